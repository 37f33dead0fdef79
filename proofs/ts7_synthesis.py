"""TS-7: for which offsets, lowering and times synchronisation isolates no healthy channel: the range, as found.

One step is one frame, 125 us; speeds and limits in words (1 word = 0.47124 km/h), T_sync in frames.
Source: the rule [P]; level rule, T_sync, lowering by 4 words, relay times, divider, comparator [A].

A channel that did not brake first is lowered and has T_sync to follow.  Of spread of the limits and lowering only the
difference counts: with the speed above the lowest limit, the follower is faster than its own by `spare` = lowering -
spread words, whatever the two are.  It gains `spare` words a frame; it needs

    two pulses, and up to 100/256 of one that the wheel correction may hold back     (2 + 100/256) * 4096 / spare
    an f_p pulse to begin with, and three generator pulses for the last f_v pulse    (1 + 2) * 4096 / word, about
    the release of NBRR                                                             160

frames.  So T_sync less the release time has to exceed a multiple of 1/spare, and the signal hardly matters.  As found,
with relay NBRR releasing within 160 frames and the speed always above the lowest limit:

| signal | least T_sync, spare 3 words | greatest spread, lowering 4, T_sync 4000 |
|--------|-----------------------------|------------------------------------------|
| 25     | 3730 (refuted at 3079)      | 1 word (refuted at 2)                    |
| 45     | 3630 (refuted at 2804)      | 1 word (refuted at 2)                    |
| 65     | 3613 (refuted at 2828)      | 1 word (refuted at 2)                    |
| 75     | 3614 (refuted at 2877)      | 1 word (refuted at 2)                    |
| 90     | 3621 (refuted at 2998)      | 1 word (refuted at 3)                    |

With 2, 3, 4, 5 spare words 5381, 3730, 2905, 2410 frames are enough at 25 km/h, 5318, 3621, 2773, 2400 at 90; with 6
and more the least T_sync of the model, 2400.  Within the range all values are proved at once; beyond it, at 4000
frames, every spread and lowering with 2 spare words or fewer (at 90 km/h: 1 or fewer) is refuted by a run, so no island
is safe.

So with the T_sync of the model, 4000 frames, a spread of 1 word is harmless at every signal.  The published +-2.0 km/h
(8 words) would need a lowering of 11 words (5.2 km/h), more than the model admits; lowered by the printed 2 km/h, a
follower may take for ever.  A release, or power-up with unequal relays, isolates a healthy channel whatever these
values are (`ts7_isolation`): there the speed is below the lowest limit, or the brake not on its account.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

from models.ts7.numbers import ACCURACY
from models.ts7.system import Ts7
from models.ts7.train import PER_WORD, SCALE
from proofs.ts7_accuracy import STEP_MM, error_of_limit
from proofs.ts7_brake_chain import CHANNELS, RELEASE, WORDS
from proofs.ts7_formulas import (
    LARGEST_WHEEL,
    PULSE,
    SMALLEST_WHEEL,
    Formula,
    braked_and_ahead,
    named,
    potential,
)
from proofs.ts7_isolation import between_windows, in_service, nobody_isolated
from proofs.ts7_voting import OFFSETS
from safety import PROVED, Bit, Scenario, Seen, all_of, any_of, implies
from safety.prove.bounds import between, magnitude, reals
from safety.prove.claims import Claim
from safety.prove.weakest import ABOVE, BELOW, weakest, weakest_of, weakest_real

SOURCE = "[A] T_sync, lowering, offsets, relay times"
LOWERINGS = tuple(f"{n}.lowering" for n in CHANNELS)
WINDOW = "common.sync.frames"
RELEASES = tuple(f"common.{n}.nbrr_relay.release" for n in CHANNELS)
CARRIES = 256 - SMALLEST_WHEEL  # wheel phase from which on every generator pulse carries, whatever the wheel
DROP = 256 - LARGEST_WHEEL  # least that the wheel phase then drops by


@dataclass(frozen=True)
class Following:
    """A lowered channel at the signal of a word, its limit `spare` words or more below the lowest of all limits."""

    word: int
    spare: int

    @property
    def wrapped(self) -> int:
        """The first f_p pulse has come; the reference then starts from nothing."""
        return 4096 // (self.word - 12) + 1

    @property
    def rest(self) -> int:
        """Most that one frame of reference takes."""
        return PER_WORD * (self.word + 4 - self.spare)

    @property
    def ahead(self) -> int:
        """Two pulses ahead, and as much more as no wheel phase keeps for long."""
        return self.wrapped + -(-(2 * PULSE + CARRIES * SCALE + 2 * self.rest) // (PER_WORD * self.spare))

    @property
    def latched(self) -> int:
        """Three generator pulses later the phase has dropped below that, with the third f_v pulse."""
        return self.ahead + -(-3 * SCALE * LARGEST_WHEEL // (PER_WORD * (self.word - 4))) + 1

    def lemmas(self, n: str) -> list[Formula]:
        """Of channel n, while a window is open that has not seen it brake."""

        def before(s: Seen, goal: Bit) -> Bit:
            return implies(s.common.sync.window.open & ~s.common.sync.window[f"seen_{n}"], goal)

        def gains(s: Seen) -> Bit:
            spent, reference = s.common.sync.window.age.int(), s[n].ring.j0.int() + 256 * s[n].div0.n.int()
            gained = potential(s, n) >= PER_WORD * self.spare * (spent - self.wrapped) - self.rest
            return before(s, braked_and_ahead(s, n) | (reference >= (self.word - 12) * spent) | gained)

        def trips(s: Seen) -> Bit:
            late = PER_WORD * (self.word - 4) * (s.common.sync.window.age.int() - self.ahead)
            phase, j1, period = s.axle.phase, s[n].ring.j1, SCALE * s.wheel.int()
            first = phase >= late  # one, two, three generator pulses since it is two pulses and more ahead
            second = (j1 >= CARRIES) & (phase + period >= late)
            third = (j1 >= CARRIES) & (j1.int() + DROP <= 255) & (phase + 2 * period >= late)
            return before(s, braked_and_ahead(s, n) | first | second | third)

        def falls(s: Seen) -> Bit:
            relay, spent = s.common[n].nbrr_relay, s.common.sync.window.age.int()
            timed = (spent < self.latched + relay.waited.int()) & (relay.waited <= relay.release)
            return before(s, relay.closed & timed)

        return [named(f"{n} lowered {what}", f) for what, f in [("gains", gains), ("trips", trips), ("falls", falls)]]


def given(line: str, words: int, release: int = RELEASE) -> Formula:
    """One signal, lowered limits so many words or more below all others, the speed above the lowest limit.

    Relays NBRR release within so many frames.
    """

    def spared(s: Seen) -> Bit:
        offsets = [s[o] for o in OFFSETS]
        spare = all_of(*(one - s[low].int() + words <= other for one, low in zip(offsets, LOWERINGS, strict=True)
                         for other in offsets))  # fmt: skip
        over = any_of(*(s.speed > PER_WORD * (WORDS[line] + offset) for offset in offsets))
        alone = all_of(*(s.lines[name] if name == line else ~s.lines[name] for name in WORDS))
        prompt = all_of(*(s[each] <= release for each in RELEASES))
        return s.inverter & alone & spare & over & prompt

    below = f"lowered limits {words} words or more below all others, speed above the lowest"
    spared.__doc__ = f"inverter on, signal {line}, {below}, NBRR releases within {release} frames"
    return spared


# Phases at which a follower brakes late, by spare words: wheel, j1, phase of the axle, reference (j0 + 256 n)
LATE = {
    "s25": {3: (172, 90, 93_600, 388), 2: (169, 102, 93_904, 203), 1: (171, 112, 7_221, 156)},
    "s45": {3: (171, 117, 135_557, 352), 2: (171, 85, 174_927, 255), 1: (172, 170, 28_142, 1237)},
    "s65": {3: (172, 168, 237_133, 1404), 2: (171, 98, 196_185, 265), 1: (172, 171, 191_055, 1150)},
    "s75": {3: (171, 118, 216_472, 271), 2: (171, 90, 6_797, 199), 1: (171, 92, 161_591, 163)},
    "s90": {3: (172, 84, 318_459, 240), 2: (172, 169, 282_373, 867), 1: (172, 85, 244_875, 3830)},
}
LONGEST = 5400  # steps of a run: longer than each window looked at that is not proved
STANDING_CHOICES = (*OFFSETS, *LOWERINGS, "wheel", *RELEASES)  # the same at all frames, left open


def late(line: str, spread: int, lowering: int = 4, release: int = RELEASE) -> Scenario:
    """Channel a brakes first, at the lowest limit; b and c, some words above and lowered, follow late."""
    wheel, j1, axle, reference = LATE[line][max(1, min(3, lowering - spread))]
    reference += 4 - lowering  # so that it is the same once lowered
    followers = {"offset": spread - 4, "ring.j1": j1, "ring.j0": reference % 256, "div0.n": reference // 256}
    start = {f"{n}.{register}": value for n in "bc" for register, value in followers.items()}
    start |= {f"common.{n}.nbrr_relay.closed": True for n in "bc"}
    start |= {f"common.{n}.chr_relay.closed": True for n in CHANNELS}
    start |= {"a.offset": -4, "a.comparator.u": 3, "a.comparator.latch": True, "wheel": wheel, "axle.phase": axle}
    start |= dict.fromkeys(LOWERINGS, lowering) | dict.fromkeys(RELEASES, release)
    inputs = {f"lines.{line}": True, "inverter": True, "speed": PER_WORD * (WORDS[line] - 4) + 1}
    return Scenario(LONGEST, inputs, start)


def lemmas(line: str, spare: int) -> list[Formula]:
    """All channels in service, and each follows in its time."""
    following = Following(WORDS[line], max(1, spare))
    return [in_service, *(f for n in CHANNELS for f in following.lemmas(n))]


def asked(
    line: str, name: str, spread: int = 1, lowering: int = 4, release: int = RELEASE, frames: int = 4000
) -> Claim:
    """That nobody is isolated within a spread (or less), with a lowering (or more) and times (or better ones)."""
    spared = given(line, lowering - spread, release)

    def within(s: Seen) -> Bit:
        offsets = [s[o] for o in OFFSETS]
        near = all_of(*(one - other <= spread for one in offsets for other in offsets))
        return spared(s) & near & all_of(*(s[low] >= lowering for low in LOWERINGS)) & (s[WINDOW] >= frames)

    told = f"limits within {spread} words, lowering by {lowering} or more, T_sync >= {frames}; {spared.__doc__}"
    within.__doc__ = told
    scenario = late(line, spread, lowering, release)
    return Claim(
        f"ts7_synthesis.{name}_at_{line}", Ts7, nobody_isolated, told, PROVED, "TS7-10", SOURCE, given=within,
        start=between_windows, lemmas=tuple(lemmas(line, lowering - spread)), symbolic=(*STANDING_CHOICES, WINDOW),
        anywhere=True, steps=1, scenario=replace(scenario, start={**scenario.start, WINDOW: frames}),
    )  # fmt: skip


# --- what is looked for ----------------------------------------------------------------------------------------------


def least_window(line: str, spare: int = 3, gap: int = 850) -> None:
    """The least T_sync at one signal and so many spare words."""
    name = f"least_window_at_{line}" if spare == 3 else f"least_window_at_{line}_with_{spare}_spare"

    @weakest(Ts7, WINDOW, safe=ABOVE, within=(2400, 8000), unit="frame", id=f"ts7_synthesis.{name}", gap=gap,
             given=given(line, spare), start=between_windows, anywhere=True, symbolic=STANDING_CHOICES, steps=1,
             lemmas=lemmas(line, spare), scenarios=[late(line, 4 - spare)], requirement="TS7-10", source=SOURCE,
             at={"signal": line, "lowering less spread": f"{spare} words or more"})  # fmt: skip
    def nobody_isolated_in_time(s: Seen) -> Bit:
        """One signal, the speed above the lowest limit, each limit lowered below all others: no healthy channel is
        isolated."""
        return nobody_isolated(s)


def greatest_spread(line: str) -> None:
    """The greatest spread of the limits at one signal."""

    @weakest_of("spread of the limits", safe=BELOW, within=(0, 8), unit="word", covers=True,
                id=f"ts7_synthesis.greatest_spread_at_{line}", gap=1 if line != "s90" else 2,
                at={"signal": line, "lowering": "4 words", "T_sync": "4000 frames"})  # fmt: skip
    def within(spread: int) -> Claim:
        """One signal, the speed above the lowest limit: no healthy channel is isolated."""
        return asked(line, "greatest_spread", spread)


for signal in LATE:
    least_window(signal)
    greatest_spread(signal)


@weakest_of("lowering", safe=ABOVE, within=(0, 8), unit="word", covers=True,
            at={"signal": "s65", "spread": "1 word", "T_sync": "4000 frames"})  # fmt: skip
def least_lowering(words: int) -> Claim:
    """Signal 65, limits within 1 word, the speed above the lowest limit: no healthy channel is isolated."""
    return asked("s65", "least_lowering", lowering=words)


def prompt_as_b(s: Seen) -> Bit:
    """Signal 25, lowered limits 3 words below all others, T_sync >= 4000; no NBRR releases later than that of b."""
    times = all_of(s[WINDOW] >= 4000, *(s[each] <= s[RELEASES[1]] for each in RELEASES))
    return given("s25", 3, 800)(s) & times


@weakest(Ts7, RELEASES[1], safe=BELOW, within=(0, 400), unit="frame", given=prompt_as_b, start=between_windows, steps=1,
         anywhere=True, symbolic=(*OFFSETS, *LOWERINGS, "wheel", WINDOW, *RELEASES[::2]), lemmas=lemmas("s25", 3),
         at={"signal": "s25", "lowering less spread": "3 words or more", "T_sync": "4000 frames"},
         requirement="TS7-10", source=SOURCE)  # fmt: skip
def longest_release(s: Seen) -> Bit:
    """Signal 25, the speed above the lowest limit: no healthy channel is isolated."""
    return nobody_isolated(s)


# --- the wheel switch ------------------------------------------------------------------------------------------------

true_mm, step, off_mm = reals("true_mm step off_mm")
wheel = error_of_limit(90, 40)
wheel = replace(
    wheel,
    statement="Error of the 90 km/h limit, wheel within off_mm of its setting",
    given=(*wheel.given, between(0, off_mm, 40), magnitude(true_mm - STEP_MM * step) <= off_mm),
)
weakest_real(
    wheel, ACCURACY, off_mm, safe=BELOW, within=(0, 40), gap=Fraction(1, 10), unit="mm",
    id="ts7_synthesis.greatest_wheel_error_at_90", at={"signal": "s90", "drift": "100 ppm"},
)  # fmt: skip

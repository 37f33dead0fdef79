"""TS-7: which healthy channels synchronisation isolates, frame by frame, and how far apart limits may lie.

One step is one frame, 125 us; speeds and limits in words (1 word = 0.47124 km/h), lowering 4 words, T_sync 4000 frames
(0.5 s).  With exact limits a spread of 2.0 km/h is harmless (see the threshold model); here a lowered channel needs
time to follow, and the time is T_sync.
Source: the rule [P]; level rule, T_sync, lowering by 4 words, relay times [A].

Main results: with one signal, the true wheel set and the speed always above the lowest limit, limits within 1 word
(0.47 km/h) never isolate a healthy channel, at any phases; at 25 km/h this is proved for T_sync of 4020 frames and
more only, not for the 4000 that the model takes.  2 words apart can isolate one.  Even with equal limits an ordinary
release isolates a healthy channel, and so does a relay NBRR that operates a frame before the others at power-up.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from models.ts7.system import Ts7
from models.ts7.train import PER_WORD, SCALE
from models.ts7.voting import CommonPart, SettlingCommonPart
from proofs.ts7_brake_chain import CHANNELS, RELEASE, WORDS
from proofs.ts7_formulas import (
    LARGEST_WHEEL,
    PULSE,
    SPEED_FRACTION,
    Formula,
    braked_and_ahead,
    latch_at_the_ends,
    named,
    potential,
)
from proofs.ts7_synchronisation import (
    SIGNAL_65,
    SILENT_JUST_AFTER_A_WINDOW_OPENED,
    T_SYNC,
    demands,
    newly_cut,
    no_fault_found,
    three,
    windows_in_order,
)
from proofs.ts7_voting import OFFSETS
from safety import PROVED, REFUTED, Bit, Scenario, Seen, all_of, any_of, claim, implies

# --- limits apart ---------------------------------------------------------------------------------------------------


def released_then(at: int, words: Callable[[int], float], steps: int, **start: int) -> Scenario:
    """Signal 65, released at 30 words, then at a speed in words; all channels start with the phases given."""
    speed = {"speed": lambda k: int(PER_WORD * (30 if k < at else words(k)))}
    return Scenario(steps, {**SIGNAL_65, **speed}, {name.replace("__", "."): value for name, value in start.items()})


@dataclass(frozen=True)
class Following:
    """A lowered channel, 3 words above its limit at least, at the signal of a word: when it brakes, in frames."""

    word: int  # 4 words of offset and 4 of lowering: limits from word - 8 to word

    @property
    def wrapped(self) -> int:
        """The first f_p pulse has come; the reference then starts from nothing."""
        return 4096 // (self.word - 8) + 1

    @property
    def behind(self) -> int:
        """Most that the speed phase still holds after an f_v pulse, with what one frame of reference may take."""
        return SCALE * LARGEST_WHEEL + PER_WORD * self.word

    @property
    def ahead(self) -> int:
        """Two pulses ahead and more: the next f_v pulse is the third."""
        return self.wrapped + -(-(2 * PULSE + self.behind + PER_WORD * self.word) // (3 * PER_WORD))

    @property
    def latched(self) -> int:
        """That pulse has come."""
        return self.ahead + (SPEED_FRACTION - self.behind) // (PER_WORD * (self.word - 4)) + 1

    @property
    def seen(self) -> int:
        """Relay NBRR has fallen: the least T_sync."""
        return self.latched + RELEASE + 1

    def lemmas(self, n: str) -> list[Formula]:
        """Of channel n, while a window is open that has not seen it brake."""

        def before(s: Seen, goal: Bit) -> Bit:
            return implies(s.common.sync.window.open & ~s.common.sync.window[f"seen_{n}"], goal)

        def gains(s: Seen) -> Bit:
            spent, reference = s.common.sync.window.age.int(), s[n].ring.j0.int() + 256 * s[n].div0.n.int()
            gained = potential(s, n) >= 3 * PER_WORD * (spent - self.wrapped) - PER_WORD * self.word
            return before(s, braked_and_ahead(s, n) | (reference >= (self.word - 8) * spent) | gained)

        def trips(s: Seen) -> Bit:
            late, phase = s.common.sync.window.age.int() - self.ahead, SCALE * s[n].ring.j1.int() + s.axle.phase
            due = phase >= self.behind + PER_WORD * (self.word - 4) * late
            return before(s, braked_and_ahead(s, n) | (late <= 0) | due)

        def falls(s: Seen) -> Bit:
            relay, spent = s.common[n].nbrr_relay, s.common.sync.window.age.int()
            timed = (spent < self.latched + relay.waited.int()) & (relay.waited <= RELEASE)
            return before(s, relay.closed & timed)

        return [named(f"{n} lowered {what}", f) for what, f in [("gains", gains), ("trips", trips), ("falls", falls)]]


def in_service(s: Seen) -> Bit:
    """All channels are in service, checks and latches in step with their counters, windows in order."""

    def sound(n: str) -> Bit:
        check = s[n].check
        counted = 256 * check["count"].int() + s[n].ring.j2.int() - 85 * check.frame.int()
        checked = ~check.faulty & (counted >= 0) & (counted <= 255)
        return s.common[n].chr_relay.closed & checked & latch_at_the_ends(n)(s)

    uncut = ~any_of(*three(s.common.sync, "cut_"))
    return ~s.power.standby & uncut & all_of(*map(sound, CHANNELS)) & windows_in_order(s.common)


def between_windows(s: Seen) -> Bit:
    """Any phases and brake demands; all channels in service, no window open."""
    return in_service(s) & ~s.common.sync.window.open


def spread_of(words: int, line: str, least: int = 2400) -> Formula:
    """Inverter on, one signal, limits within so many words, the speed never below the lowest."""

    def given(s: Seen) -> Bit:
        offsets = [s[o] for o in OFFSETS]
        near = all_of(*(one - other <= words for one in offsets for other in offsets))
        over = any_of(*(s.speed > PER_WORD * (WORDS[line] + offset) for offset in offsets))
        alone = all_of(*(s.lines[name] if name == line else ~s.lines[name] for name in WORDS))
        return s.inverter & alone & near & over & (s.common.sync.frames >= least)

    return named(f"signal {line}, limits within {words} words, speed above the lowest, T_sync >= {least}", given)


def nobody_isolated(s: Seen) -> Bit:
    """No target is dropped."""
    return ~any_of(*three(s, "targets."))


T_SYNC_OF = {line: max(4000, Following(WORDS[line]).seen) for line in ("s25", "s45", "s65", "s75", "s90")}
OPEN = (*OFFSETS, "wheel", "common.sync.frames")


def declared_at(line: str) -> Formula:
    """The claim for one signal."""

    def nobody_isolated_within_one_word(s: Seen) -> Bit:
        """One signal, wheel as set, limits within 1 word of each other, speed above the lowest, T_sync of 4000 frames
        or more (at 25 km/h: of 4020, so not the 4000 of the model): no healthy channel is isolated."""
        return nobody_isolated(s)

    lemmas = [in_service, *(f for n in CHANNELS for f in Following(WORDS[line]).lemmas(n))]
    given = spread_of(1, line, T_SYNC_OF[line])
    return claim(Ts7, given=given, start=between_windows, anywhere=True, symbolic=OPEN, expect=PROVED, lemmas=lemmas,
                 requirement="TS7-10", source="[D] for T_sync 4000 frames [A]; at 25 km/h 4020 frames",
                 )(named(f"nobody_isolated_within_one_word_at_{line}", nobody_isolated_within_one_word))  # fmt: skip


WITHIN_ONE_WORD = {line: declared_at(line) for line in T_SYNC_OF}


@claim(Ts7, expect=REFUTED, defeat=True, settings={"a.offset": -2, "b.offset": 2, "c.offset": 2}, requirement="TS7-10",
       source="[A] +-2.0 km/h as words", twin_of=WITHIN_ONE_WORD["s65"],
       scenario=released_then(1500, lambda k: 136.5, 16_000))  # fmt: skip
def nobody_isolated_within_four_words(s: Seen) -> Bit:
    """All healthy, limits within 4 words of each other: no channel is isolated.  False: half a word above the lowest
    limit the others, lowered by 4, follow too late, and the early one is isolated."""
    return nobody_isolated(s)


@claim(Ts7, given=spread_of(2, "s75"), start=between_windows, anywhere=True, symbolic=OPEN, expect=REFUTED, defeat=True,
       requirement="TS7-10", source="[A] T_sync 0.5 s", twin_of=WITHIN_ONE_WORD["s75"],
       scenario=Scenario(4200, {"lines.s75": True, "inverter": True, "speed": 161 * PER_WORD + 1}, {
           "wheel": 172, "axle.phase": 374_807, "a.offset": 2, "a.comparator.u": 3, "a.comparator.latch": True,
           **{f"{n}.{r}": v for n in "bc" for r, v in {"offset": 4, "ring.j0": 220, "ring.j1": 116}.items()},
           **{f"common.{r}.closed": True for r in (
               "a.chr_relay", "b.chr_relay", "c.chr_relay", "b.nbrr_relay", "c.nbrr_relay")}}))  # fmt: skip
def nobody_isolated_within_two_words(s: Seen) -> Bit:
    """Signal 75, wheel as set, limits within 2 words of each other, speed above the lowest, T_sync of 2400 frames or
    more: no healthy channel is isolated.  False: with 4000, just above the lowest, the others follow too late."""
    return nobody_isolated(s)


# --- release -------------------------------------------------------------------------------------------------------


def isolation_needs_a_brake(s: Seen) -> Bit:
    """A channel is isolated only at a frame at which some channel brakes."""
    return implies(any_of(*(newly_cut(s, n) for n in CHANNELS)), any_of(*three(s, "brakes.")))


@claim(SettlingCommonPart, given=no_fault_found, symbolic=T_SYNC, expect=PROVED, requirement="TS7-10",
       source="[A] a window ends with the last brake command", witness=SILENT_JUST_AFTER_A_WINDOW_OPENED)  # fmt: skip
def nobody_isolated_after_all_released(s: Seen) -> Bit:
    """If windows end with the last brake command, a channel that finds no fault in itself is isolated only while some
    channel brakes."""
    return isolation_needs_a_brake(s)


@claim(CommonPart, given=no_fault_found, symbolic=T_SYNC, expect=REFUTED, defeat=True, requirement="TS7-10",
       source="[A] 1.6", twin_of=nobody_isolated_after_all_released,
       scenario=demands(6000, a=[(1000, 2000)], b=[(1000, 1500)], c=[(1000, 1500)]))  # fmt: skip
def nobody_isolated_after_all_released_in_the_reference(s: Seen) -> Bit:
    """In the reference, too, a channel that finds no fault in itself is isolated only while some channel brakes.
    False: one that merely releases 500 frames after the others is isolated 3500 frames later."""
    return isolation_needs_a_brake(s)


@claim(Ts7, expect=REFUTED, defeat=True, requirement="TS7-10", source="[A] 1.6",
       twin_of=nobody_isolated_after_all_released,
       scenario=released_then(1500, lambda k: 150 if k < 5000 else 130, 11_000,
                              a__div0__n=8, b__div0__n=3))  # fmt: skip
def nobody_isolated_by_an_ordinary_release(s: Seen) -> Bit:
    """Three healthy channels with equal limits, apart only in the phase of a divider: one brake and its release isolate
    nobody.  False: a window opens on the two that still brake, and the first to release is isolated as silent."""
    return nobody_isolated(s)


# --- power-up ------------------------------------------------------------------------------------------------------


@claim(Ts7, expect=REFUTED, defeat=True, requirement="TS7-10", source="[A] relay times; level rule",
       settings={f"common.{n}.nbrr_relay.operate": frames for n, frames in zip(CHANNELS, (240, 241, 241), strict=True)},
       twin_of=WITHIN_ONE_WORD["s65"], scenario=Scenario(4600, {**SIGNAL_65, "speed": 30 * PER_WORD}))  # fmt: skip
def nobody_isolated_at_power_up_with_unequal_relays(s: Seen) -> Bit:
    """All healthy, equal limits, NBRR of a operates in 240 frames, those of b and c in 241: power-up isolates nobody.
    False: for a frame b and c alone brake, the window takes a for silent, and isolates it T_sync later."""
    return nobody_isolated(s)

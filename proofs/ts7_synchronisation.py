"""TS-7 synchronisation, frame by frame: windows, isolation, and who may be isolated.

One step is one frame, 125 us; speeds in words (1 word = 0.47124 km/h), lowering 4 words, T_sync 4000 frames (0.5 s).
In the claims about the common part alone the channels may do anything whatever: their demands are free inputs.
Source: the rule [P]; level rule, T_sync, two at once, relay times [A].

Main results: synchronisation isolates one channel at most, and a silent one within two windows (level rule; with the
edge rule never).
"""

from __future__ import annotations

from collections.abc import Callable

from models.ts7.signals import Lines
from models.ts7.system import Ts7
from models.ts7.train import PER_WORD
from models.ts7.voting import CommonPart, EdgeCommonPart, SettlingCommonPart
from proofs.ts7_brake_chain import RELEASE, Chain
from proofs.ts7_formulas import (
    REFERENCE_FRACTION,
    braked_and_ahead,
    free_and_behind,
    latch_at_the_ends,
    named,
    potential,
)
from proofs.ts7_voting import OFFSETS
from safety import (
    PROVED,
    REFUTED,
    Bit,
    Scenario,
    Seen,
    age,
    all_of,
    any_of,
    at_most,
    claim,
    count,
    faulty,
    implies,
    select,
)

SIGNAL_65 = {"lines.s65": True, "inverter": True, "mg": True}
T_SYNC = ("sync.frames",)  # left open, 2400..8000 frames
MOST = 8000


def three(s: Seen, prefix: str) -> list[Bit]:
    """The bits of the three channels: `seen_` or `targets.`."""
    return [s[f"{prefix}{n}"] for n in "abc"]


# --- windows and isolation -----------------------------------------------------------------------------------------


def windows_in_order(s: Seen) -> Bit:
    """A window has a channel that braked first, not all three, lasts T_sync at most, and needs all in service."""
    first, seen, y = three(s.sync, "first_"), three(s.sync, "seen_"), s.sync
    inside = any_of(*first) & ~all_of(*first) & (y.age < y.frames) & ~any_of(*three(y, "cut_"))
    outside = ~any_of(*first, *seen) & (y.age == 0)
    return select(y.window, inside, outside) & all_of(*(implies(f, n) for f, n in zip(first, seen, strict=True)))


def at_most_one_cut(s: Seen) -> Bit:
    """At most one channel is isolated."""
    return count(*three(s.sync, "cut_")) <= 1


def no_fault_found(s: Seen) -> Bit:
    """No channel finds itself faulty."""
    return ~any_of(s["a.fault"], s["b.fault"], s["c.fault"])


@claim(CommonPart, symbolic=T_SYNC, expect=PROVED, lemmas=[windows_in_order], requirement="TS7-10",
       source="[P] 1.6, gaps filled [R]", witness=Scenario(steps=2000, start={"sync.frames": 4000}, inputs={
           "supply": True, "b.drive": True, "c.drive": True, "a.drive": lambda k: k < 1000}))  # fmt: skip
def only_channels_that_follow_late_are_lowered(s: Seen) -> Bit:
    """Whatever the channels do: limits are lowered in a window only, never all three, with nobody isolated."""
    lowered = [s.sync.window & ~f for f in three(s.sync, "first_")]
    return implies(any_of(*lowered), s.synchronising & ~all_of(*lowered) & ~any_of(*three(s.sync, "cut_")))


@claim(CommonPart, given=no_fault_found, symbolic=T_SYNC, expect=PROVED, lemmas=[windows_in_order, at_most_one_cut],
       requirement="TS7-14", source="[P] no further synchronisation after an isolation")  # fmt: skip
def synchronisation_isolates_at_most_one(s: Seen) -> Bit:
    """Whatever the channels do, synchronisation isolates one of them at most."""
    return count(*three(s, "targets.")) <= 1


@claim(CommonPart, expect=REFUTED, requirement="TS7-14", twin_of=synchronisation_isolates_at_most_one)
def at_most_one_is_ever_isolated(s: Seen) -> Bit:
    """At most one is isolated, also by the channels' own checks: false, two may find themselves faulty."""
    return count(*three(s, "targets.")) <= 1


def agree(s: Seen) -> Bit:
    """Channels b and c have both braked in this window, or neither has."""
    b, c = s.sync.seen_b | s.brakes.b, s.sync.seen_c | s.brakes.c
    return ~(b ^ c)


def newly_cut(s: Seen, n: str) -> Bit:
    """A channel is isolated at this frame."""
    return s.targets[n] & ~s.sync[f"cut_{n}"]


@claim(CommonPart, given=no_fault_found, symbolic=T_SYNC, expect=PROVED, requirement="TS7-10",
       source="[P] majority of the three commands")  # fmt: skip
def a_pair_that_agrees_is_not_isolated(s: Seen) -> Bit:
    """If two healthy channels both brake in a window, or both do not, neither is isolated whatever the third does."""
    return implies(agree(s), ~newly_cut(s, "b") & ~newly_cut(s, "c"))


@claim(CommonPart, given=no_fault_found, symbolic=T_SYNC, expect=REFUTED, requirement="TS7-10", anywhere=True,
       twin_of=a_pair_that_agrees_is_not_isolated, start=lambda s: windows_in_order(s) & at_most_one_cut(s))  # fmt: skip
def a_pair_is_not_isolated(s: Seen) -> Bit:
    """The same without the premise: one of two that disagree may be isolated."""
    return ~newly_cut(s, "b") & ~newly_cut(s, "c")


# --- a channel that falls silent -----------------------------------------------------------------------------------


def silent(s: Seen, n: str) -> Bit:
    """The other two brake, channel n does not, and all are in service."""
    others = all_of(*(s.brakes[m] for m in "abc" if m != n))
    return others & ~s.brakes[n] & ~any_of(*three(s, "isolated."))


def silence_is_timed(n: str) -> Callable[[Seen], Bit]:
    """Lemma: silence of n has lasted no longer than a first window, that saw n brake, and a second one allow."""

    def lemma(s: Seen) -> Bit:
        y, t = s.sync, age(silent(s, n), 2 * MOST + 2).int()
        braking = all_of(*(y[f"seen_{m}"] for m in "abc" if m != n))
        first = y.window & braking & (y.age >= t)
        between = ~y.window & (t <= y.frames)
        second = y.window & braking & ~y[f"seen_{n}"] & (y.age + y.frames + 1 >= t)
        return any_of(*three(y, "cut_")) | (t == 0) | first | between | second

    return named(f"the silence of {n} is timed by windows", lemma)


SILENCE = [silence_is_timed(n) for n in "abc"]


def ends_in_isolation(s: Seen, windows: int, spare: int) -> Bit:
    """Whichever channel is silent: after so many windows and spare frames of it, somebody is isolated."""

    def long(n: str) -> Bit:
        return silent(s, n) & (age(silent(s, n), 2 * MOST + 2).int() + 1 >= windows * s.sync.frames + spare)

    return implies(any_of(*(long(n) for n in "abc")), any_of(*three(s, "targets.")))


def demands(steps: int, **braking: list[tuple[int, int]]) -> Scenario:
    """Each channel brakes in its intervals of frames; T_sync is 0.5 s."""

    def drive(intervals: list[tuple[int, int]]) -> Callable[[int], bool]:
        return lambda k: not any(first <= k < end for first, end in intervals)

    inputs = {f"{n}.drive": drive(braking[n]) for n in braking}
    return Scenario(steps, {"supply": True, **inputs}, start={"sync.frames": 4000})


EVER = 30_000
ALL_BRAKE_THEN_C_IS_SILENT = demands(11_000, a=[(1000, EVER)], b=[(1000, EVER)], c=[(1000, 2000)])
SILENT_JUST_AFTER_A_WINDOW_OPENED = demands(
    15_000, a=[(1000, 1500), (2000, 2300), (5582, EVER)], b=[(1000, EVER)], c=[(1000, 5502)]
)


@claim(CommonPart, symbolic=T_SYNC, expect=PROVED, lemmas=[windows_in_order, *SILENCE], requirement="TS7-7",
       source="[P] 1.6; level rule [A]", witness=SILENT_JUST_AFTER_A_WINDOW_OPENED)  # fmt: skip
def silence_ends_in_isolation(s: Seen) -> Bit:
    """While two channels brake and the third does not, somebody is isolated within two windows and a frame."""
    return ends_in_isolation(s, 2, 1)


@claim(CommonPart, symbolic=T_SYNC, expect=REFUTED, requirement="TS7-7", twin_of=silence_ends_in_isolation,
       scenario=SILENT_JUST_AFTER_A_WINDOW_OPENED)  # fmt: skip
def silence_ends_in_isolation_a_frame_earlier(s: Seen) -> Bit:
    """The time is exact: a channel that falls silent just after a window opened is found by the next one only."""
    return ends_in_isolation(s, 2, 0)


@claim(EdgeCommonPart, symbolic=T_SYNC, expect=REFUTED, requirement="TS7-7", source="edge rule [A]",
       twin_of=silence_ends_in_isolation, scenario=ALL_BRAKE_THEN_C_IS_SILENT)  # fmt: skip
def silence_ends_in_isolation_by_the_edge_rule(s: Seen) -> Bit:
    """Edge rule: a channel that falls silent while all three brake is never noticed, for nobody starts to brake."""
    return ends_in_isolation(s, 2, 1)


# --- how low the brake can come without need -----------------------------------------------------------------------


def calm(n: str) -> Callable[[Seen], Bit]:
    """Lemma: a healthy channel n stays free of brake, fault and isolation, its relays up."""

    def lemma(s: Seen) -> Bit:
        check, relays, y = s[n].check, s.common[n], s.common.sync
        counted = 256 * check.count.int() + s[n].ring.j2.int() - 85 * check.frame.int()
        healthy = free_and_behind(s, n) & ~check.faulty & (counted >= 0) & (counted <= 255)
        up = relays.chr_relay.closed & relays.nbrr_relay.closed
        return faulty(s, n) | (healthy & up & ~any_of(y[f"first_{n}"], y[f"seen_{n}"], y[f"cut_{n}"]))

    return named(f"{n} stays free, in service and unseen", lemma)


def powered(s: Seen) -> Bit:
    """The inverter feeds the relays, NB is released."""
    return ~s.power.standby & s.common.nb_relay.closed


CALM = [powered, *(calm(n) for n in "abc")]


def at_rest(s: Seen) -> Bit:
    """All healthy channels are released and in service."""
    return all_of(*(lemma(s) for lemma in CALM))


def words_below(words: int) -> Callable[[Seen], Bit]:
    """The speed stays below the limit of the signal."""

    def given(s: Seen) -> Bit:
        return s.inverter & (s.speed <= PER_WORD * (s.lines_a.word.int() - words))

    return named(f"inverter on, speed at least {words} words below the limit of the signal", given)


@claim(Ts7, faults=at_most(1, "channel"), given=words_below(8), start=at_rest, anywhere=True, lemmas=CALM,
       symbolic=OFFSETS, expect=PROVED, requirement="TS7-9", source="[D] +-4 words and lowering by 4")  # fmt: skip
def no_brake_eight_words_below(s: Seen) -> Bit:
    """From rest: one channel, broken in any way, cannot bring NB while the speed stays 8 words below the limit."""
    return ~s.nb


AT_THE_EDGE = {  # released, but the speed pulses as far ahead as a speed within the limit leaves them
    "power.standby": False, "common.nb_relay.closed": True,
    **{f"{n}.{register}": value for n in "abc" for register, value in {
        "offset": -4, "comparator.u": 2, "ring.j1": 150, "ring.j0": 255, "div0.n": 15}.items()},
    **{f"common.{n}.{relay}.closed": True for n in "abc" for relay in ("chr_relay", "nbrr_relay")},
}  # fmt: skip


@claim(Ts7, faults=at_most(1, "channel"), given=words_below(7), start=at_rest, anywhere=True, symbolic=OFFSETS,
       expect=REFUTED, requirement="TS7-9", twin_of=no_brake_eight_words_below, scenario=Scenario(
           3000, {**SIGNAL_65, "speed": PER_WORD * (138 - 7)}, AT_THE_EDGE, present=["a"]))  # fmt: skip
def no_brake_seven_words_below(s: Seen) -> Bit:
    """The bound is exact: 7 words below, a broken channel a and the lowering bring b and c to brake."""
    return ~s.nb


# --- healthy channels isolated -------------------------------------------------------------------------------------


def only_65(s: Seen) -> Bit:
    """The line of signal 65 is active, no other."""
    return all_of(*(s.lines[name] if name == "s65" else ~s.lines[name] for name in Lines._fields))


def nobody_isolated(s: Seen) -> Bit:
    """No target is dropped."""
    return ~any_of(*three(s, "targets."))


def released_then(at: int, words: Callable[[int], float], steps: int, **start: int) -> Scenario:
    """Signal 65, released at 30 words, then at a speed in words; all channels start with the phases given."""
    speed = {"speed": lambda k: int(PER_WORD * (30 if k < at else words(k)))}
    return Scenario(steps, {**SIGNAL_65, **speed}, {name.replace("__", "."): value for name, value in start.items()})


def follows_at_three_words(n: str) -> list[Callable[[Seen], Bit]]:
    """Lemmas: in a window a lowered channel gains 3 words a frame until it brakes, and its relay then falls."""

    def unseen(s: Seen) -> Bit:
        return s.common.sync.window & ~s.common.sync[f"seen_{n}"]

    def gains(s: Seen) -> Bit:
        gained = potential(s, n) >= 3 * PER_WORD * s.common.sync.age.int() - REFERENCE_FRACTION
        return implies(unseen(s), braked_and_ahead(s, n) | gained)

    def falls(s: Seen) -> Bit:
        relay, spent = s.common[n].nbrr_relay, s.common.sync.age.int()
        timed = (spent < THREE_WORDS.latched + relay.waited.int()) & (relay.waited <= RELEASE)
        return implies(unseen(s), relay.closed & timed)

    return [named(f"{n} lowered brakes or gains", gains), named(f"{n} lowered falls", falls)]


THREE_WORDS = Chain(words=3)
LONG_ENOUGH = THREE_WORDS.latched + RELEASE + 1  # frames, 0.82 s


def in_service(s: Seen) -> Bit:
    """All channels are in service, checks and latches in step with their counters, windows in order."""

    def sound(n: str) -> Bit:
        check = s[n].check
        counted = 256 * check["count"].int() + s[n].ring.j2.int() - 85 * check.frame.int()
        checked = ~check.faulty & (counted >= 0) & (counted <= 255)
        return s.common[n].chr_relay.closed & checked & latch_at_the_ends(n)(s)

    return ~s.power.standby & ~any_of(*three(s.common.sync, "cut_")) & all_of(*map(sound, "abc")) & windows_in_order(s.common)


def above_the_lowest(s: Seen) -> Bit:
    """Signal 65, inverter on; limits within 1 word, the speed always above the lowest of them; T_sync 0.82 s or more."""
    offsets = [s[o] for o in OFFSETS]
    near = all_of(*(one - other <= 1 for one in offsets for other in offsets))
    over = any_of(*(s.speed > PER_WORD * (138 + offset) for offset in offsets))
    return s.inverter & only_65(s) & near & over & (s.common.sync.frames >= LONG_ENOUGH)


@claim(Ts7, given=above_the_lowest, start=lambda s: in_service(s) & ~s.common.sync.window, anywhere=True,
       symbolic=(*OFFSETS, "common.sync.frames"), expect=PROVED, requirement="TS7-10", source="[D]",
       lemmas=[in_service, *(lemma for n in "abc" for lemma in follows_at_three_words(n))])  # fmt: skip
def nobody_isolated_within_one_word(s: Seen) -> Bit:
    """Limits within 1 word, speed never below the lowest of them, T_sync of 0.82 s: no healthy channel is isolated."""
    return nobody_isolated(s)


@claim(Ts7, expect=REFUTED, settings={"a.offset": -2, "b.offset": 2, "c.offset": 2}, requirement="TS7-10",
       source="[A] +-2.0 km/h as words", twin_of=nobody_isolated_within_one_word,
       scenario=released_then(1500, lambda k: 136.5, 16_000))  # fmt: skip
def nobody_isolated_within_four_words(s: Seen) -> Bit:
    """Limits 4 words apart, all healthy: constant speed half a word above the lowest isolates the channel that is right."""
    return nobody_isolated(s)

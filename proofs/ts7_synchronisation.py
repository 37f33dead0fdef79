"""TS-7 synchronisation, frame by frame: windows, isolation, and who may be isolated.

One step is one frame, 125 us; speeds in words (1 word = 0.47124 km/h), lowering 4 words, T_sync 4000 frames (0.5 s).
In the claims about the common part alone the channels may do anything whatever: their demands are free inputs.
Source: the rule [P]; level rule, T_sync, two at once, relay times [A].

Main results: synchronisation isolates one channel at most, and a silent one within two windows and a frame (8001
frames; with the edge rule never).  From rest, with the speed kept 8 words below the limit, one broken channel cannot
bring the brake; 7 words below it can.
"""

from __future__ import annotations

from collections.abc import Callable

from models.ts7.system import Ts7
from models.ts7.train import PER_WORD
from models.ts7.voting import CommonPart, EdgeCommonPart
from proofs.ts7_brake_chain import CHANNELS
from proofs.ts7_formulas import (
    Formula,
    free_and_behind,
    named,
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
    return [s[f"{prefix}{n}"] for n in CHANNELS]


# --- windows and isolation -----------------------------------------------------------------------------------------


def windows_in_order(s: Seen) -> Bit:
    """A window has a channel that braked first, not all three, lasts T_sync at most, and needs all in service."""
    first, seen, y = three(s.sync.window, "first_"), three(s.sync.window, "seen_"), s.sync
    inside = any_of(*first) & ~all_of(*first) & (y.window.age < y.frames) & ~any_of(*three(y, "cut_"))
    outside = ~any_of(*first, *seen) & (y.window.age == 0)
    return select(y.window.open, inside, outside) & all_of(*(implies(f, n) for f, n in zip(first, seen, strict=True)))


def at_most_one_cut(s: Seen) -> Bit:
    """At most one channel is isolated."""
    return count(*three(s.sync, "cut_")) <= 1


def no_fault_found(s: Seen) -> Bit:
    """No channel finds itself faulty."""
    return ~any_of(s["a.fault"], s["b.fault"], s["c.fault"])


@claim(CommonPart, symbolic=T_SYNC, expect=PROVED, requirement="TS7-10",
       source="[P] 1.6, gaps filled [R]", witness=Scenario(steps=2000, start={"sync.frames": 4000}, inputs={
           "supply": True, "b.drive": True, "c.drive": True, "a.drive": lambda k: k < 1000}))  # fmt: skip
def only_channels_that_follow_late_are_lowered(s: Seen) -> Bit:
    """Whatever the channels do: limits are lowered in a window only, never all three, with nobody isolated."""
    lowered = [s.sync.window.open & ~f for f in three(s.sync.window, "first_")]
    return implies(any_of(*lowered), s.synchronising & ~all_of(*lowered) & ~any_of(*three(s.sync, "cut_")))


@claim(CommonPart, given=no_fault_found, symbolic=T_SYNC, expect=PROVED, 
       requirement="TS7-14", source="[P] no further synchronisation after an isolation")  # fmt: skip
def synchronisation_isolates_at_most_one(s: Seen) -> Bit:
    """Whatever the channels do, synchronisation isolates one of them at most."""
    return count(*three(s, "targets.")) <= 1


@claim(CommonPart, expect=REFUTED, requirement="TS7-14", twin_of=synchronisation_isolates_at_most_one)
def at_most_one_is_ever_isolated(s: Seen) -> Bit:
    """At most one channel is ever isolated, by its own check or otherwise.  False: two may find themselves faulty."""
    return count(*three(s, "targets.")) <= 1


def agree(s: Seen) -> Bit:
    """Channels b and c have both braked in this window, or neither has."""
    b, c = s.sync.window.seen_b | s.brakes.b, s.sync.window.seen_c | s.brakes.c
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
       start=windows_in_order, twin_of=a_pair_that_agrees_is_not_isolated)  # fmt: skip
def a_pair_is_not_isolated(s: Seen) -> Bit:
    """Of two healthy channels neither is isolated, whatever the third does.  False: one of two that disagree may be."""
    return ~newly_cut(s, "b") & ~newly_cut(s, "c")


# --- a channel that falls silent -----------------------------------------------------------------------------------


def silent(s: Seen, n: str) -> Bit:
    """The other two brake, channel n does not, and all are in service."""
    others = all_of(*(s.brakes[m] for m in CHANNELS if m != n))
    return others & ~s.brakes[n] & ~any_of(*three(s, "isolated."))


def silence_is_timed(n: str) -> Callable[[Seen], Bit]:
    """Lemma: silence of n has lasted no longer than a first window, that saw n brake, and a second one allow."""

    def lemma(s: Seen) -> Bit:
        y, t = s.sync, age(silent(s, n), 2 * MOST + 2).int()
        braking = all_of(*(y.window[f"seen_{m}"] for m in CHANNELS if m != n))
        first = y.window.open & braking & (y.window.age >= t)
        between = ~y.window.open & (t <= y.frames)
        second = y.window.open & braking & ~y.window[f"seen_{n}"] & (y.window.age + y.frames + 1 >= t)
        return any_of(*three(y, "cut_")) | (t == 0) | first | between | second

    return named(f"the silence of {n} is timed by windows", lemma)


SILENCE = [silence_is_timed(n) for n in CHANNELS]


def ends_in_isolation(s: Seen, windows: int, spare: int) -> Bit:
    """Whichever channel is silent: after so many windows and spare frames of it, somebody is isolated."""

    def long(n: str) -> Bit:
        return silent(s, n) & (age(silent(s, n), 2 * MOST + 2).int() + 1 >= windows * s.sync.frames + spare)

    return implies(any_of(*(long(n) for n in CHANNELS)), any_of(*three(s, "targets.")))


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
    """While two channels brake and the third does not, somebody is isolated within two windows.  False: one that falls
    silent just after a window opened is found at the end of the next, a frame later."""
    return ends_in_isolation(s, 2, 0)


@claim(EdgeCommonPart, symbolic=T_SYNC, expect=REFUTED, requirement="TS7-7", source="edge rule [A]",
       twin_of=silence_ends_in_isolation, scenario=ALL_BRAKE_THEN_C_IS_SILENT)  # fmt: skip
def silence_ends_in_isolation_by_the_edge_rule(s: Seen) -> Bit:
    """Edge rule: while two channels brake and the third does not, somebody is isolated within two windows and a frame.
    False: one that falls silent while all three brake is never noticed, for nobody starts to brake."""
    return ends_in_isolation(s, 2, 1)


def unseen_and_silent(s: Seen, n: str) -> Bit:
    """Channel n is silent and has not braked in an open window either."""
    return silent(s, n) & ~s.sync.window[f"seen_{n}"]


def timed_by_one_window(n: str) -> Formula:
    """Lemma: such silence has lasted no longer than the window that will isolate n."""

    def lemma(s: Seen) -> Bit:
        y, t = s.sync, age(unseen_and_silent(s, n), MOST + 1).int()
        open_ = y.window.open & all_of(*(y.window[f"seen_{m}"] for m in CHANNELS if m != n)) & ~y.window[f"seen_{n}"]
        return any_of(*three(y, "cut_")) | (t == 0) | (open_ & (y.window.age + 1 >= t))

    return named(f"the silence of {n} is timed by one window", lemma)


def isolated_in_one_window(s: Seen, spare: int) -> Bit:
    """After T_sync and some spare frames of such silence, somebody is isolated."""

    def long(n: str) -> Bit:
        return unseen_and_silent(s, n) & (age(unseen_and_silent(s, n), MOST + 1).int() + 1 >= s.sync.frames + spare)

    return implies(any_of(*(long(n) for n in CHANNELS)), any_of(*three(s, "targets.")))


ONE_WINDOW = [windows_in_order, *(timed_by_one_window(n) for n in CHANNELS)]
C_NEVER_BRAKES = demands(6000, a=[(1000, EVER)], b=[(1000, EVER)], c=[])


@claim(CommonPart, symbolic=T_SYNC, expect=PROVED, lemmas=ONE_WINDOW, requirement="TS7-7",
       source="[P] 1.6; level rule [A]", witness=C_NEVER_BRAKES)  # fmt: skip
def silence_from_the_start_ends_in_isolation(s: Seen) -> Bit:
    """A silent channel that no open window has seen brake: somebody is isolated within one window and a frame."""
    return isolated_in_one_window(s, 1)


@claim(CommonPart, symbolic=T_SYNC, expect=REFUTED, requirement="TS7-7", scenario=C_NEVER_BRAKES,
       twin_of=silence_from_the_start_ends_in_isolation)  # fmt: skip
def silence_from_the_start_ends_in_isolation_a_frame_earlier(s: Seen) -> Bit:
    """A silent channel that no open window has seen brake: somebody is isolated within one window.  False: it takes a
    frame more."""
    return isolated_in_one_window(s, 0)


# --- a channel that brakes alone -----------------------------------------------------------------------------------


def alone(s: Seen, n: str) -> Bit:
    """Channel n brakes, the others do not and have not in an open window; all are in service."""
    others = any_of(*(s.brakes[m] | s.sync.window[f"seen_{m}"] for m in CHANNELS if m != n))
    return s.brakes[n] & ~others & ~any_of(*three(s, "isolated."))


def timed_alone(n: str) -> Formula:
    """Lemma: n has braked alone no longer than the window that will isolate it."""

    def lemma(s: Seen) -> Bit:
        y, t = s.sync, age(alone(s, n), MOST + 1).int()
        open_ = y.window.open & y.window[f"seen_{n}"] & (y.window.age + 1 >= t)
        return any_of(*three(y, "cut_")) | (t == 0) | open_

    return named(f"the lone brake of {n} is timed by its window", lemma)


def isolated_alone(s: Seen, n: str, spare: int) -> tuple[Bit, Bit]:
    """Premise: n has braked alone for T_sync and some spare frames; conclusion: it or one before it is isolated."""
    long = alone(s, n) & (age(alone(s, n), MOST + 1).int() + 1 >= s.sync.frames + spare)
    return long, s.targets[n] | any_of(*three(s.sync, "cut_"))


def lone_brakes_are_isolated(s: Seen, spare: int) -> Bit:
    """The same for each of the three channels."""
    cases = [isolated_alone(s, n, spare) for n in CHANNELS]
    return implies(any_of(*(long for long, _ in cases)), all_of(*(~long | ends for long, ends in cases)))


A_BRAKES_ALONE = demands(6000, a=[(1000, EVER)], b=[], c=[])


@claim(CommonPart, given=no_fault_found, symbolic=T_SYNC, expect=PROVED, requirement="TS7-1",
       lemmas=[windows_in_order, *(timed_alone(n) for n in CHANNELS)],
       source="[P] if they do not brake, the first is faulty and is cut off", witness=A_BRAKES_ALONE)  # fmt: skip
def a_lone_brake_is_isolated(s: Seen) -> Bit:
    """A channel that brakes alone is isolated within one window and a frame."""
    return lone_brakes_are_isolated(s, 1)


@claim(CommonPart, given=no_fault_found, symbolic=T_SYNC, expect=REFUTED, requirement="TS7-1", scenario=A_BRAKES_ALONE,
       twin_of=a_lone_brake_is_isolated)  # fmt: skip
def a_lone_brake_is_isolated_a_frame_earlier(s: Seen) -> Bit:
    """A channel that brakes alone is isolated within one window.  False: it takes a frame more."""
    return lone_brakes_are_isolated(s, 0)


# --- how low the brake can come without need -----------------------------------------------------------------------


def calm(n: str) -> Callable[[Seen], Bit]:
    """Lemma: a healthy channel n stays free of brake, fault and isolation, its relays up."""

    def lemma(s: Seen) -> Bit:
        check, relays, y = s[n].check, s.common[n], s.common.sync
        counted = 256 * check.count.int() + s[n].ring.j2.int() - 85 * check.frame.int()
        healthy = free_and_behind(s, n) & ~check.faulty & (counted >= 0) & (counted <= 255)
        up = relays.chr_relay.closed & relays.nbrr_relay.closed
        return faulty(s, n) | (healthy & up & ~any_of(y.window[f"first_{n}"], y.window[f"seen_{n}"], y[f"cut_{n}"]))

    return named(f"{n} stays free, in service and unseen", lemma)


def powered(s: Seen) -> Bit:
    """The inverter feeds the relays, NB is released."""
    return ~s.power.standby & s.common.nb_relay.closed


CALM = [powered, *(calm(n) for n in CHANNELS)]


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
    **{f"{n}.{register}": value for n in CHANNELS for register, value in {
        "offset": -4, "comparator.u": 2, "ring.j1": 150, "ring.j0": 255, "div0.n": 15}.items()},
    **{f"common.{n}.{relay}.closed": True for n in CHANNELS for relay in ("chr_relay", "nbrr_relay")},
}  # fmt: skip


@claim(Ts7, faults=at_most(1, "channel"), given=words_below(7), start=at_rest, anywhere=True, symbolic=OFFSETS,
       expect=REFUTED, requirement="TS7-9", twin_of=no_brake_eight_words_below, scenario=Scenario(
           3000, {**SIGNAL_65, "speed": PER_WORD * (138 - 7)}, AT_THE_EDGE, present=["a"]))  # fmt: skip
def no_brake_seven_words_below(s: Seen) -> Bit:
    """From rest: one channel, broken in any way, cannot bring NB while the speed stays 7 words below the limit.  False:
    a broken channel a opens a window, and b and c, lowered, brake."""
    return ~s.nb

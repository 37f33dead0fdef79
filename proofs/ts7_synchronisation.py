"""TS-7 synchronisation, frame by frame: windows, isolation, and who may be isolated.

One step is one frame, 125 us; speeds in words (1 word = 0.47124 km/h), lowering 4 words, T_sync 4000 frames (0.5 s).
In the claims about the common part alone the channels may do anything whatever: their demands are free inputs.
Source: the rule [P]; level rule, T_sync, two at once, relay times [A].

Main results: synchronisation isolates one channel at most, and a silent one within two windows (level rule; with the
edge rule never).
"""

from __future__ import annotations

from collections.abc import Callable

from models.ts7.voting import CommonPart, EdgeCommonPart
from safety import PROVED, REFUTED, Bit, Scenario, Seen, age, all_of, any_of, claim, count, implies, select

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
       source="[P] 1.6, gaps filled [R]", witness=Scenario(steps=3000, inputs={"supply": True, "b.drive": True,
       "c.drive": True, "a.drive": lambda k: k < 1000}))  # fmt: skip
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


@claim(CommonPart, given=no_fault_found, expect=REFUTED, requirement="TS7-10", steps=1, twin_of=a_pair_that_agrees_is_not_isolated,
       anywhere=True, start=lambda s: windows_in_order(s) & at_most_one_cut(s))  # fmt: skip
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
        first = y.window & braking & (y.age + 1 >= t)
        between = ~y.window & (t <= y.frames)
        second = y.window & braking & ~y[f"seen_{n}"] & (y.age + y.frames + 1 >= t)
        return any_of(*three(y, "cut_")) | (t == 0) | first | between | second

    lemma.__name__ = f"the silence of {n} is timed by windows"
    return lemma


SILENCE = [silence_is_timed(n) for n in "abc"]


def ends_in_isolation(s: Seen, windows: int, spare: int) -> Bit:
    """Whichever channel is silent: after so many windows and spare frames of it, somebody is isolated."""

    def long(n: str) -> Bit:
        return silent(s, n) & (age(silent(s, n), 2 * MOST + 2).int() + 1 >= windows * s.sync.frames + spare)

    return all_of(*(implies(long(n), any_of(*three(s, "targets."))) for n in "abc"))


def falls_silent(at: int) -> Scenario:
    """All run, all brake, then channel c does not."""
    demands = {"a.drive": lambda k: k < 1000, "b.drive": lambda k: k < 1000, "c.drive": lambda k: k < 1000 or k >= at}
    return Scenario(steps=at + 17_000, inputs={"supply": True, **demands})


@claim(CommonPart, symbolic=T_SYNC, expect=PROVED, lemmas=[windows_in_order, *SILENCE], requirement="TS7-7",
       source="[P] 1.6; level rule [A]", witness=falls_silent(2000))  # fmt: skip
def silence_ends_in_isolation(s: Seen) -> Bit:
    """While two channels brake and the third does not, somebody is isolated within two windows and a frame."""
    return ends_in_isolation(s, 2, 1)


@claim(CommonPart, symbolic=T_SYNC, expect=REFUTED, requirement="TS7-7", twin_of=silence_ends_in_isolation,
       scenario=Scenario(steps=20_000, start={"sync.frames": 4000}, inputs={"supply": True, "a.drive": lambda k: k < 1000,
       "b.drive": lambda k: k < 1002, "c.drive": lambda k: k < 1002 or k >= 1003 }))  # fmt: skip
def silence_ends_in_isolation_a_frame_earlier(s: Seen) -> Bit:
    """The time is exact: a window opens, the third brakes for one frame and falls silent; a second one is needed."""
    return ends_in_isolation(s, 2, 0)


@claim(EdgeCommonPart, symbolic=T_SYNC, expect=REFUTED, requirement="TS7-7", source="edge rule [A]",
       twin_of=silence_ends_in_isolation, scenario=falls_silent(2000))  # fmt: skip
def silence_ends_in_isolation_by_the_edge_rule(s: Seen) -> Bit:
    """Edge rule: a channel that falls silent while all three brake is never noticed; nobody starts to brake."""
    return ends_in_isolation(s, 2, 1)

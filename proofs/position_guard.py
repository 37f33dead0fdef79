"""One balise lost, or one too many: with the guard the decoder never reads a wrong code or a wrong origin.

What is proved is about any group that is no longer than W, so about all codes at once, about any real place of the
extra balise, before, within or behind the group, any jitter and any scale error; by induction over the equipment.  That
such a group is read as its true code is shown in `position_reading`.
Source: AP-6, AP-7; five balises of a kind of their own [P]; COLLECT, GUARD, DECIDE [A].

Main results: no premise about the span check is needed, the guard alone does it: the group's own balises keep its
window or its guard busy, so an extra one near it makes six or hits the guard.  Without the guard {5, 12, 30} with a
balise 10 m before it reads {10, 15, 22}; a loss together with an insertion turns it into {5, 17, 30}, guard or not.
"""

from __future__ import annotations

from fractions import Fraction

from models.position.passing import Passing, ThinnedPassing, UnguardedPassing
from safety import PROVED, REFUTED, Bit, Scenario, Seen, claim, implies, once, select

FIVE = 5
SOURCE = "[A] guard of W after the last balise"


def one_fault(s: Seen) -> Bit:
    """a balise is lost or one is too many, not both, nor two"""
    return ~(s.seen.extra & (s.strange | s.lost))


def no_fault(s: Seen) -> Bit:
    """no balise is lost or too many"""
    return ~s.seen.extra & ~s.lost


def more_to_come(s: Seen) -> Bit:
    """Balises of the group are still ahead."""
    return s.own + s.lost.word() < FIVE


def same_spots(s: Seen) -> Bit:
    """The decoder has the group's balises where they are."""
    group, own = s.decoder.group, s.own
    first = (group.since_first == s.first) & ((own < 2) | (group.a == s.a)) & ((own < 3) | (group.b == s.b))
    return first & ((own < 4) | (group.c == s.c)) & ((own < FIVE) | (group.last == s.last))


def spoilt(s: Seen) -> Bit:
    """The extra balise is among those of the group, which will be rejected."""
    group = s.decoder.group
    return s.strange & (group.count > 0) & ((group.count > s.own) | group.hit) & (group.since_last <= s.first)


def collected(s: Seen) -> Bit:
    """The decoder has either just the group, or a group that it will reject, or nothing of it any more."""
    group = s.decoder.group
    pure = (group.count == s.own) & ~group.hit & same_spots(s) & (group.since_last <= s.first)
    over = ~more_to_come(s) & ((group.count == 0) | (s.strange & (group.count <= 1) & ~group.hit))
    before = (group.count <= s.strange.word()) & ~group.hit
    sound = (s.first >= 0) & (s.own + s.lost.word() <= FIVE) & (group.count <= 6) & ~(s.lost & s.strange)
    return sound & select(s.own == 0, before, pure | spoilt(s) | over)


def true_reading(s: Seen) -> Bit:
    """What is accepted are the five balises of the group, and the origin is its first one."""
    right = same_spots(s) & (s.own == FIVE) & (s.reading.origin == s.since_first)
    return implies(s.reading.accepted, right)


BEFORE_IT = Scenario(6, {
    "seen.run": lambda k: (0, 10, 5, 7, 18, 10)[k], "seen.extra": lambda k: k == 0, "seen.own": lambda k: k > 0,
})  # fmt: skip
REPLACED = Scenario(6, {
    "seen.run": lambda k: (0, 5, 12, 13, 10, 41)[k], "seen.extra": lambda k: k == 2,
    "seen.own": lambda k: k in (0, 1, 3, 4),
}, start={"lost": True})  # fmt: skip


@claim(Passing, expect=PROVED, given=one_fault, lemmas=[collected], requirement="AP-6", source=SOURCE)
def one_fault_is_never_read(s: Seen) -> Bit:
    """With one balise lost, or one too many at any place, what is accepted are the five balises of the group where they
    are, and the origin is its first one."""
    return true_reading(s)


@claim(UnguardedPassing, expect=REFUTED, given=one_fault, requirement="AP-6", twin_of=one_fault_is_never_read,
       source="[A] variant without the guard", defeat=True,
       scenario=BEFORE_IT)  # fmt: skip
def one_fault_is_never_read_unguarded(s: Seen) -> Bit:
    """Without the guard too.  False: a balise 10 m before {5, 12, 30} takes the place of the first one, the window
    closes before the last one, and {10, 15, 22} is read."""
    return true_reading(s)


@claim(Passing, expect=REFUTED, requirement="AP-7", twin_of=one_fault_is_never_read, defeat=True,
       source="[P] 9,139 combinations: no code is spare", scenario=REPLACED)  # fmt: skip
def two_faults_are_never_read(s: Seen) -> Bit:
    """With one balise lost and one too many too.  False: {5, 12, 30} without its middle one, and another one on slot
    17, reads {5, 17, 30}."""
    return true_reading(s)


NEAR = tuple(Fraction(run) * Fraction("0.99") for run in ("0", "0.9", "2", "22.9", "15.1", "42"))


@claim(ThinnedPassing, expect=REFUTED, requirement="AP-7", twin_of=one_fault_is_never_read, defeat=True,
       source="[A] span check for a scale error of 1 %",
       scenario=Scenario(6, {
           "seen.run": lambda k: NEAR[k], "seen.extra": lambda k: k == 0, "seen.own": lambda k: 0 < k < 5,
       }, start={"lost": True}))  # fmt: skip
def two_faults_are_never_read_of_247_codes(s: Seen) -> Bit:
    """With 247 codes of which two share one slot at most, neither with one lost and one too many.  False at a scale
    error of 1 %: the span check passes a span of 40.9 m, and {2, 25, 32} without its last inner balise, another one
    0.9 m before it and 0.1 m of jitter, reads {1, 3, 25}."""
    return true_reading(s)


# --- near the group it is rejected -----------------------------------------------------------------------------------


def comes_near(s: Seen) -> Bit:
    """The extra balise and one of the group come within W of each other."""
    within = s.decoder.group.since_last + s.seen.run <= s.window
    return within & ((s.seen.extra & (s.own > 0)) | (s.seen.own & (s.own == 0) & s.strange))


def closed_means_free(s: Seen) -> Bit:
    """Where the decoder has nothing of what came, W is free behind it."""
    closed = (s.decoder.group.count == 0) & ((s.own > 0) | s.strange)
    return implies(closed, s.decoder.group.since_last > s.window)


def near_means_spoilt(s: Seen) -> Bit:
    """Once it has come near, the group is spoilt or over."""
    gone = ~more_to_come(s) & (s.own > 0) & (s.decoder.group.count == 0)
    return implies(once(comes_near(s)), s.strange & (s.own > 0) & (spoilt(s) | gone))


@claim(Passing, expect=PROVED, given=one_fault, lemmas=[collected, closed_means_free, near_means_spoilt],
       requirement="AP-6", source=SOURCE, steps=8)  # fmt: skip
def extra_near_the_group_is_rejected(s: Seen) -> Bit:
    """Once the extra balise and a balise of the group have come within W of each other, nothing is accepted."""
    return implies(once(comes_near(s)), ~s.reading.accepted)


@claim(UnguardedPassing, expect=REFUTED, given=one_fault, requirement="AP-6", scenario=BEFORE_IT,
       twin_of=extra_near_the_group_is_rejected, source="[A] variant without the guard")  # fmt: skip
def extra_near_the_group_is_rejected_unguarded(s: Seen) -> Bit:
    """So it is without the guard.  False: 10 m before {5, 12, 30}."""
    return extra_near_the_group_is_rejected(s)


@claim(Passing, expect=PROVED, given=one_fault, lemmas=[collected], requirement="AP-6", source=SOURCE)
def four_are_rejected(s: Seen) -> Bit:
    """With one balise lost nothing is accepted."""
    return implies(s.lost, ~s.reading.accepted)


@claim(Passing, expect=REFUTED, requirement="AP-6", scenario=REPLACED, twin_of=four_are_rejected)
def four_and_a_strange_one_are_rejected(s: Seen) -> Bit:
    """So it is where another one stands in the place of the lost one.  False: they are five."""
    return four_are_rejected(s)


def nothing_strange(s: Seen) -> Bit:
    """No balise was too many."""
    return ~s.strange


@claim(Passing, expect=PROVED, given=no_fault, lemmas=[collected, nothing_strange], requirement="AP-5",
       source=SOURCE, steps=8)  # fmt: skip
def a_true_group_is_collected(s: Seen) -> Bit:
    """Without a fault the decoder decides with the five balises of the group where they are, the guard not hit."""
    group = s.decoder.group
    five = (group.count == FIVE) & (s.own == FIVE) & same_spots(s) & ~group.hit
    return implies(s.reading.accepted | s.reading.rejected, five)


@claim(Passing, expect=REFUTED, given=no_fault, requirement="AP-5", twin_of=a_true_group_is_collected, steps=7)
def a_true_group_is_never_decided(s: Seen) -> Bit:
    """Without a fault the decoder decides nothing.  False: it does, W behind the last balise."""
    return ~(s.reading.accepted | s.reading.rejected)

"""From the code to the fix: a group that is read as itself puts the train where it is, in either direction.

Source: AP-5, AP-8; installed codes, places, numbers [A].

Main results: the fix holds the train within e + eps times the way since the group's first balise; the direction is told
as soon as no code is installed with its mirror image.  That a true group is read as itself is `position_reading`.
"""

from __future__ import annotations

from fractions import Fraction

from models.position.told import Telling, UndirectedTelling
from safety import PROVED, REFUTED, Bit, Seen, claim, implies

JITTER, SCALE = Fraction(1, 10), Fraction(1, 100)
SOURCE = "[P] codes checked against those installed; [A] places"


def own_reading(s: Seen) -> Bit:
    """what is accepted is the group's code, for the direction"""
    return implies(s.reading.accepted, s.own)


def counted(s: Seen) -> Bit:
    """the first balise detected within 0.10 m, the way since counted within 1 %"""
    off, origin = s.ran.way - s.reading.origin, s.reading.origin
    way = (s.ran.way >= 0) & (origin >= 0) & (off <= SCALE * origin) & (-off <= SCALE * origin)
    return way & (s.ran.jitter <= JITTER) & (-s.ran.jitter <= JITTER)


def both(s: Seen) -> Bit:
    """what is accepted is the group's code, for the direction; the first balise detected within 0.10 m, the way since
    counted within 1 %"""
    return own_reading(s) & counted(s)


def true_fix(s: Seen) -> Bit:
    """What is told holds the train."""
    fix = s.told.fix
    return implies(fix.given, (fix.low <= s.head) & (s.head <= fix.high) & (fix.low <= fix.place))


def true_direction(s: Seen) -> Bit:
    """What is told is the direction."""
    return implies(s.told.fix.given, s.told.rising == s.ran.rising)


@claim(Telling, expect=PROVED, given=both, requirement="AP-5", source=SOURCE)
def a_group_puts_the_train_where_it_is(s: Seen) -> Bit:
    """The fix from an installed group holds the head of the train, in either direction."""
    return true_fix(s)


@claim(Telling, expect=PROVED, given=own_reading, requirement="AP-8", source=SOURCE)
def a_group_tells_the_direction(s: Seen) -> Bit:
    """The direction told is that in which the group was passed."""
    return true_direction(s)


@claim(Telling, expect=REFUTED, given=own_reading, requirement="AP-5", twin_of=a_group_puts_the_train_where_it_is)
def a_group_with_any_count(s: Seen) -> Bit:
    """The fix holds the train however the way since is counted.  False."""
    return true_fix(s)


@claim(Telling, expect=REFUTED, given=counted, requirement="AP-7", twin_of=a_group_puts_the_train_where_it_is,
       defeat=True)  # fmt: skip
def a_group_read_as_another(s: Seen) -> Bit:
    """The fix holds the train when a group can be read as another one.  False: it is put to that one."""
    return true_fix(s)


@claim(UndirectedTelling, expect=REFUTED, given=both, requirement="AP-8", twin_of=a_group_tells_the_direction,
       defeat=True)  # fmt: skip
def a_mirrored_code_tells_the_direction(s: Seen) -> Bit:
    """The same with a code installed beside its mirror image.  False: {10, 28, 35} passed backwards reads {5, 12,
    30}."""
    return true_direction(s)


@claim(UndirectedTelling, expect=REFUTED, given=both, requirement="AP-8", twin_of=a_group_puts_the_train_where_it_is)
def a_mirrored_code_puts_the_train_where_it_is(s: Seen) -> Bit:
    """The fix holds the train with a code installed beside its mirror image.  False: it is 29 km off."""
    return true_fix(s)

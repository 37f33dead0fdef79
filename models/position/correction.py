"""Correction at every balise: a balise that is seen is looked up in the line data around the estimated position.

    one of its kind within w = max(5 m, s_hi - s_lo + 2e)   the train is there: position := its place, interval := +-e
    none                                                    keep; two in succession: the position is unknown
    more than one                                           keep, the interval widened by e on both sides [A]
    expected, and s_lo has passed it by w                   missed; two in succession: the position is unknown

An unknown position stays so until a code tells it.  A balise is dealt with as of its detection, anywhere in a cycle
(`locator`).  The line data are four balises here: what is claimed of them holds for any kinds and places that the
spacing admits.
Source: correction at every balise [P]; the rules and numbers [A].
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from models.kinematics import nearest
from models.position.odometer import Fix, larger, smaller, step_s
from safety import U2, Bit, Model, Real, all_of, any_of, at_least, count, parameter, point, power_up, require, select

SIGNAL, RELEASE, REFERENCE, BRANCH = range(4)  # kinds of balises
PLACES = "[A] line data, in running order"
KINDS = "[A] 0 signal, 1 release, 2 reference, 3 branch"


class Where(NamedTuple):
    """The position as estimated, surely between `low` and `high`, m."""

    low: Real
    guess: Real
    high: Real

    def within(self) -> Where:
        """The estimate brought into the interval: where a slide is misjudged, it can have left it."""
        return Where(self.low, larger(self.low, smaller(self.guess, self.high)), self.high)


class Ahead(NamedTuple):
    """One wire for each balise of the line data, in running order."""

    a: Bit
    b: Bit
    c: Bit
    d: Bit


class Entry(NamedTuple):
    """A balise of the line data."""

    place: Real
    kind: U2


class Entries(NamedTuple):
    """Four balises in running order."""

    a: Entry
    b: Entry
    c: Entry
    d: Entry

    def one_of(self, which: Ahead) -> Entry:
        """The entry that is marked."""
        place, kind = self.d
        for here, each in zip(which[:3], self[:3], strict=True):
            place, kind = select(here, each.place, place), select(here, each.kind, kind)
        return Entry(place, kind)


class Matched(NamedTuple):
    """What a balise, or its absence, tells; `fix` is for the odometer, before its next cycle."""

    fix: Fix
    reliable: Bit  # the position may be relied on; else the most restrictive pattern
    adopted: Bit
    doubtful: Bit  # more than one candidate
    unlisted: Bit  # no candidate
    absent: Bit  # one or more expected balises given up


class LineData(Model, tick_s=step_s):
    """The stored balises."""

    place_a: Real = parameter(1000, unit="m", within=(0, 100_000), source=PLACES)
    place_b: Real = parameter(2000, unit="m", within=(0, 100_000), source=PLACES)
    place_c: Real = parameter(3000, unit="m", within=(0, 100_000), source=PLACES)
    place_d: Real = parameter(4000, unit="m", within=(0, 100_000), source=PLACES)
    kind_a: U2 = parameter(SIGNAL, unit="kind", within=(0, 3), source=KINDS)
    kind_b: U2 = parameter(SIGNAL, unit="kind", within=(0, 3), source=KINDS)
    kind_c: U2 = parameter(SIGNAL, unit="kind", within=(0, 3), source=KINDS)
    kind_d: U2 = parameter(SIGNAL, unit="kind", within=(0, 3), source=KINDS)

    def step(self) -> tuple[LineData, Entries]:
        """What is read out."""
        stored = zip("abcd", self.stored(), strict=True)
        read = (Entry(point(f"at_{n}", each.place), point(f"is_{n}", each.kind)) for n, each in stored)
        return type(self)(), Entries(*read)

    def stored(self) -> Entries:
        """The entries as they are stored."""
        places = (self.place_a, self.place_b, self.place_c, self.place_d)
        kinds = (self.kind_a, self.kind_b, self.kind_c, self.kind_d)
        return Entries(*map(Entry, places, kinds))


class Expected(Model, tick_s=step_s):
    """Which balises are still ahead of the train."""

    past_a: Bit = power_up(False)
    past_b: Bit = power_up(False)
    past_c: Bit = power_up(False)
    past_d: Bit = power_up(False)

    def step(self, late: Ahead, fixed: Bit, place: Real, entries: Entries) -> Expected:
        """Those given up are no longer expected; after a fix it is those at its place or behind it."""
        past = (self.past_a, self.past_b, self.past_c, self.past_d)
        a, b, c, d = (
            select(fixed, each.place <= place, was | gone) for each, was, gone in zip(entries, past, late, strict=True)
        )
        return type(self)(past_a=a, past_b=b, past_c=c, past_d=d)

    def ahead(self) -> Ahead:
        """What is still expected."""
        return Ahead(~self.past_a, ~self.past_b, ~self.past_c, ~self.past_d)


class Tally(Model, tick_s=step_s):
    """Whether the position may be relied on: not after two unmatched, or two missed, balises in succession."""

    known: Bit = power_up(False)
    unmatched: U2 = power_up(0)
    missed: U2 = power_up(0)

    def step(self, fixed: Bit, by_code: Bit, unlisted: Bit, late: Ahead) -> tuple[Tally, Bit]:
        """A fix of any kind; one by a code; a balise without a match; expected ones given up."""
        unmatched = select(fixed, 0, (self.unmatched + unlisted.word()).sat(2))
        missed = select(fixed, 0, (self.missed + count(*late)).sat(2))
        known = by_code | (self.known & (unmatched < 2) & (missed < 2))
        return type(self)(known=known, unmatched=unmatched, missed=missed), known


class CorrectionData(Model):
    """What a correction works with."""

    jitter: Real = parameter(Fraction("0.1"), unit="m", within=(0, 1), source="[A] e, of the detection of a balise")
    least: Real = parameter(5, unit="m", within=(0, 100), source="[A] least window")
    widest: Real = parameter(20, unit="m", within=(0, 200), source="[D] interval after 1 km at 1 %")

    def check(self, stored: Entries, least: Real) -> None:
        """Refuse line data in which the search for a balise can find two."""
        require("balises in running order, those of one kind more than 2w apart", spaced(stored, least),
                nearest("spacing", least, "m", side="any above"))  # fmt: skip

    def window(self, width: Real) -> Real:
        """w, m, of an interval so wide."""
        return larger(self.least, width + 2 * self.jitter)


class Correction(CorrectionData, tick_s=step_s):
    """Matching of balises with the line data."""

    data: LineData
    expected: Expected
    tally: Tally

    def step(self, seen: Bit, kind: U2, at: Where, code: Fix) -> tuple[Correction, Matched]:
        """A balise of a kind, if `seen`; the position at that instant; what a code tells, if it does."""
        self.check(self.data.stored(), 2 * self.window(self.widest))
        (data, entries), at = self.data.step(), at.within()
        looks, window = self.tally.known & point("seen", seen) & ~code.given, self.window(at.high - at.low)
        near = Ahead(*(looks & (each.kind == kind) & within(each.place, at.guess, window) for each in entries))
        none, many = looks & ~any_of(*near), at_least(2, *near)
        adopted = any_of(*near) & ~many
        fix = self.found(chosen(near, entries), adopted, many, at, code)
        fixed, ahead = adopted | code.given, self.expected.ahead()
        late = Ahead(*(is_late(e & ~fixed, at, each.place + window) for e, each in zip(ahead, entries, strict=True)))
        tally, reliable = self.tally.step(fixed, code.given, none, late)
        expected = self.expected.step(late, fixed, fix.place, entries)
        following = type(self)(data=data, expected=expected, tally=tally)
        return following, Matched(fix, reliable, adopted, many, none, any_of(*late))

    def found(self, place: Real, adopted: Bit, many: Bit, at: Where, code: Fix) -> Fix:
        """The place with its own uncertainty; with more than one candidate the interval as it was, widened."""
        e = self.jitter
        low, high = select(adopted, place, at.low) - e, select(adopted, place, at.high) + e
        guess, given = select(adopted, place, at.guess), adopted | many
        c = code.given
        return Fix(given | c, select(c, code.low, low), select(c, code.place, guess), select(c, code.high, high))


class Crowded(Correction, tick_s=step_s):
    """The same with any line data, to show what the spacing is for."""

    def check(self, stored: Entries, least: Real) -> None:
        """Refuse nothing."""


def within(place: Real, guess: Real, window: Real) -> Bit:
    """Whether a place lies in the window around the estimate, its ends included."""
    return (place - guess <= window) & (guess - place <= window)


def chosen(near: Ahead, entries: Entries) -> Real:
    """The place of the candidate; of the first one where there are more."""
    place = entries.d.place
    for here, each in zip(near[2::-1], entries[2::-1], strict=True):
        place = select(here, each.place, place)
    return place


def is_late(expected: Bit, at: Where, place: Real) -> Bit:
    """Whether the train has surely passed a place at which something is expected."""
    return expected & (at.low > place)


def spaced(entries: Entries, least: Real) -> Bit:
    """Whether balises stand in running order, those of one kind more than so far apart."""
    pairs = [(x, y) for k, y in enumerate(entries) for x in entries[:k]]
    return all_of(*((x.place < y.place) & ((x.kind != y.kind) | (y.place - x.place > least)) for x, y in pairs))

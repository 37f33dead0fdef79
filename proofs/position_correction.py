"""Correction at balises: the balise that is matched is the right one, and when that is so.

The true position, the estimate and the interval are anything; the balise that is seen is one of the line data, or not.
Source: AP-4; correction at every balise [P]; w = max(5 m, interval + 2e), rules [A].

Main results: as long as the interval holds the train, a match is right whatever the spacing, because the true balise is
always a candidate and only a single one is adopted.  When the interval has lost the train, an error below half the
spacing is enough, since then the true balise is the nearest.  A spacing above 2w is what makes each listed balise a
match.  A balise that is not in the line data moves the train wrongly.  w = interval + e would do.
"""

from __future__ import annotations

from fractions import Fraction

from models.position.sighting import CrowdedSighting, Sighting
from proofs.premises import together
from safety import PROVED, REFUTED, Bit, Real, Seen, all_of, claim, count, implies, since
from safety.prove.bounds import Bound, between, magnitude, reals
from safety.prove.weakest import ABOVE, weakest_real

NAMES = "abcd"
OPEN = tuple(f"correction.data.{what}_{n}" for what in ("place", "kind") for n in NAMES)
JITTER = Fraction(1, 10)  # m
RULES = "[A] rules of correction; [P] at every balise"


# --- premises --------------------------------------------------------------------------------------------------------


def listed(s: Seen) -> Bit:
    """the balise that is seen is in the line data, of the kind that it shows, and seen within 0.1 m of its place"""
    here = (s.sight.kind == s.kind_of) & (s.sight.head - s.place <= JITTER) & (s.place - s.sight.head <= JITTER)
    return implies(s.sight.seen, here & (count(*(s.sight.which[n] for n in NAMES)) == 1))


def holds(s: Seen) -> Bit:
    """the interval holds the train"""
    return (s.at.low <= s.sight.head) & (s.sight.head <= s.at.high)


def holds_estimate(s: Seen) -> Bit:
    """the interval holds the estimate"""
    return (s.at.low <= s.at.guess) & (s.at.guess <= s.at.high)


def narrow(s: Seen) -> Bit:
    """the interval is no wider than the line is laid out for, 20 m"""
    return s.at.high - s.at.low <= 20


def near_enough(s: Seen) -> Bit:
    """the estimate is off the balise by less than half of its distance to any other one of its kind"""
    off = s.at.guess - s.place
    return all_of(*(rivals_off(s, n) | half_way(s.correction.data[n].place - s.place, off) for n in NAMES))


def rivals_off(s: Seen, n: str) -> Bit:
    """The entry is of another kind, or the balise itself."""
    return (s.correction.data[n].kind != s.kind_of) | s.sight.which[n]


def half_way(apart: Real, off: Real) -> Bit:
    """Whether twice the distance either way is less than that of two balises."""
    return implies(apart > 0, (2 * off < apart) & (-2 * off < apart)) & implies(
        apart <= 0, (2 * off < -apart) & (-2 * off < -apart)
    )


# --- the match is the right one --------------------------------------------------------------------------------------


def right(s: Seen) -> Bit:
    """What is adopted is the place of the balise that is seen, and the new interval holds the train."""
    fix, head = s.matched.fix, s.sight.head
    inside = (fix.low <= head) & (head <= fix.high)
    return implies(s.matched.adopted, (fix.place == s.place) & inside)


@claim(CrowdedSighting, expect=PROVED, symbolic=OPEN, given=together(listed, holds), anywhere=True, requirement="AP-4",
       source=RULES, steps=4)  # fmt: skip
def a_match_is_right_while_the_interval_holds(s: Seen) -> Bit:
    """While the interval holds the train, what is adopted is the balise that is seen, for any line data, however near
    each other balises stand."""
    return right(s)


@claim(CrowdedSighting, expect=PROVED, symbolic=OPEN, anywhere=True,
       given=together(listed, near_enough, holds_estimate),
       requirement="AP-4", source=RULES, steps=4)  # fmt: skip
def a_match_is_right_within_half_the_spacing(s: Seen) -> Bit:
    """With an error below half the spacing of balises of a kind, what is adopted is the balise that is seen, even where
    the interval has lost the train, for any line data."""
    return right(s)


@claim(Sighting, expect=REFUTED, given=together(listed, narrow), anywhere=True, requirement="AP-4", steps=2,
       defeat=True, twin_of=a_match_is_right_within_half_the_spacing)  # fmt: skip
def a_match_is_right_whatever_the_error(s: Seen) -> Bit:
    """What is adopted is the balise that is seen, whatever the error.  False: creep or a slide can put the estimate to
    the next one."""
    return right(s)


@claim(Sighting, expect=REFUTED, given=together(holds, narrow), anywhere=True, requirement="AP-4", steps=2, defeat=True,
       twin_of=a_match_is_right_while_the_interval_holds)  # fmt: skip
def an_unlisted_balise_is_matched_rightly(s: Seen) -> Bit:
    """What is adopted holds the train whatever is seen.  False: one that is not listed passes for its neighbour."""
    return implies(s.matched.adopted, (s.matched.fix.low <= s.sight.head) & (s.sight.head <= s.matched.fix.high))


# --- there is a match ------------------------------------------------------------------------------------------------


def looked_for(s: Seen) -> Bit:
    """A balise is seen, the position is known, no code comes."""
    return s.sight.seen & s.correction.tally.known & ~s.code.given


@claim(Sighting, expect=PROVED, symbolic=OPEN, given=together(listed, holds, narrow), anywhere=True, requirement="AP-4",
       source=RULES, steps=4)  # fmt: skip
def a_listed_balise_is_matched(s: Seen) -> Bit:
    """With the interval holding the train, no wider than laid out for, each listed balise that is seen is adopted."""
    return implies(looked_for(s), s.matched.adopted)


@claim(CrowdedSighting, expect=REFUTED, symbolic=OPEN, given=together(listed, holds, narrow), anywhere=True, steps=2,
       requirement="AP-4", twin_of=a_listed_balise_is_matched)  # fmt: skip
def a_listed_balise_is_matched_in_a_crowd(s: Seen) -> Bit:
    """Also with balises of a kind nearer than 2w.  False: there are two candidates, and none is adopted."""
    return a_listed_balise_is_matched(s)


# --- two in succession make the position unknown ---------------------------------------------------------------------


def fixed(s: Seen) -> Bit:
    """A balise has been adopted, or a code has come."""
    return s.matched.adopted | s.code.given


def counted(s: Seen) -> Bit:
    """What has happened since the last fix has been counted."""
    tally = s.correction.tally
    once_missed = implies(since(s.matched.absent & ~fixed(s), ~fixed(s)), tally.missed >= 1)
    return once_missed & implies(since(s.matched.unlisted, ~fixed(s)), tally.unmatched >= 1)


@claim(Sighting, expect=PROVED, lemmas=[counted], requirement="AP-4", source=RULES, steps=8)
def two_in_succession_make_it_unknown(s: Seen) -> Bit:
    """Two expected balises given up, or two balises without a match, with no fix in between: the position is not relied
    on."""
    missed = since(s.matched.absent & ~fixed(s), ~fixed(s)) & s.matched.absent
    unmatched = since(s.matched.unlisted, ~fixed(s)) & s.matched.unlisted
    return implies((missed | unmatched) & ~fixed(s), ~s.matched.reliable)


@claim(Sighting, expect=REFUTED, requirement="AP-4", twin_of=two_in_succession_make_it_unknown, steps=4)
def one_makes_it_unknown(s: Seen) -> Bit:
    """One expected balise given up is enough.  False: the second one counts."""
    return implies(s.matched.absent & ~fixed(s), ~s.matched.reliable)


@claim(Sighting, expect=PROVED, requirement="AP-4", source=RULES, steps=8)
def only_a_code_makes_it_known(s: Seen) -> Bit:
    """A position that is not relied on comes to be relied on by a code only."""
    return implies(~s.correction.tally.known & s.matched.reliable, s.code.given)


@claim(Sighting, expect=REFUTED, requirement="AP-4", twin_of=only_a_code_makes_it_known, steps=2)
def nothing_makes_it_known(s: Seen) -> Bit:
    """A position that is not relied on is never relied on again.  False: a code tells it."""
    return implies(~s.correction.tally.known, ~s.matched.reliable)


# --- window and spacing ----------------------------------------------------------------------------------------------

WIDTH = 20  # m, after 1 km at 1 %
w, spacing, estimate = reals("w spacing estimate")
OFF = (between(-(WIDTH + JITTER), estimate, WIDTH + JITTER),)  # of the estimate from the balise that is seen
AT = {"interval": "20 m", "e": "0.10 m"}

weakest_real(
    Bound(
        "position_correction.window", "What the window lacks to take in the balise that is seen",
        magnitude(estimate) - w, (*OFF, between(0, w, 40)), unit="m", requirement="AP-4", source=RULES,
        assumed=("[A] interval 20 m, e = 0.10 m",),
    ),
    0, w, safe=ABOVE, within=(0, 40), gap=Fraction(1, 1000), id="position_correction.least_window", unit="m", at=AT,
)  # fmt: skip

TAKEN = WIDTH + 2 * JITTER  # w as specified, m
weakest_real(
    Bound(
        "position_correction.spacing", "What two balises of a kind lack to be never candidates at once",
        2 * TAKEN - magnitude(spacing - estimate) - magnitude(estimate),
        (between(-TAKEN, estimate, TAKEN), between(0, spacing, 100)),
        unit="m", requirement="AP-4", source=RULES, assumed=("[A] interval 20 m, e = 0.10 m",),
    ),
    0, spacing, safe=ABOVE, within=(0, 100), gap=Fraction(1, 1000), id="position_correction.least_spacing", unit="m",
    at=AT,
)  # fmt: skip

"""Reading the code: how far jitter and scale error may go, over all real values.

Normalised by its own span a group loses its scale error: what is left of an inner balise is at most 2e slots, for
every slot, every jitter up to e, in true metres, and every scale.
Source: AP-5; L = 40 m, u = 1 m, u_tol = 0.25 slot [A].

Main results: 2e is reached, so e below 0.125 m is enough and needed; the decoder reads every true group as its code,
up to e = 0.1249 m.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from models.position.code import SLOTS, SPAN
from models.position.passing import ENDS, TrueGroup
from safety import PROVED, REFUTED, Bit, Real, Seen, all_of, claim, implies
from safety.prove.bounds import Bound, between, claim_bracket, magnitude, reals
from safety.prove.laws import law

ASSUMED = ("[A] L = 40 m, 39 slots of 1 m",)
JITTER, SCALE, HALF = Fraction(1, 10), Fraction(1, 100), Fraction(1, 2)
EIGHTH = Fraction("0.1249")  # m, just below u_tol / 2


def within(e: Real, *jitters: Real) -> Bit:
    """Jitter of so many balises, at most e."""
    return all_of(*((j <= e) & (-e <= j) for j in jitters))


@law(expect=PROVED, requirement="AP-5", source="[D] normalised by the span", assumed=ASSUMED)
def reading_is_within_2e(t: Real, e: Real, first: Real, j: Real, last: Real) -> Bit:
    """A balise at 1 to 39 slots, anywhere there, reads within 2e slots of its place, for all jitter up to e, e being at
    most half a slot."""
    spot, span = t + j - first, SPAN + last - first
    known = (t >= 1) & (t <= SLOTS) & (e >= 0) & (e <= HALF) & within(e, first, j, last)
    return implies(known, (spot * SPAN - span * t <= 2 * e * span) & (span * t - spot * SPAN <= 2 * e * span))


@law(expect=PROVED, requirement="AP-5", source="[D] normalised by the span", assumed=ASSUMED)
def scale_cancels(scale: Real, t: Real, u: Real, spot: Real, span: Real) -> Bit:
    """Within u slots or not: the same with every distance multiplied by a scale above 0."""
    off, scaled = spot * SPAN - span * t - u * span, scale * (spot * SPAN - span * t - u * span)
    return implies(scale > 0, (off <= 0) == (scaled <= 0))


@law(expect=REFUTED, requirement="AP-5", twin_of=reading_is_within_2e)
def reading_is_nearer_than_2e(t: Real, e: Real, first: Real, j: Real, last: Real) -> Bit:
    """Nearer than 2e slots.  False: 2e is reached, first and last balise both e on one side, the inner one on the
    other."""
    spot, span = t + j - first, SPAN + last - first
    known = (t >= 1) & (t <= SLOTS) & (e <= HALF) & (e > 0) & within(e, first, j, last)
    return implies(known, (spot * SPAN - span * t < 2 * e * span) & (span * t - spot * SPAN < 2 * e * span))


@law(expect=REFUTED, requirement="AP-5", twin_of=reading_is_within_2e)
def reading_is_within_2e_of_any_jitter(t: Real, e: Real, first: Real, j: Real, last: Real) -> Bit:
    """Within 2e slots however large e.  False above half a slot: the span shrinks too much."""
    spot, span = t + j - first, SPAN + last - first
    known = (t >= 1) & (t <= SLOTS) & (2 * e < SPAN) & within(e, first, j, last)
    return implies(known, (spot * SPAN - span * t <= 2 * e * span) & (span * t - spot * SPAN <= 2 * e * span))


t, j, first, last = reals("t j first last")
JITTERED = tuple(between(-JITTER, each, JITTER) for each in (j, first, last))
claim_bracket(
    Bound(
        "position_reading.error_of_a_slot",
        "Error of a normalised slot at e = 0.10 m, any scale",
        magnitude((t + j - first) * SPAN - (SPAN + last - first) * t),
        (*JITTERED, between(1, t, SLOTS)),
        per=SPAN + last - first,
        whole=(t,),
        unit="slot",
        requirement="AP-5",
        source="[D] 2e",
        assumed=(*ASSUMED, "[A] e = 0.10 m"),
    )
)


# --- the decoder itself ----------------------------------------------------------------------------------------------


def a_true_group(s: Seen) -> Bit:
    """Five balises of a code collected, any scale within 1 %, any jitter up to 0.10 m"""
    return group_within(s, JITTER, SCALE)


def almost_an_eighth(s: Seen) -> Bit:
    """Five balises of a code collected, any scale within 1 %, any jitter up to 0.1249 m"""
    return group_within(s, EIGHTH, SCALE)


def with_more_jitter(s: Seen) -> Bit:
    """Five balises of a code collected, any scale within 1 %, any jitter up to 0.126 m"""
    return group_within(s, Fraction("0.126"), SCALE)


def with_more_scale_error(s: Seen) -> Bit:
    """Five balises of a code collected, any scale within 1.1 %, any jitter up to 0.10 m"""
    return group_within(s, JITTER, Fraction("0.011"))


def group_within(s: Seen, jitter: Fraction, scale: Fraction) -> Bit:
    """Five balises of a code collected, so much jitter and scale error."""
    group, spots, e = s.decoder.group, s.spots, jitter * s.scale
    near = all_of(*((s[f"jitter_{n}"] <= e) & (-e <= s[f"jitter_{n}"]) for n in ENDS))
    scaled = (s.scale >= 1 - scale) & (s.scale <= 1 + scale)
    code = (s.p >= 1) & (s.p < s.q) & (s.q < s.r) & (s.r <= SLOTS)
    same = (group.a == spots.a) & (group.b == spots.b) & (group.c == spots.c) & (group.last == spots.last)
    return near & scaled & code & same & (group.count == 5) & ~group.hit & (s.run >= 0) & (group.since_last >= 0)


def true_balise(name: str, spot: str) -> Callable[[Seen], Bit]:
    """What the slot of one inner balise needs of a true group: both ends and this balise, collected as they stand."""

    def given(s: Seen) -> Bit:
        group, spots, e = s.decoder.group, s.spots, JITTER * s.scale
        near = all_of(*((s[f"jitter_{n}"] <= e) & (-e <= s[f"jitter_{n}"]) for n in ("first", name, "last")))
        scaled = (s.scale >= 1 - SCALE) & (s.scale <= 1 + SCALE)
        same = (getattr(group, spot) == getattr(spots, spot)) & (group.last == spots.last)
        return near & scaled & (s[name] >= 1) & (s[name] <= SLOTS) & same

    given.__doc__ = "First, last and this balise of a code collected, any scale within 1 %, any jitter up to 0.10 m"
    return given


def decided(s: Seen) -> Bit:
    """W behind the last balise is free."""
    return s.decoder.group.since_last + s.run > s.window


def slots_read(s: Seen) -> Bit:
    """The slots are read as they are."""
    return all_of(*(s.reading[name] == s[name] for name in "pqr"))


def and_slots_read_of_it(s: Seen) -> Bit:
    """five balises of a code collected, any scale within 1 %, any jitter up to 0.1249 m; slots read as claimed of
    each"""
    return almost_an_eighth(s) & slots_read(s)


def and_slots_read(s: Seen) -> Bit:
    """five balises of a code collected, any scale within 1 %, any jitter up to 0.10 m; slots read as claimed of each"""
    return a_true_group(s) & slots_read(s)


@claim(
    TrueGroup,
    expect=PROVED,
    given=true_balise("p", "a"),
    anywhere=True,
    requirement="AP-5",
    source="[A] DECIDE",
    steps=1,
)
def first_slot_is_read(s: Seen) -> Bit:
    """The first slot read is the group's: for every code, all jitter up to 0.1249 m, every scale
    error up to 1 %."""
    return s.reading.p == s.p


@claim(
    TrueGroup,
    expect=PROVED,
    given=true_balise("q", "b"),
    anywhere=True,
    requirement="AP-5",
    source="[A] DECIDE",
    steps=1,
)
def second_slot_is_read(s: Seen) -> Bit:
    """The second slot read is the group's."""
    return s.reading.q == s.q


@claim(
    TrueGroup,
    expect=PROVED,
    given=true_balise("r", "c"),
    anywhere=True,
    requirement="AP-5",
    source="[A] DECIDE",
    steps=1,
)
def third_slot_is_read(s: Seen) -> Bit:
    """The third slot read is the group's."""
    return s.reading.r == s.r


@claim(TrueGroup, expect=PROVED, given=and_slots_read, anywhere=True, requirement="AP-5", source="[A] DECIDE", steps=1)
def a_true_group_is_accepted(s: Seen) -> Bit:
    """With these slots the code is accepted as soon as W behind the last balise is free."""
    return implies(decided(s), s.reading.accepted & slots_read(s))


@claim(TrueGroup, expect=PROVED, given=and_slots_read_of_it, anywhere=True, requirement="AP-5", source="[A] DECIDE",
       settings={"decoder.jitter": EIGHTH}, steps=1)  # fmt: skip
def a_true_group_is_accepted_with_almost_an_eighth(s: Seen) -> Bit:
    """The same with e = 0.1249 m, of which the decoder is told."""
    return implies(decided(s), s.reading.accepted & slots_read(s))


@claim(TrueGroup, expect=REFUTED, given=and_slots_read_of_it, anywhere=True, requirement="AP-5", steps=1,
       twin_of=a_true_group_is_accepted_with_almost_an_eighth)  # fmt: skip
def a_group_is_accepted_with_jitter_unknown_to_the_decoder(s: Seen) -> Bit:
    """Jitter up to 0.1249 m with a decoder that is told 0.10 m.  False: its span check leaves less room."""
    return implies(decided(s), s.reading.accepted)


@claim(TrueGroup, expect=REFUTED, given=with_more_jitter, anywhere=True, requirement="AP-5", steps=1,
       twin_of=first_slot_is_read)  # fmt: skip
def a_group_with_more_jitter_is_read(s: Seen) -> Bit:
    """Jitter up to 0.126 m: the first slot read is the group's.  False: it is more than u_tol away from every slot."""
    return first_slot_is_read(s)


@claim(TrueGroup, expect=REFUTED, given=with_more_scale_error, anywhere=True, requirement="AP-5", steps=1,
       twin_of=a_true_group_is_accepted)  # fmt: skip
def a_group_with_more_scale_error_is_accepted(s: Seen) -> Bit:
    """Scale error up to 1.1 %: the code is accepted.  False: the span check is made for 1 %."""
    return implies(decided(s), s.reading.accepted)

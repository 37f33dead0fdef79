"""The reversible counter: what its count settles at, how soon, how exactly, and under acceleration.

The *lead* is the count with its fractions: the pulses counted, and the part of a pulse that the axle has turned since
the last one, less the part that the divider has gathered.  A step changes it by exactly (r - n)/2048, where r = 2048 V
is the *true count* of the speed V, whatever the phases are: it follows r with a time constant of 2048 steps, 0.319 s.

Results, at 250 km/h (nE = 530) with the speed generator of the two-counter device, a pulse being 0.488 km/h:
* The brake is certain from r = nE, absent up to r = nE - 1: the permitted speed is uncertain by a pulse, 0.19 %.
* Overspeed by a pulse brakes within 2.245 s whatever was before, and may take 1.995 s.
* While the speed rises by up to 1 km/h/s, the brake is there at 0.81 km/h above nE; a run has none at 0.30 km/h.
* The printed f2/(k f1 + 1) belongs to a sum over one unit of time; with k f1 = 1 that swings for ever.

One step is an oscillator pulse, 155.87 us.  Source: eq. (1), (2) [P]; what follows from them [D]; every number [A].
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from math import ceil
from typing import NamedTuple

from models.reversible_counter import DIVISOR, PER_KMH, PULSE, PeriodicSum, ReversibleCounter, StrongFeedback
from safety import PROVED, REFUTED, Bit, Int, Scenario, Seen, age, bit, claim, implies, once, persists, previous, select

Formula = Callable[[Seen], Bit]

UNIT = DIVISOR * PULSE  # lead of one pulse
LIMIT = 530  # nE of 250 km/h
STEP_S = Fraction("155.8695e-6")


def lead(s: Seen) -> Int:
    """The count with its fractions, in pulses/UNIT."""
    return UNIT * s.n.int() + DIVISOR * s.axle.phase - PULSE * s.divider.rest.int()


def true_count(s: Seen) -> Int:
    """2048 V, in pulses/PULSE."""
    return DIVISOR * s.speed


def at(count: Fraction | int) -> int:
    """The least speed input whose true count is not less than `count` pulses."""
    return ceil(count * Fraction(PULSE, DIVISOR))


# --- what the count settles at ---------------------------------------------------------------------------------------


def near(x: Int, y: Int, within: int) -> Bit:
    """Not further apart than so much."""
    return (x - y <= within) & (y - x <= within)


def constant_speed(s: Seen) -> Bit:
    """The speed is what it was a step before; at first the lead is within a pulse of its true count."""
    settled = near(lead(s), DIVISOR * true_count(s), UNIT)
    return select(once(bit(True)), s.speed == previous(s.speed, 0), settled)


def stays_settled(s: Seen) -> Bit:
    """Lemma: within a pulse, and what the divider adds in a step."""
    before = DIVISOR * DIVISOR * previous(s.speed, 0)
    return implies(once(bit(True)), near(lead(s), before, UNIT + PULSE))


@claim(ReversibleCounter, expect=PROVED, requirement="RC-1", source="eq. (1) without its +1 [D]",
       given=constant_speed, lemmas=[stays_settled])  # fmt: skip
def settles_at_f2_over_k_f1(s: Seen) -> Bit:
    """At constant speed the count stays within two pulses of f2/(k f1)."""
    return near(PULSE * s.n.int(), true_count(s), 2 * PULSE)


K_F1 = Fraction(1, 2048 * STEP_S)  # per second, 3.13


@claim(ReversibleCounter, expect=REFUTED, requirement="RC-1", source="eq. (1) as printed, in pulses a second [P]",
       given=constant_speed, twin_of=settles_at_f2_over_k_f1,
       scenario=Scenario(3, {"speed": at(LIMIT)}, start={"counter.n": LIMIT}))  # fmt: skip
def settles_at_f2_over_k_f1_plus_1(s: Seen) -> Bit:
    """At constant speed the count stays within two pulses of f2/(k f1 + 1), in pulses a second."""
    ratio = K_F1 / (K_F1 + 1)  # of the printed count to f2/(k f1)
    return near(ratio.denominator * PULSE * s.n.int(), ratio.numerator * true_count(s), 2 * ratio.denominator * PULSE)


# --- a sum over one unit of time -------------------------------------------------------------------------------------


def same_pulses(s: Seen) -> Bit:
    """As many speed pulses as in the unit before."""
    return implies(once(bit(True)), s.pulses == previous(s.pulses, 0))


@claim(PeriodicSum, expect=PROVED, requirement="RC-5", source="eq. (1) [P]", given=same_pulses, induction=8)
def the_sum_settles_at_the_printed_count(s: Seen) -> Bit:
    """After seven units of time with as many speed pulses the sum is within two pulses of f2/(k f1 + 1)."""
    return implies(age(bit(True), 7) == 7, near(5 * s.n.int(), 4 * s.pulses.int(), 10))


@claim(PeriodicSum, expect=REFUTED, requirement="RC-5", given=same_pulses, steps=10,
       twin_of=the_sum_settles_at_the_printed_count)  # fmt: skip
def the_sum_settles_in_two_units(s: Seen) -> Bit:
    """After two units of time with as many speed pulses it is."""
    return implies(age(bit(True), 7) >= 2, near(5 * s.n.int(), 4 * s.pulses.int(), 10))


@claim(StrongFeedback, expect=REFUTED, requirement="RC-5", given=same_pulses, steps=60, source="k f1 = 1 [A]",
       twin_of=the_sum_settles_at_the_printed_count)  # fmt: skip
def the_sum_settles_with_strong_feedback(s: Seen) -> Bit:
    """With k f1 = 1, after 50 units of time with as many speed pulses, the sum is within two pulses of half of them."""
    return implies(age(bit(True), 50) == 50, near(2 * s.n.int(), s.pulses.int(), 4))


@claim(StrongFeedback, expect=PROVED, requirement="RC-5", given=same_pulses, source="k f1 = 1 [A]", induction=3)
def strong_feedback_swings(s: Seen) -> Bit:
    """With k f1 = 1 the sum of the unit before the last comes back, for ever."""
    return implies(age(bit(True), 3) == 3, s.n == previous(previous(s.n, 0), 0))


# --- how soon: the way up in pieces ----------------------------------------------------------------------------------


class Piece(NamedTuple):
    """From step `start` on the lead is at least `low`, and rises by `rise` a step."""

    start: int
    low: int
    rise: int


def named(name: str, formula: Formula) -> Formula:
    """The formula under the name by which results show it."""
    formula.__name__ = name
    return formula


def way_up(excess: int, limit: int = LIMIT, ratio: Fraction = Fraction(9, 8)) -> list[Piece]:
    """From an empty counter to the limit, the true count being `excess` pulses above it.

    In each piece the distance to the true count shrinks by `ratio`; its rise is that at its end, so this is a lower
    bound.  The last piece is the limit.
    """
    pieces, start, level, r = [], 0, -1, limit + excess
    while level < limit:
        higher = min(max(level + 1, r - ceil((r - level) / ratio)), limit)
        rise = PULSE * (r - higher)  # the count is not above `higher` before the lead is
        pieces.append(Piece(start, UNIT * level, rise))
        start, level = start + -(-UNIT * (higher - level) // rise), higher
    return [*pieces, Piece(start, UNIT * limit, 0)]


def steps_to_brake(excess: int) -> int:
    """Steps within which overspeed by so many pulses brakes, whatever was before."""
    return way_up(excess)[-1].start + 1


def too_fast(s: Seen, excess: int) -> Bit:
    """The true count is `excess` pulses above the limit, or more."""
    return true_count(s) >= PULSE * (s.limit.int() + excess)


def climbing(excess: int, while_: Formula, excused: Formula = lambda s: bit(False)) -> list[Formula]:
    """Lemmas: while it is too fast the lead is not below the way up, unless excused."""
    last = steps_to_brake(excess)

    def above(piece: Piece, end: int | None) -> Formula:
        def lemma(s: Seen) -> Bit:
            since = age(while_(s), last)
            now = (since >= piece.start) & (bit(True) if end is None else since <= end)
            return excused(s) | implies(now, lead(s) >= piece.low + piece.rise * (since.int() - piece.start))

        return named(f"lead {piece.start} steps after overspeed began", lemma)

    pieces = way_up(excess)
    return [*(above(one, following.start) for one, following in pairwise(pieces)), above(pieces[-1], None)]


def faster_by_one(s: Seen) -> Bit:
    """Overspeed by a pulse."""
    return too_fast(s, 1)


FAST = {"speed": at(LIMIT + 1)}


@claim(ReversibleCounter, expect=PROVED, requirement="RC-2", source="eq. (2) [P], settling [D]",
       lemmas=climbing(1, faster_by_one), witness=Scenario(steps_to_brake(1) + 1, FAST))  # fmt: skip
def overspeed_by_a_pulse_brakes(s: Seen) -> Bit:
    """A speed whose true count is a pulse (0.49 km/h) or more above nE brakes within 14 403 steps (2.245 s) after any
    past, and as long as it lasts."""
    return implies(persists(faster_by_one(s), steps_to_brake(1)), s.brake)


@claim(ReversibleCounter, expect=REFUTED, requirement="RC-2", twin_of=overspeed_by_a_pulse_brakes,
       scenario=Scenario(12_800, FAST, start={"divider.rest": DIVISOR - 1}))  # fmt: skip
def overspeed_by_a_pulse_brakes_in_1_994_s(s: Seen) -> Bit:
    """The brake stays from 12 795 steps (1.994 s) on; a single step with it may come before."""
    return implies(persists(faster_by_one(s), 12_795), s.brake)


@claim(ReversibleCounter, expect=REFUTED, requirement="RC-2", source="printed 0.4 s [P]",
       twin_of=overspeed_by_a_pulse_brakes, scenario=Scenario(2600, FAST))  # fmt: skip
def overspeed_by_a_pulse_brakes_in_0_4_s(s: Seen) -> Bit:
    """It brakes within 2566 steps (0.4 s)."""
    return implies(persists(faster_by_one(s), 2566), s.brake)


# --- how exactly -----------------------------------------------------------------------------------------------------


def a_pulse_below(s: Seen) -> Bit:
    """The true count is a pulse or more below nE."""
    return true_count(s) <= PULSE * (s.limit.int() - 1)


def lead_below(s: Seen) -> Bit:
    """The lead is less than a pulse below nE, but for what the divider adds in a step."""
    return lead(s) < UNIT * (s.limit.int() - 1) + PULSE


@claim(ReversibleCounter, expect=PROVED, requirement="RC-3", source="[D]", symbolic=("limit",), given=a_pulse_below,
       start=lead_below, lemmas=[lead_below])  # fmt: skip
def a_pulse_below_never_brakes(s: Seen) -> Bit:
    """While the true count is a pulse or more below nE there is no brake, for every check speed."""
    return ~s.brake


def half_a_pulse_below(s: Seen) -> Bit:
    """The true count is half a pulse or more below nE."""
    return 2 * true_count(s) <= PULSE * (2 * s.limit.int() - 1)


@claim(ReversibleCounter, expect=REFUTED, requirement="RC-3", given=half_a_pulse_below, start=lead_below,
       twin_of=a_pulse_below_never_brakes, scenario=Scenario(20_000, {"speed": at(LIMIT - Fraction(1, 2)) - 1},
                                                             start={"counter.n": LIMIT - 2}))  # fmt: skip
def half_a_pulse_below_never_brakes(s: Seen) -> Bit:
    """Half a pulse below nE there is none."""
    return ~s.brake


# --- under acceleration ----------------------------------------------------------------------------------------------

LAG = UNIT + DIVISOR * DIVISOR * DIVISOR  # a pulse, and what r rises by in 2048 steps at 1 km/h/s


def at_most_1_kmh_s(s: Seen) -> Bit:
    """The speed is at most one unit higher than a step before; at first the lead is no more than a pulse behind."""
    no_lag = DIVISOR * true_count(s) - lead(s) <= UNIT
    return select(once(bit(True)), s.speed <= previous(s.speed, 0) + 1, no_lag)


def lags(s: Seen) -> Bit:
    """Lemma: the lead is not further behind than LAG."""
    return implies(once(bit(True)), DIVISOR * DIVISOR * previous(s.speed, 0) - lead(s) <= LAG)


def above_limit(s: Seen, kmh: str) -> Bit:
    """The speed is so much above that of nE, or more."""
    return true_count(s) >= PULSE * s.limit.int() + ceil(DIVISOR * PER_KMH * Fraction(kmh))


@claim(ReversibleCounter, expect=PROVED, requirement="RC-4", source="[D]", symbolic=("limit",), given=at_most_1_kmh_s,
       lemmas=[lags])  # fmt: skip
def accelerating_brakes_within_0_81_kmh(s: Seen) -> Bit:
    """Where the speed never rises by more than 1 km/h/s, the brake is there at 0.81 km/h (1.66 pulses) above nE."""
    return implies(above_limit(s, "0.81"), s.brake)


RAMP = Scenario(12_000, {"speed": lambda step: at(LIMIT - 2) + step}, start={"counter.n": LIMIT - 2})


@claim(ReversibleCounter, expect=REFUTED, requirement="RC-4", given=at_most_1_kmh_s,
       twin_of=accelerating_brakes_within_0_81_kmh, scenario=RAMP)  # fmt: skip
def accelerating_brakes_within_0_30_kmh(s: Seen) -> Bit:
    """It is there at 0.30 km/h above nE."""
    return implies(above_limit(s, "0.3"), s.brake)

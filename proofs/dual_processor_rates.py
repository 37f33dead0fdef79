"""Dual processors: mean time between stops, common cause, coincidence, and the hazard's probability, by two routes.

Main results: two processors and a comparator in series stop the train every 47 619 h; a common cause, beta of a
processor's rate, is the ceiling of safety at 1e-7 /h, seven powers of ten above the independent coincidence of two
wrong outputs within 0.1 s, 5.56e-15 /h.

The hazard's cut sets have no order and no time in them: a broken processor may show healthy words for months and turn
against the other when that breaks too.  Of the 0.0081 of a year found so, 0.0070 is that pair, latent and never
repaired: an upper bound.  If a broken processor shows it within 0.1 s, and is stopped by the next cycle and for good
(`a_mismatch_brakes_for_ever`), 0.0011 is left: nearly all the three single failures, and 3.5e-5 by a comparator that
had gone blind before B broke; both processors within 0.1 s add 4.5e-11.
Times in h, rates per h, exponential [A].  Source: structure [P]; all rates [A].
"""

from __future__ import annotations

import math
from fractions import Fraction

from proofs.dual_processor import EQUAL
from proofs.dual_processor_hazards import PAIRS, RATES, SINGLES
from safety.rates.claims import printed, rate
from safety.rates.enclosure import Enclosure
from safety.rates.exponential import chance
from safety.rates.markov import Chain, mean_time
from safety.rates.numeric import transient
from safety.rates.units import quantity
from safety.trees import BasicEvent, FaultTree, from_cut_sets, solve

LAMBDA = quantity("1e-5 /h", "A", "failure rate of a processor")
LAMBDA_C = quantity("1e-6 /h", "A", "failure rate of the comparator")
BETA = quantity("0.01", "A", "share of a processor's failures that strike both alike")
WINDOW = quantity("0.1 s", "A", "within which two wrong outputs coincide")
HOURS = quantity("8760 h", "A", "time at risk, without repair or test")
FAILED = {"A wrong", "B wrong", "comparator failed"}  # each stops the train


def in_series() -> Chain:
    """Any failure ends the running."""
    rates = {"A wrong": LAMBDA.value, "B wrong": LAMBDA.value, "comparator failed": LAMBDA_C.value}
    return Chain("all right", {("all right", state): per_hour for state, per_hour in rates.items()})


def share_of_both() -> Fraction:
    """Of the first failures of the processors, those of both at once."""
    alone = 2 * (1 - BETA.value) * LAMBDA.value
    both = BETA.value * LAMBDA.value
    return both / (alone + both)


def within(rate_per_h: Fraction, hours: Fraction) -> Enclosure:
    """Probability of what comes at a rate, within some hours."""
    return Enclosure(*chance(rate_per_h * hours))


def second_within_the_window() -> Enclosure:
    """One of two fails, and the other at least once, at most in the mean, within the window after it."""
    mean = LAMBDA.value * WINDOW.value
    return Enclosure(2 * LAMBDA.value * within(LAMBDA.value, WINDOW.value).low, 2 * LAMBDA.value * mean)


rate(
    id="dual-processor.mtbf", unit="h", source="[D] series of what stops the train",
    target=printed("47 619 h", digits=5),
    quantity="mean time between stops of the train by processors and comparator",
    inputs={"processor": LAMBDA, "comparator": LAMBDA_C},
    routes={"1 / (2 lambda + lambda_c)": lambda: 1 / (2 * LAMBDA.value + LAMBDA_C.value),
            "Markov chain, exact": lambda: mean_time(in_series(), FAILED)},
)  # fmt: skip

rate(
    id="dual-processor.common-cause", unit="1/h", source="[D] beta factor", inputs={"processor": LAMBDA, "beta": BETA},
    quantity="rate of one and the same failure in both processors, which the comparison cannot see",
    target=printed("1e-7 /h", digits=1),
    routes={"beta lambda": lambda: BETA.value * LAMBDA.value,
            "share of the first failures": lambda: share_of_both() * (2 - BETA.value) * LAMBDA.value},
)  # fmt: skip

rate(
    id="dual-processor.coincidence", unit="1/h", source="[D] independent failures", target=printed("5.56e-15 /h"),
    quantity="rate at which both processors fail independently within 0.1 s of each other",
    inputs={"processor": LAMBDA, "window": WINDOW},
    routes={"pairs in independent streams, 2 lambda^2 T": lambda: 2 * LAMBDA.value**2 * WINDOW.value,
            "first failures, and another within T": second_within_the_window},
)  # fmt: skip


# --- the hazard -------------------------------------------------------------------------------------------------------


def cut_sets() -> list[tuple[str, ...]]:
    """Those of `energised_where_the_truth_forbids`."""
    return [*((name,) for name in SINGLES), *PAIRS]


def tree() -> FaultTree:
    """The cut sets as a fault tree."""
    names = dict.fromkeys(name for one in cut_sets() for name in one)
    events = [BasicEvent(n, None, Fraction(RATES[n][0]), HOURS.value, RATES[n][1], "A") for n in names]
    return from_cut_sets("energised where the truth forbids it", cut_sets(), events)


def closed_form() -> Enclosure:
    """No single, and not B together with A or with a blind comparator."""
    (other, b), (_, equal) = PAIRS

    def end(k: int) -> Fraction:
        failed = {name: chance(per_hour(name) * HOURS.value)[k] for one in cut_sets() for name in one}
        beside_b = 1 - (1 - failed[other]) * (1 - failed[equal])
        return 1 - math.prod(1 - failed[name] for name in SINGLES) * (1 - failed[b] * beside_b)

    return Enclosure(end(0), end(1))


def per_hour(name: str) -> Fraction:
    """The rate of a fault."""
    return Fraction(RATES[name][0])


def leaves() -> tuple[Fraction, Fraction, Fraction]:
    """Of the undisturbed state: rate of any failure of a processor, of a blind comparator, and of a single."""
    return 2 * LAMBDA.value, per_hour(EQUAL.name), sum(map(per_hour, SINGLES), Fraction(0))


def found_in_closed_form() -> Enclosure:
    """No single; no two processors within the window; and no B after the comparator has gone blind."""
    processors, blind, singles = leaves()
    hours, b = HOURS.value, LAMBDA.value
    both = processors + blind

    def end(k: int) -> Fraction:
        first, together = chance(both * hours), chance(b * WINDOW.value)
        after = first[k] / both - (first[1 - k] - chance(b * hours)[k]) / (both - b)
        pairs = processors / both * first[k] * together[k] + blind * after
        return 1 - (1 - chance(singles * hours)[k]) * (1 - pairs)

    return Enclosure(end(0), end(1))


def found_by_chain() -> Enclosure:
    """The same by states; a single counts in each of them, even where the train was stopped."""
    processors, blind, singles = leaves()
    together = chance(LAMBDA.value * WINDOW.value)[1]
    rates = {
        ("all right", "wrong"): singles + processors * together, ("all right", "blind"): blind,
        ("all right", "stopped"): processors * (1 - together),
        ("blind", "wrong"): singles + LAMBDA.value, ("stopped", "wrong"): singles,
    }  # fmt: skip
    return transient(Chain("all right", rates), HOURS.value).probability["wrong"]


rate(
    id="dual-processor.top-event", unit="1", source="[D] cut sets, rates [A]", inputs={"hours": HOURS},
    quantity="upper bound: probability that the relay is energised where the truth forbids it, within 8760 h, nothing "
             "repaired, and a broken processor showing healthy words until the other breaks",
    routes={"closed form": closed_form,
            "decision diagram of the fault tree": lambda: Enclosure(*map(Fraction, solve(tree()).bounds or ()))},
)  # fmt: skip

rate(
    id="dual-processor.top-event.found-at-once", unit="1", source="[D] cut sets in their order, rates [A]",
    inputs={"hours": HOURS, "processor": LAMBDA, "window": WINDOW},
    quantity="the same, where a broken processor shows it within 0.1 s and is stopped for good",
    routes={"closed form": found_in_closed_form, "Markov chain": found_by_chain},
)  # fmt: skip

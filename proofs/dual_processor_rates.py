"""Dual processors: mean time between stops, common cause, coincidence, and the hazard's probability, by two routes.

Main results: two processors and a comparator in series stop the train every 47 619 h; a common cause, beta of a
processor's rate, is the ceiling of safety at 1e-7 /h, seven powers of ten above the independent coincidence of two
wrong outputs within 0.1 s, 5.56e-15 /h.
Times in h, rates per h, exponential [A].  Source: structure [P]; all rates [A].
"""

from __future__ import annotations

import math
from fractions import Fraction

from proofs.dual_processor_hazards import PAIRS, RATES, SINGLES
from safety.rates.claims import printed, rate
from safety.rates.enclosure import Enclosure
from safety.rates.exponential import chance
from safety.rates.markov import Chain, mean_time
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
        chance = {name: within(Fraction(RATES[name][0]), HOURS.value)[k] for one in cut_sets() for name in one}
        beside_b = 1 - (1 - chance[other]) * (1 - chance[equal])
        return 1 - math.prod(1 - chance[name] for name in SINGLES) * (1 - chance[b] * beside_b)

    return Enclosure(end(0), end(1))


rate(
    id="dual-processor.top-event", unit="1", source="[D] cut sets, rates [A]", inputs={"hours": HOURS},
    quantity="probability that the relay is energised where the truth forbids it, within 8760 h, nothing repaired",
    routes={"closed form": closed_form,
            "decision diagram of the fault tree": lambda: Enclosure(*map(Fraction, solve(tree()).bounds or ()))},
)  # fmt: skip

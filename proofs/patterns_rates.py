"""Speed patterns: how often each way of telling the stop fails to the wrong side, and what the detectors are worth.

Rates in 1/h from the FIT of the fault table, every one of them assumed [A]; failures exponential and independent [A].
A single wrong-side failure takes effect at the next signal at stop.  With detectors fitted, what is left of them are
the modes that nothing on board finds, and pairs.

Results: 7.0e-7 /h by a resonant point, 4.6e-7 by a magnet, 9.5e-8 by continuous current, 4.55e-7 by both, 1.7e-7 by a
ground program; with detectors the singles left are 1.2e-7, 1.1e-7, none, 1.0e-7 and 1.0e-7, nearly all of them a
brake that gives less than guaranteed, which only the test at departure finds.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from models.patterns.failures import ADDED, ASSUMED_RATES, TABLE
from proofs.patterns_campaign import STOP
from proofs.patterns_hazards import CHECKED, PLAIN_ONES, Protection
from safety.exhibits import Column, Row, table
from safety.rates.claims import rate
from safety.rates.enclosure import Enclosure
from safety.rates.exponential import chance
from safety.rates.units import quantity
from safety.trees import BasicEvent, FaultTree, from_cut_sets, solve

RATES = {row.name: Fraction(row.rate) for row in (*TABLE, *ADDED)}
PARTS = quantity("1 FIT", "A", "fault table, by row: 5 to 300 FIT")
HOURS = quantity("10 000 h", "A", "time at risk, without repair or test")
SOURCE = "[D] cut sets computed, FIT of the fault table [A]"


def by_proof(protection: Protection) -> Fraction:
    """Sum over the single cut sets."""
    return sum((RATES[one[0]] for one in protection.cut_sets if len(one) == 1), Fraction(0))


def by_injection(name: str) -> Fraction:
    """Sum over the modes that an injection finds on the wrong side at a signal at stop."""
    found = (injection for injection, cell in STOP[name].inject().injections() if cell.startswith("wrong"))
    return sum((RATES[injection.faults[0].name] for injection in found), Fraction(0))


def tree(protection: Protection) -> FaultTree:
    """The cut sets as a fault tree."""
    names = dict.fromkeys(name for one in protection.cut_sets for name in one)
    events = [BasicEvent(name, None, RATES[name], HOURS.value, ASSUMED_RATES, "A") for name in names]
    return from_cut_sets("the train passes the protected point", protection.cut_sets, events)


def in_closed_form(cut_sets: Sequence[tuple[str, ...]]) -> Enclosure:
    """Probability of the top event, from sets that have no failure in common."""
    ends = []
    for end in (0, 1):
        none = Fraction(1)
        for one in cut_sets:
            together = Fraction(1)
            for name in one:
                together *= chance(RATES[name] * HOURS.value)[end]
            none *= 1 - together
        ends.append(1 - none)
    return Enclosure(*ends)


def disjoint(protection: Protection) -> bool:
    """No failure is in two sets."""
    names = [name for one in protection.cut_sets for name in one]
    return len(names) == len(set(names))


def wrong_side(name: str, plain: Protection) -> None:
    """Declare the rate of an equipment without detectors."""
    rate(
        id=f"patterns.wrong-side.{name}", unit="1/h", source=SOURCE, inputs={"parts": PARTS},
        quantity=f"rate of wrong-side failure, stop told by {name}, single failures, no detectors",
        routes={"single cut sets of the hazard": lambda: by_proof(plain),
                "wrong-side modes of the campaign": lambda: by_injection(name)},
    )  # fmt: skip


def with_detectors(name: str, checked: Protection) -> None:
    """Declare the probability of an equipment with detectors."""
    rate(
        id=f"patterns.with-detectors.{name}", unit="1", source=SOURCE, inputs={"parts": PARTS, "hours": HOURS},
        quantity=f"probability that the train can pass, stop told by {name}, detectors fitted, within 10 000 h",
        routes={"closed form": lambda: in_closed_form(checked.cut_sets),
                "decision diagram of the fault tree":
                    lambda: Enclosure(*map(Fraction, solve(tree(checked)).bounds or ()))},
    )  # fmt: skip


for _name, _plain in PLAIN_ONES.items():
    wrong_side(_name, _plain)
for _name, _checked in CHECKED.items():
    if disjoint(_checked):
        with_detectors(_name, _checked)


@table(
    id="patterns.rates", title="Failure to the wrong side, by the way of telling the stop",
    source=SOURCE,
    columns=(Column("stop told by"), Column("single failures", "FIT", assumed=True),
             Column("with detectors", "FIT", assumed=True), Column("pairs and triples with detectors")),
)  # fmt: skip
def wrong_side_rates() -> Iterator[Row]:
    """A way a row; the rate is the sum over the single cut sets."""
    for name, plain in PLAIN_ONES.items():
        checked = CHECKED[name]
        larger = sum(len(one) > 1 for one in checked.cut_sets)
        yield name, by_proof(plain) * 10**9, by_proof(checked) * 10**9, larger

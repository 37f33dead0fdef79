"""Fault trees straight from a model: the cut sets of a hazard with their rates, drawn and solved.

A fault of rate r over t hours is there with Q = 1 - exp(-r t), r and t exactly as declared.  Faults are taken to be
independent.  What is known beyond the enumerated orders is stated and carried into the upper bound: if sets of more
than m faults may exist, the top event is no likelier than the enumerated part plus the chance of more than m faults at
once, at most the sum over all (m + 1)-subsets of the product of r t (union bound).  At any time the probability so lies
between that of the confirmed sets alone and that of confirmed and candidate sets with what lies beyond: a candidate may
be no cut set at all, or stand for larger ones.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction
from typing import Any, get_type_hints

from safety.model import Model
from safety.prove.hazards import CONFIRMED, CutSets, Hazard
from safety.prove.problem import build_problem
from safety.prove.record import cut_set_entry
from safety.system import ModelError, nearest
from safety.trees.as_written import exact
from safety.trees.drawn.from_cut_sets import from_cut_sets
from safety.trees.importance.events import plain
from safety.trees.importance.gates import importance_of_gates
from safety.trees.solve import solve
from safety.trees.summary import summary
from safety.trees.tree import TAGS, BasicEvent, FaultTree

NARROW = 1000  # a probability is given as one number where its bounds are closer than this part of it
SHORT = 2  # letters; a part's longer name says itself what it is
WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+")  # of the name of a class
CHANCE = "Q = 1 - exp(-rate x hours), faults independent"


def tree_from_model(found: CutSets, hazard: Hazard) -> FaultTree:
    """The fault tree whose minimal cut sets are those of the hazard, candidates too; no probability without a rate.

    Raises `ModelError` for a rate of a fault that the hazard does not have, `TreeError` for one that is no number.
    """
    names = [fault.name for fault in build_problem(hazard.claim).faults]
    for name in hazard.rates:
        if name not in names:
            raise ModelError(f"{hazard.id}: there is a rate for the fault {name!r}; {nearest(name, names)}")
    used = {name for one in found.sets for name in one.faults}
    events = [_event(name, hazard) for name in names if name in used]
    sets = [one.faults for one in found.sets]
    titles = _titles(hazard.claim.model)
    return from_cut_sets(hazard.id, sets, events, description=hazard.claim.statement, titles=titles)


def tree_entry(found: CutSets, hazard: Hazard, seconds: float | None = None) -> dict[str, Any]:
    """The hazard's entry under "trees" of the results document; `seconds` is what finding the cut sets took."""
    tree = tree_from_model(found, hazard)
    entry = summary(tree, source=f"model {hazard.claim.model.__name__}", read_s=seconds)
    status = {frozenset(one.faults): one.status for one in found.sets}
    for one in entry["minimal_cut_sets"]["sets"]:
        one["status"] = status[frozenset(one["events"])]
    by_order = found.by_order()
    faults = len(build_problem(hazard.claim).faults)
    entry |= cut_set_entry(found, hazard) | {
        "model": hazard.claim.model.__name__,
        "completeness": completeness(found, faults),
        "faults_listed": faults,
        "chance": CHANCE,
        "hours": hazard.hours,
        "as_expected": not hazard.expect or by_order == dict(hazard.expect),
    }
    if entry["probability"] is not None:
        entry["gate_importance"] = [plain(one) for one in importance_of_gates(tree).values()]
    if not entry["as_expected"]:
        entry["note"] = f"cut sets by order {_orders(by_order)}, expected {_orders(hazard.expect)}"
    return entry | _bounds(entry, found, hazard)


def told(found: CutSets, hazard: Hazard) -> str:
    """How far an enumeration is, with the bounds on the probability that it gives already."""
    number = f"order {found.complete_to} complete, {len(found.sets)} cut set{'s' * (len(found.sets) != 1)} so far"
    entry = tree_entry(found, hazard)
    low, high = entry["probability_low"], entry["probability_high"]
    return number + (f", probability {low:.3g} to {high:.3g}" if low is not None and high is not None else "")


def completeness(found: CutSets, faults: int) -> str:
    """How far the list of cut sets of a hazard with so many faults reaches."""
    if found.all_orders:
        return f"complete at all orders over the {faults} listed fault{'s' * (faults != 1)}"
    if found.complete_to < 0:
        return f"not complete: {found.why}"
    rest = f"; {found.why}" if found.why else ", larger sets may exist"
    return f"complete up to {found.complete_to} faults at once{rest}"


def beyond(rates: Iterable[Fraction], order: int) -> Fraction:
    """An upper bound on the chance of `order` or more of the faults at once, from their expected numbers r t."""
    sums = [Fraction(1)] + [Fraction(0)] * order  # elementary symmetric polynomials so far
    for expected in rates:
        for k in range(order, 0, -1):
            sums[k] += sums[k - 1] * expected
    return min(sums[order], Fraction(1))


def _titles(model: type[Model]) -> dict[str, str]:
    """What the short names of like parts stand for: "channel a" for the part a of the class Channel."""
    kinds = {name: kind for name, kind in get_type_hints(model).items() if isinstance(kind, type)}
    alike = Counter(kinds.values())
    return {
        name: f"{' '.join(WORDS.findall(kind.__name__)).lower()} {name}"
        for name, kind in kinds.items()
        if issubclass(kind, Model) and alike[kind] > 1 and len(name) <= SHORT
    }


def _event(name: str, hazard: Hazard) -> BasicEvent:
    if name not in hazard.rates:
        return BasicEvent(name, description="no rate given")
    rate, source = hazard.rates[name]
    tag = source[1:2] if source[:1] == "[" and source[1:2] in TAGS else ""
    hours = exact(hazard.hours, f"hours of {hazard.id}")
    return BasicEvent(name, None, exact(rate, f"rate of {name}"), hours, source, tag)


def _bounds(entry: dict[str, Any], found: CutSets, hazard: Hazard) -> dict[str, Any]:
    """Probability and bounds, made honest where candidates or missing orders leave something open."""
    if entry["probability_low"] is None:
        return {"probability": None, "probability_high": None}
    sure = replace(found, sets=[one for one in found.sets if one.status == CONFIRMED])
    bounds = solve(tree_from_model(sure, hazard)).bounds if len(sure.sets) < len(found.sets) else None
    low = bounds[0] if bounds else entry["probability_low"]
    rest = _beyond(found, hazard)
    high = None if rest is None else Fraction(entry["probability_high"]) + rest
    known = high is not None and high - Fraction(low) <= high / NARROW
    return {
        "probability": entry["probability"] if known else None,
        "probability_low": low,
        "probability_high": _above(high) if rest else entry["probability_high"] if rest == 0 else None,
        **({"beyond": float(rest)} if rest else {}),
    }


def _beyond(found: CutSets, hazard: Hazard) -> Fraction | None:
    """An upper bound on what larger sets than those enumerated may add; None when there is none."""
    if found.all_orders:
        return Fraction(0)
    names = [fault.name for fault in build_problem(hazard.claim).faults]
    if found.complete_to < 0 or any(name not in hazard.rates for name in names):
        return None
    hours = exact(hazard.hours, f"hours of {hazard.id}")
    return beyond((exact(hazard.rates[name][0], f"rate of {name}") * hours for name in names), found.complete_to + 1)


def _above(value: Fraction | None) -> float | None:
    return None if value is None else min(1.0, math.nextafter(float(value), 2.0))


def _orders(counts: Any) -> str:
    return ", ".join(f"{number} of order {order}" for order, number in sorted(counts.items())) or "none"

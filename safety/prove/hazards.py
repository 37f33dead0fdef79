"""Minimal cut sets of a hazard, straight from the model, complete at every order.

    @hazard(Ts7, faults=component_faults(), lemmas=(...), scenarios=..., requirement="TS7-7")
    def overspeed_without_brake(s: Seen) -> Bit:
        \"\"\"The train runs 4 words too fast for 0.6 s and neither brake is applied.\"\"\"
        return persists(s.excess >= 4, ticks=4800) & ~s.nb & ~s.eb

The lemmas are proved once for every combination of faults.  Sets of faults are then enumerated by rising number: each
set that the lemmas allow is run on the Python reading (confirmed) or stays a candidate; when no further set is allowed
at an order, the list is complete there, and one more question asks for sets of any order.  Lemmas that are too weak
can only add candidates, never lose a cut set.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from safety.faults import any_of_faults
from safety.model import Model
from safety.prove import search
from safety.prove.claims import INTEGERS, PROVED, Claim, F, Formula, Scenario, claim_id
from safety.prove.induction import lemma_obligations
from safety.prove.problem import Problem, build_problem
from safety.prove.prove import Limits
from safety.prove.solve import SAT, UNKNOWN, Solver, Unrolling
from safety.system import ModelError
from safety.trace import Trace

CONFIRMED, CANDIDATE = "confirmed", "candidate"


@dataclass(frozen=True)
class CutSet:
    """Faults that together lead to the hazard and no fewer of them do; confirmed by a run, or a candidate."""

    faults: tuple[str, ...]
    status: str
    steps: int | None = None
    script: Scenario | None = field(default=None, compare=False, repr=False)

    @property
    def order(self) -> int:
        """How many faults."""
        return len(self.faults)


@dataclass
class CutSets:
    """All minimal cut sets up to `complete_to` faults; `all_orders` when no further one of any order exists."""

    id: str
    sets: list[CutSet]
    complete_to: int
    all_orders: bool
    why: str = ""

    def by_order(self, status: str | None = None) -> dict[int, int]:
        """Number of sets of each order."""
        orders = [s.order for s in self.sets if status in (None, s.status)]
        return {n: orders.count(n) for n in sorted(set(orders))}


@dataclass(frozen=True)
class Hazard:
    """A hazard as declared; `claim` says that it never happens, `scenarios` gives runs to try for a set of faults.

    `rates` gives each fault's failure rate per hour with its source tag, `hours` the time at risk.
    """

    claim: Claim
    scenarios: Callable[[tuple[str, ...]], Sequence[Scenario]]
    most: int
    rates: Mapping[str, tuple[str, str]]
    hours: str
    expect: Mapping[int, int]

    @property
    def id(self) -> str:
        """Proof file's stem and function."""
        return self.claim.id


_registry: dict[str, Hazard] = {}


def hazards() -> list[Hazard]:
    """All hazards that imported proof files have declared."""
    return list(_registry.values())


def hazard(
    model: type[Model],
    *,
    faults: Any,
    scenarios: Callable[[tuple[str, ...]], Sequence[Scenario]],
    lemmas: Sequence[Formula] = (),
    given: Formula | None = None,
    start: Formula | None = None,
    symbolic: Sequence[str] = (),
    settings: Mapping[str, Any] | None = None,
    requirement: str = "",
    source: str = "",
    most: int = 4,
    rates: Mapping[str, tuple[str, str]] | None = None,
    hours: str = "1",
    expect: Mapping[int, int] | None = None,
) -> Callable[[F], F]:
    """Declare a hazard: the decorated function is true where it happens.

    `scenarios(names)` gives the runs that may show the hazard with these faults present; `most` is the greatest order
    enumerated; `rates` maps a fault to (failures per hour, source with tag); `expect` pins the number of sets by order.
    """

    def declare(formula: F) -> F:
        statement = " ".join((formula.__doc__ or "").split())
        if not statement:
            raise ModelError(f"hazard {formula.__name__} says nothing: give it a docstring in plain words")

        def never(seen: Any) -> Any:
            return ~formula(seen)

        inner = Claim(
            claim_id(formula), model, never, statement, PROVED, requirement, source, any_of_faults(faults), given, start,
            tuple(lemmas), tuple(symbolic), dict(settings or {}), 1, 0, INTEGERS, None, None, None, "hazard",
        )  # fmt: skip
        _registry[inner.id] = Hazard(inner, scenarios, most, dict(rates or {}), hours, dict(expect or {}))
        return formula

    return declare


def cut_sets(hazard: Hazard, limits: Limits | None = None, progress: Callable[[str], None] | None = None) -> CutSets:
    """Enumerate the minimal cut sets.  Raises `ModelError` when a lemma does not hold under all faults."""
    limits, say = limits or Limits(), progress or (lambda _: None)
    problem = build_problem(hazard.claim)
    answer = lemma_obligations(problem, True, limits.timeout, limits.solvers)
    if answer.failed:
        raise ModelError(f"{hazard.id}: {answer.failed}: not shown for every combination of faults; guard the lemma by the faults that break it")
    names = [f.name for f in problem.faults]
    unrolling = Unrolling(problem.system, "z3", True, anywhere=True)
    k, solver = unrolling.k, Solver("z3", unrolling.k, limits.timeout)
    solver.add(*unrolling.at(0, [*problem.lemmas.values(), problem.given]), k.Not(unrolling.at(0, [problem.holds])[0]))
    present = unrolling.at(0, problem.faulted.present)
    solver.add_ranges(unrolling)
    result = CutSets(hazard.id, [], -1, False)
    for order in range(hazard.most + 1):
        if not _order(hazard, problem, solver, k, present, names, order, result):
            return result
        result.complete_to = order
        say(f"{hazard.id}: order {order} complete, {len(result.sets)} cut sets so far")
    result.all_orders = solver.check() not in (SAT, UNKNOWN)
    return result


def _order(hazard: Hazard, problem: Problem, solver: Solver, k: Any, present: list[Any], names: list[str], order: int, result: CutSets) -> bool:
    """All further cut sets of one order; false when the solver gave up."""
    solver.push()
    solver.add(k.AtMost(*present, order))
    found: list[CutSet] = []
    while (answer := solver.check()) == SAT:
        model = solver.model()
        chosen = tuple(n for n, p in zip(names, present, strict=True) if bool(model.eval(p, model_completion=True)))
        found.append(_replayed(hazard, problem, chosen))
        solver.add(_block(k, present, names, chosen))
    solver.pop()
    for one in sorted(found, key=lambda c: c.faults):
        result.sets.append(one)
        solver.add(_block(k, present, names, one.faults))
    if answer == UNKNOWN:
        result.why = f"the solver gave no answer at order {order}"
    return answer != UNKNOWN


def _block(k: Any, present: list[Any], names: list[str], chosen: tuple[str, ...]) -> Any:
    return k.Or(*(k.Not(p) for n, p in zip(names, present, strict=True) if n in chosen)) if chosen else k.BoolVal(False)


def _replayed(hazard: Hazard, problem: Problem, chosen: tuple[str, ...]) -> CutSet:
    """Run the scenarios with these faults in the equipment, on the Python reading."""
    equipped = search.with_faults(problem, chosen)
    for script in hazard.scenarios(chosen):
        holds = search.scripted(equipped, script, keep=("claim.holds", "claim.given"))["claim.holds"]
        if False in holds:
            return CutSet(chosen, CONFIRMED, holds.index(False) + 1, script)
    return CutSet(chosen, CANDIDATE)


def replay(hazard: Hazard, cut: CutSet) -> Trace:
    """The run that confirms a cut set, with every signal, up to the step at which the hazard is there."""
    if cut.script is None:
        raise ModelError(f"{hazard.id}: {' + '.join(cut.faults)} is a candidate: no scenario confirmed it, so there is no run to show")
    found = search.cut_at(search.scripted(build_problem(hazard.claim), cut.script), "claim.holds", False)
    assert found is not None
    return found

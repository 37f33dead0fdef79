"""Minimal cut sets of a hazard, straight from the model, complete at every order.

    @hazard(Ts7, faults=component_faults(), lemmas=(...), scenarios=..., requirement="TS7-7")
    def overspeed_without_brake(s: Seen) -> Bit:
        \"\"\"The train runs 4 words too fast for 0.6 s and neither brake is applied.\"\"\"
        return persists(s.excess >= 4, ticks=4800) & ~s.nb & ~s.eb

The lemmas are proved once for every combination of faults.  Sets of faults are then enumerated by rising number: each
set that the lemmas allow is run on the Python reading (confirmed) or stays a candidate; when no further set is allowed
at an order, the list is complete there, and one more question asks for sets of any order.  Lemmas that are too weak
can only add candidates, never lose a cut set: a candidate stands for every set that contains it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from safety.faults import any_of_faults
from safety.model import Model
from safety.prove import search
from safety.prove.claims import INTEGERS, PROVED, Claim, F, Formula, Scenario, claim_id
from safety.prove.induction import lemma_obligations
from safety.prove.problem import Problem, build_problem
from safety.prove.prove import Limits
from safety.prove.solve import SAT, UNKNOWN, UNSAT, Disagreement, Solver, Unrolling
from safety.system import ModelError
from safety.terms import bit
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
    """All minimal cut sets up to `complete_to` faults; `all_orders` when no further one of any order exists.

    `agreed_by` names the solvers that confirm that the list is complete.
    """

    id: str
    sets: list[CutSet]
    complete_to: int
    all_orders: bool
    why: str = ""
    agreed_by: list[str] = field(default_factory=list)

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
_formulas: dict[str, Formula] = {}


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
            claim_id(formula), model, never, statement, PROVED, requirement, source, any_of_faults(faults), given,
            start, tuple(lemmas), tuple(symbolic), dict(settings or {}), 1, 0, INTEGERS, None, None, None, "hazard",
        )  # fmt: skip
        _register(Hazard(inner, scenarios, most, dict(rates or {}), hours, dict(expect or {})), formula)
        return formula

    return declare


def _register(new: Hazard, formula: Formula) -> None:
    """Add a hazard; raises `ModelError` when another function of the same file, or a claim, has its id."""
    old = _formulas.get(new.id)
    twice = old is not None and old.__globals__ is formula.__globals__
    if twice and old is not None and old.__code__.co_firstlineno != formula.__code__.co_firstlineno:
        raise ModelError(f"two hazards are called {new.id!r}; rename one")
    _registry[new.id], _formulas[new.id] = new, formula


def cut_sets(hazard: Hazard, limits: Limits | None = None, progress: Callable[[str], None] | None = None) -> CutSets:
    """Enumerate the minimal cut sets.

    Raises `ModelError` when a lemma does not hold under all faults, or when the assumptions admit no run at all.
    """
    limits, say = limits or Limits(), progress or (lambda _: None)
    problem = build_problem(hazard.claim)
    if search.bounded(problem, bit(True), 1, True, limits.timeout).run is None:
        raise ModelError(
            f"{hazard.id}: no run could be started: the assumptions contradict one another, or no answer came"
        )
    answer = lemma_obligations(problem, True, limits.timeout, limits.solvers)
    if answer.failed:
        raise ModelError(
            f"{hazard.id}: {answer.failed}: not shown for every combination of faults; "
            "guard the lemma by the faults that break it"
        )
    question = _Question(problem, "z3", limits.timeout)
    result = CutSets(hazard.id, [], -1, False)
    for order in range(hazard.most + 1):
        if not _order(hazard, question, order, result):
            return result
        result.complete_to = order
        say(f"{hazard.id}: order {order} complete, {len(result.sets)} cut sets so far")
    result.all_orders = question.solver.check() == UNSAT
    result.agreed_by = [name for name in answer.agreed_by if name == "z3" or _confirms(problem, result, name, limits)]
    return result


class _Question:
    """The hazard at a state that the lemmas allow, with the sets of faults found so far and all above them excluded."""

    def __init__(self, problem: Problem, solver: str, timeout: float) -> None:
        self.problem = problem
        unrolling = Unrolling(problem.system, solver, True, anywhere=True)
        self.k, self.solver = unrolling.k, Solver(solver, unrolling.k, timeout)
        self.solver.add(*unrolling.at(0, [*problem.lemmas.values(), problem.given]))
        self.solver.add(self.k.Not(unrolling.at(0, [problem.holds])[0]))
        names = [f.name for f in problem.faults]
        self.present = dict(zip(names, unrolling.at(0, problem.faulted.present), strict=True))
        self.solver.add_ranges(unrolling)

    def limit(self, order: int) -> None:
        """At most so many faults."""
        present = list(self.present.values())
        if present and self.solver.name == "z3":
            self.solver.add(self.k.AtMost(*present, order))
        elif present:  # the other interface has no such word
            self.solver.add(self.k.Sum([self.k.If(p, self.k.IntVal(1), self.k.IntVal(0)) for p in present]) <= order)

    def exclude(self, chosen: tuple[str, ...]) -> None:
        """Neither these faults together nor more than these."""
        absent = [self.k.Not(self.present[name]) for name in chosen]
        self.solver.add(self.k.Or(*absent) if len(absent) > 1 else absent[0] if absent else self.k.BoolVal(False))

    def chosen(self) -> tuple[str, ...]:
        """The faults of the last answer."""
        model = self.solver.model()
        return tuple(name for name, p in self.present.items() if bool(model.eval(p, model_completion=True)))


def _order(hazard: Hazard, question: _Question, order: int, result: CutSets) -> bool:
    """All further cut sets of one order; false when the solver gave up."""
    question.solver.push()
    question.limit(order)
    found: list[CutSet] = []
    while (answer := question.solver.check()) == SAT:
        chosen = question.chosen()
        found.append(_replayed(hazard, question.problem, chosen))
        question.exclude(chosen)
    question.solver.pop()
    for one in sorted(found, key=lambda c: c.faults):
        result.sets.append(one)
        question.exclude(one.faults)
    if answer == UNKNOWN:
        result.why = f"the solver gave no answer at order {order}: {question.solver.why}"
    return answer != UNKNOWN


def _confirms(problem: Problem, result: CutSets, name: str, limits: Limits) -> bool:
    """Whether another solver finds no further set either, of the orders that the list is said to be complete at.

    Raises `Disagreement` when it finds one.
    """
    try:
        question = _Question(problem, name, limits.timeout)
        for one in result.sets:
            question.exclude(one.faults)
        if not result.all_orders:
            question.limit(result.complete_to)
        answer = question.solver.check()
    except Exception:  # missing or broken down: it confirms nothing
        return False
    if answer == SAT:
        raise Disagreement(f"{result.id}: {name} finds one more cut set, z3 does not")
    return answer == UNSAT


def _replayed(hazard: Hazard, problem: Problem, chosen: tuple[str, ...]) -> CutSet:
    """Run the scenarios with exactly these faults in the equipment, on the Python reading."""
    equipped = search.with_faults(problem, chosen)
    for given in hazard.scenarios(chosen):
        script = replace(given, present=chosen)
        holds = search.scripted(equipped, script, keep=("claim.holds", "claim.given"))["claim.holds"]
        if False in holds:
            return CutSet(chosen, CONFIRMED, holds.index(False) + 1, script)
    return CutSet(chosen, CANDIDATE)


def replay(hazard: Hazard, cut: CutSet) -> Trace:
    """The run that confirms a cut set, with every signal, up to the step at which the hazard is there."""
    if cut.script is None:
        faults = " + ".join(cut.faults)
        raise ModelError(f"{hazard.id}: {faults} is a candidate: no scenario confirmed it, so there is no run to show")
    found = search.cut_at(search.scripted(build_problem(hazard.claim), cut.script), "claim.holds", False)
    assert found is not None
    return found

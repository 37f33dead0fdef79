"""Minimal cut sets of a hazard, straight from the model, complete at every order.

    @hazard(Ts7, faults=component_faults(), lemmas=(...), scenarios=..., requirement="TS7-7")
    def overspeed_without_brake(s: Seen) -> Bit:
        \"\"\"The train runs 4 words too fast for 0.6 s and neither brake is applied.\"\"\"
        return persists(s.excess >= 4, ticks=4800) & ~s.nb & ~s.eb

The lemmas are proved once for every combination of faults.  Sets of faults are then enumerated by rising number: each
set that the lemmas allow is run on the Python reading (confirmed) or stays a candidate; when no further set is allowed
at an order, the list is complete there, and one more question asks for sets of any order.  Lemmas that are too weak
can only add candidates, never lose a cut set: a candidate stands for every set that contains it.  At the end, questions
that know nothing of the enumeration ask for the hazard with only a part of a set present: there must be none.
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

    `agreed_by` names the solvers that confirm that the list is complete, `minimal_by` those that show that no proper
    part of a set suffices; `not_minimal` are sets of which a part may suffice.
    """

    id: str
    sets: list[CutSet]
    complete_to: int
    all_orders: bool
    why: str = ""
    agreed_by: list[str] = field(default_factory=list)
    minimal_by: list[str] = field(default_factory=list)
    not_minimal: list[tuple[str, ...]] = field(default_factory=list)

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


def cut_sets(
    hazard: Hazard, limits: Limits | None = None, progress: Callable[[CutSets], None] | None = None
) -> CutSets:
    """Enumerate the minimal cut sets; `progress` is shown what there is after each order.

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
        complete = _order(hazard, question, order, result)
        if not complete:
            break
        result.complete_to = order
        say(result)
    else:
        result.all_orders = question.solver.check() == UNSAT
        by = [name for name in answer.agreed_by if name == "z3" or _confirms(problem, result, name, limits)]
        result.agreed_by = by
    _check_minimal(problem, result, limits)
    return result


class _Question:
    """The hazard at a state that the lemmas allow, with the sets of faults found so far and all above them excluded."""

    def __init__(self, problem: Problem, solver: str, timeout: float) -> None:
        self.problem = problem
        unrolling = Unrolling(problem.system, solver, True, anywhere=True)
        self.k = unrolling.k
        known = unrolling.at(0, [*problem.lemmas.values(), problem.given])
        present = unrolling.at(0, problem.faulted.present)
        there = self.k.Not(unrolling.at(0, [problem.holds])[0])
        reals = solver == "cvc5" and unrolling.encoder.reals_only  # the other is asked for models, many a time
        self.solver = Solver(solver, self.k, timeout, real=reals)
        self.solver.add(*known, there)
        self.present = dict(zip([f.name for f in problem.faults], present, strict=True))
        self.solver.add_ranges(unrolling)

    def limit(self, order: int) -> None:
        """At most so many faults."""
        present = list(self.present.values())
        if present and self.solver.name == "z3":
            self.solver.add(self.k.AtMost(*present, order))
        elif present:  # the other interface has no such word
            self.solver.add(self.k.Sum([self.k.If(p, self.k.RealVal(1), self.k.RealVal(0)) for p in present]) <= order)

    def exclude(self, chosen: tuple[str, ...]) -> None:
        """Neither these faults together nor more than these."""
        absent = [self.k.Not(self.present[name]) for name in chosen]
        self.solver.add(self.k.Or(*absent) if len(absent) > 1 else absent[0] if absent else self.k.BoolVal(False))

    def part_of(self, sets: Sequence[tuple[str, ...]]) -> None:
        """Only faults of one of these sets, but not all of them."""
        within = []
        for one in sets:
            absent = [self.k.Not(p) for name, p in self.present.items() if name not in one]
            some_absent = self.k.Or(*(self.k.Not(self.present[name]) for name in one), self.k.BoolVal(False))
            within.append(self.k.And(*absent, some_absent))
        self.solver.add(self.k.Or(*within, self.k.BoolVal(False)))

    def chosen(self) -> tuple[str, ...]:
        """The faults of the last answer."""
        model, z3 = self.solver.model(), self.solver.name == "z3"
        values = {name: model.eval(p, model_completion=True) if z3 else model[p] for name, p in self.present.items()}
        return tuple(name for name, value in values.items() if self.k.is_true(value))


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


def _check_minimal(problem: Problem, result: CutSets, limits: Limits) -> None:
    """Show, with each solver, that no proper part of a set suffices; name the sets of which one may.

    Raises `Disagreement` when one solver shows it and another finds such a part.
    """
    left = [one.faults for one in result.sets if one.faults]
    said: dict[str, str] = {}
    for name in limits.solvers:
        said[name], parts = _parts(problem, left, name, limits)
        result.not_minimal += [one for one in left if one in parts and one not in result.not_minimal]
    if SAT in said.values() and UNSAT in said.values():
        raise Disagreement(f"{result.id}: whether a part of a cut set suffices: {said}")
    result.minimal_by = [name for name, answer in said.items() if answer == UNSAT]
    if result.not_minimal:
        names = "; ".join(" + ".join(one) for one in result.not_minimal)
        result.why = "; ".join(filter(None, [result.why, f"not minimal: a part suffices of {names}"]))


def _parts(
    problem: Problem, sets: Sequence[tuple[str, ...]], solver: str, limits: Limits
) -> tuple[str, set[tuple[str, ...]]]:
    """What a solver says to whether a proper part of a set allows the hazard, and the sets of which one does."""
    left: list[tuple[str, ...]] = list(sets)
    larger: set[tuple[str, ...]] = set()
    try:
        question = _Question(problem, solver, limits.timeout)
        while True:
            question.solver.push()
            question.part_of(left)
            answer = question.solver.check()
            if answer != SAT or question.solver.apart:  # then it does not tell which
                return (SAT if larger else answer), larger
            found = set(question.chosen())
            question.solver.pop()
            new = {one for one in left if found < set(one)}
            assert new, f"{found} is no proper part of any set"
            larger |= new
            left = [one for one in left if one not in larger]
    except Exception:  # missing or broken down: it shows nothing
        return UNKNOWN, larger


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

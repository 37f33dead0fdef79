"""Counterexamples and witnesses: bounded search, scripted scenarios, and replay on the Python reading.

Nothing is called a counterexample before it has been run on the Python reading and broken the claim there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, cast

from safety.faults import present_name
from safety.prove.claims import Scenario
from safety.prove.problem import Problem, observed
from safety.prove.solve import SAT, UNKNOWN, Disagreement, Solver, Unrolling
from safety.system import ANY, ModelError, nearest, substitute
from safety.terms import Bit
from safety.terms.graph import Term
from safety.terms.values import bit
from safety.trace import Trace, run


@dataclass
class Found:
    """Result of a search: a replayed run that ends where the target holds, or the number of steps searched in full."""

    run: Trace | None
    searched: int
    complete: bool = True


def bounded(problem: Problem, target: Bit, steps: int, integers: bool, timeout: float, solver: str = "z3") -> Found:
    """Look for the shortest run whose last step satisfies `target`, up to `steps` steps; then the smallest of those.

    `searched` counts the steps shown free of the target.
    """
    unrolling = Unrolling(problem.system, solver, integers)
    asked = Solver(solver, unrolling.k, timeout, finite=not integers)
    asked.add(*unrolling.at(0, [problem.start]))
    for k in range(steps):
        given, hit = unrolling.at(k, [problem.given, target])
        asked.add_ranges(unrolling)
        asked.add(given)
        asked.push()
        asked.add(hit)
        answer = asked.check()
        if answer == SAT:
            values = _smallest(problem, unrolling, asked, k)
            return Found(replay(problem, values, k + 1, target), k)
        asked.pop()
        if answer == UNKNOWN:
            return Found(None, k, complete=False)
        asked.add(unrolling.k.Not(hit))
    return Found(None, steps)


def _smallest(problem: Problem, unrolling: Unrolling, asked: Solver, last: int) -> dict[tuple[str, int], Any]:
    """Fix the free choices one by one, each to its least value: the result does not depend on the solver."""
    values: dict[tuple[str, int], Any] = {}
    free = [(s.path, s.var, 0) for s in problem.system.states if s.power_up is ANY]
    free += [(path, var, k) for k in range(last + 1) for path, var in problem.system.inputs.items()]
    for path, var, k in free:
        context = unrolling.contexts[k]
        if var.uid not in context.known:
            continue
        values[path, k] = _least(unrolling, asked, context.known[var.uid], var)
    return values


def _least(unrolling: Unrolling, asked: Solver, expression: Any, var: Term) -> Any:
    """The least value that the expression can take in a model of what is asserted; asserted from then on."""
    encoder = unrolling.encoder

    def current() -> Any:
        if asked.check() != SAT:
            raise Disagreement(f"{var.attr}: the solver withdrew its answer while the run was being made smallest")
        return encoder.value(asked.model(), expression, var.sort)

    value = current()
    if var.sort.kind == "real":
        asked.add(expression == unrolling.k.RealVal(str(value)))
        return value
    low = 0 if var.sort.kind == "bit" else var.sort.bounds[0]
    while value is not False and value != low:
        middle = False if value is True else (low + value) // 2
        asked.push()
        asked.add(_at_most(unrolling, expression, var, middle))
        answer = asked.check()
        if answer == SAT:
            value = encoder.value(asked.model(), expression, var.sort)
            asked.pop()
        else:
            asked.pop()
            if value is True:
                break
            low = middle + 1
    asked.add(_at_most(unrolling, expression, var, value))
    return value


def _at_most(unrolling: Unrolling, expression: Any, var: Term, value: Any) -> Any:
    k = unrolling.k
    if var.sort.kind == "bit":
        return expression if value else k.Not(expression)
    if unrolling.encoder.integers:
        return expression <= value
    if var.sort.kind == "uint":
        return k.ULE(expression, k.BitVecVal(value, var.sort.width))
    return expression <= value


def replay(problem: Problem, values: Mapping[tuple[str, int], Any], steps: int, target: Bit | None) -> Trace:
    """Run the Python reading on a solver's choices; raises `Disagreement` when the target is not met at the last step."""
    system = observed(problem)
    start = {path: v for (path, k), v in values.items() if k == 0 and path in system.state}

    def row(k: int) -> dict[str, Any]:
        return {path: values.get((path, k), _low(var)) for path, var in system.inputs.items()}

    trace = run(system, row, steps, start=start)
    met = trace["claim.holds"][-1] if target is problem.premise else not trace["claim.holds"][-1]
    reached = trace["claim.premise"][-1] if target is problem.premise else met
    if not reached or not all(trace["claim.given"]):
        raise Disagreement(f"{problem.claim.id}: the solver's run of {steps} steps does not do on the Python reading what it should")
    return trace


def _low(var: Term) -> Any:
    return {"bit": False, "real": Fraction(0)}.get(var.sort.kind, var.sort.low if var.sort.kind == "int" else 0)


def scripted(problem: Problem, script: Scenario, keep: Sequence[str] | None = None) -> Trace:
    """Run a scenario, recording all signals or those of `keep` (with `claim.given`).  Raises `ModelError` when it names what is not there or breaks an assumption of the claim."""
    system = observed(problem)
    names = [f.name for f in problem.faults]
    for name in script.present:
        if name not in names:
            raise ModelError(f"{problem.claim.id}: the scenario wants the fault {name!r}; {nearest(name, names)}")
    present = {present_name(i): fault.name in script.present for i, fault in enumerate(problem.faults)}
    usual = {path: p.default for path, p in system.settings.items() if path in system.state}
    chosen = usual | {path: value for path, value in present.items() if path in system.state}
    unknown = [n for n in script.inputs if n not in system.inputs]
    if unknown:
        raise ModelError(f"{problem.claim.id}: the scenario sets {unknown[0]!r}; {nearest(unknown[0], system.inputs)}")

    fixed: dict[str, Any] = {}
    moving: dict[str, Callable[[int], Any]] = {path: (lambda k: k >= script.at) for path in system.inputs if path.endswith(".now")}
    for path, var in system.inputs.items():
        point = path.split(".", 1)[-1].removesuffix(".value")
        wanted = script.inputs.get(path, script.values.get(point, _low(var)))
        if callable(wanted):
            moving[path] = wanted
        elif path not in moving:
            fixed[path] = wanted
    rows: dict[tuple[Any, ...], dict[str, Any]] = {}

    def row(k: int) -> dict[str, Any]:
        now = tuple(f(k) for f in moving.values())
        if now not in rows:
            rows.clear()
            rows[now] = fixed | dict(zip(moving, now, strict=True))
        return rows[now]

    trace = run(system, row, script.steps, start={**chosen, **script.start}, keep=keep)
    broken = [k for k, ok in enumerate(trace["claim.given"]) if not ok]
    if broken:
        raise ModelError(f"{problem.claim.id}: the scenario breaks an assumption of the claim at step {broken[0]}")
    return trace


def with_faults(problem: Problem, names: Sequence[str]) -> Problem:
    """The problem with just these faults in the equipment: the others are folded away, the rest is as it was."""
    present = zip(problem.faults, problem.faulted.present, strict=True)
    fixed = {there.uid: bit(fault.name in names) for fault, there in present if there.op == "var"}
    holds, premise, given = (cast(Bit, t) for t in substitute([problem.holds, problem.premise, problem.given], fixed))
    system = problem.system.mapped(lambda terms: substitute(terms, fixed))
    return replace(problem, system=system, holds=holds, premise=premise, given=given)


def cut_at(trace: Trace, signal: str, value: bool) -> Trace | None:
    """The run up to the first step at which a signal has a value; None when it never has."""
    if value not in trace[signal]:
        return None
    last = trace[signal].index(value)
    return Trace(trace.system, last + 1, {p: v[: last + 1] for p, v in trace.columns.items()}, trace.chosen)

"""Counterexamples and witnesses: bounded search, scripted scenarios, and replay on the Python reading.

Nothing is called a counterexample before it has been run on the Python reading and broken the claim there.
"""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, cast

from safety.faults import now_name, present_name
from safety.prove.claims import Scenario
from safety.prove.problem import Problem, observed
from safety.prove.simplest import simple_one
from safety.prove.solve import SAT, UNKNOWN, Disagreement, Solver, Unrolling
from safety.system import ANY, ModelError, nearest, substitute
from safety.terms import Bit, TermError
from safety.terms.graph import REAL, Sort
from safety.terms.values import bit
from safety.trace import Trace, least, run

# Whole numbers up to 16, then halves, quarters and eighths, small ones first.
PLAIN = [Fraction(0)] + [
    Fraction(sign * n, parts)
    for parts in (1, 2, 4, 8)
    for n in range(1, 16 * parts + 1)
    for sign in (1, -1)
    if parts == 1 or n % 2
]


@dataclass
class Found:
    """Result of a search: a replayed run that ends where the target holds, or the number of steps searched in full.

    A search that is not `complete` stopped early, and `why` says what for.
    """

    run: Trace | None
    searched: int
    complete: bool = True
    why: str = ""


def bounded(
    problem: Problem,
    target: Bit,
    steps: int,
    integers: bool,
    timeout: float,
    done: Callable[[int], None] | None = None,
    until: float = math.inf,
) -> Found:
    """Look for the shortest run whose last step satisfies `target`, up to `steps` steps; then the smallest of those.

    `searched` counts the steps shown free of the target; `done` is told that number as it grows.  The run does not
    depend on the solver (reals that no fraction is apart).  No further step is searched once the monotonic clock
    shows `until`.
    """
    unrolling = Unrolling(problem.system, "z3", integers)
    asked = Solver("z3", unrolling.k, timeout, finite=not integers)
    asked.add(*unrolling.at(0, [problem.start]))
    for k in range(steps):
        if time.monotonic() > until:
            return Found(None, k, complete=False, why=f"the time was up at step {k}")
        given, hit = unrolling.at(k, [problem.given, target])
        asked.add_ranges(unrolling)
        asked.add(given)
        asked.push()
        asked.add(hit)
        answer = asked.check()
        if answer == SAT:
            try:
                values = _smallest(problem, unrolling, asked, k)
            except TermError as error:  # a number that no run can be given
                return Found(None, k, complete=False, why=str(error))
            return Found(replay(problem, values, k + 1, target), k)
        asked.pop()
        if answer == UNKNOWN:
            return Found(None, k, complete=False, why=f"the solver gave no answer at step {k}: {asked.why}")
        asked.add(unrolling.k.Not(hit))
        if done is not None:
            done(k + 1)
    return Found(None, steps)


def run_of_length(problem: Problem, target: Bit, steps: int, integers: bool, timeout: float) -> Found:
    """Look for a run of so many steps whose last satisfies `target`, the smallest; shorter ones are not asked for."""
    unrolling = Unrolling(problem.system, "z3", integers)
    asked = Solver("z3", unrolling.k, timeout, finite=not integers)
    asked.add(*unrolling.at(0, [problem.start]))
    for k in range(steps):
        asked.add(*unrolling.at(k, [problem.given]))
    asked.add(*unrolling.at(steps - 1, [target]))
    asked.add_ranges(unrolling)
    answer = asked.check()
    if answer != SAT:
        return Found(None, 0, answer != UNKNOWN, asked.why or f"there is no run of {steps} steps")
    try:
        values = _smallest(problem, unrolling, asked, steps - 1)
    except TermError as error:
        return Found(None, 0, complete=False, why=str(error))
    return Found(replay(problem, values, steps, target), 0)


def _smallest(problem: Problem, unrolling: Unrolling, asked: Solver, last: int) -> dict[tuple[str, int], Any]:
    """Fix the free choices one by one, each to its least value: the result does not depend on the solver."""
    free = [(s.path, s.var, 0) for s in problem.system.states if s.power_up is ANY]
    free += [(path, var, k) for k in range(last + 1) for path, var in problem.system.inputs.items()]
    values: dict[tuple[str, int], Any] = {}
    model = asked.model()
    for path, var, k in free:
        expression = unrolling.contexts[k].known.get(var.uid)
        if expression is not None:
            shrink = _simple_real if var.sort == REAL else _least
            values[path, k], model = shrink(unrolling, asked, model, expression, var.sort)
    return values


def _least(unrolling: Unrolling, asked: Solver, model: Any, expression: Any, sort: Sort) -> tuple[Any, Any]:
    """The least value that the expression can take, and a model with it; asserted from then on."""
    value = unrolling.encoder.value(model, expression, sort)
    low = sort.bounds[0]
    while value > low:
        middle = (low + int(value)) // 2
        smaller = _model_with(asked, _at_most(unrolling, expression, sort, middle))
        if smaller is None:
            low = middle + 1
        else:
            model = smaller
            value = unrolling.encoder.value(model, expression, sort)
    asked.add(expression == value)
    return value, model


def _simple_real(unrolling: Unrolling, asked: Solver, model: Any, expression: Any, sort: Sort) -> tuple[Any, Any]:
    """The first of the plain numbers that will do, else a simple fraction: runs do not depend on the solver's models.

    Where there is none, it is a fraction near the model's value; `TermError` when no fraction will do.
    """
    k = unrolling.k

    def exactly(x: Fraction) -> Any:
        return expression == k.RealVal(str(x))

    def meets(low: Fraction, high: Fraction) -> bool:
        within = (
            exactly(low)
            if low == high
            else k.And(k.RealVal(str(low)) <= expression, expression <= k.RealVal(str(high)))
        )
        return _model_with(asked, within) is not None

    value = next((x for x in PLAIN if meets(x, x)), None)
    value = simple_one(meets) if value is None else value
    if value is None:
        found = model.eval(expression, model_completion=True)
        near = [Fraction(found.approx(n).as_fraction()) for n in (3, 9, 27)] if k.is_algebraic_value(found) else []
        value = next((x for x in near if meets(x, x)), None)
    if value is None:
        value = cast(Fraction, unrolling.encoder.value(model, expression, sort))
    now = _model_with(asked, exactly(value))
    asked.add(exactly(value))
    return value, model if now is None else now


def _model_with(asked: Solver, condition: Any) -> Any:
    """A model of what is asserted and of a condition; None when there is none, or none is found in time."""
    asked.push()
    asked.add(condition)
    model = asked.model() if asked.check() == SAT else None
    asked.pop()
    return model


def _at_most(unrolling: Unrolling, expression: Any, sort: Sort, value: Any) -> Any:
    k = unrolling.k
    if sort.kind == "bit":
        return expression if value else k.Not(expression)
    if unrolling.encoder.integers or sort.kind == "int":
        return expression <= value
    return k.ULE(expression, k.BitVecVal(value, sort.width))


def replay(problem: Problem, values: Mapping[tuple[str, int], Any], steps: int, target: Bit) -> Trace:
    """Run the Python reading on a solver's choices.

    Raises `Disagreement` when the target is not met at the last step.
    """
    whole = observed(problem)
    system = replace(whole, signals={**whole.signals, "claim.target": target})
    start = {path: v for (path, k), v in values.items() if k == 0 and path in system.state}

    def row(k: int) -> dict[str, Any]:
        return {path: values.get((path, k), least(var.sort)) for path, var in system.inputs.items()}

    try:
        trace = run(system, row, steps, start=start)
    except ModelError as error:
        raise Disagreement(f"{problem.claim.id}: the solver's run of {steps} steps cannot be run: {error}") from error
    if not trace["claim.target"][-1] or not all(trace["claim.given"]):
        raise Disagreement(
            f"{problem.claim.id}: the solver's run of {steps} steps does not do on the Python reading what it should"
        )
    columns = {path: column for path, column in trace.columns.items() if path != "claim.target"}
    return Trace(whole, trace.steps, columns, trace.chosen)


def again(problem: Problem, run: Trace) -> Trace:
    """A counterexample that was run elsewhere, run here.  Raises `Disagreement` when it breaks nothing here."""
    values = {(path, 0): value for path, value in run.chosen.items()}
    values |= {(path, k): run[path][k] for path in problem.system.inputs for k in range(len(run))}
    return replay(problem, values, len(run), ~problem.holds)


def scripted(problem: Problem, script: Scenario, keep: Sequence[str] | None = None) -> Trace:
    """Run a scenario, recording all signals or those of `keep` (with `claim.given`).

    Raises `ModelError` when it names what is not there or breaks an assumption of the claim.
    """
    system = observed(problem)
    names = [f.name for f in problem.faults]
    for name in script.present:
        if name not in names:
            raise ModelError(f"{problem.claim.id}: the scenario wants the fault {name!r}; {nearest(name, names)}")
    for name in script.inputs:
        if name not in system.inputs:
            raise ModelError(f"{problem.claim.id}: the scenario sets {name!r}; {nearest(name, system.inputs)}")
    present = {present_name(i): fault.name in script.present for i, fault in enumerate(problem.faults)}
    start = {path: value for path, value in present.items() if path in system.state} | dict(script.start)
    fixed, moving = _choices(problem, script)
    functions = list(dict.fromkeys(moving.values()))
    rows: dict[tuple[Any, ...], dict[str, Any]] = {}

    def row(k: int) -> dict[str, Any]:
        now = tuple([f(k) for f in functions])
        if now not in rows:
            rows.clear()
            by_function = dict(zip(functions, now, strict=True))
            rows[now] = fixed | {path: by_function[f] for path, f in moving.items()}
        return rows[now]

    trace = run(system, row, script.steps, start=start, keep=keep)
    broken = [k for k, ok in enumerate(trace["claim.given"]) if not ok]
    if broken:
        raise ModelError(f"{problem.claim.id}: the scenario breaks an assumption of the claim at step {broken[0]}")
    return trace


def _choices(problem: Problem, script: Scenario) -> tuple[dict[str, Any], dict[str, Callable[[int], Any]]]:
    """Inputs of a scenario by name: those that stay, and those that are a function of the step.

    A fault's choices within a step of several (`... (step 0)`) are all that of the step.
    """

    def begun(step: int) -> bool:
        return step >= script.at

    fixed: dict[str, Any] = {}
    moving: dict[str, Callable[[int], Any]] = {}
    values = dict(script.values)
    onsets, places = {now_name(i) for i in range(len(problem.faults))}, set()
    free = set(problem.faulted.choices)
    for path, var in problem.system.inputs.items():
        wanted: Any = least(var.sort)
        if path in script.inputs:
            wanted = script.inputs[path]
        elif path in free:
            base = re.sub(r" \(step \d+\)$", "", path)
            place = base.partition(".")[2].removesuffix(".value")
            places.add(place)
            wanted = begun if base in onsets else values.get(place, wanted)
        if callable(wanted):
            moving[path] = wanted
        else:
            fixed[path] = wanted
    for place in values:
        if place not in places:
            raise ModelError(f"{problem.claim.id}: the scenario gives values at {place!r}; {nearest(place, places)}")
    return fixed, moving


def with_faults(problem: Problem, names: Sequence[str]) -> Problem:
    """The problem with just these faults in the equipment: the others are folded away, the rest is as it was."""
    present = zip(problem.faults, problem.faulted.present, strict=True)
    fixed = {there.uid: bit(fault.name in names) for fault, there in present if there.op == "var"}
    terms = substitute([problem.holds, problem.given, *problem.premises], fixed)
    holds, given, *premises = (cast(Bit, t) for t in terms)
    system = problem.system.mapped(lambda terms: substitute(terms, fixed))
    return replace(problem, system=system, holds=holds, premises=tuple(premises), given=given)


def cut_at(trace: Trace, signal: str, value: bool) -> Trace | None:
    """The run up to the first step at which a signal has a value; None when it never has."""
    if value not in trace[signal]:
        return None
    last = trace[signal].index(value)
    return Trace(trace.system, last + 1, {p: v[: last + 1] for p, v in trace.columns.items()}, trace.chosen)


def first(trace: Trace, signal: str) -> int | None:
    """The first step at which a signal is true; None when it never is."""
    return trace[signal].index(True) if True in trace[signal] else None

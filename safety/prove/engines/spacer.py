"""Spacer, z3's property-directed reachability, on the problem as constrained Horn clauses over integers.

    power-up, start           =>  Inv(registers)
    Inv(registers), given     =>  Inv(next registers)
    Inv(registers), given, not holds  =>  false

A solution for Inv is an inductive invariant, and is taken back into terms and checked like one that a user has written.
(Komuravelli, Gurfinkel, Chaki, SMT-Based Model Checking for Recursive Programs, 2014.)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

from safety.export.transition import Transition, transition
from safety.prove.claims import REFUTED
from safety.prove.engines.engine import Budget, Engine, Result, proved_by, uses_reals, without_z3
from safety.prove.engines.terms_of import NoTerm, conjuncts
from safety.prove.problem import Problem
from safety.prove.search import run_of_length
from safety.prove.solve import SAT, UNSAT
from safety.system import ANY
from safety.terms import Bit, Term
from safety.terms.graph import Value
from safety.terms.smt import Encoder, solver_module
from safety.terms.values import const

NAME = "spacer"
STEP = "step"
CHECK = 0.3  # of the time, kept for checking the answer
AS_WRITTEN = {"xform.slice": False, "xform.inline_linear": False, "xform.inline_eager": False}


def run(problem: Problem, budget: Budget) -> Result:
    """Ask Spacer; a counterexample's inputs are then found for the length that it gives."""
    what = transition(problem, words_as_integers=True)
    k = solver_module("z3")
    engine = k.Fixedpoint()
    engine.set(engine="spacer", timeout=int((1 - CHECK) * 1000 * budget.left), **AS_WRITTEN)
    invariant, violated = _rules(k, engine, what)
    try:
        answer = str(engine.query(violated))
    except k.Z3Exception as error:
        told = error.args[0]
        return Result(NAME, why=f"it gave up: {told.decode() if isinstance(told, bytes) else told}")
    if answer == UNSAT:
        found, why = _solutions(k, engine, invariant, [s.var for s in what.states])
        return proved_by(NAME, problem, found, True, budget, why)
    if answer == SAT:
        names = engine.get_rule_names_along_trace()
        return _violation(problem, 1 + sum(str(name) == STEP for name in names), budget)
    return Result(NAME, why=f"no answer: {engine.reason_unknown()}")


def _rules(k: Any, engine: Any, what: Transition) -> tuple[Any, Any]:
    """State the clauses; the relation of the registers, and the one that says that the property is violated."""
    encoder = Encoder("z3", integers=True)
    registers = encoder([s.var for s in what.states])
    promised = list(encoder.ranges)
    following = encoder([s.next for s in what.states])
    fixed = [s for s in what.states if s.power_up is not ANY]
    begun = encoder([const(cast(Value, s.power_up), s.var.sort) for s in fixed])
    power_up = [encoder([s.var])[0] == value for s, value in zip(fixed, begun, strict=True)]
    start, given, holds = encoder([what.start, what.given, what.holds])
    inputs = encoder(what.inputs)
    invariant = k.Function("Inv", *(value.sort() for value in registers), k.BoolSort())
    violated = k.Function("Violated", k.BoolSort())
    engine.register_relation(invariant, violated)
    engine.declare_var(*registers, *inputs)
    engine.rule(invariant(*registers), k.And(*power_up, *promised, start), "start")
    engine.rule(invariant(*following), k.And(invariant(*registers), given), STEP)
    engine.rule(violated(), k.And(invariant(*registers), given, k.Not(holds)), "violation")
    return invariant, violated()


def _solutions(k: Any, engine: Any, invariant: Any, registers: Sequence[Term]) -> tuple[list[dict[str, Bit]], str]:
    """The invariants in Spacer's answer that are terms, and what to say where none is.

    There are two: what it keeps of the relation of the registers, and `for all x, Inv(x) == formula`.  Where clauses
    were simplified away only the second is right; it is the longer one, and may have quantifiers.
    """
    told = [(engine.get_cover_delta(-1, invariant), dict(enumerate(registers)))]
    answer = engine.get_answer()
    for one in answer.children() if k.is_and(answer) else [answer]:
        equation = one.body() if k.is_quantifier(one) else one
        if k.is_eq(equation) and equation.arg(0).decl().eq(invariant):
            left, right = equation.children()
            told.append((right, {k.get_var_index(x): r for x, r in zip(left.children(), registers, strict=True)}))
    found, why = [], ""
    for formula, leaves in told:
        try:
            parts = conjuncts(k, formula, leaves)
            found.append({f"{NAME} {n + 1}": part for n, part in enumerate(parts)})
        except NoTerm as error:
            why = str(error)
    return found, why


def _violation(problem: Problem, steps: int, budget: Budget) -> Result:
    """A run of the length that Spacer says; it is searched for again, as Spacer does not say the inputs."""
    found = run_of_length(problem, ~problem.holds, steps, uses_reals(problem), budget.left)
    if found.run is None:
        return Result(NAME, why=f"it speaks of a violation after {steps} steps, but none was found: {found.why}")
    return Result(NAME, REFUTED, trace=found.run, steps=steps, agreed_by=(NAME, "z3"))


ENGINE = Engine(NAME, without_z3, run)

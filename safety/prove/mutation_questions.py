"""Mutants put to a solver all at once: for which an obligation fails, which break a claim within a search.

In one solver the register SELECTOR is free: an answer names a mutant, which is set aside, until the rest is shown to
behave.  Mutant 0, the model as it is, goes along as a control.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, cast

from safety.prove.induction import Obligation, invariance, property_obligations
from safety.prove.mutation import SELECTOR, Mutant, meant
from safety.prove.mutation_runs import only, outputs_of
from safety.prove.problem import Problem
from safety.prove.solve import SAT, UNKNOWN, UNSAT, Solver, Unrolling
from safety.system import ANY, System, substitute
from safety.terms import Bit
from safety.terms.graph import BIT, Term, postorder, rewrite, variable
from safety.terms.values import all_of, build, const

AS_WRITTEN = 0


@dataclass
class Split:
    """Mutants by answer: those that `failed` (and at what), those that `kept` to it, those `open` and why."""

    failed: dict[int, str] = field(default_factory=dict)
    kept: set[int] = field(default_factory=set)
    open: dict[int, str] = field(default_factory=dict)


def cone(problem: Problem) -> tuple[set[int], set[str]]:
    """What a claim can see: the mutants and the registers that its formulas depend on, now or later."""
    following = problem.system.state
    edge: list[Term] = [problem.holds, problem.given, *problem.premises, *problem.lemmas.values()]
    met: set[int] = set()
    mutants: set[int] = set()
    registers: set[str] = set()
    while edge:
        terms = postorder(edge, met)
        met |= {t.uid for t in terms}
        mutants |= {number for t in terms if (number := meant(t)) is not None}
        reached = [following[t.attr] for t in terms if t.op == "var" and t.attr in following]
        registers |= {s.path for s in reached}
        edge = [s.next for s in reached if s.next.uid not in met]
    return mutants, registers


def with_open_power_up(problem: Problem, mutants: Sequence[Mutant]) -> Problem:
    """The problem whose registers hold at power-up what the chosen mutant says."""
    selector = problem.system.state[SELECTOR].var
    start, states = problem.start, dict(problem.system.state)
    held: dict[str, Term] = {}
    for mutant in mutants:
        if mutant.power_up is None or (path := mutant.power_up[0]) not in states:
            continue
        state = states[path]
        if state.power_up is not ANY:
            sort = state.var.sort
            before = held.get(path, const(cast(Any, state.power_up), sort))
            chosen = build("eq", (selector, const(mutant.number, selector.sort)), None, BIT)
            held[path] = build("select", (chosen, const(mutant.power_up[1], sort), before), None, sort)
    for path, value in held.items():
        start &= cast(Bit, build("eq", (states[path].var, value), None, BIT))
        states[path] = replace(states[path], power_up=ANY)
    return replace(problem, system=replace(problem.system, states=tuple(states.values())), start=start)


class _Question:
    """A solver in which the mutant is one of some."""

    def __init__(
        self, system: System, anywhere: bool, numbers: Collection[int], integers: bool, timeout: float
    ) -> None:
        self.unrolling = Unrolling(system, "z3", integers, anywhere)
        self.asked = Solver("z3", self.unrolling.k, timeout, finite=not integers)
        self.sort = system.state[SELECTOR].var.sort
        self.choice = self.unrolling.at(0, [system.state[SELECTOR].var])[0]
        self.asked.add(self.unrolling.k.Or(*(self.choice == n for n in sorted(numbers))))

    def assume(self, step: int, formulas: Sequence[Bit]) -> None:
        self.asked.add(*self.unrolling.at(step, formulas))

    def one(self) -> int | str:
        """A mutant for which what is asserted can happen, which is then set aside; or the solver's answer."""
        self.asked.add_ranges(self.unrolling)
        answer = self.asked.check()
        if answer != SAT:
            return answer
        number = self.unrolling.encoder.value(self.asked.model(), self.choice, self.sort)
        self.asked.add(self.choice != number)
        return int(number)


def split(system: System, one: Obligation, numbers: Collection[int], integers: bool, timeout: float) -> Split:
    """For which mutants an obligation fails."""
    question = _Question(system, one.anywhere, numbers, integers, timeout)
    for step, formulas in one.assumed:
        question.assume(step, formulas)
    question.assume(one.step, [~one.shown])
    result, left = Split(), set(numbers)
    while left:
        answer = question.one()
        if answer == UNSAT:
            result.kept = left
            break
        if answer == UNKNOWN:
            result.open = dict.fromkeys(left, f"{one.label}: {question.asked.why}")
            break
        result.failed[cast(int, answer)] = one.label
        left.discard(cast(int, answer))
    return result


def in_either_reading(question: Callable[[set[int], bool], Split], numbers: Collection[int], reals: bool) -> set[int]:
    """The mutants that a question keeps: asked in bit-vectors, of what that leaves open in integers.

    Two steps that share nearly all are told to be the same far sooner bit by bit; reals have no bits.
    """
    left, kept = set(numbers), set[int]()
    for integers in (True,) if reals else (False, True):
        found = question(left, integers)
        kept |= found.kept
        left = set(found.open)
        if not left:
            break
    return kept


def still_proved(problem: Problem, numbers: Collection[int], integers: bool, timeout: float) -> Split | None:
    """For which mutants the claim's proof still goes through, with the same lemmas and no greater depth.

    None when it does not for the model as it is.
    """
    some = only(problem, numbers)
    result = Split(kept={AS_WRITTEN, *numbers})
    for one in invariance(some):
        _narrow(result, split(some.system, one, result.kept, integers, timeout))
        if AS_WRITTEN not in result.kept:
            return None
    base = result
    for depth in range(problem.claim.induction + 1):
        result = Split(dict(base.failed), set(base.kept), dict(base.open))
        for one in property_obligations(some, depth):
            _narrow(result, split(some.system, one, result.kept, integers, timeout))
            if AS_WRITTEN not in result.kept:
                break
        else:
            result.kept.discard(AS_WRITTEN)
            return result
    return None


def _narrow(result: Split, found: Split) -> None:
    result.failed |= found.failed
    result.open |= found.open
    result.kept = found.kept


def breakable(
    problem: Problem, target: Bit, numbers: Collection[int], steps: int, integers: bool, timeout: float
) -> Split:
    """For which mutants a run of up to `steps` steps meets a target (`failed`, with its length); the others `kept`.

    `timeout` is that of the whole search.
    """
    question = _Question(problem.system, False, numbers, integers, timeout)
    question.assume(0, [problem.start])
    result, left, end = Split(), set(numbers), time.monotonic() + timeout
    for k in range(steps):
        if time.monotonic() > end:
            result.open = dict.fromkeys(left, f"searched {k} steps in {timeout:g} s")
            return result
        question.assume(k, [problem.given])
        hit = question.unrolling.at(k, [target])[0]
        question.asked.add_ranges(question.unrolling)
        question.asked.push()
        question.asked.add(hit)
        found: list[int] = []
        while left:
            answer = question.one()
            if answer == UNKNOWN:
                result.open = dict.fromkeys(left, f"no answer at step {k}: {question.asked.why}")
                return result
            if answer == UNSAT:
                break
            result.failed[cast(int, answer)] = f"after {k + 1} steps"
            found.append(cast(int, answer))
            left.discard(cast(int, answer))
        question.asked.pop()
        if not left:
            break
        question.asked.add(*(question.choice != n for n in found), question.unrolling.k.Not(hit))
    result.kept = left
    return result


# --- mutants that do what the model as it is does --------------------------------------------------------------------


def same_step(system: System, terms: Sequence[Term]) -> Bit:
    """Whether the mutant's registers after a step, the outputs of the whole and some terms are those as written."""
    selector = system.state[SELECTOR].var
    outputs = [system.signals[path] for path in outputs_of(system)]
    mutated = [*(s.next for s in system.states if s.path != SELECTOR), *outputs, *terms]
    original = substitute(mutated, {selector.uid: const(AS_WRITTEN, selector.sort)})
    return all_of(
        *(cast(Bit, build("eq", (x, y), None, BIT)) for x, y in zip(mutated, original, strict=True) if x is not y)
    )


def cut_at_points(system: System) -> tuple[System, list[Term]]:
    """The system whose points are free, as if any fault acted there; and what healthy points would carry."""
    free: dict[str, Term] = {}
    carried: dict[str, Term] = {}

    def rule(old: Term, args: tuple[Term, ...]) -> Term:
        if old.op == "point":
            carried[old.attr] = args[0]
            return free.setdefault(old.attr, variable(f"value of {old.attr}", old.sort))
        return build(old.op, args, old.attr, old.sort) if old.args else old

    loose = system.mapped(lambda terms: rewrite(terms, rule))
    inputs = dict(system.inputs) | {str(v.attr): v for v in free.values()}
    return replace(loose, inputs=inputs, points={}), list(carried.values())


def equivalent(mutants_system: System, numbers: Collection[int], integers: bool, timeout: float) -> Split:
    """Which mutants step as the model as it is does, from any register content and whatever faults act at points."""
    loose, carried = cut_at_points(mutants_system)
    assumed = (mutants_system.start, *(cast(Bit, a) for a in loose.assumptions.values()))
    shown = same_step(loose, carried)
    return split(loose, Obligation("the same step", True, ((0, assumed),), 0, shown), numbers, integers, timeout)


def equivalent_for(
    problem: Problem, numbers: Collection[int], integers: bool, timeout: float, known: Sequence[Bit] = ()
) -> Split:
    """Which mutants step as the model as it is does in all states that a claim's lemmas and assumptions leave.

    `known` are further invariants of the model as it is.
    """
    some = only(problem, numbers)
    selector = some.system.state[SELECTOR].var
    assumed = substitute([some.given, *some.lemmas.values(), *known], {selector.uid: const(AS_WRITTEN, selector.sort)})
    shown = same_step(some.system, [some.holds, some.given, *some.premises])
    one = Obligation("the same step", True, ((0, tuple(cast(list[Bit], assumed))),), 0, shown)
    return split(some.system, one, numbers, integers, timeout)


def same_from_power_up(problem: Problem, mutant: Mutant, integers: bool, timeout: float) -> bool:
    """Whether a register's other value at power-up shows nowhere at the first step and is gone after it.

    The problem is that of the model as it is, with which the mutant shares all but this value.
    """
    path, value = cast(tuple[str, Any], mutant.power_up)
    system = problem.system
    if path not in system.state:
        return True
    var = system.state[path].var
    outputs = [system.signals[name] for name in outputs_of(system)]
    read = [*(s.next for s in system.states), *outputs, problem.holds, problem.given, *problem.premises, problem.start]
    original = substitute(read, {var.uid: const(cast(Any, system.state[path].power_up), var.sort)})
    changed = substitute(read, {var.uid: const(value, var.sort)})
    same = all_of(*(cast(Bit, build("eq", pair, None, BIT)) for pair in zip(original, changed, strict=True)))
    unrolling = Unrolling(system, "z3", integers)
    asked = Solver("z3", unrolling.k, timeout, finite=not integers)
    asked.add(*unrolling.at(0, [problem.given, problem.start, ~same]))
    asked.add_ranges(unrolling)
    return asked.check() == UNSAT

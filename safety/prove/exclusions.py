"""Which wires of a model exclude or need one another, which words are 0 with them: guessed, and proved by induction."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, permutations
from typing import cast

from safety.prove.problem import Problem
from safety.prove.solve import SAT, UNSAT, Solver, Unrolling
from safety.terms import Bit, UInt, implies
from safety.terms.graph import BIT, REAL, postorder

MOST = 40  # registers of which pairs are tried


def exclusions(problem: Problem, timeout: float) -> tuple[Bit, ...]:
    """Invariants of the registers of one bit, alone and in pairs, and with words of 0, that are inductive together.

    `timeout` in seconds is for one question; none where a question stays open.
    """
    states = problem.system.states
    wires = [cast(Bit, s.var) for s in states if s.var.sort == BIT and s.next is not s.var][:MOST]
    guesses = [*wires, *(~w for w in wires)]
    guesses += [~(x & y) for x, y in combinations(wires, 2)]
    guesses += [implies(x, y) for x, y in permutations(wires, 2)]
    words = [cast(UInt, s.var) for s in states if s.var.sort.kind == "uint" and s.next is not s.var][:MOST]
    guesses += [implies(x, w == 0) for w in words for wire in wires for x in (wire, ~wire)]
    integers = any(t.sort == REAL for t in postorder([problem.given, problem.start, *problem.system.roots()]))
    return tuple(_kept(problem, _kept(problem, guesses, integers, timeout, step=0), integers, timeout, step=1))


def _kept(problem: Problem, guesses: Sequence[Bit], integers: bool, timeout: float, step: int) -> Sequence[Bit]:
    """The guesses that hold at power-up (step 0), or that a step keeps where all of them hold (step 1)."""
    unrolling = Unrolling(problem.system, "z3", integers, anywhere=step == 1)
    k, before = unrolling.k, unrolling.at(0, guesses)
    after = unrolling.at(step, guesses)
    base = unrolling.at(0, [problem.given, *([] if step else [problem.start])])
    left = list(range(len(guesses)))
    while left:
        asked = Solver("z3", k, timeout, finite=not integers)
        asked.add(*base, *((before[i] for i in left) if step else ()), k.Or(*(k.Not(after[i]) for i in left)))
        asked.add_ranges(unrolling)
        answer = asked.check()
        if answer == UNSAT:
            break
        if answer != SAT:
            return ()
        model = asked.model()
        left = [i for i in left if k.is_true(model.eval(after[i], model_completion=True))]
    return [guesses[i] for i in left]

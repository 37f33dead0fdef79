"""For how long what a claim assumes can be kept: of steps that no run reaches, a claim says nothing."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

from safety.prove.falsify import reach
from safety.prove.problem import Problem
from safety.prove.solve import SAT, UNSAT, Solver, Unrolling
from safety.system import State
from safety.terms import UInt, select
from safety.terms.graph import uint, variable, variables

TRY = 1.0  # seconds to look for a run by simulation, which is cheaper than to ask


def ends_after(problem: Problem, steps: int, integers: bool, timeout: float) -> int | None:
    """The number of steps, below `steps`, for which a run can keep the assumptions; None where no such end is found.

    Assumptions that read no changing register can be kept for ever if they can at all, and a witness keeps them as long
    as it runs.  `timeout` in seconds is for a question; one that stays open finds no end.
    """
    moving = {s.var.uid for s in problem.system.states if s.next is not s.var}
    witness = problem.claim.witness
    if (witness is not None and witness.steps >= steps) or not any(v.uid in moving for v in variables([problem.given])):
        return None
    if _kept_in_simulation(problem, steps):
        return None
    unrolling = Unrolling(problem.system, "z3", integers)

    def answer(length: int) -> str:
        asked = Solver("z3", unrolling.k, timeout, finite=not integers)
        asked.add(*unrolling.at(0, [problem.start]))
        for k in range(length):
            asked.add(*unrolling.at(k, [problem.given]))
        asked.add_ranges(unrolling)
        return asked.check()

    if answer(steps) != UNSAT:
        return None
    return next((k for k in reversed(range(steps)) if answer(k) == SAT), None)


def _kept_in_simulation(problem: Problem, steps: int) -> bool:
    """Whether simulation soon meets a run of so many steps; such a run is one, whatever else there is."""
    width = steps.bit_length()
    taken = cast(UInt, variable("watch.taken", uint(width)))
    counts = State(taken, select(taken < steps, (taken + 1).low(width), taken), 0)
    system = replace(problem.system, states=(*problem.system.states, counts))
    return reach(replace(problem, system=system), taken == steps - 1, steps, TRY) is not None

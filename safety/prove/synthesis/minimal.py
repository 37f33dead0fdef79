"""From an inductive set of lemmas to the few that a property rests on: unsatisfiable cores, followed backwards."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from safety.prove.induction import Obligation, property_obligations
from safety.prove.problem import Problem
from safety.prove.solve import UNSAT, Solver, Unrolling
from safety.terms import Bit

PATIENCE = 10.0  # seconds for one question


def needed(problem: Problem, lemmas: Mapping[str, Bit], depth: int, integers: bool) -> dict[str, Bit]:
    """The lemmas that the property at this depth of induction needs, and those that these need to be kept by a step.

    All of them where the solver gives no core.
    """
    proved = replace(problem, lemmas={})
    wanted: set[str] = set()
    for obligation in property_obligations(proved, depth):
        core = _core(problem, lemmas, obligation, integers) if obligation.anywhere else set()
        if core is None:
            return dict(lemmas)
        wanted |= core
    edge = sorted(wanted)
    for name in edge:  # grows while it is walked
        kept = Obligation(name, True, ((0, (problem.given,)),), 1, lemmas[name])
        core = _core(problem, lemmas, kept, integers)
        if core is None:
            return dict(lemmas)
        edge += sorted(core - wanted)
        wanted |= core
    return {name: lemma for name, lemma in lemmas.items() if name in wanted}


def _core(problem: Problem, lemmas: Mapping[str, Bit], obligation: Obligation, integers: bool) -> set[str] | None:
    unrolling = Unrolling(problem.system, "z3", integers, obligation.anywhere)
    asked = Solver("z3", unrolling.k, PATIENCE)
    for step, formulas in obligation.assumed:
        asked.add(*unrolling.at(step, formulas))
    asked.add(unrolling.k.Not(unrolling.at(obligation.step, [obligation.shown])[0]))
    names = {f"lemma {i}": name for i, name in enumerate(lemmas)}
    flags: Sequence[Any] = [unrolling.k.Bool(n) for n in names]
    for flag, lemma in zip(flags, unrolling.at(0, list(lemmas.values())), strict=True):
        asked.add(unrolling.k.Implies(flag, lemma))
    asked.add_ranges(unrolling)
    asked.raw.set("core.minimize", True)
    if str(asked.raw.check(*flags)) != UNSAT:
        return None
    return {names[str(flag)] for flag in asked.raw.unsat_core()}

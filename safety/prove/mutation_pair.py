"""A mutant beside the model as it is: the shortest run in which both differ."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

from safety.prove import search
from safety.prove.mutation import Mutant
from safety.prove.mutation_runs import outputs_of, single
from safety.prove.problem import Problem
from safety.system import ANY, State, substitute
from safety.terms import Bit
from safety.terms.graph import BIT, Term, variable
from safety.terms.values import all_of, any_of, bit, build
from safety.trace import Trace

BESIDE = "mutant: "  # before the names of the mutant's registers and outputs


def difference(
    problem: Problem, mutant: Mutant, steps: int, integers: bool, timeout: float
) -> tuple[Trace, str] | None:
    """A replayed run, and the register or output in which both differ at its end; both keep what the problem assumes.

    `problem` is that of all mutants.  None when the search of `steps` steps finds no such run.
    """
    written, changed = single(problem, None), single(problem, mutant)
    moving = [s for s in written.system.states if s.next is not s.var]
    other = {s.var.uid: variable(BESIDE + s.path, s.var.sort) for s in moving}
    beside = changed.system.mapped(lambda terms: substitute(terms, other))
    states = [State(other[s.var.uid], s.next, s.power_up) for s in beside.states if s.var.uid in other]
    given, start = cast(list[Bit], substitute([changed.given, changed.start], other))
    shown = {path: beside.signals[path] for path in outputs_of(beside)}
    differ = {s.path: _differ(s.var, other[s.var.uid]) for s in moving}
    differ |= {path: _differ(written.system.signals[path], term) for path, term in shown.items()}
    alike = all_of(*(~differ[s.path] for s in moving if s.power_up is ANY))
    signals = dict(written.system.signals) | {BESIDE + path: term for path, term in shown.items()}
    both = replace(written.system, states=(*written.system.states, *states), signals=signals)
    question = replace(
        written, system=both, holds=bit(True), premises=(bit(True),), lemmas={},
        given=written.given & given, start=written.start & start & alike,
    )  # fmt: skip
    run = search.bounded(question, any_of(*differ.values()), steps, integers, timeout).run
    if run is None:
        return None
    return run, next(path for path in differ if run[path][-1] != run[BESIDE + path][-1])


def _differ(x: Term, y: Term) -> Bit:
    return ~cast(Bit, build("eq", (x, y), None, BIT))

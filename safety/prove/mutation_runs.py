"""Mutants on known runs: what was chosen in a run of the model as it is, chosen again in a mutant of it.

A mutant runs on the Python reading, so a claim that is false there is a replayed counterexample.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

from safety.prove import search
from safety.prove.claims import REFUTED, Scenario
from safety.prove.mutation import SELECTOR, Mutant, folded, meant
from safety.prove.problem import Problem, observed, premise_name
from safety.prove.solve import Disagreement
from safety.system import ANY, System, substitute
from safety.terms import Bit
from safety.terms.graph import BIT, Term, rewrite, variable
from safety.terms.texts import compile_lanes, lane_type
from safety.terms.values import build, const
from safety.trace import Stepper, Trace, initial_state

FEW = 0.6  # of the lanes still going: then the others are dropped,
WORTH = 500  # where so many steps are left


@dataclass(frozen=True)
class Course:
    """A run of the model as it is: the choices in it, and what they led to step by step."""

    rows: tuple[tuple[Any, ...], ...]
    start: dict[str, Any]
    values: tuple[tuple[Any, ...], ...]  # of what is `compared`


@dataclass
class Seen:
    """What a mutant showed on a course: the step at which it broke the claim, a premise met, the first difference."""

    broken: int | None = None
    met: bool = False
    differs: tuple[int, str] | None = None


def single(problem: Problem, mutant: Mutant | None) -> Problem:
    """The problem of one mutant (None: of the model as it is), as if the model had been written so."""
    selector = problem.system.state[SELECTOR].var
    fixed: dict[int, Term] = {selector.uid: const(mutant.number if mutant else 0, selector.sort)}

    def change(terms: Sequence[Term]) -> list[Bit]:
        return cast(list[Bit], substitute(terms, fixed))

    whole = problem.system.mapped(lambda terms: substitute(terms, fixed))
    states = [s for s in whole.states if s.path != SELECTOR]
    if mutant is not None and mutant.power_up is not None:
        path, value = mutant.power_up
        states = [replace(s, power_up=value) if s.path == path and s.power_up is not ANY else s for s in states]
    system = replace(whole, states=tuple(states))
    holds, given, start, *premises = change([problem.holds, problem.given, problem.start, *problem.premises])
    lemmas = dict(zip(problem.lemmas, change([*problem.lemmas.values()]), strict=True))
    faulted = replace(problem.faulted, system=system)
    return Problem(problem.claim, system, faulted, holds, tuple(premises), given, start, lemmas)


def only(problem: Problem, numbers: Collection[int]) -> Problem:
    """The problem with just these mutants: the choices of the others are folded away."""
    change = folded(numbers)
    holds, given, start, *premises = change([problem.holds, problem.given, problem.start, *problem.premises])
    lemmas = dict(zip(problem.lemmas, change([*problem.lemmas.values()]), strict=True))
    system = problem.system.mapped(change)
    return Problem(problem.claim, system, problem.faulted, holds, tuple(premises), given, start, lemmas)


def outputs_of(system: System) -> list[str]:
    """The outputs of the whole."""
    return [path for path in system.signals if "." not in path]


def courses(problem: Problem, integers: bool, timeout: float, twins: Sequence[Scenario] = ()) -> Iterator[Course]:
    """The runs that a claim is known by: its scenario and witness, or the shortest ones that a search finds.

    `twins` are the scenarios of its twins, in runs of its own.
    """
    claim, met = problem.claim, set()
    for script in (claim.scenario, claim.witness, *twins):
        if script is not None:
            run = search.scripted(problem, script)
            met |= _met(problem, run)
            yield course_of(problem, run)
    targets = [premise for i, premise in enumerate(problem.premises) if i not in met and not premise.is_const]
    if claim.expect == REFUTED:
        targets = [~problem.holds] if claim.scenario is None else []
    for target in targets:
        found = search.bounded(problem, target, claim.steps, integers, timeout)
        if found.run is not None:
            yield course_of(problem, found.run)


def _met(problem: Problem, run: Trace) -> set[int]:
    return {i for i in range(len(problem.premises)) if True in run[premise_name(problem, i)]}


def course_of(problem: Problem, run: Trace) -> Course:
    """What was chosen in a run of a problem, and what it led to."""
    system = problem.system
    rows = tuple(zip(*(run[path] for path in system.inputs), strict=True)) if system.inputs else ((),) * len(run)
    start = {path: value for path, value in run.chosen.items() if path in system.state}
    values = tuple(zip(*(run[path] for path in (*system.state, *outputs_of(system))), strict=True))
    return Course(rows, start, values)


class Lanes:
    """Some mutants of a claim's problem side by side on the lanes reading, a mutant a lane."""

    def __init__(self, problem: Problem, mutants: Sequence[Mutant]) -> None:
        self.problem, self.mutants = only(problem, {m.number for m in mutants}), mutants
        self.whole = observed(self.problem)
        self.outputs = outputs_of(problem.system)
        self.states = [s for s in self.whole.states if s.path != SELECTOR]
        self.compared = len(self.states) - 1  # the last register watches for the first step
        self.names = [*(s.path for s in self.states[: self.compared]), *self.outputs]
        self.chosen = {m.number: variable(f"mutant {m.number}", BIT) for m in mutants}
        inputs = [*(s.var for s in self.states), *self.whole.inputs.values(), *self.chosen.values()]
        signals = self.whole.signals
        shown = [signals[name] for name in ("claim.holds", "claim.given", "claim.premise", *self.outputs)]
        self.step = compile_lanes(inputs, rewrite([*(s.next for s in self.states), *shown], self._one_hot))

    def _one_hot(self, old: Term, args: tuple[Term, ...]) -> Term:
        number = meant(old)
        if number is not None:
            return self.chosen[number]
        return build(old.op, args, old.attr, old.sort) if old.args else old

    def follow(self, known: Course) -> dict[int, Seen]:
        """What each mutant shows on a course, up to the step that breaks the claim or what it assumes."""
        seen = {m.number: Seen() for m in self.mutants}
        lanes: Lanes | None = self
        first = 0
        state: Sequence[Any] = self.power_up(known.start)
        while lanes is not None:
            lanes, first, state = lanes._follow(known, first, state, seen)
        return seen

    def _follow(
        self, known: Course, first: int, state: Sequence[Any], seen: dict[int, Seen]
    ) -> tuple[Lanes | None, int, Sequence[Any]]:
        """From a step on, until most lanes have ended; then those that go on, from which step, and their registers."""
        import numpy as np

        lanes, count = len(self.mutants), len(self.states)
        chosen = [np.arange(lanes) == i for i in range(lanes)]
        alive = np.ones(lanes, dtype=np.bool_)
        differs = np.array([seen[m.number].differs is not None for m in self.mutants])
        met = np.array([seen[m.number].met for m in self.mutants])
        inputs = self._inputs(known.rows[first])
        for k in range(first, len(known.rows)):
            if k > first and known.rows[k] != known.rows[k - 1]:
                inputs = self._inputs(known.rows[k])
            result = self.step(*state, *inputs, *chosen)
            holds, given, premise, *rest = result[count:]
            alive &= given
            for lane in map(int, np.flatnonzero(alive & premise & ~met)):
                seen[self.mutants[lane].number].met = met[lane] = True
            if not differs.all():
                self._compare([*state[: self.compared], *rest], known.values[k], alive, differs, seen, k)
            for lane in map(int, np.flatnonzero(alive & ~holds)):
                seen[self.mutants[lane].number].broken = k
                alive[lane] = False
            state = [np.broadcast_to(x, (lanes,)) for x in result[:count]]
            left = int(alive.sum())
            if not left:
                break
            if left < lanes * FEW and len(known.rows) - k > WORTH:
                fewer = Lanes(self.problem, [m for m, lives in zip(self.mutants, alive, strict=True) if lives])
                return fewer, k + 1, [column[alive] for column in state]
        return None, 0, ()

    def _inputs(self, row: Sequence[Any]) -> list[Any]:
        import numpy as np

        variables = self.whole.inputs.values()
        return [np.full(len(self.mutants), x, dtype=lane_type(v)) for x, v in zip(row, variables, strict=True)]

    def power_up(self, start: Mapping[str, Any]) -> list[Any]:
        """The registers at power-up, a mutant a lane, those that are free as `start` says."""
        import numpy as np

        values, _ = initial_state(self.whole, start)
        known = dict(zip(self.whole.state, values, strict=True))
        lanes = [np.full(len(self.mutants), known[s.path], dtype=lane_type(s.var)) for s in self.states]
        for lane, mutant in enumerate(self.mutants):
            for s, column in zip(self.states, lanes, strict=True):
                if mutant.power_up and mutant.power_up[0] == s.path and s.power_up is not ANY:
                    column[lane] = mutant.power_up[1]
        return lanes

    def _compare(
        self, columns: Sequence[Any], expected: Sequence[Any], alive: Any, differs: Any, seen: dict[int, Seen], k: int
    ) -> None:
        import numpy as np

        for name, column, value in zip(self.names, columns, expected, strict=True):
            new = (column != value) & alive & ~differs
            if new.any():
                differs |= new
                for lane in map(int, np.flatnonzero(new)):
                    seen[self.mutants[lane].number].differs = k, name


class Replay:
    """A problem's Python reading, and the signals of some claims in it."""

    def __init__(self, problem: Problem, claims: Sequence[str]) -> None:
        self.whole, self.claims = observed(problem), claims
        self.stepper = Stepper.of(self.whole, ["claim.holds", "claim.given", *claims])
        self.at = {path: len(self.whole.states) + i for i, path in enumerate(self.stepper.observed)}

    def broken(self, known: Course, step: int) -> list[str]:
        """The claims that are false at a step of a course.

        None of them where the problem was broken before, or what is given was not kept.
        """
        at = self.at
        state, _ = initial_state(self.whole, known.start)
        for k, row in enumerate(known.rows[: step + 1]):
            result = self.stepper.function(*state, *row)
            if result[at["claim.holds"]] is (k == step) or not result[at["claim.given"]]:
                return []
            state = result[: len(self.whole.states)]
        return [name for name in self.claims if not result[at[name]]]


def confirmed(problem: Problem, known: Course, step: int) -> None:
    """Replay a course on a single mutant; `Disagreement` unless it breaks the claim there."""
    if not Replay(problem, ["claim.holds"]).broken(known, step):
        raise Disagreement(f"{problem.claim.id}: lanes and the Python reading differ on a mutant at step {step}")

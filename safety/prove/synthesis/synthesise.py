"""The driver: lemmas for a problem, stage by stage, until its property follows from them."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import cast

from safety.prove.claims import BITS, INTEGERS
from safety.prove.induction import ask, property_obligations
from safety.prove.problem import Problem
from safety.prove.solve import SAT, UNSAT
from safety.prove.synthesis.candidates import Candidate, fit
from safety.prove.synthesis.conserved import Form, forms, groups, pairs, reads, units
from safety.prove.synthesis.houdini import OutOfTime, Pruner
from safety.prove.synthesis.minimal import needed
from safety.prove.synthesis.sampling import Rows, Sampler, Steps, conjuncts, joined
from safety.prove.synthesis.shapes import codes, shapes
from safety.prove.synthesis.templates import (
    Neighbourhood,
    atoms,
    bounds,
    ceiling_of,
    ceilings,
    clauses,
    clocks,
    rates,
    residues,
    telling,
)
from safety.terms import Bit
from safety.terms.graph import postorder, variables
from safety.terms.values import all_of

STAGES = (
    "codes", "rates", "clauses", "rates of flags", "rates at ends", "clocks", "bounds", "shapes", "falls",
    "bounds on products", "guarded bounds",
)  # fmt: skip
LANES, TICKS, EVERY, STEPS = 192, 90, 3, 4000
SLICE = 0.3  # share of the time left that one stage may take
QUESTION = 10.0  # seconds for the question whether the property follows
BITWISE = ("band", "bor", "bxor")  # combine words bit by bit: hopeless in integers, easy in bits


@dataclass
class Found:
    """Lemmas from which the property follows at a depth of induction; or none, and why."""

    lemmas: dict[str, Bit] = field(default_factory=dict)
    depth: int | None = None
    why: str = ""
    arithmetic: str = INTEGERS


def synthesise(problem: Problem, seconds: float, say: Callable[[str], None] | None = None) -> Found:
    """Look for lemmas within a time; what is found still has to be proved (`safety.prove.induction`).

    The registers nearest to the property come first, those further away are left free; then more and more of them.
    """
    deadline = time.monotonic() + seconds
    say = say or (lambda _: None)
    searches = [_Search(part, deadline) for part in layers(problem)]
    running = [(search, search.stages()) for search in searches]
    for stage in STAGES:
        for search, stages in running:
            next(stages)
            say(f"{stage}, {len(search.problem.system.states)} registers: {len(search.kept)} kept; {search.why}")
            depth = search.follows()
            if depth is not None:
                integers = search.arithmetic == INTEGERS
                lemmas = needed(search.problem, search.lemmas(), depth, integers)
                return Found(lemmas, depth, arithmetic=search.arithmetic)
            if time.monotonic() > deadline:
                return Found(why=f"lemma synthesis was stopped after {seconds:g} s")
    return Found(why="the property does not follow from the lemmas that were found")


def clause_lemmas(problem: Problem, seconds: float) -> dict[str, Bit]:
    """The clauses over the registers next to the property that are inductive together."""
    search = _Search(next(layers(problem)), time.monotonic() + seconds)
    for stage, _ in zip(STAGES, search.stages(), strict=False):
        if stage == "clauses":
            break
    return search.lemmas()


def layers(problem: Problem) -> Iterator[Problem]:
    """The problem with the registers at a distance of 1, 2, ... from its property, the rest being free inputs.

    Last come those that watch for the assumptions alone.
    """
    states = {s.var.uid: s for s in problem.system.states}
    reached = {v.uid for v in variables([problem.holds, *problem.premises]) if v.uid in states}
    assumed = {v.uid for v in variables([problem.given]) if v.uid in states and states[v.uid].next is not v}
    while True:
        yield localised(problem, reached)
        further = reached | {v.uid for uid in reached for v in variables([states[uid].next]) if v.uid in states}
        if further == reached:
            further = reached | assumed
        if further == reached:
            return
        reached = further


def localised(problem: Problem, reached: Collection[int]) -> Problem:
    """The problem with these registers only; others are inputs, whatever they hold."""
    near = {*reached, *_faults_at(problem, reached)}
    kept = tuple(s for s in problem.system.states if s.var.uid in near)
    read = [problem.holds, problem.given, problem.start, *(s.next for s in kept)]
    leaves = {v.uid: v for v in variables([*read, *problem.faulted.active, *problem.faulted.acted])}
    inputs = {str(v.attr): v for v in leaves.values() if v.uid not in {s.var.uid for s in kept}}
    points = {n: p for n, p in problem.system.points.items() if all(v.uid in leaves for v in variables([p]))}
    return replace(problem, system=replace(problem.system, states=kept, inputs=inputs, points=points, signals={}))


def _faults_at(problem: Problem, reached: Collection[int]) -> set[int]:
    """The registers of the faults that act on the next values of some registers: lemmas are guarded by them."""
    states = {s.var.uid: s for s in problem.system.states}
    read = {v.uid for uid in reached for v in variables([states[uid].next])}
    found: list[int] = []
    for active, acted in zip(problem.faulted.active, problem.faulted.acted, strict=True):
        leaves = [v.uid for v in variables([active, acted])]
        if read & set(leaves):
            found += [uid for uid in leaves if uid in states]
    for uid in found:  # grows while it is walked
        found += [v.uid for v in variables([states[uid].next]) if v.uid in states and v.uid not in found]
    return set(found)


class _Search:
    def __init__(self, problem: Problem, deadline: float) -> None:
        self.problem, self.deadline, self.why = problem, deadline, ""
        self.kept: list[Candidate] = []
        self.pruner = Pruner(problem)
        self.near = Neighbourhood(problem)
        self.sampler = Sampler(problem)
        self.atoms = atoms(problem)
        self.watching = [s for s in problem.system.states if s.path.startswith("watch.")]
        self.groups = groups(problem.system.states, self.watching)
        self.arithmetic = INTEGERS
        self.asked = 0
        combines = any(t.op in BITWISE for t in postorder([problem.holds, *(s.next for s in problem.system.states)]))
        self.readings = (BITS, INTEGERS) if combines else (INTEGERS,)

    def lemmas(self) -> dict[str, Bit]:
        """The candidates kept so far, by name."""
        named: dict[str, Bit] = {}
        for c in self.kept:
            named[f"{c.name} ({len(named)})" if c.name in named else c.name] = c.lemma
        return named

    def settled(self) -> list[Bit]:
        return [c.lemma for c in self.kept]

    def soon(self) -> float:
        """When one stage has to end."""
        now = time.monotonic()
        return now + max(SLICE * (self.deadline - now), 0.1)

    def keep(self, candidates: Sequence[Candidate]) -> None:
        """Prune candidates against what is kept, and keep the rest; none where that takes too long."""
        self.why = ""
        try:
            self.pruner.deadline = self.soon()
            self.kept += self.pruner.prune(candidates, self.settled())
        except OutOfTime as error:
            self.why = str(error)

    def follows(self) -> int | None:
        """The depth of induction at which the property follows, if one does; not asked again for the same lemmas."""
        if len(self.kept) == self.asked:
            return None
        self.asked = len(self.kept)
        whole = replace(self.problem, lemmas=self.lemmas())
        for depth in range(self.problem.claim.induction + 1):
            for reading in self.readings:
                answer = self.answer(whole, depth, reading == INTEGERS)
                if answer == UNSAT:
                    self.arithmetic = reading
                    return depth
                if answer == SAT:
                    break
        return None

    def answer(self, whole: Problem, depth: int, integers: bool) -> str:
        """`unsat` when all obligations of the property at a depth are met, else what the first says that is not."""
        results = (ask(whole, o, "z3", integers, QUESTION).result for o in property_obligations(whole, depth))
        return next((result for result in results if result != UNSAT), UNSAT)

    def stages(self) -> Iterator[None]:
        """Each of the `STAGES` adds to what is kept."""
        rows = joined(self.sampler.run(self.sampler.starts(LANES), TICKS, EVERY, self.soon()))
        self.keep([*codes(self.near), *ceilings(self.problem, rows), *residues(self.problem, rows)])
        yield
        healthy = self.without_faults(self.problem)
        steps = healthy.steps(STEPS, 20, 0.1, self.soon())
        found = self.forms(healthy, steps)
        linear, products = [f for f in found if not f.product], [f for f in found if f.product]
        self.race(steps, rows, linear, False)
        yield
        guessed = clauses(self.near, self.atoms, rows) if len(next(iter(rows.values()), [])) else []
        self.keep(guessed)
        yield
        self.race(steps, rows, linear, True)
        yield
        self.race(steps, rows, linear, False)
        yield
        self.keep(fit(clocks(self.near, steps, self.atoms), rows))
        yield
        both = linear + pairs(self.problem.system.states, self.groups, self.watching)
        self.bound(steps, rows, both, False, guessed)
        yield
        self.keep(fit(shapes(self.near, steps, rows, self.atoms), rows))
        yield
        self.race(steps, rows, units(self.problem.system.states), False)
        yield
        self.bound(steps, rows, products, False, guessed)
        yield
        self.bound(steps, rows, both, True, guessed)
        yield

    def bound(self, steps: Steps, rows: Rows, some: list[Form], guarded: bool, guessed: list[Candidate]) -> None:
        """Bounds on forms, and together with them the clauses that did not hold without."""
        bounding = fit(bounds(self.near, steps, some, self.atoms, self.tops(), guarded), rows)
        dropped = [c for c in guessed if not any(c is k for k in self.kept)]
        self.keep([*(c for c in bounding if telling(c, self.kept)), *dropped])

    def race(self, steps: Steps, rows: Rows, some: list[Form], flags: bool) -> None:
        """Rates of forms; none where finding them takes too long."""
        self.pruner.deadline = self.soon()
        try:
            racing = rates(self.pruner, self.near, steps, some, self.atoms, self.settled(), self.tops(), flags)
            self.keep(fit(racing, rows))
        except OutOfTime as error:
            self.why = str(error)

    def without_faults(self, problem: Problem) -> Sampler:
        """A sampler of steps in which no fault is present, registers below the ceilings that are known."""
        sampler = Sampler(problem)
        sampler.draw_states.fixed |= {v.uid: False for v in problem.faulted.present if v.op == "var"}
        for uid, top in self.tops().items():
            sampler.draw_states.range[uid][1] = top
        return sampler

    def tops(self) -> dict[int, int]:
        """The lowest known ceiling of each register that has one."""
        found: dict[int, int] = {}
        for uid, top in filter(None, map(ceiling_of, self.kept)):
            found[uid] = min(top, found.get(uid, top))
        return found

    def forms(self, sampler: Sampler, steps: Steps) -> list[Form]:
        """The conserved forms of all groups: within all assumptions, and within those that say what is equal.

        The latter because a speed that is kept low makes pulses too rare to be sampled.
        """
        equal = [part for part in conjuncts(self.problem.given) if part.op == "eq"]
        assumed = (cast(Bit, a) for a in self.problem.system.assumptions.values())
        loose = self.without_faults(replace(self.problem, given=all_of(*assumed, *(cast(Bit, e) for e in equal))))
        seen: dict[object, Form] = {}
        for source, drawn in ((loose, loose.steps(STEPS, 20, 0.1, self.soon())), (sampler, steps)):
            for group in self.groups:
                free = reads(group, [*source.inputs, *source.points])
                for f in forms(drawn, group, self.watching, free):
                    seen.setdefault(f.key, f)
        return list(seen.values())

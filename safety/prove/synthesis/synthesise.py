"""The driver: lemmas for a problem, stage by stage, until its property follows from them."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import cast

from safety.prove.induction import ask, property_obligations
from safety.prove.problem import Problem
from safety.prove.solve import UNSAT
from safety.prove.synthesis.candidates import Candidate, fit
from safety.prove.synthesis.conserved import Form, forms, groups, pairs, reads
from safety.prove.synthesis.houdini import OutOfTime, Pruner
from safety.prove.synthesis.minimal import needed
from safety.prove.synthesis.sampling import Sampler, Steps, conjuncts, joined
from safety.prove.synthesis.templates import Neighbourhood, atoms, bounds, ceiling_of, ceilings, clauses, clocks, rates, residues, telling
from safety.terms import Bit
from safety.terms.graph import variables
from safety.terms.values import all_of

LANES, TICKS, EVERY, STEPS = 192, 90, 3, 4000
SLICE = 0.4  # share of the time left that one stage may take
QUESTION = 10.0  # seconds for the question whether the property follows


@dataclass
class Found:
    """Lemmas from which the property follows at a depth of induction; or none, and why."""

    lemmas: dict[str, Bit] = field(default_factory=dict)
    depth: int | None = None
    why: str = ""


def synthesise(problem: Problem, seconds: float, say: Callable[[str], None] | None = None) -> Found:
    """Look for lemmas within a time; what is found still has to be proved (`safety.prove.induction`).

    The registers nearest to the property come first, those further away are left free; then more and more of them.
    """
    deadline = time.monotonic() + seconds
    say = say or (lambda _: None)
    found = Found(why="the property does not follow from the lemmas that were found")
    for distance, part in enumerate(layers(problem), 1):
        say(f"{len(part.system.states)} registers up to distance {distance}")
        search = _Search(part, deadline)
        for stage in search.stages():
            say(f"{stage}: {len(search.kept)} candidates are inductive; {search.why}")
            depth = search.follows()
            if depth is not None:
                return Found(needed(search.problem, search.lemmas(), depth), depth)
            if time.monotonic() > deadline:
                return Found(why=f"lemma synthesis was stopped after {seconds:g} s")
    return found


def layers(problem: Problem) -> Iterator[Problem]:
    """The problem with the registers at a distance of 1, 2, ... from its property, the rest being free inputs."""
    states = {s.var.uid: s for s in problem.system.states}
    reached = {v.uid for v in variables([problem.holds, *problem.premises]) if v.uid in states}
    while True:
        yield localised(problem, reached)
        further = reached | {v.uid for uid in reached for v in variables([states[uid].next]) if v.uid in states}
        if further == reached:
            return
        reached = further


def localised(problem: Problem, reached: Collection[int]) -> Problem:
    """The problem with these registers only; others are inputs, whatever they hold."""
    kept = tuple(s for s in problem.system.states if s.var.uid in reached)
    read = [problem.holds, problem.given, problem.start, *(s.next for s in kept)]
    leaves = {v.uid: v for v in variables([*read, *problem.faulted.active, *problem.faulted.acted])}
    inputs = {str(v.attr): v for v in leaves.values() if v.uid not in {s.var.uid for s in kept}}
    points = {n: p for n, p in problem.system.points.items() if all(v.uid in leaves for v in variables([p]))}
    return replace(problem, system=replace(problem.system, states=kept, inputs=inputs, points=points, signals={}))


class _Search:
    def __init__(self, problem: Problem, deadline: float) -> None:
        self.problem, self.deadline, self.why = problem, deadline, ""
        self.kept: list[Candidate] = []
        self.pruner = Pruner(problem)
        self.near = Neighbourhood(problem)
        self.sampler = Sampler(problem)
        self.atoms = atoms(problem)

    def lemmas(self) -> dict[str, Bit]:
        """The candidates kept so far, by name."""
        named: dict[str, Bit] = {}
        for c in self.kept:
            named[f"{c.name} ({len(named)})" if c.name in named else c.name] = c.lemma
        return named

    def settled(self) -> list[Bit]:
        return [c.lemma for c in self.kept]

    def keep(self, candidates: Sequence[Candidate]) -> None:
        """Prune candidates against what is kept, and keep the rest; none where that takes too long."""
        now = time.monotonic()
        self.why = ""
        try:
            self.pruner.deadline = now + max(SLICE * (self.deadline - now), 0.1)
            self.kept += self.pruner.prune(candidates, self.settled())
        except OutOfTime as error:
            self.why = str(error)

    def follows(self) -> int | None:
        """The depth of induction at which the property follows, if one does."""
        whole = replace(self.problem, lemmas=self.lemmas())
        for depth in range(self.problem.claim.induction + 1):
            replies = (ask(whole, o, "z3", True, QUESTION) for o in property_obligations(whole, depth))
            if all(reply.result == UNSAT for reply in replies):
                return depth
        return None

    def stages(self) -> Iterator[str]:
        """Each stage adds to what is kept; its name is given when it is done."""
        rows = joined(self.sampler.run(self.sampler.starts(LANES), TICKS, EVERY))
        guessed = clauses(self.near, self.atoms, rows) if len(next(iter(rows.values()), [])) else []
        self.keep([*ceilings(self.problem, rows), *residues(self.problem, rows), *guessed])
        yield "clauses"
        healthy = self.without_faults(self.problem)
        steps = healthy.steps(STEPS, 20, 0.1)
        found = self.forms(healthy, steps)
        self.keep(self.racing(steps, found))
        yield "rates"
        self.keep(fit(clocks(self.near, steps, self.atoms, 1), rows, start=True))
        yield "clocks"
        watching = [s for s in self.problem.system.states if s.path.startswith("watch.")]
        found += pairs(self.problem.system.states, groups(self.problem.system.states, watching), watching)
        for guarded in (False, True):
            bounding = fit(bounds(self.near, steps, found, self.atoms, self.tops(), guarded), rows, start=True)
            dropped = [c for c in guessed if not any(c is k for k in self.kept)]
            self.keep([*(c for c in bounding if telling(c, self.kept)), *dropped])
            yield "guarded bounds" if guarded else "bounds"

    def racing(self, steps: Steps, found: list[Form]) -> list[Candidate]:
        self.pruner.deadline = self.deadline
        try:
            return rates(self.pruner, self.near, steps, found, self.atoms, self.settled())
        except OutOfTime:
            return []

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
        watching = [s for s in self.problem.system.states if s.path.startswith("watch.")]
        equal = [part for part in conjuncts(self.problem.given) if part.op == "eq"]
        assumed = (cast(Bit, a) for a in self.problem.system.assumptions.values())
        loose = self.without_faults(replace(self.problem, given=all_of(*assumed, *(cast(Bit, e) for e in equal))))
        seen: dict[object, Form] = {}
        for source, drawn in ((loose, loose.steps(STEPS, 20, 0.1)), (sampler, steps)):
            for group in groups(self.problem.system.states, watching):
                free = reads(group, [*source.inputs, *source.points])
                for f in forms(drawn, group, watching, free):
                    seen.setdefault(f.key, f)
        return list(seen.values())

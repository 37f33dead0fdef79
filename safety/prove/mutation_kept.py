"""Kills that an earlier run has found: run again they spare the search for them, and they are never believed.

A kill is a claim's name and what the run was given, kept under the mutant's text.  Whether the mutant breaks the claim
there is seen anew on the Python reading, so one that was found for another text of model or claim does no harm: it
kills again, or the mutant is examined as if nothing were known.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping
from typing import Any

from safety.canonical import digest
from safety.prove.cache import Cache
from safety.prove.mutation import SELECTOR, Mutant, Mutants
from safety.prove.mutation_case import Case
from safety.prove.mutation_runs import Course, Replay, only
from safety.prove.problem import Problem
from safety.prove.stimulus import packed, unpacked
from safety.system import ModelError


class Kills:
    """The kills of a model's mutants that are kept in a cache; without a cache none are."""

    def __init__(self, cache: Cache | None, mutants: Mutants) -> None:
        self.cache, self.mutants = cache, mutants
        self.keys = dict(_keys(mutants)) if cache is not None else {}
        self.known: dict[int, Any] = {}

    def recall(self, numbers: Collection[int]) -> None:
        """Read what is kept of some mutants."""
        if self.cache is not None:
            found = {number: self.cache.get(self.keys[number]) for number in numbers}
            self.known = {number: kill for number, kill in found.items() if kill is not None}

    def keep(self, mutant: Mutant, case: Case, course: Course, step: int) -> None:
        """Keep the run in which a mutant breaks a claim for the first time, at its last step."""
        if self.cache is not None:
            inputs = dict(zip(case.stated.system.inputs, zip(*course.rows[: step + 1], strict=True), strict=False))
            given = packed({path: v for path, v in course.start.items() if path != SELECTOR}, inputs)
            self.cache.put(self.keys[mutant.number], {"claim": case.claim.id, "steps": step + 1, "given": given})

    def keep_unmet(self, mutant: Mutant, case: Case) -> None:
        """Keep that the run which shows a claim's premise does not show it for a mutant."""
        if self.cache is not None:
            self.cache.put(self.keys[mutant.number], {"claim": case.claim.id, "given": None})

    def unmet(self, case: Case) -> set[int]:
        """The mutants of which that is kept."""
        return {n for n, kill in self.known.items() if kill["claim"] == case.claim.id and kill["given"] is None}

    def again(self, case: Case, numbers: set[int]) -> list[tuple[int, Course, int]]:
        """Those mutants that break a claim again in the run that is kept, with the run and its last step."""
        known = {n: kill for n, kill in self.known.items() if kill["claim"] == case.claim.id and kill["given"]}
        asked = sorted(known.keys() & numbers)
        if not asked:
            return []
        some = only(case.stated, asked)
        schemata = Replay(some, ["claim.holds"])
        found = []
        for number in asked:
            mutant, kill = self.mutants[number], known[number]
            replay = schemata if mutant.power_up is None else Replay(case.single(mutant), ["claim.holds"])
            chosen = {SELECTOR: number} if replay is schemata else {}
            course = _course(some, kill, chosen)
            if course is not None and _breaks(replay, course):
                found.append((number, course, len(course.rows) - 1))
        return found


def _keys(mutants: Mutants) -> list[tuple[int, str]]:
    """A key for each mutant: by what is changed and how, and by the how-manieth it is of those that read alike."""
    met: Counter[str] = Counter()
    found = []
    for mutant in mutants.mutants:
        told = f"{mutant.was}: {mutant.change}"
        met[told] += 1
        found.append((mutant.number, digest(["kill of a mutant", mutants.system.name, told, str(met[told])])))
    return found


def _course(problem: Problem, kill: Mapping[str, Any], chosen: Mapping[str, Any]) -> Course | None:
    """The run that is kept, if the problem has all that it names, and no other inputs."""
    system, steps = problem.system, kill["steps"]
    try:
        start, inputs = unpacked(system, kill["given"])
    except ModelError:
        return None
    if inputs.keys() != system.inputs.keys() or any(len(column) != steps for column in inputs.values()):
        return None
    columns = [inputs[path] for path in system.inputs]
    if not all(v.sort.admits(x) for v, c in zip(system.inputs.values(), columns, strict=True) for x in set(c)):
        return None
    rows = tuple(zip(*columns, strict=True)) if columns else ((),) * steps
    return Course(rows, {**start, **chosen}, ())


def _breaks(replay: Replay, course: Course) -> bool:
    try:
        return bool(replay.broken(course, len(course.rows) - 1))
    except ModelError:  # a register that is not free any more, or holds other values
        return False

"""The judge: what is true of a case, without any solver.

A small model is explored breadth-first through all its states, on NumPy lanes.  A large one that fails is run as its
family says; one that holds is run at random (`tests.generated.test_generated`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safety.prove.claims import PROVED, REFUTED, VACUOUS
from safety.prove.problem import Problem, observed
from safety.prove.search import scripted
from safety.system import ANY
from safety.terms.graph import Sort, Term
from safety.terms.texts import compile_lanes, lane_type
from tests.generated.case import Case

TRANSITIONS = 4_000_000
STEPS = 2_000
TABLE = 1 << 27  # register contents that a table of flags covers
CHUNK = 1 << 18


@dataclass
class Truth:
    """The first step at which the claim breaks, and whether each premise is met; None when it never does."""

    broken: int | None
    met: list[bool]

    @property
    def verdict(self) -> str:
        if self.broken is not None:
            return REFUTED
        return PROVED if all(self.met) else VACUOUS


class Codes:
    """Values of several variables as one number, mixed radix."""

    def __init__(self, variables: list[Term]) -> None:
        self.lows = [v.sort.bounds[0] for v in variables]
        self.sizes = [_values(v.sort) for v in variables]
        self.types = [lane_type(v) for v in variables]
        self.size = math.prod(self.sizes)

    def pack(self, columns: list[np.ndarray]) -> np.ndarray:
        code = np.zeros(len(columns[0]) if columns else 1, dtype=np.int64)
        for column, low, size in zip(columns, self.lows, self.sizes, strict=True):
            code = code * size + (column.astype(np.int64) - low)
        return code

    def unpack(self, code: np.ndarray) -> list[np.ndarray]:
        columns: list[np.ndarray] = []
        for low, size, kind in zip(self.lows[::-1], self.sizes[::-1], self.types[::-1], strict=True):
            code, digit = np.divmod(code, size)
            columns.append((digit + low).astype(kind))
        return columns[::-1]


def _values(sort: Sort) -> int:
    return sort.bounds[1] - sort.bounds[0] + 1


def explored(problem: Problem, most: int = TRANSITIONS) -> Truth | None:
    """Visit every state that can be reached; None when that takes more than `most` transitions or 2000 steps."""
    system = observed(problem)
    states, inputs = [s.var for s in system.states], list(system.inputs.values())
    registers, choices = Codes(states), Codes(inputs)
    starts = Codes([s.var for s in system.states if s.power_up is ANY])
    if registers.size > TABLE or choices.size > most or starts.size > most:
        return None
    premises = [system.signals[name] for name in system.signals if name.startswith("claim.premise")]
    premises = premises[1:] if len(premises) > 1 else premises
    seen_by = [system.signals["claim.given"], system.signals["claim.holds"], *premises]
    step = compile_lanes([*states, *inputs], [*seen_by, *(s.next for s in system.states)])
    frontier, seen = _power_up(problem, starts), np.zeros(registers.size, dtype=np.bool_)
    truth, visited, depth = Truth(None, [False] * len(premises)), 0, 0
    seen[frontier] = True
    every_choice = np.arange(choices.size)
    while len(frontier):
        visited += len(frontier) * choices.size
        if visited > most or depth > STEPS:
            return None
        after = []
        for part in np.array_split(frontier, 1 + len(frontier) * choices.size // CHUNK):
            here = registers.unpack(np.repeat(part, choices.size))
            chosen = choices.unpack(np.tile(every_choice, len(part)))
            given, kept, *rest = step(*here, *chosen)
            met, following = rest[: len(premises)], rest[len(premises) :]
            if truth.broken is None and (given & ~kept).any():
                truth.broken = depth
            truth.met = [a or bool((given & b).any()) for a, b in zip(truth.met, met, strict=True)]
            after.append(np.unique(registers.pack([x[given] for x in following])))
        reached = np.concatenate(after)
        frontier = np.unique(reached[~seen[reached]])
        seen[frontier] = True
        depth += 1
    return truth


def _power_up(problem: Problem, starts: Codes) -> np.ndarray:
    """Codes of all register contents at power-up (the start condition is part of `claim.given`)."""
    system = observed(problem)
    free = iter(starts.unpack(np.arange(starts.size)))
    columns = [
        next(free) if s.power_up is ANY else np.full(starts.size, s.power_up, dtype=lane_type(s.var))
        for s in system.states
    ]
    return np.unique(Codes([s.var for s in system.states]).pack(columns))


def breaks(problem: Problem, case: Case) -> bool:
    """Whether the run that the family names breaks the claim, on the Python reading."""
    assert case.breaks is not None
    return False in scripted(problem, case.breaks, keep=["claim.holds", "claim.given"])["claim.holds"]

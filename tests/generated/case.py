"""A case: a claim about a generated model, with the verdict that the family's own mathematics gives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from random import Random
from typing import Any

from safety.model import Model
from safety.prove.claims import PROVED, REFUTED, VACUOUS, Claim, Formula, Scenario
from tests.prove.small import asked


@dataclass(frozen=True)
class Case:
    """`truth` is proved, refuted or vacuous; a refuted one comes with the run that breaks it."""

    claim: Claim
    truth: str
    breaks: Scenario | None = None

    @property
    def name(self) -> str:
        return self.claim.id


Family = Callable[[Random], list[Case]]


def holds(model: type[Model], formula: Formula, **changes: Any) -> Case:
    """A claim that is true."""
    return Case(_claim(model, formula, changes), PROVED)


def fails(model: type[Model], formula: Formula, breaks: Scenario, **changes: Any) -> Case:
    """A near miss, with a run that breaks it."""
    return Case(_claim(model, formula, changes), REFUTED, breaks)


def silent(model: type[Model], formula: Formula, **changes: Any) -> Case:
    """A claim whose premise can never happen."""
    return Case(_claim(model, formula, changes), VACUOUS)


def named(case: Case, name: str) -> Case:
    """The case under its own name."""
    return replace(case, claim=replace(case.claim, id=name))


def _claim(model: type[Model], formula: Formula, changes: dict[str, Any]) -> Claim:
    return asked(formula, model, **({"steps": 20} | changes))


def bits(most: int) -> int:
    """Bits of a word that holds 0 to `most`."""
    return max(most.bit_length(), 1)


def size(rng: Random, least: int, small: int, large: int) -> int:
    """A size from `least` up: half are at most `small` (every state can be visited), half beyond, up to `large`."""
    return rng.randint(least, small) if rng.random() < 0.5 else rng.randint(small + 1, large)

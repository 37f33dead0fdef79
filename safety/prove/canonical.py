"""The canonical text of a problem: one digest for what a verdict rests on, and for nothing else.

Terms are numbered by where they stand, not by when they were made, and dictionaries are read by name, so a problem has
one key in every process.  Order is kept where a verdict shows it: registers, inputs and faults (a counterexample is the
smallest in their order) and lemmas.  A claim's functions count by what they have built or, in scenarios, by the values
that they give; its words do not count.  What cannot be written down, such as a function where none is expected, has no
key, and a claim without a key is never taken from a cache.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping, Set
from typing import Any, ClassVar

from safety.canonical import NoKeyError, Text, digest
from safety.prove.claims import Scenario
from safety.prove.problem import Problem

WORDS = {"id", "statement", "requirement", "source", "twin_of", "role"}  # of a claim: shown, not proved
BUILT = {  # of a claim: they stand in its problem, as terms
    "model", "formula", "faults", "given", "start", "lemmas", "symbolic", "settings", "anywhere", "refinement",
    "steps_per_frame",
}  # fmt: skip


def problem_key(problem: Problem, *surroundings: str) -> str:
    """The key of a problem in the given surroundings: the prover's digest, the solvers' names.

    Raises `NoKeyError`.
    """
    text = ProblemText()
    try:
        told = text.of(problem), problem.claim.expect
        return digest([*surroundings, json.dumps(text.nodes), json.dumps(told)])
    except NoKeyError:
        raise
    except Exception as error:  # a scenario's function that fails: the proof tells the user where
        raise NoKeyError(f"{problem.claim.id}: {type(error).__name__}: {error}") from error


class ProblemText(Text):
    """A problem's text: a script stands by what it gives at each step."""

    in_order = frozenset({"inputs", "lemmas"})
    shown: ClassVar[Mapping[str, Set[str]]] = {
        "claim": WORDS | BUILT | {"expect"},
        "faulted": {"system"},
        "kind": {"effect"},
    }

    def of(self, value: Any, name: str = "") -> Any:
        """What stands for a value; `name` is the field that holds it.  Raises `NoKeyError`."""
        return ["scenario", self._scenario(value)] if isinstance(value, Scenario) else super().of(value, name)

    def _scenario(self, script: Scenario) -> Any:
        told = {f.name: getattr(script, f.name) for f in dataclasses.fields(script)}
        for name in ("inputs", "values"):
            told[name] = {path: _course(value, script.steps) for path, value in told[name].items()}
        return [[name, self.of(value)] for name, value in told.items()]


def _course(value: Any, steps: int) -> Any:
    return [value(k) for k in range(steps)] if callable(value) else value

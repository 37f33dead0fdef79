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
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from safety.prove.cache import digest
from safety.prove.claims import Scenario
from safety.prove.problem import Problem
from safety.system import ANY
from safety.terms.graph import Sort, Term, node, postorder

KEPT_IN_ORDER = {"inputs", "lemmas"}
WORDS = {"id", "statement", "requirement", "source", "twin_of", "role"}  # of a claim: shown, not proved
BUILT = {  # of a claim: they stand in its problem, as terms
    "model", "formula", "faults", "given", "start", "lemmas", "symbolic", "settings", "anywhere", "refinement",
    "steps_per_frame",
}  # fmt: skip
SHOWN = {"claim": WORDS | BUILT | {"expect"}, "faulted": {"system"}, "kind": {"effect"}}


class NoKeyError(Exception):
    """A problem has no canonical text."""


def problem_key(problem: Problem, *surroundings: str) -> str:
    """The key of a problem in the given surroundings: the prover's digest, the solvers' names.

    Raises `NoKeyError`.
    """
    text = _Text()
    try:
        told = text.of(problem), problem.claim.expect
        return digest([*surroundings, json.dumps(text.nodes), json.dumps(told)])
    except NoKeyError:
        raise
    except Exception as error:  # a scenario's function that fails: the proof tells the user where
        raise NoKeyError(f"{problem.claim.id}: {type(error).__name__}: {error}") from error


def written(terms: Mapping[str, Term]) -> Any:
    """Named terms as plain data, which `read` turns into the same terms in any process."""
    text = _Text()
    places = [[name, text.place_of(term)] for name, term in terms.items()]
    return [text.nodes, places]


def read(data: Any) -> dict[str, Any]:
    """The terms that `written` wrote down.  Raises `ValueError` for anything else."""
    try:
        nodes, places = data
        made: list[Term] = []
        for op, attr, (kind, low, high), arguments in nodes:
            made.append(node(op, tuple(made[i] for i in arguments), _attribute(attr), Sort(kind, low, high)))
        return {name: made[i] for name, i in places}
    except (TypeError, KeyError, IndexError, ValueError) as error:
        raise ValueError(f"these are no terms: {error}") from None


def _attribute(told: Any) -> Any:
    if not isinstance(told, list):
        return told
    kind, value = told
    return {"int": int, "Fraction": Fraction}[kind](value) if kind != "list" else tuple(_attribute(v) for v in value)


class _Text:
    """Plain lists that stand for values; terms stand in a table of their own, each once."""

    def __init__(self) -> None:
        self.nodes: list[Any] = []
        self.place: dict[int, int] = {}
        self.alive: list[Term] = []  # a term that is gone could leave its number to another

    def of(self, value: Any, name: str = "") -> Any:
        """What stands for a value; `name` is the field that holds it."""
        if value is None or isinstance(value, bool | str):
            return value
        if isinstance(value, int | Fraction):
            return [type(value).__name__, str(value)]
        if isinstance(value, Term):
            return ["term", self.place_of(value)]
        if value is ANY:
            return ["any"]
        if isinstance(value, Scenario):
            return ["scenario", self._scenario(value)]
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            return self._fields(value, SHOWN.get(name or type(value).__name__.lower(), set()))
        if isinstance(value, Mapping):
            items = [[self.of(key), self.of(item)] for key, item in value.items()]
            return ["map", items if name in KEPT_IN_ORDER else sorted(items, key=json.dumps)]
        if isinstance(value, list | tuple):
            return ["list", [self.of(item) for item in value]]
        raise NoKeyError(f"{name or 'a value'} is {value!r}, a {type(value).__name__}")

    def _fields(self, value: Any, without: set[str]) -> Any:
        """A field that was added later counts too, unless it is known not to."""
        fields = [f.name for f in dataclasses.fields(value) if f.name not in without]
        return [type(value).__name__, [[name, self.of(getattr(value, name), name)] for name in fields]]

    def place_of(self, root: Term) -> int:
        """Where a term stands in the table."""
        for term in postorder([root], self.place):
            arguments = [self.place[a.uid] for a in term.args]
            self.place[term.uid] = len(self.nodes)
            self.nodes.append([term.op, self.of(term.attr), [term.sort.kind, term.sort.low, term.sort.high], arguments])
            self.alive.append(term)
        return self.place[root.uid]

    def _scenario(self, script: Scenario) -> Any:
        """A script by what it gives at each step."""
        told = {f.name: getattr(script, f.name) for f in dataclasses.fields(script)}
        for name in ("inputs", "values"):
            told[name] = {path: _course(value, script.steps) for path, value in told[name].items()}
        return [[name, self.of(value)] for name, value in told.items()]


def _course(value: Any, steps: int) -> Any:
    return [value(k) for k in range(steps)] if callable(value) else value

"""The canonical text of values, and digests over it: one key for one thing in every process and on every machine.

Terms are numbered by where they stand, not by when they were made, and dictionaries are read by name.  What cannot be
written down has no key.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Iterable, Mapping, Set
from fractions import Fraction
from pathlib import Path
from typing import Any, ClassVar

from safety.system import ANY
from safety.terms.graph import Sort, Term, node, postorder

PACKAGE = Path(__file__).resolve().parent
READINGS = ("*.py", "terms/**/*.py", "kinds/**/*.py", "faults/**/*.py")  # below the package: what all analyses share


class NoKeyError(Exception):
    """A thing has no canonical text."""


class Text:
    """Plain lists that stand for values; terms stand in a table of their own (`nodes`), each once.

    `in_order` names fields whose dictionaries keep their order; `shown` gives, by field or class, fields that are only
    shown and do not count.
    """

    in_order: ClassVar[Set[str]] = frozenset()
    shown: ClassVar[Mapping[str, Set[str]]] = {}

    def __init__(self) -> None:
        self.nodes: list[Any] = []
        self.place: dict[int, int] = {}
        self.alive: list[Term] = []  # a term that is gone could leave its number to another

    def of(self, value: Any, name: str = "") -> Any:
        """What stands for a value; `name` is the field that holds it.  Raises `NoKeyError`."""
        if value is None or isinstance(value, bool | str):
            return value
        if isinstance(value, int | Fraction):
            return [type(value).__name__, str(value)]
        if isinstance(value, Term):
            return ["term", self.place_of(value)]
        if value is ANY:
            return ["any"]
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            return self._fields(value, self.shown.get(name or type(value).__name__.lower(), set()))
        if isinstance(value, Mapping):
            items = [[self.of(key), self.of(item)] for key, item in value.items()]
            return ["map", items if name in self.in_order else sorted(items, key=json.dumps)]
        if isinstance(value, list | tuple):
            return ["list", [self.of(item) for item in value]]
        raise NoKeyError(f"{name or 'a value'} is {value!r}, a {type(value).__name__}")

    def _fields(self, value: Any, without: Set[str]) -> Any:
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


def written(terms: Mapping[str, Term]) -> Any:
    """Named terms as plain data, which `read` turns into the same terms in any process."""
    text = Text()
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


# --- digests ---------------------------------------------------------------------------------------------------------


def digest(parts: Iterable[str | bytes]) -> str:
    """SHA-256 over texts, each told from the next."""
    sum_ = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        sum_.update(b"%d:" % len(data))
        sum_.update(data)
    return sum_.hexdigest()


def files(root: Path, patterns: Iterable[str]) -> list[Path]:
    """The files below a folder that fit, compiled ones left out, in order of name."""
    found = {path for pattern in patterns for path in root.glob(pattern) if "__pycache__" not in path.parts}
    return sorted(path for path in found if path.is_file())


def text_of(root: Path, found: Iterable[Path]) -> str:
    """A digest of the names and contents of files below a folder."""
    return digest(part for path in found for part in (path.relative_to(root).as_posix(), path.read_bytes()))

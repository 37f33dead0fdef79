"""The parts of a Study in the project's own JSON: keys beside those of a fault tree, each a list.

    "parameters":        [{"name": "rate", "expression": {"lognormal-deviate": ["1e-6", 3, "0.95"]}, "unit": "hours-1",
                          "source": "P"}]
    "ccf_groups":        [{"name": "Pumps", "model": "beta-factor", "members": ["A", "B"], "factors": {"2": "0.1"}}]
    "substitutions", "alignments", "initiating_events", "event_trees": the fields of the classes of these names

An expression is a number, or an object with one key, its name in Open-PSA MEF, and the list of its arguments;
{"parameter": "rate"} is a parameter. Where an object may be of several classes, "is" names its class.
"""

from __future__ import annotations

import types
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from fractions import Fraction
from functools import cache
from typing import Any, Union, get_args, get_origin, get_type_hints

from safety.trees import common_cause, study, substitutions
from safety.trees.as_written import Rational, TreeError, exact
from safety.trees.event_trees import definitions as event_trees
from safety.trees.expressions.expression import Constant, Expression, MissionTime, Operation, Parameter
from safety.trees.formats.draft import at
from safety.trees.formats.json_expressions import expression_to_json
from safety.trees.formats.mef_expressions import FUNCTIONS

SECTIONS = {
    "ccf_groups": common_cause.CcfGroup,
    "substitutions": substitutions.Substitution,
    "alignments": study.Alignment,
    "initiating_events": event_trees.InitiatingEvent,
    "event_trees": event_trees.EventTree,
}
NAMES = {"Expression": Expression, "Factor": Union[Expression, Rational], "Rational": Rational}  # noqa: UP007


def to_json(value: Any) -> Any:
    """A part of a study as JSON."""
    if isinstance(value, Constant):
        return {"constant": str(value.number)}  # a plain number is a Fraction
    if isinstance(value, Expression):
        return expression_to_json(value)
    if isinstance(value, common_cause.CcfGroup):
        total, factors = value.as_given
        written = {
            "name": value.name,
            "model": value.model,
            "members": list(value.members),
            "factors": to_json(factors),
        }
        rest = {"total": to_json(total), "testing": value.testing, "description": value.description}
        return written | {key: one for key, one in rest.items() if one}
    if is_dataclass(value):
        written = {
            field.name: to_json(getattr(value, field.name))
            for field in fields(value)
            if getattr(value, field.name) != field.default
        }
        return {"is": type(value).__name__} | written if type(value) in _alternatives() else written
    if isinstance(value, Mapping):
        return {str(key): to_json(one) for key, one in value.items()}
    if isinstance(value, tuple):
        return [to_json(one) for one in value]
    return str(value) if isinstance(value, Fraction) else value


@cache
def _alternatives() -> frozenset[type]:
    """The classes that stand where another could."""
    ends = get_type_hints(event_trees.Branch, vars(event_trees) | NAMES)["target"]
    return frozenset(get_args(event_trees.Instruction) + get_args(event_trees.Condition) + get_args(ends))


class Parts:
    """The parts of a study in a JSON document. Raises TreeError."""

    def __init__(self, document: dict[str, Any], place: str, places: Mapping[str, str]) -> None:
        self._place, self._start, self._places = place, place, places  # of what has a name
        self._written: dict[str, dict[str, Any]] = {}
        self._made: dict[str, Parameter] = {}
        self._open: list[str] = []
        for entry in document.get("parameters", []):
            if not isinstance(entry, dict) or not isinstance(entry.get("name"), str) or "expression" not in entry:
                raise self._error(f'{_shown(entry)} is no parameter, expected "name" and "expression"; correct it')
            if unknown := entry.keys() - {"name", "expression", "unit", "source"}:
                raise self._error(f'parameter "{entry["name"]}" has the unknown key "{min(unknown)}"; remove it')
            if entry["name"] in self._written:
                raise self._error(f'parameter "{entry["name"]}" is defined twice; rename or remove one')
            self._written[entry["name"]] = entry
        self.found: dict[str, Any] = {}
        for section in SECTIONS:
            if section in document:
                self.found[section] = tuple(self._named(entry, section) for entry in document[section])
        self._place = place
        if self._written:
            self.found["parameters"] = {name: self.parameter(name) for name in self._written}
        if "tops" in document:
            self.found["tops"] = self._part(document["tops"], tuple[str, ...], "tops")
        if "tree_names" in document:
            self.found["tree_names"] = self._part(document["tree_names"], Mapping[str, str], "tree_names")

    def _named(self, entry: Any, section: str) -> Any:
        if isinstance(entry, dict):
            self._place = self._places.get(str(entry.get("name")), self._start)
        return self._part(entry, SECTIONS[section], section)

    def expression(self, entry: Any) -> Expression:
        """The expression that a JSON value stands for."""
        if isinstance(entry, str | int) and not isinstance(entry, bool):
            return Constant(exact(entry, "a number in an expression"))
        if not isinstance(entry, dict) or len(entry) != 1:
            raise self._error(
                f'{_shown(entry)} is no expression, expected a number or {{"name": [arguments]}}; correct it'
            )
        [(tag, given)] = entry.items()
        if tag == "parameter" and isinstance(given, str):
            return self.parameter(given)
        if tag == "constant":
            return self.expression(given)
        if not isinstance(given, list):
            raise self._error(f'"{tag}" holds {_shown(given)}, expected the list of its arguments; correct it')
        arguments = [self.expression(one) for one in given]
        if tag == MissionTime.tag and not arguments:
            return MissionTime()
        return FUNCTIONS[tag](*arguments) if tag in FUNCTIONS else Operation(tag, *arguments)

    def parameter(self, name: str) -> Parameter:
        """The parameter of that name, made once."""
        if name in self._made:
            return self._made[name]
        if name not in self._written:
            raise self._error(f'parameter "{name}" is not defined; define it under "parameters"')
        if name in self._open:
            loop = " -> ".join([*self._open[self._open.index(name) :], name])
            raise self._error(f"parameters in a cycle: {loop}; give one of them a number")
        self._open.append(name)
        entry = self._written[name]
        unit, source = (str(entry.get(key, "")) for key in ("unit", "source"))
        self._made[name] = Parameter(name, self.expression(entry["expression"]), unit, source)
        self._open.pop()
        return self._made[name]

    def _part(self, entry: Any, hint: Any, what: str) -> Any:
        """The value of type `hint` that a JSON value stands for."""
        kinds = get_args(hint) if get_origin(hint) in (Union, types.UnionType) else (hint,)
        if Expression in kinds and isinstance(entry, dict):
            return self.expression(entry)
        if Fraction in kinds and isinstance(entry, str | int) and not isinstance(entry, bool):
            return exact(entry, what)
        if type(entry) in kinds and isinstance(entry, str | bool | None):
            return entry
        origin, inner = get_origin(hint), get_args(hint)
        if origin is tuple and isinstance(entry, list):
            each = [inner[0]] * len(entry) if inner[-1] is ... else inner
            if len(each) == len(entry):
                return tuple(self._part(one, one_hint, what) for one, one_hint in zip(entry, each, strict=True))
        if origin is Mapping and isinstance(entry, dict):
            return {self._key(key, inner[0]): self._part(one, inner[1], what) for key, one in entry.items()}
        classes = {kind.__name__: kind for kind in kinds if isinstance(kind, type) and is_dataclass(kind)}
        if classes and isinstance(entry, dict):
            kind = classes.get(str(entry.get("is"))) or next(iter(classes.values()))
            return self._object({key: one for key, one in entry.items() if key != "is"}, kind, what)
        expected = " or ".join(getattr(kind, "__name__", str(kind)) for kind in kinds)
        raise self._error(f'"{what}" holds {_shown(entry)}, expected {expected}; correct it')

    def _key(self, key: str, kind: type) -> Any:
        if kind is str:
            return key
        if not key.isdecimal() or len(key) > 9:
            raise self._error(f'"{key}" is no level, expected a whole number; correct it')
        return int(key)

    def _object(self, entry: dict[str, Any], kind: Any, what: str) -> Any:
        hints = get_type_hints(kind, vars(event_trees) | vars(common_cause) | vars(study) | NAMES)
        known = {field.name: field for field in fields(kind)}
        for key in entry:
            if key not in known:
                raise self._error(
                    f'{kind.__name__} in "{what}" has the unknown key "{key}", expected {", ".join(known)}'
                )
        for name, field in known.items():
            if name not in entry and field.default is MISSING and field.default_factory is MISSING:
                raise self._error(f'{kind.__name__} in "{what}" has no "{name}"; add it')
        values = {key: self._part(one, hints[key], key) for key, one in entry.items()}
        with at(self._place):
            return kind(**values)

    def _error(self, message: str) -> TreeError:
        return TreeError(message, place=self._place)


def _shown(entry: Any) -> str:
    return repr(entry)[:40]

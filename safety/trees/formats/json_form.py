"""The project's own JSON form of a fault tree.

One object. Numbers are decimals or "p/q" strings and are kept exactly; an absent key is an empty or unknown value:

    {"format": "rightside/fault-tree/1", "name": "Wrong-side permit", "top": "G0", "mission_time_h": "8760",
     "gates":        [{"name": "G0", "kind": "vote", "k": 2, "inputs": ["A", "B", "C"], "description": "..."}],
     "basic_events": [{"name": "A", "probability": "1/1000", "description": "...", "source": "P"},
                      {"name": "B", "rate_per_hour": "1e-6", "mission_time_h": "10", "source": "A"}],
     "house_events": [{"name": "C", "state": true}]}

A basic event may have an "expression" in place of numbers; gates and events may have "attributes", an object of texts.
What a Study holds beside its gates and events, and the form of expressions, is in `json_study`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from fractions import Fraction

from safety.trees.as_written import TreeError, exact
from safety.trees.formats.draft import Draft, at
from safety.trees.tree import BasicEvent, FaultTree, Gate, HouseEvent, Node

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any

    from safety.trees.study import Study

    Keys = dict[str, Any]  # the types each key may have

FORMAT = "rightside/fault-tree/1"
NUMBER = (str, int)  # numbers with a point arrive as their text, so that nothing is rounded
QUANTITIES = {"probability": NUMBER, "rate_per_hour": NUMBER, "mission_time_h": NUMBER}
TEXTS = {"name": str, "description": str}
NODE = TEXTS | {"attributes": dict}
DOCUMENT: Keys = TEXTS | {
    "format": str,
    "top": str,
    "mission_time_h": NUMBER,
    "gates": list,
    "basic_events": list,
    "house_events": list,
    "parameters": list,
    "tops": list,
    "tree_names": dict,
    "ccf_groups": list,
    "substitutions": list,
    "alignments": list,
    "initiating_events": list,
    "event_trees": list,
}
TIMES = ("description", "mission_time_h")
STUDY = tuple(DOCUMENT)[-8:]  # the keys of a Study only
ENTRIES: dict[str, tuple[type[Gate | BasicEvent | HouseEvent], Keys]] = {
    "gates": (Gate, NODE | {"kind": str, "k": int, "inputs": list, "inside": str}),
    "basic_events": (BasicEvent, NODE | QUANTITIES | {"source": str, "expression": (*NUMBER, dict)}),
    "house_events": (HouseEvent, NODE | {"state": bool}),
}
REQUIRED = {"gates": ("name", "kind", "inputs"), "basic_events": ("name",), "house_events": ("name", "state")}


def to_document(tree: FaultTree | Study) -> dict[str, Any]:
    """`tree`, or a whole study, as the JSON object above, ready for json.dumps, numbers as exact text;

    `read_json` takes it back.
    """
    keys = ("name", "top", "description", "mission_time_h") if isinstance(tree, FaultTree) else ("name", *TIMES)
    head = {"format": FORMAT} | _written(tree, keys)
    lists: dict[str, Sequence[Node]] = {
        "gates": tree.gates,
        "basic_events": tree.events,
        "house_events": tree.house_events,
    }
    sections = {
        section: [_written(node, tuple(ENTRIES[section][1])) for node in nodes] for section, nodes in lists.items()
    }
    expressions = [event.expression for event in tree.events if event.expression is not None]
    if isinstance(tree, FaultTree) and not expressions:
        return head | sections
    from safety.trees.formats.json_expressions import parameters_to_json

    if isinstance(tree, FaultTree):
        parts = {"parameters": parameters_to_json(expressions)}
    else:
        from safety.trees.formats.json_study import to_json

        parts = {"parameters": parameters_to_json(tree.parameters.values())}
        parts |= {key: to_json(getattr(tree, key)) for key in STUDY[1:]}
    return head | sections | {key: part for key, part in parts.items() if part}


def _written(node: Node | FaultTree | Study, keys: tuple[str, ...]) -> dict[str, Any]:
    return {key: _value(key, value) for key in keys if (value := getattr(node, key)) not in (None, "", ())}


def _value(key: str, value: Any) -> Any:
    if key == "expression":
        from safety.trees.formats.json_expressions import expression_to_json

        return expression_to_json(value)
    if isinstance(value, tuple):
        return dict(value) if key == "attributes" else list(value)
    return str(value) if isinstance(value, Fraction) else value


def read_json(text: bytes, file: str, mission_time_h: Fraction | None = None) -> Draft:
    """The definitions in a JSON text; `mission_time_h` replaces that of the file.

    Raises TreeError with file and line.
    """
    try:
        content = text.decode("utf-8-sig")
        document = json.loads(content, parse_float=str, parse_constant=str, object_pairs_hook=_object)
    except json.JSONDecodeError as error:
        message = f"not JSON ({error.msg}, column {error.colno}); correct it there"
        raise TreeError(message, place=f"{file}:{error.lineno}") from None
    except TreeError as error:
        raise error.at(file) from None
    except ValueError as error:
        raise TreeError(f"{file}: not JSON in UTF-8 ({error}); correct it") from None

    places = {name: f"{file}:{line}" for name, line in _names_by_line(content)}
    with at(f"{file}:1"):
        study = isinstance(document, dict) and any(key in document for key in STUDY[1:])
        _check(document, "the document", DOCUMENT, ("format",) if study else ("format", "name", "top", "gates"))
        if document["format"] != FORMAT:
            raise TreeError(f'the format is "{document["format"]}", expected "{FORMAT}"; convert the file')
        time = mission_time_h
        if time is None and "mission_time_h" in document:
            time = exact(document["mission_time_h"], "mission_time_h")
    draft = Draft(file, document.get("name", ""), document.get("top", ""), document.get("description", ""), time)
    expression = None
    if any(key in document for key in STUDY) or any(_has_expression(one) for one in document.get("basic_events", [])):
        from safety.trees.formats.json_study import Parts

        with at(f"{file}:1"):
            parts = Parts(document, f"{file}:1", places)
        draft.parts, expression = parts.found, parts.expression
        draft.tops, draft.tree_names = draft.parts.pop("tops", ()), draft.parts.pop("tree_names", {})
    for section, (node, keys) in ENTRIES.items():
        for number, entry in enumerate(document.get(section, []), 1):
            where = places.get(str(entry.get("name")), file) if isinstance(entry, dict) else file
            with at(where):
                _check(entry, f"entry {number} of {section}", keys, REQUIRED[section])
                if "attributes" in entry:
                    entry["attributes"] = tuple(entry["attributes"].items())
                if "expression" in entry and expression is not None:
                    entry["expression"] = expression(entry["expression"])
                draft.add(node(**entry), where)
    return draft


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise TreeError(f'the key "{twice}" stands twice in an object, beside {json.dumps(keys)[:80]}; remove one')
    return found


def _has_expression(entry: object) -> bool:
    return isinstance(entry, dict) and "expression" in entry


def _names_by_line(content: str) -> Iterator[tuple[str, int]]:
    """Every "name" in a JSON text with the line that it stands in."""
    line, start = 1, 0
    for found in re.finditer(r'"name"\s*:\s*("(?:[^"\\]|\\.)*")', content):
        line, start = line + content.count("\n", start, found.start(1)), found.start(1)
        yield json.loads(found[1]), line


def _check(entry: object, what: str, keys: Keys, required: tuple[str, ...]) -> None:
    """That `entry` is an object with the required keys, no unknown ones, and values of the right types."""
    if not isinstance(entry, dict):
        raise TreeError(f"{what} is {json.dumps(entry)[:40]}, expected an object {{...}}; correct it")
    for key in required:
        if key not in entry:
            raise TreeError(f'{what} has no "{key}"; add it')
    for key, value in entry.items():
        if key not in keys:
            raise TreeError(f'{what} has the unknown key "{key}", expected {", ".join(keys)}; correct or remove it')
        if not isinstance(value, keys[key]) or (isinstance(value, bool) and keys[key] is not bool):
            expected = " or ".join(
                kind.__name__ for kind in (keys[key] if isinstance(keys[key], tuple) else (keys[key],))
            )
            raise TreeError(f'"{key}" of {what} is {json.dumps(value)[:40]}, expected {expected}; correct it')
        texts = {"inputs": value, "tops": value, "attributes": value.values() if isinstance(value, dict) else ()}
        if not all(isinstance(text, str) for text in texts.get(key, ())):
            raise TreeError(f'"{key}" of {what} holds something else than texts; give texts only')

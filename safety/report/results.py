"""The results document: load it, merge parts of it, bring it to canonical form, write it.

    load(path) -> results          read and validated, or ResultsError with file, place and what was expected
    merge(first, *others)          one document out of several; the later entry with the same model and id wins
    canonical(results)             what is committed: no times, no machine, no solver versions, entries in order of id
    save(results, path)            atomically: a reader sees the old file or the new one

Results are plain dicts in the shape of `schema.Document`.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, get_args

import msgspec

from safety.report import schema
from safety.report.files import ResultsError, dumps, write_bytes, write_text
from safety.report.numbers import clean
from safety.report.schema import SCHEMA, SECTIONS, Entry
from safety.report.standing import exit_code

__all__ = [
    "Results",
    "ResultsError",
    "canonical",
    "dumps",
    "empty",
    "exit_code",
    "load",
    "loads",
    "merge",
    "save",
    "validate",
    "write_bytes",
    "write_text",
]

Results = dict[str, Any]

# Keys of an entry that differ from run to run, with the solver or the machine: times, questions asked, a state it
# happened to pick, whether the result is of an earlier run, what ran the injections
VOLATILE = frozenset(
    {"seconds", "injections_per_second", "engine", "engine_note", "questions", "candidate", "cached", "rechecked"}
)
DIGITS = 12  # significant digits of a committed double: mathematical libraries differ in the last two or three
_PLACE = re.compile(r" - at `\$(.*)`$")


def empty(**tool: str) -> Results:
    """A document without results, made by these versions."""
    return {"schema": SCHEMA, "tool": tool}


def load(path: Path) -> Results:
    """Read and validate; raises ResultsError with file, place and what was expected there."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ResultsError(f"{path}: no such file; `rightside verify --json {path}` writes it") from None
    except UnicodeDecodeError as bad:
        raise ResultsError(f"{path}: byte {bad.start}: not UTF-8 text; expected a results document in JSON") from None
    except OSError as bad:
        raise ResultsError(f"{path}: cannot be read: {bad.strerror}") from None
    return loads(text, str(path))


def loads(text: str, name: str = "results") -> Results:
    """Parse and validate; `name` stands in messages for the file."""
    try:
        document = json.loads(text, parse_constant=_no_constant, object_pairs_hook=_no_double_key)
    except json.JSONDecodeError as bad:
        raise ResultsError(f"{name}: line {bad.lineno}, column {bad.colno}: {bad.msg}; expected JSON") from None
    except ValueError as bad:
        raise ResultsError(f"{name}: {bad}") from None
    except RecursionError:
        raise ResultsError(f"{name}: nested too deeply for a results document") from None
    return validate(document, name)


def validate(document: Any, name: str = "results") -> Results:
    """The same document, if its shape is right."""
    if isinstance(document, dict) and document.get("schema") != SCHEMA:
        raise ResultsError(f'{name}: schema: {document.get("schema")!r}; expected "{SCHEMA}"')
    try:
        msgspec.convert(document, schema.Document)
    except msgspec.ValidationError as bad:
        raise ResultsError(clean(f"{name}: {_explain(str(bad), document)}")) from None
    for section in SECTIONS:
        seen: set[tuple[str, str]] = set()
        for n, entry in enumerate(document.get(section, ())):
            if key(entry) in seen:
                raise ResultsError(
                    f"{name}: {section}[{n}]: id {entry['id']!r} is used twice; expected one entry an id in a model"
                )
            seen.add(key(entry))
    return dict(document)


def merge(first: Results, *others: Results) -> Results:
    """One document out of several, entries in order; the later one of the same model and id wins."""
    merged = dict(first)
    for other in others:
        for name, value in other.items():
            if name in SECTIONS:
                entries = {key(entry): entry for entry in (*merged.get(name, ()), *value)}
                merged[name] = sorted(entries.values(), key=key)
            elif name in ("runs", "limits"):
                merged[name] = [*merged.get(name, ()), *(item for item in value if item not in merged.get(name, ()))]
            elif name == "tool":
                merged[name] = {**merged.get(name, {}), **value}
            else:
                merged[name] = value
    return merged


def canonical(results: Results) -> Results:
    """The part of the results that depends on models, claims and tool release alone: equal runs give equal bytes."""
    kept = {name: value for name, value in results.items() if name not in (*SECTIONS, "runs", "tool")}
    kept["tool"] = {name: value for name, value in results.get("tool", {}).items() if name == "rightside"}
    for section in SECTIONS:
        if section == "event_trees" and not results.get(section):
            continue  # no project has them, only tree files
        entries = sorted(results.get(section, ()), key=key)
        kept[section] = [{name: value for name, value in entry.items() if name not in VOLATILE} for entry in entries]
    kept["claims"] = [_without_guesses(entry) for entry in kept["claims"]]
    settled: Results = _settled(kept)
    return settled


def _without_guesses(entry: dict[str, Any]) -> dict[str, Any]:
    """An entry without the lemmas that the tool found: which of several that do depends on the time it had."""
    if not entry.get("found_lemmas"):
        return entry
    means = "induction" if str(entry.get("method")).startswith("induction") else "closed form"
    return {**entry, "method": f"{means}, lemmas found by the tool", "lemmas": [], "found_lemmas": 1}


def save(results: Results, path: Path) -> None:
    """Validate and write, atomically."""
    write_text(path, dumps(validate(results, str(path))))


def key(entry: Entry) -> tuple[str, str]:
    return entry.get("model") or "", entry["id"]


def _settled(value: Any) -> Any:
    """Numbers rounded and keys in order, as they come back from a file: what is made of either is the same."""
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}")
    if isinstance(value, dict):
        return {name: _settled(item) for name, item in sorted(value.items())}
    return [_settled(item) for item in value] if isinstance(value, list | tuple) else value


def _no_constant(word: str) -> None:
    raise ValueError(f'{word} is not JSON; expected "inf" for an infinite value, null for an unknown one')


def _no_double_key(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    document = dict(pairs)
    if len(document) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"key {next(name for name in names if names.count(name) > 1)!r} stands twice in one object")
    return document


def _explain(message: str, document: Any) -> str:
    """msgspec's message with the place first, the entry's id beside it and the words that are allowed."""
    found = _PLACE.search(message)
    place, what = (found[1].lstrip("."), message[: found.start()]) if found else ("top", message)
    entry = re.match(r"(\w+)\[(\d+)\]", place)
    if entry:
        got = document[entry[1]][int(entry[2])]
        place += f" ({got['id']})" if isinstance(got, dict) and "id" in got else ""
    word = re.search(r"\.(verdict|expect)\b", place)
    if word and what.startswith("Invalid enum"):
        allowed = schema.FigureVerdict if place.startswith("figures") else schema.Verdict
        what += f"; expected one of {', '.join(get_args(allowed))}"
    return f"{place}: {what}"

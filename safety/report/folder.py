"""The report folder: results.json, index.html, junit.xml, trees/*.svg, plots/*.svg, written and checked.

Everything in it follows from the canonical results alone, so a committed folder that differs is stale.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from safety.report import results as documents
from safety.report.html import html, picture, plotted, slugs
from safety.report.junit import junit
from safety.report.numbers import clean
from safety.report.results import Results
from safety.report.schema import SECTIONS


class Difference(NamedTuple):
    """A file that is not as `write` would leave it."""

    file: str  # relative to the folder, with forward slashes
    kind: str  # missing, stale, extra
    detail: str

    def __str__(self) -> str:
        return f"{self.file}: {self.kind}: {self.detail}"


def write(results: Results, folder: Path, timings: bool = False) -> list[Path]:
    """Write the folder, removing pictures that are gone; with timings it is to be read, not committed."""
    files = _files(results, timings)
    for name, text in files.items():
        documents.write_text(folder / name, text)
    for drawn in ("trees", "plots"):
        for drawing in (folder / drawn).glob("*.svg"):
            if f"{drawn}/{drawing.name}" not in files:
                drawing.unlink()
    return [folder / name for name in files]


def check(results: Results, folder: Path) -> list[Difference]:
    """What keeps the folder from being the one that `write` would write; empty when it is fresh."""
    wanted = _files(results)
    there = (
        {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
        if folder.is_dir()
        else set()
    )
    missing, extra = wanted.keys() - there, there - wanted.keys() - set(_mentioned(results))
    differences = [Difference(name, "missing", "run `rightside report` to write it") for name in sorted(missing)]
    differences += [Difference(name, "extra", "no result makes or names it; delete it") for name in sorted(extra)]
    for name in sorted(there & wanted.keys()):
        got = (folder / name).read_bytes()
        if got != wanted[name].encode():
            differences.append(Difference(name, "stale", _first_difference(name, got, wanted[name])))
    return differences


def _files(results: Results, timings: bool = False) -> dict[str, str]:
    documents.validate(results)
    fixed = documents.canonical(results)
    shown = results if timings else fixed
    files = {
        "results.json": documents.dumps(shown),
        "index.html": html(results, timings),
        "junit.xml": junit(shown, timings),
    }
    pictures = {slug: picture(tree) for tree, slug in zip(fixed["trees"], slugs(fixed["trees"]), strict=True)}
    plots = [exhibit for exhibit in fixed["exhibits"] if exhibit.get("marks")]
    drawings = {f"plots/{slug}.svg": plotted(plot, slug) for plot, slug in zip(plots, slugs(plots), strict=True)}
    drawings |= {f"trees/{slug}.svg": drawn for slug, drawn in pictures.items() if drawn}
    return files | {name: clean(drawn) for name, drawn in drawings.items()}


def _mentioned(results: Results) -> Iterator[str]:
    """Files that may lie in the folder: waveforms, written on demand and named by the results."""
    for claim in results.get("claims", ()):
        waveform = (claim.get("counterexample") or {}).get("vcd")
        if waveform:
            yield waveform


def _first_difference(name: str, got: bytes, wanted: str) -> str:
    try:
        text = got.decode()
    except UnicodeDecodeError:
        return "not UTF-8 text"
    if name == "results.json":
        try:
            committed = documents.loads(text)
        except documents.ResultsError as bad:
            return str(bad)
        place = next(_places(committed, documents.loads(wanted)), None)
        if place:
            return place
    for number, (old, new) in enumerate(zip(text.splitlines(), wanted.splitlines(), strict=False), start=1):
        if old != new:
            return f"line {number}: committed {_short(old)}, now {_short(new)}"
    return f"{len(text.splitlines())} lines committed, {len(wanted.splitlines())} now"


def _places(old: Any, new: Any, place: str = "") -> Iterator[str]:
    """Where two documents differ; entries of a section are matched by model and id."""
    if isinstance(old, dict) and isinstance(new, dict):
        for name in sorted(old.keys() | new.keys()):
            inner = f"{place}.{name}" if place else name
            if name not in old or name not in new:
                yield f"{inner}: {'not committed yet' if name in new else 'committed, but no longer there'}"
            else:
                yield from _places(old[name], new[name], inner)
    elif isinstance(old, list) and isinstance(new, list) and place in SECTIONS:
        olds, news = ({_name(entry): entry for entry in entries} for entries in (old, new))
        yield from _places(olds, news, place)
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for n, (before, now) in enumerate(zip(old, new, strict=True)):
            yield from _places(before, now, f"{place}[{n}]")
    elif old != new or type(old) is not type(new):
        yield f"{place}: committed {_short(repr(old))}, now {_short(repr(new))}"


def _name(entry: dict[str, Any]) -> str:
    return "/".join(filter(None, documents.key(entry)))


def _short(text: str) -> str:
    """Fit for one line."""
    text = text.strip()
    return text if len(text) <= 80 else text[:77] + "..."

"""What `verify` says at its end: the unexpected first, with the trace's changed cells, then counts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, TextIO

from safety.report.numbers import exact_text, one_line
from safety.report.sarif import replay_command
from safety.report.schema import JUDGED, Entry
from safety.report.standing import WORDS, WORST_FIRST, exit_code, judge
from safety.report.trace import Trace

WIDTH = 118
CELLS = 8  # ticks in a table of changed cells
SIGNALS = 20
UNEXPECTED = 20  # results told in full


class Line(NamedTuple):
    """A line of text and how a terminal shows it."""

    text: str
    style: str = ""  # rich's words; only a terminal shows them


def show(results: Mapping[str, Any], stream: TextIO) -> None:
    """Print the summary; in colour only where the stream is a terminal."""
    lines = summary(results)
    if not stream.isatty():
        encoding = getattr(stream, "encoding", None) or "utf-8"
        text = "".join(f"{line.text}\n" for line in lines)
        stream.write(text.encode(encoding, "replace").decode(encoding))
        return
    from rich.console import Console
    from rich.text import Text

    console = Console(file=stream, highlight=False, soft_wrap=True)
    for line in lines:
        console.print(Text(line.text, style=line.style))


def summary(results: Mapping[str, Any]) -> list[Line]:
    """All lines: first each result that is not as asked, then counts and the exit code."""
    return [*_unexpected(results), *_counts(results)]


def _unexpected(results: Mapping[str, Any]) -> Iterator[Line]:
    off = sorted((it for it in judge(results) if it.standing.code), key=lambda it: WORST_FIRST.index(it.standing.code))
    for section, entry, standing in off[:UNEXPECTED]:
        head = str(entry["verdict"] if section == "claims" else WORDS[standing.code]).upper()
        yield Line(_fit(f"x {head:<10} {entry['id']}  {entry.get('requirement') or ''}".rstrip()), "bold red")
        yield Line(_fit(f"    {standing.reason}"), "red")
        if entry.get("statement"):
            yield Line(_fit(f"    {entry['statement']}"))
        if entry.get("why"):
            yield Line(_fit(f"    why: {entry['why']}"))
        if entry.get("counterexample"):
            yield from changed_cells(entry)
        surprises = entry.get("surprises") or ()
        if len(surprises) > 1 or entry.get("baseline"):
            yield from (Line(f"    {one_line(text)}") for text in surprises)  # in full: a command in it is to be copied
        yield Line("")
    if len(off) > UNEXPECTED:
        yield Line(f"  and {len(off) - UNEXPECTED} more results that are not as asked", "red")


def changed_cells(claim: Entry) -> Iterator[Line]:
    """The counterexample as a table: a star at each changed cell, the violated tick named in the head.

    Of a bound it is the point, a value a line.
    """
    counterexample = claim["counterexample"]
    if counterexample.get("values"):
        yield from _point(claim)
        return
    trace = Trace(counterexample)
    table = trace.table(CELLS)
    yield Line(_fit(f"    faults  {'; '.join(counterexample.get('faults') or ['none'])}"))
    if not table.ticks:
        return
    heads = [f"!{tick}" if tick == table.violated else str(tick) for tick in table.ticks]
    rows = [
        (_tail(row.lane.path, 30), [f"*{c.text}" if c.changed else c.text for c in row.cells])
        for row in table.rows[:SIGNALS]
    ]
    label = max(len(name) for name, _ in [("tick", []), *rows])
    widths = [max(len(_cell(texts[n])) for texts in [heads, *(cells for _, cells in rows)]) for n in range(len(heads))]
    for name, texts in [("tick", heads), *rows]:
        cells = "  ".join(_cell(text).rjust(width) for text, width in zip(texts, widths, strict=True))
        yield Line(f"    {one_line(name):<{label}}  {cells}", "bold" if name == "tick" else "")
    notes = [_many(len(table.rows) - SIGNALS, "more signal")] * (len(table.rows) > SIGNALS)
    notes += [f"{_many(table.left_out, 'earlier change')} after tick {table.ticks[0]}"] * bool(table.left_out)
    if table.violated is not None:
        yield Line(
            _fit(f"    * changed   ! violates {claim['id']}" + "".join(f"   ({note} not shown)" for note in notes)),
            "red",
        )
    if counterexample.get("replay"):
        yield Line(_fit(f"    next    {counterexample['replay']}"))


def _point(claim: Entry) -> Iterator[Line]:
    """The point at which a bound is exceeded; exact values in full, whatever their length."""
    counterexample = claim["counterexample"]
    values = counterexample["values"]
    label = max(map(len, ["exceeded", *values]))
    for name, text in values.items():
        yield Line(f"    {one_line(name):<{label}}  {one_line(text)}")
    if counterexample.get("value"):
        value, limit = exact_text(counterexample["value"]), exact_text(claim.get("limit"))
        yield Line(one_line(f"    {'exceeded':<{label}}  {value}, limit {limit}"), "red")
    if counterexample.get("replay"):
        yield Line(_fit(f"    next    {counterexample['replay']}"))


def _counts(results: Mapping[str, Any]) -> Iterator[Line]:
    verdicts = Counter(claim["verdict"] for claim in results.get("claims", ()))
    if verdicts:
        as_must = sum(claim["verdict"] == claim["expect"] == "refuted" for claim in results["claims"])
        words = [
            f"{count} {verdict}" + (f" ({as_must} as they must be)" if verdict == "refuted" else "")
            for verdict, count in sorted(verdicts.items())
        ]
        yield Line(f"{_many(len(results['claims']), 'claim')}: {', '.join(words)}")
    for campaign in results.get("campaigns", ()):
        classes = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in campaign["classes"].items())
        kind = "exhaustive" if campaign["exhaustive"] else "sampled"
        yield Line(_fit(f"{campaign['id']}: {campaign['injections']} injections, {kind}: {classes}"))
        parts = (campaign.get("closure") or {}).get("parts")
        if parts:
            told = ", ".join(f"{part['faults']} {name}" for name, part in parts.items())
            yield Line(_fit(f"    single faults by what settles them: {told}"))
            yield from (Line(_fit(f"    does not count: {text}")) for text in campaign["closure"]["open"])
        baseline = campaign.get("baseline") or {}
        if baseline.get("better"):
            yield Line(one_line(f"    better than {baseline['file']}: {'; '.join(baseline['better'])}"), "green")
            yield Line(one_line(f"    `rightside inject --write-baseline {baseline['file']}` keeps it"))
        for one in campaign.get("reproducers") or ():
            command = replay_command(f"{campaign['id']}::{one['injection']}")
            yield Line(one_line(f"    minimal reproducer of {one['of']}: {command}"))
    others = [
        _many(len(results[section]), section.removesuffix("s").replace("_", " "))
        for section in JUDGED[2:]
        if results.get(section)
    ]
    if others:
        yield Line(", ".join(others))
    code = exit_code(results)
    yield Line(f"exit {code}: {WORDS[code]}", "bold green" if code == 0 else "bold red")


def _many(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _fit(text: str) -> str:
    text = one_line(text)
    return text if len(text) <= WIDTH else text[: WIDTH - 3] + "..."


def _tail(text: str, room: int) -> str:
    return text if len(text) <= room else "..." + text[3 - room :]


def _cell(text: str) -> str:
    return _tail(one_line(text), 12)

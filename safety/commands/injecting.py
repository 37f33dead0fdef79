"""A campaign worked on as the command asks: engine, place of work, target, baseline, reproducers; its entry."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from safety.commands import CommandError
from safety.commands.evaluate import Note, fitting
from safety.commands.gate import against, aim, fail
from safety.inject.engine import NATIVE
from safety.project import Project, Value
from safety.report.numbers import number

if TYPE_CHECKING:
    from safety.inject import Campaign, Result
    from safety.report.schema import Entry

EVERY = ""  # the name under which a target is for all campaigns


@dataclass(frozen=True)
class Wishes:
    """What the command asks of campaigns beside what they declare; plain values, so that a worker can be told."""

    engine: str = ""
    collapsing: bool = True
    audit: bool = False
    targets: Mapping[str, str] = field(default_factory=dict)
    baseline: str = ""
    record: bool = False
    shrink: int = 0
    csv: str = ""
    xlsx: str = ""
    shard: str = ""
    several: bool = False  # campaigns: each has files of its own

    def file(self, kind: str, campaign: str) -> Path | None:
        """The file of failure modes of a campaign: as given; where there are several, with its id before the ending."""
        path = Path(getattr(self, kind))
        if not getattr(self, kind):
            return None
        return path.with_name(f"{path.stem}-{campaign}{path.suffix}") if self.several else path

    @property
    def changes(self) -> dict[str, Any]:
        """What is changed of a campaign; none of it changes an answer."""
        found: dict[str, Any] = {"engine": self.engine} if self.engine else {}
        if not self.collapsing:
            found["collapsing"] = False
        return found | ({"audit": True} if self.audit else {})


Run = Callable[["Campaign", Note], "tuple[Result, Sequence[str]]"]


def prepare(campaign: Campaign, wishes: Wishes, settings: Mapping[str, Value]) -> None:
    """Give a campaign its settings, and change it as asked."""
    if isinstance(campaign.model, type):
        campaign.settings = {**campaign.settings, **fitting(campaign.model, settings)}
    for name, value in wishes.changes.items():
        setattr(campaign, name, value)


def injected(campaign: Campaign, wishes: Wishes, project: Project, note: Note, run: Run | None = None) -> Entry:
    """The entry of a campaign that is prepared; `run` gives its result, by default in this process.

    Raises `CommandError` when the engine that is asked for is not there.
    """
    try:
        result, problems = (run or here)(campaign, note)
    except ImportError as missing:
        if campaign.engine != NATIVE:
            raise
        raise CommandError(f"{campaign.id}: engine {campaign.engine}: {missing}; give --engine lanes") from None
    entry = result.to_json()
    entry["declared"] = declared(campaign, project.root)
    if campaign.proofs and not result.interrupted:
        from safety.closure import compared

        entry["closure"] = {"faults": compared(campaign, result, project.claims, project.hazards)}
    if wishes.shard and result.interrupted:
        _as_a_part(entry, wishes.shard, len(campaign.space))
    for problem in problems:
        fail(entry, problem, [problem])
    target = wishes.targets.get(campaign.id, wishes.targets.get(EVERY, campaign.target_coverage))
    if target is not None and not result.interrupted:
        aim(entry, Fraction(target))
    if (wishes.baseline or wishes.record) and not result.interrupted:
        _hold_against(entry, result, wishes)
    _write_modes(entry, result, wishes)
    if wishes.shrink:
        _shrink(campaign, entry, wishes.shrink, note)
    return entry


def _as_a_part(entry: Entry, shard: str, of: int) -> None:
    """An entry of the shards of one of several machines: nothing else was asked for, so nothing is missing."""
    note = f"part {shard}: {entry['injections']} of {of} injections are kept"
    entry |= {"part": shard, "surprises": [], "as_expected": True, "expect": {"exhaustive": False}, "note": note}


def here(campaign: Campaign, note: Note) -> tuple[Result, Sequence[str]]:
    """Run a campaign in this process, where nothing keeps it from being made."""
    return campaign.inject(pace(campaign, note)), ()


def pace(campaign: Campaign, note: Note) -> Callable[[float, float], None]:
    """Tell of progress: the share done, injections a second, and how long it still takes."""

    def tell(share: float, seconds: float) -> None:
        rate = share * len(campaign.space) / seconds if seconds > 0 else 0.0
        left = seconds * (1 - share) / share if share > 0 else 0.0
        note(f"{share:.0%}, {number(float(f'{rate:.2g}'))}/s, {left:.0f} s left")

    return tell


def declared(campaign: Campaign, root: Path) -> dict[str, Any] | None:
    """The file, relative to the project, and the line where a campaign is declared; None when that is elsewhere."""
    file, line = campaign.place
    path = Path(file)
    return {"file": path.relative_to(root).as_posix(), "line": line} if path.is_relative_to(root) else None


def _write_modes(entry: Entry, result: Result, wishes: Wishes) -> None:
    """The tables of failure modes; campaigns of pairs have none."""
    if not (wishes.csv or wishes.xlsx):
        return
    from safety.inject import write_csv
    from safety.inject.workbook import write_xlsx

    csv, xlsx = (wishes.file(kind, result.campaign.id) for kind in ("csv", "xlsx"))
    try:
        if csv and result.rows:
            write_csv(result.rows, csv)
        if xlsx and result.rows:
            write_xlsx(result, xlsx)
    except OSError as error:
        told = f"failure modes cannot be written: {error.filename or csv or xlsx}: {error.strerror}"
        fail(entry, told, [told])


def _hold_against(entry: Entry, result: Result, wishes: Wishes) -> None:
    from safety.inject.baseline import Findings, compare

    found = Findings.of(result)
    if wishes.baseline:
        against(entry, compare(records(wishes.baseline)[entry["id"]], found), Path(wishes.baseline).name)
    if wishes.record:
        entry["record"] = found.record()


def records(file: str) -> dict[str, dict[str, Any]]:
    """The records of a baseline file.  Raises `CampaignError` for a file that is none, `CommandError` without one."""
    from safety.inject.baseline_file import loads

    try:
        return loads(Path(file).read_text(encoding="utf-8"), file)
    except OSError as error:
        raise CommandError(
            f"{file}: cannot be read: {error.strerror}; `rightside inject --write-baseline {file}` writes one"
        ) from None
    except UnicodeDecodeError as bad:
        raise CommandError(f"{file}: byte {bad.start}: no UTF-8 text; a baseline is JSON") from None


def _shrink(campaign: Campaign, entry: Entry, most: int, note: Note) -> None:
    """Minimal reproducers of the first dangerous undetected injections; those that a baseline has not come first."""
    from safety.inject.reproduce import Unconfirmed, read, reproducer

    new = (entry.get("baseline") or {}).get("new", {})
    listed = (line.partition("::")[2] for line in entry["replay"])
    chosen = list(dict.fromkeys([*new, *listed]))[:most]
    entry["reproducers"] = []
    for count, one in enumerate(chosen, start=1):
        note(f"shrinking {count} of {len(chosen)}")
        try:
            entry["reproducers"].append(reproducer(campaign, read(campaign, one)).to_json())
        except Unconfirmed as denied:
            entry.setdefault("disagreed_by", []).append(str(denied))

"""Failure rates from a table: what a parts list or an effects analysis says of each mode, entered in the groups.

    part,mode,rate_per_h,source
    ring register,stage stuck,6.4e-8,[A] SN 29500 at 40 C
    part,mode,fit,share,source
    relay,welded,120,15 %,[A] maker's data

Columns: `part` and `mode` as in the groups (`part` alone where it has one group); the rate of the mode as `rate_per_h`
or in `fit` (1e-9/h); with `share`, the rate is that of the part and the share that of the mode, and the shares of a
part sum to 1; `source` starts with its tag, [P], [D], [A] or [R].  Further columns are left alone.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

from safety.inject.fmeda import FORMULA
from safety.inject.space import CampaignError, Group
from safety.system import nearest

FIT = Fraction(1, 10**9)  # 1/h


@dataclass(frozen=True)
class _Line:
    """One line of the table: where it stands, which mode it is about, and its rate in 1/h."""

    place: str
    key: tuple[str, str]
    rate: Fraction
    share: Fraction | None
    source: str


def with_rates(groups: Sequence[Group], path: str | Path) -> list[Group]:
    """The groups with the failure rates and sources of a CSV table.

    Raises `CampaignError`, with file, line and value, for a column that is missing, a number that cannot be read or is
    not above 0, a source without tag, shares that do not sum to 1, and unless each line fits one group and each group
    one line.
    """
    lines = _read(Path(path))
    _check_shares(path, lines)
    named = {_key(group): group for group in groups}
    if len(named) < len(groups):
        twice = next(g for g in groups if named[_key(g)] is not g)
        raise CampaignError(f"group {twice.name!r} has the part and mode of another; give it a mode of its own")
    rates: dict[tuple[str, str], _Line] = {}
    for line in lines:
        key = line.key if line.key in named else _only_mode(line.key, groups)
        if key not in named:
            told = (": ".join(name) for name in named)
            raise CampaignError(
                f"{line.place}: no group has {': '.join(line.key)!r}; {nearest(': '.join(line.key), told)}"
            )
        if key in rates:
            raise CampaignError(f"{line.place}: {': '.join(key)!r} stands in {rates[key].place} already; leave one out")
        rates[key] = line
    for key, group in named.items():
        if key not in rates:
            raise CampaignError(f"{path}: no line for {': '.join(key)!r} (group {group.name!r}); add one")
    return [replace(g, rate_per_h=rates[_key(g)].rate, source=rates[_key(g)].source) for g in groups]


def _key(group: Group) -> tuple[str, str]:
    return group.part or group.name, group.mode or group.name


def _only_mode(key: tuple[str, str], groups: Sequence[Group]) -> tuple[str, str]:
    """For a line without mode, the mode of the part's only group."""
    part, mode = key
    keys = [_key(group) for group in groups if _key(group)[0] == part]
    return keys[0] if len(keys) == 1 and not mode else key


def _read(path: Path) -> list[_Line]:
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.DictReader(file)
            given = [name.strip().lower() for name in reader.fieldnames or ()]
            reader.fieldnames = given
            missing = [name for name in ("part", "source") if name not in given]
            if missing or ("rate_per_h" in given) == ("fit" in given):
                raise CampaignError(
                    f"{path}:1: the columns are {', '.join(given) or 'none'}; "
                    f"there have to be part, source and either rate_per_h or fit, and there may be mode and share"
                )
            lines = [_line(f"{path}:{reader.line_num}", row) for row in reader]
    except (OSError, UnicodeDecodeError, csv.Error) as wrong:
        raise CampaignError(f"{path}: cannot be read as CSV ({wrong}); give a text table in UTF-8") from None
    if not lines:
        raise CampaignError(f"{path}: there is no line after the heading; give one for each failure mode")
    return lines


def _line(place: str, row: dict[str | None, str | list[str] | None]) -> _Line:
    if None in row or None in row.values():
        raise CampaignError(
            f"{place}: the line has more or fewer fields than the heading; put texts with commas in quotes"
        )
    text = {str(name): _text(str(value)) for name, value in row.items()}
    unit, column = (FIT, "fit") if "fit" in text else (Fraction(1), "rate_per_h")
    rate = unit * _number(place, column, text[column])
    share = None
    if text.get("share"):
        percent = text["share"].endswith("%")
        share = _number(place, "share", text["share"].removesuffix("%").rstrip()) / (100 if percent else 1)
    if text["source"][:3] not in ("[P]", "[D]", "[A]", "[R]"):
        raise CampaignError(f"{place}: source {text['source']!r}; start it with [P], [D], [A] or [R]")
    return _Line(
        place, (text["part"], text.get("mode", "")), rate * (1 if share is None else share), share, text["source"]
    )


def _text(cell: str) -> str:
    """What a cell says, without the apostrophe that `write_csv` puts before what looks like a formula."""
    return (cell[1:] if cell.startswith("'") and cell[1:].startswith(FORMULA) else cell).strip()


def _number(place: str, column: str, text: str) -> Fraction:
    if not re.fullmatch(r"\d+(\.\d*)?([eE][+-]?\d{1,3})?", text) or not (value := Fraction(text)):
        raise CampaignError(
            f"{place}: {column} is {text!r}; write a number above 0 with a decimal point, such as 6.4e-8"
        )
    return value


def _check_shares(path: str | Path, lines: Sequence[_Line]) -> None:
    sums: dict[str, list[Fraction | None]] = {}
    for line in lines:
        sums.setdefault(line.key[0], []).append(line.share)
    for part, shares in sums.items():
        given = [share for share in shares if share is not None]
        if given and (len(given) < len(shares) or sum(given) != 1):
            raise CampaignError(
                f"{path}: the shares of part {part!r} sum to {float(sum(given)):g}"
                f"{', and one is missing' if len(given) < len(shares) else ''}; they have to sum to 1"
            )

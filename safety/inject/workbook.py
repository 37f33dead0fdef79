"""The failure-mode table as a workbook: the table with totals, what each figure is made of, and the parameters.

The same result gives the same bytes: nothing of the time of writing is in the file.
"""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from safety.inject.classes import CELLS
from safety.inject.counting import pieces
from safety.inject.figures import BEHIND, FIGURES
from safety.inject.fmeda import COLUMNS, Row, records, totals
from safety.inject.space import CampaignError

if TYPE_CHECKING:
    from safety.inject.result import Result

MOST_NAMED = 100  # injections named for each cell of a mode; all can be listed with `injections_behind`
EPOCH = (1980, 1, 1, 0, 0, 0)
LONGEST = 32_767  # characters in a cell of a workbook


def injections_behind(result: Result, row: Row, column: str) -> Iterator[str]:
    """The selectors of the injections that a figure of a mode is made of, `CAMPAIGN::injection` as `replay` takes them.

    Raises `CampaignError` for a column that is not made of injections.
    """
    if column not in BEHIND:
        raise CampaignError(f"column {column!r} is not made of injections; choose one of {', '.join(BEHIND)}")
    place = [group.name for group in result.campaign.space.groups].index(row.group.name)
    for number in _numbers(result, place, BEHIND[column]):
        yield _selector(result, number)


def _selector(result: Result, number: int) -> str:
    return f"{result.campaign.id}::{result.campaign.space.injection(number).id}"


def _numbers(result: Result, group: int, cells: Collection[str]) -> Iterator[int]:
    """The numbers of the injections of a group, by its place, that came to some cells."""
    import numpy as np

    space, judged = result.campaign.space, result.judged
    chosen = [place for place, cell in enumerate(CELLS) if cell in cells]
    for low, high in pieces(len(judged)):
        mine = space.keys(low, high) % space.group_keys == group
        yield from (low + np.flatnonzero(mine & np.isin(judged.cells[low:high], chosen))).tolist()


def write_xlsx(found: Result | Sequence[Row], path: str | Path) -> None:
    """Write the table; of a `Result` also which injections are behind each figure, and the campaign.

    Sheets: FMEDA, Totals, Traceability (only of a result), Parameters.  Raises `CampaignError` when openpyxl is not
    installed, or there are no rows (a campaign of pairs has none).
    """
    try:
        import openpyxl
    except ImportError:
        raise CampaignError(f"{path}: openpyxl is not installed; pip install rightside[xlsx]") from None
    rows = found if isinstance(found, Sequence) else found.rows
    if not rows:
        raise CampaignError(f"{path}: there is no failure mode to write; the table is of campaigns of single faults")
    book = openpyxl.Workbook()
    book.remove(book.active)
    _sheet(book, "FMEDA", COLUMNS, (record.values() for record in records(rows)))
    _sheet(book, "Totals", ("part", "rate_per_h", *_with_bounds(), "tags"), _totals(rows))
    if not isinstance(found, Sequence):
        _sheet(book, "Traceability", ("part", "mode", "cell", "injections", "columns", "replay"), _traces(found))
    _sheet(book, "Parameters", ("parameter", "value", "tag", "source"), _parameters(found, rows))
    written = io.BytesIO()
    book.save(written)
    Path(path).write_bytes(_timeless(written.getvalue()))


def _with_bounds() -> Iterator[str]:
    return (column for name in FIGURES for column in (name, f"{name}_low", f"{name}_high"))


def _totals(rows: Sequence[Row]) -> Iterator[list[Any]]:
    for total in totals(rows):
        figures = [total.figure(name) for name in FIGURES]
        numbers = [float(x) if f else None for f in figures for x in ((f.value, f.low, f.high) if f else (0, 0, 0))]
        yield [total.name, None if total.rate is None else float(total.rate), *numbers, total.tags]


def _traces(result: Result) -> Iterator[list[Any]]:
    """A line for each cell of each mode, with the first of its injections."""
    for place, row in enumerate(result.rows):
        for cell, number in row.tally.table.items():
            names = [_selector(result, n) for n in islice(_numbers(result, place, [cell]), MOST_NAMED)]
            more = [f"... {number - len(names)} more"] if number > len(names) else []
            columns = ", ".join(column for column, cells in BEHIND.items() if cell in cells)
            yield [row.part, row.mode, cell, number, columns, "\n".join([*names, *more])[:LONGEST]]


def _parameters(found: Result | Sequence[Row], rows: Sequence[Row]) -> Iterator[list[Any]]:
    if not isinstance(found, Sequence):
        campaign = found.campaign
        yield ["campaign", campaign.id, "", ""]
        yield ["faults", campaign.space.statement, "", ""]
        yield ["all injected", "no, interrupted" if found.interrupted else "yes" if found.exhaustive else "no", "", ""]
    yield [
        "confidence of bounds",
        min(row.confidence for row in rows),
        "",
        "each figure by itself; totals over all modes",
    ]
    for row in rows:
        yield [f"rate of {row.part}: {row.mode}, 1/h", row.to_json()["rate_per_h"], row.group.tag, row.group.source]


def _sheet(book: Any, title: str, heading: Sequence[str], lines: Iterable[Iterable[Any]]) -> None:
    from openpyxl.cell import WriteOnlyCell
    from openpyxl.cell.cell import ILLEGAL_CHARACTERS_RE
    from openpyxl.styles import Font

    sheet = book.create_sheet(title)
    for place, line in enumerate((heading, *lines)):
        cells = []
        for value in line:
            plain = ILLEGAL_CHARACTERS_RE.sub(_visible, value) if isinstance(value, str) else value
            cell = WriteOnlyCell(sheet, plain)
            if isinstance(value, str):
                cell.data_type = "s"  # a text that starts with "=" is a text
            cell.font = Font(bold=place == 0)
            cells.append(cell)
        sheet.append(cells)
    sheet.freeze_panes = "A2"
    sheet.auto_filter.ref = sheet.dimensions


def _visible(control: re.Match[str]) -> str:
    """A control character as it is written in Python: a workbook has none."""
    return f"\\x{ord(control[0]):02x}"


def _timeless(data: bytes) -> bytes:
    """The workbook without the time at which it was written."""
    result = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(result, "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "docProps/core.xml":
                content = re.sub(rb"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", b"1980-01-01T00:00:00Z", content)
            new.writestr(zipfile.ZipInfo(name, EPOCH), content, zipfile.ZIP_DEFLATED)
    return result.getvalue()

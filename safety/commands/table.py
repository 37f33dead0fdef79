"""Plain text tables, aligned, without borders: they can be cut, sorted and searched, a row a line."""

from __future__ import annotations

from collections.abc import Sequence

from safety.report.numbers import one_line


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Left-aligned columns, two spaces apart; an empty cell is a dash."""
    lines = [[*head], *([one_line(cell) or "-" for cell in row] for row in rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(head))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines
    )

"""Speed patterns: the fault table row by row, with what proofs and injections found for each mode.  Rates are FIT [A].

A mode is dangerous where it is by itself a cut set of an equipment.  Result: all rows are as the table has them but
one: a program clock that stops is dangerous where it times the acknowledgement, and one that is fast is not; the
directions printed there hold for the interval of a ground program.
"""

from __future__ import annotations

from collections.abc import Iterator

from models.patterns.failures import TABLE
from proofs.patterns_campaign import DETECTED
from proofs.patterns_hazards import PLAIN_ONES
from safety.exhibits import Column, Row, table


def dangerous_in(name: str) -> list[str]:
    """The ways of telling the stop that a mode defeats by itself."""
    return [way for way, one in PLAIN_ONES.items() if (name,) in one.cut_sets]


def detected_in(name: str) -> list[str]:
    """Those in which a detector finds it no later than the train passes."""
    found = {way: dict(cells(way)) for way in DETECTED}
    return [way for way, by in found.items() if by.get(name, "").endswith("/yes")]


def cells(way: str) -> Iterator[tuple[str, str]]:
    """Each mode, and what its injection came to in an equipment with detectors."""
    for injection, cell in DETECTED[way].inject().injections():
        yield injection.faults[0].name, cell


@table(
    id="patterns.fault-table", title="Fault table of speed supervision: direction and detection, found by model",
    source="[A] table; [D] cut sets and injections",
    columns=(Column("mode"), Column("direction"), Column("dangerous by itself in"), Column("as the table has it"),
             Column("to be detected by"), Column("detected in"), Column("rate", "FIT", assumed=True)),
    says_no=("program clock: stops: as the table has it",),
)  # fmt: skip
def fault_table() -> Iterator[Row]:
    """A mode a row."""
    for row in TABLE:
        bad = dangerous_in(row.name)
        agrees = bool(bad) == (row.direction == "D")
        shown = ", ".join(detected_in(row.name))
        yield row.name, row.direction, ", ".join(bad) or "none", agrees, row.detected_by, shown or "none", row.fit

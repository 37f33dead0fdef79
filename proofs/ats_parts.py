"""ATS-SP and radio control: which modes of the component table are wrong-side by themselves, and pairs that are.

What injection finds of each row, beside the direction of the table: a row is dangerous if any of its injections is, on
any ride.  What fault trees are made of.  Rates are those of `Mode.fit`: INVENTED [A], the table has none.
Main result: all rows are as the table has them but two.  A comparator that always says equal has no effect by itself,
and messages with stamps cannot be replayed.  With the map three rows are found in time.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from typing import NamedTuple

from models.ats import failures
from models.ats.failures import FIT, RADIO, Mode
from proofs.ats_campaign import MAPPED_ON_THE_STRETCH, ON_PARTS, ON_THE_STRETCH
from proofs.radio_campaign import parting, running
from safety.exhibits import Column, Row, table
from safety.inject import Campaign

PAIRS = (("comparator: stuck equal", "processor: single fault"),)  # of the processor that drives the output
MAPPED = (  # found in time where the map is consulted
    "signal balise: missing / detuned", "branch balise: missing", "on-board coil, oscillation unit: silent",
)  # fmt: skip
ALL = (*ON_THE_STRETCH, *ON_PARTS, running, parting)


class Finding(NamedTuple):
    """What injection finds of a row."""

    direction: str  # D if any injection is wrong-side, else S if any is on the safe side, else N
    by: str  # the first injection that shows it, and the campaign


@cache
def findings(campaigns: tuple[Campaign, ...]) -> dict[str, Finding]:
    """The rows that these campaigns inject, in the order in which they come."""
    found: dict[str, Finding] = {}
    for campaign in campaigns:
        for injection, cell in campaign.inject().injections():
            direction = {"wrong": "D", "safe": "S", "neutral": "N"}[cell.split("/")[0]]
            so_far = found.get(injection.group, Finding("", ""))
            if not so_far.direction or "NSD".index(direction) > "NSD".index(so_far.direction):
                shown = "none has an effect" if direction == "N" else f"{injection.faults[0].name} ({campaign.id})"
                found[injection.group] = Finding(direction, shown)
    return found


def wrong_side(campaigns: tuple[Campaign, ...]) -> list[str]:
    """The rows that some of these campaigns shows as wrong-side."""
    return [name for name, found in findings(campaigns).items() if found.direction == "D"]


def named() -> dict[str, Mode]:
    """The rows by name."""
    return {mode.name: mode for mode in failures.table()}


def singles(mapped: bool = False) -> list[str]:
    """Rows of ATS-SP that are wrong-side by themselves; with the map, without those that it finds."""
    own = [mode.name for mode in failures.table() if mode.wrong_side and mode.bench != RADIO]
    return [name for name in own if not (mapped and name in MAPPED)]


def of_radio() -> list[str]:
    """Rows of radio control that are wrong-side by themselves."""
    return [mode.name for mode in failures.table() if mode.wrong_side and mode.bench == RADIO]


def per_hour(name: str) -> Fraction:
    """Failures per hour of a row."""
    return named()[name].fit * FIT


COLUMNS = (
    Column("row"), Column("direction of the table"), Column("found"), Column("as the table has it"),
    Column("injections"), Column("by what injection"), Column("with the map"), Column("why"),
    Column("rate", "FIT", assumed=True),
)  # fmt: skip


def with_map(name: str) -> str:
    """What becomes of a dangerous row of the stretch with the set that acts on one balise that was not seen."""
    found = findings(MAPPED_ON_THE_STRETCH).get(name)
    return "" if found is None else {"N": "found in time"}.get(found.direction, found.direction)


@table(
    id="ats.component-table", title="Component table of ATS-SP and radio control: direction stated and found",
    source="[A] table, sizes of the faults; [D] injections", columns=COLUMNS,
    says_no=tuple(f"{mode.name}: as the table has it" for mode in failures.table() if mode.why),
    note="D dangerous, S restrictive, N neither; injections: onsets and sizes, each on rides of its bench",
)  # fmt: skip
def component_table() -> Iterator[Row]:
    """A row a row."""
    for mode in failures.table():
        name, (found, by) = mode.name, findings(ALL)[mode.name]
        agrees, of = found == mode.direction, len(mode.injected)
        yield name, mode.direction, found, agrees, of, by, with_map(name), mode.why, mode.fit

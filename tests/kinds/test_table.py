"""The table of kinds in the documents is the one of the code, and says of each kind what is so."""

from __future__ import annotations

import inspect
from pathlib import Path

import pytest

import safety
from safety.kinds import kinds, makers, table
from tests.kinds.by_hand import CASES

DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "fault_kinds.md"


def test_the_document_has_the_table() -> None:
    text = DOCUMENT.read_text(encoding="utf-8")
    written = text[text.index("| kind |") :]
    assert written == table(), "write it anew: the part from `| kind |` on is what safety.kinds.table() gives"


def test_every_kind_is_in_the_table_and_public() -> None:
    from safety import kinds as package

    made = {
        name
        for name in package.__all__
        if inspect.isfunction(f := getattr(package, name)) and inspect.signature(f).return_annotation == "Kind"
    }
    assert made == makers().keys() == {entry.name for entry in kinds()}
    assert made <= {*safety.__all__}


@pytest.mark.parametrize("entry", kinds(), ids=lambda entry: entry.name)
def test_an_entry_is_whole(entry: object) -> None:
    assert isinstance(entry, type(kinds()[0]))
    assert entry.definition.endswith(".") and len(entry.definition) < 120
    assert entry.place in ("point", "points", "part")
    takes_numbers = set(inspect.signature(makers()[entry.name]).parameters) - {"late"}
    assert bool(entry.unit) == bool(takes_numbers), "a kind with parameters says their unit"
    assert "IEC 61508" in entry.reference or "EN 50129" in entry.reference or not entry.reference


def test_choices_are_those_that_a_proof_leaves_open() -> None:
    """A kind whose rule allows more than one course of values has a choice in the table, and no other kind has."""
    open_ = {entry.name for entry in kinds() if entry.choices}
    assert open_ == {"byzantine", "frozen", "noise", "bridge", "power_dip"}
    for case in CASES:
        drawn = {name for name in open_ if case.kind.name.startswith(name.replace("_", " "))}
        one = [v for v in case.values if len(case.shown) == 1 and case.rule(0, [True], [case.values[0]] * 2, [v])]
        assert drawn or len(one) <= 1, case

"""ATS-SP: the cut sets of a forgotten stop are complete, and are the rows that injection finds wrong-side."""

from __future__ import annotations

from proofs import ats_parts
from proofs.ats_hazards import DRIFT, FAULTS, PHASE, SINGLES
from safety.prove.hazards import CONFIRMED, cut_sets, hazards

SILENT = "on-board coil, oscillation unit: silent"


def test_cut_sets_are_complete_confirmed_and_single() -> None:
    found = cut_sets(next(h for h in hazards() if h.id.startswith("ats_hazards.")))
    assert found.all_orders
    assert found.agreed_by == ["z3", "cvc5"]
    assert found.by_order() == found.by_order(CONFIRMED) == {1: 6}
    assert {one.faults[0] for one in found.sets} == set(SINGLES)


def test_singles_are_the_wrong_side_rows_of_the_chain() -> None:
    """The branch balise is of another hazard."""
    chain = {fault.name for fault in FAULTS}
    of_the_turnout = {"branch balise: missing"}
    assert {DRIFT, PHASE, SILENT} <= chain
    assert set(SINGLES) == (set(ats_parts.singles()) & chain) - of_the_turnout

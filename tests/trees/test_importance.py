"""Importance against the figures of Storm's own tests (shared/oracles/markov), which the oracle file recomputes."""

import csv
import math

import pytest

from safety.trees import BasicEvent, FaultTree, Gate, solve
from tests.oracles import SHARED

FILE = SHARED / "markov" / "oracles.csv"
ROWS = 25
if not FILE.is_file():
    pytest.skip(f"{FILE} is absent: {ROWS} oracle rows not checked; set RIGHTSIDE_ORACLES", allow_module_level=True)

with FILE.open(newline="") as file:
    EXPECTED = [row for row in csv.DictReader(file) if row["id"].startswith("imp_") and "MTTF" not in row["id"]]

MEASURES = {
    "Birnbaum": "birnbaum",
    "CIF": "criticality",
    "DIF": "diagnostic",
    "RAW": "risk_achievement_worth",
    "RRW": "risk_reduction_worth",
}
RATES = {"x1": math.log(2), "x2": math.log(2), "x3": 0.2, "x4": math.log(2), "x5": 0.6, "x6": 1.0, "x7": math.log(2)}
STATIC = FaultTree(
    "static",
    "top",
    (
        Gate("top", "and", ("x1", "two", "three")),
        Gate("two", "or", ("x2", "x3")),
        Gate("three", "or", ("x4", "x5", "x6")),
    ),
    tuple(BasicEvent(name, rate_per_hour=rate, mission_time_h=1) for name, rate in RATES.items()),
)
VOTE = FaultTree(
    "2 of 4",
    "top",
    (Gate("top", "vote", ("x1", "x2", "x3", "x4"), 2),),
    tuple(BasicEvent(f"x{i}", "1/2") for i in range(1, 5)),
)


def test_all_rows_are_here():
    assert len(EXPECTED) == ROWS


@pytest.mark.parametrize("row", EXPECTED, ids=[row["id"] for row in EXPECTED])
def test_as_in_storm(row):
    solution = solve(VOTE if row["id"].startswith("imp_2of4") else STATIC)
    _, _, *quantity = row["id"].split("_")
    if quantity == ["Q"]:
        found = solution.probability
    else:
        measure, event = quantity if len(quantity) == 2 else (*quantity, "x1")
        found = getattr(solution.importance()[event], MEASURES[measure])
    assert found == pytest.approx(float(row["expected"]), rel=1e-12)


def test_an_event_the_top_does_not_reach_has_no_importance():
    measures = solve(STATIC).importance()["x7"]
    assert (measures.birnbaum, measures.risk_achievement_worth, measures.risk_reduction_worth) == (0, 1, 1)

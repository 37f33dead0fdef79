"""Intervention curves of the ERA braking tool as error bounds (shared/oracles/braking).

Read in place from $RIGHTSIDE_ORACLES, else from ../shared/oracles beside the project.  The curve of a row is the
greatest distance that a train at a speed up to the row's runs, with any build-up time up to T_be and any deceleration
from the guaranteed one up.  The distances are summed exactly in all rows; bounds are proved in one row of EVERY.
"""

from __future__ import annotations

import csv
import json
from fractions import Fraction as F
from itertools import pairwise

import pytest

from safety.prove.bounds import Bound, between, bracket, check, reals
from safety.prove.claims import PROVED, REFUTED
from tests.oracles import SHARED

FOLDER = SHARED / "braking"
SCENARIOS = ("era_gamma_frg", "era_lambda_pasp_100_tco_sb", "era_lambda_pasp_200")
ROWS, EVERY = 3 * 1901, 250
NEAR = F(1, 10**6)  # metres: the tool prints doubles

if not FOLDER.is_dir():
    pytest.skip(f"{FOLDER} is absent: {ROWS} oracle rows not checked; set RIGHTSIDE_ORACLES", allow_module_level=True)


def rows(scenario: str) -> list[dict[str, F | None]]:
    with (FOLDER / f"{scenario}.csv").open(newline="") as file:
        return [{name: F(x) if x else None for name, x in row.items()} for row in csv.DictReader(file)]


def build_up(scenario: str) -> F:
    inputs = json.loads((FOLDER / f"{scenario}_inputs.json").read_text("utf-8"), parse_float=F)
    return F((inputs.get("derived_by_the_tool") or inputs["gamma"])["T_be_s"])


def run_out(before: dict[str, F | None], row: dict[str, F | None], time: F) -> Bound:
    """Distance run before the stop, from any speed of a row's tenth of a km/h."""
    v, t, b = reals("v t b")
    slow, fast, least, left = before["v_kmh"] / F("3.6"), row["v_kmh"] / F("3.6"), before["A_safe_ms2"], before["EBD_m"]
    return Bound(
        "braking.intervention",
        "Distance run before the stop",
        2 * b * (v * t + left) + v * v - slow * slow,
        (between(slow, v, fast), between(0, t, time), between(least, b, 2 * least)),
        per=2 * b,
        unit="m",
    )


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_the_distances_add_up_in_every_row(scenario: str) -> None:
    table = rows(scenario)
    assert len(table) * len(SCENARIOS) == ROWS
    for before, row in pairwise(table):
        gained = (row["v_kmh"] ** 2 - before["v_kmh"] ** 2) / F("12.96") / (2 * before["A_safe_ms2"])
        assert abs(row["EBD_m"] - before["EBD_m"] - gained) <= NEAR


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_the_intervention_curve_is_what_it_takes_to_stop(scenario: str) -> None:
    table, time = rows(scenario), build_up(scenario)
    # The vertical parts of the curve, above the line speed and at the release speed, say nothing of stopping.
    curved = [
        k for k in range(1, 1601) if table[k]["EBI_m"] not in (None, table[k - 1]["EBI_m"], table[k + 1]["EBI_m"])
    ]
    tried = curved[EVERY // 2 :: EVERY]
    assert len(tried) >= 4
    for k in tried:
        bound, printed = run_out(table[k - 1], table[k], time), table[k]["EBI_m"]
        proved = check(bound, printed + NEAR)
        assert (proved.verdict, len(proved.agreed_by)) == (PROVED, 2)
        assert check(bound, printed - F(1, 100)).verdict == REFUTED
        assert check(run_out(table[k - 1], table[k], time + F(1, 10)), printed + NEAR).verdict == REFUTED


def test_the_bracket_of_a_row_holds_the_printed_distance() -> None:
    table, time = rows(SCENARIOS[0]), build_up(SCENARIOS[0])
    found = bracket(run_out(table[999], table[1000], time))
    assert found.verdict == PROVED and found.low - NEAR <= table[1000]["EBI_m"] <= found.high

"""Braking curves against the tables of the braking-curve tool, read in place; bad input is refused."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from models.kinematics.era_curves import curves
from safety import ModelError
from tests.oracles import SHARED

FOLDER = SHARED / "braking"
SCENARIOS = sorted(FOLDER.glob("era_*_inputs.json"))
if not SCENARIOS:
    pytest.skip(
        f"{FOLDER} is absent: 3 scenarios of braking curves not checked; set RIGHTSIDE_ORACLES", allow_module_level=True
    )
COLUMNS = {"ebd": "EBD", "sbd": "SBD", "ebi": "EBI", "sbi1": "SBI1", "sbi2": "SBI2", "floi": "FLOI",
           "warning": "Warning", "permitted": "Permitted", "indication": "Indication"}  # fmt: skip


def loaded(path: Path) -> Any:
    return json.loads(path.read_text())


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda p: p.stem)
def test_all_curves_within_a_micrometre(path: Path) -> None:
    inputs = loaded(path)
    quirk = inputs["quirks"]["service_deceleration_above_180_kmh_uses_emergency_percentage"]
    found = curves(inputs, quirk)
    with path.with_name(path.name.replace("_inputs.json", ".csv")).open() as table:
        rows = list(csv.DictReader(table))
    for name, column in COLUMNS.items():
        curve = getattr(found, name)
        assert len(curve) == len(rows)
        for row, ours in zip(rows, curve, strict=True):
            theirs = row[f"{column}_m"]
            assert (ours is None) == (theirs == ""), (name, row["v_kmh"], ours, theirs)
            assert ours is None or abs(ours - float(theirs)) < 1e-6, (name, row["v_kmh"])


def test_the_quirk_is_seen_where_the_tool_has_it() -> None:
    inputs = loaded(FOLDER / "era_lambda_pasp_200_inputs.json")
    right, wrong = curves(inputs).sbd[-1], curves(inputs, quirk=True).sbd[-1]
    assert right is not None and wrong is not None and 50 < right - wrong < 70


@pytest.mark.parametrize(
    ("part", "key", "value", "said"),
    [("track", "target_speed_kmh", 40, "nearest admissible value is 0"), ("train", "type", "Delta", "Lambda or Gamma"),
     ("train", "brake_position", "Express", "Passenger in P"), ("track", "line_speed_kmh", 0, "line speed"),
     ("lambda", "brake_percentage", -5, "brake percentage"), ("track", "line_speed_kmh", None, "line speed|scenario"),
     ("track", "gradient_profile_m_permille", [[0, -300]], "deceleration at")],
)  # fmt: skip
def test_bad_input_is_refused(part: str, key: str, value: Any, said: str) -> None:
    inputs = loaded(FOLDER / "era_lambda_pasp_200_inputs.json")
    inputs[part][key] = value
    with pytest.raises(ModelError, match=said):
        curves(inputs)


def test_a_missing_input_is_named() -> None:
    inputs = loaded(FOLDER / "era_gamma_frg_inputs.json")
    del inputs["national"]
    with pytest.raises(ModelError, match="national"):
        curves(inputs)

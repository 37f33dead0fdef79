"""Every model of the two-counter ATC runs the same on three readings, and takes its settings from anywhere."""

from __future__ import annotations

import os
import random
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.two_counter import circuit, equipment, measuring, samples, selection, train, variants
from models.two_counter.failures import component_faults, component_modes
from safety.faults import instrument
from safety.model import Model
from safety.system import ModelError
from safety.terms.graph import Sort
from safety.terms.texts import compile_lanes, lane_type
from safety.trace import Stepper, run
from safety.tracing import direct_step, trace
from tests.models.two_counter.runs import STEP_S, lines

ROOT = Path(__file__).resolve().parents[3]
MODULES = (selection, train, circuit, equipment, samples, variants, measuring)
MODELS = [
    m
    for module in MODULES
    for m in vars(module).values()
    if isinstance(m, type) and issubclass(m, Model) and hasattr(m, "step") and m.__module__ == module.__name__
]


def some(rng: random.Random, sort: Sort) -> Any:
    if sort.kind == "bit":
        return rng.random() < 0.5
    low, high = sort.bounds
    return rng.choice((low, high, rng.randint(low, high), rng.randint(low, high)))


@pytest.mark.parametrize("model", MODELS, ids=lambda m: m.__name__)
def test_three_readings_agree_from_any_state(model: type[Model]) -> None:
    made, rng, runs = trace(model), random.Random(1967), 12
    stepper = Stepper.of(made)
    given = [{t.attr: some(rng, t.sort) for t in stepper_leaves(made)} for _ in range(runs)]
    rows = [stepper.function(*values.values()) for values in given]
    for values, row in zip(given, rows, strict=True):
        state = {path: values[path] for path in made.state}
        following, seen = direct_step(model, state, {name: values[name] for name in made.inputs})
        assert dict(zip(state, row, strict=False)) == following
        watched = dict(zip(stepper.observed, row[len(state) :], strict=False))
        assert {path: seen[path] for path in watched if path in seen} == watched
    leaves, nexts = stepper_leaves(made), [s.next for s in made.states]
    columns = [np.array([values[t.attr] for values in given], dtype=lane_type(t)) for t in leaves]
    for k, column in enumerate(compile_lanes(leaves, nexts)(*columns)):
        assert column.tolist() == [row[k] for row in rows]


def stepper_leaves(made: Any) -> list[Any]:
    """Registers and inputs, as variables, in the order in which a step takes them."""
    return [*(s.var for s in made.states), *made.inputs.values()]


def test_there_are_all_models_with_the_period_of_the_oscillator() -> None:
    assert len(MODELS) == 37
    assert {trace(m).clock.period for m in MODELS} == {STEP_S}
    assert all(m.__doc__ for m in MODELS)


def test_every_parameter_has_unit_range_and_source() -> None:
    for model, number in ((equipment.Equipment, 12), (measuring.Ride, 15), (variants.Watched, 13)):
        settings = trace(model).settings
        assert len(settings) == number
        assert all(s.unit and s.low <= s.value <= s.high and len(s.source) > 8 for s in settings.values())


@pytest.mark.parametrize(
    ("setting", "says"),
    [
        ({"n1f": 2048}, "lies outside 1885..2047 pulse; the nearest admissible value is 2047"),
        ({"n1f": 1884}, "the nearest admissible value is 1885"),
        ({"m250": 15}, "the nearest admissible value is 16"),
        ({"error": 30_000}, "lies outside -20000..20000 ppm"),
        ({"wheel": 939}, "the nearest admissible value is 930"),
        ({"acceleration": 301}, "lies outside 0..300 0.01 km/h/s"),
        ({"lost_one_in": -1}, "the nearest admissible value is 0"),
        ({"error": 1.5}, "write an exact number"),
        ({"m240": 1000}, "did you mean"),
    ],
)
def test_settings_out_of_range_are_refused_with_the_reason(setting: dict[str, Any], says: str) -> None:
    with pytest.raises(ModelError) as refused:
        trace(measuring.Ride, setting)
    assert says in str(refused.value)


def test_misuse_is_told() -> None:
    start = {"train.phase": 1_000_000}
    with pytest.raises(ModelError, match="phase within one edge"):
        run(equipment.Equipment, {"speed": 0, **lines(250)}, 1, start=start)
    with pytest.raises(ModelError, match="800001 is not a value of it"):
        run(equipment.Equipment, {"speed": 800_001, **lines(250)}, 1)


RUN = ["run", "two_counter.measuring.Ride", "lines.*=0", "lines.s250=1", "--steps", "6000", "--show", "brake,signal1"]
SETTINGS = {
    "start": 25_875,
    "acceleration": 0,
    "m250": 1037,
    "n1f": 2040,
    "error": 700,
    "wheel": 912,
    "lost_one_in": 300,
}


def command(project: Path, *words: str) -> str:
    code = "import sys; from safety.commands import main; sys.exit(main(sys.argv[1:]))"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    called = subprocess.run(
        [sys.executable, "-c", code, *words], cwd=project, env=environment, capture_output=True, text=True
    )
    assert called.returncode == 0, called.stderr
    return called.stdout


def test_settings_come_from_the_command_line_and_from_toml_alike(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "models", tmp_path / "models")
    (tmp_path / "proofs").mkdir()
    (tmp_path / "pyproject.toml").write_text("[tool.rightside]\n")
    plain = command(tmp_path, *RUN)
    line = command(tmp_path, *RUN, *(f"--set={name}={value}" for name, value in SETTINGS.items()))
    table = ", ".join(f"{name} = {value}" for name, value in SETTINGS.items())
    (tmp_path / "pyproject.toml").write_text(f"[tool.rightside]\nsettings = {{{table}}}\n")
    assert command(tmp_path, *RUN) == line != plain


def test_every_named_failure_has_a_place_in_the_equipment_and_its_variants() -> None:
    modes, faults = component_modes(), component_faults()
    assert (len(modes), len(faults), len({f.name for f in faults})) == (14, 125, 125)
    for model in (equipment.Equipment, variants.NoDefault):
        made = trace(model)
        for fault in faults:
            assert instrument(made, [fault]).system.states

"""The variants of TS-7 run the same on the direct and on the Python reading, and what makes them different shows."""

from __future__ import annotations

import pytest

from models.ts7.full_scale import FullScaleBench
from models.ts7.half_window import HalfBench, HalfCheckedRing, HalfTs7, HalfWindow
from models.ts7.train import PER_WORD, Bench
from models.ts7.wheel_bench import WheelBench
from models.ts7.windings import Windings, WoundBench, WoundTs7
from safety.model import Model
from safety.system import ModelError
from safety.trace import run
from safety.tracing import trace
from tests.models.ts7.test_readings import direct_and_python_agree

MODELS = (HalfWindow, HalfBench, HalfTs7, HalfCheckedRing, WheelBench, FullScaleBench, Windings, WoundBench, WoundTs7)


@pytest.mark.parametrize("model", MODELS, ids=lambda m: m.__name__)
def test_direct_and_python_agree_from_any_state(model: type[Model]) -> None:
    direct_and_python_agree(model)


@pytest.mark.parametrize("model", MODELS, ids=lambda m: m.__name__)
def test_every_parameter_has_unit_range_and_source(model: type[Model]) -> None:
    assert all(s.unit and s.low <= s.value <= s.high and len(s.source) > 8 for s in trace(model).settings.values())


@pytest.mark.parametrize("wheel", [156, 164, 172])
def test_a_set_wheel_is_the_wheel_given_on_the_bench(wheel: int) -> None:
    """`WheelBench` with a right setting does what `Bench` does."""
    row = {"word": 138, "speed": 150 * PER_WORD, "lowered": False, "backward": False}
    bench = run(Bench, {**row, "wheel": wheel, "true_wheel": wheel}, 3000)
    seen = run(trace(WheelBench, {"wheel": wheel}), row, 3000)
    assert all(seen[path] == bench[path] for path in ("a.f_v", "brake", "rev", "fault", "drive", "axle.phase"))


@pytest.mark.parametrize(("place", "word"), list(enumerate(range(231, 256, 3))))
def test_full_scale_words(place: int, word: int) -> None:
    row = {"word": 138, "speed": 0, "lowered": False, "backward": False}
    assert run(trace(FullScaleBench, {"place": place}), row, 1, keep=["wheel_word"])["wheel_word"] == [word]


@pytest.mark.parametrize(
    ("model", "settings", "says"),
    [
        (FullScaleBench, {"place": 9}, "nearest admissible value is 8"),
        (WheelBench, {"wheel": 180}, "nearest admissible value is 172"),
        (WheelBench, {"wheel_error": 5}, "lies outside -4..4 5 mm"),
        (HalfBench, {"a.check_word": 256}, "lies outside 0..255 word"),
    ],
)
def test_misuse_is_told(model: type[Model], settings: dict[str, int], says: str) -> None:
    with pytest.raises(ModelError, match=says.replace(".", r"\.")):
        trace(model, settings)

"""The parameters of the two-counter ATC as a user sets them: times, decisions, refusals."""

from __future__ import annotations

import json
from fractions import Fraction
from math import floor
from pathlib import Path
from typing import Any

import pytest

from models.two_counter import step_s
from models.two_counter.equipment import Equipment
from models.two_counter.measuring import Ride
from models.two_counter.train import Train
from proofs import two_counter_circuit  # noqa: F401  declares the claims
from safety.commands import main
from safety.prove.claims import registered
from safety.prove.prove import prove
from safety.prove.record import claim_entry
from safety.trace import run
from safety.tracing import trace
from tests.models.two_counter.runs import TC, lines, threshold
from tests.test_trace import read

ROOT = Path(__file__).resolve().parents[3]
MILLION = 10**6


# --- time ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("n1f", "error"), [(2000, 0), (2047, 0), (1885, -20_000), (2047, 12_345)])
@pytest.mark.parametrize("model", [Equipment, Ride])
def test_a_waveform_shows_the_counting_time_whatever_the_oscillator_is(model: Any, n1f: int, error: int) -> None:
    settings = {"n1f": n1f, "error": error}
    speed = {"speed": 400_000} if model is Equipment else {}
    if model is Ride:
        settings |= {"start": 20_000, "acceleration": 0}
    seen = run(model, {**lines(110), **speed}, 4500, settings=settings, keep=["gate"])
    step = Fraction(TC, n1f) / (1 + Fraction(error, MILLION))
    assert seen.system.clock.period == step == step_s(n1f, error) and seen.to_json()["tick_s"] == str(step)
    dump = read(seen.vcd())
    values = [value == "1" for value in dump.columns["gate"]]
    rises = [dump.unit * at for at, old, new in zip(dump.times[1:], values, values[1:], strict=False) if new > old]
    falls = [dump.unit * at for at, old, new in zip(dump.times[1:], values, values[1:], strict=False) if new < old]
    counted = falls[-1] - max(at for at in rises if at < falls[-1])
    true = TC * threshold(110) / 400_000  # as long as 477 edges take at 200 km/h, by the clock on the wall
    assert abs(counted - true) < 2 * step


def test_results_show_the_period_of_the_oscillator_as_it_is_set() -> None:
    claim = next(each for each in registered() if each.id == "two_counter_circuit.no_line_sets_the_highest_preset")
    entry = claim_entry(prove(claim, settings={"n1f": 2047, "error": -20_000}))
    period = str(step_s(2047, -20_000))
    assert (entry["verdict"], entry["clock"]) == ("refuted", {"tick_s": period})
    assert entry["counterexample"]["tick_s"] == period == str(TC / 2047 / Fraction(98, 100))


# --- the range in which edges are spaced -----------------------------------------------------------------------------


def loss(nominal: Fraction, error: int) -> Fraction:
    """Share by which the spacing of edges is too small, both roundings included."""
    return 1 - floor(nominal) * (MILLION + error) // MILLION / (nominal * (MILLION + error) / MILLION)


def test_the_spacing_of_edges_is_rounded_down_by_less_than_its_docstring_says() -> None:
    """Over the whole range: what cannot come up to the worst of the pairs of n1F and wheel looked at is left out."""
    nominal = {(n1f, wheel): Fraction(500 * n1f * wheel, 910) for n1f in range(1885, 2048) for wheel in range(840, 931)}
    most = {at: 1 - floor(x) / x + 1 / (x * Fraction(98, 100)) for at, x in nominal.items()}
    worst = (Fraction(0), (0, 0), 0)
    for at in sorted(most, key=lambda at: -most[at]):
        if most[at] <= worst[0]:
            break
        worst = max(worst, *((loss(nominal[at], error), at, error) for error in range(-20_000, 20_001)))
    share, (n1f, wheel), error = worst
    assert (n1f, wheel, error) == (1888, 841, -19_823) and Fraction("2.288e-6") < share < Fraction("2.3e-6")
    assert "by less than 2.3 ppm" in str(Train.spacing.__doc__)
    (within,) = trace(Equipment, {"n1f": n1f, "error": error, "wheel": wheel}).assumptions.values()
    assert 1 - within.args[1].attr / (nominal[n1f, wheel] * (MILLION + error) / MILLION) == share


# --- the command line ------------------------------------------------------------------------------------------------

SHOWN = ["--show", "brake", "--json", "-"]
RIDE = ["run", "--project", str(ROOT), *SHOWN, "two_counter.measuring.Ride", "lines.*=0", "lines.s110=1"]


def braked(capfd: pytest.CaptureFixture[str], *settings: str) -> bool:
    """Whether a ride ends with the brake applied."""
    capfd.readouterr()
    assert main([*RIDE, "--steps", "6600", *(word for each in settings for word in ("--set", each))]) == 0
    shown = json.loads(capfd.readouterr().out)
    (brake,) = (each for each in shown["signals"] if each["path"] == "brake")
    return bool(brake["changes"][-1][1])


@pytest.mark.parametrize(
    ("start", "setting", "before", "after"),
    [  # at 110 km/h, whose f2E is 119.25 on the frequency scale
        (11900, "m110=470", False, True),
        (11950, "m110=480", True, False),
        (11950, "n1f=2047", True, True),  # oscillator and count go together
        (11950, "error=1e4", True, False),
        (11900, "error=-1e4", False, True),
        (11900, "wheel=900.0", False, True),
        (11900, "start=11950", False, True),
        (11900, "acceleration=100", False, True),
        (11950, "lost_one_in=20", True, False),
    ],
)
def test_each_parameter_is_set_and_acts(
    capfd: pytest.CaptureFixture[str], start: int, setting: str, before: bool, after: bool
) -> None:
    at = [f"start={start}", "acceleration=0"]
    assert braked(capfd, *at) is before
    assert braked(capfd, *at, setting) is after


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("m250=15", "selection.m250 = 15 edge lies outside 16..2047 edge; the nearest admissible value is 16 ([D]"),
        ("n1f=2048", "n1f = 2048 pulse lies outside 1885..2047 pulse; the nearest admissible value is 2047 ([A]"),
        ("n1f=2000.5", "n1f = 4001/2 pulse is no whole number; write one in 1885..2047 pulse, e.g. 2000"),
        ("error=20001", "oscillator.error = 20001 ppm lies outside -20000..20000 ppm"),
        ("wheel=1e3", "train.wheel = 1000 mm lies outside 840..930 mm; the nearest admissible value is 930"),
        ("acceleration=301", "acceleration = 301 0.01 km/h/s lies outside 0..300"),
        ("lost_one_in=2001", "lost_one_in = 2001 pulse lies outside 0..2000 pulse"),
        ("wheel=nan", "'nan' is no value"),
        ("nif=2047", "did you mean n1f"),
    ],
)
def test_each_parameter_is_refused_out_of_its_range(capfd: pytest.CaptureFixture[str], setting: str, said: str) -> None:
    try:
        code = main([*RIDE, "--steps", "10", "--set", setting])
    except SystemExit as ended:
        code = int(str(ended.code))
    shown = capfd.readouterr()
    assert code == 2 and shown.out == ""
    assert said in shown.err

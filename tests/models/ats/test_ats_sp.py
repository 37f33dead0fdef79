"""The on-board set of ATS-SP: from a balise to the brake lines."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from models.ats.ats_sp import AnySignalCounts, AtsSp, KeepsAPlace, UnknownProceeds
from models.ats.stretch import PULSES_A_METRE
from models.position.correction import BRANCH, REFERENCE, RELEASE, SIGNAL
from proofs import ats_sp
from safety import ModelError, run
from safety.tracing import trace
from tests.models.ts7.test_readings import direct_and_python_agree
from tests.proofs.verdicts import OWN_LEMMAS, check, claims_of, of

OFF: dict[str, Any] = {name: 0 if term.sort.is_number else False for name, term in trace(AtsSp).inputs.items()} | {
    "inputs.supply": True,
    "inputs.cycle": True,
}
SETTINGS = {
    "locator.correction.data.place_a": 1000, "locator.correction.data.place_b": 1003,
    "locator.correction.data.kind_b": RELEASE, "target_b": 1600,
}  # fmt: skip
FIX = {"code.given": True, "code.low": 1000, "code.place": 1000, "code.high": 1000}


def seen(kind: int, stop: bool, proceed: bool) -> dict[str, Any]:
    """A balise of a kind and its shift."""
    return {"shift.seen": True, "shift.kind": kind, "shift.stop": stop, "shift.proceed": proceed}


def drive(*rows: dict[str, Any], model: Any = AtsSp) -> Any:
    """A run from 1000 m, where a code has told the position, after a reset."""
    return run(model, [OFF | row for row in (FIX | {"inputs.reset": True}, *rows)], settings=SETTINGS)


def test_direct_and_python_agree() -> None:
    direct_and_python_agree(AtsSp)


def test_a_stop_balise_makes_the_pattern_and_a_release_ends_it() -> None:
    told = drive(seen(SIGNAL, True, False), {}, seen(RELEASE, False, True), {})
    assert told["sp.home.target.pattern"] == [False, True, True, False, False]
    assert told["display"] == told["sp.home.target.pattern"]
    assert all(told["service_line"]) and all(told["emergency_line"])


@pytest.mark.parametrize(("stop", "proceed"), [(True, False), (False, False), (True, True)])
def test_what_is_not_understood_is_stop(stop: bool, proceed: bool) -> None:
    assert drive(seen(SIGNAL, stop, proceed))["sp.home.target.pattern"][-1]
    assert drive(seen(SIGNAL, stop, proceed), model=UnknownProceeds)["sp.home.target.pattern"][-1] == (stop > proceed)
    kept = drive(seen(SIGNAL, True, False), seen(RELEASE, stop, proceed))
    assert kept["sp.home.target.pattern"][-1]


def test_without_a_position_a_stop_balise_makes_the_worst_pattern() -> None:
    told = run(AtsSp, [OFF | {"inputs.reset": True}, OFF | seen(SIGNAL, True, False)], settings=SETTINGS)
    assert told["sp.blind.target.pattern"] == [False, True] and not any(told["sp.home.target.pattern"])


@pytest.mark.parametrize(("kind", "blind"), [(SIGNAL, True), (RELEASE, True), (BRANCH, True), (REFERENCE, False)])
def test_what_cannot_be_assigned_makes_the_worst_pattern(kind: int, blind: bool) -> None:
    told = run(AtsSp, [OFF | {"inputs.reset": True}, OFF | seen(kind, True, False)], settings=SETTINGS)
    assert told["sp.blind.target.pattern"] == [False, blind]
    assert not any(told["sp.home.target.pattern"]) and not any(told["sp.turnout.target.pattern"])


@pytest.mark.parametrize("model", [AtsSp, KeepsAPlace])
def test_a_code_does_not_lift_the_worst_pattern(model: Any) -> None:
    """After 300 m without a position a stop balise, then a code that tells 10 m: the brake comes, and stays."""
    code = {"code.given": True, "code.low": 9, "code.place": 10, "code.high": 11}
    more = {0: {"inputs.reset": True}, 300: seen(SIGNAL, True, False), 310: code}
    rows = [OFF | {"axle.pulses": min(k, 150) * PULSES_A_METRE / 10} | more.get(k, {}) for k in range(420)]
    told = run(model, rows, settings=SETTINGS, keep=("sp.service", "sp.blind.target.pattern"))
    assert all(told["sp.blind.target.pattern"][300:])
    assert any(told["sp.service"][311:]) == (model is AtsSp)


@pytest.mark.parametrize(("since", "low"), [(0, "999.9"), (1, "1000.89")])
def test_a_balise_puts_the_train_where_its_time_stamp_says(since: int, low: str) -> None:
    """Matched at 15 m/s: e on both sides, and 1 % of the way since; not the way of a whole cycle."""
    code = FIX | {f"code.{name}": 820 for name in ("low", "place", "high")} | {"inputs.reset": True}
    rows = [OFF | {"axle.pulses": min(k, 150) * PULSES_A_METRE / 10} for k in range(200)]
    rows[0], rows[195] = rows[0] | code, rows[195] | seen(SIGNAL, True, False) | {"axle.since": since}
    shown = tuple(f"locator.{name}" for name in ("matched.adopted", "position.low", "position.high"))
    told = run(AtsSp, rows[:196], settings=SETTINGS, keep=shown)
    high = 1000 + since * Fraction("1.01") + Fraction("0.1")
    assert [told[name][-1] for name in shown] == [True, Fraction(low), high]


@pytest.mark.parametrize("model", [AtsSp, AnySignalCounts])
def test_a_balise_of_another_signal_does_not_end_the_pattern(model: Any) -> None:
    """Balise a at stop, then b at 1003 m, which shows proceed for the next signal."""
    rows = [OFF | row for row in (FIX | {"inputs.reset": True}, seen(SIGNAL, True, False), seen(RELEASE, False, True))]
    told = run(model, rows, settings=SETTINGS | {"target_b": 2600})
    assert told["sp.home.target.pattern"] == [False, True, model is AtsSp]


def test_another_signal_at_stop_makes_the_worst_pattern() -> None:
    rows = [OFF | row for row in (FIX | {"inputs.reset": True}, seen(RELEASE, True, False))]
    told = run(AtsSp, rows, settings=SETTINGS | {"target_b": 2600})
    assert told["sp.home.target.pattern"][-1] is False and told["sp.blind.target.pattern"][-1] is True


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"sp.signal_at": 600, "receiver.begins": 0, "receiver.ends": 600}, "nearest admissible signal_at is 1600 m"),
        ({"sp.signal_at": 2700}, "nearest admissible signal_at is 3600 m"),
        ({"target_a": 1100}, "nearest admissible target_a is 1180 m"),
        ({"target_b": 1003}, "nearest admissible target_b is 1183 m"),
        ({"locator.correction.data.kind_b": BRANCH}, "nearest admissible target_b is 1700 m"),
        ({"receiver.ends": 1700}, "nearest admissible receiver.ends is 1600 m"),
    ],
)
def test_line_data_that_do_not_fit_are_refused(settings: dict[str, Any], says: str) -> None:
    with pytest.raises(ModelError, match=says):
        run(AtsSp, [OFF], settings=SETTINGS | settings)


def test_the_default_line_data_fit() -> None:
    run(AtsSp, [OFF])


@pytest.mark.parametrize("lost", ["inputs.supply", "inputs.cycle"])
def test_a_lost_line_brakes_at_once(lost: str) -> None:
    told = drive({}, {lost: False}, {})
    assert told["service_line"] == told["emergency_line"] == [True, True, False, True]


def test_power_up_brakes_until_the_reset() -> None:
    assert not run(AtsSp, [OFF], settings=SETTINGS)["emergency_line"][0]


def test_a_mark_behind_the_crossing_is_refused() -> None:
    with pytest.raises(ModelError, match="nearest admissible mark_at is any below 1000 m"):
        run(AtsSp, [OFF], settings=SETTINGS | {"crossing_at": 1000})


def test_claims() -> None:
    for claim in claims_of(ats_sp).values():
        check(of(claim.formula, OWN_LEMMAS))

"""The on-board set of ATS-SP: from a balise to the brake lines."""

from __future__ import annotations

from typing import Any

import pytest

from models.ats.ats_sp import AtsSp, UnknownProceeds
from models.position.correction import RELEASE, SIGNAL
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
    "locator.correction.data.kind_b": RELEASE, "sp.signal_at": 1600,
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


@pytest.mark.parametrize("lost", ["inputs.supply", "inputs.cycle"])
def test_a_lost_line_brakes_at_once(lost: str) -> None:
    told = drive({}, {lost: False}, {})
    assert told["service_line"] == told["emergency_line"] == [True, True, False, True]


def test_power_up_brakes_until_the_reset() -> None:
    assert not run(AtsSp, [OFF], settings=SETTINGS)["emergency_line"][0]


def test_a_mark_behind_the_crossing_is_refused() -> None:
    with pytest.raises(ModelError, match="a mark before crossing_at"):
        run(AtsSp, [OFF], settings=SETTINGS | {"crossing_at": 1000})


def test_claims() -> None:
    for claim in claims_of(ats_sp).values():
        check(of(claim.formula, OWN_LEMMAS))

"""Ground program by pulse spacing: orders by interval, silence, lost pulses, planted bugs."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from models.patterns.ground_program import BASE, GroundProgram, Orders
from proofs.patterns_ground_program import EVERY_SECOND, FAST
from safety import Bit, ModelError, Real, Scenario, bit, run
from safety.faults import instrument
from safety.tracing import trace
from tests.models.patterns.planted import judged
from tests.models.ts7.test_readings import direct_and_python_agree


def test_direct_and_python_agree() -> None:
    direct_and_python_agree(GroundProgram)


def test_every_parameter_has_unit_range_and_source() -> None:
    assert all(
        s.unit and s.low <= s.value <= s.high and len(s.source) > 5 for s in trace(GroundProgram).settings.values()
    )


def row(pulse: bool, now: Fraction, departs: bool = False) -> dict[str, Any]:
    return {"pulse": pulse, "now": now, "departs": departs}


@pytest.mark.parametrize(
    ("share", "power", "brake"),
    [("0.94", False, True), ("0.95", False, False), ("1", False, False), ("1.05", False, False), ("1.06", True, False),
     ("2", True, False), ("2.01", False, True)],
)  # fmt: skip
def test_orders_by_interval(share: str, power: bool, brake: bool) -> None:
    """As shares of the base interval: brake, dead band, power, and the brake again once it was silent too long."""
    rows = [row(True, BASE), row(True, BASE + Fraction(share) * BASE)]
    seen = run(GroundProgram, lambda k: rows[k], 2)
    assert (seen["power"][1], seen["brake"][1]) == (power, brake)


def test_orders_last_until_the_next_pulse() -> None:
    times = ["0.3", "0.63", "0.7", "0.9", "1.22", "1.24"]
    seen = run(GroundProgram, lambda k: row(k < 2, Fraction(times[k])), 6)
    assert seen["power"][1:] == [True, True, True, True, False] and seen["brake"][-1]


def test_a_train_that_stands_starts_by_the_departure_order_only() -> None:
    seen = run(GroundProgram, lambda k: row(False, Fraction(k), departs=k == 5), 7)
    assert seen["power"] == [False] * 5 + [True, False]


def test_every_second_pulse_missing_gives_power_at_one_and_a_half_the_speed() -> None:
    system = instrument(trace(GroundProgram), [EVERY_SECOND]).system
    seen = run(system, lambda k: row(True, FAST.inputs["now"](k)), 8)
    assert any(seen["power"]) and not any(run(GroundProgram, lambda k: row(True, FAST.inputs["now"](k)), 8)["power"])


def test_a_band_out_of_range_is_refused() -> None:
    with pytest.raises(ModelError, match="nearest admissible value is 1/2"):
        trace(GroundProgram, {"band": Fraction(3, 4)})


class Deaf(GroundProgram, event="look at the pulse receiver"):
    """Planted: silence is not noticed."""

    def step(self, pulse: Bit, now: Real, departs: Bit) -> tuple[GroundProgram, Orders]:
        """As if the departure order were always given."""
        return super().step(pulse, now, bit(True))


def test_a_planted_deafness_is_found() -> None:
    script = Scenario(3, {"now": lambda k: k * BASE * 3})
    assert judged("patterns_ground_program.silence_brakes", Deaf, script).verdict == "refuted"

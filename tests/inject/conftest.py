"""A small piece of equipment to break: a timer that lights a lamp, with a watchdog that sees the timer stand still."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import pytest

from safety.inject import Campaign, Group, stuck_bits
from safety.model import ANY, Model, assume, point, power_up
from safety.terms import U3, U4, Bit, select


class Lamp(NamedTuple):
    lit: Bit
    alarm: Bit


class Timer(Model, event="tick"):
    """Counts ticks modulo 16 while `run`; the lamp is lit in the upper half; a counter that stands raises the alarm."""

    count: U4 = power_up(ANY)
    still: U3 = power_up(0)
    alarm_held: Bit = power_up(False)

    def step(self, run: Bit) -> tuple[Timer, Lamp]:
        assume("the timer runs", run)
        count = point("count", self.count)
        total = point("sum", (count + select(point("run", run), 1, self.still.low(4 - 1))).low(4))
        still = point("still", select(total == count, (self.still + 1).sat(3), 0))
        alarm = point("alarm", self.alarm_held | (still == 7))
        lit = point("lit", total >= 8)
        return Timer(count=total, still=still, alarm_held=alarm), Lamp(lit=lit, alarm=alarm)


@pytest.fixture
def timer() -> type[Model]:
    return Timer


@pytest.fixture
def campaign() -> Callable[..., Campaign]:
    """A campaign on the timer: 32 ticks run in, 64 measured in blocks of 16; a lamp that stays lit is wrong."""

    def make(**changes: Any) -> Campaign:
        declared: dict[str, Any] = {
            "id": "timer",
            "model": Timer,
            "faults": [
                Group("count", stuck_bits("count"), part="counter"),
                Group("lamp", stuck_bits("lit"), part="driver"),
            ],
            "stimulus": {"run": True},
            "run_in": 32,
            "measured": 64,
            "block": 16,
            "observe": {"lit": "lit", "alarm": lambda wires: wires["alarm"]},
            "wrong_side": lambda seen: (seen["lit"] > 8).any(axis=0),
            "safe_side": lambda seen: (seen["lit"] < 8).any(axis=0),
            "detected": lambda seen: seen.ever("alarm"),
        }
        return Campaign(**(declared | changes))

    return make

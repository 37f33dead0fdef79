"""A small piece of equipment to break: a timer that lights a lamp, and a watchdog that sees it stand still.

What each fault does can be told by hand.  From count 8 on (the lamp just lit), with the register's bit read as:
bit 0 = 0 the count stands at 9, lit, and the watchdog sees it; bit 1 = 0 and bit 2 = 0 it runs round within 8..12, lit;
bit 3 = 1 it leaves out 1..8, lit for 7 of 8; bit 3 = 0 it runs 1..8, lit for 1 of 8; bits 0, 1, 2 = 1 some counts are
left out, but half of the rest are lit.
"""

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
        total = point("sum", (count + point("run", run).word()).low(4))
        still = point("still", select(total == self.count, (self.still + 1).sat(3), 0))
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
            "engine": "lanes",
            "faults": [
                Group("count", stuck_bits("count"), part="counter"),
                Group("lamp", stuck_bits("lit"), part="driver"),
                Group("input", stuck_bits("run"), part="input"),
                Group("watchdog", stuck_bits("alarm"), part="watchdog"),
            ],
            "stimulus": {"run": True},
            "start": {"count": 8},
            "run_in": 32,
            "measured": 64,
            "block": 16,
            "observe": {"lit": "lit", "alarm": lambda wires: wires["alarm"]},
            "wrong_side": lambda counts: (counts["lit"] > 8).any(axis=0),
            "safe_side": lambda counts: (counts["lit"] < 8).any(axis=0),
            "detected": lambda counts: counts.ever("alarm"),
        }
        return Campaign(**(declared | changes))

    return make

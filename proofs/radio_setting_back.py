"""Radio control: runs in which a leader sets back, one for each rule without which its follower comes into it.

The leader stands 100 m ahead of the follower's head, the margin is 0; it is to set back until the trains touch.  What
the air does with a message is written as the cycles in which it is taken, heard, and heard once more.
Source: section 9, R1; section 10, AR-4, AR-8; setting back, places [A].
"""

from __future__ import annotations

from collections.abc import Callable, Container
from fractions import Fraction
from typing import Any

from models.kinematics import ACCELERATION, CYCLE
from models.radio.ride import NEVER, commissioned
from proofs.radio_formulas import TWO
from safety import Fault, Scenario

APART = Fraction(100)  # m
SPURT = ACCELERATION * CYCLE * CYCLE / 2  # m in a cycle from a standstill


def within(cycles: Container[int]) -> Callable[[int], bool]:
    """An input that is true in some cycles."""
    return lambda cycle: cycle in cycles


def sent(kind: str, taken: Container[int] = (), heard: Container[int] = (), old: Container[int] = ()) -> dict[str, Any]:
    """What the air does with messages of a kind; `old` is one from before the run."""
    return {
        f"air.{kind}.keep_one": within(taken),
        f"air.{kind}.deliver": lambda cycle: cycle in heard or cycle in old,
        f"air.{kind}.second": within(old),
    }


def spurts(train: str, cycle: int) -> dict[str, Any]:
    """A train that stands but in one cycle, in which it comes forward and stops."""
    return {f"{train}.way": lambda now: SPURT if now == cycle else 0}


def setting_back(fault: Fault, *inputs: dict[str, Any], ordered: int, limit: Fraction = Fraction(0)) -> Scenario:
    """A run in which the leader is ordered back in a cycle, no authority being wanted before; `limit` is that held."""
    wishes = {
        "wish.barrier": lambda cycle: NEVER if cycle > ordered else 0,
        "wish.set_back": within((ordered,)),
    }
    told = {name: value for each in inputs for name, value in each.items()}
    parameters = {"leader.length": 200} | dict.fromkeys(TWO.left_open[:3], 0)
    return Scenario(8, wishes | told, commissioned(APART, APART - limit) | parameters, present=[fault.name])

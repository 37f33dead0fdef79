"""Radio control: rides of two trains, cycle by cycle, for pictures and for runs that break the rules.

The radio is as planned: a message in each direction every T_r = 1 s, which arrives T_c = 0.5 s later, but for the time
in which it is `silent`.  Each driver asks for an acceleration; when the brake acts, the train loses b.
A step is a cycle of 0.1 s; places in m, speeds in m/s, times in s, all exact.
Source: section 9; T_r, T_c, speeds, places [A].
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from models.kinematics import ACCELERATION, B_SERVICE, CYCLE, moved, mps, way_doubled
from models.radio.headway import LATENCY_S, MARGIN_M, PERIOD_S
from models.radio.moving_block import TwoTrains
from safety.trace import Live

TRAIN = "follower.driven.train"
UNIT = "follower.driven.unit"
SHOWN = (
    "leader.head", "leader.rear", f"{TRAIN}.head", f"{TRAIN}.speed", f"{UNIT}.limit", "follower.cell.known",
    "follower.driven.brake", "follower.driven.radio_lost",
)  # fmt: skip
CHANNELS = ("reports", "authorities", "echoes", "orders", "receipts")
NEVER = Fraction(10**6)
Driver = Callable[[Fraction, Fraction], Fraction]  # acceleration asked for, of time and speed


def commissioned(apart: Fraction, margin: Fraction, length: Fraction = Fraction(200)) -> dict[str, Any]:
    """Power-up: the follower's head at 0, the leader's rear `apart` ahead, both standing, all messages true."""
    slots = {
        f"follower.{channel}.{slot}.{part}": value
        for channel, place in zip(CHANNELS, (apart, apart - margin, apart - margin, apart, apart), strict=True)
        for slot in ("one", "two")
        for part, value in (("sent_at", Fraction(-1)), ("says", place))
    }
    stamps = [f"follower.{of}" for of in ("cell.known_stamp", "cell.asked_stamp", "setting_back.stamp")] + [
        f"{UNIT}.stamp"
    ]
    return slots | dict.fromkeys(stamps, Fraction(-1)) | {
        "leader.head": apart + length, "leader.rear": apart, "leader.furthest": apart,
        f"{TRAIN}.rear": -length, f"{TRAIN}.furthest": -length, f"{TRAIN}.left": Fraction(21, 10),
        "follower.cell.known": apart, "follower.cell.in_force": apart - margin, f"{UNIT}.limit": apart - margin,
    }  # fmt: skip


@dataclass(frozen=True)
class Setting:
    """What a ride is about; times in s."""

    seconds: int
    leader: Driver
    follower: Driver
    apart: Fraction = Fraction(1000)
    margin: Fraction = MARGIN_M
    silent: tuple[Fraction, Fraction] = (Fraction(0), Fraction(0))
    rolls_back: tuple[Fraction, Fraction] = (NEVER, Fraction(0))  # when, and how far
    settings: Mapping[str, Any] = field(default_factory=dict)


def ride(of: Setting) -> list[dict[str, Any]]:
    """What each cycle shows, with its time as "s".  Raises `ModelError` for parameters that the model refuses."""
    settings = {"follower.cell.margin": of.margin, **of.settings}
    live = Live(TwoTrains, start=commissioned(of.apart, of.margin), settings=settings)
    rows = []
    for k in range(int(of.seconds / CYCLE)):
        time, state = k * CYCLE, live.state
        back = of.rolls_back[1] if time == of.rolls_back[0] else 0
        row = live.shown(
            air(time, of.silent)
            | motion("ahead", state["leader.speed"], of.leader(time, state["leader.speed"]), back)
            | motion("behind", state[f"{TRAIN}.speed"], _driven(of, time, state))
            | {"beyond": NEVER, "wish.barrier": NEVER, "wish.to": NEVER, "order.place": NEVER, "braked": False}
            | dict.fromkeys(("order.ordered", "wish.set_back"), False)
        )
        rows.append({name: row[name] for name in SHOWN} | {"s": time})
    return rows


def _driven(of: Setting, time: Fraction, state: Mapping[str, Any]) -> Fraction:
    """What the follower does: the brake's b when it acts, else what its driver asks for."""
    acts = state[f"{TRAIN}.left"] < CYCLE
    return -B_SERVICE if acts else of.follower(time, state[f"{TRAIN}.speed"])


def air(time: Fraction, silent: tuple[Fraction, Fraction]) -> dict[str, Any]:
    """A message each T_r, delivered T_c later unless the radio is silent then."""
    sent, heard = time % PERIOD_S == 0, time % PERIOD_S == LATENCY_S
    arrives = heard and not silent[0] <= time < silent[1]
    choices = {"keep_one": sent, "keep_two": False, "deliver": arrives, "second": False}
    return {f"air.{channel}.{name}": value for channel in CHANNELS for name, value in choices.items()}


def motion(train: str, speed: Fraction, acceleration: Fraction, back: Fraction | int = 0) -> dict[str, Any]:
    """The inputs of a train that keeps an acceleration for a cycle, or comes to a standstill."""
    reached, moving = moved(speed, acceleration, CYCLE)
    way = way_doubled(speed, reached, moving) / 2
    return {f"{train}.way": way, f"{train}.reached": reached, f"{train}.back": back, f"{train}.parts": False}


def up_to(top: Fraction) -> Driver:
    """A driver who pulls up to a speed and holds it."""

    def asks(time: Fraction, speed: Fraction) -> Fraction:
        return min(ACCELERATION, (top - speed) / CYCLE)

    return asks


def stops(top: Fraction, at: Fraction, until: Fraction = NEVER) -> Driver:
    """The same, standing (or braking to a standstill) from one time to another."""

    def asks(time: Fraction, speed: Fraction) -> Fraction:
        if at <= time < until:
            return -B_SERVICE if speed > 0 else Fraction(0)
        return up_to(top)(time, speed)

    return asks


CATCHING_UP = Setting(
    300,
    leader=stops(mps(60), Fraction(80), Fraction(150)),
    follower=up_to(mps(100)),
    silent=(Fraction(200), Fraction(215)),
)
ROLLING_BACK = Setting(
    170, leader=stops(mps(60), Fraction(40)), follower=up_to(mps(60)), apart=Fraction(300), margin=Fraction(10),
    rolls_back=(Fraction(160), Fraction(20)), settings={"leader.roll_back": 20},
)  # fmt: skip

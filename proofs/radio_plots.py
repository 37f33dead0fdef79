"""Radio control: time and distance of two trains, a collision after rolling back, and headway over speed, as pictures.

Source: section 9, headway, R2 to R4 [D]; speeds, places, brakes, T_r, T_c, T_loss, L, m, t_sys, B [A].

Main results: the follower comes to a stand behind its authority, behind the leader's rear; without allowance a leader
that rolls back 20 m comes through a margin of 10 m.  Two fixed blocks of 600 m cost 21.4 s at 100 km/h.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise
from typing import Any

from models.kinematics import B_SERVICE, KMH, T_SERVICE, Interval, distance, kmh, mps
from models.radio.headway import BLOCK_M, CLEAR, best_speed, fixed_block, least_headway, moving_block
from models.radio.ride import CATCHING_UP, ROLLING_BACK, TRAIN, UNIT, Setting, ride
from safety.exhibits import Axis, Band, Column, Curve, Mark, Note, Points, Row, Rule, plot, table

OF_RIDES = ("[A] speeds, places, brakes", "[A] T_r = 1 s, T_c = 0.5 s, T_loss = 3 s")
OF_HEADWAYS = ("[A] L = 200 m, m = 50 m, t_sys = 5 s", "[A] two blocks of 600 m")
HEAD, END = f"{TRAIN}.head", f"{UNIT}.limit"
EVERY = 10  # cycles between points of a curve

# --- time and distance -----------------------------------------------------------------------------------------------


def course(rows: list[dict[str, Any]], name: str, label: str) -> Curve:
    """One place over time."""
    return Curve(label, [(row["s"], row[name]) for row in [*rows[::EVERY], rows[-1]]])


def interventions(rows: list[dict[str, Any]], why: str) -> list[tuple[Fraction, Fraction]]:
    """Where the head was when something was first demanded."""
    return [(row["s"], row[HEAD]) for before, row in pairwise(rows) if row[why] and not before[why]]


def received(rows: list[dict[str, Any]]) -> list[tuple[Fraction, Fraction]]:
    """When the ground heard of a rear, and where it was said to be."""
    return [(row["s"], row["follower.cell.known"]) for before, row in pairwise(rows)
            if row["follower.cell.known"] != before["follower.cell.known"]]  # fmt: skip


def trains(rows: list[dict[str, Any]]) -> Iterator[Mark]:
    """Leader, authority and follower."""
    yield course(rows, "leader.head", "head of the leader")
    yield course(rows, "leader.rear", "rear of the leader")
    yield course(rows, END, "end of the authority")
    yield course(rows, HEAD, "head of the follower")


@plot(id="radio_plots.time_distance", requirement="AR-3", assumed=OF_RIDES,
      title="Two trains under radio control: the leader stops and goes on, later the radio is silent for 15 s",
      source="[D] section 9; model run", x=Axis("time", "s"), y=Axis("place", "m"))  # fmt: skip
def time_distance() -> Iterator[Mark]:
    """Reports and authorities over time, and where the pattern or the lost radio demands the brake."""
    rows = ride(CATCHING_UP)
    yield Band("radio silent", x=CATCHING_UP.silent)
    yield from trains(rows)
    yield Points("rear as reported", received(rows)[::EVERY])
    yield Points("pattern intervenes", interventions(rows, "follower.driven.brake")[:1])
    yield Points("radio_lost", interventions(rows, "follower.driven.radio_lost"))


def close_up(of: Setting, seconds: int) -> list[dict[str, Any]]:
    """The end of a ride."""
    return ride(of)[-seconds * 10 :]


@plot(id="radio_plots.rolling_back", requirement="AR-2", assumed=(*OF_RIDES, "[A] rolls back 20 m, m = 10 m"),
      title="Counterexample: no allowance, margin 10 m, the leader rolls back 20 m",
      source="[D] section 10, AR-2; model run",
      x=Axis("time", "s"), y=Axis("place", "m", low=940, high=1000))  # fmt: skip
def rolling_back() -> Iterator[Mark]:
    """The rear of the leader comes back through the head of the follower, which has kept its authority."""
    rows = close_up(ROLLING_BACK, 110)
    yield from list(trains(rows))[1:]
    hit = next(row for row in rows if row[HEAD] > row["leader.rear"])
    yield Points("contact", [(hit["s"], hit[HEAD])])
    yield Note("rolls back 20 m", (hit["s"] - 40, hit["leader.rear"] - 12))


# --- headway ---------------------------------------------------------------------------------------------------------

SPEEDS = range(10, 301, 5)  # km/h
BRAKES = (Fraction("2.5"), Fraction("3.5"))  # km/h/s


@plot(id="radio_plots.headway", requirement="AR-9", assumed=OF_HEADWAYS, source="[D] section 9, headway",
      title="Headway over speed, moving and fixed block", x=Axis("speed", "km/h", low=0, high=300),
      y=Axis("headway", "s", low=0, high=120))  # fmt: skip
def headway() -> Iterator[Mark]:
    """Moving block for two brakes with its least value, and fixed block."""
    for brake in BRAKES:
        points = [(speed, moving_block(mps(speed), brake * KMH)) for speed in SPEEDS]
        yield Curve(f"moving block, {float(brake):g} km/h/s", points)
    fits = [speed for speed in SPEEDS if distance(mps(speed), B_SERVICE, T_SERVICE) <= CLEAR * BLOCK_M]
    yield Curve("fixed block, as far as a stop fits into two of 600 m", [(v, fixed_block(mps(v))) for v in fits])
    yield Points("least", [(kmh(best_speed(b * KMH).middle), least_headway(b * KMH).middle) for b in BRAKES])
    yield Rule("100 km/h", x=100)


COLUMNS = (
    Column("brake", "km/h/s", decimals=1, assumed=True),
    Column("v*", "km/h", decimals=2, assumed=True),
    Column("H*", "s", decimals=2, assumed=True),
    Column("H at 100 km/h", "s", decimals=2, assumed=True),
    Column("H at 270 km/h, L = 400 m", "s", decimals=2, assumed=True),
    Column("fixed block at 100 km/h", "s", decimals=1, assumed=True),
    Column("both ends round alike"),
)


def rounds_alike(found: Interval) -> bool:
    """Whether both ends of an enclosure are the same number to two decimals."""
    return round(found.low, 2) == round(found.high, 2)


@table(id="radio_plots.headways", requirement="AR-9", assumed=OF_HEADWAYS, columns=COLUMNS,
       title="Headways of moving and fixed block", source="[D] section 9, headway")  # fmt: skip
def headways() -> Iterator[Row]:
    """A row a brake."""
    for brake in BRAKES:
        b = brake * KMH
        best, least = best_speed(b), least_headway(b)
        fast = moving_block(mps(270), b, Fraction(400))
        alike = rounds_alike(best.scaled(1 / KMH)) and rounds_alike(least)
        yield brake, kmh(best.middle), least.middle, moving_block(mps(100), b), fast, fixed_block(mps(100)), alike

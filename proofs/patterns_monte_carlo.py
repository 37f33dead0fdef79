"""Speed patterns, sampled: how often a train passes the point when brakes, rails and drivers scatter.

Each mission is drawn anew, with a pinned seed, and run on the model; a share of missions is bounded by Clopper and
Pearson at 99 %.  This is sampling, not proof: the distributions are assumed [A], and what is rare is not seen.

* **brake**: the deceleration falls short of what is guaranteed by 0 to 0.15 m/s^2, uniformly; the margin of 10 m and
  the caution of the pattern (power that is not drawn, the steepest end of the bin) cover four fifths of that;
* **slide**: from a moment on, which is uniform over the braking, the rail gives 0.4 m/s^2 only;
* **driver**: under continuous transmission he acknowledges after 0 to 12 s, uniformly, and goes on at 15 mph; who is
  later than 6 s is braked to a stand;
* **lets_go**: he acknowledges at once and brakes with 0.5 m/s^2, but lets go after 0 to 60 s, uniformly, from when on
  the train coasts; who holds for 56 s stands; **lets_go_by_point**: the same drivers with a stored pattern.

A run ends after 220 s.  Results of 1200 missions each: 217, 936, 624, 692 and 0 pass the point.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

from models.kinematics import B_SERVICE
from models.patterns.equipment import ContinuousEquipment, Equipment, Outcome, PointEquipment
from proofs.patterns_rides import STEPS, approach, start
from safety import ANY_TIME, TRANSIENT, Bit, Fault, Real, offset, point, stuck
from safety.exhibits import Column, Row, table
from safety.inject import Campaign, Group
from safety.inject.statistics import clopper_pearson

MISSIONS, SEED, CONFIDENCE = 1200, 1961, 0.99
SCATTER = Fraction(15, 100)  # m/s^2, by which a brake may fall short [A]
SLIPPERY = Fraction(4, 10)  # m/s^2, what a slippery rail gives [A]
BRAKING = range(200, 600)  # cycles of the ride in which a slide may begin
RED_COMES, LATENESS = 108, range(120)  # cycle of the ride; cycles until the driver presses
BY_HAND, HELD = Fraction(5, 10), range(600)  # m/s^2 [A]; cycles for which the driver brakes
STEPS_DRAWN = 1000  # of a draw from a continuum


def weaker(pick: random.Random) -> Fault:
    """A brake that gives less than guaranteed, from the start."""
    short = SCATTER * pick.randint(1, STEPS_DRAWN) / STEPS_DRAWN
    return Fault(offset(-short), ["vehicle.force"], onset=ANY_TIME, at=0)


def slides(pick: random.Random) -> Fault:
    """The rail becomes slippery at some moment of the braking."""
    return Fault(offset(SLIPPERY - B_SERVICE), ["vehicle.force"], onset=ANY_TIME, at=pick.choice(BRAKING))


def acknowledges(pick: random.Random) -> Fault:
    """The driver presses for half a second, at some time after red has come."""
    return Fault(stuck(1), ["pressed"], onset=TRANSIENT, at=RED_COMES + pick.choice(LATENESS), ticks=5)


class DrivenByCode(ContinuousEquipment, tick_s="0.1"):
    """Coded current, with a handle at which the driver can be drawn."""

    def step(self, stop: Bit, current: Bit, button: Bit, drive: Real, test: Bit) -> tuple[ContinuousEquipment, Outcome]:
        """A cycle."""
        return super().step(stop, current, button, point("handle", drive), test)


class DrivenByPoint(PointEquipment, tick_s="0.1"):
    """Resonant coil and stored pattern, with the same handle."""

    def step(self, stop: Bit, drive: Real, test: Bit) -> tuple[PointEquipment, Outcome]:
        """A cycle."""
        return super().step(stop, point("handle", drive), test)


def lets_go(pick: random.Random) -> Fault:
    """The driver, who brakes to a stand otherwise, releases at some time after red has come."""
    return Fault(offset(BY_HAND), ["handle"], onset=ANY_TIME, at=RED_COMES + pick.choice(HELD))


def by_hand(cycle: int) -> Fraction:
    """The acceleration that he gives, m/s^2."""
    return -BY_HAND if cycle >= RED_COMES else Fraction(0)


def drawn(
    name: str, equipment: type[Equipment], fault: Callable[[random.Random], Fault], wrong: int, **given: Any
) -> Campaign:
    """Missions of a train to a signal at stop, each with what was drawn for it; so many pass the point."""
    return Campaign(
        id=f"patterns_monte_carlo_{name}", model=equipment,
        stimulus=approach(equipment, **given), start=start(equipment), measured=STEPS,
        hazard="passed", faults=[Group(name, fault, drawn=MISSIONS)], seed=SEED, confidence=CONFIDENCE,
        expect={"dangerous_undetected": wrong, "no_effect": MISSIONS - wrong},
    )  # fmt: skip


brake = drawn("brake", PointEquipment, weaker, 217)
slide = drawn("slide", PointEquipment, slides, 936)
driver = drawn("driver", ContinuousEquipment, acknowledges, 624)
let_go = drawn("lets_go", DrivenByCode, lets_go, 692, button=True, drive=by_hand)
let_go_by_point = drawn("lets_go_by_point", DrivenByPoint, lets_go, 0, drive=by_hand)
SAMPLED = (brake, slide, driver, let_go, let_go_by_point)


@table(
    id="patterns.sampled", title="Missions that pass the point, sampled with a pinned seed",
    source="[A] distributions; bounds of Clopper and Pearson at 99 %",
    columns=(Column("what scatters"), Column("missions"), Column("pass the point"),
             Column("share, least", decimals=4, assumed=True), Column("share, greatest", decimals=4, assumed=True)),
)  # fmt: skip
def sampled() -> Iterator[Row]:
    """A campaign a row."""
    for campaign in SAMPLED:
        hits = campaign.inject().tally.dangerous_undetected
        low, high = clopper_pearson(hits, MISSIONS, CONFIDENCE)
        yield campaign.faults[0].name, MISSIONS, hits, Fraction(low), Fraction(high)

"""The train in discrete time, against motion in closed form."""

from __future__ import annotations

from fractions import Fraction

import pytest

from models.kinematics import B_SERVICE, distance
from models.patterns.train import Brake, T, Train, check_budget, runs
from safety import ModelError, run


@pytest.mark.parametrize(("v", "b"), [(Fraction(20), B_SERVICE), (Fraction(7, 3), Fraction(1, 3)), (Fraction(0), 1)])
def test_a_braked_train_stops_where_the_distance_says(v: Fraction, b: Fraction) -> None:
    """To the last digit, a standstill within a cycle included."""
    reached, moving = runs(v, [-b] * 400)
    rows = [{"reached": u, "moving": m, "push": -Fraction(b)} for u, m in zip(reached, moving, strict=True)]
    trace = run(Train, rows, 400, start={"v": v, "x": Fraction(1000)})
    assert trace["v"][-1] == 0 and 1000 - trace["x"][-1] == distance(v, Fraction(b), Fraction(0))


@pytest.mark.parametrize(
    "row",
    [{"reached": 3, "moving": T, "push": 0}, {"reached": 1, "moving": T / 2, "push": 0},
     {"reached": 2, "moving": T, "push": -1}, {"reached": -1, "moving": T, "push": 0}],
)  # fmt: skip
def test_a_motion_that_cannot_be_is_refused(row: dict[str, Fraction]) -> None:
    with pytest.raises(ModelError, match="breaks the assumption"):
        run(Train, [row], 1, start={"v": Fraction(2), "x": Fraction(50)})


def test_the_brake_acts_within_its_budget() -> None:
    """From the sample that asks: the budget less the cycle to that sample, in whole cycles."""
    trace = run(Brake, [{"asked": True, "t": Fraction(2)}] * 30, 30, start={"left": Fraction(2) - T})
    assert trace["acts"].index(True) * T <= Fraction(2) - 2 * T


def test_the_brake_does_not_act_in_the_cycle_that_releases_it() -> None:
    rows = [{"asked": asked, "t": Fraction(2)} for asked in (True, True, False, True)]
    assert run(Brake, rows, 4, start={"left": T})["acts"] == [True, True, False, False]


def test_a_budget_that_the_brake_does_not_keep_is_refused() -> None:
    check_budget(Fraction(2), Fraction("1.7"))
    with pytest.raises(ModelError, match=r"reaction budget = 1.9 s: .*; the nearest admissible value is 2 s"):
        check_budget(Fraction("1.9"), Fraction("1.7"))

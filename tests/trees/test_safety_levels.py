"""Bands of safety integrity, at their limits and across them."""

from fractions import Fraction

import pytest

from safety.trees import BasicEvent, FaultTree, Gate
from safety.trees.expressions.expression import Operation
from safety.trees.expressions.lifetimes import Exponential, Glm
from safety.trees.over_time.averages import averages
from safety.trees.over_time.mission import Mission
from safety.trees.over_time.safety_levels import UPPER_END, level
from tests.trees.over_time import L, T

NEXT = Fraction(1, 10**40)  # far closer than a double can tell


@pytest.mark.parametrize(("mode", "upper"), UPPER_END.items())
def test_limits_belong_to_the_lower_level(mode, upper):
    for sil in (1, 2, 3, 4):
        limit = upper / 10 ** (sil - 1)
        assert level(mode, limit).decided == sil - 1
        assert level(mode, limit - NEXT).decided == sil
        across = level(mode, limit - NEXT, limit)
        assert across.decided is None and (across.worst, across.best) == (sil - 1, sil)
        assert across.plain() == {"mode": mode, "sil": None, "sil_at_least": sil - 1, "limit": float(limit)}


def test_the_table_of_the_standard():
    """IEC 61508-1:2010, tables 2 and 3, as printed."""
    for sil, low, high in ((4, "1e-5", "1e-4"), (3, "1e-4", "1e-3"), (2, "1e-3", "1e-2"), (1, "1e-2", "1e-1")):
        for figure in (Fraction(low), Fraction(low) * 2, Fraction(high) - NEXT):
            assert level("low demand", figure).decided == sil
            assert level("high demand", figure / 10**4).decided == sil


def test_better_than_the_highest_level_is_still_the_highest():
    below = level("high demand", Fraction(1, 10**10))
    assert below.plain() == {"mode": "high demand", "sil": 4, "sil_at_least": 4, "beyond": True}
    assert "beyond" not in level("high demand", Fraction(1, 10**9)).plain()
    assert level("low demand", 1).plain() == {"mode": "low demand", "sil": 0, "sil_at_least": 0}


@pytest.mark.parametrize(
    ("figures", "sil"), [(("0.1", "0.1", "0.1"), 2), (("0.1", "0.1", "0.0999"), 3), (("0.1", "0.01"), 2)]
)
def test_constant_trees_are_decided_exactly(figures, sil):
    """0.1 * 0.1 * 0.1 is 0.001 itself, which doubles put a little above or below."""
    names = tuple("abc"[: len(figures)])
    events = tuple(BasicEvent(name, Fraction(figure)) for name, figure in zip(names, figures, strict=True))
    found = averages(Mission(FaultTree("t", "top", (Gate("top", "and", names),), events), 8760))
    assert found.method == "constant" and found.exact == found.low_demand.low
    assert found.low_demand.decided == sil and found.high_demand is None


def test_a_rate_is_decided_by_its_bounds():
    """Of what is never repaired, w(t) falls below its rate: the frequency is just below 1e-7, on the better side."""
    events = (BasicEvent("a", rate_per_hour=Fraction(1, 10**7)),)
    found = averages(Mission(FaultTree("t", "top", (Gate("top", "or", ("a",)),), events, mission_time_h=8760)))
    assert found.frequency.high < 1e-7 and found.high_demand.decided == 3
    assert found.low_demand.decided == 3
    plain = found.plain()
    assert plain["sil_high_demand"]["sil"] == 3 and plain["method"] == "certified quadrature"


def over(law, time, gate="or"):
    events = (BasicEvent("a", expression=law),)
    return averages(Mission(FaultTree("t", "top", (Gate("top", gate, ("a",)),), events, mission_time_h=time)))


@pytest.mark.parametrize(
    ("law", "time", "gate"),
    [
        (Exponential(L, T), 10**12, "or"),  # failed long ago
        (Glm("0.999", "1e-8", 0, T), 1000, "or"),  # failed at first
        (Exponential(L, T), 1000, "not"),  # holds until a fails
        (Exponential("2.15e-10", T), 10**9, "or"),  # PFDavg just above 0.1
    ],
)
def test_no_level_from_the_frequency_of_what_is_mostly_down(law, time, gate):
    found = over(law, time, gate)
    assert found.unavailability.low > 0.1
    assert level("high demand", *found.frequency).decided == 4  # what must not be said
    high_demand = found.plain()["sil_high_demand"]
    assert high_demand["sil"] == high_demand["sil_at_least"] == 0 == found.low_demand.decided
    assert "of the time on the average, 0.1 or more" in high_demand["why_none"]
    assert "limit" not in high_demand and "beyond" not in high_demand


def test_a_level_where_it_is_mostly_up():
    found = over(Exponential("2.05e-10", T), 10**9)  # PFDavg just below 0.1
    assert 0.09 < found.unavailability.high < 0.1 and found.high_demand.decided == 4
    assert "why_none" not in found.plain()["sil_high_demand"]


def test_no_level_where_a_share_of_a_probability_is_used_up():
    """A hundredth of what is sure to have failed: PFDavg is 0.01, but nothing more fails."""
    law = Operation("mul", Fraction(1, 100), Exponential(L, T))
    assert over(law, 500).high_demand.decided == 2
    found = over(law, 10**8)
    assert found.unavailability.high < 0.011 and level("high demand", *found.frequency).decided == 4
    assert found.high_demand.decided == 0 and '"a" has 0.01 times the probability' in found.high_demand.why_none

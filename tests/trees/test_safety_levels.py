"""Bands of safety integrity, at their limits and across them."""

from fractions import Fraction

import pytest

from safety.trees import BasicEvent, FaultTree, Gate
from safety.trees.averages import averages
from safety.trees.mission import Mission
from safety.trees.safety_levels import UPPER_END, level

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

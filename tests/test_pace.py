"""Models whose step is as long as their parameters say."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Annotated, Any

import pytest

from safety.model import Model, parameter, power_up
from safety.system import Clock, ModelError, repeat
from safety.terms import U12, Bit, Int
from safety.trace import run
from safety.tracing import trace
from tests.test_trace import read

Percent = Annotated[Int, (-50, 50)]


def length(rate: int = 1000, error: int = 0) -> Fraction:
    """Seconds of a step."""
    return Fraction(100, rate * (100 + error))


class Oscillator(Model, tick_s=length):
    """A clock, some per cent fast; nothing in its step says how much."""

    error: Percent = parameter(0, unit="%", within=(-50, 50), source="[A]", init=False)

    def step(self) -> Oscillator:
        return type(self)()


class Beat(Model, tick_s=length):
    """A wire that changes each step."""

    rate: U12 = parameter(1000, unit="Hz", within=(3, 4000), source="[P]", init=False)
    up: Bit = power_up(False)

    def step(self) -> tuple[Beat, Bit]:
        return type(self)(up=~self.up), self.up & (self.rate > 0)


class Whole(Model):
    """Both."""

    oscillator: Oscillator
    beat: Beat

    def step(self) -> tuple[Whole, Bit]:
        beat, up = self.beat.step()
        return Whole(oscillator=self.oscillator.step(), beat=beat), up


class Two(Model):
    """Two that beat together."""

    a: Beat
    b: Beat

    def step(self) -> tuple[Two, Bit]:
        a, _ = self.a.step()
        b, up = self.b.step()
        return Two(a=a, b=b), up


@pytest.mark.parametrize(
    ("settings", "period"),
    [
        ({}, "1/1000"),
        ({"rate": 2000}, "1/2000"),
        ({"error": 25}, "1/1250"),
        ({"rate": 7, "error": -50}, "2/7"),
        ({"beat.rate": Fraction(4000, 1)}, "1/4000"),
    ],
)
def test_the_period_follows_from_the_parameters_wherever_it_is_shown(settings: dict[str, Any], period: str) -> None:
    seconds = Fraction(period)
    found = run(Whole, (), 5, settings=settings)
    assert found.system.clock == Clock(seconds) and found.to_json()["tick_s"] == period
    assert repeat(found.system, 3).clock.period == 3 * seconds
    dump = read(found.vcd())
    for step, time in enumerate(dump.times):
        off = abs(dump.unit * time - step * seconds)
        assert off == 0 or off <= dump.unit / 2 <= seconds / 10**6


def test_a_part_without_a_parameter_has_the_default() -> None:
    assert trace(Beat).clock.period == Fraction(1, 1000)
    assert trace(Oscillator, {"error": 25}).clock.period == Fraction(1, 1250)


def test_a_parameter_of_the_period_is_among_those_used_and_is_checked() -> None:
    assert trace(Oscillator, {"error": 25}).settings["error"].value == 25
    with pytest.raises(ModelError, match=r"error = 51 % lies outside -50\.\.50 %"):
        trace(Oscillator, {"error": 51})


def test_an_open_parameter_leaves_the_period_open() -> None:
    open_ = trace(Whole, symbolic=["rate"])
    assert open_.clock.period is None and str(open_.clock) == "at each step, whose length follows from rate"
    assert trace(Oscillator, symbolic=["error"]).state["error"].path == "error"


def test_parts_with_different_periods_are_refused() -> None:
    assert trace(Two, {"rate": 2000}).clock.period == Fraction(1, 2000)
    with pytest.raises(ModelError, match=r"a\.rate = 1000 and b\.rate = 2000: steps of different length; one system"):
        trace(Two, {"b.rate": 2000})


class Fixed(Model, tick_s="1/1000"):
    """Steps of its own length."""

    beat: Beat

    def step(self) -> Fixed:
        return Fixed(beat=self.beat.step()[0])


def test_a_period_that_follows_and_one_that_is_fixed_do_not_mix() -> None:
    with pytest.raises(ModelError, match=r"step every 1000 us and length\(rate, error\); one system has one clock"):
        trace(Fixed)


@pytest.mark.parametrize(("rule", "said"), [(lambda: 0.25, "0.25"), (lambda: Fraction(0), r"Fraction\(0, 1\)")])
def test_a_rule_that_gives_no_period_is_refused(rule: Callable[[], Any], said: str) -> None:
    class Bad(Model, tick_s=rule):
        """A step of no length."""

        def step(self) -> Bad:
            return Bad()

    with pytest.raises(ModelError, match=f"gives {said} for .*; a period is a Fraction of seconds, above 0"):
        trace(Bad)


@pytest.mark.parametrize("value", [930, Fraction(930), Fraction("9.3e2")])
def test_a_whole_number_may_be_written_in_any_exact_way(value: Any) -> None:
    set_ = trace(Beat, {"rate": value}).settings["rate"].value
    assert set_ == 930 and type(set_) is int


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (Fraction("930.5"), r"rate = 1861/2 Hz is no whole number; write one in 3\.\.4000 Hz, e\.g\. 1000"),
        (Fraction("1e4"), r"rate = 10000 Hz lies outside 3\.\.4000 Hz; the nearest admissible value is 4000"),
        (Fraction("2.5"), r"is no whole number"),
        (930.0, r"is not a value of u12; write an exact number"),
        (True, r"is not a value of u12; write an exact number"),
        ("930", r"is not a value of u12; write an exact number"),
    ],
)
def test_another_value_is_refused_for_the_right_reason(value: Any, said: str) -> None:
    with pytest.raises(ModelError, match=said):
        trace(Beat, {"rate": value})

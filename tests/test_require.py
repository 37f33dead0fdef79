"""Requirements: what parameters have to fulfil together, refused where they are set, assumed where they are open."""

from __future__ import annotations

import pytest

from safety.model import Model, parameter, require
from safety.system import ModelError
from safety.terms import Bit, Real
from safety.tracing import trace


class Curve(Model, tick_s=1):
    """A part with two parameters that depend on each other."""

    far: Real = parameter(3, unit="m", within=(0, 9), source="[A] far")
    near: Real = parameter(2, unit="m", within=(0, 9), source="[A] near")

    def step(self) -> tuple[Curve, Bit]:
        require("the near marker lies behind the far one", self.near < self.far, lambda: f"give near up to {NEAREST}")
        return type(self)(), self.near < self.far


NEAREST = 2


def test_parameters_that_do_not_go_together_are_refused_with_the_nearest() -> None:
    assert trace(Curve).assumptions == {}
    with pytest.raises(ModelError, match=r"the near marker lies behind the far one: not with these.*near up to 2"):
        trace(Curve, {"near": 3})


def test_of_open_parameters_it_is_assumed_and_shown() -> None:
    assert list(trace(Curve, symbolic=["near"]).assumptions) == ["the near marker lies behind the far one"]


def test_a_requirement_is_about_parameters_alone() -> None:
    class Moving(Model, tick_s=1):
        def step(self, x: Bit) -> tuple[Moving, Bit]:
            require("x", x, "none")
            return type(self)(), x

    with pytest.raises(ModelError, match="reads x, which is no parameter; use assume"):
        trace(Moving)


def test_a_switch_may_be_left_open() -> None:
    class Switched(Model, tick_s=1):
        on: Bit = parameter(False, unit="", within=(False, True), source="[A] fitted or not")

        def step(self, x: Bit) -> tuple[Switched, Bit]:
            return type(self)(), x & self.on

    made = trace(Switched, symbolic=["on"])
    assert [s.path for s in made.states] == ["on"] and made.start.is_const

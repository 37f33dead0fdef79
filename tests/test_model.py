"""Models: what a class declares becomes a system; each misuse is told with the signal's name and what to write."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple

import pytest

from safety.model import ANY, Model, assume, parameter, parts, point, power_up, registers
from safety.prove.claims import Seen
from safety.scope import current
from safety.system import ModelError, repeat
from safety.terms import U2, U3, U4, U8, Bit, UInt, select
from safety.terms.graph import describe
from safety.trace import run
from safety.tracing import direct_step, resolve, trace


class Drive(NamedTuple):
    trip: Bit
    d: Bit


class Inputs(NamedTuple):
    up: Bit
    by: U2


class Leaf(Model, tick_s="125e-6"):
    """Adds up, with a gain."""

    gain: U3 = parameter(2, unit="count", within=(1, 5), source="[P] table 1", init=False)
    n: U4 = power_up(ANY)

    def step(self, inputs: Inputs) -> tuple[Leaf, Bit]:
        more = select(inputs.up, (self.n + inputs.by + self.gain).sat(4), self.n)
        assume("not too much", inputs.by < 3)
        return Leaf(n=point("n", more)), point("full", self.n == 15)


class Drives(NamedTuple):
    first: Bit
    second: Bit


class Whole(Model):
    """Two leaves, one behind the other."""

    left: Leaf
    right: Leaf
    limit: U4 = parameter(9, unit="count", within=(4, 15), source="[A] test", init=False)
    seen: Bit = power_up(False)

    def step(self, inputs: Inputs) -> tuple[Whole, Drives]:
        left, a = self.left.step(inputs)
        right, b = self.right.step(Inputs(up=a, by=inputs.by))
        return Whole(left=left, right=right, seen=self.seen | b), Drives(a, point("out", b & (self.right.gain > 1)))


# --- what a trace knows --------------------------------------------------------------------------------------------


def test_a_trace_knows_every_name() -> None:
    made = trace(Whole)
    assert list(made.state) == ["seen", "left.n", "right.n"]
    assert list(made.inputs) == ["inputs.up", "inputs.by"]
    assert list(made.signals) == ["left.out", "right.out", "first", "second"]
    assert set(made.points) == {"left.n", "left.full", "right.n", "right.full", "out"}
    assert made.parts == {"left": "Leaf", "right": "Leaf"}
    assert list(made.assumptions) == ["left.not too much", "right.not too much"]
    assert str(made.clock) == "every 125 us" and made.state["left.n"].power_up is ANY
    assert registers(Whole).keys() == {"seen"} and parts(Whole) == {"left": Leaf, "right": Leaf}


def test_parameters_are_set_by_full_name_pattern_or_bare_name() -> None:
    assert {p: s.value for p, s in trace(Whole).settings.items()} == {"left.gain": 2, "right.gain": 2}
    assert resolve(Whole, {"gain": 3}) == resolve(Whole, {"*.gain": 3}) == {"left.gain": 3, "right.gain": 3}
    assert {p: s.value for p, s in trace(Whole, {"left.gain": 5}).settings.items()} == {"left.gain": 5, "right.gain": 2}
    setting = trace(Whole, {"left.gain": 5}).settings["left.gain"]
    assert (setting.unit, setting.low, setting.high, setting.tag, setting.default) == ("count", 1, 5, "P", 2)
    assert Leaf.gain.name == "gain"  # type: ignore[attr-defined]


def test_a_part_keeps_its_own_parameter_wherever_it_is_read() -> None:
    """`self.right.gain`, read by the whole, is the right leaf's."""
    row = {"inputs.up": False, "inputs.by": 0}
    weak = run(Whole, row, 1, start={"right.n": 15}, settings={"right.gain": 1})
    strong = run(Whole, row, 1, start={"right.n": 15}, settings={"left.gain": 1})
    assert weak["out"] == [False] and strong["out"] == [True]


def test_an_open_parameter_is_a_register_that_stays() -> None:
    made = trace(Whole, symbolic=["right.gain"])
    gain = made.state["right.gain"]
    assert gain.next is gain.var and gain.power_up is ANY and made.settings["right.gain"].value is None
    assert describe(made.start) == "((1 <= right.gain) & (right.gain <= 5))"
    assert run(made, {"inputs.up": False, "inputs.by": 0}, 2)["right.gain"] == [2, 2]
    with pytest.raises(ModelError, match=r"right\.gain = 6 lies outside 1\.\.5 count"):
        run(made, {"inputs.up": False, "inputs.by": 0}, 2, start={"right.gain": 6})


def test_the_direct_reading_takes_the_same_step() -> None:
    state, inputs = {"seen": False, "left.n": 14, "right.n": 15}, {"inputs.up": True, "inputs.by": 1}
    following, seen = direct_step(Whole, state, inputs)
    assert following == {"seen": True, "left.n": 15, "right.n": 15}
    assert seen == {
        "left.n": 15, "left.full": False, "left.out": False, "right.n": 15, "right.full": True, "right.out": True,
        "out": True, "first": False, "second": True,
    }  # fmt: skip
    assert current.get() is None


def test_several_steps_are_one_with_the_inputs_held() -> None:
    one, three = trace(Leaf), repeat(trace(Leaf), 3)
    row = {"inputs.up": True, "inputs.by": 1}
    assert run(three, row, 2)["n"] == run(one, row, 6)["n"][::3]
    assert str(three.clock) == "every 375 us"
    assert list(three.assumptions) == ["not too much (step 0)", "not too much (step 1)", "not too much"]
    assert repeat(one, 1).states == one.states


class Through(Model, event="tick"):
    """Passes an input on under the input's name."""

    def step(self, brake: Bit) -> tuple[Through, NamedBrake]:
        return Through(), NamedBrake(brake=~point("brake", ~brake))


class NamedBrake(NamedTuple):
    brake: Bit


def test_an_output_with_the_name_of_an_input_is_told_from_it() -> None:
    made = trace(Through)
    assert list(made.signals) == ["brake (output)"]
    found = run(made, {"brake": True}, 1)
    assert found["brake"] == [True] and found["brake (output)"] == [True]
    with pytest.raises(ModelError, match=r"has an input and an output 'brake'; write s\['brake \(output\)'\]"):
        _ = Seen(made).brake
    assert Seen(made)["brake (output)"].op == "not"


class Odd(Model, event="tick"):
    """Signals with the names of Python's own attributes."""

    count: U2 = power_up(0)
    index: Bit = power_up(False)

    def step(self, copy: Bit, system: Bit) -> tuple[Odd, Keys]:
        return Odd(count=(self.count + 1).low(2), index=copy), Keys(keys=system, items=self.index)


class Keys(NamedTuple):
    keys: Bit
    items: Bit


def test_names_of_python_attributes_are_signals_like_others() -> None:
    made = trace(Odd)
    seen = Seen(made)
    assert seen.count is made.state["count"].var and seen.index is made.state["index"].var
    assert seen.keys is made.inputs["system"] is seen.system and seen.items is seen.index


# --- misuse --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"left.gain": 9}, r"left\.gain = 9 count lies outside 1\.\.5 count; the nearest admissible value is 5"),
        ({"gain": 0}, r"left\.gain = 0 count lies outside .* value is 1"),
        ({"gain": Fraction(11, 4)}, r"= 11/4 count is no whole number; write one in 1\.\.5 count"),
        ({"gain": "3"}, r"left\.gain = 3 count is not a value of u3; write an exact number in 1\.\.5 count"),
        ({"gain": 2.5}, "is not a value of u3; write an exact number"),
        ({"gian": 3}, "Whole has no parameter 'gian'; did you mean gain"),
    ],
)
def test_settings_are_checked(settings: dict[str, Any], says: str) -> None:
    with pytest.raises(ModelError, match=says):
        trace(Whole, settings)


@pytest.mark.parametrize(
    ("declared", "says"),
    [
        ({"source": "table 1"}, r"start it with \[P\], \[D\], \[A\] or \[R\]"),
        ({"default": 9}, r"parameter default 9 count lies outside 1\.\.5"),
        ({"within": (5, 1)}, r"parameter range 5\.\.1 count is empty"),
    ],
)
def test_a_parameter_is_checked_where_it_is_declared(declared: dict[str, Any], says: str) -> None:
    usual: dict[str, Any] = {"default": 2, "unit": "count", "within": (1, 5), "source": "[P] table 1"}
    with pytest.raises(ModelError, match=says):
        parameter(**(usual | declared))


def test_names_that_are_not_there_are_told() -> None:
    made = trace(Whole)
    for path, says in (
        ("left.m", "did you mean left.n"),
        ("zzz", "there is first, inputs.by"),
        ("left.fulll", "left.full"),
    ):
        with pytest.raises(ModelError, match=says):
            made.lookup(path)
        with pytest.raises(ModelError, match=f"Whole has no signal '{path}'"):
            _ = Seen(made)[path]


class Base(Model, event="tick"):
    """Counts."""

    n: U8 = power_up(0)

    def step(self, go: Bit) -> tuple[Base, Bit]:
        return type(self)(n=select(go, (self.n + 1).low(8), self.n)), point("high", self.n > 7)


class Inverted(Base, event="tick"):
    """Counts the other way round."""

    def step(self, go: Bit) -> tuple[Base, Bit]:
        return super().step(~go)


class Inherited(Base, event="tick"):
    """Counts as its base does."""


def test_a_model_may_build_on_another() -> None:
    assert run(Inherited, {"go": True}, 3)["n"] == run(Inverted, {"go": False}, 3)["n"] == [0, 1, 2]
    assert trace(Inherited).name == "Inherited" and list(trace(Inverted).points) == ["high"]


def test_a_part_with_other_registers_is_still_itself() -> None:
    class Pair(Model, tick_s=1):
        a: U4 = power_up(1)
        b: U4 = power_up(2)

        def step(self, up: Bit) -> tuple[Pair, UInt]:
            moved = self.replaced(a=select(up, self.b, self.a))
            return moved.replaced(b=self.a), moved.a + moved.b

    found = run(Pair, {"up": True}, 3)
    assert found["a"] == [1, 2, 1] and found["b"] == [2, 1, 2] and found["out"] == [4, 2, 4]

    class Misspelt(Pair, tick_s=1):
        def step(self, up: Bit) -> tuple[Misspelt, UInt]:
            return self.replaced(c=up), self.a

    with pytest.raises(ModelError, match="Misspelt has no register 'c'"):
        trace(Misspelt)

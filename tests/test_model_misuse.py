"""Models written wrongly: each is told with the signal's name and what to write instead."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import pytest

from safety.model import ANY, Model, assume, parameter, point, power_up, registers
from safety.system import ModelError
from safety.terms import U1, U2, U4, U8, Bit, Int, Real, UInt, select, word
from safety.trace import run
from safety.tracing import trace

USED = (ANY, U1, U2, U4, U8, Annotated, Int, Real, UInt, assume, parameter, point, power_up, word)  # by the texts below


class Drive(NamedTuple):
    trip: Bit
    d: Bit


class Inputs(NamedTuple):
    up: Bit
    by: U2


class Nest(NamedTuple):
    leaf: Drive


class Leaf(Model, tick_s="125e-6"):
    """Adds up."""

    n: U4 = power_up(ANY)

    def step(self, inputs: Inputs) -> tuple[Leaf, Bit]:
        return Leaf(n=point("n", select(inputs.up, (self.n + inputs.by).sat(4), self.n))), self.n == 15


class Bare(Model):
    """Has no clock."""

    def step(self) -> Bare:
        return self


def model(*body: str, head: str = 'event="tick"') -> type[Model]:
    """A model from the lines of its body."""
    lines = "".join(f"    {line}\n" for line in body)
    text = f"from __future__ import annotations\nclass Made(Model, {head}):\n    'Made for a test.'\n{lines}"
    space = dict(globals())
    exec(compile(text, "<made>", "exec"), space)
    made: type[Model] = space["Made"]
    return made


# what is wrong: (what is said, the lines of the model)
MISUSE: dict[str, tuple[str, ...]] = {
    "a forgotten register": (
        r"Made\(\.\.\.\) lacks b: every step returns every register and part",
        "a: Bit = power_up(False)",
        "b: Bit = power_up(False)",
        "def step(self) -> Made:",
        "    return Made(a=self.a)",
    ),
    "an unknown register": (
        "Made has no register or part 'cuont'; did you mean count?",
        "count: U4 = power_up(0)",
        "def step(self) -> Made:",
        "    return Made(count=self.count, cuont=self.count)",
    ),
    "no power-up value": (
        r"Made\.a has no power-up value; write `= power_up\(0\)` or `= power_up\(ANY\)`",
        "a: Bit",
        "def step(self) -> Made:",
        "    return Made(a=self.a)",
    ),
    "a wrong power-up value": (
        r"Made\.a: power_up\(4\) is not a value of u2",
        "a: U2 = power_up(4)",
        "def step(self) -> Made:",
        "    return Made(a=self.a)",
    ),
    "0 for a wire": (
        r"Made\.a: power_up\(0\) is not a value of bit",
        "a: Bit = power_up(0)",
        "def step(self) -> Made:",
        "    return Made(a=self.a)",
    ),
    "a wider word": (
        r"next\(Made\.a\) is u4, given u5 \(a \+ 1\); wrap it with \.low\(4\) or saturate it with \.sat\(4\)",
        "a: U4 = power_up(0)",
        "def step(self) -> Made:",
        "    return Made(a=self.a + 1)",
    ),
    "a wider range": (
        r"is int\[0, 3\], given int\[-1, 3\] .*; clamp it with \.clip\(0, 3\)",
        "a: Annotated[Int, (0, 3)] = power_up(0)",
        "def step(self) -> Made:",
        "    return Made(a=self.a - 1)",
    ),
    "a word for a range": (
        r"clamp it with \.int\(\)\.clip\(0, 3\)",
        "a: Annotated[Int, (0, 3)] = power_up(0)",
        "def step(self, b: U4) -> Made:",
        "    return Made(a=b)",
    ),
    "a wire for a word": (
        r"next\(Made\.a\) is u1, given bit b; write \.word\(\)",
        "a: U1 = power_up(0)",
        "def step(self, b: Bit) -> Made:",
        "    return Made(a=b)",
    ),
    "a word for a wire": (
        r"is bit, given u2 b; write a comparison or \.bit\(i\)",
        "a: Bit = power_up(False)",
        "def step(self, b: U2) -> Made:",
        "    return Made(a=b)",
    ),
    "a word for a real": (
        r"is real, given u2 b; write \.real\(\)",
        "a: Real = power_up(0)",
        "def step(self, b: U2) -> Made:",
        "    return Made(a=b)",
    ),
    "a real for a word": (
        "is u2, given real b; a real has no exact word",
        "a: U2 = power_up(0)",
        "def step(self, b: Real) -> Made:",
        "    return Made(a=b)",
    ),
    "a literal out of range": (
        r"next\(Made\.a\) is u2: 5 is not a value of it",
        "a: U2 = power_up(0)",
        "def step(self) -> Made:",
        "    return Made(a=5)",
    ),
    "no type": (
        r"Made\.step\(b\) has no type; annotate it, e\.g\. b: Bit",
        "def step(self, b) -> Made:",
        "    return Made()",
    ),
    "an unknown type": (
        "'Bti' in an annotation is not defined",
        "def step(self, b: Bti) -> Made:",
        "    return Made()",
    ),
    "a word of no width": (
        "is no signal type; write Bit, U8",
        "def step(self, b: UInt) -> Made:",
        "    return Made()",
    ),
    "a range of no bounds": (
        "is no signal type",
        "def step(self, b: Int) -> Made:",
        "    return Made()",
    ),
    "a wrong width": (
        "is no signal type",
        "def step(self, b: Annotated[UInt, '8']) -> Made:",
        "    return Made()",
    ),
    "a Python type": (
        "<class 'int'> is no signal type",
        "def step(self, b: int) -> Made:",
        "    return Made()",
    ),
    "no step": (
        "Made has no step",
        "a: Bit = power_up(False)",
    ),
    "nothing returned": (
        r"Made\.step returns None; write the next Made",
        "def step(self) -> Made:",
        "    pass",
    ),
    "another model returned": (
        r"Made\.step returns <.*Leaf",
        "def step(self) -> Made:",
        "    return Leaf(n=word(0, 4))",
    ),
    "an assigned register": (
        r"Made\.a cannot be assigned; return a new Made\(a=\.\.\.\)",
        "a: Bit = power_up(False)",
        "def step(self) -> Made:",
        "    self.a = ~self.a",
        "    return self",
    ),
    "an unknown signal": (
        "no attribute 'b'",
        "a: Bit = power_up(False)",
        "def step(self) -> Made:",
        "    return Made(a=self.b)",
    ),
    "a register called step": (
        "every model has a 'step' of its own",
        "step: Bit = power_up(False)",
    ),
    "a register with a name of Model": (
        "every model has a 'parameter_value' of its own; give the field another name",
        "parameter_value: Bit = power_up(False)",
        "def step(self) -> Made:",
        "    return self",
    ),
    "an input with a register's name": (
        "input 'a' has the name of a register; give it another",
        "a: Bit = power_up(False)",
        "def step(self, a: Bit) -> Made:",
        "    return Made(a=a)",
    ),
    "an output with a register's name": (
        "output 'd' has the name of a register or part; give it another",
        "d: Bit = power_up(False)",
        "def step(self) -> tuple[Made, Drive]:",
        "    return self, Drive(trip=self.d, d=self.d)",
    ),
    "an output that is no term": (
        "output of Made is u2: 7 is not a value",
        "def step(self) -> tuple[Made, U2]:",
        "    return self, 7",
    ),
    "an output of another width": (
        r"output of Made is u2, given u4 b; wrap it with \.low\(2\)",
        "def step(self, b: U4) -> tuple[Made, U2]:",
        "    return self, b",
    ),
    "an output without a type": (
        r"step has outputs; annotate its result, e\.g\. -> tuple\[Made, Bit\]",
        "def step(self, b: Bit):",
        "    return self, b",
    ),
    "another bundle": (
        "output of Made is a Drive, not Inputs",
        "def step(self, b: Bit) -> tuple[Made, Drive]:",
        "    return self, Inputs(b, word(0, 2))",
    ),
    "a point named twice": (
        "point 'x' is named twice in one step",
        "def step(self, b: Bit) -> tuple[Made, Bit]:",
        "    return self, point('x', b) & point('x', ~b)",
    ),
    "a point of no term": (
        "point 'x' is given True; a fault acts on a term",
        "def step(self) -> tuple[Made, Bit]:",
        "    return self, point('x', True)",
    ),
    "an assumption twice": (
        "'so' is assumed twice in one step",
        "def step(self, b: Bit, c: Bit) -> Made:",
        "    assume('so', b)",
        "    assume('so', c)",
        "    return self",
    ),
    "an assumption of no bit": (
        r"assume\('so'\) is given <b: u2>",
        "def step(self, b: U2) -> Made:",
        "    assume('so', b)",
        "    return self",
    ),
    "an if": (
        r"b is a bit signal.*select\(\.\.\.\)",
        "def step(self, b: Bit) -> Made:",
        "    return Made() if b else self",
    ),
    "a part of another type": (
        r"Made\(leaf=\.\.\.\) is a Leaf, not",
        "leaf: Leaf",
        "def step(self, i: Inputs) -> Made:",
        "    self.leaf.step(i)",
        "    return Made(leaf=word(0, 4))",
    ),
    "a part left un-stepped": (
        r"part 'leaf' is never stepped; call self\.leaf\.step\(\.\.\.\) or leave it out",
        "leaf: Leaf",
        "def step(self) -> Made:",
        "    return Made(leaf=self.leaf)",
    ),
    "a part returned as it was": (
        r"Made\(leaf=\.\.\.\) is given 'leaf' as it was; return what leaf\.step\(\.\.\.\) gave",
        "leaf: Leaf",
        "def step(self, i: Inputs) -> Made:",
        "    self.leaf.step(i)",
        "    return Made(leaf=self.leaf)",
    ),
    "parts returned crosswise": (
        r"Made\(a=\.\.\.\) is given the part 'b'; return each part as itself",
        "a: Leaf",
        "b: Leaf",
        "def step(self, i: Inputs) -> Made:",
        "    a, b = self.a.step(i)[0], self.b.step(i)[0]",
        "    return Made(a=b, b=a)",
    ),
    "a part stepped twice": (
        "'leaf' is stepped twice in one step",
        "leaf: Leaf",
        "def step(self, i: Inputs) -> Made:",
        "    return Made(leaf=self.leaf.step(i)[0].step(i)[0])",
    ),
    "a part stepped twice from the same registers": (
        "'leaf' is stepped twice in one step",
        "leaf: Leaf",
        "def step(self, i: Inputs) -> Made:",
        "    self.leaf.step(i)",
        "    return Made(leaf=self.leaf.step(i)[0])",
    ),
    "a part made on the spot": (
        "of a Leaf made within a step; a part is a field: `leaf: Leaf`",
        "def step(self, i: Inputs) -> Made:",
        "    Leaf(n=word(3, 4)).step(i)",
        "    return self",
    ),
    "an input of another width in a bundle": (
        r"Leaf\.step\(inputs=\.\.\.\)\.by is u2, given u4 b",
        "leaf: Leaf",
        "def step(self, b: U4) -> Made:",
        "    return Made(leaf=self.leaf.step(Inputs(up=b == 0, by=b))[0])",
    ),
    "a part's output under another thing's name": (
        "output 'leaf' has the name of a register or part",
        "leaf: Leaf",
        "def step(self, i: Inputs) -> tuple[Made, Nest]:",
        "    leaf, full = self.leaf.step(i)",
        "    return Made(leaf=leaf), Nest(leaf=Drive(full, full))",
    ),
}


@pytest.mark.parametrize("name", MISUSE)
def test_misuse_is_told(name: str) -> None:
    says, *body = MISUSE[name]
    clock = 'tick_s="125e-6"' if any("Leaf" in line for line in body) else 'event="tick"'
    with pytest.raises((TypeError, AttributeError), match=says):
        trace(model(*body, head=clock))


@pytest.mark.parametrize(
    ("head", "says"),
    [
        ("event='tick', tick_s=1", "a clock is a period or an event, not both"),
        ("tick_s=0", "tick_s=0 is not a time; write the seconds of a step"),
        ("tick_s='soon'", "tick_s='soon' is not a time"),
        ("tick_s=-1", "is not a time"),
    ],
)
def test_a_clock_is_a_time_or_an_event(head: str, says: str) -> None:
    with pytest.raises(ModelError, match=says):
        model("def step(self) -> Made:", "    return self", head=head)


def test_one_system_has_one_clock() -> None:
    body = ("leaf: Leaf", "def step(self, i: Inputs) -> Made:", "    return Made(leaf=self.leaf.step(i)[0])")
    assert str(trace(model(*body, head="tick_s='1/8000'")).clock) == "every 125 us"
    with pytest.raises(ModelError, match="Made and its parts step at each tick and every 125 us; one system has"):
        trace(model(*body))
    with pytest.raises(ModelError, match=r"Bare has no clock; write class Bare\(Model, tick_s=\.\.\.\)"):
        trace(Bare)


def test_values_are_widened_and_never_cut() -> None:
    body = ("a: U4 = power_up(0)", "r: Real = power_up(0)", "def step(self, b: U2) -> Made:")
    made = trace(model(*body, "    return Made(a=b, r=self.r + b.real())"))
    found = run(made, {"b": 3}, 3)
    assert found["a"] == [0, 3, 3] and found["r"] == [0, 3, 6]
    assert made.state["a"].next.sort == made.state["a"].var.sort


def test_annotations_say_the_sort() -> None:
    step = ("def step(self) -> Made:", "    return self")
    wide = model("a: Annotated[UInt, 8] = power_up(255)", *step)
    assert registers(wide) == registers(model("a: U8 = power_up(255)", *step))

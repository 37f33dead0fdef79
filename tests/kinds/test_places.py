"""Where a fault acts, and what is refused: places that are not there, kinds that do not fit, values without order."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest

from safety.faults import (
    ANY_TIME,
    FROM_START,
    INTERMITTENT,
    TRANSIENT,
    Fault,
    any_active,
    common_cause,
    every,
    instrument,
    placed,
    schedule,
    where,
)
from safety.kinds import (
    Kind,
    Seat,
    bridge,
    byzantine,
    clock_fast,
    clock_glitch,
    clock_slow,
    clock_stop,
    dead,
    delayed,
    drift,
    extra,
    flip,
    frozen,
    intermittent,
    memory_flip,
    missing,
    noise,
    offset,
    oscillating,
    power_dip,
    reads,
    slow_to_operate,
    slow_to_release,
    stuck,
    swapped,
    upset,
    wired_and,
    wired_or,
)
from safety.model import Model, parameter, point, power_up
from safety.system import ModelError, repeat
from safety.terms import U2, Bit
from safety.terms.graph import variables
from safety.terms.values import bit
from safety.trace import run
from safety.tracing import trace
from tests.kinds.by_hand import Cell, Desk


class Limited(Model, event="tick"):
    """A part with a parameter of its own."""

    limit: U2 = parameter(1, unit="pulses", within=(0, 3), source="[A] invented")
    n: U2 = power_up(0)

    def step(self) -> Limited:
        return Limited(n=point("n", (self.n + self.limit).low(2)))


class Chain(Model, event="tick"):
    """Points that depend on each other: b on a, c on b; d on what c was."""

    before: Bit = power_up(False)
    first: Cell
    second: Cell
    limited: Limited

    def step(self, x: Bit, y: Bit) -> Chain:
        a = point("a", x)
        b = point("b", a & y)
        c = point("c", ~b)
        point("d", self.before)
        point("free", x ^ y)
        return Chain(
            before=c,
            first=self.first.step(c.word().widen(2)),
            second=self.second.step(b.word().widen(2)),
            limited=self.limited.step(),
        )


def built(*faults: Fault, model: type[Model] = Chain) -> Any:
    return instrument(trace(model), faults)


def test_a_part_is_the_registers_under_its_name() -> None:
    system = trace(Chain)
    own = ("first.n", "first.kept")
    assert where(system, Fault(clock_stop(), ["first"])) == own
    assert where(system, Fault(clock_stop(), ["first.n"])) == ("first.n",)
    assert where(system, Fault(clock_stop(), ["f*", "first"])) == own
    assert where(system, Fault(clock_stop(), ["Chain"])) == ("before", *own, "second.n", "second.kept", "limited.n")
    cause = common_cause("x", {"first": clock_stop(), "a+d": wired_or(), "c": frozen()})
    assert where(system, cause) == (*own, "a", "d", "c")
    assert [(p.kind.name, p.names) for p in placed(system, cause)] == [
        ("clock stopped", ("first.n", "first.kept")), ("wired-or", ("a", "d")), ("frozen", ("c",)),
    ]  # fmt: skip


def test_parameters_and_registers_of_faults_are_no_part() -> None:
    system = trace(Chain, symbolic=["limit"])
    assert where(system, Fault(power_dip(), ["limited"])) == ("limited.n",)
    faulted = instrument(system, [Fault(clock_stop(), ["Chain"]), Fault(delayed(1), ["limited.n"])])
    (stage,) = (s for s in faulted.system.states if s.path == "fault1.limited.n.stage0")
    assert stage.next is not stage.var


def test_a_fault_of_a_part_lies_under_its_name() -> None:
    faulted = instrument(trace(Chain), [Fault(clock_stop(), ["first"]), Fault(flip(), ["a"])], present=None)
    assert any_active(faulted, "first.") is faulted.active[0]
    assert any_active(faulted, "second.") is bit(False)


# --- points that are joined have an order, or none -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("faults", "path"),
    [
        ([Fault(wired_or(), ["a", "b"])], "b -> a -> b"),
        ([Fault(wired_or(), ["a", "c"])], "c -> a -> b -> c"),
        ([Fault(bridge(1), ["a", "b"])], "b -> a -> b"),
        ([Fault(bridge(0), ["c", "free"]), Fault(swapped(), ["free", "a"])], "c -> a -> b -> c"),
        ([Fault(flip(), ["a"]), Fault(wired_and(), ["b", "c"])], "c -> b -> c"),
    ],
    ids=lambda v: v if isinstance(v, str) else "",
)
def test_points_that_depend_on_each_other_cannot_be_joined(faults: list[Fault], path: str) -> None:
    with pytest.raises(ModelError, match="depend on each other within one step: ") as refused:
        built(*faults)
    shown = str(refused.value).partition("one step: ")[2].partition(";")[0].split(" -> ")
    ring = path.split(" -> ")
    turns = [ring[k:-1] + ring[: k + 1] for k in range(len(ring) - 1)]
    assert shown in turns and "late=True" in str(refused.value)


def test_points_that_depend_one_way_can_be_joined_that_way() -> None:
    """The first drives the second, which is computed from it: b reads a, not a & y."""
    found = run(built(Fault(bridge(0), ["a", "b"])).system, {"x": True, "y": False}, 2)
    assert (found["a"], found["b"], found["c"]) == ([True] * 2, [True] * 2, [False] * 2)
    found = run(built(Fault(wired_or(), ["d", "c"])).system, {"x": False, "y": False}, 3)
    assert (found["c"], found["d"]) == ([True] * 3, [True] * 3)


def test_late_points_meet_the_last_values() -> None:
    """b reads a & y | what a was; a reads x | what b was without the fault."""
    rows = [{"x": k == 1, "y": True} for k in range(5)]
    found = run(built(Fault(wired_or(late=True), ["a", "b"])).system, rows)
    assert found["a"] == [False, True, True, True, True]
    assert found["b"] == [False, True, True, True, True]
    found = run(built(Fault(wired_or(late=True), ["a", "b"])).system, [{"x": k == 1, "y": False} for k in range(5)])
    assert found["a"] == [False, True, False, False, False]
    assert found["b"] == [False, False, True, False, False]


def test_joined_points_that_carry_other_faults_meet_what_is_there_by_then() -> None:
    rows = {"x": False, "y": True}
    before = built(Fault(stuck(1), ["free"]), Fault(wired_and(), ["free", "d"])).system
    after = built(Fault(wired_and(), ["free", "d"]), Fault(stuck(1), ["free"])).system
    assert run(before, rows, 3)["free"] == [False, True, True]  # d: False, then True
    assert run(after, rows, 3)["free"] == [True] * 3 and run(after, rows, 3)["d"] == [False, True, True]


# --- misuse --------------------------------------------------------------------------------------------------------


def fault(kind: Kind, *points: str) -> Callable[[], Any]:
    return lambda: built(Fault(kind, points))


def desk(kind: Kind, *points: str) -> Callable[[], Any]:
    return lambda: built(Fault(kind, points), model=Desk)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        # places
        (fault(clock_stop(), "frist"), r"Chain has no part or register 'frist'; did you mean first or"),
        (fault(clock_stop(), "first.m"), r"no part or register 'first.m'; did you mean first.n"),
        (fault(stuck(0), "limited"), r"no point 'limited'; did you mean limited.n"),
        (desk(clock_stop(), "Desk.cell"), "no part or register 'Desk.cell'; did you mean cell"),
        (fault(bridge(0), "a"), "bridge, first dominant joins 2 points; here are 1: a"),
        (fault(bridge(0), "a", "a"), "joins 2 points; here are 1: a"),
        (fault(bridge(0), "a", "c", "d"), "joins 2 points; here are 3: a, c, d"),
        (fault(wired_or(), "a"), "wired-or joins 2 or more points; here are 1: a"),
        (desk(wired_or(), "wire", "word"), "wired-or joins points of one sort; wire is bit, word is u2"),
        (lambda: every(wired_or(), "*"), r"every\(wired-or, ...\): it acts on points at once"),
        (lambda: every(clock_stop(), "*"), r"it acts on part at once; write Fault\(kind, \[...\]\) for each"),
        (lambda: built(common_cause("x", {"a": stuck(0), "a*": flip()})), "'x' has two kinds at a; leave one to"),
        (lambda: built(common_cause("x", {"a+d": wired_or(), "d": flip()})), "two kinds at d"),
        (lambda: common_cause("x", {}), "common cause 'x': write common_cause"),
        (lambda: common_cause("x", {"a": stuck}), "common cause 'x': write common_cause"),  # type: ignore[dict-item]
        # sorts
        (desk(drift(1), "wire"), "drift by \\+1 a step does not apply to wire, a bit; it is for uint, int, real"),
        (desk(upset(0, 1), "wire"), "does not apply to wire, a bit"),
        (desk(wired_or(), "whole", "real"), r"does not apply to whole, a int\[-3, 3\]; it is for bit, uint"),
        (desk(slow_to_operate(2), "word"), "does not apply to word, a u2; it is for bit"),
        (desk(stuck(1, bit=0), "wire"), "stuck-at-1 bit 0 at a wire: it has no bits to choose from"),
        (desk(flip(bit=2), "word"), "flip bit 2: a point of u2 has bits 0..1, not bit 2"),
        (desk(upset(0, 2), "word"), "upset of bits 0\\+2: a point of u2 has|flip bits 0\\+2: a point of u2 has bits"),
        (desk(reads(4), "word"), "reads 4: 4 is not a value of u2"),
        (desk(reads(Fraction(1, 2)), "whole"), r"is not a value of int\[-3, 3\]"),
        (desk(offset(Fraction(1, 2)), "word"), "off by \\+1/2: a point of u2 is off by whole numbers only"),
        (desk(noise(Fraction(1, 2)), "whole"), "noise of 1/2: a point of int"),
        (desk(memory_flip(bit=2), "cell"), "stored flip bit 2: a point of u2 has bits 0..1"),
        # parameters
        (lambda: stuck(2), r"stuck\(2\): a wire is stuck at 0 or at 1"),
        (lambda: stuck(0, bit=()), "name each bit once"),
        (lambda: flip(bit=(1, 1)), r"bits \(1, 1\): name each bit once"),
        (lambda: flip(bit=1.5), "bits 1.5: name each bit once"),  # type: ignore[arg-type]
        (lambda: upset(3), r"a multi-bit upset names two bits or more; one bit is flip\(bit=3\)"),
        (lambda: upset(), "name each bit once"),
        (lambda: oscillating(0), "a level stays for 1 step or more"),
        (lambda: delayed(0), "a delay is 1 step or more"),
        (lambda: delayed(1.0), "a delay is 1 step or more"),  # type: ignore[arg-type]
        (lambda: slow_to_operate(0), "closes 1 step late or more"),
        (lambda: slow_to_release(-1), "opens 1 step late or more"),
        (lambda: intermittent(stuck(0), 0, 4), "acts for 1 step or more"),
        (lambda: intermittent(stuck(0), 4, 4), r"intermittent\(..., 4, 4\): it acts in 4 of more than 4 steps"),
        (lambda: intermittent(stuck, 1, 4), "the first argument is the kind"),  # type: ignore[arg-type]
        (lambda: missing(0), "at least 1 pulse is lost"),
        (lambda: missing(3, every=3), r"3 pulse\(s\) are lost of more than 3"),
        (lambda: extra(every=1), r"one in each step is stuck\(1\)"),
        (lambda: offset(0), r"offset\(0\): write an offset other than 0"),
        (lambda: drift(0), r"drift\(0\): write a rate other than 0"),
        (lambda: drift(0.5), "write a rate other than 0, a whole number or an exact Fraction"),  # type: ignore[arg-type]
        (lambda: drift(True), "write a rate other than 0"),
        (lambda: noise(0), "write an amplitude above 0"),
        (lambda: noise(-2), "write an amplitude above 0"),
        (lambda: noise(1, seed="x"), "a seed is a whole number"),  # type: ignore[arg-type]
        (lambda: bridge(2), r"bridge\(2\): the dominant line is 0, the first point, or 1"),
        (lambda: bridge(True), "the dominant line is 0"),
        (lambda: clock_slow(1), r"clock_slow\(1\): one step in 2 or more is lost"),
        (lambda: clock_fast(1), "a fast clock takes 2 steps or more in one"),
        (lambda: clock_fast(2, every=0), "in 1 of every 1 steps or more"),
        (lambda: clock_glitch(1), r"clock_glitch\(1\): 0 skips a step, 2 is one step too many"),
        (lambda: Fault(stuck, ["a"]), "that is no fault kind; write e.g. stuck"),  # type: ignore[arg-type]
        (lambda: Fault(flip(), ["a"], ANY_TIME, at=1.5), "1.5 is no whole number"),  # type: ignore[arg-type]
        (lambda: Kind("none", ""), "kind 'none': give it one of effect, joint, update and members"),
        (lambda: Kind("two", "", lambda _, h: h, joint=lambda _, h: h), "kind 'two': give it one of"),
        (lambda: Seat("s", bit(True)).then(bit(True), bit(True)), "s has no register"),
        (desk(Kind("wider", "", lambda _, h: h + 1), "word"), "the effect gives u3 at word, a u2"),  # type: ignore
        (desk(Kind("short", "", joint=lambda _, h: h[:1]), "wire", "line"), "the effect gives None at line, a bit"),
        # values
        (lambda: schedule(built(Fault(noise(1), ["word"], values={"byte": [1]}), model=Desk)), "has values for 'byte'"),
        (lambda: schedule(built(Fault(power_dip(), ["cell"], values={"cell.n": [1]}), model=Desk)),
         "has values for 'cell.n', where it chooses none"),
    ],
)  # fmt: skip
def test_misuse_is_told(make: Callable[[], Any], says: str) -> None:
    with pytest.raises(ModelError, match=says):
        make()


def test_a_part_without_registers_has_nothing_to_stop() -> None:
    class Wire(Model, event="tick"):
        """Passes a wire on."""

        def step(self, w: Bit) -> tuple[Wire, Bit]:
            return Wire(), point("w", w)

    class Two(Model, event="tick"):
        """A wire and a register."""

        n: Bit = power_up(False)
        wire: Wire

        def step(self, w: Bit) -> Two:
            wire, out = self.wire.step(w)
            return Two(n=out, wire=wire)

    with pytest.raises(ModelError, match="'wire' of Two has no register: nothing for such a fault to act on"):
        built(Fault(clock_stop(), ["wire"]), model=Two)


def test_a_kind_of_several_points_has_no_effect_at_one() -> None:
    for kind in (wired_or(), clock_stop(), common_cause("x", {"a": dead()}).kind):
        with pytest.raises(ModelError, match="acts on more than one point: build it into the system"):
            kind.effect(Seat("seat", bit(True)), bit(True))


def test_steps_taken_as_one_are_refused_where_the_fault_has_a_course_of_its_own() -> None:
    twice = repeat(trace(Limited), 2)
    for kind in (frozen(), byzantine(), drift(1), intermittent(flip(), 1, 2)):
        with pytest.raises(ModelError, match="several steps taken as one; build its fault in before"):
            instrument(twice, [Fault(kind, ["n"])])
    assert run(instrument(twice, [Fault(stuck(1, bit=0), ["n"])]).system, (), 2)["n"] == [0, 3]


def test_windows() -> None:
    assert Fault(flip(), ["a"]).window() == (0, None)
    assert Fault(flip(), ["a"], ANY_TIME, at=3).window() == (3, None)
    assert Fault(flip(), ["a"], TRANSIENT, at=3, ticks=2).window() == (3, 5)
    assert Fault(flip(), ["a"], INTERMITTENT, at=3).window() == (3, None)
    one = Fault(flip(), ["a"], INTERMITTENT, at=3, ticks=2)
    assert [k for k in range(9) if one.acts(k)] == [3, 4]
    assert Fault(flip(), ["a"], FROM_START).acts(0)


def test_nothing_of_the_instrument_is_left_in_the_system() -> None:
    """The placeholders of healthy values are gone from every term, those of the faults' own registers among them."""
    kinds = [frozen(), delayed(2), wired_or(late=True)]
    faulted = built(Fault(kinds[0], ["a"]), Fault(kinds[1], ["a", "b"]), Fault(kinds[2], ["b", "d"]))
    known = {s.var.uid for s in faulted.system.states} | {v.uid for v in faulted.system.inputs.values()}
    assert {v.uid for v in variables(faulted.system.roots())} <= known

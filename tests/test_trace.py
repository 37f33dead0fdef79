"""Runs and what they leave: tables, JSON and value change dumps that an independent reader gets back."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from fractions import Fraction
from typing import Annotated, Any, NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety.model import ANY, Model, assume, point, power_up
from safety.system import ModelError, System
from safety.terms import U3, U4, Bit, Int, Real, select
from safety.trace import Live, Trace, run, show
from safety.tracing import trace


class Shown(NamedTuple):
    lit: Bit
    level: Annotated[Int, (-3, 4)]


class Part(Model, tick_s="125e-6"):
    """Holds a real and a number below zero."""

    r: Real = power_up(Fraction(1, 3))
    n: Annotated[Int, (-3, 4)] = power_up(ANY)

    def step(self, up: Bit) -> tuple[Part, Shown]:
        n = select(up, self.n + 1, self.n - 1).clip(-3, 4)
        assume("not at the top", ~(up & (self.n == 4)))
        return Part(r=self.r / 2, n=point("n", n)), Shown(lit=point("lit", n > 0), level=n)


class Whole(Model):
    """A part and a counter."""

    part: Part
    count: U4 = power_up(14)

    def step(self, up: Bit, by: U3) -> tuple[Whole, Bit]:
        part, shown = self.part.step(up)
        return Whole(part=part, count=(self.count + by).low(4)), ~shown.lit


ROWS = [{"up": k % 3 != 0, "by": k} for k in range(6)]


# --- runs ----------------------------------------------------------------------------------------------------------


def test_registers_are_those_before_the_step_and_outputs_those_of_it() -> None:
    found = run(Whole, ROWS, start={"part.n": -1})
    assert found["part.n"] == [-1, -2, -1, 0, -1, 0]
    assert found["part.level"] == [-2, -1, 0, -1, 0, 1]
    assert found["out"] == [True] * 5 + [False]
    assert found["count"] == [14, 14, 15, 1, 4, 8]
    assert found["part.r"] == [Fraction(1, 3 * 2**k) for k in range(6)]
    assert (len(found), found.steps, found.chosen) == (6, 6, {"part.n": -1})
    assert found.row(1) == {p: v[1] for p, v in found.columns.items()}


def test_inputs_may_be_rows_one_row_or_a_function() -> None:
    rows = run(Part, [{"up": True}] * 4)
    assert rows.columns == run(Part, {"up": True}, 4).columns == run(Part, lambda k: {"up": True}, 4).columns
    assert run(Part, iter([{"up": True}] * 9), 4).columns == rows.columns
    assert rows["n"] == [-3, -2, -1, 0]  # ANY is the least where nothing is said


def test_a_row_that_is_changed_in_place_is_read_anew() -> None:
    def rows() -> Any:
        row: dict[str, Any] = {"up": True, "by": 0}
        for k in range(5):
            row["by"] = k
            yield row

    assert run(Whole, rows())["by"] == [0, 1, 2, 3, 4]
    with pytest.raises(ModelError, match="step 1: input up is bit: 1 is not a value of it"):
        shared: dict[str, Any] = {"up": True, "by": 0}
        run(Whole, lambda k: shared | {"up": k < 1 or 1}, 3)


def test_only_what_is_wanted_is_kept() -> None:
    found = run(Whole, ROWS, keep=["out", "count"])
    assert list(found.columns) == ["out", "count"] and found["count"] == run(Whole, ROWS)["count"]
    with pytest.raises(ModelError, match=r"Whole has no signal 'part\.n'; there is count, out"):
        found["part.n"]


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: run(Whole, [{"up": True}]), "step 0 of Whole lacks the input by"),
        (lambda: run(Whole, [{"up": True, "by": 0}, {"up": True}]), "step 1 of Whole lacks the input by"),
        (lambda: run(Whole, [{"up": True, "by": 0, "pu": 1}]), r"Whole has no input 'pu' \(step 0\); did you mean up"),
        (lambda: run(Whole, [{"up": True, "by": 8}]), "step 0: input by is u3: 8 is not a value of it"),
        (lambda: run(Whole, [{"up": 1, "by": 0}]), "step 0: input up is bit: 1 is not a value of it"),
        (lambda: run(Whole, {"up": True, "by": 0}), r"say how many steps to run: run\(\.\.\., steps=n\)"),
        (lambda: run(Whole, lambda k: {}), "say how many steps to run"),
        (lambda: run(Whole), "say how many steps to run"),
        (
            lambda: run(Whole, ROWS, start={"part.m": 0}),
            "Whole has no register 'part.m'; did you mean part.r or part.n",
        ),
        (
            lambda: run(Whole, ROWS, start={"count": 3}),
            "count is 14 at power-up, not 3: only registers declared ANY can be set",
        ),
        (lambda: run(Whole, ROWS, start={"part.n": 5}), r"part\.n is int\[-3, 4\]: 5 is not a value of it"),
        (lambda: run(Whole, ROWS, keep=["coutn"]), "Whole has no signal 'coutn'; did you mean count"),
        (
            lambda: run(Part, {"up": True}, 9),
            "step 7 of Part breaks the assumption 'not at the top': choose inputs that keep it",
        ),
    ],
)
def test_misuse_is_told(call: Any, says: str) -> None:
    with pytest.raises(ModelError, match=says):
        call()


# --- tables and JSON -----------------------------------------------------------------------------------------------


def test_a_table_has_a_line_for_each_change() -> None:
    found = run(Whole, {"up": False, "by": 0}, 9, start={"part.n": -1})
    assert found.table(["part.n", "out", "count"]) == (
        "step  part.n  out  count\n"
        "   0      -1    1     14\n"
        "   1      -2    .      .\n"
        "   2      -3    .      ."
    )  # fmt: skip
    assert found.table(["part.n"], first=1, last=1) == "step  part.n\n   1      -2"
    with pytest.raises(ModelError, match="has no signal 'uot'; did you mean out"):
        found.table(["uot"])


def test_json_gives_the_changes_of_each_signal() -> None:
    found = run(Whole, ROWS, start={"part.n": -1}).to_json(["out", "part.r", "count"])
    assert found["steps"] == 6 and found["tick_s"] == "1/8000"
    assert found["signals"] == [
        {"path": "out", "kind": "bit", "unit": "", "changes": [[0, True], [5, False]]},
        {
            "path": "part.r",
            "kind": "number",
            "unit": "",
            "changes": [[k, str(Fraction(1, 3 * 2**k))] for k in range(6)],
        },
        {"path": "count", "kind": "number", "unit": "", "changes": [[0, 14], [2, 15], [3, 1], [4, 4], [5, 8]]},
    ]
    assert json.loads(json.dumps(found)) == found


def test_a_value_is_short() -> None:
    assert [show(v) for v in (True, False, 7, Fraction(1, 3))] == ["1", "0", "7", "1/3"]


# --- value change dumps --------------------------------------------------------------------------------------------


class Dump(NamedTuple):
    """A value change dump as read back: seconds a unit, kind and bits of each signal, values at each time."""

    unit: Fraction
    signals: dict[str, tuple[str, int]]
    times: list[int]
    columns: dict[str, list[str]]


def read(text: str) -> Dump:
    """A small reader of IEEE 1364 value change dumps, written from the standard."""
    header, body = text.split("$enddefinitions $end")
    tokens = header.split()
    unit, paths, scope, signals = Fraction(0), {}, [], {}
    while tokens:
        end = tokens.index("$end")
        section, tokens = tokens[:end], tokens[end + 1 :]
        match section:
            case ["$timescale", number, scale]:
                exponent = {"s": 0, "ms": 3, "us": 6, "ns": 9, "ps": 12, "fs": 15}[scale]
                unit = Fraction(int(number), 10**exponent)
            case ["$scope", "module", name]:
                scope.append(name)
            case ["$upscope"]:
                scope.pop()
            case ["$var", kind, bits, code, name]:
                path = ".".join([*scope[1:], name])
                assert code not in paths and path not in signals
                paths[code], signals[path] = path, (kind, int(bits))
            case [head, *_]:
                assert head in ("$version", "$comment")
    assert not scope
    now, times, columns = {}, [], {path: [] for path in signals}
    for line in body.split("\n"):
        if line.startswith("#"):
            if times:
                for path, values in columns.items():
                    values.append(now[path])
            times.append(int(line[1:]))
        elif found := re.fullmatch(r"([01])(\S+)|[br](\S+) (\S+)", line):
            code = found[2] or found[4]
            now[paths[code]] = found[1] or found[3]
        else:
            assert not line
    return Dump(unit, signals, times, columns)


def value(system: System, path: str, kind: str, bits: int, text: str) -> Any:
    """A value as it was, of a text in the dump."""
    if kind == "real":
        return float(text)
    number = int(text, 2)
    assert number < 1 << bits
    sort = system.lookup(path).sort
    if sort.kind == "bit":
        return bool(number)
    return number - (1 << bits) if sort.bounds[0] < 0 and number >> (bits - 1) else number


def at_every_step(found: Trace, dump: Dump) -> dict[str, list[Any]]:
    """The columns of a dump, a value a step: between its times nothing changes."""
    scale = dump.times[-1] // found.steps
    assert all(t % scale == 0 for t in dump.times) and dump.times == sorted(set(dump.times))
    spans = [(b - a) // scale for a, b in zip(dump.times, dump.times[1:], strict=False)]
    columns = {}
    for path, texts in dump.columns.items():
        kind, bits = dump.signals[path]
        values = [value(found.system, path, kind, bits, text) for text in texts]
        columns[path] = [v for v, span in zip(values, spans, strict=True) for _ in range(span)]
    return columns


@given(st.lists(st.tuples(st.booleans(), st.integers(0, 7)), min_size=1, max_size=12), st.integers(-3, 3))
def test_a_dump_is_read_back_as_it_was(inputs: list[tuple[bool, int]], start: int) -> None:
    free = replace(trace(Whole), assumptions={})
    found = run(free, [{"up": up, "by": by} for up, by in inputs], start={"part.n": start})
    dump = read(found.vcd())
    back = at_every_step(found, dump)
    assert set(back) == set(found.columns)
    for path, column in found.columns.items():
        assert back[path] == [float(v) if isinstance(v, Fraction) else v for v in column]
    assert dump.unit == Fraction(1, 10**6) and dump.times[-1] == 125 * len(inputs)
    assert dump.signals["part.n"] == ("wire", 4) and dump.signals["count"] == ("wire", 4)
    assert dump.signals["part.r"] == ("real", 64) and dump.signals["out"] == ("wire", 1)


class Beat(Model, tick_s="3.90625e-6"):
    """A bit time that is no whole number of nanoseconds."""

    on: Bit = power_up(False)

    def step(self) -> Beat:
        return type(self)(on=~self.on)


class Edge(Beat, event="edge"):
    """The same at each edge."""


class Third(Beat, tick_s="1/3"):
    """A third of a second, which no unit of time divides."""


def test_the_time_in_a_dump_is_the_time_of_the_clock() -> None:
    beat, edge, third = (read(run(m, (), 4).vcd()) for m in (Beat, Edge, Third))
    assert beat.unit * beat.times[-1] == 4 * Fraction("3.90625e-6") and beat.unit == Fraction(1, 10**12)
    assert edge.times[-1] == 4
    assert third.unit == Fraction(1, 10**9) and third.times[-1] == 1_333_333_333
    assert "one step is about 333333333.333 x 1 ns" in run(Third, (), 1).vcd()
    assert "at each edge" in run(Edge, (), 1).vcd()


def test_many_signals_have_codes_of_their_own() -> None:
    class Leaf(Model, event="tick"):
        """Two wires."""

        a: Bit = power_up(False)
        b_a: Bit = power_up(True)

        def step(self) -> Leaf:
            return Leaf(a=self.b_a, b_a=self.a)

    class Twig(Model, event="tick"):
        """Leaves whose names look alike once the dots are gone."""

        a: Leaf
        a_b: Leaf

        def step(self) -> Twig:
            return Twig(a=self.a.step(), a_b=self.a_b.step())

    body = "".join(f"    t{i}: Twig\n" for i in range(30))
    steps = ", ".join(f"t{i}=self.t{i}.step()" for i in range(30))
    space: dict[str, Any] = {"Model": Model, "Twig": Twig}
    exec(
        f"class Tree(Model, event='tick'):\n    'Many.'\n{body}    def step(self):\n        return Tree({steps})\n",
        space,
    )
    found = run(space["Tree"], (), 3)
    assert len(found.columns) == 120
    assert at_every_step(found, read(found.vcd())) == found.columns


def test_an_empty_run_can_be_shown() -> None:
    found = run(Part, {"up": True}, 0)
    assert len(found) == 0 and found.table(["n"]) == "step  n" and found.to_json(["n"])["signals"][0]["changes"] == []
    assert read(found.vcd()).times == [0]


def test_a_run_step_by_step_is_the_run_of_its_rows_and_may_follow_the_registers() -> None:
    whole, live = run(Whole, ROWS, start={"part.n": -1}), Live(Whole, start={"part.n": -1})
    assert [live.shown(row) for row in ROWS] == [whole.row(k) for k in range(len(ROWS))]
    assert (live.count, live.chosen) == (6, {"part.n": -1})
    closed = Live(Part, keep=["n"])
    for _ in range(12):
        closed.step({"up": closed.state["n"] < 3})  # held below the top, where the assumption would break
    assert closed.state["n"] == 3 and closed.state["r"] == Fraction(1, 3 * 2**12)
    closed.step({"up": True})
    with pytest.raises(ModelError, match="step 13 of Part breaks the assumption 'not at the top'"):
        closed.step({"up": True})
    with pytest.raises(ModelError):
        closed.step({"down": True})

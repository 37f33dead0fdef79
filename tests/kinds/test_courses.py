"""Each kind over twenty steps, worked out by hand: what goes in above, what is seen below."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import pytest

from safety.faults import ANY_TIME, INTERMITTENT, TRANSIENT, Fault, common_cause, instrument, schedule
from safety.kinds import (
    bridge,
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
    open_circuit,
    oscillating,
    power_dip,
    reads,
    slow_to_operate,
    slow_to_release,
    stuck,
    swapped,
    upset,
    welded,
    wired_and,
    wired_or,
)
from safety.model import Model, point, power_up
from safety.system import ANY
from safety.terms import U2, U8, Bit, Int, Real
from safety.trace import Trace, run
from safety.tracing import trace
from tests.kinds.by_hand import IDLE, Desk

THIRD = Fraction(1, 3)


def shown(model: type[Model], faults: Sequence[Fault], rows: Sequence[dict[str, Any]], **start: Any) -> Trace:
    faulted = instrument(trace(model), faults)
    choose = schedule(faulted)
    return run(faulted.system, lambda k: rows[k] | choose(k), len(rows), start=start)


def text(values: Sequence[bool]) -> str:
    return "".join(str(int(v)) for v in values)


@pytest.mark.parametrize(
    ("fault", "seen"),
    [
        (None, "01101110001011110000"),
        (Fault(stuck(0), ["wire"], ANY_TIME, at=4), "01100000000000000000"),
        (Fault(stuck(1), ["wire"], TRANSIENT, at=7, ticks=3), "01101111111011110000"),
        (Fault(flip(), ["wire"], TRANSIENT, at=12, ticks=1), "01101110001001110000"),
        (Fault(open_circuit(), ["wire"], INTERMITTENT, at=1, ticks=2), "00001110001011110000"),
        (Fault(welded(), ["wire"], ANY_TIME, at=16), "01101110001011111111"),
        (Fault(reads(True), ["wire"], TRANSIENT, at=0, ticks=4), "11111110001011110000"),
        (Fault(reads(1), ["wire"], TRANSIENT, at=0, ticks=4), "11111110001011110000"),
        (Fault(dead(), ["wire"], ANY_TIME, at=13), "01101110001010000000"),
        (Fault(oscillating(), ["wire"], ANY_TIME, at=10), "01101110001010101010"),
        (Fault(oscillating(3), ["wire"], TRANSIENT, at=5, ticks=10), "01101111000111010000"),
        (Fault(frozen(), ["wire"], TRANSIENT, at=7, ticks=6), "01101111111111110000"),
        (Fault(delayed(3), ["wire"]), "00001101110001011110"),
        (Fault(slow_to_operate(1), ["wire"]), "00100110000001110000"),
        (Fault(slow_to_operate(3), ["wire"]), "00000000000000010000"),
        (Fault(slow_to_operate(1), ["wire"], ANY_TIME, at=12), "01101110001001110000"),
        (Fault(slow_to_release(1), ["wire"]), "01111111001111111000"),
        (Fault(slow_to_release(2), ["wire"], ANY_TIME, at=9), "01101110001111111100"),
        (Fault(intermittent(stuck(1), 1, 4), ["wire"], ANY_TIME, at=8), "01101110101011111000"),
        (Fault(intermittent(flip(), 2, 3), ["wire"], TRANSIENT, at=3, ticks=5), "01110101001011110000"),
        (Fault(missing(2), ["wire"], ANY_TIME, at=4), "01100010001011110000"),
        (Fault(missing(every=3), ["wire"]), "01100110000011010000"),
        (Fault(missing(2, every=3), ["wire"], ANY_TIME, at=6), "01101100000010010000"),
        (Fault(extra(), ["wire"], ANY_TIME, at=8), "01101110101011110000"),
        (Fault(extra(every=4), ["wire"], ANY_TIME, at=8), "01101110101011111000"),
    ],
    ids=str,
)
def test_a_wire(fault: Fault | None, seen: str) -> None:
    rows = [IDLE | {"w": v == "1"} for v in "01101110001011110000"]
    assert text(shown(Desk, [fault] if fault else [], rows)["wire"]) == seen


class Scale(Model, event="tick"):
    """A reading of each sort of number."""

    def step(self, x: U8, r: Real) -> tuple[Scale, Int]:
        point("word", x), point("real", r)
        return Scale(), point("whole", (x.int() - 100).clip(-100, 155))


def readings(fault: Fault, values: Sequence[int], name: str = "word") -> list[Any]:
    """What is seen where `values` go in as the word, as a real, and less 100 as the whole number."""
    return shown(Scale, [fault], [{"x": v, "r": v} for v in values])[name]


RAMP = [*range(0, 200, 10)]


def test_a_word() -> None:
    assert readings(Fault(offset(-25), ["word"]), RAMP) == [0, 0, 0, *range(5, 166, 10)]
    assert readings(Fault(offset(80), ["word"]), RAMP) == [*range(80, 251, 10), 255, 255]
    rising = [0, 10, 20, 30, 40, 52, 64, 76, 88, 100, 112, 124, 136, 148, 160, 172, 184, 196, 208, 220]
    assert readings(Fault(drift(2), ["word"], ANY_TIME, at=5), RAMP) == rising
    assert readings(Fault(drift(30), ["word"], TRANSIENT, at=2, ticks=4), [200] * 8) == [
        200, 200, 230, 255, 255, 255, 200, 200,
    ]  # fmt: skip
    assert readings(Fault(drift(-7), ["word"]), [20] * 5) == [13, 6, 0, 0, 0]
    falling = [100, 100, 99, 99, 99, 98, 98, 98, 97, 97, 97, 96, 96, 96, 95, 95, 95, 94, 94, 94]
    assert readings(Fault(drift(-THIRD), ["word"]), [100] * 20) == falling
    assert readings(Fault(upset(0, 1, 2), ["word"], TRANSIENT, at=2, ticks=2), RAMP[:6]) == [0, 10, 19, 25, 40, 50]
    assert readings(Fault(stuck(1, bit=(0, 7)), ["word"]), [0, 2, 129, 255]) == [129, 131, 129, 255]
    assert readings(Fault(reads(77), ["word"], ANY_TIME, at=18), RAMP) == [*RAMP[:18], 77, 77]
    assert readings(Fault(frozen(), ["word"], TRANSIENT, at=3, ticks=3), RAMP[:8]) == [0, 10, 20, 20, 20, 20, 60, 70]
    assert readings(Fault(delayed(2), ["word"], ANY_TIME, at=4), RAMP[:8]) == [0, 10, 20, 30, 20, 30, 40, 50]
    for again in (INTERMITTENT, TRANSIENT):  # a drift starts anew with each onset
        assert readings(Fault(drift(1), ["word"], again, at=1, ticks=3), [50] * 6) == [50, 51, 52, 53, 50, 50]


def test_a_whole_number_and_a_real() -> None:
    assert readings(Fault(offset(-150), ["whole"]), [100, 60, 250], "whole") == [-100, -100, 0]
    assert readings(Fault(drift(20), ["whole"]), [200] * 5, "whole") == [120, 140, 155, 155, 155]
    assert readings(Fault(dead(), ["whole"]), [7, 8], "whole") == [0, 0]
    assert readings(Fault(reads(-3), ["whole"]), [7, 8], "whole") == [-3, -3]
    assert readings(Fault(offset(THIRD), ["real"]), [1, 2], "real") == [1 + THIRD, 2 + THIRD]
    assert readings(Fault(drift(-THIRD), ["real"], ANY_TIME, at=1), [0] * 5, "real") == [
        0, -THIRD, -2 * THIRD, -1, -4 * THIRD,
    ]  # fmt: skip


def test_noise_is_bounded_repeatable_and_differs_by_seed_and_point() -> None:
    fault = Fault(noise(5), ["word", "whole"])
    first, second = readings(fault, [100] * 200), readings(fault, [100] * 200, "whole")
    assert first == readings(fault, [100] * 200) != readings(Fault(noise(5, seed=1), ["word"]), [100] * 200)
    assert {*first} == {*range(95, 106)} and {*second} == {*range(-5, 6)}
    assert [v - 100 for v in first] != second
    assert {*readings(Fault(noise(5), ["word"]), [254] * 99)} == {*range(249, 256)}
    real = readings(Fault(noise(THIRD), ["real"]), [0] * 99, "real")
    assert min(real) < -THIRD * 9 / 10 and max(real) > THIRD * 9 / 10 and all(abs(v) <= THIRD for v in real)
    given = Fault(noise(5), ["word"], ANY_TIME, at=1, values={"word": [1, 2, -3]})
    assert readings(given, [9] * 5) == [9, 11, 6, 6, 6]
    beyond = Fault(noise(THIRD), ["real"], values={"real": [-1, 1]})  # a choice out of bounds stays at the bound
    assert readings(beyond, [0] * 2, "real") == [-THIRD, THIRD]


@pytest.mark.parametrize(
    ("fault", "wire", "line"),
    [
        (None, "01010101010101010101", "00110011001100110011"),
        (Fault(wired_and(), ["wire", "line"]), "00010001000100010001", "00010001000100010001"),
        (Fault(wired_or(), ["wire", "line"], ANY_TIME, at=16), "01010101010101010111", "00110011001100110111"),
        (Fault(wired_or(late=True), ["wire", "line"]), "01011101110111011101", "00111011101110111011"),
        (Fault(bridge(0), ["wire", "line"]), "01010101010101010101", "01010101010101010101"),
        (Fault(bridge(1), ["wire", "line"]), "00110011001100110011", "00110011001100110011"),
        (Fault(bridge(), ["wire", "line"], TRANSIENT, at=2, ticks=8), "01010101010101010101", "00010101011100110011"),
        (Fault(swapped(), ["line", "wire"], ANY_TIME, at=8), "01010101001100110011", "00110011010101010101"),
        (Fault(swapped(late=True), ["wire", "line"]), "00011001100110011001", "00101010101010101010"),
        (Fault(intermittent(wired_or(), 1, 4), ["wire", "line"], ANY_TIME, at=1), "01010101010101010101",
         "01110111011101110111"),
        (Fault(bridge(), ["wire", "line"], values={"wire": [False] * 16 + [True]}), "01010101010101010011",
         "01010101010101010011"),
    ],
    ids=str,
)  # fmt: skip
def test_two_wires(fault: Fault | None, wire: str, line: str) -> None:
    rows = [IDLE | {"w": k % 2 == 1, "v": k % 4 > 1} for k in range(20)]
    found = shown(Desk, [fault] if fault else [], rows)
    assert (text(found["wire"]), text(found["line"])) == (wire, line)


def test_lines_of_words() -> None:
    def seen(fault: Fault) -> tuple[int, int]:
        found = shown(Desk, [fault], [IDLE | {"x": 1, "y": 2}])
        return found["word"][0], found["byte"][0]

    assert seen(Fault(wired_or(), ["word", "byte"])) == (3, 3)
    assert seen(Fault(wired_and(), ["word", "byte"])) == (0, 0)
    assert seen(Fault(swapped(), ["word", "byte"])) == (2, 1)
    assert seen(Fault(bridge(), ["word", "byte"], values={"word": [2]})) == (3, 3)


@pytest.mark.parametrize(
    ("faults", "course"),
    [
        ([], "12301230123012301230"),
        ([Fault(clock_stop(), ["cell"], TRANSIENT, at=5, ticks=5)], "12301222222301230123"),
        ([Fault(clock_slow(3), ["cell"], ANY_TIME, at=2)], "12301123301123301123"),
        ([Fault(clock_fast(), ["cell"], ANY_TIME, at=10)], "12301230123131313131"),
        ([Fault(clock_fast(every=3), ["cell"])], "12312312312312312312"),
        ([Fault(clock_glitch(), ["cell"], ANY_TIME, at=6)], "12301231230123012301"),
        ([Fault(clock_glitch(0), ["cell"], ANY_TIME, at=6)], "12301233012301230123"),
        ([Fault(power_dip(), ["cell"], TRANSIENT, at=6, ticks=3)], "12301231112301230123"),
        ([Fault(memory_flip(bit=1), ["cell.n"], TRANSIENT, at=6, ticks=1)], "12301232301230123012"),
        ([Fault(clock_stop(), ["Desk"], ANY_TIME, at=17)], "12301230123012301222"),
        ([Fault(intermittent(clock_stop(), 1, 2), ["cell"])], "11223300112233001122"),
        # what comes later in the list acts on what is there already
        ([Fault(clock_stop(), ["cell"]), Fault(power_dip(), ["cell"], ANY_TIME, at=9)], "1" * 20),
        ([Fault(power_dip(), ["cell"], ANY_TIME, at=9), Fault(clock_stop(), ["cell"], ANY_TIME, at=6)],
         "12301233333333333333"),
        ([Fault(clock_fast(2), ["cell"]), Fault(clock_fast(3), ["cell"])], "1313" * 5),
    ],
    ids=lambda v: ", ".join(map(str, v)) if isinstance(v, list) else "",
)  # fmt: skip
def test_a_counter(faults: list[Fault], course: str) -> None:
    found = shown(Desk, faults, [IDLE | {"add": 1}] * 20)
    assert "".join(map(str, found["cell.n"])) == course


def test_a_register_that_powers_up_with_any_value_takes_any_at_a_restart() -> None:
    dip = Fault(power_dip(), ["cell"], TRANSIENT, at=3, ticks=2, values={"cell.kept": [0, 0, 0, 3, 1]})
    found = shown(Desk, [dip], [IDLE] * 8, **{"cell.kept": 2})
    assert found["cell.kept"] == [2, 2, 2, 2, 3, 1, 1, 1]
    unsaid = shown(Desk, [Fault(power_dip(), ["cell"], TRANSIENT, at=3, ticks=2)], [IDLE] * 8, **{"cell.kept": 2})
    assert unsaid["cell.kept"] == [2, 2, 2, 2, 0, 0, 0, 0]


def test_a_common_cause_acts_everywhere_at_once() -> None:
    cause = common_cause(
        "lightning", {"cell": power_dip(), "wire": stuck(0), "word+byte": wired_or(), "real": drift(THIRD)},
        onset=TRANSIENT, at=2, ticks=2,
    )  # fmt: skip
    rows = [IDLE | {"w": True, "x": 1, "y": 2, "add": 1}] * 6
    found = shown(Desk, [cause], rows)
    assert text(found["wire"]) == "110011"
    assert found["word"] == [1, 1, 3, 3, 1, 1] and found["byte"] == [2, 2, 3, 3, 2, 2]
    assert found["cell.n"] == [1, 2, 3, 1, 1, 2]
    assert found["real"] == [0, 0, THIRD, 2 * THIRD, 0, 0]


class Ring(Model, event="tick"):
    """A part with a point between its register and its next value, and a register that counts what it shows."""

    x: U2 = power_up(1)
    total: U8 = power_up(0)
    odd: Bit = power_up(ANY)

    def step(self) -> Ring:
        following = point("sum", (self.x + 1).low(2))
        return Ring(x=following, total=(self.total + following).low(8), odd=following.bit(0))


def test_a_fast_clock_takes_the_faults_of_its_points_along() -> None:
    def course(*faults: Fault) -> list[int]:
        return shown(Ring, faults, [{}] * 5)["x"]

    fast, bit = Fault(clock_fast(), ["x"]), Fault(stuck(1, bit=0), ["sum"])
    assert course(fast) == [1, 3, 1, 3, 1]
    assert course(bit) == [1, 3, 1, 3, 1]  # 1 -> 2|1, 3 -> 0|1
    assert course(fast, bit) == course(bit, fast) == [1, 1, 1, 1, 1]  # 1 -> 3 -> 1
    late = Fault(delayed(1), ["sum"])  # what the fault remembers is of whole steps
    assert course(fast, late) == [1, 0, 2, 1, 3]
    assert shown(Ring, [fast], [{}] * 5)["total"] == [0, 2, 2, 4, 4]  # it sees the first of the two steps: 2, 0, 2, 0
    assert shown(Ring, [Fault(clock_fast(), ["Ring"])], [{}] * 3)["total"] == [0, 5, 6]  # 2 + 3, 0 + 1

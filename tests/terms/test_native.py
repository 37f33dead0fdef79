"""The native column on every kind of processor, and wrong instructions in it, each of which shows as a wrong value."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from safety.terms import TermError
from safety.terms.direct import evaluate
from safety.terms.graph import REAL, uint, variable
from safety.terms.native import compile_native
from safety.terms.table import OPERATIONS
from tests.terms.agreement import NATIVE, check, compiled, native, targets
from tests.terms.graphs import EDGES, edge_graphs, graphs
from tests.terms.test_readings_agree import examples, on

WORDS = targets()
TARGETS = WORDS | {f"{name} in slices": target.in_slices() for name, target in WORDS.items()}


@pytest.fixture(params=TARGETS)
def processor(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """The native reading is that of this kind of processor."""
    monkeypatch.setitem(NATIVE, "native", native(TARGETS[request.param]))
    monkeypatch.setattr("tests.terms.agreement.READINGS", NATIVE)
    return str(request.param)


@examples(20, 2_000)
def test_native_reading_agrees(processor: str, examples: int) -> None:
    on(examples, graphs(), lambda graph: check("native", *graph))


@pytest.mark.parametrize("operation", EDGES)
def test_native_reading_agrees_on_the_edges_of(processor: str, operation: str) -> None:
    for outputs, rows in edge_graphs(operation):
        check("native", outputs, rows)


@pytest.mark.parametrize("number", [1, 15, 16, 17, 64, 65, 200, 511, 512, 513, 1200])
def test_any_number_of_lanes(processor: str, number: int) -> None:
    x: Any = variable("x", uint(8))
    values = np.arange(number) % 251
    (found,) = compiled([x], [(x + 7).low(8)], TARGETS[processor])(values)
    assert found.tolist() == ((values + 7) % 256).tolist()


def test_a_real_is_refused() -> None:
    x: Any = variable("x", REAL)
    with pytest.raises(TermError, match="x is a real: it has no native reading; use lanes"):
        compile_native([x], [x < 1])


def test_a_wide_number_is_refused() -> None:
    x: Any = variable("x", uint(64))
    with pytest.raises(TermError, match=r"is u65, more than the 64 bits of a native word; use lanes"):
        compile_native([x], [(x + 1).bit(64)])


def test_a_variable_that_is_not_bound_is_refused() -> None:
    with pytest.raises(TermError, match="y is read but not bound"):
        compile_native([variable("x", uint(8))], [variable("y", uint(8))])


# --- wrong instructions ----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Slip:
    """In the entry of a row one instruction stands for another, so that the text is still sound LLVM."""

    row: str
    right: str
    wrong: str

    def __str__(self) -> str:
        return f"{self.row}: {self.wrong or 'nothing'} for {self.right}"


EXTENSIONS = (("zext", "sext"), ("sext", "zext"))
SLIPS = [
    *(Slip(row, *pair) for row in ("add", "sub", "mul", "eq", "lt", "le", "clip") for pair in EXTENSIONS),
    *(Slip(row, "zext", "sext") for row in ("cast", "concat")),
    *(Slip(row, "sext", "zext") for row in ("cast", "slice")),
    *(Slip("add", "add ", wrong) for wrong in ("sub ", "or ", "xor ")),
    *(Slip("sub", "sub ", wrong) for wrong in ("add ", "xor ")),
    *(Slip("mul", "mul ", wrong) for wrong in ("add ", "and ")),
    *(Slip("eq", "icmp eq", f"icmp {wrong}") for wrong in ("ne", "uge", "ule")),
    *(Slip("lt", "icmp ult", f"icmp {wrong}") for wrong in ("slt", "ule", "ugt", "ne")),
    *(Slip("lt", "icmp slt", f"icmp {wrong}") for wrong in ("ult", "sle")),
    *(Slip("le", "icmp ule", f"icmp {wrong}") for wrong in ("sle", "ult", "uge")),
    *(Slip("le", "icmp sle", f"icmp {wrong}") for wrong in ("ule", "slt")),
    *(Slip("clip", right, wrong) for right, wrong in (("umin", "smin"), ("smin", "umin"), ("smax", "umax"))),
    *(Slip("clip", right, wrong) for right, wrong in (("umin", "umax"), ("smax", "smin"), ("uadd.sat", "sadd.sat"))),
    *(Slip("clip", "uadd.sat", wrong) for wrong in ("usub.sat", "umax")),
    *(Slip("slice", right, wrong) for right, wrong in (("lshr", "shl"), ("lshr", "ashr"), ("and ", "or "))),
    *(Slip("bit", "icmp ult", f"icmp {wrong}") for wrong in ("ule", "uge", "slt")),
    *(Slip("bit", right, wrong) for right, wrong in (("icmp ne", "icmp eq"), ("add ", "sub "), ("and ", "xor "))),
    *(Slip("concat", right, wrong) for right, wrong in (("shl", "lshr"), ("or ", "and "), ("or ", "sub "))),
    *(Slip("div", "udiv", wrong) for wrong in ("sdiv", "urem")),
    *(Slip("mod", "urem", wrong) for wrong in ("srem", "udiv")),
    *(Slip("band", "and ", wrong) for wrong in ("or ", "xor ")),
    *(Slip("bor", "or ", wrong) for wrong in ("and ", "xor ")),
    *(Slip("bxor", "xor ", wrong) for wrong in ("or ", "and ")),
    *(Slip("and", "and ", wrong) for wrong in ("or ", "xor ")),
    *(Slip("or", "or ", wrong) for wrong in ("and ", "xor ")),
    *(Slip("xor", "xor ", wrong) for wrong in ("or ", "and ")),
    *(Slip("not", "xor ", wrong) for wrong in ("or ", "and ")),
    *(Slip("implies", right, wrong) for right, wrong in (("or ", "and "), ("xor ", "and "))),
]


class Spy:
    """The code that is written, with a slip in it."""

    def __init__(self, code: Any, slip: Slip) -> None:
        self._code, self._slip = code, slip

    def __getattr__(self, name: str) -> Any:
        return getattr(self._code, name)

    def _slipped(self, text: str) -> str:
        return self._slip.wrong + text.removeprefix(self._slip.right) if text.startswith(self._slip.right) else text

    def op(self, text: str) -> str:
        return str(self._code.op(self._slipped(text)))

    def call(self, intrinsic: str, kind: str, *args: str) -> str:
        return str(self._code.call(self._slipped(intrinsic), kind, *args))


def wrong_values(row: str) -> Iterator[bool]:
    for outputs, rows in edge_graphs(row):
        expected = [evaluate(outputs, given) for given in rows]
        yield NATIVE["native"](outputs, rows, expected) != expected


@pytest.mark.parametrize("slip", SLIPS, ids=str)
def test_a_wrong_instruction_shows(slip: Slip, monkeypatch: pytest.MonkeyPatch) -> None:
    entry = OPERATIONS[slip.row].native
    slipped = replace(OPERATIONS[slip.row], native=lambda k, t, *args: entry(Spy(k, slip), t, *args))
    monkeypatch.setitem(OPERATIONS, slip.row, slipped)
    assert any(wrong_values(slip.row))

"""A run of the exported and-inverter graph is the run of the Python reading, bit by bit; and each operation, in each
format of words, gives what the direct reading gives.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from random import Random
from typing import Any

import pytest
from hypothesis import given, settings

from safety.export import btor2, expressions, verilog
from safety.export.aiger import AT_START, FIRST, STARTED, VALID, aag, aiger
from safety.system import ANY
from safety.terms.graph import Term
from safety.trace import Trace, run
from tests.export.readers import Aiger, read_aiger, wires
from tests.export.systems import Question, operations_question, questions
from tests.export.test_tools import READERS
from tests.terms.graphs import edges

TICKS = 50


def chosen(rng: Random, variable: Term) -> Any:
    sort = variable.sort
    if sort.kind == "bit" or rng.random() < 0.5:
        return rng.choice(edges(sort))
    return rng.randint(*sort.bounds)


def ours(question: Question, rng: Random) -> Trace:
    start = {s.path: chosen(rng, s.var) for s in question.system.states if s.power_up is ANY}
    rows = [{path: chosen(rng, v) for path, v in question.system.inputs.items()} for _ in range(TICKS)]
    return run(question.system, rows, start=start)


def bits(value: Any, count: int) -> list[bool]:
    return [bool(value >> i & 1) for i in range(count)]


class Simulated:
    """A file with its wires by full name."""

    def __init__(self, file: Aiger) -> None:
        self.file = file
        names = {kind: [file.names[f"{kind}{n}"] for n in range(count)] for kind, count in self._counts().items()}
        self.alone = {name: file.registers[names["l"].index(name)][0] for name in names["l"] if not name.endswith("]")}
        self.inputs = {path: [file.inputs[n] for n in places] for path, places in wires(names["i"]).items()}
        registers = wires([name if name.endswith("]") else f"{name}[0]" for name in names["l"]])
        self.registers = {path: [file.registers[n][0] for n in places] for path, places in registers.items()}

    def _counts(self) -> Mapping[str, int]:
        return {"i": len(self.file.inputs), "l": len(self.file.registers)}

    def given(self, row: Mapping[str, Any]) -> dict[int, bool]:
        """Inputs by literal; what the row does not name is false."""
        found = dict.fromkeys(self.file.inputs, False)
        for path, word in self.inputs.items():
            found |= zip(word, bits(row.get(path, 0), len(word)), strict=True)
        return found

    def holds(self, held: Mapping[int, bool], path: str, value: Any) -> bool:
        word = self.registers[path]
        return [held[x] for x in word] == bits(value, len(word))


def check_folded(question: Question, trace: Trace) -> None:
    """Step 0 loads; then the registers are ours, and the output says that the claim is broken, as ours does."""
    file = Simulated(read_aiger(aiger(question)))
    held = {own: False for own, _, _ in file.file.registers}
    at_start = {f"{path}{AT_START}": column[0] for path, column in trace.columns.items()}
    valid = trace["start"][0]
    for k in range(-1, TICKS):
        row = {path: trace[path][k] for path in question.system.inputs} if k >= 0 else at_start
        value = file.file.run(held, file.given(row))
        assert held[file.alone[STARTED]] == (k >= 0)
        assert [value(x) for x in file.file.bad] == [k >= 0 and valid and trace["given"][k] and not trace["holds"][k]]
        if k >= 0:
            assert held[file.alone[VALID]] == valid
            assert all(
                file.holds(held, path, trace[path][k]) for path in question.system.state if path in file.registers
            )
            valid = valid and trace["given"][k]
        held = {own: value(after) for own, after, _ in file.file.registers}


def check_plain(question: Question, trace: Trace) -> None:
    """The registers are ours from step 0 on; bad, and the assumptions, as ours."""
    file = Simulated(read_aiger(aag(question).encode()))
    free = {
        x: b
        for path, word in file.registers.items()
        if path in trace.columns
        for x, b in zip(word, bits(trace[path][0], len(word)), strict=True)
    }
    held = {own: free[own] if reset == own else bool(reset) for own, _, reset in file.file.registers}
    for k in range(TICKS):
        value = file.file.run(held, file.given({path: trace[path][k] for path in question.system.inputs}))
        assumed = trace["given"][k] and (k > 0 or trace["start"][0])
        assert all(value(c) for c in file.file.constraints) == assumed
        assert [value(x) for x in file.file.bad] == [not trace["holds"][k]]
        assert all(file.holds(held, path, trace[path][k]) for path in question.system.state if path in file.registers)
        assert held.get(file.alone.get(FIRST, -1), k == 0) == (k == 0)
        held = {own: value(after) for own, after, _ in file.file.registers}


@pytest.mark.parametrize("examples", [20, pytest.param(400, marks=pytest.mark.slow)])
@pytest.mark.parametrize("check", [check_folded, check_plain])
def test_random_systems_run_as_ours(check: Callable[[Question, Trace], None], examples: int) -> None:
    def runs_alike(question: Question) -> None:
        check(question, ours(question, Random(1)))

    settings(max_examples=examples, database=None)(given(questions())(runs_alike))()


# --- every operation in every format -------------------------------------------------------------------------------

OF_WORDS = {name: read for name, read in READERS.items() if "cvc5" not in name and "1.9" not in name}
BTOR2, SMT, VERILOG = "btor2, Bitwuzla", "smtlib bits, z3", "verilog, Yosys"
NARROW, WIDE = 20, 200  # bits


def check_operations(reader: str, seed: int, widest: int, tmp_path: Path) -> None:
    rows = 1 if reader == VERILOG else 6  # Yosys takes seconds a row
    found: Any = OF_WORDS[reader](operations_question(seed, widest, rows), tmp_path)  # type: ignore[arg-type]
    assert found is None


@pytest.mark.parametrize(("seed", "widest"), [(1, NARROW), pytest.param(2, WIDE, marks=pytest.mark.slow)])
@pytest.mark.parametrize("reader", OF_WORDS)
def test_every_operation_means_the_same_to_the_tool(reader: str, seed: int, widest: int, tmp_path: Path) -> None:
    check_operations(reader, seed, widest, tmp_path)


WRONG = [
    *((BTOR2, btor2, "_NAMED", "bvslt", "ult"), (BTOR2, btor2, "_NAMED", "bvule", "ult")),
    *((BTOR2, btor2, "_NAMED", "sign_extend", "uext"), (BTOR2, btor2, "_NAMED", "bvurem", "udiv")),
    *((VERILOG, verilog, "_INFIX", "bvurem", "/"), (VERILOG, verilog, "_SIGNED", "bvslt", ">")),
    *((SMT, expressions, "_ON_BITS", "<", "bvult"), (SMT, expressions, "_ON_BITS", "^", "bvor")),
    *((SMT, expressions, "_NAMED", "ULE", "bvult"), (SMT, expressions, "_NAMED", "UDiv", "bvsdiv")),
]


@pytest.mark.parametrize(("reader", "module", "table", "operation", "wrong"), WRONG)
def test_a_wrong_operation_is_found(
    reader: str, module: Any, table: str, operation: str, wrong: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(getattr(module, table), operation, wrong)
    with pytest.raises(AssertionError):
        check_operations(reader, 1, NARROW, tmp_path)

"""Each format, re-read by a tool that is not ours, gives the verdict that is ours; a counterexample is as long."""

from __future__ import annotations

import importlib
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from safety.export import export
from safety.export.aiger import aiger
from safety.prove.claims import registered
from safety.prove.problem import Problem, build_problem
from safety.system import State
from safety.terms import Bit
from tests.export.claims import CLAIMS
from tests.export.readers import btor2_unrolled, shortest, vmt_unrolled

MOST = 16  # steps, beyond the longest counterexample
PATIENCE_S = 300


def program(*names: str) -> str:
    beside = Path(sys.executable).parent
    found = next((path for name in names if (path := shutil.which(name) or shutil.which(name, path=beside))), None)
    return found or pytest.skip(f"{names[0]} is not installed")


def called(*words: str, text: str | None = None) -> str:
    done = subprocess.run(words, input=text, capture_output=True, text=True, timeout=PATIENCE_S)
    return done.stdout + done.stderr


# --- the tools: steps of a counterexample, or None for `proved` ----------------------------------------------------


def abc(content: bytes, prepared: str, tmp_path: Path) -> int | None:
    """ABC: bounded search for the shortest counterexample, then property-directed reachability."""
    file = tmp_path / "claim.aig"
    file.write_bytes(content)
    said = called(
        program("berkeley-abc", "abc", "yosys-abc"), "-c", f"read_aiger {file}; {prepared} bmc3 -F {MOST}; pdr"
    )
    hit = re.search(r"asserted in frame (\d+)", said)
    assert hit or "Property proved" in said or "Explored all reachable states" in said, said
    return int(hit[1]) if hit else None


def by_aiger(problem: Problem, tmp_path: Path) -> int | None:
    return abc(
        aiger(problem, bool(problem.lemmas)), "", tmp_path
    )  # its step 0 loads the registers: frame n is step n - 1


def by_aiger_with_constraints(problem: Problem, tmp_path: Path) -> int | None:
    """Format 1.9; without `undc` ABC would take unknown power-up values for 0."""
    frame = abc(aiger(problem, bool(problem.lemmas), fold_constraints=False), "logic; undc; strash; fold;", tmp_path)
    return None if frame is None else frame + 1


def by_btor2(problem: Problem, tmp_path: Path) -> int | None:
    """Bitwuzla's parser and solver, on the file's lines copied once a step."""
    bitwuzla = pytest.importorskip("bitwuzla", reason="bitwuzla is not installed")
    text = str(export(problem, "btor2", bool(problem.lemmas)))

    def found(from_power_up: bool, last: int) -> bool:
        parser = bitwuzla.Parser(bitwuzla.TermManager(), bitwuzla.Options(), "btor2")
        parser.parse(btor2_unrolled(text, from_power_up, last), True, False)
        return {"sat": True, "unsat": False}[str(parser.bitwuzla().check_sat())]

    return shortest(found, MOST)


def by_questions(ask: Callable[[str], str], integers: bool) -> Callable[[Problem, Path], int | None]:
    """The three questions of the SMT-LIB script, at growing depth."""

    def verdict(problem: Problem, _: Path) -> int | None:
        for depth in range(1, MOST):
            said = ask(str(export(problem, "smtlib", bool(problem.lemmas), integers, depth))).split()
            assert said[::2] == ["base", "step", "run"], said
            base, step, run = said[1::2]
            assert run == "sat"
            if base == "sat":
                return depth
            if step == "unsat":
                return None
            assert (base, step) == ("unsat", "sat"), said
        raise AssertionError(f"no answer with {MOST} steps")

    return verdict


def z3(text: str) -> str:
    return called(program("z3"), "-in", "-smt2", text=text)


def cvc5(text: str) -> str:
    """cvc5's own parser of SMT-LIB, command by command."""
    import cvc5 as solver

    own = solver.Solver()
    parser = solver.InputParser(own)
    parser.setStringInput(solver.InputLanguage.SMT_LIB_2_6, text, "claim")
    parser.getSymbolManager()
    own.setOption("incremental", "true")
    said = []
    while not (command := parser.nextCommand()).isNull():
        said.append(str(command.invoke(own, parser.getSymbolManager())))
    return " ".join(said).replace('"', "")


def by_vmt(integers: bool) -> Callable[[Problem, Path], int | None]:
    """z3 on the file's annotated formulas."""

    def verdict(problem: Problem, _: Path) -> int | None:
        text = str(export(problem, "vmt", bool(problem.lemmas), integers))

        def found(from_power_up: bool, last: int) -> bool:
            return {"sat\n": True, "unsat\n": False}[z3(vmt_unrolled(text, from_power_up, last))]

        return shortest(found, MOST)

    return verdict


def by_verilog(problem: Problem, tmp_path: Path) -> int | None:
    """Yosys, temporal induction."""
    file = tmp_path / "claim.v"
    file.write_text(str(export(problem, "verilog", bool(problem.lemmas))))
    script = f"read_verilog -formal {file}; prep; sat -tempinduct -prove-asserts -set-assumes -maxsteps {MOST}"
    said = called(program("yosys"), "-p", script)
    if "Induction step proven: SUCCESS!" in said:
        return None
    assert "model found for base case: FAIL!" in said, said
    return max(int(n) for n in re.findall(r"\[base case (\d+)\]", said))


READERS: dict[str, Callable[[Problem, Path], int | None]] = {
    "aiger, ABC": by_aiger,
    "aiger 1.9, ABC": by_aiger_with_constraints,
    "btor2, Bitwuzla": by_btor2,
    "smtlib integers, z3": by_questions(z3, True),
    "smtlib bits, z3": by_questions(z3, False),
    "smtlib integers, cvc5": by_questions(cvc5, True),
    "smtlib bits, cvc5": by_questions(cvc5, False),
    "vmt integers, z3": by_vmt(True),
    "vmt bits, z3": by_vmt(False),
    "verilog, Yosys": by_verilog,
}


@pytest.mark.parametrize("name", CLAIMS)
@pytest.mark.parametrize("reader", READERS)
def test_a_tool_finds_the_same(reader: str, name: str, tmp_path: Path) -> None:
    make, steps = CLAIMS[name]
    assert READERS[reader](make(), tmp_path) == steps


# --- the tests can fail --------------------------------------------------------------------------------------------


def without_start(problem: Any) -> Any:
    return replace(problem, start=Bit.__or__(problem.start, True))


def without_given(problem: Any) -> Any:
    return replace(problem, given=Bit.__or__(problem.given, True))


def powered_up_otherwise(problem: Any) -> Any:
    def changed(s: State) -> State:
        return replace(s, power_up=not s.power_up if isinstance(s.power_up, bool) else 7)

    return replace(problem, system=replace(problem.system, states=tuple(map(changed, problem.system.states))))


@pytest.mark.parametrize(
    ("name", "planted"),
    [("few and idle", without_start), ("few and idle", without_given), ("nine", powered_up_otherwise)],
    ids=["no start", "no given", "power-up"],
)
@pytest.mark.parametrize("reader", READERS)
def test_a_file_that_leaves_something_out_is_found(
    reader: str, name: str, planted: Callable[[Any], Any], tmp_path: Path
) -> None:
    make, steps = CLAIMS[name]
    assert READERS[reader](planted(make()), tmp_path) != steps


@pytest.mark.parametrize("reader", READERS)
def test_a_range_that_is_left_out_is_found(reader: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("safety.export.transition._in_range", lambda v: v.sort.kind != "none")
    for name in ("slow", "in range"):
        assert READERS[reader](CLAIMS[name][0](), tmp_path) is not None


# --- a claim of a real model ---------------------------------------------------------------------------------------


def of_ts7(module: str, name: str) -> Problem:
    importlib.import_module(f"proofs.{module}")
    return build_problem(next(c for c in registered() if c.id == f"{module}.{name}"))


@pytest.mark.parametrize(("name", "steps"), [("lowering_only_lowers", None), ("a_broken_matrix_only_lowers", 1)])
@pytest.mark.parametrize("reader", READERS)
def test_a_tool_finds_the_same_for_a_whole_two_out_of_three_system(
    reader: str, name: str, steps: int | None, tmp_path: Path
) -> None:
    assert READERS[reader](of_ts7("ts7_voting", name), tmp_path) == steps


@pytest.mark.parametrize("ask", [z3, cvc5])
def test_a_stranger_redoes_a_proof_by_lemmas(ask: Callable[[str], str]) -> None:
    problem = of_ts7("ts7_channel", "brakes_without_signal_in_its_own_time")
    assert ask(str(export(problem, "smtlib", lemmas=True))).split() == ["base", "unsat", "step", "unsat", "run", "sat"]
    assert ask(str(export(problem, "smtlib"))).split()[3] == "sat"  # without them the induction does not carry

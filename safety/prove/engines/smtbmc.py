"""Temporal induction by yosys-smtbmc on the problem as a circuit: other hands from the file to the question.

Its induction is re-checked at the depth that it gives; its counterexample is replayed.
"""

from __future__ import annotations

import json
import re
from typing import Any

from safety.prove.claims import BOUNDED, PROVED
from safety.prove.engines.engine import BOTH, Budget, Engine, Result, refuted_by
from safety.prove.engines.external import CIRCUIT_FILE, Given, last_line, output, tool
from safety.prove.induction import by_induction
from safety.prove.problem import Problem

NAME = "smtbmc"
DEEPEST = 20
SOLVERS = {"yices": "yices-smt2", "bitwuzla": "bitwuzla", "boolector": "boolector", "cvc5": "cvc5", "z3": "z3"}
TOP, QUESTION, RUN = "top.v", "circuit.smt2", "run.yw"
SCRIPT = (
    f"read_aiger -module_name circuit -clk_name clk {CIRCUIT_FILE}; read_verilog -formal {TOP}; "
    f"prep -flatten -top top; write_smt2 -wires {QUESTION}"
)


def unavailable() -> str | None:
    """Whether Yosys, or every solver that it could ask, is missing."""
    if not (tool("yosys") and tool("yosys-smtbmc")):
        return "yosys and yosys-smtbmc are not on the path; on Debian or Ubuntu: apt install yosys"
    if _solver() is None:
        return f"no solver for yosys-smtbmc is on the path; it asks {', '.join(SOLVERS.values())}"
    return None


def _solver() -> str | None:
    return next((name for name, program in SOLVERS.items() if tool(program)), None)


def run(problem: Problem, budget: Budget) -> Result:
    """Ask for an induction first, then for a violation as deep as the induction needs, or as the claim's bound is."""
    given = Given(problem, budget)
    (budget.scratch / TOP).write_text(_top(len(given.inputs)))
    said = output([tool("yosys") or "yosys", "-q", "-p", SCRIPT], budget)
    if not (budget.scratch / QUESTION).exists():
        return Result(NAME, why=f"yosys did not write the question: {last_line(said)}")
    said = _ask(budget, "-i", "-t", str(DEEPEST), seconds=budget.left / 2)
    depth = None
    if "Status: PASSED" in said:
        depth = DEEPEST - min(int(step) for step in re.findall(r"Trying induction in step (\d+)", said))
    steps = problem.claim.steps if depth is None else depth
    said = _ask(budget, "-t", str(steps + 1), "--dump-yw", RUN, seconds=budget.left)  # the first only loads
    if "Status: FAILED" in said:
        told = json.loads((budget.scratch / RUN).read_text())
        return refuted_by(NAME, problem, given.values(_wires(told)), len(told["steps"]) - 1)
    if "Status: PASSED" not in said:
        return Result(NAME, why=f"no answer: {last_line(said)}")
    if depth is None:
        return Result(NAME, BOUNDED, steps=steps, agreed_by=(NAME,), why=f"induction of depth {DEEPEST} fails")
    return _proved(problem, depth, budget)


def _ask(budget: Budget, *options: str, seconds: float) -> str:
    asked = [tool("yosys-smtbmc") or "yosys-smtbmc", "-s", _solver() or "z3", "--noinfo", "--timeout"]
    return output([*asked, str(int(seconds) + 1), *options, QUESTION], budget, seconds)


def _top(inputs: int) -> str:
    """A module around the circuit that asserts that its output is false."""
    bus = f", input [{inputs - 1}:0] i" if inputs else ""
    ports = "".join(f".i{n}(i[{n}]), " for n in range(inputs))
    return (
        f"module top(input clk{bus});\n  wire violated;\n"
        f"  circuit c({ports}.clk(clk), .violated(violated));\n  always @* assert (!violated);\nendmodule\n"
    )


def _proved(problem: Problem, depth: int, budget: Budget) -> Result:
    """The induction again, by our own encoding and both solvers; Yosys may have simplified a step or two away."""
    answer = by_induction(problem, depth + 2, False, budget.left, BOTH)
    if answer.proved:
        return Result(NAME, PROVED, agreed_by=(*answer.agreed_by, NAME), steps=answer.depth)
    why = f"rests on {NAME} alone: its induction of depth {depth} was not confirmed: {answer.failed}"
    return Result(NAME, PROVED, agreed_by=(NAME,), why=why)


def _wires(told: Any) -> list[tuple[int, int, bool]]:
    """Number, frame and value of each input in a Yosys witness; its bits stand with the last signal first."""
    found = []
    for frame, step in enumerate(told["steps"]):
        bits = step["bits"][::-1]
        for signal in told["signals"]:
            width = signal["width"]
            if signal["path"][-1] == "\\i":
                found += [(signal["offset"] + n, frame, value == "1") for n, value in enumerate(bits[:width])]
            bits = bits[width:]
    return found


ENGINE = Engine(NAME, unavailable, run)

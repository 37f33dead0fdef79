"""ABC's `pdr`, property-directed reachability over bits, on the problem as a circuit.

Its counterexample is replayed; its invariant, cubes over registers that are never reached, is checked like a lemma.
(Een, Mishchenko, Brayton, Efficient Implementation of Property Directed Reachability, 2011.)
"""

from __future__ import annotations

import re

from safety.prove.engines.engine import Budget, Engine, Result, proved_by, refuted_by
from safety.prove.engines.external import CIRCUIT_FILE, Given, last_line, output, tool
from safety.prove.problem import Problem
from safety.terms import Bit
from safety.terms.values import all_of

NAME = "pdr"
PROGRAMS = ("berkeley-abc", "yosys-abc", "abc")
INVARIANT, RUN = "invariant.pla", "run.txt"
CHECK = 0.3  # of the time, kept for checking the answer
VALUE = re.compile(r"i(\d+)@(\d+)=([01])")


def unavailable() -> str | None:
    """Whether ABC is missing."""
    if tool(*PROGRAMS):
        return None
    return "ABC is not on the path (berkeley-abc, yosys-abc or abc); on Debian or Ubuntu: apt install berkeley-abc"


def run(problem: Problem, budget: Budget) -> Result:
    """Ask ABC."""
    given = Given(problem, budget)
    seconds = (1 - CHECK) * budget.left  # ABC counts whole seconds of processor time, so the clock is kept here too
    order = f"read_aiger {CIRCUIT_FILE}; pdr -d -I {INVARIANT} -T {max(1, int(seconds))}; write_cex -n {RUN}"
    said = output([tool(*PROGRAMS) or PROGRAMS[0], "-c", order], budget, seconds)
    if "Property proved" in said:
        written = budget.scratch / INVARIANT  # an ABC of another year may not write it
        invariants = [_invariant(written.read_text(), given)] if written.exists() else []
        return proved_by(NAME, problem, invariants, False, budget, "it wrote no invariant")
    if violated := re.search(r" was asserted in frame (\d+)", said):
        found = VALUE.findall((budget.scratch / RUN).read_text())
        values = given.values((int(n), int(frame), value == "1") for n, frame, value in found)
        return refuted_by(NAME, problem, values, int(violated[1]))  # frame 0 only loads
    return Result(NAME, why=f"no answer: {last_line(said)}")


def _invariant(text: str, given: Given) -> dict[str, Bit]:
    """The clauses of an invariant in PLA: each row is a cube of registers that is never reached."""
    columns: list[Bit] = []
    for line in text.splitlines():
        if line.startswith(".ilb"):
            columns = [given.register(int(name[1:])) for name in line.split()[1:]]
    cubes = re.findall(r"^([01-]+) 1$", text, re.MULTILINE)
    clauses = [
        ~all_of(*(w if c == "1" else ~w for w, c in zip(columns, cube, strict=True) if c != "-")) for cube in cubes
    ]
    return {f"{NAME} {n + 1}": clause for n, clause in enumerate(clauses)}


ENGINE = Engine(NAME, unavailable, run)

"""Claims for other tools: AIGER, BTOR2, SMT-LIB, VMT and Verilog.

What comes back from such a tool is a verdict of a program that shares nothing with this one but the file.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from safety.export import aiger, btor2, smtlib, verilog, vmt
from safety.export.transition import Problem
from safety.system import ModelError, nearest

__all__ = ["FORMATS", "Format", "Problem", "export"]


@dataclass(frozen=True)
class Format:
    """A format: how it is written, what it is called, and whether it can have integers and reals."""

    write: Callable[..., str | bytes]
    ending: str
    text: str
    numbers: bool = False


FORMATS = {
    "aiger": Format(
        aiger.aiger, ".aig", "and-inverter graph, binary, for tools of any age (step 0 loads the registers)"
    ),
    "aag": Format(aiger.aag, ".aag", "and-inverter graph, ASCII, format 1.9 with power-up values and assumptions"),
    "btor2": Format(btor2.btor2, ".btor2", "words, for word-level model checkers"),
    "smtlib": Format(
        smtlib.smtlib, ".smt2", "transition system and its induction as three questions, for any SMT solver", True
    ),
    "vmt": Format(vmt.vmt, ".vmt", "annotated SMT-LIB, for model checkers modulo theories", True),
    "verilog": Format(verilog.verilog, ".v", "module with assumptions and an assertion, for hardware tools"),
}


def export(problem: Problem, format: str, lemmas: bool = False, integers: bool = True, depth: int = 1) -> str | bytes:
    """A claim's problem as a file of one of `FORMATS`: bytes for `aiger`, else text.

    With `lemmas` they have to hold as the claim does.  `integers` (words as integers, or as bit-vectors) and `depth`
    (of the induction) are for the formats that have them.  Raises `ModelError` for another format, `TermError` for a
    claim over reals in a format of bits.
    """
    if format not in FORMATS:
        raise ModelError(f"there is no format {format!r}; {nearest(format, FORMATS)}")
    form = FORMATS[format]
    if not form.numbers:
        return form.write(problem, lemmas)
    return form.write(problem, lemmas, integers, **({"depth": depth} if format == "smtlib" else {}))

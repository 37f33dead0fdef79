"""Tools of others: found on the path, run in a folder of their own, with plain names for all that they are given."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from safety.export.aiger import AT_START, STARTED, VALID, binary, circuit
from safety.export.bits import bits_of
from safety.prove.engines.engine import Budget
from safety.prove.problem import Problem
from safety.terms import Bit, UInt
from safety.terms.graph import BIT
from safety.terms.values import bit

CIRCUIT_FILE = "circuit.aig"
WIRE = re.compile(r"(.*)\[(\d+)\]")


def tool(*names: str) -> str | None:
    """The first of the programs that is on the path, or beside our own Python (a solver's wheel may bring one)."""
    return next(filter(None, (shutil.which(name, path=_path()) for name in names)), None)


def _path() -> str:
    return os.pathsep.join([os.environ.get("PATH", os.defpath), str(Path(sys.executable).parent)])


def output(command: Sequence[str], budget: Budget, seconds: float | None = None) -> str:
    """What a program prints, run in the scratch folder for so long (or all that is left), with a last line if cut off.

    It sees nothing of our Python: it may be written in one of its own.
    """
    clean = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    try:
        ended = subprocess.run(
            command,
            cwd=budget.scratch,
            env={**clean, "PATH": _path()},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=budget.left if seconds is None else seconds,
        )
        return ended.stdout.decode(errors="replace")
    except subprocess.TimeoutExpired as late:
        return (late.stdout or b"").decode(errors="replace") + f"\nit was cut off after {late.timeout:.1f} s"


def last_line(text: str) -> str:
    """The last words of a program, for a reason."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1][:200] if lines else "it printed nothing"


class Given:
    """A problem written as a circuit file in the scratch folder.

    The wires in the file are `i0`, `i1`, ... and `r0`, `r1`, ...: no tool trips over a name of ours.  The circuit's
    frame 0 only loads the registers; frame n + 1 is the problem's step n.
    """

    def __init__(self, problem: Problem, budget: Budget) -> None:
        made = circuit(problem)
        self.problem = problem
        self.inputs = [_place(name) for name in made.inputs.values()]
        self.registers = [_place(name) for name in made.registers.values()]
        plain = replace(made, inputs=_numbered(made.inputs, "i"), registers=_numbered(made.registers, "r"))
        (budget.scratch / CIRCUIT_FILE).write_bytes(binary(plain))

    def register(self, number: int) -> Bit:
        """The term of a register of the circuit, in any frame but 0, where the assumptions have held so far."""
        path, place = self.registers[number]
        if path in (STARTED, VALID):
            return bit(True)
        var: Any = self.problem.system.state[path].var
        if var.sort == BIT:
            return var  # type: ignore[no-any-return]
        word: UInt = var if isinstance(var, UInt) else var.low(bits_of(var.sort))
        return word.bit(place)

    def values(self, wires: Iterable[tuple[int, int, bool]]) -> dict[tuple[str, int], Any]:
        """Values by input and step, and by open register at step 0, from the number, frame and value of wires."""
        words: dict[tuple[str, int], int] = {}
        for number, frame, value in wires:
            path, place = self.inputs[number]
            if path.endswith(AT_START) == (frame == 0):
                key = path.removesuffix(AT_START), max(frame - 1, 0)
                words[key] = words.get(key, 0) | value << place
        return {key: self._value(key[0], word) for key, word in words.items()}

    def _value(self, path: str, word: int) -> Any:
        """The value whose bits a word holds."""
        system = self.problem.system
        sort = system.inputs[path].sort if path in system.inputs else system.state[path].var.sort
        if sort == BIT:
            return bool(word)
        negative = sort.kind == "int" and word >> bits_of(sort) - 1
        return word - (1 << bits_of(sort)) if negative else word


def _place(name: str) -> tuple[str, int]:
    """The name of a wire in parts: what it belongs to, and its place there."""
    found = WIRE.fullmatch(name)
    return (found[1], int(found[2])) if found else (name, 0)


def _numbered(wires: dict[int, str], letter: str) -> dict[int, str]:
    return {literal: f"{letter}{n}" for n, literal in enumerate(wires)}

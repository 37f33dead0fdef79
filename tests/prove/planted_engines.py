"""Engines that misbehave, each in one way; they run in a process of their own, which imports this file."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from safety.prove.claims import BOUNDED, PROVED
from safety.prove.engines.engine import Budget, Engine, Result
from safety.prove.problem import Problem
from safety.prove.solve import Disagreement


def proves(problem: Problem, budget: Budget) -> Result:
    return Result("proves", PROVED, agreed_by=("proves",), why="said so")


def checks(problem: Problem, budget: Budget) -> Result:
    """Has a proof, and takes long to check it."""
    budget.tell(Result("checks", PROVED, agreed_by=("checks",), why="rests on checks alone"))
    time.sleep(300)
    return Result("checks")


def bounds(problem: Problem, budget: Budget) -> Result:
    return Result("bounds", BOUNDED, steps=10)


def sleeps(problem: Problem, budget: Budget) -> Result:
    (budget.scratch / "rubbish").write_text("left behind")
    budget.tell(Result("sleeps", BOUNDED, steps=3))
    time.sleep(300)
    return Result("sleeps")


def starts_a_tool(problem: Problem, budget: Budget) -> Result:
    """Leaves its pid and that of a program that it has started, in the folder beside its own."""
    program = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(300)"])
    notes = Path(os.environ["PLANTED_PIDS"])
    notes.with_suffix(".new").write_text(f"{os.getpid()} {program.pid}")
    notes.with_suffix(".new").rename(notes)
    return sleeps(problem, budget)


def eats_memory(problem: Problem, budget: Budget) -> Result:
    eaten = []
    while True:
        eaten.append(bytearray(1 << 24))


def exits(problem: Problem, budget: Budget) -> Result:
    os._exit(7)


def crashes(problem: Problem, budget: Budget) -> Result:
    print("the last words", file=sys.stderr, flush=True)
    os.kill(os.getpid(), signal.SIGSEGV)
    time.sleep(300)
    return Result("crashes")


def raises(problem: Problem, budget: Budget) -> Result:
    raise ValueError("no such luck")


def finds_a_difference(problem: Problem, budget: Budget) -> Result:
    raise Disagreement("two readings differ")


def chatters(problem: Problem, budget: Budget) -> Result:
    print("what a library prints", flush=True)
    os.write(1, b"\x00" * 100)
    return Result("chatters", BOUNDED, steps=1)


def spins(problem: Problem, budget: Budget) -> Result:
    while True:
        pass


def ready() -> None:
    """Nothing is missing."""


def planted(run: object) -> Engine:
    return Engine(run.__name__, ready, run)  # type: ignore[attr-defined, arg-type]

"""Other tools on the same transition system: commands on a file that we export, each tool run as a whole process."""

from __future__ import annotations

import math
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from safety.export import export
from safety.prove.problem import Problem
from safety.terms.values import all_of

PROVED, BROKEN, OPEN, LATE, ABSENT = "proved", "refuted", "not decided", "not finished", "not installed"
DEPTH = 20  # of the induction of yosys-smtbmc
PATIENCE = 4  # times the cap, of wall clock
RULES = """
(declare-fun reached ({sorts}) Bool)
(assert (forall ({registers}) (=> (start {r}) (reached {r}))))
(assert (forall ({all} {afters}) (=> (and (reached {r}) (given {n}) (next {n} {a})) (reached {a}))))
(assert (forall ({all}) (=> (and (reached {r}) (given {n}) (not (holds {n}))) false)))
(check-sat)
"""


@dataclass(frozen=True)
class Peer:
    """A tool: what it reads, the commands with `{file}`, and what its output means."""

    name: str
    programs: tuple[str, ...]
    write: Callable[[Problem], str | bytes]
    commands: tuple[tuple[str, ...], ...]
    proved: str = ""  # an expression for either verdict; none where the tool cannot give it
    broken: str = ""


@dataclass(frozen=True)
class Time:
    """What became of a tool: the verdict, and the seconds of processor time and of wall clock that it took."""

    verdict: str
    seconds: float
    wall: float = 0.0


def horn(integers: bool) -> Callable[[Problem], str]:
    """Constrained Horn clauses of the system: satisfiable exactly if the claim holds for ever."""

    def write(problem: Problem) -> str:
        script = str(export(problem, "smtlib", bool(problem.lemmas), integers))
        functions = script[script.index("(define-fun start") : script.index("(declare-const")]
        over = re.findall(r"\((\|[^|]*\||[^\s()]+) (\(_ BitVec \d+\)|Int|Bool)\)", _over(functions, "next"))
        of_start = len(re.findall(r"\((\|[^|]*\||[^\s()]+) (\(_ BitVec \d+\)|Int|Bool)\)", _over(functions, "start")))
        now, after = over[: len(over) - of_start], over[len(over) - of_start :]
        declared = [f"({name} {sort})" for name, sort in over]
        return "(set-logic HORN)\n" + functions + RULES.format(
            sorts=" ".join(sort for _, sort in after), registers=" ".join(declared[:of_start]),
            all=" ".join(declared[: len(now)]), afters=" ".join(declared[len(now) :]),
            r=" ".join(name for name, _ in now[:of_start]), n=" ".join(name for name, _ in now),
            a=" ".join(name for name, _ in after),
        )  # fmt: skip

    return write


def _over(functions: str, name: str) -> str:
    """The variables of a function, as text."""
    return functions[functions.index(f"(define-fun {name} ") :].split("\n", 1)[0]


def _file(form: str) -> Callable[[Problem], str | bytes]:
    return lambda problem: export(problem, form, bool(problem.lemmas))


PREPARE = (
    *("yosys", "-q", "-p"),
    "read_verilog -formal {file}; prep -top claim; async2sync; dffunmap; write_smt2 -wires {file}.smt2",
)
INDUCE, SEARCH = (("yosys-smtbmc", "-s", "z3", *mode, "-t", str(DEPTH), "{file}.smt2") for mode in (["-i"], []))
PEERS = [
    Peer("ABC pdr", ("berkeley-abc", "abc", "yosys-abc"), _file("aiger"),
         (("berkeley-abc", "-c", "read_aiger {file}; scorr; dc2; pdr"),), r"Property proved", r"asserted in frame"),
    Peer("z3 Spacer, bits", ("z3",), horn(False), (("z3", "fp.engine=spacer", "{file}"),), r"^sat", r"^unsat"),
    Peer("z3 Spacer, integers", ("z3",), horn(True), (("z3", "fp.engine=spacer", "{file}"),), r"^sat", r"^unsat"),
    Peer("yosys-smtbmc -i", ("yosys-smtbmc",), _file("verilog"), (PREPARE, INDUCE), r"Status: PASSED"),
    Peer("yosys-smtbmc, search", ("yosys-smtbmc",), _file("verilog"),
         (PREPARE, SEARCH), broken=r"Status: FAILED"),
]  # fmt: skip


def assumed(problem: Problem) -> Problem:
    """The problem with its lemmas as constraints: nothing but the claim is left to show."""
    return replace(problem, given=all_of(problem.given, *problem.lemmas.values()), lemmas={})


def program(*names: str) -> str | None:
    """Where a program is: on the path, or beside the interpreter."""
    beside = str(Path(sys.executable).parent)
    return next((path for n in names if (path := shutil.which(n) or shutil.which(n, path=beside))), None)


def timed(peer: Peer, problem: Problem, cap: float, folder: Path) -> Time:
    """Run a tool on a problem for at most `cap` seconds of processor time; writing the file does not count."""
    where = program(*peer.programs)
    if where is None or (peer.commands[0] is PREPARE and program("yosys") is None):
        return Time(ABSENT, 0.0)
    content, file = peer.write(problem), folder / "claim"
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    before, began, said = _processor(), time.perf_counter(), ""
    for words in peer.commands:
        called = [where if words[0] in peer.programs else program(words[0]) or words[0], *words[1:]]
        output, finished = _called([w.replace("{file}", str(file)) for w in called], cap)
        said += output
        seconds, wall = _processor() - before, time.perf_counter() - began
        if not finished or seconds > 0.98 * cap:
            return Time(LATE, cap, wall)
    for text, verdict in ((peer.proved, PROVED), (peer.broken, BROKEN)):
        if text and re.search(text, said, re.MULTILINE):
            return Time(verdict, seconds, wall)
    return Time(OPEN, seconds, wall)


def _processor() -> float:
    """Seconds of processor time of all processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _called(words: Sequence[str], cap: float) -> tuple[str, bool]:
    """The output of a process, and whether it finished; one that does not is ended with all that it started."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    process = subprocess.Popen(
        words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True,
        env={**os.environ, "PATH": path},
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(cap), math.ceil(cap))),
    )  # fmt: skip
    try:
        output, _ = process.communicate(timeout=PATIENCE * cap)
        return output, process.returncode != -signal.SIGKILL
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return "", False

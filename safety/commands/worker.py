"""A worker process: takes items on stdin, gives answers on stdout, a JSON text a line.

Started as `python -m safety.commands.worker`.  The first line says where the project is and how to work.  A process of
its own keeps a crash, a hanging solver and its memory away from the other results.
"""

from __future__ import annotations

import json
import os
import queue
import sys
import threading
from dataclasses import asdict
from fractions import Fraction
from pathlib import Path
from typing import Any, TextIO

from safety.commands.selection import Item
from safety.project import Config, Project

END = 1


def main() -> None:
    """Work until stdin ends; then, whatever a solver is doing, end at once."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what the project's files print must not get among the answers
    lines: queue.Queue[str] = queue.Queue()
    threading.Thread(target=_read, args=(sys.stdin, lines), daemon=True).start()
    head = json.loads(lines.get())

    from safety.commands.evaluate import Order, evaluate
    from safety.commands.recall import started_with
    from safety.commands.snapshot import Reads

    settings = {name: typed(value) for name, value in head["order"].pop("settings").items()}
    order = Order(**head["order"], settings=settings)
    project = Project(Path(head["root"]), Config())
    if order.cache:
        started_with()
    reads = Reads(project.root) if order.cache else None
    project.load_proofs()
    while True:
        item = Item(**json.loads(lines.get()))
        answer = evaluate(project, item, order, lambda text: _write(answers, {"note": text}))
        told = {"entry": answer.entry, "problem": answer.problem and asdict(answer.problem), "vcd": answer.vcd}
        _write(answers, told | {"reads": reads.taken() if reads else []})


def plain(value: Any) -> Any:
    """A setting's value for JSON: a fraction as a text."""
    return str(value) if isinstance(value, Fraction) else value


def typed(value: Any) -> Any:
    """The value back from JSON."""
    return Fraction(value) if isinstance(value, str) else value


def _write(answers: TextIO, message: Any) -> None:
    answers.write(json.dumps(message) + "\n")
    answers.flush()


def _read(stdin: TextIO, lines: queue.Queue[str]) -> None:
    for line in stdin:
        lines.put(line)
    os._exit(END)  # the command has gone: a solver may be busy for hours, nobody waits for it


if __name__ == "__main__":
    main()

"""Worker processes seen from the command: items go out, answers come in, a worker that dies is replaced."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Generator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import safety
from safety.commands.evaluate import Answer, Order, without_result
from safety.commands.selection import Item
from safety.commands.worker import plain
from safety.project import Problem, Project

TICK_S = 0.1


class Event(NamedTuple):
    """An answer, or a note on an item at work; both None when a tick passed without either."""

    answer: Answer | None = None
    item: Item | None = None
    note: str = ""


class _Worker:
    """One process and the thread that listens to it."""

    def __init__(self, head: str, heard: queue.Queue[tuple[_Worker, Any]]) -> None:
        self.item: Item | None = None
        self.process = subprocess.Popen(
            [sys.executable, "-m", "safety.commands.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            encoding="utf-8",
            env={**os.environ, "PYTHONPATH": _path()},
            start_new_session=True,  # Ctrl-C is for the command, which ends its workers itself
        )
        self.send(head)
        threading.Thread(target=self._listen, args=(heard,), daemon=True).start()

    def _listen(self, heard: queue.Queue[tuple[_Worker, Any]]) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            heard.put((self, json.loads(line)))
        heard.put((self, None))

    def send(self, line: str) -> None:
        assert self.process.stdin is not None
        with contextlib.suppress(BrokenPipeError):  # it has died; the listener finds out
            self.process.stdin.write(line + "\n")
            self.process.stdin.flush()

    def give(self, item: Item) -> None:
        self.item = item
        self.send(json.dumps(item.__dict__))

    def end(self) -> None:
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe is not None:
                with contextlib.suppress(BrokenPipeError):
                    pipe.close()


class Workers:
    """Up to `jobs` processes that work on a project's items."""

    def __init__(self, project: Project, order: Order, jobs: int) -> None:
        told = order.__dict__ | {"settings": {name: plain(value) for name, value in order.settings.items()}}
        self.head = json.dumps({"root": str(project.root), "order": told})
        self.jobs = jobs
        self.heard: queue.Queue[tuple[_Worker, Any]] = queue.Queue()
        self.live: list[_Worker] = []

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self.live:
            worker.end()

    def run(self, items: Sequence[Item]) -> Generator[Event, None, None]:
        """Answers as they come, in whatever order, with an empty event about every tenth of a second."""
        waiting, open_items = deque(items), len(items)
        for _ in range(min(self.jobs, len(items))):
            self._start(waiting)
        while open_items:
            try:
                worker, message = self.heard.get(timeout=TICK_S)
            except queue.Empty:
                yield Event()
                continue
            if message is not None and "note" in message:
                yield Event(None, worker.item, message["note"])
                continue
            item = worker.item
            if message is None:
                worker.end()
                self.live.remove(worker)
                if waiting:
                    self._start(waiting)
            if item is not None:
                open_items -= 1
                worker.item = None
                if message is not None and waiting:
                    worker.give(waiting.popleft())
                yield Event(_answer(item, message) if message else _died(item, worker.process.returncode))

    def at_work(self) -> list[Item]:
        """The items that are being worked on."""
        return [worker.item for worker in self.live if worker.item]

    def _start(self, waiting: deque[Item]) -> None:
        worker = _Worker(self.head, self.heard)
        self.live.append(worker)
        worker.give(waiting.popleft())


def _answer(item: Item, message: Any) -> Answer:
    problem = message["problem"] and Problem(**message["problem"])
    return Answer(item, message["entry"], problem, message["vcd"], [(path, told) for path, told in message["reads"]])


def _died(item: Item, code: int) -> Answer:
    """A killed process (most often for want of memory) leaves the item undecided; any other end is a fault of ours."""
    if -code == getattr(signal, "SIGKILL", None):
        why = "its process was killed, most likely for want of memory; give -j 1, or a smaller bound"
        return Answer(item, without_result(item, _Killed(why)))
    how = f"signal {-code}" if code < 0 else f"exit code {code}"
    return Answer(item, without_result(item, f"its process ended by itself ({how})"))


class _Killed(Exception):
    """The operating system ended the process of an item."""

    exit_code = 3


def _path() -> str:
    """Where the worker finds this very package, installed or not."""
    here = str(Path(safety.__file__).parent.parent)
    return os.pathsep.join([here, *filter(None, [os.environ.get("PYTHONPATH")])])

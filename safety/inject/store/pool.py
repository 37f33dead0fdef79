"""An executor of worker processes that outlives them: what a killed worker had in hand is given out again.

Each worker is a fresh interpreter (spawned, not forked) under a thread of its own.  A task that takes `ATTEMPTS`
workers with it is given up; the others go on.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import queue
import signal
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, NamedTuple, ParamSpec, TypeVar

ATTEMPTS = 3
GRACE_S = 5.0  # for a worker to end by itself

P = ParamSpec("P")
T = TypeVar("T")


class WorkerDiedError(Exception):
    """A task ended its worker each time it was tried."""


class GoneError(Exception):
    """The executor itself is gone, and with it what it had in hand."""


class _Task(NamedTuple):
    future: Future[Any]
    call: tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]


class Processes(Executor):
    """Up to `workers` processes, started when there is work for them."""

    def __init__(self, workers: int) -> None:
        if workers < 1:
            raise ValueError(f"{workers} workers: there has to be one at least")
        self.workers = workers
        self._tasks: queue.SimpleQueue[_Task | None] = queue.SimpleQueue()
        self._threads: list[threading.Thread] = []
        self._live: set[_Worker] = set()
        self._closed = self._abandoned = False

    def submit(self, function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Have a process call the function, which it imports by name; arguments and result are pickled."""
        if self._closed:
            raise RuntimeError("this executor has been shut down")
        future: Future[T] = Future()
        self._tasks.put(_Task(future, (function, args, kwargs)))
        if len(self._threads) < self.workers:
            thread = threading.Thread(target=self._serve, daemon=True)
            self._threads.append(thread)
            thread.start()
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the workers: once all tasks are done; with `cancel_futures` after those at work; without `wait` now."""
        self._closed, self._abandoned = True, self._abandoned or not wait
        while cancel_futures or not wait:
            try:
                task = self._tasks.get_nowait()
            except queue.Empty:
                break
            if task is not None:
                task.future.cancel()
        for _ in self._threads:
            self._tasks.put(None)
        for worker in () if wait else tuple(self._live):
            worker.kill()
        for thread in self._threads:
            thread.join()

    def _serve(self) -> None:
        """What a thread does: keep one worker, give it tasks, replace it when it dies."""
        worker: _Worker | None = None
        while (task := self._tasks.get()) is not None:
            if task.future.set_running_or_notify_cancel():
                worker = self._do(task, worker)
        if worker is not None:
            self._end(worker)

    def _do(self, task: _Task, worker: _Worker | None) -> _Worker | None:
        """Have the task done; returns the worker that is there then."""
        died = ""
        for _ in range(ATTEMPTS):
            if self._abandoned:
                died = "the executor was shut down"
                break
            try:
                worker = worker or self._begin()
                done, value = worker.call(task)
            except EOFError:
                assert worker is not None
                died, worker = f"{ATTEMPTS} workers died of it, the last by {self._end(worker)}", None
            except Exception as error:  # the task cannot be pickled, or no process begun
                task.future.set_exception(error)
                return worker
            else:
                (task.future.set_result if done else task.future.set_exception)(value)
                return worker
        task.future.set_exception(WorkerDiedError(died))
        return worker

    def _begin(self) -> _Worker:
        worker = _Worker()
        self._live.add(worker)
        if self._abandoned:  # meanwhile
            worker.kill()
        return worker

    def _end(self, worker: _Worker) -> str:
        self._live.discard(worker)
        return worker.end()


class _Worker:
    """A process, and the way to it."""

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process: BaseProcess = context.Process(target=_work, args=(theirs,), daemon=True)
        self.process.start()
        theirs.close()

    def call(self, task: _Task) -> tuple[bool, Any]:
        """Whether the call came to a value, and the value or the error.  Raises `EOFError` when the process died."""
        try:
            self.pipe.send(task.call)
            wait([self.pipe, self.process.sentinel])
            answer: tuple[bool, Any] = self.pipe.recv()
        except OSError as error:
            raise EOFError from error
        return answer

    def kill(self) -> None:
        """End the process at once."""
        with contextlib.suppress(ValueError):  # it has ended
            self.process.kill()

    def end(self) -> str:
        """End the process; returns how it ended."""
        self.pipe.close()
        self.process.join(GRACE_S)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()
        code = self.process.exitcode
        self.process.close()
        return f"exit code {code}" if code is None or code >= 0 else signal.Signals(-code).name


def _work(pipe: Connection) -> None:
    """What a worker does, until the other end of the pipe is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the command, which ends its workers itself
    os.dup2(2, 1)  # stdout is for the command's data
    sys.stdout = sys.stderr
    with contextlib.suppress(EOFError, OSError):
        while True:
            function, args, kwargs = pipe.recv()
            try:
                answer = True, function(*args, **kwargs)
            except Exception as error:
                answer = False, error
            try:
                pipe.send(answer)
            except (OSError, EOFError):
                return
            except Exception as error:  # the answer cannot be pickled
                pipe.send((False, TypeError(f"the answer cannot be handed over: {error}")))

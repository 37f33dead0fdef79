"""Executors: what a name stands for, and that each of them is one of `concurrent.futures`."""

from __future__ import annotations

import builtins
import operator
import os
import signal
import socket
import time
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor
from typing import Any

import pytest

from safety.inject.store import StoreError, open_executor
from safety.inject.store.executors import Serial
from safety.inject.store.pool import ATTEMPTS, Processes, WorkerDiedError
from tests.inject import timer_project as timer


@pytest.fixture(scope="module")
def processes() -> Iterator[Processes]:
    with Processes(2) as executor:
        yield executor


@pytest.fixture(params=["serial", "processes"])
def executor(request: pytest.FixtureRequest, processes: Processes) -> Executor:
    return Serial() if request.param == "serial" else processes


def test_values_and_errors_come_back(executor: Executor) -> None:
    assert list(executor.map(operator.mul, range(6), range(6))) == [0, 1, 4, 9, 16, 25]
    with pytest.raises(ZeroDivisionError):
        executor.submit(operator.truediv, 1, 0).result()
    assert executor.submit(int, "12", base=3).result() == 5


def test_what_cannot_be_pickled_is_an_error_of_its_call_only(processes: Processes) -> None:
    with pytest.raises(Exception, match="pickle"):
        processes.submit(lambda: 1).result()
    with pytest.raises(TypeError, match="cannot be handed over"):
        processes.submit(vars, int).result()
    assert processes.submit(abs, -1).result() == 1


def test_a_killed_worker_is_replaced_and_its_task_done_again(processes: Processes) -> None:
    slow = [processes.submit(time.sleep, 0.3) for _ in range(3)]
    timer.until(lambda: len(processes._live) == sum(task.running() for task in slow) == processes.workers)
    for worker in tuple(processes._live):
        assert worker.process.pid is not None
        os.kill(worker.process.pid, signal.SIGKILL)
    assert [task.result() for task in slow] == [None] * 3


def test_a_task_that_ends_each_of_its_workers_is_given_up(processes: Processes) -> None:
    deadly = processes.submit(os._exit, 7)
    assert processes.submit(abs, -2).result() == 2
    with pytest.raises(WorkerDiedError, match=f"{ATTEMPTS} workers died of it, the last by exit code 7"):
        deadly.result()
    killed = processes.submit(os.kill, 0, 0)  # of its own group, signal 0: harmless
    assert killed.result() is None


def test_workers_are_fresh_interpreters_and_leave_stdout_alone(processes: Processes, capfd: Any) -> None:
    assert processes.submit(os.getpid).result() != os.getpid()
    with Processes(1) as executor:
        executor.submit(os.write, 1, b"noise").result()
        executor.submit(print, "more noise", flush=True).result()
    assert capfd.readouterr().out == ""


def test_an_executor_that_is_shut_down_at_once_drops_what_it_had() -> None:
    executor = Processes(1)
    tasks = [executor.submit(time.sleep, 60) for _ in range(2)]
    while not tasks[0].running():
        time.sleep(0.01)
    executor.shutdown(wait=False, cancel_futures=True)
    with pytest.raises(WorkerDiedError, match="shut down"):
        tasks[0].result()
    with pytest.raises(CancelledError):
        tasks[1].result()
    with pytest.raises(RuntimeError, match="shut down"):
        executor.submit(abs, 1)


# --- names -----------------------------------------------------------------------------------------------------------


def test_a_name_says_which_and_how_many() -> None:
    for name, workers in (("serial", 1), ("processes:3", 3)):
        with open_executor(name) as executor:
            assert getattr(executor, "workers", None) == workers
    with open_executor("processes", 5) as executor:
        assert getattr(executor, "workers", None) == 5


@pytest.mark.parametrize("name", ["", "threads", "processes:0", "processes:two", "serial:2", "ray://a:1"])
def test_another_name_is_refused(name: str) -> None:
    with pytest.raises(StoreError, match="give one of serial, processes, processes:N, dask://HOST:PORT"):
        open_executor(name)


@pytest.mark.parametrize("name", ["dask://", "dask://host", "dask://:8786", "dask://host:port", "dask://host:99999"])
def test_an_address_is_a_host_and_a_port(name: str) -> None:
    with pytest.raises(StoreError, match="write dask://HOST:PORT"):
        open_executor(name)


def test_a_scheduler_that_does_not_answer_is_an_error() -> None:
    pytest.importorskip("distributed", reason="Dask is not installed: pip install rightside[cluster]")
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        with pytest.raises(StoreError, match=r"no scheduler answers .* start one with `dask scheduler`"):
            open_executor(f"dask://127.0.0.1:{unused.getsockname()[1]}")


def test_without_dask_the_error_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name == "distributed":
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(StoreError, match=r"pip install rightside\[cluster\]"):
        open_executor("dask://127.0.0.1:8786")

"""Where the shards of a campaign are made: in this process, in others on this machine, or on a Dask cluster.

All of them are a `concurrent.futures.Executor` with `workers`, the number of calls that they make at a time.
"""

from __future__ import annotations

import contextlib
import logging
import os
import pickle
import socket
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from functools import partial
from importlib.util import find_spec
from typing import Any, ParamSpec, TypeVar

from safety.inject.store.pool import GoneError, Processes, WorkerDiedError
from safety.inject.store.shards import StoreError

PATIENCE_S = 5.0  # for the scheduler of a cluster to answer
NEEDED = "safety.inject.store.running"  # on every machine: what it is given to do
WAYS = "serial, processes, processes:N, dask://HOST:PORT"

P = ParamSpec("P")
T = TypeVar("T")


def open_executor(where: str = "processes", workers: int | None = None) -> Executor:
    """The executor that a text names: `serial`, `processes`, `processes:4`, `dask://host:port`.

    `workers`: how many processes, unless the text says so; default one a core.  Raises `StoreError` for another text,
    a cluster that does not answer, or Dask missing.
    """
    kind, _, number = where.partition(":")
    if kind == "dask":
        return Cluster(where)
    if where == "serial":
        return Serial()
    if kind != "processes" or (number and not (number.isdecimal() and int(number))):
        raise StoreError(f"executor {where!r}: give one of {WAYS}")
    return Processes(int(number) if number else workers or os.cpu_count() or 1)


class Serial(Executor):
    """Calls at once, in this process."""

    workers = 1

    def submit(self, function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Call the function now."""
        future: Future[T] = Future()
        try:
            future.set_result(function(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


class Cluster(Executor):
    """The workers of a Dask cluster, however many there are at the time; Dask replaces those that die."""

    def __init__(self, address: str) -> None:
        host, _, port = address.removeprefix("dask://").rpartition(":")
        if not (host and port.isdecimal() and 0 < int(port) < 1 << 16):
            raise StoreError(f"executor {address!r}: write dask://HOST:PORT, the address of the scheduler")
        try:
            import distributed
        except ImportError:
            raise StoreError(f"{address}: Dask is not installed; pip install rightside[cluster]") from None
        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what is of use to the user, we say
        try:
            socket.create_connection((host, int(port)), PATIENCE_S).close()
            client: Any = distributed.Client
            self._client = client(f"tcp://{host}:{port}", timeout=PATIENCE_S, set_as_default=False)
            answer = self._client.run_on_scheduler(find_spec, NEEDED)
        except ImportError as error:
            answer = error
        except (OSError, TimeoutError) as error:
            raise StoreError(
                f"{address}: no scheduler answers ({error}); start one with `dask scheduler`, or correct the address"
            ) from None
        self._executor = self._client.get_executor(pure=False)
        if answer is None or isinstance(answer, ImportError):
            self.shutdown()
            raise _not_found(f"the scheduler {address}", answer)

    @property
    def workers(self) -> int:
        """Threads of all workers; 1 while there is none yet, so that something waits for the first."""
        with _there():
            return sum(self._client.nthreads().values()) or 1

    def submit(self, function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Have some worker call the function; the future raises `StoreError` for a worker without this package."""
        future: Future[T] = Future()
        future.set_running_or_notify_cancel()
        with _there():
            theirs = self._executor.submit(_unpacked_there(partial(function, *args, **kwargs)))
        theirs.add_done_callback(lambda done: _hand_on(done, future))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Leave the cluster; what is still at work there is dropped."""
        with contextlib.suppress(OSError):
            self._executor.shutdown(wait=False)
            self._client.close()


def _unpacked_there(call: Callable[[], T]) -> Callable[[], T]:
    """The call in a form that any worker takes, at whatever time it joins, one without this package too.

    Handed the call itself, that one would leave the cluster without a word.  Here it raises `ImportError` of the name
    `NEEDED`, with its address as the path.
    """
    packed = pickle.dumps(call)

    def unpacked() -> T:  # goes by value, as there is no name to import it by
        try:
            work: Callable[[], T] = pickle.loads(packed)
        except ImportError as error:
            from distributed import get_worker

            raise ImportError(str(error), name=NEEDED, path=get_worker().address) from None
        return work()

    return unpacked


def _not_found(machine: str, why: ImportError | None = None) -> StoreError:
    return StoreError(
        f"{machine} does not find the package safety of rightside{f' ({why})' if why else ''}: install the same "
        "release there, or put it on its PYTHONPATH, and start it again"
    )


@contextlib.contextmanager
def _there() -> Iterator[None]:
    try:
        yield
    except (OSError, TimeoutError) as error:
        raise GoneError(f"the cluster does not answer any more ({error})") from None


def _hand_on(theirs: Future[Any], ours: Future[Any]) -> None:
    error = theirs.exception() if not theirs.cancelled() else None
    if theirs.cancelled():
        ours.set_exception(GoneError("the cluster has dropped what it had in hand"))
    elif type(error).__name__ == "KilledWorker":
        ours.set_exception(WorkerDiedError(str(error)))
    elif isinstance(error, ImportError) and error.name == NEEDED:
        ours.set_exception(_not_found(f"the worker {error.path}", error))
    elif error is not None:
        ours.set_exception(error)
    else:
        ours.set_result(theirs.result())

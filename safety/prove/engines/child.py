"""One engine in a process of its own: the side of the child, and the framed messages that both sides exchange.

The caps are set before anything is read.  A child whose parent is gone ends itself with all that it has started.
"""

from __future__ import annotations

import os
import signal
import struct
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

from safety.prove.engines.engine import Budget, Engine, Result
from safety.prove.engines.transport import packed, unpacked
from safety.prove.problem import Problem
from safety.prove.solve import Disagreement

LENGTH = struct.Struct(">Q")
PARENT_LOOK_S = 0.5


def framed(value: Any) -> bytes:
    """A value as one message."""
    data = packed(value)
    return LENGTH.pack(len(data)) + data


def messages(stream: IO[bytes]) -> Iterator[bytes]:
    """The messages of a stream up to its end, each for `unpacked`; one that was cut off is no message."""
    while len(head := stream.read(LENGTH.size)) == LENGTH.size:
        (length,) = LENGTH.unpack(head)
        data = stream.read(length)
        if len(data) < length:
            return
        yield data


def serve(parent: int, seconds: float, memory_mb: int, scratch: str) -> None:
    """Run the one job that comes on stdin: an engine and a problem.

    To stdout go pairs: whether it is the last, and a result or the disagreement that the engine met.  Everything else
    that is printed goes to stderr.
    """
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    _cap(seconds, memory_mb)
    threading.Thread(target=_end_with, args=(parent,), daemon=True).start()

    def send(last: bool, answer: Result | Disagreement) -> None:
        answers.write(framed((last, answer)))
        answers.flush()

    for job in messages(sys.stdin.buffer):
        one, problem = unpacked(job)
        send(True, _answer(one, problem, Budget(seconds, Path(scratch), lambda result: send(False, result))))


def _answer(one: Engine, problem: Problem, budget: Budget) -> Result | Disagreement:
    try:
        return one.run(problem, budget)
    except Disagreement as error:
        return error
    except MemoryError:
        return Result(one.name, why="it ran out of memory")
    except Exception as error:
        said = f"{error}" if hasattr(error, "exit_code") else f"{type(error).__name__}: {error}"
        return Result(one.name, why=f"it failed: {said}")


def _cap(seconds: float, memory_mb: int) -> None:
    """Limit this process and all that it starts, each by itself; elsewhere than on POSIX only the parent's clock does.

    The processor time is limited too: it ends a child whose solver never looks up, should the parent be gone.
    """
    if sys.platform == "win32":
        return
    import resource

    whole = 2 * int(seconds) + 2
    resource.setrlimit(resource.RLIMIT_AS, (memory_mb << 20, memory_mb << 20))
    resource.setrlimit(resource.RLIMIT_CPU, (whole, whole + 1))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _end_with(parent: int) -> None:
    """End with the parent."""
    while os.getppid() == parent or sys.platform == "win32":
        time.sleep(PARENT_LOOK_S)
    if sys.platform != "win32":
        os.killpg(0, signal.SIGKILL)

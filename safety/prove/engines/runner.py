"""One engine in a process of its own: the side of the parent, which starts it, listens, and ends it with its tools."""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import TypeAlias

from safety.prove.engines.child import framed, messages
from safety.prove.engines.engine import Engine, Result
from safety.prove.engines.transport import unpacked
from safety.prove.problem import Problem
from safety.prove.solve import Disagreement

GRACE_S = 1.0  # an engine knows its time, and has this long to say how far it got
START = (
    "import sys; parent, seconds, memory_mb, scratch, *sys.path = sys.argv[1:]; "
    "from safety.prove.engines.child import serve; serve(int(parent), float(seconds), int(memory_mb), scratch)"
)

Heard: TypeAlias = "queue.Queue[tuple[Runner, bytes | None]]"


class Runner:
    """One engine, its process while it runs, and the thread that listens to it."""

    def __init__(self, one: Engine, scratch: Path) -> None:
        self.engine, self.scratch = one, scratch
        self.process: subprocess.Popen[bytes] | None = None
        self.result = Result(one.name)
        self.began = time.monotonic()

    def late(self, seconds: float) -> bool:
        """Whether it has had its time."""
        return time.monotonic() > self.began + seconds + GRACE_S

    def start(self, problem: Problem, seconds: float, memory_mb: int, heard: Heard) -> None:
        """Start the engine on a problem that can travel; what its process says comes to `heard` as it is."""
        job = framed((self.engine, problem))
        self.scratch.mkdir()
        caps = [str(os.getpid()), str(seconds), str(memory_mb), str(self.scratch)]
        with open(self.scratch / "stderr", "wb") as stderr:
            self.process = subprocess.Popen(
                [sys.executable, "-c", START, *caps, *map(os.path.abspath, sys.path)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=stderr,
                start_new_session=True,  # Ctrl-C is for the parent; the group is ended as one
            )
        self.listener = threading.Thread(target=_exchange, args=(self, self.process, job, heard), daemon=True)
        self.listener.start()

    def hear(self, message: bytes | None) -> None:
        """Take a message, or (None) the end of the process; raises the `Disagreement` that an engine met."""
        if message is None:
            self._gone()
            return
        last, answer = unpacked(message)
        if isinstance(answer, Disagreement):
            raise answer
        self.result = answer
        if last:
            self._stop()

    def end(self, why: str) -> None:
        """End it before its last answer, for a reason; what it has told stays."""
        self._stop()
        self.result.why = "; ".join(filter(None, [self.result.why, why]))

    def _stop(self) -> int:
        """End the process with all that it has started; its exit code."""
        assert self.process is not None
        _kill_group(self.process)
        code = self.process.wait()
        self.listener.join()
        for pipe in (self.process.stdin, self.process.stdout):
            assert pipe is not None
            with contextlib.suppress(BrokenPipeError):
                pipe.close()
        self.process = None
        self.result.seconds = time.monotonic() - self.began
        return code

    def _gone(self) -> None:
        """Find out how the process ended that gave no last answer."""
        assert self.process is not None
        with contextlib.suppress(subprocess.TimeoutExpired):  # it is about to be collected: not to be killed before
            self.process.wait(GRACE_S)
        code = self._stop()
        self.result.why = "; ".join(filter(None, [self.result.why, _end_of(code, self.scratch / "stderr")]))

    def told(self) -> str:
        """The result so far in a line."""
        said = self.result
        steps = "" if said.steps is None else f", {said.steps} steps"
        return f"{said.engine}: {said.verdict}{steps}" + (f" ({said.why})" if said.why else "")


def _exchange(runner: Runner, process: subprocess.Popen[bytes], job: bytes, heard: Heard) -> None:
    """Give a process its job and listen to it until it ends.  Terms are made in the main thread only."""
    assert process.stdin is not None and process.stdout is not None
    with contextlib.suppress(BrokenPipeError):
        process.stdin.write(job)
        process.stdin.close()
    for message in messages(process.stdout):
        heard.put((runner, message))
    heard.put((runner, None))


def _kill_group(process: subprocess.Popen[bytes]) -> None:
    if sys.platform == "win32":
        process.kill()
    else:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)


def _end_of(code: int, stderr: Path) -> str:
    """What became of a process that ended without its last answer, with the last words it left."""
    lines = stderr.read_text(encoding="utf-8", errors="replace").splitlines()
    words = f": {lines[-1].strip()[:200]}" if lines else ""
    if -code == getattr(signal, "SIGXCPU", None):
        return "it has used up its processor time"
    if -code == getattr(signal, "SIGKILL", None):
        return f"it was killed, most likely for want of memory{words}"
    return (f"it crashed (signal {-code})" if code < 0 else f"it ended without an answer (exit code {code})") + words

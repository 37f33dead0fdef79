"""Several engines on one problem, each in its own process; the first conclusive answer ends the others."""

from __future__ import annotations

import contextlib
import queue
import tempfile
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from pathlib import Path

from safety.prove.claims import REFUTED
from safety.prove.engines.engine import NAMES, Engine, Result, engine
from safety.prove.engines.runner import Runner
from safety.prove.engines.transport import portable
from safety.prove.problem import Problem
from safety.prove.solve import Disagreement
from safety.system import ModelError

MEMORY_MB = 4096
TICK_S = 0.1


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a portfolio; `results` are those that were there by then."""

    def __init__(self, results: list[Result]) -> None:
        super().__init__()
        self.results = results


def portfolio(
    problem: Problem,
    engines: Sequence[str | Engine] | None = None,
    *,
    seconds: float = 60.0,
    memory_mb: int = MEMORY_MB,
    workers: int = 2,
    progress: Callable[[str], None] | None = None,
    every_answer: bool = False,
) -> list[Result]:
    """What the engines (by name or as such; all of them by default) find out, in their order.

    At most `workers` run at once, each for `seconds` of wall clock and with `memory_mb` of address space a process
    (POSIX).  The first proof or counterexample ends the rest, unless `every_answer` is asked for.  An engine that was
    ended, has crashed or ran out keeps what it had found by then; `why` says what became of it.  Raises `Disagreement`
    when two answers cannot both be right, `ModelError` for an unknown engine or no room to run one, and `Interrupted`
    for Ctrl-C.
    """
    if seconds <= 0 or memory_mb <= 0 or workers <= 0:
        raise ModelError(
            f"seconds={seconds}, memory_mb={memory_mb}, workers={workers}: a portfolio needs more than 0 of each"
        )
    chosen = [engine(one) if isinstance(one, str) else one for one in (NAMES if engines is None else engines)]
    tell = progress or _quiet
    with tempfile.TemporaryDirectory(prefix="rightside-") as scratch, _Race(portable(problem), seconds) as race:
        waiting = deque(chosen)
        try:
            while (waiting or race.live) and (every_answer or not race.decided):
                while waiting and len(race.live) < workers:
                    race.enter(waiting.popleft(), memory_mb, Path(scratch))
                for told in race.news():
                    tell(told)
            race.end("ended: another engine had answered")
        except KeyboardInterrupt:
            race.end("interrupted")
            raise Interrupted(race.results) from None
    results = [*race.results, *(Result(one.name, why="not started: another engine had answered") for one in waiting)]
    _agree(problem, results)
    return results


def _quiet(_: str) -> None:
    pass


def _agree(problem: Problem, results: Sequence[Result]) -> None:
    for one, other in combinations(results, 2):
        if one.contradicts(other):
            against, held = (one, other) if one.verdict == REFUTED else (other, one)
            raise Disagreement(
                f"{problem.claim.id}: {held.engine} says {held.verdict}, "
                f"{against.engine} has a run of {len(against.trace or [])} steps that breaks it"
            )


class _Race:
    """The engines entered so far: `live` ones, and what all have found, in the order of their entry."""

    def __init__(self, problem: Problem, seconds: float) -> None:
        self.problem, self.seconds = problem, seconds
        self.heard: queue.Queue[tuple[Runner, bytes | None]] = queue.Queue()
        self.runners: list[Runner] = []

    def __enter__(self) -> _Race:
        return self

    def __exit__(self, *_: object) -> None:
        self.end("ended")

    @property
    def live(self) -> list[Runner]:
        return [runner for runner in self.runners if runner.process is not None]

    @property
    def results(self) -> list[Result]:
        return [runner.result for runner in self.runners]

    @property
    def decided(self) -> bool:
        """Whether an engine has ended with a conclusive answer; one that is still checking its own may yet say more."""
        return any(runner.process is None and runner.result.conclusive for runner in self.runners)

    def enter(self, one: Engine, memory_mb: int, scratch: Path) -> None:
        """Start an engine; one that cannot run here has its result at once."""
        runner = Runner(one, scratch / f"{len(self.runners)}")
        self.runners.append(runner)
        missing = one.unavailable()
        if missing is None:
            runner.start(self.problem, self.seconds, memory_mb, self.heard)
        else:
            runner.result.why = missing

    def news(self) -> Iterator[str]:
        """What has happened within a tick: results on the way, and those who have ended."""
        with contextlib.suppress(queue.Empty):
            waiting = TICK_S
            while True:
                runner, message = self.heard.get(timeout=waiting)
                waiting = 0.0
                if runner.process is not None:
                    runner.hear(message)
                    yield runner.told()
        for runner in self.live:
            if runner.late(self.seconds):
                runner.end(f"ended: no answer within {self.seconds:g} s")
                yield runner.told()

    def end(self, why: str) -> None:
        """End all that still run."""
        for runner in self.live:
            runner.end(why)

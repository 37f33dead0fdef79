"""What an engine is asked, and what it answers: runs side by side as arrays, a column a run.

A `Task` is what all runs of a campaign have in common; its `atoms` are the faults that occur in it, each at its points
and without a schedule of its own.  A `Batch` says for each run which atoms act, and from which step to which; an
`Outcome` says what was seen in each run.  The NumPy lanes (`safety.inject.lanes`) and the native kernels
(`safety.inject.native`) are engines; they give the same outcome to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from safety.faults import Fault
from safety.system import ModelError, System, nearest
from safety.terms.graph import REAL, TermError, postorder

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Numbers = npt.NDArray[np.int32]

AUTO, NATIVE, LANES = ENGINES = ("auto", "native", "lanes")
NEVER = 2**31 - 1  # a step or frame that does not come
NONE = -1  # no atom


@dataclass(frozen=True)
class Timing:
    """What is run, in frames: `run_in`, then `measured` in blocks of `block`; a frame is `steps` model steps."""

    run_in: int
    measured: int
    block: int
    steps: int

    @property
    def frames(self) -> int:
        """Frames of a whole run."""
        return self.run_in + self.measured

    @property
    def blocks(self) -> int:
        """Blocks that the measured frames divide into."""
        return self.measured // self.block


@dataclass(frozen=True)
class Task:
    """The system with constant inputs folded in, the faults that occur, what is observed, the stimulus by frame.

    `count` names wires whose true frames are counted, by block; `watch` names wires whose first true frame is
    recorded; both are looked at after the last step of each measured frame.
    """

    system: System
    atoms: tuple[Fault, ...]
    count: tuple[str, ...]
    watch: tuple[str, ...]
    timing: Timing
    inputs: Callable[[int], Mapping[str, Any]]
    start: Mapping[str, Any]


@dataclass(frozen=True)
class Batch:
    """Runs side by side, each with up to k faults at once: arrays of shape (k, runs), int32.

    `atoms`: positions in `Task.atoms`, `NONE` where there is no further fault; `first`: the model step at which the
    fault begins to act (0: from power-up); `end`: the step before which it ends (`NEVER`: it stays).  Faults of one run
    at one point act in the order of their rows.
    """

    atoms: Numbers
    first: Numbers
    end: Numbers

    @property
    def runs(self) -> int:
        """How many runs stand side by side."""
        return int(self.atoms.shape[1])


@dataclass(frozen=True)
class Outcome:
    """What was seen: `counts[wire]`, shape (blocks, runs), true frames; `first[wire]`, shape (runs,), the first true
    measured frame (0 is the first after run-in) or `NEVER`."""

    counts: Mapping[str, Numbers]
    first: Mapping[str, Numbers]


class Engine(Protocol):
    """Something that runs batches of one task."""

    @property
    def name(self) -> str:
        """What it is called: "native" or "lanes"."""

    @property
    def note(self) -> str:
        """What is worth saying about how it ran: why it is not the native one, what was run again; or nothing."""

    @property
    def golden(self) -> Outcome:
        """The fault-free run, as an outcome of one run.

        Raises `CampaignError` when it breaks an assumption of the model.
        """

    def run(self, batch: Batch) -> Outcome:
        """Run a batch; the order of its columns is free, and kept."""


class AutoEngine:
    """The native engine, or the NumPy lanes from where on that is not there or does not take the model or a fault.

    A fault that is built in is compiled with the first batch that has it, so this may come late; what was run before
    stands, for the outcome is the same.  `tick` is that of the lanes.
    """

    def __init__(self, task: Task) -> None:
        self.task, self._reason = task, ""
        self.tick: Callable[[float], None] = lambda share: None
        self._engine: Engine
        try:
            self._engine = native_engine(task)
        except (ImportError, TermError) as reason:
            self._take_lanes(reason)

    @property
    def note(self) -> str:
        """Why the lanes are in use, or what the native engine says of its runs."""
        return self._reason or self._engine.note

    @property
    def name(self) -> str:
        """That of the engine in use."""
        return self._engine.name

    @property
    def golden(self) -> Outcome:
        """The fault-free run; see `Engine`."""
        return self._asked(lambda engine: engine.golden)

    def run(self, batch: Batch) -> Outcome:
        """Run a batch; see `Engine`."""
        return self._asked(lambda engine: engine.run(batch))

    def _asked(self, question: Callable[[Engine], Outcome]) -> Outcome:
        try:
            return question(self._engine)
        except TermError as reason:
            if self._reason:
                raise
            self._take_lanes(reason)
            return question(self._engine)

    def _take_lanes(self, reason: Exception) -> None:
        from safety.inject.lanes import LaneEngine

        lanes = LaneEngine(self.task)
        lanes.tick = lambda share: self.tick(share)
        self._reason = f"NumPy lanes, for the native engine does not take it: {reason}"
        self._engine = lanes


def engine_for(task: Task, name: str = AUTO) -> Engine:
    """The engine of a name.

    "auto" is the native engine, or the NumPy lanes where the model or a fault does not fit it or it is not there.
    Raises `TermError` when "native" is asked for and the model does not fit, `ImportError` when it is not there,
    `ModelError` for an unknown name.
    """
    if name not in ENGINES:
        raise ModelError(f"engine {name!r}; {nearest(name, ENGINES)}")
    if name == AUTO:
        return AutoEngine(task)
    if name == LANES:
        from safety.inject.lanes import LaneEngine

        return LaneEngine(task)
    return native_engine(task)


def native_engine(task: Task) -> Engine:
    """The native engine of a task, that for reals where it has some; raises as `engine_for` does."""
    from safety.inject.native import NativeEngine

    if any(term.sort == REAL for term in postorder([*task.system.roots(), *(s.var for s in task.system.states)])):
        from safety.inject.native.enclosing import EnclosingEngine

        return EnclosingEngine(task)
    return NativeEngine(task)

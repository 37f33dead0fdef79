"""Batches of injections on the NumPy lanes: lane 0 is the fault-free run, each further lane one injection.

A batch carries masks, and a few faults built in one by one (`MOST_BUILT_IN` of them) that no mask can carry; masks
change at the steps at which faults begin and end, and stand still between.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any

from safety.faults import Fault, present_name, schedule
from safety.inject.kernel import BROKEN, Kernel
from safety.inject.masks import KEEP, TURN, Mask, masks, window
from safety.inject.space import CampaignError, Injection, identify
from safety.system import System
from safety.terms.table import is_object
from safety.terms.texts import lane_type
from safety.trace import initial_state

if TYPE_CHECKING:
    import numpy.typing as npt

    Lanes = npt.NDArray[Any]

MOST_LANES = 8192
MOST_BUILT_IN = 24

Row = Mapping[str, Any]
Tick = Callable[[int], None]
ByFault = Mapping[str, Mapping[str, Mask]]  # masks by point, by fault (`identify`)


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
class Batch:
    """Injections that run side by side: positions in the campaign, and the faults built in one by one."""

    positions: tuple[int, ...]
    built_in: tuple[Fault, ...] = ()


@dataclass(frozen=True)
class Plan:
    """The batches of a campaign, and the masks of each fault that has some."""

    batches: tuple[Batch, ...]
    masks: ByFault

    @property
    def points(self) -> list[str]:
        """Points that carry a mask in some injection."""
        return sorted({point for found in self.masks.values() for point in found})


def plan(system: System, injections: Sequence[Injection], timing: Timing, *, most_lanes: int = MOST_LANES) -> Plan:
    """Divide injections into batches.

    Raises `CampaignError` for a fault that does not fit its point, begins after the end or not at a frame's start.
    """
    found: dict[str, Mapping[str, Mask] | None] = {}
    for fault in (f for injection in injections for f in injection.faults):
        if identify(fault) not in found:
            _check_onset(fault, timing)
            found[identify(fault)] = masks(system, fault)
    masks_of = {name: m for name, m in found.items() if m is not None}
    return Plan(tuple(_batches(injections, masks_of, most_lanes)), masks_of)


def _batches(injections: Sequence[Injection], masks_of: ByFault, most_lanes: int) -> Iterator[Batch]:
    """Injections with faults to build in come first, the masked ones fill up their batches and follow in their own."""
    built = {i: found for i, one in enumerate(injections) if (found := to_build_in(one, masks_of))}
    plain = [i for i in range(len(injections)) if i not in built]
    for positions, faults in _chunks(built, most_lanes):
        room = most_lanes - len(positions)
        yield Batch((*positions, *plain[:room]), faults)
        plain = plain[room:]
    yield from (Batch(tuple(plain[k : k + most_lanes])) for k in range(0, len(plain), most_lanes))


def to_build_in(injection: Injection, masks_of: ByFault) -> dict[int, Fault]:
    """The faults of an injection that no mask can carry, by place: those without one, and what shares their points.

    Faults at one point act in the order of their places, which a mask behind a built-in fault could not keep.
    """
    placed = dict(zip(injection.places, injection.faults, strict=True))
    found = {place: fault for place, fault in placed.items() if identify(fault) not in masks_of}
    patterns = [pattern for fault in found.values() for pattern in fault.points]
    return {
        place: fault
        for place, fault in placed.items()
        if place in found
        or any(fnmatchcase(point, pattern) for point in masks_of[identify(fault)] for pattern in patterns)
    }


def _chunks(
    built: Mapping[int, dict[int, Fault]], most_lanes: int
) -> Iterator[tuple[tuple[int, ...], tuple[Fault, ...]]]:
    chosen: list[int] = []
    faults: dict[int, Fault] = {}
    for i, more in built.items():
        if chosen and (len(faults | more) > MOST_BUILT_IN or len(chosen) >= most_lanes):
            yield tuple(chosen), tuple(faults[place] for place in sorted(faults))
            chosen, faults = [], {}
        chosen.append(i)
        faults |= more
    if chosen:
        yield tuple(chosen), tuple(faults[place] for place in sorted(faults))


def _check_onset(fault: Fault, timing: Timing) -> None:
    if timing.steps > 1 and fault.values:
        raise CampaignError(
            f"fault {fault.name!r} has values step by step, but steps_per_frame={timing.steps} holds them for a frame; "
            "use steps_per_frame=1"
        )
    last = timing.frames * timing.steps
    first, end = window(fault)
    if not 0 <= first < last:
        raise CampaignError(
            f"fault {fault.name!r} begins at step {first}, outside the run (0 to {last - 1}); choose another `at`"
        )
    for step in (first, end):
        if step is not None and step % timing.steps:
            near = step - step % timing.steps
            raise CampaignError(
                f"fault {fault.name!r} begins or ends at step {step}, inside a frame of {timing.steps} steps; "
                f"choose {near} or {near + timing.steps}, or a campaign with steps_per_frame=1"
            )


def run_batch(
    kernel: Kernel,
    batch: Batch,
    injections: Sequence[Injection],
    found: Plan,
    rows: Callable[[int], Row],
    timing: Timing,
    start: Mapping[str, Any],
    tick: Tick,
) -> dict[str, Lanes]:
    """Counts of a batch: for each observed wire an array of shape (blocks, 1 + injections); lane 0 is fault-free.

    Raises `CampaignError` when the fault-free run breaks an assumption of the model.
    """
    import numpy as np

    members = [injections[i] for i in batch.positions]
    lanes = 1 + len(members)
    state = _power_up(kernel, start, lanes)
    choose, present = schedule(kernel.faulted), _FaultLanes(kernel, members, found)
    counts = {name: np.zeros((timing.blocks, lanes), dtype=np.int64) for name in kernel.counters if name != BROKEN}
    fixed: tuple[Any, ...] = ()
    free: dict[str, Any] = {}
    for frame in range(timing.frames):
        step = frame * timing.steps
        if step in present.events:
            fixed = kernel.prologue(*present.at(step))
            free = choose(step)
        inputs = _input_lanes(kernel, {**rows(frame), **free}, lanes)
        state = list(kernel.step(*state, *inputs, *fixed))
        for position in kernel.constant:
            state[position] = np.asarray(state[position])
        done = frame + 1 - timing.run_in
        if done >= 0 and done % timing.block == 0:
            for name in counts:
                if done:
                    counts[name][done // timing.block - 1] = state[kernel.counters[name]]
                state[kernel.counters[name]] = np.zeros(lanes, dtype=np.int64)
        tick(frame + 1)
    if np.broadcast_to(state[kernel.counters[BROKEN]], (lanes,))[0]:
        raise CampaignError("the fault-free run breaks an assumption of the model: choose a stimulus that keeps it")
    return counts


def _power_up(kernel: Kernel, start: Mapping[str, Any], lanes: int) -> list[Any]:
    import numpy as np

    states = kernel.faulted.system.states
    values, _ = initial_state(kernel.faulted.system, start)
    known = {s.path: value for s, value in zip(states, values, strict=True)}
    return [np.full(lanes, known.get(s.path, 0), dtype=lane_type(s.var)) for s in kernel.states]


class _FaultLanes:
    """Masks and presences, an array for each of `kernel.faults`; at a step only the lanes that change are touched."""

    def __init__(self, kernel: Kernel, members: Sequence[Injection], found: Plan) -> None:
        import numpy as np

        self.members, self.found, self.names = members, found, [str(t.attr) for t in kernel.faults]
        self.built_in = [to_build_in(injection, found.masks) for injection in members]
        self.present = {identify(f): present_name(i) for i, f in enumerate(kernel.faulted.faults)}
        self.arrays: dict[str, Lanes] = {}
        self.passing: dict[str, Any] = {}
        for term, name in zip(kernel.faults, self.names, strict=True):
            self.passing[name] = term.sort.bounds[1] if name.endswith(KEEP) else 0
            self.arrays[name] = np.full(1 + len(members), self.passing[name], dtype=lane_type(term))
        self.events: dict[int, list[int]] = {0: list(range(1, 1 + len(members)))}
        for lane, injection in enumerate(members, start=1):
            for step in {step for fault in injection.faults for step in _steps(fault)} - {0}:
                self.events.setdefault(step, []).append(lane)

    def at(self, step: int) -> list[Lanes]:
        """The arrays from this step on; call it at each step of `events`, in order."""
        for lane in self.events[step]:
            whole: dict[str, Mask] = {}
            injection = self.members[lane - 1]
            for place, fault in zip(injection.places, injection.faults, strict=True):
                if place in self.built_in[lane - 1]:
                    self.arrays[self.present[identify(fault)]][lane] = True
                    continue
                for point, mask in self.found.masks[identify(fault)].items():
                    before = whole.get(point, Mask(self.passing[point + KEEP], 0))
                    whole[point] = mask.after(before) if _acts(fault, step) else before
            for point, mask in whole.items():
                self.arrays[point + KEEP][lane], self.arrays[point + TURN][lane] = mask.keep, mask.turn
        return [self.arrays[name] for name in self.names]


def _steps(fault: Fault) -> set[int]:
    """Steps at which a fault begins, ends or takes another value."""
    first, end = window(fault)
    changes = max((len(values) for values in (fault.values or {}).values()), default=0)
    return {first, *([] if end is None else [end]), *range(changes)}


def _acts(fault: Fault, step: int) -> bool:
    first, end = window(fault)
    return first <= step and (end is None or step < end)


def _input_lanes(kernel: Kernel, row: Row, lanes: int) -> list[Any]:
    """Inputs of a frame: one number for all lanes, or an array where lanes hold objects."""
    import numpy as np

    return [
        np.full(lanes, row[str(term.attr)], dtype=object)
        if is_object(term.sort)
        else (np.bool_ if term.sort.kind == "bit" else np.int64)(row[str(term.attr)])
        for term in kernel.inputs
    ]

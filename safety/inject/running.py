"""Running a campaign on the lanes, and one of its injections again on the Python reading."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from safety.faults import instrument, schedule
from safety.inject.campaign import Campaign, Progress, observed
from safety.inject.classes import Counts, judge
from safety.inject.kernel import Kernel, build_kernel
from safety.inject.lanes import Batch, Plan, plan, run_batch
from safety.inject.masks import changes_nothing
from safety.inject.result import Result
from safety.inject.space import CampaignError, Injection, identify
from safety.trace import Trace, run

if TYPE_CHECKING:
    import numpy.typing as npt

    ByWire = Mapping[str, npt.NDArray[Any]]

PROGRESS_S = 0.5
HEALTHY = Injection("fault-free", (), "")


def inject(campaign: Campaign, progress: Progress | None) -> Result:
    """Run all batches of a campaign; see `Campaign.inject`."""
    began = time.monotonic()
    todo = plan(campaign.system, campaign.space.injections, campaign.timing)
    kernels = _Kernels(campaign, todo)
    cells: dict[int, str] = {}
    interrupted = False
    try:
        for batch in todo.batches:
            tick = _meter(progress, began, len(cells), len(batch.positions), campaign)
            counts = _counts(campaign, kernels.of(batch), batch, todo, tick)
            cells |= dict(zip(batch.positions, _cells(campaign, counts), strict=True))
    except KeyboardInterrupt:
        interrupted = True
    idle = {name for name, found in todo.masks.items() if changes_nothing(campaign.system, found)}
    effective = {i for i in cells if not all(identify(f) in idle for f in campaign.space.injections[i].faults)}
    return Result(campaign, cells, effective, time.monotonic() - began, interrupted)


class _Kernels:
    """The kernel of a batch: one for all that carry masks only, a new one for each other."""

    def __init__(self, campaign: Campaign, todo: Plan) -> None:
        self.campaign, self.points = campaign, todo.points
        self.masked: Kernel | None = None

    def of(self, batch: Batch) -> Kernel:
        if batch.built_in:
            return self._build(batch)
        if self.masked is None:
            self.masked = self._build(batch)
        return self.masked

    def _build(self, batch: Batch) -> Kernel:
        wires = [observed(name) for name in self.campaign.observe]
        return build_kernel(self.campaign.system, wires, self.points, batch.built_in, self.campaign.steps_per_frame)


def _counts(campaign: Campaign, kernel: Kernel, batch: Batch, todo: Plan, tick: Callable[[int], None]) -> ByWire:
    members = campaign.space.injections
    counts = run_batch(kernel, batch, members, todo, campaign.inputs, campaign.timing, campaign.start, tick)
    return {name: counts[observed(name)] for name in campaign.observe}


def _cells(campaign: Campaign, counts: ByWire) -> list[str]:
    """`direction/detected` of each injection; the fault-free run, lane 0, is judged too and has to come out clean."""
    golden = {name: lanes[:, :1] for name, lanes in counts.items()}
    cells = judge(Counts(counts, golden), campaign.wrong_side, campaign.safe_side, campaign.detected)
    if cells[0] != "neutral/no":
        raise CampaignError(
            f"{campaign.id}: the fault-free run is judged {cells[0]}; correct the judges or the stimulus"
        )
    return cells[1:]


def _meter(progress: Progress | None, began: float, done: int, now: int, campaign: Campaign) -> Callable[[int], None]:
    """What a batch calls after each frame; it passes the share done on, about twice a second."""
    if progress is None:
        return lambda frame: None
    last = time.monotonic()
    total, frames = len(campaign.space.injections), campaign.timing.frames

    def tick(frame: int) -> None:
        nonlocal last
        if (moment := time.monotonic()) - last >= PROGRESS_S or (frame == frames and done + now == total):
            last = moment
            progress((done + now * frame / frames) / total, moment - began)

    return tick


@dataclass(frozen=True)
class Replay:
    """One injection run again: its trace (a step is a model step) and the `direction/detected` cell it comes to."""

    injection: Injection
    trace: Trace
    cell: str


def replay(campaign: Campaign, key: str | int | None, keep: Sequence[str] = ()) -> Replay:
    """Run one injection on the Python reading; see `Campaign.replay`."""
    injection = HEALTHY if key is None else campaign.space.injections[campaign.space.find(key)]
    golden = campaign.healthy_counts
    trace = _run(campaign, injection, keep)
    found = Counts(golden if key is None else _counted(campaign, trace), golden)
    return Replay(injection, trace, judge(found, campaign.wrong_side, campaign.safe_side, campaign.detected)[0])


def healthy_counts(campaign: Campaign) -> ByWire:
    """What is counted in the fault-free run on the Python reading."""
    return _counted(campaign, _run(campaign, HEALTHY, ()))


def _run(campaign: Campaign, injection: Injection, keep: Sequence[str]) -> Trace:
    faulted = instrument(campaign.system, injection.faults)
    choose, timing = schedule(faulted), campaign.timing
    return run(
        replace(faulted.system, assumptions={}),  # the fault-free run of the campaign kept them
        lambda step: {**campaign.inputs(step // timing.steps), **choose(step)},
        timing.frames * timing.steps,
        start=campaign.start,
        keep=list(dict.fromkeys([*(observed(name) for name in campaign.observe), *keep])),
    )


def _counted(campaign: Campaign, trace: Trace) -> ByWire:
    """What the lanes count, from a trace: true wires at the ends of frames, by block."""
    import numpy as np

    t = campaign.timing
    starts = range(t.run_in, t.frames, t.block)
    ends = {name: trace[observed(name)][t.steps - 1 :: t.steps] for name in campaign.observe}
    return {name: np.array([[sum(v[k : k + t.block])] for k in starts]) for name, v in ends.items()}

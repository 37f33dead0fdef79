"""Running a campaign in this process, and one of its injections again on the Python reading."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from safety.faults import instrument, schedule
from safety.inject.campaign import Campaign, Progress
from safety.inject.classes import CELLS
from safety.inject.engine import NEVER, Outcome
from safety.inject.judging import NO_LATENCY, UNDETECTED, UNMADE, Judged, judge
from safety.inject.monitors import observed
from safety.inject.result import Result
from safety.inject.space import Injection, window
from safety.trace import Trace, run

PROGRESS_S = 0.5
SMALLEST, LARGEST = 4096, 2**20  # injections of a range
HEALTHY = Injection("fault-free", (), "")


def inject(campaign: Campaign, progress: Progress | None) -> Result:
    """Run a campaign range by range; see `Campaign.inject`."""
    began = time.monotonic()
    total = len(campaign.space)
    found = Judged.alike(total, UNMADE)
    done, size, interrupted = 0, SMALLEST, False
    meter = _meter(progress, began)
    try:
        while done < total:
            start, end = time.process_time(), min(done + size, total)
            campaign.tick = _part(meter, done / total, end / total)
            found.put(slice(done, end), campaign.judged(done, end))
            done, size = end, _next_size(size, time.process_time() - start)
            meter(done / total)
    except KeyboardInterrupt:
        interrupted = True
    return Result.of(campaign, found, seconds=time.monotonic() - began, interrupted=interrupted)


def _part(meter: Callable[[float], None], low: float, high: float) -> Callable[[float], None]:
    """What is told the share of a part that is done."""
    return lambda share: meter(low + share * (high - low))


def _next_size(size: int, seconds: float) -> int:
    """A range that keeps the processor busy for about as long as it should be until the next report of progress."""
    return min(LARGEST, size * 4 if seconds < PROGRESS_S / 4 else size * 2 if seconds < PROGRESS_S / 2 else size)


def _meter(progress: Progress | None, began: float) -> Callable[[float], None]:
    """What is told the share done; it passes that on, about twice a second, and at the end."""
    if progress is None:
        return lambda share: None
    last, most = time.monotonic(), 0.0

    def meter(share: float) -> None:
        nonlocal last, most
        now, most = time.monotonic(), max(share, most)
        if now - last >= PROGRESS_S or share == 1:
            last = now
            progress(most, now - began)

    return meter


@dataclass(frozen=True)
class Replay:
    """One injection run again: its trace (a step is a model step) and the `direction/detected` cell it comes to.

    `detected_by` and `latency` (frames from the onset) say what found it, where the campaign names detectors.
    """

    injection: Injection
    trace: Trace
    cell: str
    detected_by: str | None = None
    latency: int | None = None


def replay(campaign: Campaign, key: str | int | Injection | None, keep: Sequence[str] = ()) -> Replay:
    """Run one injection on the Python reading; see `Campaign.replay`."""
    if key is None or isinstance(key, Injection):
        injection = key or HEALTHY
    else:
        injection = campaign.space.injection(campaign.space.find(key))
    trace = run_again(campaign, injection, keep)
    seen = outcome(campaign, trace)
    golden = seen if key is None else _golden(campaign, injection.scenario)
    onset = min((window(fault)[0] for fault in injection.faults), default=NEVER) // campaign.steps_per_frame
    found = judge(campaign, seen, golden, onset)
    by, latency = int(found.detector[0]), int(found.latency[0])
    return Replay(
        injection,
        trace,
        CELLS[found.cells[0]],
        None if by == UNDETECTED else list(campaign.detectors)[by],
        None if latency == NO_LATENCY else latency,
    )


def _golden(campaign: Campaign, scenario: int) -> Outcome:
    return campaign.healthy if scenario == 0 else healthy(campaign, scenario)


def healthy(campaign: Campaign, scenario: int = 0) -> Outcome:
    """What is seen of the fault-free run on the Python reading."""
    return outcome(campaign, run_again(campaign, replace(HEALTHY, scenario=scenario)))


def run_again(campaign: Campaign, injection: Injection, keep: Sequence[str] = ()) -> Trace:
    """An injection on the Python reading: what the campaign looks at, and the signals in `keep`."""
    variant = campaign.variant(injection.scenario)
    faulted = instrument(variant.system, injection.faults)
    choose, timing = schedule(faulted), campaign.timing
    return run(
        replace(faulted.system, assumptions={}),  # the fault-free run of the campaign kept them
        lambda step: {**variant.inputs(step // timing.steps), **choose(step)},
        timing.frames * timing.steps,
        start=variant.start,
        keep=list(dict.fromkeys([*(observed(name) for name in campaign.looked_at), *keep])),
    )


def outcome(campaign: Campaign, trace: Trace) -> Outcome:
    """What an engine sees, from a trace: true wires at the ends of measured frames."""
    import numpy as np

    t = campaign.timing
    ends = {name: trace[observed(name)][t.steps - 1 :: t.steps][t.run_in :] for name in campaign.looked_at}
    starts = range(0, t.measured, t.block)
    counts = {n: np.array([[sum(ends[n][k : k + t.block])] for k in starts], np.int32) for n in campaign.observe}
    first = {n: np.array([ends[n].index(True) if True in ends[n] else NEVER], np.int32) for n in campaign.watched}
    return Outcome(
        {observed(name): array for name, array in counts.items()},
        {observed(name): array for name, array in first.items()},
    )

"""How the runs of a campaign come out, for a range of its injections: what a worker computes, and a shard holds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from safety.inject.classes import CELLS, NO_EFFECT, Counts, came, cell, cells_of
from safety.inject.engine import NEVER, NONE, Batch, Outcome
from safety.inject.lanes import LaneEngine
from safety.inject.monitors import observed
from safety.inject.space import CampaignError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from safety.inject.campaign import Campaign
    from safety.inject.ranks import Positions

    Bytes = npt.NDArray[np.uint8]
    Frames = npt.NDArray[np.uint32]

HAZARD, SAFE = "hazard", "safe"  # names of what a campaign in the declarative form looks at
UNMADE, UNDETECTED, NO_LATENCY = 255, 255, 2**32 - 1


def detector(label: str) -> str:
    """The name under which a detector is looked at."""
    return f"detector {label}"


@dataclass(frozen=True, eq=False)
class Judged:
    """How each injection of a range came out, by number.

    `cells`: places in `CELLS`, or `UNMADE`; `detector`: place in the campaign's `detectors` of the one that came first,
    or `UNDETECTED`; `latency`: frames from the (first) onset to that detection, or `NO_LATENCY`.  Judging functions do
    not say by what a fault is detected, nor when.
    """

    cells: Bytes
    detector: Bytes
    latency: Frames

    def __len__(self) -> int:
        return len(self.cells)

    @classmethod
    def alike(cls, number: int, cell: int) -> Judged:
        """So many injections in one cell, without a detector."""
        import numpy as np

        return cls(
            np.full(number, cell, np.uint8),
            np.full(number, UNDETECTED, np.uint8),
            np.full(number, NO_LATENCY, np.uint32),
        )

    @property
    def arrays(self) -> tuple[Any, Any, Any]:
        """The three of them."""
        return self.cells, self.detector, self.latency

    def put(self, where: Any, others: Judged) -> None:
        """Enter others at some places, or from some place on."""
        for own, new in zip(self.arrays, others.arrays, strict=True):
            own[where] = new

    def same(self, other: Judged) -> Any:
        """Whether each injection came out as the other says."""
        return (self.cells == other.cells) & (self.detector == other.detector) & (self.latency == other.latency)


def judged(campaign: Campaign, low: int, high: int) -> Judged:
    """Run and judge the injections numbered `low` to `high` (not included); see `Campaign.judged`."""
    found = Judged.alike(high - low, UNMADE)
    for scenario, start, end in _by_scenario(campaign, low, high):
        part = _collapsed(campaign, scenario, start, end)
        if campaign.audit:
            _compare(campaign, start, part, _plain(campaign, scenario, start, end))
        found.put(slice(start - low, end - low), part)
    return found


def _by_scenario(campaign: Campaign, low: int, high: int) -> Iterator[tuple[int, int, int]]:
    """The scenarios of a range, each with its part of it: injections stand in the order of their scenarios."""
    import numpy as np

    space = campaign.space
    scenarios = space.positions(low, high) // space.in_a_scenario
    found, starts = np.unique(scenarios, return_index=True)
    for scenario, start, end in zip(found, starts, [*starts[1:], high - low], strict=True):
        yield int(scenario), low + int(start), low + int(end)


def _plain(campaign: Campaign, scenario: int, low: int, high: int) -> Judged:
    batch = campaign.space.batch(low, high)
    return _run(campaign, scenario, batch, onset_frames(campaign, batch))


def _collapsed(campaign: Campaign, scenario: int, low: int, high: int) -> Judged:
    """Run what stands for the injections of the range, each once; all others come out as that."""
    import numpy as np

    collapse, space = campaign.collapse(scenario), campaign.space
    batch = space.batch(low, high)
    if not campaign.collapsing or collapse.nothing:
        return _run(campaign, scenario, batch, onset_frames(campaign, batch))
    members = batch.atoms.astype(np.int64)
    led = collapse.representatives(members)
    other = np.flatnonzero((led != members).any(axis=0))
    source = np.arange(high - low)
    source[other] = _sources(campaign, scenario, low, high, led[:, other], other, batch.first.min(axis=0)[other])
    run = np.flatnonzero((source == np.arange(high - low)) & (led != NONE).any(axis=0))
    found = Judged.alike(high - low, NO_EFFECT)
    windows = space.when(space.positions(low, high)[run], led[:, run])
    again = Batch(*(array.astype(np.int32) for array in (led[:, run], *windows)))
    found.put(run, _run(campaign, scenario, again, onset_frames(campaign, batch)[run]))
    return Judged(*(array[source] for array in found.arrays))


def _sources(
    campaign: Campaign, scenario: int, low: int, high: int, led: Positions, columns: Positions, onset: Positions
) -> Positions:
    """For columns of a range, and what is run for them, the column of the range that comes out the same."""
    import numpy as np

    space = campaign.space
    times = space.positions(low, high)[columns] % space.in_a_scenario % space.times
    keys = onset.astype(np.int64)  # a latency counts from it
    for row in led:
        keys = keys * (len(space.singles) + 1) + row + 1
    _, first, like = np.unique(keys, return_index=True, return_inverse=True)
    found = columns[first][like]  # the first that is alike
    whole = np.flatnonzero((led != NONE).all(axis=0) & (np.diff(led, axis=0) > 0).all(axis=0))
    there = scenario * space.in_a_scenario + space.combinations.position(led[:, whole]) * space.times + times[whole]
    numbers = space.number(there) - low
    inside = (numbers >= 0) & (numbers < high - low)
    found[whole[inside]] = numbers[inside]  # or the one that is run for itself
    return np.asarray(found)


def _compare(campaign: Campaign, low: int, collapsed: Judged, plain: Judged) -> None:
    import numpy as np

    wrong = np.flatnonzero(~collapsed.same(plain))
    if len(wrong):
        one = campaign.space.injection(low + int(wrong[0]))
        told = [CELLS[judged.cells[wrong[0]]] for judged in (collapsed, plain)]
        raise CampaignError(
            f"{campaign.id}: collapsing is wrong for {len(wrong)} of {len(plain)} injections: {one.id} comes out as "
            f"{told[0]} collapsed and {told[1]} when run; run with collapsing=False and report this"
        )


def _run(campaign: Campaign, scenario: int, batch: Batch, onset: Any) -> Judged:
    """Run a batch and judge it; `onset`: the frame of the first fault of each run.

    Raises `CampaignError` when the fault-free run is judged faulty.
    """
    engine = campaign.engine_of(scenario)
    if isinstance(engine, LaneEngine):
        engine.tick = campaign.tick
    outcome = engine.run(batch) if batch.runs else None
    golden = engine.golden  # judged even where nothing is run, and cheapest after a run
    healthy = judge(campaign, golden, golden, NEVER)
    if healthy.cells[0] != NO_EFFECT:
        where = f" of scenario {scenario}" if campaign.vary else ""
        raise CampaignError(
            f"{campaign.id}: the fault-free run{where} is judged {CELLS[healthy.cells[0]]}; "
            "correct the judges or the stimulus"
        )
    if outcome is None:
        return Judged.alike(0, NO_EFFECT)
    return judge(campaign, outcome, golden, onset)


def onset_frames(campaign: Campaign, batch: Batch) -> Any:
    """The frame at which the first fault of each run begins."""
    import numpy as np

    return np.where(batch.atoms == NONE, NEVER, batch.first).min(axis=0) // campaign.steps_per_frame


def named(outcome: Outcome) -> Outcome:
    """The outcome by the names that the campaign gives to what it looks at."""
    cut = len(observed(""))
    counts, first = ({name[cut:]: array for name, array in a.items()} for a in (outcome.counts, outcome.first))
    return Outcome(counts, first)


def judge(campaign: Campaign, outcome: Outcome, golden: Outcome, onset: Any) -> Judged:
    """Judge what was seen; `onset`: the frame of the first fault of each run, `NEVER` for none."""
    import numpy as np

    if campaign.hazard is None:
        assert campaign.wrong_side is not None and campaign.detected is not None
        counts = Counts(named(outcome), named(golden))
        cells = cells_of(counts, campaign.wrong_side, campaign.safe_side, campaign.detected)
        found = Judged.alike(len(cells), NO_EFFECT)
        found.cells[:] = cells
        return found
    first = named(outcome).first
    hazard = first[HAZARD]
    never = np.full_like(hazard, NEVER)
    by = np.stack([first[detector(label)] for label in campaign.detectors] or [never])
    earliest = by.min(axis=0)
    found = came(earliest) & (earliest <= hazard)
    cells = cell(came(hazard), came(first[SAFE]) if campaign.safe else never != NEVER, found)
    after = campaign.timing.run_in + earliest.astype(np.int64) - onset
    return Judged(
        cells,
        np.where(found, by.argmin(axis=0), UNDETECTED).astype(np.uint8),
        np.where(found, after, NO_LATENCY).astype(np.uint32),
    )

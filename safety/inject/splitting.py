"""Rare events by multilevel splitting: runs that come near the event are continued many times over.

A level function says how near a state is; the probability of the event is the product of the probabilities of getting
from each level to the next, each of which is large enough to be counted.  Fixed effort (L'Ecuyer, Demers and Tuffin,
ACM Transactions on Modeling and Computer Simulation 17, 2007): every stage makes the same number of runs, from states
drawn at random among those in which the level was reached.  The estimate is unbiased for every choice of levels.

The interval is Student's t over independent replications.  It is asymptotic: unlike the bounds of
`safety.inject.statistics` it is no guarantee.  It does not cover ways to the event that no run has found, nor the
skewness of few replications, nor anything about how well the process describes the equipment.

    class Train:  # any object with these four methods; states are arrays, a run a row
        def start(self, runs, rng): ...   # states at the start
        def step(self, states, rng): ...  # states one step later
        def over(self, states): ...       # whether a run has ended without the event
        def level(self, states): ...      # how near it is
    found = splitting(Train(), levels=[1, 2, 3], runs=1000, replications=20, seed=1)
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from safety.inject.statistics.binomial import beta_quantile
from safety.inject.statistics.tails import one_tail

States = npt.NDArray[Any]
Numbers = npt.NDArray[Any]
Generator = np.random.Generator


class Process(Protocol):
    """A Markov process as it is simulated: arrays of states with the first axis for the runs.

    All that the future depends on is in the state, the time too if the run ends at a time.
    """

    def start(self, runs: int, rng: Generator) -> States:
        """The states at the start of so many runs."""

    def step(self, states: States, rng: Generator) -> States:
        """The states one step later."""

    def over(self, states: States) -> Numbers:
        """Whether each run has ended without the event; a run that has reached the last level has not."""

    def level(self, states: States) -> Numbers:
        """How near each run is to the event; larger is nearer."""


@dataclass(frozen=True)
class RareEvent:
    """The probability that a run reaches the last level before it is over, and what it took to find.

    `relative_error`: estimated standard error / estimate.  `stages`: probability of each level after the one before.
    `runs`, `steps`: simulated in all.  `steps_per_plain_run`: mean length of a run without splitting.
    """

    estimate: float
    low: float
    high: float
    confidence: float
    relative_error: float
    stages: tuple[float, ...]
    replications: int
    runs: int
    steps: int
    steps_per_plain_run: float
    kind = "sampled, asymptotic"

    @property
    def plain_runs(self) -> float:
        """How many runs without splitting have the same relative error: (1 - p)/(p error^2)."""
        return (1 - self.estimate) / (self.estimate * self.relative_error**2) if self.relative_error else math.inf

    @property
    def plain_steps(self) -> float:
        """How many simulated steps those runs take."""
        return self.plain_runs * self.steps_per_plain_run

    def to_json(self) -> dict[str, Any]:
        """All of it with plain numbers; the key `kind` says what sort of interval it is."""
        names = ("estimate", "low", "high", "confidence", "relative_error", "replications", "runs", "steps", "kind")
        plain = {name: getattr(self, name) for name in (*names, "plain_runs", "plain_steps")}
        return plain | {"stages": list(self.stages)}


def splitting(
    process: Process,
    levels: Sequence[float],
    *,
    runs: int,
    seed: int,
    replications: int = 20,
    confidence: float = 0.95,
    most_steps: int = 1_000_000,
) -> RareEvent:
    """Estimate the probability of reaching the last of the rising `levels`, with `runs` runs a stage and replication.

    Raises `ValueError` when the levels do not rise, there are under 2 replications, no run reaches some level, or a run
    takes more than `most_steps` steps from one level to the next.
    """
    if not levels or any(b <= a for a, b in itertools.pairwise(levels)):
        raise ValueError(f"levels {list(levels)}: name at least one, each above the one before")
    if runs < 1 or replications < 2:
        raise ValueError(f"runs={runs}, replications={replications}: give at least 1 run and 2 replications")
    rng = np.random.default_rng(seed)
    states = process.start(runs * replications, rng)
    replication = np.repeat(np.arange(replications), runs)
    estimates = np.ones(replications)
    stages, made, walked, plain, reaching = [], 0, 0, 0.0, 1.0
    for level in levels:
        reached, steps = _stage(process, states, level, rng, most_steps)
        made, walked = made + len(states), walked + steps
        plain += reaching * steps / len(states)
        hits = np.bincount(replication[reached.rows], minlength=replications)
        if not hits.any():
            raise ValueError(f"none of {len(states)} runs reaches level {level}; put one below it, or make more runs")
        estimates *= hits / runs
        stages.append(float(hits.sum() / len(states)))
        reaching *= stages[-1]
        ends = np.cumsum(hits)
        left = np.flatnonzero(hits)
        draws = [rng.integers(ends[i] - hits[i], ends[i], runs) for i in left]
        states, replication = reached.states[np.concatenate(draws)], np.repeat(left, runs)
    estimate = float(estimates.mean())
    error = float(estimates.std(ddof=1)) / math.sqrt(replications)
    reach = student(confidence, replications - 1) * error
    return RareEvent(
        estimate, max(estimate - reach, 0.0), min(estimate + reach, 1.0), confidence, error / estimate, tuple(stages),
        replications, made, walked, plain,
    )  # fmt: skip


def pilot_levels(
    process: Process, goal: float, *, runs: int, seed: int, share: float = 0.2, most_steps: int = 1_000_000
) -> list[float]:
    """Levels up to `goal`, each reached from the one before by about `share` of the runs, found by trial.

    Use another seed for `splitting` itself: then the estimate stays unbiased.  Raises `ValueError` when no run gets any
    higher, or 0 < share < 1 does not hold.
    """
    if not 0 < share < 1:
        raise ValueError(f"share {share}: it lies between 0 and 1, e.g. 0.2")
    rng = np.random.default_rng(seed)
    states = process.start(runs, rng)
    levels = [float(np.max(process.level(states)))]
    while levels[-1] < goal:
        highest = np.sort(_stage(process, states, goal, rng, most_steps)[0].highest)[::-1]
        usual = float(highest[max(int(share * len(highest)) - 1, 0)])
        above = highest[highest > levels[-1]]
        if not len(above):
            raise ValueError(f"none of {runs} runs gets above level {levels[-1]} towards {goal}; make more runs")
        levels.append(min(usual if usual > levels[-1] else float(above.min()), goal))
        entered = _stage(process, states, levels[-1], rng, most_steps)[0].states
        if not len(entered):
            raise ValueError(f"none of {runs} runs reaches level {levels[-1]} again; make more runs")
        states = entered[rng.integers(0, len(entered), runs)]
    return levels[1:]


@dataclass(frozen=True)
class _Reached:
    """Which runs of a stage reached its level and in which states, in the order of the runs; the highest of each."""

    rows: Numbers
    states: States
    highest: Numbers


def _stage(process: Process, states: States, level: float, rng: Generator, most_steps: int) -> tuple[_Reached, int]:
    """Carry every run on until it reaches `level` or is over; also how many steps that took in all."""
    rows = np.arange(len(states))
    ends = states.copy()
    highest = np.array(process.level(states), dtype=float)
    steps = 0
    for _ in range(most_steps):
        going = ~((highest[rows] >= level) | process.over(states))
        rows, states = rows[going], states[going]
        if not len(rows):
            hit = np.flatnonzero(highest >= level)
            return _Reached(hit, ends[hit], highest), steps
        states = process.step(states, rng)
        steps += len(rows)
        ends[rows] = states
        highest[rows] = np.maximum(highest[rows], process.level(states))
    raise ValueError(
        f"{len(rows)} runs are neither over nor at level {level} after {most_steps} steps; over() ends a run"
    )


def student(confidence: float, freedom: int) -> float:
    """The t that Student's distribution exceeds in absolute value with probability 1 - confidence."""
    x = beta_quantile(float(2 * one_tail(confidence)), freedom / 2, 0.5)
    return math.sqrt(freedom * (1 - x) / x)

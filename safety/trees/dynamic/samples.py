"""A dynamic tree under many rate vectors at once, for the uncertainty of its result: plain doubles, no enclosures.

All samples share the states found once; each step of uniformisation is one operation on a matrix of states by samples.
Rates per hour, times in hours.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from safety.rates.exceptions import NumericsFailed
from safety.rates.numeric import MOST_STEPS
from safety.trees.as_written import TreeError
from safety.trees.dynamic.solve import DynamicSolution
from safety.trees.dynamic.states import States
from safety.trees.dynamic.tree import TimedEvent

CELLS = 4_000_000  # numbers of a matrix of transitions by samples


def probabilities(solution: DynamicSolution, rates: Mapping[str, Sequence[float]], time_h: float) -> array[float]:
    """The probability that the top has failed by `time_h`, for each of n samples.

    `rates` gives n rates for some of the events; the others keep theirs. Relative error about 1e-14 x fastest rate x
    time. Raises TreeError: an unknown event or one of rate 0, unequal lengths, a negative rate, unequal rates of events
    that were taken to be alike (solve with symmetry=False); NumericsFailed where rates differ too much.
    """
    columns, count = _columns(solution, rates)
    if time_h < 0:
        raise TreeError(f"time is {time_h} h, expected 0 or more")
    known: dict[str, Any] = {}
    for part in solution.parts:
        if part.static is None:
            states = solution.states[part.name]
            _check_alike(states, columns)
            width = max(1, CELLS // max(1, len(states.source)))
            pieces = [_chain(states, columns, slice(at, at + width), time_h, count) for at in range(0, count, width)]
            known[part.name] = np.concatenate(pieces) if pieces else np.zeros(0)
        else:
            rows = [
                known[e.name] if e.name in known else _chance(solution, columns, e.name, time_h, count)
                for e in part.static.events
            ]
            known[part.name] = np.array(solution.diagrams[part.name].many(np.ascontiguousarray(rows)))
    return array("d", known[solution.tree.top].tolist())


def _columns(solution: DynamicSolution, rates: Mapping[str, Sequence[float]]) -> tuple[dict[str, Any], int]:
    columns = {name: np.array(values, float) for name, values in rates.items()}
    if len({len(values) for values in columns.values()}) != 1:
        sizes = ", ".join(f"{name}: {len(values)}" for name, values in columns.items())
        raise TreeError(f"expected as many rates for each event, at least one event; got {sizes or 'none'}")
    for name, values in columns.items():
        event = solution.tree.nodes.get(name)
        if not isinstance(event, TimedEvent) or not event.rate_per_hour:
            raise TreeError(
                f'rates are given for "{name}", which is no event with a rate above 0; correct the name', name
            )
        if not (values >= 0).all():
            raise TreeError(f'a rate of event "{name}" is {values.min()}, expected 0 or more', name)
    return columns, len(next(iter(columns.values())))


def _check_alike(states: States, columns: Mapping[str, Any]) -> None:
    for alike in states.equal_events:
        if len({columns[name].tobytes() if name in columns else b"" for name in alike}) > 1:
            raise TreeError(
                f"events {', '.join(sorted(alike))} were taken to be alike, but their rates differ; give all of them "
                "one row of rates, or solve with symmetry=False",
                min(alike),
            )


def _chance(solution: DynamicSolution, columns: Mapping[str, Any], name: str, time_h: float, count: int) -> Any:
    event = solution.tree.nodes[name]
    assert isinstance(event, TimedEvent)
    if event.probability is not None:
        return np.full(count, float(event.probability))
    rate = columns[name] if name in columns else np.full(count, float(event.rate_per_hour or 0))
    return -np.expm1(-rate * time_h)


def _chain(states: States, columns: Mapping[str, Any], piece: slice, time_h: float, count: int) -> Any:
    """One chain, for the samples of `piece`."""
    width = len(range(count)[piece])
    rate_of = np.empty((len(states.causes), width))
    for row, cause in zip(rate_of, states.causes, strict=True):
        event = states.tree.events[cause.event]
        own = columns[event.name][piece] if event.name in columns else float(event.rate_per_hour or 0)
        row[:] = own * float(cause.factor * (1 if cause.active else event.dormancy))
    start = np.zeros((states.count, width))
    for state, chance in states.start.items():
        start[state] = float(chance)
    if states.failed is None or not len(states.source):
        return np.zeros(width) if states.failed is None else start[states.failed]

    by_source = np.argsort(states.source, kind="stable")
    leaving, first = np.unique(states.source[by_source], return_index=True)
    out = np.zeros((states.count, width))
    out[leaving] = np.add.reduceat(rate_of[states.cause[by_source]], first, axis=0)
    fastest = np.maximum(out.max(0), 1e-300)
    jumps = fastest * time_h
    longest = float(jumps.max())
    if longest > MOST_STEPS:
        raise NumericsFailed(f"{longest:.1e} steps are too many; ask for a shorter time or a narrower range of rates")

    by_target = np.argsort(states.target, kind="stable")
    source, chance_of = states.source[by_target], rate_of / fastest
    arriving, first = np.unique(states.target[by_target], return_index=True)
    cause, stay = states.cause[by_target], 1.0 - out / fastest
    total, now = np.zeros(width), start
    with np.errstate(divide="ignore"):
        log_jumps = np.log(jumps)
    for step in range(int(longest + 9 * math.sqrt(longest)) + 40):
        poisson = np.exp(-jumps + step * log_jumps - math.lgamma(step + 1)) if step else np.exp(-jumps)
        total += poisson * now[states.failed]
        moved = np.add.reduceat(now[source] * chance_of[cause], first, axis=0)
        now = now * stay
        now[arriving] += moved
    return np.minimum(total, 1.0)

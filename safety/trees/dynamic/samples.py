"""A dynamic tree under many rate vectors at once, for the uncertainty of its result: plain doubles, no enclosures.

All samples share the states found once; each step of uniformisation is one operation on a matrix of states by samples.
Rates per hour, times in hours.
"""

from __future__ import annotations

import itertools
import math
from array import array
from collections.abc import Mapping, Sequence
from functools import reduce
from typing import Any

import numpy as np

from safety.rates.exceptions import NumericsFailed
from safety.rates.numeric import MOST_STEPS
from safety.trees.as_written import TreeError
from safety.trees.dynamic.solve import DynamicSolution, checked_time
from safety.trees.dynamic.states import States
from safety.trees.dynamic.tree import TimedEvent

NONE: Mapping[str, Any] = {}
SETTLED = 1e-17  # chance to be still on the way, relative to that of having failed, at which no step is made any more
MOST_CHANCES = 8  # sampled fixed probabilities in one chain, which is searched for each combination of them
CELLS = 4_000_000  # numbers of a matrix of transitions by samples


def probabilities(
    solution: DynamicSolution,
    rates: Mapping[str, Sequence[float]],
    time_h: float,
    chances: Mapping[str, Sequence[float]] = NONE,
) -> array[float]:
    """The probability that the top has failed by `time_h`, for each of n samples.

    `rates` gives n rates for some of the events, `chances` n probabilities for some of those with a fixed one; the
    others keep theirs. Where parts that were taken to be alike get unequal rates, their states are searched anew.
    Relative error about 1e-14 x fastest rate x time. Raises TreeError: an unknown event or one of rate 0, unequal
    lengths, a negative rate, a probability outside 0..1, more than MOST_CHANCES of these in one chain, a time out of
    range; TooLarge; NumericsFailed where rates differ too much.
    """
    columns, count = _columns(solution, rates, chances)
    checked_time(time_h)
    known: dict[str, Any] = {}
    for part in solution.parts:
        if part.static is None:
            known[part.name] = _part(solution, part.name, columns, time_h, count)
        else:
            rows = [
                known[e.name] if e.name in known else _chance(solution, columns, e.name, time_h, count)
                for e in part.static.events
            ]
            known[part.name] = np.array(solution.diagrams[part.name].many(np.ascontiguousarray(rows)))
    return array("d", known[solution.tree.top].tolist())


def _columns(
    solution: DynamicSolution, rates: Mapping[str, Sequence[float]], chances: Mapping[str, Sequence[float]]
) -> tuple[dict[str, Any], int]:
    columns = {name: np.array(values, float) for name, values in (*rates.items(), *chances.items())}
    if len({len(values) for values in columns.values()}) != 1:
        sizes = ", ".join(f"{name}: {len(values)}" for name, values in columns.items())
        raise TreeError(f"expected as many rates for each event, at least one event; got {sizes or 'none'}")
    _check_chances(solution, {name: columns[name] for name in chances})
    for name in rates:
        values = columns[name]
        event = solution.tree.nodes.get(name)
        if not isinstance(event, TimedEvent) or not event.rate_per_hour:
            raise TreeError(
                f'rates are given for "{name}", which is no event with a rate above 0; correct the name', name
            )
        if not (values >= 0).all():
            raise TreeError(f'a rate of event "{name}" is {values.min()}, expected 0 or more', name)
    return columns, len(next(iter(columns.values())))


def _check_chances(solution: DynamicSolution, chances: Mapping[str, Any]) -> None:
    for name, values in chances.items():
        event = solution.tree.nodes.get(name)
        if not isinstance(event, TimedEvent) or event.probability is None:
            raise TreeError(
                f'probabilities are given for "{name}", which is no event with a probability; correct the name', name
            )
        if not ((values >= 0) & (values <= 1)).all():
            raise TreeError(f'a probability of event "{name}" is {values.min()}, expected 0 to 1', name)


def _part(solution: DynamicSolution, part: str, columns: Mapping[str, Any], time_h: float, count: int) -> Any:
    """The top of one chain: the mean over whether the events of sampled fixed probability are there."""
    events = solution.states[part].tree.events
    sampled = [event.name for event in events if event.probability is not None and event.name in columns]
    if len(sampled) > MOST_CHANCES:
        raise TreeError(
            f'the Markov chain of "{part}" has {len(sampled)} uncertain probabilities ({", ".join(sampled[:5])}, ...), '
            f"at most {MOST_CHANCES} are sampled; give the others plain numbers",
            sampled[0],
        )
    total = np.zeros(count)
    for there in itertools.product((False, True), repeat=len(sampled)):
        given = dict(zip(sampled, there, strict=True))
        states = solution.states_given(part, given)
        if not _are_alike(states, {name: column for name, column in columns.items() if name not in given}):
            states = solution.states_given(part, given, symmetry=False)
        width = max(1, CELLS // max(1, len(states.source)))
        pieces = [_chain(states, columns, slice(at, at + width), time_h, count) for at in range(0, count, width)]
        weights = (
            columns[name] if is_there else 1 - columns[name] for name, is_there in zip(sampled, there, strict=True)
        )
        if pieces:
            total += reduce(np.multiply, weights, np.concatenate(pieces))
    return total


def _are_alike(states: States, columns: Mapping[str, Any]) -> bool:
    """Whether events that were taken to be alike have the same rates in every sample."""
    return all(
        len({columns[name].tobytes() if name in columns else b"" for name in alike}) == 1
        for alike in states.equal_events
    )


def _chance(solution: DynamicSolution, columns: Mapping[str, Any], name: str, time_h: float, count: int) -> Any:
    event = solution.tree.nodes[name]
    assert isinstance(event, TimedEvent)
    if event.probability is not None:
        return columns.get(name, np.full(count, float(event.probability)))
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
    with np.errstate(over="ignore"):
        jumps = fastest * time_h
    if not np.isfinite(jumps).all():
        raise NumericsFailed("a rate times the time is beyond all doubles; ask for a shorter time or lower rates")

    by_target = np.argsort(states.target, kind="stable")
    source, chance_of = states.source[by_target], rate_of / fastest
    arriving, first = np.unique(states.target[by_target], return_index=True)
    cause, stay = states.cause[by_target], 1.0 - out / fastest
    total, passed, now = np.zeros(width), np.zeros(width), start
    moving = out.max(1) > 0
    enough = jumps + 9 * np.sqrt(jumps) + 40  # jumps: more have no chance that counts
    with np.errstate(divide="ignore"):
        log_jumps = np.log(jumps)
    for step in range(int(enough.max())):
        if step > MOST_STEPS:
            raise NumericsFailed(f"more than {step} steps are too many; ask for a shorter time or less different rates")
        if step % 64 == 63 and (now[moving].sum(0) <= SETTLED * now[states.failed]).all():
            total += np.where(step < enough, 1 - passed, 0.0) * now[states.failed]
            break
        poisson = np.exp(-jumps + step * log_jumps - math.lgamma(step + 1)) if step else np.exp(-jumps)
        passed += poisson
        total += poisson * now[states.failed]
        moved = np.add.reduceat(now[source] * chance_of[cause], first, axis=0)
        now = now * stay
        now[arriving] += moved
    return np.minimum(total, 1.0)

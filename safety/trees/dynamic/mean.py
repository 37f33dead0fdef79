"""Mean time to failure of a tree in parts that is too large for one chain: certified bounds from its curve.

The mean is the integral of the chance to survive, which never rises: sums from the left and from the right of every
interval enclose it. Beyond the last time, the top waits for the parts to come to their ends at most, of which each is
at most so many steps away that take at most so long. Times in hours.
"""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np

from safety.rates.enclosure import INFINITE, Enclosure
from safety.trees.dynamic.solve import DynamicSolution
from safety.trees.dynamic.tree import TimedEvent

POINTS = 1000  # of the final sums; the bounds are about 4/POINTS of the mean apart
COARSE = 64
TAIL = 1e-6  # of the mean, beyond the last time


def bounded_mean_time(solution: DynamicSolution, points: int = POINTS) -> Enclosure:
    """Bounds of the mean time to failure, infinite where the top may never fail. Raises NumericsFailed."""
    if solution.ever.low < 1:
        return Enclosure(Fraction(0) if solution.ever.high == 1 else INFINITE, INFINITE)
    longest = _longest_wait(solution)
    end = Fraction(longest) * 64  # survived with a chance below 2**-32, as twice the longest wait is with one of 1/2
    while True:
        earlier = end / 4
        if (1 - Fraction(solution.probability(earlier).low)) * longest > TAIL * float(earlier) / 10:
            break
        end = earlier
    coarse = [Fraction(0), *(end / Fraction(2) ** power for power in range(COARSE // 2, -1, -1))]
    chances = [float(one.middle) for one in solution.probabilities(coarse)]
    hours = np.array([float(time) for time in coarse])
    density = np.concatenate([[0.0], np.cumsum(np.sqrt(np.maximum(np.diff(chances), 0.0) * np.diff(hours)))])
    spread = np.interp(np.linspace(0.0, density[-1], points), density, hours)
    times = sorted({Fraction(0), end, *(Fraction(float(time)) for time in spread)})
    survival = [(1 - Fraction(one.high), 1 - Fraction(one.low)) for one in solution.probabilities(times)]
    steps = [after - before for before, after in pairwise(times)]
    low = sum((step * after[0] for step, after in zip(steps, survival[1:], strict=True)), Fraction(0))
    high = sum((step * before[1] for step, before in zip(steps, survival, strict=False)), Fraction(0))
    return Enclosure(low, high + survival[-1][1] * Fraction(longest))


def _longest_wait(solution: DynamicSolution) -> float:
    """A bound on the mean time until every part has come to its end, from whatever state it is in."""
    wait = 0.0
    for part in solution.parts:
        if part.static is None:
            chain = solution.chains[part.name]
            moving = chain.exit[chain.exit > 0]
            wait += len(np.unique(chain.states.settled)) / float(moving.min()) if len(moving) else 0.0
        else:
            for event in part.static.events:
                node = solution.tree.nodes.get(event.name)
                if isinstance(node, TimedEvent) and (rate := solution.rate(node)):
                    wait += 1 / float(rate)
    return math.nextafter(wait * (1 + 1e-9), math.inf)

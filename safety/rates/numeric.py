"""Chains in double precision with certified bounds: a second route to mean times, and probabilities at a time.

Mean times: a sparse LU solve, refined, then judged by its exact residual. Where absorption is certain the matrix A of
the chain has A^-1 >= 0, so |1 - A t| <= e < 1 proves t/(1+e) <= true <= t/(1-e), however t was found. Nothing is shared
with the elimination in `markov`.

Probabilities: uniformisation (Jensen 1953). Only non-negative numbers are added and multiplied, so that rounding is a
relative error which can be counted; the Poisson mass left out is an absolute one. Rates per hour, times in hours.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from fractions import Fraction
from importlib import import_module
from typing import NamedTuple

from safety.rates.enclosure import INFINITE, Enclosure
from safety.rates.exceptions import NumericsFailed
from safety.rates.markov import Chain
from safety.rates.units import Rational, exact

MOST_STEPS = 2_000_000
_ROUND = Fraction(1, 2**53)  # largest relative error of one operation in double precision
_TINY = Fraction(1, 10**300)  # covers every loss by underflow


def enclose_mean_time(chain: Chain, until: Collection[str], relative: float = 1e-12) -> Enclosure:
    """Encloses the mean time until `until` is entered; infinite when that is not certain. Raises as below."""
    return enclose_mean_reward(chain, until, dict.fromkeys(chain.states, Fraction(1)), relative)


def enclose_mean_reward(
    chain: Chain, until: Collection[str], reward: Mapping[str, Rational], relative: float = 1e-12
) -> Enclosure:
    """Encloses the mean of the integral of `reward[state]` (>= 0) until `until` is entered; infinite if not certain.

    The width is at most about 2 * relative * largest reward * mean time. Raises ChainError, NotExact, and
    NumericsFailed when doubles cannot reach that width (use the exact markov.mean_reward).
    """
    chain.check(*reward)
    states = chain.transient(until)
    if states is None:
        return Enclosure.exactly(INFINITE)
    if not states:
        return Enclosure.exactly(Fraction(0))
    system, start = _System(chain, states), states.index(chain.start)
    times, error = system.solve([Fraction(1)] * len(states), relative)
    longest = times[start] / (1 - error)
    weights = [exact(reward.get(s, 0), f"reward of {s!r}") for s in states]
    if set(weights) == {1}:
        return Enclosure(times[start] / (1 + error), longest)
    earned, error = system.solve(weights, relative * float(max(weights)))
    return Enclosure(max(Fraction(0), earned[start] - error * longest), earned[start] + error * longest)


class _System:
    """A m = w over the transient states: A has the exit rates on its diagonal, elsewhere minus the rates."""

    def __init__(self, chain: Chain, states: list[str]) -> None:
        index = {s: i for i, s in enumerate(states)}
        self.entries = [(i, i, chain.exit_rate(s)) for s, i in index.items()]
        self.entries += [(index[s], index[t], -rate) for s in states for t, rate in chain.out[s].items() if t in index]
        rows, columns, values = zip(*self.entries, strict=True)
        matrix = import_module("scipy.sparse").csc_matrix(([float(v) for v in values], (rows, columns)))
        try:
            self.lu = import_module("scipy.sparse.linalg").splu(matrix)
        except RuntimeError as error:
            raise NumericsFailed(
                f"no LU of this {len(states)}-state chain in doubles ({error}); use the exact elimination"
            ) from None

    def solve(self, right: list[Fraction], target: float) -> tuple[list[Fraction], Fraction]:
        """m and a bound of every |w - A m|, both exact rationals, the latter at most `target`."""
        array = import_module("numpy").array
        solution, last = [Fraction(0)] * len(right), INFINITE
        for _ in range(20):
            residual = self._residual(right, solution)
            worst = max(abs(r) for r in residual)
            if worst <= target:
                return solution, worst
            if worst >= last:
                break
            last = float(worst)
            step = self.lu.solve(array([float(r) for r in residual]))
            solution = [x + Fraction(d) for x, d in zip(solution, step.tolist(), strict=True)]
        raise NumericsFailed(
            f"the residual of this {len(right)}-state chain stays at {last:.1e}, above {target:.1e}; "
            f"use the exact elimination"
        )

    def _residual(self, right: list[Fraction], solution: list[Fraction]) -> list[Fraction]:
        from flint import fmpq

        values = [fmpq(x.numerator, x.denominator) for x in solution]
        rest = [fmpq(x.numerator, x.denominator) for x in right]
        for row, column, rate in self.entries:
            rest[row] -= fmpq(rate.numerator, rate.denominator) * values[column]
        return [Fraction(int(x.p), int(x.q)) for x in rest]


class Transient(NamedTuple):
    """At a time t: the probability of each state, and the mean of the integral of the reward over [0, t]."""

    probability: Mapping[str, Enclosure]
    reward: Enclosure

    def any_of(self, states: Collection[str]) -> Enclosure:
        """Probability to be in one of `states`."""
        parts = [self.probability[s] for s in set(states)]
        return Enclosure(sum((p.low for p in parts), Fraction(0)), sum((p.high for p in parts), Fraction(0)))


def transient(chain: Chain, time: Rational, reward: Mapping[str, Rational] | None = None) -> Transient:
    """Probabilities of all states at `time` h and the mean reward (>= 0; 0 where not named) up to then, enclosed.

    Relative error about 1e-15 * largest exit rate * `time`; truncation below 1e-30. Raises ChainError, NotExact, and
    NumericsFailed above MOST_STEPS steps.
    """
    import numpy as np

    reward = reward or {}
    chain.check(*reward)
    end, gains = exact(time, "time"), {s: exact(reward.get(s, 0), f"reward of {s!r}") for s in chain.states}
    fastest = max(chain.exit_rate(s) for s in chain.states)
    if fastest * end == 0:
        still = {s: Enclosure.exactly(Fraction(s == chain.start)) for s in chain.states}
        return Transient(still, Enclosure.exactly(gains[chain.start] * end))
    if fastest * end > MOST_STEPS:
        raise NumericsFailed(
            f"{float(fastest * end):.1e} steps are too many (rate {float(fastest):.3g} /h, "
            f"{float(end):.3g} h); ask for the steady state, or for a shorter time"
        )

    size, poisson = len(chain.states), Poisson(fastest * end)
    index = {s: i for i, s in enumerate(chain.states)}
    source = np.array([index[s] for s, _ in chain.rates] + list(range(size)))
    target = np.array([index[t] for _, t in chain.rates] + list(range(size)))
    stay = [1 - chain.exit_rate(s) / fastest for s in chain.states]
    jump = np.array([float(p) for p in (*(rate / fastest for rate in chain.rates.values()), *stay)])
    gain = np.array([float(g) for g in gains.values()])
    now = np.zeros(size)
    now[index[chain.start]] = 1.0
    total, earned = np.zeros(size), 0.0
    for step in range(poisson.last + 1):
        if step >= poisson.first:
            total = total + poisson.weights[step - poisson.first] * now
        earned += poisson.more_than(step) * float(gain @ now)
        now = np.asarray(np.bincount(target, weights=now[source] * jump, minlength=size))

    operations = (poisson.last + 1) * (int(np.bincount(target).max()) + 3) + size + 10 * len(poisson.weights)
    rounding = 2 * _ROUND * operations
    if rounding > Fraction(1, 1000):
        raise NumericsFailed(f"{poisson.last} steps lose too many digits; ask for the steady state, or a shorter time")

    def around(value: Fraction, absolute: Fraction) -> Enclosure:
        return Enclosure(max(Fraction(0), value * (1 - rounding) - absolute), value * (1 + rounding) + absolute)

    outside = poisson.outside + _TINY
    probability = {s: around(Fraction(float(total[i])), outside) for s, i in index.items()}
    unseen = max(gains.values()) * outside * (poisson.last + 2) / fastest
    return Transient(probability, around(Fraction(earned) / fastest, unseen))


class Poisson:
    """Poisson weights of mean q for `first` to `last` events; the mass outside is below `outside`."""

    def __init__(self, q: Fraction) -> None:
        mean, mode = float(q), int(q)
        up, down = [1.0], [1.0]
        while up[-1] > 1e-40:
            up.append(up[-1] * mean / (mode + len(up)))
        while down[-1] > 1e-40 and len(down) <= mode:
            down.append(down[-1] * (mode - len(down) + 1) / mean)
        self.first, self.last = mode - len(down) + 1, mode + len(up) - 1
        relative = [*reversed(down), *up[1:]]
        whole = math.fsum(relative)
        self.weights = [w / whole for w in relative]
        self._beyond = [0.0]
        for weight in reversed(self.weights[1:]):
            self._beyond.append(self._beyond[-1] + weight)
        self._beyond.reverse()
        # Both tails fall faster than geometrically; the square also covers the mean excess over `last`, the 2 rounding.
        rising, falling = mean / (self.last + 1), self.first / mean
        tails = up[-1] * rising / (1 - rising) ** 2 + (down[-1] * falling / (1 - falling) if self.first else 0.0)
        self.outside = Fraction(2 * tails)

    def more_than(self, step: int) -> float:
        """Probability of more than `step` events."""
        return 1.0 if step < self.first else self._beyond[step - self.first]

"""Figures of the Markov chain of a dynamic tree, each enclosed: probability of failure by a time, mean time, ever.

Probabilities by a time: uniformisation (A. Jensen 1953) with the Poisson mass left out and the rounding both counted.
Mean time and probability of ever failing: as nothing is repaired, no transition leads back, and both follow from the
last states to the first with additions, multiplications and divisions of positive numbers only; small chains in
rationals instead. Rates per hour, times in hours.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from importlib import import_module
from typing import Any

import numpy as np

from safety.rates.enclosure import INFINITE, Enclosure
from safety.rates.exceptions import NumericsFailed
from safety.rates.exponential import transient_by_exponential
from safety.rates.markov import Chain
from safety.rates.numeric import MOST_STEPS, Poisson
from safety.trees.as_written import Rational, TreeError, exact
from safety.trees.dynamic.states import Cause, States

EXACT_TRANSITIONS = 20_000  # largest chain that is solved in rationals unasked
HALF_ULP = 2.0**-53
STIFF_STATES, STIFF_STEPS = 120, 20_000
MARGIN = 1.25  # of the uniformisation rate over the fastest state, so that staying has a chance above 1/5
SPLIT = 2.0**26
TINY = Fraction(1, 10**300)


class FailureChain:
    """The chain of `states`, with the rates of its tree or with `rates` per hour by event name instead."""

    def __init__(self, states: States, rates: Mapping[str, Rational] | None = None) -> None:
        self.states = states
        self._check_alike(rates or {})
        self.rates = [self._rate(cause, rates or {}) for cause in states.causes]
        rates_of = np.array([float(rate) for rate in self.rates])[states.cause]
        keep = rates_of > 0
        self.source, self.target = states.source[keep], states.target[keep]
        self._rate_of, self._cause = rates_of[keep], states.cause[keep]
        self.exit = np.bincount(self.source, self._rate_of, states.count)
        self._out = int(np.bincount(self.source).max(initial=0))  # most terms in a sum over what leaves a state
        self._in = int(np.bincount(self.target[self.exit[self.target] > 0]).max(initial=0))

    def _check_alike(self, rates: Mapping[str, Rational]) -> None:
        for alike in self.states.equal_events:
            if (
                len({exact(rates[name], f'rate of event "{name}"', name) if name in rates else None for name in alike})
                > 1
            ):
                raise TreeError(
                    f"events {', '.join(sorted(alike))} were taken to be alike, but their new rates differ; give "
                    "all of them one rate, or solve with symmetry=False",
                    min(alike),
                )

    def _rate(self, cause: Cause, rates: Mapping[str, Rational]) -> Fraction:
        event = self.states.tree.events[cause.event]
        if event.name not in rates:
            return cause.rate(self.states.tree)
        rate = exact(rates[event.name], f'rate of event "{event.name}"', event.name)
        if rate < 0:
            raise TreeError(f'rate of event "{event.name}" is {rate}, expected 0 or more', event.name)
        return rate * cause.factor * (1 if cause.active else event.dormancy)

    @cached_property
    def certain(self) -> bool:
        """Whether the top fails for sure, sooner or later."""
        seen = self._reachable()
        ends = np.flatnonzero(seen & (self.exit == 0))
        return all(int(end) == self.states.failed for end in ends)

    def _reachable(self) -> Any:
        seen = np.zeros(self.states.count, bool)
        seen[[state for state, chance in self.states.start.items() if chance]] = True
        for level in self._levels(self.source):
            seen[self.target[level][seen[self.source[level]]]] = True
        return seen

    def _levels(self, state: Any) -> list[Any]:
        """Transitions grouped by how much is settled in `state` (their source), least first."""
        settled = self.states.settled[state]
        order = np.argsort(settled, kind="stable")
        cuts = np.flatnonzero(np.diff(settled[order])) + 1
        return [part for part in np.split(order, cuts) if len(part)]

    def probabilities(self, times: Sequence[Rational]) -> list[Enclosure]:
        """Probability that the top has failed by each of `times` (hours), in one pass over the longest.

        The relative error is about 1e-14 x the fastest rate x time, or 1e-14 of a chain of up to STIFF_STATES states
        whose fastest rate x time is beyond STIFF_STEPS. Raises TreeError for a negative time, NumericsFailed above
        MOST_STEPS steps.
        """
        ends = [exact(time, "time") for time in times]
        if any(end < 0 for end in ends):
            raise TreeError(f"time is {min(ends)} h, expected 0 or more")
        if self.states.failed is None:
            return [Enclosure.exactly(Fraction(0))] * len(ends)
        at_once = self.states.start.get(self.states.failed, Fraction(0))
        fastest = Fraction(float(self.exit.max()) * MARGIN)
        if fastest == 0:
            return [Enclosure.exactly(at_once)] * len(ends)
        most = MOST_STEPS if self.states.count > STIFF_STATES else STIFF_STEPS
        poissons = {end: Poisson(fastest * end) for end in ends if 0 < fastest * end <= most}
        share, left = self._shares(float(fastest), max((p.last for p in poissons.values()), default=0))
        return [
            Enclosure.exactly(at_once)
            if end == 0
            else self._mixed(poissons[end], share, left)
            if end in poissons
            else self._by_matrix(end)
            for end in ends
        ]

    def _by_matrix(self, end: Fraction) -> Enclosure:
        """The same by the exponential of the whole matrix in balls, for rates that are far apart."""
        count, failed = self.states.count, str(self.states.failed)
        if count > STIFF_STATES:
            raise NumericsFailed(
                f"rates up to {float(self.exit.max()):.3g} per hour take too many steps for {float(end):.3g} h and "
                f"{count} states (beyond {STIFF_STATES}); ask for a shorter time, or treat the fastest events as "
                "instantaneous"
            )
        rates: dict[tuple[str, str], Fraction] = {}
        for source, target, cause in zip(self.source, self.target, self._cause, strict=True):
            between = str(source), str(target)
            rates[between] = rates.get(between, Fraction(0)) + self.rates[cause]
        names = [str(state) for state in range(count)]
        low = high = Fraction(0)
        for state, chance in self.states.start.items():
            found = transient_by_exponential(Chain(str(state), rates, names), end).probability[failed]
            low, high = low + chance * Fraction(found.low), high + chance * Fraction(found.high)
        return Enclosure(low, min(Fraction(1), high))

    def _shares(self, fastest: float, last: int) -> tuple[Any, float]:
        """The share that has failed after 0, 1, 2, ... jumps, up to `last` or until nothing moves; what still moves."""
        sparse = import_module("scipy.sparse")
        count, every = self.states.count, np.arange(self.states.count)
        chance = self._rate_of / fastest
        coarse = np.round(chance * SPLIT) / SPLIT  # sums of these are exact, so that little is lost where 1 is near
        stay = 1.0 - np.bincount(self.source, coarse, count) - np.bincount(self.source, chance - coarse, count)
        inner, last_step = self.exit[self.target] > 0, self.target == self.states.failed
        rows, columns = np.concatenate([self.target[inner], every]), np.concatenate([self.source[inner], every])
        step = sparse.csr_matrix((np.concatenate([chance[inner], stay]), (rows, columns)), (count, count))
        ending, arriving = self.source[last_step], chance[last_step]
        step.sum_duplicates()
        now = np.zeros(count)
        for state, share_of_start in self.states.start.items():
            now[state] = float(share_of_start)
        moving = self.exit > 0
        share = [now[self.states.failed]]
        for jump in range(last):
            share.append(share[-1] + float(np.sum(arriving * now[ending])))
            now = step @ now
            if jump % 64 == 63 and (left := float(now[moving].sum())) < 1e-25 * share[-1]:
                return np.array(share), left
        return np.array(share), 0.0

    def _mixed(self, poisson: Any, share: Any, left: float) -> Enclosure:
        weights = np.array(poisson.weights)
        jumps = np.minimum(np.arange(poisson.first, poisson.last + 1), len(share) - 1)
        value = Fraction(math.fsum(weights * share[jumps]))
        per_jump = 15 + self._in + 4  # staying: 3 half ulps of 1, which it is at least a fifth of; then its sum
        once = 64 + self.states.count.bit_length() + 10 * len(weights)  # sums are pairwise, in blocks of 128
        rounding = Fraction(2 * HALF_ULP * (int(jumps[-1]) * per_jump + once))
        if rounding > Fraction(1, 1000):
            raise NumericsFailed(f"{poisson.last} steps lose too many digits; ask for a shorter time")
        outside = poisson.outside + TINY
        low, high = value * (1 - rounding) - outside, value * (1 + rounding) + outside + 2 * Fraction(left)
        return Enclosure(max(Fraction(0), low), min(Fraction(1), high))

    @cached_property
    def mean_time(self) -> Enclosure:
        """Mean time until the top fails, in hours: infinite unless that is `certain`, exact for a small chain."""
        return self._backward(reward=1) if self.certain else Enclosure.exactly(INFINITE)

    @cached_property
    def ever(self) -> Enclosure:
        """Probability that the top ever fails, exact where certain, impossible, or for a small chain."""
        if self.certain or self.states.failed is None:
            return Enclosure.exactly(Fraction(self.states.failed is not None))
        return self._backward(reward=0)

    def _backward(self, reward: int) -> Enclosure:
        """Mean of `reward` x time until the end, plus 1 - `reward` if the end is the failure of the top."""
        if len(self.source) <= EXACT_TRANSITIONS:
            return Enclosure.exactly(self._backward_exact(reward))
        value = np.zeros(self.states.count)
        if not reward:
            value[self.states.failed] = 1.0
        levels = self._levels(self.source)
        for level in reversed(levels):
            source = self.source[level]
            onward = np.bincount(source, self._rate_of[level] * value[self.target[level]], self.states.count)
            moved = np.unique(source)
            value[moved] = (reward + onward[moved]) / self.exit[moved]
        mean = sum((chance * Fraction(float(value[state])) for state, chance in self.states.start.items()), Fraction(0))
        error = Fraction(2 * HALF_ULP * len(levels) * (2 * self._out + 6))
        return Enclosure(mean * (1 - error), mean * (1 + error))

    def _backward_exact(self, reward: int) -> Fraction:
        from flint import fmpq

        rates = [fmpq(rate.numerator, rate.denominator) for rate in self.rates]
        onward = [fmpq(reward)] * self.states.count
        total = [fmpq(0)] * self.states.count
        value = [fmpq(0)] * self.states.count
        if not reward:
            value[self.states.failed or 0] = fmpq(1)
        for level in reversed(self._levels(self.source)):
            ending = set()
            for at in level.tolist():
                source, rate = int(self.source[at]), rates[self._cause[at]]
                onward[source] += rate * value[self.target[at]]
                total[source] += rate
                ending.add(source)
            for source in ending:
                value[source] = onward[source] / total[source]
        mean = sum(
            (chance * Fraction(int(value[s].p), int(value[s].q)) for s, chance in self.states.start.items()),
            Fraction(0),
        )
        return mean

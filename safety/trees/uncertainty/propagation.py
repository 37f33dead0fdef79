"""Uncertainty of the top event: its distribution as the parameters range over theirs, by sampling.

One solved diagram is evaluated for all samples. What is read off a sample is an estimate, never exact: a quantile
comes with an interval that holds the true one with the stated confidence whatever the distribution (order statistics
and the binomial law), the mean with its standard error. The samples of a Latin hypercube are not independent, so its
quantiles have no such interval, and the standard error comes from the means of its independent blocks.

Probabilities have no unit. Sources: W. J. Conover, "Practical Nonparametric Statistics" (1999), section 3.2; Open-PSA
Model Exchange Format 2.0d for the error factor.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property, partial
from importlib import import_module
from typing import Any

import numpy as np

from safety.trees.as_written import TreeError
from safety.trees.solve import Solution
from safety.trees.uncertainty.correlation import Vector
from safety.trees.uncertainty.sampling import Columns, Draws, Holder, Plan, probabilities, said, variables

LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)
CONFIDENCE = 0.95
BINS = 40
HELD = 8  # columns of samples held besides those of the variables
CHUNK = 20_000  # samples whose probabilities of all events are held at a time
BYTES = 4e9  # of memory that the samples may take
IMPORTANCE_BYTES = 64  # of it for each sample of each event
MEASURES = ("birnbaum", "criticality", "diagnostic", "risk_achievement_worth")


@dataclass(frozen=True)
class Quantile:
    """The value that a sample does not exceed with probability `level`.

    The true quantile lies in low..high with at least the `confidence`; all three None where none can be given, one end
    None where it is not bounded.
    """

    level: float
    value: float
    low: float | None
    high: float | None
    confidence: float | None


@dataclass(frozen=True)
class Spread:
    """What samples say of one figure; `blocks` is 0 for independent samples, else the number of Latin hypercubes."""

    values: Vector = field(repr=False)  # in the order drawn
    blocks: int = 0
    least: float | None = None  # possible values of the figure; None: no bound
    greatest: float | None = None

    @cached_property
    def mean(self) -> float:
        """The mean."""
        return float(np.mean(self.values))

    @cached_property
    def standard_deviation(self) -> float:
        """The standard deviation (with n - 1)."""
        return float(np.std(self.values, ddof=1))

    @cached_property
    def standard_error(self) -> float:
        """The standard deviation of the estimated mean."""
        if not self.blocks:
            return self.standard_deviation / math.sqrt(self.values.size)
        means = self.values.reshape(self.blocks, -1).mean(axis=1)
        return float(np.std(means, ddof=1)) / math.sqrt(self.blocks)

    @cached_property
    def error_factor(self) -> float | None:
        """Root of the 95 % over the 5 % quantile; None if the latter is not positive."""
        low, high = self.quantile(0.05).value, self.quantile(0.95).value
        return math.sqrt(high / low) if low > 0 else None

    @cached_property
    def ordered(self) -> Vector:
        """The values, rising."""
        return np.sort(self.values)

    def quantile(self, level: float, confidence: float = CONFIDENCE) -> Quantile:
        """The quantile at `level` with its interval, both between 0 and 1. Raises TreeError if they are not."""
        if not (0 < level < 1 and 0 < confidence < 1):
            raise TreeError(
                f"quantile {level} with confidence {confidence}, expected both between 0 and 1; correct them"
            )
        size = self.values.size
        value = float(self.ordered[math.ceil(size * level) - 1])
        if self.blocks:
            return Quantile(level, value, None, None, None)
        first, last = ranks(size, level, confidence)
        low = float(self.ordered[first - 1]) if first else self.least
        high = float(self.ordered[last - 1]) if last <= size else self.greatest
        return Quantile(level, value, low, high, confidence)

    def histogram(self, bins: int = BINS) -> list[tuple[float, float, int]]:
        """Lower end, upper end and number of values of each bin.

        The bins are equally wide, in the logarithm if all values are positive and span a decade. Ends are included on
        the left, the last one on both sides.
        """
        low, high = float(self.ordered[0]), float(self.ordered[-1])
        if low == high:
            return [(low, high, self.values.size)]
        edges = np.geomspace(low, high, bins + 1) if low > 0 and high / low >= 10 else np.linspace(low, high, bins + 1)
        edges[0], edges[-1] = low, high
        counts, _ = np.histogram(self.values, edges)
        return [(float(a), float(b), int(n)) for a, b, n in zip(edges, edges[1:], counts, strict=False)]

    def curve(self, points: int = 200) -> list[tuple[float, float]]:
        """Points (value, fraction of samples up to it) of the distribution function."""
        size = self.values.size
        chosen = sorted({round(i) for i in np.linspace(0, size - 1, min(points, size))})
        return [(float(self.ordered[i]), (i + 1) / size) for i in chosen]


@dataclass(frozen=True)
class Uncertainty(Spread):
    """The sampled distribution of the probability of the top event."""

    plan: Plan = field(default_factory=Plan)
    variables: tuple[str, ...] = ()
    outside: Mapping[str, int] = field(default_factory=dict)  # by event: samples outside 0..1, set to the nearer end


def ranks(size: int, level: float, confidence: float) -> tuple[int, int]:
    """Which of `size` ordered independent samples (the first is 1) enclose the quantile at `level`.

    At each side the risk is at most (1 - confidence) / 2; 0 and size + 1 stand for no sample that is far enough out.
    """
    risk = (1 - confidence) / 2
    below = import_module("scipy.special").bdtr(np.arange(size), size, level)  # P(at most k samples below the quantile)
    first = int(np.searchsorted(below, risk, side="right"))
    last = int(np.searchsorted(below, 1 - risk, side="left")) + 1
    return first, last


def propagate(solution: Solution, plan: Plan | None = None) -> Uncertainty:
    """The distribution of the probability of the top event.

    Raises TreeError: no distribution in the tree, samples that take more than BYTES, or what `sampling.probabilities`
    raises.
    """
    plan = plan or Plan()
    names, chunks = drawn(solution.tree, plan, CHUNK)
    values, outside = np.empty(plan.samples), Counter[str]()
    for first, columns in chunks:
        values[first : first + CHUNK] = solution.many(columns.values)
        outside.update(columns.outside)
    return Uncertainty(values, plan.blocks * plan.hypercube, 0.0, 1.0, plan, names, dict(outside))


def propagate_importance(solution: Solution, plan: Plan | None = None) -> dict[str, dict[str, Spread | str]]:
    """For each basic event the distributions of MEASURES (see `importance`), over the same samples.

    The Fussell-Vesely importance is the criticality, and the risk reduction worth 1 / (1 - criticality). Where there is
    no distribution, the reason stands in its place: samples in which the top event is impossible leave all but
    Birnbaum's without meaning. Takes some IMPORTANCE_BYTES for each sample of each event; beyond BYTES of them nothing
    is computed. Raises TreeError.
    """
    plan = plan or Plan()
    names, chunks = drawn(solution.tree, plan, plan.samples)
    if (needed := plan.samples * (len(solution.events) * IMPORTANCE_BYTES + 8 * len(names))) > BYTES:
        why = (
            f"{plan.samples} samples of {len(solution.events)} events take {needed / 1e9:.3g} GB, more than the "
            f"{BYTES / 1e9:g} GB allowed; take fewer samples"
        )
        return {name: dict.fromkeys(MEASURES, why) for name in solution.events}
    ((_, columns),) = chunks
    top = np.array(solution.many(columns.values))
    why = ""
    if not top.all():
        why = (
            f"the top event is impossible in {int((top == 0).sum())} of {plan.samples} samples, which leaves this "
            "without meaning; correct the distributions"
        )
    slopes = np.array(solution.many_derivatives(columns.values)).reshape(columns.values.shape)
    blocks = plan.blocks * plan.hypercube
    result: dict[str, dict[str, Spread | str]] = {}
    for name, q, slope in zip(solution.events, columns.values, slopes, strict=True):
        result[name] = dict.fromkeys(MEASURES, why) | {"birnbaum": Spread(slope, blocks)}
        if not why:
            worth = 1 + (1 - q) * slope / top
            figures = (slope, q * slope / top, q * worth, worth)
            result[name] = {measure: Spread(values, blocks) for measure, values in zip(MEASURES, figures, strict=True)}
    return result


def drawn(holder: Holder, plan: Plan, size: int) -> tuple[tuple[str, ...], Iterator[tuple[int, Columns]]]:
    """The names of the random variables, and the samples, up to `size` of them at a time from the number given on.

    Raises TreeError: no distribution, or samples that take more than BYTES.
    """
    names = tuple(sorted(variables(holder)))
    if not names:
        raise TreeError(
            f"{said(holder)} holds no distribution, so nothing is uncertain; give a parameter or a basic event one, "
            "such as a lognormal-deviate"
        )
    if (needed := 8 * plan.samples * (len(names) + HELD)) > BYTES:
        raise TreeError(
            f"{plan.samples} samples of {len(names)} random variables take {needed / 1e9:.3g} GB, expected at most "
            f"{BYTES / 1e9:g} GB, which is {int(BYTES / 8 / (len(names) + HELD))} samples; take fewer"
        )
    uniforms = plan.uniforms(names)

    def chunks() -> Iterator[tuple[int, Columns]]:
        for first in range(0, plan.samples, size):
            part = {name: column[first : first + size] for name, column in uniforms.items()}
            yield first, probabilities(holder, min(size, plan.samples - first), partial(Draws, uniforms=part))

    return names, chunks()


def fields(found: Uncertainty, levels: Sequence[float] = LEVELS, confidence: float = CONFIDENCE) -> dict[str, Any]:
    """What a results document says of it: plain numbers, lists and texts."""
    plan = found.plan
    return {
        "method": "Latin hypercube" if plan.hypercube else "Monte Carlo",
        "samples": plan.samples,
        "hypercubes": found.blocks,
        "seed": plan.seed,
        "variables": list(found.variables),
        "correlated": list(plan.correlation.names) if plan.correlation else [],
        "mean": found.mean,
        "standard_error": found.standard_error,
        "standard_deviation": found.standard_deviation,
        "error_factor": found.error_factor,
        "quantiles": [asdict(found.quantile(level, confidence)) for level in levels],
        "histogram": [{"low": low, "high": high, "samples": count} for low, high, count in found.histogram()],
        "set_to_range": dict(found.outside),
    }


def importance_fields(
    found: Mapping[str, Mapping[str, Spread | str]], levels: Sequence[float] = (0.05, 0.5, 0.95)
) -> list[dict[str, Any]]:
    """The same for what `propagate_importance` gives, the event of the largest mean importance first.

    Ranked by the criticality, or by Birnbaum's where the former is not known. A measure that is not known is None, and
    "why_not" tells why.
    """
    rows = []
    for name, measures in sorted(found.items(), key=lambda pair: (-_mean(pair[1]), pair[0])):
        row: dict[str, Any] = {"event": name}
        for measure, spread in measures.items():
            row |= {measure: None, "why_not": spread} if isinstance(spread, str) else {measure: _spread(spread, levels)}
        rows.append(row)
    return rows


def _mean(measures: Mapping[str, Spread | str]) -> float:
    known = (each.mean for each in (measures["criticality"], measures["birnbaum"]) if not isinstance(each, str))
    return next(known, 0.0)


def _spread(spread: Spread, levels: Sequence[float]) -> dict[str, Any]:
    return {
        "mean": spread.mean,
        "standard_error": spread.standard_error,
        "standard_deviation": spread.standard_deviation,
        "quantiles": [asdict(spread.quantile(level)) for level in levels],
    }

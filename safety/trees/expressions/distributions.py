"""Distributions of what is not known for certain: parameters, or the probability of an event itself.

Each stands for one random variable; its value outside sampling is its mean. Samples are drawn by the inverse of the
distribution function. Source: Open-PSA Model Exchange Format 2.0d, section 5.4 (random deviates).
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from fractions import Fraction
from importlib import import_module
from statistics import NormalDist
from typing import Any, ClassVar

from safety.trees.as_written import Rational, TreeError
from safety.trees.expressions.arithmetics import EVERYTHING, UNKNOWN, Doubles, Interval, hull
from safety.trees.expressions.expression import Domains, Expression
from safety.trees.expressions.readings import Reading

POSITIVE = Interval(0.0, float("inf"))


class Distribution(Expression):
    """Base: `formula` is the mean; one variable, named by the path to it."""

    is_certain = False
    __slots__ = ()

    def read(self, reading: Reading, path: str) -> Any:
        """What stands for the random variable in the reading: its mean, its support or its samples."""
        values = [reading.of(argument, f"{path}/{n}") for n, argument in enumerate(self.arguments, 1)]
        reading.check(self, values)
        return reading.random(self, values, path)

    def support(self, *values: Interval) -> Interval:
        """All values that it takes, from those that its arguments take."""
        raise NotImplementedError

    def quantile(self, u: Any, *values: Any) -> Any:
        """The inverse distribution function at the probabilities `u` (numpy array, 0 < u < 1)."""
        raise NotImplementedError


class Uniform(Distribution):
    """Uniform between two bounds. Arguments: lower and upper bound."""

    tag = "uniform-deviate"
    domains: ClassVar[Mapping[int, Domains]] = {2: (("lower bound", "any number"), ("upper bound", "any number"))}
    __slots__ = ()

    def check(self, values: Any) -> None:
        """The lower bound must not lie above the upper one."""
        super().check(values)
        _check_order(self.tag, values)

    def formula(self, a: Doubles, *values: Any) -> Any:
        """The middle."""
        return (values[0] + values[1]) / a.number(Fraction(2))

    def support(self, *values: Interval) -> Interval:
        """From the least lower to the greatest upper bound."""
        return hull([*values])

    def quantile(self, u: Any, *values: Any) -> Any:
        """Linear."""
        return values[0] + (values[1] - values[0]) * u


class Normal(Distribution):
    """Normal. Arguments: mean, standard deviation."""

    tag = "normal-deviate"
    domains: ClassVar[Mapping[int, Domains]] = {2: (("mean", "any number"), ("standard deviation", "0 or more"))}
    __slots__ = ()

    def formula(self, a: Doubles, *values: Any) -> Any:
        """The mean."""
        return values[0]

    def support(self, *values: Interval) -> Interval:
        """Every number."""
        return EVERYTHING

    def quantile(self, u: Any, *values: Any) -> Any:
        """Mean plus deviations."""
        return values[0] + values[1] * standard_normal(u)


class Lognormal(Distribution):
    """Lognormal. Arguments: mean, error factor, level of the error factor; or mean and deviation of the logarithm.

    The error factor at level p is the quantile of p over the median: exp(z sigma) with z the normal quantile of p,
    1.645 for the usual p = 0.95, for which it is the root of the 95 % over the 5 % quantile.
    """

    tag = "lognormal-deviate"
    domains: ClassVar[Mapping[int, Domains]] = {
        2: (("mean of the logarithm", "any number"), ("deviation of the logarithm", "0 or more")),
        3: (("mean", "more than 0"), ("error factor", "1 or more"), ("level", "more than 0 and less than 1")),
    }
    __slots__ = ()

    def check(self, values: Any) -> None:
        """Besides, at a level up to a half an error factor has no meaning, and the level is one number."""
        super().check(values)
        if len(values) == 3 and not isinstance(values[2], float):
            raise TreeError(f"level of <{self.tag}> differs from sample to sample, expected one number; write it so")
        if len(values) == 3 and values[2] <= 0.5:
            raise TreeError(f"level of <{self.tag}> is {values[2]:g}, expected more than 0.5, as 0.95; correct it")

    def formula(self, a: Doubles, *values: Any) -> Any:
        """The mean."""
        if len(values) == 3:
            return values[0]
        return a.call("exp", values[0] + values[1] * values[1] / a.number(Fraction(2)))

    def support(self, *values: Interval) -> Interval:
        """Every positive number."""
        return POSITIVE

    def quantile(self, u: Any, *values: Any) -> Any:
        """The exponential of a normal quantile."""
        import numpy as np

        if len(values) == 3:
            sigma = np.log(values[1]) / NormalDist().inv_cdf(values[2])
            mu = np.log(values[0]) - sigma * sigma / 2
        else:
            mu, sigma = values
        return np.exp(mu + sigma * standard_normal(u))


class Gamma(Distribution):
    """Gamma. Arguments: shape, scale."""

    tag = "gamma-deviate"
    domains: ClassVar[Mapping[int, Domains]] = {2: (("shape", "more than 0"), ("scale", "more than 0"))}
    __slots__ = ()

    def formula(self, a: Doubles, *values: Any) -> Any:
        """Shape times scale."""
        return values[0] * values[1]

    def support(self, *values: Interval) -> Interval:
        """Every positive number."""
        return POSITIVE

    def quantile(self, u: Any, *values: Any) -> Any:
        """By the inverse incomplete gamma function."""
        return import_module("scipy.special").gammaincinv(values[0], u) * values[1]


class Beta(Distribution):
    """Beta. Arguments: its two shape parameters."""

    tag = "beta-deviate"
    domains: ClassVar[Mapping[int, Domains]] = {2: (("first shape", "more than 0"), ("second shape", "more than 0"))}
    __slots__ = ()

    def formula(self, a: Doubles, *values: Any) -> Any:
        """First over the sum of both."""
        return values[0] / (values[0] + values[1])

    def support(self, *values: Interval) -> Interval:
        """0..1."""
        return UNKNOWN

    def quantile(self, u: Any, *values: Any) -> Any:
        """By the inverse incomplete beta function."""
        return import_module("scipy.special").betaincinv(values[0], values[1], u)


class Histogram(Distribution):
    """A choice among expressions. Arguments: x0, then x1, E1, x2, E2, ... with x rising.

    A number drawn uniformly from x0..xn chooses the expression Ei of its interval (so the format defines it; SCRAM
    takes the intervals for the values and the expressions for their weights).
    """

    tag = "histogram"
    __slots__ = ()

    def __init__(self, *arguments: Expression | Rational) -> None:
        if len(arguments) < 3 or len(arguments) % 2 == 0:
            raise TreeError(
                f"<{self.tag}> has {len(arguments)} arguments, expected a lower bound and then for each bin its upper "
                "bound and an expression; correct it"
            )
        super().__init__(*arguments)

    def check(self, values: Any) -> None:
        """Bounds must rise."""
        bounds = (values[0], *values[1::2])
        if not all(isinstance(bound, float) for bound in bounds):
            raise TreeError(f"a bound of <{self.tag}> differs from sample to sample, expected one number; write it so")
        _check_order(self.tag, bounds)
        if bounds[0] == bounds[-1]:
            raise TreeError(f"the bounds of <{self.tag}> are all {bounds[0]:g}, expected rising ones; correct them")

    def formula(self, a: Doubles, *values: Any) -> Any:
        """The mean of the expressions, each weighted with the width of its interval."""
        bounds, expressions = (values[0], *values[1::2]), values[2::2]
        total = a.number(Fraction(0))
        for (low, high), each in zip(itertools.pairwise(bounds), expressions, strict=True):
            total = total + (high - low) * each
        return total / (bounds[-1] - bounds[0])

    def support(self, *values: Interval) -> Interval:
        """What covers all expressions."""
        return hull([*values[2::2]])

    def quantile(self, u: Any, *values: Any) -> Any:
        """The expression of the interval that holds the number at `u` of the way from x0 to xn."""
        import numpy as np

        bounds = np.array((values[0], *values[1::2]))
        chosen = np.searchsorted((bounds[1:-1] - bounds[0]) / (bounds[-1] - bounds[0]), u)
        return np.stack([np.broadcast_to(each, u.shape) for each in values[2::2]])[chosen, np.arange(u.size)]


def standard_normal(u: Any) -> Any:
    """Quantiles of the standard normal distribution (numpy)."""
    return import_module("scipy.special").ndtri(u)


def _check_order(tag: str, bounds: Any) -> None:
    for low, high in itertools.pairwise(bounds):
        wrong = low > high
        if wrong if isinstance(wrong, bool) else wrong.any():
            raise TreeError(f"the bounds of <{tag}> fall, from {low} to {high}, expected rising ones; correct them")

"""How the unavailability and the failure frequency of one basic event go with the time since the mission began.

`laws.behaviours` finds for each event of a tree one of three kinds. Relaxing covers nearly all: between tests the
unavailability goes from `start` to `limit` at the rate `pace`, as do a constant (pace 0), an exponential (0, 1, failure
rate), GLM (gamma, r / (r + m), r + m) and a periodic test without repair time (0, 1, failure rate, again from each
test), all possibly times a constant `scale`. Tested is a periodic test after which failures are repaired at a rate.
Expressed is any other expression of the mission time.

The failure frequency is the unconditional one: the expected number of failures per hour, whatever went before. The
repair frequency is its counterpart. A scaled law fails and is repaired `scale` times as often.

Units: hours, rates and frequencies per hour. Source: IEC 61508-6:2010 annex B.5; Open-PSA Model Exchange Format 2.0d.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

from safety.trees.as_written import TreeError

if TYPE_CHECKING:
    from safety.trees.expressions.expression import Expression

MISSION_TIME = "mission time"  # in the place of a parameter's name, as in `expressions`
ZERO, ONE = Fraction(0), Fraction(1)
LARGEST = 700.0  # exponent of e that is still a double
EXTREME = Fraction(10**100)  # rates and times lie between this and its inverse, so that products are still doubles


class UnknownFrequency(TreeError):
    """How often an event occurs does not follow from what is known of its probability."""


@dataclass(frozen=True)
class Relaxing:
    """See the module. `first_test` and `interval` are those of its tests, None if there are none.

    At the pace 0 it stays at `start`, and so `limit` is that.
    """

    start: Fraction
    limit: Fraction
    pace: Fraction = ZERO
    failure_rate: Fraction = ZERO
    repair_rate: Fraction = ZERO
    scale: Fraction = ONE
    first_test: Fraction | None = None
    interval: Fraction | None = None
    is_exact: bool = True  # whether all these are as given, none a rounded one
    unknown: str = ""  # why it is not known how often it fails

    def __post_init__(self) -> None:
        _check_rates(self.pace, self.failure_rate, self.repair_rate)
        if not self.pace:
            object.__setattr__(self, "limit", self.start)

    @property
    def varies(self) -> bool:
        """Whether anything happens to it: its probability changes, or failures and repairs balance."""
        return self.pace > 0 and self.scale > 0 and (self.start != self.limit or 0 < self.limit < 1)

    @property
    def is_bounded(self) -> bool:
        """Whether `growth` holds."""
        return self.scale <= 1

    @cached_property
    def _doubles(self) -> tuple[float, float, float, float]:
        return float(self.scale), float(self.start), float(self.limit), float(self.pace)

    def tests(self, until: Fraction) -> Iterator[Fraction]:
        """The times of its tests before `until`."""
        return _every(self.first_test, self.interval, until)

    def piece(self, time: Fraction) -> tuple[Fraction, Relaxing]:
        """When it last began anew before `time`, and what it does from then on."""
        return _last(time, self.first_test, self.interval)[0], self

    def down(self, hours: float) -> float:
        """Probability to be down so long after `since`; nothing is subtracted."""
        scale, start, limit, pace = self._doubles
        x = -pace * hours
        return scale * (start * math.exp(x) - limit * math.expm1(x))

    def up(self, hours: float) -> float:
        """Probability to be up; nothing is subtracted but the scale from 1."""
        scale, start, limit, pace = self._doubles
        x = -pace * hours
        return (1 - scale) + scale * ((1 - start) * math.exp(x) - (1 - limit) * math.expm1(x))

    def failures(self, hours: float) -> float:
        """Failures per hour."""
        scale, start, limit, pace = self._doubles
        x = -pace * hours
        return scale * float(self.failure_rate) * ((1 - start) * math.exp(x) - (1 - limit) * math.expm1(x))

    def repairs(self, hours: float) -> float:
        """Repairs per hour. Raises UnknownFrequency where all repairs come at once, at the tests."""
        if self.first_test is not None:
            raise UnknownFrequency("the repairs of a periodic test come all at once")
        return float(self.repair_rate) * self.down(hours)

    def growth(self, earliest: float, width: float) -> float:
        """The largest log(|q| + |1 - q|) over complex times of real part >= `earliest`, imaginary within +-`width`.

        With e = exp(-pace z) and r = |e| at imaginary part 0: |e - r| <= r min(2, pace * width), and between `start`
        and `limit` |q| + |1 - q| is 1. A scale below 1 leaves less.
        """
        if not self.varies:
            return 0.0
        _, start, limit, pace = self._doubles
        if -pace * earliest > LARGEST:
            return math.inf
        r = math.exp(-pace * earliest)
        return math.log1p(2 * abs(start - limit) * (max(0.0, r - 1) + r * min(2.0, pace * width)))


@dataclass(frozen=True)
class Tested:
    """Failing, found to have failed at a test only, and then repaired at a rate: a periodic test of 5 arguments."""

    failure_rate: Fraction
    repair_rate: Fraction
    interval: Fraction
    first_test: Fraction
    scale: Fraction = ONE
    unknown = ""

    def __post_init__(self) -> None:
        _check_rates(self.failure_rate, self.repair_rate)

    @property
    def varies(self) -> bool:
        """Whether it depends on time at all."""
        return self.failure_rate > 0 and self.scale > 0

    @property
    def is_bounded(self) -> bool:
        """Whether `growth` of its pieces holds."""
        return self.scale <= 1

    @property
    def pace(self) -> Fraction:
        """The larger of its rates."""
        return max(self.failure_rate, self.repair_rate)

    def tests(self, until: Fraction) -> Iterator[Fraction]:
        """The times of its tests before `until`."""
        return _every(self.first_test, self.interval, until)

    def piece(self, time: Fraction) -> tuple[Fraction, AfterTest]:
        """The last test before `time`, and what it does from then on."""
        begin, done = _last(time, self.first_test, self.interval)
        while len(self._pieces) <= done:
            length = self.interval if len(self._pieces) > 1 else self.first_test
            last = self._pieces[-1]
            self._pieces.append(replace(last, down_at_test=last.unscaled(float(length))))
        return begin, self._pieces[done]

    @cached_property
    def _pieces(self) -> list[AfterTest]:
        return [AfterTest(float(self.failure_rate), float(self.repair_rate), 0.0, float(self.scale))]


@dataclass(frozen=True)
class AfterTest:
    """What was down at the test is in repair, the rest is up; per hour."""

    failure_rate: float
    repair_rate: float
    down_at_test: float
    scale: float

    @property
    def pace(self) -> float:
        """The larger rate."""
        return max(self.failure_rate, self.repair_rate)

    def _back(self, hours: float) -> float:
        """Probability that what was in repair is up: convolution of both exponentials."""
        slow, fast = sorted((self.failure_rate, self.repair_rate))
        x = (fast - slow) * hours
        return self.repair_rate * hours * math.exp(-slow * hours) * (-math.expm1(-x) / x if x else 1.0)

    def unscaled(self, hours: float) -> float:
        """Probability to be down without the scale."""
        failed = -math.expm1(-self.failure_rate * hours)
        return (1 - self.down_at_test) * failed + self.down_at_test * (1 - self._back(hours))

    def down(self, hours: float) -> float:
        """Probability to be down so long after the test."""
        return self.scale * self.unscaled(hours)

    def failures(self, hours: float) -> float:
        """Failures per hour."""
        up = (1 - self.down_at_test) * math.exp(-self.failure_rate * hours) + self.down_at_test * self._back(hours)
        return self.scale * self.failure_rate * up

    def repairs(self, hours: float) -> float:
        """Repairs per hour of what was in repair at the test, all others being failed and not known to be."""
        return self.scale * self.repair_rate * self.down_at_test * math.exp(-self.repair_rate * hours)

    def growth(self, earliest: float, width: float) -> float:
        """As that of Relaxing, and twice what is in repair times a bound of |_back|."""
        if -self.pace * earliest > LARGEST:
            return math.inf
        r, edge = (math.exp(-rate * earliest) for rate in (self.failure_rate, self.pace))
        away = math.hypot(max(abs(earliest), earliest + 6 * width / math.sqrt(8)), width)
        apart = abs(self.failure_rate - self.repair_rate)
        back = self.repair_rate * min(away, 2 / apart if apart else away) * max(1.0, edge)
        failed = max(0.0, r - 1) + r * min(2.0, self.failure_rate * width)
        return math.log1p(2 * (1 - self.down_at_test) * failed + 2 * self.down_at_test * back)


@dataclass(frozen=True)
class Expressed:
    """Any other expression of the mission time; its failure frequency is its derivative, unless it is tested."""

    event: str
    expression: Expression
    scale: Fraction = ONE
    varies, is_bounded, unknown = True, False, ""
    pace = failure_rate = repair_rate = ZERO

    def tests(self, until: Fraction) -> Iterator[Fraction]:
        """The times before `until` at which it may jump."""
        for law in self.expression.below():
            if law.tag == "periodic-test":
                arguments = [argument.exact() for argument in law.arguments[:-1]]
                place = {4: 1, 5: 2, 11: 3}[len(law.arguments)]
                interval, first = arguments[place], arguments[place + 1]
                lasting = arguments[6] if len(law.arguments) == 11 else ZERO
                for time in _every(first, interval, until):
                    yield time
                    if lasting and time + lasting < until:
                        yield time + lasting

    def piece(self, time: Fraction) -> tuple[Fraction, Expressed]:
        """It counts from the beginning."""
        return ZERO, self

    def down(self, hours: float) -> float:
        """Probability to be down at a time."""
        value = float(self.scale) * self.expression.value(Fraction(hours))
        inside = min(1.0, max(0.0, value))
        return inside if math.isclose(value, inside, rel_tol=1e-12, abs_tol=1e-15) else value  # else refused by `many`

    def failures(self, hours: float) -> float:
        """Failures per hour. Raises UnknownFrequency where the expression does not tell failures from repairs."""
        law = self.expression
        slope = -1.0 if law.tag == "periodic-test" else law.derivative(MISSION_TIME, Fraction(hours))
        if slope < 0:
            raise UnknownFrequency(f"<{law.tag}> does not tell failures from repairs")
        return float(self.scale) * slope

    def repairs(self, hours: float) -> float:
        """Repairs per hour. Raises UnknownFrequency for all but a Weibull, which has none."""
        if self.expression.tag != "Weibull":
            raise UnknownFrequency(f"<{self.expression.tag}> does not tell how often repairs come")
        return 0.0

    def growth(self, earliest: float, width: float) -> float:
        """Unknown."""
        return math.nan


Behaviour = Relaxing | Tested | Expressed
Piece = Relaxing | AfterTest | Expressed  # what a behaviour is from one test to the next


def _every(first: Fraction | None, interval: Fraction | None, until: Fraction) -> Iterator[Fraction]:
    if first is not None and interval is not None:
        time = first
        while time < until:
            yield time
            time += interval


def _last(time: Fraction, first: Fraction | None, interval: Fraction | None) -> tuple[Fraction, int]:
    """The last test before `time`, or 0, and how many there were."""
    if first is None or interval is None or time <= first:
        return ZERO, 0
    done = math.ceil((time - first) / interval)
    return first + (done - 1) * interval, done


def double(value: Fraction, what: str) -> Fraction:
    """`value`, if it is 0 or of a size to compute with in doubles. Raises TreeError."""
    if value and not 1 / EXTREME <= abs(value) <= EXTREME:
        size = Decimal(value.numerator) / Decimal(value.denominator)
        number = f"{Decimal(f'{size:.5e}').normalize():g}"
        raise TreeError(f"{what} is {number}, expected 0 or a number from 1e-100 to 1e+100; correct it")
    return value


def _check_rates(*rates: Fraction) -> None:
    for rate in rates:
        double(rate, "a rate per hour of failure or repair")

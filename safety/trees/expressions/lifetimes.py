"""Laws of parts that fail, are repaired and are tested: the probability that a part is down at a time.

Units: rates per hour, times in hours. Source: Open-PSA Model Exchange Format 2.0d, section 5.3 (built-ins).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, ClassVar, NamedTuple

from safety.trees.as_written import Rational, TreeError
from safety.trees.expressions.arithmetics import UNKNOWN, Doubles
from safety.trees.expressions.expression import Domains, Expression
from safety.trees.expressions.readings import NOTHING, Reading

TIME = ("time in hours", "0 or more")
RATE = ("failure rate per hour", "0 or more")
TESTS = ("test interval in hours", "more than 0"), ("time before the first test in hours", "0 or more")
MOST_TESTS = 1_000_000
REPAIR = ("repair rate per hour", "0 or more")


class _SurvivalKnown(Expression):
    """A law that gives 1 minus its value with full accuracy, too."""

    __slots__ = ()

    def exponent(self, a: Doubles, *values: Any) -> Any:
        """What the probability of survival is exp(-) of."""
        raise NotImplementedError

    def formula(self, a: Doubles, *values: Any) -> Any:
        """1 - exp(-exponent)."""
        return -a.call("expm1", -self.exponent(a, *values))

    def chance(
        self, mission_time_h: Rational | None = None, parameters: Mapping[str, Rational] = NOTHING
    ) -> tuple[float, float]:
        """The probabilities of failure and of survival, both accurate to a few ulp."""
        value, reading = self.value(mission_time_h, parameters), Reading(Doubles(), mission_time_h, parameters)
        exponent = self.exponent(reading.arithmetic, *(reading.of(argument) for argument in self.arguments))
        return value, math.exp(-exponent)


class Exponential(_SurvivalKnown):
    """1 - exp(-rate t): not repairable, of constant failure rate. Arguments: rate, t."""

    tag = "exponential"
    domains: ClassVar[Mapping[int, Domains]] = {2: (RATE, TIME)}
    __slots__ = ()

    def exponent(self, a: Doubles, *values: Any) -> Any:
        """Rate times time."""
        return values[0] * values[1]


class Weibull(_SurvivalKnown):
    """1 - exp(-((t - shift) / scale) ^ shape), and 0 before the shift. Arguments: scale (h), shape, shift (h), t."""

    tag = "Weibull"
    domains: ClassVar[Mapping[int, Domains]] = {
        4: (("scale in hours", "more than 0"), ("shape", "more than 0"), ("time shift in hours", "0 or more"), TIME)
    }
    __slots__ = ()

    def exponent(self, a: Doubles, *values: Any) -> Any:
        """Age over scale, to the shape."""
        scale, shape, shift, time = values
        age = a.largest([time - shift, a.number(Fraction(0))])
        return a.power(age / scale, shape)


class Glm(Expression):
    """Failed on demand with probability gamma, then failing and being repaired at constant rates.

    r / (r + m) - (r / (r + m) - gamma) exp(-(r + m) t), for arguments gamma, failure rate r, repair rate m, t; here in
    the equal form gamma exp(-(r + m) t) + r t decay((r + m) t), which subtracts nothing and needs no r + m > 0.
    """

    tag = "GLM"
    domains: ClassVar[Mapping[int, Domains]] = {
        4: (("probability of failure on demand", "between 0 and 1"), RATE, REPAIR, TIME)
    }
    __slots__ = ()

    def formula(self, a: Doubles, *values: Any) -> Any:
        """See the class."""
        gamma, rate, repair, time = values
        x = (rate + repair) * time
        return gamma * a.call("exp", -x) + rate * time * a.call("decay", x)


class PeriodicTest(Expression):
    """A part whose failures only a test finds: every tau hours, the first theta hours after the start.

    4 arguments  failure rate, tau, theta, t: tested and repaired in no time
    5            failure rate, repair rate, tau, theta, t: tested in no time, repaired at a rate
    11           failure rate, failure rate during a test, repair rate, tau, theta, gamma, test duration, x, sigma,
                 omega, t: the test makes a good part fail with probability gamma when it begins; during it the part is
                 available (x = 1) or not (0); at its end a failure is found with probability sigma, and repair begins;
                 a repair leaves the part failed with probability omega. A part under repair is not tested.

    At the instant of a test the value is that just before it. `omega` follows a repair only; the words of the format
    ("after a test or a repair") would also allow a failure after each test, which gamma can express.
    """

    tag = "periodic-test"
    domains: ClassVar[Mapping[int, Domains]] = {
        4: (RATE, *TESTS, TIME),
        5: (RATE, REPAIR, *TESTS, TIME),
        11: (
            RATE,
            ("failure rate per hour during a test", "0 or more"),
            REPAIR,
            *TESTS,
            ("probability that the test makes the part fail", "between 0 and 1"),
            ("test duration in hours", "0 or more"),
            ("availability during a test", "between 0 and 1"),
            ("probability that the test finds a failure", "between 0 and 1"),
            ("probability of a bad repair", "between 0 and 1"),
            TIME,
        ),
    }
    __slots__ = ()

    def read(self, reading: Reading, path: str) -> Any:
        """As any other, but times that are known count as rationals: the value jumps at each test."""
        values = [reading.of(argument, f"{path}/{n}") for n, argument in enumerate(self.arguments, 1)]
        reading.check(self, values)
        interval, first, time = (reading.exactly(each) for each in self._times(self.arguments))
        if interval is None or first is None or time is None:
            return reading.each(self, values)
        begun = max(0, math.ceil((time - first) / interval))
        since = time - first - (begun - 1) * interval
        a = reading.arithmetic
        return self._after(a, values, begun, a.known(since, self._since(a, values, begun)))

    def check(self, values: Any) -> None:
        """As any other, and a test must end before the next begins."""
        super().check(values)
        if len(values) == 11:
            self.require("test interval less test duration", "0 or more", values[3] - values[6])

    def formula(self, a: Doubles, *values: Any) -> Any:
        """The probability that the part is down at the time t."""
        interval, first, time = self._times(values)
        begun = a.multiples_below(time - first, interval)
        if begun is None:
            return UNKNOWN
        return self._after(a, values, begun, self._since(a, values, begun))

    def _since(self, a: Doubles, values: Sequence[Any], begun: int) -> Any:
        """Hours since the last of `begun` tests began."""
        interval, first, time = self._times(values)
        return time - first - a.number(Fraction(begun - 1)) * interval

    def _times(self, arguments: Sequence[Any]) -> tuple[Any, Any, Any]:
        """Test interval, time before the first test, time."""
        first = {4: 1, 5: 2, 11: 3}[len(arguments)]
        return arguments[first], arguments[first + 1], arguments[-1]

    def _after(self, a: Doubles, values: Sequence[Any], begun: int, since: Any) -> Any:
        """The value when `begun` tests have begun, the last of them `since` hours ago."""
        rate, (interval, first, time) = values[0], self._times(values)
        if not begun:
            return -a.call("expm1", -rate * time)
        if len(values) == 4:
            return -a.call("expm1", -rate * since)
        if begun > MOST_TESTS:
            raise TreeError(f"<periodic-test> has {begun} tests up to its time, at most {MOST_TESTS} are computed")
        zero, one = a.number(Fraction(0)), a.number(Fraction(1))
        if len(values) == 5:
            values = (rate, rate, values[1], interval, first, zero, zero, one, one, zero, time)
        part = _TestedPart(a, *values[:3], *values[5:10])
        state = part.run((one, zero, zero), first)
        for _ in range(begun - 1):
            state = part.run(part.tested(state), interval - part.duration)
        return a.choose(
            a.compare("leq", since, part.duration),
            lambda: part.down_in_test(state, since),
            lambda: part.down(part.run(part.tested(state), since - part.duration)),
        )


_State = tuple[Any, Any, Any]  # probability to be up, failed (and not known to be), in repair


class _TestedPart(NamedTuple):
    """The Markov chain of a periodically tested part, in closed form from one change of phase to the next."""

    a: Doubles
    rate: Any
    rate_in_test: Any
    repair_rate: Any
    gamma: Any
    duration: Any
    available: Any
    sigma: Any
    omega: Any

    def run(self, state: _State, hours: Any) -> _State:
        """After `hours` between tests."""
        a, (up, failed, repair) = self.a, state
        one = a.number(Fraction(1))
        stays = a.call("exp", -self.rate * hours)
        # The mean of exp(-rate s - repair_rate (hours - s)), from its slower end, from which nothing can overflow.
        slower = a.call("exp", -a.smallest([self.rate, self.repair_rate]) * hours)
        overlap = slower * a.call("decay", a.absolute(self.repair_rate - self.rate) * hours)
        back = repair * (one - self.omega) * self.repair_rate * hours * overlap
        still = repair * a.call("exp", -self.repair_rate * hours)
        newly = -up * a.call("expm1", -self.rate * hours)
        return up * stays + back, failed + newly + (repair - still - back), still

    def _in_test(self, state: _State, hours: Any) -> tuple[_State, _State]:
        """`hours` into a test: those who are tested, and those who were in repair and are not."""
        a, (up, failed, repair) = self.a, state
        zero, one = a.number(Fraction(0)), a.number(Fraction(1))
        begins = up * (one - self.gamma)
        newly = up * self.gamma - begins * a.call("expm1", -self.rate_in_test * hours)
        tested = begins * a.call("exp", -self.rate_in_test * hours), failed + newly, zero
        return tested, self.run((zero, zero, repair), hours)

    def tested(self, state: _State) -> _State:
        """After a whole test."""
        (up, failed, _), (up_again, failed_again, repair) = self._in_test(state, self.duration)
        missed = failed * (self.a.number(Fraction(1)) - self.sigma)
        return up + up_again, missed + failed_again, repair + failed * self.sigma

    def down_in_test(self, state: _State, hours: Any) -> Any:
        """Probability to be down `hours` into a test."""
        (up, failed, _), other = self._in_test(state, hours)
        return up * (self.a.number(Fraction(1)) - self.available) + failed + self.down(other)

    def down(self, state: _State) -> Any:
        """Probability to be down."""
        return state[1] + state[2]


def constant_rate(law: Expression | None) -> Expression | None:
    """The rate per hour of an exponential over the system mission time, also behind parameters; None for other laws."""
    while law is not None and law.tag == "parameter":
        law = law.arguments[0]
    if law is None or law.tag != "exponential":
        return None
    rate, time = law.arguments
    return rate if time.tag == "system-mission-time" and not rate.uses_mission_time else None

"""Reading an expression in one arithmetic: what its parameters, the mission time and random variables stand for."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from safety.trees.as_written import Rational, TreeError, exact
from safety.trees.expressions.arithmetics import Doubles, Dual, Interval

if TYPE_CHECKING:
    from safety.trees.expressions.expression import Expression, Parameter

MISSION_TIME = "mission time"  # in the place of a parameter's name
NOTHING: Mapping[str, Any] = {}


class Reading:
    """Expressions in one arithmetic: at a mission time, with some parameters given, each parameter read once.

    `varied` names the parameter, or MISSION_TIME, with respect to which `Duals` differentiate.
    """

    def __init__(
        self,
        arithmetic: Doubles,
        mission_time_h: Rational | None = None,
        parameters: Mapping[str, Any] = NOTHING,
        varied: str = "",
    ) -> None:
        self.arithmetic, self.mission_time_h, self.varied = arithmetic, mission_time_h, varied
        self.given = parameters
        self._known = {name: self._given(value, name) for name, value in parameters.items()}

    def of(self, expression: Expression, path: str = "") -> Any:
        """The value of `expression`, which stands at `path`. Raises TreeError as `Expression.value` does."""
        try:
            return expression.read(self, path)
        except (ArithmeticError, ValueError) as error:
            if isinstance(error, TreeError):
                raise
            raise TreeError(f"<{expression.tag}> has no value here ({error}); correct its arguments") from None

    def mission_time(self) -> Any:
        """The mission time."""
        if self.mission_time_h is None:
            raise TreeError("<system-mission-time> has no value; pass mission_time_h (hours)")
        return self._given(self.mission_time_h, MISSION_TIME)

    def parameter(self, parameter: Parameter) -> Any:
        """The value of a parameter: as given, or that of its definition."""
        if parameter.name not in self._known:
            value = self.of(parameter.definition, parameter.name)
            if parameter.name == self.varied:
                value = Dual(value.value, 1.0)
            self._known[parameter.name] = value
        return self._known[parameter.name]

    def random(self, distribution: Expression, values: list[Any], path: str) -> Any:
        """What stands for a random variable: its mean."""
        return distribution.formula(self.arithmetic, *values)

    def check(self, expression: Expression, values: list[Any]) -> None:
        """Raise TreeError if an argument is out of its domain; in doubles only, which all other readings go with."""
        if type(self.arithmetic) is Doubles:
            expression.check(values)

    def each(self, expression: Expression, values: list[Any]) -> Any:
        """The formula over values that may differ from sample to sample where it cannot take them together."""
        return expression.formula(self.arithmetic, *values)

    def exactly(self, expression: Expression) -> Fraction | None:
        """The same value as a rational, if it is one and known for certain."""
        if not all(each.is_certain for each in expression.below()):
            return None
        return expression.exact(self.mission_time_h, self.given)

    def _given(self, value: Any, name: str) -> Any:
        number = self.arithmetic.number(exact(value, name))
        return Dual(number.value, 1.0) if name == self.varied else number


class Supports(Reading):
    """Intervals of all values that random variables can take."""

    def random(self, distribution: Any, values: list[Interval], path: str) -> Interval:
        """All values of the distribution."""
        found: Interval = distribution.support(*values)
        return found

"""Reading the expressions of Open-PSA MEF: parameters, operations, lifetimes and distributions.

A unit says what a parameter's number means and is never converted: a parameter in another unit than the one expected
where it stands is refused.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from safety.trees.expressions.distributions import Beta, Gamma, Histogram, Lognormal, Normal, Uniform
from safety.trees.expressions.expression import Constant, Expression, MissionTime, Operation, Parameter
from safety.trees.expressions.lifetimes import Exponential, Glm, PeriodicTest, Weibull
from safety.trees.formats.draft import at
from safety.trees.formats.mef_elements import ANNOTATIONS, NUMBERS, attributes, only, truth
from safety.trees.formats.xml_elements import Element

if TYPE_CHECKING:
    from safety.trees.formats.mef import MefReader

FUNCTIONS = {
    kind.tag: kind
    for kind in (Exponential, Glm, Weibull, PeriodicTest, Uniform, Normal, Lognormal, Gamma, Beta, Histogram)
}
UNITS = ("bool", "int", "float", "hours", "hours-1", "years", "years-1", "fit", "demands")
TIME, RATE, PURE = ("hours",), ("hours-1",), ("bool", "int", "float", "demands")
# Units of the arguments of lifetimes, by their number.
EXPECTED: dict[str, dict[int, tuple[tuple[str, ...], ...]]] = {
    "exponential": {2: (RATE, TIME)},
    "GLM": {4: (PURE, RATE, RATE, TIME)},
    "Weibull": {4: (TIME, PURE, TIME, TIME)},
    "periodic-test": {
        4: (RATE, TIME, TIME, TIME),
        5: (RATE, RATE, TIME, TIME, TIME),
        11: (RATE, RATE, RATE, TIME, TIME, PURE, TIME, PURE, PURE, PURE, TIME),
    },
}
INNER = {"switch": ("case", -1), "histogram": ("bin", 0)}  # the parts in pairs, and where the one part alone stands
ATTRIBUTES = {
    "float": {"value"},
    "int": {"value"},
    "bool": {"value"},
    "parameter": {"name", "unit"},
    "system-mission-time": {"unit"},
}


class Expressions:
    """The expressions in the documents of one reader; each parameter is made once."""

    def __init__(self, reader: MefReader) -> None:
        self._reader = reader
        self._made: dict[str, Parameter] = {}
        self._open: list[str] = []  # parameters whose definitions are being read

    def all(self) -> dict[str, Parameter]:
        """Every parameter defined, by name."""
        return {name: self._parameter(name, element) for name, (element, _) in self._reader.parameters.items()}

    def probability(self, element: Element, scope: str) -> Expression:
        """An expression that stands for a probability."""
        expression = self.read(element, scope)
        _check_unit(expression, PURE, element)
        return expression

    def fields(self, element: Element, scope: str) -> dict[str, Any]:
        """The fields of a basic event that has this probability; what is a plain number stays one."""
        expression = self.probability(element, scope)
        if isinstance(expression, Exponential):
            rate, time = map(plain, expression.arguments)
            if rate is not None and (time is not None or isinstance(expression.arguments[1], MissionTime)):
                return {"rate_per_hour": rate, "mission_time_h": time}
        number = plain(expression)
        return {"expression": expression} if number is None else {"probability": number}

    def read(self, element: Element, scope: str) -> Expression:
        """An expression written inside `scope` ("Tree.Component."). Raises TreeError with file and line."""
        tag = element.tag
        if unknown := element.attributes.keys() - ATTRIBUTES.get(tag, set()):
            raise element.error(f'<{tag}> has the unknown attribute "{min(unknown)}"; remove it or correct its name')
        if tag in NUMBERS:
            return Constant(self._reader.number(element))
        if tag == "bool":
            return Constant(int(truth(element)))
        if tag == "parameter":
            return self._reference(element, scope)
        if tag == "system-mission-time":
            if element.attributes.get("unit", "hours") != "hours":
                raise element.error(f'<{tag}> is in hours, not in "{element.attributes["unit"]}"; correct the unit')
            return MissionTime()
        parts = _flat(element)
        arguments = [self.read(part, scope) for part in parts]
        for argument, part, unit in zip(arguments, parts, EXPECTED.get(tag, {}).get(len(parts), ()), strict=False):
            _check_unit(argument, unit, part)
        if tag == "div" and len(parts) == 2 and all(isinstance(one, Constant) for one in arguments):
            number = plain(Operation(tag, *arguments))
            if number is not None:
                return Constant(number)
        with at(element.place):
            function = FUNCTIONS.get(tag)
            return Operation(tag, *arguments) if function is None else function(*arguments)

    def _reference(self, element: Element, scope: str) -> Parameter:
        given = element.get("name")
        parameter = self._parameter(self._reader.parameter_names.find(given, scope, element), element)
        unit = element.attributes.get("unit", parameter.unit)
        if unit != parameter.unit:
            raise element.error(
                f'parameter "{given}" is used in "{unit}" and defined in "{parameter.unit or "no unit"}"; '
                "units are not converted, make them the same"
            )
        return parameter

    def _parameter(self, name: str, element: Element) -> Parameter:
        if name in self._made:
            return self._made[name]
        if name in self._open:
            loop = " -> ".join([*self._open[self._open.index(name) :], name])
            raise element.error(f"parameters in a cycle: {loop}; give one of them a number")
        if name not in self._reader.parameters:
            raise element.error(f'parameter "{name}" is not defined; define it or read the file that does as well')
        definition, scope = self._reader.parameters[name]
        unit = definition.attributes.get("unit", "")
        if unit and unit not in UNITS:
            raise definition.error(
                f'unit="{unit}" of parameter "{name}" is unknown, expected one of {", ".join(UNITS)}'
            )
        self._open.append(name)
        value = self.read(only(definition, "an expression"), scope)
        self._open.pop()
        self._made[name] = Parameter(name, value, unit, dict(attributes(definition)).get("source", ""))
        return self._made[name]


def _flat(element: Element) -> list[Element]:
    """The arguments of an expression; those of <case> and <bin> stand in one row with the rest."""
    children = [child for child in element.children if child.tag not in ANNOTATIONS]
    if element.tag not in INNER:
        return children
    inner, alone = INNER[element.tag]
    if not children or [place for place, child in enumerate(children) if child.tag != inner] != [alone % len(children)]:
        where = "first" if alone == 0 else "last"
        raise element.error(f"<{element.tag}> holds <{inner}> elements and {where} one expression; correct its order")
    parts: list[Element] = []
    for child in children:
        if child.tag == inner and len(child.children) != 2:
            raise child.error(f"<{inner}> has {len(child.children)} parts, expected 2; correct it")
        parts.extend(child.children if child.tag == inner else [child])
    return parts


def _check_unit(argument: Expression, expected: tuple[str, ...], element: Element) -> None:
    if isinstance(argument, Parameter) and argument.unit and argument.unit not in expected:
        raise element.error(
            f'parameter "{argument.name}" is in "{argument.unit}" where {" or ".join(expected)} is expected; '
            "units are not converted, give it in that unit"
        )


def plain(expression: Expression) -> Fraction | None:
    """The exact value of an expression that nothing can change."""
    fixed = expression.is_certain and not expression.uses_mission_time and not expression.parameters
    return expression.exact() if fixed else None

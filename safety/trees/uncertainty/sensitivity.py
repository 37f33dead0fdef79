"""Sensitivity of the top event to a quantity: its derivative, and how far one at a time moves the top.

A quantity is a parameter by its name, a random variable by its name (see `sampling`), the probability of a basic event
by the event's name, or MISSION_TIME. Units: those of the quantity; hours for the mission time.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from fractions import Fraction
from typing import Any

from safety.trees.as_written import Rational, TreeError, exact
from safety.trees.expressions.expression import Expression, MissionTime
from safety.trees.expressions.lifetimes import Exponential
from safety.trees.expressions.readings import MISSION_TIME, NOTHING
from safety.trees.solve import Solution
from safety.trees.tree import BasicEvent, FaultTree
from safety.trees.uncertainty.sampling import parameters


@dataclass(frozen=True)
class Derivative:
    """The derivative of the top's probability by a quantity, and relative to both: (x / P) dP/dx, None if P is 0.

    `kind` is "parameter", "event" or MISSION_TIME: a parameter and an event may have one name.
    """

    name: str
    kind: str
    value: float
    derivative: float
    elasticity: float | None


def derivatives(solution: Solution) -> list[Derivative]:
    """For every parameter, every basic event and the mission time, the largest elasticity first; empty if P is unknown.

    By the chain rule over the importance of the events, all in one pass over the diagram.
    """
    top, importance = solution.probability, solution.importance()
    if top is None:
        return []
    tree, terms = solution.tree, dict[str, list[float]]()
    shared = parameters(tree)
    values = {MISSION_TIME: tree.mission_time_h}
    found = []
    for event in tree.events:
        if event.name not in importance:
            continue
        slope, timed = importance[event.name].birnbaum, _timed(event)
        found.append(_derivative(event.name, "event", importance[event.name].probability, slope, top))
        if timed is None:
            continue
        names = [*timed.parameters, *([MISSION_TIME] if timed.uses_mission_time else [])]
        for name in names:
            terms.setdefault(name, []).append(slope * timed.derivative(name, event.mission_time_h) if slope else 0.0)
            if name in shared and name not in values:
                values[name] = exact(shared[name].value(event.mission_time_h), name)
            elif name == MISSION_TIME and values[name] is None:
                values[name] = event.mission_time_h
    for name, parts in terms.items():
        value = values[name]
        assert value is not None
        kind = "parameter" if name in shared else MISSION_TIME
        found.append(_derivative(name, kind, float(value), math.fsum(parts), top))
    return sorted(found, key=lambda one: (-abs(one.elasticity or 0), one.name, one.kind))


def _derivative(name: str, kind: str, value: float, slope: float, top: float) -> Derivative:
    return Derivative(name, kind, value, slope, value * slope / top if top else None)


def _timed(event: BasicEvent) -> Expression | None:
    """What gives the event's probability as a function of parameters and the mission time, if of any."""
    if event.expression is not None:
        return event.expression
    if event.probability is None and event.rate_per_hour is not None:
        return Exponential(event.rate_per_hour, MissionTime())
    return None


@dataclass(frozen=True)
class Bar:
    """One bar of a tornado diagram: the top's probability with one quantity at `low` and at `high`, all else as is."""

    name: str
    low: float
    high: float
    top_low: float
    top_high: float

    @property
    def swing(self) -> float:
        """Width of the bar."""
        return abs(self.top_high - self.top_low)


def tornado(
    solution: Solution,
    ranges: Mapping[str, tuple[Rational, Rational]] = NOTHING,
    quantiles: tuple[float, float] = (0.05, 0.95),
) -> list[Bar]:
    """The bars of all random variables between two quantiles and of the quantities in `ranges`, the widest first.

    All cases are evaluated in one pass. Raises TreeError: an unknown or ambiguous name (see `quantity`), a value out of
    range.
    """
    import numpy as np

    from safety.trees.uncertainty.sampling import Columns, Draws, probabilities, variables

    tree = solution.tree
    shared, random = parameters(tree), variables(tree)
    events = {event.name: i for i, event in enumerate(tree.events)}
    chosen = {
        name: ("variable", name) if name in random and name not in {*shared, *events} else quantity(name, tree)
        for name in ranges
    }
    as_asked = {plain: name for name, (kind, plain) in chosen.items() if kind == "parameter"}
    names = [*(name for name in random if name not in ranges), *ranges]
    places = {name: slice(2 * n, 2 * n + 2) for n, name in enumerate(names)}
    ends = {name: tuple(float(exact(end, f'range of "{name}"')) for end in pair) for name, pair in ranges.items()}

    class Cases(Draws):
        """Each random variable at its mean, but in its own two cases at the ends of its range."""

        def random(self, distribution: Any, values: list[Any], path: str) -> Any:
            """The cases of the variable at `path`."""
            mean = distribution.formula(self.arithmetic, *values)
            if path not in ends:
                middle = [argument.value(self.mission_time_h) for argument in distribution.arguments]
                ends[path] = tuple(distribution.quantile(np.array(quantiles), *middle).tolist())
            return self._varied(path, mean)

        def parameter(self, parameter: Any) -> Any:
            """The cases of a parameter."""
            value = super().parameter(parameter)
            return self._varied(as_asked[parameter.name], value) if parameter.name in as_asked else value

        def exactly(self, expression: Expression) -> Fraction | None:
            """None for what is varied."""
            return None if expression.parameters.keys() & as_asked.keys() else super().exactly(expression)

        def _varied(self, name: str, value: Any) -> Any:
            cases = np.full(2 * len(names), value) if np.ndim(value) == 0 else np.array(value)
            cases[places[name]] = ends[name]
            return cases

    columns: Columns = probabilities(tree, 2 * len(names), Cases)
    for name, (kind, plain) in chosen.items():
        if kind == "event":
            columns.values[events[plain], places[name]] = ends[name]
    top = solution.many(columns.values)
    bars = [Bar(name, *ends[name], *top[places[name]]) for name in names]
    return sorted(bars, key=lambda bar: (-bar.swing, bar.name))


def fields(solution: Solution, ranges: Mapping[str, tuple[Rational, Rational]] = NOTHING) -> dict[str, Any]:
    """What a results document says of the sensitivity: plain numbers, lists and texts."""
    bars = tornado(solution, ranges) if ranges or any(not e.is_certain for e in _expressions(solution.tree)) else []
    return {
        "derivatives": [asdict(one) for one in derivatives(solution)],
        "tornado": [asdict(bar) for bar in bars],
    }


def _expressions(tree: FaultTree) -> Iterator[Expression]:
    return (each for event in tree.events if event.expression is not None for each in event.expression.below())


def quantity(name: str, tree: FaultTree) -> tuple[str, str]:
    """The kind, "parameter" or "event", and the plain name of the quantity `name`, before which its kind may stand.

    Raises TreeError: there is none of the name, or one of each kind.
    """
    kinds = {"parameter": parameters(tree).keys(), "event": {event.name for event in tree.events}}
    found = [(kind, name) for kind, names in kinds.items() if name in names]
    if not found:
        kind, _, plain = name.partition(":")
        found = [(kind, plain)] if plain in kinds.get(kind, ()) else []
    if len(found) > 1:
        raise TreeError(
            f'"{name}" is a parameter and a basic event of fault tree "{tree.name}"; write "parameter:{name}" or '
            f'"event:{name}"',
            name,
        )
    if found:
        return found[0]
    known = sorted(set().union(*kinds.values()))
    some = ", ".join(known[:8]) + ", ..." * (len(known) > 8)
    raise TreeError(
        f'"{name}" is neither a parameter nor a basic event of fault tree "{tree.name}", which has {some}', name
    )

"""Which behaviour over the mission each basic event of a tree has, read off its rate or expression.

A rated event whose exposure time is not the mission's, as any law of a fixed time, keeps the probability that it has
then: how often it fails is not known, as it is not said when its exposure begins anew.

Units: hours, rates per hour. Source: Open-PSA Model Exchange Format 2.0d, section 5.3.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from safety.trees.as_written import TreeError
from safety.trees.over_time.behaviour import ONE, ZERO, Behaviour, Expressed, Relaxing, Tested
from safety.trees.tree import BasicEvent, FaultTree

if TYPE_CHECKING:
    from safety.trees.expressions.expression import Expression

LAWS = ("exponential", "Weibull", "GLM", "periodic-test")


def mission_time(tree: FaultTree) -> Fraction | None:
    """The mission time of the tree or, if it has none, that of its events; None if they have none either.

    Raises TreeError when events of a tree without one differ.
    """
    if tree.mission_time_h is not None:
        return tree.mission_time_h
    times = {event.mission_time_h: event.name for event in tree.events if event.mission_time_h is not None}
    if len(times) > 1:
        (one, first), (other, second) = list(times.items())[:2]
        raise TreeError(
            f'basic events "{first}" and "{second}" have mission times of {float(one or 0):g} h and '
            f'{float(other or 0):g} h; give fault tree "{tree.name}" the mission_time_h that is to vary',
            second,
        )
    return next(iter(times), None)


def behaviours(tree: FaultTree) -> list[Behaviour]:
    """What each event of `tree` does as time goes on, in the order of its events.

    An event with a rate follows the time if its mission time is the tree's; with another one of its own it keeps the
    probability that it has then. Raises TreeError: an event without a probability; a rate no double can hold.
    """
    time = mission_time(tree)
    return [_behaviour(event, time) for event in tree.events]


def _behaviour(event: BasicEvent, time: Fraction | None) -> Behaviour:
    rate, expression = event.rate_per_hour, event.expression
    follows = event.mission_time_h == time
    try:
        if rate is not None and event.probability is None and follows:
            return Relaxing(ZERO, ONE, rate, rate)
        if expression is not None and expression.uses_mission_time and follows:
            return _law(event.name, expression)
    except TreeError as error:
        raise TreeError(f'basic event "{event.name}": {error.message}', event.name, error.place) from None
    unknown = _unknown(event)
    if event.exact_chance is not None:
        return Relaxing(event.exact_chance[0], ZERO, unknown=unknown)
    if event.chance is None:
        raise TreeError(
            f'basic event "{event.name}" has no probability, so nothing can be said over time; give it one', event.name
        )
    return Relaxing(Fraction(event.chance[0]), ZERO, is_exact=False, unknown=unknown)


def _unknown(event: BasicEvent) -> str:
    """Why it is not known how often an event fails that keeps its probability; nothing if it does not fail."""
    if event.rate_per_hour and event.probability is not None:
        return "it has a probability beside its rate; give it only the rate"
    if event.rate_per_hour or (event.expression is not None and event.expression.uses_mission_time):
        return (
            f"its exposure time of its own, {float(event.mission_time_h or 0):g} h, does not say how often it begins "
            "anew; give it the mission time, or a periodic-test"
        )
    for part in event.expression.below() if event.expression is not None else ():
        if part.tag in LAWS:
            return f"its <{part.tag}> is of a fixed time, not of the mission time; give it <system-mission-time/>"
    return ""


def _law(name: str, expression: Expression) -> Behaviour:
    while expression.tag == "parameter":
        expression = expression.arguments[0]
    arguments = expression.arguments
    times = [part.uses_mission_time for part in arguments]
    if expression.tag == "mul" and sum(times) == 1:
        law, others = arguments[times.index(True)], [part for part in arguments if not part.uses_mission_time]
        return _scaled(_law(name, law), *_product(others))
    if expression.tag == "div" and times[0] and not any(times[1:]):
        divisor, exact = _product(arguments[1:])
        return _scaled(_law(name, arguments[0]), 1 / divisor, exact)
    *given, last = arguments or (expression,)
    while last.tag == "parameter":
        last = last.arguments[0]
    if last.tag != "system-mission-time" or any(argument.uses_mission_time for argument in given):
        return Expressed(name, expression)
    numbers = [_number(argument) for argument in given]
    values, exact = [value for value, _ in numbers], all(is_exact for _, is_exact in numbers)
    match expression.tag, values:
        case "exponential", [rate]:
            return Relaxing(ZERO, ONE, rate, rate, is_exact=exact)
        case "GLM", [gamma, rate, repair]:
            total = rate + repair
            return Relaxing(gamma, rate / total if total else gamma, total, rate, repair, is_exact=exact)
        case "periodic-test", [rate, interval, first]:
            return Relaxing(ZERO, ONE, rate, rate, first_test=first, interval=interval, is_exact=exact)
        case "periodic-test", [rate, repair, interval, first]:
            return Tested(rate, repair, interval, first)
    return Expressed(name, expression)


def _scaled(law: Behaviour, factor: Fraction, exact: bool) -> Behaviour:
    if isinstance(law, Relaxing):
        return replace(law, scale=law.scale * factor, is_exact=law.is_exact and exact)
    return replace(law, scale=law.scale * factor)


def _product(expressions: Iterable[Expression]) -> tuple[Fraction, bool]:
    numbers = [_number(expression) for expression in expressions]
    return math.prod((number for number, _ in numbers), start=ONE), all(exact for _, exact in numbers)


def _number(expression: Expression) -> tuple[Fraction, bool]:
    exact = expression.exact() if all(part.is_certain for part in expression.below()) else None
    return (Fraction(expression.value()), False) if exact is None else (exact, True)

"""Data of a tree in Galileo text that stand in files of their own: rates and probabilities, uncertain ones too.

Galileo text holds plain numbers only. Data are the basic events of an Open-PSA MEF file, by name: one whose
probability is an `exponential` over the system mission time gives its rate, one whose probability does not change with
time gives that. They stand in place of what the tree says. In the results the figure of an uncertain quantity is its
mean, as the nearest double where it is no rational.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from safety.trees.as_written import TreeError
from safety.trees.dynamic.tree import DynamicTree, TimedEvent
from safety.trees.expressions.expression import Constant, Expression
from safety.trees.expressions.lifetimes import constant_rate
from safety.trees.tree import BasicEvent, FaultTree


@dataclass(frozen=True)
class Data:
    """`tree` with the data in it; `rates` (per hour) and `chances` are the expressions of the uncertain events."""

    tree: DynamicTree
    rates: Mapping[str, Expression]
    chances: Mapping[str, Expression]
    sources: Mapping[str, str]  # source tags of the events that have one

    @property
    def is_certain(self) -> bool:
        """Whether there is nothing to sample."""
        return not self.rates and not self.chances


def with_data(tree: DynamicTree, events: Iterable[BasicEvent]) -> Data:
    """`tree` with the figures of `events`.

    Raises TreeError: an event that the tree does not have or without a figure, one whose probability changes with time
    otherwise than by a constant rate, a rate or probability out of range.
    """
    data, found = _of(tree, events), list[TimedEvent]()
    rates, chances, sources = dict[str, Expression](), dict[str, Expression](), dict[str, str]()
    for event in tree.events:
        if event.name not in data:
            found.append(event)
            continue
        given = data[event.name]
        rate, chance = _rate(given), _chance(given)
        figure = rate if rate is not None else chance
        if figure is None:
            raise TreeError(
                f'"{event.name}" has neither a constant rate nor a constant probability, as parts of dynamic trees '
                "have; give it an exponential of its rate and the system-mission-time, or a probability without time",
                event.name,
            )
        if not all(part.is_certain for part in figure.below()):
            (chances if rate is None else rates)[event.name] = figure
        value = figure.exact()
        number = Fraction(figure.value()) if value is None else value
        if event.name in rates and not number:
            raise TreeError(
                f'the rate of "{event.name}" is uncertain with mean 0, so its failures would be left out; give it a '
                "distribution with a mean above 0",
                event.name,
            )
        found.append(replace(event, rate_per_hour=None, probability=number) if rate is None else
                     replace(event, rate_per_hour=number, probability=None))  # fmt: skip
        sources[event.name] = given.source
    return Data(replace(tree, events=tuple(found)), rates, chances, sources)


def _rate(event: BasicEvent) -> Expression | None:
    """Its rate per hour over the system mission time, None if it has none."""
    if event.probability is None and event.rate_per_hour is not None and event.mission_time_h is None:
        return Constant(event.rate_per_hour)
    return constant_rate(event.expression)


def _chance(event: BasicEvent) -> Expression | None:
    """Its probability, None if it has none or one that changes with time."""
    if event.probability is not None:
        return Constant(event.probability)
    timeless = event.expression is not None and not event.expression.uses_mission_time
    return event.expression if timeless else None


def static_with_data(tree: DynamicTree, events: Iterable[BasicEvent], mission_time_h: Fraction | None) -> FaultTree:
    """A static `tree` with `events` in place of its own of these names. Raises TreeError as `DynamicTree.static`."""
    data, plain = _of(tree, events), tree.static(mission_time_h)
    return replace(plain, events=tuple(data.get(event.name, event) for event in plain.events))


def _of(tree: DynamicTree, events: Iterable[BasicEvent]) -> dict[str, BasicEvent]:
    """The data by name. Raises TreeError for one of no event of the tree."""
    data = {event.name: event for event in events}
    if unknown := data.keys() - {event.name for event in tree.events}:
        name = min(unknown)
        raise TreeError(
            f'the data are of "{name}", which is no basic event of the tree "{tree.name}"; correct the name', name
        )
    return data

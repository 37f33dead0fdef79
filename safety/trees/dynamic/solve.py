"""Solving a dynamic tree: parts that can be solved apart by Markov chain, what joins them by decision diagram."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property, partial
from typing import TypeAlias

from safety.rates.enclosure import INFINITE, Enclosure
from safety.trees.as_written import Rational, TreeError, exact
from safety.trees.dynamic.chain import HALF_ULP, FailureChain
from safety.trees.dynamic.modules import Part, parts, whole
from safety.trees.dynamic.states import BUDGET, States, explore
from safety.trees.dynamic.tree import DynamicTree, TimedEvent
from safety.trees.solve import Solution, solve
from safety.trees.tree import LARGEST, FaultTree

EXACT_NODES = 20_000  # largest diagram that is evaluated in rationals
CHANCE_ERROR = 12 * HALF_ULP  # of 1 - exp(-rate x time) in doubles, relative
Ends: TypeAlias = "tuple[array[float], array[float]]"  # the least and the largest values of one figure at some times


class DynamicSolution:
    """What is known of `tree`: every figure as an enclosure, computed when first asked for.

    `rates` (per hour, by event name) replace those of the tree; chains and diagrams are kept (see `with_rates`).
    """

    def __init__(
        self,
        tree: DynamicTree,
        found: tuple[Part, ...],
        chains: Mapping[str, States],
        diagrams: Mapping[str, Solution],
        search: Callable[..., States],
        rates: Mapping[str, Rational],
    ) -> None:
        self.tree, self.parts, self.states, self.diagrams = tree, found, chains, diagrams
        self._search, self.rates = search, rates
        for name in rates:
            event = tree.nodes.get(name)
            if not isinstance(event, TimedEvent) or event.rate_per_hour is None:
                raise TreeError(f'a rate is given for "{name}", which is no event with a rate; correct the name', name)
        self.chains = {name: FailureChain(states, rates) for name, states in chains.items()}

    def with_rates(self, rates: Mapping[str, Rational]) -> DynamicSolution:
        """The same tree under other rates per hour (0 or more), without a new search for states.

        Raises TreeError: an unknown event, a rate for one that had rate 0 (its failures were left out).
        """
        for name in rates:
            event = self.tree.nodes.get(name)
            if isinstance(event, TimedEvent) and event.rate_per_hour == 0:
                raise TreeError(
                    f'event "{name}" has rate 0, so its failures were left out; solve again with a rate', name
                )
        return DynamicSolution(self.tree, self.parts, self.states, self.diagrams, self._search, {**self.rates, **rates})

    def states_given(self, part: str, there: Mapping[str, bool], symmetry: bool = True) -> States:
        """The states of a part's chain, given of some events of fixed probability whether they are there.

        Without `symmetry` no events are taken to be alike.
        """
        if symmetry and not there:
            return self.states[part]
        tree = self.states[part].tree
        events = (replace(e, probability=Fraction(there[e.name])) if e.name in there else e for e in tree.events)
        search = self._search if symmetry else partial(self._search, symmetry=False)
        return search(replace(tree, events=tuple(events)))

    def probability(self, time_h: Rational) -> Enclosure:
        """Probability that the top has failed by `time_h` hours. Raises as `probabilities`."""
        return self.probabilities([time_h])[0]

    def probabilities(self, times_h: Sequence[Rational]) -> list[Enclosure]:
        """Probability that the top has failed by each of the times (hours).

        Raises TreeError for a negative time, NumericsFailed where rates differ too much for so long a time.
        """
        return self.curves(times_h)[self.tree.top]

    def curves(self, times_h: Sequence[Rational]) -> dict[str, list[Enclosure]]:
        """The same for every part, by its gate. Raises as `probabilities`."""
        times = [checked_time(time) for time in times_h]
        hours = [float(time) for time in times]
        known: dict[str, list[Enclosure]] = {}
        for part in self.parts:
            if part.static is None:
                known[part.name] = self.chains[part.name].probabilities(times)
            else:
                names = [event.name for event in part.static.events]
                rows = [_ends(known[name]) if name in known else self._chances(name, hours) for name in names]
                known[part.name] = self._joined(part.name, rows)
        return known

    def _chances(self, name: str, hours: Sequence[float]) -> Ends:
        """The least and the largest probabilities of an event by these times."""
        event = self.tree.nodes[name]
        assert isinstance(event, TimedEvent)
        if event.probability is not None:
            return _ends([Enclosure.exactly(event.probability)] * len(hours))
        rate = float(self.rate(event))
        middles = [-math.expm1(-rate * time) for time in hours]
        low, high = 1 - CHANCE_ERROR, 1 + CHANCE_ERROR
        return array("d", [p * low for p in middles]), array("d", [min(1.0, p * high) for p in middles])

    def rate(self, event: TimedEvent) -> Fraction:
        """Its failure rate per hour, 0 where it has a fixed probability."""
        rate = self.rates.get(event.name, event.rate_per_hour)
        return exact(rate if rate is not None else 0, f'rate of event "{event.name}"', event.name)

    def _joined(self, name: str, rows: Sequence[Ends]) -> list[Enclosure]:
        """The top of a diagram, which is monotone: lowest from the lowest, highest from the highest."""
        solution = self.diagrams[name]
        columns = array("d")
        for low, high in rows:
            columns += low + high
        values = solution.many(columns)
        error = Fraction(1.01 * HALF_ULP * 5 * (1 + sum(len(part.order) for part in solution.parts)))
        half = len(values) // 2
        return [
            Enclosure(Fraction(least) * (1 - error), min(Fraction(1), Fraction(most) * (1 + error)))
            for least, most in zip(values[:half], values[half:], strict=True)
        ]

    @cached_property
    def ever(self) -> Enclosure:
        """Probability that the top ever fails; exact where chains and diagrams are small."""
        known: dict[str, Enclosure] = {}
        for part in self.parts:
            if part.static is None:
                known[part.name] = self.chains[part.name].ever
                continue
            rows = [known.get(event.name) or self._ever(event.name) for event in part.static.events]
            known[part.name] = (
                self._ever_exact(part, rows) or self._joined(part.name, [_ends([row]) for row in rows])[0]
            )
        return known[self.tree.top]

    def _ever(self, name: str) -> Enclosure:
        event = self.tree.nodes[name]
        assert isinstance(event, TimedEvent)
        chance = event.probability if event.probability is not None else Fraction(self.rate(event) > 0)
        return Enclosure.exactly(chance)

    def _ever_exact(self, part: Part, rows: list[Enclosure]) -> Enclosure | None:
        assert part.static is not None
        if self.diagrams[part.name].nodes > EXACT_NODES or not all(row.exact for row in rows):
            return None
        events = [replace(e, probability=Fraction(row.low)) for e, row in zip(part.static.events, rows, strict=True)]
        value = solve(replace(part.static, events=tuple(events))).exact
        return None if value is None else Enclosure.exactly(value)

    def mean_time(self, budget: int = BUDGET) -> Enclosure:
        """Mean time until the top fails, in hours; infinite where it may never fail.

        Of the whole tree as one chain, as the parts' means do not add up. Raises TooLarge when that has more states
        than `budget`.
        """
        if self.ever.high < 1:
            return Enclosure.exactly(INFINITE)
        if len(self.parts) == 1 and self.parts[0].static is None:
            return self.chains[self.parts[0].name].mean_time
        return FailureChain(self._search(whole(self.tree), budget=budget), self.rates).mean_time


def checked_time(time_h: Rational, what: str = "time") -> Fraction:
    """A time in hours, if it is from 0 to LARGEST. Raises TreeError if it is not."""
    time = exact(time_h, what)
    if not 0 <= time <= LARGEST:
        shown = time if time < LARGEST else f"about 1e{len(str(int(time))) - 1}"
        raise TreeError(f"{what} is {shown} h, expected 0 to {float(LARGEST):.0e}; correct it")
    return time


def solve_dynamic(
    tree: DynamicTree, *, ties: str = "refuse", budget: int = BUDGET, symmetry: bool = True
) -> DynamicSolution:
    """Solve `tree`, static or dynamic.

    With ties="as written" simultaneous dependents fail, and racing spare gates claim, in the order written. With
    `symmetry` equal parts share states; turn it off to give them unequal rates later. Raises TreeError where the order
    of ties would change the result and ties="refuse", TooLarge for a part with more than `budget` states.
    """
    found = parts(tree)
    search = partial(explore, ties=ties, budget=budget, symmetry=symmetry)
    chains = {part.name: search(part.dynamic) for part in found if part.dynamic}
    diagrams = {part.name: solve(part.static) for part in found if part.static}
    return DynamicSolution(tree, found, chains, diagrams, search, {})


def joined_tree(solution: DynamicSolution, time_h: Rational) -> FaultTree | None:
    """The static tree that joins the parts, its events with their probabilities by `time_h` hours (middles).

    None where the whole tree is one chain.
    """
    top = solution.parts[-1]
    if top.static is None:
        return None
    time = exact(time_h, "time")
    known, events = solution.curves([time]), []
    for event in top.static.events:
        node = solution.tree.nodes.get(event.name)
        if event.name in known:
            events.append(replace(event, probability=Fraction(known[event.name][0].middle)))
        elif isinstance(node, TimedEvent) and node.probability is not None:
            events.append(replace(event, probability=node.probability))
        elif isinstance(node, TimedEvent):
            events.append(replace(event, rate_per_hour=solution.rate(node), mission_time_h=time))
    return replace(top.static, events=tuple(events))


def _ends(found: Sequence[Enclosure]) -> Ends:
    return array("d", [float(one.low) for one in found]), array("d", [float(one.high) for one in found])

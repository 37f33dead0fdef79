"""Uncertainty of event trees: how the figures of every sequence spread as parameters range over their distributions.

All sequences of all initiating events are evaluated on the same samples, so that what they share is the same in each
of them: parameters, basic events, split fractions, the frequency of an initiating event. A distribution that is
written where an expression is collected, outside of parameters, is one variable, whichever paths pass there.

Probabilities have no unit, frequencies that of the initiating event.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from typing import TYPE_CHECKING, Any

import numpy as np

from safety.trees.as_written import TreeError
from safety.trees.event_trees.answers import EventTreeAnswer, Part, SequenceAnswer
from safety.trees.expressions.expression import Constant, Expression, draws
from safety.trees.tree import BasicEvent
from safety.trees.uncertainty.correlation import Vector
from safety.trees.uncertainty.propagation import BYTES, CHUNK, Uncertainty, drawn, fields
from safety.trees.uncertainty.sampling import Columns, Plan, Quantities, Quantity, variables_by_event

if TYPE_CHECKING:
    from safety.trees.event_trees.definitions import Factor

Answers = Sequence[tuple[EventTreeAnswer, Fraction]]  # each with the fraction of the time for which it holds


@dataclass(frozen=True)
class SequenceSpread:
    """The sampled distributions of the figures of a sequence; None for a frequency where there is none.

    `everywhere` is that of its frequency over all initiating events.
    """

    probability: Uncertainty
    frequency: Uncertainty | None
    everywhere: Uncertainty | None

    def fields(self) -> dict[str, Any]:
        """What a results document says of it, under the names of the figures."""
        spreads = {
            "uncertainty": self.probability,
            "frequency_uncertainty": self.frequency,
            "frequency_of_all_initiating_events_uncertainty": self.everywhere,
        }
        return {key: fields(spread) for key, spread in spreads.items() if spread is not None}


def propagate(
    answers: Answers, plan: Plan | None = None, mission_time_h: Fraction | None = None
) -> list[dict[str, SequenceSpread]]:
    """For each answer, the spread of every sequence by name; `mission_time_h` (hours) is that of the study.

    Raises TreeError: nothing is uncertain, an event has no probability, a value is missing in some sample, samples that
    take more than BYTES.
    """
    return _Sampled(answers, plan or Plan(), mission_time_h).spreads()


class _Sampled:
    """The samples of all that is uncertain behind `answers`."""

    def __init__(self, answers: Answers, plan: Plan, mission_time_h: Fraction | None) -> None:
        self.answers, self.plan, self.mission_time_h = answers, plan, mission_time_h
        self.rows: dict[str, int] = {}  # of each event and quantity
        self.factors: dict[object, str] = {}  # the names of expressions
        self.events = self._events()
        quantities = [*self._quantities()]
        for quantity in quantities:
            self.rows[quantity.name] = len(self.rows)
        self.holder = Quantities("the study", (*self.events.values(), *quantities))
        self.random = variables_by_event(self.holder)

    def _events(self) -> dict[str, BasicEvent]:
        found: dict[str, BasicEvent] = {}
        for _, _, sequence in self.sequences():
            for part in sequence.parts:
                for event in part.solution.tree.events:
                    known = found.setdefault(event.name, event)
                    self.rows.setdefault(event.name, len(self.rows))
                    if (known.chance, known.expression) != (event.chance, event.expression):
                        raise TreeError(
                            f'basic event "{event.name}" differs from sequence to sequence, so it cannot be sampled; '
                            "give the members of its common-cause group one distribution",
                            event.name,
                        )
        return found

    def sequences(self) -> Iterator[tuple[int, str, SequenceAnswer]]:
        """Every sequence, with the number of its answer and its name."""
        for number, (answer, _) in enumerate(self.answers):
            for name, sequence in answer.sequences.items():
                yield number, name, sequence

    def _quantities(self) -> Iterator[Quantity]:
        """Frequencies and split fractions that are expressions."""
        for answer, _ in self.answers:
            initiating = answer.initiating
            yield from self._named(
                initiating.frequency,
                f"frequency of {initiating.name}",
                f'the frequency of initiating event "{initiating.name}"',
            )
            for sequence in answer.sequences.values():
                for one in (one for part in sequence.parts for one in part.expressions):
                    number = len(self.factors) + 1
                    what = f'an expression collected on the way to sequence "{sequence.name}"'
                    yield from self._named(one, f"collected expression {number}", what)

    def _named(self, one: Factor | None, name: str, what: str) -> Iterator[Quantity]:
        if isinstance(one, Expression) and _place(one) not in self.factors:
            while name in self.events:
                name += "'"
            self.factors[_place(one)] = name
            yield Quantity(name, what, one, self.mission_time_h)

    def spreads(self) -> list[dict[str, SequenceSpread]]:
        """See `propagate`."""
        places = [(number, name) for number, name, _ in self.sequences()]
        if (needed := 8 * self.plan.samples * 3 * len(places)) > BYTES:
            raise TreeError(
                f"{self.plan.samples} samples of {len(places)} sequences take {needed / 1e9:.3g} GB, expected at most "
                f"{BYTES / 1e9:g} GB; take fewer samples"
            )
        _, chunks = drawn(self.holder, self.plan, max(1, min(CHUNK, CHUNK * 200 // max(1, len(self.rows)))))
        chance = {place: np.empty(self.plan.samples) for place in places}
        times = [np.ones(self.plan.samples) for _ in self.answers]
        outside = Counter[str]()
        for first, columns in chunks:
            here = slice(first, first + columns.values.shape[1])
            outside.update(columns.outside)
            for number, name, sequence in self.sequences():
                chance[number, name][here] = sum(self._chance(part, columns) for part in sequence.parts)
            for number, (answer, _) in enumerate(self.answers):
                times[number][here] = self._factor(answer.initiating.frequency, columns)
        result: list[dict[str, SequenceSpread]] = [{} for _ in self.answers]
        everywhere = self._everywhere(chance, times)
        for number, name, sequence in self.sequences():
            answer, values = self.answers[number][0], chance[number, name]
            names = self._of(sequence)
            often = answer.initiating.frequency is not None
            known = names | self._of_factor(answer.initiating.frequency)
            result[number][name] = SequenceSpread(
                self._spread(values, names, outside, 1.0 if _is_probability(sequence) else None),
                self._spread(values * times[number], known, outside) if often else None,
                self._spread(everywhere[name], self._of_all(name), outside) if name in everywhere else None,
            )
        return result

    def _everywhere(self, chance: Mapping[tuple[int, str], Vector], times: list[Vector]) -> dict[str, Vector]:
        """The frequency of each sequence over all initiating events, as `consequences`."""
        total: dict[str, Vector] = {}
        unknown = set()
        for number, name, _ in self.sequences():
            answer, fraction = self.answers[number]
            if answer.initiating.frequency is None:
                unknown.add(name)
            total[name] = total.get(name, 0.0) + chance[number, name] * times[number] * float(fraction)
        return {name: values for name, values in total.items() if name not in unknown}

    def _chance(self, part: Part, columns: Columns) -> Vector:
        """Samples of the probability of the paths that collected the same."""
        rows = [self.rows[name] for name in part.solution.events]
        size = columns.values.shape[1]
        value = np.array(part.solution.many(columns.values[rows])) if rows else np.full(size, part.solution.probability)
        return reduce(np.multiply, (self._factor(one, columns) for one in part.expressions), value)

    def _factor(self, one: Factor | None, columns: Columns) -> Any:
        if isinstance(one, Expression):
            return columns.values[self.rows[self.factors[_place(one)]]]
        return 1.0 if one is None else Constant(one).value()

    def _spread(
        self, values: Vector, names: set[str], outside: Mapping[str, int], greatest: float | None = None
    ) -> Uncertainty:
        """What `values` say, which depend on the events and quantities `names`."""
        random = sorted({variable for name in names for variable in self.random.get(name, ())})
        left = {name: count for name, count in outside.items() if name in names}
        return Uncertainty(
            values, self.plan.blocks * self.plan.hypercube, 0.0, greatest, self.plan, tuple(random), left
        )

    def _of(self, sequence: SequenceAnswer) -> set[str]:
        events = {name for part in sequence.parts for name in part.solution.events}
        return events.union(*(self._of_factor(one) for part in sequence.parts for one in part.expressions))

    def _of_factor(self, one: Factor | None) -> set[str]:
        return {self.factors[_place(one)]} if isinstance(one, Expression) else set()

    def _of_all(self, name: str) -> set[str]:
        found: set[str] = set()
        for number, other, sequence in self.sequences():
            if other == name:
                found |= self._of(sequence) | self._of_factor(self.answers[number][0].initiating.frequency)
        return found


def _place(one: Expression) -> object:
    """What makes an expression the same as another: with a distribution of its own, where it stands."""
    return id(one) if draws(one) else one


def _is_probability(sequence: SequenceAnswer) -> bool:
    """Whether its figure cannot exceed 1: nothing was multiplied, no alternatives were added up."""
    return all(not part.expressions for part in sequence.parts)

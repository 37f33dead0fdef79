"""Answers of an event tree: how likely each sequence is, and whether the sequences share out all that can happen.

A sequence is the disjunction of the paths that end in it, a path the conjunction of the formulas it collected, with a
success as the exact negation of a failure, and the house events as they were when a formula was collected. It is
solved as one fault tree, with all that its formulas share. (To leave successes out, or only to delete the cut sets that
contradict them, the "delete-term" approximation, gives other and usually larger figures; it is used nowhere here.)
Expressions collected on a path, split fractions, multiply its probability; paths of one sequence that collected
different expressions are added up, as alternatives of each other.

That the paths exclude each other and leave nothing out is not assumed but checked. Without expressions the check is
logical: "two of the paths at once" and "none of the paths" must be impossible, whatever the probabilities. With and
without, the probabilities of the sequences must add up to 1, that is their frequencies to that of the initiating event
(with substitutions, which take cases out, to what these leave).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, reduce
from typing import TYPE_CHECKING

from safety.trees.as_written import TreeError
from safety.trees.event_trees.gates import Formulas
from safety.trees.event_trees.paths import Course, by_sequence, courses
from safety.trees.expressions.arithmetics import Interval, Intervals
from safety.trees.expressions.expression import Constant, Expression, draws
from safety.trees.importance.events import Importance, measures
from safety.trees.module_diagrams import TooLarge
from safety.trees.solve import Solution, solve
from safety.trees.tree import FaultTree

if TYPE_CHECKING:
    from safety.trees.event_trees.definitions import Factor, InitiatingEvent
    from safety.trees.study import Study

EXACT_NODES = 20_000  # largest diagram that is evaluated in rationals unasked


@dataclass(frozen=True)
class Figure:
    """A number, 0 or more: doubles that enclose it, and itself where it is a known rational."""

    within: Interval
    exact: Fraction | None = None

    @classmethod
    def of(cls, exact: Fraction) -> Figure:
        """A number that is known."""
        return cls(Intervals().number(exact), exact)

    @property
    def value(self) -> float:
        """The number, or the middle of what encloses it."""
        return (self.within.low + self.within.high) / 2 if self.exact is None else float(self.exact)

    def may_be(self, other: Figure) -> bool:
        """Whether the two can be the same number: whether they are, if both are known."""
        if self.exact is not None and other.exact is not None:
            return self.exact == other.exact
        return self.within.low <= other.within.high and other.within.low <= self.within.high

    def __mul__(self, other: Figure) -> Figure:
        if self.exact is not None and other.exact is not None:
            return Figure.of(self.exact * other.exact)
        return Figure(self.within * other.within)

    def __add__(self, other: Figure) -> Figure:
        if self.exact is not None and other.exact is not None:
            return Figure.of(self.exact + other.exact)
        return Figure(self.within + other.within)


ONE, NOTHING = Figure.of(Fraction(1)), Figure.of(Fraction(0))


@dataclass(frozen=True)
class Part:
    """The paths of a sequence that collected the same expressions: their product, and the rest as a solved tree."""

    factor: Figure
    solution: Solution
    expressions: tuple[Factor, ...] = ()  # whose product `factor` is

    @cached_property
    def probability(self) -> Figure | None:
        """Of the paths together; None if a basic event below them has none."""
        solution = self.solution
        exact = solution.exact if solution.nodes <= EXACT_NODES else None
        if exact is not None:
            return self.factor * Figure.of(exact)
        return None if solution.bounds is None else self.factor * Figure(Interval(*solution.bounds))


class SequenceAnswer:
    """A sequence after one initiating event: `courses` are the paths to it, `solution` says which failures it takes."""

    def __init__(self, name: str, paths: tuple[Course, ...], solution: Solution, parts: tuple[Part, ...]) -> None:
        self.name, self.courses, self.solution, self.parts = name, paths, solution, parts

    @cached_property
    def probability(self) -> Figure | None:
        """Given the initiating event; None if a basic event below has none. May exceed 1 by overlapping paths."""
        figures = [part.probability for part in self.parts]
        known = [figure for figure in figures if figure is not None]
        return reduce(Figure.__add__, known) if len(known) == len(figures) else None

    def importance(self) -> dict[str, Importance]:
        """What each basic event does to the probability of the sequence (`importance` has the measures)."""
        if self.probability is None:
            return {}
        if len(self.parts) == 1 and self.parts[0].factor == ONE:
            return self.solution.importance()
        top = self.probability.value
        slopes: dict[str, float] = {}
        for part in self.parts:
            for name, one in part.solution.importance().items():
                slopes[name] = slopes.get(name, 0.0) + part.factor.value * one.birnbaum
        chances = {name: q for part in self.parts for name, q in _chances(part.solution).items()}
        return {
            name: measures(name, q, top, top + (1 - q) * slopes[name], max(0.0, top - q * slopes[name]))
            for name, q in chances.items()
        }


@dataclass(frozen=True)
class EventTreeAnswer:
    """Everything that follows one initiating event."""

    initiating: InitiatingEvent
    frequency: Figure | None  # in the unit of the initiating event; None where it has none
    sequences: Mapping[str, SequenceAnswer]  # in the order in which the paths first reach them
    overlap: Solution | None  # "two paths at once"; None with expressions, or where it is too large
    gap: Solution | None  # "none of the paths", likewise
    whole: Figure | None = ONE  # the probability of anything at all: less than 1 where substitutions take cases out

    @cached_property
    def total(self) -> Figure | None:
        """The sum over all sequences: `whole` for a partition."""
        figures = [sequence.probability for sequence in self.sequences.values()]
        known = [figure for figure in figures if figure is not None]
        return reduce(Figure.__add__, known, NOTHING) if len(known) == len(figures) else None

    @cached_property
    def wrong(self) -> tuple[str, ...]:
        """Why the sequences are no partition of all that can happen, in words; empty if nothing speaks against it."""
        found = []
        if self.overlap is not None and _possible(self.overlap):
            found.append("two of its paths can be taken at once")
        if self.gap is not None and _possible(self.gap):
            found.append("there are cases in which none of its paths is taken")
        total, whole = self.total, self.whole
        if total is not None and whole is not None and not total.may_be(whole):
            found.append(f"the probabilities of its sequences add up to {total.value:.9g}, not to {whole.value:.9g}")
        return tuple(found)

    @property
    def is_partition(self) -> bool | None:
        """Whether each case is in just one sequence; None if neither logic nor numbers could tell."""
        if self.wrong:
            return False
        return True if self.total is not None or (self.overlap and self.gap) else None

    def frequency_of(self, sequence: str) -> Figure | None:
        """Of a sequence, in the unit of the initiating event; None if that or the probability is not known."""
        probability = self.sequences[sequence].probability
        return None if probability is None or self.frequency is None else self.frequency * probability


def analyse(study: Study, initiating: InitiatingEvent, house: Mapping[str, bool] | None = None) -> EventTreeAnswer:
    """Solve every sequence that `initiating` may lead to; `house` has states of house events other than those written.

    Raises TreeError: something is not defined, an expression has no value or is negative. Raises TooLarge.
    """
    walked = courses(initiating, study.event_trees)
    formulas = Formulas(study, house)
    sequences = {name: _sequence(name, paths, formulas, study) for name, paths in by_sequence(walked).items()}
    logical = not any(course.expressions for course in walked)
    frequency = None if initiating.frequency is None else _value((initiating.frequency,), study)
    whole = formulas.whole()
    return EventTreeAnswer(
        initiating,
        frequency,
        sequences,
        _solved(formulas.overlap(walked)) if logical else None,
        _solved(formulas.gap(walked)) if logical else None,
        ONE if whole is None else Part(ONE, solve(whole)).probability,
    )


def consequences(answers: Iterable[tuple[EventTreeAnswer, Fraction]]) -> dict[str, Figure | None]:
    """The frequency of each sequence over all initiating events; None where one of these has none.

    Each answer comes with the fraction of the time for which it holds.
    """
    result: dict[str, Figure | None] = {}
    for answer, fraction in answers:
        for name in answer.sequences:
            one, before = answer.frequency_of(name), result.get(name, NOTHING)
            result[name] = None if one is None or before is None else before + one * Figure.of(fraction)
    return result


def _sequence(name: str, paths: tuple[Course, ...], formulas: Formulas, study: Study) -> SequenceAnswer:
    description = next((s.description for tree in study.event_trees for s in tree.sequences if s.name == name), "")
    solution = solve(formulas.tree(name, paths, description))
    groups: dict[tuple[Factor | int, ...], list[Course]] = {}
    for course in paths:
        groups.setdefault(tuple(_variable(one) for one in course.expressions), []).append(course)
    parts = tuple(
        Part(
            _value(together[0].expressions, study),
            solution if len(groups) == 1 else solve(formulas.tree(name, together)),
            together[0].expressions,
        )
        for together in groups.values()
    )
    return SequenceAnswer(name, paths, solution, parts)


def _variable(one: Factor) -> Factor | int:
    """What is equal for expressions that are always equal: with a distribution of its own it is like no other."""
    return id(one) if isinstance(one, Expression) and draws(one) else one


def _value(expressions: tuple[Factor, ...], study: Study) -> Figure:
    product = ONE
    for one in expressions:
        expression = one if isinstance(one, Expression) else Constant(one)
        exact = expression.exact(study.mission_time_h)
        figure = Figure(Interval(*expression.enclosure(study.mission_time_h))) if exact is None else Figure.of(exact)
        if figure.value < 0:
            raise TreeError(f"an expression of an event tree is {figure.value:g}, expected 0 or more; correct it")
        product = product * figure
    return product


def _solved(tree: FaultTree) -> Solution | None:
    try:
        return solve(tree)
    except TooLarge:
        return None


def _possible(solution: Solution) -> bool:
    try:
        return bool(solution.counts)
    except TooLarge:  # then it is no constant
        return True


def _chances(solution: Solution) -> dict[str, float]:
    return {event.name: event.chance[0] for event in solution.tree.events if event.chance is not None}

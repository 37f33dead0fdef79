"""The states of a dynamic tree and the steps between them, found level by level with whole matrices of states.

States that differ only in what cannot matter any more are one state (`Rules.reduce`); all states in which the top has
failed are one, and so are all in which it never will.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from safety.trees.as_written import TreeError
from safety.trees.dynamic.rules import FAILED, NEVER, OPEN, REMEDY, Columns, Rules, conflicts
from safety.trees.dynamic.symmetry import Symmetry
from safety.trees.dynamic.tree import DynamicTree
from safety.trees.module_diagrams import TooLarge

BUDGET = 500_000  # states
CELLS = 30_000_000  # numbers of a state matrix treated at once
TIES = ("refuse", "as written")


@dataclass(frozen=True)
class Cause:
    """What makes a transition: event number `event` of the tree fails, then chances with product `factor` fall so."""

    event: int
    active: bool
    factor: Fraction

    def rate(self, tree: DynamicTree) -> Fraction:
        """Rate per hour."""
        event = tree.events[self.event]
        assert event.rate_per_hour is not None
        return event.rate_per_hour * self.factor * (1 if self.active else event.dormancy)


@dataclass(frozen=True)
class States:
    """`count` states; transition i goes from source[i] to target[i] by causes[cause[i]]. No transition leads back.

    `start` gives the states at time 0 with their probabilities; `failed` is the state in which the top has failed
    (None if no way leads there); `settled[s]` counts the events that are decided in s: it grows with every transition.
    """

    tree: DynamicTree
    count: int
    source: Any
    target: Any
    cause: Any
    causes: tuple[Cause, ...]
    start: dict[int, Fraction]
    failed: int | None
    settled: Any
    equal_events: tuple[frozenset[str], ...] = ()  # whose rates must stay equal, as they were taken to be alike


def explore(tree: DynamicTree, *, ties: str = "refuse", budget: int = BUDGET, symmetry: bool = True) -> States:
    """All states of `tree`. Raises TooLarge above `budget` states, TreeError where the order of ties decides.

    With ties="as written" simultaneous dependents fail, and racing spare gates claim, in the order their events and
    gates are written. With `symmetry` (not where ties are as written) equal parts that change places make no new state.
    """
    if ties not in TIES:
        raise TreeError(f"ties is {ties!r}, expected 'refuse' or 'as written'")
    return _Explorer(tree, ties == "refuse", budget, symmetry).run()


class _Explorer:
    def __init__(self, tree: DynamicTree, refuse_ties: bool, budget: int, symmetry: bool) -> None:
        self.tree, self.budget, self.refuse_ties = tree, budget, refuse_ties
        self.rules = Rules(tree, refuse_ties)
        self.conflicts = conflicts(self.rules)
        self.symmetry = Symmetry(self.rules) if symmetry and refuse_ties else None
        self.factors: list[Fraction] = [Fraction(1)]
        self.factor_number: dict[Fraction, int] = {Fraction(1): 0}
        self.known: dict[bytes, int] = {}

    def run(self) -> States:
        columns, weight = self.beginning()
        start: dict[int, Fraction] = {}
        numbers, fresh = self.number(columns)
        for number, one in zip(numbers, weight, strict=True):
            start[number] = start.get(number, Fraction(0)) + self.factors[one]
        found: list[Columns] = [columns[:, fresh]]
        parts: list[tuple[Any, Any, Any]] = []
        done = 0
        while done < len(found):
            parts += [self.transitions(piece, found) for piece in self.pieces(found[done])]
            done += 1
        source, target, cause = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
        classes, cause = np.unique(cause, return_inverse=True)
        every = np.concatenate(found, axis=1)
        failed = np.flatnonzero(every[self.rules.top] == FAILED)
        return States(
            self.tree,
            len(self.known),
            source,
            target,
            cause,
            tuple(self.cause(int(one)) for one in classes),
            start,
            int(failed[0]) if len(failed) else None,
            (every[: self.rules.events] != OPEN).sum(0),
            () if self.symmetry is None else self.symmetry.equal_events,
        )

    def reduced(self, columns: Columns) -> Columns:
        columns = self.rules.reduce(columns)
        return columns if self.symmetry is None else self.symmetry.sort(columns)

    def pieces(self, columns: Columns) -> list[Columns]:
        width = max(1, CELLS // (self.rules.height * max(1, self.rules.events)))
        return [columns[:, at : at + width] for at in range(0, columns.shape[1], width)]

    def cause(self, code: int) -> Cause:
        factor, step = divmod(code, 2 * self.rules.events)
        return Cause(step // 2, bool(step % 2), self.factors[factor])

    def beginning(self) -> tuple[Columns, Any]:
        """The states right after time 0, when what has a fixed probability has failed or not."""
        rules = self.rules
        columns = np.zeros((rules.height, 1), np.uint8)
        weight = np.zeros(1, np.int64)
        for row, event in enumerate(self.tree.events):
            missing = OPEN if row in rules.due else NEVER
            if event.probability is None:
                columns[row] = OPEN if event.rate_per_hour else missing
            elif event.probability in (0, 1):
                columns[row] = FAILED if event.probability else missing
            else:
                if columns.shape[1] > self.budget:
                    raise self.too_large()
                there = columns.copy()
                there[row], columns[row] = FAILED, missing
                columns = np.concatenate([columns, there], axis=1)
                chances = 1 - event.probability, event.probability
                weight = np.concatenate([self.times(weight, chance) for chance in chances])
        before = columns.copy()
        before[: rules.events][before[: rules.events] == FAILED] = OPEN
        rules.decide(before, columns)
        if rules.forbidden(before, columns).any():
            raise TreeError("a seq or mutex forbids what fails at time 0; correct the probabilities or the restriction")
        columns, _, weight = self.trigger(before, columns, np.arange(columns.shape[1]), weight)
        columns, _, weight = self.settle(columns, weight)
        return columns, weight

    def times(self, weight: Any, chance: Fraction) -> Any:
        """The numbers of the factors numbered `weight`, each times `chance`."""
        result = np.empty_like(weight)
        for one in np.unique(weight):
            product = self.factors[one] * chance
            if product not in self.factor_number:
                self.factor_number[product] = len(self.factors)
                self.factors.append(product)
            result[weight == one] = self.factor_number[product]
        return result

    def number(self, columns: Columns) -> tuple[list[int], list[int]]:
        """The numbers of these states, and which of the columns are new."""
        height, blob = self.rules.height, np.ascontiguousarray(columns.T).tobytes()
        numbers, fresh = [], []
        known = self.known
        for at in range(columns.shape[1]):
            key = blob[at * height : (at + 1) * height]
            number = known.get(key)
            if number is None:
                number = known[key] = len(known)
                fresh.append(at)
            numbers.append(number)
        if len(known) > self.budget:
            raise self.too_large()
        return numbers, fresh

    def too_large(self) -> TooLarge:
        return TooLarge(
            f'dynamic tree "{self.tree.name}" has more than {self.budget} states ({self.rules.events} events); give '
            "independent parts gates of their own, so that they are solved apart, or pass a larger budget"
        )

    def transitions(self, columns: Columns, found: list[Columns]) -> tuple[Any, Any, Any]:
        """Source, target and cause of all transitions out of `columns`; new states are appended to `found`."""
        rules = self.rules
        numbers, _ = self.number(columns)
        active = rules.active(columns)
        rates = np.array([float(bool(e.rate_per_hour)) for e in self.tree.events])
        sleeping = np.array([bool(e.dormancy) for e in self.tree.events])
        can = (columns[: rules.events] == OPEN) & (rates > 0)[:, None] & (active | sleeping[:, None])
        event, column = np.nonzero(can)
        new, origin, weight = self.step(columns[:, column], event, np.zeros(len(column), np.int64))
        new, parent, weight = self.settle(new, weight)
        origin = origin[parent]
        target, fresh = self.number(new)
        if fresh:
            found.append(new[:, fresh])
        step = 2 * event[origin] + active[event[origin], column[origin]]
        return np.array(numbers)[column[origin]], np.array(target, np.int64), weight * 2 * rules.events + step

    def step(self, old: Columns, event: Any, weight: Any) -> tuple[Columns, Any, Any]:
        """Column i after the failure of event[i], without what is forbidden: (columns, i of each, factors)."""
        new = old.copy()
        new[event, np.arange(new.shape[1])] = FAILED
        self.rules.decide(old, new)
        origin = np.flatnonzero(~self.rules.forbidden(old, new))
        return self.trigger(old[:, origin], new[:, origin], origin, weight[origin])

    def trigger(self, old: Columns, new: Columns, origin: Any, weight: Any) -> tuple[Columns, Any, Any]:
        """What the triggers that failed from `old` to `new` make due; a column splits where chance decides."""
        for probability, trigger, dependents in self.rules.dependencies:
            hit = (old[trigger] == OPEN) & (new[trigger] == FAILED)
            waiting = new[dependents] == OPEN
            due = [self.rules.due[row] for row in dependents]
            if probability == 1:
                new[due] |= hit & waiting
                continue
            split = np.flatnonzero(hit & waiting.any(0))
            heads = new[:, split]
            heads[due] |= waiting[:, split]
            tails = np.ones(new.shape[1], bool)
            tails[split] = False
            lucky = weight.copy()
            lucky[~tails] = self.times(weight[split], 1 - probability)
            old = np.concatenate([old, old[:, split]], axis=1)
            new = np.concatenate([new, heads], axis=1)
            origin = np.concatenate([origin, origin[split]])
            weight = np.concatenate([lucky, self.times(weight[split], probability)])
        return new, origin, weight

    def settle(self, columns: Columns, weight: Any) -> tuple[Columns, Any, Any]:
        """The reduced states once all that is due and possible has failed: (columns, column of each, factors)."""
        rules = self.rules
        rows = np.array(rules.dependents, np.intp)
        due = columns[[rules.due[row] for row in rows]].astype(bool) & (columns[rows] == OPEN)
        chosen = np.full(columns.shape[1], -1)
        pieces = []
        for at in range(len(rows)):
            todo = np.flatnonzero(due[at] & (chosen < 0))
            if len(todo):
                new, origin, onward = self.step(columns[:, todo], np.full(len(todo), rows[at]), weight[todo])
                chosen[todo[origin]] = at
                pieces.append((new, todo[origin], onward))
        still = np.flatnonzero(chosen < 0)
        results = [(self.reduced(columns[:, still]), still, weight[still])]
        if pieces:
            results.append(self.settle_joined(pieces))
        result = _joined(results)
        if self.refuse_ties:
            for at in range(len(rows)):
                rival = due[at] & (chosen >= 0) & (chosen != at) & self.conflicts[at][chosen]
                if rival.any():
                    self.check_order(columns, weight, np.flatnonzero(rival), at, result, chosen)
        return result

    def settle_joined(self, pieces: list[tuple[Columns, Any, Any]]) -> tuple[Columns, Any, Any]:
        new, origin, weight = _joined(pieces)
        new, parent, weight = self.settle(new, weight)
        return new, origin[parent], weight

    def check_order(self, columns: Columns, weight: Any, todo: Any, at: int, result: Any, chosen: Any) -> None:
        """Raises TreeError unless dependent number `at` may fail first as well, with the same outcome."""
        rows = self.rules.dependents
        new, origin, onward = self.step(columns[:, todo], np.full(len(todo), rows[at]), weight[todo])
        possible = np.unique(todo[origin])
        outcomes = self.distribution(self.settle_joined([(new, todo[origin], onward)]), possible)
        for one, other in zip(outcomes, self.distribution(result, possible), strict=True):
            if one != other:
                first, second = (self.rules.names[rows[i]] for i in (int(chosen[possible[0]]), at))
                raise TreeError(
                    f'"{first}" and "{second}" can fail simultaneously as dependents, and their order decides what '
                    f"happens next: there is no one result; {REMEDY}",
                    second,
                )

    def distribution(self, result: tuple[Columns, Any, Any], wanted: Any) -> list[dict[bytes, Fraction]]:
        """For each column number in `wanted`: the outcomes with their factors."""
        columns, origin, weight = result
        found: dict[int, dict[bytes, Fraction]] = {int(one): {} for one in wanted}
        for at in np.flatnonzero(np.isin(origin, wanted)):
            outcomes, key = found[int(origin[at])], columns[:, at].tobytes()
            outcomes[key] = outcomes.get(key, Fraction(0)) + self.factors[weight[at]]
        return list(found.values())


def _joined(pieces: list[tuple[Columns, Any, Any]]) -> tuple[Columns, Any, Any]:
    if len(pieces) == 1:
        return pieces[0]
    columns, origin, weight = zip(*pieces, strict=True)
    return np.concatenate(columns, axis=1), np.concatenate(origin), np.concatenate(weight)

"""One step of a dynamic tree, for many states at once: which gates fail, what is claimed, what becomes irrelevant.

A state is a column of small numbers: the status of every event and gate, then for every spare gate the input in use,
for every input of a spare gate whether it was ever made active, and for every dependent whether its failure is due. All
functions here take matrices of such columns, so that a hundred thousand states cost as many NumPy calls as one.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from safety.trees.as_written import TreeError
from safety.trees.dynamic.tree import STATIC, DynamicGate, DynamicTree

OPEN, FAILED, NEVER, GONE = range(4)  # may still fail; has failed; cannot fail any more; does not matter any more
Columns = Any  # array (rows of a state, number of states) of uint8
Mask = Any  # array (number of states,) of bool
MOST_UNITS = 255  # of a spare gate, as a state is made of bytes
REMEDY = "write the order into the tree, or take it as written (--ties 'as written')"


@dataclass(frozen=True)
class SpareInput:
    """Input number `index` of a spare gate: an element that `others` (spare gate, index there) may use as well."""

    index: int
    row: int
    on: int  # the row that says whether it was ever made active
    others: tuple[tuple[Rule, int], ...]


@dataclass
class Rule:
    """A gate by row numbers; `used` and `units` for a spare gate only."""

    gate: DynamicGate
    row: int
    inputs: list[int]
    used: int = -1
    units: tuple[SpareInput, ...] = ()


class Rules:
    """The tree, compiled to rows. `refuse_ties`: raise TreeError where two spare gates race for one unit."""

    def __init__(self, tree: DynamicTree, refuse_ties: bool) -> None:
        self.tree, self.refuse_ties = tree, refuse_ties
        names = [*(event.name for event in tree.events), *(gate.name for gate in tree.inputs_first)]
        self.names, self.row = names, {name: row for row, name in enumerate(names)}
        self.events = len(tree.events)
        self.elements = len(names)
        self.top = self.row[tree.top]
        self.gates = [Rule(gate, self.row[gate.name], self._rows(gate.inputs)) for gate in tree.inputs_first]
        self.spares = [rule for rule in self.gates if rule.gate.kind == "spare"]
        for rule in self.spares:
            if len(rule.inputs) > MOST_UNITS:
                raise TreeError(
                    f'spare gate "{rule.gate.name}" has {len(rule.inputs)} inputs, expected at most {MOST_UNITS}; '
                    "use several gates",
                    rule.gate.name,
                )
        self.dependents = sorted({self.row[d] for dependency in tree.dependencies for d in dependency.dependents})
        units = sorted({row for rule in self.spares for row in rule.inputs})
        self.on = {row: self.elements + len(self.spares) + at for at, row in enumerate(units)}
        self.due = {row: self.elements + len(self.spares) + len(units) + at for at, row in enumerate(self.dependents)}
        self.height = self.elements + len(self.spares) + len(units) + len(self.dependents)
        self.restrictions = [(r.kind, self._rows(r.inputs)) for r in tree.restrictions]
        self.dependencies = [
            (d.probability, self.row[d.trigger], self._rows(d.dependents)) for d in tree.dependencies if d.probability
        ]
        fed = {row for rule in self.gates for row in rule.inputs}
        self.roots = [row for row in range(self.elements) if row not in fed]
        for at, rule in enumerate(self.spares):
            rule.used = self.elements + at
        for rule in self.spares:
            rule.units = tuple(
                SpareInput(
                    index,
                    row,
                    self.on[row],
                    tuple((r, r.inputs.index(row)) for r in self.spares if r is not rule and row in r.inputs),
                )
                for index, row in enumerate(rule.inputs)
            )

    def _rows(self, names: Iterable[str]) -> list[int]:
        return [self.row[name] for name in names]

    def events_below(self, rows: Iterable[int]) -> list[int]:
        """Rows of the events below any of `rows`."""
        found = set().union(*(self.tree.below[self.names[row]] for row in rows))
        return sorted(row for row in self._rows(found) if row < self.events)

    def decide(self, old: Columns, new: Columns) -> None:
        """Decide every open gate of `new`, in place; `old` is the state before the step."""
        lost: dict[int, Mask] = {}
        for rule in self.gates:
            gate, inputs = rule.gate, new[rule.inputs]
            failed, never = inputs == FAILED, inputs == NEVER
            if gate.kind in ("and", "inhibit"):
                fails, cannot = failed.all(0), never.any(0)
            elif gate.kind == "or":
                fails, cannot = failed.any(0), never.all(0)
            elif gate.kind == "vote":
                assert gate.k is not None
                fails, cannot = failed.sum(0) >= gate.k, never.sum(0) > len(rule.inputs) - gate.k
            elif gate.kind == "pand":
                so_far = np.logical_and.accumulate(failed, 0)
                late = (failed[1:] & ~so_far[:-1]).any(0)
                if gate.exclusive:
                    late |= (failed & (old[rule.inputs] != FAILED)).sum(0) > 1
                fails, cannot = failed.all(0) & ~late, late | never.any(0)
            elif gate.kind == "por":
                rivals = failed[1:].any(0)
                earlier = rivals if gate.exclusive else (old[rule.inputs[1:]] == FAILED).any(0)
                lost_race = np.where(failed[0], earlier, rivals)
                fails, cannot = failed[0] & ~lost_race, lost_race | never[0]
            else:
                fails, cannot = self._claim(rule, old, new, lost)
            undecided = new[rule.row] == OPEN
            new[rule.row][undecided & cannot] = NEVER
            new[rule.row][undecided & fails] = FAILED
        self._activate(new)

    def _claim(self, rule: Rule, old: Columns, new: Columns, lost: dict[int, Mask]) -> tuple[Mask, Mask]:
        used, inputs = new[rule.used], new[rule.inputs]
        in_use = np.take_along_axis(inputs, used[None].astype(np.intp), 0)[0]
        lost[rule.row] = (new[rule.row] == OPEN) & (in_use == FAILED)
        looking = lost[rule.row].copy()
        for unit in rule.units[1:]:
            fit = (inputs[unit.index] == OPEN) | (inputs[unit.index] == NEVER)
            takes = looking & (unit.index > used) & fit & ~_claimed(unit, new)
            if self.refuse_ties:
                self._refuse_race(rule, unit, old, new, lost, fit)
            new[rule.used][takes] = unit.index
            looking &= ~takes
        in_use = np.take_along_axis(inputs, new[rule.used][None].astype(np.intp), 0)[0]
        return looking, in_use == NEVER

    def _refuse_race(
        self, rule: Rule, unit: SpareInput, old: Columns, new: Columns, lost: dict[int, Mask], fit: Mask
    ) -> None:
        for other, index in unit.others:
            if other.row in lost:
                both = (
                    lost[rule.row] & lost[other.row] & fit & (old[rule.used] < unit.index) & (old[other.used] < index)
                )
                if (both & ~_claimed(unit, old)).any():
                    raise TreeError(
                        f'spare gates "{other.gate.name}" and "{rule.gate.name}" can lose their units in one step and '
                        f'both may claim "{self.names[unit.row]}": which is first is open; {REMEDY}',
                        rule.gate.name,
                    )

    def _activate(self, new: Columns) -> Columns:
        """Mark what spare gates have made active, in place; which elements are active."""
        active = np.zeros((self.elements, new.shape[1]), bool)
        active[self.roots] = True
        for row, on in self.on.items():
            active[row] = new[on]
        for rule in reversed(self.gates):
            if rule.gate.kind != "spare":
                active[rule.inputs] |= active[rule.row]
                continue
            holds = active[rule.row] & ((new[rule.row] == OPEN) | (new[rule.row] == NEVER))
            for unit in rule.units:
                using = holds & (new[rule.used] == unit.index)
                new[unit.on] |= using
                active[unit.row] |= using
        return active

    def active(self, columns: Columns) -> Columns:
        """Which events are active."""
        return self._activate(columns.copy())[: self.events]

    def forbidden(self, old: Columns, new: Columns) -> Mask:
        """Which steps a seq or mutex makes impossible."""
        bad = np.zeros(new.shape[1], bool)
        for kind, rows in self.restrictions:
            now = new[rows]
            fresh = (now == FAILED) & (old[rows] != FAILED)
            if kind == "seq":
                waiting = np.logical_or.accumulate((now == OPEN) | (now == NEVER), 0)
                bad |= (fresh[1:] & waiting[:-1]).any(0)
            else:
                bad |= fresh.any(0) & ((now == FAILED).sum(0) > 1)
        return bad

    def reduce(self, columns: Columns) -> Columns:
        """The same states with all that cannot matter any more set to one value, in place."""
        relevant = self._relevant(columns)
        status = columns[: self.elements]
        status[~relevant] = GONE
        for rule in self.spares:
            holds = (columns[rule.row] == OPEN) | (columns[rule.row] == NEVER)
            columns[rule.used][~holds] = 0
        for row, on in self.on.items():
            columns[on] &= self._warms(columns, relevant, row)
        for row, due in self.due.items():
            columns[due][columns[row] != OPEN] = 0
        return columns

    def _warms(self, columns: Columns, relevant: Any, row: int) -> Mask:
        """Whether some event below, still to come, fails at another rate once active."""
        cool = [below for below in self.events_below([row]) if self.tree.events[below].dormancy != 1]
        return (relevant[cool] & (columns[cool] == OPEN)).any(0)

    def _relevant(self, columns: Columns) -> Any:
        """Which elements can still change the fate of the top: the least set closed under the rules below."""
        opened = columns[: self.elements] == OPEN
        lasting = opened | (columns[: self.elements] == NEVER)
        matters = np.zeros((self.elements, columns.shape[1]), bool)
        size = -1
        matters[self.top] = opened[self.top]
        while (now := int(matters.sum())) != size:
            size = now
            for rule in reversed(self.gates):
                matters[rule.inputs] |= matters[rule.row] & opened[rule.row]
            for _, trigger, dependents in self.dependencies:
                waiting = matters[dependents] & opened[dependents] & (columns[[self.due[d] for d in dependents]] == 0)
                matters[trigger] |= opened[trigger] & waiting.any(0)
            for kind, rows in self.restrictions:
                binding = (
                    opened[rows].any(0) if kind == "mutex" else opened[rows[1:]].any(0) & lasting[rows[:-1]].any(0)
                )
                below = self.events_below(rows)
                matters[rows] |= binding & (matters[below] & opened[below]).any(0)
            for rule in self.spares:
                for unit in rule.units:
                    for other, _ in unit.others:
                        matters[rule.row] |= lasting[rule.row] & matters[other.row] & opened[other.row]
                    warms = self._warms(columns, matters, unit.row) & (columns[unit.on] == 0)
                    matters[rule.row] |= opened[rule.row] & (columns[rule.used] <= unit.index) & warms
        matters[self.top] = True
        return matters


def _claimed(unit: SpareInput, columns: Columns) -> Mask:
    """Whether another spare gate has `unit` in use."""
    claimed = np.zeros(columns.shape[1], bool)
    for other, index in unit.others:
        holds = (columns[other.row] == OPEN) | (columns[other.row] == NEVER)
        claimed |= holds & (columns[other.used] == index)
    return claimed


def conflicts(rules: Rules) -> Any:
    """For every pair of dependents (rows and columns as `rules.dependents`): can the order of their failures matter?

    Only where both reach one element that looks at order: a pand, por, spare gate, a unit shared by spare gates, a
    restriction. Reaching goes upwards through gates and onwards through dependencies.
    """
    tree = rules.tree
    reached: list[set[str]] = []
    for row in rules.dependents:
        found, agenda = set(), [rules.names[row]]
        while agenda:
            name = agenda.pop()
            if name in found:
                continue
            found.add(name)
            agenda += [gate.name for gate in tree.gates if name in gate.inputs]
            agenda += [
                d for dependency in tree.dependencies if dependency.trigger == name for d in dependency.dependents
            ]
        marks = {gate.name for gate in tree.gates if gate.name in found and gate.kind not in STATIC}
        marks |= {f"unit {u}" for g in tree.gates if g.kind == "spare" and g.name in found for u in g.inputs}
        marks |= {f"restriction {r.name}" for r in tree.restrictions if found.intersection(r.inputs)}
        reached.append(marks)
    return np.array([[bool(one & other) for other in reached] for one in reached], bool).reshape(2 * [len(reached)])

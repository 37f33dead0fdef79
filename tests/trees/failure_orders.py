"""The plain reading of a dynamic tree: every order of failures tried one by one, no two states ever merged.

Nothing here is shared with the state space of the project: a gate's fate is read off the instants at which its inputs
failed. Slow (the factorial of the number of events) and exact.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise

from safety.trees.as_written import TreeError
from safety.trees.dynamic.tree import DynamicGate, DynamicTree


@dataclass
class Past:
    """What has happened so far: the instant of every failure, the unit that each spare gate has in use."""

    instant: int = 0
    failed: dict[str, int] = field(default_factory=dict)
    using: dict[str, str] = field(default_factory=dict)
    active: set[str] = field(default_factory=set)
    due: set[str] = field(default_factory=set)

    def copy(self) -> Past:
        return Past(self.instant, dict(self.failed), dict(self.using), set(self.active), set(self.due))


def transform(tree: DynamicTree, s: Fraction, order: Sequence[str] | None = None) -> Fraction:
    """Mean of exp(-s x time until the top fails), 0 where it never does: exact. s = 0 gives P(ever).

    `order`: in which order simultaneous dependents fail; as the events are written if not given.
    """
    order = order or [event.name for event in tree.events]
    return sum((chance * _transform(tree, past, s, order) for past, chance in _begin(tree, order)), Fraction(0))


def _transform(tree: DynamicTree, past: Past, s: Fraction, order: Sequence[str]) -> Fraction:
    if tree.top in past.failed:
        return Fraction(1)
    leaving, total = Fraction(0), Fraction(0)
    for event in tree.events:
        if event.name in past.failed or not event.rate_per_hour:
            continue
        rate = event.rate_per_hour * (1 if event.name in past.active else event.dormancy)
        if rate == 0 or (after := _after(tree, past, [event.name])) is None:
            continue
        leaving += rate
        for later, chance in _settled(tree, after, order):
            total += rate * chance * _transform(tree, later, s, order)
    return total / (s + leaving) if leaving else Fraction(0)


def _begin(tree: DynamicTree, order: Sequence[str]) -> Iterator[tuple[Past, Fraction]]:
    start = Past(using={gate.name: gate.inputs[0] for gate in tree.gates if gate.kind == "spare"})
    outcomes: list[tuple[list[str], Fraction]] = [([], Fraction(1))]
    for event in tree.events:
        if event.probability is not None:
            p = event.probability
            outcomes = [(o, c * (1 - p)) for o, c in outcomes] + [([*o, event.name], c * p) for o, c in outcomes]
    for failing, chance in outcomes:
        if chance:
            after = _after(tree, start, failing)
            if after is None:
                raise TreeError("a seq or mutex forbids what fails at time 0")
            yield from ((past, chance * share) for past, share in _settled(tree, after, order))


def _after(tree: DynamicTree, past: Past, failing: list[str]) -> Past | None:
    """What has happened once `failing` have failed in the next instant; None if a seq or mutex forbids it."""
    new = past.copy()
    new.instant += 1
    new.failed |= dict.fromkeys(failing, new.instant)
    for gate in tree.inputs_first:
        if gate.name not in new.failed and _fails(gate, new):
            new.failed[gate.name] = new.instant
    for restriction in tree.restrictions:
        for at, name in enumerate(restriction.inputs):
            if new.failed.get(name) == new.instant:
                earlier, others = restriction.inputs[:at], {*restriction.inputs} - {name}
                if restriction.kind == "seq" and any(one not in new.failed for one in earlier):
                    return None
                if restriction.kind == "mutex" and any(one in new.failed for one in others):
                    return None
    fed = {name for gate in tree.gates for name in gate.inputs}
    new.active |= {name for name in tree.nodes if name not in fed}
    for gate in reversed(tree.inputs_first):
        if gate.name in new.active:
            if gate.kind != "spare":
                new.active |= {*gate.inputs}
            elif gate.name not in new.failed:
                new.active.add(new.using[gate.name])
    return new


def _fails(gate: DynamicGate, past: Past) -> bool:
    instants = [past.failed.get(name) for name in gate.inputs]
    known = [instant for instant in instants if instant is not None]
    match gate.kind:
        case "and" | "inhibit":
            return len(known) == len(instants)
        case "or":
            return bool(known)
        case "vote":
            return len(known) >= (gate.k or 0)
        case "pand":
            ordered = all(a < b if gate.exclusive else a <= b for a, b in pairwise(known))
            return len(known) == len(instants) and ordered
        case "por":
            first = instants[0]
            rivals = [instant for instant in instants[1:] if instant is not None]
            return first is not None and all(first < r if gate.exclusive else first <= r for r in rivals)
    if past.using[gate.name] not in past.failed:
        return False
    taken = {unit for name, unit in past.using.items() if name != gate.name and name not in past.failed}
    for unit in gate.inputs[gate.inputs.index(past.using[gate.name]) + 1 :]:
        if unit not in past.failed and unit not in taken:
            past.using[gate.name] = unit
            return False
    return True


def _settled(tree: DynamicTree, past: Past, order: Sequence[str]) -> Iterator[tuple[Past, Fraction]]:
    """What follows at once: chances fall, and dependents fail one after the other."""
    outcomes = [(past, Fraction(1))]
    for dependency in tree.dependencies:
        if past.failed.get(dependency.trigger) == past.instant:
            spread = []
            for one, chance in outcomes:
                hit = one.copy()
                hit.due |= {*dependency.dependents}
                spread += [(hit, chance * dependency.probability), (one, chance * (1 - dependency.probability))]
            outcomes = spread
    for one, chance in outcomes:
        if not chance:
            continue
        for name in order:
            if name in one.due and name not in one.failed and (after := _after(tree, one, [name])) is not None:
                yield from ((later, chance * share) for later, share in _settled(tree, after, order))
                break
        else:
            yield one, chance

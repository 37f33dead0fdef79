"""Factoring minimal cut sets: from a flat list of sets to a formula of and, or and k-out-of-n that has just these.

Parts that always act as one (modules) are contracted from the inside out until nothing changes:

    events that occur in the same company, whatever the rest      -> or
    events that occur in the same sets                            -> and
    events of which, in the same company, any k of n occur        -> k out of n

What is left falls into components that share no part (or), has parts in common to all its sets (and), or is divided by
the part that occurs most often, f = x g + h, where this takes fewer gates than the list of its sets (algebraic
factoring). Each step keeps the family of minimal cut sets as it is. The result depends on the sets alone and on the
numbers of the events, not on the order in which they are given.

Sources: Z. W. Birnbaum and J. D. Esary, "Modules of coherent binary systems", SIAM Journal 13 (1965); R. K. Brayton,
"Factoring logic functions", IBM Journal of Research and Development 31 (1987).
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from itertools import combinations, islice, product
from math import comb
from typing import NamedTuple

WORTH = 3  # sets with a part from which on dividing by it can save a gate
READABLE = 2000  # sets that hang together without modules; more are listed as they are, as nobody reads them


class Factor(NamedTuple):
    """A formula over events, which are numbers from 0 on: kind "event", "and", "or" or "vote" (at least `k`)."""

    kind: str
    parts: tuple[Factor, ...] = ()
    k: int | None = None
    event: int = -1

    @property
    def events(self) -> Iterator[int]:
        """The events in it, from left to right; one may come more than once."""
        if self.kind == "event":
            yield self.event
        for part in self.parts:
            yield from part.events

    @property
    def gates(self) -> int:
        """How many gates it takes, where those that come again are drawn again."""
        return (self.kind != "event") + sum(part.gates for part in self.parts)

    @property
    def sets(self) -> Iterator[frozenset[int]]:
        """Its minimal cut sets, if it was made from these: one for each choice of what its gates leave open."""
        if self.kind == "event":
            yield frozenset({self.event})
        elif self.kind == "or":
            for part in self.parts:
                yield from part.sets
        else:
            for chosen in combinations(self.parts, self.k or len(self.parts)):
                for pieces in product(*(part.sets for part in chosen)):
                    yield frozenset[int]().union(*pieces)


def factored(sets: Iterable[frozenset[int]]) -> Factor:
    """The formula whose minimal cut sets are `sets`: at least one, none empty, none within another.

    It takes no more gates than the plain list of the sets (see `listed`).
    """
    family = {sum(1 << event for event in one) for one in sets}
    quotient = _Quotient({event: Factor("event", event=event) for event in _members_of_any(family)}, family)
    formula = _short(quotient.formula())
    return formula if formula.kind == "or" else min(formula, listed(formula.sets), key=lambda each: each.gates)


def listed(sets: Iterable[frozenset[int]]) -> Factor:
    """The plain list of the sets: an or of ands."""
    return _join("or", [_join("and", [Factor("event", event=event) for event in one]) for one in sets])


def _short(formula: Factor) -> Factor:
    """The formula with the plain list of its sets wherever that takes fewer gates."""
    parts = [_short(part) for part in formula.parts]
    if formula.kind != "or":
        return formula._replace(parts=_sorted(parts))
    return _join("or", [_fewer(part) for part in parts])


def _fewer(part: Factor) -> Factor:
    """Of an or: the part, or the list of its sets, of which each but a single event takes one gate of the or."""
    if part.kind == "event" or part.gates <= sum(1 for _ in islice(part.sets, part.gates)):
        return part
    return listed(part.sets)


class _Quotient:
    """A family over `parts`, formulas that stand for the events inside them: part number i is bit i of a set."""

    def __init__(self, parts: dict[int, Factor], family: set[int]) -> None:
        self.parts, self.family = parts, family

    def formula(self) -> Factor:
        """The family as a formula."""
        alternatives: list[Factor] = []
        left = [self]
        while left:
            quotient = left.pop()
            while quotient._contract_alike(True) or quotient._contract_alike(False) or quotient._contract_votes():
                pass
            for component in _components(quotient.family):
                found, rest = quotient._divided(component)
                alternatives += found
                if rest:
                    left.append(quotient._within(rest))
        return _join("or", alternatives)

    def _divided(self, family: set[int]) -> tuple[list[Factor], set[int]]:
        """Formulas for some sets of a family that hangs together and has no modules left, and its other sets.

        The parts common to all sets are taken out; else the one that most sets have, if that saves a gate; else each
        set stays as it is.
        """
        common = -1
        for one in family:
            common &= one
        if not common and len(family) <= READABLE:
            counts = Counter(i for one in family for i in _members(one))
            common = 1 << min(counts, key=lambda i: (-counts[i], min(self.parts[i].events)))
        sharing = {one for one in family if common and one & common == common}
        if len(sharing) >= WORTH or sharing == family:
            inner = [self._within({one ^ common for one in sharing}).formula()] if sharing != {common} else []
            formula = _join("and", [*(self.parts[i] for i in _members(common)), *inner])
            if sharing == family or formula.gates < len(sharing) + sum(self.parts[i].gates for i in _members(common)):
                return [formula], family - sharing
        return [self._and(one) for one in family], set()

    def _within(self, family: set[int]) -> _Quotient:
        return _Quotient({i: self.parts[i] for i in _members_of_any(family)}, family)

    def _and(self, one: int) -> Factor:
        return _join("and", [self.parts[i] for i in _members(one)])

    def _contract_alike(self, series: bool) -> bool:
        """Contract parts that occur in the same company into an or, or in the same sets into an and."""
        seen: dict[int, list[int]] = defaultdict(list)
        for one in sorted(self.family):
            for i in _members(one):
                seen[i].append(one ^ (1 << i) if series else one)
        alike: dict[tuple[int, ...], list[int]] = defaultdict(list)
        for i, company in seen.items():
            alike[tuple(sorted(company))].append(i)
        found = False
        for group in alike.values():
            if len(group) > 1:
                found = True
                self._replace(group, _join("or" if series else "and", [self.parts[i] for i in group]))
        return found

    def _contract_votes(self) -> bool:
        """Contract the first group of parts that can be exchanged for one another and of which any k of n occur."""
        for group in self._exchangeable():
            mask = sum(1 << i for i in group)
            chosen: dict[int, set[int]] = defaultdict(set)
            for one in self.family:
                if one & mask:
                    chosen[one & ~mask].add(one & mask)
            sizes = {part.bit_count() for parts in chosen.values() for part in parts}
            k = min(sizes)
            if sizes == {k} and 1 < k < len(group) and {len(p) for p in chosen.values()} == {comb(len(group), k)}:
                self._replace(group, Factor("vote", _sorted(self.parts[i] for i in group), k))
                return True
        return False

    def _exchangeable(self) -> list[list[int]]:
        """Groups of three and more parts that can change places with one another, family unchanged."""
        within: dict[int, list[int]] = defaultdict(list)
        for one in self.family:
            for i in _members(one):
                within[i].append(one)
        profiles: dict[tuple[int, ...], list[list[int]]] = defaultdict(list)
        for i in sorted(within):
            classes = profiles[tuple(sorted(one.bit_count() for one in within[i]))]
            for group in classes:
                both = (1 << i) | (1 << group[0])
                if all(one & both == both or one ^ both in self.family for one in within[i]):
                    group.append(i)
                    break
            else:
                classes.append([i])
        return [group for classes in profiles.values() for group in classes if len(group) > 2]

    def _replace(self, group: list[int], formula: Factor) -> None:
        """Put `formula` in the place of the parts of `group`."""
        mask, bit = sum(1 << i for i in group), 1 << min(group)
        self.family = {one & ~mask | bit if one & mask else one for one in self.family}
        for i in group:
            del self.parts[i]
        self.parts[min(group)] = formula


def _join(kind: str, parts: list[Factor]) -> Factor:
    """An and or an or of `parts`, those of the same kind merged into it; of one part, that part."""
    if len(parts) == 1:
        return parts[0]
    return Factor(kind, _sorted(inner for part in parts for inner in (part.parts if part.kind == kind else (part,))))


def _sorted(parts: Iterable[Factor]) -> tuple[Factor, ...]:
    """Events first, then gates, by their smallest event."""
    return tuple(sorted(parts, key=lambda part: (part.kind != "event", *sorted(part.events))))


def _members(one: int) -> Iterator[int]:
    while one:
        low = one & -one
        yield low.bit_length() - 1
        one ^= low


def _members_of_any(family: Iterable[int]) -> list[int]:
    union = 0
    for one in family:
        union |= one
    return list(_members(union))


def _components(family: set[int]) -> list[set[int]]:
    """The family divided into parts that have no member in common."""
    masks: list[int] = []
    for one in family:
        apart = []
        for mask in masks:
            if mask & one:
                one |= mask
            else:
                apart.append(mask)
        masks = [*apart, one]
    return [{one for one in family if one & mask} for mask in sorted(masks)] if len(masks) > 1 else [family]

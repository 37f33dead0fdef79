"""Gates with a name for a formula of events: what an engineer would write beside them.

The sub-system of an event is what its name says before the colon ("counter 2: stage 0 at 1") or before the last dot of
a dotted first word ("a.counter stuck-at-0"). A gate is called by what its inputs are called, within the sub-system that
all its events belong to; an or of all events of a sub-system is "... fails". Long lists are divided by sub-system.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from functools import cache
from itertools import takewhile

from safety.trees.drawn.factoring import Factor
from safety.trees.tree import Gate

Path = tuple[str, ...]
MANY = 8  # inputs of a gate; from here on they are divided by sub-system, and lists of sets by order
FAILS = " fails"
LONGEST = 90  # letters of a name made of those of the inputs
DOTTED = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)+")


def drawn(
    top: str, formula: Factor, names: Sequence[str], description: str = "", titles: Mapping[str, str] | None = None
) -> tuple[Gate, ...]:
    """The gates for `formula` over the events called `names`: first the one called `top`, then level by level.

    `titles` are better names of sub-systems than those in the events' names ("channel a" for "a").
    """
    return tuple(_Drawing(top, names, formula, titles or {}).gates(description))


def subsystem(event: str) -> Path:
    """The sub-system that an event belongs to, from the whole to the part; () if its name does not say."""
    before, colon, _ = event.partition(": ")
    dotted = DOTTED.match(before)
    if not dotted:
        return (before,) if colon else ()
    words = dotted.group().split(".")
    return tuple([*words[:-1], words[-1] + before[dotted.end() :]] if colon else words[:-1])


class _Drawing:
    """The gates made so far, and what is known of the events."""

    def __init__(self, top: str, names: Sequence[str], formula: Factor, titles: Mapping[str, str]) -> None:
        self.top, self.names, self.formula, self.titles = top, names, formula, titles
        self.subsystems = [subsystem(name) for name in names]
        self.all_of: dict[Path, set[int]] = defaultdict(set)  # the events of each sub-system that the formula has
        for event in formula.events:
            for depth in range(1, len(self.subsystems[event]) + 1):
                self.all_of[self.subsystems[event][:depth]].add(event)
        self.made: dict[Factor, Gate] = {}
        self.combined: set[str] = set()  # names of gates that are made of those of their inputs
        self.taken = {top, *names}
        self.path = cache(self._path)

    def gates(self, description: str) -> Iterator[Gate]:
        formula = self.formula
        parts = self.divided(formula) if formula.parts else (formula,)
        kind = formula.kind if formula.parts else "or"
        top = Gate(self.top, kind, tuple(self.name(part) for part in parts), formula.k, description)
        return _outer_first(top, {gate.name: gate for gate in self.made.values()})

    def name(self, formula: Factor) -> str:
        """What a formula is called in the tree: an event's own name, or that of its gate, made if it is not yet."""
        if formula.kind == "event":
            return self.names[formula.event]
        if formula not in self.made:
            parts = self.divided(formula)
            inputs = tuple(self.name(part) for part in parts)
            name = self.free(self.wanted(formula, parts, inputs))
            self.made[formula] = Gate(name, formula.kind, inputs, formula.k)
        return self.made[formula].name

    def divided(self, formula: Factor) -> tuple[Factor, ...]:
        """The inputs of a gate; those of an or, if they are many, by sub-system and by order."""
        parts, depth = formula.parts, len(self.path(formula))
        if formula.kind == "or" and len(parts) >= MANY:
            parts = _together(parts, lambda part: self.path(part)[depth : depth + 1], 2)
        if formula.kind == "or" and len(parts) >= MANY:
            parts = _together(parts, _order, MANY)
        return parts

    def wanted(self, formula: Factor, parts: Sequence[Factor], inputs: Sequence[str]) -> str:
        """What a gate should be called."""
        path, count = self.path(formula), len(inputs)
        title = self.title(path)
        if formula.kind == "or" and path and self.all_of[path] == set(formula.events):
            return f"{title}{FAILS}"
        where = f"{title}: " if path else ""
        plain = ".".join(path)
        pairs = zip(parts, inputs, strict=True)
        inner = [_within(plain if part.kind == "event" else title, name) for part, name in pairs]
        spelled = [self.spelled(formula, inner)]
        if formula.kind == "or":
            spelled.append(self.spelled(formula, self.shortened(parts, inner, len(path))))
        elif formula.kind == "and" and all(len(self.path(part)) > len(path) for part in parts):
            spelled.append(f"{', '.join(_within(title, self.title(self.path(part))) for part in parts)} together")
        for words in spelled:
            if len(where + words) <= LONGEST:
                self.combined.add(where + words)
                return where + words
        orders = {_order(part) for part in parts}
        if formula.kind == "or" and len(orders) == 1 and orders != {None}:
            return f"{where}{orders.pop()} failures together"
        if formula.kind == "or":
            return f"{where}any of {count} causes"
        return f"{where}{f'any {formula.k} of' if formula.kind == 'vote' else 'all'} {count} together"

    def spelled(self, formula: Factor, inputs: Sequence[str]) -> str:
        """A name made of those of the inputs."""
        heads, _, tails = zip(*(name.rpartition(": ") for name in inputs), strict=True)
        if formula.kind == "and" and len(set(tails)) == 1 and all(heads):
            return f"{' and '.join(heads)}: {tails[0]}"
        if formula.kind != "vote":
            return f" {formula.kind} ".join(f"({name})" if name in self.combined else name for name in inputs)
        if not all(name.endswith(FAILS) for name in inputs):
            return f"any {formula.k} of {', '.join(inputs)}"
        nouns, _, tails = zip(*(name.removesuffix(FAILS).rpartition(" ") for name in inputs), strict=True)
        noun = f"the {nouns[0]}s " if len(set(nouns)) == 1 and nouns[0] else ""
        return f"{formula.k} of {noun}{', '.join(tails if noun else (n.removesuffix(FAILS) for n in inputs))} fail"

    def shortened(self, parts: Sequence[Factor], inputs: Sequence[str], depth: int) -> list[str]:
        """The names of inputs; one name for all events of a sub-system where there are several."""
        groups: dict[Path, list[str]] = defaultdict(list)
        for part, name in zip(parts, inputs, strict=True):
            groups[self.path(part)[: depth + 1] if part.kind == "event" else ()].append(name)
        short: list[str] = []
        for path, names in groups.items():
            short += names if len(names) == 1 or len(path) <= depth else [f"a fault of {self.title(path)}"]
        return short

    def title(self, path: Path) -> str:
        """What a sub-system is called."""
        return ".".join([self.titles.get(path[0], path[0]), *path[1:]]) if path else ""

    def free(self, wanted: str) -> str:
        number, name = 1, wanted
        while name in self.taken:
            number += 1
            name = f"{wanted} ({number})"
        self.taken.add(name)
        if wanted in self.combined:
            self.combined.add(name)
        return name

    def _path(self, formula: Factor) -> Path:
        """The sub-system that all events of a formula belong to."""
        levels = zip(*{self.subsystems[event] for event in formula.events}, strict=False)
        return tuple(level[0] for level in takewhile(lambda level: len(set(level)) == 1, levels))


def _together(parts: Sequence[Factor], key: Callable[[Factor], Hashable], fewest: int) -> tuple[Factor, ...]:
    """`parts` with those that have the same key, if they are so many and not all, put under an or of their own."""
    groups: dict[Hashable, list[Factor]] = {}
    for part in parts:
        groups.setdefault(key(part) or part, []).append(part)
    if len(groups) == 1:
        return tuple(parts)
    large = {of: Factor("or", tuple(group)) for of, group in groups.items() if len(group) >= fewest}
    return tuple(part for of, group in groups.items() for part in ([large[of]] if of in large else group))


def _within(subsystem: str, name: str) -> str:
    """A name as it is read inside a sub-system."""
    inner = name.removeprefix(subsystem)
    return inner[1:].lstrip() if subsystem and inner != name and inner[:1] in (":", ".") else name


def _order(part: Factor) -> int | None:
    """The number of events of a plain cut set."""
    plain = part.kind == "and" and all(inner.kind == "event" for inner in part.parts)
    return len(part.parts) if plain else None


def _outer_first(top: Gate, gates: Mapping[str, Gate]) -> Iterator[Gate]:
    """`top` and all below it, level by level."""
    level, met = [top], {top.name}
    while level:
        yield from level
        below = dict.fromkeys(name for gate in level for name in gate.inputs if name in gates and name not in met)
        met.update(below)
        level = [gates[name] for name in below]

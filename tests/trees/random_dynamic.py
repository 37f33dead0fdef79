"""Random small dynamic trees, all kinds of gates, dependencies and restrictions mixed."""

from __future__ import annotations

import random
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction

from safety.trees.as_written import TreeError
from safety.trees.dynamic.tree import Dependency, DynamicGate, DynamicTree, Restriction, TimedEvent

RATES = ("0.3", "0.5", "0.7", "1", "1.3", "2")
DORMANCIES = ("0", "0.5", "1")


def random_dynamic(seed: int, events: int = 5, *, chances: bool = True, ordered: bool = True) -> DynamicTree:
    """The tree of `seed`. Without `chances` no event has a fixed probability; without `ordered` no seq and no mutex."""
    draw = random.Random(seed)
    while True:
        try:
            return _draw(draw, events, chances, ordered)
        except TreeError:
            continue  # two spare gates with one first input, say: draw again


def _draw(draw: random.Random, count: int, chances: bool, ordered: bool) -> DynamicTree:
    events = []
    for at in range(count):
        if chances and draw.random() < 0.1:
            events.append(TimedEvent(f"e{at}", probability=Fraction(draw.choice(("0", "0.25", "0.5", "1")))))
        else:
            rate = "0" if draw.random() < 0.05 else draw.choice(RATES)
            events.append(TimedEvent(f"e{at}", Fraction(rate), dormancy=Fraction(draw.choice(DORMANCIES))))
    free = [event.name for event in events]
    every = list(free)
    gates: list[DynamicGate] = []
    while len(free) > 1 or not gates:
        size = min(len(free), draw.choice((2, 2, 2, 3)))
        inputs = draw.sample(free, size)
        if draw.random() < 0.3:
            inputs.append(draw.choice(every))  # shared
        kind = draw.choice(("and", "or", "vote", "pand", "por", "spare", "spare"))
        pool = [unit for gate in gates if gate.kind == "spare" for unit in gate.inputs[1:]]
        if kind == "spare" and pool and draw.random() < 0.6:
            inputs.append(draw.choice(pool))
        inputs = list(dict.fromkeys(inputs))
        k = draw.randint(1, len(inputs)) if kind == "vote" else None
        exclusive = kind in ("pand", "por") and draw.random() < 0.3
        gates.append(DynamicGate(f"g{len(gates)}", kind, tuple(inputs), k, exclusive))
        free = [name for name in free if name not in inputs] + [gates[-1].name]
        every.append(gates[-1].name)
    dependencies = []
    for at in range(draw.choice((0, 0, 1, 2))):
        trigger, *dependents = draw.sample([e.name for e in events], draw.choice((2, 3)))
        if draw.random() < 0.3:
            trigger = draw.choice([g.name for g in gates])
        chance = draw.choice(("1", "1", "0.25"))
        dependencies.append(Dependency(f"d{at}", trigger, tuple(dependents), Fraction(chance)))
    restrictions = []
    if ordered and draw.random() < 0.3:
        names = draw.sample([name for name in every if name != gates[-1].name], 2)
        restrictions.append(Restriction("r0", draw.choice(("seq", "mutex")), tuple(names)))
    return DynamicTree(
        gates[-1].name, gates[-1].name, tuple(gates), tuple(events), tuple(dependencies), tuple(restrictions)
    )


def renamed(tree: DynamicTree, prefix: str) -> DynamicTree:
    """The same tree with `prefix` before every name."""

    def all_of(names: Iterable[str]) -> tuple[str, ...]:
        return tuple(prefix + name for name in names)

    return DynamicTree(
        prefix + tree.name,
        prefix + tree.top,
        tuple(replace(gate, name=prefix + gate.name, inputs=all_of(gate.inputs)) for gate in tree.gates),
        tuple(replace(event, name=prefix + event.name) for event in tree.events),
        tuple(
            Dependency(prefix + d.name, prefix + d.trigger, all_of(d.dependents), d.probability)
            for d in tree.dependencies
        ),
        tuple(replace(r, name=prefix + r.name, inputs=all_of(r.inputs)) for r in tree.restrictions),
    )

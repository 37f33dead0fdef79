"""Orders of the variables of a module, to be tried in turn: no single rule is good for every fault tree.

Source of the last: F. Aloul, I. Markov, K. Sakallah, "FORCE: A Fast and Easy-to-Implement Variable-Ordering
Heuristic", GLSVLSI 2003.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator

from safety.trees.modules import Module
from safety.trees.tree import Gate

Order = tuple[str, ...]


def candidate_orders(module: Module) -> Iterator[Order]:
    """Orders of `module.variables`, without repetition, the cheap and usually good ones first."""
    shares = Counter(name for gate in module.gates for name in gate.inputs)
    size = {name: 1 for name in module.variables}
    for gate in module.gates:
        size[gate.name] = 1 + sum(size.get(name, 0) for name in gate.inputs)
    rules: list[Callable[[str], tuple[int, ...]]] = [
        lambda _: (0,),
        lambda name: (size.get(name, 0),),
        lambda name: (-shares[name], size.get(name, 0)),
        lambda name: (-size.get(name, 0),),
    ]
    seen: set[Order] = set()
    for rule in rules:
        order = _depth_first(module, rule)
        for candidate in (order, force(module, order)):
            if candidate not in seen:
                seen.add(candidate)
                yield candidate


def _depth_first(module: Module, rule: Callable[[str], tuple[int, ...]]) -> Order:
    """The variables as a depth-first walk meets them that takes the inputs of each gate by increasing `rule`."""
    gates = {gate.name: gate for gate in module.gates}
    met: dict[str, None] = {}
    agenda = [module.top]
    while agenda:
        name = agenda.pop()
        if name not in met:
            met[name] = None
            if name in gates:
                agenda.extend(sorted(gates[name].inputs, key=rule)[::-1])
    variables = set(module.variables)
    return tuple(name for name in met if name in variables)


def force(module: Module, order: Order, rounds: int = 20) -> Order:
    """`order` improved by moving each variable, again and again, to the mean position of the gates over it."""
    edges = [gate for gate in module.gates if len(gate.inputs) > 1]
    best, best_span = order, _span(edges, order)
    for _ in range(rounds):
        position = {name: float(i) for i, name in enumerate(order)}
        centre: dict[str, float] = {}
        for gate in module.gates:
            below = [centre.get(name, position.get(name)) for name in gate.inputs]
            known = [place for place in below if place is not None]
            centre[gate.name] = sum(known) / max(1, len(known))
        pulls: dict[str, list[float]] = {name: [] for name in order}
        for gate in edges:
            for name in gate.inputs:
                if name in pulls:
                    pulls[name].append(centre[gate.name])
        order = tuple(
            sorted(
                order,
                key=lambda name: (
                    sum(pulls[name]) / len(pulls[name]) if pulls[name] else position[name],
                    position[name],
                ),
            )
        )
        span = _span(edges, order)
        if span >= best_span:
            break
        best, best_span = order, span
    return best


def _span(edges: list[Gate], order: Order) -> int:
    """Sum over the gates of the distance between the first and the last variable directly below."""
    position = {name: i for i, name in enumerate(order)}
    places = [[position[name] for name in gate.inputs if name in position] for gate in edges]
    return sum(max(below) - min(below) for below in places if below)

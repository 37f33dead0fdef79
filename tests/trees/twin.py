"""The obvious twin of the solver: every figure of a fault tree by trying all combinations of its basic events."""

import itertools
import math
from fractions import Fraction

from hypothesis import strategies as st

from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent, solve

EVENTS, HOUSES = "abcdef", "uv"


def holds(tree, name, failed):
    """Whether the gate or event `name` occurs when the basic events in `failed` do, by the words of its definition."""
    for house in tree.house_events:
        if house.name == name:
            return house.state
    gate = next((gate for gate in tree.gates if gate.name == name), None)
    if gate is None:
        return name in failed
    inputs = [holds(tree, below, failed) for below in gate.inputs]
    return {
        "and": all(inputs),
        "or": any(inputs),
        "vote": inputs.count(True) >= (gate.k or 0),
        "not": not inputs[0],
        "xor": inputs.count(True) in (1, 3, 5, 7, 9),
    }[gate.kind]


class Table:
    """The truth table of a tree, and what the definitions say of it."""

    def __init__(self, tree):
        self.q = {event.name: event.probability for event in tree.events}
        sets = [frozenset(s) for n in range(len(self.q) + 1) for s in itertools.combinations(self.q, n)]
        self.truths = [s for s in sets if holds(tree, tree.top, s)]

    def probability(self, **fixed):
        """Of the top event, where the probabilities in `fixed` replace those of the tree."""
        q = self.q | fixed
        return sum((math.prod(q[e] if e in s else 1 - q[e] for e in q) for s in self.truths), Fraction(0))

    def cut_sets(self):
        return {s for s in self.truths if not any(other < s for other in self.truths)}


def disagreements(tree):
    """What the solver says of `tree` that its truth table does not; an empty list is agreement."""
    table, solution, found = Table(tree), solve(tree), []
    p = table.probability()
    if solution.exact != p:
        found.append(f"P: {solution.exact}, table {p}")
    low, high = solution.bounds
    if not low <= p <= high:
        found.append(f"bounds {low}, {high} miss {p}")
    listed, cut_sets = list(solution.cut_sets()), table.cut_sets()
    if len(listed) != len(cut_sets) or {frozenset(s) for s in listed} != cut_sets:
        found.append(f"cut sets {listed}, table {cut_sets}")
    if [len(s) for s in listed] != sorted(len(s) for s in listed):
        found.append(f"cut sets not by order: {listed}")
    by_order = [sum(len(s) == n for s in cut_sets) for n in range(max(map(len, cut_sets), default=-1) + 1)]
    if list(solution.counts) != by_order:
        found.append(f"counts {solution.counts}, table {by_order}")
    doubles = solution.importance()
    for name, measures in solution.exact_importance().items():
        q, p1, p0 = table.q[name], table.probability(**{name: Fraction(1)}), table.probability(**{name: Fraction(0)})
        expected = (p1 - p0,)
        if p:
            joint = sum(
                math.prod(table.q[e] if e in s else 1 - table.q[e] for e in table.q) for s in table.truths if name in s
            )
            expected += (q * (p1 - p0) / p, (p - p0) / p, joint / p, p1 / p, p / p0 if p0 else math.inf)
        else:
            expected += (None,) * 5
        got = figures(measures)
        if got != expected:
            found.append(f"importance of {name}: {got}, table {expected}")
        if not all(close(a, b) for a, b in zip(figures(doubles[name]), expected, strict=True)):
            found.append(f"importance of {name} in doubles: {figures(doubles[name])}, table {expected}")
    return found


def figures(measures):
    return (
        measures.birnbaum,
        measures.criticality,
        measures.fussell_vesely,
        measures.diagnostic,
        measures.risk_achievement_worth,
        measures.risk_reduction_worth,
    )


def close(a, b):
    return a == b or (a is not None and b is not None and math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12))


PROBABILITIES = st.fractions(0, 1, max_denominator=20)


@st.composite
def trees(draw, kinds=("and", "or", "vote", "not", "xor"), houses=True, probabilities=PROBABILITIES):
    """Fault trees with up to six basic events and seven gates, shared inputs and unreached parts included."""
    events = [BasicEvent(name, draw(probabilities)) for name in EVENTS[: draw(st.integers(1, 6))]]
    house_events = [HouseEvent(name, draw(st.booleans())) for name in HOUSES[: draw(st.integers(0, 2 * houses))]]
    names = [node.name for node in (*events, *house_events)]
    gates = []
    for number in range(draw(st.integers(1, 7))):
        kind = draw(st.sampled_from(kinds))
        most = 1 if kind == "not" else 4
        inputs = draw(st.lists(st.sampled_from(names), min_size=1, max_size=most, unique=True))
        k = draw(st.integers(1, len(inputs))) if kind == "vote" else None
        gates.append(Gate(f"g{number}", kind, tuple(inputs), k))
        names.append(f"g{number}")
    return FaultTree("random", gates[-1].name, tuple(draw(st.permutations(gates))), tuple(events), tuple(house_events))

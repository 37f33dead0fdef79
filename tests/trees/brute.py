"""The truth table of a fault tree, all rows at once: bit `r` of a column is its value where r has the failed events.

Nothing is shared with the kernel: no diagram, no order, no module, no reduction. For up to about 20 basic events.
"""

import math
from fractions import Fraction

from safety.trees import Gate


class Truth:
    """What the definitions say of a tree."""

    def __init__(self, tree):
        self.tree, self.names = tree, [event.name for event in tree.events]
        self.rows = 1 << len(self.names)
        self.every = (1 << self.rows) - 1
        self.column = {name: self._variable(i) for i, name in enumerate(self.names)}
        self.column |= {house.name: self.every * house.state for house in tree.house_events}
        self.top = self._of(tree.top)

    def _variable(self, i):
        """Runs of 2^i rows without the event and 2^i with it, again and again."""
        width, run = 2 << i, ((1 << (1 << i)) - 1) << (1 << i)
        while width < self.rows:
            run |= run << width
            width *= 2
        return run

    def _of(self, name):
        if name not in self.column:
            gate = self.tree.nodes[name]
            assert isinstance(gate, Gate)
            self.column[name] = self._gate(gate, [self._of(below) for below in gate.inputs])
        return self.column[name]

    def _gate(self, gate, inputs):
        exactly = [self.every] + [0] * len(inputs)  # by how many inputs so far are true
        for x in inputs:
            for n in range(len(inputs), 0, -1):
                exactly[n] = exactly[n] & ~x | exactly[n - 1] & x
            exactly[0] &= ~x
        wanted = {
            "and": [len(inputs)],
            "or": range(1, len(inputs) + 1),
            "vote": range(gate.k or 0, len(inputs) + 1),
            "not": [0],
            "xor": range(1, len(inputs) + 1, 2),
        }[gate.kind]
        found = 0
        for n in wanted:
            found |= exactly[n]
        return found

    def probability(self, fixed=None):
        """Of the top event, exactly; `fixed` replaces probabilities (Fraction by name)."""
        chances = [(fixed or {}).get(event.name, event.probability) for event in self.tree.events]
        bits = bin(self.top)[2:].zfill(self.rows)[::-1]
        weights = [bit == "1" for bit in bits]
        for q in chances:
            yes, no = q.numerator, q.denominator - q.numerator
            weights = [no * a + yes * b for a, b in zip(weights[::2], weights[1::2], strict=True)]
        return Fraction(weights[0], math.prod(q.denominator for q in chances))

    def minimal(self):
        """The minimal cut sets: the rows where the top event occurs, and in no row with fewer of these events."""
        above = self.top
        for i, name in enumerate(self.names):
            above |= (above & ~self.column[name]) << (1 << i)
        larger = 0
        for i, name in enumerate(self.names):
            larger |= (above & ~self.column[name]) << (1 << i)
        rows = bin(self.top & ~larger)[2:][::-1]
        return {self._set(row) for row, bit in enumerate(rows) if bit == "1"}

    def _set(self, row):
        return frozenset(name for i, name in enumerate(self.names) if row >> i & 1)


def by_order(sets):
    """How many sets there are with 0, 1, 2, ... events; () if there is none."""
    sizes = [len(one) for one in sets]
    return tuple(sizes.count(n) for n in range(max(sizes, default=-1) + 1))

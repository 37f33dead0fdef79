"""A Boolean graph of gates as plain arrays of C int: what the simplification, the orders and the diagrams share.

A literal is 2 * index + complement. Index 0 is the constant true (literal 0 is true, 1 false), 1 to `variables` are the
variables, and the gates follow, each after its inputs.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence

AND, OR, VOTE, XOR = range(4)  # VOTE: at least `k` of its inputs; XOR: an odd number of them


class FlatGraph:
    """`kind` and `k` of each gate, and its inputs: the literals `inputs[start[g]:start[g + 1]]` of gate number g.

    Gate number g has the index `variables + 1 + g`; `root` is the literal whose function the graph stands for.
    """

    __slots__ = ("inputs", "k", "kind", "root", "start", "variables")

    def __init__(
        self,
        variables: int,
        kind: array[int],
        k: array[int],
        start: array[int],
        inputs: array[int],
        root: int,
    ) -> None:
        self.variables = variables
        self.kind = kind
        self.k = k
        self.start = start
        self.inputs = inputs
        self.root = root

    @classmethod
    def of(cls, variables: int, gates: Iterable[tuple[int, int, Sequence[int]]], root: int) -> FlatGraph:
        """From the kind, k and input literals of each gate, inputs first."""
        kind, k, start, inputs = array("i"), array("i"), array("i", [0]), array("i")
        for gate_kind, gate_k, literals in gates:
            kind.append(gate_kind)
            k.append(gate_k)
            inputs.extend(literals)
            start.append(len(inputs))
        return cls(variables, kind, k, start, inputs, root)

    def __len__(self) -> int:
        """The number of gates."""
        return len(self.kind)

    def gate(self, index: int) -> tuple[int, int, list[int]]:
        """Kind, k and input literals of the gate of that index."""
        g = index - self.variables - 1
        return self.kind[g], self.k[g], list(self.inputs[self.start[g] : self.start[g + 1]])

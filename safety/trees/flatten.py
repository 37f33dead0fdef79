"""A fault tree as the kernel takes it: numbers for names, literals for inputs."""

from __future__ import annotations

from array import array

from safety.trees.kernel.flat import AND, OR, VOTE, XOR, FlatGraph
from safety.trees.tree import FaultTree

KINDS = {"and": AND, "or": OR, "vote": VOTE, "xor": XOR}
TRUE = 0


def flatten(tree: FaultTree) -> FlatGraph:
    """The graph below the top; variable i + 1 is the i-th event of `tree`, house events are constants."""
    literal = {event.name: 2 * i for i, event in enumerate(tree.events, 1)}
    literal |= {house.name: TRUE ^ (not house.state) for house in tree.house_events}
    index = len(tree.events) + 1
    kind, k, start, inputs = array("i"), array("i"), array("i", [0]), array("i")
    for gate in tree.inputs_first:
        if gate.kind == "not":
            literal[gate.name] = literal[gate.inputs[0]] ^ 1
            continue
        kind.append(KINDS[gate.kind])
        k.append(gate.k or 0)
        inputs.extend([literal[name] for name in gate.inputs])
        start.append(len(inputs))
        literal[gate.name] = 2 * index
        index += 1
    return FlatGraph(len(tree.events), kind, k, start, inputs, literal[tree.top])

"""Which gates are written inside the formula of another, in formats that have formulas."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence

from safety.trees.tree import Gate


def nested(all_gates: Sequence[Gate], tops: Collection[str]) -> frozenset[str]:
    """The gates that a reader of the formula above them names, and marks, just as they are: "top/2" inside of "top"."""
    uses = Counter(name for gate in all_gates for name in gate.inputs)
    gates = {gate.name: gate for gate in all_gates}
    found: set[str] = set()
    for gate in sorted(all_gates, key=lambda gate: len(gate.name)):  # each before those named after it
        outermost = gate.inside if gate.name in found else gate.name
        for place, name in enumerate(gate.inputs, 1):
            inner = gates.get(name)
            if inner is None or name in tops or uses[name] > 1 or inner.description or inner.attributes:
                continue
            if name == f"{gate.name}/{place}" and inner.inside == outermost:
                found.add(name)
    return frozenset(found)

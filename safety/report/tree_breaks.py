"""Where a fault tree is broken into pages: about NODES cards on each, with as few breaks as that allows.

Each gate is drawn once, below its use nearest to the top; every other use, and every use across a break, is a transfer.
The breaks are those of the linear tree-partitioning algorithm (S. Kundu, J. Misra, SIAM J. Comput. 6, 1977): inputs
first, the heaviest branch is cut off a gate until the rest fits, which needs the least number of cuts. A gate with
more than WIDE inputs is continued on further pages. Small branches that were cut off share a page.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

NODES = 25  # cards on one page, those of transfers included
WIDE = 36  # inputs of one gate on one page


class Branch:
    """A card to be drawn and what hangs below it: a gate (or its part from input `first` on), an event, a transfer."""

    __slots__ = ("first", "inputs", "is_transfer", "last", "name", "weight")

    def __init__(self, name: str, first: int = 0, last: int = 0, is_transfer: bool = False) -> None:
        self.name = name
        self.first, self.last = first, last  # of the gate's inputs, those drawn in this part: first <= i < last
        self.is_transfer = is_transfer
        self.inputs: list[Branch] = []
        self.weight = 1  # cards, itself included

    @property
    def key(self) -> tuple[str, int]:
        """What a transfer and the part that it leads to have in common."""
        return self.name, self.first

    def subtree(self) -> Iterator[Branch]:
        """This branch and all below, each before its inputs."""
        agenda = [self]
        while agenda:
            branch = agenda.pop()
            yield branch
            agenda.extend(reversed(branch.inputs))


Page = list[Branch]  # the branches side by side on one page


def pages(tops: Sequence[str], gates: Mapping[str, Sequence[str]]) -> list[Page]:
    """The pages of the trees below the gates `tops`, the first tree first; `gates` gives the inputs of every gate.

    A name that is none of the gates is an event. What no top reaches is left out.
    """
    homes = _homes(tops, gates)
    branches: dict[str, Branch] = {}  # gates whose place is still open, by name
    cut: dict[tuple[str, int], Branch] = {}
    for name in reversed(homes):
        branches[name] = _gate(name, gates[name], homes, branches, cut)
    pages_: list[Page] = [[]]
    for root in _in_order([branches[top] for top in tops], cut):
        has_room = sum(branch.weight for branch in pages_[-1]) + root.weight <= NODES
        if not pages_[-1] or (has_room and (len(pages_) > 1 or root.name in tops)):
            pages_[-1].append(root)
        else:
            pages_.append([root])
    return pages_


def _homes(tops: Sequence[str], gates: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """The gate below which each gate is drawn: the first to use it, level by level."""
    homes = dict.fromkeys(tops, "")
    for top in tops:
        agenda = [top]
        for name in agenda:
            for below in gates[name]:
                if below in gates and below not in homes:
                    homes[below] = name
                    agenda.append(below)
    return homes


def _gate(
    name: str,
    inputs: Sequence[str],
    homes: Mapping[str, str],
    branches: dict[str, Branch],
    cut: dict[tuple[str, int], Branch],
) -> Branch:
    """The branch of a gate, light enough for a page; what is cut off it is entered in `cut`."""
    below = [
        (branches.pop(one) if homes[one] == name else Branch(one, is_transfer=True)) if one in homes else Branch(one)
        for one in inputs
    ]
    parts = [below] if len(below) <= WIDE else _split(below)
    last = len(below)
    rest: Branch | None = None
    for part in reversed(parts):
        gate = Branch(name, last - len(part), last)
        last = gate.first
        gate.inputs = part
        if rest is not None:
            cut[rest.key] = rest
            gate.inputs = [*part, Branch(name, rest.first, is_transfer=True)]
        gate.weight += sum(branch.weight for branch in gate.inputs)
        _lighten(gate, cut)
        rest = gate
    assert rest is not None
    return rest


def _split(below: Sequence[Branch]) -> list[list[Branch]]:
    """The inputs of a wide gate in runs that fill a page each, with room for the gate and the way to the next run."""
    runs: list[list[Branch]] = [[]]
    weight = 2
    for branch in below:
        taken = branch.weight if branch.weight <= NODES // 3 else 1  # what is heavier will be cut off
        if runs[-1] and weight + taken > NODES:
            runs.append([])
            weight = 2
        runs[-1].append(branch)
        weight += taken
    return runs


def _lighten(gate: Branch, cut: dict[tuple[str, int], Branch]) -> None:
    """Cut the heaviest inputs off until the gate fits on a page."""
    for branch in sorted(reversed(gate.inputs), key=lambda one: -one.weight):  # of equal ones the last
        if gate.weight <= NODES or branch.weight == 1:
            return
        cut[branch.key] = branch
        gate.inputs[gate.inputs.index(branch)] = Branch(branch.name, branch.first, is_transfer=True)
        gate.weight -= branch.weight - 1


def _in_order(tops: Sequence[Branch], cut: dict[tuple[str, int], Branch]) -> Iterator[Branch]:
    """The tops and the branches that were cut off, each after the one that first leads to it, and near it."""
    agenda = [*reversed(tops)]
    while agenda:
        root = agenda.pop()
        yield root
        found = [cut.pop(one.key) for one in root.subtree() if one.is_transfer and one.key in cut]
        agenda.extend(reversed(found))

"""A fault tree while it is being read: its definitions, with the file and line of each for error messages."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction

from safety.trees.tree import BasicEvent, FaultTree, Gate, HouseEvent, Node, TreeError


@contextmanager
def at(place: str) -> Iterator[None]:
    """Give `place` ("file:line") to a TreeError raised inside, unless it has one."""
    try:
        yield
    except TreeError as error:
        raise TreeError(error.message, error.item, error.place or place) from None


@dataclass
class Draft:
    """Definitions in the order read. `top` may stay empty: the one gate that no other gate uses is then taken."""

    file: str
    name: str = ""
    top: str = ""
    description: str = ""
    mission_time_h: Fraction | None = None
    gates: list[Gate] = field(default_factory=list)
    events: list[BasicEvent] = field(default_factory=list)
    house_events: list[HouseEvent] = field(default_factory=list)
    places: dict[str, str] = field(default_factory=dict)  # of a name defined twice, the second

    def add(self, node: Node, place: str) -> None:
        """Take up a definition that stands at `place`."""
        self.places[node.name] = place
        match node:
            case Gate():
                self.gates.append(node)
            case BasicEvent():
                self.events.append(node)
            case HouseEvent():
                self.house_events.append(node)

    def finish(self, top: str | None) -> FaultTree:
        """The checked tree, with `top` if given. Raises TreeError with the place of the definition at fault."""
        try:
            chosen = top or self.top or self._only_root()
            return FaultTree(
                self.name or chosen,
                chosen,
                tuple(self.gates),
                tuple(self.events),
                tuple(self.house_events),
                self.description,
                self.mission_time_h,
            )
        except TreeError as error:
            raise TreeError(error.message, error.item, self.places.get(error.item, self.file)) from None

    def _only_root(self) -> str:
        used = {name for gate in self.gates for name in gate.inputs}
        roots = list(dict.fromkeys(gate.name for gate in self.gates if gate.name not in used))
        if len(roots) == 1:
            return roots[0]
        if not self.gates:
            raise TreeError("no gate is defined; a fault tree needs at least its top gate")
        if not roots:
            # Each gate is used by another, so there is a cycle; building the tree finds and names it.
            return self.gates[0].name
        some = ", ".join(roots[:5]) + ", ..." * (len(roots) > 5)
        raise TreeError(f"{len(roots)} gates are used by no other ({some}); choose one of them with top=")

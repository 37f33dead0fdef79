"""What is being read: its definitions, with the file and line of each for error messages."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction

from safety.trees.as_written import TreeError
from safety.trees.tree import BasicEvent, FaultTree, Gate, HouseEvent, Node

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any

    from safety.trees.study import Study


@contextmanager
def at(place: str) -> Iterator[None]:
    """Give `place` ("file:line") to a TreeError raised inside, unless it has one."""
    try:
        yield
    except TreeError as error:
        raise error.at(place) from None


class Draft:
    """Definitions in the order read. `top` may stay empty: the one gate that no other gate uses is then taken."""

    def __init__(
        self, file: str, name: str = "", top: str = "", description: str = "", mission_time_h: Fraction | None = None
    ) -> None:
        self.file, self.name, self.top, self.description = file, name, top, description
        self.mission_time_h = mission_time_h
        self.gates: list[Gate] = []
        self.events: list[BasicEvent] = []
        self.house_events: list[HouseEvent] = []
        self.tops: tuple[str, ...] = ()  # the gates to analyse; empty: those that no other gate uses
        self.places: dict[str, str] = {}  # of a name defined twice, the second
        self.tree_names: dict[str, str] = {}  # of a gate, the fault tree that it was written in, where that has a name
        self.parts: dict[str, Any] = {}  # further fields of a Study; beside "parameters" they change what a tree means

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
        """The checked tree, with `top` if given, and with all that the files say of it applied (see Study.quantified).

        Raises TreeError with the place of the definition at fault.
        """
        with self.places_of_items():
            if self.parts.keys() - {"parameters"}:
                return self.study().only_tree(top)
            chosen = top or self.top or only_root(self.tops or roots(self.gates), self.gates)
            return FaultTree(
                self.tree_names.get(chosen) or self.name or chosen,
                chosen,
                tuple(self.gates),
                tuple(self.events),
                tuple(self.house_events),
                self.description,
                self.mission_time_h,
            )

    def study(self) -> Study:
        """All that was read. Raises TreeError with the place of the definition at fault."""
        from safety.trees.study import Study

        with self.places_of_items():
            return Study(
                self.name,
                tuple(self.gates),
                tuple(self.events),
                tuple(self.house_events),
                tops=(self.top,) if self.top else self.tops,
                description=self.description,
                mission_time_h=self.mission_time_h,
                tree_names=self.tree_names,
                **self.parts,
            )

    @contextmanager
    def places_of_items(self) -> Iterator[None]:
        """Give an error raised inside the place of the definition that it names."""
        try:
            yield
        except TreeError as error:
            raise error.at(self.places.get(error.item, self.file)) from None


def only_root(found: Sequence[str], gates: Sequence[Gate]) -> str:
    """The one gate in `found`, those of `gates` that no other uses. Raises TreeError when there are several or none."""
    if len(found) == 1:
        return found[0]
    if not gates:
        raise TreeError("no gate is defined; a fault tree needs at least its top gate")
    if not found:
        # Each gate is used by another, so there is a cycle; building the tree finds and names it.
        return gates[0].name
    some = ", ".join(found[:5]) + ", ..." * (len(found) > 5)
    raise TreeError(f"{len(found)} gates are used by no other ({some}); choose one of them with top=")


def roots(gates: Sequence[Gate]) -> list[str]:
    """The gates that no other gate uses, in the order given."""
    used = {name for gate in gates for name in gate.inputs}
    return list(dict.fromkeys(gate.name for gate in gates if gate.name not in used))

"""Gates in an order in which each comes after its inputs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from safety.trees.as_written import TreeError

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Protocol, TypeVar

    class HasInputs(Protocol):
        """A gate of any kind of tree."""

        @property
        def inputs(self) -> tuple[str, ...]:
            """Names of gates and events."""

    G = TypeVar("G", bound=HasInputs)


def inputs_first(gates: Mapping[str, G], roots: Iterable[str], cyclic: str) -> tuple[G, ...]:
    """The gates that `roots` reach, each after its inputs; a name that is no gate is passed over.

    Raises TreeError, `cyclic` and the loop by name, where a gate is its own cause.
    """
    done: dict[str, G] = {}
    path: dict[str, None] = {}  # gates entered and not yet left, outermost first
    agenda = [(root, False) for root in roots][::-1]
    while agenda:
        name, leaving = agenda.pop()
        gate = gates.get(name)
        if gate is None or name in done:
            continue
        if leaving:
            del path[name]
            done[name] = gate
        elif name in path:
            entered = list(path)
            loop = " -> ".join([*entered[entered.index(name) :], name])
            raise TreeError(f"{cyclic}: {loop}; no gate may be its own cause, break it at one of them", name)
        else:
            path[name] = None
            agenda.append((name, True))
            agenda.extend((below, False) for below in reversed(gate.inputs))
    return tuple(done.values())

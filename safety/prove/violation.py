"""What a claim forbids, as something to look for in a run: one formula for the proof and for the injection campaign.

Campaign(..., hazard=violation(brakes_on_overspeed))            the claim's formula does not hold
Campaign(..., hazard=happening(overspeed_without_brake))        the hazard's formula holds
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, cast

from safety.prove.claims import Formula, Seen, watching
from safety.system import State, System
from safety.terms import Bit
from safety.terms.graph import BIT, variable


class Host(Protocol):
    """A system that is looked at, and the registers that looking needs, by what they stand for."""

    system: System
    registers: dict[Any, State]


def happening(formula: Formula) -> Callable[[Host], Bit]:
    """Where a formula is true, as a wire; its time operators count steps from power-up."""
    return lambda host: watching(host.registers, formula, Seen(host.system))


def violation(formula: Formula, given: Formula | None = None) -> Callable[[Host], Bit]:
    """Where a formula is false, as a wire; only as long as `given` has been true at every step."""

    def violated(host: Host) -> Bit:
        broken = ~happening(formula)(host)
        if given is None:
            return broken
        now = happening(given)(host)
        key = ("given", now.uid)
        if key not in host.registers:
            held = cast(Bit, variable(f"watch.given{len(host.registers)}", BIT))
            host.registers[key] = State(held, held & now, True)
        return cast(Bit, host.registers[key].var) & now & broken

    return violated

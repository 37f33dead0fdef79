"""What a campaign looks at: the signals of a system by name, and monitors that need a memory of their own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, cast

from safety.inject.space import CampaignError
from safety.system import State, System
from safety.terms import Bit, UInt, select
from safety.terms.graph import BIT, Term, uint, variable


def observed(name: str) -> str:
    """Name of the signal that carries an observed wire."""
    return f"observed {name}"


class Wires:
    """The signals of a system by full name, to observe something made of several of them, or of their past.

    `registers`: what is remembered for that, by what it stands for; `steps`: model steps of a frame.
    """

    def __init__(self, system: System, steps: int = 1) -> None:
        self.system, self.steps = system, steps
        self.registers: dict[Any, State] = {}

    def __getitem__(self, path: str) -> Any:
        return self.system.lookup(path)

    def lasting(self, wire: Bit, frames: int) -> Bit:
        """Whether the wire has been true for so many frames in a row, at each of their steps, up to and with this one.

        So a hazard can be one that a relay follows, or that lasts longer than the allowed reaction time:
        `wires.lasting(fast & ~braked, frames=640)`.  Raises `CampaignError` unless `frames` is 1 or more.
        """
        if type(frames) is not int or frames < 1:
            raise CampaignError(f"lasting(..., {frames!r}): a number of frames is a whole number from 1 up")
        before = frames * self.steps - 1
        if not before:
            return wire
        width = before.bit_length()

        def follow(past: Term) -> Term:
            steps = cast(UInt, past)
            return select(wire, select(steps < before, (steps + 1).low(width), steps), 0)

        past = cast(UInt, self._register(("lasting", wire.uid, before), uint(width), 0, follow))
        return wire & (past >= before)

    def once(self, wire: Bit) -> Bit:
        """Whether the wire is true at this step or was at one before."""
        past = self._register(("once", wire.uid, 0), BIT, False, lambda past: cast(Bit, past) | wire)
        return cast(Bit, past) | wire

    def _register(self, key: tuple[str, int, int], sort: Any, start: Any, follow: Callable[[Term], Term]) -> Term:
        if key not in self.registers:
            var = variable(f"monitor {len(self.registers)} {key[0]}", sort)
            self.registers[key] = State(var, follow(var), start)
        return self.registers[key].var

    def observing(self, seen: Mapping[str, Term]) -> System:
        """The system with these terms among its signals, and what the monitors remember among its registers."""
        states = (*self.system.states, *self.registers.values())
        signals = {observed(name): wire for name, wire in seen.items()}
        return replace(self.system, states=states, signals={**self.system.signals, **signals})


Watched = str | Callable[[Wires], Bit]  # a wire by its name, or a function of all wires


def observing(system: System, watched: Mapping[str, Watched], steps: int) -> System:
    """The system with the watched wires among its signals, as `observed NAME`.

    Raises `ModelError` for an unknown signal, `CampaignError` for what is not a wire.
    """
    wires = Wires(system, steps)
    seen = {name: wires[wire] if isinstance(wire, str) else wire(wires) for name, wire in watched.items()}
    for name, wire in seen.items():
        if not isinstance(wire, Term) or wire.sort != BIT:
            what = wire.sort if isinstance(wire, Term) else f"{wire!r}"
            raise CampaignError(f"{name!r} observes a {what}; write a comparison or .bit(i)")
    return wires.observing(seen)

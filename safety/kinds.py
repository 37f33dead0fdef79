"""Fault kinds: what a wire, a word or a contact does when it fails.

A kind is a small machine at a point: from the healthy value it makes the value that is seen, with memory and free
choices of its own where it needs them.  Each says what it means in one line, which results repeat.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import cast

from safety.system import ANY, ModelError, PowerUpValue, State
from safety.terms import Bit, UInt, select
from safety.terms.graph import BIT, Sort, Term, uint, variable
from safety.terms.values import build, const


class Seat:
    """What a fault's effect is built from: whether it acts now, memory, and free choices."""

    def __init__(self, name: str, active: Bit) -> None:
        self.name, self.active = name, active
        self.states: list[State] = []
        self.inputs: dict[str, Term] = {}

    def register(self, label: str, sort: Sort, start: PowerUpValue) -> Term:
        """A register of the fault; give its next value with `then`."""
        var = variable(f"{self.name}.{label}", sort)
        self.states.append(State(var, var, start))
        return var

    def then(self, register: Term, value: Term) -> None:
        """The register's next value."""
        self.states = [replace(s, next=value) if s.var is register else s for s in self.states]

    def free(self, label: str, sort: Sort) -> Term:
        """A value chosen anew at every step: by the schedule of a run, by the solver in a proof."""
        self.inputs[f"{self.name}.{label}"] = variable(f"{self.name}.{label}", sort)
        return self.inputs[f"{self.name}.{label}"]


Effect = Callable[[Seat, Term], Term]


@dataclass(frozen=True)
class Kind:
    """A way to fail: name, meaning, the sorts it applies to, and its effect while active."""

    name: str
    meaning: str
    effect: Effect
    sorts: tuple[str, ...] = ("bit", "uint", "int", "real")

    def __str__(self) -> str:
        return self.name


def _mask(sort: Sort, number: int | None) -> int:
    if number is not None and not 0 <= number < sort.width:
        raise ModelError(f"a point of {sort} has bits 0..{sort.width - 1}, not bit {number}")
    return (1 << sort.width) - 1 if number is None else 1 << number


def stuck(value: int, bit: int | None = None) -> Kind:
    """Stuck-at: the wire, one bit of the word, or (without `bit`) the whole word reads `value` (0 or 1)."""
    if value not in (0, 1) or isinstance(value, float):
        raise ModelError(f"stuck({value!r}): a wire is stuck at 0 or at 1")

    def effect(_: Seat, healthy: Term) -> Term:
        if healthy.sort == BIT:
            return const(bool(value), BIT)
        word, mask = cast(UInt, healthy), _mask(healthy.sort, bit)
        return word | mask if value else word & (healthy.sort.bounds[1] & ~mask)

    place = "" if bit is None else f" bit {bit}"
    return Kind(f"stuck-at-{value}{place}", f"reads {value} whatever the equipment does", effect, ("bit", "uint"))


def flip(bit: int | None = None) -> Kind:
    """Bit flip: the wire, one bit, or all bits of the word are inverted."""

    def effect(_: Seat, healthy: Term) -> Term:
        return ~cast(Bit, healthy) if healthy.sort == BIT else cast(UInt, healthy) ^ _mask(healthy.sort, bit)

    return Kind("flip" if bit is None else f"flip bit {bit}", "reads the opposite", effect, ("bit", "uint"))


def frozen() -> Kind:
    """Frozen: the value seen at the last healthy step stays."""

    def effect(seat: Seat, healthy: Term) -> Term:
        last = seat.register("last", healthy.sort, ANY)
        seat.then(last, choose(seat.active, last, healthy))
        return last

    return Kind("frozen", "keeps the last healthy value (at power-up: any value)", effect)


def delayed(ticks: int) -> Kind:
    """Delayed: the value of `ticks` steps ago is seen."""
    if ticks < 1:
        raise ModelError(f"delayed({ticks}): a delay is 1 step or more")

    def effect(seat: Seat, healthy: Term) -> Term:
        low: PowerUpValue = False if healthy.sort == BIT else 0 if healthy.sort.admits(0) else healthy.sort.bounds[0]
        value = healthy
        for k in range(ticks):
            stage = seat.register(f"stage{k}", healthy.sort, low)
            seat.then(stage, value)
            value = stage
        return value

    return Kind(f"delayed by {ticks}", f"shows the value of {ticks} steps before (at first: 0)", effect)


def missing(pulses: int = 1) -> Kind:
    """Missing pulses: while active, the first `pulses` pulses do not come."""
    if pulses < 1:
        raise ModelError(f"missing({pulses}): at least 1 pulse is lost")

    def effect(seat: Seat, healthy: Term) -> Term:
        width = max(pulses.bit_length(), 1)
        lost = cast(UInt, seat.register("lost", uint(width), 0))
        swallow = cast(Bit, healthy) & seat.active & (lost < pulses)
        seat.then(lost, select(swallow, (lost + 1).low(width), lost))
        return cast(Bit, healthy) & ~swallow

    return Kind(f"{pulses} missing pulse(s)", f"the first {pulses} pulse(s) are lost", effect, ("bit",))


def extra() -> Kind:
    """Extra pulse: one pulse too many at the step at which the fault becomes active."""

    def effect(seat: Seat, healthy: Term) -> Term:
        before = cast(Bit, seat.register("before", BIT, False))
        seat.then(before, seat.active)
        return cast(Bit, healthy) | (seat.active & ~before)

    return Kind("extra pulse", "one pulse more, at onset", effect, ("bit",))


def open_circuit() -> Kind:
    """Open: a broken wire or an open coil or contact; de-energised, reads 0."""
    return Kind(
        "open", "de-energised for ever: broken wire, open coil or contact", lambda _, h: const(False, BIT), ("bit",)
    )


def welded() -> Kind:
    """Welded: a contact that cannot open any more; reads 1."""
    return Kind("welded", "the contact stays closed", lambda _, h: const(True, BIT), ("bit",))


def byzantine() -> Kind:
    """Byzantine: any value at every step, differently at every point."""
    return Kind("byzantine", "any value at every step", lambda seat, healthy: seat.free("value", healthy.sort))


def choose(condition: Bit, then: Term, otherwise: Term) -> Term:
    """`then` where the condition holds, of any sort.

    Where `then` masks `otherwise`, the mask is chosen: the stuck bits of a word stay a flat chain, which solvers need.
    """
    if then.op in _NEUTRAL and then.args[0] is otherwise and then.args[1].is_const:
        neutral = const(_NEUTRAL[then.op](then.sort), then.sort)
        mask = build("select", (condition, then.args[1], neutral), None, then.sort)
        return build(then.op, (otherwise, mask), None, then.sort)
    return build("select", (condition, then, otherwise), None, then.sort)


_NEUTRAL: dict[str, Callable[[Sort], int]] = {
    "bor": lambda _: 0, "bxor": lambda _: 0, "band": lambda sort: int(sort.bounds[1]),
}  # fmt: skip

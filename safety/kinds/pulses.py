"""Kinds for a wire that carries pulses, a step long each: some do not come, or come besides."""

from __future__ import annotations

from typing import cast

from safety.kinds.kind import Kind, Seat, whole
from safety.system import ModelError
from safety.terms import Bit, UInt, select
from safety.terms.graph import BIT, Term, uint


def missing(pulses: int = 1, every: int | None = None) -> Kind:
    """Missing pulses: while active, the first `pulses` do not come; with `every`, the last `pulses` of each `every`.

    The pulses of each `every` are counted from power-up on, so the onset decides which of them is the first to be lost.
    """
    call = f"missing({pulses!r})" if every is None else f"missing({pulses!r}, every={every!r})"
    whole(pulses, 1, call, "at least 1 pulse is lost")
    if every is not None:
        if type(every) is not int or every <= pulses:
            raise ModelError(f"{call}: {pulses} pulse(s) are lost of more than {pulses}; all of them is stuck(0)")
        return _missing_of_each(pulses, every)

    def effect(seat: Seat, healthy: Term) -> Term:
        lost = cast(UInt, seat.register("lost", uint(pulses.bit_length()), 0))
        swallow = cast(Bit, healthy) & seat.active & (lost < pulses)
        seat.then(lost, select(swallow, (lost + 1).low(lost.width), lost))
        return cast(Bit, healthy) & ~swallow

    meaning = f"the first {pulses} pulse(s) are lost"
    return Kind(f"{pulses} missing pulse(s)", meaning, effect, ("bit",), unit="pulses")


def _missing_of_each(pulses: int, every: int) -> Kind:
    """The last `pulses` of each `every` pulses are lost."""

    def effect(seat: Seat, healthy: Term) -> Term:
        came = cast(UInt, seat.register("came", uint((every - 1).bit_length()), 0))
        pulse = cast(Bit, healthy)
        following = select(came == every - 1, 0, (came + 1).low(came.width))
        seat.then(came, select(pulse, following, came))
        return pulse & (came < every - pulses)

    meaning = f"of every {every} pulses the last {pulses} are lost"
    return Kind(f"{pulses} in {every} pulses missing", meaning, effect, ("bit",), unit="pulses")


def extra(every: int | None = None) -> Kind:
    """Extra pulse: a pulse at the step at which the fault becomes active; with `every`, again every so many steps.

    Where a pulse is there already the two are one.
    """
    if every is None:

        def once(seat: Seat, healthy: Term) -> Term:
            before = cast(Bit, seat.register("before", BIT, False))
            seat.then(before, seat.active)
            return cast(Bit, healthy) | (seat.active & ~before)

        return Kind("extra pulse", "one pulse more, at onset", once, ("bit",), unit="steps")
    whole(every, 2, f"extra(every={every!r})", "a pulse in every 2 steps is the most; one in each step is stuck(1)")

    def effect(seat: Seat, healthy: Term) -> Term:
        turn = cast(UInt, seat.register("turn", uint((every - 1).bit_length()), 0))
        seat.then(turn, select(seat.active, select(turn == every - 1, 0, (turn + 1).low(turn.width)), 0))
        return cast(Bit, healthy) | (turn == 0)

    meaning = f"a pulse more at onset and every {every} steps after it"
    return Kind(f"extra pulse every {every} steps", meaning, effect, ("bit",), unit="steps")

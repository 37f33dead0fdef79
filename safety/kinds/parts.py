"""Kinds that act on the registers of a part: its clock, its power, what it has stored.

They name parts (`a`, `a.ring`, the name of the whole for all of it) or single registers.  A part is all registers under
its name; parameters, and registers of other faults, go on.
"""

from __future__ import annotations

from typing import Any, cast

from safety.kinds.kind import WIRES, Bits, Kind, Part, Seat, at_bits, choose, mask, whole
from safety.system import ANY, ModelError
from safety.terms import Bit, UInt, select
from safety.terms.graph import BIT, Term, uint
from safety.terms.values import const

_CLOCK = "IEC 61508-2:2010 tables A.1 and A.11 (clock)"


def clock_stop() -> Kind:
    """Clock stopped: the registers keep their values; what is computed from them still follows its inputs."""
    return Kind("clock stopped", "registers keep their values", update=lambda _, part: part.after(0), reference=_CLOCK)


def clock_slow(one_in: int) -> Kind:
    """Clock slow: the last of every `one_in` steps is lost, counted from onset."""
    whole(one_in, 2, f"clock_slow({one_in!r})", "one step in 2 or more is lost; all of them is clock_stop()")

    def update(seat: Seat, part: Part) -> tuple[Term, ...]:
        return _at(_last_of(seat, one_in), part, 0)

    name = f"clock slow, 1 step in {one_in} lost"
    return Kind(name, f"of every {one_in} steps the last is lost", update=update, unit="steps", reference=_CLOCK)


def clock_fast(times: int = 2, every: int = 1) -> Kind:
    """Clock fast: the last of every `every` steps, counted from onset, is `times` steps in one.

    Within them all that lies outside the part stays as it is, and what the others see of the part in this step is what
    they would have seen of the first: a step function knows no time between two steps.
    """
    call = f"clock_fast({times!r}, every={every!r})"
    whole(times, 2, call, "a fast clock takes 2 steps or more in one")
    whole(every, 1, call, "it does so in 1 of every 1 steps or more")

    def update(seat: Seat, part: Part) -> tuple[Term, ...]:
        return part.after(times) if every == 1 else _at(_last_of(seat, every), part, times)

    name = f"clock fast, {times} steps in one" + (f" every {every} steps" if every > 1 else "")
    return Kind(name, f"{times} steps in the time of one", update=update, unit="steps", reference=_CLOCK)


def clock_glitch(steps: int = 2) -> Kind:
    """Clock glitch: at onset, once, `steps` steps in one (2: one step too many), or none (0: one step is skipped)."""
    if type(steps) is not int or steps < 0 or steps == 1:
        raise ModelError(f"clock_glitch({steps!r}): 0 skips a step, 2 is one step too many; write 0, or 2 or more")

    def update(seat: Seat, part: Part) -> tuple[Term, ...]:
        before = cast(Bit, seat.register("before", BIT, False))
        seat.then(before, seat.active)
        return _at(~before, part, steps)

    name = "clock glitch, a step skipped" if steps == 0 else f"clock glitch, {steps} steps in one"
    return Kind(name, "one wrong clock edge, at onset", update=update, unit="steps", reference=_CLOCK)


def power_dip() -> Kind:
    """Power dip and restart: the registers are held at their power-up values, and start from them when it ends.

    A register that powers up with ANY value takes any, anew at every step of the dip: 0 or false in a run whose
    `Fault.values` do not say otherwise.  What a part without power shows is another matter: see `common_cause`.
    """

    def update(seat: Seat, part: Part) -> tuple[Term, ...]:
        return tuple(
            const(cast(Any, s.power_up), s.var.sort)
            if s.power_up is not ANY
            else seat.at(s.path).free("power_up", s.var.sort)
            for s in part.states
        )

    return Kind(
        "power dip",
        "registers return to their power-up values",
        update=update,
        reference="IEC 61508-2:2010 tables A.1 and A.9 (power supply)",
    )


def memory_flip(bit: Bits = None) -> Kind:
    """Upset of what is stored: the named bits of the registers (all without `bit`) are inverted at the end of a step.

    Transient over one step it is the single-event upset of a register, which stays until the register is written.
    """
    name = f"stored flip{at_bits(bit)}"

    def inverted(value: Term) -> Term:
        chosen = mask(value.sort, bit, name)
        return ~cast(Bit, value) if value.sort == BIT else cast(UInt, value) ^ chosen

    return Kind(
        name,
        "stores the opposite",
        sorts=WIRES,
        update=lambda _, part: tuple(inverted(s.next) for s in part.states),
        unit="bit numbers",
        reference="IEC 61508-2:2010 table A.1 (soft errors)",
    )


def _last_of(seat: Seat, steps: int) -> Bit:
    """Whether this is the last of so many steps, counted from onset."""
    turn = cast(UInt, seat.register("turn", uint((steps - 1).bit_length()), 0))
    last = turn == steps - 1
    seat.then(turn, select(seat.active, select(last, 0, (turn + 1).low(turn.width)), 0))
    return last


def _at(now: Bit, part: Part, steps: int) -> tuple[Term, ...]:
    """So many steps at once while the condition holds, one step else."""
    return tuple(choose(now, value, s.next) for value, s in zip(part.after(steps), part.states, strict=True))

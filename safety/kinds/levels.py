"""Kinds that put another level on a wire, another word on its lines, or another reading in a sensor's place."""

from __future__ import annotations

from fractions import Fraction
from typing import cast

from safety.kinds.kind import WIRES, Bits, Kind, Seat, at_bits, exact, listed, mask, resting, whole
from safety.system import ModelError
from safety.terms import Bit, UInt, select
from safety.terms.graph import BIT, Term, uint
from safety.terms.values import const


def stuck(value: int, bit: Bits = None) -> Kind:
    """Stuck-at: the wire, one bit or several of the word, or (without `bit`) the whole word reads `value` (0 or 1)."""
    if value not in (0, 1) or isinstance(value, float):
        raise ModelError(f"stuck({value!r}): a wire is stuck at 0 or at 1")
    name = f"stuck-at-{value}{at_bits(bit)}"

    def effect(_: Seat, healthy: Term) -> Term:
        chosen = mask(healthy.sort, bit, name)
        if healthy.sort == BIT:
            return const(bool(value), BIT)
        word = cast(UInt, healthy)
        return word | chosen if value else word & (healthy.sort.bounds[1] & ~chosen)

    return Kind(
        name,
        f"reads {value} whatever the equipment does",
        effect,
        WIRES,
        unit="level, bit numbers",
        reference="IEC 61508-2:2010 table A.1 (stuck-at)",
    )


def flip(bit: Bits = None) -> Kind:
    """Bit flip: the wire, the named bits, or all bits of the word are inverted; transient, a single-event upset."""
    name = f"flip{at_bits(bit)}"

    def effect(_: Seat, healthy: Term) -> Term:
        chosen = mask(healthy.sort, bit, name)
        return ~cast(Bit, healthy) if healthy.sort == BIT else cast(UInt, healthy) ^ chosen

    return Kind(
        name,
        "reads the opposite",
        effect,
        WIRES,
        unit="bit numbers",
        reference="IEC 61508-2:2010 table A.1 (soft errors)",
    )


def upset(*bits: int) -> Kind:
    """Multi-bit upset: the named bits of a word are inverted together; adjacent ones are `upset(*range(2, 5))`."""
    if len(listed(bits)) < 2:
        raise ModelError(f"upset({bits[0]}): a multi-bit upset names two bits or more; one bit is flip(bit={bits[0]})")
    one = flip(bits)
    return Kind(
        f"upset of{at_bits(bits)}",
        "several bits read the opposite at once",
        one.effect,
        ("uint",),
        unit="bit numbers",
        reference=one.reference,
    )


def open_circuit() -> Kind:
    """Open: a broken wire or an open coil or contact, a relay stuck open; de-energised, reads 0."""
    return Kind(
        "open",
        "de-energised for ever: broken wire, open coil or contact",
        lambda _, h: const(False, BIT),
        ("bit",),
        reference="IEC 61508-2:2010 table A.1 (DC fault model); EN 50129:2018 annex C",
    )


def welded() -> Kind:
    """Welded: a contact that cannot open any more; reads 1."""
    return Kind(
        "welded",
        "the contact stays closed",
        lambda _, h: const(True, BIT),
        ("bit",),
        reference="IEC 61508-2:2010 table A.1 (welded contacts); EN 50129:2018 annex C",
    )


def reads(value: bool | int | Fraction) -> Kind:
    """Constant reading: the point shows `value`, whatever it is of the healthy one."""
    name = f"reads {value}"
    return Kind(
        name,
        f"{value} whatever the equipment does",
        lambda _, h: const(exact(value, h.sort, name), h.sort),
        unit="unit of the point",
        reference="IEC 61508-2:2010 table A.1 (stuck-at)",
    )


def dead() -> Kind:
    """Sensor dead: reads 0, or the least value that there is where 0 is none."""
    return Kind(
        "dead",
        "reads 0, or the least value that there is",
        lambda _, h: const(resting(h.sort), h.sort),
        reference="IEC 61508-2:2010 table A.1 (sensors: stuck-at)",
    )


def oscillating(steps: int = 1) -> Kind:
    """Oscillation: the wire reads 1 and 0 in turn, `steps` steps each, from onset on."""
    whole(steps, 1, f"oscillating({steps!r})", "a level stays for 1 step or more")

    def effect(seat: Seat, healthy: Term) -> Term:
        turn = cast(UInt, seat.register("turn", uint((2 * steps - 1).bit_length()), 0))
        following = select(turn == 2 * steps - 1, 0, (turn + 1).low(turn.width))
        seat.then(turn, select(seat.active, following, 0))
        return turn < steps

    return Kind(
        f"oscillating every {steps} step(s)",
        "reads 1 and 0 in turn",
        effect,
        ("bit",),
        unit="steps",
        reference="IEC 61508-2:2010 table A.1 (drift and oscillation)",
    )


def byzantine() -> Kind:
    """Byzantine: any value at every step, differently at every point."""
    return Kind("byzantine", "any value at every step", lambda seat, healthy: seat.free("value", healthy.sort))

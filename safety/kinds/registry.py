"""The table of kinds: what each is called, does, leaves open in a proof, and where the standards name it.

Everything in it is read off the kinds themselves: the definition is the first sentence of the docstring, memory and
choices are what the effect asks its seat for.  `docs/fault_kinds.md` shows it, and a test keeps the two equal.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, cast

from safety.kinds.kind import PART, POINTS, Kind, Part, Seat
from safety.kinds.levels import byzantine, dead, flip, open_circuit, oscillating, reads, stuck, upset, welded
from safety.kinds.lines import bridge, swapped, wired_and, wired_or
from safety.kinds.parts import clock_fast, clock_glitch, clock_slow, clock_stop, memory_flip, power_dip
from safety.kinds.pulses import extra, missing
from safety.kinds.timing import delayed, frozen, intermittent, slow_to_operate, slow_to_release
from safety.kinds.values import drift, noise, offset
from safety.system import ANY, State
from safety.terms import Bit
from safety.terms.graph import BIT, REAL, Sort, integer, uint, variable

_SAMPLES = {"bit": BIT, "uint": uint(4), "int": integer(-3, 3), "real": REAL}

# Every way to make a kind, with arguments for which it shows all that it has.
_MAKERS: tuple[tuple[Callable[..., Kind], tuple[Any, ...]], ...] = (
    (stuck, (1,)),
    (flip, ()),
    (upset, (0, 1)),
    (open_circuit, ()),
    (welded, ()),
    (reads, (1,)),
    (dead, ()),
    (oscillating, (2,)),
    (byzantine, ()),
    (frozen, ()),
    (delayed, (1,)),
    (slow_to_operate, (2,)),
    (slow_to_release, (2,)),
    (intermittent, (stuck(1), 1, 2)),
    (missing, ()),
    (extra, ()),
    (offset, (1,)),
    (drift, (1,)),
    (noise, (2,)),
    (wired_and, ()),
    (wired_or, ()),
    (bridge, ()),
    (swapped, ()),
    (clock_stop, ()),
    (clock_slow, (2,)),
    (clock_fast, ()),
    (clock_glitch, ()),
    (power_dip, ()),
    (memory_flip, ()),
)


@dataclass(frozen=True)
class Entry:
    """A row of the table: a way to make a kind.

    `memory` are registers of the fault, `choices` what a proof leaves open: values at every step, registers at
    power-up; a run takes one of them.  Both are those of an example at a point of the first sort that it applies to.
    """

    name: str
    parameters: str
    definition: str
    place: str
    sorts: tuple[str, ...]
    unit: str
    memory: tuple[str, ...]
    choices: tuple[str, ...]
    reference: str


def kinds() -> tuple[Entry, ...]:
    """All fault kinds, in the order of the table."""
    return tuple(_entry(make, make(*arguments)) for make, arguments in _MAKERS)


def makers() -> dict[str, Callable[..., Kind]]:
    """The functions that make kinds, by name."""
    return {make.__name__: make for make, _ in _MAKERS}


def _entry(make: Callable[..., Kind], example: Kind) -> Entry:
    seat = _seated(example)
    registers = {str(s.var.attr).rpartition(".")[2]: s for s in seat.states}
    free = [f"{name.rpartition('.')[2]}: {term.sort} at every step" for name, term in seat.inputs.items()]
    started = [f"{name}: {s.var.sort} at power-up" for name, s in registers.items() if s.power_up is ANY]
    signature = inspect.signature(make)
    bare = signature.replace(
        parameters=[p.replace(annotation=inspect.Parameter.empty) for p in signature.parameters.values()],
        return_annotation=inspect.Signature.empty,
    )
    return Entry(
        make.__name__,
        str(bare),
        (inspect.getdoc(make) or "").partition("\n\n")[0].replace("\n", " "),
        example.place,
        example.sorts,
        example.unit,
        tuple(registers),
        (*free, *started),
        example.reference,
    )


def _seated(kind: Kind) -> Seat:
    """A seat that the kind has taken at points or registers of the first sort that it applies to."""
    sort: Sort = _SAMPLES[kind.sorts[0]]
    seat = Seat("sample.place", cast(Bit, variable("active", BIT)))
    first, second = (variable(name, sort) for name in ("first", "second"))
    if kind.place == PART:
        assert kind.update is not None
        kind.update(seat, Part((State(first, second, ANY),)))
    elif kind.place == POINTS:
        assert kind.joint is not None
        kind.joint(seat, (first, second))
    else:
        kind.effect(seat, first)
    return seat


def table() -> str:
    """The kinds as a Markdown table."""
    lines = [
        "| kind | what it does | acts on | unit of parameters | memory | left open in a proof | reference |",
        "|---|---|---|---|---|---|---|",
    ]
    for e in kinds():
        on = "registers of parts" if e.place == PART else f"{e.place}: {', '.join(e.sorts)}"
        cells = [
            f"`{e.name}{e.parameters}`",
            e.definition,
            on,
            e.unit,
            ", ".join(e.memory),
            "; ".join(e.choices) or "nothing",
            e.reference,
        ]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") or "-" for cell in cells) + " |")
    return "\n".join(lines) + "\n"

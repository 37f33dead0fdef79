"""Expressions in the language of SMT-LIB 2.6."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from safety.export.expressions import BOOL, INT, Expression, Names, Reading, Width, below
from safety.export.transition import Transition, power_up

UNWANTED = "|\\ \t\n"


def symbol(name: str) -> str:
    """A name as a quoted symbol."""
    return f"|{name}|"


class Variable(NamedTuple):
    """A register or an input: its symbol at a step, that at the next, and its sort."""

    now: str
    after: str
    sort: str


@dataclass(frozen=True)
class Texts:
    """A transition system in SMT-LIB: what a start is, what is given, what has to hold, what a step does."""

    registers: list[Variable]
    inputs: list[Variable]
    start: str
    given: str
    holds: str
    next: str


def texts(what: Transition, integers: bool) -> Texts:
    """The texts; a symbol is `MODEL/FULL.NAME`, which is no name of a theory's, with a prime for the next step."""
    reading, names = Reading(integers), Names(UNWANTED)
    terms = [*(s.var for s in what.states), *what.inputs]
    bound = [reading.bind(v, names.new(f"{what.name}/{v.attr}")) for v in terms]
    variables = [Variable(symbol(x.attr), symbol(names.new(f"{x.attr}'")), sort_text(x.sort)) for x in bound]
    registers = variables[: len(what.states)]
    start, given, holds, *following = reading([what.start, what.given, what.holds, *(s.next for s in what.states)])
    fixed = [
        f"(= {v.now} {value_text(value, x.sort)})"
        for s, v, x in zip(what.states, registers, bound, strict=False)
        if (value := power_up(s)) is not None
    ]
    steps = [f"(= {v.after} {text(x)})" for v, x in zip(registers, following, strict=True)]
    return Texts(
        registers,
        variables[len(registers) :],
        conjunction([*fixed, text(start)]),
        text(given),
        text(holds),
        conjunction(steps),
    )


def sort_text(sort: Width) -> str:
    """A sort."""
    return f"(_ BitVec {sort})" if isinstance(sort, int) else sort


def value_text(value: object, sort: Width) -> str:
    """A constant."""
    if sort == BOOL:
        return "true" if value else "false"
    number = Fraction(str(value))
    if isinstance(sort, int):
        return f"(_ bv{number % (1 << sort)} {sort})"
    size = f"{abs(number.numerator)}" if sort == INT else f"{abs(number.numerator)}.0"
    size = size if number.denominator == 1 else f"(/ {size} {number.denominator}.0)"
    return size if number >= 0 else f"(- {size})"


def conjunction(formulas: Iterable[str]) -> str:
    """All of them; true of none."""
    formulas = [f for f in formulas if f != "true"]
    return f"(and {' '.join(formulas)})" if len(formulas) > 1 else (formulas or ["true"])[0]


def text(root: Expression) -> str:
    """An expression; what is used more than once is written once, in `let`s as deep as the graph."""
    order = below([root])
    uses = Counter(a.number for x in order for a in x.args)
    written: dict[int, str] = {}
    level: dict[int, int] = {}
    shared: dict[int, list[str]] = {}
    for x in order:
        body, depth = (
            _applied(x, [written[a.number] for a in x.args]),
            max((level[a.number] for a in x.args), default=0),
        )
        if x.args and uses[x.number] > 1:
            shared.setdefault(depth, []).append(f"(${x.number} {body})")
            body, depth = f"${x.number}", depth + 1
        written[x.number], level[x.number] = body, depth
    lets = "".join(f"(let ({' '.join(shared[depth])})\n    " for depth in sorted(shared))
    return lets + written[root.number] + ")" * len(shared)


def _applied(x: Expression, args: list[str]) -> str:
    if x.op == "const":
        return value_text(x.attr, x.sort)
    if x.op == "var":
        return symbol(x.attr)
    if x.op == "extract":
        high, low = x.attr
        return f"((_ extract {high} {low}) {args[0]})"
    if x.op in ("zero_extend", "sign_extend"):
        return f"((_ {x.op} {x.attr}) {args[0]})"
    return f"({x.op} {' '.join(args)})"

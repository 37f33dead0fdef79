"""The declarations in a model's body: registers with power-up values, parameters, and the sorts of annotations."""

from __future__ import annotations

import typing
from dataclasses import dataclass
from typing import Any, Literal

from safety.system import ModelError, PowerUpValue
from safety.terms import Bit, Int, Real, Term, UInt
from safety.terms.graph import BIT, REAL, Sort, describe, integer, uint
from safety.terms.values import build, const


@dataclass(frozen=True)
class PowerUp:
    """A register's value when power comes."""

    value: PowerUpValue


def power_up(value: PowerUpValue) -> Any:
    """Declare a register: its value at power-up, or ANY."""
    return PowerUp(value)


@dataclass(frozen=True)
class Parameter:
    """A typed quantity that is fixed for a run: default, unit, admissible range, source."""

    default: Any
    unit: str
    low: Any
    high: Any
    source: str
    name: str = ""

    def __get__(self, owner: Any, _: type | None = None) -> Any:
        return self if owner is None else owner.parameter_value(self)


def parameter(default: Any, *, unit: str, within: tuple[Any, Any], source: str, init: Literal[False] = False) -> Any:
    """Declare a parameter; `source` starts with its tag: [P] printed, [D] derived, [A] assumed, [R] reconstructed.

    Raises `ModelError` when the tag is missing, the range is empty or the default lies outside it.
    """
    if source[:3] not in ("[P]", "[D]", "[A]", "[R]"):
        raise ModelError(f"parameter source {source!r}: start it with [P], [D], [A] or [R]")
    if not within[0] <= within[1]:
        raise ModelError(f"parameter range {within[0]}..{within[1]} {unit} is empty; write within=(least, greatest)")
    if not within[0] <= default <= within[1]:
        raise ModelError(f"parameter default {default} {unit} lies outside {within[0]}..{within[1]}")
    return Parameter(default, unit, within[0], within[1], source)


def sort_of(annotation: Any, where: str) -> Sort:
    """The sort that an annotation stands for: Bit, Annotated[UInt, bits], Annotated[Int, (low, high)] or Real."""
    if annotation is Bit:
        return BIT
    if annotation is Real:
        return REAL
    marked = typing.get_origin(annotation) is typing.Annotated
    base, *extra = typing.get_args(annotation) if marked else (annotation,)
    if base is UInt and len(extra) == 1 and type(extra[0]) is int:
        return uint(extra[0])
    if base is Int and len(extra) == 1 and isinstance(extra[0], tuple) and len(extra[0]) == 2:
        return integer(*extra[0])
    raise ModelError(
        f"{where}: {annotation!r} is no signal type; "
        "write Bit, U8 (Annotated[UInt, 8]), Annotated[Int, (low, high)] or Real"
    )


def fit(value: Any, sort: Sort, where: str) -> Term:
    """A value for a place of a sort: literals become constants, narrower words gain zeros, nothing is cut."""
    if not isinstance(value, Term):
        if not sort.admits(value):
            raise ModelError(f"{where} is {sort}: {value!r} is not a value of it")
        return const(value, sort)
    if value.sort == sort:
        return value
    given = f"{where} is {sort}, given {value.sort} {describe(value)}"
    if value.sort.is_number and sort.is_number and REAL not in (value.sort, sort):
        (low, high), (least, greatest) = value.sort.bounds, sort.bounds
        if least <= low and high <= greatest:
            return build("cast", (value,), None, sort)
        if sort.kind == "uint":
            raise ModelError(f"{given}; wrap it with .low({sort.width}) or saturate it with .sat({sort.width})")
        signed = "" if value.sort.kind == "int" else ".int()"
        raise ModelError(f"{given}; clamp it with {signed}.clip({least}, {greatest})")
    if value.sort == BIT:
        raise ModelError(f"{given}; write .word()")
    if sort == BIT:
        raise ModelError(f"{given}; write a comparison or .bit(i)")
    raise ModelError(f"{given}; " + ("write .real()" if sort == REAL else "a real has no exact word: keep it a Real"))

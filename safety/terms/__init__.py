"""Typed, exact-width terms and their readings: one text, many meanings that agree."""

from typing import Annotated

from safety.terms.graph import Term, TermError
from safety.terms.values import (
    Bit,
    Int,
    Real,
    UInt,
    all_of,
    any_of,
    at_least,
    bit,
    count,
    implies,
    real,
    select,
    word,
)

U1, U2, U3, U4 = Annotated[UInt, 1], Annotated[UInt, 2], Annotated[UInt, 3], Annotated[UInt, 4]
U5, U6, U7, U8 = Annotated[UInt, 5], Annotated[UInt, 6], Annotated[UInt, 7], Annotated[UInt, 8]
U9, U10, U12, U14 = Annotated[UInt, 9], Annotated[UInt, 10], Annotated[UInt, 12], Annotated[UInt, 14]
U16, U20, U24, U32 = Annotated[UInt, 16], Annotated[UInt, 20], Annotated[UInt, 24], Annotated[UInt, 32]

__all__ = [
    "U1", "U2", "U3", "U4", "U5", "U6", "U7", "U8", "U9", "U10", "U12", "U14", "U16", "U20", "U24", "U32",
    "Bit", "Int", "Real", "Term", "TermError", "UInt",
    "all_of", "any_of", "at_least", "bit", "count", "implies", "real", "select", "word",
]  # fmt: skip

"""Values as a results document has them: numbers, exact numbers, seconds, tags; brackets of values."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Required, TypedDict

import msgspec

Number = int | float | Literal["inf"] | None
Tag = Literal["P", "D", "A", "R", ""]
Seconds = Annotated[str, msgspec.Meta(pattern=r"^\d+(\.\d+)?(/[1-9]\d*)?$")]  # exact: "1/8000", "0.5"


class Exact(TypedDict, total=False):
    """A number as the nearest double and as it is: "p/q"."""

    value: Required[Number]
    exact: Required[str]
    unit: str


class Bracket(TypedDict, total=False):
    """The least upper bound of a quantity: `low` is reached at the witness, `high` is proved not to be exceeded."""

    low: Required[Exact | None]
    high: Required[Exact | None]
    unit: str
    relative_width: Number
    witness: dict[str, str] | None  # exact values; a root is "[low, high]"


class Synthesis(TypedDict, total=False):
    """The weakest safe value of a parameter: proved from `safe_from` on, refuted at `refuted_at` (None: not known)."""

    id: Required[str]
    model: Required[str | None]  # None: a bound over reals
    requirement: str | None
    source: str | None
    statement: Required[str]
    parameter: Required[str]
    unit: str | None
    safe: Literal["above", "below"]
    at: dict[str, Any]  # what else is held fixed, by name
    within: list[int | Exact]  # the range looked at
    safe_from: Required[int | Exact | None]
    refuted_at: Required[int | Exact | None]
    everywhere: bool  # the whole range is safe
    exact: bool  # the two values are next to each other
    gap: int | Exact  # how far apart they may be
    settled: Required[bool]  # they are no farther
    for_all: str  # by what the proof is one of all values on the safe side
    proof: dict[str, Any] | None
    refutation: dict[str, Any] | None
    counterexample: dict[str, Any] | None
    why: str | None
    seconds: Number
    error: str | None

"""Error bounds: how large a quantity over reals can be, proved by routes that share nothing, or refuted at a point.

    v, t, b = reals("v t b")
    slide = Bound(
        "stop.distance", "Distance run before the stop (m).", quantity=2 * b * v * t + v * v, per=2 * b,
        given=(between(0, v, 25), between(0, t, 2), between(Fraction(7, 10), b, Fraction(14, 10))),
    )
    check(slide, limit=500)     # proved: agreed by z3 nlsat and exact boxes
    bracket(slide)              # [largest refuted, smallest proved], 1e-4 apart

A root y of x is a variable with `y * y == x` and `y >= 0`; a quotient is `quantity` over `per`.  Rounding is relaxed to
what any rounding does (`counted`, `rounded_down`): then the bound holds for every phase.  Variables that take whole
values only are named in `whole`.  Numbers are exact; units are the user's.

In a proof file `claim_bound(slide, 500, expect=PROVED)` and `claim_bracket(slide)` make a claim of it.  What is proved
has a certificate of kind "real": two routes, named, that agree; no proof that could be checked bit by bit.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from safety.prove.bounds.claims import BoundClaim, claim_bound, claim_bracket
from safety.prove.bounds.statement import Bound, between, counted, magnitude, reals, rounded_down

if TYPE_CHECKING:
    from safety.prove.bounds.bracketing import Bracket, bracket
    from safety.prove.bounds.routes import Limits
    from safety.prove.bounds.verdict import Finding, check

__all__ = [
    "Bound",
    "BoundClaim",
    "Bracket",
    "Finding",
    "Limits",
    "between",
    "bracket",
    "check",
    "claim_bound",
    "claim_bracket",
    "counted",
    "magnitude",
    "reals",
    "rounded_down",
]
_HOME = {"Bracket": "bracketing", "bracket": "bracketing", "Limits": "routes", "Finding": "verdict", "check": "verdict"}


def __getattr__(name: str) -> Any:
    """Import what decides bounds when it is first used: a file that only states them starts without FLINT."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_HOME[name]}"), name)

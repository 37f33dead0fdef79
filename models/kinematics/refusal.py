"""How a value that a formula cannot honour is refused: reason, value, nearest admissible value."""

from __future__ import annotations

from typing import Any, NoReturn

from safety import ModelError
from safety.terms import Term


def refuse(what: str, value: Any, unit: str, why: str, nearest: str) -> NoReturn:
    """Raise ModelError: the value, why it cannot be, the nearest one that can."""
    raise ModelError(f"{what} = {shown(value)} {unit}: {why}; the nearest admissible value is {nearest}")


def shown(value: Any) -> str:
    """A number as people read it."""
    return f"{float(value):.6g}"


def positive(what: str, value: Any, unit: str) -> None:
    """Refuse what is not above 0 (nor a number at all)."""
    if not isinstance(value, Term) and not value > 0:
        refuse(what, value, unit, "it has to be above 0", "any above 0")


def not_negative(what: str, value: Any, unit: str) -> None:
    """Refuse what is below 0 (or no number at all)."""
    if not isinstance(value, Term) and not value >= 0:
        refuse(what, value, unit, "it has to be 0 or more", "0")

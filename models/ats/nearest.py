"""What a refusal of parameters that do not go together says: the nearest admissible value."""

from __future__ import annotations

from collections.abc import Callable

from safety import Real


def nearest(name: str, value: Real, unit: str, side: str = "") -> Callable[[], str]:
    """The text for `require`; `side` is "any above" or "any below" where the value itself is not admissible."""
    return lambda: f"the nearest admissible {name} is {side}{' ' if side else ''}{float(value.attr):.6g} {unit}"

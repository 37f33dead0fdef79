"""Versions of rightside and of what its results rest on."""

from __future__ import annotations

import platform
from importlib import metadata

ENGINES = {"z3": "z3-solver", "cvc5": "cvc5", "flint": "python-flint", "numpy": "numpy"}


def version() -> str:
    """The release of rightside."""
    return _of("rightside") or "not installed, run from its source"


def versions() -> dict[str, str]:
    """Everything whose version may matter to a result."""
    found = {name: _of(distribution) for name, distribution in ENGINES.items()}
    return {"rightside": version(), "python": platform.python_version(), **{n: v for n, v in found.items() if v}}


def _of(distribution: str) -> str | None:
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return None

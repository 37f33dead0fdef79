"""Versions of rightside and of what its results rest on."""

from __future__ import annotations

VERSION = "0.1.0"  # the release; the build reads it here
ENGINES = {"z3": "z3-solver", "cvc5": "cvc5", "flint": "python-flint", "numpy": "numpy"}


def versions() -> dict[str, str]:
    """Everything whose version may matter to a result."""
    import platform
    from importlib import metadata

    found = {"rightside": VERSION, "python": platform.python_version()}
    for name, distribution in ENGINES.items():
        try:
            found[name] = metadata.version(distribution)
        except metadata.PackageNotFoundError:
            continue
    return found

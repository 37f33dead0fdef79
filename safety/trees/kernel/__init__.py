"""The kernel of the fault-tree engine: every file here runs compiled where a compiler was found, interpreted elsewhere.

A file `diagram.py` is compiled under the name `_diagram_c`, so that a stale binary never stands in for an edited
source: the binary holds the hash of the text it was made from, and one of another text is refused.
"""

from __future__ import annotations

import binascii
import os
from functools import cache
from importlib import import_module
from types import ModuleType


class StaleKernel(ImportError):
    """A compiled file of the kernel was made from another text than the one beside it."""

    exit_code = 70


@cache
def load(name: str, interpreted: bool = False) -> ModuleType:
    """The kernel's file `name`: compiled if it was built (and `interpreted` is not asked for).

    Raises StaleKernel.
    """
    if not interpreted:
        try:
            compiled = import_module(f"{__name__}._{name}_c")
        except ModuleNotFoundError:
            pass
        else:
            source = os.path.join(os.path.dirname(__file__), f"{name}.py")
            with open(source, "rb") as file:
                text = file.read()
            if binascii.crc32(text) != compiled.SOURCE:
                raise StaleKernel(
                    f"{compiled.__file__} was compiled from another text than {source}; "
                    "compile it anew with `python hatch_build.py`, or remove it to run interpreted"
                )
            return compiled
    return import_module(f"{__name__}.{name}")


def is_compiled() -> bool:
    """Whether the kernel runs compiled."""
    return load("diagram").__name__.endswith("_c")

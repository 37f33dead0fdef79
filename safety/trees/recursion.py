"""Room for recursions that go down one level a call."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def recursion_of(levels: int) -> Iterator[None]:
    """Let a recursion of so many levels run; Python functions calling each other use no C stack."""
    old = sys.getrecursionlimit()
    sys.setrecursionlimit(max(old, 3 * levels + 2000))
    try:
        yield
    finally:
        sys.setrecursionlimit(old)

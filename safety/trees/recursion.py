"""Room for recursions that go down one level a call, interpreted and compiled."""

from __future__ import annotations

import sys
from collections.abc import Callable

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import TypeVar

    T = TypeVar("T")

SHALLOW = 4_000  # levels that any thread's stack holds
FRAME = 1_024  # bytes of stack for one level, more than any function of the kernel takes
LARGEST = 1 << 30


def deeply(levels: int, work: Callable[[], T]) -> T:
    """What `work` gives, with room for a recursion of so many levels: in a thread of its own where it goes deep."""
    old = sys.getrecursionlimit()
    sys.setrecursionlimit(max(old, 3 * levels + 2000))
    try:
        return work() if levels <= SHALLOW else _in_thread(levels, work)
    finally:
        sys.setrecursionlimit(old)


def _in_thread(levels: int, work: Callable[[], T]) -> T:
    result: list[T] = []
    error: list[BaseException] = []

    def run() -> None:
        try:
            result.append(work())
        except BaseException as raised:
            error.append(raised)

    import threading

    old = threading.stack_size(min(LARGEST, (1 << 23) + FRAME * levels))
    try:
        thread = threading.Thread(target=run)
        thread.start()
    finally:
        threading.stack_size(old)
    thread.join()
    if error:
        raise error[0]
    return result[0]

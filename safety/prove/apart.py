"""A question in a copy of this process, which is ended when its time is up.

cvc5 looks at its own limit between the steps of an algorithm, and a step over polynomials may take minutes.
"""

from __future__ import annotations

import os
import select
import signal
import warnings
from collections.abc import Callable


def answered_apart(ask: Callable[[], str], seconds: float) -> str:
    """What `ask` gives, empty where it is not there in time or breaks down.  Without `fork` it is asked right here."""
    if not hasattr(os, "fork"):
        return ask()
    read, write = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of threads: the copy only asks, and ends
        copy = os.fork()
    if copy == 0:
        try:
            os.write(write, ask().encode())
        finally:
            os._exit(0)
    os.close(write)
    try:
        ready, _, _ = select.select([read], [], [], seconds)
        return os.read(read, 4096).decode() if ready else ""
    finally:
        os.close(read)
        os.kill(copy, signal.SIGKILL)
        os.waitpid(copy, 0)

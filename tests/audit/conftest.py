"""A small paper: papers that tests declare are gone when the test has ended."""

from collections.abc import Iterator

import pytest

from safety.audit import Paper, assumed, derived, printed
from tests.apart import kept


@pytest.fixture
def paper() -> Iterator[Paper]:
    """A clock: an oscillator, a divider of 15 stages, and a period that an assumed load changes."""
    with kept():
        yield declare()


def declare() -> Paper:
    """Its symbols."""
    made = Paper("clock", "A clock, 1960")
    made.symbol("f", "kHz", "oscillator", printed("32.77"))
    made.symbol("stages", "1", "of the divider", derived(15))
    made.symbol("divisor", "1", "2 to the stages", derived(2**15))
    made.symbol("load", "1", "slows the oscillator", assumed("0.01", "0", "0.02"))
    made.symbol("unheard", "s", "of which nothing is known")
    made.symbol("T", "s", "period", by="divisor/f")
    return made


@pytest.fixture(autouse=True)
def apart() -> Iterator[None]:
    """What a test declares is gone after it."""
    with kept():
        yield

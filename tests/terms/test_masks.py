"""A word and a constant bit by bit, as the integer solvers read it: the value that Python gives, and few divisions."""

from __future__ import annotations

import random

import pytest

from safety.terms import Bit, UInt, select, word
from safety.terms.column_solvers import of_constants, runs
from safety.terms.graph import BIT, uint, variable
from safety.terms.smt import Encoder


def test_runs_are_the_runs() -> None:
    assert runs(0b0110_0001, 8) == [(0, 1), (5, 7)]
    assert runs(0, 8) == [] and runs(255, 8) == [(0, 8)]


def masks(width: int) -> list[int]:
    picked = random.Random(width)
    return [0, (1 << width) - 1, 1 << width - 1, *(picked.randrange(1 << width) for _ in range(6))]


@pytest.mark.parametrize("solver", ["z3", "cvc5"])
@pytest.mark.parametrize("width", [1, 5, 11])
@pytest.mark.parametrize("chosen", [False, True])
def test_a_mask_lets_through_what_python_says(solver: str, width: int, chosen: bool) -> None:
    """For every mask, constant or chosen by a bit as a fault does, no word differs from its bits."""
    x, fails = variable("x", uint(width)), variable("fails", BIT)
    assert isinstance(x, UInt) and isinstance(fails, Bit)
    whole = (1 << width) - 1
    encoder = Encoder(solver, True)
    for mask in masks(width):
        low = select(fails, word(mask, width), word(whole, width)) if chosen else word(mask, width)
        high = select(fails, word(mask, width), word(0, width)) if chosen else word(mask, width)
        anded, ored = x & low, x | high
        for value in {0, whole, mask, *random.Random(mask).sample(range(whole + 1), min(3, whole + 1))}:
            for failed in (False, True):
                k = encoder.k
                asked = k.Solver()
                expression = encoder([x, fails, anded, ored])
                through, over = (mask, mask) if failed or not chosen else (whole, 0)
                asked.add(expression[0] == value, expression[1] == failed)
                asked.add(k.Or(expression[2] != (value & through), expression[3] != (value | over)))
                assert str(asked.check()) == "unsat", (mask, value, failed)


def test_a_choice_that_the_solver_does_not_show_is_no_mask() -> None:
    """A term that has been bound to something else stands for that, whatever it was made of."""
    fails, x = variable("fails", BIT), variable("x", uint(4))
    assert isinstance(x, UInt) and isinstance(fails, Bit)
    choice, mixed = select(fails, word(3, 4), word(15, 4)), select(fails, word(3, 4), x)
    encoder = Encoder("z3", True)
    shown, other = encoder([choice, mixed])
    assert of_constants(choice, shown)
    assert not of_constants(mixed, other) and not of_constants(choice, encoder.k.Int("bound"))
    encoder.bind(choice, encoder.k.Int("bound"))
    (anded,) = encoder([x & choice])
    asked = encoder.k.Solver()
    asked.add(encoder.k.Int("bound") == 5, encoder.k.Int("x") == 15, anded != 5)
    assert str(asked.check()) == "unsat"

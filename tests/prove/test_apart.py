"""Questions in a process of their own: answered, ended when time is up, and never waited for longer."""

from __future__ import annotations

import os
import time
from typing import Any

import pytest

from safety.prove.apart import answered_apart
from safety.prove.solve import COVERINGS, JUSTIFIED, SAT, UNKNOWN, UNSAT, Solver
from safety.terms import real
from safety.terms.graph import REAL, variable
from safety.terms.smt import Encoder


def test_an_answer_comes_back() -> None:
    assert answered_apart(lambda: "unsat", 10) == "unsat"


def test_what_does_not_end_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    copies: list[int] = []
    fork = os.fork

    def noted() -> int:
        copies.append(fork())
        return copies[-1]

    def for_ever() -> str:
        time.sleep(600)
        return "unsat"

    monkeypatch.setattr(os, "fork", noted)
    assert answered_apart(for_ever, 0.2) == ""
    with pytest.raises(ChildProcessError):
        os.waitpid(copies[0], os.WNOHANG)  # nothing is left behind


def test_what_breaks_down_has_not_answered() -> None:
    assert answered_apart(lambda: os._exit(3), 10) == ""


def test_cvc5_on_reals_is_asked_apart_and_a_solver_that_hangs_says_unknown() -> None:
    encoder = Encoder("cvc5", integers=True)
    x = variable("x", REAL)
    asked = Solver("cvc5", encoder.k, 0.2, real=True)
    asked.add(encoder([x * x < real(0)])[0])
    assert asked.apart and asked.check() == UNSAT

    class Hangs:
        def assertions(self) -> list[Any]:
            time.sleep(600)
            return []

    asked.raw = Hangs()
    assert (asked.check(), asked.why) == (UNKNOWN, "no answer in 0.2 s")


@pytest.mark.parametrize("refused", [COVERINGS, JUSTIFIED])
def test_where_one_way_of_cvc5_with_reals_has_no_answer_the_other_gives_it(
    refused: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    encoder = Encoder("cvc5", integers=True)
    x = variable("x", REAL)
    asked = Solver("cvc5", encoder.k, 5, real=True)
    asked.add(encoder([x * x < real(0)])[0])
    answered = Solver._asked_with
    monkeypatch.setattr(Solver, "_asked_with", lambda self, way: "" if way is refused else answered(self, way))
    assert asked.check() == UNSAT
    asked.raw = encoder.k.SolverFor("QF_NRA")
    asked.add(encoder([x * x <= real(0)])[0])
    assert asked.check() == SAT

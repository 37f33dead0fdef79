"""What solvers may answer, or not: agreement, silence, contradiction, breakdown, and answers that come late."""

from __future__ import annotations

from typing import Annotated, Any

import pytest

from safety.model import Model, power_up
from safety.prove import induction
from safety.prove.claims import (
    BITS,
    BOUNDED,
    INTEGERS,
    PROVED,
    REFUTED,
    UNDECIDED,
    Scenario,
    Seen,
)
from safety.prove.solve import Disagreement, Solver
from safety.system import ANY
from safety.terms import Bit, Int, smt
from tests.prove.small import below_sixteen, passed_in_time, verdict, with_no_search_for_proofs


def silent(monkeypatch: pytest.MonkeyPatch, solver: str, label: str, result: str = "unknown") -> None:
    """A solver that says `result` to one obligation."""
    ask = induction.ask

    def patched(problem: Any, one: Any, name: str, *rest: Any) -> induction.Reply:
        if name == solver and label in one.label:
            return induction.Reply(result, {}, "out of time")
        return ask(problem, one, name, *rest)

    monkeypatch.setattr(induction, "ask", patched)


def test_agreement_is_on_every_obligation(monkeypatch: pytest.MonkeyPatch) -> None:
    assert verdict(below_sixteen, lemmas=[passed_in_time]).agreed_by == ["z3", "cvc5"]
    silent(monkeypatch, "cvc5", "is kept by a step")
    found = verdict(below_sixteen, lemmas=[passed_in_time])
    assert (found.verdict, found.agreed_by) == (PROVED, ["z3"])
    assert "one solver only, z3; cvc5 left open lemma 'passed in time' is kept by a step (out of time)" in found.why


def test_no_solver_may_agree_to_all_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    silent(monkeypatch, "cvc5", "is kept by a step")
    silent(monkeypatch, "z3", "power-up")
    found = verdict(below_sixteen, lemmas=[passed_in_time])
    assert (found.verdict, found.agreed_by) == (PROVED, [])
    assert "no single solver for all obligations" in found.why


def test_what_both_leave_open_is_not_proved(monkeypatch: pytest.MonkeyPatch) -> None:
    silent(monkeypatch, "cvc5", "property")
    silent(monkeypatch, "z3", "property")
    found = with_no_search_for_proofs(below_sixteen)
    assert (found.verdict, found.agreed_by) == (BOUNDED, ["z3"])


@pytest.mark.parametrize("liar", ["z3", "cvc5"])
def test_solvers_that_contradict_stop_everything(monkeypatch: pytest.MonkeyPatch, liar: str) -> None:
    silent(monkeypatch, liar, "property", "sat")
    with pytest.raises(Disagreement, match="the property follows"):
        verdict(below_sixteen)


def test_a_missing_solver_confirms_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    module = smt.solver_module

    def only_z3(name: str) -> Any:
        if name == "cvc5":
            raise ModuleNotFoundError("No module named 'cvc5'")
        return module(name)

    monkeypatch.setattr(smt, "solver_module", only_z3)
    found = verdict(below_sixteen, lemmas=[passed_in_time])
    assert (found.verdict, found.agreed_by) == (PROVED, ["z3"])
    assert "cvc5 left open lemma 'passed in time' at power-up (ModuleNotFoundError" in found.why


def test_a_solver_that_crashes_confirms_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    import z3

    def crash(self: Any, *_: Any) -> Any:
        raise z3.Z3Exception("out of memory")

    monkeypatch.setattr(z3.Solver, "check", crash)
    found = with_no_search_for_proofs(below_sixteen)
    assert (found.verdict, found.agreed_by) == (UNDECIDED, [])  # cvc5 proves it, the premise could not be shown
    found = verdict(below_sixteen, witness=Scenario(1))
    assert (found.verdict, found.agreed_by) == (PROVED, ["cvc5"])
    assert "out of memory" in found.why


def late(monkeypatch: pytest.MonkeyPatch, first: int) -> None:
    """From the question of that number on, bounded search gets no answer."""
    check, asked_so_far = Solver.check, [0]

    def patched(self: Solver) -> str:
        asked_so_far[0] += self.finite
        return "unknown" if self.finite and asked_so_far[0] > first else check(self)

    monkeypatch.setattr(Solver, "check", patched)


def test_a_search_that_stops_early_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    found = verdict(lambda s: s.n < 13, expect=BOUNDED, witness=Scenario(1))
    assert (found.verdict, found.steps, found.as_expected) == (BOUNDED, 12, True)
    late(monkeypatch, 3)
    found = verdict(lambda s: s.n < 13, expect=BOUNDED, witness=Scenario(1))
    assert (found.verdict, found.steps, found.as_expected) == (BOUNDED, 3, False)
    assert "no answer at step 3" in found.why


def test_a_counterexample_found_in_time_stays_one(monkeypatch: pytest.MonkeyPatch) -> None:
    late(monkeypatch, 4)  # the answer is there, making it small gets none
    found = verdict(lambda s: s.n < 3, expect=REFUTED)
    assert (found.verdict, found.steps) == (REFUTED, 4)


def test_a_proof_has_no_bound() -> None:
    found = verdict(below_sixteen, expect=REFUTED)
    assert (found.verdict, found.steps, found.as_expected) == (PROVED, None, False)


def test_ranges_are_told_to_the_solver(monkeypatch: pytest.MonkeyPatch) -> None:
    class Bounded(Model, event="tick"):
        """Holds a number from 3 to 9."""

        n: Annotated[Int, (3, 9)] = power_up(ANY)

        def step(self, m: Annotated[Int, (-2, 5)]) -> Bounded:
            return Bounded(n=(self.n + m).clip(3, 9))

    def in_range(s: Seen) -> Bit:
        return (s.n >= 3) & (s.n - s.m < 12)

    for arithmetic in (INTEGERS, BITS):
        assert verdict(in_range, Bounded, arithmetic=arithmetic).verdict == PROVED
        assert verdict(lambda s: s.n - s.m < 11, Bounded, arithmetic=arithmetic, expect=REFUTED).verdict == REFUTED
    monkeypatch.setattr(Solver, "add_ranges", lambda self, unrolling: None)
    with pytest.raises(Exception, match="not a value of int"):
        verdict(in_range, Bounded)

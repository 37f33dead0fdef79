"""What a proof does with claims that say nothing, assumptions that cannot be met, and solvers that fail it."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import pytest

from safety.commands.evaluate import without_result
from safety.commands.selection import Item
from safety.model import Model, assume, power_up
from safety.prove.claims import BITS, BOUNDED, PROVED, REFUTED, UNDECIDED, VACUOUS, Scenario, Seen
from safety.prove.prove import Limits, prove
from safety.prove.solve import Solver
from safety.system import ModelError
from safety.terms import U4, Bit, bit, implies, word
from safety.terms.smt import SolverMissingError, solver_module
from tests.prove.small import asked, below_sixteen, verdict, with_no_search_for_proofs

# --- claims that say nothing -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("formula", "said"),
    [
        (lambda s: word(3, 4) <= 5, "names no signal: it says True whatever the model does"),
        (lambda s: bit(False), "names no signal: it says False whatever the model does"),
        (lambda s: s.nn < 5, "has no signal 'nn'; did you mean n"),
        (lambda s: s.n, "a claim returns a Bit"),
        (lambda s: True, "a claim returns a Bit"),
        (lambda s: None, "a claim returns a Bit"),
    ],
)
def test_a_claim_that_says_nothing_is_refused(formula: Any, said: str) -> None:
    with pytest.raises(ModelError, match=said) as refused:
        verdict(formula)
    assert refused.value.exit_code == 2


def test_a_truth_about_any_model_is_told_as_such() -> None:
    assert "it says nothing about this one" in verdict(lambda s: s.n.int() < 16).why


# --- assumptions that cannot be met ----------------------------------------------------------------------------------


@pytest.mark.parametrize("expect", [PROVED, REFUTED, BOUNDED, VACUOUS])
@pytest.mark.parametrize(
    "changes",
    [
        {"given": lambda s: s.go & ~s.go},
        {"given": lambda s: s.n > 20},
        {"given": lambda s: s.n.int() < 0},
        {"start": lambda s: s.n == 3},
        {"start": lambda s: s.n == 3, "anywhere": True, "given": lambda s: s.n == 4},
    ],
)
def test_contradictory_assumptions_are_vacuous_whatever_is_expected(expect: str, changes: dict[str, Any]) -> None:
    for formula in (below_sixteen, lambda s: s.high & ~s.high):
        found = verdict(formula, expect=expect, **changes)
        assert (found.verdict, found.counterexample) == (VACUOUS, None)
        assert "the assumptions contradict one another: no run starts" in found.why
        assert found.agreed_by == ["z3", "cvc5"]
        assert found.as_expected == (expect == VACUOUS)


class Held(Model, event="tick"):
    """A model whose own assumption cannot be met."""

    n: U4 = power_up(0)

    def step(self, go: Bit) -> tuple[Held, Bit]:
        assume("both", go & ~go)
        return Held(n=self.n), go


def test_a_model_that_assumes_too_much_proves_nothing() -> None:
    assert verdict(lambda s: s.n == 5, Held).verdict == VACUOUS


def test_a_scenario_that_breaks_the_assumptions_refutes_nothing() -> None:
    with pytest.raises(ModelError, match="breaks an assumption of the claim at step 0"):
        verdict(lambda s: ~s.high, expect=REFUTED, given=lambda s: ~s.go, scenario=Scenario(12, {"go": True}))


# --- solvers that are not there, break down, or run out of memory ----------------------------------------------------


@pytest.fixture
def missing(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    def switch(name: str) -> None:
        for module in [m for m in sys.modules if m.partition(".")[0] == name]:
            monkeypatch.delitem(sys.modules, module)
        monkeypatch.setitem(sys.modules, name, None)

    return switch


def test_without_cvc5_a_proof_says_that_one_solver_made_it(missing: Callable[[str], None]) -> None:
    missing("cvc5")
    found = verdict(lambda s: implies(s.on, s.on | s.high))
    assert (found.verdict, found.agreed_by) == (PROVED, ["z3"])
    assert "confirmed by one solver only, z3; cvc5 left open" in found.why
    assert "the solver cvc5 cannot be loaded" in found.why and "pip install cvc5" in found.why
    assert verdict(lambda s: ~s.high, expect=REFUTED).verdict == REFUTED


def test_without_z3_it_says_so_and_decides_nothing(missing: Callable[[str], None]) -> None:
    missing("z3")
    with pytest.raises(SolverMissingError, match="pip install z3-solver") as told:
        verdict(below_sixteen)
    entry = without_result(Item("claims", "x", expect=PROVED), told.value)
    assert entry["verdict"] == UNDECIDED and "error" not in entry
    assert "the solver z3 cannot be loaded" in entry["why"]


def test_a_solver_of_another_name_is_refused() -> None:
    with pytest.raises(TypeError, match="write one of z3, cvc5"):
        solver_module("yices")


def broken(monkeypatch: pytest.MonkeyPatch, names: tuple[str, ...], error: Exception) -> None:
    check = Solver.check

    class Raw:
        def __init__(self, real: Any) -> None:
            self.real = real

        def __getattr__(self, name: str) -> Any:
            if name == "check":
                raise error
            return getattr(self.real, name)

    def failing(self: Solver) -> str:
        if self.name in names:
            self.raw = Raw(self.raw)
        return check(self)

    monkeypatch.setattr(Solver, "check", failing)


@pytest.mark.parametrize("error", [MemoryError(), RuntimeError("segmentation"), OSError("no libz3")])
def test_a_solver_that_breaks_down_leaves_the_proof_to_the_other(
    monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    broken(monkeypatch, ("cvc5",), error)
    found = verdict(below_sixteen)
    assert (found.verdict, found.agreed_by) == (PROVED, ["z3"])
    assert type(error).__name__ in found.why


@pytest.mark.parametrize("expect", [PROVED, REFUTED])
def test_when_all_solvers_break_down_nothing_is_decided(monkeypatch: pytest.MonkeyPatch, expect: str) -> None:
    broken(monkeypatch, ("z3", "cvc5"), MemoryError("out of memory"))
    for formula in (below_sixteen, lambda s: ~s.high, lambda s: implies(s.n.int() > 20, s.high)):
        found = with_no_search_for_proofs(formula, expect=expect)
        assert (found.verdict, found.counterexample) == (UNDECIDED, None)
        assert "out of memory" in found.why


def test_without_a_solver_simulation_still_refutes(monkeypatch: pytest.MonkeyPatch) -> None:
    broken(monkeypatch, ("z3", "cvc5"), MemoryError("out of memory"))
    found = verdict(lambda s: ~s.high, expect=REFUTED)
    assert (found.verdict, found.steps) == (REFUTED, 9)


def test_z3_without_memory_is_undecided_and_no_fault_of_ours(monkeypatch: pytest.MonkeyPatch) -> None:
    import z3

    def full(*_: Any, **__: Any) -> Any:
        raise z3.Z3Exception(b"out of memory")

    monkeypatch.setattr("safety.prove.search.Solver", full)
    with pytest.raises(z3.Z3Exception) as raised:
        prove(asked(lambda s: ~s.high, expect=REFUTED, arithmetic=BITS), Limits(20))
    for section in ("claims", "trees"):
        entry = without_result(Item(section, "x", expect=REFUTED), raised.value)
        assert "error" not in entry
        assert "z3 broke down: out of memory; give -j 1" in (entry.get("why") or entry["note"])
    assert "the prover broke down: MemoryError" in without_result(Item("claims", "x"), MemoryError())["why"]


def test_any_other_error_is_still_ours() -> None:
    entry = without_result(Item("claims", "x"), ZeroDivisionError("division by zero"))
    assert entry["error"] == "ZeroDivisionError: division by zero"


def test_an_interrupt_is_never_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    broken(monkeypatch, ("z3",), KeyboardInterrupt())  # type: ignore[arg-type]
    with pytest.raises(KeyboardInterrupt):
        verdict(below_sixteen)


def test_a_claim_may_be_read_without_a_solver(missing: Callable[[str], None]) -> None:
    from safety.prove.prove import stated

    missing("z3")
    missing("cvc5")
    assert Seen(stated(asked(below_sixteen)).system).n.sort.width == 4

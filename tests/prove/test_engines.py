"""What each engine says of small equipment is what visiting all its states says, and what it proves is re-checked."""

from __future__ import annotations

import itertools
import os
import random
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from safety.model import Model, power_up
from safety.prove.claims import BITS, BOUNDED, INTEGERS, PROVED, REFUTED, Seen
from safety.prove.engines.engine import BOTH, NAMES, Budget, Result, engine, proved_by, with_lemmas_given
from safety.prove.engines.terms_of import NoTerm, conjuncts
from safety.prove.induction import by_induction
from safety.prove.problem import Problem, build_problem
from safety.prove.solve import UNKNOWN, Disagreement
from safety.system import ModelError
from safety.terms import U2, Bit, Term, bit, implies
from safety.terms.direct import evaluate
from safety.terms.graph import BIT, uint, variable
from safety.terms.smt import solver_module
from tests.prove import chance, naive, translated
from tests.prove.naive import Machine, TooLarge
from tests.prove.small import Lamps, asked, below_sixteen, passed_in_time

STEPS = 5
SEEDS = {"bounded": 30, "induction": 15, "spacer": 25, "pdr": 30, "smtbmc": 10}


def never_high(s: Seen) -> Bit:
    """False after nine steps."""
    return ~s.high


def budget(folder: Path, seconds: float = 20) -> Budget:
    return Budget(seconds, folder)


def run(name: str, problem: Problem, folder: Path, seconds: float = 20) -> Result:
    """An engine's result here, in this process; the test is skipped where its tool is missing."""
    one = engine(name)
    if missing := one.unavailable():
        pytest.skip(missing)
    return one.run(problem, budget(folder, seconds))


# --- against enumeration -------------------------------------------------------------------------------------------


def drawn(seed: int) -> tuple[Problem, naive.Truth] | None:
    """A random problem with the truth about it; None where there is no claim in it, or too many states."""
    rng = random.Random(seed)
    machine = Machine(chance.equipment(rng), chance.question(rng))
    arithmetic = rng.choice([INTEGERS, BITS])
    model = translated.model(machine.made)
    claim = translated.claim(machine.asked, model, expect=PROVED, steps=STEPS, induction=1, arithmetic=arithmetic)
    try:
        return build_problem(claim), naive.truth(machine)
    except (ModelError, TooLarge):
        return None


def wrong(found: Result, truth: naive.Truth) -> str:
    """What is wrong with a result; nothing where it is right."""
    if found.verdict == PROVED and truth.broken is not None:
        return f"it breaks at step {truth.broken}"
    if found.verdict == BOUNDED and truth.broken is not None and truth.broken < (found.steps or 0):
        return f"it breaks at step {truth.broken}"
    if found.verdict == REFUTED:
        if truth.broken is None:
            return "it never breaks"
        if found.trace is None or found.trace["claim.holds"][-1] or not all(found.trace["claim.given"]):
            return "its run breaks nothing"
        if len(found.trace) <= truth.broken or len(found.trace) != found.steps:
            return f"the shortest run has {truth.broken + 1} steps"
    return ""


def results(name: str, seeds: range, folder: Path) -> Counter[tuple[str, int]]:
    """How often each verdict was given, by how many who agree."""
    told: Counter[tuple[str, int]] = Counter()
    for seed in seeds:
        if (made := drawn(seed)) is None:
            continue
        problem, truth = made
        found = run(name, problem, folder, 1 if name == "induction" else 5)
        assert not (said := wrong(found, truth)), f"{name}, seed {seed}: {found.verdict} {found.steps}: {said}"
        assert found.verdict != PROVED or name in found.agreed_by or set(found.agreed_by) == set(BOTH)
        if found.invariant is not None:
            again = by_induction(replace(problem, lemmas=found.invariant), 0, True, 10, ("cvc5",))
            assert again.proved, f"{name}, seed {seed}: {again.failed}"
        told[found.verdict, len(found.agreed_by)] += 1
    return told


@pytest.mark.parametrize("name", NAMES)
def test_no_wrong_result(name: str, tmp_path: Path) -> None:
    told = results(name, range(SEEDS[name]), tmp_path)
    assert told.total() > SEEDS[name] * 0.8
    conclusive = sum(n for (verdict, _), n in told.items() if verdict in (PROVED, REFUTED))
    assert conclusive > told.total() * (0.25 if name in ("bounded", "induction") else 0.5)


@pytest.mark.parametrize("name", ["spacer", "pdr"])
def test_reachability_decides_and_its_invariants_are_confirmed(name: str, tmp_path: Path) -> None:
    told = results(name, range(100, 120), tmp_path)
    assert told[PROVED, 3] > 4 and told[PROVED, 3] + told[REFUTED, 1] + told[REFUTED, 2] >= told.total() * 0.9


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_no_wrong_result_among_hundreds(name: str, tmp_path: Path) -> None:
    results(name, range(1000, 1400), tmp_path)


@pytest.mark.parametrize("name", NAMES)
def test_a_run_that_breaks_the_claim_is_replayed(name: str, tmp_path: Path) -> None:
    found = run(name, build_problem(asked(never_high)), tmp_path)
    if name == "induction":
        assert (found.verdict, found.trace) == (UNKNOWN, None) and "induction of depth 20 fails" in found.why
    else:
        assert found.verdict == REFUTED and found.trace is not None and found.steps == 9
        assert found.trace["claim.holds"] == [True] * 8 + [False]


class Clock(Model, event="tick"):
    """Has no inputs, and no choice at power-up."""

    n: U2 = power_up(0)

    def step(self) -> tuple[Clock, Lamps]:
        return Clock(n=(self.n + 1).low(2)), Lamps(on=self.n == 3, high=self.n.bit(1))


@pytest.mark.parametrize("name", [n for n in NAMES if n != "induction"])
def test_a_run_without_any_choice_is_replayed_too(name: str, tmp_path: Path) -> None:
    found = run(name, build_problem(asked(lambda s: ~s.on, Clock)), tmp_path)
    assert (found.verdict, found.steps) == (REFUTED, 4)


@pytest.mark.parametrize("name", [n for n in NAMES if n != "bounded"])
def test_what_says_nothing_is_proved_too(name: str, tmp_path: Path) -> None:
    found = run(name, replace(build_problem(asked(never_high)), holds=bit(True)), tmp_path)
    assert found.verdict == PROVED and set(BOTH) <= set(found.agreed_by)


@pytest.mark.parametrize("name", [n for n in NAMES if n != "bounded"])
def test_what_is_true_is_proved_and_confirmed_by_both_solvers(name: str, tmp_path: Path) -> None:
    found = run(name, build_problem(asked(passed_in_time)), tmp_path)
    assert found.verdict == PROVED and set(BOTH) <= set(found.agreed_by)


def test_unknown_engine() -> None:
    with pytest.raises(ModelError, match="there is no engine 'spacers'; did you mean spacer"):
        engine("spacers")


# --- invariants ----------------------------------------------------------------------------------------------------


def test_an_invariant_that_is_none_does_not_count(tmp_path: Path) -> None:
    problem = build_problem(asked(passed_in_time))
    state = problem.system.state
    too_weak = {"w": bit(True)}
    not_kept = {"n": ~state["passed"].var}  # type: ignore[operator]
    for invariants, why in ([], "it gave none"), ([too_weak], "the property follows"), ([not_kept], "kept by a step"):
        found = proved_by("tool", problem, invariants, True, budget(tmp_path), "it gave none")
        assert (found.agreed_by, found.invariant) == (("tool",), None)
        assert found.why.startswith("rests on tool alone") and why in found.why
    right = {"r": problem.holds}
    found = proved_by("tool", problem, [not_kept, right], True, budget(tmp_path))
    assert (found.agreed_by, found.invariant, found.why) == ((*BOTH, "tool"), right, "")


def test_lemmas_are_given_only_when_they_are_proved(tmp_path: Path) -> None:
    problem = build_problem(asked(lambda s: implies(s.n >= 8, s.on), lemmas=[passed_in_time]))
    helped = with_lemmas_given(problem, 10)
    assert helped is not None and helped.lemmas == {} and helped.given is not problem.given
    found = run("spacer", helped, tmp_path)
    assert found.verdict == PROVED and found.invariant is not None
    assert by_induction(replace(problem, lemmas=problem.lemmas | found.invariant), 0, True, 10, BOTH).proved
    assert with_lemmas_given(build_problem(asked(below_sixteen, lemmas=[lambda s: s.n < 9])), 10) is None


X, Y, WIRE = variable("x", uint(2)), variable("y", uint(2)), variable("wire", BIT)


def test_a_solvers_formula_means_the_same_as_a_term() -> None:
    k = solver_module("z3")
    x, y, wire = k.Var(0, k.IntSort()), k.Var(1, k.IntSort()), k.Var(2, k.BoolSort())
    formulas = [
        x + 2 * y <= 5, x - y < 1, -x + 3 >= y, x * y > 2, x - 2 == y, k.Not(x == y), wire == (x > 1),
        k.Xor(wire, x < y), k.Implies(wire, x == 3), k.If(wire, x, y) >= 2, k.Or(x % 2 == 1, (x + y) / 2 >= 2),
        k.If(x > y, wire, y == 0), x + -1 * y + -2 <= 0, k.Or(k.BoolVal(False), wire),
        k.And(wire, k.BoolVal(True), x + y + 1 != 3),
    ]  # fmt: skip
    leaves: dict[int, Term] = {0: X, 1: Y, 2: WIRE}
    for formula in formulas:
        terms = conjuncts(k, formula, leaves)
        for a, b, c in itertools.product(range(4), range(4), [False, True]):
            exact = k.simplify(k.substitute_vars(formula, k.IntVal(a), k.IntVal(b), k.BoolVal(c)))
            told = all(evaluate(terms, {X: a, Y: b, WIRE: c}))
            assert told is k.is_true(exact), (formula, a, b, c)


def test_a_formula_without_a_term_is_refused() -> None:
    k = solver_module("z3")
    x, n = k.Var(0, k.IntSort()), k.Int("n")
    f = k.Function("f", k.IntSort(), k.BoolSort())
    for formula in k.Exists([n], n > x), f(x), x % (x + 1) == 0, (x - 1) % 2 == 0, k.ToReal(x) > 0:
        with pytest.raises(NoTerm, match="which no term does"):
            conjuncts(k, formula, {0: X})


# --- tools that are missing, or wrong ------------------------------------------------------------------------------


def fake(folder: Path, monkeypatch: pytest.MonkeyPatch, name: str, script: str) -> None:
    """A program of this name, before any other on the path."""
    if os.name != "posix":
        pytest.skip("a script with a first line that names its interpreter is for POSIX")
    (folder / "bin").mkdir(exist_ok=True)
    (folder / "bin" / name).write_text(f"#!/bin/sh\n{script}\n")
    (folder / "bin" / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder / 'bin'}{os.pathsep}{os.defpath}")


@pytest.mark.parametrize(("name", "package"), [("pdr", "berkeley-abc"), ("smtbmc", "yosys")])
def test_a_missing_tool_is_named(name: str, package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert f"apt install {package}" in (engine(name).unavailable() or "")


CUBES = "printf '.i 1\\n.o 1\\n.ilb r2\\n.ob inv\\n0 1\\n.e\\n' > invariant.pla; echo 'Property proved.'"
NO_RUN = "printf 'i0@0=0\\ni0@1=1\\n' > run.txt; echo 'Output 0 was asserted in frame 1.'"


@pytest.mark.parametrize(
    ("script", "why"),
    [
        (CUBES, "its invariant was not confirmed"),
        (f"{CUBES}; rm invariant.pla; touch invariant.pla", "its invariant was not confirmed"),
        (f"{CUBES}; rm invariant.pla", "it wrote no invariant"),
    ],
)
def test_a_tool_that_proves_what_is_false_stands_alone(
    script: str, why: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake(tmp_path, monkeypatch, "berkeley-abc", script)
    found = engine("pdr").run(build_problem(asked(never_high)), budget(tmp_path))
    assert (found.verdict, found.agreed_by, found.invariant) == (PROVED, ("pdr",), None)
    assert f"rests on pdr alone: {why}" in found.why


def test_an_induction_that_proves_what_is_false_stands_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake(tmp_path, monkeypatch, "yosys", "touch circuit.smt2")
    fake(tmp_path, monkeypatch, "yosys-smtbmc", "echo 'Trying induction in step 18..'; echo 'Status: PASSED'")
    found = engine("smtbmc").run(build_problem(asked(never_high)), budget(tmp_path))
    assert (found.verdict, found.agreed_by, found.invariant) == (PROVED, ("smtbmc",), None)
    assert "rests on smtbmc alone: its induction of depth 2 was not confirmed" in found.why


def test_a_run_of_a_tool_that_breaks_nothing_is_a_disagreement(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake(tmp_path, monkeypatch, "berkeley-abc", NO_RUN)
    with pytest.raises(Disagreement, match="does not do on the Python reading what it should"):
        engine("pdr").run(build_problem(asked(never_high)), budget(tmp_path))


def test_a_tool_that_hangs_is_cut_off(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake(tmp_path, monkeypatch, "berkeley-abc", "exec /bin/sleep 60")
    found = engine("pdr").run(build_problem(asked(never_high)), budget(tmp_path, 0.5))
    assert (found.verdict, found.why.split(" after ")[0]) == (UNKNOWN, "no answer: it was cut off")


def test_a_tool_that_says_nothing_of_use_leaves_it_open(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake(tmp_path, monkeypatch, "berkeley-abc", "echo 'what is read_aiger?'")
    found = engine("pdr").run(build_problem(asked(never_high)), budget(tmp_path))
    assert (found.verdict, found.why) == (UNKNOWN, "no answer: what is read_aiger?")

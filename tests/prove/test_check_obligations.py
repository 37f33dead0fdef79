"""The stand-alone checker's obligations, as texts and clauses, against the toolkit's own, and bugs planted in them."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

import pytest

from safety.prove import check
from safety.prove.certificate import described
from safety.prove.claims import BITS, INTEGERS, PROVED
from safety.prove.induction import ask, invariance, property_obligations
from safety.prove.lrat import NoProof, refutation
from safety.prove.problem import Problem, build_problem
from safety.system import ANY, ModelError, State
from safety.terms import select
from safety.terms.graph import BIT, integer, uint, variable
from tests.prove import chance, translated
from tests.prove.certified import problem_of
from tests.prove.naive import Machine


def drawn(seed: int) -> Problem | None:
    """A random problem with faults, watching registers and lemmas that need not hold."""
    rng = random.Random(seed)
    machine = Machine(chance.equipment(rng), chance.question(rng))
    arithmetic = rng.choice([INTEGERS, BITS])
    model = translated.model(machine.made)
    claim = translated.claim(machine.asked, model, expect=PROVED, steps=3, induction=1, arithmetic=arithmetic)
    try:
        return build_problem(claim)
    except ModelError as error:
        assert "names no signal" in str(error)
        return None


def unlike(problem: Problem, depth: int, solver: str) -> list[str]:
    """The obligations of an induction that the checker's text or clauses judge otherwise than the toolkit."""
    c = check.read(described(problem, depth))
    ours = [*invariance(problem), *property_obligations(problem, depth)]
    theirs = check.obligations(c)
    found = [] if [one.label for one in ours] == [one.label for one in theirs] else ["other obligations"]
    for one, other in zip(ours, theirs, strict=True):
        expected = ask(problem, one, "z3", c.integers, 20).result
        clauses = check.clauses(c, other)
        assert clauses is not None
        try:
            check.check_lrat(clauses, refutation(clauses, 20))
            answer = "unsat"
        except NoProof as none:
            answer = "sat" if none.satisfiable else str(none)
        if answer != expected:
            found.append(f"{one.label}: the clauses are {answer}, not {expected}")
        if (said := check.ask(solver, check.smt(c, other), 20)) != expected:
            found.append(f"{one.label}: the text is {said}, not {expected}")
    return found


def judged(seeds: range) -> tuple[int, list[str]]:
    """How many problems were judged, and what differed."""
    problems = [(seed, problem) for seed in seeds if (problem := drawn(seed))]
    wrong = [f"{seed}: {text}" for seed, p in problems for text in unlike(p, seed % 3, check.SOLVERS[seed % 2])]
    return len(problems), wrong


def test_obligations_of_random_problems_are_judged_as_by_the_toolkit() -> None:
    count, wrong = judged(range(8))
    assert count > 5 and wrong == []


@pytest.mark.slow
def test_obligations_of_many_random_problems_are_judged_as_by_the_toolkit() -> None:
    count, wrong = judged(range(1000, 1400))
    assert count > 300 and wrong == []


def _no_ranges(right: Any) -> Any:
    def leaf(g: Any, *given: Any) -> Any:
        value, g.ranges = right(g, *given), []
        return value

    return leaf


def climbing(power_up: Any, start: Any, lemma: int, holds: Callable[[Any, Any], Any]) -> Problem:
    """A register that climbs to 9 while `up`; `calm` is given."""
    n: Any = variable("n", uint(4))
    up: Any = variable("up", BIT)
    calm: Any = variable("calm", BIT)
    after = select(up & (n < 9), (n + 1).low(4), n)
    return problem_of([State(n, after, power_up)], [up, calm], holds(n, calm), {"low": n <= lemma}, calm, start(n))


DESIGNED = [
    climbing(ANY, lambda n: n < 5, 9, lambda n, calm: (n <= 9) & calm),
    climbing(0, lambda n: n == n, 5, lambda n, calm: n <= 5),
    climbing(9, lambda n: n == n, 9, lambda n, calm: n <= 8),
]


def test_designed_problems_are_judged_as_by_the_toolkit() -> None:
    assert [unlike(problem, depth, "cvc5") for problem in DESIGNED for depth in (0, 2)] == [[]] * 6


OBLIGATION_BUGS: dict[str, Callable[[Any], None]] = {
    "the start is not assumed": lambda m: _of_obligations(
        m, lambda o, c: o._replace(assumed=o.assumed[o.anywhere < 1 :])
    ),
    "nothing is assumed": lambda m: _of_obligations(m, lambda o, c: o._replace(assumed=())),
    "every obligation starts at power-up": lambda m: _of_obligations(m, lambda o, c: o._replace(anywhere=False)),
    "lemmas are shown before the step": lambda m: _of_obligations(
        m, lambda o, c: o._replace(step=0) if "kept" in o.label else o
    ),
    "the given is forgotten": lambda m: _of_obligations(
        m, lambda o, c: o._replace(assumed=tuple(a for a in o.assumed if a[1] != c.given))
    ),
    "the property is shown of itself": lambda m: _of_obligations(
        m, lambda o, c: o._replace(assumed=(*o.assumed, (o.step, o.shown)))
    ),
}


def _of_obligations(m: pytest.MonkeyPatch, change: Callable[..., Any]) -> None:
    right = check.obligations
    m.setattr(check, "obligations", lambda c: [change(one, c) for one in right(c)])


@pytest.mark.parametrize("bug", OBLIGATION_BUGS)
def test_a_bug_planted_in_the_obligations_is_found(bug: str, monkeypatch: pytest.MonkeyPatch) -> None:
    OBLIGATION_BUGS[bug](monkeypatch)
    assert any(unlike(problem, 1, "z3") for problem in DESIGNED)


def test_ranges_of_integers_are_assumed() -> None:
    n: Any = variable("n", integer(3, 9))
    problem = problem_of([State(n, n, 3)], [], n >= 3)
    assert unlike(problem, 0, "z3") == [] and unlike(problem_of([State(n, n, 3)], [], n >= 4), 0, "z3") == []


def test_forgotten_ranges_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    n: Any = variable("n", integer(3, 9))
    monkeypatch.setattr(check._Gates, "leaf", _no_ranges(check._Gates.leaf))
    assert len(unlike(problem_of([State(n, n, 3)], [], n >= 3), 0, "z3")) == 1

"""What is tried for a claim, in which order, and what counts: nothing rests on how an answer was found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from safety.model import Model, power_up
from safety.prove import falsify, prove, search, solve
from safety.prove.claims import BOUNDED, PROVED, REFUTED, UNDECIDED, VACUOUS, Claim, Scenario, Seen, persists
from safety.prove.engines.engine import Result
from safety.prove.induction import by_induction
from safety.prove.problem import Problem, build_problem
from safety.terms import U8, Bit, implies, select
from tests.prove.small import Counter, asked

TO_100 = Scenario(102, {"go": True})
ALONE = prove.Limits(20, synthesis=0, simulation=0, portfolio=0)


class Twins(Model, event="tick"):
    """Two counters that count alike, the second by 2 in a register of its own."""

    a: U8 = power_up(0)
    b: U8 = power_up(0)

    def step(self, go: Bit) -> Twins:
        end = self.a == 100
        return Twins(
            a=select(go, select(end, 0, (self.a + 1).low(8)), self.a),
            b=select(go, select(end, 0, (self.b + 2).low(8)), self.b),
        )


def twins_agree(s: Seen) -> Bit:
    """Where the first is full, the second is at 200: true, and not inductive by itself."""
    return implies(s.a == 100, s.b == 200)


def late(s: Seen) -> Bit:
    """False after 9 steps of counting."""
    return ~s.high


def far(s: Seen) -> Bit:
    """False after 100 steps of counting."""
    return s.a != 100


def engines(monkeypatch: pytest.MonkeyPatch, answer: Callable[[Problem], Result]) -> list[Problem]:
    """Put this answer in place of the engines; the problems that they were asked about."""
    asked_of: list[Problem] = []

    def portfolio(problem: Problem, names: Any, **_: Any) -> list[Result]:
        asked_of.append(problem)
        return [answer(problem)]

    monkeypatch.setattr("safety.prove.engines.portfolio.portfolio", portfolio)
    return asked_of


def only_engines(**changes: Any) -> Any:
    return prove.Limits(20, synthesis=0, simulation=0, **({"portfolio": 30.0} | changes))


def test_an_engine_proves_what_is_left_open_and_its_invariant_is_proved_like_a_lemma() -> None:
    open_ = prove.prove(asked(twins_agree, Twins, steps=5, witness=TO_100), ALONE)
    assert open_.verdict in (BOUNDED, UNDECIDED)
    found = prove.prove(asked(twins_agree, Twins, steps=5, witness=TO_100), only_engines())
    assert (found.verdict, found.agreed_by, found.why) == (PROVED, ["z3", "cvc5"], "")
    assert found.problem is not None and found.found == tuple(found.problem.lemmas)
    assert "lemmas found by" in found.method
    arithmetic = "spacer" in found.method
    assert by_induction(found.problem, 0, arithmetic, 20, ("z3", "cvc5")).proved
    wrong = {name: lemma & (build_problem(asked(far, Twins)).holds) for name, lemma in found.problem.lemmas.items()}
    assert not by_induction(replace(found.problem, lemmas=wrong), 0, arithmetic, 20, ("z3", "cvc5")).proved


def test_the_word_of_an_engine_is_no_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    engines(monkeypatch, lambda _: Result("spacer", PROVED, agreed_by=("spacer",), why="it gave none"))
    found = prove.prove(asked(far, Twins, steps=5), only_engines())
    assert (found.verdict, found.agreed_by) == (BOUNDED, ["z3"])
    assert "spacer says that it is proved, which is not confirmed: it gave none" in found.why


def test_the_run_of_an_engine_is_run_again_and_made_shortest(monkeypatch: pytest.MonkeyPatch) -> None:
    def wandering(problem: Problem) -> Result:
        """Waits for five steps before it counts."""
        values = {("go", k): k >= 5 for k in range(14)}
        return Result("pdr", REFUTED, trace=search.replay(problem, values, 14, ~problem.holds))

    engines(monkeypatch, wandering)
    found = prove.prove(asked(late, steps=3, expect=PROVED), only_engines())
    assert (found.verdict, found.steps) == (REFUTED, 9)
    assert found.method == "pdr, made shortest by bounded search, replayed"
    monkeypatch.setattr(prove, "LONG", 5)
    found = prove.prove(asked(late, steps=3, expect=PROVED), only_engines())
    assert (found.verdict, found.steps, found.method) == (REFUTED, 14, "pdr, replayed")
    assert found.counterexample is not None and found.counterexample["go"][:6] == [False] * 5 + [True]


def test_a_run_of_an_engine_that_breaks_nothing_is_a_disagreement(monkeypatch: pytest.MonkeyPatch) -> None:
    def harmless(problem: Problem) -> Result:
        return Result("pdr", REFUTED, trace=search.replay(problem, {}, 4, problem.holds))

    engines(monkeypatch, harmless)
    with pytest.raises(solve.Disagreement):
        prove.prove(asked(late, steps=3, expect=PROVED), only_engines())


@pytest.mark.parametrize(("expect", "asks"), [(PROVED, 1), (REFUTED, 1), (BOUNDED, 0), (UNDECIDED, 0), (VACUOUS, 0)])
def test_engines_are_asked_where_a_proof_or_a_run_is_expected(
    expect: str, asks: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked_of = engines(monkeypatch, lambda _: Result("spacer"))
    found = prove.prove(asked(far, Twins, steps=3, expect=expect), only_engines())
    assert (found.verdict, len(asked_of)) == (BOUNDED, asks)
    assert ("spacer and pdr do not decide it" in found.why) == bool(asks)
    prove.prove(asked(far, Twins, steps=3, expect=expect), only_engines(portfolio=0))
    assert len(asked_of) == asks


def test_what_is_bounded_on_purpose_is_not_broken_beyond_its_bound() -> None:
    """Counting to 8 takes 8 steps: within 4 it does not happen, whatever simulation could find later."""
    found = prove.prove(asked(late, steps=4, expect=BOUNDED), prove.Limits(20, synthesis=0))
    assert (found.verdict, found.steps, found.as_expected) == (BOUNDED, 4, True)
    found = prove.prove(asked(late, steps=4, expect=PROVED), prove.Limits(20, synthesis=0))
    assert (found.verdict, found.steps) == (REFUTED, 9)


def test_short_runs_are_looked_at_before_lemmas(monkeypatch: pytest.MonkeyPatch) -> None:
    def unwanted(*_: Any) -> Any:
        raise AssertionError("lemmas were looked for")

    monkeypatch.setattr("safety.prove.synthesis.synthesise.synthesise", unwanted)
    assert prove.prove(asked(late, expect=PROVED)).verdict == REFUTED
    assert prove.prove(asked(far, Twins, expect=UNDECIDED)).verdict == REFUTED


def test_all_reasons_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    from safety.prove.synthesis.synthesise import Found

    def nothing(*_: Any) -> Found:
        return Found(why="no lemma was found")

    monkeypatch.setattr("safety.prove.synthesis.synthesise.synthesise", nothing)
    monkeypatch.setattr(falsify, "reach", lambda *_: None)
    engines(monkeypatch, lambda _: Result("spacer"))

    def after_long(s: Seen) -> Bit:
        """False, after more steps than are searched."""
        return implies(persists(s.go, ticks=90), s.b != 190)

    found = prove.prove(asked(after_long, Twins, steps=5))
    assert found.verdict == UNDECIDED
    for reason in ("induction fails: the property", "no lemma was found", "spacer and pdr do not", "was not reached"):
        assert reason in found.why


def test_a_premise_that_is_met_beyond_the_bound_bounds_nothing() -> None:
    def after_long(s: Seen) -> Bit:
        """Nothing is said before step 100."""
        return implies(s.a == 100, s.b >= 150)

    found = prove.prove(asked(after_long, Twins, steps=5, expect=BOUNDED), prove.Limits(20, synthesis=0))
    assert found.verdict == UNDECIDED
    assert "the search of 5 steps ends before the premise can happen (it was seen at step 100)" in found.why


@pytest.mark.parametrize(
    ("claim", "method"),
    [
        (asked(late, given=lambda s: s.n > 3), "no run starts"),
        (asked(late, given=lambda s: s.n > 3, induction=0, steps=4, expect=VACUOUS), "no run starts"),
        (asked(lambda s: implies(s.n.int() > 20, s.on)), "no run meets the premise"),
    ],
)
def test_a_vacuous_claim_names_the_proof_that_it_is(claim: Claim, method: str) -> None:
    found = prove.prove(claim, ALONE)
    assert (found.verdict, found.agreed_by) == (VACUOUS, ["z3", "cvc5"])
    assert found.method.startswith("induction of depth ") and found.method.endswith(method)


def test_a_condition_that_always_holds_can_be_watched() -> None:
    def always(s: Seen) -> Bit:
        """The age of what is always true grows with every step; the count does not need to."""
        return implies(persists(s.n.int() < 16, ticks=30), s.on)

    found = prove.prove(asked(always, steps=5), prove.Limits(20, synthesis=0, portfolio=0))
    assert found.verdict == REFUTED and found.steps == 30


def test_progress_is_told() -> None:
    said: list[str] = []
    prove.decide(build_problem(asked(late, Counter, steps=3, expect=REFUTED)), ALONE, said.append)
    assert said[:2] == ["bounded search", "induction"]

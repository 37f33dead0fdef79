"""Outcomes out of the cache: what comes back is what was found, and nothing that a wrong record says is believed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest

from safety.commands.recall import Recalled, key_of, recalled
from safety.prove import prove as provers
from safety.prove import search
from safety.prove.cache import Cache
from safety.prove.claims import REFUTED, UNDECIDED, Claim, Scenario
from safety.prove.prove import Limits, stated
from safety.terms import bit, implies
from tests.prove.small import asked, below_sixteen, passed_in_time
from tests.prove.test_cache import Set

LIMITS = Limits(20)


def again(cache: Cache, claim: Claim, limits: Limits = LIMITS, fresh: bool = False) -> Any:
    return recalled(cache, stated(claim), limits, fresh)


def both(cache: Cache, claim: Claim) -> tuple[Any, Any]:
    first, second = again(cache, claim), again(cache, claim)
    assert not first.cached
    return first.outcome, second


@pytest.fixture
def no_proof(monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    def switch() -> None:
        monkeypatch.setattr(provers, "_decide", lambda problem, limits, say: 1 / 0)

    return switch


@pytest.mark.parametrize(
    "claim",
    [
        asked(below_sixteen),
        asked(lambda s: ~s.high, expect=REFUTED),
        asked(lambda s: ~s.high, expect=REFUTED, scenario=Scenario(12, {"go": True})),
        asked(lambda s: s.n != 13, steps=4),
        asked(lambda s: implies(s.n.int() > 20, s.high)),
        asked(lambda s: s.high | ~s.high | (s.n == 3)),
        asked(lambda s: s.high, Set, settings={"limit": 12}),
    ],
)
def test_what_comes_back_is_what_was_found(cache: Cache, claim: Claim, no_proof: Callable[[], None]) -> None:
    from safety.prove.record import claim_entry

    first = again(cache, claim)
    no_proof()
    second = again(cache, claim)
    assert (first.cached, second.cached) == (False, True)
    assert claim_entry(second.outcome) == claim_entry(first.outcome)
    runs = [found.outcome.counterexample for found in (first, second)]
    assert (runs[0] is None) == (runs[1] is None)
    if runs[0] and runs[1]:
        assert runs[0].columns == runs[1].columns and runs[0].vcd() == runs[1].vcd()


def test_a_shared_record_is_told_in_the_words_of_each_claim(cache: Cache) -> None:
    both(cache, asked(below_sixteen))
    other = again(cache, asked(below_sixteen, id="another.claim", statement="in other words"))
    assert other.cached and other.outcome.claim.id == "another.claim"


def test_lemmas_that_were_found_come_back_as_terms(cache: Cache, monkeypatch: pytest.MonkeyPatch) -> None:
    claim = asked(lambda s: implies(s.high, s.passed))
    lemmas = stated(replace(claim, lemmas=(passed_in_time, lambda s: s.n.low(2).int() + Fraction(1, 3) > 0))).lemmas

    def finding(problem: Any, limits: Limits, say: Any) -> Any:
        whole = replace(problem, lemmas=lemmas)
        return outcome(problem.claim, "proved", whole, agreed_by=["z3", "cvc5"], **found)

    outcome = provers.Outcome
    found = {"found": tuple(lemmas)} if "found" in outcome.__dataclass_fields__ else {}
    monkeypatch.setattr(provers, "_decide", finding)
    again(cache, claim)
    second = again(cache, claim)
    assert second.cached and all(second.outcome.problem.lemmas[name] is term for name, term in lemmas.items())
    assert list(second.outcome.problem.lemmas) == list(lemmas)
    assert all(getattr(second.outcome, name) == value for name, value in found.items())


def test_an_outcome_about_another_problem_is_not_kept(cache: Cache, monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = provers.Outcome
    monkeypatch.setattr(
        provers,
        "_decide",
        lambda problem, limits, say: outcome(
            problem.claim, "proved", replace(problem, given=bit(True)), agreed_by=["z3", "cvc5"]
        ),
    )
    again(cache, asked(below_sixteen, given=lambda s: s.go))
    assert not again(cache, asked(below_sixteen, given=lambda s: s.go)).cached


def test_an_undecided_claim_is_asked_again(cache: Cache, monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = provers.Outcome
    monkeypatch.setattr(provers, "_decide", lambda problem, limits, say: outcome(problem.claim, UNDECIDED, problem))
    again(cache, asked(below_sixteen))
    monkeypatch.undo()
    assert again(cache, asked(below_sixteen)).outcome.verdict == "proved"


def test_more_time_asks_again_where_time_ran_out_and_only_there(cache: Cache, monkeypatch: pytest.MonkeyPatch) -> None:
    outcome, real = provers.Outcome, provers._decide

    def cut_short(problem: Any, limits: Limits, say: Any) -> Any:
        short = outcome(problem.claim, "bounded", problem, steps=4, agreed_by=["z3", "cvc5"])
        return short if problem.claim.steps == 4 else real(problem, limits, say)

    monkeypatch.setattr(provers, "_decide", cut_short)
    bounded, proved = asked(below_sixteen, steps=4), asked(below_sixteen)
    for claim in (bounded, proved):
        assert not again(cache, claim, Limits(20)).cached
        assert again(cache, claim, Limits(10)).cached
    assert not again(cache, bounded, Limits(21)).cached
    assert again(cache, proved, Limits(21)).cached


def planted(cache: Cache, claim: Claim, **changes: Any) -> None:
    """A record with another outcome, its checksum right: what a faulty prover would have left."""
    name = key_of(stated(claim), LIMITS)
    assert name is not None
    record = cache.get(name)
    record["outcome"] |= changes.pop("outcome", {})
    cache.put(name, record | changes)


def test_a_refutation_whose_run_breaks_nothing_is_not_believed(cache: Cache, said: list[str]) -> None:
    claim = asked(lambda s: ~s.high, expect=REFUTED)
    again(cache, claim)
    wrong = {"start": {}, "inputs": {"go": [[False, 9]]}}
    planted(cache, claim, stimulus=wrong)
    found = again(cache, claim)
    assert (found.cached, found.outcome.verdict) == (False, "refuted")
    assert "does not break it" in said[0]
    planted(cache, claim, stimulus={"start": {"none": 1}, "inputs": {}})
    assert not again(cache, claim).cached


def test_proving_again_finds_a_wrong_record(cache: Cache) -> None:
    claim = asked(lambda s: ~s.high)
    again(cache, claim)
    same = again(cache, claim, fresh=True)
    assert same.marks == {"rechecked": True} and not same.cached
    planted(cache, claim, outcome={"verdict": "proved", "steps": None, "agreed_by": ["z3", "cvc5"]}, settled=True)
    assert again(cache, claim).outcome.verdict == "proved"
    found = again(cache, claim, fresh=True)
    assert found.outcome.verdict == "refuted"
    assert found.marks == {"disagreed_by": ["the cache (proved)"]}
    assert not again(cache, claim).cached  # neither was kept


def test_proving_again_without_an_answer_is_no_disagreement(cache: Cache, monkeypatch: pytest.MonkeyPatch) -> None:
    claim = asked(below_sixteen)
    again(cache, claim)
    outcome = provers.Outcome
    monkeypatch.setattr(
        provers, "_decide", lambda problem, limits, say: outcome(problem.claim, UNDECIDED, problem, why="time is up")
    )
    assert again(cache, claim, fresh=True).marks == {"why": "time is up; the cache says proved"}


def test_other_runs_differ_only_where_both_are_the_smallest() -> None:
    claim = asked(lambda s: ~s.high, expect=REFUTED)
    problem = stated(claim)

    def told(method: str, waits: int) -> Any:
        values = {("go", k): k >= waits for k in range(9 + waits)}
        return provers.Outcome(
            claim, REFUTED, problem, method, counterexample=search.replay(problem, values, 9 + waits, ~problem.holds)
        )

    for method, differs in (("bounded search, replayed", True), ("directed simulation, replayed", False)):
        assert Recalled(told(method, 0), before=told(method, 2)).differs == differs
        assert not Recalled(told(method, 1), before=told(method, 1)).differs


def test_a_prover_that_changes_while_it_works_keeps_nothing(cache: Cache, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("safety.commands.recall.prover", lambda: "edited")
    again(cache, asked(below_sixteen))
    assert not cache.folder.exists()

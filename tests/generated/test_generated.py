"""Generated models: the families' mathematics is what exploring says, and no verdict of the prover contradicts it."""

from __future__ import annotations

import functools
from collections.abc import Iterable
from dataclasses import replace
from random import Random

import pytest

from safety.prove.claims import BOUNDED, PROVED, REFUTED
from safety.prove.falsify import falsify
from safety.prove.problem import build_problem
from safety.prove.prove import Limits, Outcome, prove
from tests.generated import racing
from tests.generated.case import Case
from tests.generated.generator import FAMILIES, cases, drawn
from tests.generated.judge import breaks, explored
from tests.generated.run import DECIDED, is_wrong
from tests.generated.seeds import QUICK, SEEDS, SHORT

FEW = 60_000  # transitions
SHARE = 0.95  # of all cases are decided


def disputed(some: Iterable[Case], most: int) -> list[str]:
    """Cases of which exploring, or the run that is to break them, says something else than the mathematics."""
    wrong = []
    for case in some:
        problem = build_problem(case.claim)
        truth = explored(problem, most)
        if truth is not None and truth.verdict != case.truth:
            wrong.append(f"{case.name}: {case.truth} by the mathematics, {truth}")
        if case.breaks is not None and not breaks(problem, case):
            wrong.append(f"{case.name}: the run does not break it")
    return wrong


def judged(some: Iterable[Case], limits: Limits) -> list[tuple[Case, Outcome]]:
    return [(case, prove(case.claim, limits)) for case in some]


@pytest.mark.parametrize("family", FAMILIES)
def test_mathematics_is_what_exploring_says(family: str) -> None:
    assert disputed(drawn(QUICK, [family]), FEW) == []


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_mathematics_is_what_exploring_says_of_all_seeds(family: str) -> None:
    assert disputed(drawn(SEEDS, [family]), 4_000_000) == []


def test_there_are_two_hundred_models_and_every_family_has_both_kinds() -> None:
    assert len(FAMILIES) * len(SEEDS) >= 200
    for family in FAMILIES:
        assert {PROVED, REFUTED} <= {case.truth for case in drawn(SEEDS, [family])}, family


def test_a_seed_gives_the_same_cases_again() -> None:
    first, second = (build_problem(cases("divider", 3)[0].claim).holds for _ in "12")
    assert first is second


def test_every_family_has_models_that_are_explored_and_models_too_large_for_it() -> None:
    sizes = {
        truth is None for case in drawn(range(6), ["race"]) for truth in [explored(build_problem(case.claim), FEW)]
    }
    assert sizes == {True, False}


@pytest.mark.parametrize("family", SHORT)
def test_no_verdict_is_wrong(family: str) -> None:
    short = [replace(case, claim=replace(case.claim, steps=5)) for case in cases(family, 0)]
    told = judged(short, Limits(timeout=2, synthesis=1, solvers=("z3",)))
    assert [(c.name, o.verdict) for c, o in told if is_wrong(c, o)] == []
    assert any(o.verdict in DECIDED for _, o in told)


@functools.cache
def all_seeds(family: str) -> list[tuple[Case, Outcome]]:
    return judged(drawn(SEEDS, [family]), Limits(timeout=10, solvers=("z3",)))


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_no_verdict_is_wrong_on_all_seeds(family: str) -> None:
    assert [(c.name, o.verdict) for c, o in all_seeds(family) if is_wrong(c, o)] == []


@pytest.mark.slow
def test_most_cases_are_decided() -> None:
    told = [one for family in FAMILIES for one in all_seeds(family)]
    open_ = [case.name for case, found in told if found.verdict not in DECIDED]
    assert len(open_) <= (1 - SHARE) * len(told), open_


# --- deep runs, found by simulation --------------------------------------------------------------------------------


@pytest.mark.parametrize("family", [f for f in FAMILIES if f != "race"])  # whose tight runs take longer to find
def test_deep_near_misses_are_found_by_simulation(family: str) -> None:
    for case in cases(family, 1):
        if case.breaks is not None:
            run = falsify(build_problem(case.claim), 120_000, 20)
            assert run is not None and run["claim.holds"][-1] is False and all(run["claim.given"]), case.name


@pytest.mark.parametrize("family", FAMILIES)
def test_nothing_is_found_against_what_holds(family: str) -> None:
    for case in cases(family, 0):
        if case.truth != REFUTED:
            assert falsify(build_problem(case.claim), 1000, 0.1) is None, case.name


# --- the judge and the count of wrong verdicts can fail --------------------------------------------------------------


def test_a_wrong_constant_is_disputed() -> None:
    right, miss = next(pair for seed in range(20) if len(pair := cases("watchdog", seed)) == 2 and _small(pair[0]))
    assert disputed([right, miss], FEW) == []
    assert "by the mathematics" in disputed([replace(right, truth=REFUTED)], FEW)[0]
    assert "by the mathematics" in disputed([replace(miss, truth=PROVED)], FEW)[0]
    assert miss.breaks is not None
    short = replace(miss, breaks=replace(miss.breaks, steps=1))
    assert disputed([short], FEW) == [f"{miss.name}: the run does not break it"]


def _small(case: Case) -> bool:
    return case.truth == PROVED and explored(build_problem(case.claim), FEW) is not None


def test_a_vacuous_claim_is_told_from_a_true_one() -> None:
    silent = next(c for c in drawn(range(40), ["watchdog"]) if c.truth == "vacuous")
    truth = explored(build_problem(silent.claim), FEW)
    assert truth is None or truth.verdict == "vacuous"
    assert is_wrong(silent, Outcome(silent.claim, PROVED))


def test_a_wrong_verdict_is_counted() -> None:
    right, miss = racing.race(Random(1))
    assert is_wrong(miss, Outcome(miss.claim, PROVED))
    assert is_wrong(right, Outcome(right.claim, REFUTED))
    assert miss.breaks is not None
    assert is_wrong(miss, Outcome(miss.claim, BOUNDED, steps=miss.breaks.steps))
    assert not is_wrong(miss, Outcome(miss.claim, BOUNDED, steps=miss.breaks.steps - 1))
    assert not is_wrong(right, Outcome(right.claim, BOUNDED, steps=5))

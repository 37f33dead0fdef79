"""The gate by baseline over whole runs: no alarm for an unchanged model, and one for every planted regression."""

from __future__ import annotations

import dataclasses
import itertools
import random
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import pytest

from safety.inject import Campaign, CampaignError, Result, number_sets
from safety.inject.baseline import Comparison, Findings, compare
from safety.inject.baseline_file import dumps, loads, same_campaign
from safety.inject.classes import class_of
from safety.model import Model
from safety.prove.mutation import SELECTOR, Mutants, mutants_of
from safety.system import substitute
from safety.terms.values import const

Make = Callable[..., Campaign]
REGRESSIONS = 50


def kept(result: Result) -> Any:
    return loads(dumps({"c": Findings.of(result).record()}), "b.json")["c"]


@pytest.fixture(params=["listed", "by fault"])
def listed(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    """Whether records list their injections."""
    if request.param == "by fault":
        monkeypatch.setattr(number_sets, "RANGES", 0)
        monkeypatch.setattr(number_sets, "LONGEST", 3)
    return request.param == "listed"


def test_an_unchanged_model_never_alarms(campaign: Make, listed: bool) -> None:
    before = kept(campaign().inject())
    ways = itertools.cycle(itertools.product(["lanes", "auto"], [True, False]))
    for _, (engine, collapsing) in zip(range(100), ways, strict=False):
        found = compare(before, Findings.of(campaign(engine=engine, collapsing=collapsing).inject()))
        assert found == Comparison()


@pytest.fixture
def mutants(timer: type[Model]) -> Mutants:
    return mutants_of(timer)


def mutated(campaign: Make, mutants: Mutants, number: int) -> Campaign:
    """The campaign on a mutant; number 0 is the model as it is."""
    return campaign(model=mutants.system, start={"count": 8, SELECTOR: number}, engine="lanes")


def classes(result: Result) -> dict[str, str]:
    return {injection.id: class_of(cell) for injection, cell in result.injections()}


def worse(were: dict[str, str], now: dict[str, str]) -> set[str]:
    """What a baseline has to alarm for, told apart from how it does."""
    return {
        one
        for one, found in now.items()
        if (found == "dangerous_undetected") > (were[one] == "dangerous_undetected")
        or (were[one] == "detected") > (found == "detected")
    }


def regressions(healthy: Result, mutants: Iterable[tuple[str, Campaign]], listed: bool) -> int:
    """How many mutants are worse than the healthy model; each of these has to alarm, and no other."""
    before, were, count = kept(healthy), classes(healthy), 0
    for told, declared in mutants:
        same_campaign(before, declared, "b.json")
        try:
            result = declared.inject()
        except CampaignError:  # the fault-free run is judged faulty: refused, which is no pass either
            count += 1
            continue
        expected, found = worse(were, classes(result)), compare(before, Findings.of(result))
        count += bool(expected)
        if listed:
            assert (found.new.keys() | found.lost.keys(), found.worse) == (expected, bool(expected)), told
        else:  # a fault of which the set changed may have become better all the same
            assert found.worse >= bool(expected), told
    return count


def test_every_planted_regression_alarms_and_nothing_else_does(campaign: Make, mutants: Mutants, listed: bool) -> None:
    healthy = mutated(campaign, mutants, 0).inject()
    planted = ((str(mutant), mutated(campaign, mutants, mutant.number)) for mutant in mutants.mutants)
    assert regressions(healthy, planted, listed) >= REGRESSIONS


@pytest.mark.slow
def test_every_planted_regression_of_the_ring_alarms_and_nothing_else_does() -> None:
    from proofs.ts7_campaign import ring_single_stuck as declared

    mutants = mutants_of(declared.model)

    def planted(number: int) -> Campaign:
        """The campaign on a mutant, folded into the model."""
        chosen = {mutants.selector.uid: const(number, mutants.selector.sort)}
        system = mutants.system.mapped(lambda roots: substitute(roots, chosen))
        model = replace(system, states=tuple(state for state in system.states if state.path != SELECTOR))
        fields = {field.name: getattr(declared, field.name) for field in dataclasses.fields(declared)}
        return Campaign(**(fields | {"id": "mutant", "model": model, "settings": {}, "expect": None}))

    sample = random.Random(1).sample(mutants.mutants, 120)
    count = regressions(planted(0).inject(), ((str(one), planted(one.number)) for one in sample), listed=True)
    assert count >= REGRESSIONS

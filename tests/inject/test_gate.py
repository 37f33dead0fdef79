"""The gate by baseline over whole runs: no alarm for an unchanged model, and one for every planted regression."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import pytest

from safety.inject import Campaign, CampaignError, Result, number_sets
from safety.inject.baseline import Comparison, Findings, compare
from safety.inject.baseline_file import dumps, loads, same_campaign
from safety.inject.classes import class_of
from safety.model import Model
from safety.prove.mutation import SELECTOR, Mutants, mutants_of

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


def test_every_planted_regression_alarms_and_nothing_else_does(campaign: Make, mutants: Mutants, listed: bool) -> None:
    healthy = mutated(campaign, mutants, 0).inject()
    before, were = kept(healthy), classes(healthy)
    regressions = 0
    for mutant in mutants.mutants:
        declared = mutated(campaign, mutants, mutant.number)
        same_campaign(before, declared, "b.json")
        try:
            result = declared.inject()
        except CampaignError:  # the fault-free run is judged faulty: refused, which is no pass either
            regressions += 1
            continue
        now = classes(result)
        worse = {
            one
            for one, found in now.items()
            if (found == "dangerous_undetected") > (were[one] == "dangerous_undetected")
            or (were[one] == "detected") > (found == "detected")
        }
        regressions += bool(worse)
        found = compare(before, Findings.of(result))
        if listed:
            assert found.new.keys() | found.lost.keys() == worse, str(mutant)
            assert found.worse == bool(worse), str(mutant)
        else:  # by fault: a change of the set is an alarm, unless the fault is clean now
            assert found.worse >= bool(worse), str(mutant)
    assert regressions >= REGRESSIONS

"""The gate by baseline over whole runs: no alarm for an unchanged model, and one for every planted regression."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import pytest

from safety.inject import Campaign, CampaignError, Result
from safety.inject import baseline as module
from safety.inject.baseline import Findings, compare, dumps, loads
from safety.inject.classes import class_of
from safety.prove.mutation import SELECTOR, Mutants, mutants_of

Make = Callable[..., Campaign]
REGRESSIONS = 50


def kept(result: Result) -> Any:
    return loads(dumps({"c": Findings.of(result).record()}), "b.json")["c"]


@pytest.mark.parametrize("longest", [20_000, 3])
def test_an_unchanged_model_never_alarms(campaign: Make, monkeypatch: pytest.MonkeyPatch, longest: int) -> None:
    monkeypatch.setattr(module, "LONGEST", longest)
    before = kept(campaign().inject())
    ways = itertools.cycle(itertools.product(["lanes", "auto"], [True, False]))
    for _, (engine, collapsing) in zip(range(100), ways, strict=False):
        found = compare(before, Findings.of(campaign(engine=engine, collapsing=collapsing).inject()))
        assert found == module.Comparison()


@pytest.fixture(scope="module")
def mutants(request: pytest.FixtureRequest) -> Mutants:
    from tests.inject.conftest import Timer

    return mutants_of(Timer)


def mutated(campaign: Make, mutants: Mutants, number: int) -> Campaign:
    """The campaign on a mutant; number 0 is the model as it is."""
    return campaign(model=mutants.system, start={"count": 8, SELECTOR: number}, engine="lanes")


def classes(result: Result) -> dict[str, str]:
    return {injection.id: class_of(cell) for injection, cell in result.injections()}


@pytest.mark.parametrize("longest", [20_000, 3])
def test_every_planted_regression_alarms_and_nothing_else_does(
    campaign: Make, mutants: Mutants, monkeypatch: pytest.MonkeyPatch, longest: int
) -> None:
    monkeypatch.setattr(module, "LONGEST", longest)
    healthy = mutated(campaign, mutants, 0).inject()
    before, were = kept(healthy), classes(healthy)
    regressions = 0
    for mutant in mutants.mutants:
        declared = mutated(campaign, mutants, mutant.number)
        module.same_campaign(before, declared, "b.json")
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
        if longest > 3:
            assert found.new.keys() | found.lost.keys() == worse, str(mutant)
            assert found.worse == bool(worse), str(mutant)
        else:  # by fault: a change of the set is an alarm, unless the fault is clean now
            assert found.worse >= bool(worse), str(mutant)
    assert regressions >= REGRESSIONS

"""Mean times to failure against sums over every state and a Markov chain, exactly and by quadrature."""

from dataclasses import replace
from fractions import Fraction

import pytest

from safety.rates.markov import Chain, mean_time
from safety.trees import BasicEvent, FaultTree, Gate, TreeError
from safety.trees import mean_time as mean_time_module
from safety.trees.expressions import Constant, Operation
from safety.trees.lifetimes import Exponential, Glm, Weibull
from safety.trees.mean_time import mean_time_to_failure
from tests.trees.over_time import L, M, T, expansion, inside, rated, voted


@pytest.mark.parametrize("seed", range(30))
def test_mean_times_of_random_trees(seed, monkeypatch):
    tree = rated(seed)
    terms = expansion(tree)
    if set(terms) <= {0}:
        return
    exact = sum(-c / rate for rate, c in terms.items() if rate)
    found = mean_time_to_failure(tree)
    if terms.get(0, 0) != 1:
        assert found.method == "infinite" and found.never == pytest.approx(float(1 - terms.get(0, 0)))
        assert found.plain()["value"] == "inf"
        return
    assert found.exact == exact and inside(exact, found.bounds)
    monkeypatch.setattr(mean_time_module, "MOST_TERMS", 0)
    by_quadrature = mean_time_to_failure(tree)
    assert by_quadrature.exact is None and inside(exact, by_quadrature.bounds)


def test_mean_time_is_that_of_the_chain():
    chain = Chain("3", {("3", "2"): 3 * L, ("2", "failed"): 2 * L})
    assert mean_time_to_failure(voted(2, [Exponential(L, T)] * 3)).exact == mean_time(chain, {"failed"})


def test_mean_times_of_very_different_rates(monkeypatch):
    laws = [Exponential(Fraction(1, 10**n), T) for n in (1, 4, 8)]
    monkeypatch.setattr(mean_time_module, "MOST_TERMS", 0)
    for k in (1, 2, 3):
        found = mean_time_to_failure(voted(k, laws))
        monkeypatch.undo()
        exact = mean_time_to_failure(voted(k, laws)).exact
        monkeypatch.setattr(mean_time_module, "MOST_TERMS", 0)
        assert found.exact is None and inside(exact, found.bounds)


def test_mean_time_is_refused_where_it_is_not_the_integral():
    with pytest.raises(TreeError, match='"e0" is repaired, tested or of no constant failure rate'):
        mean_time_to_failure(voted(1, [Glm(0, L, M, T)]))
    with pytest.raises(TreeError, match='"e0" is repaired, tested'):
        mean_time_to_failure(voted(1, [Weibull(100, 2, 0, T)]))
    with pytest.raises(TreeError, match='no event below the top of fault tree "voted" has a failure rate'):
        mean_time_to_failure(voted(1, [Constant(1)]))
    tree = voted(1, [Exponential(L, T)])
    negated = replace(tree, top="none", gates=(*tree.gates, Gate("none", "not", ("top",))))
    with pytest.raises(TreeError, match='"e0" can prevent the top event'):
        mean_time_to_failure(negated)
    # scaled by 1/2 it may never fail
    assert mean_time_to_failure(voted(1, [Operation("mul", Fraction(1, 2), Exponential(L, T))])).never == 0.5


def test_constants_may_act_both_ways(monkeypatch):
    """One of two parts is in use, by chance: 0.7 / L + 0.3 / (2 L)."""
    gates = (
        Gate("top", "or", ("first", "second")),
        Gate("first", "and", ("a", "not c")),
        Gate("second", "and", ("b", "c")),
        Gate("not c", "not", ("c",)),
    )
    events = BasicEvent("a", rate_per_hour=L), BasicEvent("b", rate_per_hour=2 * L), BasicEvent("c", Fraction(3, 10))
    tree = FaultTree("t", "top", gates, events, mission_time_h=1)
    assert mean_time_to_failure(tree).exact == Fraction(17, 20) / L
    monkeypatch.setattr(mean_time_module, "MOST_TERMS", 0)
    found = mean_time_to_failure(tree)
    assert found.method == "estimated" and inside(Fraction(17, 20) / L, found.bounds)

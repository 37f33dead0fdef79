"""Mean times to failure against sums over every state and a Markov chain, exactly and by quadrature."""

import math
import sys
from dataclasses import replace
from fractions import Fraction

import pytest

from safety.rates.markov import Chain, mean_time
from safety.trees import BasicEvent, FaultTree, Gate, TreeError, read
from safety.trees.common_cause import CcfGroup, apply
from safety.trees.expressions.expression import Constant, Operation
from safety.trees.expressions.lifetimes import Exponential, Glm, PeriodicTest, Weibull
from safety.trees.over_time import mean_time as mean_time_module
from safety.trees.over_time.mean_time import mean_time_to_failure
from safety.trees.over_time.quadrature import Bounds
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


# --- rates of 0, shares, exposure times, sizes ------------------------------------------------------------------------


@pytest.mark.parametrize("law", [Exponential(0, T), PeriodicTest(0, 100, 100, T), Glm(0, 0, 0, T), Glm(0, 0, M, T)])
def test_what_has_the_rate_0_never_fails(law):
    assert mean_time_to_failure(voted(1, [law, Exponential(L, T)])).exact == 1 / L
    without = mean_time_to_failure(voted(2, [Exponential(L, T), Exponential(M, T)]))
    assert mean_time_to_failure(voted(2, [law, Exponential(L, T), Exponential(M, T)])).exact == without.exact
    assert mean_time_to_failure(voted(2, [law, Exponential(L, T)])).never == 1


def test_what_is_failed_at_first_and_has_the_rate_0_stays_so():
    third = Glm("1/3", 0, 0, T)
    assert mean_time_to_failure(voted(1, [third, Exponential(L, T)])).exact == Fraction(2, 3) / L
    assert mean_time_to_failure(voted(2, [third, Exponential(L, T)])).never == pytest.approx(2 / 3)


@pytest.mark.parametrize("seed", range(12))
def test_random_trees_with_a_rate_of_0(seed):
    tree = rated(seed)
    events = [replace(event, rate_per_hour=Fraction(0)) if n == 0 else event for n, event in enumerate(tree.events)]
    tree = replace(tree, events=events)
    terms = expansion(tree)
    if set(terms) <= {0}:
        return
    found = mean_time_to_failure(tree)
    if terms.get(0, 0) == 1:
        assert found.exact == sum(-c / rate for rate, c in terms.items() if rate)
    else:
        assert found.never == pytest.approx(float(1 - terms.get(0, 0)))


def test_a_galileo_tree_with_a_rate_of_0(tmp_path):
    for gate, never in (("or", 0), ("and", 1)):
        (tmp_path / "t.dft").write_text(f'toplevel "T"; "T" {gate} "A" "B"; "A" lambda=0; "B" lambda=1e-5;')
        found = mean_time_to_failure(read(tmp_path / "t.dft", mission_time_h=1000))
        assert found.never == never and found.exact == (None if never else 100_000)


def test_a_long_fraction_is_not_written_out():
    laws = [Exponential(Fraction(10**16 + 7919 * n * n + n, 10**20), T) for n in range(25)]
    found = mean_time_to_failure(voted(3, laws))
    assert found.exact.denominator > 10**4300
    plain = found.plain()
    assert plain["exact"] is None and plain["method"] == "exact" and inside(found.exact, (plain["low"], plain["high"]))
    assert mean_time_to_failure(voted(1, [Exponential(L, T)])).plain()["exact"] == "10000"


def test_a_share_of_a_probability_is_no_constant_rate():
    """Neither may it never come, as its limit says, nor is it of a rate scaled alike."""
    with pytest.raises(TreeError, match=r'"e0" has 0\.5 times the probability of an event with a rate'):
        mean_time_to_failure(voted(1, [Operation("mul", Fraction(1, 2), Exponential(L, T))]))
    group = CcfGroup("G", "beta-factor", ("e0", "e1"), {2: Fraction(1, 10)})
    with pytest.raises(TreeError, match="as one of a common-cause group has"):
        mean_time_to_failure(apply(voted(2, [Exponential(L, T)] * 2), [group]))


def test_an_exposure_time_of_its_own_is_not_dropped():
    events = BasicEvent("a", rate_per_hour=L, mission_time_h=10), BasicEvent("b", rate_per_hour=L)
    tree = FaultTree("t", "top", (Gate("top", "or", ("a", "b")),), events, mission_time_h=1000)
    with pytest.raises(TreeError, match='how often events fail is not: "a": its exposure time of its own, 10 h'):
        mean_time_to_failure(tree)
    with pytest.raises(TreeError, match='"e0": its <exponential> is of a fixed time, not of the mission time'):
        mean_time_to_failure(voted(1, [Exponential(L, 10), Exponential(L, T)]))


def test_repairs_that_balance_failures_are_repairs():
    with pytest.raises(TreeError, match='"e0" is repaired'):
        mean_time_to_failure(voted(1, [Glm("1/2", L, L, T), Exponential(L, T)]))


def test_rates_and_mean_times_beyond_all_doubles():
    assert mean_time_to_failure(voted(2, [Exponential(Fraction(1, 10**90), T)] * 2)).exact == 15 * 10**89
    assert Bounds.of(Fraction(10**400)) == (sys.float_info.max, math.inf)
    for exponent in ("e400", "e-400", "e120", "e-120"):
        with pytest.raises(TreeError, match=f'"a".*1{exponent.replace("e", r"e[+]?")}, expected'):
            events = (BasicEvent("a", rate_per_hour="1" + exponent),)
            mean_time_to_failure(FaultTree("t", "top", (Gate("top", "or", ("a",)),), events, mission_time_h=1))

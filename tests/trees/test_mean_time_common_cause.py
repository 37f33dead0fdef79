"""Mean times to failure with common causes: shares of the rates against the Markov chain of shocks and closed forms."""

import itertools
from fractions import Fraction
from math import comb

import pytest

from safety.rates.markov import Chain, mean_time
from safety.trees import BasicEvent, Gate, TreeError
from safety.trees.common_cause import CcfGroup, apply
from safety.trees.expressions.expression import MissionTime, Operation, Parameter
from safety.trees.expressions.lifetimes import Exponential, Glm
from safety.trees.over_time import mean_time as mean_time_module
from safety.trees.over_time.mean_time import mean_time_to_failure
from safety.trees.study import Study
from tests.trees.over_time import L, M, T, inside, voted

FACTORS = {
    ("beta-factor", "non-staggered"): {4: Fraction(1, 10)},
    ("MGL", "non-staggered"): {2: Fraction(1, 10), 3: Fraction(1, 4), 4: Fraction(1, 2)},
    ("alpha-factor", "non-staggered"): {1: Fraction(9, 10), 2: Fraction(3, 50), 3: Fraction(1, 50), 4: Fraction(1, 50)},
    ("alpha-factor", "staggered"): {1: Fraction(9, 10), 2: Fraction(3, 50), 3: Fraction(1, 50), 4: Fraction(1, 50)},
    ("phi-factor", "non-staggered"): {1: Fraction(9, 10), 2: Fraction(1, 20), 3: Fraction(1, 40), 4: Fraction(1, 40)},
}


def shock_rates(model, testing, x, rate=L, n=4):
    """The rate of the shock that hits one particular set of k of n members, from the definitions of the factors."""
    if model == "beta-factor":
        return {1: (1 - x[n]) * rate, n: x[n] * rate}
    if model == "phi-factor":
        return {k: x[k] * rate for k in x}
    if (
        model == "MGL"
    ):  # rho_k: the fraction of a member's failures shared by k or more that is shared by those of k - 1
        at_least = {1: Fraction(1)}
        for k in range(2, n + 1):
            at_least[k] = at_least[k - 1] * x[k]
        at_least[n + 1] = Fraction(0)
        return {k: (at_least[k] - at_least[k + 1]) * rate / comb(n - 1, k - 1) for k in range(1, n + 1)}
    if testing == "staggered":  # alpha_k: the fraction of a member's failures in events of k members
        return {k: x[k] * rate / comb(n - 1, k - 1) for k in x}
    # alpha_k: the fraction of the events that are of k members; together at such a rate that a member has its own
    events = rate * n / sum(k * alpha for k, alpha in x.items())
    return {k: alpha * events / comb(n, k) for k, alpha in x.items()}


def chain_mean_time(shocks, n, failed):
    """Mean time until `failed` holds of the set of members that shocks have hit."""
    transitions = {}
    for size in range(n + 1):
        for down in map(frozenset, itertools.combinations(range(n), size)):
            for k, rate in shocks.items():
                for hit in itertools.combinations(range(n), k):
                    after = down.union(hit)
                    if after != down and not failed(down):
                        pair = str(sorted(down)), str(sorted(after))
                        transitions[pair] = transitions.get(pair, 0) + rate
    ends = {state for pair in transitions for state in pair} - {start for start, _ in transitions}
    return mean_time(Chain(str([]), transitions), ends)


def grouped(tree, group):
    return apply(tree, [group], of_rates=True)


@pytest.mark.parametrize("k", [1, 2, 3, 4])
@pytest.mark.parametrize(("model", "testing"), FACTORS)
def test_mean_times_are_those_of_the_chain_of_shocks(model, testing, k, monkeypatch):
    factors = FACTORS[model, testing]
    group = CcfGroup("G", model, ("e0", "e1", "e2", "e3"), factors, testing=testing)
    tree = grouped(voted(k, [Exponential(L, T)] * 4), group)
    exact = chain_mean_time(shock_rates(model, testing, factors), 4, lambda down: len(down) >= k)
    assert mean_time_to_failure(tree).exact == exact
    monkeypatch.setattr(mean_time_module, "MOST_TERMS", 0)
    assert inside(exact, mean_time_to_failure(tree).bounds)


@pytest.mark.parametrize("beta", [Fraction(1, 100), Fraction(1, 10), Fraction(1)])
def test_two_channels_in_closed_form(beta):
    group = CcfGroup("G", "beta-factor", ("e0", "e1"), {2: beta})
    both, either = (mean_time_to_failure(grouped(voted(k, [Exponential(L, T)] * 2), group)).exact for k in (2, 1))
    assert both == 2 / L - 1 / ((2 - beta) * L) and either == 1 / ((2 - beta) * L)


@pytest.mark.parametrize(("model", "testing"), [key for key in FACTORS if key[0] != "phi-factor"])
def test_a_member_keeps_its_own_mean_time(model, testing):
    group = CcfGroup("G", model, ("e0", "e1", "e2", "e3"), FACTORS[model, testing], testing=testing)
    alone = voted(1, [Exponential(L, T)])
    tree = apply(alone, [group], elsewhere=("e1", "e2", "e3"), of_rates=True)
    assert mean_time_to_failure(tree).exact == 1 / L


def test_beside_parts_outside_of_the_group():
    """Two of a group of two, or one part of its own: a chain by hand."""
    tree = voted(2, [Exponential(L, T)] * 2)
    gates = (*tree.gates, Gate("all", "or", ("top", "c")))
    study = Study("s", gates, (*tree.events, BasicEvent("c", rate_per_hour=M)), mission_time_h=Fraction(8760),
                  tops=("all",), ccf_groups=(CcfGroup("G", "beta-factor", ("e0", "e1"), {2: "0.2"}),))  # fmt: skip
    own, shared = L * 8 / 10, L * 2 / 10
    chain = Chain("2", {("2", "1"): 2 * own, ("2", "0"): shared + M, ("1", "0"): own + shared + M})
    assert mean_time_to_failure(study.quantified("all", of_rates=True)).exact == mean_time(chain, {"0"})
    with pytest.raises(TreeError, match=r"let the group share out rates \(of_rates\)"):
        mean_time_to_failure(study.quantified("all"))


def test_factors_and_rates_that_are_parameters():
    beta, rate = Parameter("beta", Fraction(1, 10)), Parameter("rate", Operation("mul", 2, L))
    group = CcfGroup("G", "beta-factor", ("e0", "e1"), {2: beta}, total=Exponential(rate, MissionTime()))
    tree = grouped(voted(2, [Exponential(rate, T)] * 2), group)
    assert mean_time_to_failure(tree).exact == 2 / (2 * L) - 1 / (Fraction(19, 10) * 2 * L)


@pytest.mark.parametrize("law", [Parameter("q", Fraction(1, 10)), Glm(0, L, M, T), Operation("mul", "1/2", "1/3")])
def test_what_has_no_rate_shares_out_its_probability(law):
    group = CcfGroup("G", "beta-factor", ("e0", "e1"), {2: Fraction(1, 10)})
    assert grouped(voted(2, [law] * 2), group) == apply(voted(2, [law] * 2), [group])


def test_what_has_no_constant_rate_stays_refused():
    group = CcfGroup("G", "beta-factor", ("e0", "e1"), {2: Fraction(1, 10)})
    with pytest.raises(TreeError, match='"e0-alone" is repaired, tested or of no constant failure rate'):
        mean_time_to_failure(grouped(voted(2, [Glm(0, L, M, T)] * 2), group))

"""Uncertainty by sampling against closed forms: moments, quantiles, shared and correlated parameters, intervals.

Seeds are fixed, so nothing here is left to chance; a bound of 4 standard errors would fail once in 16 000 seeds.
"""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from scipy import stats

from safety.trees.as_written import TreeError
from safety.trees.expressions.distributions import Beta, Distribution, Gamma, Histogram, Lognormal, Normal, Uniform
from safety.trees.expressions.expression import Expression, MissionTime, Operation, Parameter
from safety.trees.expressions.lifetimes import Exponential, PeriodicTest
from safety.trees.solve import Solution, solve
from safety.trees.tree import BasicEvent, FaultTree, Gate
from safety.trees.uncertainty.correlation import Correlation
from safety.trees.uncertainty.propagation import (
    MEASURES,
    Spread,
    fields,
    importance_fields,
    propagate,
    propagate_importance,
    ranks,
)
from safety.trees.uncertainty.sampling import Draws, Plan, probabilities, variables

N = 20_000


def tree_of(kind: str, *expressions: Expression | str, time: int | None = None) -> FaultTree:
    """One gate over events e1, e2, ..."""
    events = tuple(
        BasicEvent(f"e{n}", expression=each) if isinstance(each, Expression) else BasicEvent(f"e{n}", Fraction(each))
        for n, each in enumerate(expressions, 1)
    )
    gate = Gate("top", kind, tuple(event.name for event in events), 2 if kind == "vote" else None)
    return FaultTree("t", "top", (gate,), events, mission_time_h=None if time is None else Fraction(time))


def solved(kind: str, *expressions: Expression | str, time: int | None = None) -> Solution:
    return solve(tree_of(kind, *expressions, time=time))


PLANS = pytest.mark.parametrize("plan", [Plan(N, seed=2), Plan(N, seed=2, hypercube=True)], ids=["free", "hypercube"])


@PLANS
def test_a_product_of_lognormals_is_lognormal(plan: Plan) -> None:
    sigmas, means = (0.5, 0.8, 0.3), (1e-2, 3e-3, 5e-2)
    laws = [Lognormal(math.log(m) - s * s / 2, s) for m, s in zip(means, sigmas, strict=True)]
    found = propagate(solved("and", *laws), plan)
    sigma = math.sqrt(sum(s * s for s in sigmas))
    exact = stats.lognorm(sigma, scale=math.prod(means) * math.exp(-sigma * sigma / 2))
    assert abs(found.mean - math.prod(means)) < 4 * found.standard_error
    assert found.standard_deviation == pytest.approx(exact.std(), rel=0.1)
    assert found.error_factor == pytest.approx(math.exp(stats.norm.ppf(0.95) * sigma), rel=0.02)
    assert stats.kstest(found.values, exact.cdf).pvalue > 1e-4
    for level in (0.05, 0.5, 0.95):
        quantile = found.quantile(level, 0.999)
        assert quantile.value == pytest.approx(exact.ppf(level), rel=0.05)
        if not plan.hypercube:
            assert quantile.low is not None and quantile.high is not None
            assert quantile.low <= exact.ppf(level) <= quantile.high


def moments(law: Distribution) -> tuple[Fraction, Fraction]:
    """Mean and mean square, exactly."""
    x = [argument.exact() or Fraction(0) for argument in law.arguments]
    if isinstance(law, Uniform):
        return (x[0] + x[1]) / 2, (x[0] ** 2 + x[0] * x[1] + x[1] ** 2) / 3
    assert isinstance(law, Beta)
    total = x[0] + x[1]
    return x[0] / total, x[0] * (x[0] + 1) / (total * (total + 1))


@PLANS
@pytest.mark.parametrize("seed", range(6))
def test_moments_of_a_multilinear_function_of_independent_inputs_are_exact(seed: int, plan: Plan) -> None:
    draw = random.Random(seed)
    laws: list[Distribution] = [
        Uniform(Fraction(draw.randint(0, 40), 100), Fraction(draw.randint(41, 100), 100))
        if draw.random() < 0.5
        else Beta(draw.randint(1, 5), draw.randint(1, 5))
        for _ in range(4)
    ]
    tree = tree_of("vote" if seed % 2 else "xor", *laws)
    mean, square = Fraction(0), Fraction(0)
    pairs = [moments(law) for law in laws]
    worlds = [w for w in itertools.product((0, 1), repeat=4) if tree.occurs({f"e{i + 1}" for i in range(4) if w[i]})]
    for one, other in itertools.product(worlds, repeat=2):
        term = Fraction(1)
        for (m, s), a, b in zip(pairs, one, other, strict=True):  # mean of q^(a+b) (1-q)^(2-a-b)
            term *= s if a and b else 1 - 2 * m + s if not (a or b) else m - s
        square += term
    for one in worlds:
        mean += math.prod((m if a else 1 - m for (m, _), a in zip(pairs, one, strict=True)), start=Fraction(1))
    found = propagate(solve(tree), plan)
    assert abs(found.mean - mean) < 4 * found.standard_error
    assert found.standard_deviation == pytest.approx(math.sqrt(square - mean * mean), rel=0.03)


def test_a_hypercube_estimates_the_mean_of_a_sum_far_better() -> None:
    solution = solved("or", *(Uniform(0, "1e-3") for _ in range(5)))
    free, cube = propagate(solution, Plan(N)), propagate(solution, Plan(N, hypercube=True))
    assert cube.standard_error < free.standard_error / 100
    assert abs(cube.mean - (1 - (1 - 5e-4) ** 5)) < 5 * cube.standard_error


@PLANS
def test_a_shared_parameter_is_one_variable(plan: Plan) -> None:
    p = Parameter("p", Uniform(0, 1))
    together, apart = propagate(solved("and", p, p), plan), propagate(solved("and", Uniform(0, 1), Uniform(0, 1)), plan)
    assert abs(together.mean - 1 / 3) < 4 * together.standard_error + 1e-6
    assert abs(apart.mean - 1 / 4) < 4 * apart.standard_error + 1e-6
    assert together.variables == ("p",) and apart.variables == ("e1", "e2")


@PLANS
@pytest.mark.parametrize("wanted", [-0.8, 0.5, 1.0])
def test_correlated_parameters_move_the_mean_of_their_product(wanted: float, plan: Plan) -> None:
    both = Correlation(("a", "b"), ((1, wanted), (wanted, 1)))
    plan = Plan(plan.samples, plan.seed, plan.hypercube, correlation=both)
    found = propagate(solved("and", Parameter("a", Uniform(0, 1)), Parameter("b", Uniform(0, 1))), plan)
    # Of uniforms the rank correlation is the correlation: E[xy] = 1/4 + r/12.
    assert abs(found.mean - (1 / 4 + wanted / 12)) < 4 * found.standard_error + 1e-6


def test_names_of_variables() -> None:
    rate = Parameter("rate", Lognormal(Parameter("centre", Uniform("1e-4", "2e-4")), 3, "0.95"))
    tree = tree_of(
        "or", Exponential(rate, MissionTime()), Exponential(Gamma(2, "1e-4"), 10), Beta(1, 9), rate, time=100
    )
    assert sorted(variables(tree)) == ["centre", "e2/1", "e3", "rate"]
    shadow = Parameter("e1", Uniform(0, 1))
    assert sorted(variables(tree_of("or", Uniform(0, "0.5"), shadow))) == ["e1", "e1 (event)"]
    with pytest.raises(TreeError, match='parameter "p" has two definitions'):
        variables(tree_of("or", Parameter("p", Uniform(0, 1)), Parameter("p", Uniform(0, "0.5"))))


EXPRESSIONS: list[Expression] = [
    Exponential(Lognormal("1e-3", 3, "0.95"), MissionTime()),
    PeriodicTest(Lognormal("1e-4", 3, "0.95"), 50, 10, MissionTime()),
    PeriodicTest("1e-3", "1e-2", Uniform(20, 50), 10, MissionTime()),
    PeriodicTest(
        Uniform(0, "1e-3"), 0, "1e-2", 50, 10, "0.1", Uniform(0, 50), Uniform(0, 1), "0.9", "0.1", MissionTime()
    ),
    Operation("ite", Operation("lt", Uniform(0, 1), "0.3"), "0.1", Uniform("0.2", "0.3")),
    Operation("min", Uniform(0, 1), "0.5", Operation("pow", Uniform(0, 1), 2)),
    Operation("abs", Operation("sin", Normal(0, 1))),
    Operation("div", Operation("mod", Uniform(0, 10), 3), 3),
    Operation("max", Operation("and", Operation("gt", Uniform(0, 1), "0.5"), 1) * "0.2", "0.1"),
    Operation("switch", Operation("not", Operation("floor", Uniform(0, 2))), "0.1", Histogram(0, 1, "0.2", 3, "0.6")),
    Operation("acos", Uniform("0.9", 1)) / 2,
]


@pytest.mark.parametrize("expression", EXPRESSIONS, ids=lambda e: e.tag)
def test_samples_of_an_expression_are_its_values_at_the_samples_of_its_variables(expression: Expression) -> None:
    """Each distribution becomes a parameter, whose sampled values go through `value` one by one."""
    tree = tree_of("or", expression, time=75)
    size = 40
    uniforms = Plan(size, seed=9).uniforms(sorted(variables(tree)))
    columns = probabilities(tree, size, lambda time: Draws(time, uniforms)).values[0]
    sampled: dict[str, list[float]] = {}

    def named(each: Expression, path: str) -> Expression:
        arguments = [named(argument, f"{path}/{n}") for n, argument in enumerate(each.arguments, 1)]
        if not isinstance(each, Distribution) or isinstance(each, Histogram):
            if isinstance(each, Histogram):
                at = each.quantile(uniforms[path], *(a.value() for a in each.arguments))
                sampled[path] = at.tolist()
                return Parameter(path, each)
            return (
                type(each)(each.tag, *arguments)
                if isinstance(each, Operation)
                else (type(each)(*arguments) if arguments else each)
            )
        sampled[path] = each.quantile(uniforms[path], *(a.value() for a in each.arguments)).tolist()
        return Parameter(path, each)

    certain = named(expression, "e1")
    for n in range(size):
        given = {path: values[n] for path, values in sampled.items()}
        assert columns[n] == pytest.approx(certain.value(75, given), rel=1e-12), given


@pytest.mark.parametrize("size", [10, 59, 200])
@pytest.mark.parametrize("level", [0.05, 0.5, 0.9])
def test_the_interval_of_a_quantile_covers_as_it_says(size: int, level: float) -> None:
    """The chance that order statistics enclose the quantile, summed exactly; and one step narrower is too little."""

    def below(k: int) -> Fraction:  # at most k of `size` samples lie below the quantile
        p = Fraction(str(level))
        return sum((math.comb(size, j) * p**j * (1 - p) ** (size - j) for j in range(k + 1)), Fraction(0))

    for confidence in (0.8, 0.95):
        first, last = ranks(size, level, confidence)
        risk = (1 - Fraction(str(confidence))) / 2
        assert first == 0 or below(first - 1) <= risk
        assert last == size + 1 or 1 - below(last - 1) <= risk
        assert below(first) > risk and (last == 1 or 1 - below(last - 2) > risk)


def test_a_sample_that_is_too_small_has_the_ends_of_the_range_as_bounds() -> None:
    found = propagate(solved("or", Uniform("0.2", "0.6")), Plan(20)).quantile(0.95)
    assert found.high == 1 and found.low is not None and 0.2 < found.low < found.value


def test_summary_figures_of_known_values() -> None:
    spread = Spread(np.array([4.0, 1.0, 3.0, 2.0]))
    assert (spread.mean, spread.standard_deviation) == (2.5, pytest.approx(math.sqrt(5 / 3)))
    assert spread.standard_error == pytest.approx(math.sqrt(5 / 12))
    assert [spread.quantile(level).value for level in (0.1, 0.25, 0.26, 0.5, 0.99)] == [1, 1, 2, 2, 4]
    assert spread.curve() == [(1, 0.25), (2, 0.5), (3, 0.75), (4, 1)]
    assert spread.histogram(3) == [(1, 2, 1), (2, 3, 1), (3, 4, 2)]
    assert Spread(np.ones(5)).histogram() == [(1, 1, 5)]
    wide = Spread(np.array([1e-6, 1e-5, 1e-4, 1e-3])).histogram(3)
    assert [count for *_, count in wide] == [1, 1, 2] and wide[0][1] == pytest.approx(1e-5)
    blocks = Spread(np.array([1.0, 3.0, 2.0, 4.0]), blocks=2)
    assert blocks.standard_error == pytest.approx(0.5)


def test_values_outside_the_range_of_a_probability_are_set_to_its_end_and_counted() -> None:
    found = propagate(solved("or", Normal("0.9", "0.1"), "0"), Plan(N))
    over = int((Plan(N).uniforms(["e1"])["e1"] > stats.norm.cdf(1)).sum())
    assert found.outside == {"e1": over} and abs(over / N - 0.1587) < 0.01
    assert found.values.max() == 1


def test_samples_in_parts_are_the_samples_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    solution = solved("vote", Normal("0.9", "0.1"), Beta(1, 3), "0.3")
    whole = propagate(solution, Plan(1000))
    monkeypatch.setattr("safety.trees.uncertainty.propagation.CHUNK", 300)
    parts = propagate(solution, Plan(1000))
    assert np.array_equal(whole.values, parts.values) and whole.outside == parts.outside != {}


def test_importance_over_the_samples_is_that_of_each_sample() -> None:
    laws = [Uniform("0.1", "0.3"), Uniform("0.2", "0.5"), Uniform("0.05", "0.9")]
    tree, plan = tree_of("vote", *laws), Plan(30, seed=4)
    found = propagate_importance(solve(tree), plan)
    uniforms = plan.uniforms(["e1", "e2", "e3"])
    for n in range(30):
        q = {
            name: law.quantile(uniforms[name], *(a.value() for a in law.arguments))[n]
            for name, law in zip(uniforms, laws, strict=True)
        }
        fixed = tree_of("vote", *(f"{Fraction(float(value))}" for value in q.values()))
        exact = solve(fixed).exact_importance()
        for name, measure in itertools.product(q, MEASURES):
            assert found[name][measure].values[n] == pytest.approx(float(getattr(exact[name], measure)), rel=1e-12)


def test_the_fields_of_a_results_document_are_plain_and_reproducible() -> None:
    solution = solved("and", Parameter("p", Lognormal("1e-3", 3, "0.95")), "0.5")
    first, again = (fields(propagate(solution, Plan(1000, seed=11))) for _ in range(2))
    assert first == again != fields(propagate(solution, Plan(1000, seed=12)))
    assert first["variables"] == ["p"] and first["seed"] == 11 and first["method"] == "Monte Carlo"
    assert sum(each["samples"] for each in first["histogram"]) == 1000
    assert [each["level"] for each in first["quantiles"]] == [0.05, 0.25, 0.5, 0.75, 0.95]
    cube = fields(propagate(solution, Plan(1000, hypercube=True)))
    assert cube["method"] == "Latin hypercube" and cube["quantiles"][0]["confidence"] is None


def test_the_fields_of_importance_rank_the_events() -> None:
    solution = solved("or", Uniform("0.1", "0.2"), Uniform("0.3", "0.4"))
    rows = importance_fields(propagate_importance(solution, Plan(200)))
    assert [row["event"] for row in rows] == ["e2", "e1"]
    assert rows[0]["criticality"]["mean"] > rows[1]["criticality"]["mean"]
    low, middle, high = (each["value"] for each in rows[0]["birnbaum"]["quantiles"])
    assert 0.8 < low < middle < high < 0.9  # 1 - q1


def test_samples_with_an_impossible_top_leave_out_the_importance_without_meaning() -> None:
    solution = solved("and", Normal("0.01", "0.01"), Uniform("0.9", 1))
    plan = Plan(1000)
    found = propagate(solution, plan)
    assert fields(found)["set_to_range"] == {"e1": int((found.values == 0).sum())} != {"e1": 0}
    rows = importance_fields(propagate_importance(solution, plan))
    assert [row["event"] for row in rows] == ["e1", "e2"]  # by Birnbaum's
    for row in rows:
        assert row["birnbaum"]["mean"] > 0
        assert [row[measure] for measure in MEASURES[1:]] == [None] * 3
        assert f"impossible in {found.outside['e1']} of 1000 samples" in row["why_not"]


def test_importance_that_takes_too_much_memory_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    solution = solved("or", Uniform("0.1", "0.2"), "0.3")
    monkeypatch.setattr("safety.trees.uncertainty.propagation.BYTES", 1e5)
    assert importance_fields(propagate_importance(solution, Plan(500)))[0]["criticality"]["mean"] > 0
    (row, _) = importance_fields(propagate_importance(solution, Plan(1000)))
    assert row["birnbaum"] is None and "1000 samples of 2 events take 0.000136 GB" in row["why_not"]
    assert propagate(solution, Plan(1000)).values.size == 1000
    with pytest.raises(TreeError, match="which is 1388 samples; take fewer"):
        propagate(solution, Plan(2000))


def test_an_uncertain_test_interval_is_solved_at_its_mean_and_sampled() -> None:
    """By quadrature: the value at each interval of the range, which jumps wherever the number of tests changes."""
    law = PeriodicTest("1e-3", Uniform(500, 900), 0, MissionTime())
    solution = solved("or", law, time=1000)
    assert solution.probability == PeriodicTest("1e-3", 700, 0, 1000).value()
    grid = [500 + 400 * (n + 0.5) / 2000 for n in range(2000)]
    mean = math.fsum(PeriodicTest("1e-3", x, 0, 1000).value() for x in grid) / len(grid)
    found = propagate(solution, Plan(N))
    assert abs(found.mean - mean) < 4 * found.standard_error


@pytest.mark.parametrize("wrong", [math.nan, -1e-300, 1.0000001])
@pytest.mark.parametrize("place", [0, 1, 6])
def test_a_sample_out_of_range_is_named(wrong: float, place: int) -> None:
    columns = np.full((2, 7), 0.5)
    columns[1, place] = wrong
    with pytest.raises(TreeError, match=f'sample {place} gives basic event "e2" the probability'):
        solved("or", "0.1", "0.2").many(columns)


@pytest.mark.parametrize(
    ("run", "message"),
    [
        (lambda: propagate(solved("or", "0.1")), "holds no distribution"),
        (lambda: propagate(solved("or", Exponential(Normal("1e-3", "1e-3"), 10))), "in .* samples, expected 0 or more"),
        (
            lambda: propagate(solved("or", Uniform(0, 1)), Plan(10**12)),
            "7.2e.04 GB, expected at most 4 GB, .* 55555555",
        ),
        (lambda: propagate(solved("or", Operation("sqrt", Uniform("-0.1", "0.5")))), "has no value in .* of 10000"),
        (lambda: Spread(np.ones(3)).quantile(1.0), "expected both between 0 and 1"),
        (
            lambda: probabilities(FaultTree("t", "g", (Gate("g", "or", ("e",)),), (BasicEvent("e"),)), 3, Draws),
            "no prob",
        ),
    ],
)
def test_what_cannot_be_sampled_is_refused(run: Callable[[], object], message: str) -> None:
    with pytest.raises(TreeError, match=message):
        run()

"""Distributions: quantiles against scipy's own, means against integrals, and samples drawn as planned."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats

from safety.trees.as_written import TreeError
from safety.trees.expressions.distributions import Beta, Distribution, Gamma, Histogram, Lognormal, Normal, Uniform
from safety.trees.uncertainty.correlation import Correlation, of_pairs, read_correlation
from safety.trees.uncertainty.sampling import Plan

U = np.array([1e-12, 1e-4, 0.05, 0.5, 0.95, 1 - 1e-4])
SIGMA = math.log(3) / stats.norm.ppf(0.95)
EACH: list[tuple[Distribution, Any]] = [
    (Uniform("0.2", "0.7"), stats.uniform(0.2, 0.5)),
    (Normal("0.2", "0.01"), stats.norm(0.2, 0.01)),
    (Lognormal("1e-3", 3, "0.95"), stats.lognorm(SIGMA, scale=1e-3 * math.exp(-(SIGMA**2) / 2))),
    (Lognormal(-5, "0.5"), stats.lognorm(0.5, scale=math.exp(-5))),
    (Gamma("2.5", "0.01"), stats.gamma(2.5, scale=0.01)),
    (Beta("0.5", 8), stats.beta(0.5, 8)),
    (Histogram(100, 170, "0.1", 200, "0.3"), stats.rv_discrete(values=((1, 3), (0.7, 0.3)))),
]
LAWS = pytest.mark.parametrize(("law", "peer"), EACH, ids=[type(law).__name__ for law, _ in EACH])


def values(law: Distribution) -> list[float]:
    return [argument.value() for argument in law.arguments]


@LAWS
def test_quantiles_and_mean_are_those_of_scipy(law: Distribution, peer: Any) -> None:
    tenths = 10 if isinstance(law, Histogram) else 1  # scipy's discrete values are whole
    assert law.quantile(U, *values(law)) == pytest.approx(peer.ppf(U) / tenths, rel=1e-9)
    assert law.value() == pytest.approx(float(peer.mean()) / tenths, rel=1e-12)


@LAWS
def test_the_mean_is_the_integral_of_the_quantiles_and_the_support_holds_them(law: Distribution, peer: Any) -> None:
    u = (np.arange(200_000) + 0.5) / 200_000
    quantiles = law.quantile(u, *values(law))
    assert float(quantiles.mean()) == pytest.approx(law.value(), rel=2e-4)
    low, high = law.interval()
    assert low <= quantiles.min() and quantiles.max() <= high
    assert (np.diff(quantiles) >= 0).all()


def test_the_error_factor_is_the_root_of_the_ratio_of_quantiles() -> None:
    low, middle, high = Lognormal("0.01", 5, "0.95").quantile(np.array([0.05, 0.5, 0.95]), 0.01, 5.0, 0.95)
    assert math.sqrt(high / low) == pytest.approx(5) and high / middle == pytest.approx(5)


def test_a_histogram_chooses_an_expression_by_the_width_of_its_interval() -> None:
    law = Histogram(0, 1, Uniform(0, 1), 4, "0.5")
    chosen = law.quantile(np.array([0.1, 0.24, 0.26, 0.9]), 0.0, 1.0, np.array([0.7, 0.8, 0.9, 1.0]), 4.0, 0.5)
    assert chosen.tolist() == [0.7, 0.8, 0.5, 0.5]
    assert law.exact() == law.value() == 0.5


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Histogram(0, 1), "has 2 arguments"),
        (lambda: Histogram(0, 2, 1, 1, 1), "fall, from 2.0 to 1.0"),
        (lambda: Histogram(1, 1, 1), "are all 1, expected rising"),
        (lambda: Beta(0, 1), "first shape of <beta-deviate> is 0, expected more than 0"),
        (lambda: Gamma(1, -1), "scale of <gamma-deviate> is -1"),
        (lambda: Normal(1, "-0.1"), "standard deviation of <normal-deviate> is -0.1"),
        (lambda: Lognormal("0.1", 3, "0.4"), "level of <lognormal-deviate> is 0.4, expected more than 0.5"),
    ],
)
def test_a_distribution_without_meaning_is_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(TreeError, match=message):
        make()


NAMES = ("a", "b", "c")


def test_numbers_depend_on_seed_and_name_only() -> None:
    one = Plan(100, seed=7).uniforms(NAMES)
    assert all(np.array_equal(one[name], Plan(100, seed=7).uniforms(("z", name))[name]) for name in NAMES)
    assert not np.array_equal(one["a"], one["b"])
    assert not np.array_equal(one["a"], Plan(100, seed=8).uniforms(NAMES)["a"])
    first = one["a"][:3].tolist()
    assert first == pytest.approx(FIRST, rel=1e-15)  # the same on every machine and version


FIRST = [0.549012450780061, 0.23409793442296312, 0.46941627228794724]


@pytest.mark.parametrize("hypercube", [False, True])
def test_uniforms_are_uniform(hypercube: bool) -> None:
    for column in Plan(20_000, seed=3, hypercube=hypercube).uniforms(NAMES).values():
        assert column.min() > 0 and column.max() < 1
        assert stats.kstest(column, "uniform").pvalue > 1e-4


def test_a_hypercube_has_one_sample_in_each_stratum() -> None:
    for correlation in (None, Correlation(("a", "b"), ((1, 0.7), (0.7, 1)))):
        for column in Plan(400, hypercube=True, blocks=4, correlation=correlation).uniforms(NAMES).values():
            for block in column.reshape(4, 100):
                assert sorted(int(x * 100) for x in block) == list(range(100))


@pytest.mark.parametrize("hypercube", [False, True])
@pytest.mark.parametrize("wanted", [-0.9, -0.3, 0.0, 0.5, 0.95, 1.0])
def test_rank_correlation_is_as_asked(wanted: float, hypercube: bool) -> None:
    size = 40_000
    correlation = Correlation(("a", "c"), ((1, wanted), (wanted, 1)))
    columns = Plan(size, seed=5, hypercube=hypercube, correlation=correlation).uniforms(NAMES)
    assert stats.spearmanr(columns["a"], columns["c"]).statistic == pytest.approx(wanted, abs=4 / math.sqrt(size))
    assert stats.spearmanr(columns["a"], columns["b"]).statistic == pytest.approx(0, abs=4 / math.sqrt(size))
    assert stats.kstest(columns["c"], "uniform").pvalue > 1e-4


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Correlation(NAMES, ((1, 0.9, 0.9), (0.9, 1, -0.9), (0.9, -0.9, 1))), "has the eigenvalue -0.8"),
        (lambda: Correlation(("a", "b"), ((1, 0.5), (0.4, 1))), "the same both ways"),
        (lambda: Correlation(("a", "b"), ((1, 1.5), (1.5, 1))), "expected -1 to 1"),
        (lambda: Correlation(("a", "b"), ((2, 0), (0, 1))), "and 1 with itself"),
        (lambda: Correlation(("a", "a"), ((1, 0), (0, 1))), "each named once"),
        (lambda: Correlation(("a", "b"), ((1, 0),)), "as many rows and columns"),
        (lambda: Plan(1), "1 samples with seed 1"),
        (lambda: Plan(95, hypercube=True), "cannot be shared out among 10"),
        (
            lambda: Plan(correlation=Correlation(("a", "x"), ((1, 0), (0, 1)))).uniforms(NAMES),
            'names "x", which is no random variable .* a, b, c',
        ),
    ],
)
def test_a_plan_that_cannot_be_drawn_is_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(TreeError, match=message):
        make()


def test_a_matrix_on_the_edge_of_what_is_possible_is_taken() -> None:
    columns = Plan(1000, correlation=Correlation(NAMES, ((1, 1, 1), (1, 1, 1), (1, 1, 1)))).uniforms(NAMES)
    assert columns["a"] == pytest.approx(columns["c"], abs=1e-7)


def test_correlations_are_read_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "together.json"
    file.write_text('{"rank_correlations": [["a", "b", 0.5], ["c", "b", -1]]}')
    with pytest.raises(TreeError, match="has the eigenvalue"):
        read_correlation(file)
    file.write_text('{"rank_correlations": [["a", "b", 0.5], ["c", "b", -0.25]]}')
    assert read_correlation(file) == Correlation(NAMES, ((1, 0.5, 0), (0.5, 1, -0.25), (0, -0.25, 1)))
    assert of_pairs([]) == Correlation((), ())


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "no JSON text"),
        ("[" * 100_000, "no JSON text"),
        ("[]", "expected {"),
        ('{"rank_correlations": 1}', "expected {"),
        ('{"rank_correlations": [], "other": 1}', "expected {"),
        ('{"rank_correlations": [["a", "b"]]}', r'\["a", "b"\] is no pair of names with a number'),
        ('{"rank_correlations": [["a", "b", true]]}', "is no pair of names with a number"),
        ('{"rank_correlations": [["a", "b", 0.1], ["b", "a", 0.1]]}', '"b" and "a" is given twice'),
        ('{"rank_correlations": [["a", "a", 1]]}', "given with itself"),
        ('{"rank_correlations": [["a", "b", 1.1]]}', "expected -1 to 1"),
        ('{"rank_correlations": [["a", "b", NaN]]}', "expected -1 to 1"),
    ],
)
def test_a_file_of_correlations_that_is_none_is_refused(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "together.json"
    file.write_text(text)
    with pytest.raises(TreeError, match=message) as refused:
        read_correlation(file)
    assert refused.value.place == str(file)

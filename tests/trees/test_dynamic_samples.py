"""Many rate vectors at once: each sample as if the tree were solved anew."""

import numpy as np
import pytest

from safety.rates.exceptions import NumericsFailed
from safety.trees import TreeError
from safety.trees.dynamic.samples import probabilities
from safety.trees.dynamic.solve import solve_dynamic
from safety.trees.formats.galileo import read_galileo

TEXT = """toplevel T; T or S E P; S wsp A B; P pand C D; F pdep=0.3 C D; E and X Y;
A lambda=1; B lambda=1 dorm=0.2; C lambda=0.5; D lambda=0.7; X lambda=0.1; Y prob=0.5;"""


def tree(text=TEXT):
    return read_galileo(text.encode(), "test.dft")


@pytest.mark.parametrize("time", [0, 0.001, 2.0, 40.0, 150.0, 1e4, 1e9])
def test_each_sample_as_if_solved_anew(time):
    draw = np.random.default_rng(7)
    rates = {name: draw.lognormal(-1, 1, 6) for name in ("A", "B", "D", "X")}
    solution = solve_dynamic(tree())
    found = probabilities(solution, rates, time)
    for sample, value in enumerate(found):
        anew = solution.with_rates({name: repr(float(values[sample])) for name, values in rates.items()})
        assert value == pytest.approx(float(anew.probability(repr(time)).middle), rel=1e-12, abs=1e-300)


def test_many_samples_in_pieces(monkeypatch):
    rates = {"A": np.linspace(0, 2, 50), "X": np.linspace(2, 1, 50)}
    whole = probabilities(solve_dynamic(tree()), rates, 1.5)
    monkeypatch.setattr("safety.trees.dynamic.samples.CELLS", 60)
    assert probabilities(solve_dynamic(tree()), rates, 1.5) == whole
    assert len(set(whole)) == 50


@pytest.mark.parametrize(
    ("rates", "message"),
    [
        ({}, "at least one event; got none"),
        ({"A": [1.0], "B": [1.0, 2.0]}, "A: 1, B: 2"),
        ({"Z": [1.0]}, '"Z", which is no event'),
        ({"A": [-1.0]}, "is -1.0, expected 0 or more"),
        ({"A": [float("nan")]}, "expected 0 or more"),
    ],
)
def test_what_is_refused(rates, message):
    with pytest.raises(TreeError, match=message):
        probabilities(solve_dynamic(tree()), rates, 1.0)


def test_alike_events_with_unequal_rates_are_told_apart():
    text = "toplevel T; T pand G C; G and A B; A lambda=1; B lambda=1; C lambda=1;"
    assert solve_dynamic(tree(text)).states["T"].equal_events
    told = probabilities(solve_dynamic(tree(text)), {"A": [1.0, 2.0]}, 1.0)
    apart = probabilities(solve_dynamic(tree(text), symmetry=False), {"A": [1.0, 2.0]}, 1.0)
    together = probabilities(solve_dynamic(tree(text)), {"A": [1.0, 2.0], "B": [1.0, 2.0]}, 1.0)
    assert told == apart and apart[0] == pytest.approx(together[0], rel=1e-14) and apart[1] < together[1]


@pytest.mark.parametrize("time_h", [-1, 10**151, 10**400])
def test_times_out_of_range(time_h):
    for compute in (
        lambda: probabilities(solve_dynamic(tree()), {"A": [1.0]}, time_h),
        lambda: solve_dynamic(tree()).probability(time_h),
    ):
        with pytest.raises(TreeError, match=r"time is .* h, expected 0 to 1e\+150"):
            compute()


def test_rates_and_times_beyond_all_doubles():
    with pytest.raises(NumericsFailed, match="beyond all doubles"):
        probabilities(solve_dynamic(tree()), {"A": [1e200]}, 10**140)

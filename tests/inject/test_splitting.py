"""Multilevel splitting against exact Markov values, with the effort counted, and what it refuses."""

from __future__ import annotations

import itertools
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from safety.inject.splitting import RareEvent, pilot_levels, splitting, student
from safety.rates.markov import Chain, probability_before


class Spares:
    """Units that fail one after the other and are repaired: a walk on 0, 1, 2 ... that starts at 1 and ends at 0."""

    def __init__(self, fail: Fraction, repair: Fraction) -> None:
        self.fail, self.repair = fail, repair

    def start(self, runs: int, rng: Any) -> Any:
        return np.ones(runs, dtype=np.int64)

    def step(self, states: Any, rng: Any) -> Any:
        up = float(self.fail / (self.fail + self.repair))
        return states + np.where(rng.random(len(states)) < up, 1, -1)

    def over(self, states: Any) -> Any:
        return states <= 0

    def level(self, states: Any) -> Any:
        return states

    def exact(self, goal: int) -> Fraction:
        rates = {(str(n), str(n + 1)): self.fail for n in range(1, goal)}
        rates |= {(str(n), str(n - 1)): self.repair for n in range(1, goal)}
        return probability_before(Chain("1", rates), {str(goal)}, {"0"})


WORST = 4  # the stage at which a channel is lost


class Channels:
    """Two-out-of-three equipment whose channels degrade by stages and are repaired by stages.

    From one degraded channel on: is the equipment lost (two channels at the worst stage) before all are as new?
    """

    fail, repair = Fraction(1, 20), Fraction(1)

    def start(self, runs: int, rng: Any) -> Any:
        return np.tile(np.array([1, 0, 0]), (runs, 1))

    def step(self, states: Any, rng: Any) -> Any:
        rates = np.concatenate([(states < WORST) * float(self.fail), (states > 0) * float(self.repair)], axis=1)
        ends = np.cumsum(rates, axis=1)
        pick = (ends <= rng.random((len(states), 1)) * ends[:, -1:]).sum(axis=1)
        after = states.copy()
        after[np.arange(len(states)), pick % 3] += np.where(pick < 3, 1, -1)
        return after

    def over(self, states: Any) -> Any:
        return states.sum(axis=1) == 0

    def level(self, states: Any) -> Any:
        """Stages of the two worst channels together."""
        return states.sum(axis=1) - states.min(axis=1)

    def exact(self) -> Fraction:
        every = list(itertools.product(range(WORST + 1), repeat=3))
        rates = {}
        for state in every:
            for i, change in itertools.product(range(3), (1, -1)):
                after = (*state[:i], state[i] + change, *state[i + 1 :])
                if after in every:
                    rates[str(state), str(after)] = self.fail if change > 0 else self.repair
        lost = {str(state) for state in every if state.count(WORST) >= 2}
        return probability_before(Chain(str((1, 0, 0)), rates), lost, {str((0, 0, 0))})


def close_and_cheap(found: RareEvent, exact: Fraction) -> None:
    """Within 10 %, and by 1000 times fewer runs and steps than plain sampling to the same relative error."""
    assert 0.9 < found.estimate / exact < 1.1
    assert found.relative_error < 0.05
    assert found.low < exact < found.high
    plain = (1 - exact) / (exact * Fraction(found.relative_error) ** 2)
    assert plain > 1000 * found.runs
    assert found.plain_steps > 1000 * found.steps
    assert found.plain_runs == pytest.approx(float(plain), rel=0.1)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_spares_run_out_with_a_probability_of_1e_9(seed: int) -> None:
    spares = Spares(Fraction(1), Fraction(8))
    exact = spares.exact(10)
    assert Fraction(5, 10**9) < exact < Fraction(7, 10**9)
    assert exact == Fraction(7, 8**10 - 1)  # the gambler's ruin
    close_and_cheap(splitting(spares, range(2, 11), runs=5000, seed=seed), exact)


def test_two_of_three_channels_are_lost_with_a_probability_of_1e_9() -> None:
    exact = Channels().exact()
    assert Fraction(1, 10**9) < exact < Fraction(2, 10**9)
    close_and_cheap(splitting(Channels(), range(2, 2 * WORST + 1), runs=6000, seed=1), exact)


def test_levels_found_by_a_pilot_do_as_well() -> None:
    spares = Spares(Fraction(1), Fraction(3))
    levels = pilot_levels(spares, 19, runs=2000, seed=5, share=0.15)
    assert levels == sorted(set(levels)) and levels[-1] == 19 and len(levels) > 5
    close_and_cheap(splitting(spares, levels, runs=5000, seed=1), spares.exact(19))


def test_the_estimate_is_unbiased_and_the_interval_covers_about_as_stated() -> None:
    spares = Spares(Fraction(1), Fraction(2))
    exact = float(spares.exact(9))
    found = [splitting(spares, range(2, 10), runs=60, replications=10, seed=seed) for seed in range(150)]
    estimates = np.array([one.estimate for one in found])
    assert abs(estimates.mean() - exact) < 3 * estimates.std() / 150**0.5
    assert 0.90 <= np.mean([one.low <= exact <= one.high for one in found]) <= 0.99


def test_one_level_is_plain_sampling() -> None:
    spares = Spares(Fraction(1), Fraction(2))
    found = splitting(spares, [3], runs=2000, seed=1)
    assert found.stages == (found.estimate,)
    assert found.plain_runs == pytest.approx(found.runs, rel=0.6)  # the error is itself estimated, from 20 replications
    assert found.estimate == pytest.approx(1 / 7, rel=0.05)


def test_the_length_of_a_plain_run_is_the_mean_duration_of_the_walk() -> None:
    found = splitting(Spares(Fraction(1), Fraction(8)), range(2, 11), runs=5000, seed=1)
    assert found.steps_per_plain_run == pytest.approx(9 / 7, rel=0.02)  # from 1 to 0, one step in nine is upwards
    assert found.plain_steps == found.plain_runs * found.steps_per_plain_run


def test_a_level_may_be_jumped_over() -> None:
    class Leaps(Spares):
        def step(self, states: Any, rng: Any) -> Any:
            return states + np.where(rng.random(len(states)) < 0.25, 3, -1)

    split = splitting(Leaps(Fraction(1), Fraction(3)), [2, 3, 4], runs=4000, seed=1)
    assert split.stages[1:] == (1.0, 1.0) and split.estimate == pytest.approx(0.25, rel=0.05)


def test_the_same_seed_gives_the_same_result() -> None:
    spares = Spares(Fraction(1), Fraction(8))
    one, same, other = (splitting(spares, range(2, 8), runs=300, seed=seed) for seed in (1, 1, 2))
    assert one == same != other


def test_the_result_says_what_it_is() -> None:
    found = splitting(Spares(Fraction(1), Fraction(2)), [2, 3], runs=200, seed=1).to_json()
    assert found["kind"] == "sampled, asymptotic"
    assert found["runs"] == 200 * 20 * 2 and len(found["stages"]) == 2 and found["steps"] > found["runs"] / 2


@pytest.mark.parametrize(
    ("levels", "options", "message"),
    [
        ([], {}, "name at least one"),
        ([3, 2], {}, "each above the one before"),
        ([2], {"runs": 0}, "runs=0"),
        ([2], {"replications": 1}, "replications=1"),
        ([2, 60], {}, "reaches level 60; put one below it, or make more runs"),
        ([40], {"most_steps": 2}, "after 2 steps"),
    ],
)
def test_what_cannot_be_estimated_is_refused(levels: list[int], options: dict[str, int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        splitting(Spares(Fraction(1), Fraction(4)), levels, **{"runs": 50, "seed": 1, **options})


def test_a_pilot_that_gets_nowhere_says_so() -> None:
    with pytest.raises(ValueError, match=r"gets above level 1\.0 towards 5"):
        pilot_levels(Spares(Fraction(1), Fraction(10**9)), 5, runs=50, seed=1)
    with pytest.raises(ValueError, match="share 1"):
        pilot_levels(Spares(Fraction(1), Fraction(2)), 5, runs=50, seed=1, share=1)


@pytest.mark.parametrize(("confidence", "freedom"), [(0.95, 19), (0.99, 1), (0.9, 4), (0.95, 200)])
def test_students_quantile(confidence: float, freedom: int) -> None:
    from scipy.stats import t

    assert student(confidence, freedom) == pytest.approx(t.ppf((1 + confidence) / 2, freedom), rel=1e-9)

"""Chains: what is refused, and that independent routes give the same figures on random chains."""

from fractions import Fraction
from math import exp, inf

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety.rates.enclosure import Enclosure
from safety.rates.exceptions import ChainError, NotErgodic, NotExact, NumericsFailed
from safety.rates.exponential import transient_by_exponential
from safety.rates.markov import (
    Chain,
    availability,
    entry_frequency,
    mean_reward,
    mean_time,
    probability_before,
    steady_state,
)
from safety.rates.numeric import enclose_mean_reward, enclose_mean_time, transient

NAMES = "abcde"
rates = st.fractions(min_value=Fraction(1, 10**6), max_value=10, max_denominator=10**6)
pairs = [(s, t) for s in NAMES for t in NAMES if s != t]
flows = st.dictionaries(st.sampled_from(pairs), rates, max_size=12)
ring = {(s, t): Fraction(1, 100) for s, t in zip(NAMES, NAMES[1:] + NAMES[0], strict=True)}


def contains(enclosure: Enclosure, value: float | Fraction) -> bool:
    return enclosure.low <= value <= enclosure.high


@pytest.mark.parametrize(
    ("start", "rates", "states", "error", "words"),
    [
        ("up", {("up", "down"): 0.1}, (), NotExact, "'up' -> 'down' = 0.1 is a float"),
        ("up", {("up", "down"): -1}, (), NotExact, "negative"),
        ("up", {("up", "up"): 1}, (), ChainError, "self loop"),
        ("up", {("up", "dwon"): 1}, ("up", "down"), ChainError, "did you mean 'down'"),
        ("up", {}, ("up", "up"), ChainError, "'up' is given twice"),
    ],
)
def test_what_is_no_chain_is_refused(start: str, rates: dict, states: tuple, error: type, words: str) -> None:
    with pytest.raises(error, match=words):
        Chain(start, rates, states)


def test_unknown_states_are_refused_in_every_question() -> None:
    chain = Chain("up", {("up", "down"): 1, ("down", "up"): 1})
    for ask in (mean_time, enclose_mean_time, availability, entry_frequency, probability_before):
        with pytest.raises(ChainError, match="'downn'"):
            ask(chain, {"downn"})
    for question in (transient, transient_by_exponential):
        with pytest.raises(ChainError):
            question(chain, 1, {"downn": Fraction(1)})
    with pytest.raises(ChainError, match="empty"):
        mean_time(chain, set())


def test_a_mean_time_is_infinite_when_the_end_is_not_certain() -> None:
    trap = Chain("a", {("a", "b"): 1, ("a", "trap"): "1e-9"})
    assert mean_time(trap, {"b"}) == inf == enclose_mean_time(trap, {"b"}).low
    assert probability_before(trap, {"b"}) == Fraction(10**9, 10**9 + 1)
    assert mean_time(Chain("a", {}), {"a"}) == 0
    assert mean_time(Chain("a", {}, "ab"), {"b"}) == inf


def test_long_run_figures_need_one_closed_class() -> None:
    with pytest.raises(NotErgodic, match=r"'b' or in 'c'|'c' or in 'b'"):
        steady_state(Chain("a", {("a", "b"): 1, ("a", "c"): 1}))
    assert steady_state(Chain("a", {("a", "b"): 1, ("b", "c"): 1, ("c", "b"): 3})) == {
        "a": 0,
        "b": Fraction(3, 4),
        "c": Fraction(1, 4),
    }


@given(flows)
def test_exact_mean_times_lie_in_the_certified_enclosure(flow: dict) -> None:
    chain = Chain("a", flow, NAMES)
    exact, enclosed = mean_time(chain, {"e"}), enclose_mean_time(chain, {"e"})
    assert contains(enclosed, exact) and enclosed.relative_width < 1e-11


@given(flows, st.dictionaries(st.sampled_from(NAMES), rates))
def test_exact_rewards_lie_in_the_certified_enclosure(flow: dict, reward: dict) -> None:
    chain = Chain("a", flow, NAMES)
    assert contains(enclose_mean_reward(chain, {"e"}, reward), mean_reward(chain, {"e"}, reward))


@given(flows)
def test_the_mean_time_solves_its_own_equations(flow: dict) -> None:
    """First-step analysis: exit rate * m(s) = 1 + sum of rate * m(next), with each m from a chain of its own start."""
    chain = Chain("a", {**ring, **flow})
    times = {s: mean_time(Chain(s, chain.rates), {"e"}) for s in NAMES}
    for s in NAMES[:-1]:
        assert chain.exit_rate(s) * times[s] == 1 + sum(rate * times[t] for t, rate in chain.out[s].items())


@given(flows)
def test_the_steady_state_balances_every_state(flow: dict) -> None:
    chain = Chain("a", {**ring, **flow})
    long_run = steady_state(chain)
    assert sum(long_run.values()) == 1
    for s in NAMES:
        assert long_run[s] * chain.exit_rate(s) == sum(
            long_run[t] * rate for (t, to), rate in chain.rates.items() if to == s
        )


@given(flows)
def test_entries_per_hour_are_one_in_a_mean_cycle(flow: dict) -> None:
    """Renewal: e is left to one copy of itself; the mean time from e back to e is 1 / frequency of entries."""
    chain = Chain("a", {**ring, **flow})
    cycle = Chain("e", {(s, "e again" if t == "e" else t): rate for (s, t), rate in chain.rates.items()})
    assert entry_frequency(chain, {"e"}) == 1 / mean_time(cycle, {"e again"})


@settings(deadline=None)
@given(flows, st.fractions(0, 50, max_denominator=100))
def test_uniformisation_and_matrix_exponential_overlap(flow: dict, time: Fraction) -> None:
    chain = Chain("a", flow, NAMES)
    reward = {"a": Fraction(1), "c": Fraction(1, 3)}
    one, other = transient(chain, time, reward), transient_by_exponential(chain, time, reward)
    assert one.reward.overlaps(other.reward)
    for state in NAMES:
        assert one.probability[state].overlaps(other.probability[state])
        assert one.probability[state].high - one.probability[state].low < Fraction(1, 10**10)


@pytest.mark.parametrize("solve", [transient, transient_by_exponential])
def test_one_unit_decays_exponentially(solve) -> None:
    chain = Chain("up", {("up", "down"): "0.01"})
    at = solve(chain, 250, {"up": Fraction(1)})
    assert float(at.probability["up"].middle) == pytest.approx(exp(-2.5), rel=1e-13)
    assert float(at.reward.middle) == pytest.approx(100 * (1 - exp(-2.5)), rel=1e-13)
    assert at.any_of(["up", "down"]).low <= 1 <= at.any_of(["up", "down"]).high


def test_rare_events_keep_their_relative_accuracy() -> None:
    chain = Chain("ok", {("ok", "hit"): "1e-12", ("hit", "ok"): "0.1", ("hit", "lost"): "1e-6"})
    one, other = transient(chain, 1000), transient_by_exponential(chain, 1000)
    assert float(one.probability["lost"].middle) == pytest.approx(9.9e-15, rel=1e-2)
    assert (
        one.probability["lost"].overlaps(other.probability["lost"]) and one.probability["lost"].relative_width < 1e-11
    )


def test_a_stiff_chain_stays_exact_and_doubles_say_when_they_fail() -> None:
    """Five redundant units, fast repair: a mean time above 10^40 h, where doubles alone cancel to nothing."""
    steps = {(str(n), str(n + 1)): Fraction((5 - n), 10**9) for n in range(5)}
    steps |= {(str(n + 1), str(n)): Fraction(10) for n in range(4)}
    chain = Chain("0", steps)
    assert float(mean_time(chain, {"5"})) == pytest.approx(10**4 * 10**45 / 120, rel=1e-6)
    with pytest.raises(NumericsFailed, match="exact elimination"):
        enclose_mean_time(chain, {"5"})


def test_too_much_work_is_refused_with_a_way_out() -> None:
    fast = Chain("a", {("a", "b"): 1000, ("b", "a"): 1000})
    with pytest.raises(NumericsFailed, match="steady state"):
        transient(fast, 10**6)
    many = Chain("0", {(str(n), str(n + 1)): 1 for n in range(300)})
    with pytest.raises(NumericsFailed, match=r"numeric\.transient"):
        transient_by_exponential(many, 1)


def test_a_planted_wrong_transition_is_seen() -> None:
    right = {("ok", "one"): Fraction(3, 1000), ("one", "ok"): Fraction(1, 8), ("one", "failed"): Fraction(2, 1000)}
    for pair in right:
        wrong = Chain("ok", {**right, pair: right[pair] * Fraction(1001, 1000)})
        assert not contains(enclose_mean_time(wrong, {"failed"}), mean_time(Chain("ok", right), {"failed"}))

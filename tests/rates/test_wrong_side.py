"""Wrong-side failure: closed form, lumped chain and channel-by-channel chain agree; limits are as they must be."""

from dataclasses import replace
from fractions import Fraction
from math import inf

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety.rates.claims import at_most, rate
from safety.rates.exceptions import NotExact, RateError, RoutesDisagree
from safety.rates.markov import Chain, entry_frequency, mean_time
from safety.rates.wrong_side import (
    WRONG_SIDE,
    Coverage,
    Equipment,
    Failures,
    channel_chain,
    closed_form,
    lumped_chain,
    mean_time_by_channels,
    mean_time_by_formula,
    rate_by_channels,
    rate_by_formula,
)

CHANNEL = Equipment(
    channel=Fraction(1, 10_000),
    dangerous=Fraction(1, 2),
    coverage=Coverage.of("0.9", "0.85", "0.94"),
    repair=Fraction(1, 24),
)
WITH_COMMON = replace(CHANNEL, common=Fraction(1, 31_337), common_wrong_side=Fraction(1, 1000))
ONE_YEAR = Fraction(8760)

positive = st.fractions(min_value=Fraction(1, 10**7), max_value=1, max_denominator=10**7)
rates = st.one_of(st.just(Fraction(0)), positive)
failures = st.builds(Failures, rates, rates, rates)
fractions = st.fractions(0, 1, max_denominator=1000)


@given(failures, rates)
def test_three_ways_to_the_mean_time_agree_exactly(failure: Failures, repair: Fraction) -> None:
    formula = closed_form(failure, repair)
    for build in (lumped_chain, channel_chain):
        assert mean_time(build(failure, repair), {WRONG_SIDE}) == formula


@given(st.builds(Failures, positive, positive, positive), positive)
def test_a_planted_error_in_any_transition_is_seen(failure: Failures, repair: Fraction) -> None:
    right = lumped_chain(failure, repair)
    for pair, value in right.rates.items():
        wrong = Chain(right.start, {**right.rates, pair: 2 * value})
        assert mean_time(wrong, {WRONG_SIDE}) != closed_form(failure, repair)


@given(failures.filter(lambda f: f.silent or f.common), rates)
def test_the_rate_is_the_event_frequency_under_renewal(failure: Failures, repair: Fraction) -> None:
    """A wrong side that is renewed after one mean hour: entries per hour are 1 / (mean time + 1)."""
    chain = channel_chain(failure, repair)
    renewed = Chain(chain.start, {**chain.rates, (WRONG_SIDE, chain.start): Fraction(1)})
    assert entry_frequency(renewed, {WRONG_SIDE}) == 1 / (closed_form(failure, repair) + 1)


@given(positive, positive, fractions, fractions)
def test_more_coverage_never_shortens_the_mean_time(
    channel: Fraction, repair: Fraction, one: Fraction, other: Fraction
) -> None:
    low, high = sorted((one, other))
    equipment = replace(WITH_COMMON, channel=channel, repair=repair, coverage=Coverage(high, low, high))
    estimate = mean_time_by_formula(equipment)
    assert estimate.low.high <= estimate.value.low == estimate.high.low
    rate = rate_by_channels(equipment)
    assert rate.high.exact and rate.low.high <= rate.high.low


def test_the_vote_decides_what_is_wrong_side() -> None:
    """Every state in which the train runs has at most one silent channel, and at most one isolated."""
    states = set(channel_chain(Failures(*map(Fraction, (1, 1, 1))), Fraction(1)).states) - {WRONG_SIDE}
    assert len(states) == 1 + 3 + 3 + 6
    assert all(s.count("s") <= 1 and s.count("i") <= 1 for s in states)


def test_without_repair_and_diagnostics_two_silent_channels_are_the_e8_system() -> None:
    bare = replace(CHANNEL, dangerous=Fraction(1), coverage=Coverage.of(0), repair=Fraction(0))
    assert mean_time_by_formula(bare).value.low == Fraction(5, 6) * 10_000 == mean_time_by_channels(bare).value.low


@pytest.mark.parametrize("test", [None, ONE_YEAR])
def test_edges(test: Fraction | None) -> None:
    for never in (
        replace(CHANNEL, coverage=Coverage.of(1)),
        replace(CHANNEL, channel=Fraction(0)),
        replace(CHANNEL, dangerous=Fraction(0)),
        replace(CHANNEL, coverage=Coverage.of(1), channel=Fraction(0)),
    ):
        equipment = replace(never, proof_test=test)
        for mean, per_hour in ((mean_time_by_formula, rate_by_formula), (mean_time_by_channels, rate_by_channels)):
            assert mean(equipment).value == (inf, inf)
            assert per_hour(equipment).value == (0, 0)
    only_common = replace(WITH_COMMON, coverage=Coverage.of(1), proof_test=test)
    expected = Fraction(1, 31_337_000)
    for per_hour in (rate_by_formula, rate_by_channels):
        value = per_hour(only_common).value
        assert value.low <= expected <= value.high and value.relative_width < 1e-9


@settings(deadline=None, max_examples=25)
@given(
    channel=st.fractions(Fraction(1, 10**7), Fraction(1, 100), max_denominator=10**7),
    coverage=fractions,
    repair=st.integers(1, 1000),
    test=st.integers(1, 20_000),
    common=st.sampled_from([Fraction(0), Fraction(1, 30_000)]),
)
def test_both_routes_with_a_proof_test_overlap(
    channel: Fraction, coverage: Fraction, repair: int, test: int, common: Fraction
) -> None:
    equipment = replace(
        CHANNEL,
        channel=channel,
        coverage=Coverage.of(coverage),
        repair=Fraction(1, repair),
        common=common,
        common_wrong_side=Fraction(1, 100),
        proof_test=Fraction(test),
    )
    one, other = rate_by_formula(equipment).value, rate_by_channels(equipment).value
    assert one.overlaps(other) and max(one.relative_width, other.relative_width) < 1e-8


def test_frequent_tests_approach_the_textbook_rate() -> None:
    """Two of three silent within one interval T: 3 (silent rate)^2 T, to first order in every rate times T."""
    silent = CHANNEL.failures(Fraction(9, 10)).silent
    for interval in (Fraction(1), Fraction(10)):
        found = rate_by_channels(replace(CHANNEL, proof_test=interval)).value
        assert float(found.middle / (3 * silent**2 * interval)) == pytest.approx(1, abs=5e-4 * float(interval))


def test_rare_tests_approach_the_rate_without_one() -> None:
    untested, tested = (rate_by_channels(replace(CHANNEL, proof_test=t)).value for t in (None, Fraction(10**7)))
    assert float(tested.middle) == pytest.approx(float(untested.middle), rel=1e-12)


def test_a_proof_test_helps_and_the_coverage_interval_is_the_range() -> None:
    yearly, never = rate_by_formula(replace(WITH_COMMON, proof_test=ONE_YEAR)), rate_by_formula(WITH_COMMON)
    assert yearly.value.high < never.value.low
    assert never.low.high < never.value.low < never.high.low


def test_pinned_figures() -> None:
    """Repair 24 h; first with a common part of 31 337 h, 0.1 % wrong side, then with a yearly test instead."""
    assert [f"{float(e.middle):.6e}" for e in rate_by_formula(WITH_COMMON)] == [
        "6.010700e-06",
        "3.615962e-06",
        "9.004447e-06",
    ]
    yearly = replace(CHANNEL, proof_test=ONE_YEAR)
    assert [f"{float(e.middle):.6e}" for e in rate_by_channels(yearly)] == [
        "6.094270e-07",
        "2.255466e-07",
        "1.325797e-06",
    ]


def test_wrong_inputs_are_named() -> None:
    for change, error, word in [
        ({"channel": 1e-4}, NotExact, "channel"),
        ({"dangerous": Fraction(2)}, RateError, "dangerous"),
        ({"proof_test": Fraction(0)}, RateError, "proof_test"),
        ({"repair": Fraction(-1)}, NotExact, "repair"),
    ]:
        with pytest.raises(error, match=word):
            replace(CHANNEL, **change)
    for interval in (("0.9", "0.95", "1"), ("0.9", "0.8", "1.1"), ("0.9", "0.5", "0.8")):
        with pytest.raises(RateError, match="order"):
            Coverage.of(*interval)


def test_a_statement_with_a_tolerable_hazard_rate() -> None:
    yearly = replace(CHANNEL, proof_test=ONE_YEAR)

    def state(name: str, bound: str) -> dict:
        return rate(
            id=f"ws.{name}",
            quantity="rate of wrong-side failure",
            unit="1/h",
            source="example [A]",
            target=at_most(bound),
            routes={
                "lumped chain, uniformised": lambda: rate_by_formula(yearly),
                "channel by channel, matrix exponential": lambda: rate_by_channels(yearly),
            },
        ).evaluate()

    assert state("met", "2e-6 /h")["met"] is True
    assert state("open", "1e-6 /h")["met"] is None  # the coverage interval lies across the bound
    assert state("missed", "1e-9 /h")["met"] is False
    entry = state("range", "1e-9 /h")
    assert entry["low"] < entry["value"] < entry["high"] and "exact" not in entry


def test_a_wrong_vote_stops_the_statement() -> None:
    """Voting rule (b), an isolated channel is left out and both others must ask: one silent channel then is enough."""
    failure, repair = CHANNEL.failures(Fraction(9, 10)), CHANNEL.repair
    right = channel_chain(failure, repair)
    rule_b = Chain(
        right.start,
        {
            (s, WRONG_SIDE if {"i", "s"} <= set(t) and t != WRONG_SIDE else t): r
            for (s, t), r in right.rates.items()
            if not {"i", "s"} <= set(s)
        },
    )
    with pytest.raises(RoutesDisagree):
        rate(
            id="ws.rule-b",
            quantity="mean time to wrong-side failure",
            unit="h",
            source="planted",
            routes={
                "rule (a)": lambda: closed_form(failure, repair),
                "rule (b)": lambda: mean_time(rule_b, {WRONG_SIDE}),
            },
        ).evaluate()

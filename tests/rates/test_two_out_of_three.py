"""TS-7: equations E8, E9, E10 against a chain, and every figure of section 4 that is consistent with 30 000 h."""

from fractions import Fraction
from math import inf

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from safety.rates.claims import Route, Target, printed, rate
from safety.rates.enclosure import Enclosure, Extended
from safety.rates.exceptions import RoutesDisagree, Unreachable
from safety.rates.inverse import solve_decreasing, square_root
from safety.rates.markov import Chain, mean_time
from safety.rates.two_out_of_three import (
    FAILED,
    chain,
    channel_rate_for,
    common_rate_for,
    mttf,
    mttf_first_failure,
    mttf_with_common_part,
    mttf_without_repair,
)
from safety.rates.units import Unit

MTBF = Fraction(30_000)
rates = st.fractions(min_value=0, max_value=1, max_denominator=10**7)


def by_chain(channel: Fraction, common: Fraction = Fraction(0), repair: Fraction = Fraction(0)) -> Extended:
    return mean_time(chain(channel, common, repair), {FAILED})


@given(rates, rates, rates)
def test_e10_is_the_chain_for_all_rates(channel: Fraction, common: Fraction, repair: Fraction) -> None:
    assert mttf(channel, common, repair) == by_chain(channel, common, repair)


@given(rates, rates)
def test_e8_and_e9_are_e10_without_repair(channel: Fraction, common: Fraction) -> None:
    assert mttf_with_common_part(channel, common) == mttf(channel, common, 0)
    assert mttf_without_repair(channel) == mttf(channel, 0, 0)


def test_what_never_fails_has_infinite_mean_time() -> None:
    assert mttf(0, 0, 1) == mttf_with_common_part(0, 0) == mttf_without_repair(0) == mttf_first_failure(0) == inf


@given(rates.filter(bool), rates, rates)
def test_inverse_problems_give_back_the_rate(channel: Fraction, common: Fraction, repair: Fraction) -> None:
    target = mttf(channel, common, repair)
    assert isinstance(target, Fraction)
    assert channel_rate_for(target, repair, common) == Enclosure(channel, channel)
    assert common_rate_for(target, channel, repair) == Enclosure(common, common)


@given(rates.filter(bool), rates, rates)
def test_the_root_and_the_bisection_of_the_chain_overlap(channel: Fraction, common: Fraction, repair: Fraction) -> None:
    try:
        root = channel_rate_for(MTBF, repair, common)
    except Unreachable:
        with pytest.raises(Unreachable):
            solve_decreasing(lambda x: by_chain(x, common, repair), MTBF)
        return
    assume(root.low > 0)
    bisected = solve_decreasing(lambda x: by_chain(x, common, repair), MTBF)
    assert root.overlaps(bisected) and bisected.relative_width <= 1e-12


def test_targets_out_of_reach_say_so() -> None:
    with pytest.raises(Unreachable, match="lower another rate"):
        channel_rate_for(MTBF, common="1e-4")
    with pytest.raises(Unreachable, match="lower another rate"):
        common_rate_for(MTBF, channel="1e-4")
    with pytest.raises(Unreachable, match="rate 0 gives"):
        solve_decreasing(lambda x: by_chain(Fraction(1, 10**4), x), MTBF)
    with pytest.raises(Unreachable, match="no say"):
        solve_decreasing(lambda x: inf, MTBF)


@given(st.fractions(min_value=0, max_denominator=10**9))
def test_a_square_root_is_bracketed(x: Fraction) -> None:
    low, high = square_root(x)
    assert low * low <= x <= high * high and high - low <= high / 2**250
    assert square_root(x * x) == (x, x)


def bisected(mean: Route) -> Enclosure:
    return solve_decreasing(mean, MTBF)  # type: ignore[arg-type]


def statement(name: str, unit: Unit, target: Target, **routes: Route) -> dict:
    return rate(
        id=f"ts7.{name}", quantity=name, unit=unit, source="TS-7 section 4 [D]", target=target, routes=routes
    ).evaluate()


def test_series_reading() -> None:
    total = Fraction(1, 30_000)
    assert printed("3.3333·10⁻⁵ /h").met(total, total)
    assert (
        mttf_first_failure(total / 4, total / 4)
        == MTBF
        == mean_time(
            Chain(
                "ok",
                {("ok", "A"): total / 4, ("ok", "B"): total / 4, ("ok", "C"): total / 4, ("ok", "common"): total / 4},
            ),
            {"A", "B", "C", "common"},
        )
    )


@pytest.mark.parametrize(
    ("per_channel", "published"),
    [
        ("0", "2.77778·10⁻⁵ /h"),
        ("0.1", "2.6114·10⁻⁵ /h"),
        ("0.25", "2.3932·10⁻⁵ /h"),
        ("0.5", "2.0952·10⁻⁵ /h"),
    ],
)
def test_without_repair(per_channel: str, published: str) -> None:
    entry = statement(
        f"channel rate, common part {per_channel} of it",
        "1/h",
        printed(published),
        root=lambda: channel_rate_for(MTBF, common_per_channel=per_channel),
        chain=lambda: bisected(lambda x: by_chain(x, x * Fraction(per_channel))),
    )
    assert entry["met"] is True and entry["method"] == "root" and "/" in entry["exact"]


@pytest.mark.parametrize(("hours", "published"), [(8, 1180), (24, 2019), (72, 3424), (168, 5095)])
def test_channel_mtbf_with_repair(hours: int, published: int) -> None:
    repair = Fraction(1, hours)
    entry = statement(
        f"channel MTBF, repair {hours} h",
        "h",
        printed(f"{published} h", digits=4),
        root=lambda: channel_rate_for(MTBF, repair).reciprocal(),
        chain=lambda: bisected(lambda x: by_chain(x, repair=repair)).reciprocal(),
    )
    assert entry["met"] is True and entry["agreed_by"] == ["root", "chain"]


@pytest.mark.parametrize(("channel", "common"), [(5_000, 36_085), (10_000, 31_337), (20_000, 30_325), (36_000, 30_100)])
def test_common_part_mtbf_with_repair_of_24_h(channel: int, common: int) -> None:
    x, repair = Fraction(1, channel), Fraction(1, 24)
    entry = statement(
        f"common-part MTBF, channel {channel} h",
        "h",
        printed(f"{common} h", digits=5),
        root=lambda: common_rate_for(MTBF, x, repair).reciprocal(),
        chain=lambda: bisected(lambda c: by_chain(x, c, repair)).reciprocal(),
    )
    assert entry["met"] is True


def test_p19() -> None:
    assert channel_rate_for(MTBF) == Enclosure.exactly(Fraction(1, 36_000))
    assert mttf_without_repair("1/36000") == MTBF
    found = channel_rate_for(MTBF, repair="1/24").reciprocal()
    assert printed("2019 h").met(found.low, found.high)


def test_p20() -> None:
    found = common_rate_for(MTBF, "1e-4", "1/24")
    assert printed("3.1911·10⁻⁵ /h").met(found.low, found.high)
    assert mttf("1e-4", found.low, "1/24") >= MTBF >= mttf("1e-4", found.high, "1/24")


@pytest.mark.parametrize("slip", [("two work", FAILED), ("three work", "two work"), ("two work", "three work")])
def test_a_planted_wrong_transition_stops_the_statement(slip: tuple[str, str]) -> None:
    x, repair = Fraction(1, 2019), Fraction(1, 24)
    right = chain(x, 0, repair)
    wrong = Chain(right.start, {**right.rates, slip: right.rates[slip] + x})
    with pytest.raises(RoutesDisagree, match=r"'E10' gives .*'chain' gives"):
        statement(
            f"planted {slip}",
            "h",
            printed("30 000 h", digits=3),
            E10=lambda: mttf(x, 0, repair),
            chain=lambda: mean_time(wrong, {FAILED}),
        )

"""The rate statements of TS-7: the specification is met, what is invented says so, coverage is the campaigns'."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from models.ts7.numbers import mttf_two_of_three
from proofs import ts7_parts, ts7_rates
from safety.rates.claims import Rate, declared

STATEMENTS = {r.id: r for r in declared() if r.id.startswith("ts7.")}
SPECIFIED = {  # the exact value where it is short, and the figure of the specification
    "ts7.mtbf.first-failure": (Fraction(1, 30_000), "3.3333e-5"),
    "ts7.mtbf.no-repair": (Fraction(1, 36_000), "2.77778e-5"),
    "ts7.mtbf.no-repair.forward": (Fraction(30_000), "30000"),
    "ts7.mtbf.common-0.1": (None, "2.6114e-5"),
    "ts7.mtbf.common-0.25": (None, "2.3932e-5"),
    "ts7.mtbf.common-0.5": (None, "2.0952e-5"),
    "ts7.mtbf.repair-8h": (None, "1180"),
    "ts7.mtbf.repair-24h": (None, "2019"),
    "ts7.mtbf.repair-72h": (None, "3424"),
    "ts7.mtbf.repair-168h": (None, "5095"),
    "ts7.mtbf.common-part-5000h": (None, "36085"),
    "ts7.mtbf.common-part-10000h": (None, "31337"),
    "ts7.mtbf.common-part-20000h": (None, "30325"),
    "ts7.mtbf.common-part-36000h": (None, "30100"),
    "ts7.mtbf.common-rate": (None, "3.1911e-5"),
}
COMPUTED = {  # by the statement: value, low, high to four digits
    "ts7.wrong-side.coverage": (0.5534, 0.2365, 0.8321),
    "ts7.wrong-side.window": (3.390e-8, 1.274e-8, 5.795e-8),
    "ts7.wrong-side.window-and-test": (2.096e-11, 2.963e-12, 6.125e-11),
    "ts7.wrong-side.compared": (2.394e-15, 3.384e-16, 6.996e-15),
    "ts7.wrong-side.whole": (3.720e-7, 3.720e-7, 3.720e-7),
    "ts7.mttf.parts-list": (2.688e6, 2.688e6, 2.688e6),
    "ts7.hazard.top-event": (3.864e-3, 3.864e-3, 3.864e-3),
}


@pytest.fixture(scope="module")
def entries() -> dict[str, dict[str, Any]]:
    return {name: statement.evaluate() for name, statement in STATEMENTS.items()}


def test_these_statements_are_declared() -> None:
    assert STATEMENTS.keys() == SPECIFIED.keys() | COMPUTED.keys()


@pytest.mark.parametrize("name", SPECIFIED)
def test_a_figure_of_the_specification_is_met_by_two_routes(name: str, entries: dict[str, dict[str, Any]]) -> None:
    value, shown = SPECIFIED[name]
    entry = entries[name]
    assert entry["met"] is True
    assert entry["value"] == pytest.approx(float(shown), rel=5e-4)
    assert len(entry["agreed_by"]) >= 2
    assert value is None or Fraction(entry["exact"]) == value


@pytest.mark.parametrize("name", COMPUTED)
def test_a_computed_figure_is_as_before(name: str, entries: dict[str, dict[str, Any]]) -> None:
    entry = entries[name]
    assert (entry["value"], entry["low"], entry["high"]) == pytest.approx(COMPUTED[name], rel=5e-4)
    assert entry["target"] is None


@pytest.mark.parametrize("statement", STATEMENTS.values(), ids=lambda r: r.id)
def test_what_is_invented_is_said_to_be_assumed(statement: Rate, entries: dict[str, dict[str, Any]]) -> None:
    given = {name for name, value in statement.inputs.items() if value.source == "A"}
    assert {text.partition(" = ")[0] for text in entries[statement.id]["assumed"]} == given
    assert given or statement.id in {"ts7.mtbf.first-failure", "ts7.mtbf.no-repair", "ts7.mtbf.no-repair.forward"}


@pytest.mark.parametrize(
    ("channel_h", "repair_h", "common"),
    [(1180, 8, 0), (2019, 24, 0), (3424, 72, 0), (5095, 168, 0), (10_000, 24, Fraction("3.1911e-5"))],
)
def test_the_specified_rates_give_30_000_h_by_the_formula_of_the_model(
    channel_h: int, repair_h: int, common: Fraction | int
) -> None:
    reached = mttf_two_of_three(Fraction(1, channel_h), Fraction(1, repair_h), Fraction(common))
    assert float(reached) == pytest.approx(30_000, rel=1e-3)


# --- coverage and parts lists --------------------------------------------------------------------------------------


def test_the_coverage_is_that_of_the_injected_faults() -> None:
    """By hand: 35 of 70 shared faults are dangerous and found; column, channel: dangerous and never found."""
    fit = Fraction(1, 10**9)
    found = (64 + 3 * 2) * fit / 2
    missed = Fraction(3, 16) * 8 * fit  # column
    missed += (Fraction(2, 6) * 6 + Fraction(4, 16) * 8 + Fraction(11, 64) * 32 + Fraction(1, 8) * 4) * fit
    missed += (Fraction(3, 8) * 8 + Fraction(10, 20) * 16 + Fraction(4, 8) * 4 + Fraction(4, 8) * 5) * fit
    missed += Fraction(1, 4) * 5 * fit  # output amplifier
    assert ts7_rates.coverage().value == found / (found + missed)
    assert ts7_rates.coverage() == ts7_rates.coverage_fault_by_fault()


def test_the_ends_of_the_coverage_take_every_rate_off_by_two() -> None:
    value, low, high = ts7_rates.coverage()
    odds = value / (1 - value)
    assert (low / (1 - low), high / (1 - high)) == (odds / 4, 4 * odds)


def test_better_coverage_makes_wrong_side_failure_rarer(entries: dict[str, dict[str, Any]]) -> None:
    order = ["ts7.wrong-side.window", "ts7.wrong-side.window-and-test", "ts7.wrong-side.compared"]
    values = [entries[name]["value"] for name in order]
    assert values == sorted(values, reverse=True)


def test_what_the_channels_share_decides(entries: dict[str, dict[str, Any]]) -> None:
    assert ts7_rates.COMMON.per_hour == ts7_rates.SHARED_PER_HOUR
    assert entries["ts7.wrong-side.whole"]["value"] == pytest.approx(3.72e-7, rel=1e-6)


def test_every_number_of_the_parts_lists_is_invented_and_used() -> None:
    assert all(note.startswith("[A] invented") for note in (ts7_parts.INVENTED_COMPONENTS, ts7_parts.INVENTED_ELEMENTS))
    ring, channel = ts7_rates.campaign_results()
    for result, listed in ((ring, ts7_parts.RING), (channel, ts7_parts.CHANNEL)):
        assert [row.group.name for row in result.rows] == list(listed)
    assert {row.group.name for row in ts7_rates.channel_rows()} == {*ts7_parts.BIT_BY_BIT_ONLY, *ts7_parts.CHANNEL}

"""Two-counter ATC: rates by two routes, and what they are made of."""

from __future__ import annotations

from fractions import Fraction

import pytest

from models.two_counter.failures import component_faults
from proofs import two_counter_rates as rates
from proofs.two_counter_campaign import early
from proofs.two_counter_parts import COMPONENTS, mode_rate


def test_two_routes_agree() -> None:
    assert rates.by_proof() == rates.by_injection() == Fraction("5.75e-7")


def test_every_rate_of_the_parts_list_is_used() -> None:
    assert set(COMPONENTS) <= {fault.name for fault in component_faults()}


def test_diagnostic_coverage_is_0() -> None:
    coverage = early.inject().diagnostic_coverage
    assert coverage is not None and coverage.value == 0


def test_effects_table_divides_the_rate_of_all_modes() -> None:
    rows = early.inject().rows
    whole = sum((mode_rate(fault) for fault in component_faults()), Fraction(0))
    assert sum(row.rate for row in rows) == whole
    undetected = sum(row.split()["lambda_du"] for row in rows)
    late = Fraction("2e-9")  # two modes that are dangerous at other moments only
    assert undetected == rates.by_proof() + mode_rate_of("generator 5 km/h low") - late


def mode_rate_of(name: str) -> Fraction:
    return next(mode_rate(fault) for fault in component_faults() if fault.name == name)


def test_top_event_lies_between_sum_and_sum_less_pairs() -> None:
    low, high = rates.top_event(0), rates.top_event(1)
    sum_ = rates.by_proof() * 10_000
    assert low <= high < sum_
    assert float(high) == pytest.approx(float(sum_), rel=0.005)

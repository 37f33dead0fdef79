"""The error of the limits, against the published accuracy and the exact formulas of `models.ts7.numbers`."""

from __future__ import annotations

from fractions import Fraction

import pytest

from models.ts7 import numbers
from proofs.ts7_accuracy import HALF_STEP_MM, STEP_MM, error_of_limit
from safety import PROVED, REFUTED
from safety.prove.bounds import bracket, check
from safety.prove.bounds.claims import declared
from safety.report.standing import standing


@pytest.mark.parametrize("signal", numbers.SPEEDS)
def test_every_limit_is_within_the_envelope_of_the_worst_of_each_cause(signal: int) -> None:
    found = check(error_of_limit(signal), numbers.error_envelope())
    assert (found.verdict, len(found.agreed_by)) == (PROVED, 2)


def test_the_worst_error_is_at_ninety_and_below_the_envelope() -> None:
    found = bracket(error_of_limit(90))
    exact = numbers.speed_of(numbers.WORD[90]).high * Fraction(785, 780) * Fraction(10_001, 10_000) - 90
    assert (found.verdict, len(found.agreed_by)) == (PROVED, 2)
    assert found.low is not None and found.high is not None and found.witness is not None
    assert found.low <= exact <= found.high < Fraction("0.594") < numbers.error_envelope()
    assert {str(v.attr): low for v, (low, _) in found.witness.items()}["step"] == 78


@pytest.mark.parametrize("signal", numbers.SPEEDS)
def test_without_wear_and_drift_it_is_the_error_of_the_word(signal: int) -> None:
    found = bracket(error_of_limit(signal, off_mm=0, drift=Fraction(0)))
    low, high = numbers.word_error(signal)
    assert found.low is not None and found.high is not None
    assert found.low <= max(abs(low), abs(high)) <= found.high


def test_a_switch_two_steps_off_is_out_of_the_published_accuracy() -> None:
    for steps, verdict in ((1, PROVED), (2, REFUTED)):
        assert check(error_of_limit(90, off_mm=steps * STEP_MM), numbers.ACCURACY).verdict == verdict
    assert check(error_of_limit(90, HALF_STEP_MM), Fraction("0.59")).verdict == REFUTED


def test_each_proved_bound_has_a_twin_that_fails_and_all_are_as_asked() -> None:
    claims = [claim for claim in declared() if claim.module == "proofs.ts7_accuracy"]
    limited = [claim for claim in claims if claim.limit is not None]
    proved = {claim.id for claim in limited if claim.expect == PROVED}
    assert len(proved) == 6 and proved == {claim.twin_of for claim in limited if claim.expect == REFUTED}
    assert [standing("claims", claim.evaluate(20.0)).code for claim in claims] == [0] * 13
    assert {claim.bound.requirement for claim in claims} == {"TS7-3", "TS7-16"}

"""Assumptions that can be kept for some steps only: a proof says so."""

from __future__ import annotations

import pytest

from safety.prove.claims import PROVED, VACUOUS, Scenario, Seen
from safety.prove.problem import build_problem
from safety.prove.vacuity import ends_after
from safety.system import ModelError
from safety.terms import Bit
from tests.prove.small import asked, below_sixteen, verdict


def counts_but_stays_below(least: int):
    def given(s: Seen) -> Bit:
        """It is told to count, and stays low all the same."""
        return s.go & (s.n < least)

    return given


@pytest.mark.parametrize("least", [1, 3, 7])
def test_an_end_that_no_run_passes_is_found(least: int) -> None:
    """From 0 it counts once a step: with n < least each run ends after so many steps."""
    given = counts_but_stays_below(least)
    assert ends_after(build_problem(asked(below_sixteen, given=given)), 12, False, 20) == least
    outcome = verdict(below_sixteen, given=given)
    assert outcome.verdict == PROVED
    assert f"no run keeps what is assumed for more than {least} steps" in outcome.why


def test_an_end_beyond_the_steps_that_are_looked_at_is_not_found() -> None:
    given = counts_but_stays_below(13)
    assert ends_after(build_problem(asked(below_sixteen, given=given)), 12, False, 20) is None


def test_assumptions_that_can_be_kept_bring_no_note() -> None:
    def waits_at_seven(s: Seen) -> Bit:
        """Told to count below 7 only."""
        return (s.n < 7) | ~s.go

    assert "no run keeps" not in verdict(below_sixteen, given=waits_at_seven).why
    assert ends_after(build_problem(asked(below_sixteen, given=lambda s: s.go)), 12, False, 20) is None


def test_what_cannot_even_begin_is_vacuous() -> None:
    assert verdict(below_sixteen, given=counts_but_stays_below(0)).verdict == VACUOUS


def test_a_witness_that_ends_early_is_refused() -> None:
    witness = Scenario(20, {"go": True})
    with pytest.raises(ModelError, match="breaks an assumption"):
        verdict(below_sixteen, given=counts_but_stays_below(3), witness=witness)

"""Two-stage and one-stage patterns, held lines: figures, refusals, claims."""

from __future__ import annotations

from fractions import Fraction

import pytest

from models.kinematics import kmh
from models.patterns.held_lines import HeldLine
from models.patterns.two_stage import TwoStageRun, passing_ceilings
from proofs import patterns_stages as proofs
from safety import ModelError, run
from safety.prove.prove import prove
from safety.tracing import trace
from tests.proofs.verdicts import check, claims_of

CLAIMS = claims_of(proofs)


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    check(prove(CLAIMS[name]))


def test_ceilings_on_passing_the_balises() -> None:
    assert [round(float(kmh(c.low)), 3) for c in passing_ceilings()] == [98.175, 50.543]


@pytest.mark.parametrize(("d1", "d2", "said"), [(600, 10, "above 10 m"), (170, 180, "behind the second")])
def test_distances_that_cannot_be_are_refused(d1: int, d2: int, said: str) -> None:
    with pytest.raises(ModelError, match=said):
        passing_ceilings(Fraction(d1), Fraction(d2))


def test_a_second_balise_within_the_margin_is_refused() -> None:
    with pytest.raises(ModelError, match="way is left before the margin"):
        trace(TwoStageRun, {"d2": Fraction(20), "margin": Fraction(20)})


@pytest.mark.parametrize("lost", proofs.LINES)
def test_sp_15_each_lost_line_is_the_brake(lost: str) -> None:
    held = {f"held.{line}": True for line in proofs.LINES}
    rows = [held | {"asked": False}] * 2 + [held | {"asked": False, f"held.{lost}": False}] * 2
    assert run(HeldLine, rows, 4)["out"] == [True, False, False, True]

"""Step supervision: the ladder's figures, refusals, claims."""

from __future__ import annotations

from fractions import Fraction

import pytest

from models.kinematics import B_EMERGENCY, KMH, T_EMERGENCY
from models.patterns.one_stage import pattern_length
from models.patterns.step_supervision import check_sections, overlap, sections
from proofs import patterns_steps as proofs
from safety import ModelError
from safety.prove.bounds.claims import declared
from safety.prove.laws import LawClaim
from safety.prove.prove import prove
from tests.proofs.verdicts import check, claims_of

MODULE = proofs.__name__.partition(".")[2]
CLAIMS = claims_of(proofs)
LAWS = {c.id: c for c in declared() if isinstance(c, LawClaim) and c.id.startswith(f"{MODULE}.")}


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    check(prove(CLAIMS[name]))


@pytest.mark.parametrize("name", LAWS)
def test_law(name: str) -> None:
    assert LAWS[name].found(20.0)["verdict"] == LAWS[name].expect


def test_sp_11_ladder_and_pattern() -> None:
    lengths = sections()
    assert [round(float(x), 2) for x in lengths] == [456.60, 188.89, 122.22, 57.29]
    assert (sum(lengths), pattern_length()) == (825, 750)
    assert round(float(pattern_length(b=3 * KMH)), 2) == 518.52


@pytest.mark.parametrize(("last", "metres"), [(25, 35.218), (45, 99.107)])
def test_overlap_of_a_last_step_above_0(last: int, metres: float) -> None:
    assert float(overlap(last, B_EMERGENCY, T_EMERGENCY)) == pytest.approx(metres, abs=0.0005)


def test_a_section_that_is_too_short_is_refused() -> None:
    check_sections([457, 189, 123, 58])
    with pytest.raises(ModelError, match=r"section 65 to 45 km/h = 188 m: too short .* 188.889 m"):
        check_sections([457, 188, 123, 58])
    with pytest.raises(ModelError, match="number of sections"):
        check_sections([457, 189, 123])


def test_a_downgrade_makes_sections_longer_up_to_where_no_stop_is_possible() -> None:
    assert all(steep > level for steep, level in zip(sections(downgrade=-20), sections(), strict=True))
    with pytest.raises(ModelError, match="stops no train"):
        sections(downgrade=Fraction(-60))

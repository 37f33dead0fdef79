"""What the small claims are said to be is what the tool's own search and induction find."""

import pytest

from safety.prove.claims import PROVED, REFUTED
from safety.prove.prove import prove
from tests.export.claims import CLAIMS


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict_of(name: str) -> None:
    make, steps = CLAIMS[name]
    outcome = prove(make().claim)
    assert (outcome.verdict, outcome.steps) == ((PROVED, None) if steps is None else (REFUTED, steps))

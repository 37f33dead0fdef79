"""The supervised train: its claims, the budget, the states."""

from __future__ import annotations

from fractions import Fraction

import pytest

from models.patterns.supervised import ServiceRun
from models.patterns.supervisor import Supervisor
from proofs import patterns_supervisor as proofs
from safety import ModelError, run
from safety.prove.prove import prove
from safety.tracing import trace
from tests.proofs.verdicts import check, claims_of

CLAIMS = claims_of(proofs)


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    check(prove(CLAIMS[name]))


def test_a_budget_that_is_too_short_is_refused() -> None:
    with pytest.raises(ModelError, match=r"guard.t_s = 1/5 s lies outside .* nearest admissible value is 3/10"):
        trace(ServiceRun, {"guard.t_s": Fraction(1, 5)})


def seen(v: int, x: int, acknowledged: bool = False) -> dict[str, object]:
    ends = {"v_lo": v, "v_hi": v, "x_lo": x, "x_hi": x, "acknowledged": acknowledged}
    return {f"seen.{name}": value for name, value in ends.items()}


def test_free_warning_brake_and_emergency_in_turn() -> None:
    """At 20 m/s towards the point; then at standstill before it, with the emergency brake acknowledged."""
    rows = [seen(20, x) for x in (700, 500, 350, 200)] + [seen(0, 100), seen(0, 100, True)]
    found = run(Supervisor, rows, len(rows))
    assert found["warning"] == [False, True, True, True, False, False]
    assert found["service"] == [False, False, True, True, False, False]
    assert found["emergency"] == [False, False, False, True, True, False]

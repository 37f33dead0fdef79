"""Two-counter ATC: cut sets with a watchdog, and the swapped signals that do no harm."""

from __future__ import annotations

from dataclasses import replace

import pytest

from proofs import two_counter_swapped, two_counter_watchdog_hazard
from safety import REFUTED
from safety.prove.claims import registered
from safety.prove.hazards import CONFIRMED, cut_sets, hazards
from safety.prove.prove import Limits, prove
from safety.system import ModelError

(HAZARD,) = (h for h in hazards() if h.id == "two_counter_watchdog_hazard.with_watchdog_no_brake")
CLAIMS = {c.id: c for c in registered() if c.id.startswith(f"{two_counter_swapped.__name__.split('.')[-1]}.")}


def test_what_held_the_command_takes_a_second_fault() -> None:
    found = cut_sets(HAZARD)
    assert found.by_order() == found.by_order(CONFIRMED) == dict(HAZARD.expect)
    assert (found.all_orders, found.why, found.agreed_by) == (True, "", ["z3", "cvc5"])
    assert {one.faults[0] for one in found.sets if one.order == 1} == set(two_counter_watchdog_hazard.LEFT)
    pairs = {frozenset((a, b)) for a in two_counter_watchdog_hazard.SILENT for b in two_counter_watchdog_hazard.FOOLED}
    assert {frozenset(one.faults) for one in found.sets if one.order == 2} == pairs


def test_a_watchdog_that_is_fooled_without_excuse_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(two_counter_watchdog_hazard, "FOOLED", ("watchdog dead",))
    with pytest.raises(ModelError, match="not shown for every combination"):
        cut_sets(replace(HAZARD))


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    outcome = prove(CLAIMS[name], Limits(synthesis=0, simulation=0, portfolio=0))
    assert outcome.as_expected, outcome.why
    assert outcome.verdict == REFUTED or (outcome.agreed_by == ["z3", "cvc5"] and outcome.premise_at is not None)

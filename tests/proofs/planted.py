"""A claim about a wrong model: a part of it exchanged, which a replayed run has to refute."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from safety import REFUTED, Scenario
from safety.model import Model
from safety.prove.claims import claim_id, registered
from safety.prove.prove import prove
from tests.seeded.planting import planted


def refuted(stated: Callable[..., Any], places: Mapping[str, type[Model]], run: Scenario | None = None) -> bool:
    """Whether the claim falls with these parts in place of the healthy ones, by a run (by default its witness)."""
    healthy = next(c for c in registered() if c.id == claim_id(stated))
    wrong = replace(healthy, model=planted(healthy.model, places), scenario=run or healthy.witness, expect=REFUTED)
    outcome = prove(wrong)
    return outcome.verdict == REFUTED and outcome.counterexample is not None

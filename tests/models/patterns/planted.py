"""What a claim of a proof file says of a model with a planted bug."""

from __future__ import annotations

import importlib
from dataclasses import replace

from safety.model import Model
from safety.prove.claims import REFUTED, Scenario, registered
from safety.prove.outcome import Outcome
from safety.prove.prove import prove


def judged(claim: str, model: type[Model], scenario: Scenario | None = None) -> Outcome:
    """The verdict on a claim, `stem.name`, asked of another model; the run to try is that given, or the claim's."""
    importlib.import_module(f"proofs.{claim.partition('.')[0]}")
    (found,) = (one for one in registered() if one.id == claim)
    return prove(
        replace(found, model=model, expect=REFUTED, scenario=scenario or found.scenario, steps=12, witness=None)
    )

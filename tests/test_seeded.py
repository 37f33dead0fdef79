"""Planted bugs: each wrong variant of TS-7 is refuted by a named claim of proofs/, in a replayed run.

The variant takes the place of the healthy part in the claim's own model; claim, faults and lemmas stay as they are.
"""

from __future__ import annotations

import re
from pathlib import Path
from types import ModuleType

import pytest

from safety import PROVED, REFUTED
from safety.prove.claims import Claim
from safety.prove.prove import prove
from tests.proofs import test_ts7_channel as channel
from tests.proofs import test_ts7_power as power
from tests.proofs import test_ts7_ring as ring
from tests.proofs import test_ts7_synchronisation as synchronisation
from tests.proofs import test_ts7_window as window
from tests.seeded.table import TABLE, Plant, claim

README = Path(__file__).parent / "seeded" / "README.md"
ROW = re.compile(r"^\| `(\w+)` \| (.+) \| `([\w.]+)` \|$", re.MULTILINE)
CLAIMS = sorted({plant.claim for plant in TABLE})


@pytest.mark.parametrize("plant", TABLE, ids=str)
def test_a_planted_bug_is_refuted_by_its_claim(plant: Plant) -> None:
    outcome = prove(plant.refuting())
    assert outcome.verdict == REFUTED, outcome.why
    run = outcome.counterexample
    assert run is not None
    assert all(run["claim.given"])
    assert run["claim.holds"].index(False) == len(run) - 1


def proved_by(module: ModuleType) -> set[str]:
    """The claims that `test_verdict` of a file proves in every run of the tests, on the models as they are."""
    [given] = module.test_verdict.pytestmark
    claims = [one if isinstance(one, Claim) else claim(one) for one in given.args[1]]
    return {one.id for one in claims if one.expect == PROVED}


BY_THEIR_OWN_TESTS = set().union(*map(proved_by, (channel, power, ring, synchronisation, window)))


@pytest.mark.parametrize("name", [name for name in CLAIMS if name not in BY_THEIR_OWN_TESTS])
def test_the_model_as_it_is_keeps_the_claim(name: str) -> None:
    outcome = prove(claim(name))
    assert outcome.verdict == claim(name).expect == PROVED, outcome.why


def test_the_readme_lists_every_variant_with_its_claim() -> None:
    listed = ROW.findall(README.read_text(encoding="utf-8"))
    assert listed == [(str(plant), plant.wrong, plant.claim) for plant in TABLE]

"""Claims about the check window: verdicts, and one frame less that must fail."""

from __future__ import annotations

from dataclasses import replace

import pytest

from proofs import ts7_window as window
from safety import PROVED, Bit, Seen, implies
from safety.prove.claims import Claim
from safety.prove.problem import build_problem
from safety.prove.prove import prove
from safety.prove.search import scripted
from tests.proofs.verdicts import OWN_LEMMAS, check, claims_of, of, without_twin

CLAIMS = claims_of(window)


@pytest.mark.parametrize("claim", CLAIMS.values(), ids=list(CLAIMS))
def test_verdict(claim: Claim) -> None:
    check(prove(claim))


def test_every_proved_requirement_has_a_claim_that_fails() -> None:
    assert without_twin(CLAIMS) == []


def test_one_frame_less_is_not_proved() -> None:
    def sooner(s: Seen) -> Bit:
        return implies(window.has_acted(s, 446), window.found(s))

    assert of(window.dead_check_is_found, OWN_LEMMAS, formula=sooner, steps=4).verdict != PROVED


@pytest.mark.parametrize("claim", [c for c in CLAIMS.values() if c.lemmas], ids=lambda c: c.formula.__name__)
def test_no_lemma_can_be_left_out(claim: Claim) -> None:
    for left_out in claim.lemmas:
        rest = tuple(lemma for lemma in claim.lemmas if lemma is not left_out)
        assert prove(replace(claim, lemmas=rest, steps=2), OWN_LEMMAS).verdict != PROVED, left_out.__name__


@pytest.mark.parametrize("word", [84, 87, 81, 93, 69, 117, 65, 127])
def test_words_that_stay_in_the_window(word: int) -> None:
    """In the run that the proof for all words allows: the claim holds in it, and no channel is found faulty."""
    claim = CLAIMS["window_passes_65_to_127"]
    seen = scripted(build_problem(claim), window.four_blocks(**{"a.check_word": word}))
    assert claim.expect == PROVED
    assert set(seen["a.check_word"]) == {word}
    assert len(seen["claim.holds"]) == 1024 and all(seen["claim.holds"])
    assert not any(seen["a.fault"])


@pytest.mark.parametrize(("word", "frames"), [(21, 256), (213, 256), (64, 256), (128, 256)])
def test_words_that_leave_the_window(word: int, frames: int) -> None:
    run = of(window.window_passes_64, formula=never_found, scenario=window.four_blocks(**{"a.check_word": word}))
    assert run.counterexample is not None and len(run.counterexample) == frames


def never_found(s: Seen) -> Bit:
    """No channel is found faulty."""
    return ~s.fault

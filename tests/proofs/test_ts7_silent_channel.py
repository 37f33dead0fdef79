"""A channel that never brakes, and the cases that the text leaves open: verdicts, lemmas, planted bugs."""

from __future__ import annotations

from dataclasses import replace

import pytest

from models.ts7.voting import EdgeSynchronisation
from proofs import ts7_gap_cases as gap
from proofs import ts7_silent_channel as silent
from proofs.ts7_formulas import Formula
from proofs.ts7_synchronisation import EVER
from safety import PROVED, Scenario
from safety.model import Model
from safety.prove.claims import Claim
from safety.prove.prove import prove
from tests.proofs.planted import refuted
from tests.proofs.verdicts import OWN_LEMMAS, check, claims_of, without_twin
from tests.seeded.behind import NeverIsolatesC
from tests.seeded.voting import IsolatesTheMajority, OneOfThree, TwoOfTwo

CLAIMS = {**claims_of(silent), **claims_of(gap)}
ALL_BRAKE_THEN_C_IS_SILENT = silent.outputs(11_000, a=[(1000, EVER)], b=[(1000, EVER)], c=[(1000, 2000)])


LONG = (
    "silence_is_found_within_two_windows",
    "silence_is_found_a_frame_earlier",
    "a_channel_that_never_brakes_is_noticed",
)


@pytest.mark.parametrize(
    "claim", [pytest.param(c, marks=[pytest.mark.slow] if n in LONG else []) for n, c in CLAIMS.items()], ids=CLAIMS
)
def test_verdict(claim: Claim) -> None:
    check(prove(claim))


def test_every_proved_requirement_has_a_claim_that_fails() -> None:
    assert without_twin(CLAIMS) == []


@pytest.mark.parametrize("name", ["two_of_three_brake_the_train", "either_remaining_channel_brakes_the_train"])
def test_no_lemma_can_be_left_out(name: str) -> None:
    assert prove(replace(CLAIMS[name], lemmas=(), steps=2), OWN_LEMMAS).verdict != PROVED


@pytest.mark.parametrize(
    ("claim", "place", "variant", "run"),
    [
        (silent.silence_is_found_within_two_windows, "common.sync", EdgeSynchronisation, ALL_BRAKE_THEN_C_IS_SILENT),
        (silent.a_channel_that_never_brakes_is_noticed, "common.sync", NeverIsolatesC, None),
        (gap.neither_follows_the_first_is_isolated, "sync", IsolatesTheMajority, None),
        (gap.one_follows_the_silent_one_is_isolated, "sync", IsolatesTheMajority, None),
        (gap.one_follows_the_silent_one_is_isolated, "sync", NeverIsolatesC, None),
        (gap.two_of_three_brake_the_train, "", OneOfThree, None),
        (gap.either_remaining_channel_brakes_the_train, "", TwoOfTwo, gap.B_FOLLOWS),
    ],
)
def test_a_planted_bug_is_refuted(claim: Formula, place: str, variant: type[Model], run: Scenario | None) -> None:
    assert refuted(claim, {place: variant}, run)

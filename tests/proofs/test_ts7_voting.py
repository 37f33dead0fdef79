"""Claims about the vote of TS-7: each has the verdict it states, and each counterexample tells what it should."""

from __future__ import annotations

import pytest

from proofs import ts7_voting
from proofs.ts7_brake_chain import CHANNELS
from safety import REFUTED
from safety.prove.claims import Claim, registered
from safety.prove.prove import Outcome, prove
from safety.trace import Trace

CLAIMS = {c.formula.__name__: c for c in registered() if c.formula.__module__ == ts7_voting.__name__}
FAST, BRAKED = 5104, ts7_voting.BROKEN_CHANNEL.braked


@pytest.fixture(scope="module")
def outcomes() -> dict[str, Outcome]:
    return {name: prove(claim) for name, claim in CLAIMS.items()}


def test_the_file_declares_these_claims() -> None:
    assert {name: claim.expect for name, claim in CLAIMS.items()} == {
        "brakes_with_one_channel_broken": "proved",
        "brakes_in_a_third_of_the_time": "refuted",
        "brakes_with_two_channels_broken": "refuted",
        "brakes_by_rule_b": "refuted",
        "lowering_only_lowers": "proved",
        "a_broken_matrix_only_lowers": "refuted",
    }


@pytest.mark.parametrize("claim", CLAIMS.values(), ids=list(CLAIMS))
def test_each_claim_has_the_verdict_it_states(claim: Claim, outcomes: dict[str, Outcome]) -> None:
    outcome = outcomes[claim.formula.__name__]
    assert outcome.as_expected, f"{outcome.verdict}: {outcome.why}"


@pytest.mark.parametrize("claim", [c for c in CLAIMS.values() if c.expect != REFUTED], ids=lambda c: c.id)
def test_two_solver_families_agree_on_a_proof(claim: Claim, outcomes: dict[str, Outcome]) -> None:
    assert outcomes[claim.formula.__name__].agreed_by == ["z3", "cvc5"]


@pytest.mark.parametrize("claim", [c for c in CLAIMS.values() if c.expect == REFUTED], ids=lambda c: c.id)
def test_a_refuted_claim_is_the_twin_of_a_proved_one(claim: Claim) -> None:
    assert claim.twin_of is not None
    assert CLAIMS[claim.twin_of.partition(".")[2]].expect == "proved"


# --- what the numbers say ------------------------------------------------------------------------------------------


def test_the_chain_for_four_words_takes_these_frames() -> None:
    """Latch, relay NBRR, relay NB: 19 120 word frames at 4 words, then twice the release time of 160 frames."""
    chain = ts7_voting.BROKEN_CHANNEL
    assert (chain.latched, chain.voted, chain.braked) == (4781, 4942, FAST)


def run_of(outcome: Outcome) -> Trace:
    assert outcome.counterexample is not None
    return outcome.counterexample


def test_with_two_channels_broken_the_third_brakes_alone(outcomes: dict[str, Outcome]) -> None:
    run = run_of(outcomes["brakes_with_two_channels_broken"])
    assert [run[f"brakes.{n}"][-1] for n in CHANNELS] == [False, False, True]
    assert not any(run["nb"][-BRAKED:])


def test_rule_b_isolates_a_healthy_channel_first(outcomes: dict[str, Outcome]) -> None:
    """The silent channel a outvotes the early one, b; then c alone asks for the brake, and rule (b) wants both."""
    run = run_of(outcomes["brakes_by_rule_b"])
    assert [run[f"targets.{n}"][-1] for n in CHANNELS] == [False, True, False]
    assert [run[f"brakes.{n}"][-1] for n in CHANNELS] == [False, True, True]
    assert not any(run["nb"][-BRAKED:])
    assert not any(run["eb"][-BRAKED:])

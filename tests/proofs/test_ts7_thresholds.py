"""Claims about exact limits: expected verdicts, and bugs planted in the model that they find."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from models.ts7 import threshold
from models.ts7.threshold import Thresholds, Trio
from proofs import ts7_thresholds as proofs
from safety import PROVED, REFUTED, Bit, Real, at_least, real
from safety.prove.claims import Claim, claim_id, registered
from safety.prove.prove import prove

CLAIMS = {c.id: c for c in registered() if c.id.startswith("ts7_thresholds.")}


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    found = prove(CLAIMS[name])
    assert found.as_expected, found.why
    assert found.verdict == REFUTED or found.agreed_by == ["z3", "cvc5"]


def of(formula: object) -> Claim:
    return CLAIMS[claim_id(formula)]  # type: ignore[arg-type]


class NoVoteForTheIsolated(Thresholds, event="window of constant speed"):
    """Planted: an isolated channel no longer counts as braking."""

    def brakes(self, braked: Trio, cut: Trio) -> Bit:
        return at_least(2, *(brake & ~out for brake, out in zip(braked, cut, strict=True)))


def test_a_lost_vote_is_found() -> None:
    assert prove(replace(of(proofs.brakes_above_two), model=NoVoteForTheIsolated)).verdict == REFUTED


@pytest.mark.parametrize(
    ("lowering", "refuted"),
    [
        (Fraction(19, 10), proofs.nobody_isolated_within_two),
        (Fraction(21, 10), proofs.no_brake_up_to_minus_four),
        (Fraction(-1, 10), proofs.lowering_only_lowers),
    ],
)
def test_another_lowering_is_found(lowering: Fraction, refuted: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threshold, "LOWERING", lowering)
    assert prove(of(refuted)).verdict == REFUTED


def test_the_counterexample_to_rule_b_isolates_a_healthy_channel() -> None:
    run = prove(of(proofs.brakes_above_two_by_rule_b)).counterexample
    assert run is not None and len(run) == 2
    broken = [n for i, n in enumerate("abc") if run[f"fault{i}"][0]]
    cut = [n for n in "abc" if run[f"cut.{n}"][-1]]
    assert len(broken) == len(cut) == 1 and broken != cut
    assert not run["nb"][-1] and run["x"][-1] > 2


def test_below_minus_four_a_healthy_channel_was_isolated_before() -> None:
    run = prove(of(proofs.no_brake_up_to_minus_four_whoever_is_isolated)).counterexample
    assert run is not None and len(run) == 2
    assert [n for i, n in enumerate("abc") if run[f"cut_{n}"][-1] and not run[f"fault{i}"][0]]
    assert run["nb"][-1] and run["x"][-1] <= -4


def test_limits_are_exact_numbers() -> None:
    found = prove(of(proofs.nobody_isolated_within_two))
    assert found.verdict == PROVED and found.problem is not None
    assert {v.sort.kind for v in found.problem.system.inputs.values()} == {"real"}
    assert isinstance(real("1/3"), Real)

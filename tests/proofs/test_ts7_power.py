"""Claims about power, relays and their circuits: expected verdicts, and planted bugs that they find."""

from __future__ import annotations

from dataclasses import replace

import pytest

from proofs import ts7_contacts, ts7_power
from safety import PROVED, REFUTED
from safety.prove.claims import Claim, claim_id, registered
from safety.prove.prove import prove

CLAIMS = {c.id: c for c in registered() if c.id.startswith(("ts7_power.", "ts7_contacts."))}


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    found = prove(CLAIMS[name])
    assert found.as_expected, found.why
    assert found.verdict == REFUTED or found.agreed_by == ["z3", "cvc5"]


def of(formula: object) -> Claim:
    return CLAIMS[claim_id(formula)]  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("formula", "setting"),
    [
        (ts7_power.what_opens_behind_the_vote_brakes, {"common.nb_relay.release": 161}),
        (ts7_power.what_opens_in_a_channel_votes_to_brake, {"common.a.chr_relay.release": 161}),
        (ts7_power.any_reverse_detection_applies_eb, {"common.eb_relay.release": 161}),
        (ts7_power.two_isolated_channels_apply_eb, {"b.chr_relay.release": 161}),
        (ts7_power.inverter_loss_is_no_permanent_stop, {"power.gap": 401}),
        (ts7_power.inverter_loss_is_no_permanent_stop, {"common.nb_relay.operate": 241}),
    ],
)
def test_a_frame_more_is_found(formula: object, setting: dict[str, int]) -> None:
    """A relay or a change-over slower by one frame breaks the claim in the run that witnesses its premise."""
    slower = replace(of(formula), settings=setting, scenario=of(formula).witness)
    assert prove(slower).verdict == REFUTED


@pytest.mark.parametrize("name", "bc")
def test_a_slower_relay_in_another_channel_is_found(name: str) -> None:
    claim = of(ts7_power.what_opens_in_a_channel_votes_to_brake)
    assert claim.witness is not None
    run = replace(claim.witness, present=[f"{name}.chr_relay.coil open"])
    slower = {f"common.{name}.chr_relay.release": 161}
    assert prove(replace(claim, settings=slower, scenario=run)).verdict == REFUTED


def test_a_missing_rung_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ts7_contacts, "NB_RULE_A", ts7_contacts.NB_RULE_A[2:])
    assert prove(of(ts7_contacts.nb_circuit_is_two_of_three)).verdict == REFUTED


def test_a_front_contact_for_a_back_contact_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    turned = tuple(c._replace(name=c.name.replace("~rev_a", "rev_a")) for c in ts7_contacts.EB_CHAIN)
    monkeypatch.setattr(ts7_contacts, "EB_CHAIN", turned)
    assert prove(of(ts7_contacts.eb_circuit_needs_two_in_service_and_no_reverse)).verdict == REFUTED


def test_exact_times_in_frames() -> None:
    """The runs reach the premise where the times of the relays add up to it; power fails or faults strike at 1000."""
    reached = {
        ts7_power.stops_a_frame_after_the_release_time: 160,
        ts7_power.inverter_loss_is_no_permanent_stop: 400 + 3 * 240,
        ts7_power.what_opens_behind_the_vote_brakes: 160,
        ts7_power.what_opens_in_a_channel_votes_to_brake: 2 * 160,
        ts7_power.two_isolated_channels_apply_eb: 1 + 2 * 160,
        ts7_power.any_reverse_detection_applies_eb: 160,
    }
    for formula, frames in reached.items():
        found = prove(of(formula))
        assert (found.verdict, found.premise_at) == (PROVED, 1000 + frames)

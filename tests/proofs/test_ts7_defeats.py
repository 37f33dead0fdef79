"""What defeats TS-7: expected verdicts, what the runs show, and that the same runs brake without the fault."""

from __future__ import annotations

from dataclasses import replace

import pytest

from proofs import ts7_defeats as proofs
from safety import REFUTED
from safety.prove.claims import Claim, claim_id, registered
from safety.prove.problem import build_problem
from safety.prove.prove import prove
from safety.prove.search import scripted

CLAIMS = {c.id: c for c in registered() if c.id.startswith("ts7_defeats.")}
FAULTS = [c.id for c in CLAIMS.values() if c.expect == REFUTED and c.scenario and c.scenario.present]


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    found = prove(CLAIMS[name])
    assert found.as_expected, found.why
    assert found.verdict == REFUTED or found.agreed_by == ["z3", "cvc5"]


def of(formula: object) -> Claim:
    return CLAIMS[claim_id(formula)]  # type: ignore[arg-type]


@pytest.mark.parametrize("name", FAULTS)
def test_the_fault_is_to_blame(name: str) -> None:
    """The same run without the fault keeps the claim: what defeats it is the fault, not the run."""
    claim = CLAIMS[name]
    assert claim.scenario is not None
    assert False not in scripted(build_problem(claim), replace(claim.scenario, present=()))["claim.holds"]


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize(
    "pair", [proofs.brakes_with_two_silent_channels, proofs.brakes_with_a_fast_oscillator_and_a_silent_channel]
)
def test_one_fault_of_a_pair_is_not_enough(pair: object, which: int) -> None:
    """Each fault of a pair alone is masked by the vote."""
    claim = of(pair)
    assert claim.scenario is not None and len(claim.scenario.present) == 2
    alone = replace(claim.scenario, present=[claim.scenario.present[which]])
    assert False not in scripted(build_problem(claim), alone)["claim.holds"]


def test_two_silent_channels_isolate_the_healthy_one() -> None:
    run = prove(of(proofs.the_healthy_channel_stays_in_service)).counterexample
    assert run is not None
    assert [run[f"targets.{n}"][-1] for n in "abc"] == [False, False, True]
    assert [run[f"{n}.brake"][-1] for n in "abc"] == [False, False, True]
    assert not run["nb"][-1] and not run["eb"][-1]


def test_a_welded_contact_ignores_three_votes() -> None:
    run = prove(of(proofs.brakes_with_a_welded_output_contact)).counterexample
    assert run is not None
    assert [run[f"brakes.{n}"][-1] for n in "abc"] == [True] * 3
    assert not run["nb"][-1] and not run["common.nb_relay.coil"][-1]


def test_a_fast_oscillator_is_a_rate_and_no_fault_of_the_window() -> None:
    """Of 16 pulses 15 come; the check window still counts 85 overflows a block."""
    claim = of(proofs.brakes_with_a_fast_shared_oscillator)
    assert claim.scenario is not None
    fast = scripted(build_problem(claim), claim.scenario)
    right = scripted(build_problem(claim), replace(claim.scenario, present=()))
    pulses = [sum(run["axle.pulse"][3000:7000]) for run in (fast, right)]
    assert abs(pulses[0] - pulses[1] * 15 / 16) < 1
    assert fast["a.check.count"] == right["a.check.count"] and not any(fast["a.fault"])

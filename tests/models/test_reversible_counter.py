"""The reversible counter: both readings of its equation by running them, its claims, its single faults.

`told` is the device a second time, in plain integers; the campaign's wrong side is compared with it fault by fault.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from models.reversible_counter import DIVISOR, PER_KMH, PULSE, PeriodicSum, ReversibleCounter, StrongFeedback
from models.reversible_failures import component_modes
from proofs import reversible_campaign, reversible_counter
from proofs.reversible_counter import steps_to_brake
from safety import PROVED, REFUTED, Bit, Scenario, Seen, implies, persists, run
from safety.prove.claims import claim_id, registered
from safety.prove.prove import Limits, prove

CLAIMS = {c.id: c for c in registered() if c.id.startswith("reversible_counter.")}
OWN = Limits(synthesis=0, simulation=0, portfolio=0)


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    found = prove(CLAIMS[name], OWN)
    assert found.as_expected, found.why
    assert found.verdict == REFUTED or (found.agreed_by == ["z3", "cvc5"] and found.premise_at is not None)


def told(
    speed: int, steps: int, limit: int = 530, n: int = 0, rest: int = 0, *, up: bool = True, down: bool = True
) -> list[int]:
    """The count before each step, from the words of the description."""
    phase, counts = 0, []
    for _ in range(steps):
        counts.append(n)
        phase, rest = phase + speed, rest + n
        pulse, carry = phase >= PULSE, rest >= DIVISOR
        phase, rest = phase % PULSE, rest % DIVISOR
        n = max(0, min(1023, n + (pulse and up) - (carry and down)))
    return counts


@pytest.mark.parametrize("kmh", [5, 70, 160, 250, 300])
def test_count_settles_at_f2_over_k_f1_and_follows_the_words(kmh: int) -> None:
    speed = kmh * PER_KMH
    seen = run(ReversibleCounter, {"speed": speed}, steps=16_000)
    assert seen["count"] == told(speed, 16_000)
    true_count = DIVISOR * kmh / 1000
    assert all(abs(n - true_count) < 2 for n in seen["count"][-2000:])
    assert seen["brake"][-1] == (seen["count"][-1] >= 530)


def test_time_constant_is_that_of_the_divider() -> None:
    """After 2048 steps the count has come 63.2 % of its way, to a pulse or two."""
    counts = told(300 * PER_KMH, 2049)
    assert counts[2048] == pytest.approx((1 - 2.718281828**-1) * 614.4, abs=2)


def test_the_sum_settles_at_the_printed_count_by_swinging() -> None:
    seen = run(PeriodicSum, {"pulses": 500}, steps=12)["count"]
    assert abs(seen[-1] - 500 / 1.25) <= 1
    assert seen[0] > 400 > seen[1]


def test_strong_feedback_swings_for_ever() -> None:
    seen = run(StrongFeedback, {"pulses": 500}, steps=40)["count"]
    assert seen[-1] != seen[-2] and seen[-1] == seen[-3]


def test_a_shorter_time_than_the_way_up_is_not_proved() -> None:
    """The lemmas carry their time and no shorter one, here for 50 % above nE."""
    whole = steps_to_brake(265)

    def fast(s: Seen) -> Bit:
        return reversible_counter.too_fast(s, 265)

    for steps, verdict in ((whole, PROVED), (whole - 200, "undecided")):
        stated = replace(
            CLAIMS[claim_id(reversible_counter.overspeed_by_a_pulse_brakes)],
            formula=lambda s, steps=steps: implies(persists(fast(s), steps), s.brake),
            lemmas=tuple(reversible_counter.climbing(265, fast)),
            witness=Scenario(whole + 1, {"speed": reversible_counter.at(530 + 265)}),
        )
        assert prove(stated, OWN).verdict == verdict


# --- single faults ---------------------------------------------------------------------------------------------------

WRONG = {  # what makes it not fail-safe, beside stages and bits
    "speed generator open or short", "speed pulses lost", "oscillator fast", "divider.carry stuck-at-1",
    "up stuck-at-0", "down stuck-at-1", "over stuck-at-0", "relay contact welded",
}  # fmt: skip


@pytest.fixture(scope="module")
def outcome() -> dict[str, str]:
    result = reversible_campaign.single_faults.inject()
    assert result.exhaustive and not result.surprises()
    return {found.faults[0].name: cell for found, cell in result.injections()}


def test_every_mode_is_injected(outcome: dict[str, str]) -> None:
    assert set(outcome) == {fault.name for faults in component_modes().values() for fault in faults}


def test_single_faults_that_are_wrong_side(outcome: dict[str, str]) -> None:
    wrong = {name for name, cell in outcome.items() if cell.startswith("wrong")}
    assert {name for name in wrong if "bit" not in name} == WRONG
    assert {cell for cell in outcome.values() if cell.endswith("/yes")} == set(), "nothing detects a fault"


@pytest.mark.parametrize(("name", "lines"), [("up stuck-at-0", {"up": False}), ("down stuck-at-0", {"down": False})])
def test_a_broken_line_by_the_words(outcome: dict[str, str], name: str, lines: dict[str, bool]) -> None:
    """Without pulses up the count decays and nothing brakes; without pulses down it climbs and brakes."""
    speed = reversible_counter.at(540)
    counts = told(speed, 20_000, n=520, **lines)
    assert (counts[-1] >= 530) == (name == "down stuck-at-0")
    assert outcome[name].startswith("safe" if counts[-1] >= 530 else "wrong")

"""The sense of rotation from two windings: verdicts, planted bugs, and the whole equipment by running it."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from models.ts7.train import PER_WORD, SCALE, Axle, Pulses, Speed
from models.ts7.windings import Windings, WoundTs7
from proofs import ts7_windings as windings
from proofs.ts7_formulas import Formula, at_least_kmh
from safety import PROVED, U8, Bit
from safety.faults import Fault, instrument
from safety.prove.claims import Claim
from safety.prove.prove import prove
from safety.system import ModelError
from safety.trace import run
from safety.tracing import trace
from tests.proofs.planted import refuted
from tests.proofs.verdicts import OWN_LEMMAS, check, claims_of, without_twin

CLAIMS = claims_of(windings)
LONG = ("without_a_winding_nothing_is_reported", "swapped_windings_never_report_a_roll_back")


@pytest.mark.parametrize(
    "claim", [pytest.param(c, marks=[pytest.mark.slow] if n in LONG else []) for n, c in CLAIMS.items()], ids=CLAIMS
)
def test_verdict(claim: Claim) -> None:
    check(prove(claim))


def test_every_proved_requirement_has_a_claim_that_fails() -> None:
    assert without_twin(CLAIMS) == []


@pytest.mark.parametrize("claim", [c for c in CLAIMS.values() if c.lemmas], ids=lambda c: c.formula.__name__)
def test_no_lemma_can_be_left_out(claim: Claim) -> None:
    for left_out in claim.lemmas:
        rest = tuple(lemma for lemma in claim.lemmas if lemma is not left_out)
        assert prove(replace(claim, lemmas=rest, steps=2), OWN_LEMMAS).verdict != PROVED, left_out.__name__


class Inverted(Windings, tick_s="125e-6"):
    """B low is taken for backward."""

    def step(self, speed: Speed, backward: Bit, wheel: U8) -> tuple[Windings, Pulses]:
        following, seen = super().step(speed, backward, wheel)
        return following, Pulses(seen.pulse, ~seen.backward)


class NeverSampled(Windings, tick_s="125e-6"):
    """The level of B is not taken over at an edge of A."""

    def step(self, speed: Speed, backward: Bit, wheel: U8) -> tuple[Windings, Pulses]:
        following, seen = super().step(speed, backward, wheel)
        kept = type(self)(phase=following.phase, was_high=following.was_high, reverse=self.reverse)
        return kept, Pulses(seen.pulse, self.reverse)


class NoFilter(Windings, tick_s="125e-6"):
    """The sense is that of B at every moment, not at the edges of A."""

    def step(self, speed: Speed, backward: Bit, wheel: U8) -> tuple[Windings, Pulses]:
        following, seen = super().step(speed, backward, wheel)
        quarter = SCALE // 4 * wheel
        return following, Pulses(seen.pulse, (following.phase >= quarter) & (following.phase < 3 * quarter))


@pytest.mark.parametrize(
    ("variant", "claim"),
    [
        (Inverted, windings.windings_report_no_roll_back_forward),
        (Inverted, windings.windings_report_eight_backward),
        (NeverSampled, windings.windings_report_eight_backward),
        (NoFilter, windings.windings_report_no_roll_back_forward),
    ],
)
def test_a_planted_bug_is_refuted(variant: type[Windings], claim: Formula) -> None:
    assert refuted(claim, {"axle": variant})


@pytest.mark.parametrize("backward", [False, True])
def test_the_pulses_are_those_of_the_axle_drawn_without_windings(backward: bool) -> None:
    """Forward edge by edge; backward the axle without windings turns forward too, so that only the number is equal."""
    row = {"speed": 60 * PER_WORD, "backward": backward, "wheel": 164}
    plain, wound = (run(m, row, 8000, start=s) for m, s in ((Axle, {}), (Windings, {"was_high": True})))
    assert abs(sum(plain["pulse"]) - sum(wound["pulse"])) <= 1
    assert backward or plain["pulse"] == wound["pulse"]
    assert set(wound["backward"][200:]) == {backward}


def test_speeds_too_fast_to_be_sampled_are_refused() -> None:
    with pytest.raises(ModelError, match="f_s below 2 kHz"):
        run(Windings, {"speed": SCALE // 4 * 164, "backward": False, "wheel": 164}, 1)


def ride(kmh: str, backward: bool, *faults: Fault) -> list[bool]:
    """EB of the whole equipment at signal 65: 0.3 s at rest, then one way at a speed for 0.5 s."""
    made = instrument(trace(WoundTs7), faults).system
    rows = (
        {**{f"lines.s{v}": v == 65 for v in (0, 25, 45, 65, 75, 90)}, "inverter": True, "mg": True,
         "speed": at_least_kmh(Fraction(kmh)) if k >= 2400 else 0, "backward": backward}
        for k in range(6400)
    )  # fmt: skip
    return run(made, rows, keep=["eb"])["eb"]


@pytest.mark.parametrize(
    ("kmh", "backward", "faults", "eb"),
    [
        ("8", True, [], True),
        ("4", True, [], False),
        ("60", False, [], False),
        ("30", True, [windings.B_LOW], False),
        ("30", True, [windings.A_DEAD[1]], False),
        ("30", False, [windings.B_HIGH], True),
        ("30", False, [windings.SWAPPED], True),
        ("30", True, [windings.SWAPPED], False),
    ],
)
def test_emergency_brake(kmh: str, backward: bool, faults: list[Fault], eb: bool) -> None:
    seen = ride(kmh, backward, *faults)
    assert not seen[2399] and seen[-1] is eb

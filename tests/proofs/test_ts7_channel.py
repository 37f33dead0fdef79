"""Claims about one channel: verdicts, lemmas a little tighter that must fail, and the response simulated."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from models.ts7.numbers import ROLLBACK_WORD, SPEEDS, WORD
from models.ts7.train import PER_WORD, SCALE
from proofs import ts7_channel as channel
from proofs import ts7_formulas as formulas
from proofs import ts7_rollback as rollback
from proofs.ts7_formulas import Formula, at_least_kmh, at_most_kmh, frames_for
from safety import PROVED, Bit, Seen
from safety.prove.claims import Claim
from safety.prove.induction import by_induction
from safety.prove.problem import build_problem
from safety.prove.prove import prove
from tests.proofs.verdicts import SHORT, check, claims_of, without_twin

CLAIMS = {**claims_of(channel), **claims_of(rollback)}


@pytest.mark.parametrize("claim", CLAIMS.values(), ids=list(CLAIMS))
def test_verdict(claim: Claim) -> None:
    check(prove(claim))


def test_every_proved_requirement_has_a_claim_that_fails() -> None:
    assert without_twin(CLAIMS) == []


def one_more(s: Seen) -> Bit:
    """Wheel set right; at most 1/4096 word above the limit."""
    return channel.wheel_set_right(s) & (channel.excess(s) <= 1)


def one_less(s: Seen) -> Bit:
    """Wheel set right; at most 1/4096 word below the limit."""
    return channel.wheel_set_right(s) & (channel.excess(s) >= -1)


@pytest.mark.parametrize(
    ("claim", "given"), [(channel.never_brakes_falsely, one_more), (channel.never_releases_falsely, one_less)]
)
def test_one_unit_of_speed_too_much_is_not_proved(claim: Formula, given: Formula) -> None:
    found = prove(replace(CLAIMS[claim.__name__], given=given, steps=4), SHORT)
    assert found.verdict != PROVED
    assert found.candidate


def brakes_by(units: int = channel.ABOVE) -> bool:
    """Whether the written lemmas with this rate prove, without any search, that the channel brakes."""
    rises = formulas.rising(channel.two_above, units, frames_for(channel.ABOVE))
    return by_lemmas(channel.brakes_two_kmh_above, rises)


def releases_by(units: int = channel.BELOW) -> bool:
    """Whether the written lemmas with this rate prove, without any search, that the channel releases."""
    falls = formulas.falling(channel.two_below, units, frames_for(channel.BELOW))
    return by_lemmas(channel.releases_two_kmh_below, falls)


def by_lemmas(claim: Formula, lemma: Formula) -> bool:
    problem = build_problem(replace(CLAIMS[claim.__name__], lemmas=(channel.LATCH, lemma)))
    return by_induction(problem, 1, True, 30.0, ("z3", "cvc5")).proved


@pytest.mark.parametrize(
    ("name", "proved_by"),
    [
        ("REFERENCE_FRACTION", brakes_by),
        ("SPEED_FRACTION", releases_by),
        ("PULSE", brakes_by),
        ("PULSE", releases_by),
    ],
)
def test_a_lemma_one_unit_tighter_is_not_proved(
    name: str, proved_by: Callable[[], bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert proved_by()
    monkeypatch.setattr(formulas, name, getattr(formulas, name) - 1)
    assert not proved_by()


@pytest.mark.parametrize("part", ["comparator.u", "ring.j1", "ring.j0", "div0.n"])
def test_a_potential_without_one_of_its_parts_is_not_proved(part: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def poorer(s: Seen, name: str = "a", race: formulas.Race = formulas.BRAKE) -> object:
        weight = {"comparator.u": formulas.PULSE, "ring.j1": SCALE, "ring.j0": -PER_WORD, "div0.n": -256 * PER_WORD}
        return whole(s, name, race) - weight[part] * s[name][part].int()

    assert brakes_by()
    whole = formulas.potential
    monkeypatch.setattr(formulas, "potential", poorer)
    assert not brakes_by()


@pytest.mark.parametrize(("proved_by", "units"), [(brakes_by, channel.ABOVE), (releases_by, channel.BELOW)])
def test_a_rate_one_unit_greater_is_not_proved(proved_by: Callable[[int], bool], units: int) -> None:
    assert proved_by(units)
    assert not proved_by(units + 1)


def test_margins_and_times() -> None:
    assert (channel.ABOVE, frames_for(channel.ABOVE)) == (17_115, 4576)
    assert (channel.BELOW, frames_for(channel.BELOW)) == (15_365, 5098)
    assert (rollback.ABOVE, frames_for(rollback.ABOVE)) == (24_480, 3200)
    assert (rollback.BELOW, frames_for(rollback.BELOW)) == (10_289, 7612)


def slowest(speed: int, word: int, wheel: int, released: bool, phases: int = 2000) -> int:
    """Frames until the latch of the last of many channels moves, from random phases; written without the model."""
    random = np.random.default_rng(7)
    axle = random.integers(0, SCALE * wheel, phases)
    axle[::2] = 0
    accv, acc, pd = (random.integers(0, n, phases) for n in (256, 256, 16))
    u = np.full(phases, 0 if released else 3)
    moved = np.zeros(phases, bool)
    for frame in range(1, 20_000):
        axle += speed
        s = axle >= SCALE * wheel
        axle -= s * SCALE * wheel
        accv += s * wheel
        up = accv >= 256
        accv -= up * 256
        acc += word
        carry = acc >= 256
        acc -= carry * 256
        pd += carry
        down = pd == 16
        pd -= down * 16
        u = np.clip(u + (up & ~down) - (down & ~up), 0, 3)
        moved |= u == (3 if released else 0)
        if moved.all():
            return frame
    raise AssertionError("never")


@pytest.mark.parametrize("wheel", [156, 164, 166, 172])
@pytest.mark.parametrize("speed", SPEEDS)
def test_simulated_response_keeps_the_printed_time(speed: int, wheel: int) -> None:
    """Worst of 150 000 phases for each of the nine wheels, run apart: 2107 frames to brake, 2242 to release."""
    assert slowest(at_least_kmh(speed + 2), WORD[speed], wheel, released=True) <= 2107
    assert slowest(at_most_kmh(speed - 2), WORD[speed], wheel, released=False) <= 2242


@pytest.mark.parametrize("wheel", [156, 162, 172])
def test_simulated_roll_back_keeps_the_printed_time(wheel: int) -> None:
    assert slowest(at_least_kmh(8), ROLLBACK_WORD, wheel, released=True) <= 1985


def test_simulated_creeping_is_as_slow_as_proved() -> None:
    assert slowest(at_least_kmh(2), 0, 172, released=True) == channel.EXACT

"""Radio control: what its acceptance checks ask, on the models, and the rules that refuse parameters."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from random import Random
from typing import Any

import pytest

from models.kinematics import B_SERVICE, CYCLE, KMH, T_SERVICE, ceiling, ceiling_accelerating, kmh, mps
from models.radio import Supervised, TwoTrains
from models.radio.headway import (
    best_speed,
    fixed_block,
    least_headway,
    moving_block,
    run_after_loss,
    staleness,
    t_loss,
)
from models.radio.ride import CATCHING_UP, CHANNELS, ROLLING_BACK, TRAIN, UNIT, commissioned, motion, ride
from proofs import radio_authority, radio_laws, radio_moving_block
from safety import ModelError
from safety.prove.bounds.claims import declared
from safety.prove.claims import claim_id, registered
from safety.prove.outcome import Outcome
from safety.prove.prove import prove
from safety.trace import Live

SLOW, FAST = Fraction("2.5") * KMH, Fraction("3.5") * KMH
LONG = Fraction(400)


def proved(formula: Any) -> Outcome:
    """The outcome of a claim of a proof file."""
    return prove(next(each for each in registered() if each.id == claim_id(formula)))


def law(formula: Any) -> dict[str, Any]:
    """The result of a law."""
    return next(each for each in declared() if each.id == claim_id(formula)).found(20.0)


# --- acceptance checks -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("found", "printed"),
    [
        (least_headway(SLOW).middle, "31.83"),
        (moving_block(mps(100), SLOW), "34.00"),
        (least_headway(FAST).middle, "27.68"),
        (moving_block(mps(100), FAST), "28.29"),
        (moving_block(mps(270), SLOW, LONG), "65.00"),
        (moving_block(mps(270), FAST, LONG), "49.57"),
        (fixed_block(mps(100)), "55.40"),
        (kmh(best_speed(SLOW).middle), "67.08"),
        (kmh(best_speed(FAST).middle), "79.37"),
        (staleness(mps(100)), "41.67"),
        (staleness(mps(270)), "112.50"),
        (staleness(mps(270), Fraction(3), Fraction(1)), "300.00"),
        (run_after_loss(mps(100)), "694.44"),
    ],
)
def test_as_13_headways_and_staleness(found: Fraction, printed: str) -> None:
    assert f"{float(found):.2f}" == printed


def test_as_13_the_roots_are_enclosed() -> None:
    for b in (SLOW, FAST):
        best, least = best_speed(b), least_headway(b)
        assert best.low**2 <= 2 * b * 250 <= best.high**2
        assert moving_block(best.middle, b) >= least.low
        assert all(moving_block(mps(v), b) > least.high for v in range(10, 300, 10))


def test_as_14_ar_1_is_proved_ar_2_refuted_ar_3_proved() -> None:
    assert law(radio_laws.stop_point_lies_behind_the_leader)["verdict"] == "proved"
    assert law(radio_laws.even_where_the_leader_rolls_back_20_m)["verdict"] == "refuted"
    for formula in (
        radio_authority.stays_within_its_authority,
        radio_moving_block.the_follower_never_passes_the_leader,
    ):
        outcome = proved(formula)
        assert (outcome.verdict, sorted(outcome.agreed_by)) == ("proved", ["cvc5", "z3"])


def test_ar_2_the_exact_witness() -> None:
    """rep = 12, rear = 0, head at 1/2: all premises hold, and the head is past the rear."""
    from safety import real

    witness = [real(x) for x in (12, 0, Fraction(2), Fraction(1, 2), Fraction(3, 2))]
    assert radio_laws.even_where_the_leader_rolls_back_20_m(*witness).attr is False
    assert radio_laws.even_where_the_leader_rolls_back_20_m(*[real(x) for x in (12, 8, 2, 1, 1)]).attr is True


def standing(speed: Fraction) -> dict[str, Any]:
    """A train 1000 m before the end of its authority, on the move."""
    return {"unit.limit": Fraction(1000), "unit.stamp": Fraction(0), "train.speed": speed,
            "train.left": T_SERVICE + CYCLE,
            "train.rear": Fraction(-200), "train.furthest": Fraction(-200)}  # fmt: skip


def shortened(speed: Fraction, place: Fraction, stamp: Fraction = Fraction(1)) -> dict[str, Any]:
    """What the unit does with a shorter authority."""
    live = Live(Supervised, start=standing(speed))
    came = {"came.comes": True, "came.stamp": stamp, "came.place": place, "now": Fraction(1)}
    order = {"order.ordered": False, "order.place": Fraction(0)}
    return live.shown(came | order | motion("motion", speed, Fraction(0))) | {"then": live.state["unit.limit"]}


def test_as_16_an_authority_that_cannot_be_kept_is_not_shortened() -> None:
    place, reaction = Fraction(400), T_SERVICE + 2 * CYCLE
    greatest = ceiling_accelerating(place, B_SERVICE, reaction, Fraction("0.8"))
    taken, refused = shortened(greatest.low, place), shortened(greatest.high + Fraction(1, 10**6), place)
    assert (taken["shortened"], taken["then"], taken["brake"]) == (True, place, False)
    assert (refused["shortened"], refused["then"]) == (False, Fraction(1000))
    above = shortened(ceiling(place, B_SERVICE, T_SERVICE).high + Fraction(1, 10**6), place)  # v_p(x_new)
    assert (above["shortened"], above["then"]) == (False, Fraction(1000))


def test_an_old_authority_is_not_taken_and_a_longer_one_at_once() -> None:
    assert shortened(Fraction(0), Fraction(400), stamp=Fraction(0))["then"] == 1000
    assert shortened(mps(100), Fraction(1400))["then"] == 1400


# --- rides -----------------------------------------------------------------------------------------------------------


def test_the_follower_keeps_behind_the_leader_and_its_authority() -> None:
    rows = ride(CATCHING_UP)
    for row in rows:
        assert row[f"{TRAIN}.head"] <= row[f"{UNIT}.limit"] <= row["leader.rear"] - 50
    first_lost = next(row for row in rows if row["follower.driven.radio_lost"])
    assert first_lost["follower.driven.brake"]
    assert Fraction(199) + 3 < first_lost["s"] <= Fraction(199) + 3 + CYCLE  # the last one heard was sent at 199 s


def test_a_leader_that_rolls_back_further_than_allowed_for_is_hit() -> None:
    rows = ride(ROLLING_BACK)
    hit = [row["s"] for row in rows if row[f"{TRAIN}.head"] > row["leader.rear"]]
    assert hit and hit[0] > 160
    assert all(row[f"{TRAIN}.head"] <= row[f"{UNIT}.limit"] for row in rows)


# --- what is refused -------------------------------------------------------------------------------------------------


def test_a_t_loss_that_regular_traffic_exceeds_is_refused() -> None:
    settings = {"follower.driven.unit.t_loss": Fraction(3, 2)}
    with pytest.raises(
        ModelError, match=r"T_loss covers a period, the latency and a cycle.*nearest admissible t_loss is 1\.6 s"
    ):
        Live(TwoTrains, start=commissioned(Fraction(1000), Fraction(50)), settings=settings)
    with pytest.raises(ModelError, match=r"T_loss = 1\.5 s: .* nearest admissible value is 1\.6 s"):
        t_loss(Fraction(3, 2))
    assert t_loss(Fraction(16, 10)) == Fraction(16, 10)


@pytest.mark.parametrize(
    ("setting", "value", "nearest"),
    [
        ("follower.cell.margin", -1, "0"),
        ("follower.cell.allowance", 101, "100"),
        ("follower.driven.train.b", Fraction(1, 20), "1/10"),
        ("leader.roll_back", -5, "0"),
    ],
)
def test_parameters_out_of_range_are_refused(setting: str, value: Any, nearest: str) -> None:
    with pytest.raises(ModelError, match=f"nearest admissible value is {nearest}"):
        Live(TwoTrains, start=commissioned(Fraction(1000), Fraction(50)), settings={setting: value})


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: moving_block(Fraction(0), SLOW), "speed = 0 m/s"),
        (lambda: moving_block(mps(100), Fraction(0)), "deceleration = 0"),
        (lambda: least_headway(SLOW, margin=Fraction(-1)), "margin = -1 m"),
        (lambda: run_after_loss(mps(100), Fraction(-1)), "T_loss = -1 s"),
        (lambda: staleness(mps(-100)), "speed = -27.7778"),
    ],
)
def test_headways_of_what_cannot_be_are_refused(call: Any, said: str) -> None:
    with pytest.raises(ModelError, match=said):
        call()


# --- a random adversary ----------------------------------------------------------------------------------------------


def adversary(rng: Random, settings: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """A ride under random air, wishes and drivers."""
    live = Live(TwoTrains, start=commissioned(Fraction(120), Fraction(20)), settings=settings)
    channels = [f"air.{channel}" for channel in CHANNELS]
    barrier = Fraction(10**6)
    for k in range(900):
        state = live.state
        if k % 60 == 0:  # long enough for a request to be acknowledged
            barrier = rng.choice((Fraction(10**6), state[f"{TRAIN}.head"] + rng.randrange(60)))
        row: dict[str, Any] = {f"{c}.{name}": rng.random() < 0.3 for c in channels for name in ("keep_one", "keep_two")}
        row |= {f"{c}.{name}": rng.random() < 0.5 for c in channels for name in ("deliver", "second")}
        row |= {"wish.barrier": barrier, "braked": False}
        row |= {"wish.set_back": rng.random() < 0.1, "wish.to": state["leader.rear"] - rng.randrange(60)}
        row |= {"beyond": 0, "order.ordered": False, "order.place": 0}
        braking = state[f"{TRAIN}.left"] < CYCLE
        wanted = -B_SERVICE * rng.randint(1, 2) if braking else Fraction(rng.randint(-2, 8), 10)
        row |= motion("behind", state[f"{TRAIN}.speed"], wanted)
        back = Fraction(rng.randrange(5)) if rng.random() < 0.1 else 0
        row |= motion("ahead", state["leader.speed"], Fraction(rng.randint(-8, 8), 10), back)
        yield live.shown(row)


@pytest.mark.parametrize("seed", (0, 4, 5))
def test_no_random_adversary_brings_the_trains_together(seed: int) -> None:
    settings = {"leader.roll_back": 10, "follower.cell.allowance": 10, "follower.cell.margin": 0}
    rows = list(adversary(Random(seed), settings))
    assert all(row[f"{TRAIN}.head"] <= row[f"{UNIT}.limit"] <= row["leader.rear"] for row in rows)
    assert rows[-1][f"{TRAIN}.head"] > 20  # it does run
    assert any(row["follower.driven.shortened"] for row in rows)
    assert any(row["follower.cell.sets_back"] for row in rows)


def test_the_random_adversary_finds_a_missing_allowance() -> None:
    settings = {"leader.roll_back": 40, "follower.cell.allowance": 0, "follower.cell.margin": 0}
    runs = (adversary(Random(seed), settings) for seed in range(5))
    assert any(row[f"{TRAIN}.head"] > row["leader.rear"] for run in runs for row in run)

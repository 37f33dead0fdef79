"""ATS-SP supervision: targets, patterns, brakes; a train that is driven into the pattern; planted slips."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from models.ats.ride import GuardRide, NearEndRide, NoFreeRunRide
from models.ats.supervision import Supervision
from models.ats.variants import BlindAtAPlace, BlindMovesOn
from models.kinematics import ACCELERATION, B_SERVICE, MARGIN, T_SERVICE, ceiling, mps
from proofs import ats_supervision, ats_supervision_targets
from safety import PROVED, ModelError, run
from safety.prove.bounds.claims import declared
from safety.trace import Live
from tests.models.ts7.test_readings import direct_and_python_agree
from tests.proofs.verdicts import OWN_LEMMAS, check, claims_of, of

CYCLE, ACTS, PLACE = Fraction(1, 10), Fraction("1.9"), 600
OFF = dict.fromkeys(("ended", "freed", "others.over", "others.far_over"), False) | {"others.kept": True}


@pytest.mark.parametrize("model", [Supervision, GuardRide])
def test_direct_and_python_agree(model: Any) -> None:
    direct_and_python_agree(model)


class Drive:
    """A train in a GuardRide, driven by its driver until the brake is ordered; b_s after the free run."""

    def __init__(self, model: Any, head: Fraction, speed: Fraction, **settings: Any) -> None:
        self.live = Live(model, start={"train.head": head, "train.speed": speed}, settings=settings)
        self.head, self.speed, self.ordered, self.made = head, speed, Fraction(0), False

    def cycle(self, throttle: Fraction, *, short: Fraction = Fraction(0), b: Fraction = B_SERVICE) -> bool:
        """One cycle; `short`: how far the interval ends before the train.  Whether the brake was ordered."""
        reached = max(Fraction(0), self.speed + throttle * CYCLE)
        read = max(self.speed, reached)
        roll, way = read * ACTS, read * read / (2 * B_SERVICE)
        inputs = OFF | {
            "made": not self.made, "freed": not self.made, "where.low": self.head, "where.guess": self.head,
            "where.high": self.head - short, "where.fastest": read, "where.slowest": self.speed,
            "course.roll": roll, "course.way": way,
        }  # fmt: skip
        order = self.ordered > 0 or read * read + 2 * B_SERVICE * read * T_SERVICE > 2 * B_SERVICE * (
            PLACE - MARGIN - self.head + short
        )
        rolled, braked = (self.speed + reached) * CYCLE / 2, Fraction(0)
        if order:
            self.ordered += CYCLE
            if self.ordered <= ACTS:
                rolled, reached = self.speed * CYCLE, self.speed
            else:
                reached = max(Fraction(0), self.speed - b * CYCLE)
                rolled, braked = Fraction(0), (self.speed**2 - reached**2) / (2 * b)
        values = self.live.step(inputs | {"course.rolled": rolled, "course.braked": braked, "course.speed": reached})
        self.made, self.head, self.speed = True, self.head + rolled + braked, reached
        seen = dict(zip(self.live.paths, values, strict=True))
        assert seen["order"] == order
        return bool(seen["order"])


@pytest.mark.parametrize("throttle", ["0", "0.8", "-0.2"])
def test_a_train_that_is_driven_into_the_pattern_stands_before_the_margin(throttle: str) -> None:
    drive = Drive(GuardRide, Fraction(-500), mps(90))
    ordered = [drive.cycle(Fraction(throttle) if drive.ordered == 0 else Fraction(0)) for _ in range(900)]
    assert any(ordered[1:]) and drive.speed == 0
    assert PLACE - MARGIN - 20 < drive.head <= PLACE - MARGIN


def test_an_interval_that_ends_short_of_the_train_lets_it_overrun() -> None:
    drive = Drive(GuardRide, Fraction(-500), mps(90))
    for _ in range(900):
        drive.cycle(Fraction(0), short=Fraction(30))
    assert drive.speed == 0 and PLACE < drive.head <= PLACE + 20 + CYCLE * mps(90)


def test_the_premise_of_no_traction_20_m_out() -> None:
    """At 4 m/s the pattern permits 20 m; with 0.8 m/s^2 in the free run the train needs more."""
    v, reached = Fraction(4), 4 + ACCELERATION * T_SERVICE
    assert v <= ceiling(Fraction(20), B_SERVICE, T_SERVICE).low
    way = (v + reached) * T_SERVICE / 2 + reached * reached / (2 * B_SERVICE)
    assert way - 20 > 12


def asked(v: Fraction, at: Fraction, **settings: Any) -> dict[str, Any]:
    """What supervision orders with the home target made, at a speed and a place."""
    flags = dict.fromkeys(
        ("clear_read", "release_read", "phase_released", "branch_read", "stray_stop", "station_made", "station_ended"),
        False,
    )
    here = {"where.low": at, "where.guess": at, "where.high": at}

    def row(k: int) -> dict[str, Any]:
        events = {f"events.{name}": value for name, value in flags.items()}
        speed = {"where.fastest": v if k else 0, "where.slowest": v if k else 0}
        return events | here | speed | {"events.stop_read": k == 1, "events.reset": k == 0}

    return run(Supervision, row, 2, settings=settings).row(1)


@pytest.mark.parametrize("x", [50, 100, 200, 400])
def test_service_comes_first_then_emergency(x: int) -> None:
    """One cycle above v_p gives the service brake, above v_pe the emergency brake, at equality neither."""
    for b, t, which in ((B_SERVICE, T_SERVICE, "service"), (Fraction(35, 36), Fraction(3, 2), "emergency")):
        pattern = ceiling(x - MARGIN, b, t)
        assert not asked(pattern.low, Fraction(600 - x))[which]
        assert asked(pattern.high + Fraction(1, 10**9), Fraction(600 - x))[which]
    assert not asked(ceiling(x - MARGIN, B_SERVICE, T_SERVICE).high + Fraction(1, 10**9), Fraction(600 - x))[
        "emergency"
    ]


@pytest.mark.parametrize(
    ("model", "settings", "says"),
    [
        (Supervision, {"switch_at": 900}, "nearest admissible switch_clear is 900 m"),
        (Supervision, {"b_e": Fraction(1, 2)}, "nearest admissible b_e is 0.694445 m/s"),
        (Supervision, {"t_s": 1}, "nearest admissible t_s is 1.5 s"),
        (GuardRide, {"train.acts": 3}, "nearest admissible t_s is 3.1 s"),
        (Supervision, {"margin": -1}, "nearest admissible value is 0"),
    ],
)
def test_what_it_cannot_honour_is_refused(model: Any, settings: dict[str, Any], says: str) -> None:
    with pytest.raises(ModelError, match=says):
        run(model, {}, 1, settings=settings)


@pytest.mark.parametrize("module", [ats_supervision, ats_supervision_targets], ids=lambda m: m.__name__)
def test_proofs_have_both_solvers(module: Any) -> None:
    for claim in claims_of(module).values():
        if claim.expect == PROVED:
            check(of(claim.formula, OWN_LEMMAS))


def test_laws() -> None:
    laws = [one for one in declared() if one.id.startswith("ats_supervision_targets.")]
    assert [one.found(30)["verdict"] for one in laws] == [one.expect for one in laws] == [PROVED, "refuted"]


def blind_left(model: Any, jump: int) -> tuple[list[Fraction], list[bool]]:
    """What is left to the blind target of a train at 10 m/s: made at 10 m, again at 90 m; its place is told `jump` m
    nearer from 120 m on."""
    flags = (
        "stop_read",
        "clear_read",
        "release_read",
        "phase_released",
        "branch_read",
        "station_made",
        "station_ended",
    )

    def row(k: int) -> dict[str, Any]:
        at = Fraction(k) - jump * (k >= 120)
        where = dict.fromkeys(("where.low", "where.guess", "where.high"), at)
        speed = {"where.fastest": 10 * (k > 0), "where.slowest": 0}
        events = dict.fromkeys((f"events.{flag}" for flag in flags), False)
        return events | where | speed | {"events.stray_stop": k in (10, 90), "events.reset": k == 0}

    told = run(model, row, 200)
    return told["blind.target.left"][10:], told["service"][10:]


@pytest.mark.parametrize("jump", [0, 500, -500])
def test_nothing_but_the_way_run_moves_the_blind_target(jump: int) -> None:
    left, service = blind_left(Supervision, jump)
    assert left == [179 - k for k in range(190)]
    need = 10 * T_SERVICE + 100 / (2 * B_SERVICE)
    assert service == [each - MARGIN < need for each in left]


def test_as_it_was_a_fix_or_another_stop_released_its_brake() -> None:
    service = blind_left(BlindAtAPlace, 500)[1]
    assert service[109] and not any(service[110:])
    assert blind_left(BlindMovesOn, 0)[0][80] == 179


@pytest.mark.parametrize("slip", [NearEndRide, NoFreeRunRide])
def test_a_planted_slip_breaks_av_1(slip: Any) -> None:
    assert of(ats_supervision.signal_is_never_passed, OWN_LEMMAS, model=slip, expect="refuted").as_expected

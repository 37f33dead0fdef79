"""Radio control: the weakest margin, allowance and T_loss, each with the proof that one step beyond is unsafe.

Source: sections 9 and 10 [P]; rolling back 20 m, the targets of 5 s and of 700 m, b, free run, 100 km/h [A].

As found: without allowance a margin of 20 m bears a leader that rolls back 20 m, 19 m do not; so does an allowance of
20 m without margin.  T_loss = 5 s is the greatest with which no train runs unbraked on messages older than 5 s; 3.2 s
the greatest with which a train at 100 km/h or less stands within 700 m of where it was when the last was sent.
"""

from __future__ import annotations

from fractions import Fraction

from models.kinematics import B_SERVICE, T_SERVICE, mps, need
from models.radio import Supervised, TwoTrains
from proofs.radio_authority import in_order
from proofs.radio_formulas import TWO
from safety import PROVED, Bit, Seen, all_of, implies, real
from safety.prove.bounds import Bound, between, reals
from safety.prove.claims import Claim
from safety.prove.weakest import ABOVE, BELOW, weakest_of, weakest_real

ROLLS_BACK = 20  # m [A]
TOO_OLD = 5  # s [A]
SOURCE = "[D] section 10, AR-1 and AR-2; [A] rolls back 20 m"


def apart(name: str, value: int, margin: bool) -> Claim:
    """The claim that a follower keeps clear of that leader, margin or allowance from a value on, the other one 0."""

    def given(s: Seen) -> Bit:
        """The follower keeps its authority; the leader rolls back up to 20 m; the distance is at least the value."""
        cell = s.follower.cell
        held, none = (cell.margin, cell.allowance) if margin else (cell.allowance, cell.margin)
        rolls = TWO.keeps_its_authority(s) & (s.leader.roll_back == ROLLS_BACK)
        return all_of(rolls, (held >= value), (none == 0))

    return Claim(
        f"radio_synthesis.{name}_{value}", TwoTrains, TWO.never_passed,
        "The follower never passes a leader that rolls back up to 20 m.", PROVED, "AR-2", SOURCE,
        given=given, start=TWO.commissioned, lemmas=tuple(TWO.lemmas()), symbolic=TWO.left_open, steps=3,
    )  # fmt: skip


@weakest_of("follower.cell.margin", safe=ABOVE, within=(15, 25), unit="m", covers=True,
            at={"rolls back": "20 m", "allowance": "0 m"})  # fmt: skip
def least_margin(value: int) -> Claim:
    """The follower never passes a leader that rolls back up to 20 m, with so much margin and no allowance."""
    return apart("least_margin", value, margin=True)


@weakest_of("follower.cell.allowance", safe=ABOVE, within=(15, 25), unit="m", covers=True,
            at={"rolls back": "20 m", "margin": "0 m"})  # fmt: skip
def least_allowance(value: int) -> Claim:
    """The follower never passes a leader that rolls back up to 20 m, with so much allowance and no margin."""
    return apart("least_allowance", value, margin=False)


@weakest_of("unit.t_loss", safe=BELOW, within=(2, 10), unit="s", covers=True, at={"too old": "5 s"})
def greatest_t_loss(value: int) -> Claim:
    """No train runs without brake when the newest message that it holds, or that arrives, is older than 5 s."""

    def given(s: Seen) -> Bit:
        """T_loss is at most the value."""
        return all_of(s.unit.t_loss <= value)

    def braked(s: Seen) -> Bit:
        fresh = s.came.comes & (s.now - s.came.stamp <= TOO_OLD)
        return implies((s.now - s.unit.stamp > TOO_OLD) & ~fresh, s.brake)

    return Claim(
        f"radio_synthesis.greatest_t_loss_{value}", Supervised, braked,
        "No train runs without brake on messages older than 5 s.", PROVED, "AR-7", "[D] section 9, R3; [A] 5 s",
        given=given, start=in_order, symbolic=("unit.t_loss",), steps=3,
    )  # fmt: skip


v, t_loss = reals("v t_loss")
run_on = Bound(
    "radio_synthesis.run_on", "Way from the stamp of the last message to the standstill (m)",
    quantity=2 * B_SERVICE * v * t_loss + need(v, B_SERVICE, T_SERVICE), per=real(2 * B_SERVICE),
    given=(between(0, v, mps(100)), between(0, t_loss, 10)), requirement="AR-7",
    source="[D] section 9, distance run after loss; [A] 700 m, brakes",
)  # fmt: skip
weakest_real(
    run_on, 700, t_loss, safe=BELOW, within=(0, 10), gap=Fraction(1, 1000), unit="s",
    id="radio_synthesis.greatest_t_loss_at_100_km_h", at={"speed": "100 km/h or less", "way": "700 m"},
)  # fmt: skip

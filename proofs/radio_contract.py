"""Radio control: a train stays within its authority, of every brake, acceleration, free run and T_loss in their range.

`radio_authority` proves the same of the trains as assumed.  With the parameters open, that the stop fits is kept by a
step only through products of three of them; so it is proved of `Watched`, the same train with an observer of the cycle
before, in short steps: the stop fitted when the cycle began (`stop_fitted_by_*`); the stop from where the cycle could
end, and its way, are no longer than that (`way_is_paid_by_*`); the stop that is left is no longer (`slower`).
Lemmas are stated in products that both sides share, so that each step is linear in them or has few numbers.
`watched_differences` checks term by term, without a solver, that the train watched is the train.
Source: section 9, R1 to R3; section 10, AR-3; ranges of b, a, free run, T_loss [A].
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from models.kinematics import ACCELERATION, B_SERVICE, CYCLE, T_SERVICE, Quantity, need_accelerating
from models.radio import Supervised
from models.radio.watched import Watched
from proofs.radio_formulas import braking_fits, reacts_in_time, within_authority
from proofs.radio_line import open_system, otherwise, unshared
from safety import (
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Model,
    Scenario,
    Seen,
    all_of,
    any_of_faults,
    byzantine,
    claim,
    implies,
    reads,
    stuck,
)

ASSUMED = "[A] ranges of b, a, free run, T_loss"
OPEN = ("driven.unit.t_loss", "driven.train.b", "driven.train.a", "driven.train.free_run")


def stop_left(s: Seen) -> Quantity:
    """2 b times the way to a stop from here, with what is left of the reaction time."""
    t = s.driven.train
    return need_accelerating(t.speed, t.b, t.left, t.a)


def stop_after(s: Seen) -> Quantity:
    """The same from the speed reached, a cycle of the reaction time later."""
    t = s.driven.train
    return need_accelerating(s.reached, t.b, s.time - CYCLE, t.a)


def reacts(s: Seen) -> Bit:
    return reacts_in_time(s.driven, s.driven.train.free_run)


def way_fits(s: Seen) -> Bit:
    return all_of(2 * s.driven.train.b * s.way <= s.needed)


def moves(s: Seen) -> Bit:
    t = s.driven.train
    forward = all_of(t.speed <= s.reached, t.head - s.head <= s.way, s.way >= 0, s.time >= 0)
    return forward & implies(s.acted, t.left == 0) & implies(~s.acted, (s.time >= CYCLE) & (t.left == s.time - CYCLE))


def goes_no_further(s: Seen) -> Bit:
    t = s.driven.train
    return all_of(2 * t.b * (t.head - s.head) <= 2 * t.b * s.way)


def slower(s: Seen) -> Bit:
    braked = stop_left(s) <= s.reached * s.reached
    return implies(s.acted, braked) & implies(~s.acted, stop_left(s) <= stop_after(s))


def room(s: Seen) -> Quantity:
    """2 b times the way from where the cycle began to the end of the authority."""
    return 2 * s.driven.train.b * (s.driven.unit.limit - s.head)


def stop_fitted_by_demand(s: Seen) -> Bit:
    return implies(s.demanded, s.needed <= 2 * s.driven.train.b * (s.held - s.head))


def authority_reaches(s: Seen) -> Bit:
    b = s.driven.train.b
    return implies(s.demanded & ~s.shorter, 2 * b * s.held <= 2 * b * s.driven.unit.limit)


def stop_fitted_by_shortened(s: Seen) -> Bit:
    return implies(s.demanded & s.shorter, s.needed <= room(s))


def stop_fitted_by_ceiling(s: Seen) -> Bit:
    return implies(~s.demanded, s.needed <= room(s))


def way_is_paid_by_the_brake(s: Seen) -> Bit:
    return implies(s.acted, s.reached * s.reached + 2 * s.driven.train.b * s.way <= s.needed)


def way_is_paid_by_the_time(s: Seen) -> Bit:
    return implies(~s.acted, stop_after(s) + 2 * s.driven.train.b * s.way <= s.needed)


TIMER = Fault(byzantine(), ["driven.unit.lost"])
LEMMAS = (reacts, way_fits, moves, slower, goes_no_further, stop_fitted_by_demand, authority_reaches,
          stop_fitted_by_shortened, stop_fitted_by_ceiling, way_is_paid_by_the_brake,
          way_is_paid_by_the_time)  # fmt: skip


def in_order(s: Seen) -> Bit:
    """Power-up: in motion or not, the stop fits; what the observer begins with is defined by that, for any train."""
    t = s.driven.train
    observer = all_of(s.head == t.head, s.way == 0, s.reached == t.speed, s.time == t.left + CYCLE,
                      s.needed == stop_left(s))  # fmt: skip
    return reacts(s) & braking_fits(s.driven, t.b, t.a) & observer


@claim(Watched, expect=PROVED, requirement="AR-3", source="[D] section 10; " + ASSUMED, start=in_order,
       lemmas=LEMMAS, symbolic=OPEN, faults=any_of_faults([TIMER]))  # fmt: skip
def stays_within_its_authority(s: Seen) -> Bit:
    """Of any b, a, free run, T_loss in range, whatever comes or is lost: no head beyond its authority."""
    return within_authority(s.driven)


# --- every premise is needed -----------------------------------------------------------------------------------------


NO_FREE_RUN = Fault(reads(2 * CYCLE), ["driven.unit.reaction"])
CREEP = Fraction(1, 10)  # m/s
TRAIN = {"driven.train.b": B_SERVICE, "driven.train.a": ACCELERATION, "driven.train.free_run": T_SERVICE,
         "driven.unit.t_loss": 3}  # fmt: skip
LATE = Scenario(
    12, {"motion.way": CREEP * CYCLE, "motion.reached": CREEP}, present=[NO_FREE_RUN.name],
    start=TRAIN | {
        "driven.unit.limit": CREEP, "driven.train.speed": CREEP, "driven.train.left": CYCLE, "reached": CREEP,
        "time": 2 * CYCLE, "needed": need_accelerating(CREEP, B_SERVICE, CYCLE, ACCELERATION),
    },
)  # fmt: skip


@claim(Watched, expect=REFUTED, requirement="AR-3", source=ASSUMED, start=in_order, symbolic=OPEN, scenario=LATE,
       twin_of=stays_within_its_authority, faults=any_of_faults([NO_FREE_RUN]))  # fmt: skip
def within_it_even_without_counting_the_free_run(s: Seen) -> Bit:
    """The train stays within its authority where the unit's pattern leaves out the free run of the brake."""
    return stays_within_its_authority(s)


@claim(Watched, expect=REFUTED, requirement="AR-3", source=ASSUMED, start=in_order, symbolic=OPEN,
       twin_of=stays_within_its_authority,
       faults=any_of_faults([Fault(reads(B_SERVICE / 100), ["driven.train.brake_force"])]))  # fmt: skip
def within_it_even_with_a_weaker_brake(s: Seen) -> Bit:
    """The train stays within its authority where the brake gives less than any that the unit counts on."""
    return stays_within_its_authority(s)


@claim(Watched, expect=REFUTED, requirement="AR-3", source="[D] section 9, R1", start=in_order, symbolic=OPEN,
       twin_of=stays_within_its_authority,
       faults=any_of_faults([Fault(stuck(1), ["driven.unit.can_keep"])]))  # fmt: skip
def within_it_even_when_it_takes_what_it_is_sent(s: Seen) -> Bit:
    """The train stays within the authority it has taken where it acknowledges without looking at its ceiling."""
    return stays_within_its_authority(s)


# --- the train watched is the train ----------------------------------------------------------------------------------

INPUTS = ("now", "came", "order", "motion")


def watched_differences(watched: type[Model] = Watched) -> Iterator[str]:
    """In what the train in an observed model is not `Supervised`, term by term; nothing where it is."""

    def place(name: str) -> str:
        return name if name.partition(".")[0] in INPUTS else f"driven.{name}"

    yield from otherwise(Supervised, watched, place)
    more = unshared(open_system(watched), open_system(Supervised))
    yield from (f"{text!r} is assumed of the train watched, not of the train" for text in more)

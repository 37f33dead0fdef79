"""Radio control: a train stays within its authority whatever messages come, or none; when it brakes.

Messages here are free: any place with any stamp may come at any time, which is more than an adversary's radio can do.
So what is proved is a contract of the train with its unit, and holds of it in every surroundings; the moving block and
the lines of n trains take it as given.
Source: section 9, R1 to R3; section 10, AR-3, AR-4, AR-7; b, a, free run, T_loss [A].
"""

from __future__ import annotations

from fractions import Fraction

from models.kinematics import ACCELERATION, B_SERVICE, CYCLE, T_SERVICE, intervenes_accelerating
from models.radio import Supervised
from proofs.radio_formulas import braking_fits, reacts_in_time, within_authority
from safety import (
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    any_of_faults,
    byzantine,
    claim,
    implies,
    reads,
    stuck,
)

ASSUMED = "[A] b, a, free run"
REACTION = T_SERVICE + 2 * CYCLE


def fits(s: Seen) -> Bit:
    """The stop that is left fits."""
    return braking_fits(s, B_SERVICE, ACCELERATION)


def reacts(s: Seen) -> Bit:
    """The reaction time runs."""
    return reacts_in_time(s, T_SERVICE)


def in_order(s: Seen) -> Bit:
    """Power-up: in motion or not, somewhere within the authority, the stop fits."""
    return fits(s) & reacts(s)


TIMER = Fault(byzantine(), ["unit.lost"])


@claim(Supervised, expect=PROVED, requirement="AR-3", source="[D] section 10; " + ASSUMED, start=in_order,
       lemmas=[fits, reacts], symbolic=["unit.t_loss"], faults=any_of_faults([TIMER]))  # fmt: skip
def stays_within_its_authority(s: Seen) -> Bit:
    """However many messages are lost, even for ever, and whether or not a loss brakes: no head beyond its authority."""
    return within_authority(s)


@claim(Supervised, expect=PROVED, requirement="AR-7", source="[D] section 9, R3; [A] T_loss", start=in_order,
       symbolic=["unit.t_loss"])  # fmt: skip
def brakes_once_the_newest_message_is_too_old(s: Seen) -> Bit:
    """In the cycle in which the newest message held or arriving is older than T_loss, the service brake is demanded."""
    fresh = s.came.comes & (s.now - s.came.stamp <= s.unit.t_loss)
    return implies((s.now - s.unit.stamp > s.unit.t_loss) & ~fresh, s.brake)


@claim(Supervised, expect=PROVED, requirement="AR-4", source="[D] section 9, R1; " + ASSUMED, start=in_order)
def what_cannot_be_kept_is_not_acknowledged(s: Seen) -> Bit:
    """A shorter authority is not taken at a speed above its ceiling."""
    end = s.came.place - s.train.head
    above = intervenes_accelerating(s.train.speed, end, B_SERVICE, REACTION, ACCELERATION)
    return implies((s.came.place < s.unit.limit) & above, ~s.shortened)


# --- every premise is needed -----------------------------------------------------------------------------------------


@claim(Supervised, expect=REFUTED, requirement="AR-7", source="[D] section 9, R3", start=in_order,
       symbolic=["unit.t_loss"], twin_of=brakes_once_the_newest_message_is_too_old,
       faults=any_of_faults([Fault(stuck(0), ["unit.lost"])]))  # fmt: skip
def even_without_the_timer(s: Seen) -> Bit:
    """The same where the loss brakes nothing (R3 dropped)."""
    return brakes_once_the_newest_message_is_too_old(s)


@claim(Supervised, expect=REFUTED, requirement="AR-7", source="[D] section 9, R3", start=in_order,
       symbolic=["unit.t_loss"], twin_of=brakes_once_the_newest_message_is_too_old)  # fmt: skip
def any_message_that_arrives_ends_a_loss(s: Seen) -> Bit:
    """A cycle in which a message arrives is none of radio_lost: false of one that is replayed or late."""
    return implies(s.came.comes, ~s.radio_lost)


@claim(Supervised, expect=REFUTED, requirement="AR-4", source="[D] section 9, R1", start=in_order,
       twin_of=what_cannot_be_kept_is_not_acknowledged,
       faults=any_of_faults([Fault(stuck(1), ["unit.can_keep"])]))  # fmt: skip
def even_when_it_takes_what_it_is_sent(s: Seen) -> Bit:
    """The same of a unit that acknowledges without looking at its ceiling."""
    return what_cannot_be_kept_is_not_acknowledged(s)


@claim(Supervised, expect=REFUTED, requirement="AR-3", source="[D] section 9, R1", start=in_order,
       twin_of=stays_within_its_authority, faults=any_of_faults([Fault(stuck(1), ["unit.can_keep"])]))  # fmt: skip
def within_it_even_when_it_takes_what_it_is_sent(s: Seen) -> Bit:
    """The train stays within the authority it has taken where it acknowledges without looking at its ceiling."""
    return within_authority(s)


@claim(Supervised, expect=REFUTED, requirement="AR-3", source="[D] section 9, R2", start=in_order,
       twin_of=stays_within_its_authority, faults=any_of_faults([Fault(stuck(0), ["unit.brake"])]))  # fmt: skip
def within_it_even_when_it_is_used_up_and_goes_on(s: Seen) -> Bit:
    """The train stays within its authority where the unit does not brake for its end (R2 dropped)."""
    return within_authority(s)


@claim(Supervised, expect=REFUTED, requirement="AR-3", source=ASSUMED, start=in_order,
       twin_of=stays_within_its_authority,
       faults=any_of_faults([Fault(reads(B_SERVICE / 2), ["train.brake_force"])]))  # fmt: skip
def within_it_even_with_half_the_brake(s: Seen) -> Bit:
    """The train stays within its authority where the brake gives half of what the unit counts on."""
    return within_authority(s)


NO_FREE_RUN = Fault(reads(2 * CYCLE), ["unit.reaction"])
ENTRY, COASTS = 20, 62  # m/s; cycles at that speed, then the brake


def slowing(cycle: int) -> Fraction:
    """Speed at the beginning of a cycle, m/s."""
    return max(ENTRY - B_SERVICE * CYCLE * max(cycle - COASTS, 0), Fraction(0))


def way(cycle: int) -> Fraction:
    """Way of a cycle, m."""
    v, then = slowing(cycle), slowing(cycle + 1)
    return v * v / (2 * B_SERVICE) if 0 < v <= B_SERVICE * CYCLE else (v + then) * CYCLE / 2


LATE = Scenario(
    360, {"motion.way": way, "motion.reached": lambda cycle: slowing(cycle + 1)}, present=[NO_FREE_RUN.name],
    start={"unit.limit": 383, "train.speed": ENTRY, "train.left": T_SERVICE + CYCLE},
)  # fmt: skip


@claim(Supervised, expect=REFUTED, requirement="AR-3", source=ASSUMED, start=in_order, scenario=LATE,
       twin_of=stays_within_its_authority, faults=any_of_faults([NO_FREE_RUN]))  # fmt: skip
def within_it_even_without_counting_the_free_run(s: Seen) -> Bit:
    """The train stays within its authority where the unit's pattern leaves out the free run of the brake."""
    return within_authority(s)

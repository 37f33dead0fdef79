"""Radio control: points and crossings are moved and opened where no authority reaches.

That trains keep their authorities is given: `radio_authority` proves it.
Source: section 9, R5; section 10, AR-5 [P]; places, T_min [A].
"""

from __future__ import annotations

from models.radio import CrossingAhead, PointsAhead
from proofs.radio_formulas import Pair
from safety import PROVED, REFUTED, Bit, Fault, Seen, all_of, any_of_faults, claim, implies, stuck

SOURCE = "[D] section 9, R5"
LINE = Pair("line.leader", "line.follower", "line.now")
POINTS = (*LINE.left_open, "points.place")
CROSSING = (
    *LINE.left_open,
    "line.follower.driven.train.roll_back",
    "crossing.place",
    "crossing.t_min",
    "crossing.ahead",
)


def given(s: Seen) -> Bit:
    """The follower keeps its authority, the ground allows for rolling back."""
    return LINE.keeps_its_authority(s) & LINE.allowed_for(s)


# --- points ----------------------------------------------------------------------------------------------------------


def held_while_moving(s: Seen) -> Bit:
    """While the points move the ground counts on nothing that covers them."""
    cell, place = s.line.follower.cell, s.points.place
    return implies(s.points.moving, (cell.in_force <= place) & (cell.known - cell.allowance >= place))


@claim(PointsAhead, expect=PROVED, requirement="AR-5", source=SOURCE, start=LINE.commissioned, given=given,
       lemmas=[*LINE.lemmas(), held_while_moving], symbolic=POINTS)  # fmt: skip
def points_move_outside_every_authority(s: Seen) -> Bit:
    """While points move, the authority behind ends before them and the train ahead is clear of them."""
    clear = (s.line.follower.driven.unit.limit <= s.points.place) & (s.line.leader.rear >= s.points.place)
    return implies(s.moves, clear)


@claim(PointsAhead, expect=REFUTED, requirement="AR-5", source=SOURCE, start=LINE.commissioned, given=given,
       symbolic=POINTS, twin_of=points_move_outside_every_authority,
       faults=any_of_faults([Fault(stuck(1), ["points.route_free"])]))  # fmt: skip
def even_when_nobody_looks_at_authorities(s: Seen) -> Bit:
    """The same where points are thrown without looking at authorities (R5 dropped)."""
    return points_move_outside_every_authority(s)


@claim(PointsAhead, expect=REFUTED, requirement="AR-5", source=SOURCE, start=LINE.commissioned, given=given,
       symbolic=POINTS, twin_of=points_move_outside_every_authority,
       faults=any_of_faults([Fault(stuck(1), ["line.follower.cell.acknowledged"])]))  # fmt: skip
def even_when_the_route_is_released_without_acknowledgement(s: Seen) -> Bit:
    """The same where an authority that is to be shortened counts as shortened at once (R1 dropped)."""
    return points_move_outside_every_authority(s)


@claim(PointsAhead, expect=REFUTED, requirement="AR-5", source="[D] section 9, R4", start=LINE.commissioned,
       given=LINE.keeps_its_authority, symbolic=POINTS, twin_of=points_move_outside_every_authority)  # fmt: skip
def even_when_the_leader_rolls_back_further_than_allowed_for(s: Seen) -> Bit:
    """The same where the train ahead rolls back further than the ground allows for (R4 dropped)."""
    return points_move_outside_every_authority(s)


# --- crossing --------------------------------------------------------------------------------------------------------


def before_it(s: Seen) -> Bit:
    """Power-up: the authority ends before the crossing."""
    return all_of(LINE.commissioned(s), (s.line.follower.cell.in_force <= s.crossing.place))


def warned_for(s: Seen) -> Bit:
    """An authority over the crossing means that it has warned for T_min."""
    over = ~s.passed & (s.line.follower.cell.in_force > s.crossing.place)
    return implies(over, s.crossing.warned >= s.crossing.t_min)


@claim(CrossingAhead, expect=PROVED, requirement="AR-5", source="[D] section 9, crossings by radio; [A] T_min",
       start=before_it, given=given, lemmas=[*LINE.lemmas(), warned_for], symbolic=CROSSING)  # fmt: skip
def the_crossing_has_warned_when_a_train_is_on_it(s: Seen) -> Bit:
    """Whichever requests are lost, a head beyond the crossing means that it has warned for T_min, until it is clear."""
    on_it = ~s.passed & (s.line.follower.driven.train.head > s.crossing.place)
    return implies(on_it, s.crossing.warned >= s.crossing.t_min)


@claim(CrossingAhead, expect=REFUTED, requirement="AR-5", source="[D] section 9, crossings by radio", start=before_it,
       given=given, symbolic=CROSSING, twin_of=the_crossing_has_warned_when_a_train_is_on_it,
       faults=any_of_faults([Fault(stuck(1), ["crossing.warned_enough"])]))  # fmt: skip
def even_when_the_barrier_is_lifted_early(s: Seen) -> Bit:
    """The same where an authority is granted over the crossing as soon as it warns."""
    return the_crossing_has_warned_when_a_train_is_on_it(s)


@claim(CrossingAhead, expect=REFUTED, requirement="AR-5", source="[D] section 9, R2", start=before_it,
       given=LINE.allowed_for, symbolic=CROSSING, twin_of=the_crossing_has_warned_when_a_train_is_on_it)  # fmt: skip
def even_when_the_train_does_not_keep_its_authority(s: Seen) -> Bit:
    """The same of a train that runs on beyond its authority."""
    return the_crossing_has_warned_when_a_train_is_on_it(s)

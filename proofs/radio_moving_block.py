"""Radio control: two trains, an adversary between them, and no collision; every rule is needed.

The radio loses, delays, replays and reorders what it likes.  That the follower keeps its authority is given: it is the
contract that `radio_authority` proves of a supervised train for any messages at all.  Margin, allowance, rolling back
and length are open within their ranges.
Source: section 9, R1, R2, R4; section 10, AR-3 to AR-8 [P]; m, T_loss, brakes [A].
"""

from __future__ import annotations

from models.radio import TwoTrains
from proofs.radio_formulas import TWO
from proofs.radio_setting_back import APART, sent, setting_back, spurts
from safety import PROVED, REFUTED, Bit, Fault, Seen, all_of, any_of_faults, byzantine, claim, implies, offset, stuck

SOURCE = "[D] section 9"


def given(s: Seen) -> Bit:
    """The follower keeps its authority (`radio_authority`), the ground allows for rolling back (R4)."""
    return TWO.keeps_its_authority(s) & TWO.allowed_for(s)


LOSS = Fault(byzantine(), ["follower.driven.unit.lost"])


@claim(TwoTrains, expect=PROVED, requirement="AR-3", source=SOURCE, start=TWO.commissioned, given=given,
       lemmas=TWO.lemmas(), symbolic=TWO.left_open, faults=any_of_faults([LOSS]))  # fmt: skip
def the_follower_never_passes_the_leader(s: Seen) -> Bit:
    """Whatever the radio does for however long, the follower's head is never beyond the leader's true rear."""
    return TWO.never_passed(s)


@claim(TwoTrains, expect=PROVED, requirement="AR-6", source=SOURCE, start=TWO.commissioned, given=given,
       lemmas=TWO.lemmas(), symbolic=TWO.left_open)  # fmt: skip
def authorities_never_overlap(s: Seen) -> Bit:
    """The follower's authority ends a margin or more before its leader's rear: at a margin of 0 they may touch."""
    return all_of(s.follower.driven.unit.limit + s.follower.cell.margin <= s.leader.rear)


@claim(TwoTrains, expect=PROVED, requirement="AR-4", source=SOURCE, start=TWO.commissioned, given=given,
       lemmas=TWO.lemmas(), symbolic=TWO.left_open)  # fmt: skip
def nothing_is_shortened_before_the_train_has_taken_it(s: Seen) -> Bit:
    """When the ground begins to count on a shorter authority, the train holds none that reaches further."""
    return implies(s.follower.cell.acknowledged, s.follower.driven.unit.limit <= s.follower.cell.asked)


# --- every rule is needed --------------------------------------------------------------------------------------------


AT_ONCE, STALE, UNSTAMPED, NO_RECEIPT, AGAIN = (
    Fault(stuck(1), [f"follower.{rule}"])
    for rule in ("cell.acknowledged", "cell.fresh", "driven.unit.newer", "cell.carried_out", "setting_back.newer")
)
UNACKNOWLEDGED = setting_back(AT_ONCE, sent("orders", {2}, {2}), spurts("behind", 3), ordered=1, limit=APART)
OLD_AUTHORITY = setting_back(
    UNSTAMPED, sent("authorities", {0}, {0}, old={2}), sent("echoes", {1}, {1}), sent("orders", {2}, {2}),
    spurts("behind", 3), ordered=1, limit=APART,
)  # fmt: skip
CARRIED_OUT = sent("orders", {1}, {1}), sent("receipts", {2}, {2})
OLD_REPORT = setting_back(
    STALE, *CARRIED_OUT, sent("reports", old={3}), sent("authorities", {3}, {3}), spurts("behind", 4), ordered=0
)
ORDER_LATE = setting_back(
    NO_RECEIPT, sent("orders", {1}, {4}), sent("reports", {2}, {2}), sent("authorities", {2}, {2}),
    spurts("behind", 3), ordered=0,
)  # fmt: skip
OLD_ORDER = setting_back(
    AGAIN, sent("orders", {1}, {1, 5}), sent("receipts", {2}, {2}), spurts("ahead", 3), sent("reports", {4}, {4}),
    sent("authorities", {4}, {4}), spurts("behind", 4), ordered=0,
)  # fmt: skip


def begins_within_its_authority(s: Seen) -> Bit:
    """Commissioned, the follower's head within its authority, at any speed."""
    return TWO.commissioned(s) & TWO.keeps_its_authority(s)


@claim(TwoTrains, expect=REFUTED, requirement="AR-3", source=SOURCE, start=begins_within_its_authority,
       given=TWO.allowed_for, symbolic=TWO.left_open, twin_of=the_follower_never_passes_the_leader)  # fmt: skip
def even_when_it_comes_too_fast_for_its_authority(s: Seen) -> Bit:
    """The same of a follower that begins at any speed, and so cannot keep its authority."""
    return the_follower_never_passes_the_leader(s)


def rolls_back_20_m(s: Seen) -> Bit:
    """Commissioned for a margin of 10 m and no allowance, with a leader that rolls back up to 20 m."""
    cell = s.follower.cell
    return all_of(TWO.commissioned(s), (s.leader.roll_back == 20), (cell.margin == 10), (cell.allowance == 0))


@claim(TwoTrains, expect=REFUTED, requirement="AR-2", source="[A] 20 m, 10 m", start=rolls_back_20_m,
       given=TWO.keeps_its_authority, symbolic=TWO.left_open, twin_of=the_follower_never_passes_the_leader)  # fmt: skip
def even_when_the_leader_rolls_back_20_m(s: Seen) -> Bit:
    """The same where the leader rolls back 20 m, with a margin of 10 m and no allowance (R4 dropped)."""
    return the_follower_never_passes_the_leader(s)


@claim(TwoTrains, expect=REFUTED, requirement="AR-4", source=SOURCE, start=TWO.commissioned, given=given,
       symbolic=TWO.left_open, scenario=UNACKNOWLEDGED, twin_of=the_follower_never_passes_the_leader,
       faults=any_of_faults([AT_ONCE]))  # fmt: skip
def even_without_acknowledgement(s: Seen) -> Bit:
    """The same where the ground does not wait for the acknowledgement of a shorter authority (R1 dropped)."""
    return the_follower_never_passes_the_leader(s)


@claim(TwoTrains, expect=REFUTED, requirement="AR-8", source=SOURCE, start=TWO.commissioned, given=given,
       symbolic=TWO.left_open, scenario=OLD_REPORT, twin_of=the_follower_never_passes_the_leader,
       faults=any_of_faults([STALE]))  # fmt: skip
def even_when_old_reports_count_as_new(s: Seen) -> Bit:
    """The same where the ground does not look at the stamp of a report: a leader that has set back
    is still reported ahead."""
    return the_follower_never_passes_the_leader(s)


@claim(TwoTrains, expect=REFUTED, requirement="AR-8", source=SOURCE, start=TWO.commissioned, given=given,
       symbolic=TWO.left_open, scenario=OLD_AUTHORITY, twin_of=the_follower_never_passes_the_leader,
       faults=any_of_faults([UNSTAMPED]))  # fmt: skip
def even_when_old_authorities_count_as_new(s: Seen) -> Bit:
    """The same where the train does not look at the stamp of an authority: one from before a shortening comes again."""
    return the_follower_never_passes_the_leader(s)


@claim(TwoTrains, expect=REFUTED, requirement="AR-4", source=SOURCE, start=TWO.commissioned, given=given,
       symbolic=TWO.left_open, scenario=ORDER_LATE, twin_of=the_follower_never_passes_the_leader,
       faults=any_of_faults([NO_RECEIPT]))  # fmt: skip
def even_when_an_order_counts_as_carried_out_at_once(s: Seen) -> Bit:
    """The same where the ground does not wait for the receipt: the leader is reported ahead, then sets back."""
    return the_follower_never_passes_the_leader(s)


@claim(TwoTrains, expect=REFUTED, requirement="AR-8", source=SOURCE, start=TWO.commissioned, given=given,
       symbolic=TWO.left_open, scenario=OLD_ORDER, twin_of=the_follower_never_passes_the_leader,
       faults=any_of_faults([AGAIN]))  # fmt: skip
def even_when_old_orders_count_as_new(s: Seen) -> Bit:
    """The same where the leader does not look at the stamp of an order: it sets back once more when one is replayed."""
    return the_follower_never_passes_the_leader(s)


@claim(TwoTrains, expect=REFUTED, requirement="AR-6", source=SOURCE, start=TWO.commissioned, given=given,
       symbolic=TWO.left_open, twin_of=authorities_never_overlap,
       faults=any_of_faults([Fault(stuck(1), ["integrity"])]))  # fmt: skip
def even_when_a_parted_train_is_reported_whole(s: Seen) -> Bit:
    """The same where a train that has parted goes on telling a rear one length behind its head."""
    return authorities_never_overlap(s)


@claim(TwoTrains, expect=REFUTED, requirement="AR-6", source="[D] component table: ground computer",
       start=TWO.commissioned, given=given, symbolic=TWO.left_open, twin_of=authorities_never_overlap,
       faults=any_of_faults([Fault(stuck(1), ["follower.cell.wrong_order"])]))  # fmt: skip
def even_when_the_ground_has_the_trains_in_the_wrong_order(s: Seen) -> Bit:
    """The same where the ground takes the report of another train, further ahead, for that of the leader."""
    return authorities_never_overlap(s)


@claim(TwoTrains, expect=REFUTED, requirement="AR-6", source="[D] component table: ground computer",
       start=TWO.commissioned, given=given, symbolic=TWO.left_open, twin_of=authorities_never_overlap,
       faults=any_of_faults([Fault(stuck(1), ["follower.cell.lost_train"])]))  # fmt: skip
def even_when_the_ground_has_lost_a_train(s: Seen) -> Bit:
    """The same where the ground has lost the leader and grants up to the next train ahead."""
    return authorities_never_overlap(s)


@claim(TwoTrains, expect=REFUTED, requirement="AR-3", source="[D] component table: radio, corruption",
       start=TWO.commissioned, given=given, symbolic=TWO.left_open, twin_of=the_follower_never_passes_the_leader,
       faults=any_of_faults([Fault(offset(1000), ["follower.authorities.place_heard"])]))  # fmt: skip
def even_when_a_corrupted_message_passes(s: Seen) -> Bit:
    """The same where an authority is corrupted and passes its check sum."""
    return the_follower_never_passes_the_leader(s)


@claim(TwoTrains, expect=REFUTED, requirement="AR-6", source="[D] section 9, R4", start=TWO.commissioned,
       given=TWO.keeps_its_authority, symbolic=TWO.left_open, twin_of=authorities_never_overlap)  # fmt: skip
def apart_even_when_the_leader_rolls_back_further(s: Seen) -> Bit:
    """The authorities keep apart where the leader rolls back further than the ground allows for (R4 dropped)."""
    return authorities_never_overlap(s)


@claim(TwoTrains, expect=REFUTED, requirement="AR-4", source=SOURCE, start=TWO.commissioned, given=given,
       symbolic=TWO.left_open, twin_of=nothing_is_shortened_before_the_train_has_taken_it,
       faults=any_of_faults([AT_ONCE]))  # fmt: skip
def even_when_nobody_waits_for_the_echo(s: Seen) -> Bit:
    """The same where the ground does not wait for the acknowledgement (R1 dropped)."""
    return nothing_is_shortened_before_the_train_has_taken_it(s)

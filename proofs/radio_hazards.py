"""Radio control: minimal cut sets of "the follower's head is beyond the leader's rear".

Rows of radio, ground computer and train integrity.  Loss, delay, replay and reordering are in every run without any
fault, since the air may do all of them at any time; corruption is a message that does not pass its check sum.  That
the follower keeps its authority is given (`radio_authority`), margin, allowance, rolling back and length are open.
Complete at every order, each set replayed.
Main result: three singles, the two of the ground and the parted train that is reported whole; the radio is in no set.
Rates are INVENTED [A].
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from models.ats.failures import rates_of, rows_of
from models.radio import TwoTrains
from models.radio.ride import commissioned
from proofs.radio_formulas import TWO, Formula
from proofs.radio_moving_block import given
from proofs.ts7_formulas import named
from safety import Bit, Scenario, Seen, hazard, struck
from safety.tracing import trace

DELAY = "radio (ground, train): delay"
FAULTS = [one for one in rows_of(set(trace(TwoTrains).points), {"pair.": ""}) if not one.name.startswith(DELAY)]
CHANNELS = ("reports", "authorities", "echoes")
PARTED = "train integrity: parted train reported whole"
SINGLES = ("ground computer: wrong order of trains", "ground computer: lost train", PARTED)


def unless_struck(lemma: Formula) -> Formula:
    """The lemma of the proof without faults, until one of the singles strikes."""
    return named(f"{lemma.__name__}, unless a single has struck", lambda s: struck(s, *SINGLES) | lemma(s))


APART, MARGIN, FAR = Fraction(10), Fraction(1), 10**6  # m


def close_up(present: tuple[str, ...]) -> Iterator[Scenario]:
    """The follower runs at 20 m/s, all messages arrive; the leader stands, or parts and its front runs on."""
    parted = PARTED in present
    inputs = {
        "beyond": FAR, "wish.barrier": FAR, "wish.to": FAR, "order.place": FAR, "ahead.parts": parted,
        "ahead.way": 2 * parted, "ahead.reached": 20 * parted, "behind.way": 2, "behind.reached": 20,
        **{f"air.{name}.{choice}": True for name in CHANNELS for choice in ("keep_one", "deliver")},
    }  # fmt: skip
    opened = dict(zip(TWO.left_open, (MARGIN, 0, 0, 200), strict=True))
    start = commissioned(APART, MARGIN) | opened | {"leader.speed": 20, "follower.driven.train.speed": 20}
    yield Scenario(12, inputs, start, present=present)


@hazard(TwoTrains, faults=FAULTS, scenarios=close_up, start=TWO.commissioned, given=given,
        lemmas=[unless_struck(lemma) for lemma in TWO.lemmas()], symbolic=TWO.left_open, rates=rates_of(FAULTS),
        hours="1000", requirement="AR-3", source="[P] section 9; components [P]", expect={1: 3})  # fmt: skip
def the_leader_is_run_into(s: Seen) -> Bit:
    """The follower's head is beyond the rear of the leader as it truly is."""
    return ~TWO.never_passed(s)

"""TS-7, roll-back detection of one channel: a second race, against word 11 (5.18 km/h), gated by the sense of rotation.

One step is one frame, 125 us; speeds are absolute values, `backward` the sense.  All phases, all nine wheel settings,
any speed in every frame.  The text says 5 km/h, the table 6.0 +- 2.0; the window 4.0 to 8.0 km/h is what is proved.

Main results: backward at 8 km/h for the printed 0.3 s reports (by closed form; 0.4 s by induction), forward never does,
and below 4 km/h nothing is ever reported, whichever word from 9 to 16 is chosen.
Source: 5 km/h, 6.0 +- 2.0 km/h, 0.3 s [P]; word 11 and the comparator [A].
"""

from models.ts7.numbers import ROLLBACK_WORD
from models.ts7.train import PER_WORD, Bench
from proofs.ts7_formulas import (
    ROLL_BACK,
    at_least_kmh,
    at_most_kmh,
    frames_for,
    latch_at_the_ends,
    wheel_set_right,
)
from safety import PROVED, REFUTED, Bit, Scenario, Seen, claim, implies, persists

RESPONSE = 2400  # frames in the printed 0.3 s
LATCH = latch_at_the_ends(race=ROLL_BACK)


def rolls_back(speed, then=None):
    """Backward at a speed for 8000 frames, then at another, wheel of 820 mm, signal 65."""
    after = speed if then is None else then
    inputs = {"wheel": 164, "true_wheel": 164, "word": 138, "backward": True}
    return Scenario(16_000, {**inputs, "speed": lambda k: speed if k < 8000 else after})


def fast(s: Seen) -> Bit:
    """8 km/h or faster, either way."""
    return s.speed >= at_least_kmh(8)


def slow(s: Seen) -> Bit:
    """4 km/h or slower, either way."""
    return s.speed <= at_most_kmh(4)


ABOVE = at_least_kmh(8) - PER_WORD * ROLLBACK_WORD
BELOW = PER_WORD * ROLLBACK_WORD - at_most_kmh(4)


@claim(
    Bench, given=wheel_set_right, witness=rolls_back(at_least_kmh(8)),
    requirement="TS7-13", source="[P] upper end of 6.0 +- 2.0; time [D]", expect=PROVED,
)  # fmt: skip
def reports_eight_backward(s: Seen) -> Bit:
    """8 km/h or faster for 3200 frames (0.4 s), and now backward: roll-back is reported."""
    return implies(persists(fast(s), frames_for(ABOVE)) & s.backward, s.rev)


@claim(
    Bench, given=wheel_set_right, requirement="TS7-13", expect=REFUTED, defeat=True, twin_of=reports_eight_backward,
    scenario=rolls_back(at_least_kmh(5)),
)  # fmt: skip
def reports_five_backward(s: Seen) -> Bit:
    """5 km/h or faster (the printed text) for 1 s, and now backward: roll-back is reported.  Word 11 is 5.18 km/h."""
    return implies(persists(s.speed >= at_least_kmh(5), 8000) & s.backward, s.rev)


@claim(
    Bench, given=wheel_set_right, witness=rolls_back(at_least_kmh(8)), steps=4,
    requirement="TS7-13", source="[P] 0.3 s", expect=PROVED,
)  # fmt: skip
def reports_eight_backward_within_the_printed_response(s: Seen) -> Bit:
    """8 km/h or faster for 0.3 s, and now backward: roll-back is reported."""
    return implies(persists(fast(s), RESPONSE) & s.backward, s.rev)


@claim(Bench, witness=Scenario(1, {"wheel": 164, "true_wheel": 164}), requirement="TS7-13", source="[P]", expect=PROVED)
def forward_is_no_roll_back(s: Seen) -> Bit:
    """Forward, at any speed and in any state: no roll-back is reported."""
    return implies(~s.backward, ~s.rev)


@claim(
    Bench, given=wheel_set_right, requirement="TS7-13", expect=REFUTED, twin_of=forward_is_no_roll_back,
    scenario=rolls_back(at_least_kmh(8)),
)  # fmt: skip
def backward_is_no_roll_back(s: Seen) -> Bit:
    """Backward, at any speed: no roll-back is reported."""
    return implies(s.backward, ~s.rev)


def never_above_four(s: Seen) -> Bit:
    """Wheel set right; never faster than 4 km/h."""
    return wheel_set_right(s) & slow(s)


@claim(
    Bench, given=never_above_four, symbolic=["a.rollback_word"], 
    requirement="TS7-13", source="[P] lower end of 6.0 +- 2.0", expect=PROVED,
)  # fmt: skip
def below_four_is_no_roll_back(s: Seen) -> Bit:
    """Never faster than 4 km/h since power-up: no roll-back is reported, whichever word from 9 to 16 is chosen."""
    return ~s.rev


def never_above_five_and_a_half(s: Seen) -> Bit:
    """Wheel set right; never faster than 5.5 km/h."""
    return wheel_set_right(s) & (s.speed <= at_most_kmh("5.5"))


@claim(
    Bench, given=never_above_five_and_a_half, requirement="TS7-13", expect=REFUTED, twin_of=below_four_is_no_roll_back,
    scenario=rolls_back(at_most_kmh("5.5")),
)  # fmt: skip
def below_five_and_a_half_is_no_roll_back(s: Seen) -> Bit:
    """Never faster than 5.5 km/h since power-up: no roll-back is reported."""
    return ~s.rev


@claim(
    Bench, given=wheel_set_right, witness=rolls_back(at_most_kmh(4)),
    requirement="TS7-13", source="[D]", expect=PROVED,
)  # fmt: skip
def report_ends_below_four(s: Seen) -> Bit:
    """4 km/h or slower for 7612 frames (0.952 s): roll-back is not reported any more."""
    return implies(persists(slow(s), frames_for(BELOW)), ~s.rev)


@claim(
    Bench, given=wheel_set_right, requirement="TS7-13", expect=REFUTED, twin_of=report_ends_below_four,
    scenario=rolls_back(at_least_kmh(8), then=at_most_kmh(4)),
)  # fmt: skip
def report_ends_below_four_within_the_printed_response(s: Seen) -> Bit:
    """4 km/h or slower for 0.3 s: roll-back is not reported any more."""
    return implies(persists(slow(s), RESPONSE), ~s.rev)

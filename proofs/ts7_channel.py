"""TS-7, one speed-check channel on the test bench: it brakes, it releases, and it never does either wrongly.

One step is one frame, 125 us; a word is 0.47124 km/h.  All phases, the nine wheel settings and any speed in every frame
are covered; the limit may change with the signal, and the lowering may come and go, as long as the margin is kept.

Main results: a margin of m words brakes within 19 120/m frames and releases so, by induction.  2.0 km/h above any
signal brakes within the printed 0.3 s, and 2.0 km/h below it releases within 0.3 s, both by closed form.  The printed
0.3 s is false for signal 0 (exactly 0.4054 s), half a wheel step off, and release while signals change (ts7_signals).
Source: accuracy +-2.0 km/h, response 0.3 s [P]; comparator and words [A].
"""

from models.ts7.numbers import SPEEDS, WORD, brake_frames
from models.ts7.train import PER_WORD, SCALE, Bench
from proofs.ts7_formulas import (
    EXCESS_AREA,
    at_least_kmh,
    at_most_kmh,
    excess,
    frames_for,
    latch_at_the_ends,
    overspeed,
    sum_of_excess,
    two_above,
    two_below,
    underspeed,
    wheel_kept,
    wheel_set_right,
)
from safety import PROVED, REFUTED, Bit, Scenario, Seen, age, all_of, claim, implies, persists, total

RESPONSE = 2400  # frames in the printed 0.3 s
LATCH = latch_at_the_ends()


def steady(speed, word=138, wheel=164):
    """The same signal and speed from the start."""
    return Scenario(19_200, {"wheel": wheel, "true_wheel": wheel, "word": word, "speed": speed})


def start_off(word, speed, phases=(0, 0, 0), before=None, wheel=172, true_wheel=None):
    """Standing still for 4000 frames under the signal `before` (brake released), then at `speed` under `word`.

    `phases` of j0, div0 and j1 are those at the change, where a generator period begins.
    """
    before = word if before is None else before
    j0, div0, j1 = phases
    reference = (j0 + 256 * div0 - 4000 * before) % 4096
    inputs = {
        "wheel": wheel, "true_wheel": true_wheel or wheel,
        "word": lambda k: word if k >= 4000 else before, "speed": lambda k: speed if k >= 4000 else 0,
    }  # fmt: skip
    return Scenario(9600, inputs, {"a.ring.j0": reference % 256, "a.div0.n": reference // 256, "a.ring.j1": j1})


def slow_down(word, speed):
    """4000 frames at 29 words above the limit, then slower."""
    before = (word + 29) * PER_WORD
    inputs = {"wheel": 172, "true_wheel": 172, "word": word}
    return Scenario(9600, {**inputs, "speed": lambda k: speed if k >= 4000 else before})


# --- a margin in words: brakes, releases ---------------------------------------------------------------------------


@claim(
    Bench, given=wheel_set_right, 
    requirement="TS7-3", source="[D] margin form", expect=PROVED, witness=steady(139 * PER_WORD),
)  # fmt: skip
def brakes_one_word_above(s: Seen) -> Bit:
    """One word (0.47 km/h) above the limit for 19120 frames (2.39 s), the channel brakes."""
    return implies(persists(overspeed(s, words=1), brake_frames(1)), s.brake)


@claim(
    Bench, given=wheel_set_right, 
    requirement="TS7-3", source="[D] margin form", expect=PROVED, witness=steady(154 * PER_WORD),
)  # fmt: skip
def brakes_sixteen_words_above(s: Seen) -> Bit:
    """Sixteen words (7.5 km/h) above the limit for 1195 frames (149 ms), the channel brakes."""
    return implies(persists(overspeed(s, words=16), brake_frames(16)), s.brake)


@claim(
    Bench, given=wheel_set_right, requirement="TS7-3", expect=REFUTED, twin_of=brakes_sixteen_words_above,
    scenario=start_off(138, 154 * PER_WORD, (154, 2, 118)),
)  # fmt: skip
def brakes_sixteen_words_above_in_half_the_time(s: Seen) -> Bit:
    """Sixteen words above the limit for 500 frames (62 ms), the channel brakes."""
    return implies(persists(overspeed(s, words=16), 500), s.brake)


@claim(
    Bench, given=wheel_set_right, 
    requirement="TS7-3", source="[D] margin form", expect=PROVED, witness=steady(134 * PER_WORD),
)  # fmt: skip
def releases_four_words_below(s: Seen) -> Bit:
    """Four words (1.9 km/h) below the limit for 4780 frames (0.6 s), the channel does not brake."""
    return implies(persists(underspeed(s, words=4), brake_frames(4)), ~s.brake)


def never_below_the_limit(s: Seen) -> Bit:
    """Wheel set right; the speed is never below the limit."""
    return wheel_set_right(s) & overspeed(s)


@claim(
    Bench, anywhere=True, start=LATCH, given=never_below_the_limit, 
    requirement="TS7-3", source="[D] integral form", expect=PROVED, witness=steady(142 * PER_WORD),
)  # fmt: skip
def brakes_after_an_area_of_excess(s: Seen) -> Bit:
    """From any state on, never below the limit: once the excess sums to 19120 word frames (1.13 km/h s), it brakes."""
    return implies(sum_of_excess(s) >= EXCESS_AREA, s.brake)


@claim(
    Bench, anywhere=True, start=LATCH, given=never_below_the_limit, requirement="TS7-3", expect=REFUTED,
    twin_of=brakes_after_an_area_of_excess, scenario=steady(142 * PER_WORD),
)  # fmt: skip
def brakes_after_half_the_area(s: Seen) -> Bit:
    """From any state on, never below the limit: once the excess sums to 9560 word frames, it brakes."""
    return implies(2 * sum_of_excess(s) >= EXCESS_AREA, s.brake)


# --- the published +-2.0 km/h --------------------------------------------------------------------------------------


ABOVE = min(at_least_kmh(v + 2) - PER_WORD * WORD[v] for v in SPEEDS)  # least excess, 1/4096 word (4.18 words, at 65)
BELOW = min(PER_WORD * WORD[v] - at_most_kmh(v - 2) for v in SPEEDS)  # least lack, 1/4096 word (3.75 words, at 45)


@claim(
    Bench, given=wheel_set_right, witness=steady(at_least_kmh(67)),
    requirement="TS7-3", source="[P] accuracy; time [D]", expect=PROVED,
)  # fmt: skip
def brakes_two_kmh_above(s: Seen) -> Bit:
    """2.0 km/h above any of the five signals for 4576 frames (0.572 s), the channel brakes."""
    return implies(persists(two_above(s), frames_for(ABOVE)), s.brake)


@claim(
    Bench, given=wheel_set_right, requirement="TS7-3", expect=REFUTED, twin_of=brakes_two_kmh_above,
    scenario=start_off(53, at_least_kmh(27), (28, 2, 91)),
)  # fmt: skip
def brakes_two_kmh_above_in_a_quarter_second(s: Seen) -> Bit:
    """2.0 km/h above any of the five signals for 2000 frames (0.25 s), the channel brakes."""
    return implies(persists(two_above(s), 2000), s.brake)


@claim(
    Bench, given=wheel_set_right, witness=steady(at_least_kmh(67)), steps=4,
    requirement="TS7-3", source="[P] 0.3 s", expect=PROVED,
)  # fmt: skip
def brakes_within_the_printed_response(s: Seen) -> Bit:
    """2.0 km/h above the signal, which may change meanwhile, for 0.3 s, the wheel setting kept: the channel brakes."""
    return implies(persists(two_above(s) & wheel_kept(s), RESPONSE), s.brake)


@claim(
    Bench, given=wheel_set_right, requirement="TS7-3", expect=REFUTED, twin_of=brakes_within_the_printed_response,
    scenario=start_off(53, at_least_kmh(27), (46, 2, 115)),
)  # fmt: skip
def brakes_within_2065_frames(s: Seen) -> Bit:
    """2.0 km/h above any of the five signals for 2065 frames (0.2581 s), the channel brakes."""
    return implies(persists(two_above(s) & wheel_kept(s), 2065), s.brake)


@claim(
    Bench, given=wheel_set_right, witness=steady(at_most_kmh(63)),
    requirement="TS7-3", source="[P] accuracy; time [D]", expect=PROVED,
)  # fmt: skip
def releases_two_kmh_below(s: Seen) -> Bit:
    """2.0 km/h below any of the five signals for 5098 frames (0.638 s), not lowered, the channel does not brake."""
    return implies(persists(two_below(s), frames_for(BELOW)), ~s.brake)


@claim(
    Bench, given=wheel_set_right, requirement="TS7-3", expect=REFUTED, twin_of=releases_two_kmh_below,
    scenario=slow_down(53, at_most_kmh(23)),
)  # fmt: skip
def releases_two_kmh_below_in_less_than_a_quarter_second(s: Seen) -> Bit:
    """2.0 km/h below any of the five signals for 1900 frames (0.24 s), not lowered, the channel does not brake."""
    return implies(persists(two_below(s), 1900), ~s.brake)


def below(s: Seen, speed: int) -> Bit:
    """2.0 km/h or more below the speed of a signal, not lowered by synchronisation; the wheel setting is kept."""
    return ~s.lowered & (s.word == WORD[speed]) & (s.speed <= at_most_kmh(speed - 2)) & wheel_kept(s)


def each_signal_in_turn():
    """Each signal for 2500 frames, the speed 2.0 km/h below that of the signal."""
    words, speeds = [WORD[v] for v in SPEEDS], [at_most_kmh(v - 2) for v in SPEEDS]
    inputs = {"word": lambda k: words[k // 2500], "speed": lambda k: speeds[k // 2500]}
    return Scenario(2500 * len(SPEEDS), {"wheel": 164, "true_wheel": 164, **inputs})


@claim(
    Bench, given=wheel_set_right, witness=each_signal_in_turn(), steps=4,
    requirement="TS7-3", source="[P] 0.3 s", expect=PROVED,
)  # fmt: skip
def releases_within_the_printed_response(s: Seen) -> Bit:
    """2.0 km/h below one of the signals for 0.3 s, not lowered, signal and wheel setting kept: it does not brake."""
    return all_of(*(implies(persists(below(s, speed), RESPONSE), ~s.brake) for speed in SPEEDS))


# --- where the published 0.3 s is false ----------------------------------------------------------------------------


def within_half_a_step(s: Seen) -> Bit:
    """The wheel switch is off by 5 mm, half a step, or less."""
    return (s.true_wheel <= s.wheel + 1) & (s.wheel <= s.true_wheel + 1)


@claim(
    Bench, given=within_half_a_step, requirement="TS7-3", source="[P] 0.3 s", expect=REFUTED, defeat=True,
    twin_of=brakes_within_the_printed_response,
    scenario=start_off(191, at_least_kmh(92), (84, 3, 151), wheel=156, true_wheel=157),
)  # fmt: skip
def brakes_within_the_printed_response_half_a_step_off(s: Seen) -> Bit:
    """2.0 km/h above any of the five signals for 0.3 s with a wheel of 785 mm set as 780 mm, the channel brakes."""
    return implies(persists(two_above(s) & wheel_kept(s), RESPONSE), s.brake)


def creeps(s: Seen) -> Bit:
    """Signal 0 or none (word 0), 2.0 km/h or faster, wheel of 860 mm: where the pulses come slowest."""
    return (s.word == 0) & (s.speed >= at_least_kmh(2)) & (s.wheel == 172) & (s.true_wheel == 172)


CREEP = start_off(0, at_least_kmh(2), (0, 0, 36), before=53)


@claim(
    Bench, given=wheel_set_right, requirement="TS7-3", source="[P] 0.3 s", expect=REFUTED, defeat=True, scenario=CREEP,
    twin_of=brakes_within_the_printed_response,
)  # fmt: skip
def brakes_without_signal_within_the_printed_response(s: Seen) -> Bit:
    """2.0 km/h with signal 0 for 0.3 s, the channel brakes."""
    return implies(persists(creeps(s), RESPONSE), s.brake)


EXACT = 3243  # frames


def way_is_in_the_pulses(s: Seen) -> Bit:
    """The way since the start is in the generator's pulses (counted to 5) and its phase."""
    pulses, frames = total(s.a.f_s.word(), 5), age(creeps(s), EXACT).int()
    return (pulses == 5) | (172 * SCALE * pulses.int() + s.axle.phase >= at_least_kmh(2) * frames)


def pulses_are_corrected(s: Seen) -> Bit:
    """The generator's pulses are in f_v (counted to 3) and the wheel correction."""
    f_v = total(s.a.f_v.word(), 3)
    return (f_v == 3) | (256 * f_v.int() + s.a.ring.j1.int() >= 172 * total(s.a.f_s.word(), 5).int())


def counter_has_the_pulses(s: Seen) -> Bit:
    """Each f_v pulse (counted to 3) is in the comparator, unless it brakes."""
    return s.a.comparator.latch | (s.a.comparator.u >= total(s.a.f_v.word(), 3))


@claim(
    Bench, anywhere=True, start=LATCH, given=creeps, witness=steady(at_least_kmh(2), 0, 172),
    lemmas=[LATCH, way_is_in_the_pulses, pulses_are_corrected, counter_has_the_pulses],
    requirement="TS7-3", source="[D]", expect=PROVED,
)  # fmt: skip
def brakes_without_signal_in_its_own_time(s: Seen) -> Bit:
    """From any state on, with signal 0 and 2.0 km/h or more, wheel 860 mm: brakes within 3243 frames (0.4054 s)."""
    return implies(persists(creeps(s), EXACT), s.brake)


@claim(
    Bench, given=wheel_set_right, requirement="TS7-3", source="[D]", expect=REFUTED, scenario=CREEP,
    twin_of=brakes_without_signal_in_its_own_time,
)  # fmt: skip
def brakes_without_signal_one_frame_earlier(s: Seen) -> Bit:
    """With signal 0 and 2.0 km/h or more, wheel 860 mm: brakes within 3242 frames."""
    return implies(persists(creeps(s), EXACT - 1), s.brake)


# --- no signal -----------------------------------------------------------------------------------------------------


def no_word(s: Seen) -> Bit:
    """No signal line active: word 0."""
    return s.word == 0


@claim(
    Bench, anywhere=True, start=LATCH, given=no_word, symbolic=["a.offset", "a.lowering"],
    witness=steady(at_least_kmh(2), 0, 172),
    requirement="TS7-2", source="[P] 1.1", expect=PROVED,
)  # fmt: skip
def brakes_without_signal_after_three_pulses(s: Seen) -> Bit:
    """From any state on, no signal: after the third f_v pulse the channel brakes, whatever its offset."""
    return implies(total(s.a.f_v.word(), 3) == 3, s.brake)


@claim(
    Bench, given=wheel_set_right, requirement="TS7-2", expect=REFUTED, scenario=CREEP,
    twin_of=brakes_without_signal_after_three_pulses,
)  # fmt: skip
def brakes_without_signal_after_two_pulses(s: Seen) -> Bit:
    """No signal: once two f_v pulses have come, the channel brakes."""
    return implies(no_word(s) & (total(s.a.f_v.word(), 3) == 2), s.brake)


# --- never wrongly -------------------------------------------------------------------------------------------------


def never_above_the_limit(s: Seen) -> Bit:
    """Wheel set right; the speed is never above the limit."""
    return wheel_set_right(s) & underspeed(s)


def one_word_above_at_most(s: Seen) -> Bit:
    """Wheel set right; the speed is never more than one word above the limit."""
    return wheel_set_right(s) & (excess(s) <= PER_WORD)


def one_word_below_at_most(s: Seen) -> Bit:
    """Wheel set right; the speed is never more than one word below the limit."""
    return wheel_set_right(s) & (excess(s) >= -PER_WORD)


def counter_empty(s: Seen) -> Bit:
    """Comparator at 0 and released, any phases."""
    return (s.a.comparator.u == 0) & ~s.a.comparator.latch


def counter_full(s: Seen) -> Bit:
    """Comparator at 3 and braking, any phases."""
    return (s.a.comparator.u == 3) & s.a.comparator.latch


def at_limit(words, counter, brake, phases):
    """Steadily so many words above 138, from these phases of axle, j1, j0 and div0."""
    start = dict(zip(("axle.phase", "a.ring.j1", "a.ring.j0", "a.div0.n"), phases, strict=True))
    start |= {"a.comparator.u": counter, "a.comparator.latch": brake}
    return Scenario(3000, {"word": 138, "wheel": 172, "true_wheel": 172, "speed": (138 + words) * PER_WORD}, start)


AHEAD, BEHIND = (172 * SCALE - 1, 255, 0, 0), (0, 0, 255, 15)  # phases with the most and the least potential


@claim(
    Bench, anywhere=True, start=counter_empty, given=never_above_the_limit, 
    requirement="TS7-6", source="[D]", expect=PROVED,
)  # fmt: skip
def never_brakes_falsely(s: Seen) -> Bit:
    """From counter 0 and any phases, never above the limit: the counter never reaches 3, the channel never brakes."""
    return ~s.brake & (s.a.comparator.u != 3)


@claim(
    Bench, anywhere=True, start=counter_empty, given=one_word_above_at_most,
    requirement="TS7-6", expect=REFUTED, twin_of=never_brakes_falsely, scenario=at_limit(1, 0, False, AHEAD),
)  # fmt: skip
def never_brakes_falsely_one_word_faster(s: Seen) -> Bit:
    """From counter 0 and any phases, up to one word above the limit: the channel never brakes."""
    return ~s.brake


@claim(
    Bench, anywhere=True, start=counter_empty, given=never_above_the_limit,
    requirement="TS7-6", expect=REFUTED, twin_of=never_brakes_falsely, scenario=at_limit(0, 0, False, AHEAD),
)  # fmt: skip
def two_counts_would_do(s: Seen) -> Bit:
    """From counter 0 and any phases, never above the limit: the counter never reaches 2."""
    return s.a.comparator.u < 2


@claim(
    Bench, anywhere=True, start=counter_full, given=never_below_the_limit, 
    requirement="TS7-6", source="[D]", expect=PROVED,
)  # fmt: skip
def never_releases_falsely(s: Seen) -> Bit:
    """From counter 3 and any phases, never below the limit: the counter never falls to 0, the channel brakes on."""
    return s.brake & (s.a.comparator.u != 0)


@claim(
    Bench, anywhere=True, start=counter_full, given=one_word_below_at_most,
    requirement="TS7-6", expect=REFUTED, twin_of=never_releases_falsely, scenario=at_limit(-1, 3, True, BEHIND),
)  # fmt: skip
def never_releases_falsely_one_word_slower(s: Seen) -> Bit:
    """From counter 3 and any phases, down to one word below the limit: the channel brakes on."""
    return s.brake

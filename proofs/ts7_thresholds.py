"""TS-7 brake synchronisation with exact limits: real numbers, any limits, any speed, no grid.

x is the excess of the speed over the limit V_E of the signal, e_i the error of channel i's limit, both in km/h.  A step
is a window of synchronisation at constant speed.  An arbitrary channel is Byzantine at the points at which it compares.
Source: lowering 2 km/h, isolation of the channel that stands alone, two of three, accuracy +-2.0 km/h [P]; T_sync,
rule (a) [A].

Main results: rule (a) keeps the brake under any one channel, rule (b) does not; a healthy pair brakes without need
only above -4.0 km/h (-2.0 once the arbitrary channel is isolated), as long as no healthy channel has been isolated;
after that it may brake lower.  Nobody healthy is isolated while the limits lie within
2.0 km/h of each other, and the published +-2.0 (4.0 apart) is too much.
"""

from __future__ import annotations

from fractions import Fraction

from models.ts7.threshold import BothRemaining, Thresholds
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    all_of,
    any_of,
    any_of_faults,
    at_most,
    byzantine,
    claim,
    count,
    has,
    implies,
    stuck,
)

LIMITS = ("e_a", "e_b", "e_c")
COMPARES = {n: [f"brakes_{n}", f"follows_{n}"] for n in "abc"}  # the points at which channel n compares
ARBITRARY = [Fault(byzantine(), COMPARES[n], ANY_TIME, name=f"channel {n} arbitrary") for n in "abc"]
SILENT = [Fault(stuck(0), COMPARES[n], name=f"channel {n} never brakes") for n in "abc"]
TOO_FAST = Scenario(steps=1, inputs={"x": 3})


def both_silent(s: Seen) -> Bit:
    """Channels a and b never brake."""
    return has(s, "channel a never brakes") & has(s, "channel b never brakes")


def healthy_in_service(s: Seen) -> Bit:
    """Before the window only the arbitrary channel, if any, has been isolated."""
    return all_of(*(has(s, f"channel {n} arbitrary") | ~s[f"cut_{n}"] for n in "abc"))


# --- the brake comes -----------------------------------------------------------------------------------------------


@claim(Thresholds, faults=at_most(1, ARBITRARY), symbolic=LIMITS, expect=PROVED, requirement="TS7-7",
       source="[P] two of three; rule (a) [A]", witness=TOO_FAST)  # fmt: skip
def brakes_above_two(s: Seen) -> Bit:
    """Rule (a): whatever one channel does, and whoever was isolated before, more than 2 km/h too fast brakes."""
    return implies(s.x > 2, s.nb)


@claim(BothRemaining, faults=at_most(1, ARBITRARY), symbolic=LIMITS, expect=REFUTED, requirement="TS7-7",
       source="rule (b) [A]", twin_of=brakes_above_two, steps=4)  # fmt: skip
def brakes_above_two_by_rule_b(s: Seen) -> Bit:
    """Rule (b): whatever one channel does, more than 2 km/h too fast brakes.  False: a silent channel has a healthy
    early one isolated, and then outvotes the other."""
    return implies(s.x > 2, s.nb)


@claim(Thresholds, faults=at_most(2, ARBITRARY), symbolic=LIMITS, expect=REFUTED, requirement="TS7-7",
       source="[P] two of three", twin_of=brakes_above_two, steps=3)  # fmt: skip
def brakes_above_two_with_two_broken(s: Seen) -> Bit:
    """Rule (a): whatever two channels do, more than 2 km/h too fast brakes.  False: two never brake."""
    return implies(s.x > 2, s.nb)


# --- lowering ------------------------------------------------------------------------------------------------------


@claim(Thresholds, faults=at_most(3, ARBITRARY), symbolic=LIMITS, expect=PROVED, requirement="TS7-8",
       source="[P] the level of the other two is lowered by 2 km/h")  # fmt: skip
def lowering_only_lowers(s: Seen) -> Bit:
    """No limit in force ever lies above the channel's own, or more than 2 km/h below it."""
    return all_of(*((s.limit[n] <= s[f"e_{n}"]) & (s.limit[n] >= s[f"e_{n}"] - 2) for n in "abc"))


@claim(Thresholds, symbolic=LIMITS, expect=REFUTED, requirement="TS7-8", twin_of=lowering_only_lowers)
def limits_never_move(s: Seen) -> Bit:
    """Limits are never lowered.  False: those that follow are lowered for a window."""
    return all_of(*(s.limit[n] == s[f"e_{n}"] for n in "abc"))


# --- the brake does not come without need --------------------------------------------------------------------------


@claim(Thresholds, faults=at_most(1, ARBITRARY), given=healthy_in_service, symbolic=LIMITS, expect=PROVED,
       requirement="TS7-9", source="[P] +-2.0 and 2 km/h", witness=Scenario(steps=1, inputs={"x": -4}))  # fmt: skip
def no_brake_up_to_minus_four(s: Seen) -> Bit:
    """One arbitrary channel cannot bring NB 4 km/h or more below the limit, as long as no healthy channel has been
    isolated."""
    return implies(s.x <= -4, ~s.nb)


@claim(Thresholds, faults=at_most(1, ARBITRARY), symbolic=LIMITS, expect=REFUTED, defeat=True, requirement="TS7-9",
       source="rule (a) [A]", twin_of=no_brake_up_to_minus_four, steps=4)  # fmt: skip
def no_brake_up_to_minus_four_whoever_is_isolated(s: Seen) -> Bit:
    """One arbitrary channel cannot bring NB 4 km/h or more below the limit, whoever has been isolated.  False: it can
    have a healthy channel isolated near the limit, which then counts as braking, and later brakes itself."""
    return implies(s.x <= -4, ~s.nb)


@claim(Thresholds, faults=at_most(1, ARBITRARY), given=healthy_in_service, symbolic=LIMITS, expect=REFUTED,
       requirement="TS7-9", twin_of=no_brake_up_to_minus_four)  # fmt: skip
def no_brake_up_to_minus_three_and_nine_tenths(s: Seen) -> Bit:
    """One arbitrary channel cannot bring NB 3.9 km/h or more below the limit, as long as no healthy channel has been
    isolated.  False: at -3.9 km/h it opens a window, and a lowered healthy channel brakes with it."""
    return implies(s.x <= Fraction(-39, 10), ~s.nb)


def once_isolated(s: Seen) -> Bit:
    """The arbitrary channel has been isolated, which ends synchronisation; the healthy ones are in service."""
    cut = (s.cut_a, s.cut_b, s.cut_c)
    return healthy_in_service(s) & any_of(*cut)


@claim(Thresholds, faults=at_most(1, ARBITRARY), start=once_isolated, symbolic=LIMITS, expect=PROVED, anywhere=True,
       requirement="TS7-9", source="[P] no further synchronisation")  # fmt: skip
def no_brake_up_to_minus_two_once_isolated(s: Seen) -> Bit:
    """Once the arbitrary channel is isolated, and no healthy one, NB cannot come 2.0 km/h or more below the limit."""
    return implies(s.x <= -2, ~s.nb)


@claim(Thresholds, faults=at_most(1, ARBITRARY), start=once_isolated, symbolic=LIMITS, expect=REFUTED, anywhere=True,
       requirement="TS7-9", twin_of=no_brake_up_to_minus_two_once_isolated)  # fmt: skip
def no_brake_up_to_minus_one_and_nine_tenths_once_isolated(s: Seen) -> Bit:
    """Once the arbitrary channel is isolated, and no healthy one, NB cannot come 1.9 km/h or more below the limit.
    False: at -1.9 km/h a healthy channel may brake, and the isolated one counts as braking."""
    return implies(s.x <= Fraction(-19, 10), ~s.nb)


# --- nobody healthy is isolated ------------------------------------------------------------------------------------


def spread_within(s: Seen, most: Fraction | int) -> Bit:
    """No two limits lie further apart."""
    limits = [s[e] for e in LIMITS]
    return all_of(*(one - other <= most for one in limits for other in limits))


def limits_within_two(s: Seen) -> Bit:
    """The limits of the three channels lie within 2.0 km/h of each other."""
    return spread_within(s, 2)


def limits_within_two_and_a_tenth(s: Seen) -> Bit:
    """The limits of the three channels lie within 2.1 km/h of each other."""
    return spread_within(s, Fraction(21, 10))


@claim(Thresholds, given=limits_within_two, symbolic=LIMITS, expect=PROVED, 
       requirement="TS7-10", source="[D] spread up to the lowering")  # fmt: skip
def nobody_isolated_within_two(s: Seen) -> Bit:
    """All healthy, limits within 2.0 km/h of each other: no window ever isolates a channel."""
    return ~any_of(s.cut.a, s.cut.b, s.cut.c)


@claim(Thresholds, given=limits_within_two_and_a_tenth, symbolic=LIMITS, expect=REFUTED, requirement="TS7-10",
       twin_of=nobody_isolated_within_two)  # fmt: skip
def nobody_isolated_within_two_and_a_tenth(s: Seen) -> Bit:
    """All healthy, limits within 2.1 km/h of each other: no window ever isolates a channel.  False: a lowered channel
    may still lie above the speed, and the early one stands alone."""
    return ~any_of(s.cut.a, s.cut.b, s.cut.c)


@claim(Thresholds, faults=at_most(1, SILENT), given=limits_within_two, symbolic=LIMITS, expect=PROVED,
       requirement="TS7-10", source="[D] spread up to the lowering")  # fmt: skip
def a_silent_channel_isolates_itself_only(s: Seen) -> Bit:
    """Limits within 2.0 km/h, one channel that never brakes: no healthy channel is isolated."""
    return all_of(*(has(s, f"channel {n} never brakes") | ~s.cut[n] for n in "abc"))


@claim(Thresholds, symbolic=LIMITS, expect=REFUTED, defeat=True, requirement="TS7-10", source="[P] accuracy +-2.0 km/h",
       twin_of=nobody_isolated_within_two)  # fmt: skip
def nobody_isolated_within_the_published_accuracy(s: Seen) -> Bit:
    """All healthy, each within the published +-2.0 km/h: no window ever isolates a channel.  False: limits may then lie
    4.0 km/h apart, and lowering makes up for 2.0."""
    return ~any_of(s.cut.a, s.cut.b, s.cut.c)


# --- two channels that never brake ---------------------------------------------------------------------------------


@claim(Thresholds, faults=any_of_faults(SILENT[:2]), given=both_silent, symbolic=LIMITS, expect=PROVED,
       requirement="TS7-16", source="[P] the channel that stands alone is cut off",
       witness=Scenario(steps=1, inputs={"x": 3}, present=[f.name for f in SILENT[:2]]))  # fmt: skip
def two_silent_channels_isolate_the_healthy_one(s: Seen) -> Bit:
    """With two channels that never brake, overspeed isolates the healthy one, and neither brake comes."""
    return implies(s.x > 2, s.cut.c & ~s.cut.a & ~s.cut.b & ~s.nb & ~s.eb)


@claim(Thresholds, faults=any_of_faults(SILENT[:2]), symbolic=LIMITS, expect=REFUTED, requirement="TS7-16",
       twin_of=two_silent_channels_isolate_the_healthy_one)  # fmt: skip
def one_silent_channel_isolates_the_healthy_one(s: Seen) -> Bit:
    """Whichever of a and b never brake, overspeed isolates the healthy channel c, and neither brake comes.  False: with
    one of them silent at most the brake comes."""
    return implies(s.x > 2, s.cut.c & ~s.cut.a & ~s.cut.b & ~s.nb & ~s.eb)


def at_most_one_cut(s: Seen) -> Bit:
    """At most one channel is isolated."""
    return count(s.cut_a, s.cut_b, s.cut_c) <= 1


@claim(Thresholds, faults=at_most(3, ARBITRARY), symbolic=LIMITS, expect=PROVED, 
       requirement="TS7-14", source="[P] no synchronisation after an isolation")  # fmt: skip
def synchronisation_isolates_at_most_one(s: Seen) -> Bit:
    """Whatever the channels do, synchronisation isolates one of them at most, and never asks for EB by that."""
    return (count(s.cut.a, s.cut.b, s.cut.c) <= 1) & ~s.eb


@claim(Thresholds, faults=at_most(1, ARBITRARY), symbolic=LIMITS, expect=REFUTED, requirement="TS7-14",
       twin_of=synchronisation_isolates_at_most_one)  # fmt: skip
def an_arbitrary_channel_isolates_nobody(s: Seen) -> Bit:
    """Whatever the channels do, nobody is ever isolated.  False: a channel that brakes alone is."""
    return count(s.cut.a, s.cut.b, s.cut.c) == 0

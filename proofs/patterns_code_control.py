"""American code control: what the acknowledgement assures, and what it does not.

Steps of 0.1 s, time stamps in s.  Code, button, speed and stamps are anything.
Source: aspects, limits, acknowledgement [P]; edge, 6 s, latch to standstill [A].

Main results: red that is not acknowledged brings the emergency brake once the acknowledgement time is over, whatever
that time is, for ever, and the brake stays to standstill; a button stuck closed acknowledges nothing.  A red that is
acknowledged never stops the train below 15 mph: it may creep past the signal (SP-X3).
"""

from __future__ import annotations

from fractions import Fraction

from models.patterns.code_control import LIMITS, RED, CodeControl, HeldButton, SilenceAccepted
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Real,
    Scenario,
    Seen,
    all_of,
    any_of_faults,
    at_most,
    claim,
    dead,
    frozen,
    implies,
    last,
    open_circuit,
    persists,
    previous,
    select,
    since,
)

SOURCE = "[P] acknowledgement; T_ack, edge [A]"
PATIENCE = ("patience",)


def comes(s: Seen) -> Bit:
    """The cab signal falls to red in this cycle; at power-up it is red already."""
    return all_of(s.aspect == RED, previous(s.aspect, RED) != RED)


def goes_down(s: Seen) -> Bit:
    """The button goes down in this cycle."""
    return all_of(s.button, ~previous(s.button, True))


def unanswered(s: Seen) -> Bit:
    """Red has come, has stayed, and the button has not gone down since, this cycle included."""
    still = (s.aspect == RED) & ~goes_down(s)
    return all_of(since(comes(s), still), still)


def came_at(s: Seen) -> Real:
    """Stamp of the cycle at which red came last."""
    stamp: Real = last(s.now, comes(s), 0)
    return stamp


def unanswered_is_not_agreed(s: Seen) -> Bit:
    """What the registers know of an unanswered red: since when, and that it is not acknowledged."""
    still = (s.aspect == RED) & ~goes_down(s)
    known = (s.shown == RED) & ~s.agreed & (s.since == came_at(s))
    kept = all_of(s.shown == previous(s.aspect, RED), s.pressed == previous(s.button, True))
    return implies(since(comes(s), still), known) & kept


def silent_driver(s: Seen) -> Bit:
    """Red unanswered for the acknowledgement time."""
    return all_of(unanswered(s), s.now - came_at(s) >= s.patience)


SHORT = {"patience": Fraction(1, 2)}
RED_AT_1 = {"code": lambda k: 3 if k < 1 else 0, "now": lambda k: Fraction(k, 10)}


@claim(CodeControl, expect=PROVED, lemmas=[unanswered_is_not_agreed], symbolic=PATIENCE,
       requirement="SP-F1", source=SOURCE, witness=Scenario(8, RED_AT_1, SHORT))  # fmt: skip
def silence_brings_the_emergency_brake(s: Seen) -> Bit:
    """Red that has come and has not been acknowledged for the acknowledgement time brings the emergency brake, whatever
    that time is."""
    return implies(silent_driver(s), s.emergency)


@claim(SilenceAccepted, expect=REFUTED, symbolic=PATIENCE, requirement="SP-F1",
       twin_of=silence_brings_the_emergency_brake, scenario=Scenario(8, RED_AT_1, SHORT))  # fmt: skip
def silence_brings_the_emergency_brake_where_it_is_accepted(s: Seen) -> Bit:
    """The same of the variant that accepts a missing acknowledgement.  False: it never brakes."""
    return silence_brings_the_emergency_brake(s)


def registers_follow(s: Seen) -> Bit:
    """What the registers keep: the aspect before, when red came, the button before, the emergency brake."""
    kept = (s.shown == previous(s.aspect, RED)) & (s.since == came_at(s)) & (s.pressed == previous(s.button, True))
    return all_of(kept, s.latched == previous(s.emergency, False), s.agreed == previous(s.acknowledged, False))


@claim(CodeControl, expect=PROVED, lemmas=[registers_follow], symbolic=PATIENCE, requirement="SP-F1", source=SOURCE)
def brakes_come_just_then(s: Seen) -> Bit:
    """Red is acknowledged just by a button that goes down after it has come, until it goes; the emergency brake comes
    just with red that is not, after its time, and stays in motion; the service brake above the limit, or with it."""
    agreed = (s.aspect == RED) & ~comes(s) & (previous(s.acknowledged, False) | goes_down(s))
    came = select(comes(s), s.now, came_at(s))
    late = (s.aspect == RED) & ~agreed & (s.now >= came + s.patience)
    emergency = late | (previous(s.emergency, False) & (s.v > 0))
    limits = (implies(s.aspect == code, s.limit == limit) for code, limit in enumerate(LIMITS))
    brakes = (s.emergency == emergency) & (s.brake == (emergency | (s.v > s.limit)))
    return all_of(s.aspect == s.code, s.acknowledged == agreed, brakes, *limits)


@claim(CodeControl, expect=REFUTED, requirement="SP-F1", twin_of=brakes_come_just_then)
def brakes_come_just_above_the_limit(s: Seen) -> Bit:
    """The brakes come just above the limit.  False: red that is not acknowledged brings them, too."""
    return all_of(s.brake == (s.v > s.limit))


CLOCK_STOPS = Fault(frozen(), ["clock"], ANY_TIME, name="clock stops")


@claim(CodeControl, expect=REFUTED, defeat=True, symbolic=PATIENCE, requirement="SP-F1",
       faults=at_most(1, [CLOCK_STOPS]), twin_of=silence_brings_the_emergency_brake, source="[A] program clock stops",
       scenario=Scenario(12, RED_AT_1, SHORT, ["clock stops"], at=2))  # fmt: skip
def silence_brings_the_emergency_brake_though_the_clock_stops(s: Seen) -> Bit:
    """The same with a clock that stops.  False: the time never ends; the clock needs a watchdog of its own."""
    return silence_brings_the_emergency_brake(s)


@claim(CodeControl, expect=PROVED, symbolic=PATIENCE, requirement="SP-F1", source=SOURCE,
       witness=Scenario(10, {**RED_AT_1, "v": 5}, SHORT))  # fmt: skip
def emergency_brake_stays_to_standstill(s: Seen) -> Bit:
    """The emergency brake, once on, stays while the train runs, whatever the button and the code do."""
    return implies(previous(s.emergency, False) & (s.v > 0), s.emergency & s.brake)


@claim(CodeControl, expect=REFUTED, symbolic=PATIENCE, requirement="SP-F1",
       twin_of=emergency_brake_stays_to_standstill,
       scenario=Scenario(12, {**RED_AT_1, "code": lambda k: 0 if 1 <= k < 9 else 3}, SHORT))  # fmt: skip
def emergency_brake_stays_for_ever(s: Seen) -> Bit:
    """The emergency brake, once on, stays for ever.  False: at standstill it may go."""
    return implies(previous(s.emergency, False), s.emergency)


# --- the button ------------------------------------------------------------------------------------------------------


def red_for_long(s: Seen) -> Bit:
    """Red has come and stayed for the acknowledgement time."""
    return all_of(since(comes(s), s.aspect == RED), s.aspect == RED, s.now - came_at(s) >= s.patience)


def never_agreed(s: Seen) -> Bit:
    """With the button closed from power-up on nothing is acknowledged, and the stamp is that of red's coming."""
    known = (s.shown == RED) & (s.since == came_at(s))
    kept = all_of(s.pressed, ~s.agreed, s.shown == previous(s.aspect, RED))
    return implies(since(comes(s), s.aspect == RED), known) & kept


def stuck_closed(s: Seen) -> Bit:
    """The button is stuck closed from power-up on."""
    return all_of(s.ack_button)


CLOSED_AND_RED = Scenario(8, {**RED_AT_1, "button": True}, SHORT)


@claim(CodeControl, expect=PROVED, given=stuck_closed, lemmas=[never_agreed],
       symbolic=PATIENCE, requirement="SP-F1", source="[A] edge-triggered", witness=CLOSED_AND_RED)  # fmt: skip
def stuck_button_acknowledges_nothing(s: Seen) -> Bit:
    """With the button stuck closed every red brings the emergency brake after the acknowledgement time."""
    return implies(red_for_long(s), s.emergency)


@claim(HeldButton, expect=REFUTED, given=stuck_closed, symbolic=PATIENCE,
       requirement="SP-F1", twin_of=stuck_button_acknowledges_nothing, scenario=CLOSED_AND_RED)  # fmt: skip
def held_button_acknowledges_nothing(s: Seen) -> Bit:
    """The same of the variant in which a held button counts.  False: red is acknowledged for ever."""
    return stuck_button_acknowledges_nothing(s)


# --- limits ----------------------------------------------------------------------------------------------------------

LINES = [Fault(open_circuit(), [p], ANY_TIME, name=f"{p} open") for p in ("valve", "emergency_valve")]
LINES += [Fault(dead(), ["receiver"], ANY_TIME, name="receiver silent")]


@claim(CodeControl, expect=PROVED, faults=any_of_faults(LINES), symbolic=PATIENCE, requirement="SP-F1",
       source="[P] limits; fail-safe direction")  # fmt: skip
def brakes_above_the_limit_shown(s: Seen) -> Bit:
    """Faster than the limit of the code in the rails, or with a valve's line without current, the train brakes at once;
    a silent receiver shows red."""
    kept = all_of(*(implies((s.code == code) & (s.v > limit), s.brake) for code, limit in enumerate(LIMITS)))
    return kept & implies(~s.valve | ~s.emergency_valve, s.brake)


@claim(CodeControl, expect=REFUTED, faults=any_of_faults(LINES), symbolic=PATIENCE, requirement="SP-F1",
       twin_of=brakes_above_the_limit_shown)  # fmt: skip
def brakes_only_above_the_limit(s: Seen) -> Bit:
    """The train brakes only above the limit of the code in the rails.  False: lost lines brake, too."""
    return implies(s.brake, s.v > LIMITS[RED])


# --- SP-X3 -----------------------------------------------------------------------------------------------------------


@claim(CodeControl, expect=PROVED, symbolic=PATIENCE, requirement="SP-X3", source="[P] limit 15 mph after red",
       witness=Scenario(6, {**RED_AT_1, "button": lambda k: k == 3, "v": 6}))  # fmt: skip
def acknowledged_red_lets_creep(s: Seen) -> Bit:
    """Once red is acknowledged and no emergency brake is latched, a train at 15 mph or less is never braked, for
    ever."""
    return implies(s.acknowledged & ~s.latched & (s.v <= LIMITS[RED]), ~s.brake)


@claim(CodeControl, expect=REFUTED, defeat=True, requirement="SP-X3", source=SOURCE,
       twin_of=acknowledged_red_lets_creep, steps=250,
       scenario=Scenario(250, {**RED_AT_1, "button": lambda k: k == 3, "v": 6}))  # fmt: skip
def acknowledged_red_means_stopped(s: Seen) -> Bit:
    """A train that has been at an acknowledged red for 24 s stands or is braked.  False: at 6 m/s it has by then passed
    the signal, 137.61 m behind the B point."""
    return implies(persists(s.acknowledged, ticks=240), (s.v <= 0) | s.brake)


@claim(CodeControl, expect=REFUTED, symbolic=PATIENCE, requirement="SP-X3", twin_of=acknowledged_red_lets_creep,
       scenario=Scenario(12, {**RED_AT_1, "button": lambda k: k == 9, "v": 6}, SHORT))  # fmt: skip
def acknowledged_late_lets_creep(s: Seen) -> Bit:
    """The same where the emergency brake is on already.  False: it stays to standstill."""
    return implies(s.acknowledged & (s.v <= LIMITS[RED]), ~s.brake)


@claim(CodeControl, expect=REFUTED, symbolic=PATIENCE, requirement="SP-X3", twin_of=acknowledged_red_lets_creep,
       scenario=Scenario(8, {**RED_AT_1, "button": lambda k: k == 3, "v": 7}))  # fmt: skip
def acknowledged_red_lets_run(s: Seen) -> Bit:
    """The same at any speed.  False: above 15 mph the service brake comes."""
    return implies(s.acknowledged & ~s.latched, ~s.brake)

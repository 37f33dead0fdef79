"""Ground program by pulse spacing: who is too fast is braked, silence brakes, and what a lost pulse does.

Time in s, speed in m/s, spacing of the crossings in m.  A step is a look at the receiver, at any time.
Source: longer interval power, shorter one brake, no pulse for 2 T0 brake [P]; T0, dead band, departure order [A].

Main results: faster than the program by more than the dead band brakes at the next pulse, for any spacing, base
interval and band; silence for more than 2 T0 brakes at the next look.  At standstill the rules alone never give power.
Every second pulse missing gives power to a train that is up to twice as fast as the program.
"""

from __future__ import annotations

from fractions import Fraction

from models.patterns.ground_program import BAND, BASE, SILENT, GroundProgram
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
    frozen,
    implies,
    last,
    missing,
    open_circuit,
    previous,
    select,
    struck,
    stuck,
)
from safety.prove.laws import law

SOURCE = "[P] pulses at a constant interval; T0, dead band [A]"
SIZES = ("base", "band")
PULSES = {"pulse": True, "now": lambda k: (k + 1) * BASE}

# --- what the intervals mean -----------------------------------------------------------------------------------------


@law(expect=PROVED, requirement="SP-C1", source=SOURCE)
def short_interval_is_overspeed(v: Real, interval: Real, spacing: Real, base: Real, band: Real) -> Bit:
    """Between two crossings laid for a program speed, an interval is shorter than the dead band just where the train is
    faster than the program by more than it."""
    laid = (spacing > 0) & (base > 0) & (band >= 0) & (band < 1) & (v > 0) & (v * interval == spacing)
    short, fast = interval < base * (1 - band), v * base * (1 - band) > spacing
    return implies(laid, ~(short ^ fast))


@law(expect=REFUTED, requirement="SP-C1", twin_of=short_interval_is_overspeed)
def short_interval_is_any_overspeed(v: Real, interval: Real, spacing: Real, base: Real, band: Real) -> Bit:
    """The same for any speed above the program.  False: the dead band admits a little more."""
    laid = (spacing > 0) & (base > 0) & (band >= 0) & (band < 1) & (v > 0) & (v * interval == spacing)
    return implies(laid, ~((interval < base * (1 - band)) ^ (v * base > spacing)))


# --- the equipment ---------------------------------------------------------------------------------------------------


def interval(s: Seen) -> Real:
    """Time since the last pulse."""
    time: Real = s.now - s.pulsed
    return time


@claim(GroundProgram, expect=PROVED, symbolic=SIZES, requirement="SP-C1", source=SOURCE,
       witness=Scenario(3, {"pulse": True, "now": lambda k: k * BASE / 2}))  # fmt: skip
def too_fast_brakes(s: Seen) -> Bit:
    """A pulse that comes sooner than the dead band brakes at once, whatever base interval and band."""
    return implies(s.pulse & ~s.departs & (interval(s) < s.base * (1 - s.band)), s.brake & ~s.power)


@claim(GroundProgram, expect=REFUTED, requirement="SP-C1", twin_of=too_fast_brakes, scenario=Scenario(2, PULSES))
def sooner_than_the_base_interval_brakes(s: Seen) -> Bit:
    """Any pulse sooner than one at the end of the dead band brakes.  False: in the band the train coasts."""
    return implies(s.pulse & ~s.departs & (interval(s) < BASE * (1 + BAND)), s.brake)


LINES = [Fault(open_circuit(), [p], ANY_TIME, name=f"{p} open") for p in ("receiver", "valve", "contactor")]


@claim(GroundProgram, expect=PROVED, faults=any_of_faults(LINES), symbolic=SIZES, requirement="SP-H1", source=SOURCE,
       witness=Scenario(3, {"now": lambda k: k * BASE * 3}))  # fmt: skip
def silence_brakes(s: Seen) -> Bit:
    """Once no pulse has come for more than two base intervals the train is braked and has no power, also where the
    receiver is dead or a line is lost."""
    return implies((interval(s) > SILENT * s.base) & ~s.departs, s.brake & ~s.power)


@claim(GroundProgram, expect=REFUTED, symbolic=SIZES, requirement="SP-H1", twin_of=silence_brakes,
       scenario=Scenario(3, {"now": lambda k: k * BASE * 3, "departs": True}))  # fmt: skip
def silence_brakes_during_departure(s: Seen) -> Bit:
    """The same while the departure order is given.  False: it is what makes a train start."""
    return implies(interval(s) > SILENT * s.base, s.brake)


CLOCK_STOPS = Fault(frozen(), ["clock"], ANY_TIME, name="clock stops")
STOPPED_CLOCK = Scenario(6, {"pulse": lambda k: k < 2, "now": lambda k: (k + 1) * BASE}, present=["clock stops"], at=2)


@claim(GroundProgram, expect=REFUTED, defeat=True, faults=at_most(1, [CLOCK_STOPS]), requirement="SP-H1",
       source="[A] program clock stops", twin_of=silence_brakes, scenario=STOPPED_CLOCK)  # fmt: skip
def silence_brakes_though_the_clock_stops(s: Seen) -> Bit:
    """The same with a clock that stops.  False: time does not end; the clock needs a watchdog."""
    return implies((interval(s) > SILENT * BASE) & ~s.departs, s.brake)


@claim(GroundProgram, expect=PROVED, faults=any_of_faults(LINES), requirement="SP-F1", source="[A] energise to release",
       symbolic=SIZES)  # fmt: skip
def brake_and_power_never_together(s: Seen) -> Bit:
    """The train is never given power while it is braked; a valve's line once lost keeps it braked."""
    return all_of(~(s.brake & s.power), implies(struck(s, "valve open"), s.brake))


WELDED = Fault(stuck(1), ["contactor"], ANY_TIME, name="contactor welded")


@claim(GroundProgram, expect=REFUTED, defeat=True, faults=at_most(1, [WELDED]), requirement="SP-F1",
       twin_of=brake_and_power_never_together, source="[A] welded contact")  # fmt: skip
def brake_and_power_never_together_when_welded(s: Seen) -> Bit:
    """The same with a contactor that is welded.  False."""
    return all_of(~(s.brake & s.power))


def looked_back(s: Seen) -> tuple[Bit, Bit, Bit, Bit]:
    """Whether it is silent; whether this pulse is late, whether it is early; whether the last one was late."""
    waited = s.now - last(s.now, s.pulse | s.departs, 0)
    late = waited > s.base + s.base * s.band
    return waited > s.base + s.base, late, waited + s.base * s.band < s.base, last(late, s.pulse, False)


def orders_are_kept(s: Seen) -> Bit:
    """What the registers keep: stamp of the last pulse, whether it was late, the brake."""
    kept = (s.pulsed == last(s.now, s.pulse | s.departs, 0)) & (s.braking == previous(s.brake, True))
    return all_of(kept, s.powering == looked_back(s)[3])


@claim(GroundProgram, expect=PROVED, lemmas=[orders_are_kept], symbolic=SIZES, requirement="SP-C1", source=SOURCE)
def orders_are_just_these(s: Seen) -> Bit:
    """The brake comes just in silence, with an early pulse, or until the next pulse, the last two not in departure;
    power just with a late pulse, until the next, or in departure, without the brake."""
    silent, late, early, was_late = looked_back(s)
    slows = select(s.pulse, early, previous(s.brake, True))
    brake = ~s.departs & (silent | slows)
    power = (select(s.pulse, late, was_late) | s.departs) & ~brake
    return all_of(s.brake == brake, s.power == power)


@claim(GroundProgram, expect=REFUTED, requirement="SP-C1", twin_of=orders_are_just_these,
       scenario=Scenario(3, {"pulse": True, "now": lambda k: k * BASE * 2}))  # fmt: skip
def power_comes_just_in_departure(s: Seen) -> Bit:
    """Power comes just in departure.  False: a late pulse gives it, too."""
    return all_of(s.power == s.departs)


# --- what the rules leave out ----------------------------------------------------------------------------------------


def never_departs(s: Seen) -> Bit:
    """No departure order is given, and no pulse comes: the train stands."""
    return all_of(~s.departs, ~s.pulse)


def as_at_power_up(s: Seen) -> Bit:
    """The order that is kept is to brake."""
    return all_of(s.braking, ~s.powering)


@claim(GroundProgram, expect=PROVED, given=never_departs, symbolic=SIZES, requirement="SP-H1",
       source="[P] rules, without a departure order", lemmas=[as_at_power_up])  # fmt: skip
def standing_train_never_starts(s: Seen) -> Bit:
    """By the rules alone a train that stands is never given power."""
    return all_of(~s.power)


@claim(GroundProgram, expect=REFUTED, symbolic=SIZES, requirement="SP-H1", twin_of=standing_train_never_starts)
def train_never_starts(s: Seen) -> Bit:
    """No train is ever given power.  False: the departure order does, and later a long interval."""
    return standing_train_never_starts(s)


EVERY_SECOND = Fault(missing(every=2), ["receiver"], name="every second pulse missing")
FAST = Scenario(8, {"pulse": True, "now": lambda k: (k + 1) * BASE * Fraction(2, 3)}, present=[EVERY_SECOND.name])


def overspeed_gets_no_power(s: Seen) -> Bit:
    """A train that has crossed two crossings sooner than the dead band has no power."""
    soon = s.now - previous(s.now, 0) < BASE * (1 - BAND)
    return implies(s.pulse & previous(s.pulse, False) & soon & ~s.departs, ~s.power)


@claim(GroundProgram, expect=REFUTED, defeat=True, faults=at_most(1, [EVERY_SECOND]), requirement="SP-C1",
       source="[A] wrong-side: pulses missed", twin_of=too_fast_brakes, scenario=FAST)  # fmt: skip
def overspeed_gets_no_power_with_pulses_missing(s: Seen) -> Bit:
    """A train half as fast again as the program has no power, even if every second pulse is missed.  False: the doubled
    intervals look slow, and do not last long enough for the watchdog."""
    return overspeed_gets_no_power(s)

"""Two-counter ATC: what defeats it.  Refuted claims say that the train is braked; a replayed run shows that it is not.

All runs: 250 km/h selected, 10 % below its f2E, released; the fault strikes; then the train is too fast by its true
speed for 6000 periods (0.94 s), and no brake comes.  Where a fault only moves the limit, the train is too fast by less
than that.  Sizes of the faults are those of models/two_counter/failures.py.
Source: failures (a) to (m) of the specification's property 15 [D]; the paper concedes them in general (2.2) [P].

Main results: every one of them is a single fault, so each is a cut set of order 1.  A unit of n2E too many permits
0.5 km/h more, and no more.  Signal 3 missing holds the release for the 2048 edges of counter 2 only, for then signal 1
comes again and finds FF6 reset: late at 5 km/h, not at 250.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

from models.two_counter.equipment import Equipment
from models.two_counter.failures import component_faults, stage
from models.two_counter.numbers import CHECK_SPEEDS
from models.two_counter.train import KMH
from models.two_counter.variants import LevelReset, NoDefault
from proofs.two_counter_decision import runs_ahead
from proofs.two_counter_formulas import (
    ROWS,
    far_enough,
    greatest_permitted,
    least_too_fast,
    limit_of_release,
    named,
    preparation_in_order,
    steadily,
    through_the_window,
)
from proofs.two_counter_response import overspeed_brakes_in_time
from safety import ANY_TIME, PROVED, REFUTED, Bit, Fault, Scenario, Seen, age, any_of, any_of_faults, claim, implies

NAMED = {fault.name: fault for fault in component_faults()}
LONG_ENOUGH = 6000  # periods: by far more than a healthy one needs, 4018 at 250 km/h and 4349 at 5
LATE = 2250  # period at which the fault strikes: just after a reading that released
RELEASED = greatest_permitted(ROWS[250]) * 9 // 10


def selected(s: Seen, v: int | None) -> Bit:
    """The line of this check speed is active and none other; None: no line is."""
    lines = {x: s[f"lines.s{x}"] for x in CHECK_SPEEDS}
    others = ~any_of(*(on for x, on in lines.items() if x != v))
    return others if v is None else lines[v] & others


def brakes(s: Seen, v: int | None, speed: int) -> Bit:
    """Under this check speed, at a true speed or faster for long enough: it brakes."""
    lasts = selected(s, v) & (s.speed >= speed)
    return implies(lasts & (age(lasts, LONG_ENOUGH) >= LONG_ENOUGH - 1), s.brake)


def strikes(v: int | None, speed: int, *faults: Fault) -> Scenario:
    """Released under 250 km/h; then the fault, the check speed and the overspeed."""
    inputs = {"lines.s250": lambda k: v == 250 or k < LATE, "speed": lambda k: RELEASED if k < LATE else speed}
    if v not in (None, 250):
        inputs[f"lines.s{v}"] = lambda k: k >= LATE
    return Scenario(LATE + LONG_ENOUGH + 1, inputs, present=[f.name for f in faults], at=LATE)


class Defeat(NamedTuple):
    """A single fault, what it does, and by how much the train is too fast, in thousandths of the limit."""

    letter: str
    with_: str
    fault: Fault
    why: str
    excess: int = 100
    v: int = 250


DEFEATS = (
    Defeat("a", "the_generator_open", NAMED["generator open or short"], "no edges, no signal 1: the release is held"),
    Defeat("b", "a_fast_oscillator", NAMED["oscillator 1 % fast"], "the speed permitted is 1 % higher", 5),
    Defeat("b", "the_second_harmonic", NAMED["oscillator on its second harmonic"], "twice the speed is permitted", 900),
    Defeat("c", "lost_generator_pulses", NAMED["one generator pulse in 100 lost"], "it reads 1 % less", 5),
    Defeat("d", "ff6_stuck", NAMED["FF6 at 1"], "every sample reads safe"),
    Defeat("d", "gate_circuit_1_stuck", NAMED["gate circuit 1 at 1"], "FF6 is set by the first pulse"),
    Defeat("d", "ff2_stuck", NAMED["FF2 at 0"], "no command is stored"),
    Defeat("d", "a_welded_relay_contact", NAMED["Ry-1 contact welded"], "the command is not carried out"),
    Defeat("e", "a_larger_preset", NAMED["preset of 250 km/h"], "210 is selected, the limit is that of 250", 100, 210),
    Defeat("f", "and1_stuck", NAMED["AND1 at 1"], "counter 1 counts from signal 2 to signal 1, 6 edges more", 3),
    Defeat("g", "the_last_stage_of_counter_2_stuck", stage(2, 10, 0), "the preset is never reached"),
    Defeat("h", "signal_2_missing", NAMED["signal 2 missing"], "FF6 says safe for ever"),
    Defeat("i", "and2_stuck", NAMED["AND2 at 0"], "FF2 is never set"),
    Defeat("j", "signal_1_missing", NAMED["signal 1 missing"], "no reading: the release is held"),
    Defeat("j", "signal_3_missing", NAMED["signal 3 missing"], "no reading until counter 2 is round again", 100, 5),
    Defeat("k", "counts_of_counter_2_missing", NAMED["counter 2 misses one count in 100"], "the gate lasts longer", 5),
    Defeat("l", "counter_1_not_reset", NAMED["counter 1 is not reset"], "it goes on from the last sample"),
    Defeat("l", "a_stage_of_counter_1_stuck", stage(1, 10, 1), "976 pulses are enough", 900),
)


def defeated(d: Defeat) -> None:
    """Declare: refuted by the run in which just this fault strikes."""
    speed = least_too_fast(ROWS[d.v]) * (1000 + d.excess) // 1000
    speed = min(speed, 800_000)
    fault = replace(d.fault, onset=ANY_TIME)

    def formula(s: Seen) -> Bit:
        return brakes(s, d.v, speed)

    what = d.with_.replace("_", " ")
    formula.__doc__ = f"({d.letter}) With {what}: too fast for 0.94 s, and it brakes.  False: {d.why}."
    claim(Equipment, faults=any_of_faults([fault]), expect=REFUTED, defeat=True, requirement="TC-15",
          source=f"[D] ({d.letter})", scenario=strikes(d.v, speed, fault), twin_of=overspeed_brakes_in_time)(
        named(f"brakes_with_{d.with_}", formula)
    )  # fmt: skip


for each in DEFEATS:
    defeated(each)


@claim(NoDefault, expect=REFUTED, defeat=True, requirement="TC-15", source="[A] (m)", twin_of=overspeed_brakes_in_time,
       scenario=strikes(None, least_too_fast(ROWS[250]) * 11 // 10))  # fmt: skip
def brakes_with_no_check_speed_decoded(s: Seen) -> Bit:
    """(m) No check speed selected, nothing decoded, faster than all of them for 0.94 s: it brakes.  False: without a
    preset there is no reading, and the release is held."""
    return brakes(s, None, least_too_fast(ROWS[250]))


AND3_LEVEL = replace(NAMED["AND3 at 1"], onset=ANY_TIME)


@claim(LevelReset, faults=any_of_faults([AND3_LEVEL]), expect=REFUTED, defeat=True, requirement="TC-15",
       source="[A] AND3 as a level", twin_of=overspeed_brakes_in_time,
       scenario=strikes(250, 600_000, AND3_LEVEL))  # fmt: skip
def brakes_with_and3_as_a_level(s: Seen) -> Bit:
    """AND3 stuck at 1 behind its strobe: too fast for 0.94 s, and it brakes.  False: the level resets FF2 again after
    each reading."""
    return brakes(s, 250, 600_000)


# --- (e): by how much a preset that is too large defeats it ----------------------------------------------------------

LARGER = ROWS[250] + 2  # edges: a unit of n2E
ONE_UNIT = {"selection.m250": LARGER}


def larger_preset_in_order(s: Seen) -> Bit:
    """In the preparation counter 2 is below 8; from signal 2 on FF6 and counter 1 are reset; no count passes 1037."""
    return preparation_in_order(s, LARGER)


def read_at(s: Seen, speed: Fraction) -> Bit:
    """At this speed or faster all through a window under the larger preset: its reading brakes."""
    return implies(s.signal1 & through_the_window(s, far_enough(s, lambda m: speed, [LARGER])), s.brake)


@claim(Equipment, settings=ONE_UNIT, lemmas=[larger_preset_in_order, runs_ahead(presets=[LARGER])], expect=PROVED,
       requirement="TC-15", source="[D] (e), (5)", witness=steadily(250, least_too_fast(LARGER)))  # fmt: skip
def a_unit_more_of_n2e_permits_half_a_kmh_more(s: Seen) -> Bit:
    """(e) With n2E a unit (two edges) larger at 250 km/h: from n1F/(n1F - 1) times f2E + 0.5 km/h on every reading
    brakes."""
    return read_at(s, limit_of_release(LARGER))


@claim(Equipment, settings=ONE_UNIT, expect=REFUTED, defeat=True, requirement="TC-15", source="[D] (e)",
       scenario=steadily(250, greatest_permitted(LARGER)),
       twin_of=a_unit_more_of_n2e_permits_half_a_kmh_more)  # fmt: skip
def a_unit_more_of_n2e_permits_less(s: Seen) -> Bit:
    """(e) So it does at f2E + 0.5 km/h.  False: at that speed every reading releases."""
    return read_at(s, Fraction(greatest_permitted(ROWS[250]) + KMH // 2))

"""Two-counter ATC: what the circuit does whatever the speed: safe failures, exclusive gates, order of the signals.

One step is one oscillator period.  Speed and selection are anything at every step; a fault begins at any step.

Main results: a stopped oscillator, a counter 1 that does not count, a dead gate circuit 1, AND1 or FF6 ends in brake at
the first reading of a window that began after it; no supply or no coil is brake at once; between two readings there is
one reset and one start, and no reading uses a count of an earlier window.
Source: section 5 and figure 6 [P], read consistently; order and places of the signals [D].
"""

from __future__ import annotations

from dataclasses import replace

from models.two_counter.equipment import Equipment
from models.two_counter.failures import component_faults, stage
from proofs.two_counter_formulas import (
    ROWS,
    counted,
    counting,
    edges,
    greatest_permitted,
    line,
    preparation_in_order,
    preset,
    safe,
    steadily,
)
from safety import (
    ANY_TIME,
    INTERMITTENT,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    UInt,
    all_of,
    any_of,
    any_of_faults,
    at_most,
    claim,
    has,
    implies,
    new_fault,
    once,
    reads,
    select,
    since,
    struck,
    stuck,
    word,
)

NAMED = {fault.name: fault for fault in component_faults()}
SLOW = greatest_permitted(ROWS[250]) * 9 // 10  # released at 250


def released_before(fault: Fault, at: int = 3000, steps: int = 7500) -> Scenario:
    """Steadily below 250 km/h, which releases; then the fault begins."""
    return steadily(250, SLOW, steps, present=[fault.name], at=at)


# --- TC-6: oscillator stop -------------------------------------------------------------------------------------------

STOPS = Fault(stuck(0), ["oscillator.f1"], INTERMITTENT, name="oscillator stops and starts")


def silent(s: Seen) -> Bit:
    """No oscillator pulse at this step."""
    return s["oscillator.out"] == 0


def silent_window(s: Seen) -> Bit:
    """No oscillator pulse since the last signal 3, as long as the gate was open."""
    return since(s.signal3 & silent(s), ~s.signal3 & (silent(s) | ~counting(s)))


def nothing_counted(s: Seen) -> Bit:
    """Without a pulse since signal 3 counter 1 stands at 0 and FF6 is reset."""
    return implies(silent_window(s), ~safe(s) & implies(counting(s), counted(s) == 0))


@claim(Equipment, faults=any_of_faults([STOPS]), lemmas=[preparation_in_order, nothing_counted],
       expect=PROVED, requirement="TC-6", source="[P] section 5", witness=released_before(STOPS))  # fmt: skip
def a_stopped_oscillator_brakes(s: Seen) -> Bit:
    """No oscillator pulse all through a window, and its reading brakes."""
    return implies(s.signal1 & silent_window(s), s.brake)


@claim(Equipment, faults=any_of_faults([STOPS]), expect=REFUTED, requirement="TC-6",
       twin_of=a_stopped_oscillator_brakes, scenario=released_before(STOPS, 2119))  # fmt: skip
def an_oscillator_that_stops_within_the_window_brakes(s: Seen) -> Bit:
    """No oscillator pulse when the gate closes, and the reading brakes.  False: FF6 had been set before."""
    return implies(s.signal1 & since(silent(s) & counting(s) & ~s.gate, ~s.signal3), s.brake)


# --- TC-8: what never says that the train is slow enough -------------------------------------------------------------

NO_COUNT = [replace(NAMED[n], onset=ANY_TIME) for n in ("AND1 at 0", "gate circuit 1 at 0", "FF6 at 0")] + [
    Fault(reads(0), ["circuit.counter1.count"], ANY_TIME, name="counter 1 does not count"),
    replace(stage(1, 10, 0), onset=ANY_TIME),
]  # fmt: skip
FAILED = tuple(fault.name for fault in NO_COUNT)
AND1, _, _, COUNTER, STAGE = FAILED


def failed_before_the_window(s: Seen) -> Bit:
    """The last signal 3 came after the fault."""
    return since(s.signal3 & struck(s, *FAILED), ~s.signal3)


def never_enough(s: Seen) -> Bit:
    """In such a window counter 1 stays below n1F, or nobody is told: FF6 stays reset."""
    whole = failed_before_the_window(s)
    standing = implies(has(s, AND1, COUNTER), counted(s) == 0)
    low = implies(has(s, STAGE), counted(s) < 1024)
    return implies(whole, struck(s, *FAILED) & ~safe(s) & implies(counting(s), standing & low))


@claim(Equipment, faults=at_most(1, NO_COUNT), lemmas=[preparation_in_order, never_enough],
       expect=PROVED, requirement="TC-8", source="[P] section 5", witness=released_before(NO_COUNT[0]))  # fmt: skip
def a_count_that_is_not_reached_brakes(s: Seen) -> Bit:
    """AND1, gate circuit 1 or FF6 dead, counter 1 or its last stage at 0, from any time on: the reading of the first
    window that began after it, and of every later one, brakes."""
    return implies(s.signal1 & failed_before_the_window(s), s.brake)


HIGH = replace(stage(1, 10, 1), onset=ANY_TIME)


@claim(Equipment, faults=at_most(1, [HIGH]), expect=REFUTED, requirement="TC-8", source="[D]",
       twin_of=a_count_that_is_not_reached_brakes, defeat=True,
       scenario=steadily(110, 2 * greatest_permitted(ROWS[110]), present=[HIGH.name], at=1))  # fmt: skip
def a_stage_of_counter_1_stuck_at_1_brakes(s: Seen) -> Bit:
    """The same with the last stage of counter 1 stuck at 1.  False: 976 pulses are enough, at twice the speed."""
    return implies(s.signal1 & since(s.signal3 & struck(s, HIGH.name), ~s.signal3), s.brake)


# --- TC-9: no power, no coil -----------------------------------------------------------------------------------------

NO_SUPPLY = Fault(stuck(0), ["circuit.supply"], ANY_TIME, name="no supply")
DEAD = [replace(NAMED["Ry-1 coil open"], onset=ANY_TIME), NO_SUPPLY]
DIP = replace(NAMED["power dips"], ticks=100)


@claim(Equipment, faults=at_most(1, DEAD), expect=PROVED, requirement="TC-9", source="[P] figure 6",
       witness=released_before(DEAD[0]))  # fmt: skip
def without_power_or_coil_the_brake_comes_at_once(s: Seen) -> Bit:
    """Logic power lost or the coil of Ry-1 open from any step on: brake at that step and for ever."""
    return implies(new_fault(s) | struck(s, *(f.name for f in DEAD)), s.brake)


WELDED = replace(NAMED["Ry-1 contact welded"], onset=ANY_TIME)


@claim(Equipment, faults=at_most(1, [WELDED]), expect=REFUTED, requirement="TC-9", scenario=released_before(WELDED),
       twin_of=without_power_or_coil_the_brake_comes_at_once)  # fmt: skip
def a_welded_contact_brakes_at_once(s: Seen) -> Bit:
    """The same with the contact of Ry-1 welded."""
    return implies(struck(s, WELDED.name), s.brake)


def since_the_dip(s: Seen) -> Bit:
    """Power has dipped, and signal 3 has not come since."""
    return since(new_fault(s), ~s.signal3)


def restarts_braking(s: Seen) -> Bit:
    """From a dip to the next signal 3 FF6 is reset and FF2 set."""
    return implies(since_the_dip(s), ~safe(s) & s.circuit.ff2.on & ~counting(s) & ~s.circuit.ry1.closed)


@claim(Equipment, faults=at_most(1, [DIP]), lemmas=[restarts_braking], expect=PROVED, requirement="TC-9",
       source="[A] power-up value of FF2", witness=released_before(DIP))  # fmt: skip
def a_power_dip_comes_up_braking(s: Seen) -> Bit:
    """Power lost for up to 100 periods at any time: brake from its first step to signal 3 of the restart."""
    return implies(new_fault(s) | since_the_dip(s), s.brake)


@claim(Equipment, faults=at_most(1, [DIP]), expect=REFUTED, requirement="TC-9",
       twin_of=a_power_dip_comes_up_braking, scenario=released_before(DIP, steps=9000))  # fmt: skip
def a_power_dip_brakes_for_good(s: Seen) -> Bit:
    """After a dip of power the brake stays.  False: the next window releases."""
    return implies(once(new_fault(s)), s.brake)


# --- TC-10: exclusive gating -----------------------------------------------------------------------------------------


def one_gate(s: Seen) -> Bit:
    """AND2 or AND3 is open, and not both: at signal 1 one of set and reset reaches FF2."""
    return s["circuit.and2"] ^ s["circuit.and3"]


@claim(Equipment, expect=PROVED, requirement="TC-10", source="[P] section 5")
def one_of_and2_and_and3_is_open(s: Seen) -> Bit:
    """One of AND2 and AND3 is open, not both; at signal 1 FF2 takes what it says."""
    return one_gate(s) & implies(s.signal1, ~(s["circuit.ff2.out"] ^ s["circuit.and2"]))


@claim(Equipment, faults=any_of_faults([NAMED["AND3 at 1"]]), expect=REFUTED, requirement="TC-10",
       twin_of=one_of_and2_and_and3_is_open)  # fmt: skip
def one_of_and2_and_and3_is_open_with_and3_stuck(s: Seen) -> Bit:
    """The same with AND3 stuck at 1."""
    return one_gate(s)


# --- check-speed selection -------------------------------------------------------------------------------------------


def lowest_line(s: Seen, none: int) -> UInt:
    """The preset of the lowest line that is active, or that for none."""
    chosen = word(none, 11)
    for v, m in ROWS.items():
        chosen = select(s[f"lines.s{v}"], word(m, 11), chosen)
    return chosen


@claim(Equipment, expect=PROVED, requirement="TC-14", source="[D] presets; lowest line, lowest preset for none [A]")
def the_lowest_line_sets_the_preset(s: Seen) -> Bit:
    """The preset is that of the lowest check speed selected; with none, that of 5 km/h."""
    return preset(s) == lowest_line(s, ROWS[5])


@claim(Equipment, expect=REFUTED, requirement="TC-14", twin_of=the_lowest_line_sets_the_preset)
def no_line_sets_the_highest_preset(s: Seen) -> Bit:
    """The same, with none that of 250 km/h."""
    return preset(s) == lowest_line(s, ROWS[250])


# --- TC-11, TC-12: order, freshness ----------------------------------------------------------------------------------


def last_was(s: Seen, n: int) -> Bit:
    """Signal n has come, and none of the others since."""
    others = [s[f"signal{k}"] for k in (1, 2, 3) if k != n]
    return since(s[f"signal{n}"], ~any_of(*others))


def none_yet(s: Seen) -> Bit:
    """No signal has come."""
    return ~once(s.signal1 | s.signal2 | s.signal3)


def in_its_place(s: Seen) -> Bit:
    """Counter 2 tells which signal was the last."""
    n = edges(s)
    preparing = select(n < 2, last_was(s, 3) | none_yet(s), select(n < 4, last_was(s, 1), last_was(s, 2)))
    return select(counting(s), last_was(s, 3), preparing)


def in_order(s: Seen) -> Bit:
    """Signal 1 comes first or after signal 3, 2 after 1, 3 after 2, one at a time; 3 finds FF6 and counter 1 reset."""
    one = all_of(*(~(s[f"signal{a}"] & s[f"signal{b}"]) for a, b in ((1, 2), (1, 3), (2, 3))))
    after = (
        implies(s.signal1, last_was(s, 3) | none_yet(s))
        & implies(s.signal2, last_was(s, 1))
        & implies(s.signal3, last_was(s, 2) & ~safe(s) & (counted(s) == 0))
    )
    return one & after


HEALTHY = steadily(250, SLOW, 5000)


@claim(Equipment, lemmas=[preparation_in_order, in_its_place], expect=PROVED, requirement="TC-11", 
       source="[P] order; places [D]", witness=HEALTHY)  # fmt: skip
def signals_come_in_order(s: Seen) -> Bit:
    """Between two signals 1 come one signal 2, then one signal 3, never together; 3 finds FF6 and counter 1 reset."""
    return in_order(s)


@claim(Equipment, faults=any_of_faults([NAMED["signal 2 missing"]]), expect=REFUTED, requirement="TC-11",
       twin_of=signals_come_in_order, scenario=released_before(NAMED["signal 2 missing"], 0))  # fmt: skip
def signals_come_in_order_without_signal_2(s: Seen) -> Bit:
    """The same with signal 2 missing."""
    return in_order(s)


def reached_in_this_window(s: Seen) -> Bit:
    """Gate circuit 1 has given its output while the gate was open, after the last signal 3."""
    return since(s["circuit.counter1.out"] & s.gate, ~s.signal3)


def fresh(s: Seen) -> Bit:
    """FF6 is set by this window only."""
    return implies(safe(s), reached_in_this_window(s))


@claim(Equipment, lemmas=[preparation_in_order, fresh], expect=PROVED, requirement="TC-12",
       source="[P] signal 2 resets", witness=HEALTHY)  # fmt: skip
def a_release_is_fresh(s: Seen) -> Bit:
    """FF6 set at signal 1: counter 1 reached n1F after the last signal 3."""
    return implies(s.signal1 & safe(s), reached_in_this_window(s))


def then_faster() -> Scenario:
    """A window of 2060 pulses, so that counter 1 goes on from 12; then 300 km/h."""
    speeds = {"speed": lambda k: 502_427 if k < 2090 else 600_000}
    return Scenario(4000, {**line(250), **speeds}, present=["signal 2 missing"])


@claim(Equipment, faults=any_of_faults([NAMED["signal 2 missing"]]), expect=REFUTED, requirement="TC-12",
       twin_of=a_release_is_fresh, scenario=then_faster())  # fmt: skip
def a_release_is_fresh_without_signal_2(s: Seen) -> Bit:
    """The same with signal 2 missing.  False: FF6 stays set."""
    return implies(s.signal1 & safe(s), reached_in_this_window(s))

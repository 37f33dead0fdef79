"""Two-counter ATC at 250 km/h with signals 1 and 2 swapped: harmless, by an invariant of its own.

Swapped, FF6 is reset before it is read out, so each read-out brakes.  Only where they are swapped between the two of
one preparation is a read-out *stale*, by a command that was safe before; the next one brakes.
One step is an oscillator period.
"""

from __future__ import annotations

from dataclasses import replace

from models.two_counter.circuit import READ_OUT, RESET, START
from models.two_counter.equipment import Equipment
from models.two_counter.failures import component_faults
from proofs.two_counter_brake_chain import Chain
from proofs.two_counter_formulas import EDGE
from proofs.two_counter_hazards import CHAIN, LINES, RIDE
from safety import ANY_TIME, PROVED, REFUTED, Bit, Int, Scenario, Seen, age, at_most, claim, implies, select, struck

NAME, OTHER = "signals 1 and 2 swapped", "signals 2 and 3 swapped"
SWAPPED, OTHERS = (replace(f, onset=ANY_TIME) for name in (NAME, OTHER) for f in component_faults() if f.name == name)
M = RIDE.m


def period(s: Seen) -> Bit:
    """Lemma: counter 2 is within its period."""
    return select(s.circuit.counter2.counting, s.circuit.counter2.n < M, s.circuit.counter2.n < START)


def stale(s: Seen) -> Bit:
    """FF6 is on where it has been reset, but for a swap just then."""
    n = s.circuit.counter2.n
    return ~s.circuit.counter2.counting & (n >= READ_OUT) & (n < RESET) & s.circuit.ff6.on


def left(s: Seen) -> Int:
    """Turning until a read-out that brakes."""
    n = s.circuit.counter2.n.int()
    preparing = select(~stale(s) & (n < RESET), RESET - n, START + M + RESET - n)
    return EDGE * select(s.circuit.counter2.counting, M + RESET - n, preparing) - s.train.phase


def worked_off(s: Seen) -> Bit:
    """Lemma: overspeed has worked off its share, or the brake is applied for good."""
    since = age(CHAIN.overspeed(s), CHAIN.braked).int()
    braked = s.circuit.ff2.on & ~stale(s)
    return ~struck(s, NAME) | braked | (left(s) <= (START + M + RESET) * EDGE - CHAIN.speed * since)


@claim(Equipment, expect=PROVED, faults=at_most(1, [SWAPPED]), requirement="TC-16", source="[D]",
       lemmas=[period, worked_off, *Chain(M, lambda s: struck(s, NAME)).lemmas()],
       witness=Scenario(5000, {**LINES, "speed": CHAIN.speed}))  # fmt: skip
def brakes_with_signals_1_and_2_swapped(s: Seen) -> Bit:
    """At 250 km/h, with signals 1 and 2 swapped, at any time, overspeed for 4019 steps (0.626 s) brakes."""
    return implies(RIDE.too_fast_too_long(s), s.brake)


@claim(Equipment, expect=REFUTED, faults=at_most(1, [OTHERS]), requirement="TC-16", defeat=True, source="[D]",
       scenario=RIDE.scenarios((OTHER,))[2], twin_of=brakes_with_signals_1_and_2_swapped)  # fmt: skip
def brakes_with_signals_2_and_3_swapped(s: Seen) -> Bit:
    """With signals 2 and 3 swapped it does too.  False: FF6 is never reset, and says safe for ever."""
    return brakes_with_signals_1_and_2_swapped(s)

"""Two-counter ATC at 250 km/h: minimal cut sets of "too fast and no brake", over component faults at any time.

Three lists of faults, each complete at every order: the functional failures of all components; the stages of the
counters that do harm (the others are claims); lines and bits of the check-speed selection.  Sets across the lists are
not among them: the campaign of pairs injects these.

Results: 61 single faults, 21 of 56 functional failures, 33 of 44 stages, 7 of 39 of the selection; and 8 pairs, all of
the selection.  What the paper concedes is seen here: hardly anything in this circuit is redundant.  Beside the known
defeats (`DEFEATS`, of property 15) there are those of `FURTHER`, each with its reason.

That signal 3 is missing does not hold the command for ever: counter 2 has 11 stages and runs through 0 again, so the
next read-out brakes, 2050 edges later, which is later than property 4 allows.

Too fast: a speed at which the count is sure to fall short of n1F, for the 2 n2E + 5 pulses of property 4.
Not in the proof but in the campaign: `SIMULATED`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from models.two_counter.equipment import Equipment
from models.two_counter.failures import component_faults
from models.two_counter.selection import Lines
from proofs.two_counter_brake_chain import Chain
from proofs.two_counter_parts import INVENTED, component_rate
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    TRANSIENT,
    Bit,
    Fault,
    Scenario,
    Seen,
    any_of,
    at_most,
    claim,
    hazard,
    implies,
    persists,
    struck,
)

STAGES = range(11)

DEFEATS = {  # property 15, by its letter
    "a": ["generator open or short"],
    "b": ["oscillator 1 % fast", "oscillator on its second harmonic"],
    "c": ["one generator pulse in 100 lost"],
    "d": ["FF6 at 1", "gate circuit 1 at 1", "FF2 at 0", "Ry-1 contact welded"],
    "e": [f"preset bit {k} at 1" for k in (2, 4, 5, 6, 7, 8, 9)],
    "f": ["AND1 at 1"],
    "g": [f"counter 2: stage {k} at {value}" for k in STAGES for value in (0, 1)],
    "h": ["signal 2 missing"],
    "i": ["AND2 at 0"],
    "j": ["signal 1 missing", "signal 3 missing"],
    "k": ["counter 2 misses one count in 100"],
    "l": ["counter 1 is not reset", *(f"counter 1: stage {k} at 1" for k in STAGES)],
}
FURTHER = {  # what else is a single cut set, and why
    "counter 2 is not reset": "after a count it runs on to 2048 before a read-out can come: late, at half the rate",
    "counting gate at 1": "a count follows a count without a preparation, so no read-out comes: hold",
    "signal 3 always": "counter 2 is cleared in each step, so no read-out comes: hold",
    "signals 2 and 3 swapped": "the count begins where signal 2 was due, which so never comes: stale safe",
    "signals 1 and 3 swapped": "the count begins where signal 1 was due, which so never comes: hold",
    "FF6 flips": "between signal 2 and the count nothing resets it any more: one sample reads safe, the brake is late",
}
SINGLES = [name for names in (*DEFEATS.values(), FURTHER) for name in names]

SIMULATED = ("generator 5 km/h high", "generator 5 km/h low", "signals 1 and 2 swapped")


def chosen(which: Callable[[str], bool]) -> list[Fault]:
    """The component faults with such names, at any time."""
    found = (f for f in component_faults() if f.name not in SIMULATED and which(f.name))
    return [f if f.onset == TRANSIENT else replace(f, onset=ANY_TIME) for f in found]


FUNCTIONAL = chosen(lambda name: ": stage" not in name and "preset bit" not in name)
COUNTERS = chosen(lambda name: ": stage" in name and name in SINGLES)
STAGES_AT_0 = chosen(lambda name: ": stage" in name and name not in SINGLES)  # of counter 1
SELECTION = chosen(lambda name: name.startswith(("preset", "line", "no selection")))
LOWER = ("line s250 missing", *(f"line s{v} besides" for v in (210, 160, 110, 70, 30, 5)), "no selection")
PAIRS = tuple(("preset bit 10 at 1", name) for name in LOWER)  # 1024 added to the preset of a lower check speed


def chain(faults: Sequence[Fault]) -> Chain:
    """The way to the brake where these faults may be."""
    names = {fault.name for fault in faults}
    excused = [name for name in (*SINGLES, "power off") if name in names]
    together = [pair for pair in PAIRS if names.issuperset(pair)]
    stranding = [name for name in ("counting gate at 0",) if name in names]

    def broken(s: Seen) -> Bit:
        return any_of(*(struck(s, n) for n in excused), *(struck(s, a) & struck(s, b) for a, b in together))

    return Chain(1035, broken, lambda s: any_of(*(struck(s, name) for name in stranding)))


def rates(faults: Sequence[Fault]) -> dict[str, tuple[str, str]]:
    """Failures per hour of each, from the parts list."""
    return {fault.name: (component_rate(fault), INVENTED) for fault in faults}


CHAIN = Chain(1035)
WITHIN = 500_000  # 250 km/h on the frequency scale, 8.75 km/h below the threshold
LINES = {f"lines.{name}": name == "s250" for name in Lines._fields}


def only_250(s: Seen) -> Bit:
    """The check speed 250 km/h is selected, and no other."""
    return s.lines.s250 & ~any_of(*(s.lines[name] for name in Lines._fields if name != "s250"))


STRIKES = ((3000, 4182), (4181, 4182), (5900, 5901), (4100, 4182), (2101, 2110))  # steps of fault and overspeed


def scenarios(present: tuple[str, ...]) -> Iterator[Scenario]:
    """Released within the limit; the faults strike; overspeed: while a preparation runs, or a count."""
    for strike, begins in STRIKES:
        speed = {"speed": lambda k, begins=begins: WITHIN if k < begins else CHAIN.speed}
        yield Scenario(begins + CHAIN.braked + 20, {**LINES, **speed}, present=present, at=strike)


def too_fast_too_long(s: Seen) -> Bit:
    """Overspeed for the time that property 4 allows."""
    return persists(CHAIN.overspeed(s), CHAIN.braked)


@hazard(
    Equipment, faults=FUNCTIONAL, scenarios=scenarios, lemmas=chain(FUNCTIONAL).lemmas(),
    rates=rates(FUNCTIONAL), hours="10000",
    requirement="TC-16", source="[D]", expect={1: 21},
)  # fmt: skip
def overspeed_without_brake(s: Seen) -> Bit:
    """At 250 km/h, after a functional failure: overspeed for 4019 steps (0.626 s) and no brake."""
    return too_fast_too_long(s) & ~s.brake


def with_fault(fault: Fault) -> Callable[[Seen], Bit]:
    """The claim that one component fault does no harm."""

    def formula(s: Seen) -> Bit:
        return implies(too_fast_too_long(s), s.brake)

    formula.__name__ = f"brakes_with_{fault.name.replace(':', '').replace(' ', '_')}"
    formula.__doc__ = f"At 250 km/h, with {fault.name}, at any time, overspeed for 4019 steps (0.626 s) brakes."
    return formula


HARMLESS_STAGES = [
    claim(
        Equipment, expect=PROVED, faults=at_most(1, [one]), lemmas=chain([one]).lemmas(),
        witness=Scenario(5000, {**LINES, "speed": CHAIN.speed}), requirement="TC-16", source="[D]",
    )(with_fault(one))
    for one in STAGES_AT_0
]  # fmt: skip


@claim(
    Equipment, expect=REFUTED, faults=at_most(1, COUNTERS), requirement="TC-16", defeat=True,
    source="property 15 (l)", scenario=next(scenarios(("counter 1: stage 0 at 1",))),
)  # fmt: skip
def brakes_with_a_stage_at_1(s: Seen) -> Bit:
    """At 250 km/h, with a stage of counter 1 stuck at 1, overspeed for 4019 steps (0.626 s) brakes."""
    return implies(too_fast_too_long(s), s.brake)


@hazard(
    Equipment, faults=COUNTERS, scenarios=scenarios, lemmas=chain(COUNTERS).lemmas(),
    rates=rates(COUNTERS), hours="10000",
    requirement="TC-16", source="[D]", expect={1: 33},
)  # fmt: skip
def overspeed_without_brake_by_a_stage(s: Seen) -> Bit:
    """At 250 km/h, with stages of the counters stuck: overspeed for 4019 steps (0.626 s) and no brake."""
    return too_fast_too_long(s) & ~s.brake


@hazard(
    Equipment, faults=SELECTION, scenarios=scenarios, given=only_250, lemmas=chain(SELECTION).lemmas(),
    rates=rates(SELECTION), hours="10000",
    requirement="TC-16", source="[D]", expect={1: 7, 2: 8},
)  # fmt: skip
def overspeed_without_brake_by_the_selection(s: Seen) -> Bit:
    """At 250 km/h, with lines or bits of the preset stuck: overspeed for 4019 steps (0.626 s) and no brake."""
    return too_fast_too_long(s) & ~s.brake

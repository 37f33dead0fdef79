"""Speed patterns: whatever holds the brake off is held by current; lost, it brakes within a cycle (SP-F1).

Proved for every motion, signal and driver, and for each line lost at any time; one step is a cycle of 0.1 s.  A sensor
that falls silent is no lost line: it is the wrong-side row of the fault table.
"""

from __future__ import annotations

from models.patterns.equipment import CombinedEquipment, PointEquipment, ProgramEquipment
from models.patterns.failures import component_faults
from safety import ANY_TIME, PROVED, REFUTED, Bit, Fault, Seen, at_most, claim, dead, implies, struck, stuck

SPEED = "speed generator: zero output"


def lost(*lines: str) -> list[Fault]:
    """Each of these lines without current, from any time on."""
    return [Fault(dead(), [line], onset=ANY_TIME, name=f"{line} lost") for line in lines]


def names(faults: list[Fault]) -> list[str]:
    """How they are called."""
    return [fault.name for fault in faults]


LINES = lost("vehicle.relay", "vehicle.coil", "pattern.comparator")
OF_PROGRAM = lost("vehicle.relay", "vehicle.coil", "comparator", "ticks")
SILENT = [fault for fault in component_faults(PointEquipment) if fault.name == SPEED]


@claim(PointEquipment, expect=PROVED, faults=at_most(1, LINES), requirement="SP-F1", source="[P] energised to release")
def a_lost_line_brakes(s: Seen) -> Bit:
    """By point: when relay, valve coil or comparator loses its current, the brake is on within a cycle."""
    return implies(struck(s, *names(LINES)), s.brake.on)


@claim(
    PointEquipment, expect=REFUTED, faults=at_most(1, SILENT), requirement="SP-F1", source="[A] fault table",
    twin_of=a_lost_line_brakes,
)  # fmt: skip
def a_silent_sensor_brakes(s: Seen) -> Bit:
    """By point: when the speed generator gives nothing, the brake is on within a cycle."""
    return implies(struck(s, SPEED), s.brake.on)


@claim(
    CombinedEquipment, expect=PROVED, faults=at_most(1, LINES), requirement="SP-H1",
    source="[P] loss of current is the most restrictive",
)  # fmt: skip
def no_current_brakes_or_supervises(s: Seen) -> Bit:
    """By point and continuous: without current the brake is on, or a pattern has been started."""
    return implies(~s.current, s.brake.on | ~s.inductor.relay | s.inductor.tripped)


@claim(CombinedEquipment, expect=REFUTED, requirement="SP-H1", source="[A] a pattern brakes above its ceiling only",
       twin_of=no_current_brakes_or_supervises)  # fmt: skip
def no_current_brakes(s: Seen) -> Bit:
    """By point and continuous: without current the brake is on.  False: a pattern is started, and may be kept."""
    return implies(~s.current, s.brake.on)


@claim(
    ProgramEquipment, expect=PROVED, faults=at_most(1, OF_PROGRAM), requirement="SP-F1",
    source="[P] energised to release",
)  # fmt: skip
def a_lost_line_of_the_program_brakes(s: Seen) -> Bit:
    """By ground program: when relay, valve coil, comparator or clock fails, or no current feeds the conductor, the
    brake is on within a cycle."""
    return implies(struck(s, *names(OF_PROGRAM)) | ~s.current, s.brake.on)


STUCK = Fault(stuck(0), ["vehicle.vent"], onset=ANY_TIME, name="valve does not vent")


@claim(ProgramEquipment, expect=REFUTED, faults=at_most(2, [*OF_PROGRAM, STUCK]), requirement="SP-F1",
       source="[A] fault table", twin_of=a_lost_line_of_the_program_brakes)  # fmt: skip
def a_lost_line_of_the_program_brakes_with_a_stuck_valve(s: Seen) -> Bit:
    """So it does with a valve that does not vent.  False."""
    return a_lost_line_of_the_program_brakes(s)

"""ATS-SP: the failure modes of the component table injected one by one, each on the bench that has its parts.

**Stretch** (0.1 s a step): accelerated from 500 m to a speed that is then kept, no brake by the driver; the home signal
at stop, or a diverging route over the turnout at 90 km/h, or a signal that is clear, or clears before the brake is due.
Dangerous: beyond the signal at stop, or faster than 45 km/h on the turnout.  Safe side: a brake where none is due.
**Mapped** is the same with the set that takes each expected balise that was not seen for its most restrictive reading.
**Dual** (a bus cycle), **code** (1 m), **crossing** (a time stamp) are single parts: processors near a signal, a group
{5, 12, 30}, a train that passes a crossing at line speed and one that stops before it.

Each row is injected at several onsets and sizes (`Mode.injected`); a row is wrong-side if any of these is.  On rides
without a cause to brake only the rows are injected that the table does not call dangerous, with the map only those that
it does.  The result tables share a row's rate evenly among its injections; `ats_rates` counts it whole.

Results: of the 37 rows that are injected here 19 are wrong-side, all that the table calls dangerous but one: a
comparator that always says equal has no effect by itself.  A count that runs behind is not always learnt of from the
balises: pulses lost, all or some, late; a wheel 20 mm too large; creep late; a wheel that slides while the train gains
speed, so that it is faster than the odometer believes possible in a slide.  Nor is a coil that is silent from just
before the signal balise on.  With the map the silent coil and the missing balises are found in time.

Failure rates are INVENTED [A]: the table has none.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from models.ats.crossing import Crossing, start_point
from models.ats.failures import ASSUMED_RATES, CODE, CROSSING, DUAL, FIT, LATE, STRETCH, table
from models.ats.stretch import AT_REST, LINE, Mapped, Stretch
from models.dual_processor import OnBoard
from models.kinematics import ACCELERATION, mps
from models.position.decoder import Decoder
from safety import Bit
from safety.inject import Campaign, Group, Wires

Ride = Callable[[int], dict[str, Any]]


def groups(bench: str, directions: str = "DSN") -> list[Group]:
    """The rows of the table, of these directions, that a bench has the parts for, with their rates."""
    return [
        Group(mode.name, mode.injected, mode.component, mode.mode, mode.fit * FIT, ASSUMED_RATES)
        for mode in table() if mode.bench == bench and mode.direction in directions
    ]  # fmt: skip


# --- the stretch ------------------------------------------------------------------------------------------------------


def pulled_to(speed: int, clears: int | None = None, diverging: bool = False, current: bool = True) -> Ride:
    """Pulled to a speed in m/s; `clears` is the step at which the signal leaves stop, 0 if it never was."""
    pulling = int(speed / (ACCELERATION / 10))

    def row(step: int) -> dict[str, Any]:
        stop = clears is None or step < clears
        return {"at.stop": stop, "at.diverging": diverging, "at.current": current,
                "drive": ACCELERATION if step < pulling else Fraction(0)}  # fmt: skip

    return row


AT_STOP, TURNS, IS_CLEAR = pulled_to(25), pulled_to(25, 0, diverging=True), pulled_to(25, 0, current=False)
CLEARS = pulled_to(15, 380, current=False)  # at 908 m, behind the signal balise; the pattern would brake at 1390 m
BY_PHASE = pulled_to(15, 655)  # at 1320 m, behind the release balise


def braked(wires: Wires) -> Bit:
    """A brake is ordered or applied after the start."""
    return wires["ordered"] | wires["braking"]


def injected(
    name: str, ride: Ride, model: type[Stretch], measured: int, expect: dict[str, int], of: str = "DSN", **more: Any
) -> Campaign:
    """The modes of the stretch, of these directions, on one ride."""
    return Campaign(
        id=f"ats_{name}", model=model, settings=LINE, start=AT_REST, stimulus=ride, run_in=2, measured=measured,
        faults=groups(STRETCH, of), hazard="passed", expect=expect, **more,
    )  # fmt: skip


at_stop = injected("at_stop", AT_STOP, Stretch, 780, {"dangerous_undetected": 21, "no_effect": 25})
turns = injected("turns", TURNS, Stretch, 680, {"dangerous_undetected": 12, "no_effect": 34})
clear = injected("clear", IS_CLEAR, Stretch, 480, {"safe": 8, "no_effect": 9}, "SN", safe=braked)
clears = injected("clears", CLEARS, Stretch, 720, {"safe": 10, "no_effect": 7}, "SN", safe=braked)
by_phase = injected("by_phase", BY_PHASE, Stretch, 730, {"safe": 10, "no_effect": 7}, "SN", safe=braked)
mapped_at_stop = injected("mapped_at_stop", AT_STOP, Mapped, 780, {"dangerous_undetected": 19, "no_effect": 10}, "D")
mapped_turns = injected("mapped_turns", TURNS, Mapped, 680, {"dangerous_undetected": 11, "no_effect": 18}, "D")
ON_THE_STRETCH = (at_stop, turns, clear, clears, by_phase)
MAPPED_ON_THE_STRETCH = (mapped_at_stop, mapped_turns)

# --- single parts -----------------------------------------------------------------------------------------------------


def near_the_signal(step: int) -> dict[str, Any]:
    """From step 8 on the signal is at stop: at first far enough for the speed, from step 24 on too near."""
    return {"reading.balise": step % 4 == 0, "reading.stop": step >= 8, "reading.distance": 20 if step < 24 else 9,
            "reading.run": 0, "reading.speed": 4}  # fmt: skip


def wrong(wires: Wires) -> Bit:
    """The relay is energised where the truth forbids it."""
    return ~wires["brake"] & ~wires["safe"]


def needless(wires: Wires) -> Bit:
    """The relay has dropped where the truth permits."""
    return wires["brake"] & wires["safe"]


dual = Campaign(
    id="ats_dual", model=OnBoard, stimulus=near_the_signal, run_in=6, measured=40, faults=groups(DUAL),
    hazard=wrong, safe=needless, expect={"safe": 20, "dangerous_undetected": 1, "no_effect": 4},
)  # fmt: skip

CODED = {0, 5, 12, 30, 40}  # slots of the balises of a group


def group_of_five(step: int) -> dict[str, Any]:
    """One slot a step."""
    return {"run": Fraction(1), "balise": step - LATE in CODED, "reverses": False, "slips": False}


def misread(wires: Wires) -> Bit:
    """A code is accepted that does not stand there."""
    return wires["accepted"] & ((wires["p"] != 5) | (wires["q"] != 12) | (wires["r"] != 30))


code = Campaign(
    id="ats_code", model=Decoder, stimulus=group_of_five, measured=90, faults=groups(CODE),
    hazard=misread, safe="rejected", engine="lanes", expect={"safe": 11, "dangerous_undetected": 1},
)  # fmt: skip


def express(step: int) -> dict[str, Any]:
    """A train that passes at line speed, 10 s a step: it stops nowhere and says nothing."""
    speed = mps(100)
    return {"elapsed": Fraction(10), "way": 10 * speed, "reached": speed, "says.stops": False, "says.lost": False,
            "says.announces": False, "says.departs": False}  # fmt: skip


def stopping(step: int) -> dict[str, Any]:
    """A train that stops before the mark, which the timetable says; it stands there."""
    runs = step < 12
    return express(step) | {"says.stops": True, "way": Fraction(100 * runs), "reached": mps(36) * runs}


BEFORE = -2 * start_point()  # m
passing = Campaign(
    id="ats_crossing_express", model=Crossing, start={"head": BEFORE, "speed": mps(100)}, stimulus=express,
    measured=8, faults=groups(CROSSING), hazard="too_short", expect={"dangerous_undetected": 1, "no_effect": 1},
)  # fmt: skip
standing = Campaign(
    id="ats_crossing_stopping", model=Crossing, start={"head": -start_point() - 500, "speed": mps(36)},
    stimulus=stopping, measured=14, faults=groups(CROSSING), hazard="too_short", safe="warning",
    expect={"safe": 1, "no_effect": 1},
)  # fmt: skip
ON_PARTS = (dual, code, passing, standing)

"""ATS-S and ATS-SP: speed-distance diagrams of runs of the models, with the runs that pass the signal.

Source: 5 s alarm, release balises, one-stage pattern [P]; brakes, distances, 100 km/h [A].

Main results: with ATS-S a passive driver stops at the signal, one who brakes at 4.9 s and lets go passes it at full
speed; with ATS-SP the pattern stops the train, and a signal that goes back to stop behind the last release balise does
not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

from models.ats.ats_s import AtsS
from models.ats.phase import PhaseReceiver
from models.ats.supervision import Supervision
from models.kinematics import B_EMERGENCY, CYCLE, T_EMERGENCY, distance, mps
from proofs.patterns_drawn import (
    BRAKES,
    EMERGENCY,
    SAMPLED,
    SERVICE,
    Course,
    Once,
    Row,
    drawn,
    drive,
    lines,
    pattern,
    speed,
    to_go,
)
from safety.exhibits import Mark, Points, Rule, plot
from safety.trace import Live

TOP = mps(100)
ASSUMED = ("[A] t_e 1.5 s, b_e 3.5 km/h/s", "[A] t_s 2 s, b_s 2.5 km/h/s", "[A] 100 km/h")

# --- ATS-S -----------------------------------------------------------------------------------------------------------

ALARM_S = 5
WARNED = Fraction(distance(TOP, B_EMERGENCY, ALARM_S + T_EMERGENCY))  # m before the signal: D_req of a passive driver
CALM = {"elapsed": 0, "stop_read": False, "proceed_read": False, "braking": False, "healthy": True, "standing": False,
        "reset": False}  # fmt: skip


def with_ats_s(handle: Callable[[Fraction], bool]) -> Course:
    """A run past the warning balise, the signal at stop; `handle` says when the driver's brake handle is in use."""
    live, balise = Live(AtsS), Once(WARNED)
    live.step({**CALM, "standing": True, "reset": True})

    def row(time: Fraction, x: Fraction, v: Fraction) -> Row:
        seen = {"elapsed": CYCLE, "stop_read": balise(x), "standing": v == 0}
        return {**CALM, **seen, "braking": balise.passed and handle(x)}

    return drive(live, WARNED, TOP, row, lambda shown: lines(shown, BRAKES, emergency=EMERGENCY))


@plot(id="ats_plots.ats_s", title="ATS-S: no supervision after the alarm", requirement="AS-3", assumed=ASSUMED[::2],
      source="[P] 5 s alarm; runs of the model", x=to_go(650, 200), y=speed(110))  # fmt: skip
def ats_s() -> Iterator[Mark]:
    """A passive driver, and one who operates the brake for 0.1 s at 4.9 s."""
    late = WARNED - TOP * Fraction("4.9")
    released = with_ats_s(lambda x: late - TOP * CYCLE < x <= late)
    yield from drawn({"driver passive": with_ats_s(lambda x: False), "lets go": released})
    yield Points("warning balise", [(WARNED, 0)], ["stop read, alarm"])
    yield Points("brake handle in use", [(late, 0)], ["at 4.9 s, and let go"])
    yield Rule("signal at stop", x=0)


# --- ATS-SP ----------------------------------------------------------------------------------------------------------

SIGNAL, BALISE, RELEASE = 600, 600, 200  # m along the line; m before the signal: first balise, last release balise
SPEED = mps(95)
EASY, AGAIN = Fraction("-0.6"), Fraction("0.5")  # m/s^2: a driver under the pattern, and once it is gone
CLEARS, BACK = 350, 150  # m to go when the signal clears, when it goes back to stop
RUN_UP = 50  # m
Driver = Callable[[dict[str, Any], Fraction], Fraction]  # acceleration in m/s^2 by registers and speed
Told = Callable[[Fraction, Fraction], bool]  # an event, by place and speed
HOME = "home.target.active"  # there is a pattern to the signal
EVENTS = ("stop_read", "clear_read", "release_read", "phase_released", "branch_read", "stray_stop", "station_made",
          "station_ended", "reset")  # fmt: skip


def where(x: Fraction, v: Fraction) -> Row:
    """The position is known: head and speed, as an interval of no width."""
    head = SIGNAL - x
    return {"where.low": head, "where.guess": head, "where.high": head, "where.slowest": v, "where.fastest": v}


def with_ats_sp(drives: Driver, **told: Told) -> Course:
    """A run past the first balise at stop, with further events."""
    live, balise = Live(Supervision), Once(BALISE)
    nothing = {f"events.{name}": False for name in EVENTS}
    live.step({**nothing, "events.reset": True, **where(Fraction(BALISE), Fraction(0))})

    def row(time: Fraction, x: Fraction, v: Fraction) -> Row:
        more = {f"events.{name}": event(x, v) for name, event in told.items()}
        return {**nothing, **where(x, v), "events.stop_read": balise(x), **more}

    def driver(x: Fraction, v: Fraction) -> Fraction:
        return drives(live.state, v)

    order = {"service": SERVICE, "emergency": EMERGENCY}
    far = BALISE + RUN_UP
    return drive(live, far, SPEED, row, lambda shown: lines(shown, SAMPLED, **order), driver)


def coasts(seen: dict[str, Any], v: Fraction) -> Fraction:
    """A driver who does nothing."""
    return Fraction(0)


def obeys(seen: dict[str, Any], v: Fraction) -> Fraction:
    """A driver who brakes ahead of the pattern, and accelerates where there is none any more."""
    return EASY if seen[HOME] else AGAIN if v < SPEED else Fraction(0)


def patterns() -> Iterator[Mark]:
    """Both ceilings, and the signal."""
    yield pattern("service pattern", BRAKES[SERVICE], BALISE)
    yield pattern("emergency pattern", BRAKES[EMERGENCY], BALISE)
    yield Points("first balise", [(BALISE, 0)], ["stop read, pattern made"])
    yield Rule("signal", x=0)


@plot(id="ats_plots.ats_sp", title="ATS-SP: one pattern to the signal", requirement="AV-1", assumed=ASSUMED,
      source="[P] pattern from balise and line data; run of the model", x=to_go(700, 100), y=speed(120))  # fmt: skip
def ats_sp() -> Iterator[Mark]:
    """A driver who does nothing is braked at the pattern, again and again, and stands before the signal."""
    yield from patterns()
    yield from drawn({"driver passive": with_ats_sp(coasts)})


def phase_read(clears: int) -> Told:
    """The receiver, where the phase turns to N with the train so far before the signal."""
    receiver, before = Live(PhaseReceiver), [False]

    def read(x: Fraction, v: Fraction) -> bool:
        n = x <= clears
        turned, before[0] = n != before[0], n
        phase = {"phase.n": n, "phase.r": not n, "phase.changed": turned, "phase.age": 0}
        return bool(receiver.shown({**phase, **where(x, v)})["released"])

    return read


@plot(id="ats_plots.release", title="ATS-SP: what ends the pattern, and what does not make it again",
      requirement="AV-4", assumed=(*ASSUMED, "[A] release balise at 200 m"), x=to_go(700, 200), y=speed(120),
      source="[P] release balises, phase; runs of the models")  # fmt: skip
def release() -> Iterator[Mark]:
    """The signal clears with the train 350 m ahead: by phase and by release balise; it goes back to stop at 150 m."""
    yield from patterns()
    balise = Once(RELEASE)
    by_phase = with_ats_sp(obeys, phase_released=phase_read(CLEARS))
    by_balise = with_ats_sp(obeys, release_read=lambda x, v: balise(x))
    yield from drawn({"released by phase": by_phase, "released by balise": by_balise})
    yield Points("release balise", [(RELEASE, 0)], ["release balise"])
    yield Points("aspect", [(CLEARS, 112), (BACK, 112)], ["signal clears", "back to stop: no pattern"])

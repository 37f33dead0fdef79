"""ATS-SP part by part: minimal cut sets of a wrong release, of a signal passed, of a warning that is too short.

**Receiver**: rows of the track receiver, on a train that is within its interval.  **Branch balise**: it and the coil,
down to the target of the turnout.  **Brake**: line data, I/O unit, relay
and brake under one target that is made in time, as in AV-1.  **Crossing**: timetable and loop, as in AO-2.
Complete at every order over the listed faults, each set replayed.
Main results: cross-talk and an inverted phase release, a dead receiver does not; a turnout has no limit after a missing
balise, a silent or drifting coil; a signal is passed after a wrong entry
or a stale edition, with output or relay stuck energised, with a weak brake; a warning is too short after a wrong
timetable, not with a dead loop.  They are the wrong-side rows of injection.
Rates are INVENTED [A].
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import cache

from models.ats.braked import Braked
from models.ats.crossing import LEAST_WARNING, LINE_SPEED, MARK, NOTICE, STARTING, Crossing, start_point
from models.ats.failures import rates_of, rows_of
from models.ats.phase import PhaseBench
from models.ats.turning import Turning
from models.kinematics import ACCELERATION, B_SERVICE, CYCLE, T_SERVICE, stops_accelerating
from models.position.correction import BRANCH
from proofs import ats_crossing, ats_phase
from proofs.radio_formulas import reacts_in_time
from proofs.ts7_formulas import Formula, named
from safety import Bit, Scenario, Seen, hazard, implies, struck
from safety.tracing import trace

SOURCE = "[P] components; sizes of the faults [A]"

# --- track receiver --------------------------------------------------------------------------------------------------

RECEIVER = rows_of(set(trace(PhaseBench).points), {"ats.receiver.": "receiver."})
FALSE_N = ("track receiver: phase inverted", "track receiver: cross-talk")


def counted(s: Seen) -> Bit:
    """Lemma: unless it reads N where there is none the receiver has counted no more than N has lasted."""
    return struck(s, *FALSE_N) | ats_phase.counted(s)


def says_stop(present: tuple[str, ...]) -> Iterator[Scenario]:
    """Within the section, where the current says stop."""
    inputs = {"phase.r": True, "pos": 100, **{f"where.{name}": 100 for name in ("low", "guess", "high")}}
    values = (CYCLE, ats_phase.STABLE, 10, 0, 600)
    yield Scenario(10, inputs, dict(zip(ats_phase.OPEN, values, strict=True)), present=present, at=1)


@hazard(PhaseBench, faults=RECEIVER, scenarios=says_stop, given=ats_phase.within, lemmas=[counted],
        symbolic=ats_phase.OPEN, rates=rates_of(RECEIVER), hours="1000", requirement="AV-3", source=SOURCE,
        expect={1: 2})  # fmt: skip
def released_without_the_phase(s: Seen) -> Bit:
    """Released, though the current of the own track has not said so for T_stab, or not in the signal's section."""
    return ~ats_phase.only_a_stable_phase_releases(s)


# --- branch balise ---------------------------------------------------------------------------------------------------

BRANCHING = rows_of(set(trace(Turning).points), {"track.": "", "ats.coil.": "coil."})
COIL = "on-board coil, oscillation unit"
UNTOLD = ("branch balise: missing", f"{COIL}: silent", f"{COIL}: drift")


def target_acts(s: Seen) -> Bit:
    """Lemma: once a diverging route was told the target is active, unless one of the singles has struck."""
    return struck(s, *UNTOLD) | implies(s.due, s.target.active)


def turns(present: tuple[str, ...]) -> Iterator[Scenario]:
    """The branch balise is passed, the diverging route is set."""
    yield Scenario(4, {"reached": lambda step: step == 2, "kind": BRANCH, "diverging": True}, present=present)


@hazard(Turning, faults=BRANCHING, scenarios=turns, lemmas=[target_acts], rates=rates_of(BRANCHING), hours="1000",
        requirement="AV-1", source=SOURCE, expect={1: 3})  # fmt: skip
def turnout_without_a_limit(s: Seen) -> Bit:
    """A branch balise was passed, the diverging route set, and no pattern acts."""
    return s.unlimited


# --- brake -----------------------------------------------------------------------------------------------------------

BRAKE = rows_of(
    set(trace(Braked).points), {"ats.sp.home.": "guard.", "vehicle.force": "train.brake_force", "vehicle.": ""}
)
ENERGISED = "I/O unit, brake relay: stuck energised"
WRONG_ENTRY, STALE = "line data ROM/IC card: wrong entry", "line data ROM/IC card: stale edition"
LATE = (WRONG_ENTRY, STALE, ENERGISED, f"{ENERGISED} (2)", "brake: low force, low adhesion")


def read(s: Seen) -> Bit:
    """The premises of AV-1: within the interval, no faster than read, the target made in time."""
    train, where = s.train, s.where
    known = (train.head <= where.high) & (train.speed <= where.fastest)
    return known & implies(s.made & ~s.guard.target.active, stops(s))


def stops(s: Seen) -> Bit:
    """With what is left of its reaction time, traction going on through it, the train stops m before the signal."""
    t = s.train
    return stops_accelerating(t.speed, s.place - s.margin - t.head, B_SERVICE, t.left, ACCELERATION)


def reacts(s: Seen) -> Bit:
    """Lemma: what is left of the reaction time is no more than all of it."""
    return reacts_in_time(s, T_SERVICE)


def fits(s: Seen) -> Bit:
    """Lemma: unless one of them has struck the train can stop before the active target, which is that of the signal."""
    kept = (s.guard.target.place == s.place) & stops(s)
    return struck(s, *LATE) | implies(s.guard.target.active, kept)


ENTRY, FROM, COASTS = 20, 200, 25  # m/s; m; cycles at that speed, then it slows down with half the brake
HALF = B_SERVICE / 2


def slowing(cycle: int) -> Fraction:
    """Speed at the beginning of a cycle, m/s."""
    return ENTRY - HALF * CYCLE * max(cycle - COASTS, 0)


def way(cycle: int) -> Fraction:
    """Way of a cycle, m."""
    return (slowing(cycle) + slowing(cycle + 1)) * CYCLE / 2


@cache
def head(cycle: int) -> Fraction:
    """Where the head is at the beginning of a cycle, m."""
    return head(cycle - 1) + way(cycle - 1) if cycle else Fraction(FROM)


def towards_it(present: tuple[str, ...]) -> Iterator[Scenario]:
    """Position and speed known exactly, the target made at once, nothing reset after the start."""
    inputs = {
        "made": lambda cycle: cycle == 0, "freed": lambda cycle: cycle == 0, "others.kept": True, "where.high": head,
        "where.fastest": slowing, "motion.way": way, "motion.reached": lambda cycle: slowing(cycle + 1),
    }  # fmt: skip
    start = {"train.head": FROM, "train.speed": ENTRY, "train.left": T_SERVICE + CYCLE, "place": 600, "margin": 5}
    yield Scenario(240, inputs, start, present=present)


@hazard(Braked, faults=BRAKE, scenarios=towards_it, start=reacts, given=read, lemmas=[reacts, fits],
        symbolic=("margin", "place"), rates=rates_of(BRAKE), hours="1000", requirement="AV-1", source=SOURCE,
        expect={1: 5})  # fmt: skip
def signal_is_passed(s: Seen) -> Bit:
    """The train is beyond the point m before the signal while its target is active."""
    return s.guard.target.active & (s.train.head > s.place - s.margin)


# --- level crossing --------------------------------------------------------------------------------------------------

LOOP = rows_of(set(trace(Crossing).points))
WRONG = "timetable, loop coil: wrong"


def short(s: Seen) -> Bit:
    """At the last time stamp the head was at the crossing, and the warning had been on for less than T_min."""
    return (s.head >= 0) & (s.warned < s.least)


def in_time(s: Seen) -> Bit:
    """Lemma: the warning is long enough."""
    return ~short(s)


def unless_wrong(lemma: Formula) -> Formula:
    """The lemma of the proof without faults, until the timetable is wrong."""
    return named(f"{lemma.__name__}, unless the timetable is wrong", lambda s: struck(s, WRONG) | lemma(s))


OF_AO_2 = (
    ats_crossing.sound, ats_crossing.held, ats_crossing.started, ats_crossing.covered, ats_crossing.noticed,
    ats_crossing.run,
)  # fmt: skip
LEMMAS = [unless_wrong(lemma) for lemma in (*OF_AO_2, in_time)]


def express(present: tuple[str, ...]) -> Iterator[Scenario]:
    """A train that passes at line speed."""
    start = {"head": -start_point() - 100, "speed": LINE_SPEED, "start": start_point(), "mark": MARK, "notice": NOTICE,
             "least": LEAST_WARNING, "v_max": LINE_SPEED, "a_max": STARTING}  # fmt: skip
    way = [Fraction(0), Fraction(100), start_point(), Fraction(0)]
    run = {"way": way.__getitem__, "elapsed": lambda step: way[step] / LINE_SPEED, "reached": LINE_SPEED}
    yield Scenario(4, run, start, present=present)


@hazard(Crossing, faults=LOOP, scenarios=express, start=ats_crossing.outside, given=ats_crossing.dimensioned,
        lemmas=LEMMAS, symbolic=ats_crossing.OPEN, rates=rates_of(LOOP), hours="1000", requirement="AO-2",
        source=SOURCE, expect={1: 1})  # fmt: skip
def warned_too_late(s: Seen) -> Bit:
    """The head reaches the crossing, and the warning has been on for less than T_min."""
    return short(s)

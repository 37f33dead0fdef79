"""How the components of ATS-SP and of radio control fail: the component table, row by row, as faults of its benches.

    STRETCH   models.ats.stretch          train, axle, balises, coil, position, receiver, supervision, brake
    CODE      models.position.decoder     five reference balises, one step is one slot of 1 m
    DUAL      models.dual_processor       line data, processors, comparator, clock, output unit
    CROSSING  models.ats.crossing         warning time of a level crossing
    RADIO     models.radio                leader, follower, ground, radio

`direction` is that of the table: D dangerous, S restrictive, N neither.  Injection finds another one in nine rows:
`found` has it there, and `why` gives the reason.
Source: components, modes, directions of the table [A]; sizes (1 pulse in 20, 100 m, 300 m, half the force ...) [A].
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from models.kinematics import B_SERVICE
from safety import (
    ANY_TIME,
    INTERMITTENT,
    TRANSIENT,
    Fault,
    byzantine,
    common_cause,
    dead,
    delayed,
    drift,
    flip,
    offset,
    open_circuit,
    power_dip,
    reads,
    stuck,
    swapped,
    welded,
)
from safety.kinds import Kind

STRETCH, CODE, DUAL, CROSSING, RADIO = "stretch", "code", "dual", "crossing", "radio"
GENERATOR = "speed generator"
COIL, RECEIVER, LINE_DATA = "on-board coil, oscillation unit", "track receiver", "line data ROM/IC card"
OUTPUT = "I/O unit, brake relay"
FIT = Fraction(1, 10**9)  # /h
ASSUMED_RATES = "[A] made up for this study: the table has none"

LATE, INNER, SHIFT = 1, 12, 5  # step of the first balise; slots: an inner one of {5, 12, 30}, and how far it is moved
LOST_BY_COUNT = "balises are not where the count expects them, and the position is given up"
COVERED = "detected by the wheel's acceleration: the interval covers it"


class Mode(NamedTuple):
    """A failure mode: the table's row, where it is injected, how."""

    component: str
    mode: str
    direction: str
    fit: int  # failures in 10^9 h
    bench: str
    faults: Sequence[Fault]
    found: str = ""  # the direction that injection finds, where it is another one
    why: str = ""

    @property
    def name(self) -> str:
        """As results show it."""
        return f"{self.component}: {self.mode}"


def at(kind: Kind, *points: str) -> Fault:
    """A fault from the start of the run."""
    return Fault(kind, points)


def rows_of(points: Collection[str], places: Mapping[str, str] | None = None) -> list[Fault]:
    """The rows of which a part by itself has the points: each fault with free onset, by the name of its row.

    `places` says where the part has what the table names, by beginnings: {"ats.receiver.": "receiver."}.  What is
    transient in the table comes and goes here; of a row with several faults the second one is called "... (2)".
    """
    found = []
    for mode in table():
        for n, fault in enumerate(mode.faults, start=1):
            name = f"{mode.name} ({n})" if n > 1 else mode.name
            there = [_moved(point, places or {}) for point in fault.points]
            if all(point in points for point in there):
                found.append(_free(fault, there, name))
    return found


def _moved(point: str, places: Mapping[str, str]) -> str:
    """A point of the table as the part has it."""
    start = next((start for start in places if point.startswith(start)), "")
    return places.get(start, "") + point[len(start) :]


def _free(fault: Fault, points: Sequence[str], name: str) -> Fault:
    """The same fault at these points, from any time on, or on and off where it is transient."""
    onset = INTERMITTENT if fault.onset == TRANSIENT else ANY_TIME
    if fault.kind.members:
        kinds = [kind for _, kind in fault.kind.members]
        return common_cause(name, dict(zip(points, kinds, strict=True)), onset=onset)
    return Fault(fault.kind, points, onset, name=name)


def rates_of(faults: Sequence[Fault]) -> dict[str, tuple[str, str]]:
    """Failures per hour of the rows among these faults, INVENTED [A], as a hazard takes them."""
    names = {fault.name for fault in faults}
    return {mode.name: (str(mode.fit * FIT), ASSUMED_RATES) for mode in table() if mode.name in names}


def table() -> list[Mode]:
    """The rows, in the order of the table."""
    return [*_wayside(), *_train(), *_equipment(), *_radio()]


def _wayside() -> list[Mode]:
    return [
        Mode("signal balise", "missing / detuned", "D", 200, STRETCH, [at(stuck(0), "track.balises.signal_tuned")]),
        Mode("signal balise", "contact welded", "D", 20, STRETCH, [at(welded(), "track.balises.signal_closed")]),
        Mode("signal balise", "contact open", "S", 200, STRETCH, [at(open_circuit(), "track.balises.signal_closed")]),
        Mode("release balise", "false proceed", "D", 20, STRETCH, [at(welded(), "track.balises.release_closed")]),
        Mode("release balise", "missing", "S", 200, STRETCH, [at(stuck(0), "track.balises.release_tuned")]),
        Mode("reference balise", "missing", "S", 200, CODE, [_detection(stuck(0), INNER, 1)]),
        Mode("reference balise", "extra", "S", 20, CODE, [_detection(stuck(1), INNER + SHIFT, 1)]),
        Mode("reference balise", "both", "D", 1, CODE, [_detection(delayed(SHIFT), INNER, SHIFT + 1)]),
        Mode("branch balise", "missing", "D", 200, STRETCH, [at(stuck(0), "track.balises.branch_tuned")]),
    ]


def _detection(kind: Kind, slot: int, steps: int) -> Fault:
    """A fault of the detection of balises for a few slots."""
    return Fault(kind, ["balise"], TRANSIENT, at=LATE + slot, ticks=steps)


def _train() -> list[Mode]:
    slide = Fault(dead(), ["axle.grip"], TRANSIENT, at=450, ticks=30, name="wheel locked for 3 s")
    slip = Fault(offset(3), ["axle.grip"], TRANSIENT, at=400, ticks=30, name="wheel 3 m/s fast for 3 s")
    return [
        Mode(
            COIL,
            "silent",
            "D",
            500,
            STRETCH,
            [at(stuck(0), "ats.coil.seen")],
            "S",
            "after two expected balises that were not seen the position is given up",
        ),
        Mode(COIL, "drift", "D", 100, STRETCH, [_tells_proceed()]),
        Mode(
            COIL, "false shift", "S", 100, STRETCH, [Fault(stuck(1), ["track.unit.shifts"], TRANSIENT, at=250, ticks=2)]
        ),
        Mode(
            GENERATOR,
            "pulse loss",
            "D",
            100,
            STRETCH,
            [at(reads(Fraction(19, 20)), "axle.counted")],
            "S",
            LOST_BY_COUNT,
        ),
        Mode(GENERATOR, "extra pulses", "S", 100, STRETCH, [at(reads(Fraction(21, 20)), "axle.counted")]),
        Mode("wheel", "worn but not set", "S", 1000, STRETCH, [at(reads(Fraction(860, 780)), "axle.wear")]),
        Mode(
            "wheel",
            "larger than set",
            "D",
            100,
            STRETCH,
            [at(reads(Fraction(860, 910)), "axle.wear")],
            "S",
            LOST_BY_COUNT,
        ),
        Mode("wheel-rail", "slide", "D", 10_000, STRETCH, [slide], "N", COVERED),
        Mode("wheel-rail", "slip", "S", 10_000, STRETCH, [slip], "N", COVERED),
        Mode(
            "wheel-rail", "creep", "D", 1000, STRETCH, [at(drift(Fraction(-1, 200)), "axle.grip")], "S", LOST_BY_COUNT
        ),
        Mode(
            RECEIVER,
            "dead",
            "S",
            300,
            STRETCH,
            [at(stuck(0), "ats.receiver.n", "ats.receiver.r")],
            "N",
            "the release balise tells it, too",
        ),
        Mode(RECEIVER, "phase inverted", "D", 10, STRETCH, [at(swapped(), "ats.receiver.n", "ats.receiver.r")]),
        Mode(RECEIVER, "cross-talk", "D", 50, STRETCH, [cross_talk()]),
    ]


def _tells_proceed() -> Fault:
    """The shift drifts from that of stop to that of proceed."""
    return common_cause("drifts to proceed", {"ats.coil.shows_stop": stuck(0), "ats.coil.shows_proceed": stuck(1)})


def cross_talk() -> Fault:
    """N of a neighbouring track instead of what the own one carries."""
    return common_cause("N of another track", {"ats.receiver.n": stuck(1), "ats.receiver.r": stuck(0)})


def _equipment() -> list[Mode]:
    both = [Fault(stuck(1, bit=6), ["dual.a.left", "dual.b.left"], ANY_TIME, at=8)]
    relay = "vehicle.relay"
    return [
        Mode(LINE_DATA, "wrong entry", "D", 10, STRETCH, [at(offset(300), "ats.sp.home.target.target")]),
        Mode(LINE_DATA, "stale edition", "D", 10, STRETCH, [at(offset(100), "ats.sp.home.target.target")]),
        Mode(LINE_DATA, "bit error", "S", 100, DUAL, [at(flip(7), "line.rom.word")]),
        Mode("processor", "single fault", "S", 20_000, DUAL,
             [Fault(byzantine(), [f"dual.{n}.*"], ANY_TIME, at=8, name=f"processor {n} broken") for n in "ab"]),
        Mode("processor", "common fault", "D", 100, DUAL, both),
        Mode("comparator", "stuck equal", "D", 100, DUAL, [at(stuck(1), "dual.comparator.equal")], "N",
             "by itself it changes nothing: with a fault of B it is a pair"),
        Mode("comparator", "stuck unequal", "S", 900, DUAL, [at(stuck(0), "dual.comparator.equal")]),
        Mode("clock, supply", "loss", "S", 1000, DUAL,
             [Fault(stuck(0), [p], ANY_TIME, at=8) for p in ("dual.clock", "dual.output.supply")]),
        Mode("clock, supply", "brown-out", "S", 1000, DUAL, [Fault(power_dip(), ["dual"], TRANSIENT, at=8, ticks=3)]),
        Mode(OUTPUT, "stuck energised", "D", 10, STRETCH, [at(stuck(1), "io_unit"), at(welded(), relay)]),
        Mode(OUTPUT, "open", "S", 1000, STRETCH, [at(stuck(0), "io_unit"), at(open_circuit(), relay)]),
        Mode("brake", "low force, low adhesion", "D", 1000, STRETCH, [at(reads(B_SERVICE / 2), "vehicle.force")]),
        Mode("display", "wrong / dead", "N", 1000, STRETCH, [at(stuck(v), "ats.display") for v in (0, 1)]),
    ]  # fmt: skip


def _radio() -> list[Mode]:
    pair = "pair.follower"
    channels = [f"{pair}.{channel}" for channel in ("reports", "authorities", "echoes")]
    radio, ground = "radio (ground, train)", "ground computer"
    return [
        Mode("timetable, loop coil", "wrong", "D", 100, CROSSING, [at(stuck(1), "stopping")]),
        Mode("timetable, loop coil", "dead", "S", 1000, CROSSING, [at(stuck(0), "heard")]),
        Mode(radio, "loss", "S", 10_000, RADIO, [at(stuck(0), f"{c}.heard") for c in channels]),
        Mode(radio, "delay", "S", 10_000, RADIO, [_delay(c) for c in channels]),
        Mode(radio, "replay", "D", 100, RADIO, [_replay(c) for c in channels], "S",
             "time stamps are compared: an old message is not taken"),
        Mode(radio, "corruption", "S", 10_000, RADIO, [at(stuck(0), f"{c}.intact") for c in channels]),
        Mode(ground, "wrong order of trains", "D", 1, RADIO, [at(stuck(1), f"{pair}.cell.wrong_order")]),
        Mode(ground, "lost train", "D", 1, RADIO, [at(stuck(1), f"{pair}.cell.lost_train")]),
        Mode("train integrity", "parted train reported whole", "D", 10, RADIO, [at(stuck(1), "pair.integrity")]),
    ]  # fmt: skip


def _delay(channel: str) -> Fault:
    """Messages come 4 s late."""
    return at(delayed(40), f"{channel}.heard", f"{channel}.stamp_heard", f"{channel}.place_heard")


def _replay(channel: str) -> Fault:
    """From 20 s on the message that came then is delivered again and again."""
    return Fault(stuck(0), [f"{channel}.one.takes"], ANY_TIME, at=200)

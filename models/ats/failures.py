"""How the components of ATS-SP and of radio control fail: the component table, row by row, as faults of its benches.

    STRETCH   models.ats.stretch          train, axle, balises, coil, position, receiver, supervision, brake
    CODE      models.position.decoder     five reference balises, one step is one slot of 1 m
    DUAL      models.dual_processor       line data, processors, comparator, clock, output unit
    CROSSING  models.ats.crossing         warning time of a level crossing
    RADIO     models.radio                leader, follower, ground, radio

`direction` is that of the table: D dangerous, S restrictive, N neither.  Each row is injected as `faults` have it and
at other onsets and sizes, `others`; it is dangerous if any of these is.  In two rows that finds another direction than
the table has: `why` gives the reason.
Source: components, modes, directions of the table [A]; sizes (1 pulse in 20, 100 m, 300 m, half the force ...) [A].
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
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
PARTED = 160  # step: 1 s after a train has parted on the bench of radio control
LATER = (12, 24)  # bus cycles: other onsets, before and after the signal comes too near
FIT = Fraction(1, 10**9)  # /h
ASSUMED_RATES = "[A] made up for this study: the table has none"

LATE, INNER, SHIFT = 1, 12, 5  # step of the first balise; slots: an inner one of {5, 12, 30}, and how far it is moved


class Mode(NamedTuple):
    """A failure mode: the table's row, where it is injected, how."""

    component: str
    mode: str
    direction: str
    fit: int  # failures in 10^9 h
    bench: str
    faults: Sequence[Fault]
    others: Sequence[Fault] = ()  # the same mode at other onsets and sizes
    why: str = ""  # injection finds another direction than the table's

    @property
    def name(self) -> str:
        """As results show it."""
        return f"{self.component}: {self.mode}"

    @property
    def wrong_side(self) -> bool:
        """Whether it is by itself: as the table has it, but for the rows with a reason why not."""
        return self.direction == "D" and not self.why

    @property
    def injected(self) -> list[Fault]:
        """All its faults, each called by what it is and when."""
        return [*self.faults, *self.others]


def at(kind: Kind, *points: str) -> Fault:
    """A fault from the start of the run."""
    return Fault(kind, points)


def later(fault: Fault, *steps: int) -> list[Fault]:
    """The same fault from each of these steps on, for as long as it lasts."""
    onset = TRANSIENT if fault.ticks else ANY_TIME
    return [replace(fault, onset=onset, at=step, name=f"{fault.name}, from step {step}") for step in steps]


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


def row_of(fault: str) -> str:
    """The name of the row that a fault of `rows_of` belongs to."""
    return re.sub(r" \(\d\)$", "", fault)


def rates_of(faults: Sequence[Fault]) -> dict[str, tuple[str, str]]:
    """Failures per hour of faults of `rows_of`, INVENTED [A], as a hazard takes them: equal shares of a row's rate."""
    rows = {mode.name: mode for mode in table()}
    of = {fault.name: rows[row_of(fault.name)] for fault in faults}
    return {name: (str(mode.fit * FIT / len(mode.faults)), ASSUMED_RATES) for name, mode in of.items()}


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
        Mode("reference balise", "missing", "S", 200, CODE, [_detection(stuck(0), INNER, 1)],
             [_detection(stuck(0), slot, 1) for slot in (0, 5, 30, 40)]),
        Mode("reference balise", "extra", "S", 20, CODE, [_detection(stuck(1), INNER + SHIFT, 1)],
             [_detection(stuck(1), slot, 1) for slot in (2, 8, 20, 35, 43)]),
        Mode("reference balise", "both", "D", 1, CODE, [_detection(delayed(SHIFT), INNER, SHIFT + 1)]),
        Mode("branch balise", "missing", "D", 200, STRETCH, [at(stuck(0), "track.balises.branch_tuned")]),
    ]  # fmt: skip


def _detection(kind: Kind, slot: int, steps: int) -> Fault:
    """A fault of the detection of balises for a few slots."""
    kind_at = f"balise {kind} in slot {slot}"
    return Fault(kind, ["balise"], TRANSIENT, at=LATE + slot, ticks=steps, name=kind_at)


def _train() -> list[Mode]:
    silent, dead_receiver = at(stuck(0), "ats.coil.seen"), at(stuck(0), "ats.receiver.n", "ats.receiver.r")
    shift = _grips(stuck(1), "false shift", 250, 2, "track.unit.shifts")
    lost, extra = _counts(19, 20), _counts(21, 20)
    creep = at(drift(Fraction(-1, 200)), "axle.grip")
    slide = _grips(dead(), "wheel locked", 450, 30)
    slides = [_grips(dead(), "wheel locked", 300, 300), _grips(offset(-1), "wheel 1 m/s slow", 300, 300)]
    slip, slips = _grips(offset(3), "wheel 3 m/s fast", 400, 30), [_grips(offset(3), "wheel 3 m/s fast", 300, 300)]
    return [
        Mode(COIL, "silent", "D", 500, STRETCH, [silent], later(silent, 250, 330)),
        Mode(COIL, "drift", "D", 100, STRETCH, [_tells_proceed()]),
        Mode(COIL, "false shift", "S", 100, STRETCH, [shift],
             [_grips(stuck(1), "false shift", k, ticks, "track.unit.shifts") for k, ticks in ((100, 2), (340, 200))]),
        Mode(GENERATOR, "pulse loss", "D", 100, STRETCH, [lost],
             [*later(lost, 300), *later(_counts(1, 2), 300), *later(at(dead(), "axle.counted"), 2, 200)]),
        Mode(GENERATOR, "extra pulses", "S", 100, STRETCH, [extra], [_counts(51, 50), *later(_counts(3, 2), 300)]),
        Mode("wheel", "worn but not set", "S", 1000, STRETCH, [_wheel(780)], [_wheel(845)]),
        Mode("wheel", "larger than set", "D", 100, STRETCH, [_wheel(910)], [_wheel(880), *later(_wheel(910), 300)]),
        Mode("wheel-rail", "slide", "D", 10_000, STRETCH, [slide], slides),
        Mode("wheel-rail", "slip", "S", 10_000, STRETCH, [slip], slips),
        Mode("wheel-rail", "creep", "D", 1000, STRETCH, [creep],
             [*later(creep, 350), *later(at(reads(Fraction(24, 25)), "axle.grip"), 300)]),
        Mode(RECEIVER, "dead", "S", 300, STRETCH, [dead_receiver]),
        Mode(RECEIVER, "phase inverted", "D", 10, STRETCH, [at(swapped(), "ats.receiver.n", "ats.receiver.r")]),
        Mode(RECEIVER, "cross-talk", "D", 50, STRETCH, [cross_talk()]),
    ]  # fmt: skip


def _grips(kind: Kind, what: str, step: int, ticks: int, where: str = "axle.grip") -> Fault:
    """A fault for some steps, named."""
    return Fault(kind, [where], TRANSIENT, at=step, ticks=ticks, name=f"{what} from step {step} for {ticks / 10:g} s")


def _counts(pulses: int, of: int) -> Fault:
    """So many pulses where there should be so many."""
    return at(reads(Fraction(pulses, of)), "axle.counted")


def _wheel(diameter: int) -> Fault:
    """A wheel of so many mm, 860 being set."""
    return at(reads(Fraction(860, diameter)), "axle.wear")


def _tells_proceed() -> Fault:
    """The shift drifts from that of stop to that of proceed."""
    return common_cause("drifts to proceed", {"ats.coil.shows_stop": stuck(0), "ats.coil.shows_proceed": stuck(1)})


def cross_talk() -> Fault:
    """N of a neighbouring track instead of what the own one carries."""
    return common_cause("N of another track", {"ats.receiver.n": stuck(1), "ats.receiver.r": stuck(0)})


def _equipment() -> list[Mode]:
    both = [Fault(stuck(1, bit=6), ["dual.a.left", "dual.b.left"], ANY_TIME, at=8)]
    broken = [Fault(byzantine(), [f"dual.{n}.*"], ANY_TIME, at=8, name=f"processor {n} broken") for n in "ab"]
    losses = [Fault(stuck(0), [p], ANY_TIME, at=8) for p in ("dual.clock", "dual.output.supply")]
    equal, unequal = (at(stuck(v), "dual.comparator.equal") for v in (1, 0))
    flipped, dip = at(flip(7), "line.rom.word"), Fault(power_dip(), ["dual"], TRANSIENT, at=8, ticks=3)
    relay = "vehicle.relay"
    return [
        Mode(LINE_DATA, "wrong entry", "D", 10, STRETCH, [at(offset(300), "ats.sp.home.target.target")]),
        Mode(LINE_DATA, "stale edition", "D", 10, STRETCH, [at(offset(100), "ats.sp.home.target.target")]),
        Mode(LINE_DATA, "bit error", "S", 100, DUAL, [flipped], later(flipped, *LATER)),
        Mode("processor", "single fault", "S", 20_000, DUAL, broken, [o for f in broken for o in later(f, *LATER)]),
        Mode("processor", "common fault", "D", 100, DUAL, both),
        Mode("comparator", "stuck equal", "D", 100, DUAL, [equal], later(equal, *LATER),
             "without effect while the processors agree; dangerous with a fault of one of them, as a pair"),
        Mode("comparator", "stuck unequal", "S", 900, DUAL, [unequal], later(unequal, *LATER)),
        Mode("clock, supply", "loss", "S", 1000, DUAL, losses, [o for f in losses for o in later(f, *LATER)]),
        Mode("clock, supply", "brown-out", "S", 1000, DUAL, [dip], later(dip, *LATER)),
        Mode(OUTPUT, "stuck energised", "D", 10, STRETCH, [at(stuck(1), "io_unit"), at(welded(), relay)]),
        Mode(OUTPUT, "open", "S", 1000, STRETCH, [at(stuck(0), "io_unit"), at(open_circuit(), relay)]),
        Mode("brake", "low force, low adhesion", "D", 1000, STRETCH, [at(reads(B_SERVICE / 2), "vehicle.force")]),
        Mode("display", "wrong / dead", "N", 1000, STRETCH, [at(stuck(v), "ats.display") for v in (0, 1)]),
    ]  # fmt: skip


def _radio() -> list[Mode]:
    pair = "pair.follower"
    channels = [f"{pair}.{channel}" for channel in ("reports", "authorities", "echoes")]
    losses, replays = [at(stuck(0), f"{c}.heard") for c in channels], [_replay(c) for c in channels]
    radio, ground = "radio (ground, train)", "ground computer"
    return [
        Mode("timetable, loop coil", "wrong", "D", 100, CROSSING, [at(stuck(1), "stopping")]),
        Mode("timetable, loop coil", "dead", "S", 1000, CROSSING, [at(stuck(0), "heard")]),
        Mode(radio, "loss", "S", 10_000, RADIO, losses, [o for f in losses[:2] for o in later(f, PARTED)]),
        Mode(radio, "delay", "S", 10_000, RADIO, [_delay(c) for c in channels], [_delay(channels[1], 100)]),
        Mode(radio, "replay", "D", 100, RADIO, replays,
             [o for f in replays[:2] for o in later(f, 2, PARTED)],
             "the table means messages without stamps; these have them, and an old one is not taken"),
        Mode(radio, "corruption", "S", 10_000, RADIO, [at(stuck(0), f"{c}.intact") for c in channels]),
        Mode(ground, "wrong order of trains", "D", 1, RADIO, [at(stuck(1), f"{pair}.cell.wrong_order")]),
        Mode(ground, "lost train", "D", 1, RADIO, [at(stuck(1), f"{pair}.cell.lost_train")]),
        Mode("train integrity", "parted train reported whole", "D", 10, RADIO, [at(stuck(1), "pair.integrity")]),
    ]  # fmt: skip


def _delay(channel: str, steps: int = 40) -> Fault:
    """Messages come 4 s late."""
    return at(delayed(steps), f"{channel}.heard", f"{channel}.stamp_heard", f"{channel}.place_heard")


def _replay(channel: str) -> Fault:
    """From 20 s on the message that came then is delivered again and again."""
    return Fault(stuck(0), [f"{channel}.one.takes"], ANY_TIME, at=200)

"""Two-counter ATC: the tests of section 6 and the worst ride, carried out on the models by running them.

Frequencies Hz, speeds km/h, times s, accelerations km/h/s.  Each experiment puts signal 3 against the oscillator pulse
at the phase that decides: right after a pulse counter 1 counts least in a window, right before one most.
Source: static test with an oscillator of 8 times the frequency, dynamic test with memory Me (figure 8) [P]; rest [D].
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import islice
from typing import Any, NamedTuple

from models.two_counter.circuit import READ_OUT, START
from models.two_counter.equipment import Equipment
from models.two_counter.measuring import DynamicTest, StaticTest
from models.two_counter.motion import (
    SPACING,
    Rise,
    inputs,
    instant,
    just_released,
    rise_per_step,
    train_phase,
)
from models.two_counter.numbers import CHECK_SPEEDS, COUNTING_S, N1F, PRESETS
from models.two_counter.train import KMH, TURN
from safety import run
from safety.model import Model
from safety.trace import Trace

STEP_S = COUNTING_S / N1F
DIVIDED = 8  # test oscillator by speed signal
EARLY = Fraction(1, 1_000_000)  # of a period before a pulse
THREE_COUNTS = 7_200  # steps from power-up to their read-outs, any check speed


class Outcome(NamedTuple):
    """What a ride came to: excess over f2E / k at the edge with which the brake comes, and t4 - t1 by memory Me."""

    excess: Fraction
    time: Fraction


def edges_of(speed: int) -> int:
    """m of a check speed."""
    return PRESETS[CHECK_SPEEDS.index(speed)]


def selected(speed: int) -> dict[str, bool]:
    """The lines with one check speed."""
    return {f"lines.s{each}": each == speed for each in CHECK_SPEEDS}


def threshold(speed: int) -> int:
    """f2E in the models' units, thousandths of a pulse per counting time."""
    return TURN * edges_of(speed)


# --- static test, table 2(A) -----------------------------------------------------------------------------------------


def brakes_at(frequency: int, speed: int, error: int, first: bool) -> bool:
    """Whether the brake comes at the first sample of a test oscillator's frequency, thousandths of a pulse per Tc.

    `error` is that of the standard oscillator in ppm; `first` puts signal 3 right after a pulse of it, where the brake
    comes first, else right before one, where it comes last.
    """
    settings = {"error": error}
    spacing = 2 * SPACING * (1_000_000 + error) // 1_000_000
    for skipped in range(DIVIDED // 2):
        turned = (START * DIVIDED // 2 - skipped) * spacing % frequency
        phase = turned - 1 if first else turned
        if 0 <= phase < spacing:
            start = {"test_oscillator.phase": phase, "divider.n": skipped}
            fixed, steps = {"frequency": frequency, **selected(speed)}, _to_read_out(speed)
            seen = run(StaticTest, fixed, steps, start=start, settings=settings, keep=["signal1", "brake"])
            return bool(seen["brake"][read_outs(seen["signal1"])[1]])
    raise ValueError(f"no start puts signal 3 at a pulse for frequency={frequency}; choose one beside it")


def _to_read_out(speed: int) -> int:
    """Steps from power-up to the read-out of the first count, with some to spare."""
    return N1F + N1F * (START + READ_OUT + 2) // edges_of(speed) + 20


def static_test(speed: int, error: int = 0, first: bool = True) -> Fraction:
    """The oscillator frequency at which the brake appears, in Hz; see `brakes_at`."""
    nominal = DIVIDED * threshold(speed)
    low, high = nominal - nominal // 1000, nominal + nominal // 1000
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if brakes_at(middle, speed, error, first) else (middle, high)
    return high / (1000 * COUNTING_S)


# --- dynamic test, table 2(B); the worst ride ------------------------------------------------------------------------


def dynamic_test(speed: int, acceleration: Fraction | int = 1) -> Outcome:
    """Table 2(B): a count is just missed, its mean frequency being f2E, then on up to the brake."""
    return _ride(speed, acceleration, Fraction(N1F), Fraction(0))


def worst_ride(speed: int, acceleration: Fraction | int = 1, early: Fraction = EARLY, error: int = 0) -> Outcome:
    """A count as short as one that is still safe can be: from right before a pulse to n1F - 1 periods later.

    `error` is that of the standard oscillator in ppm.
    """
    return _ride(speed, acceleration, N1F - 1 + early, 1 - early, error)


def _ride(speed: int, acceleration: Fraction | int, window: Fraction, phase: Fraction, error: int = 0) -> Outcome:
    period = 1 / (1 + Fraction(error, 1_000_000))  # in nominal ones; edges are further apart by as much
    rise, spacing = rise_per_step(acceleration) * period, int(SPACING / period)
    edges = START + edges_of(speed) + START
    motion = Rise(just_released(edges_of(speed), rise, window, spacing), rise, phase, edges, spacing)
    seen = _seen(DynamicTest, motion, speed, THREE_COUNTS, error)
    _, _, safe, late = read_outs(seen["signal1"])[:4]
    if seen["brake"][safe] or not seen["brake"][late]:
        raise ValueError(f"{speed} km/h at {acceleration} km/h/s: that count is not the last safe one")
    return Outcome(_excess(motion, speed, 3, late), seen["time"][late] * STEP_S * period)


def excess_from(speed: int, below: Fraction, phase: Fraction, acceleration: Fraction | int = 1) -> Fraction:
    """Excess at the brake of a ride whose first count starts so many km/h `below` f2E / k, to brake by the third."""
    rise = rise_per_step(acceleration)
    motion = Rise(threshold(speed) - below * KMH, rise, phase)
    seen = _seen(Equipment, motion, speed, THREE_COUNTS)
    number, late = next((n, at) for n, at in enumerate(read_outs(seen["signal1"])) if n and seen["brake"][at])
    return _excess(motion, speed, number, late)


def _excess(motion: Rise, speed: int, number: int, step: int) -> Fraction:
    """Above the check speed at the read-out of a number, 0 being that of power-up, which the model has in a step."""
    at = instant(motion, READ_OUT + number * (edges_of(speed) + START)).low
    if int(at) != step:
        raise ValueError(f"the read-out {number} comes in step {int(at)} of the motion, in {step} of the model")
    return (motion.speed_at(at) - threshold(speed)) / KMH


def _seen(model: type[Model], motion: Rise, speed: int, steps: int, error: int = 0) -> Trace:
    """A run of the motion; in the dynamic test the key R is held until the count that is meant."""
    rows: Iterator[dict[str, Any]] = ({"speed": way, **selected(speed)} for way in islice(inputs(motion), steps))
    if model is DynamicTest:
        rows = (row | {"reset": step < int(motion.start)} for step, row in enumerate(rows))
    keep = ["signal1", "brake", *(["time"] if model is DynamicTest else [])]
    return run(model, rows, start={"train.phase": train_phase(motion)}, settings={"error": error}, keep=keep)


def read_outs(signal1: list[Any]) -> list[int]:
    """The steps of signal 1."""
    return [step for step, there in enumerate(signal1) if there]

"""Two-counter ATC: the printed numbers and the constants behind them, exact.

Independent of the models on purpose: no step of a model computes with this file.  The experiments that run the models,
tests, claims and tables take from it what the models are held against.
Speeds km/h, frequencies Hz, times s, accelerations km/h/s.  What is printed stands as printed, misprints included.
Source: tables 2(A), 2(B), 1, sections 6.1 and 6.2 [P]; presets, counting time, four pulses of preparation [D]; n1F
within its bracket [A].
"""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import NamedTuple

CHECK_SPEEDS = (250, 210, 160, 110, 70, 30, 5)
PRESETS = (1035, 875, 677, 477, 317, 157, 57)  # m, edges: two a pulse
COUNTING_S = Fraction("0.311739")  # Tc
PREPARATION_PULSES = 4
READ_OUT_PULSES = 1  # from the end of a count to signal 1
N1F = 2000  # [A]
N1F_RANGE = (1885, 2355)  # what the brake test of 6.1 leaves
ACCELERATION = 1
ALLOWED_SHARE = Fraction(25, 10_000)  # of the maximum check speed
HZ_PER_KMH = 2 / COUNTING_S  # k: a preset grows by two pulses a km/h


class StaticRow(NamedTuple):
    """A row of table 2(A): the oscillator 8 times as fast as the speed signal, and the latter twice; c/s."""

    speed: int
    oscillator: str
    signal: str
    theory: str
    error: str


class DynamicRow(NamedTuple):
    """A row of table 2(B): t4 - t1 in s, the dynamic error as measured and by theory in km/h."""

    speed: int
    time: str
    measured: str
    theory: str


STATIC = (
    StaticRow(250, "132791", "1659.87", "1660.04", "-0.15"),
    StaticRow(210, "112262", "1403.28", "1403.42", "-0.14"),
    StaticRow(160, "86859", "1085.74", "1085.84", "-0.10"),
    StaticRow(110, "61200", "765.00", "765.06", "-0.06"),
    StaticRow(70, "40670", "508.38", "508.44", "-0.06"),
    StaticRow(30, "20143", "251.79", "251.81", "-0.02"),
    StaticRow(5, "7313", "91.41", "91.42", "-0.01"),
)
OSCILLATOR_SCALE = Fraction(1, 10)  # the lost decimal point of the oscillator column
DYNAMIC = (
    DynamicRow(250, "0.62610", "0.47032", "0.46975"),
    DynamicRow(210, "0.62657", "0.47079", "0.47017"),
    DynamicRow(160, "0.62752", "0.47174", "0.47102"),
    DynamicRow(110, "0.62907", "0.47329", "0.47256"),
    DynamicRow(70, "0.63191", "0.47613", "0.47521"),
    DynamicRow(30, "0.64050", "0.48472", "0.48332"),
    DynamicRow(5, "0.67000", "0.56422", "0.51109"),
)
COUNTING_S_OF_TABLE_2B = Fraction("0.31156")  # T''c, one value for all rows
STATIC_SHARE, DYNAMIC_SHARE, TOTAL_SHARE = "0.009", "0.226", "0.235"  # %, relative to 250 km/h
BRAKE_TEST_HZ = {"brake": 120, "release": 150}  # oscillator, speed signal at 5 c/s, check speed 30
BRAKE_TEST_SIGNAL_HZ, BRAKE_TEST_SPEED = 5, 30


class Compared(NamedTuple):
    """What table 1 says of one method."""

    method: str
    accuracy: str
    response: str
    safety: str
    structure: str


TABLE_1 = (
    Compared("reversible counter", "0.2", "0.4", "fail-safe difficult", "complex"),
    Compared("two counters", "0.1", "0.3", "relatively possible", "relatively simple"),
)


def pulses(speed: int) -> Fraction:
    """n2E: pulses counted at a check speed."""
    return Fraction(PRESETS[CHECK_SPEEDS.index(speed)], 2)


def threshold_hz(speed: int) -> Fraction:
    """f2E: the speed signal at which the count takes exactly Tc."""
    return pulses(speed) / COUNTING_S


def scale_speed(speed: int) -> Fraction:
    """f2E / k: the check speed on a scale that passes through the origin."""
    return pulses(speed) / 2


def half_unit(printed: str) -> Fraction:
    """Half a unit of the last digit that is printed."""
    exponent = Decimal(printed).as_tuple().exponent
    assert isinstance(exponent, int), f"{printed} is no number"
    return Fraction(10) ** exponent / 2


def rounds_to(value: Fraction, printed: str) -> bool:
    """Whether a value is printed like this; either way at a tie."""
    return abs(value - Fraction(printed)) <= half_unit(printed)

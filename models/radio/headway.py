"""Radio control: headway of moving and fixed block, and what age messages may have, as exact numbers.

    moving block    H(v) = t_sys + v / 2b + (L + m) / v,   least at v* = sqrt(2 b (L + m)): t_sys + sqrt(2 (L + m) / b)
    fixed block     H(v) = t_sys + (n B + L) / v            n blocks of B kept clear

m/s, m, s; roots are enclosed.  The leader counts as a standing obstacle at its reported rear.
Source: section 9, headway and staleness [D]; L, m, t_sys, B, T_r, T_c, T_loss [A].

Main results: with L = 200 m, m = 50 m, t_sys = 5 s and 2.5 km/h/s the least is 31.83 s at 67.08 km/h, and 34.00 s at
100 km/h; two fixed blocks of 600 m give 55.4 s there.
"""

from __future__ import annotations

from fractions import Fraction

from models.kinematics import (
    B_SERVICE,
    CYCLE,
    T_SERVICE,
    Interval,
    at_least,
    distance,
    not_negative,
    positive,
    refuse,
    root,
)

SYSTEM_S = Fraction(5)  # T_r + T_c + reaction + free run [A]
LENGTH_M = Fraction(200)  # [A]
MARGIN_M = Fraction(50)  # [A]
BLOCK_M = Fraction(600)  # [A]
CLEAR = 2  # blocks kept clear, three aspects [A]
PERIOD_S, LATENCY_S = Fraction(1), Fraction(1, 2)  # T_r, T_c [A]
T_LOSS_S = Fraction(3)  # [A]


def moving_block(
    v: Fraction, b: Fraction, length: Fraction = LENGTH_M, margin: Fraction = MARGIN_M, system: Fraction = SYSTEM_S
) -> Fraction:
    """Time between two trains at speed v past a point, s; ModelError unless v, b > 0 and the rest is not below 0."""
    _refuse_bad(b, length, margin, system)
    positive("speed", v, "m/s")
    return system + Fraction(v) / (2 * Fraction(b)) + (length + margin) / Fraction(v)


def best_speed(b: Fraction, length: Fraction = LENGTH_M, margin: Fraction = MARGIN_M) -> Interval:
    """v*, m/s."""
    _refuse_bad(b, length, margin, Fraction(0))
    return root(2 * b * (length + margin))


def least_headway(
    b: Fraction, length: Fraction = LENGTH_M, margin: Fraction = MARGIN_M, system: Fraction = SYSTEM_S
) -> Interval:
    """H*, s."""
    _refuse_bad(b, length, margin, system)
    return root(2 * (length + margin) / Fraction(b)).shifted(system)


def fixed_block(
    v: Fraction, length: Fraction = LENGTH_M, block: Fraction = BLOCK_M, clear: int = CLEAR,
    system: Fraction = SYSTEM_S,
) -> Fraction:  # fmt: skip
    """Time between two trains at speed v with `clear` blocks kept clear between them, s."""
    positive("speed", v, "m/s")
    not_negative("block", block, "m")
    return system + (clear * block + length) / Fraction(v)


def staleness(v: Fraction, period: Fraction = PERIOD_S, latency: Fraction = LATENCY_S) -> Fraction:
    """How far a leader at speed v may have come since its report, m."""
    not_negative("speed", v, "m/s")
    return (period + latency) * v


def run_after_loss(
    v: Fraction, t_loss: Fraction = T_LOSS_S, b: Fraction = B_SERVICE, free_run: Fraction = T_SERVICE
) -> Fraction:
    """How far a train at speed v runs on from the stamp of the last message until it stands, m (R3)."""
    not_negative("T_loss", t_loss, "s")
    return v * t_loss + Fraction(distance(v, b, free_run))


def t_loss(seconds: Fraction, period: Fraction = PERIOD_S, latency: Fraction = LATENCY_S) -> Fraction:
    """A T_loss that regular traffic never exceeds; ModelError below a period, the latency and a cycle."""
    least = period + latency + CYCLE
    if seconds < least:
        refuse("T_loss", seconds, "s", "regular traffic would raise radio_lost", f"{at_least(least)} s")
    return seconds


def _refuse_bad(b: Fraction, length: Fraction, margin: Fraction, system: Fraction) -> None:
    positive("deceleration", b, "m/s^2")
    positive("length", length, "m")
    not_negative("margin", margin, "m")
    not_negative("t_sys", system, "s")

"""Two-counter ATC speed check (1967): pulses of the speed generator gate a standard oscillator into a counter.

Time: one step is one period of the standard oscillator, Tc/n1F, whose pulse falls at its end; nothing is quantised,
because between two oscillator pulses only the order of events matters.  Speeds are frequencies of the generator in
thousandths of a pulse per counting time Tc.  2000 are 1 km/h on the frequency scale V = f/k; f2E of a preset of m edges
is 500*m, for 250 km/h 517500, that is 258.75 on this scale: the paper does not say where the difference comes from.
"""

from __future__ import annotations

from fractions import Fraction

COUNTING_S = Fraction("0.311739")  # Tc [D]
TUNED = 2000  # n1F [A]


def step_s(n1f: int = TUNED, error: int = 0) -> Fraction:
    """Seconds of a step: the period of an oscillator tuned to n1F, `error` ppm off; nominally 155.8695 us."""
    return COUNTING_S / n1f * Fraction(1_000_000, 1_000_000 + error)

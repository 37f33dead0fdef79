"""Units and the default train: what the speed patterns, ATS-SP and radio control share.

SI inside (m, m/s, m/s^2, s), km/h and km/h/s only at the edges; all exact.
Source: 1 km/h = 5/18 m/s exactly; g, brakes and free-run times [A], as the papers give the principle only.
"""

from fractions import Fraction

KMH = Fraction(5, 18)  # m/s in 1 km/h; m/s^2 in 1 km/h/s
G = Fraction("9.80665")  # m/s^2 [A]
ASSUMED = "[A] the papers print no value"

B_SERVICE = Fraction("2.5") * KMH  # m/s^2, level [A]
B_EMERGENCY = Fraction("3.5") * KMH  # m/s^2, level [A]
T_SERVICE = Fraction(2)  # s, free run [A]
T_EMERGENCY = Fraction("1.5")  # s, free run [A]
T_WARNING = Fraction(5)  # s, warning before the brake [A]
ACCELERATION = Fraction("0.8")  # m/s^2, most while a brake is still to act [A]
MARGIN = Fraction(10)  # m, before the protected point [A]
CYCLE = Fraction("0.1")  # s, of a processor on board [A]
HYSTERESIS = 2 * KMH  # m/s, below the ceiling before a brake is released [A]


def mps(kmh: Fraction | int | str) -> Fraction:
    """A speed in m/s, from km/h."""
    return Fraction(kmh) * KMH


def kmh(mps: Fraction | int) -> Fraction:
    """A speed in km/h, from m/s."""
    return Fraction(mps) / KMH

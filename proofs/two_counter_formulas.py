"""Two-counter ATC: the quantities that the proofs reason with, as plain functions, and the runs that they script.

While the gate is open, counter 2 and the phase of the axle together hold the way since signal 3, to the last fraction
of an edge: the *position*.  Counter 1 holds the time.  At or above a speed the position therefore runs ahead of counter
1 at a known rate, whatever the phases were; how counter 1 stands when the gate closes follows.

Units: an edge is EDGE = 500 * n1F units of way; 2000 units a step are 1 km/h on the frequency scale.
Source: the sum of the speed over a window, for all phases and presets [D].
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import ceil
from typing import Any

from models.two_counter.circuit import RESET, START
from models.two_counter.numbers import CHECK_SPEEDS, N1F, PRESETS
from models.two_counter.train import TURN
from safety import (
    Bit,
    Int,
    Scenario,
    Seen,
    UInt,
    age,
    all_of,
    any_of,
    implies,
    last,
    previous,
    select,
    since,
    total,
    written_for,
)

Formula = Callable[[Seen], Bit]

ROWS = dict(zip(CHECK_SPEEDS, PRESETS, strict=True))  # check speed in km/h: preset in edges
EDGE = TURN * N1F  # units of way from edge to edge
LONG = 4095  # oscillator pulses of a window that are told apart
PREPARATION = START  # edges from the end of a count to signal 3

PRESET_OF = {f"m{v}": m for v, m in ROWS.items()}
written_for("two_counter_*", **PRESET_OF)
written_for("two_counter_*", but="two_counter_circuit.*", n1f=N1F, error=0, wheel=910)


def limit_of_release(m: int, edge: int = EDGE) -> Fraction:
    """f2E * n1F / (n1F - 1): the speed at or above which every sample brakes; no whole number."""
    return Fraction(edge * m, N1F - 1)


def least_too_fast(m: int, edge: int = EDGE) -> int:
    """Least speed input that is at or above that."""
    return ceil(limit_of_release(m, edge))


def greatest_permitted(m: int) -> int:
    """The speed input that is f2E: up to which every sample releases."""
    return TURN * m


# --- what the claims speak of ----------------------------------------------------------------------------------------


def preset(s: Seen) -> UInt:
    """The preset of the check speed selected now, edges."""
    return s["selection.preset"]


def last_preset(s: Seen) -> UInt:
    """The preset of the check speed that was selected a step before."""
    return previous(preset(s), PRESETS[-1])


def kept(s: Seen) -> Bit:
    """The selection is what it was a step before."""
    return preset(s) == last_preset(s)


def at_each(now: UInt, formula: Callable[[int], Bit], presets: Sequence[int] = PRESETS) -> Bit:
    """What holds of the one among the presets that stands in a word."""
    return all_of(*(implies(now == m, formula(m)) for m in presets))


def at_least(s: Seen, limit: Callable[[int], int]) -> Bit:
    """The speed is at or above the limit of the check speed selected."""
    return any_of(*((preset(s) == m) & (s.speed >= limit(m)) for m in ROWS.values()))


def at_most(s: Seen, limit: Callable[[int], int]) -> Bit:
    """The speed is at or below the limit of the check speed selected."""
    return any_of(*((preset(s) == m) & (s.speed <= limit(m)) for m in ROWS.values()))


FAR = 2**60  # units of way that are added up: seven years at 400 km/h; from then on no train comes far enough


def turned(speed: Int) -> UInt:
    """Way before this step, added up from the speeds."""
    return total(speed.sat(20), FAR)


def way_since_signal_3(s: Seen) -> Int:
    """Way from the end of the step with signal 3 to that of this step, added up from the speeds."""
    now = turned(s.speed).int() + s.speed
    return now - last(now, s.signal3, 0)


def far_enough(s: Seen, limit: Callable[[int], Fraction], presets: Sequence[int] = PRESETS) -> Bit:
    """Since signal 3 the train has come as far as at this limit or further, being anywhere between two whole units.

    The way at the end of each step is rounded up to a whole unit, so less than a unit may be missing.
    """

    def enough(m: int) -> Bit:
        least, parts = limit(m).as_integer_ratio()
        return parts * (way_since_signal_3(s) + 1) > least * pulses(s).int()

    return any_of(*((preset(s) == m) & enough(m) for m in presets))


def pulses(s: Seen) -> UInt:
    """Oscillator pulses of this window before this step, counted by the claim: one a step while the gate is open."""
    return age(s.gate, LONG)


def through_the_window(s: Seen, condition: Bit) -> Bit:
    """Since the last signal 3 the condition has held and the selection was kept, as long as the gate was open."""
    return since(s.signal3, (condition & kept(s)) | ~counting(s))


def position(s: Seen, edge: int = EDGE) -> Int:
    """Way since signal 3 while the gate is open, since its closing in the preparation; to the last fraction."""
    return edge * edges(s).int() + s.train.phase


def edges(s: Seen) -> UInt:
    """Content of counter 2."""
    return s.circuit.counter2.n


def counted(s: Seen) -> UInt:
    """Content of counter 1."""
    return s.circuit.counter1.n


def counting(s: Seen) -> Bit:
    """Whether the gate was open at the end of the step before."""
    return s.circuit.counter2.counting


def safe(s: Seen) -> Bit:
    """FF6 before this step."""
    return s.circuit.ff6.on


# --- lemmas: invariants of the registers -----------------------------------------------------------------------------


def preparation_in_order(s: Seen, most: int = max(PRESETS)) -> Bit:
    """In the preparation counter 2 is below 8; from signal 2 on FF6 and counter 1 are reset; no count passes 1035."""
    after_reset = ~safe(s) & (counted(s) == 0)
    preparing = (edges(s) < PREPARATION) & implies(edges(s) >= RESET, after_reset)
    return select(counting(s), edges(s) < most, preparing)


def named(name: str, formula: Formula) -> Formula:
    """The formula under the name by which results show it."""
    formula.__name__ = name
    return formula


# --- scripted runs ---------------------------------------------------------------------------------------------------


def line(v: int) -> dict[str, Any]:
    """The inputs that select a check speed in km/h."""
    return {f"lines.s{v}": True}


def phase_before(speed: int, left: int = 0, edge: int = EDGE) -> int:
    """Phase at power-up from which, at a constant speed, signal 3 leaves the phase `left` (below the speed)."""
    return (PREPARATION * edge + left) % max(speed, 1) % edge


def steadily(v: int, speed: int, steps: int = 2400, left: int = 0, edge: int = EDGE, **more: Any) -> Scenario:
    """One check speed, one speed, from power-up; signal 3 leaves the phase `left`."""
    return Scenario(steps, {**line(v), "speed": speed}, {"train.phase": phase_before(speed, left, edge)}, **more)

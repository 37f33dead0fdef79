"""Two-counter ATC: the quantities that the proofs reason with, as plain functions, and the runs that they script.

While the gate is open, counter 2 and the phase of the axle together hold the way since signal 3, to the last fraction
of an edge: the *position*.  Counter 1 holds the time.  At or above a speed the position therefore runs ahead of counter
1 at a known rate, whatever the phases were; how counter 1 stands when the gate closes follows.

Units: an edge is EDGE = 500 * n1F units of way; 2000 units a step are 1 km/h on the frequency scale.
Source: the sum of the speed over a window, for all phases and presets [D].
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from models.two_counter.numbers import CHECK_SPEEDS, N1F, PRESETS
from safety import Bit, Int, Scenario, Seen, UInt, all_of, any_of, implies, previous, select, since

Formula = Callable[[Seen], Bit]

ROWS = dict(zip(CHECK_SPEEDS, PRESETS, strict=True))  # check speed in km/h: preset in edges
EDGE = 500 * N1F  # units of way from edge to edge
PREPARATION = 8  # edges from the end of a count to signal 3
READ_OUT = 2  # edges from the end of a count to signal 1


def least_too_fast(m: int, edge: int = EDGE) -> int:
    """Least speed input that is at or above f2E * n1F / (n1F - 1): at which every sample brakes."""
    return -(-edge * m // (N1F - 1))


def greatest_permitted(m: int) -> int:
    """The speed input that is f2E: up to which every sample releases."""
    return 500 * m


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


def at_each(now: UInt, formula: Callable[[int], Bit]) -> Bit:
    """What holds of the one among the presets that stands in a word."""
    return all_of(*(implies(now == m, formula(m)) for m in ROWS.values()))


def at_least(s: Seen, limit: Callable[[int], int]) -> Bit:
    """The speed is at or above the limit of the check speed selected."""
    return any_of(*((preset(s) == m) & (s.speed >= limit(m)) for m in ROWS.values()))


def at_most(s: Seen, limit: Callable[[int], int]) -> Bit:
    """The speed is at or below the limit of the check speed selected."""
    return any_of(*((preset(s) == m) & (s.speed <= limit(m)) for m in ROWS.values()))


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


def preparation_in_order(s: Seen) -> Bit:
    """In the preparation counter 2 is below 8; from signal 2 on FF6 and counter 1 are reset; no count passes 1035."""
    after_reset = ~safe(s) & (counted(s) == 0)
    preparing = (edges(s) < PREPARATION) & implies(edges(s) >= 4, after_reset)
    return select(counting(s), edges(s) < max(PRESETS), preparing)


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

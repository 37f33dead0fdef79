"""Exact points: from a solver's approximate answer to a point at which every constraint certainly holds.

Free variables keep rational values.  A variable that an equality fixes is computed from it: exactly where it stands
linearly (or has a rational root), otherwise as a narrow interval at whose ends the two sides of the equality differ in
opposite senses, for every value the variables before it may have; so a solution exists in the interval, and the other
constraints are required of the whole interval.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from flint import fmpq

from safety.prove.bounds.cases import ABOVE, AT, Atom
from safety.prove.bounds.polynomials import ZERO, Box, Interval, Polynomial, quotient, root

FINEST, COARSEST = 80, 12  # roots are sought within 2**-80, at most 2**-12, of their approximate value


@dataclass(frozen=True)
class Point:
    """An interval for each variable, of no width where its value is rational."""

    box: tuple[Interval, ...]


def settle(case: Sequence[Atom], guess: Sequence[fmpq], fixed: Collection[int], whole: Collection[int]) -> Point | None:
    """A point near the guess at which all of the case holds, the variables in `fixed` computed from equalities.

    Those in `whole` have whole values there.

    None where there is none to be found: the guess is too far away, or the equalities do not fix the variables in turn.
    """
    box: Box = [(x, x) for x in guess]
    waiting, equalities, defining = set(fixed), [a.polynomial for a in case if a.relation == AT], set()
    while waiting:
        step = next(((p, i) for p in equalities if p not in defining and (i := _only(p, waiting)) is not None), None)
        if step is None:
            return None
        polynomial, variable = step
        found = _solved(polynomial, variable, box)
        if found is None:
            return None
        box[variable] = found
        defining.add(polynomial)
        waiting.discard(variable)
    defining = {p for p in defining if not _exactly_zero(p, box)}
    holds = all(a.polynomial in defining or certain(a, box) for a in case)
    holds = holds and all(box[i][0] == box[i][1] and box[i][0].q == 1 for i in whole)
    return Point(tuple(box)) if holds else None


def certain(atom: Atom, box: Sequence[Interval]) -> bool:
    """Whether an atom holds all over a box."""
    low, high = atom.polynomial.over(box)
    if atom.relation == AT:
        return bool(low.p == 0 == high.p)
    return bool(low.p > 0 if atom.relation == ABOVE else low.p >= 0)


def impossible(atom: Atom, box: Sequence[Interval]) -> bool:
    """Whether an atom holds nowhere in a box."""
    low, high = atom.polynomial.over(box)
    if atom.relation == AT:
        return bool(low.p > 0 or high.p < 0)
    return bool(high.p <= 0 if atom.relation == ABOVE else high.p < 0)


def fixed_in_turn(case: Sequence[Atom]) -> list[int]:
    """Variables that the equalities fix one after another, each by its own; those without a range of their own first.

    Empty where the equalities do not come apart like that.
    """
    left = [a.polynomial for a in case if a.relation == AT]
    ranged = [a.polynomial.variables[0] for a in case if a.relation != AT and len(a.polynomial.variables) == 1]
    fixed: list[int] = []
    while left:
        own = [(p, i) for p in left for i in p.variables if sum(i in q.variables for q in left) == 1]
        if not own:
            return []
        polynomial, variable = min(own, key=lambda pi: (ranged.count(pi[1]) > 1, max(pi[0].in_powers_of(pi[1]))))
        fixed.append(variable)
        left.remove(polynomial)
    return fixed


def _only(polynomial: Polynomial, waiting: Collection[int]) -> int | None:
    """The one variable of a polynomial that is not known yet; None if there are more, or none."""
    unknown = [i for i in polynomial.variables if i in waiting]
    return unknown[0] if len(unknown) == 1 else None


def _exactly_zero(polynomial: Polynomial, box: Box) -> bool:
    return polynomial.over(box) == (ZERO, ZERO)


def _solved(polynomial: Polynomial, variable: int, box: Box) -> Interval | None:
    """The root of a polynomial in one variable near its guess, the others being known."""
    parts = polynomial.in_powers_of(variable)
    known = {power: part.over(box) for power, part in parts.items()}
    if max(known) == 1 and (known[1][0] > 0 or known[1][1] < 0):
        low, high = known.get(0, (ZERO, ZERO))
        return quotient((-high, -low), known[1])
    if set(known) == {0, 2} and all(low == high for low, high in known.values()) and known[2][0] != 0:
        square = -known[0][0] / known[2][0]
        if square < 0:
            return None
        low, high = root(square, False, FINEST), root(square, True, FINEST)
        return (low, high) if box[variable][0] >= 0 else (-high, -low)
    return _bracketed(polynomial, variable, box)


def _bracketed(polynomial: Polynomial, variable: int, box: Box) -> Interval | None:
    """An interval around the guess at whose ends the polynomial certainly has opposite signs."""
    near = box[variable][0]
    for bits in range(FINEST, COARSEST, -4):
        reach = max(abs(near), fmpq(1, 1 << 20)) / (1 << bits)
        ends = [polynomial.over([*box[:variable], (x, x), *box[variable + 1 :]]) for x in (near - reach, near + reach)]
        (a, b), (c, d) = ends
        if (b < 0 and c > 0) or (a > 0 and d < 0):
            return near - reach, near + reach
    return None

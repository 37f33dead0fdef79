"""Whether a formula over bounded reals can hold, by cutting boxes: the route that shares nothing with the solvers.

A box is narrowed by what each constraint leaves of each variable, and dropped when a sum of constraints, weighted so
that their slopes cancel at its middle, stays below zero all over it (mean-value form of the Lagrangian: sound for any
weights, and close to the truth with good ones).  What is left is halved.  All ends of intervals are exact rationals.
"""

from __future__ import annotations

import time
from collections.abc import Collection, Sequence
from typing import NamedTuple

from flint import fmpq

from safety.prove.bounds.cases import ABOVE, AT, Atom, Case
from safety.prove.bounds.narrow import first_box, left_by
from safety.prove.bounds.points import Point, certain, fixed_in_turn, impossible, settle
from safety.prove.bounds.polynomials import ZERO, Box, Polynomial, rounded
from safety.prove.bounds.reduce import Reduced, reduced
from safety.prove.bounds.weights import weights
from safety.prove.solve import SAT, UNKNOWN, UNSAT

NARROWEST = fmpq(1, 1 << 30)  # side of a box, beside its first width, below which cutting goes nowhere


class Searched(NamedTuple):
    """What the search of boxes found: `point` when sat, `why` when unknown; `boxes` is the work done.

    `unbounded` is a variable without bounds, if that is why nothing was found.
    """

    answer: str
    boxes: int
    point: Point | None = None
    unbounded: int | None = None
    why: str = ""


def search(cases: Sequence[Case], size: int, whole: Collection[int], most: int, seconds: float) -> Searched:
    """Whether one of the cases, over `size` variables, can hold.

    Variables in `whole` take whole values.  Gives up after `most` boxes, or after some seconds.
    """
    boxes, until, open_ = 0, time.perf_counter() + seconds, Searched(UNSAT, 0)
    for case in cases:
        box, missing = first_box(case, size)
        if box is None:
            continue
        if missing is not None:
            open_ = Searched(UNKNOWN, 0, unbounded=missing, why="has no bounds; give it a range")
            continue
        for part in reduced(case, box, whole):
            found = _Cutting(case, part, box, whole).run(most - boxes, until)
            boxes += found.boxes
            if found.answer == SAT:
                return found._replace(boxes=boxes)
            open_ = found if found.answer == UNKNOWN else open_
    return open_._replace(boxes=boxes)


class _Level(NamedTuple):
    """How high a polynomial can be over a box: up to the bound, highest near `top`."""

    top: list[fmpq]
    bound: fmpq
    strict: bool

    @property
    def excludes(self) -> bool:
        """Whether the polynomial stays below zero all over the box, or where it is a strict one, at most at zero."""
        return self.bound < 0 or (self.bound == 0 and self.strict)


def _highest(polynomial: Polynomial, box: Box, strict: bool) -> _Level:
    """An upper bound: sides along which it rises or falls throughout are closed, the others by the mean-value form."""
    face, loose, closing = list(box), list(polynomial.variables), True
    while closing:
        closing = False
        for i in list(loose):
            low, high = polynomial.derivative(i).over(face)
            if low.p >= 0 or high.p <= 0:
                end = face[i][1] if low.p >= 0 else face[i][0]
                face[i] = end, end
                loose.remove(i)
                closing = True
    top = [(low + high) / 2 for low, high in face]
    sides: Box = [(x, x) for x in top]
    bound = polynomial.at(top)
    for i in loose:
        sides[i] = face[i]
        low, high = polynomial.derivative(i).over(sides)
        bound += max(-low, high) * (face[i][1] - top[i])
    return _Level(top, bound, strict)


class _Cutting:
    """The search of one case, in the form with fewer variables; points are settled in the case itself."""

    def __init__(self, case: Case, part: Reduced, start: Box, whole: Collection[int]) -> None:
        self.case, self.part, self.whole = case, part, whole
        self.atoms = [a for a in part.case if not certain(a, start)]
        self.fixed = [*part.solved, *fixed_in_turn(part.case)]
        gone = {r.variable for r in part.removed}
        self.start = [(ZERO, ZERO) if i in gone else ends for i, ends in enumerate(start)]
        self.full = [high - low for low, high in start]
        self.boxes = 0

    def run(self, most: int, until: float) -> Searched:
        """Cut until nothing is left, a point is found or the work is used up."""
        stack = [self.start]
        while stack:
            if self.boxes >= most or time.perf_counter() > until:
                return Searched(UNKNOWN, self.boxes, why=f"{self.boxes} boxes did not settle it")
            self.boxes += 1
            box = self._narrowed(stack.pop())
            if box is None:
                continue
            level = self._excluded(box)
            if level is not None and level.excludes:
                continue
            point = self._point(level.top if level else [(low + high) / 2 for low, high in box])
            if point is not None:
                return Searched(SAT, self.boxes, point)
            halves = self._halves(box)
            if halves is None:
                return Searched(UNKNOWN, self.boxes, why="a point is left at which it may just hold")
            stack += halves
        return Searched(UNSAT, self.boxes)

    def _point(self, guess: list[fmpq]) -> Point | None:
        """An exact point of the whole case near a guess at the variables that are left."""
        guess = [fmpq(round(x)) if i in self.whole else x for i, x in enumerate(guess)]
        for variable, factor, rest in reversed(self.part.removed):
            below = factor.at(guess)
            if below == 0:
                return None
            guess[variable] = -rest.at(guess) / below
        return settle(self.case, guess, self.fixed, self.whole)

    # --- narrowing -----------------------------------------------------------------------------------------------

    def _narrowed(self, box: Box) -> Box | None:
        """What the constraints leave of a box; None for nothing."""
        box = list(box)
        for i in self.whole:
            low, high = box[i]
            box[i] = fmpq(low.ceil()), fmpq(high.floor())
            if box[i][0] > box[i][1]:
                return None
        for atom in self.atoms:
            if impossible(atom, box):
                return None
            if atom.relation != AT and certain(atom, box):
                continue
            for i in atom.polynomial.variables:
                if box[i][0] < box[i][1]:
                    left = left_by(atom, i, box)
                    if left is None:
                        return None
                    assert left[0] is not None and left[1] is not None
                    box[i] = left[0], left[1]
        return box

    # --- exclusion -----------------------------------------------------------------------------------------------

    def _excluded(self, box: Box) -> _Level | None:
        """A weighted sum of constraints that is below zero all over the box, or the lowest that was found."""
        middle = [(low + high) / 2 for low, high in box]
        widths = [high - low for low, high in box]
        doubtful = [a for a in self.atoms if not certain(a, box)]
        faces = [_Face(a, middle, widths) for a in doubtful]
        best: _Level | None = None
        for goal in sorted((f for f in faces if f.value < 0 or f.free), key=lambda f: f.depth)[:2]:
            level = self._level(goal, [f for f in faces if f is not goal], box)
            if level.excludes:
                return level
            best = best or level
        return best

    def _level(self, goal: _Face, others: list[_Face], box: Box) -> _Level:
        others = [f for f in others if f.scaled]
        steepest = {i: goal.sign * x for i, x in goal.scaled.items()}
        total = goal.sign * goal.atom.polynomial.source
        strict = goal.atom.relation == ABOVE
        for weight, face in zip(weights(steepest, [(f.scaled, f.free) for f in others]), others, strict=True):
            if weight > 0 or (weight < 0 and face.free):  # only an equality may be taken either way
                total += weight * face.atom.polynomial.source
                strict |= face.atom.relation == ABOVE
        return _highest(Polynomial(total), box, strict)

    # --- cutting -------------------------------------------------------------------------------------------------

    def _halves(self, box: Box) -> list[Box] | None:
        """The box cut across the side that is widest beside its first width; None where all are too narrow."""
        shares = {i: (high - low) / self.full[i] for i, (low, high) in enumerate(box) if low < high}
        across = max(shares, key=lambda i: shares[i], default=-1)
        if across < 0 or shares[across] < NARROWEST:
            return None
        low, high = box[across]
        cut = rounded((low + high) / 2, False)
        if not low < cut < high:
            cut = (low + high) / 2
        return [[*box[:across], side, *box[across + 1 :]] for side in ((low, cut), (cut, high))]


class _Face:
    """A constraint over a box: its value and slopes at the middle, its slopes all over the box."""

    def __init__(self, atom: Atom, middle: Sequence[fmpq], widths: Sequence[fmpq]) -> None:
        self.atom = atom
        polynomial = atom.polynomial
        self.value = polynomial.at(middle)
        self.free = atom.relation == AT
        self.sign = -1 if self.free and self.value > 0 else 1
        self.scaled = {i: _float(polynomial.derivative(i).at(middle) * widths[i]) for i in polynomial.variables}
        reach = sum(abs(x) for x in self.scaled.values())
        self.depth = -abs(_float(self.value)) / reach if reach else -1e300


def _float(x: fmpq) -> float:
    return int(x.p) / int(x.q)

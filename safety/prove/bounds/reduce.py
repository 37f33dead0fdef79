"""Cases with fewer variables: what an equality defines is put in its place, what only helps is pushed to its limit.

Two exact steps, each for one variable at a time.  An equality in which the variable stands linearly, its factor of one
sign over the box, defines it.  A variable in no equality, in which each constraint rises or falls throughout, matters
only at its limit on one side: the greatest of the lower limits (or the least of the upper), one case for each.  So a
bound that is met with equality along a whole surface cancels to nothing here, where no cutting of boxes would end.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

from safety.prove.bounds.cases import ABOVE, AT, FROM, Atom, Case
from safety.prove.bounds.polynomials import Box, Polynomial, quotient

LONGEST = 80  # terms of a polynomial that a step may make
ORDERS = 60  # of using the equalities that are tried
MOST = 8  # cases that one case may become


class Removed(NamedTuple):
    """A variable that a step took out: it is `-rest / factor`, the factor being above zero all over the box."""

    variable: int
    factor: Polynomial
    rest: Polynomial


class Reduced(NamedTuple):
    """A case without the variables removed, in the order in which they were; its `solved` ones by equalities."""

    case: Case
    removed: tuple[Removed, ...] = ()
    solved: tuple[int, ...] = ()


def reduced(case: Case, box: Box, kept: Collection[int]) -> list[Reduced]:
    """Cases one of which can hold in the box wherever the case can; variables in `kept` stay."""
    done: list[Reduced] = []
    waiting = [Reduced(case)]
    while waiting:
        now = waiting.pop()
        following = _pushed(now, box, kept) if len(done) + len(waiting) < MOST else None
        following = _defined(now, box, kept, [ORDERS]) if following is None else following
        if following is None:
            done.append(now)
        else:
            waiting += following
    return done


def _defined(now: Reduced, box: Box, kept: Collection[int], budget: list[int]) -> list[Reduced] | None:
    """The case with its equalities used up as they can be, in the order that leaves least; None where none can."""
    steps = [
        (atom, step)
        for atom in now.case
        if atom.relation == AT
        for i in atom.polynomial.variables
        if i not in kept and (step := _solved(atom.polynomial, i, box)) is not None
    ]
    best: list[Reduced] | None = None
    for atom, step in steps:
        rest = _put(tuple(a for a in now.case if a is not atom), step)
        if rest is None:
            continue
        ways: list[Reduced] = []
        for case in rest:
            then = Reduced(case, (*now.removed, step), (*now.solved, step.variable))
            ways += _defined(then, box, kept, budget) or [then]
        if best is None or sum(_size(w.case) for w in ways) < sum(_size(w.case) for w in best):
            best = ways
        budget[0] -= 1
        if budget[0] <= 0:
            break
    return best


def _size(case: Case) -> int:
    """How crooked a case is: the squared degrees of its terms."""
    return sum(sum(power for _, power in powers) ** 2 for a in case for _, powers in a.polynomial.terms)


def _pushed(now: Reduced, box: Box, kept: Collection[int]) -> list[Reduced] | None:
    """The cases with one variable at its limit; None where no variable has all constraints on one side or the other."""
    choices: list[list[tuple[Atom, Removed]]] = []
    for i in sorted({i for a in now.case for i in a.polynomial.variables} - set(kept)):
        touching = [a for a in now.case if i in a.polynomial.variables]
        slopes = [a.polynomial.derivative(i).over(box) for a in touching]
        lower = [a for a, (low, _) in zip(touching, slopes, strict=True) if low >= 0]
        upper = [a for a, (_, high) in zip(touching, slopes, strict=True) if high <= 0]
        if len(lower) + len(upper) == len(touching) and all(a.relation != AT for a in touching):
            for limits in (lower, upper):
                steps = [(a, _solved(a.polynomial, i, box)) for a in limits]
                taken = [(a, step) for a, step in steps if step is not None]
                if (
                    taken
                    and len(taken) == len(limits)
                    and _reach_into(box, [step for _, step in taken], limits is lower)
                ):
                    choices.append(taken)
    if not choices:
        return None
    chosen = min(choices, key=len)
    side = {a for a, _ in chosen}
    cases: list[Reduced] = []
    for limit, step in chosen:
        # The limit may be approached only, so that the other limits on its side may just be met there.
        met = (Atom(a.polynomial, FROM) if a in side else a for a in now.case if a is not limit)
        rest = _put(tuple(met), step)
        if rest is None:
            return None
        cases += [Reduced(c, (*now.removed, step), now.solved) for c in rest]
    return cases


def _reach_into(box: Box, steps: list[Removed], lower: bool) -> bool:
    """Whether the last of the limits stays where the slopes are known, that is inside the box, wherever it can be."""
    ends = [quotient((-s.rest).over(box), s.factor.over(box)) for s in steps]
    low, high = box[steps[0].variable]
    return max(e[0] for e in ends) >= low if lower else min(e[1] for e in ends) <= high


def _solved(polynomial: Polynomial, variable: int, box: Box) -> Removed | None:
    """The step that takes the variable from where the polynomial is zero; None where it does not define it."""
    parts = polynomial.in_powers_of(variable)
    if max(parts) != 1:
        return None
    factor, rest = parts[1], parts.get(0, polynomial - polynomial)
    low, high = factor.over(box)
    if low > 0:
        return Removed(variable, factor, rest)
    return Removed(variable, -factor, -rest) if high < 0 else None


def _put(case: Case, step: Removed) -> list[Case] | None:
    """The case with the variable replaced, denominators cleared: one case, none if it cannot hold; None if too long."""
    found: dict[Atom, None] = {}
    for atom in case:
        polynomial = _replaced(atom.polynomial, step)
        if len(polynomial.terms) > LONGEST:
            return None
        value = polynomial.constant
        if value is None:
            found[Atom(polynomial, atom.relation)] = None
        elif not (value == 0 if atom.relation == AT else value > 0 if atom.relation == ABOVE else value >= 0):
            return []
    return [tuple(found)]


def _replaced(polynomial: Polynomial, step: Removed) -> Polynomial:
    parts = polynomial.in_powers_of(step.variable)
    degree = max(parts)
    total = polynomial - polynomial
    for power, part in parts.items():
        for base, times in ((-step.rest, power), (step.factor, degree - power)):
            for _ in range(times):
                part = part * base
        total = total + part
    return total

"""What one balise lost and one too many can make of a code when the extra one stands anywhere, not on a slot.

The span check lets a range of true spans Y pass, from (L - slack)/(1 + eps) to (L + slack)/(1 - eps).  A balise at a
distance d from the end of the group that is its own, read as m slots from there, needs

    40 (d - 2e) / (m + u_tol)  <=  Y  <=  40 (d + 2e) / (m - u_tol)

so the readings that are possible are those whose balises have a Y in common.  The jitter of the common end is taken
anew for each balise: the set found may be too large, never too small.  Exact rational arithmetic.
Source: L = 40 m, slots of 1 m, e = 0.10 m, u_tol = 0.25 [A].

The error of the origin is that of the place at which the group's first balise is taken to have been detected.

Main results: up to a scale error of 0.4 % no code of the 247 of `TURNED` can be read as another one; with 1 % the span
check passes true spans from 39 to 41 m, and other codes can be read.  A code read as itself need not have its origin:
with the first balise lost and an extra one near its place every
code passes, the origin up to 0.63 m off at 0.4 % and 1.12 m at 1 %, e included; nothing on board tells this from e.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from models.position.code import SLOTS, SPAN, Code
from models.position.code_sets import CodeSet

Range = tuple[Fraction, Fraction]
REACH = 3  # slots that a balise can be read away from its own, at most


@dataclass(frozen=True)
class Tolerances:
    """Jitter m, scale error, distance from a slot."""

    e: Fraction = Fraction(1, 10)
    eps: Fraction = Fraction(1, 100)
    u_tol: Fraction = Fraction(1, 4)

    @property
    def spans(self) -> Range:
        """True spans that can pass the span check, m."""
        slack = SPAN * self.eps + 2 * self.e * (1 + self.eps)
        return (SPAN - slack) / (1 + self.eps), (SPAN + slack) / (1 - self.eps)

    def slots(self, distance: int, spans: Range) -> Iterator[tuple[int, Range]]:
        """Slots that a balise can be read at, from the end that is the group's own, with the spans that this takes."""
        for m in range(max(1, distance - REACH), min(SLOTS, distance + REACH) + 1):
            low = SPAN * (distance - 2 * self.e) / (m + self.u_tol)
            high = SPAN * (distance + 2 * self.e) / (m - self.u_tol)
            shared = max(low, spans[0]), min(high, spans[1])
            if shared[0] <= shared[1]:
                yield m, shared

    def readings(self, distances: Sequence[int], spans: Range) -> Iterator[tuple[tuple[int, ...], Range]]:
        """All that several balises can be read as at once, in the order given, with the spans that this takes."""
        if not distances:
            yield (), spans
            return
        for m, shared in self.slots(distances[0], spans):
            for others, left in self.readings(distances[1:], shared):
                yield (m, *others), left


@dataclass(frozen=True)
class Misreading:
    """Slots that are read, three or, with the extra balise anywhere between, two; error of the origin, m."""

    slots: tuple[int, ...]
    origin: Range

    @property
    def off(self) -> Fraction:
        """The greatest error of the origin."""
        return max(abs(end) for end in self.origin)


def misreadings(code: Code, tolerances: Tolerances) -> Iterator[Misreading]:
    """Readings that pass as five balises with a good span, one of them not the group's."""
    stood, e = (0, *code, SPAN), tolerances.e
    yield from (Misreading(kept, (-e, e)) for kept in itertools.combinations(code, 2))
    for lost in range(len(stood)):
        *inner, end = left = [place for k, place in enumerate(stood) if k != lost]
        first, *rest = left
        for read, (low, high) in tolerances.readings([end - place for place in inner], tolerances.spans):
            yield Misreading(tuple(sorted(SPAN - m for m in read)), (end - high - e, end - low + e))
        for read, _ in tolerances.readings([place - first for place in rest], tolerances.spans):
            yield Misreading(tuple(sorted(read)), (first - e, first + e))
        if lost in (0, len(stood) - 1):
            span = Fraction(end - first)
            low, high = tolerances.spans
            spans = max(low, span - 2 * tolerances.e), min(high, span + 2 * tolerances.e)
            if spans[0] <= spans[1]:
                kept = [place - first for place in left[1:-1]]
                yield from (
                    Misreading(tuple(sorted(r)), (first - e, first + e)) for r, _ in tolerances.readings(kept, spans)
                )


@dataclass(frozen=True)
class Undetected:
    """A code of the set, what it can be read as, and the greatest error of the origin in that, m."""

    code: Code
    read: Code
    off: Fraction


def undetected_anywhere(codes: CodeSet, tolerances: Tolerances) -> list[Undetected]:
    """Each other code of the set that a code can be read as; itself where its origin can be more than e off."""
    found: dict[tuple[Code, Code], Fraction] = {}
    for code in codes:
        for each in misreadings(code, tolerances):
            for other in codes if len(each.slots) == 2 else codes & {each.slots}:
                if {*each.slots} <= {*other} and (other != code or each.off > tolerances.e):
                    found[code, other] = max(found.get((code, other), each.off), each.off)
    return [Undetected(*pair, off) for pair, off in sorted(found.items())]

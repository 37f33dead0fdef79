"""Absolute position code of five balises: the two outer ones stand 40 slots apart, three inner ones on slots 1..39.

A code is (p, q, r) with p < q < r.  Everything here is counted by going through all codes.
Source: five balises, 9,139 combinations [P]; 9139 = C(39, 3) [D]; slots of 1 m, one slot at least between balises [A].

Main results: C(39, 3) is the only binomial coefficient C(n, k), 2 <= k <= n/2, of this value; 19 codes read the same
backwards, the others form 4560 pairs, so 4579 codes are told apart when the direction is unknown; one balise lost and
one too many turn every code into 110 others.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from math import comb

from safety import ModelError

Code = tuple[int, int, int]
Gaps = tuple[int, int, int, int]

SLOTS = 39  # places of the inner balises
SPAN = SLOTS + 1  # slots from the first balise to the last
INNER = 3
CODES = comb(SLOTS, INNER)


def all_codes() -> Iterator[Code]:
    """Every code, in order of its rank."""
    yield from itertools.combinations(range(1, SPAN), INNER)


def check(code: Code) -> Code:
    """The code itself; `ModelError` when it is none."""
    if not (len(code) == INNER and 0 < code[0] < code[1] < code[2] < SPAN):
        near = nearest_code(code)
        raise ModelError(f"{code} is no code: three rising slots of 1..{SLOTS}; the nearest admissible value is {near}")
    return code


def nearest_code(numbers: tuple[int, ...]) -> Code:
    """The code that three numbers are nearest to, the first one where several are."""
    three = sorted((*numbers, *range(1, 1 + INNER))[:INNER])
    return min(all_codes(), key=lambda code: sum(abs(a - b) for a, b in zip(code, three, strict=True)))


def rank(code: Code) -> int:
    """Place of a code in lexicographic order, from 0; `ModelError` when it is no code."""
    left = (comb(SLOTS - slot, INNER - k) for k, slot in enumerate(check(code)))
    return CODES - 1 - sum(left)


def unrank(index: int) -> Code:
    """The code of a rank; `ModelError` outside 0..9138."""
    if not 0 <= index < CODES:
        near = min(max(index, 0), CODES - 1)
        raise ModelError(f"{index} is no rank: 0..{CODES - 1}; the nearest admissible value is {near}")
    left, slot, found = CODES - 1 - index, 0, []
    for k in range(INNER, 0, -1):
        slot = next(s for s in range(slot + 1, SPAN) if comb(SLOTS - s, k) <= left)
        left -= comb(SLOTS - slot, k)
        found.append(slot)
    return found[0], found[1], found[2]


def gaps(code: Code) -> Gaps:
    """The four distances from balise to balise, in slots."""
    p, q, r = code
    return p, q - p, r - q, SPAN - r


def of_gaps(each: Gaps) -> Code:
    """The code with these distances."""
    return each[0], each[0] + each[1], SPAN - each[3]


def mirror(code: Code) -> Code:
    """What a train reads that passes the code the other way."""
    p, q, r = code
    return SPAN - r, SPAN - q, SPAN - p


def rotations(code: Code) -> tuple[Code, Code]:
    """What is read when the last (first) balise is lost and another one stands before (behind), the span kept.

    The four gaps are turned by one place.
    """
    a, b, c, d = gaps(code)
    return of_gaps((d, a, b, c)), of_gaps((b, c, d, a))


def substituted(code: Code) -> Iterator[Code]:
    """What is read when one inner balise is lost and another one stands on a free slot: 108 codes."""
    free = [slot for slot in range(1, SPAN) if slot not in code]
    for kept in itertools.combinations(code, INNER - 1):
        for slot in free:
            yield tuple(sorted((*kept, slot)))  # type: ignore[misc]


def wrong_readings(code: Code) -> set[Code]:
    """All that one balise lost and one too many can make of a code, at slots: 108 and 2 rotations.

    Rotations may coincide with each other or with the code itself.
    """
    return {*substituted(code), *rotations(code)}


def shifted(code: Code) -> Iterator[Code]:
    """Codes one slot away in one balise."""
    for k, step in itertools.product(range(INNER), (-1, 1)):
        slots = list(code)
        slots[k] += step
        if 0 < slots[k] < SPAN and len(set(slots)) == INNER:
            yield slots[0], slots[1], slots[2]


def pairs(partners: Callable[[Code], Iterator[Code]]) -> int:
    """Unordered pairs of different codes of which one is a partner of the other."""
    return sum(1 for code in all_codes() for other in partners(code) if code < other)


def binomials_equal_to(value: int) -> list[tuple[int, int]]:
    """All (n, k), 2 <= k <= n/2, with C(n, k) equal to a value."""
    found = []
    for k in range(2, value.bit_length()):
        n = 2 * k
        while comb(n, k) < value:
            n += 1
        if comb(n, k) == value:
            found.append((n, k))
    return found


def span_with_spacing(least: int) -> int:
    """Span, in units, that has as many codes when neighbouring balises need `least` units between them.

    Raises `ModelError` below 1.
    """
    if least < 1:
        raise ModelError(f"{least} units between balises: it is 1 or more; the nearest admissible value is 1")
    return SPAN + (INNER + 1) * (least - 1)


def codes_in_span(span: int, least: int) -> int:
    """Codes with a span and a least spacing, by going through the four gaps."""
    room = range(least, span)
    return sum(1 for a in room for b in room for c in room if span - a - b - c >= least)

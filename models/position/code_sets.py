"""Thinned code sets: codes of which any two share at most one inner slot, so that a loss and an extra balise is seen.

Each code holds three of the 741 pairs of slots, and no pair may come twice: at most 247 codes.  That many form a
Steiner triple system on 39 points, here that of Bose: points are (x, i), x of 0..12 and i of 0..2, the triples

    (x, 0), (x, 1), (x, 2)          and          (x, i), (y, i), ((x + y) / 2 modulo 13, i + 1 modulo 3)  for x < y.

Which slot a point takes is free, and decides whether rotations (wrong readings at the ends) or mirror images are codes
too: `turned` moves each third of the slots round by so many places.
Source: the idea of checking against installed codes [P]; numbers [D]; R. C. Bose, On the construction of balanced
incomplete block designs, Annals of Eugenics 9 (1939).

Main results: 247 is the largest number of codes; the system on slots as they come holds four codes with a rotation of
theirs, six mirror pairs and a palindrome: 243 codes are left without rotations, 237 that tell the direction, too.  With
thirds turned by 0, 10 and 4 places it holds none of these: 247 codes that lack nothing.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from math import comb

import networkx as nx

from models.position.code import INNER, SLOTS, Code, mirror, rotations, wrong_readings

THIRD = SLOTS // 3
HALF = (THIRD + 1) // 2  # 1/2 modulo 13
AS_THEY_COME, TURNED = (0, 0, 0), (0, 10, 4)

CodeSet = frozenset[Code]


def most_codes() -> int:
    """No set in which two codes share at most one slot is larger: 741 pairs of slots, three in each code."""
    return comb(SLOTS, 2) // comb(INNER, 2)


def bose(turned: tuple[int, int, int] = AS_THEY_COME) -> CodeSet:
    """The 247 codes, each third of the slots moved round by so many places."""

    def slot(x: int, i: int) -> int:
        return (x + turned[i % 3]) % THIRD + THIRD * (i % 3) + 1

    across = [[slot(x, i) for i in range(3)] for x in range(THIRD)]
    within = [
        [slot(x, i), slot(y, i), slot((x + y) * HALF, i + 1)]
        for x, y in itertools.combinations(range(THIRD), 2)
        for i in range(3)
    ]
    return frozenset(tuple(sorted(three)) for three in (*across, *within))  # type: ignore[misc]


def shared(one: Code, other: Code) -> int:
    """Slots that two codes have in common."""
    return len({*one} & {*other})


def pairwise(codes: Iterable[Code]) -> int:
    """The most slots that two different codes of a set share."""
    return max(shared(a, b) for a, b in itertools.combinations(codes, 2))


def undetected(codes: CodeSet) -> list[tuple[Code, Code]]:
    """Code and reading, both in the set, of every loss with an insertion that passes; its own rotation too."""
    return sorted((code, read) for code in codes for read in wrong_readings(code) if read in codes)


def both_ways(codes: CodeSet) -> list[tuple[Code, Code]]:
    """Codes that do not give the direction: mirror pairs, once each, and palindromes."""
    return sorted((code, mirror(code)) for code in codes if mirror(code) in codes and code <= mirror(code))


def largest_part(codes: CodeSet, directed: bool = False) -> CodeSet:
    """The largest part of a set without rotations, and without mirror images if `directed`.

    The codes that exclude each other form small groups, of which each is searched through: nothing is larger.
    """
    rivals = nx.Graph()
    rivals.add_nodes_from(codes)
    for code in codes:
        others = (*rotations(code), *((mirror(code),) if directed else ()))
        rivals.add_edges_from((code, other) for other in others if other in codes)
    kept: set[Code] = set()
    for group in nx.connected_components(rivals):
        kept |= _largest_without(rivals, sorted(group))
    return frozenset(kept)


def _largest_without(rivals: nx.Graph, group: list[Code]) -> set[Code]:
    """The largest subset of a group in which no two are rivals and none is its own: all subsets, the largest first."""
    usable = [code for code in group if not rivals.has_edge(code, code)]
    for size in range(len(usable), 0, -1):
        for chosen in itertools.combinations(usable, size):
            if not any(rivals.has_edge(a, b) for a, b in itertools.combinations(chosen, 2)):
                return {*chosen}
    return set()

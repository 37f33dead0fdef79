"""The codes counted: every figure by going through all codes, and what each thinned set of codes withstands.

Source: AP-7, AP-8; 9,139 combinations [P]; derived counts [D].

Main results: the figures are confirmed, but that 110 readings are all different holds for 9062 of the codes only; 247
codes with direction and without rotations exist, no set is larger.  With one balise lost and the extra one anywhere
they are not read as each other up to a scale error of 0.4 %; but each can be read as itself with its origin off by more
than e.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from fractions import Fraction

from models.position.code import (
    CODES,
    all_codes,
    binomials_equal_to,
    mirror,
    pairs,
    rank,
    rotations,
    shifted,
    substituted,
    unrank,
    wrong_readings,
)
from models.position.code_sets import TURNED, CodeSet, bose, both_ways, largest_part, most_codes, pairwise, undetected
from models.position.misreading import Tolerances, undetected_anywhere
from safety.exhibits import Column, Row, table

ASSUMED = ("[A] 39 slots of 1 m between balises 40 m apart",)
SHARE_ONE = "{13, 26, 39} and {1, 14, 27} share no slot, and are rotations of each other"


def found() -> Iterator[tuple[str, int, int]]:
    """What is counted, the number, and the number that is expected."""
    codes = list(all_codes())
    yield "codes", len(codes), 9139
    yield "rank and unrank undo each other", sum(unrank(rank(code)) == code for code in codes), 9139
    yield "binomial coefficients C(n, k) of that value, 2 <= k <= n/2", len(binomials_equal_to(CODES)), 1
    yield "palindromes", sum(mirror(code) == code for code in codes), 19
    yield "mirror pairs", sum(code < mirror(code) for code in codes), 4560
    yield "classes when the direction is unknown", len({min(code, mirror(code)) for code in codes}), 4579
    yield "pairs one slot apart", pairs(shifted), 25308
    replaced = Counter(len({*substituted(code)}) for code in codes)
    yield "codes that 108 others are one inner balise away from", replaced[108], 9139
    yield "ways in which one lost and one too many change a code", min(replaced) + len(rotations(codes[0])), 110
    different = Counter(len(wrong_readings(code) - {code}) for code in codes)
    for readings, many in ((110, 9062), (109, 50), (108, 27)):
        yield f"codes of which these ways give {readings} different readings", different[readings], many


@table(id="position_codes.counts", title="Codes of five balises, counted one by one", requirement="AP-8",
       source="[P] 9,139 combinations; [D] the other counts", assumed=ASSUMED,
       columns=(Column("what"), Column("counted"), Column("expected"), Column("agrees")))  # fmt: skip
def counts() -> Iterator[Row]:
    """A row a figure."""
    return ((what, number, expected, number == expected) for what, number, expected in found())


# --- thinned sets ----------------------------------------------------------------------------------------------------


def sets() -> dict[str, CodeSet]:
    """Sets of codes by name."""
    plain, turned = bose(), bose(TURNED)
    return {
        "Bose, slots as they come": plain,
        "its largest part without rotations": largest_part(plain),
        "its largest part with direction, too": largest_part(plain, directed=True),
        "Bose, thirds turned by 0, 10, 4": turned,
    }


SET_COLUMNS = (
    Column("set"),
    Column("codes"),
    Column("most that can be"),
    Column("slots shared at most"),
    Column("losses with an insertion that pass, on slots"),
    Column("detects each on slots"),
    Column("gives the direction"),
    Column("no larger set"),
)
SAYS_NO = (
    "Bose, slots as they come: detects each on slots",
    "Bose, slots as they come: gives the direction",
    "its largest part without rotations: gives the direction",
    "its largest part without rotations: no larger set",
    "its largest part with direction, too: no larger set",
)


@table(id="position_codes.sets", title="Code sets that detect a loss with an insertion", requirement="AP-7",
       source="[D] a pair of slots in one code only", assumed=ASSUMED, columns=SET_COLUMNS, says_no=SAYS_NO,
       note=f"Sharing one slot at most is not enough: {SHARE_ONE}; {{10, 20, 30}} would be its own.")  # fmt: skip
def code_sets() -> Iterator[Row]:
    """A row a set; the bound counts pairs of slots, 741 in all, three in each code."""
    for name, codes in sets().items():
        passing, both = undetected(codes), both_ways(codes)
        whole = len(codes) == most_codes()
        yield name, len(codes), most_codes(), pairwise(codes), len(passing), not passing, not both, whole


ANYWHERE = (
    Column("scale error", "%"),
    Column("shortest span", "m", decimals=3),
    Column("longest span", "m", decimals=3),
    Column("other codes read"),
    Column("own code, origin more than e off"),
    Column("origin off at most, as own code", "m", decimals=4),
    Column("reads no other code"),
    Column("origin within e"),
)
SCALES = (Fraction("0.004"), Fraction("0.005"), Fraction("0.01"))
ANYWHERE_NO = (
    *(f"{percent}: origin within e" for percent in ("0.4", "0.5", "1.0")),
    *(f"{percent}: reads no other code" for percent in ("0.5", "1.0")),
)


@table(id="position_codes.anywhere", title="247 codes, one balise lost, the extra one anywhere", requirement="AP-7",
       source="[D] span check and nearness to a slot, over all real places", assumed=(*ASSUMED, "[A] e = 0.10 m"),
       columns=ANYWHERE, says_no=ANYWHERE_NO,
       note="Readings that cannot be excluded, for jitter up to e; none means that none is possible. The error of the "
       "origin, e included, is an upper bound.")  # fmt: skip
def anywhere() -> Iterator[Row]:
    """A row a scale error."""
    for eps in SCALES:
        tolerances = Tolerances(eps=eps)
        passing = undetected_anywhere(bose(TURNED), tolerances)
        own = [each.off for each in passing if each.code == each.read]
        others, (low, high) = len(passing) - len(own), tolerances.spans
        yield float(eps * 100), low, high, others, len(own), max(own), not others, not own

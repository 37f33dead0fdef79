"""Codes, exhaustively: counts, ranks, wrong readings, thinned sets, single faults at every slot."""

from __future__ import annotations

import itertools
import random
from collections import Counter
from fractions import Fraction

import pytest

from models.position import code_sets
from models.position.code import (
    CODES,
    Code,
    all_codes,
    binomials_equal_to,
    codes_in_span,
    gaps,
    mirror,
    of_gaps,
    pairs,
    rank,
    rotations,
    shifted,
    span_with_spacing,
    substituted,
    unrank,
    wrong_readings,
)
from models.position.code_sets import (
    TURNED,
    CodeSet,
    bose,
    both_ways,
    largest_part,
    most_codes,
    pairwise,
    shared,
    undetected,
)
from models.position.misreading import Tolerances, misreadings, undetected_anywhere
from models.position.on_slots import group, read
from safety import ModelError

ALL = list(all_codes())
EXAMPLE = (5, 12, 30)


def test_as_03_number_of_codes_and_ranks() -> None:
    assert len(ALL) == CODES == 9139
    assert [rank(code) for code in ALL] == list(range(CODES))
    assert [unrank(index) for index in range(CODES)] == ALL


def test_as_04_palindromes_classes_neighbours() -> None:
    assert sum(mirror(code) == code for code in ALL) == 19
    assert len({min(code, mirror(code)) for code in ALL}) == 4579
    assert sum(code < mirror(code) for code in ALL) == 4560
    assert {len({*substituted(code)}) for code in ALL} == {108}
    assert pairs(shifted) == 25308


def test_the_count_is_that_of_one_binomial_coefficient() -> None:
    assert binomials_equal_to(9139) == [(39, 3)]
    assert binomials_equal_to(3003) == [(78, 2), (15, 5), (14, 6)]  # the search finds what there is


@pytest.mark.parametrize(("least", "span"), [(1, 40), (2, 44), (3, 48), (4, 52)])
def test_span_with_a_least_spacing(least: int, span: int) -> None:
    assert span_with_spacing(least) == span
    assert [n for n in range(span - 2, span + 3) if codes_in_span(n, least) == CODES] == [span]


def test_gaps_and_rotations() -> None:
    assert all(of_gaps(gaps(code)) == code and sum(gaps(code)) == 40 for code in ALL)
    assert rotations((13, 26, 39))[0] == (1, 14, 27)
    assert rotations((10, 20, 30)) == ((10, 20, 30), (10, 20, 30))
    assert all(rotations(rotations(code)[0])[1] == code for code in ALL)


def test_110_ways_give_110_readings_of_most_codes() -> None:
    assert Counter(len(wrong_readings(code) - {code}) for code in ALL) == {110: 9062, 109: 50, 108: 27}


def test_what_is_no_code_is_refused_with_the_nearest_one() -> None:
    with pytest.raises(ModelError, match=r"nearest admissible value is \(5, 12, 39\)"):
        rank((5, 12, 40))
    with pytest.raises(ModelError, match="nearest admissible value is 9138"):
        unrank(9139)
    with pytest.raises(ModelError, match="nearest admissible value is 1"):
        span_with_spacing(0)


# --- thinned sets ----------------------------------------------------------------------------------------------------


def test_no_set_is_larger_than_247() -> None:
    assert most_codes() == 39 * 38 // 6 == 247


def test_sharing_one_slot_at_most_is_not_enough() -> None:
    plain = bose()
    assert (len(plain), pairwise(plain)) == (247, 1)
    assert ((13, 26, 39), (1, 14, 27)) in undetected(plain)
    own = frozenset({(10, 20, 30), (1, 2, 3)})
    assert undetected(own) == [((10, 20, 30), (10, 20, 30))]


def test_every_pair_of_slots_is_in_one_code() -> None:
    for codes in (bose(), bose(TURNED)):
        held = Counter(pair for code in codes for pair in itertools.combinations(code, 2))
        assert len(held) == 741 and set(held.values()) == {1}


def test_turned_set_detects_every_loss_with_an_insertion_and_tells_the_direction() -> None:
    codes = bose(TURNED)
    assert (len(codes), pairwise(codes), undetected(codes), both_ways(codes)) == (247, 1, [], [])
    assert all(not (wrong_readings(code) & codes) for code in codes)
    assert all(mirror(code) not in codes for code in codes)


def test_largest_parts_of_the_plain_system() -> None:
    plain = bose()
    part, directed = largest_part(plain), largest_part(plain, directed=True)
    assert (len(part), undetected(part)) == (243, [])
    assert (len(directed), undetected(directed), both_ways(directed)) == (237, [], [])


def test_a_planted_code_is_noticed() -> None:
    codes = bose(TURNED)
    one = min(codes)
    assert undetected(codes | {next(substituted(one))})
    assert both_ways(codes | {mirror(one)})
    assert shared(one, next(substituted(one))) == 2


def test_extra_balise_anywhere() -> None:
    two = frozenset({(2, 25, 32), (1, 3, 25)})
    assert two <= bose(TURNED) and ((2, 25, 32), (1, 3, 25)) in misread(two, Fraction("0.01"))
    assert all(code == seen for code, seen in misread(two, Fraction("0.004")))
    seen_on_slots = undetected(bose())
    some = frozenset(code for pair in seen_on_slots for code in pair)
    assert {*seen_on_slots} <= misread(some, Fraction("0.004"))


def misread(codes: CodeSet, eps: Fraction) -> set[tuple[Code, Code]]:
    """Codes and what they can be read as, at a scale error."""
    return {(each.code, each.read) for each in undetected_anywhere(codes, Tolerances(eps=eps))}


def test_own_code_with_an_origin_that_is_off() -> None:
    """The first balise lost, an extra one 0.2 m before its place: foreseen for every code, by more than e."""
    eps = Fraction("0.004")
    own = [x for x in undetected_anywhere(bose(TURNED), Tolerances(eps=eps)) if x.code == x.read]
    assert len(own) == 247 and all(x.off >= Fraction("0.3") for x in own)
    assert max(x.off for x in own) == Fraction(517, 830)


# --- one fault, every slot -------------------------------------------------------------------------------------------


EXTRAS = [1 << (extra + 80) for extra in range(-44, 85)]  # at every slot near a group, its own ones included


def test_ap_6_one_fault_at_every_slot_of_every_code() -> None:
    for code in ALL:
        own, right = group(code), [(0, code)]
        assert list(read(own)) == right
        assert all(not list(read(group(code, lost=slot))) for slot in (0, *code, 40))
        assert all(found == right or not found for found in (list(read(own | extra)) for extra in EXTRAS))


def test_ap_6_without_the_guard_every_code_has_one_such_place() -> None:
    for code in ALL:
        own, right = group(code), [(0, code)]
        found = {extra: list(read(own | extra, guarded=False)) for extra in EXTRAS}
        assert [extra for extra, seen in found.items() if seen not in ([], right)] == [1 << (code[2] + 40)]
    assert list(read(group(EXAMPLE, -10), guarded=False)) == [(-10, (10, 15, 22))]


def test_ap_7_loss_and_insertion_at_every_slot() -> None:
    for code in (EXAMPLE, (1, 20, 39), (13, 26, 39)):
        inside = {
            seen
            for lost in code
            for extra in range(1, 40)
            if extra not in code
            for _, seen in read(group(code, extra, lost))
        }
        assert inside == {*substituted(code)}
        before, behind = group(code, code[2] - 40, 40), group(code, 40 + code[0], 0)
        assert [seen for _, seen in read(before)] == [rotations(code)[0]]
        assert [seen for _, seen in read(behind)] == [rotations(code)[1]]


def test_ap_8_reading_backwards_is_the_mirror() -> None:
    for code in ALL[::100]:
        assert list(read(group(mirror(code)))) == [(0, mirror(code))]
    assert code_sets.both_ways(frozenset(ALL)) and len(both_ways(frozenset(ALL))) == 4560 + 19


def test_random_losses_with_an_insertion_are_among_the_readings_found() -> None:
    """Balises anywhere, jitter and scale drawn; what the span check and u_tol let pass was foreseen."""
    chance, allowed, seen = random.Random(39), Tolerances(), 0
    slack = float(40 * allowed.eps + 2 * allowed.e * (1 + allowed.eps))
    for _ in range(2000):
        code = unrank(chance.randrange(CODES))
        left = list((0, *code, 40))
        del left[chance.randrange(5)]
        extra = chance.choice([left[-1] - 40 + chance.uniform(-1.2, 1.2), left[0] + 40 + chance.uniform(-1.2, 1.2)])
        places = sorted([*(place + chance.choice((-0.1, 0.1)) for place in left), extra])
        *inner, span = (place - places[0] for place in places[1:])
        scale = chance.choice((0.99, 1.01))
        slots = [40 * place / span for place in inner]
        near = all(abs(slot - round(slot)) <= 0.25 and 1 <= round(slot) <= 39 for slot in slots)
        if near and abs(scale * span - 40) <= slack and len({*map(round, slots)}) == 3:
            seen += 1
            assert any({*each.slots} <= {*map(round, slots)} for each in misreadings(code, allowed))
    assert seen > 100

"""A use without a meaning in every reading raises `TermError`, which names the signal and says what to write."""

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from safety.terms import Bit, TermError, all_of, any_of, at_least, bit, count, implies, real, select, word
from safety.terms.direct import evaluate
from safety.terms.graph import BIT, REAL, integer, uint, variable
from safety.terms.smt import Encoder
from safety.terms.texts import compile_python
from tests.terms.agreement import READINGS, check

TRIP: Any = variable("a.trip", BIT)
REF: Any = variable("a.ref", BIT)
ACC: Any = variable("a.acc", uint(8))
LIMIT: Any = variable("limit", uint(8))
D: Any = variable("a.d", uint(4))
DIFF: Any = variable("diff", integer(-9, 9))
PHASE: Any = variable("phase", REAL)


def decide(x: Any) -> None:
    if x:
        pass


def repeat(x: Any) -> None:
    while x:
        pass


def confirm(x: Any) -> None:
    assert x


def loop(x: Any) -> None:
    for _ in x:
        pass


def match(x: Any) -> None:
    match x:
        case 3:
            pass


TRUTH = {
    "if": lambda: decide(TRIP),
    "if on a comparison": lambda: decide(ACC > 3),
    "if on a constant": lambda: decide(bit(True)),
    "while": lambda: repeat(TRIP),
    "and": lambda: TRIP and REF,
    "or": lambda: TRIP or REF,
    "not": lambda: not TRIP,
    "assert": lambda: confirm(ACC == LIMIT),
    "a number as a condition": lambda: decide(ACC),
    "choice": lambda: 1 if TRIP else 0,
    "chained comparison": lambda: 3 < ACC < 9,
    "in a list": lambda: ACC in [1, 2],
    "in a word": lambda: 1 in ACC,
    "max": lambda: max(ACC, LIMIT),
    "min": lambda: min(ACC, 3),
    "max of bits": lambda: max(TRIP, REF),
    "sorted": lambda: sorted([ACC, LIMIT]),
    "any": lambda: any([TRIP, REF]),
    "all": lambda: all([TRIP, REF]),
    "match": lambda: match(ACC),
    "for": lambda: loop(ACC),
    "for on a bit": lambda: loop(TRIP),
    "unpacking": lambda: [*ACC],
    "len": lambda: len(ACC),
    "indexing": lambda: ACC[3],
    "slicing": lambda: ACC[0:3],
    "as an index": lambda: [1, 2, 3][ACC],
    "range": lambda: range(ACC),
    "int": lambda: int(ACC),
    "float": lambda: float(PHASE),
    "hex": lambda: hex(ACC),
    "round": lambda: round(PHASE),
    "floor": lambda: math.floor(PHASE),
    "abs": lambda: abs(DIFF),
}

ARITHMETIC = {
    "bit + number": lambda: TRIP + 1,
    "number + bit": lambda: 1 + TRIP,
    "sum of bits": lambda: sum([TRIP, REF]),
    "bit + bit": lambda: TRIP + REF,
    "bit - bit": lambda: TRIP - REF,
    "bit * number": lambda: TRIP * 3,
    "-bit": lambda: -TRIP,
    "bit << 1": lambda: TRIP << 1,
    "bit < bit": lambda: TRIP < REF,
    "bit == number": lambda: TRIP == 1,
    "bit == word": lambda: TRIP == ACC,
    "bit & number": lambda: TRIP & 1,
    "bit & word": lambda: TRIP & ACC,
    "word & bit": lambda: ACC & TRIP,
    "word + bit": lambda: ACC + TRIP,
    "bit + word": lambda: TRIP + ACC,
    "word == bit": lambda: ACC == TRIP,
    "word < bit": lambda: ACC < TRIP,
    "word + True": lambda: ACC + True,
    "word == True": lambda: ACC == True,  # noqa: E712
    "word & True": lambda: ACC & True,
    "True + word": lambda: True + ACC,
    "word + float": lambda: ACC + 0.5,
    "real * float": lambda: PHASE * 0.5,
    "real < float": lambda: PHASE < 0.5,
    "real / float": lambda: PHASE / 0.5,
    "word + text": lambda: ACC + "1",
    "word == None": lambda: ACC == None,  # noqa: E711
    "NumPy integer": lambda: np.int64(3) + ACC,
    "word beside a NumPy integer": lambda: ACC + np.int64(3),
    "NumPy bool": lambda: np.bool_(True) & TRIP,
    "NumPy array": lambda: np.array([1, 2]) + ACC,
    "word + negative": lambda: ACC + -1,
    "negative + word": lambda: -1 + ACC,
    "word * negative": lambda: ACC * -2,
    "word & negative": lambda: ACC & -1,
    "word & wider constant": lambda: ACC & 0x1FF,
    "-word": lambda: -ACC,
    "width mismatch": lambda: ACC & D,
    "width mismatch or": lambda: ACC | D,
    "width mismatch xor": lambda: ACC ^ D,
    "word & integer": lambda: ACC & DIFF,
    "integer & number": lambda: DIFF & 3,
    "~integer": lambda: ~DIFF,
    "~real": lambda: ~PHASE,
    "integer >> 1": lambda: DIFF >> 1,
    "word // 0": lambda: ACC // 0,
    "word % 0": lambda: ACC % 0,
    "word // negative": lambda: ACC // -2,
    "word // word": lambda: ACC // LIMIT,
    "word % word": lambda: ACC % LIMIT,
    "number // word": lambda: 100 // ACC,
    "number % word": lambda: 100 % ACC,
    "word / number": lambda: ACC / 2,
    "number / word": lambda: 1 / ACC,
    "integer // number": lambda: DIFF // 2,
    "integer % number": lambda: DIFF % 2,
    "integer / number": lambda: DIFF / 2,
    "real / 0": lambda: PHASE / 0,
    "real / real": lambda: PHASE / PHASE,
    "number / real": lambda: 1 / PHASE,
    "real // number": lambda: PHASE // 2,
    "word ** 2": lambda: ACC**2,
    "2 ** word": lambda: 2**ACC,
    "divmod": lambda: divmod(ACC, 3),
    "1 << word": lambda: 1 << ACC,
    "word << word": lambda: ACC << D,
    "word << negative": lambda: ACC << -1,
    "word >> all": lambda: ACC >> 8,
}

PARTS = {
    "bit out of range": lambda: ACC.bit(8),
    "negative bit": lambda: ACC.bit(-1),
    "bit by a term": lambda: ACC.bit(D),
    "bit by a bool": lambda: ACC.bit(True),
    "slice out of range": lambda: ACC.slice(4, 5),
    "slice from below": lambda: ACC.slice(-1, 3),
    "empty slice": lambda: ACC.slice(3, 0),
    "slice by a term": lambda: ACC.slice(D, 2),
    "low of no bits": lambda: ACC.low(0),
    "low by a term": lambda: ACC.low(D),
    "low of no bits of an integer": lambda: DIFF.low(0),
    "widen that cuts": lambda: ACC.widen(4),
    "widen by a bool": lambda: D.widen(True),
    "saturation to no bits": lambda: ACC.sat(0),
    "saturation of an integer": lambda: DIFF.sat(-1),
    "clip the wrong way": lambda: DIFF.clip(3, -3),
    "clip by a term": lambda: DIFF.clip(0, ACC),
    "concat with a bit": lambda: ACC.concat(TRIP),
    "concat with a number": lambda: ACC.concat(3),
    "select by a word": lambda: select(ACC, 1, LIMIT),
    "select by a number": lambda: select(1, ACC, LIMIT),
    "select with different widths": lambda: select(TRIP, ACC, D),
    "select that would wrap": lambda: select(TRIP, ACC + 1, ACC),
    "select of bit and word": lambda: select(TRIP, REF, ACC),
    "select of bit and number": lambda: select(TRIP, REF, 1),
    "select of word and True": lambda: select(TRIP, ACC, True),
    "select of word and too great a constant": lambda: select(TRIP, ACC, 256),
    "select of word and negative": lambda: select(TRIP, -1, ACC),
    "select of word and fraction": lambda: select(TRIP, ACC, Fraction(1, 2)),
    "select of real and float": lambda: select(TRIP, PHASE, 0.5),
    "select of constants": lambda: select(TRIP, 1, 0),
    "implies from a word": lambda: implies(ACC, TRIP),
    "implies to a number": lambda: implies(TRIP, 1),
    "count of words": lambda: count(TRIP, ACC),
    "votes of words": lambda: at_least(2, TRIP, ACC),
    "all_of a list": lambda: all_of([TRIP, REF]),
    "any_of a word": lambda: any_of(TRIP, ACC),
    "no value": lambda: evaluate([ACC], {}),
    "a value out of sort": lambda: evaluate([ACC], {ACC: 256}),
    "a bool for a word": lambda: evaluate([ACC], {ACC: True}),
    "a number for a bit": lambda: evaluate([TRIP], {TRIP: 1}),
    "a float for a real": lambda: evaluate([PHASE], {PHASE: 0.5}),
    "unbound": lambda: compile_python([], [ACC]),
    "real as bit-vector": lambda: Encoder("z3", integers=False)([PHASE < 1]),
    "name used twice": lambda: Encoder("z3", integers=True)([ACC, variable("a.acc", uint(9))]),
}

NAMES = ("a.trip", "a.ref", "a.acc", "limit", "a.d", "diff", "phase", "True", "name")
ADVICE = ("write", "bring", "divided by", "is a whole constant", "has bits", "give", "not a value of it", "shift by")
ADVICE += ("bound", "low first", "prove it", "widen")


def _refused(use: Callable[[], object]) -> str:
    with pytest.raises(TermError) as refusal:
        use()
    return str(refusal.value)


@pytest.mark.parametrize(
    "use", [*TRUTH.values(), *ARITHMETIC.values(), *PARTS.values()], ids=[*TRUTH, *ARITHMETIC, *PARTS]
)
def test_misuse_names_the_signal_and_says_what_to_write(use: Callable[[], object]) -> None:
    message = _refused(use)
    assert any(name in message for name in NAMES), message
    assert any(advice in message for advice in ADVICE), message
    assert "<" not in message.replace("<<", "").replace(" < ", "").replace("<=", ""), f"a bare repr: {message}"


@pytest.mark.parametrize(
    ("use", "remedy"),
    [
        (lambda: decide(TRIP), "a.trip is a bit signal"),
        (lambda: decide(TRIP), "write select(...), &, |, ~ or implies(...)"),
        (lambda: TRIP + 1, "write .word() to count it as 0 or 1, or count(...)"),
        (lambda: ACC + TRIP, "write a.trip.word()"),
        (lambda: ACC & D, ".low(n) (cuts) or .widen(n) (zeros)"),
        (lambda: ACC + -1, "write a.acc - 1"),
        (lambda: ACC + 0.5, "write Fraction('0.5')"),
        (lambda: ACC.bit(8), "a.acc: u8 has bits 0..7, not bit 8"),
        (lambda: ACC.slice(4, 5), "has bits 0..7, not bits 4..8"),
        (lambda: ACC.widen(4), "write .low(4) or .sat(4)"),
        (lambda: ACC // LIMIT, "a divisor is a whole constant from 1 up, not limit: u8"),
        (lambda: select(TRIP, ACC + 1, ACC), "(a.acc + 1): u9, a.acc: u8): width mismatch"),
        (lambda: all_of([TRIP]), "write all_of(*bits)"),
        (lambda: 1 in ACC, "write (x == a) | (x == b)"),
    ],
)
def test_misuse_says(use: Callable[[], object], remedy: str) -> None:
    assert remedy in _refused(use)


@pytest.mark.parametrize(
    "make",
    [
        lambda: word(256, 8),
        lambda: word(-1, 8),
        lambda: word(True, 1),
        lambda: word(3, 0),
        lambda: word(3, True),
        lambda: word(2.0, 8),
        lambda: word(ACC, 9),
        lambda: bit(1),
        lambda: real(0.1),
        lambda: real("one"),
        lambda: real("1/0"),
        lambda: real(True),
        lambda: real(PHASE),
        lambda: uint(0),
        lambda: uint(2.0),
        lambda: integer(3, 2),
        lambda: integer(0, True),
        lambda: integer(0.0, 1),
        lambda: count(),
        lambda: Encoder("yices", integers=True),
    ],
)
def test_a_constant_out_of_its_sort_is_refused(make: Callable[[], object]) -> None:
    assert _refused(make)


# --- what is meant instead -----------------------------------------------------------------------------------------


def test_equality_is_a_bit_and_hashing_is_by_identity() -> None:
    assert isinstance(ACC == LIMIT, Bit)
    assert isinstance(ACC != 3, Bit)
    assert isinstance(TRIP == REF, Bit)
    assert hash(ACC) == object.__hash__(ACC)
    assert {ACC: 1, LIMIT: 2}[LIMIT] == 2
    assert len({ACC + 1, ACC + 1, ACC + 2}) == 2


def test_equal_structure_is_the_same_object() -> None:
    assert (ACC + LIMIT).low(8) is (ACC + LIMIT).low(8)
    assert (ACC > LIMIT) is (LIMIT < ACC)
    assert variable("a.acc", uint(8)) is ACC
    assert (ACC + LIMIT) is not (LIMIT + ACC)


@pytest.mark.parametrize("reading", READINGS)
def test_nothing_unsigned_is_compared_signed(reading: str) -> None:
    outputs = [ACC > LIMIT, ACC >= LIMIT, LIMIT < ACC, ACC > 10, ACC < D, ACC > DIFF, ACC.sat(4) > 3]
    values = {ACC: 200, LIMIT: 10, D: 15, DIFF: -9}
    assert evaluate(outputs, values) == [True, True, True, True, False, True, True]
    check(reading, outputs, [values])


@pytest.mark.parametrize("reading", READINGS)
def test_comparison_across_widths_is_exact(reading: str) -> None:
    wide = (ACC + LIMIT) * 256
    outputs = [
        wide == ACC,
        wide > ACC,
        ACC == 256 + 200,
        ACC < 2**70,
        ACC == -56,
        ACC > -1,
        ACC - LIMIT == -55,
        D == ACC,
    ]
    values = {ACC: 200, LIMIT: 255, D: 8}
    assert evaluate(outputs, values) == [False, True, False, True, False, True, True, False]
    check(reading, outputs, [values])


@pytest.mark.parametrize("reading", READINGS)
def test_nothing_wraps_unless_it_is_written(reading: str) -> None:
    outputs = [ACC + LIMIT, (ACC + LIMIT).low(8), (ACC + LIMIT).bit(8), (ACC + LIMIT).sat(8), ACC * LIMIT, LIMIT - ACC]
    outputs += [LIMIT.sat_sub(ACC), ACC.sat_sub(LIMIT), (LIMIT - ACC).low(8), 0 - ACC, ACC << 3, ACC >> 3, ~ACC]
    values = {ACC: 200, LIMIT: 100}
    assert evaluate(outputs, values) == [300, 44, True, 255, 20_000, -100, 0, 100, 156, -200, 1600, 25, 55]
    check(reading, outputs, [values])


@pytest.mark.parametrize("wires", range(1, 10))
def test_count_is_just_wide_enough(wires: int) -> None:
    bits: list[Any] = [variable(f"w{i}", BIT) for i in range(wires)]
    total = count(*bits)
    assert total.width == wires.bit_length()
    for true in range(wires + 1):
        values = {b: i < true for i, b in enumerate(bits)}
        outputs = [total, *(at_least(k, *bits) for k in range(wires + 2))]
        assert evaluate(outputs, values) == [true, *(true >= k for k in range(wires + 2))]

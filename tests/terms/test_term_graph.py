"""The graph: one object per structure, nothing kept alive, no recursion; sources and traversals at bound terms."""

import copy
import gc
import pickle
from fractions import Fraction
from typing import Any

from safety.terms import bit, real, select, word
from safety.terms.construct import build
from safety.terms.direct import evaluate
from safety.terms.graph import BIT, REAL, Term, describe, graph_size, integer, node, postorder, rewrite, uint, variable
from safety.terms.smt import Encoder
from safety.terms.texts import compile_lanes, compile_python
from safety.terms.values import const

A: Any = variable("a", uint(8))
B: Any = variable("b", uint(8))
P: Any = variable("p", BIT)


def test_constants_of_different_sorts_are_different_terms() -> None:
    ones = [bit(True), word(1, 1), word(1, 2), const(1, integer(0, 1)), const(1, integer(1, 1)), real(1)]
    assert len({id(one) for one in ones}) == len(ones)
    assert [type(one.attr) for one in ones] == [bool, int, int, int, int, Fraction]
    assert real(1) is real(Fraction(1)) is real("1.0")


def test_sorts_with_the_same_values_are_different_sorts() -> None:
    x = [variable("x", sort) for sort in (BIT, uint(1), integer(0, 1), REAL)]
    assert len({id(term) for term in x}) == 4
    assert len({term.sort for term in x}) == 4


def test_nothing_keeps_an_unused_term_alive() -> None:
    gc.collect()
    before = graph_size()
    term = A
    for i in range(1_000):
        term = (term + i).low(8)
    assert graph_size() > before + 1_000
    del term
    gc.collect()
    assert graph_size() == before


def test_a_very_deep_term_is_made_walked_and_freed_without_recursion() -> None:
    before = graph_size()
    p = P
    for _ in range(200_000):
        p = node("xor", (p, P), None, BIT)
    assert len(postorder([p])) == 200_001
    del p
    gc.collect()
    assert graph_size() == before


def test_a_term_made_again_after_it_died_is_new_and_consistent() -> None:
    uid = (A * 77).uid
    gc.collect()
    again = A * 77
    assert again.uid != uid
    assert again is A * 77


def test_a_copy_and_a_pickle_are_the_term_itself() -> None:
    term = select(P, A + B, (A * 3).low(9))
    assert copy.copy(term) is term
    assert copy.deepcopy([term])[0] is term
    assert pickle.loads(pickle.dumps(term)) is term


def test_a_point_stays_even_on_a_constant() -> None:
    held = build("point", (word(3, 8),), "held", uint(8))
    assert held.op == "point"
    rebuilt = rewrite([held + A], lambda old, args: build(old.op, args, old.attr, old.sort) if args else old)[0]
    assert rebuilt is held + A


def test_postorder_stops_at_what_is_known() -> None:
    inner = A + B
    inner_low = inner.low(8)
    outer = inner_low ^ A
    assert [t.uid for t in postorder([outer], {inner.uid})] == [inner_low.uid, A.uid, outer.uid]


def test_a_bound_term_hides_what_it_was_made_of() -> None:
    inner = A + B
    outer = (inner * 2).low(8)
    assert evaluate([outer], {inner: 300}) == [600 % 256]
    assert compile_python([inner], [outer])(300) == (600 % 256,)
    encoder = Encoder("z3", integers=True)
    encoder.bind(inner, encoder.k.IntVal(300))
    encoder([outer])
    assert encoder.ranges == []


def test_constant_outputs_fill_every_lane() -> None:
    outputs: list[Term] = [bit(True), word(3, 8), word(2**70, 71), real("1/3"), A]
    import numpy as np

    results = compile_lanes([A], outputs)(np.arange(4))
    assert [(r.shape, r.dtype.name) for r in results] == [
        ((4,), n) for n in ("bool", "int64", "object", "object", "int64")
    ]
    assert [r[2] for r in results] == [True, 3, 2**70, Fraction(1, 3), 2]


def test_terms_are_described_as_they_are_written() -> None:
    texts = {
        "(a + b)": A + B,
        "(a + b).bit(8)": (A + B).bit(8),
        "(a * b).low(4)": (A * B).low(4),
        "a.slice(1, 3)": A.slice(1, 3),
        "a.sat(4)": A.sat(4),
        "(a - b).clip(-3, 3)": (A - B).clip(-3, 3),
        "(a // 3)": A // 3,
        "(a % 3)": A % 3,
        "~p": ~P,
        "select(p, a, b)": select(P, A, B),
        "(b < a)": A > B,
        "((... + b) + a)": ((A + B + 1) + B) + A,
    }
    assert {describe(term, depth=2) for term in texts.values()} == set(texts)

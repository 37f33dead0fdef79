"""Minimal cut sequences against every order of failures, tried one by one."""

from itertools import combinations, permutations

import pytest

from safety.trees import TooLarge
from safety.trees.as_written import TreeError
from safety.trees.dynamic.sequences import cut_sequences
from safety.trees.formats.galileo import read_galileo
from tests.trees.failure_orders import Past, _after, _begin, _settled
from tests.trees.random_dynamic import random_dynamic


def sequences(text, **more):
    return {row.events: row.orders for row in cut_sequences(read_galileo(text.encode(), "test.dft"), **more)}


def test_readable_examples():
    text = "toplevel T; T or P S; P pand A B; S csp C D; A lambda=1; B lambda=1; C lambda=1; D lambda=1;"
    assert sequences(text) == {("A", "B"): (("A", "B"),), ("C", "D"): (("C", "D"),)}
    text = "toplevel T; T or P X; P and A B; F fdep C A B; A lambda=1; B lambda=1; C lambda=1; X lambda=1;"
    assert sequences(text) == {("A", "B"): (("A", "B"), ("B", "A")), ("C",): (("C",),), ("X",): (("X",),)}
    (row,) = cut_sequences(read_galileo(b"toplevel T; T and A B C; A lambda=1; B lambda=1; C lambda=1;", ""))
    assert row.any_order and len(row.orders) == 6
    assert sequences("toplevel T; T and A B C; A lambda=1; B lambda=1; C lambda=1;", longest=2) == {}
    assert sequences("toplevel T; T or A B; A prob=1; B lambda=1;") == {(): ((),)}


def suffices(tree, order):
    """Whether the events, failing in this order and no others in between, can make the top fail."""
    names = [event.name for event in tree.events]

    def onward(past: Past, left):
        if tree.top in past.failed:
            return not left
        if not left or left[0] in past.failed:
            return False
        event = tree.nodes[left[0]]
        can = event.rate_per_hour and (left[0] in past.active or event.dormancy)
        after = _after(tree, past, [left[0]]) if can else None
        return after is not None and any(
            chance and onward(later, left[1:]) for later, chance in _settled(tree, after, names)
        )

    return any(chance and onward(past, list(order)) for past, chance in _begin(tree, names))


@pytest.mark.parametrize("seed", range(60))
def test_equal_to_every_order_tried(seed):
    tree = random_dynamic(seed, 4)
    names = [event.name for event in tree.events]
    try:
        enough = {order for size in range(5) for order in permutations(names, size) if suffices(tree, order)}
    except TreeError:
        pytest.skip("impossible at time 0")
    minimal = {o for o in enough if not any(part in enough for n in range(len(o)) for part in combinations(o, n))}
    assert {order for row in cut_sequences(tree) for order in row.orders} == minimal


def test_too_many_orders_is_an_error_with_a_way_out(monkeypatch):
    monkeypatch.setattr("safety.trees.dynamic.sequences.MOST", 5)
    with pytest.raises(TooLarge, match="ask for shorter sequences"):
        sequences("toplevel T; T and A B C; A lambda=1; B lambda=1; C lambda=1;")

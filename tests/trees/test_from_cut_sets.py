"""A tree drawn from cut sets has just these cut sets, and shows what they share."""

import itertools
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety.trees import BasicEvent, FaultTree, Gate, TreeError, from_cut_sets, solve


def drawn(sets, names=None):
    names = names or sorted({name for cut_set in sets for name in cut_set})
    return from_cut_sets("hazard", sets, [BasicEvent(name, "1/10") for name in names])


def cut_sets_of(tree):
    return {frozenset(cut_set) for cut_set in solve(tree).cut_sets()}


FAMILIES = st.sets(st.frozensets(st.sampled_from("abcdefgh"), max_size=4), max_size=20).map(
    lambda sets: {s for s in sets if not any(other < s for other in sets)}
)


@settings(max_examples=200, deadline=None)
@given(FAMILIES)
def test_the_tree_has_exactly_these_cut_sets(sets):
    assert cut_sets_of(drawn(sets, "abcdefgh")) == sets


@settings(max_examples=50, deadline=None)
@given(FAMILIES, st.randoms())
def test_the_order_of_the_sets_does_not_matter(sets, chance):
    shuffled = sorted(sets, key=lambda _: chance.random())
    assert drawn(sets, "abcdefgh") == drawn([sorted(s, key=lambda _: chance.random()) for s in shuffled], "abcdefgh")


def test_three_channels_show_as_a_vote_over_three_channels():
    channel = {c: [f"{c}.counter", f"{c}.oscillator"] for c in ("ch_a", "ch_b", "ch_c")}
    sets = [pair for x, y in itertools.combinations(channel.values(), 2) for pair in itertools.product(x, y)]
    tree = drawn([*sets, ["voter"]])
    assert tree.nodes["hazard"] == Gate("hazard", "or", ("voter", "any 2 of 3 together"))
    assert tree.nodes["any 2 of 3 together"] == Gate(
        "any 2 of 3 together", "vote", ("any of ch_a", "any of ch_b", "any of ch_c"), 2
    )
    assert tree.nodes["any of ch_b"].inputs == ("ch_b.counter", "ch_b.oscillator")
    assert drawn(sets).nodes["hazard"].kind == "vote"


def test_single_events_come_first_and_many_sets_of_one_order_stand_together():
    chain = [(f"e{i}", f"e{i + 1}") for i in range(10)]
    tree = drawn([*chain, ["z"]], [*(f"e{i}" for i in range(11)), "z"])
    assert tree.nodes["hazard"].inputs == ("z", "2 failures together")
    assert tree.nodes["2 failures together"].inputs[0] == "cut set 2.1"
    assert tree.nodes["cut set 2.1"].inputs == ("e0", "e1")


def test_a_hundred_and_fifty_sets():
    chance = random.Random(1)
    sets = set()
    while len(sets) < 150:
        sets.add(frozenset(chance.sample([f"e{i}" for i in range(18)], 3)))
    assert cut_sets_of(drawn(sets)) == sets


def test_names_that_are_taken_are_left_alone():
    tree = drawn([("a", "b"), ("b", "c"), ("a", "c"), ("any 2 of 3 together",)])
    assert isinstance(tree.nodes["any 2 of 3 together (2)"], Gate)


@pytest.mark.parametrize(("sets", "probability"), [([], 0), ([()], 1)])
def test_no_cut_set_and_no_failure_needed(sets, probability):
    tree = drawn(sets, "ab")
    assert isinstance(tree, FaultTree)
    assert solve(tree).exact == probability


def test_refused():
    with pytest.raises(TreeError, match=r"\['a', 'b'\] of \"hazard\" contains the cut set \['a'\]; give minimal"):
        drawn([("a", "b"), ("a",)])
    with pytest.raises(TreeError, match=r"contains the cut set \[\]"):
        drawn([("a", "b"), ()])
    with pytest.raises(TreeError, match=r'undefined event "x"; add it'):
        drawn([("a", "x")], "ab")

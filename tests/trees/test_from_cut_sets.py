"""A tree drawn from cut sets has just these cut sets, and shows what they share."""

import importlib
import itertools
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety.trees import BasicEvent, FaultTree, Gate, TreeError, from_cut_sets, solve
from safety.trees.drawn.factoring import factored, listed
from safety.trees.drawn.from_cut_sets import NotGivenBack
from safety.trees.drawn.names import subsystem


def drawn(sets, names=None):
    names = names or sorted({name for cut_set in sets for name in cut_set})
    return from_cut_sets("hazard", sets, [BasicEvent(name, "1/10") for name in names])


def cut_sets_of(tree):
    return {frozenset(cut_set) for cut_set in solve(tree).cut_sets()}


FAMILIES = st.sets(st.frozensets(st.sampled_from("abcdefgh"), max_size=4), max_size=20).map(
    lambda sets: {s for s in sets if not any(other < s for other in sets)}
)


def flat_gates(sets):
    """How many gates the plain list takes: the top, and one for each set of two and more."""
    return 1 + sum(len(one) > 1 for one in sets)


@settings(max_examples=200, deadline=None)
@given(FAMILIES)
def test_the_tree_has_exactly_these_cut_sets_and_no_more_gates_than_their_list(sets):
    tree = drawn(sets, "abcdefgh")
    assert cut_sets_of(tree) == sets
    grouping = [gate for gate in tree.gates if gate.name.endswith("failures together")]
    assert len(tree.gates) - len(grouping) <= flat_gates(sets)


@settings(max_examples=50, deadline=None)
@given(FAMILIES, st.randoms())
def test_the_order_of_the_sets_does_not_matter(sets, chance):
    shuffled = sorted(sets, key=lambda _: chance.random())
    assert drawn(sets, "abcdefgh") == drawn([sorted(s, key=lambda _: chance.random()) for s in shuffled], "abcdefgh")


def pairs_of_channels(*events):
    """All pairs of an event of one channel and an event of another."""
    channel = {c: [f"{c}{event}" for event in events] for c in ("ch_a", "ch_b", "ch_c")}
    return [pair for x, y in itertools.combinations(channel.values(), 2) for pair in itertools.product(x, y)]


def test_three_channels_show_as_a_vote_over_three_channels():
    sets = pairs_of_channels(".counter", ".oscillator")
    tree = drawn([*sets, ["voter"]])
    vote = "2 of ch_a, ch_b, ch_c fail"
    assert tree.nodes["hazard"] == Gate("hazard", "or", ("voter", vote))
    assert tree.nodes[vote] == Gate(vote, "vote", ("ch_a fails", "ch_b fails", "ch_c fails"), 2)
    assert tree.nodes["ch_b fails"].inputs == ("ch_b.counter", "ch_b.oscillator")
    assert drawn(sets).nodes["hazard"].kind == "vote"


def test_what_two_faults_do_in_a_channel_is_part_of_that_channel():
    """A detector that is dead, with what it should have found: across orders 2, 3 and 4, still one vote."""
    silent = {c: [{f"{c}: no clock"}, {f"{c}: ring stuck", f"{c}: detector dead"}] for c in "abc"}
    sets = [x | y for a, b in itertools.combinations("abc", 2) for x in silent[a] for y in silent[b]]
    events = [BasicEvent(name) for name in sorted({name for one in sets for name in one})]
    tree = from_cut_sets("hazard", sets, events, titles={c: f"channel {c}" for c in "abc"})
    assert cut_sets_of(tree) == {frozenset(one) for one in sets}
    assert (tree.nodes["hazard"].kind, tree.nodes["hazard"].k) == ("vote", 2)
    assert tree.nodes["hazard"].inputs == ("channel a fails", "channel b fails", "channel c fails")
    assert tree.nodes["channel a fails"].inputs == ("a: no clock", "channel a: detector dead and ring stuck")
    assert len(tree.gates) == 7 < flat_gates(sets) == 13
    top = from_cut_sets("hazard", [*sets, {"voter"}], [*events, BasicEvent("voter")], titles={"a": "channel a"})
    assert top.nodes["hazard"].inputs == ("voter", "2 of channel a, b, c fail")
    named = from_cut_sets(
        "hazard", [*sets, {"voter"}], [*events, BasicEvent("voter")], titles={c: f"channel {c}" for c in "abc"}
    )
    assert named.nodes["hazard"].inputs == ("voter", "2 of the channels a, b, c fail")


def test_a_common_part_is_drawn_once():
    tree = drawn([("relay welded", x) for x in ("comparator at 0", "no clock", "ring stuck")])
    assert tree.gates == (
        Gate("hazard", "and", ("relay welded", "comparator at 0 or no clock or ring stuck")),
        Gate("comparator at 0 or no clock or ring stuck", "or", ("comparator at 0", "no clock", "ring stuck")),
    )
    both = drawn([*((x, y) for x in ("a", "b") for y in ("valve: 1", "valve: 2")), ["z"]])
    assert both.nodes["hazard"].inputs == ("z", "(a or b) and valve fails")


def test_a_part_in_many_sets_is_taken_out_of_what_has_no_modules():
    tree = drawn([("x", "p"), ("x", "q"), ("x", "r"), ("x", "s"), ("p", "q"), ("q", "r"), ("r", "s")])
    assert tree.nodes["hazard"].inputs == ("p and q", "x and (p or q or r or s)", "q and r", "r and s")
    assert len(tree.gates) == 6 < flat_gates(["pq"] * 7) == 8


def test_the_same_fault_in_two_parts_is_named_once():
    tree = drawn([("brake valve: fails to vent", "second brake valve: fails to vent"), ("z",)])
    assert tree.nodes["hazard"].inputs == ("z", "brake valve and second brake valve: fails to vent")


def test_long_lists_are_divided_by_sub_system():
    names = [*(f"counter 1: stage {i}" for i in range(5)), *(f"counter 2: stage {i}" for i in range(5)), "no clock"]
    tree = drawn([[name] for name in names])
    assert tree.nodes["hazard"].inputs == ("counter 1 fails", "counter 2 fails", "no clock")
    assert tree.nodes["counter 2 fails"].inputs == tuple(names[5:10])
    assert len(drawn([[name] for name in names[2:9]]).gates) == 1
    deep = drawn([[f"a.{part}.{i} stuck-at-0"] for part in ("ring", "latch") for i in "pqrst"])
    assert deep.nodes["hazard"].inputs == ("a.latch fails", "a.ring fails")


def test_a_long_name_says_which_parts_it_is_about():
    faults = [*(f"counter 2: stage {i} at 1" for i in range(4)), "generator open or short"]
    tree = drawn([*(pair for pair in itertools.product(faults, ("signal 1 always", "watchdog dead"))), ["z"]])
    name = "(a fault of counter 2 or generator open or short) and (signal 1 always or watchdog dead)"
    assert tree.nodes["hazard"].inputs == ("z", name)
    three = [f"{part}: some fault of the {part}" + " and so on" * 2 for part in ("coil", "test coil", "clock")]
    assert drawn([three, ["z"]]).nodes["hazard"].inputs == ("z", "clock, coil, test coil together")
    wide = drawn([(f"the {i}th of many events with a long name", "x") for i in range(7)])
    assert wide.nodes["hazard"].inputs == ("x", "any of 7 causes")


def test_many_sets_of_one_order_stand_together():
    chain = [(f"e{i}", f"e{i + 1}") for i in range(10)]
    tree = drawn([*chain, ["z"], ("u", "v", "w")], [*(f"e{i}" for i in range(11)), *"uvwz"])
    assert tree.nodes["hazard"].inputs == ("z", "2 failures together", "u and v and w")
    assert tree.nodes["2 failures together"].inputs[0] == "e0 and e1"
    assert tree.nodes["e0 and e1"].inputs == ("e0", "e1")


@pytest.mark.parametrize(
    ("event", "path"),
    [
        ("a: no clock", ("a",)),
        ("a.counter stuck-at-0", ("a",)),
        ("a.det.ring at 1", ("a", "det")),
        ("a.det: ring: open", ("a", "det")),
        ("counter 2: stage 0 at 1", ("counter 2",)),
        ("oscillator 1.5 % fast", ()),
        ("Ry-1 contact welded", ()),
    ],
)
def test_the_sub_system_of_an_event(event, path):
    assert subsystem(event) == path


@pytest.mark.parametrize(("count", "events", "order"), [(150, 18, 3), (600, 40, 3), (400, 60, 4)])
def test_hundreds_of_sets(count, events, order):
    """The last ones have no diagram of any use; the gates are multiplied out here, in another way."""
    chance = random.Random(count)
    sets = set()
    while len(sets) < count:
        sets.add(frozenset(chance.sample([f"e{i}" for i in range(events)], order)))
    tree = drawn(sets)
    assert len(tree.gates) <= flat_gates(sets)

    def has(name, chosen):
        gate = tree.nodes[name]
        if not isinstance(gate, Gate):
            return name in chosen
        return (any if gate.kind == "or" else all)(has(below, chosen) for below in gate.inputs)

    assert all(has("hazard", one) and not any(has("hazard", one - {event}) for event in one) for one in sets)
    for _ in range(300):
        some = set(chance.sample([f"e{i}" for i in range(events)], events // 3))
        assert has("hazard", some) == any(one <= some for one in sets)


def test_thousands_of_sets_without_any_order_are_listed_as_they_are():
    chance = random.Random(2)
    sets = {frozenset(chance.sample(range(200), 4)) for _ in range(2100)}
    assert factored(sets) == listed(sets)
    channels = [[frozenset({10 * c + i}) for i in range(10)] for c in range(16)]
    pairs = {x | y for a, b in itertools.combinations(channels, 2) for x in a for y in b}
    assert (len(pairs), factored(pairs).kind, factored(pairs).gates) == (12_000, "vote", 17)


def test_names_that_are_taken_are_left_alone():
    tree = drawn([("a", "b"), ("b", "c"), ("a", "c"), ("any 2 of a, b, c",)])
    assert isinstance(tree.nodes["any 2 of a, b, c (2)"], Gate)


@pytest.mark.parametrize("budgets", [None, (1,)])
@pytest.mark.parametrize("planted", [{0, 1}, {0}], ids=["too large a set", "one set missing"])
def test_a_tree_that_does_not_give_the_sets_back_is_never_handed_out(planted, budgets, monkeypatch):
    """Neither when the tree is solved, nor when it is multiplied out as its diagram is too large."""
    module = importlib.import_module("safety.trees.drawn.from_cut_sets")
    if budgets:
        monkeypatch.setattr(module, "BUDGETS", budgets)
    assert cut_sets_of(drawn([("a",), ("b", "c")])) == {frozenset("a"), frozenset("bc")}
    monkeypatch.setattr("safety.trees.drawn.factoring.factored", lambda sets: listed([frozenset(planted)]))
    with pytest.raises(NotGivenBack, match="has other minimal cut sets than the 2 that it was drawn from"):
        drawn([("a",), ("b", "c")])


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

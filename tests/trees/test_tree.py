"""What a fault tree refuses, and how it says so."""

from fractions import Fraction

import pytest

from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent, TreeError

A, B = BasicEvent("a", "1/3"), BasicEvent("b", 0.25)


def tree(*gates, events=(A, B), top="top", **more):
    return FaultTree("hazard", top, gates, events, **more)


REFUSED = {
    "cycle": (
        lambda: tree(Gate("top", "or", ("x", "a")), Gate("x", "and", ("y", "b")), Gate("y", "or", ("x",))),
        r'"hazard" has a cycle: x -> y -> x; .* break it',
    ),
    "own input": (lambda: tree(Gate("top", "or", ("top",))), r"cycle: top -> top"),
    "unreached cycle": (
        lambda: tree(Gate("top", "or", ("a",)), Gate("x", "or", ("y",)), Gate("y", "or", ("x",))),
        r"cycle: x -> y -> x",
    ),
    "undefined": (
        lambda: tree(Gate("top", "or", ("a", "c"))),
        r'gate "top" has the input "c", which is neither a gate nor an event .*; define it',
    ),
    "duplicate": (
        lambda: tree(Gate("top", "or", ("a",)), Gate("a", "or", ("b",))),
        r'"a" is defined 2 times .*; rename',
    ),
    "no top": (lambda: tree(Gate("x", "or", ("a",))), r'no gate "top" to be its top; name one of its gates'),
    "top is an event": (lambda: tree(Gate("x", "or", ("a",)), top="a"), r'no gate "a" to be its top'),
    "k too large": (
        lambda: Gate("v", "vote", ("a", "b"), 3),
        r'gate "v" \(vote\) has k = 3 of 2 inputs, .* from 1 to 2',
    ),
    "k zero": (lambda: Gate("v", "vote", ("a", "b"), 0), r"has k = 0 of 2 inputs"),
    "k missing": (lambda: Gate("v", "vote", ("a", "b")), r"has k = None"),
    "k superfluous": (lambda: Gate("o", "or", ("a", "b"), 1), r"has k = 1 but is no vote; remove k"),
    "no inputs": (lambda: Gate("o", "or", ()), r"has 0 inputs, expected at least 1"),
    "not of two": (lambda: Gate("n", "not", ("a", "b")), r"has 2 inputs, expected exactly 1"),
    "input twice": (lambda: Gate("o", "or", ("a", "a")), r'has the input "a" more than once'),
    "kind": (lambda: Gate("o", "maybe", ("a",)), r"is of kind 'maybe', expected one of and, or, vote, not, xor"),
    "probability above 1": (
        lambda: BasicEvent("a", 1.5),
        r'probability of basic event "a" is 1.5, expected between 0 and 1',
    ),
    "negative rate": (
        lambda: BasicEvent("a", rate_per_hour=-1),
        r'rate_per_hour of basic event "a" is -1, expected 0 or more',
    ),
    "rate beyond doubles": (
        lambda: BasicEvent("a", rate_per_hour="1e400"),
        r'rate_per_hour of basic event "a" is about 1e400, expected at most 1e\+150',
    ),
    "time beyond doubles": (
        lambda: tree(Gate("top", "or", ("a",)), events=(BasicEvent("a", rate_per_hour=1),), mission_time_h="1e151"),
        r'mission_time_h of basic event "a" is about 1e151, expected at most 1e\+150',
    ),
    "no number": (lambda: BasicEvent("a", "often"), r"is 'often', expected a number such as 0.01"),
    "not finite": (lambda: BasicEvent("a", float("nan")), r"is 'nan', expected a number"),
    "exponent": (lambda: BasicEvent("a", "1e-999999999"), r"expected a number"),
    "tag": (lambda: BasicEvent("a", source="X"), r"is 'X', expected P \(printed\), D \(derived\)"),
    "rate without a time": (
        lambda: tree(Gate("top", "or", ("a",)), events=(BasicEvent("a", rate_per_hour="1e-6"),)),
        r'"a" has a rate of 1e-06 per hour and no mission time; give it mission_time_h',
    ),
    "rate against probability": (
        lambda: BasicEvent("a", "1e-3", "1e-6", 10),
        r'"a" has probability 0.001, but its rate and mission time give 9.99995e-06; remove one',
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_with_value_place_expectation_and_next_action(case):
    build, message = REFUSED[case]
    with pytest.raises(TreeError, match=message):
        build()


def test_numbers_are_kept_as_written():
    assert [BasicEvent("a", p).probability for p in (0.1, "0.1", Fraction(1, 10), "1e-1")] == [Fraction(1, 10)] * 4


def test_a_printed_probability_may_stand_beside_the_rate_it_was_rounded_from():
    event = BasicEvent("a", "1.0e-3", "1e-6", 1000, source="P")
    assert event.chance == (1e-3, 0.999)


def test_the_largest_rate_and_time_have_a_probability():
    event = BasicEvent("a", rate_per_hour="1e150", mission_time_h="1e150")
    assert event.chance == (1, 0)
    assert 1 - 1e-12 < event.enclosure[0] <= event.enclosure[1] == 1


def test_the_mission_time_of_the_tree_is_for_events_without_their_own():
    events = (BasicEvent("a", rate_per_hour=1), BasicEvent("b", rate_per_hour=1, mission_time_h=2))
    found = tree(Gate("top", "or", ("a", "b")), events=events, mission_time_h="3.5")
    assert [event.mission_time_h for event in found.events] == [Fraction(7, 2), 2]


def test_inputs_come_first():
    gates = (
        Gate("top", "or", ("x", "h")),
        Gate("y", "or", ("a",)),
        Gate("x", "and", ("y", "b")),
        Gate("z", "or", ("a",)),
    )
    found = FaultTree("t", "top", gates, (A, B), (HouseEvent("h", False),))
    assert [gate.name for gate in found.inputs_first] == ["y", "x", "top"]

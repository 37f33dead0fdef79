"""Importance of gates, pairs and groups against the plain truth of every state of small trees."""

import itertools
import math
from dataclasses import replace
from fractions import Fraction

import pytest

from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent, TreeError, solve
from safety.trees.importance import gates as module
from safety.trees.importance.events import plain
from safety.trees.importance.gates import importance_of_gates
from safety.trees.importance.joint import differential_importance, joint_importance
from tests.trees.brute import Truth
from tests.trees.random_trees import random_tree

SEEDS = range(60)


def close(value, exact):
    """Both None, both infinite, or equal but for the rounding of a few operations (absolute, as terms cancel)."""
    if exact is None or exact == math.inf:
        return value == exact
    return abs(Fraction(value) - exact) <= Fraction(1, 10**12) * max(1, abs(exact))


def states(tree):
    """Every set of failed events with its probability."""
    events = [event for event in tree.events if event.probability]
    for flags in itertools.product((False, True), repeat=len(events)):
        failed = {event.name for event, flag in zip(events, flags, strict=True) if flag}
        yield failed, math.prod(e.probability if f else 1 - e.probability for e, f in zip(events, flags, strict=True))


def held(tree, gate, state):
    """The probability of the top with the gate replaced by a constant."""
    if gate == tree.top:
        return Fraction(state)
    gates = tuple(other for other in tree.gates if other.name != gate)
    houses = (*tree.house_events, HouseEvent(gate, state))
    return Truth(replace(tree, gates=gates, house_events=houses)).probability()


@pytest.mark.parametrize("seed", SEEDS)
def test_gates_of_random_trees(seed):
    tree = random_tree(seed, events=6)
    top = Truth(tree).probability()
    found = importance_of_gates(tree)
    assert set(found) == {gate.name for gate in tree.inputs_first}
    for name, measures in found.items():
        below = replace(tree, top=name)
        q = sum((chance for failed, chance in states(tree) if below.occurs(failed)), Fraction(0))
        both = sum(
            (chance for failed, chance in states(tree) if below.occurs(failed) and tree.occurs(failed)), Fraction(0)
        )
        p1, p0 = held(tree, name, True), held(tree, name, False)
        assert close(measures.probability, q) and close(measures.birnbaum, p1 - p0)
        expected = {
            "criticality": q * (p1 - p0) / top if top else None,
            "fussell_vesely": (top - p0) / top if top else None,
            "diagnostic": both / top if top else None,
            "risk_achievement_worth": p1 / top if top else None,
            "risk_reduction_worth": None if not top else top / p0 if p0 else math.inf,
            "top_given_gate": both / q if q else None,
        }
        for measure, exact in expected.items():
            assert close(getattr(measures, measure), exact), (name, measure, getattr(measures, measure), exact)


@pytest.mark.parametrize("seed", range(10))
def test_gates_asked_together_or_one_by_one(seed, monkeypatch):
    """Where a diagram for several gates would be too large, they are asked in fewer and fewer at a time."""
    tree = random_tree(seed, events=8)
    together = importance_of_gates(tree)
    monkeypatch.setattr(module, "SHARED_BUDGETS", (2,))
    by_one = importance_of_gates(tree)
    for name, measures in together.items():
        for measure, value in plain(measures).items():
            other = plain(by_one[name])[measure]
            assert value == other or value == pytest.approx(other, rel=1e-12, abs=1e-15), (name, measure)


def test_a_gate_that_shares_nothing_is_like_an_event():
    events = tuple(BasicEvent(name, Fraction(n, 100)) for n, name in enumerate("abcd", 1))
    gates = Gate("top", "or", ("g", "h")), Gate("g", "and", ("a", "b")), Gate("h", "and", ("c", "d"))
    tree = FaultTree("t", "top", gates, events)
    gate = importance_of_gates(tree, ["g"])["g"]
    as_event = FaultTree(
        "t", "top", (Gate("top", "or", ("g", "h")), tree.gates[2]), (*events[2:], BasicEvent("g", Fraction(2, 10**4)))
    )
    event = solve(as_event).importance()["g"]
    for measure in ("birnbaum", "criticality", "fussell_vesely", "diagnostic", "risk_achievement_worth"):
        assert getattr(gate, measure) == pytest.approx(getattr(event, measure), rel=1e-12)
    assert gate.top_given_gate == 1 and plain(gate)["gate"] == "g"


def test_a_gate_that_is_needed_has_infinite_worth_and_says_so_in_json():
    gates = Gate("top", "and", ("g", "a")), Gate("g", "or", ("a", "b"))
    tree = FaultTree("t", "top", gates, tuple(BasicEvent(name, 0.5) for name in "ab"))
    gate = importance_of_gates(tree, ["g"])["g"]
    assert plain(gate)["risk_reduction_worth"] == "inf"
    assert (gate.criticality, gate.fussell_vesely) == (0.75, 1.0)  # differ, as a is also an input of the top


@pytest.mark.parametrize("seed", SEEDS)
def test_pairs_and_groups_of_random_trees(seed):
    tree = random_tree(seed, events=7)
    solution, truth = solve(tree), Truth(tree)
    for pair in joint_importance(solution):
        a, b = pair.events
        at = {(i, j): truth.probability({a: Fraction(i), b: Fraction(j)}) for i in (0, 1) for j in (0, 1)}
        assert close(pair.joint, at[1, 1] - at[1, 0] - at[0, 1] + at[0, 0]), pair
    slopes = {
        e.name: truth.probability({e.name: Fraction(1)}) - truth.probability({e.name: Fraction(0)}) for e in tree.events
    }
    moved = {e.name: slopes[e.name] * e.probability for e in tree.events}
    names = [event.name for event in tree.events]
    groups = [(name,) for name in names] + [names[: len(names) // 2 + 1]]
    for group, found in zip(groups, differential_importance(solution, groups), strict=True):
        for changes, value in ((slopes, found.differential), (moved, found.differential_relative)):
            whole = sum(changes.values())
            if whole == 0:
                assert value is None
            elif abs(whole) > Fraction(1, 1000):  # else what is left of a non-coherent tree's sum has lost its digits
                assert close(value, sum(changes[name] for name in group) / whole)


def test_differential_importance_adds_up():
    solution = solve(random_tree(1, events=8, coherent=True))
    single = differential_importance(solution)
    (everything,) = differential_importance(solution, [solution.events])
    assert sum(one.differential for one in single) == pytest.approx(1) == everything.differential
    assert sum(one.differential_relative for one in single) == pytest.approx(1) == everything.differential_relative


def test_the_largest_pair_comes_first():
    events = tuple(BasicEvent(name, Fraction(1, 10)) for name in "abc")
    tree = FaultTree("t", "top", (Gate("top", "or", ("both", "c")), Gate("both", "and", ("a", "b"))), events)
    pairs = {pair.events: pair.joint for pair in joint_importance(solve(tree))}
    assert pairs == pytest.approx({("a", "b"): 0.9, ("a", "c"): -0.1, ("b", "c"): -0.1})
    assert next(iter(pairs)) == ("a", "b")


def test_what_cannot_be_asked():
    tree = FaultTree("t", "top", (Gate("top", "or", ("a", "b")),), (BasicEvent("a"), BasicEvent("b", 0.5)))
    with pytest.raises(TreeError, match='"a" has no probability'):
        importance_of_gates(tree)
    for ask in (joint_importance, differential_importance):
        with pytest.raises(TreeError, match='"a" has no probability'):
            ask(solve(tree))
    known = replace(tree, events=(BasicEvent("a", 0.5), BasicEvent("b", 0.5)))
    with pytest.raises(TreeError, match='has no gate "a"'):
        importance_of_gates(known, ["a"])
    with pytest.raises(TreeError, match='has no basic event "top"'):
        joint_importance(solve(known), ["a", "top"])
    with pytest.raises(TreeError, match='has no basic event "top"'):
        differential_importance(solve(known), [["top"]])

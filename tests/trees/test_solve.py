"""The solver against its obvious twin, and against inclusion and exclusion."""

import itertools
import math
import random
from fractions import Fraction

import pytest
from hypothesis import given, settings

from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent, TooLarge, solve
from tests.trees.twin import disagreements, holds, trees

MONOTONE = ("and", "or", "vote")


def events(names, q=Fraction(1, 10)):
    return tuple(BasicEvent(name, q) for name in names)


@settings(max_examples=300, deadline=None)
@given(trees())
def test_every_figure_agrees_with_the_truth_table(tree):
    assert disagreements(tree) == []


@settings(max_examples=100, deadline=None)
@given(trees())
def test_occurs_agrees_with_the_words_of_the_gates(tree):
    for size in range(len(tree.events) + 1):
        for failed in itertools.combinations([event.name for event in tree.events], size):
            assert tree.occurs(failed) == holds(tree, tree.top, failed)


@settings(max_examples=100, deadline=None)
@given(trees(kinds=MONOTONE, houses=False))
def test_inclusion_and_exclusion_over_the_cut_sets_gives_the_probability(tree):
    solution = solve(tree)
    q = {event.name: event.probability for event in tree.events}
    sets = [frozenset(cut_set) for cut_set in itertools.islice(solution.cut_sets(), 11)]
    if len(sets) > 10:
        return
    total = Fraction(0)
    for size in range(1, len(sets) + 1):
        for chosen in itertools.combinations(sets, size):
            total -= (-1) ** size * math.prod(q[name] for name in frozenset().union(*chosen))
    assert total == solution.exact


def sample():
    """Trees in which each planted bug shows, whatever the seed of hypothesis."""
    chance = random.Random(7)
    for _ in range(60):
        names = [f"e{i}" for i in range(5)]
        gates = []
        for number in range(6):
            kind = chance.choice(("and", "or", "vote", "not", "xor"))
            inputs = chance.sample(names, 1 if kind == "not" else chance.randint(2, 4))
            k = chance.randint(1, len(inputs)) if kind == "vote" else None
            gates.append(Gate(f"g{number}", kind, tuple(inputs), k))
            names.append(f"g{number}")
        leaves = tuple(BasicEvent(f"e{i}", Fraction(chance.randint(1, 9), 10)) for i in range(5))
        yield FaultTree("sample", "g5", tuple(gates), leaves)


def test_the_sample_agrees_without_a_planted_bug():
    assert [found for tree in sample() for found in disagreements(tree)] == []


def test_two_out_of_three():
    tree = FaultTree("2oo3", "top", (Gate("top", "vote", ("a", "b", "c"), 2),), events("abc"))
    solution = solve(tree)
    assert solution.exact == Fraction(3, 100) - Fraction(2, 1000)
    assert solution.counts == (0, 0, 3)
    assert set(solution.cut_sets()) == {("a", "b"), ("a", "c"), ("b", "c")}


def test_a_rate_gives_the_exponential_probability_and_no_rational():
    tree = FaultTree(
        "t", "top", (Gate("top", "or", ("a",)),), (BasicEvent("a", rate_per_hour="1e-9"),), mission_time_h=10
    )
    solution = solve(tree)
    assert solution.exact is None
    assert solution.probability == pytest.approx(-math.expm1(-1e-8), rel=1e-15)
    assert solution.bounds[0] < solution.probability < solution.bounds[1]


def test_unknown_probabilities_leave_the_cut_sets():
    tree = FaultTree("t", "top", (Gate("top", "and", ("a", "b")),), (BasicEvent("a"), BasicEvent("b", "0.5")))
    solution = solve(tree)
    assert (solution.probability, solution.exact, solution.bounds, solution.importance()) == (None, None, None, {})
    assert list(solution.cut_sets()) == [("a", "b")]


@pytest.mark.parametrize(("state", "p", "counts"), [(True, 1, (1,)), (False, 0, ())])
def test_a_constant_top_event(state, p, counts):
    tree = FaultTree("t", "top", (Gate("top", "or", ("h",)),), events("a"), (HouseEvent("h", state),))
    solution = solve(tree)
    assert (solution.exact, solution.probability, solution.counts) == (p, p, counts)
    assert list(solution.cut_sets()) == [()] * p


def test_an_indispensable_event_has_an_infinite_risk_reduction_worth_in_doubles():
    gates = (Gate("top", "and", ("a", "x")), Gate("x", "or", ("b", "c")))
    measures = solve(FaultTree("t", "top", gates, events("abc", Fraction(1, 3)))).importance()
    assert measures["a"].risk_reduction_worth == math.inf
    assert measures["b"].risk_reduction_worth < 3


DEPTH = 1500


def ladder():
    """One module, as deep as it has events: every rung is over the one before, and the lowest event is used again."""
    gates = [Gate("g1", "and", ("e0", "e1"))]
    for i in range(2, DEPTH):
        gates.append(Gate(f"g{i}", "or" if i % 2 else "and", (f"e{i}", f"g{i - 1}")))
    gates.append(Gate("top", "xor", ("e0", f"g{DEPTH - 1}")))
    return FaultTree("ladder", "top", tuple(gates), events(f"e{i}" for i in range(DEPTH)))


def test_a_ladder_deeper_than_the_recursion_limit():
    def rung(lowest):
        p = lowest * 0.1
        for i in range(2, DEPTH):
            p = 0.1 + 0.9 * p if i % 2 else 0.1 * p
        return p

    solution = solve(ladder())
    expected = 0.1 * (1 - rung(1)) + 0.9 * rung(0)
    assert solution.probability == pytest.approx(expected, rel=1e-12)
    assert sum(solution.counts) == len(list(solution.cut_sets())) >= DEPTH // 2
    assert len(solution.importance()) == DEPTH


def test_a_module_beyond_every_budget_is_refused_by_name():
    with pytest.raises(TooLarge, match=r'"ladder": a module of 1499 gates .*larger budgets'):
        solve(ladder(), budgets=(10, 100))

"""Thousands of random trees: the same figures as their truth tables, as d4 and as SCRAM."""

import math
import random
from array import array
from fractions import Fraction

import pytest

from safety.trees import solve
from tests.trees.brute import Truth, by_order
from tests.trees.other_tools import SCRAM, d4, scram
from tests.trees.random_trees import random_tree

BLOCK = 1000
SIX_DIGITS = 5e-6  # relative: SCRAM prints no more
LONG = [pytest.param(10_000, marks=pytest.mark.slow), 300]


def disagreements(tree, **how):
    """What the solver says of `tree` that its truth table does not."""
    solution, truth = solve(tree, **how), Truth(tree)
    p, sets, listed = truth.probability(), truth.minimal(), list(solution.cut_sets())
    found = []
    if not (solution.bounds[0] <= p <= solution.bounds[1] and math.isclose(solution.probability, p, rel_tol=1e-13)):
        found.append(f"probability {solution.probability} in {solution.bounds}, table {p} = {float(p)}")
    if solution.counts != by_order(sets):
        found.append(f"{solution.counts} cut sets by order, table {by_order(sets)}")
    if sorted(listed) != sorted(tuple(sorted(one)) for one in sets):
        found.append(f"cut sets {listed}, table {sets}")
    if [len(one) for one in listed] != sorted(len(one) for one in listed):
        found.append(f"cut sets not by order: {listed}")
    return found + _of_one_event(tree, solution, truth)


def _of_one_event(tree, solution, truth):
    """The same for the derivative by one event, exactly and in doubles, and for other probabilities of all events."""
    rng = random.Random(tree.name)
    name, other = rng.choice(truth.names), {event: Fraction(rng.randint(0, 64), 64) for event in truth.names}
    measured, exact = solution.importance()[name], solution.exact_importance()[name]
    columns = array("d", [float(q) for event in tree.events for q in (event.probability, other[event.name])])
    many, slopes = solution.many(columns), solution.many_derivatives(columns)
    (p, p1, p0), (p_other, p1_other, p0_other) = (
        [truth.probability(fixed | more) for more in ({}, {name: Fraction(1)}, {name: Fraction(0)})]
        for fixed in ({}, other)
    )
    place = 2 * solution.events.index(name)
    found = [(solution.exact, p), (exact.birnbaum, p1 - p0)]
    close = [(measured.birnbaum, p1 - p0), (many[0], p), (many[1], p_other)]
    close += [(slopes[place], p1 - p0), (slopes[place + 1], p1_other - p0_other)]
    if p:
        found += [(exact.risk_achievement_worth, p1 / p)]
        close += [(measured.risk_achievement_worth, p1 / p)]
    if p and p0:
        found += [(exact.risk_reduction_worth, p / p0)]
        close += [(measured.risk_reduction_worth, p / p0)]
    if all(a == b for a, b in found) and all(math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-13) for a, b in close):
        return []
    return [f"ours and the table's: exactly {found}; with {name}, {other} in doubles {close}"]


@pytest.mark.parametrize("block", range(10))
def test_ten_thousand_random_trees_agree_with_their_truth_tables(block):
    trees = (random_tree(seed, 8 + seed % 4) for seed in range(BLOCK * block, BLOCK * (block + 1)))
    assert {tree.name: wrong for tree in trees if (wrong := disagreements(tree))} == {}


def test_the_random_trees_are_of_every_sort():
    trees = [random_tree(seed, 8 + seed % 4) for seed in range(BLOCK)]
    kinds = [{gate.kind for gate in tree.inputs_first} for tree in trees]
    truths = [Truth(tree) for tree in trees]
    assert {kind for each in kinds for kind in each} == {"and", "or", "vote", "not", "xor"}
    assert 300 < sum(not each & {"not", "xor"} for each in kinds) < 700
    assert sum(0 < truth.top < truth.every for truth in truths) > 800
    assert max(len(truth.minimal()) for truth in truths) > 20
    assert max(len(tree.inputs_first) for tree in trees) > 30
    assert sum(bool(tree.house_events) for tree in trees) > 200


@pytest.mark.parametrize("count", LONG)
def test_d4_finds_the_same_probability_exactly(count):
    pytest.importorskip("py_d4", reason="d4solver is not installed: the random trees are not compared with d4")
    trees = [random_tree(seed, 12) for seed in range(count)]
    assert {tree.name: (p, q) for tree in trees if (p := solve(tree).exact) != (q := d4(tree))} == {}


@pytest.mark.parametrize("count", LONG)
def test_scram_finds_the_same_probability_and_cut_sets(count, tmp_path):
    if SCRAM is None:
        pytest.skip("scram is not installed: the random trees are not compared with it")
    trees = [random_tree(seed, 24) for seed in range(count)]
    for tree, (probability, counts) in zip(trees, scram(trees, tmp_path), strict=True):
        solution = solve(tree)
        assert math.isclose(solution.probability, probability, rel_tol=SIX_DIGITS), tree.name
        # SCRAM says (1,) of the empty set as well
        assert (solution.counts if solution.counts == (1,) else solution.counts[1:]) == counts, tree.name


def test_wider_trees_by_truth_table():
    trees = [random_tree(seed, 16) for seed in range(40)]
    assert {tree.name: wrong for tree in trees if (wrong := disagreements(tree))} == {}

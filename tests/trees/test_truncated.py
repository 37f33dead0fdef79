"""Cut sets up to an order or above a probability: all within the limits and no other, without a diagram of the top."""

import csv
import math
import sys
from fractions import Fraction
from types import ModuleType

import pytest

from safety.trees import BasicEvent, FaultTree, Gate, kernel, read, solve
from safety.trees.as_written import TreeError
from safety.trees.cut_sets.truncated import OfDiagram, largest_order, limited, truncated
from safety.trees.module_diagrams import TooLarge
from tests.oracles import SHARED
from tests.trees.brute import Truth, by_order
from tests.trees.random_trees import random_tree

ARALIA = SHARED / "fault_trees"
with_oracles = pytest.mark.skipif(not ARALIA.is_dir(), reason=f"no oracles at {ARALIA}")
EXPECTED = {}
if ARALIA.is_dir():
    with (ARALIA / "expected.csv").open(newline="") as table:
        EXPECTED = {row["name"]: row for row in csv.DictReader(table)}


def public(name):
    return read(ARALIA / "aralia" / f"{name}.xml")


def within(tree, sets, order, above):
    """Those of `sets` that the limits leave, by their definition; a limit in doubles is met but for rounding."""
    least = None if above is None else Fraction(above) * (1 - Fraction(1, 10**12))
    chance = {event.name: event.probability for event in tree.events}
    return {
        one
        for one in sets
        if (order is None or len(one) <= order) and (above is None or math.prod(chance[name] for name in one) >= least)
    }


LIMITS = ((0, None), (1, None), (2, None), (3, None), (None, None), (None, 0.25), (None, 0.01), (2, 0.1), (None, 1.0))


def check(found, tree, wanted):
    sets = list(found.cut_sets())
    assert {frozenset(one) for one in sets} == wanted and len(sets) == len(wanted)
    assert [len(one) for one in sets] == sorted(map(len, wanted))
    assert found.counts == by_order(wanted)
    chance = {event.name: event.probability for event in tree.events}
    likely = list(found.likeliest_cut_sets())
    assert {frozenset(one) for _, one in likely} == {one for one in wanted if math.prod(chance[name] for name in one)}


@pytest.mark.parametrize("rare", [False, True])
def test_those_of_random_trees_are_the_ones_by_definition(rare):
    cut = 0
    for seed in range(90):
        tree = random_tree(seed, events=9, coherent=True, rare=rare)
        truth = Truth(tree)
        every, probability = truth.minimal(), truth.probability()
        for order, above in (*LIMITS, (None, 1e-9)):
            found, wanted = truncated(tree, order, above), within(tree, every, order, above)
            check(found, tree, wanted)
            assert found.lower() <= probability
            assert wanted == every or not found.complete
            assert found.complete or (order, above) != (None, None)
            cut += not found.complete
            exact = float(sum(math.prod(event.probability for event in tree.events if event.name in s) for s in wanted))
            assert found.sum() == pytest.approx(exact, rel=1e-12, abs=0)
    assert cut > 100


def test_those_of_solved_trees_are_the_same_coherent_or_not():
    other = 0
    for seed in range(100):
        tree = random_tree(seed, events=8)
        solution, every = solve(tree), Truth(tree).minimal()
        for order, above in LIMITS:
            wanted = within(tree, every, order, above)
            if above is not None:
                impossible = {event.name for event in tree.events if not event.probability}
                assert not any(one & impossible for one in wanted)
            found = limited(solution, order, above)
            check(found, tree, wanted)
            check(OfDiagram(solution, order, above), tree, wanted)
            assert wanted == every or not found.complete
        other += isinstance(found, OfDiagram)
    assert 20 < other < 80


def test_a_tree_that_is_not_coherent_is_refused_before_a_wrong_set_is_given():
    """a & not a is impossible: with one event more a set of order 1 would be cut, and one of order 2 seem minimal."""
    gates = (Gate("n", "not", ("a",)), Gate("top", "xor", ("a", "n", "b", "c")))
    tree = FaultTree("t", "top", gates, (BasicEvent("a", 0.1), BasicEvent("b", 0.1), BasicEvent("c", 0.1)))
    with pytest.raises(TreeError, match="is not coherent"):
        truncated(tree, 2)
    single = FaultTree("t", "n", gates[:1], (BasicEvent("a", 0.1),))
    with pytest.raises(TreeError, match="is not coherent"):
        truncated(single, 2)


def test_limits_that_make_no_sense_and_missing_probabilities_are_refused():
    tree = FaultTree("t", "top", (Gate("top", "or", ("a", "b")),), (BasicEvent("a", 0.1), BasicEvent("b")))
    with pytest.raises(TreeError, match="order -1"):
        truncated(tree, -1)
    for above in (0.0, 1.5, math.nan):
        with pytest.raises(TreeError, match="expected above 0 and up to 1"):
            truncated(tree, above=above)
    with pytest.raises(TreeError, match='"b" has no probability'):
        truncated(tree, above=0.5)
    found = truncated(tree, 1)
    assert found.counts == (0, 2) and found.lower() is None and found.sum() is None


def test_a_product_equal_to_the_limit_is_within_it():
    events = tuple(BasicEvent(f"e{i}", "0.001") for i in range(4))
    tree = FaultTree("t", "top", (Gate("top", "vote", tuple(e.name for e in events), 2),), events)
    assert truncated(tree, above=1e-6).counts == (0, 0, 6)
    assert truncated(tree, above=1.0001e-6).counts == ()


def test_too_small_a_budget_is_said_and_the_largest_order_within_one_is_found():
    tree = random_tree(5, events=12, coherent=True)
    with pytest.raises(TooLarge, match="within order 3 need more than 2 nodes"):
        truncated(tree, 3, budget=2)
    assert largest_order(tree, budget=2) is None
    found = largest_order(tree)
    assert found.complete and found.counts == solve(tree).counts


def test_compiled_and_interpreted_are_equal():
    for seed in range(40):
        tree = random_tree(seed, events=12, coherent=True)
        for order, above in ((2, None), (None, 0.05), (4, 0.001)):
            compiled, slow = (truncated(tree, order, above, interpreted=how) for how in (False, True))
            assert list(compiled.cut_sets()) == list(slow.cut_sets())
            assert (compiled.complete, compiled.lower()) == (slow.complete, slow.lower())


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("result = self.make(\n", "result = self.of(f, 1) if order > 3 else self.make(\n"),
        ("self.union(self.of(g, 1), self.of(g, 2)), order - 1, left)", "self.of(g, 1), order - 1, left)"),
        ("self.product(self.of(f, 2), self.of(g, 1), order - 1, left)", "NONE"),
        (
            "high = self.product(self.of(f, 1), g, order - 1, left)",
            "high = self.product(self.of(f, 1), g, order, left)",
        ),
        ("for j in range(k[g], 0, -1):", "for j in range(1, k[g] + 1):"),
        ("self.worst[f] >= limit", "self.best[f] >= limit"),
    ],
)
def test_a_planted_error_is_found(monkeypatch, right, wrong):
    path = kernel.load("truncated", interpreted=True).__file__
    with open(path, encoding="utf-8") as file:
        source = file.read()
    assert source.count(right) == 1
    name = f"{kernel.__name__}.truncated"
    broken = ModuleType(name)
    monkeypatch.setitem(sys.modules, name, broken)
    kernel.load.cache_clear()
    exec(compile(source.replace(right, wrong), "truncated", "exec"), broken.__dict__)
    try:
        assert any(differs(seed) for seed in range(300))
    finally:
        monkeypatch.undo()
        kernel.load.cache_clear()


def differs(seed):
    tree = random_tree(seed, events=9, coherent=True)
    every = Truth(tree).minimal()
    for order, above in ((2, None), (3, None), (None, None), (None, 0.1)):
        found = truncated(tree, order, above, interpreted=True)
        if {frozenset(one) for one in found.cut_sets()} != within(tree, every, order, above):
            return True
    return False


@with_oracles
def test_the_smallest_cut_sets_of_every_coherent_public_tree():
    orders = []
    for name, row in EXPECTED.items():
        tree = public(name)
        published = [0, *map(int, row["mcs_by_order"].split())]
        if len(published) == 1 or any(gate.kind in ("not", "xor") for gate in tree.gates):
            continue
        found = largest_order(tree, budget=50_000)
        expected = published[: found.order + 1]
        assert [*found.counts, *[0] * (len(expected) - len(found.counts))] == expected, name
        if sum(found.counts) < 1000:
            assert 0 < found.lower() <= float(row["p_top"]) * (1 + 1e-12)
        orders.append(found.order)
    assert len(orders) > 15 and min(orders) >= 2 and sum(orders) > 100


@with_oracles
def test_the_cut_sets_of_the_tree_without_a_diagram():
    found = truncated(public("nus9601"), 3)
    assert found.counts == (0, 0, 0, 10) and not found.complete  # as SCRAM 0.16.2 -l 3
    assert found.sum() == pytest.approx(1e-5, rel=1e-12)
    assert truncated(public("nus9601"), above=1e-7).counts == found.counts


@with_oracles
def test_the_union_of_more_sets_than_a_diagram_holds_is_bounded_by_the_likeliest(monkeypatch):
    from safety.trees.cut_sets import truncated as module

    tree, expected = public("chinese"), float(EXPECTED["chinese"]["p_top"])
    whole = truncated(tree).lower()
    monkeypatch.setattr(module, "UNION_BUDGET", 60)
    part = truncated(tree).lower()
    assert 0.1 * expected < part < whole <= expected


def test_an_error_in_the_chance_of_an_event_is_inside_the_bound():
    event = BasicEvent("a", rate_per_hour=Fraction(1, 10**6), mission_time_h=Fraction(100))
    tree = FaultTree("t", "top", (Gate("top", "or", ("a",)),), (event,))
    lower = truncated(tree).lower()
    assert 0 < lower < -math.expm1(-1e-4) < lower * (1 + 1e-14)


def test_a_wide_gate_is_no_more_work_than_its_inputs():
    events = tuple(BasicEvent(f"e{i}", "0.001") for i in range(20_000))
    names = tuple(event.name for event in events)
    for kind, k, counts in (("or", None, (0, 20_000)), ("vote", 3, (0, 0, 0, math.comb(20_000, 3)))):
        tree = FaultTree("wide", "top", (Gate("top", kind, names, k),), events)
        assert truncated(tree, 3, budget=200_000).counts == counts


@with_oracles
@pytest.mark.slow
def test_the_smallest_cut_sets_of_a_public_tree_that_is_not_coherent():
    found = limited(solve(public("cea9601")), 4, None)
    assert found.counts == (0, 0, 0, 1144, 53292) and not found.complete  # as SCRAM 0.16.2 -l 4

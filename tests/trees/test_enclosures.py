"""Certified bounds hold for every function, however little is kept, and come together when more is."""

import csv
import random
from array import array
from pathlib import Path

import pytest

from safety.trees import BasicEvent, FaultTree, Gate, read
from safety.trees.cut_sets.enclosures import enclose, without_xor
from safety.trees.kernel import load
from safety.trees.solve import solve
from tests.oracles import SHARED
from tests.trees.flat_graphs import random_graph, tables
from tests.trees.random_trees import random_tree

ARALIA = SHARED / "fault_trees"
KERNEL, GRAPH, MODULES = (load(name) for name in ("enclosure", "graph", "modules"))
with_oracles = pytest.mark.skipif(not ARALIA.is_dir(), reason=f"no oracles at {ARALIA}")


def table_of(function, variables, order):
    """The truth table of a diagram (levels, high and low edges, root) over variables 1..n."""
    rows = 1 << variables
    everywhere = (1 << rows) - 1
    level, high, low, root = function
    table = [everywhere, 0]
    for i in range(1, len(level)):
        v = order[level[i]] - 1
        occurs = sum(1 << row for row in range(rows) if row >> v & 1)
        value = (occurs & table[high[i]]) | (~occurs & everywhere & table[low[i]])
        table += [value, value ^ everywhere]
    return table[root]


def enclosed(graph, keep, rounds, kernel=KERNEL):
    """The tables of the lower and upper function of the root's gate, and that gate's own."""
    gates = array("i", range(graph.variables + 1, graph.variables + 1 + len(graph)))
    order = array("i", range(1, graph.variables + 1))
    monotone = bool(MODULES.modules(graph)[1][-1])
    enclosure = kernel.Enclosure(len(order), monotone, 4096)
    for _ in range(rounds):
        enclosure.round(graph, gates, order, array("d", [0.3] * len(order)), keep)
    lower, upper = (table_of(enclosure.function(side), graph.variables, order) for side in range(2))
    return lower, upper, tables(graph)[0][graph.root >> 1], enclosure


def some_graphs(count, seed):
    rng = random.Random(seed)
    for _ in range(count):
        graph = without_xor(GRAPH.reduce(random_graph(rng)))
        if len(graph):
            yield graph


@pytest.mark.parametrize("keep", [1, 2, 4, 1000])
def test_the_lower_function_implies_the_module_and_that_the_upper_one(keep):
    cut = 0
    for graph in some_graphs(400, seed=keep):
        for rounds in (1, 2):
            lower, upper, own, enclosure = enclosed(graph, keep, rounds)
            assert lower & ~own == 0 and own & ~upper == 0
            cut += lower != upper
            assert (lower == upper == own) or keep < 1000
            assert lower == upper or not enclosure.exact
    assert cut > 20 or keep == 1000


def test_a_planted_error_that_keeps_the_wrong_child_is_found():
    source = Path(load("enclosure", interpreted=True).__file__).read_text(encoding="utf-8")
    right = "n = self.become(self.high[n]) if self.side else self.become(self.low[n])"
    assert right in source
    namespace = {}
    exec(
        compile(source.replace(right, right.replace("if self.side", "if not self.side")), "enclosure", "exec"),
        namespace,
    )
    broken = type("Broken", (), {"Enclosure": namespace["Enclosure"]})
    found = 0
    for graph in some_graphs(100, seed=9):
        lower, upper, own, _ = enclosed(graph, 2, 1, broken)
        found += bool(lower & ~own or own & ~upper)
    assert found


def test_bounds_of_random_trees_hold_and_are_narrow_when_the_tree_is_small():
    for seed in range(60):
        tree = random_tree(seed)
        bounds, exact = enclose(tree, budgets=(2,)), solve(tree).probability
        assert bounds.lower <= exact <= bounds.upper
        assert bounds.upper - bounds.lower <= 1e-12  # three hundred nodes are enough for so few events


def test_no_bounds_without_probabilities_and_exact_ones_for_a_single_event():
    gate = Gate("top", "or", ("a", "b"))
    assert enclose(FaultTree("t", "top", (gate,), (BasicEvent("a", 0.1), BasicEvent("b")))) is None
    single = enclose(FaultTree("t", "top", (Gate("top", "or", ("a",)),), (BasicEvent("a", 0.1),)))
    assert single.lower <= 0.1 <= single.upper and single.open_modules == 0


@with_oracles
@pytest.mark.parametrize("name", ["baobab1", "das9601", "jbd9601"])
def test_bounds_of_public_trees_hold_when_hardly_any_module_fits(name):
    tree = read(ARALIA / "aralia" / f"{name}.xml")
    with open(ARALIA / "expected.csv", encoding="utf-8") as table:
        expected = next(float(row["p_top"]) for row in csv.DictReader(table) if row["name"] == name)
    bounds = enclose(tree, enough=1.1, budgets=(100,))
    assert bounds.open_modules > 0
    assert bounds.lower <= expected <= bounds.upper <= 1.2 * bounds.lower


@with_oracles
def test_the_largest_public_tree_is_bounded_within_ten_per_cent():
    tree = read(ARALIA / "aralia" / "nus9601.xml")
    bounds = enclose(tree, enough=1.1, budgets=(20_000,))
    assert bounds.upper <= 1.1 * bounds.lower
    assert bounds.lower <= 1e-5 <= bounds.upper  # 120 million samples: 9.79e-6, standard error 0.29e-6


def test_compiled_and_interpreted_bounds_are_equal():
    for seed in range(12):
        tree = random_tree(seed, events=12)
        assert enclose(tree, budgets=(2,)) == enclose(tree, budgets=(2,), interpreted=True)


def test_an_or_of_more_events_than_the_budget_is_not_mistaken_for_something_small():
    events = tuple(BasicEvent(f"e{i}", 1e-3) for i in range(300))
    tree = FaultTree("wide", "top", (Gate("top", "or", tuple(e.name for e in events)),), events)
    bounds = enclose(tree, budgets=(100,))
    assert bounds.lower <= 1 - 0.999**300 <= bounds.upper <= bounds.lower * 1.01

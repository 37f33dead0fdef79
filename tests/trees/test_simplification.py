"""Simplified graphs are the same functions; modules and orders are what their definitions say; both kernels agree."""

import random
from pathlib import Path

import pytest

from safety.trees.kernel import load
from safety.trees.kernel.flat import AND, OR, XOR, FlatGraph
from tests.trees.flat_graphs import below, contents, random_graph, tables

GRAPH, MODULES, ORDERS, MEMBERS = (load(name) for name in ("graph", "modules", "orders", "members"))


def graphs(count, seed=1, largest=8):
    rng = random.Random(seed)
    return (random_graph(rng, largest) for _ in range(count))


def same_function(graph, other):
    return tables(graph)[1] == tables(other)[1]


def test_simplified_graphs_are_the_same_function_without_more_repeated_references():
    worse = 0
    for graph in graphs(2500):
        reduced = GRAPH.reduce(graph)
        assert same_function(graph, reduced), contents(graph)
        worse += GRAPH.repeats(reduced) > GRAPH.repeats(graph)
        refs = GRAPH.references(reduced)
        for index in range(reduced.variables + 1, len(refs)):
            _, _, inputs = reduced.gate(index)
            assert refs[index] and len(inputs) > 1 and all(literal > 1 for literal in inputs)
    assert worse <= 5  # votes with repeated inputs written out


@pytest.mark.parametrize("name", ["absorb", "merge"])
def test_each_step_keeps_the_function(name):
    step, done = getattr(load(name), name), 0
    for graph in graphs(1200, seed=2):
        start = GRAPH.signed(GRAPH.signed(graph, False))
        for copies in (1, 8) if name == "absorb" else ((),):
            changed = step(start, GRAPH.references(start), *([copies] if copies else []))
            done += contents(changed) != contents(start)
            assert same_function(graph, changed), contents(graph)
    assert done > 10


def test_a_planted_error_of_absorption_is_found():
    """With the contexts of an "and" given to votes and exclusive ors as well, some function changes."""
    source = Path(load("absorb", interpreted=True).__file__).read_text(encoding="utf-8")
    assert "if self.kind[g] == AND and not self.bit" in source
    broken = source.replace("if self.kind[g] == AND and not self.bit", "if not self.bit")
    broken = broken.replace(
        "                        if self.kind[g] == AND:\n                            self.flip",
        "                        if True:\n                            self.flip",
    )
    namespace = {}
    exec(compile(broken, "absorb", "exec"), namespace)
    wrong = 0
    for graph in graphs(600, seed=3):
        start = GRAPH.signed(GRAPH.signed(graph, False))
        wrong += not same_function(graph, namespace["absorb"](start, GRAPH.references(start), 1))
    assert wrong


def test_absorption_reaches_through_levels_and_merging_makes_one_gate_of_common_inputs():
    x, y, z, u = 2, 4, 6, 8
    absorbed = GRAPH.reduce(
        FlatGraph.of(4, [(AND, 0, [x, y]), (OR, 0, [10, z]), (AND, 0, [12, u]), (AND, 0, [x, 14])], 16)
    )
    assert GRAPH.repeats(absorbed) == 0  # x & (x & y | z) & u: no second x
    gates = [(OR, 0, [x, y, z]), (OR, 0, [x, y, u]), (XOR, 0, [10, 12])]
    merged = GRAPH.reduce(FlatGraph.of(4, gates, 14))
    assert GRAPH.repeats(merged) == 1  # of the gate over x and y


def test_modules_are_the_gates_that_share_nothing_below_them():
    for graph in graphs(600, seed=4):
        reduced = GRAPH.reduce(graph)
        if len(reduced) == 0:
            assert list(MODULES.modules(reduced)[0]) == []
            continue
        cones, first = below(reduced), reduced.variables + 1
        gates = range(first, first + len(reduced))
        monotone = {}
        for index in gates:
            kind, _, inputs = reduced.gate(index)
            monotone[index] = kind != XOR and all(not i & 1 and monotone.get(i >> 1, True) for i in inputs)
        found = [
            index
            for index in gates
            if index == reduced.root >> 1
            or not any(
                i >> 1 in cones[index] - {index}
                for other in gates
                if other not in cones[index]
                for i in reduced.gate(other)[2]
            )
        ]
        numbers, flags = MODULES.modules(reduced)
        assert list(numbers) == found and [bool(flag) for flag in flags] == [monotone[index] for index in found]
        assert list(MODULES.modules(reduced, True)[0]) == [i for i in found if monotone[i] or i == found[-1]]


def test_orders_are_permutations_of_the_modules_variables_and_differ():
    longest = 0
    for graph in graphs(300, seed=5, largest=14):
        reduced = GRAPH.reduce(graph)
        is_module = bytearray(reduced.variables + 1 + len(reduced))
        for index in MODULES.modules(reduced)[0]:
            is_module[index] = 1
        for index in MODULES.modules(reduced)[0]:
            orders = [tuple(order) for order in ORDERS.orders(reduced, index, is_module)]
            longest = max(longest, len(orders))
            assert len(set(orders)) == len(orders) > 0
            assert all(sorted(order) == sorted(MEMBERS.members(reduced, index, is_module)[1]) for order in orders)
    assert longest > 5


@pytest.mark.skipif(not GRAPH.__name__.endswith("_c"), reason="the kernel is not compiled")
def test_compiled_and_interpreted_simplification_modules_and_orders_are_equal():
    plain = {name: load(name, interpreted=True) for name in ("graph", "modules", "orders")}
    for graph in graphs(150, seed=6, largest=12):
        reduced = GRAPH.reduce(graph)
        assert contents(plain["graph"].reduce(graph)) == contents(reduced)
        assert [list(a) for a in plain["modules"].modules(reduced)] == [list(a) for a in MODULES.modules(reduced)]
        is_module = bytearray(reduced.variables + 1 + len(reduced))
        for index in MODULES.modules(reduced)[0]:
            is_module[index] = 1
        for index in MODULES.modules(reduced)[0]:
            assert list(plain["orders"].orders(reduced, index, is_module)) == list(
                ORDERS.orders(reduced, index, is_module)
            )

"""Sifting: swaps keep every function and the canonical form, sifting makes no diagram larger, building goes on."""

import random
from array import array

import pytest

from safety.trees import TooLarge, kernel, sifted, solve
from safety.trees.kernel.flat import AND, OR, FlatGraph
from tests.trees.brute import Truth
from tests.trees.random_trees import random_tree

FORMS = [False, True] if kernel.is_compiled() else [True]
LONG = 10**9  # steps: no limit


def table(edge, nodes, order):
    """The truth tables of all edges: bit i of a number is the value under the i-th assignment of the variables."""
    level, high, low = nodes
    rows = 1 << len(order)
    everywhere = (1 << rows) - 1
    value = [everywhere, 0]
    for i in range(1, len(level)):
        variable = sum(1 << row for row in range(rows) if row >> order[level[i]] & 1)
        found = variable & value[high[i]] | ~variable & value[low[i]]
        value += [found, found ^ everywhere]
    return value[edge]


def smallest(functions, order):
    """The nodes that functions of the variables need in this order: their distinct cofactors, up to complement."""
    rows = 1 << len(order)
    everywhere = (1 << rows) - 1
    present, count = {min(f, f ^ everywhere) for f in functions}, 0
    for variable in order:
        true = sum(1 << row for row in range(rows) if row >> variable & 1)
        step, following = 1 << variable, set()
        for f in present:
            f1, f0 = f & true, f & ~true
            f1, f0 = f1 | f1 >> step, f0 | f0 << step
            count += f1 != f0
            following |= {min(f1, f1 ^ everywhere), min(f0, f0 ^ everywhere)}
        present = following
    return count


def random_roots(rng):
    """Level, high and low of the nodes of random roots over at most 8 variables, and the roots."""
    levels = rng.randint(2, 8)
    builder = kernel.load("builder").Builder(levels, 10_000)
    count, wide = rng.randint(1, 12), rng.randint(2, 5)
    gates = []
    for last in range(levels, levels + count):
        inputs = [2 * rng.randint(1, last) + rng.randint(0, 1) for _ in range(wide)]
        gates.append((rng.randrange(4), rng.randint(1, wide), inputs))
    graph = FlatGraph.of(levels, gates, 2 * (levels + count))
    edge_of = array("i", [0, *(builder.variable(i) for i in range(levels)), *([0] * count)])
    builder.build(graph, array("i", range(levels + 1, levels + count + 1)), edge_of)
    roots = [edge_of[rng.randint(1, levels + count)] ^ rng.randint(0, 1) for _ in range(rng.randint(1, 5))]
    return builder.shared(array("i", roots))


def wrongly_sifted(seed, interpreted=True):
    """What is wrong after random swaps, sifting, and with roots that are given up; None if nothing is."""
    rng = random.Random(seed)
    *nodes, roots = random_roots(rng)
    levels = nodes[0][0]
    functions = [table(root, nodes, range(levels)) for root in roots]
    sifter = kernel.load("sifting", interpreted).Sifter(*nodes, roots, 10_000)

    def wrong():
        *now, edges = sifter.finish()
        level, high, low = now
        order = sifter.order()
        triples = set(zip(level[1:], high[1:], low[1:], strict=True))
        if sorted(order) != list(range(levels)):
            return "the order is none"
        if len(triples) != len(level) - 1 or any(h & 1 or h == low for _, h, low in triples):
            return "the form is not canonical"
        if any(level[i] >= min(level[high[i] >> 1], level[low[i] >> 1]) for i in range(1, len(level))):
            return "a child is above"
        if [table(edge, now, order) for edge in edges] != functions:
            return "a function is another one"
        if not len(level) - 1 == sifter.nodes == smallest(functions, order):
            return "nodes that nothing uses, or too few"
        if interpreted and uses(sifter) != uses_counted(sifter):
            return "the uses"
        return None

    found = wrong()
    for _ in range(20):
        sifter.swap(rng.randrange(levels - 1))
        found = found or wrong()
    before = sifter.nodes
    sifter.sift(LONG)
    found = found or wrong() or ("larger" if sifter.nodes > before else None)
    functions = functions[: len(functions) // 2]
    sifter.keep(len(functions))
    return found or wrong()


def uses(sifter):
    """Of each node that is there, by the interpreted form: how often it is said to be used."""
    return {i: sifter.node[8 * i + 3] for i in present(sifter)}


def uses_counted(sifter):
    """The same by counting."""
    edges = [*sifter.roots, *(sifter.node[8 * i + side] for i in present(sifter) for side in (1, 2))]
    nodes = [edge >> 1 for edge in edges]
    return {i: nodes.count(i) for i in present(sifter)}


def present(sifter):
    for first in sifter.first:
        while first:
            yield first
            first = sifter.node[8 * first + 6]


@pytest.mark.parametrize("interpreted", FORMS)
@pytest.mark.parametrize("block", range(4))
def test_swaps_and_sifting_keep_every_function_in_canonical_form(block, interpreted):
    for seed in range(50 * block, 50 * (block + 1)):
        assert wrongly_sifted(seed, interpreted) is None, seed


def pairs(count, interpreted=False):
    """Diagram of x1 y1 | x2 y2 | ... in the order x1, x2, ..., y1, y2, ...: 2 ** (count + 1) - 2 nodes."""
    builder = kernel.load("builder", interpreted).Builder(2 * count, 1 << count + 4)
    gates = [(AND, 0, [2 * i, 2 * (i + count)]) for i in range(1, count + 1)]
    gates.append((OR, 0, [2 * i for i in range(2 * count + 1, 3 * count + 1)]))
    graph = FlatGraph.of(2 * count, gates, 2 * (3 * count + 1))
    edge_of = array("i", [0, *(builder.variable(i) for i in range(2 * count)), *([0] * (count + 1))])
    root = builder.build(graph, array("i", range(2 * count + 1, 3 * count + 2)), edge_of)
    return builder.shared(array("i", [root]))


@pytest.mark.parametrize("interpreted", FORMS)
def test_pairs_that_stand_apart_are_brought_together(interpreted):
    *nodes, roots = pairs(8, interpreted)
    sifter = kernel.load("sifting", interpreted).Sifter(*nodes, roots, 10_000)
    assert sifter.nodes == 2**9 - 2
    assert sifter.sift(LONG) == 16  # every variable had its turn
    assert sifter.nodes == 16
    order = list(sifter.order())
    assert all({order[i] % 8, order[i + 1] % 8} == {order[i] % 8} for i in range(0, 16, 2))


def test_both_forms_sift_alike_to_the_last_number():
    if len(FORMS) == 1:
        pytest.skip("the kernel is not compiled here: its two forms are not compared")
    for seed in range(100):
        *nodes, roots = random_roots(random.Random(seed))
        results = []
        for interpreted in FORMS:
            sifter = kernel.load("sifting", interpreted).Sifter(*nodes, roots, len(nodes[0]) * 2)
            turns = sifter.sift(40 * len(nodes[0]))
            results.append((turns, sifter.steps, list(sifter.order()), [list(row) for row in sifter.finish()]))
        assert results[0] == results[1], seed


def test_limits_end_the_work_with_what_was_gained_so_far():
    *nodes, roots = pairs(8)
    sizes = []
    for steps in (0, 500, 1000, LONG):
        sifter = kernel.load("sifting").Sifter(*nodes, roots, 10_000)
        sifter.sift(steps)
        sizes.append(sifter.nodes)
    assert sizes[0] == 2**9 - 2
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] > sizes[2] > sizes[3]


def test_there_are_never_more_nodes_than_there_is_room_for():
    for seed in range(50):
        *nodes, roots = random_roots(random.Random(seed))
        for room in (len(nodes[0]) - 1, len(nodes[0]) * 3 // 2):
            sifter, most = kernel.load("sifting").Sifter(*nodes, roots, room), 0

            def look(s=sifter):
                nonlocal most
                most = max(most, s.nodes)

            sifter.sift(LONG, look)
            assert most <= room
            assert sifter.nodes < len(nodes[0])


def test_what_the_pulse_raises_ends_the_work():
    *nodes, roots = pairs(8)
    sifter = kernel.load("sifting").Sifter(*nodes, roots, 10_000)
    with pytest.raises(KeyboardInterrupt):
        sifter.sift(LONG, interrupt)


def interrupt():
    raise KeyboardInterrupt


def grown(tree, budget, interpreted=False):
    """The solution under one budget, and whether it took sifting."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sifted, "STEPS", 0)  # none is left to go on with
        try:
            solve(tree, (budget,), interpreted=interpreted)
            needed = False
        except TooLarge:
            needed = True
    try:
        return solve(tree, (budget,), interpreted=interpreted), needed
    except TooLarge:
        return None, needed


def test_trees_that_fit_in_no_order_tried_are_solved_by_sifting():
    by_sifting = 0
    for seed in range(80):
        tree = random_tree(seed, 12)
        nodes = solve(tree).nodes
        for budget in (3 * nodes // 4, nodes, 3 * nodes // 2):
            solution, needed = grown(tree, budget)
            if solution is not None and needed:
                by_sifting += 1
                truth = Truth(tree)
                low, high = solution.bounds
                assert low <= truth.probability() <= high, seed
                assert {frozenset(one) for one in solution.cut_sets()} == truth.minimal(), seed
                other, _ = grown(tree, budget, interpreted=True)
                assert [list(part.order) for part in other.parts] == [list(part.order) for part in solution.parts], seed
                assert (other.probability, other.nodes) == (solution.probability, solution.nodes), seed
    assert by_sifting >= 8

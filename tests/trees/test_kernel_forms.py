"""The kernel in its two forms, compiled and interpreted: the same results to the last bit; and bugs planted in it."""

import random
import sys
from array import array
from pathlib import Path
from types import ModuleType

import pytest

from safety.trees import BasicEvent, FaultTree, Gate, kernel, solve
from tests.trees.brute import Truth
from tests.trees.random_trees import random_tree
from tests.trees.test_random_trees import disagreements
from tests.trees.test_sifting import wrongly_sifted

FOLDER = Path(kernel.__file__).parent
PREFIX = kernel.__name__
SEEDS = 1000  # of them a planted bug has to show on one

compiled_too = pytest.mark.skipif(
    not kernel.is_compiled(), reason="the kernel is not compiled here: its two forms are not compared"
)


def everything(solution):
    """All that a kernel gives, as plain numbers: diagrams, figures, cut sets in the order of their listing."""
    columns = array("d", [0.5, 0.01 * len(solution.events)] * len(solution.events))
    return {
        "graph": [list(getattr(solution.graph, name)) for name in ("kind", "k", "start", "inputs")],
        "parts": [
            (part.number, list(part.order), [list(getattr(part.diagram, name)) for name in ("level", "high", "low")])
            for part in solution.parts
        ],
        "root": solution.parts[-1].diagram.root,
        "probability": solution.probability,
        "counts": solution.counts,
        "cut sets": list(solution.cut_sets()),
        "likeliest": list(solution.likeliest_cut_sets()),
        "importance": solution.importance(),
        "many": list(solution.many(columns)),
        "slopes": list(solution.many_derivatives(columns)),
    }


def tangle(seed):
    """An exclusive or of products that no order makes small: its diagram outgrows the room that it begins with."""
    rng, names = random.Random(seed), [f"x{i}" for i in range(14)]
    gates = [Gate(f"p{i}", "and", tuple(rng.sample(names, 3))) for i in range(60)]
    events = tuple(BasicEvent(name, f"{i + 3}/64") for i, name in enumerate(names))
    return FaultTree("tangle", "top", (*gates, Gate("top", "xor", tuple(gate.name for gate in gates))), events)


@compiled_too
@pytest.mark.parametrize("block", range(4))
def test_both_forms_give_the_same_to_the_last_bit(block):
    for seed in range(50 * block, 50 * (block + 1)):
        tree = random_tree(seed, 10)
        assert everything(solve(tree)) == everything(solve(tree, interpreted=True)), seed


@compiled_too
def test_both_forms_keep_to_the_budget():
    tree = random_tree(11, 14)
    nodes = solve(tree).nodes
    for budgets in ((nodes // 2, 10 * nodes), (nodes, 2000), (2000,)):
        assert everything(solve(tree, budgets)) == everything(solve(tree, budgets, interpreted=True))


# What is planted: the file, what stands there, what is put in its place, and so on.
BUGS = {
    "a complement is lost": ("builder", "        low ^= flip\n", ""),
    "children are swapped": ("builder", "high = self.both(f1, g1)", "high = self.both(f1, g0)"),
    "a cache key lacks g": ("builder", " and self.cache[entry + 1] == g", ""),
    "the lower level is split": ("builder", "min(self.node[a], self.node[b])", "max(self.node[a], self.node[b])"),
    "a node is known without its level": ("builder", " and self.node[at] == level", ""),
    "a vote counts one too few": ("builder", "range(min(k, i + 1), 0, -1)", "range(min(k, i), 0, -1)"),
    "a vote counts an input twice": ("builder", "range(min(k, i + 1), 0, -1)", "range(1, min(k, i + 1) + 1)"),
    "xor with true": ("builder", "return g ^ 1 ^ flip", "return g ^ flip"),
    "an or begins with true": ("builder", "joined: cython.int = 0 if kind == AND else 1", "joined: cython.int = 0"),
    "the last numbering loses complements": ("builder", " + (self.node[at + 2] & 1)", ""),
    "the chance of an opposite": ("diagram", "chance[l ^ 1]", "chance[l]"),
    "importance below a complement": ("diagram", "child = self.low[i] ^ side", "child = self.low[i]"),
    "importance of skipped variables": ("diagram", "sums[stop] += value", "sums[start] += value"),
    "samples below a complement": ("diagram", "BLOCK * (self.low[i] ^ side)", "BLOCK * self.low[i]"),
    "the sign of slopes": ("diagram", "sign = 1 - 2 * (self.root & 1)", "sign = 1"),
    "sets are not made minimal": ("families", "present = self.without(present, absent)", "pass"),
    "sets of the opposite": ("families", "self.minimal(self.low[i] ^ (edge & 1))", "self.minimal(self.low[i])"),
    "the second step of without": ("families", "high = self.without(high, self.node[b + 2])", "pass"),
    "a family's cache key": ("families", " and self.cache[entry + 1] == smaller", "", " + g * 4256249", ""),
    "families of one level": ("families", "if self.node[a] > self.node[b]:", "if self.node[a] >= self.node[b]:"),
    "the order of a count": ("families", "counts[p + n + j]", "counts[p + j]"),
    "zero-suppression": ("families", "if high == NONE:", "if high == low:"),
    "orders that can be reached": ("families", "high << n", "high"),
    "a vote over x and not x": ("graph", "m -= 1  # exactly one of the two\n                        k -= 1", "m -= 1"),
    "the opposite of a vote": ("graph", "k = n - k + 1", "k = n - k"),
    "a complement below a xor": ("graph", "flip ^= self.work[i] & 1", "flip ^= 0"),
    "a gate is known without its k": ("graph", " and self.k[g] == k", "", " + k * 104729", ""),
    "coalescing through a complement": ("graph", "if kind[g] == XOR or not inputs[i] & 1:", "if True:"),
    "absorption of the wrong sign": ("absorb", "self.below[used] = -1", "self.below[used] = -2"),
    "a context that not all users have": ("absorb", "common = self.known[at + i] &", "common = self.known[at + i] |"),
    "a context through a vote": ("absorb", "if self.kind[g] == AND and not self.bit", "if not self.bit"),
    "merging of what only looks alike": ("merge", "& 0x3FFFFFFF", "& 0", "not in (0, size[leader])", "in ()"),
    "a module that is used elsewhere": ("modules", " and self.latest[below] < self.left[gate]", ""),
    "a swap loses a complement": ("sifting", "self.node[b + LOW] ^ (f0 & 1)", "self.node[b + LOW]"),
    "a swap mixes up children": ("sifting", "f10 = self.edge(x, f10, f00)", "f10 = self.edge(x, f10, f01)"),
    "a swap forgets a use": ("sifting", "self.node[8 * cython.cast(cython.longlong, f11 >> 1) + USES] += 1", "pass"),
    "what is unused stays": ("sifting", "if i and self.node[at + USES] == 0:", "if False:"),
    "a swapped node is known without its variable": ("sifting", " and self.node[at] == variable", ""),
    "a variable stays where it went": ("sifting", "while self.level_of[variable] < best_level:", "while False:"),
    "sifted numbers lose complements": ("sifting", " + (self.node[at + LOW] & 1)", ""),
    "a module with a complement": ("modules", "if self.inputs[i] & 1 or not self.plain", "if not self.plain"),
}  # fmt: skip


@pytest.fixture
def plant(monkeypatch):
    """A function that puts a bug into the interpreted kernel, for one test."""

    def planted(file, *changes):
        text = (FOLDER / f"{file}.py").read_text(encoding="utf-8")
        for old, new in zip(changes[::2], changes[1::2], strict=True):
            assert old in text, f"{file}.py has no {old!r} any more: plant this bug where its like stands now"
            text = text.replace(old, new, 1)
        for source in FOLDER.glob("*.py"):  # files that use others have to load them anew
            if source.stem not in ("__init__", "flat"):
                monkeypatch.delitem(sys.modules, f"{PREFIX}.{source.stem}", raising=False)
        module = ModuleType(f"{PREFIX}.{file}")
        exec(compile(text, f"{file}.py with a bug", "exec"), module.__dict__)
        monkeypatch.setitem(sys.modules, module.__name__, module)
        kernel.load.cache_clear()

    yield planted
    monkeypatch.undo()
    kernel.load.cache_clear()


def found_by(seeds, wrong=lambda seed: disagreements(random_tree(seed, 6 + seed % 5), interpreted=True)):
    """The first seed whose tree gives the bug away, None if none does."""
    for seed in seeds:
        try:
            if wrong(seed):
                return seed
        except Exception:  # a kernel that breaks down has been found out as well
            return seed
    return None


@pytest.mark.parametrize("bug", BUGS)
def test_a_planted_bug_is_found(bug, plant):
    plant(*BUGS[bug])
    wrong = (wrongly_sifted,) if BUGS[bug][0] == "sifting" else ()
    assert found_by(range(SEEDS), *wrong) is not None


def test_what_is_planted_is_gone_again(plant):
    plant(*BUGS["children are swapped"])
    assert found_by(range(20)) is not None
    plant("builder", "high = self.both(f1, g1)", "high = self.both(f1, g1)")
    assert found_by(range(20)) is None


@pytest.mark.parametrize("interpreted", [False, True])
def test_a_diagram_that_outgrows_its_first_room(interpreted):
    tree = tangle(1)
    solution, truth = solve(tree, interpreted=interpreted), Truth(tree)
    assert solution.nodes > 300
    low, high = solution.bounds
    assert low <= truth.probability() <= high
    assert {frozenset(one) for one in solution.cut_sets()} == truth.minimal()

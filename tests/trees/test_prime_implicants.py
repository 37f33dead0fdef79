"""Prime implicants against their definition: products that imply the top and no part of which does."""

import itertools

import pytest

from safety.trees import read, solve
from safety.trees.cut_sets.prime_implicants import PrimeImplicants
from safety.trees.kernel import load
from safety.trees.module_diagrams import TooLarge
from tests.oracles import SHARED
from tests.trees.random_trees import random_tree
from tests.trees.twin import holds

ARALIA = SHARED / "fault_trees" / "aralia"


def primes_of(tree):
    """All products over the events of `tree` that imply its top, without those that contain another."""
    names = [event.name for event in tree.events]
    truths = [
        {name for name, failed in zip(names, row, strict=True) if failed}
        for row in itertools.product((False, True), repeat=len(names))
    ]
    truths = {frozenset(row): holds(tree, tree.top, row) for row in truths}
    implicants = []
    for signs in itertools.product((None, True, False), repeat=len(names)):
        product = frozenset((name, sign) for name, sign in zip(names, signs, strict=True) if sign is not None)
        if all(true for row, true in truths.items() if all((name in row) == sign for name, sign in product)):
            implicants.append(product)
    found = set(implicants)
    return {product for product in found if not any(product - {literal} in found for literal in product)}


def listed(tree, **options):
    primes = PrimeImplicants(solve(tree), **options)
    products = list(primes)
    by_order = [0] * (max(map(len, products), default=-1) + 1)
    for product in products:
        by_order[len(product)] += 1
    assert primes.counts() == tuple(by_order) and len(set(products)) == len(products)
    return {frozenset(product) for product in products}


@pytest.mark.parametrize("coherent", [True, False])
def test_prime_implicants_of_random_trees(coherent):
    negated = 0
    for seed in range(100):
        tree = random_tree(seed, events=5, coherent=coherent)
        expected = primes_of(tree)
        assert listed(tree) == expected, seed
        negated += any(not plain for product in expected for _, plain in product)
    assert (negated > 20) != coherent


def test_those_of_a_coherent_tree_are_its_minimal_cut_sets():
    for seed in range(30):
        tree = random_tree(seed, events=12, coherent=True)
        assert listed(tree) == {frozenset((name, True) for name in one) for one in solve(tree).cut_sets()}


def test_compiled_and_interpreted_are_equal():
    for seed in range(30):
        tree = random_tree(seed, events=7, coherent=False)
        solution = solve(tree)
        assert list(PrimeImplicants(solution)) == list(PrimeImplicants(solution, interpreted=True))


def test_a_planted_error_is_found():
    """Without taking away what needs no literal, products that are not prime are listed."""
    from pathlib import Path

    source = Path(load("primes", interpreted=True).__file__).read_text(encoding="utf-8")
    right = "high, low = self.apply(WITHOUT, high, none), self.apply(WITHOUT, low, none)"
    assert right in source
    namespace = {}
    exec(compile(source.replace(right, "pass"), "primes", "exec"), namespace)
    wrong = 0
    for seed in range(40):
        tree = random_tree(seed, events=5, coherent=False)
        part = solve(tree).parts[-1]
        correct = load("primes").Primes(len(part.order), 10_000)
        broken = namespace["Primes"](len(part.order), 10_000)
        d = part.diagram
        wrong += len({p.family(p.of(d.level, d.high, d.low, d.root))[1] for p in (correct, broken)}) > 1
    assert wrong


def test_too_small_a_budget_is_said():
    with pytest.raises(TooLarge, match="need more than 3 nodes"):
        PrimeImplicants(solve(random_tree(3, events=8, coherent=False)), budget=3)


@pytest.mark.skipif(not ARALIA.is_dir(), reason=f"no oracles at {ARALIA}")
def test_a_public_tree_has_more_prime_implicants_than_cut_sets_only_if_it_is_not_coherent():
    chinese, das9601 = (solve(read(ARALIA / f"{name}.xml")) for name in ("chinese", "das9601"))
    assert PrimeImplicants(chinese).counts() == chinese.counts
    assert sum(PrimeImplicants(das9601).counts()) > sum(das9601.counts)

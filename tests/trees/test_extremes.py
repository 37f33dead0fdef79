"""Trees at the edge of what doubles, stacks and budgets hold."""

import math
import random
import threading
from fractions import Fraction

import pytest

from safety.trees import BasicEvent, FaultTree, Gate, kernel, solve


def tree(*gates, **chances):
    return FaultTree("t", gates[-1].name, gates, tuple(BasicEvent(name, q) for name, q in chances.items()))


def vote(k, n, q):
    names = tuple(f"e{i}" for i in range(n))
    return FaultTree("t", "top", (Gate("top", "vote", names, k),), tuple(BasicEvent(name, q) for name in names))


def assert_importance_as_in_rationals(found, rel=1e-9):
    exact = found.exact_importance()
    for name, measures in found.importance().items():
        for key, value in vars(measures).items():
            other = getattr(exact[name], key)
            if key == "event" or value is None or value == math.inf:
                assert value == other, (name, key)
            else:
                assert value == pytest.approx(float(other), rel=rel, abs=0), (name, key)


def test_importance_below_the_opposite_of_a_module_that_is_nearly_certain():
    parts = tuple("abcdefgh")
    gates = (Gate("m", "vote", parts, 6), Gate("n", "not", ("m",)), Gate("top", "and", ("n", "x")))
    found = solve(tree(*gates, **dict.fromkeys(parts, "0.999999999999"), x="0.5"))
    assert len(found.parts) > 1
    assert_importance_as_in_rationals(found)


def test_importance_where_both_conditional_probabilities_are_nearly_one():
    gates = (Gate("both", "and", ("a", "b")), Gate("top", "or", ("both", "c", "d")))
    assert_importance_as_in_rationals(solve(tree(*gates, a="0.3", b="0.4", c="0.9999999", d="0.9999999")))


def test_what_falls_below_the_smallest_double_is_enclosed():
    found = solve(vote(20, 40, "1e-20"))
    low, high = found.bounds
    assert low == 0 < found.exact < Fraction(high)
    product, first = next(found.likeliest_cut_sets())
    assert (product, len(first), sum(found.counts)) == (0.0, 20, math.comb(40, 20))


def test_the_likeliest_sets_come_first_even_where_their_products_vanish():
    found = solve(tree(Gate("p", "and", ("a", "b")), Gate("top", "or", ("p", "c")), a="1e-200", b="1e-200", c="1e-300"))
    assert [one for _, one in found.likeliest_cut_sets()] == [("c",), ("a", "b")]


@pytest.mark.parametrize(("k", "n"), [(100, 200), (1999, 2000), (2, 2000)])
def test_votes_over_many(k, n):
    found = solve(vote(k, n, "0.5"))
    assert found.counts[k] == sum(found.counts) == math.comb(n, k)
    exact = Fraction(sum(math.comb(n, i) for i in range(k, n + 1)), 2**n)
    low, high = map(Fraction, found.bounds)
    assert low <= exact <= high


def test_more_events_than_a_budget_has_nodes():
    with pytest.raises(RuntimeError, match="needs more than 2 nodes"):
        solve(vote(1, 50, "0.1"), budgets=(2,))


def test_compiled_work_on_cut_sets_lets_signals_in():
    """The pulse of a family is called while it works, and what it raises ends the work."""

    def pulse():
        raise KeyboardInterrupt

    rng, names = random.Random(3), [f"e{i}" for i in range(60)]
    gates = [Gate(f"g{i}", "or", tuple(rng.sample(names, 5))) for i in range(17)]
    gates.append(Gate("top", "and", tuple(gate.name for gate in gates)))
    found = solve(FaultTree("t", "top", tuple(gates), tuple(BasicEvent(name, "0.1") for name in names)))
    whole = max((part.diagram for part in found.parts), key=lambda diagram: diagram.nodes)
    families = kernel.load("families")
    assert not families.Family(whole.level, whole.high, whole.low, whole.root, 10**7).full
    with pytest.raises(KeyboardInterrupt):
        families.Family(whole.level, whole.high, whole.low, whole.root, 10**7, pulse)


@pytest.mark.parametrize("interpreted", [False, True])
def test_compiled_work_on_diagrams_lets_signals_in(interpreted, monkeypatch):
    def pulse():
        raise KeyboardInterrupt

    monkeypatch.setattr("safety.trees.module_diagrams.pulse", pulse)
    with pytest.raises(KeyboardInterrupt):
        solve(vote(2, 5, "0.1"), interpreted=interpreted)


def test_a_chain_deeper_than_any_stack():
    depth = 6000
    gates = [Gate("g1", "and", ("e0", "e1"))]
    gates += [Gate(f"g{i}", "or" if i % 2 else "and", (f"e{i}", f"g{i - 1}")) for i in range(2, depth)]
    gates.append(Gate("top", "xor", ("e0", f"g{depth - 1}")))
    threads = threading.active_count()
    found = solve(FaultTree("t", "top", tuple(gates), tuple(BasicEvent(f"e{i}", "0.1") for i in range(depth))))
    assert found.nodes > depth
    assert threading.active_count() == threads

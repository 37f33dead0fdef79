"""Equal parts that change places: fewer states, the same result; and parts that only look alike."""

from collections import Counter
from fractions import Fraction

import pytest

from safety.trees import TreeError
from safety.trees.dynamic import symmetry as dynamic_symmetry
from safety.trees.dynamic.solve import solve_dynamic
from safety.trees.dynamic.states import explore
from safety.trees.dynamic.tree import Dependency, DynamicGate, DynamicTree, TimedEvent
from safety.trees.formats.galileo import read_galileo
from tests.trees.failure_orders import transform
from tests.trees.random_dynamic import random_dynamic, renamed
from tests.trees.state_transform import states_transform

SOME = Fraction(1, 3)  # a point of the Laplace transform


def read(text):
    return read_galileo(text.encode(), "test.dft")


def copies(seed):
    """Two or three copies of a random tree below a gate, with an event before or after, at times with a common link."""
    one = random_dynamic(seed, 3, chances=seed % 2 == 0)
    count = 2 + seed % 2
    every = [renamed(one, f"{at}") for at in range(count)]
    tops = tuple(tree.top for tree in every)
    joint = DynamicGate("J", "vote", tops, 1 + seed % count)
    last = DynamicGate("T", ("pand", "por", "spare", "and")[seed % 4], (("J", "z"), ("z", "J"))[seed // 4 % 2])
    dependencies = [dependency for tree in every for dependency in tree.dependencies]
    if seed % 3 == 0:
        dependencies.append(Dependency("common", "z", tuple(f"{at}e0" for at in range(count))))
    triggers = [TimedEvent(f"{at}t", Fraction(1, 2)) for at in range(count)] if seed % 5 < 2 else []
    dependencies += [Dependency(f"{at}d", f"{at}t", (f"{at}e1",)) for at in range(len(triggers))]
    events = [event for tree in every for event in tree.events]
    return DynamicTree(
        "T",
        "T",
        (*(gate for tree in every for gate in tree.gates), joint, last),
        (*events, *triggers, TimedEvent("z", Fraction(1), dormancy=Fraction(1, 2))),
        tuple(dependencies),
        tuple(restriction for tree in every for restriction in tree.restrictions),
    )


def with_and_without_symmetry(seeds):
    for seed in seeds:
        tree = copies(seed)
        try:
            plain = explore(tree, symmetry=False)
        except TreeError:
            continue
        sorted_states = explore(tree)
        same = all(states_transform(plain, s) == states_transform(sorted_states, s) for s in (Fraction(0), SOME))
        yield ("smaller" if sorted_states.count < plain.count else "equal") if same else "differ"


def test_equal_parts_that_change_places_make_no_difference():
    counts = Counter(with_and_without_symmetry(range(40)))
    assert counts["differ"] == 0
    assert counts["smaller"] > 25


@pytest.mark.slow
def test_equal_parts_that_change_places_make_no_difference_in_many():
    assert "differ" not in with_and_without_symmetry(range(1000, 2000))


@pytest.mark.parametrize("more", ["B lambda=3;", "B lambda=1; D lambda=1; F fdep D B;", "B lambda=1; L seq A C;"])
def test_parts_that_are_not_alike_are_told_apart(monkeypatch, more):
    tree = read("toplevel T; T pand G C; G and A B; A lambda=1; C lambda=1;" + more)
    assert explore(tree).equal_events == ()
    assert states_transform(explore(tree), SOME) == transform(tree, SOME)
    monkeypatch.setattr(dynamic_symmetry, "_figures", lambda event: ())
    monkeypatch.setattr(dynamic_symmetry, "_described", lambda tree, place: set())
    monkeypatch.setattr(dynamic_symmetry, "_tied", lambda tree, name: [])
    monkeypatch.setattr(dynamic_symmetry, "_rows", lambda rules, block: [rules.row[name] for name in block])
    assert explore(tree).equal_events == (frozenset("AB"),)
    assert states_transform(explore(tree), SOME) != transform(tree, SOME)


def test_alike_events_keep_one_rate():
    tree = read("toplevel T; T pand G C; G and A B; A lambda=1; B lambda=1; C lambda=1;")
    assert explore(tree).equal_events == (frozenset("AB"),)
    solution = solve_dynamic(tree)
    assert (
        solution.with_rates({"A": 2, "B": 2}).ever
        == solve_dynamic(tree, symmetry=False).with_rates({"A": 2, "B": 2}).ever
    )
    with pytest.raises(TreeError, match="events A, B were taken to be alike"):
        solution.with_rates({"A": 2})
    apart = solve_dynamic(tree, symmetry=False).with_rates({"A": 2})
    assert (
        apart.ever == solve_dynamic(read("toplevel T; T pand G C; G and A B; A lambda=2; B lambda=1; C lambda=1;")).ever
    )

"""Cut sets in numbers and sizes beyond 64 bits and 64 events, and diagrams of cut sets that do not fit their budget."""

import gc
import json
import sys
from functools import partial
from math import comb

import pytest

from safety.commands import main
from safety.trees import BasicEvent, FaultTree, Gate, kernel, solve
from safety.trees import collector as collectors
from safety.trees.cut_sets import listing, truncated
from safety.trees.formats.files import write
from safety.trees.summary import summary
from tests.trees.random_trees import random_tree


def series_of_votes(stages, k, n, above=()):
    """All of `stages` votes k of n, each over events of its own, and below a last gate `above` (kind, k, events)."""
    gates = [Gate(f"v{i}", "vote", tuple(f"e{i}-{j}" for j in range(n)), k) for i in range(stages)]
    events = [name for gate in gates for name in gate.inputs]
    gates.append(Gate("all", "and", tuple(gate.name for gate in gates)))
    if above:
        kind, least, more = above
        gates.append(Gate("top", kind, ("all", *more), least))
        events += more
    return FaultTree("series", gates[-1].name, tuple(gates), tuple(BasicEvent(name, "0.1") for name in events))


@pytest.mark.parametrize("stages", [1, 5, 18, 19, 20, 39, 40, 150, 302, 303, 304, 305, 650])
def test_the_count_is_exact_on_both_sides_of_every_word_length(stages):
    assert solve(series_of_votes(stages, 2, 3)).counts == (0,) * (2 * stages) + (3**stages,)


def test_a_module_may_have_more_cut_sets_than_a_double_holds():
    counts = solve(series_of_votes(650, 2, 3, ("vote", 2, ("a", "b")))).counts
    assert counts == (0, 0, 1, *(0,) * 1298, 2 * 3**650)


@pytest.mark.parametrize("coherent", [True, False])
def test_counts_by_primes_are_those_in_whole_numbers(coherent):
    for seed in range(60):
        families = solve(random_tree(seed, 14, coherent))._families
        for family, variables in families.members.values():
            for many in (1, 7, 2**30, 2**33 + 5, 10**18, 10**60):
                weights = [(0, 1) if i % 3 else (0, many, 0, i) for i in range(len(variables))]
                assert listing._counts(family, weights) == listing._large_counts(family, weights)


def test_the_primes_are_primes_below_31_bits():
    assert len(set(listing.PRIMES)) == len(listing.PRIMES)
    for prime in listing.PRIMES:
        assert prime < 2**31
        assert all(prime % divisor for divisor in range(2, 46_341))


def test_cut_sets_of_many_events_are_listed_each_once():
    stages, tree = 60, series_of_votes(60, 2, 3, ("or", None, ("a",)))
    sets = []
    for one in solve(tree).cut_sets():
        sets.append(one)
        if len(sets) == 400:
            break
    assert sets[0] == ("a",)
    assert len(set(sets)) == 400
    for one in sets[1:]:
        assert len(one) == 2 * stages
        assert all(sum(name.startswith(f"e{i}-") for name in one) == 2 for i in range(stages))


def test_a_diagram_of_cut_sets_holds_no_node_left_over_from_the_work():
    for seed in range(80):
        for family, _ in solve(random_tree(seed, 14))._families.members.values():
            reached = {family.root}
            for i in range(family.count - 1, 1, -1):
                if i in reached:
                    reached |= {family.node[4 * i + 1], family.node[4 * i + 2]}
            assert reached >= set(range(2, family.count))


def rows_and_columns(size, coherent=True):
    """A tree whose cut sets need a far larger diagram than its probability does."""
    rows = [Gate(f"g{i}", "or", (f"r{i}", *(f"h{i}-{j}" for j in range(size)))) for i in range(size)]
    halves = [Gate(f"h{i}-{j}", "and", (f"c{j}", f"x{i}-{j}")) for i in range(size) for j in range(size)]
    names = [f"{letter}{i}" for letter in "rc" for i in range(size)]
    names += [f"x{i}-{j}" for i in range(size) for j in range(size)]
    if not coherent:
        halves.append(Gate("either", "xor", ("c0", "x0-0")))
        rows[0] = Gate("g0", "or", (*rows[0].inputs, "either"))
    top = Gate("top", "and", tuple(gate.name for gate in rows))
    return FaultTree("crossing", "top", (top, *rows, *halves), tuple(BasicEvent(name, "0.2") for name in names))


def test_without_room_for_all_cut_sets_the_probability_stands_and_the_short_sets_are_listed(monkeypatch, tmp_path):
    tree = rows_and_columns(7)
    whole = summary(tree)
    assert "note" not in whole
    monkeypatch.setattr(sys.modules["safety.trees.solve"], "FAMILY_BUDGET", 1)
    assert summary(tree)["minimal_cut_sets"] == whole["minimal_cut_sets"]  # all of them in another way
    few = partial(truncated.largest_order, budget=2_000)
    monkeypatch.setattr(truncated, "largest_order", few)
    entry = summary(tree)
    assert entry["probability"] == whole["probability"]
    assert entry["importance"] == whole["importance"]
    assert "minimal cut sets needs more than 1 nodes" in entry["note"]
    found = entry["minimal_cut_sets"]["by_order"]
    order = entry["minimal_cut_sets"]["limits"]["order"]
    assert found == {n: count for n, count in whole["minimal_cut_sets"]["by_order"].items() if int(n) <= order}
    write(tree, tmp_path / "t.xml")
    assert main(["tree", str(tmp_path / "t.xml"), "--json", str(tmp_path / "out.json")]) == 4
    (written,) = json.loads((tmp_path / "out.json").read_text())["trees"]
    assert written["probability_low"] <= whole["probability"] <= written["probability_high"]
    assert written["minimal_cut_sets"] == entry["minimal_cut_sets"]
    assert written["note"] == entry["note"]


def test_without_room_for_the_positive_parts_of_a_tree_with_xor_none_are_given(monkeypatch):
    tree = rows_and_columns(7, coherent=False)
    whole = summary(tree)
    monkeypatch.setattr(sys.modules["safety.trees.solve"], "FAMILY_BUDGET", 1)
    entry = summary(tree)
    assert (entry["probability"], entry["minimal_cut_sets"]) == (whole["probability"], None)
    assert "minimal cut sets needs more than" in entry["note"]


def test_a_vote_of_many_has_every_choice():
    names = tuple(f"e{i}" for i in range(90))
    tree = FaultTree("v", "v", (Gate("v", "vote", names, 45),), tuple(BasicEvent(name, "0.1") for name in names))
    assert solve(tree).counts == (0,) * 45 + (comb(90, 45),)


def test_a_signal_ends_the_search_for_prime_implicants():
    """What the interpreter raises when it looks at signals comes out of compiled code, and soon."""
    calls = []

    def pulse():
        calls.append(1)
        if len(calls) == 2:
            raise KeyboardInterrupt

    solution = solve(rows_and_columns(9, coherent=False))
    diagram = solution.parts[-1].diagram
    primes = kernel.load("primes").Primes(len(solution.parts[-1].order), 20_000_000, pulse)
    with pytest.raises(KeyboardInterrupt):
        primes.of(diagram.level, diagram.high, diagram.low, diagram.root)
    assert len(calls) == 2


@pytest.mark.parametrize("was", [True, False])
def test_the_collector_is_left_as_it_was(was):
    before = gc.isenabled()
    try:
        (gc.enable if was else gc.disable)()
        with pytest.raises(ZeroDivisionError), collectors.paused():
            assert not gc.isenabled()
            raise ZeroDivisionError
        assert gc.isenabled() is was
    finally:
        (gc.enable if before else gc.disable)()


@pytest.mark.parametrize(
    ("values", "named", "said"),
    [
        (("a", 1, 2, 3, "", "", (), None, 9), {}, "BasicEvent has 8 fields, 9 values were given"),
        (("a",), {"name": "b"}, "BasicEvent: name is given twice"),
        ((), {"source": "P"}, "BasicEvent: name is missing"),
        (("a",), {"chance": 1}, "BasicEvent has no field 'chance'"),
        ((), {"chance": 1}, "BasicEvent: name is missing"),
    ],
)
def test_a_record_made_of_wrong_values_says_which(values, named, said):
    with pytest.raises(TypeError, match=said):
        BasicEvent(*values, **named)

"""Parts solved apart: the same figures as the tree as one chain, and a part that is not sound would show."""

from fractions import Fraction

import pytest

from safety.trees import TreeError
from safety.trees.dynamic import modules as dynamic_modules
from safety.trees.dynamic.chain import FailureChain
from safety.trees.dynamic.modules import parts, whole
from safety.trees.dynamic.solve import solve_dynamic
from safety.trees.dynamic.states import explore
from safety.trees.dynamic.tree import Dependency, DynamicGate, DynamicTree, Restriction
from safety.trees.formats.galileo import read_galileo
from tests.trees.random_dynamic import random_dynamic, renamed


def read(text):
    return read_galileo(("toplevel T; " + text).encode(), "test.dft")


RATES = "".join(f"{name} lambda={at}/7 dorm=0.5;" for at, name in enumerate("ABCDEFG", 2))


def shape(tree):
    return [(part.name, "static" if part.static else "chain") for part in parts(tree)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("T or P C; P pand A B;", [("P", "chain"), ("T", "static")]),
        ("T 2of3 P Q C; P pand A B; Q wsp D E;", [("P", "chain"), ("Q", "chain"), ("T", "static")]),
        ("T and X Y; X or P C; Y or P D; P pand A B;", [("P", "chain"), ("T", "static")]),
        ("T or P C; P pand A B; Y fdep C B;", [("T", "chain")]),  # a trigger in the rest
        ("T and P C D; P pand A B; Y fdep C B;", [("T/1", "chain"), ("T", "static")]),  # grouped with it
        ("T and P Q C D; P pand A B; Y fdep C B; Q pand E F;", [("T/1", "chain"), ("Q", "chain"), ("T", "static")]),
        ("T and P Q; P pand A B; Q pand D E; Y fdep G B; Z fdep G D;", [("T", "chain")]),  # a common trigger
        ("T or P Q; P wsp A C; Q wsp B C;", [("T", "chain")]),  # a common spare unit
        ("T or P C; P pand X B; X and C A;", [("T", "chain")]),  # a common event
        ("T pand P C; P wsp A B;", [("T", "chain")]),  # below a dynamic gate
        ("T or P C D; P wsp A B; S seq P C;", [("T/1", "chain"), ("T", "static")]),
        ("T or P C; P wsp A B; S seq C T;", [("T", "chain")]),
        ("T or C D; P pand C D;", [("T", "static")]),  # what the top does not look at
        ("T or C D; Y fdep A B;", [("T", "static")]),
    ],
)
def test_what_is_cut_out(text, expected):
    tree = read(text + "".join(rate + ";" for rate in RATES.split(";") if rate and rate[0] in text))
    assert shape(tree) == expected
    equal_to_one_chain(tree)


def equal_to_one_chain(tree):
    """Whether the parts give what the whole tree as one chain gives. Raises TreeError where a tie decides."""
    chain, solution = FailureChain(explore(whole(tree))), solve_dynamic(tree)
    pairs = zip(chain.probabilities([1, 4]), solution.probabilities([1, 4]), strict=True)
    same = all(one.overlaps(other) for one, other in pairs) and chain.ever.overlaps(solution.ever)
    return same and chain.mean_time == solution.mean_time()


def joined(seed):
    """Two random trees side by side below one gate, at times with a link between them."""
    one, other = random_dynamic(seed, 4, chances=False), random_dynamic(seed + 10**6, 3, chances=False)
    other = renamed(other, "x")
    gates = (*one.gates, *other.gates, DynamicGate("T", ("and", "or")[seed % 2], (one.top, other.top)))
    dependencies = [*one.dependencies, *other.dependencies]
    restrictions = [*one.restrictions, *other.restrictions]
    if seed % 4 == 0:
        dependencies.append(Dependency("link", "e0", ("xe1",)))
    if seed % 7 == 0:
        restrictions.append(Restriction("order", "seq", ("e1", "xe0")))
    return DynamicTree("T", "T", gates, (*one.events, *other.events), tuple(dependencies), tuple(restrictions))


def comparisons(seeds):
    for seed in seeds:
        try:
            yield "same" if equal_to_one_chain(joined(seed)) else "differ"
        except TreeError:
            yield "refused"


def test_parts_are_equal_to_one_chain():
    found = list(comparisons(range(60)))
    assert "differ" not in found and found.count("refused") < 8
    several = [seed for seed in range(60) if len(parts(joined(seed))) > 1]
    assert len(several) > 25


@pytest.mark.slow
def test_parts_are_equal_to_one_chain_on_many():
    assert "differ" not in comparisons(range(1000, 2000))


@pytest.mark.parametrize(
    ("condition", "wrong"),
    [
        ("is_module", lambda links, name: True),
        ("tied", set()),
        ("set_of", lambda links, name: links.tree.below[name]),
        ("component", lambda links, start, without: set(links.tree.below[start])),
    ],
)
def test_a_part_that_is_not_sound_is_found_by_that_comparison(monkeypatch, condition, wrong):
    monkeypatch.setattr(dynamic_modules._Links, condition, wrong)
    assert any(found != "same" for found in wrong_parts([*range(0, 100, 4), *range(7, 200, 7)]))


def wrong_parts(seeds):
    """As `comparisons`, of trees that are not refused by themselves; "refused" is then the fault of the parts."""
    for seed in seeds:
        tree = joined(seed)
        try:
            explore(whole(tree))
        except TreeError:
            continue
        yield from comparisons([seed])


def test_the_mean_time_of_a_tree_in_parts_by_hand():
    tree = read("T and P C; P wsp A B; A lambda=1; B lambda=1 dorm=0; C lambda=1;")
    solution = solve_dynamic(tree)
    assert [part.name for part in solution.parts] == ["P", "T"]
    assert solution.mean_time().low == 2 + Fraction(1, 4)

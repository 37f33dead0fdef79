"""Page breaks: as few as can be, shared gates drawn once, small branches together, wide gates continued."""

import itertools
import random

import pytest

from safety.report import tree_breaks
from safety.report.tree_breaks import NODES, WIDE, Branch, pages

Gates = dict[str, list[str]]


def small(seed: int) -> Gates:
    """A tree without shared gates, up to nine gates of one to four inputs."""
    chance = random.Random(seed)
    gates: Gates = {"g0": []}
    for n in range(1, chance.randint(1, 9)):
        gates[f"g{n}"] = []
        gates[chance.choice([name for name in gates if name != f"g{n}" and len(gates[name]) < 4])].append(f"g{n}")
    for name, inputs in gates.items():
        inputs += [f"{name} e{n}" for n in range(chance.randint(0 if inputs else 1, 4 - len(inputs)))]
    return gates


def least_cuts(gates: Gates, room: int) -> int:
    """The least number of gates that have to be cut off so that no part has more than `room` cards: by trying all."""

    def weight(name: str, cut: set[str]) -> int:
        return 1 + sum(weight(below, cut) if below in gates and below not in cut else 1 for below in gates[name])

    below_top = [name for name in gates if name != "g0"]
    for count in range(len(gates)):
        for some in itertools.combinations(below_top, count):
            if all(weight(name, set(some)) <= room for name in ("g0", *some)):
                return count
    raise AssertionError("a gate alone is too wide")


def transfers(plan: list[list[Branch]]) -> list[str]:
    return [branch.name for page in plan for root in page for branch in root.subtree() if branch.is_transfer]


@pytest.mark.parametrize("seed", range(40))
def test_a_tree_is_broken_as_rarely_as_possible(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    monkeypatch.setattr(tree_breaks, "NODES", 7)
    gates = small(seed)
    assert len(transfers(pages(["g0"], gates))) == least_cuts(gates, 7)


def test_breaking_at_the_lightest_branch_instead_needs_more(monkeypatch: pytest.MonkeyPatch) -> None:
    def lighten(gate: Branch, cut: dict[tuple[str, int], Branch]) -> None:
        for branch in sorted(gate.inputs, key=lambda one: one.weight):
            if gate.weight > 7 and branch.weight > 1:
                cut[branch.key] = branch
                gate.inputs[gate.inputs.index(branch)] = Branch(branch.name, branch.first, is_transfer=True)
                gate.weight -= branch.weight - 1

    monkeypatch.setattr(tree_breaks, "NODES", 7)
    monkeypatch.setattr(tree_breaks, "_lighten", lighten)
    assert any(len(transfers(pages(["g0"], small(seed)))) > least_cuts(small(seed), 7) for seed in range(40))


def test_a_shared_gate_is_drawn_at_its_use_nearest_to_the_top() -> None:
    gates = {"top": ["deep", "shared"], "deep": ["deeper", "e"], "deeper": ["shared"], "shared": ["a", "b"]}
    ((top,),) = pages(["top"], gates)
    assert [branch.name for branch in top.inputs[1].inputs] == ["a", "b"]
    assert [branch.name for branch in top.subtree() if branch.is_transfer] == ["shared"]


def test_a_wide_gate_is_continued_page_by_page() -> None:
    names = [f"e{n}" for n in range(3 * WIDE)]
    plan = pages(["top"], {"top": names})
    parts = [root for page in plan for root in page]
    assert [root.name for root in parts] == ["top"] * len(plan) and len(plan) > 3
    assert [branch.name for root in parts for branch in root.inputs if not branch.is_transfer] == names
    assert [(root.first, root.last) for root in parts] == [
        *itertools.pairwise([root.first for root in parts] + [len(names)])
    ]
    assert all(root.weight <= NODES for root in parts)


def test_what_is_beside_the_first_tree_shares_its_page_where_there_is_room() -> None:
    gates = {"top": ["a", "b"], "link": ["a", "top"], "lone": [f"e{n}" for n in range(NODES)]}
    assert [[root.name for root in page] for page in pages(["top", "link", "lone"], gates)] == [
        ["top", "link"],
        ["lone"],
    ]


def test_what_nothing_reaches_is_left_out() -> None:
    ((top,),) = pages(["top"], {"top": ["a"], "stray": ["b"]})
    assert [branch.name for branch in top.subtree()] == ["top", "a"]

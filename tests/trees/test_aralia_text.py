"""Aralia text: what its signs mean."""

from fractions import Fraction
from itertools import combinations

import pytest

from safety.trees import read
from safety.trees.formats.aralia_text import read_aralia
from safety.trees.formats.files import read_study

MEANINGS = {
    "a & b | c": lambda a, b, c: (a and b) or c,
    "a | b & c": lambda a, b, c: a or (b and c),
    "~a | -b & !c": lambda a, b, c: (not a) or (not b and not c),
    "~(a & b) & c": lambda a, b, c: not (a and b) and c,
    "a ^ b ^ c": lambda a, b, c: (a + b + c) % 2 == 1,
    "a # b": lambda a, b, c: a != b,
    "(a ^ b) | c": lambda a, b, c: a != b or c,
    "a & b => c": lambda a, b, c: not (a and b) or c,
    "a => b <=> c": lambda a, b, c: (not a or b) == c,
    "@(2, [a, b, c])": lambda a, b, c: a + b + c >= 2,
    "@(1, [a & b, ~c])": lambda a, b, c: (a and b) or not c,
    "#(1, 2, [a, b, c])": lambda a, b, c: 1 <= a + b + c <= 2,
    "#(0, 1, [a, b, c])": lambda a, b, c: a + b + c <= 1,
    "#(2, 3, [a, b, c])": lambda a, b, c: a + b + c >= 2,
    '("a")': lambda a, b, c: a,
    "a /* | b */ // | c\n": lambda a, b, c: a,
}


@pytest.mark.parametrize("formula", MEANINGS)
@pytest.mark.parametrize("end", [";", "\n"])
def test_formulas(formula, end):
    events = "".join(f"p({name}) = 0.5{end}" for name in "abc")
    tree = read_aralia(f"g := {formula}{end}{events}".encode(), "f").finish(None)
    for failed in (set(s) for n in range(4) for s in combinations("abc", n)):
        assert tree.occurs(failed) == MEANINGS[formula](*(e in failed for e in "abc")), failed


def test_limits_inside_of_limits_do_not_double():
    formula = "a"
    for _ in range(40):
        formula = f"#(1, 1, [{formula}, b])"
    tree = read_aralia(f"g := {formula};".encode(), "f").finish(None)
    assert len(tree.gates) == 40 * 4
    assert tree.occurs({"a"})
    assert not tree.occurs(set())


def test_values_names_and_title(tmp_path):
    path = tmp_path / "t.dag"
    path.write_text(
        'My-tree\ntop := g.1 | "odd name" & h\ng.1 := ~pump-1\np(pump-1) = 1/3\np("odd name") = .25\ns(h) = true\n'
    )
    tree = read(path)
    assert (tree.name, tree.top) == ("My-tree", "top")
    assert {event.name: event.probability for event in tree.events} == {
        "pump-1": Fraction(1, 3),
        "odd name": Fraction(1, 4),
    }
    assert tree.house_events[0].state is True
    assert tree.nodes["top/2"].inside == "top"
    assert read_study(path).tops == ("top",)


def test_an_event_without_a_value_has_no_known_probability():
    tree = read_aralia(b"g := a | b; p(a) = 1;", "f").finish(None)
    assert [(event.name, event.chance) for event in tree.events] == [("b", None), ("a", (1.0, 0.0))]

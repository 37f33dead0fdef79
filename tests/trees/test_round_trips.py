"""Writing and reading again: what each format holds comes back equal, whatever the names; the rest is refused."""

from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent, TreeError, read
from safety.trees.expressions.distributions import Histogram, Lognormal, Uniform
from safety.trees.expressions.expression import Constant, MissionTime, Operation, Parameter
from safety.trees.expressions.lifetimes import Exponential, Glm, Weibull
from safety.trees.formats.aralia_text import read_aralia, to_aralia
from safety.trees.formats.dot import to_dot
from safety.trees.formats.files import text, write
from safety.trees.formats.json_form import read_json
from safety.trees.formats.mef import read_mef
from safety.trees.formats.mef_names import PLAIN, decoded, encoded
from safety.trees.formats.xml_elements import parse
from tests.trees.twin import trees

NAMES = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=5) | st.from_regex(
    r"(_x00[0-9A-F]{2}_|[a-z][-./]?|é|漢|\n){1,4}", fullmatch=True
)
LABELS = st.text("aß& <>\"'µ☃", max_size=6).map(lambda text: " ".join(text.split()))
FRACTIONS = st.fractions(0, 1, max_denominator=1000)


@st.composite
def odd_trees(draw, **kinds):
    """Trees of any names."""
    tree = draw(trees(**kinds))
    names = [node.name for node in (*tree.gates, *tree.events, *tree.house_events)]
    new = dict(zip(names, draw(st.lists(NAMES, min_size=len(names), max_size=len(names), unique=True)), strict=True))
    return FaultTree(
        draw(NAMES),
        new[tree.top],
        tuple(replace(g, name=new[g.name], inputs=tuple(new[n] for n in g.inputs)) for g in tree.gates),
        tuple(replace(event, name=new[event.name]) for event in tree.events),
        tuple(replace(house, name=new[house.name]) for house in tree.house_events),
    )


def as_mef(tree, time=None):
    return read_mef([parse(text(tree, ".xml").encode(), "f")], time).finish(tree.top)


def as_json(tree):
    return read_json(text(tree, ".json").encode(), "f").finish(tree.top)


def as_aralia(tree):
    return read_aralia(to_aralia(tree).encode(), "f").finish(tree.top)


def plain(gate, mef=True):
    """What a gate is read as that has a plainer form."""
    count = len(gate.inputs)
    if (mef or gate.kind != "vote") and gate.kind != "not" and (count == 1 or (gate.kind == "vote" and gate.k == 1)):
        return replace(gate, kind="or", k=None)
    return replace(gate, kind="and", k=None) if mef and gate.kind == "vote" and gate.k == count else gate


def same_function(one, other):
    events = [event.name for event in one.events]
    return all(one.occurs(s) == other.occurs(s) for n in range(len(events) + 1) for s in combinations(events, n))


@settings(max_examples=60, deadline=None)
@given(odd_trees(), LABELS, st.sampled_from(["", "P", "D", "A", "R"]), st.dictionaries(NAMES, LABELS.filter(bool)))
def test_json_and_mef_hold_a_tree_of_any_names(tree, label, source, attributes):
    pairs = tuple(pair for pair in attributes.items() if pair[0] != "source")
    tree = replace(
        tree,
        description=label,
        gates=tuple(replace(gate, description=label, attributes=pairs) for gate in tree.gates),
        events=tuple(replace(e, description=label, source=source, attributes=pairs) for e in tree.events),
        house_events=tuple(replace(house, description=label, attributes=pairs) for house in tree.house_events),
    )
    assert as_json(tree) == tree
    back = as_mef(tree)
    assert same_function(tree, back)
    if all(gate.kind != "xor" or len(gate.inputs) <= 2 for gate in tree.gates):
        assert back == replace(tree, gates=tuple(map(plain, tree.gates)))


@settings(max_examples=60, deadline=None)
@given(odd_trees())
def test_aralia_text_holds_a_tree_of_any_names(tree):
    assert as_aralia(tree) == replace(tree, gates=tuple(plain(gate, mef=False) for gate in tree.gates))


LEAVES = st.sampled_from([*"abc", "h"]).map(lambda name: f'<event name="{name}"/>') | st.just(
    '<constant value="true"/>'
)


def _formulas(inner):
    few = st.lists(inner, min_size=2, max_size=3, unique=True)
    return st.one_of(
        inner.map("<not>{}</not>".format),
        few.map(lambda p: f"<and>{''.join(p)}</and>"),
        few.map(lambda p: f"<nor>{''.join(p)}</nor>"),
        few.map(lambda p: f'<atleast min="{len(p) - 1}">{"".join(p)}</atleast>'),
        few.map(lambda p: f"<xor>{''.join(p[:2])}</xor>"),
        few.map(lambda p: f"<imply>{''.join(p[:2])}</imply>"),
        few.map(lambda p: f'<cardinality min="1" max="1">{"".join(p)}</cardinality>'),
    )


@settings(max_examples=60, deadline=None)
@given(st.recursive(LEAVES, _formulas, max_leaves=12))
def test_formulas_inside_formulas_come_back(formula):
    events = "".join(f'<define-basic-event name="{e}"><float value="0.1"/></define-basic-event>' for e in "abc")
    file = f'<opsa-mef><define-fault-tree name="t"><define-gate name="top">{formula}</define-gate>{events}'
    file += '<define-house-event name="h"/></define-fault-tree></opsa-mef>'
    tree = read_mef([parse(file.encode(), "f")], None).finish("top")
    assert as_json(tree) == tree
    once, through_text = as_mef(tree), as_aralia(tree)
    assert same_function(tree, once)
    assert same_function(tree, through_text)
    assert as_mef(once) == once
    assert as_aralia(through_text) == through_text


def test_a_formula_used_twice_is_written_once():
    tree = read_aralia(b"g := #(1, 1, [a & b, c]); p(a) = 0.1; p(b) = 0.1; p(c) = 0.1;", "f").finish("g")
    for back in (as_mef(tree), as_aralia(tree)):
        assert {gate.name for gate in back.gates} == {"g", "g/1", "g/1/1", "g/2", "g/2/1"}
        assert same_function(tree, back)


@given(NAMES)
def test_any_name_becomes_an_identifier_and_comes_back(name):
    assert PLAIN.fullmatch(encoded(name))
    assert decoded(encoded(name)) == name


def test_names_as_written():
    assert [encoded(name) for name in ("pump-1", "a.b", "top/1", "2oo3", "Tür", "_x0041_", "-", "a--b")] == [
        "pump-1", "a_x002E_b", "top_x002F_1", "_x0032_oo3", "Tür", "_x005F_x0041_", "_x002D_", "a-_x002D_b",
    ]  # fmt: skip


RATE = Parameter("λ", Lognormal("1e-6", 3, "0.95"), "hours-1")
EXPRESSIONS = st.recursive(
    st.sampled_from(
        [
            Parameter("λ", Lognormal("1e-6", 3, "0.95")),
            Parameter("p", Constant("0.5")),
            Constant("1/3"),
            MissionTime(),
            Uniform("0.1", "0.2"),
        ]
    ),
    lambda inner: st.one_of(
        st.tuples(st.sampled_from(["add", "mul", "div", "min", "max", "mean"]), inner, inner).map(
            lambda a: Operation(*a)
        ),
        st.tuples(inner, inner, inner).map(lambda a: Operation("ite", Operation("lt", a[0], a[1]), a[1], a[2])),
        st.tuples(inner, inner, inner).map(lambda a: Operation("switch", Operation("geq", a[0], a[1]), a[1], a[2])),
        inner.map(lambda a: Operation("exp", Operation("neg", a))),
    ),
    max_leaves=5,
)


@settings(max_examples=60, deadline=None)
@given(EXPRESSIONS)
def test_expressions_come_back(expression):
    try:
        event = BasicEvent("e", expression=expression)
        tree = FaultTree("t", "g", (Gate("g", "or", ("e",)),), (event,), mission_time_h=100)
    except TreeError:  # no probability
        assume(False)
    assert as_json(tree) == tree
    back = as_mef(tree, Fraction(100))
    assert back.events[0].chance == pytest.approx(tree.events[0].chance, rel=1e-14, abs=1e-300)
    assert as_mef(back, Fraction(100)) == back
    if expression.parameters and "'div'" not in repr(expression):  # a quotient of two numbers is read as a number
        assert back == tree


@pytest.mark.parametrize(
    "expression",
    [
        Exponential(RATE, MissionTime()),
        Glm(0, RATE, "0.1", MissionTime()),
        Weibull(1000, 2, Parameter("shift", Constant(1), "hours"), 50),
        Histogram(0, 1, "0.1", 2, "0.3"),
        Operation("mul", Operation("pi"), "0.1", RATE),
    ],
)
def test_lifetimes_and_distributions_come_back(expression):
    tree = FaultTree(
        "t", "g", (Gate("g", "or", ("e",)),), (BasicEvent("e", expression=expression),), mission_time_h=100
    )
    assert as_json(tree) == tree
    assert as_mef(tree, Fraction(100)) == tree


@given(st.fractions(0, 10**6), st.sampled_from([None, Fraction(10), Fraction(1, 3)]))
def test_rates_come_back(rate, time):
    tree = FaultTree("t", "g", (Gate("g", "or", ("e",)),), (BasicEvent("e", None, rate, time),), mission_time_h=50)
    assert as_json(tree) == tree
    assert as_mef(tree, Fraction(50)) == tree


def test_what_a_format_cannot_hold_is_refused():
    rated = FaultTree("t", "g", (Gate("g", "or", ("e",)),), (BasicEvent("e", None, 1, 1),))
    with pytest.raises(TreeError, match='basic event "e" has a rate or an expression, Aralia text holds probabilities'):
        to_aralia(rated)
    nameless = FaultTree("t", "g", (Gate("g", "or", ("",)),), (BasicEvent("", 1),))
    with pytest.raises(TreeError, match="a name is empty, which MEF cannot hold"):
        text(nameless, ".xml")
    bell = replace(rated, description="\a")
    with pytest.raises(TreeError, match=r"holds '\\x07', which XML cannot hold"):
        text(bell, ".xml")


def test_a_lone_surrogate_reaches_no_file(tmp_path):
    tree = FaultTree("\ud800", "g", (Gate("g", "or", ("h",)),), (), (HouseEvent("h", True),))
    with pytest.raises(TreeError, match="which no file can hold"):
        write(tree, tmp_path / "t.json")
    assert not (tmp_path / "t.json").exists()


@pytest.mark.parametrize("ending", [".json", ".xml", ".mef", ".dag", ".txt", ".dft"])
def test_the_ending_of_the_path_says_the_format(tmp_path, ending):
    tree = FaultTree("g", "g", (Gate("g", "vote", ("a", "b", "c"), 2),), tuple(BasicEvent(e, "0.1") for e in "abc"))
    write(tree, tmp_path / f"t{ending}")
    assert read(tmp_path / f"t{ending}") == tree


def test_dot():
    events = (BasicEvent('a"\\', "0.01", attributes=(("flavor", "undeveloped"),)), BasicEvent("unused", "0.1"))
    tree = FaultTree("t", "g", (Gate("g", "vote", ('a"\\', "h"), 2, "two"),), events, (HouseEvent("h", True),))
    assert to_dot(tree).splitlines()[3:] == [
        r' "g" [shape=box, label="g\ntwo\n2 of 2"];',
        r' "a\"\\" [shape=diamond, label="a\"\\\n0.01"];',
        r' "h" [shape=house, label="h\ntrue"];',
        r' "g" -> "a\"\\";',
        ' "g" -> "h";',
        "}",
    ]

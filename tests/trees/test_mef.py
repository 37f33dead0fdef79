"""What Open-PSA MEF says beside plain gates: constants, scopes, expressions, common cause, substitutions, phases."""

from fractions import Fraction
from itertools import combinations

import pytest

from safety.trees import BasicEvent, TreeError, solve
from safety.trees.expressions.expression import Constant, MissionTime, Parameter
from safety.trees.expressions.lifetimes import Exponential
from safety.trees.formats.files import read, read_study
from safety.trees.study import Alignment, Phase, Study
from safety.trees.substitutions import Substitution
from safety.trees.tree import Gate

EVENTS = "".join(
    f'<define-basic-event name="{e}"><float value="0.{n}"/></define-basic-event>' for n, e in enumerate("abc", 1)
)
TOP_OF_A = '<define-gate name="g"><or><basic-event name="a"/></or></define-gate>'
REFERENCES = {e: f'<basic-event name="{e}"/>' for e in "abc"}


def put(folder, body, name="f.xml"):
    path = folder / name
    path.write_text(f"<opsa-mef>{body}</opsa-mef>")
    return path


FORMULAS = {
    '<cardinality min="1" max="2">{a}{b}{c}</cardinality>': lambda a, b, c: 1 <= a + b + c <= 2,
    '<cardinality min="0" max="1">{a}{b}{c}</cardinality>': lambda a, b, c: a + b + c <= 1,
    '<cardinality min="2" max="3">{a}{b}{c}</cardinality>': lambda a, b, c: a + b + c >= 2,
    '<cardinality min="0" max="3">{a}{b}{c}</cardinality>': lambda a, b, c: True,
    '<cardinality min="2" max="2">{a}<not>{b}</not>{c}</cardinality>': lambda a, b, c: a + (not b) + c == 2,
    '<or>{a}<constant value="false"/></or>': lambda a, b, c: a,
    '<constant value="true"/>': lambda a, b, c: True,
    '<iff><and>{a}<constant value="1"/></and><imply>{b}{c}</imply></iff>': lambda a, b, c: a == (not b or c),
    '<xor><xor>{a}{b}</xor>{c}</xor>': lambda a, b, c: (a + b + c) % 2 == 1,
}  # fmt: skip


@pytest.mark.parametrize("formula", FORMULAS)
def test_formulas(tmp_path, formula):
    tree = read(put(tmp_path, f'<define-gate name="top">{formula.format(**REFERENCES)}</define-gate>{EVENTS}'))
    for failed in (set(s) for n in range(4) for s in combinations("abc", n)):
        assert tree.occurs(failed) == FORMULAS[formula](*(e in failed for e in "abc")), failed


def test_a_constant_takes_a_name_that_is_free(tmp_path):
    formula = '<or><basic-event name="true"/><constant value="true"/><not><constant value="true"/></not></or>'
    tree = read(put(tmp_path, f'<define-gate name="g">{formula}</define-gate><define-basic-event name="true"/>'))
    assert tree.nodes["g"].inputs == ("true", "constant true", "g/3")
    assert [house.name for house in tree.house_events] == ["constant true"]


COMPONENTS = """
<define-fault-tree name="Train">
  <define-gate name="top"><or><gate name="left.fails"/><gate name="right.fails"/><gate name="open"/></or></define-gate>
  <define-component name="left" role="private">
    <define-gate name="fails"><or><basic-event name="pump"/><basic-event name="power"/></or></define-gate>
    <define-basic-event name="pump"><parameter name="p"/></define-basic-event>
    <define-parameter name="p"><float value="0.1"/></define-parameter>
  </define-component>
  <define-component name="right" role="private">
    <define-gate name="fails"><or><basic-event name="pump"/><basic-event name="Train.power"/></or></define-gate>
    <define-basic-event name="pump"><parameter name="p"/></define-basic-event>
    <define-parameter name="p"><float value="0.2"/></define-parameter>
    <define-gate name="open" role="public"><or><basic-event name="Train.left.pump"/></or></define-gate>
  </define-component>
  <define-basic-event name="power"><float value="0.5"/></define-basic-event>
</define-fault-tree>
"""


def test_private_definitions_are_known_by_their_paths(tmp_path):
    study = read_study(put(tmp_path, COMPONENTS))
    gates = {gate.name: gate.inputs for gate in study.gates}
    assert gates == {
        "top": ("Train.left.fails", "Train.right.fails", "open"),
        "Train.left.fails": ("Train.left.pump", "power"),
        "Train.right.fails": ("Train.right.pump", "power"),
        "open": ("Train.left.pump",),
    }
    assert [event.chance[0] for event in study.events] == [0.1, 0.2, 0.5]
    assert list(study.parameters) == ["Train.left.p", "Train.right.p"]
    assert study.tops == ("top",)


def test_public_definitions_have_paths_too(tmp_path):
    body = f"""<define-fault-tree name="t">
    <define-gate name="g"><or><gate name="c.h"/><gate name="t.c.h"/></or></define-gate>
    <define-component name="c"><define-gate name="h"><or><basic-event name="t.a"/></or></define-gate></define-component>
    {EVENTS}</define-fault-tree>"""
    with pytest.raises(TreeError, match=r'gate "g" \(or\) has the input "h" more than once'):
        read(put(tmp_path, body))
    tree = read(put(tmp_path, body.replace('<gate name="c.h"/>', "")))
    assert {gate.name: gate.inputs for gate in tree.gates} == {"g": ("h",), "h": ("a",)}


def test_a_document_type_that_defines_nothing_is_harmless(tmp_path):
    (tmp_path / "f").write_text(f"<!DOCTYPE opsa-mef>\n<opsa-mef>{EVENTS}{TOP_OF_A}</opsa-mef>")
    assert read(tmp_path / "f").top == "g"


def test_the_innermost_meaning_is_taken(tmp_path):
    body = f"""<define-fault-tree name="t"><define-component name="c">
      <define-gate name="g"><or><basic-event name="a"/></or></define-gate>
      <define-basic-event name="a" role="private"><float value="0.9"/></define-basic-event>
    </define-component></define-fault-tree><model-data>{EVENTS}</model-data>"""
    assert read(put(tmp_path, body)).nodes["g"].inputs == ("t.c.a",)


def test_the_names_that_a_private_meaning_would_hide_are_asked_for(tmp_path):
    body = COMPONENTS.replace('name="power"><float', 'name="power" role="private"><float') + (
        '<model-data><define-basic-event name="power"/></model-data>'
    )
    with pytest.raises(TreeError, match=r'"power" may mean Train.power or power; write its full path'):
        read_study(put(tmp_path, body))


def test_numbers_stay_exact_and_richer_expressions_stay_expressions(tmp_path):
    body = """<define-gate name="g">
    <or><event name="third"/><event name="sure"/><event name="rated"/><event name="par"/></or></define-gate>
    <define-basic-event name="third"><div><int value="1"/><int value="3"/></div></define-basic-event>
    <define-basic-event name="sure"><bool value="true"/></define-basic-event>
    <define-basic-event name="rated">
    <exponential><mul><float value="2"/><float value="1e-6"/></mul><system-mission-time/></exponential>
    </define-basic-event>
    <define-basic-event name="par"><exponential><parameter name="r"/><system-mission-time unit="hours"/></exponential>
    </define-basic-event>
    <define-parameter name="r" unit="hours-1"><float value="1e-3"/></define-parameter>"""
    tree = read(put(tmp_path, body), mission_time_h=10)
    rate = Parameter("r", Constant("1e-3"), "hours-1")
    assert tree.events == (
        BasicEvent("third", Fraction(1, 3)),
        BasicEvent("sure", 1),
        BasicEvent("rated", None, Fraction(2, 10**6), 10),
        BasicEvent("par", mission_time_h=10, expression=Exponential(rate, MissionTime())),
    )


def test_attributes_are_kept_and_the_source_tag_is_understood(tmp_path):
    attributes = '<attributes><attribute name="source" value="{}"/><attribute name="flavor" value="x"/></attributes>'
    body = (
        f'<define-gate name="g">{attributes.format("P")}<or><event name="a"/><event name="b"/></or></define-gate>'
        + "".join(
            f'<define-basic-event name="{name}">{attributes.format(source)}</define-basic-event>'
            for name, source in (("a", "P"), ("b", "my uncle"))
        )
    )
    tree = read(put(tmp_path, body))
    assert tree.nodes["a"] == BasicEvent("a", source="P", attributes=(("flavor", "x"),))
    assert tree.nodes["b"] == BasicEvent("b", attributes=(("source", "my uncle"), ("flavor", "x")))
    assert tree.nodes["g"].attributes == (("source", "P"), ("flavor", "x"))


MEMBERS = '<members><basic-event name="x"/><basic-event name="y"/></members>'
TOP = '<define-gate name="top"><and><basic-event name="x"/><basic-event name="y"/></and></define-gate>'


@pytest.mark.parametrize(
    ("model", "factors", "expected"),
    [
        ("beta-factor", '<factor level="2"><float value="0.2"/></factor>', {2: Fraction(1, 5)}),
        ("beta-factor", '<factors><factor><float value="0.2"/></factor></factors>', {2: Fraction(1, 5)}),
        ("MGL", '<factors><factor><float value="0.3"/></factor></factors>', {2: Fraction(3, 10)}),
        (
            "alpha-factor",
            '<factors><factor><float value="0.9"/></factor><factor><float value="0.1"/></factor></factors>',
            {1: Fraction(9, 10), 2: Fraction(1, 10)},
        ),
    ],
)
def test_common_cause_groups_define_their_members(tmp_path, model, factors, expected):
    group = f'<define-CCF-group name="g" model="{model}">{MEMBERS}<distribution><float value="0.1"/></distribution>'
    path = put(tmp_path, f"{TOP}{group}{factors}</define-CCF-group>")
    study = read_study(path)
    assert [(one.model, one.members, dict(one.factors), one.total) for one in study.ccf_groups] == [
        (model, ("x", "y"), expected, Fraction(1, 10))
    ]
    assert study.tree().events == (BasicEvent("x", "0.1"), BasicEvent("y", "0.1"))
    assert solve(study.tree()).exact == Fraction(1, 100)
    if model == "beta-factor":
        assert solve(read(path)).exact == Fraction(8, 100) ** 2 * Fraction(98, 100) + Fraction(2, 100)


def _study(*substitutions, top=("or", ("a", "b", "c"))):
    gates = (Gate("top", *top), Gate("both", "and", ("a", "b")))
    return Study(
        "s",
        gates,
        tuple(BasicEvent(e, f"0.{n}") for n, e in enumerate("abcd", 1)),
        (),
        ("top",),
        substitutions=substitutions,
    )


def test_a_statement_conditions_the_top_event():
    exclusive = _study(Substitution("x", "both", False, "delete-terms")).quantified()
    backed_up = _study(Substitution("y", "both", "d", "recovery-rule")).quantified()
    for failed in (set(s) for n in range(5) for s in combinations("abcd", n)):
        top = bool(failed & set("abc"))
        assert exclusive.occurs(failed) == (top and not {"a", "b"} <= failed)
        assert backed_up.occurs(failed) == (top and (not {"a", "b"} <= failed or "d" in failed))


def test_a_rule_changes_cut_sets():
    rule = Substitution("x", "both", "d", "recovery-rule", ("a", "b"))
    study = _study(rule, top=("vote", ("a", "b", "c"), 2))
    assert set(map(frozenset, solve(study.quantified()).cut_sets())) == {frozenset(s) for s in ("d", "ac", "bc")}
    assert set(map(frozenset, solve(study.tree()).cut_sets())) == {frozenset(s) for s in ("ab", "ac", "bc")}


def test_what_a_rule_leaves_is_minimal():
    rule = Substitution("x", "both", "c", "exchange-event", ("a", "b"))
    assert list(solve(_study(rule, top=("vote", ("a", "b", "c"), 2)).quantified()).cut_sets()) == [("c",)]


def test_a_rule_on_too_many_cut_sets_is_refused(monkeypatch):
    monkeypatch.setattr("safety.trees.substitutions.MOST", 2)
    rule = Substitution("x", "both", "d", "recovery-rule", ("a", "b"))
    with pytest.raises(
        TreeError, match=r'"s" has 3 minimal cut sets, substitutions with sources are applied to at most 2'
    ):
        _study(rule, top=("vote", ("a", "b", "c"), 2)).quantified()


def test_limits_inside_of_limits_do_not_double(tmp_path):
    formula = '<basic-event name="a"/>'
    for _ in range(40):
        formula = f'<cardinality min="1" max="1">{formula}<basic-event name="b"/></cardinality>'
    tree = read(put(tmp_path, f'<define-gate name="top">{formula}</define-gate>{EVENTS}'))
    assert len(tree.gates) == 40 * 4
    assert tree.occurs({"a"})
    assert not tree.occurs(set())


def test_a_rule_on_a_tree_that_negates_is_refused():
    study = _study(Substitution("x", "a", "d", "exchange-event", ("a",)), top=("xor", ("a", "b")))
    with pytest.raises(
        TreeError, match='gate "top" negates; substitutions with sources are rules on the cut sets of coherent'
    ):
        study.quantified()


def test_phases_set_house_events(tmp_path):
    body = f"""<define-fault-tree name="t"><define-gate name="g"><or><basic-event name="a"/><and><house-event name="h"/>
    <basic-event name="b"/></and></or></define-gate>{EVENTS}<define-house-event name="h"/></define-fault-tree>
    <define-alignment name="al"><define-phase name="run" time-fraction="0.75"/>
    <define-phase name="repair" time-fraction="0.25"><label>one out</label>
    <set-house-event name="h"><constant value="true"/></set-house-event></define-phase></define-alignment>"""
    study = read_study(put(tmp_path, body))
    phases = (Phase("run", "3/4"), Phase("repair", "1/4", (("h", True),), "one out"))
    assert study.alignments == (Alignment("al", phases),)
    found = [(phase, solve(tree).exact) for _, phase, tree in study.in_phases()]
    assert found == list(zip(phases, (Fraction(1, 10), Fraction(28, 100)), strict=True))
    with pytest.raises(
        TreeError, match='alignment "al" cannot be part of one fault tree; read the files with read_study'
    ):
        read(put(tmp_path, body))


def test_several_trees_share_events_and_are_taken_one_by_one(tmp_path):
    tree = '<define-fault-tree name="{}"><define-gate name="{}"><or>{}</or></define-gate></define-fault-tree>'
    body = tree.format("A", "g", '<event name="a"/><event name="b"/>') + tree.format(
        "B", "h", '<event name="b"/><event name="c"/>'
    )
    study = read_study(put(tmp_path, body), put(tmp_path, f"<model-data>{EVENTS}</model-data>", "data.xml"))
    assert [(one.name, one.top, [e.name for e in one.events]) for one in study.trees] == [
        ("A", "g", ["a", "b"]),
        ("B", "h", ["b", "c"]),
    ]
    with pytest.raises(TreeError, match=r"2 gates are used by no other \(g, h\); choose one"):
        study.tree()


def test_names_by_the_rule_of_sql_xml_are_read(tmp_path):
    body = '<define-gate name="a_x0020_b"><event name="_x0031_"/></define-gate><define-basic-event name="_x0031_"/>'
    tree = read(put(tmp_path, body))
    assert (tree.top, tree.events) == ("a b", (BasicEvent("1"),))


def test_other_encodings_of_xml(tmp_path):
    gate, event = "<define-gate name='ä'><event name='a'/></define-gate>", "<define-basic-event name='a'/>"
    body = f"<opsa-mef>{gate}{event}</opsa-mef>"
    for encoding in ("utf-8", "utf-8-sig", "utf-16", "iso-8859-1"):
        declared = f"<?xml version='1.0' encoding='{encoding.removesuffix('-sig')}'?>{body}"
        (tmp_path / "f").write_bytes(declared.encode(encoding))
        assert read(tmp_path / "f").top == "ä"

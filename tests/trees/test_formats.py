"""Files in, files out: what is read, that nothing is lost on the way, and how malformed files are refused."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent, TreeError, read, solve, to_document, write
from safety.trees.expressions.expression import Constant, MissionTime, Parameter
from safety.trees.expressions.lifetimes import Exponential
from tests.trees.twin import trees

TREE = """<?xml version="1.0"?>
<opsa-mef>
  <define-fault-tree name="permit">
    <label>Permit  on a
      wrong count</label>
    <define-gate name="top"><or><gate name="both"/><basic-event name="c"/></or></define-gate>
    <define-gate name="both"><label>A and B</label>
      <and><event name="a"/><not><house-event name="h"/></not><atleast min="1"><basic-event name="b"/></atleast></and>
    </define-gate>
    <define-house-event name="h"><constant value="false"/></define-house-event>
  </define-fault-tree>
</opsa-mef>
"""
DATA = """<opsa-mef>
  <model-data>
    <define-basic-event name="a"><label>A sticks</label>
      <attributes><attribute name="source" value="P"/></attributes><float value="1e-3"/></define-basic-event>
    <define-basic-event name="b">
      <exponential><parameter name="rate"/><system-mission-time/></exponential></define-basic-event>
    <define-basic-event name="c"/>
    <define-parameter name="rate"><float value="2e-6"/></define-parameter>
  </model-data>
</opsa-mef>
"""


def put(folder, text, name="tree.xml"):
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def test_mef_trees_and_data_in_two_files(tmp_path):
    tree = read(put(tmp_path, TREE), put(tmp_path, DATA, "data.xml"), mission_time_h=100)
    assert (tree.name, tree.top, tree.description) == ("permit", "top", "Permit on a wrong count")
    assert tree.nodes["a"] == BasicEvent("a", Fraction(1, 1000), description="A sticks", source="P")
    rate = Parameter("rate", Constant("2e-6"))
    assert tree.nodes["b"] == BasicEvent("b", mission_time_h=100, expression=Exponential(rate, MissionTime()))
    assert tree.nodes["c"].chance is None
    assert tree.nodes["both"].inputs == ("a", "both/2", "both/3")
    assert tree.nodes["both/3"] == Gate("both/3", "vote", ("b",), 1, inside="both")
    assert {frozenset(cut_set) for cut_set in solve(tree).cut_sets()} == {frozenset("ab"), frozenset("c")}


FORMULAS = {
    "<and>{a}{b}</and>": lambda a, b: a and b,
    "<or>{a}{b}</or>": lambda a, b: a or b,
    "<xor>{a}{b}</xor>": lambda a, b: a != b,
    "<nand>{a}{b}</nand>": lambda a, b: not (a and b),
    "<nor>{a}{b}</nor>": lambda a, b: not (a or b),
    "<iff>{a}{b}</iff>": lambda a, b: a == b,
    "<imply>{a}{b}</imply>": lambda a, b: not a or b,
    '<atleast min="2">{a}{b}</atleast>': lambda a, b: a and b,
    "<not><or>{a}<not>{b}</not></or></not>": lambda a, b: not (a or not b),
    "{a}": lambda a, b: a,
}


@pytest.mark.parametrize("formula", FORMULAS)
def test_mef_formulas(tmp_path, formula):
    inner = formula.format(a='<basic-event name="a"/>', b='<basic-event name="b"/>')
    data = "".join(f'<define-basic-event name="{e}"><float value="0.5"/></define-basic-event>' for e in "ab")
    tree = read(put(tmp_path, f'<opsa-mef><define-gate name="top">{inner}</define-gate>{data}</opsa-mef>'))
    for failed in ("", "a", "b", "ab"):
        assert tree.occurs(failed) == FORMULAS[formula]("a" in failed, "b" in failed)


@settings(max_examples=50, deadline=None)
@given(
    trees(),
    st.text(max_size=5),
    st.sampled_from(["", "P", "D", "A", "R"]),
    st.sampled_from([None, Fraction(1, 3), Fraction(10)]),
)
def test_json_gives_the_same_tree_back(tmp_path_factory, tree, text, source, time):
    events = (*tree.events, BasicEvent(f"µ {text}", None, Fraction(1, 7 * 10**6), 2, text, source), BasicEvent("bare"))
    tree = FaultTree("“n” " + text, tree.top, tree.gates, events, tree.house_events, text, time)
    path = tmp_path_factory.mktemp("json") / "tree.json"
    write(tree, path)
    assert read(path) == tree


def test_mef_and_json_mean_the_same(tmp_path):
    tree = read(put(tmp_path, TREE), put(tmp_path, DATA, "data.xml"), mission_time_h=100)
    write(tree, tmp_path / "tree.json")
    assert read(tmp_path / "tree.json") == FaultTree(
        tree.name, tree.top, tree.gates, tree.events, tree.house_events, tree.description, tree.mission_time_h
    )
    assert to_document(read(tmp_path / "tree.json")) == to_document(tree)


def xml(body, data='<define-basic-event name="a"><float value="0.1"/></define-basic-event>'):
    return f"<opsa-mef>\n{body}\n{data}\n</opsa-mef>\n"


def gate(formula, name="top"):
    return f'<define-gate name="{name}">{formula}</define-gate>'


A = '<basic-event name="a"/>'
MALFORMED = {
    "not closed": ("<opsa-mef>\n<and>\n</opsa-mef>", r"tree.xml:3: not well-formed XML \(mismatched tag\)"),
    "empty": ("", r"tree.xml:1: starts with b'', expected Open-PSA MEF XML, JSON, Aralia text or Galileo text"),
    "other text": ("top = a & b;", r"tree.xml:1: starts with b'top = a & b;'"),
    "entities": (
        '<?xml version="1.0"?>\n<!DOCTYPE x [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]>\n<opsa-mef>&b;</opsa-mef>',
        r"tree.xml:2: the document type <!DOCTYPE x ...> is not accepted",
    ),
    "outside entity": ('<!DOCTYPE x SYSTEM "file:///etc/passwd">\n<opsa-mef/>', r"tree.xml:1: the document type"),
    "root": ("<model/>", r"tree.xml:1: the root element is <model>, expected <opsa-mef>"),
    "no gate": (xml(""), r"tree.xml:1: no gate is defined"),
    "cycle": (
        xml(gate('<or><gate name="x"/></or>', "y") + "\n" + gate('<or><gate name="y"/></or>', "x")),
        r"tree.xml:[23]: .*cycle: (x -> y -> x|y -> x -> y)",
    ),
    "undefined": (
        xml("\n" + gate('<or><gate name="x"/></or>')),
        r'tree.xml:3: gate "top" has the input "x", which is neither',
    ),
    "duplicate": (xml(gate(f"<or>{A}</or>") + "\n" + gate(f"<and>{A}</and>")), r'tree.xml:3: "top" is defined 2 times'),
    "k": (xml("\n" + gate(f'<atleast min="2">{A}</atleast>')), r"tree.xml:3: .* has k = 2 of 1 inputs"),
    "no k": (xml(gate(f"<atleast>{A}</atleast>")), r'tree.xml:2: <atleast> has no attribute "min"; add it'),
    "odd k": (
        xml(gate(f'<atleast min="two">{A}</atleast>')),
        r'tree.xml:2: min="two" of <atleast> is not a whole number',
    ),
    "formula": (xml(gate(f"<pand>{A}</pand>")), r"tree.xml:2: <pand> is no formula known here, expected one of and"),
    "xor of three": (xml(gate(f"<xor>{A}{A}{A}</xor>")), r"tree.xml:2: <xor> has 3 arguments, expected 2"),
    "two formulas": (xml(gate(f"<or>{A}</or><or>{A}</or>")), r'tree.xml:2: <define-gate> "top" holds 2 elements'),
    "element": (
        xml(gate(f"<or>{A}</or>") + "<define-thing/>"),
        r"tree.xml:2: <define-thing> is not known in <opsa-mef>",
    ),
    "probability": (
        xml(gate(f"<or>{A}</or>"), '<define-basic-event name="a"><float value="1.2"/></define-basic-event>'),
        r'tree.xml:3: probability of basic event "a" is 6/5, expected between 0 and 1',
    ),
    "number": (
        xml(gate(f"<or>{A}</or>"), '<define-basic-event name="a"><float value="x"/></define-basic-event>'),
        r"tree.xml:3: .*is 'x', expected a number",
    ),
    "expression": (
        xml(gate(f"<or>{A}</or>"), '<define-basic-event name="a"><lognormal-deviate/></define-basic-event>'),
        r"tree.xml:3: .*<lognormal-deviate> has 0 arguments, expected 2 .* or 3",
    ),
    "parameter": (
        xml(gate(f"<or>{A}</or>"), '<define-basic-event name="a"><parameter name="p"/></define-basic-event>'),
        r'tree.xml:3: .*parameter "p" is not defined',
    ),
    "two roots": (
        xml(gate(f"<or>{A}</or>") + gate(f"<or>{A}</or>", "x")),
        r"2 gates are used by no other \(top, x\); choose",
    ),
    "deep": (xml(gate("<not>" * 5000 + A + "</not>" * 5000)), r"nested too deeply"),
    "json": (
        '{"format": "rightside/fault-tree/1",\n "name" 1}',
        r"tree.xml:2: not JSON \(Expecting ':' delimiter, column 9\)",
    ),
    "json format": (
        '{"format": "x", "name": "n", "top": "t", "gates": []}',
        r'the format is "x", expected "rightside/',
    ),
    "json missing": ('{"format": "rightside/fault-tree/1", "name": "n"}', r'the document has no "top"; add it'),
    "json list": (
        '{"format": "rightside/fault-tree/1", "name": "n", "top": "t", "gates": {}}',
        r'"gates" of .* is {}, expected list',
    ),
    "json depth": ('{"a":' * 100000, r"nested too deeply"),
    "latin-1": (b'{"name": "\xe4"}', r"not JSON in UTF-8"),
}


@pytest.mark.parametrize("case", MALFORMED)
def test_malformed_files_are_refused_with_file_and_line(tmp_path, case):
    text, message = MALFORMED[case]
    with pytest.raises(TreeError, match=message) as error:
        read(put(tmp_path, text))
    assert str(error.value).count("tree.xml") == 1


ENTRIES = {
    "unknown key": ('{"name": "a", "lambda": 1}', r'tree.json:3: entry 1 of basic_events has the unknown key "lambda"'),
    "type": (
        '{"name": "a", "probability": true}',
        r'tree.json:3: "probability" of entry 1 of basic_events is true, expected',
    ),
    "range": (
        '{"name": "a", "probability": 1.5}',
        r'tree.json:3: probability of basic event "a" is 1.5, expected between',
    ),
    "nan": ('{"name": "a", "probability": NaN}', r"tree.json:3: .*is 'NaN', expected a number"),
    "no object": ("7", r"tree.json: entry 1 of basic_events is 7, expected an object"),
    "duplicate": ('{"name": "a"},\n{"name": "a"}', r'tree.json:4: "a" is defined 2 times'),
    "clash": ('{"name": "a"},\n{"name": "t"}', r'"t" is defined 2 times'),
}


@pytest.mark.parametrize("case", ENTRIES)
def test_malformed_json_entries_are_refused_with_file_and_line(tmp_path, case):
    entries, message = ENTRIES[case]
    text = f"""{{"format": "rightside/fault-tree/1", "name": "n", "top": "t",
"gates": [{{"name": "t", "kind": "or", "inputs": ["a"]}}], "basic_events": [
{entries}]}}"""
    with pytest.raises(TreeError, match=message):
        read(put(tmp_path, text, "tree.json"))


def test_top_can_be_chosen(tmp_path):
    path = put(tmp_path, xml(gate(f"<or>{A}</or>") + gate(f"<or>{A}</or>", "x")))
    assert read(path, top="x").top == "x"
    with pytest.raises(TreeError, match=r'no gate "q" to be its top'):
        read(path, top="q")


def test_several_files_with_json_among_them_are_refused(tmp_path):
    write(FaultTree("t", "g", (Gate("g", "or", ("h",)),), (), (HouseEvent("h", True),)), tmp_path / "a.json")
    with pytest.raises(TreeError, match="several files, and not all of them MEF"):
        read(tmp_path / "a.json", put(tmp_path, TREE))
    with pytest.raises(TreeError, match="no file given"):
        read()

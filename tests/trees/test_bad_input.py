"""Files that are no fault trees: each is refused with its name, the line, what stands there and what was expected."""

import os
import re

import pytest

from safety.trees import TreeError, read
from safety.trees.formats.files import LARGEST, read_study

EVENTS = "".join(f'<define-basic-event name="{e}"><float value="0.1"/></define-basic-event>' for e in "ab")
A, B = '<basic-event name="a"/>', '<basic-event name="b"/>'
TOP = f'<define-gate name="top"><or>{A}{B}</or></define-gate>'


def gate(formula):
    return f'<opsa-mef>\n<define-gate name="top">{formula}</define-gate>\n{EVENTS}</opsa-mef>'


def event(expression, more=""):
    head = f'<opsa-mef>\n<define-gate name="top"><or>{A}</or></define-gate>'
    return f'{head}\n<define-basic-event name="a">{expression}</define-basic-event>\n{more}</opsa-mef>'


def beside(element):
    return f"<opsa-mef><define-fault-tree name='t'>{TOP}{EVENTS}</define-fault-tree>\n{element}</opsa-mef>"


def parameter(name, expression, unit=""):
    return f'<define-parameter name="{name}"{unit}>{expression}</define-parameter>'


def group(*parts, model="beta-factor"):
    return beside(f'<define-CCF-group name="g" model="{model}">{"".join(parts)}</define-CCF-group>')


def substitution(*parts, kind=""):
    return beside(f'<define-substitution name="s"{kind}>{"".join(parts)}</define-substitution>')


MEMBERS = f"<members>{A}{B}</members>"
TOTAL = '<distribution><float value="0.1"/></distribution>'
FACTOR = '<factor level="2"><float value="0.2"/></factor>'
HYPOTHESIS, TARGET = f"<hypothesis>{A}</hypothesis>", f"<target>{B}</target>"
TIME = "<system-mission-time/>"
X = '<parameter name="x"/>'

MEF = {
    "truncated": (gate(A)[:60], r"f:2: not well-formed XML \(.*\); correct it there"),
    "no XML after the head": ("<?xml version='1.0'?>", r"f:1: not well-formed XML \(no element found\)"),
    "latin-1 undeclared": (gate(A).encode() + b"<!-- \xe4 -->", r"f:3: not well-formed XML \(not well-formed"),
    "unknown encoding": (
        "<?xml version='1.0' encoding='klingon'?><opsa-mef/>",
        r"f:1: cannot be decoded \(unknown encoding: kl",
    ),
    "billion laughs": (
        '<!DOCTYPE l [<!ENTITY a "l"><!ENTITY b "&a;&a;"><!ENTITY c "&b;&b;">]><opsa-mef>&c;</opsa-mef>',
        r"f:1: the document type <!DOCTYPE l ...> is not accepted",
    ),
    "undefined entity": (gate("&a;"), r"f:2: not well-formed XML \(undefined entity\)"),
    "project file": (
        "<scram><input-files/></scram>",
        r"f:1: the root element is <scram>.*give the files that its <input-fi",
    ),
    "unknown element": (beside("<define-pump/>"), r"f:2: <define-pump> is not known in <opsa-mef>"),
    "unknown formula": (gate("<xnor/>"), r"f:2: <xnor> is no formula known here, expected one of and, or"),
    "empty gate": (gate("<or/>"), r'f:2: gate "top" \(or\) has 0 inputs, expected at least 1'),
    "no formula": (gate(""), r'f:2: <define-gate> "top" holds 0 elements, expected a formula'),
    "not of two": (gate(f"<not>{A}{B}</not>"), r'f:2: gate "top" \(not\) has 2 inputs, expected exactly 1'),
    "imply of one": (gate(f"<imply>{A}</imply>"), r"f:2: <imply> has 1 arguments, expected 2"),
    "twice": (gate(f"<or>{A}{A}</or>"), r'f:2: gate "top" \(or\) has the input "a" more than once'),
    "negative k": (gate(f'<atleast min="-1">{A}{B}</atleast>'), r'f:2: min="-1" of <atleast> is not a whole number'),
    "k of 0": (gate(f'<atleast min="0">{A}{B}</atleast>'), r'f:2: gate "top" \(vote\) has k = 0 of 2 inputs, expected'),
    "huge k": (gate(f'<atleast min="{"9" * 5000}">{A}</atleast>'), r'f:2: min="9+" of <atleast> is not a whole number'),
    "max of atleast": (
        gate(f'<atleast min="1" max="2">{A}{B}</atleast>'),
        r'f:2: <atleast> has the unknown attribute "max"',
    ),
    "limits": (
        gate(f'<cardinality min="2" max="1">{A}{B}</cardinality>'),
        r'f:2: <cardinality> has min="2" and max="1" of 2',
    ),
    "constant": (gate('<or><constant value="maybe"/></or>'), r'f:2: the constant is "maybe", expected true or false'),
    "no such type": (gate('<or><event name="a" type="pump"/></or>'), r'f:2: type="pump" of <event> is unknown'),
    "attribute of a reference": (
        gate('<or><basic-event name="a" typ="x"/></or>'),
        r'f:2: <basic-event> has the unknown attribute "typ"',
    ),
    "wrong kind": (
        gate('<or><gate name="a"/></or>'),
        r'f:2: "a" is no gate but a basic-event; refer to it by <basic-event>',
    ),
    "undefined": (gate('<or><gate name="x"/></or>'), r'f:2: gate "top" has the input "x", which is neither a gate nor'),
    "own cause": (gate('<or><gate name="top"/></or>'), r'f:2: fault tree "top" has a cycle: top -> top'),
    "house event": (
        beside('<define-house-event name="h"><bool value="true"/></define-house-event>'),
        r"f:2: <bool> is not known in <define-house-event>, expected constant",
    ),
    "rol": (
        gate(A).replace("<define-gate", '<define-gate rol="private"'),
        r'f:2: <define-gate> has the unknown attribute "rol"',
    ),
    "role": (
        gate(A).replace("<define-gate", '<define-gate role="secret"'),
        r'f:2: role="secret" of <define-gate> is unknown',
    ),
    "public and private": (
        f'<opsa-mef><define-fault-tree name="t">{TOP}\n<define-gate name="top" role="private">{A}</define-gate>'
        f"{EVENTS}</define-fault-tree></opsa-mef>",
        r'f:2: "t.top" is defined as public and as private',
    ),
    "two meanings": (
        f'<opsa-mef><define-fault-tree name="t"><define-component name="c"><define-gate name="top">\n<or>{A}</or>'
        '</define-gate></define-component><define-basic-event name="a" role="private"/></define-fault-tree>'
        '<model-data><define-basic-event name="a"/></model-data></opsa-mef>',
        r'f:2: "a" may mean a or t.a; write its full path',
    ),
    "probability": (
        event('<float value="1.3"/>'),
        r'f:3: probability of basic event "a" is 13/10, expected between 0 and 1',
    ),
    "half an int": (event('<int value="1/2"/>'), r"f:3: <int> is 1/2, expected a whole number"),
    "negative": (
        event('<float value="-0.1"/>'),
        r'f:3: probability of basic event "a" is -1/10, expected between 0 and 1',
    ),
    "not a number": (event('<float value="NaN"/>'), r"f:3: <float> is 'NaN', expected a number"),
    "beyond doubles": (event('<float value="1e999999999"/>'), r"f:3: <float> is '1e999999999', expected a number"),
    "no value": (event("<float>0.1</float>"), r'f:3: <float> has no attribute "value"; add it'),
    "two expressions": (
        event('<float value="0"/><float value="0"/>'),
        r'f:3: <define-basic-event> "a" holds 2 elements',
    ),
    "expression": (event("<mystery/>"), r"f:3: <mystery> is no operation"),
    "attribute": (event('<neg sign="-"><float value="0"/></neg>'), r'f:3: <neg> has the unknown attribute "sign"'),
    "arity": (event('<exponential><float value="1"/></exponential>'), r"f:3: <exponential> has 1 argument"),
    "rate": (
        event('<exponential><float value="-1"/><float value="1"/></exponential>'),
        r'f:3: .*"a" is -1, expected 0 or more',
    ),
    "too much": (
        event('<add><float value="1"/><float value="1"/></add>'),
        r'f:3: probability of basic event "a" is 2, expected',
    ),
    "no time": (
        event(f'<exponential><float value="1"/>{TIME}</exponential>'),
        r'f:3: basic event "a" has a rate .* no mission',
    ),
    "time's unit": (
        event('<system-mission-time unit="years"/>'),
        r'f:3: <system-mission-time> is in hours, not in "years"',
    ),
    "case": (
        event('<switch><case><float value="1"/></case><float value="1"/></switch>'),
        r"f:3: <case> has 1 parts, expected 2",
    ),
    "no default": (
        event("<switch/>"),
        r"f:3: <switch> holds <case> elements and last one expression; correct its order",
    ),
    "no lower bound": (
        event("<histogram><bin/></histogram>"),
        r"f:3: <histogram> holds <bin> elements and first one expr",
    ),
    "parameter": (event(X), r'f:3: parameter "x" is not defined'),
    "parameter cycle": (
        event(X, parameter("x", '<parameter name="y"/>') + "\n" + parameter("y", X)),
        r"f:5: parameters in a cycle: x -> y -> x; give one of them a number",
    ),
    "parameter twice": (
        event(X, parameter("x", "<pi/>") + "\n" + parameter("x", "<pi/>")),
        r'f:5: parameter "x" is already',
    ),
    "unit": (event(X, parameter("x", "<pi/>", ' unit="metres"')), r'f:4: unit="metres" of parameter "x" is unknown'),
    "unit of use": (
        event(
            '<exponential><parameter name="x" unit="fit"/><float value="1"/></exponential>',
            parameter("x", '<float value="1"/>', ' unit="hours-1"'),
        ),
        r'f:3: parameter "x" is used in "fit" and defined in "hours-1"; units are not converted',
    ),
    "rate in fit": (
        event(f'<exponential>{X}<float value="1"/></exponential>', parameter("x", '<float value="1"/>', ' unit="fit"')),
        r'f:3: parameter "x" is in "fit" where hours-1 is expected',
    ),
    "probability in hours": (
        event(X, parameter("x", '<float value="1"/>', ' unit="hours"')),
        r'f:3: .*"hours" where bool or',
    ),
    "group twice": (
        group(MEMBERS, TOTAL, FACTOR).replace("</opsa-mef>", '\n<define-CCF-group name="g" model="MGL"/></opsa-mef>'),
        r'f:3: <define-CCF-group> "g" is already defined at f:2',
    ),
    "group's model": (
        group(MEMBERS, TOTAL, FACTOR, model="gamma"),
        r"f:2: .*'gamma', expected one of beta-factor, MGL",
    ),
    "two totals": (group(MEMBERS, TOTAL, TOTAL, FACTOR), r"f:2: <distribution> stands in <define-CCF-group> twice"),
    "part of a group": (group(MEMBERS, TOTAL, FACTOR, A), r"f:2: <basic-event> is not known in <define-CCF-group>"),
    "no members": (group(TOTAL, FACTOR), r'f:2: <define-CCF-group> "g" has no <members>; add it'),
    "one member": (group(f"<members>{A}</members>", TOTAL, FACTOR), r"f:2: .*has 1 members, expected 2 or more"),
    "a gate as member": (
        group(MEMBERS.replace(A, '<gate name="top"/>'), TOTAL),
        r"f:2: <gate> stands where <basic-event> is",
    ),
    "no factor": (group(MEMBERS, TOTAL), r"f:2: .*has factors at the levels \[\], expected level 2"),
    "level": (
        group(MEMBERS, TOTAL, FACTOR.replace("2", "two", 1)),
        r'f:2: level="two" of <factor> is not a whole number',
    ),
    "level twice": (
        group(MEMBERS, TOTAL, f"<factors>{FACTOR * 2}</factors>"),
        r"f:2: a factor of level 2 is given twice",
    ),
    "factor 1.3": (
        group(MEMBERS, TOTAL, FACTOR.replace("0.2", "1.3")),
        r"f:2: .*the factor at level 2.* 1.3, expected 0 to 1",
    ),
    "no hypothesis": (substitution(TARGET), r'f:2: <define-substitution> "s" has no <hypothesis>; add it'),
    "substitution's type": (
        substitution(HYPOTHESIS, TARGET, kind=' type="swap"'),
        r'f:2: .*is of type "swap", expected delete',
    ),
    "delete what": (
        substitution(HYPOTHESIS, TARGET, kind=' type="delete-terms"'),
        r"f:2: .*deletes terms, so its target is",
    ),
    "exchange what": (
        substitution(HYPOTHESIS, TARGET, kind=' type="exchange-event"'),
        r"f:2: .*has no source; name the event",
    ),
    "target": (
        substitution(HYPOTHESIS, "<target><basic-event name='q'/></target>"),
        r'f:2: substitution "s" names "q", which',
    ),
    "phases": (
        beside('<define-alignment name="al"><define-phase name="p" time-fraction="0.5"/></define-alignment>'),
        r'f:2: time fractions of alignment "al" add up to 0.5, expected 1',
    ),
    "phase sets": (
        beside(
            '<define-alignment name="al"><define-phase name="p" time-fraction="1"><set-house-event name="a">'
            '<constant value="true"/></set-house-event></define-phase></define-alignment>'
        ),
        r'f:2: "a" is no house-event but a basic-event',
    ),
}
ARALIA = {
    "no end": ("g := (a & b;", r'f:1: expected \) at ";"'),
    "no formula": ("g :=\n;", r'f:2: expected \( at ";"'),
    "nothing": ("g := a;\n7", r'f:2: expected a name at "7"'),
    "no equation": ("t\ng := a;\nh b", r'f:3: expected := at "b"'),
    "letter": ("g := a;\nh := €;", r"f:2: '€;' is no part of an Aralia text"),
    "comment": ("g := a;\n/* b", r"f:2: '/\* b' is no part of an Aralia text, or is not closed"),
    "k": ("g := @(x, [a]);", r'f:1: expected a whole number at "x"'),
    "k of": ("g :=\n@(3, [a, b]);", r'f:1: gate "g" \(vote\) has k = 3 of 2 inputs'),
    "limits": ("g := #(2, 1, [a, b]);", r"f:1: limits 2 and 1 of 2 arguments"),
    "mixed": ("g := a & b ^ c;", r"f:1: an exclusive or stands beside another operator; put parentheses"),
    "chain": ("g := a => b => c;", r'f:1: expected a name at "=>"'),
    "deep": ("g := " + "~" * 5000 + "a;", r"f:1: nested too deeply"),
    "probability": ("g := a;\np(a) = 1.3;", r'f:2: probability of basic event "a" is 13/10, expected between'),
    "number": ("g := a;\np(a) = b;", r'f:2: expected a number at "b"'),
    "state": ("g := a;\ns(a) = on;", r'f:2: "on" is no state, expected true or false'),
    "twice": ("g := a;\np(a) = 1;\np(a) = 0;", r'f:3: "a" is given a value twice'),
    "gate twice": ("g := a;\ng := b;", r'f:2: "g" is defined 2 times'),
    "cycle": ("g := h;\nh := g;", r"f:1: .*cycle: g -> h -> g"),
    "string": ('g := "\\q";', r'f:1: no string as in JSON at ""\\q""'),
    "UTF-16": ("g := ä;".encode("latin-1"), r"f: not text in UTF-8"),
}
GATE = '{"name": "t", "kind": "or", "inputs": ["a"]}'
HEAD = f'{{"format": "rightside/fault-tree/1", "name": "n", "top": "t", "gates": [{GATE}]'
JSON = {
    "cut": (HEAD, r"f:1: not JSON"),
    "expression": (
        HEAD + ', "basic_events": [{"name": "a", "expression": {"exp": 1}}]}',
        r'f:1: "exp" holds 1, expected the',
    ),
    "operation": (
        HEAD + ', "basic_events": [{"name": "a", "expression": {"huh": []}}]}',
        r"f:1: <huh> is no operation",
    ),
    "parameter": (
        HEAD + ', "basic_events": [{"name": "a", "expression": {"parameter": "x"}}]}',
        r'f:1: parameter "x" is not',
    ),
    "both": (
        HEAD + ', "basic_events": [{"name": "a", "probability": 0.1, "expression": {"exp": ["-1"]}}]}',
        r'f:1: basic event "a" has an expression besides a probability',
    ),
    "cycle": (
        HEAD + ', "parameters": [{"name": "x", "expression": {"parameter": "x"}}]}',
        r"f:1: parameters in a cycle: x -> x",
    ),
    "attributes": (
        HEAD + ', "house_events": [{"name": "a", "state": true, "attributes": {"b": 1}}]}',
        r'f:1: "attributes" of',
    ),
    "kind of part": (HEAD + ', "substitutions": [7]}', r'f:1: "substitutions" holds 7, expected Substitution'),
    "part's key": (
        HEAD + ', "substitutions": [{"huh": 7}]}',
        r'f:1: Substitution in "substitutions" has the unknown key "huh"',
    ),
    "part's fields": (
        HEAD + ', "alignments": [{"name": "al"}]}',
        r'f:1: Alignment in "alignments" has no "phases"; add it',
    ),
    "part's types": (HEAD + ', "alignments": [{"name": 1, "phases": []}]}', r'f:1: "name" holds 1, expected str'),
    "key twice": (HEAD + ', "name": "m"}', r'f: the key "name" stands twice in an object, beside \["format", "name"'),
    "huge integer": (HEAD + ', "mission_time_h": ' + "9" * 5000 + "}", r"f: not JSON"),
}
GALILEO = {
    "dynamic": (
        'toplevel "t"; "t" pand "a" "b"; "a" lambda=1; "b" lambda=1;',
        r'f: "t" is a dynamic tree \("t" depends on the order of failures\), expected a static one',
    ),
    "no time": (
        'toplevel "t";\n"t" or "a"; "a" lambda=1;',
        r'f: basic event "a" has a rate of 1 per hour and no mission time',
    ),
    "undefined": ('toplevel "t";\n"t" or "a";', r'f:2: .*"a"'),
}
TABLES = {"MEF": MEF, "Aralia": ARALIA, "JSON": JSON, "Galileo": GALILEO}
CASES = [(table, name) for table, cases in TABLES.items() for name in cases]


@pytest.mark.parametrize(("table", "name"), CASES)
def test_refused_with_file_line_and_what_was_expected(tmp_path, monkeypatch, table, name):
    text, message = TABLES[table][name]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "f").write_bytes(text.encode() if isinstance(text, str) else text)
    for reading in (read, read_study):
        try:
            tree = reading("f")
        except TreeError as error:
            assert re.match(message, str(error)), str(error)
        else:  # a study need not be one tree, but its trees must be
            assert reading is read_study
            with pytest.raises(TreeError):
                tree.quantified()


@pytest.mark.parametrize("size", [LARGEST + 1, 2**30])
def test_a_file_too_large_is_not_read(tmp_path, size):
    (tmp_path / "f").touch()
    os.truncate(tmp_path / "f", size)  # takes no place on the disk
    with pytest.raises(TreeError, match=r"f: longer than 64 MB; split it into several files"):
        read(tmp_path / "f")


def test_a_pipe_that_does_not_end_is_cut_off(tmp_path, monkeypatch):
    monkeypatch.setattr("safety.trees.formats.files.LARGEST", 1000)
    with pytest.raises(TreeError, match="/dev/zero: longer than 0 MB"):
        read("/dev/zero")


def test_what_cannot_be_opened(tmp_path):
    for path in (tmp_path / "absent.xml", tmp_path, "\0"):
        with pytest.raises(TreeError, match=r"cannot be read \(.*\); correct the path|is no path of a file"):
            read(path)


def test_a_list_of_tags_takes_no_gigabytes(tmp_path, monkeypatch):
    monkeypatch.setattr("safety.trees.formats.xml_elements.MOST_TAGS", 1000)
    (tmp_path / "f").write_text("<opsa-mef>" + "<a/>" * 1000 + "</opsa-mef>")
    with pytest.raises(TreeError, match=r"f: more than 1000 tags; split the file"):
        read(tmp_path / "f")

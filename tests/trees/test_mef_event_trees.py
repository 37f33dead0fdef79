"""Event trees in Open-PSA MEF: the input files of SCRAM give what SCRAM prints; what is malformed is refused."""

import re
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import pytest

from safety.trees import TreeError
from safety.trees.event_trees.answers import analyse
from safety.trees.event_trees.definitions import CollectFormula, Rule
from safety.trees.event_trees.summary import event_tree_entries
from safety.trees.formats.files import read_study
from tests.trees.brute import Truth

SCRAM = shutil.which("scram")
INPUTS = Path("/usr/share/scram/input")
NEEDS_SCRAM = pytest.mark.skipif(
    SCRAM is None or not INPUTS.is_dir(), reason="SCRAM is not installed (Debian package scram)"
)
FILES = {
    "split fractions": ["EventTrees/attack.xml"],
    "a named branch": ["EventTrees/bcd.xml"],
    "linked event trees": ["EventTrees/gas_leak/gas_leak.xml", "EventTrees/gas_leak/gas_leak_reactive.xml"],
    "a sequence that is all": ["TwoTrain/two_train.xml", "TwoTrain/event_tree.xml"],
    "declarative substitutions": ["TwoTrain/substitutions.xml", "TwoTrain/event_tree.xml"],
    "house events": ["ThreeMotor/three_motor.xml", "ThreeMotor/event_tree.xml"],
}


def of_scram(paths):
    """For each initiating event and sequence the printed probability, and the number of products where it has some."""
    command = [SCRAM, "--bdd", "--probability", "1", "-l", "1000", *map(str, paths)]
    report = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60).stdout
    found = {}
    for name, block in re.findall(r'<initiating-event name="([^"]+)" seq.*?>(.*?)</initiating-event>', report, re.S):
        for sequence, value in re.findall(r'<sequence name="([^"]+)" value="([^"]+)"', block):
            found[name, sequence] = [value, None]
    for name, sequence, rest in re.findall(
        r'<sum-of-products initiating-event="([^"]+)" name="([^"]+)"([^>]*)', report
    ):
        found[name, sequence][1] = int(re.search(r'products="(\d+)"', rest).group(1))
    return {key: tuple(value) for key, value in found.items()}


def of_ours(paths):
    found = {}
    study = read_study(*paths)
    for initiating in study.initiating_events:
        for name, one in analyse(study, initiating).sequences.items():
            collects = any(course.formulas for course in one.courses)
            count = sum(one.solution.counts) if collects else None
            found[initiating.name, name] = f"{one.probability.value:.6g}", count
    return found


@NEEDS_SCRAM
@pytest.mark.parametrize("files", FILES)
def test_the_sequences_have_every_digit_that_scram_prints(files):
    paths = [INPUTS / name for name in FILES[files]]
    assert of_ours(paths) == of_scram(paths)


@NEEDS_SCRAM
@pytest.mark.parametrize(
    ("files", "partition"),
    [
        ("split fractions", True),
        ("a named branch", True),
        ("linked event trees", True),
        ("declarative substitutions", True),
        ("house events", False),
    ],
)
def test_whether_the_sequences_share_out_all_cases(files, partition):
    """The one with house events collects the same top event on every path: by its own words it means nothing."""
    study = read_study(*(INPUTS / name for name in FILES[files]))
    answers = [analyse(study, initiating) for initiating in study.initiating_events]
    assert [answer.is_partition for answer in answers] == [partition] * len(answers)
    if partition:
        whole = Fraction(58725, 100_000) if files == "declarative substitutions" else 1
        assert all(answer.total.exact == whole == answer.whole.exact for answer in answers)


@NEEDS_SCRAM
@pytest.mark.parametrize("files", ["linked event trees", "house events"])
def test_the_sequences_agree_with_their_truth_tables(files):
    study = read_study(*(INPUTS / name for name in FILES[files]))
    for initiating in study.initiating_events:
        for one in analyse(study, initiating).sequences.values():
            tree = one.solution.tree
            assert one.probability.exact == Truth(tree).probability({e.name: e.exact_chance[0] for e in tree.events})


@NEEDS_SCRAM
def test_each_phase_of_an_alignment(tmp_path):
    """Two trains, one pump or the other in maintenance; failing and not failing are two sequences."""
    text = (INPUTS / "TwoTrain/event_tree.xml").read_text().replace('<sequence name="S"/>', '<sequence name="R"/>', 1)
    text = text.replace('<define-sequence name="S"/>', '<define-sequence name="S"/><define-sequence name="R"/>')
    (tmp_path / "two.xml").write_text(text)
    paths = [INPUTS / "TwoTrain/two_train_alignment.xml", tmp_path / "two.xml"]
    command = [SCRAM, "--bdd", "--probability", "1", "--ccf", "1", *map(str, paths)]
    report = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60).stdout
    theirs = re.findall(r'<sequence name="(.)" value="([^"]+)"', report)
    entries = event_tree_entries(read_study(*paths))
    assert [entry["phase"] for entry in entries] == ["Normal", "PumpOne", "PumpTwo"]
    assert sum(entry["time_fraction"] for entry in entries) == pytest.approx(1, rel=1e-15)
    ours = [(one["id"], f"{one['probability']:.6g}") for entry in entries for one in entry["sequences"]]
    assert sorted(ours) == sorted(theirs)
    assert all(entry["partition"] for entry in entries)


DATA = """
 <define-fault-tree name="systems">
  <define-gate name="A"><or><basic-event name="a"/><house-event name="H"/></or></define-gate>
  <define-gate name="B"><or><basic-event name="b"/><basic-event name="a"/></or></define-gate>
 </define-fault-tree>
 <model-data>
  <define-basic-event name="a"><float value="0.1"/></define-basic-event>
  <define-basic-event name="b"><float value="0.2"/></define-basic-event>
  <define-house-event name="H"><constant value="false"/></define-house-event>
 </model-data>"""
SET = '<set-house-event name="H"><constant value="true"/></set-house-event>'
A, B = (f'<collect-formula><gate name="{name}"/></collect-formula>' for name in "AB")
NOT_A = '<collect-formula><not><gate name="A"/></not></collect-formula>'
S, R = '<sequence name="S"/>', '<sequence name="R"/>'


def factor(value):
    return f'<collect-expression><float value="{value}"/></collect-expression>'


def fork(*paths, column="F"):
    inner = "".join(f'<path state="s{number}">{path}</path>' for number, path in enumerate(paths))
    return f'<fork functional-event="{column}">{inner}</fork>'


def document(initial, start="", ends='<define-sequence name="S"/><define-sequence name="R"/>', more=""):
    start = f'<define-initiating-event name="I" event-tree="E">{start}</define-initiating-event>' if start else (
        '<define-initiating-event name="I" event-tree="E"/>'
    )  # fmt: skip
    columns = '<define-functional-event name="F"><label>stops</label></define-functional-event>'
    columns += '<define-functional-event name="G"/>'
    tree = f'<define-event-tree name="E">{columns}{ends}<initial-state>{initial}</initial-state></define-event-tree>'
    return f"<opsa-mef>{start}{more}{tree}{DATA}</opsa-mef>"


def if_first(then, otherwise=""):
    return f'<if><test-functional-event name="F" state="s0"/>{then}{otherwise}</if>'


RULE = f'<define-rule name="both">{A}{B}</define-rule>'
SAID = {
    "paths of one sequence overlap": document(fork(A + S, B + S)),
    "a house event set on one path": document(fork(SET + A + S, A + R)),
    "a house event set after collecting": document(A + SET + fork(S, B + R)),
    "a house event between two formulas": document(A + SET + B + fork(A + S, B + R)),
    "a house event set in a sequence": document(
        fork(A + S, B + R), ends=f'<define-sequence name="S">{SET}</define-sequence>'
        f'<define-sequence name="R">{SET}{A}</define-sequence>',
    ),
    "a choice": document(fork(if_first(factor(0.7), factor(0.1)) + S, if_first(factor(0.7), factor(0.1)) + R)),
    "a choice before the fork": document(if_first(factor(0.7), factor(0.1)) + fork(factor(0.5) + S, factor(0.5) + R)),
    "a rule": document(fork('<rule name="both"/>' + S, NOT_A + '<block><rule name="both"/></block>' + R), more=RULE),
    "nothing collected": document(fork(S, B + R)),
    "a success": document(fork(NOT_A + B + S, NOT_A + R)),
}  # fmt: skip


@NEEDS_SCRAM
@pytest.mark.parametrize("what", SAID)
def test_the_instructions_mean_what_scram_takes_them_to_mean(what, tmp_path):
    path = tmp_path / "tree.xml"
    path.write_text(SAID[what])
    theirs, ours = of_scram([path]), of_ours([path])
    assert {key: value for key, (value, _) in ours.items()} == {key: value for key, (value, _) in theirs.items()}


def studied(text, folder):
    path = folder / "tree.xml"
    path.write_text(text)
    return read_study(path)


def test_a_rule_keeps_its_name_and_equal_formulas_are_one_gate(tmp_path):
    study = studied(document(fork(NOT_A + S, NOT_A + '<rule name="both"/>' + R), more=RULE), tmp_path)
    (tree,) = study.event_trees
    first, second = tree.initial.target.paths
    assert first.branch.instructions == second.branch.instructions[:1] == (CollectFormula("not A"),)
    assert second.branch.instructions[1] == Rule("both", (CollectFormula("A"), CollectFormula("B")))
    assert tree.functional_events[0].description == "stops"
    assert [gate.name for gate in study.gates] == ["A", "B", "not A"]


@pytest.mark.parametrize("start", [factor(0.01), '<float value="0.01"/>'])
def test_the_frequency_of_an_initiating_event(start, tmp_path):
    study = studied(document(fork(A + S, NOT_A + R), start + SET), tmp_path)
    answer = analyse(study, study.initiating_events[0])
    assert answer.frequency.exact == Fraction(1, 100)
    assert answer.frequency_of("S").exact == Fraction(1, 100)  # the house event was set before
    assert answer.is_partition is True


def test_common_cause_groups_hold_in_the_sequences(tmp_path):
    group = """<define-CCF-group name="pair" model="beta-factor"><members><basic-event name="a"/><basic-event name="b"/>
      </members><distribution><float value="0.1"/></distribution>
      <factor level="2"><float value="0.5"/></factor></define-CCF-group>"""
    both = f"{A}{B.replace('gate', 'basic-event').replace('B', 'b')}"
    text = document(fork(NOT_A + S, both + R), more=group).replace(
        'name="b"><float value="0.2"', 'name="b"><float value="0.1"'
    )
    study = studied(text, tmp_path)
    chance = analyse(study, study.initiating_events[0]).sequences["R"].probability.exact
    assert chance == Fraction(5, 100) + Fraction(95, 100) * Fraction(5, 100) ** 2


TEST = '<test-initiating-event name="I"/>'
WRONG = {
    "<initial-state> does not end in <fork>, <sequence> or <branch>": document(A),
    "<path> does not end in <fork>, <sequence>": document(fork(A)),
    'rule "none" is not defined': document('<rule name="none"/>' + S),
    "rules in a cycle: both -> both": document(S, more='<define-rule name="both"><rule name="both"/></define-rule>'),
    "<set-gate> is no instruction known here": document('<set-gate name="A"><basic-event name="a"/></set-gate>' + S),
    'direction="backward" is not supported': document(SET.replace('"H"', '"H" direction="backward"') + S),
    "<if> holds 1 elements": document(f"<if>{TEST}</if>{S}"),
    "<float> is no test known here": document(f'<if><float value="1"/>{A}</if>{S}'),
    "a test is 'not' of 2 parts": document(f"<if><not>{2 * TEST}</not>{A}</if>{S}"),
    "has 2 frequencies; give one": document(S, factor(1) + factor(2)),
    "has no <initial-state>": '<opsa-mef>\n<define-event-tree name="E"/></opsa-mef>',
    "has a second <initial-state>": document(f"{S}</initial-state><initial-state>{S}"),
    "<sequence> is not known in <fork>": document(f'<fork functional-event="F">{S}</fork>'),
    '<define-fork> is not known in <define-event-tree>': document(S, ends="<define-fork/>"),
    "has two paths for the state": document(fork(S, R).replace("s1", "s0")),
    'goes on with the branch "x"': document('<branch name="x"/>'),
}  # fmt: skip


@pytest.mark.parametrize("message", WRONG)
def test_refused_with_its_place(message, tmp_path):
    with pytest.raises(TreeError) as error:
        studied(WRONG[message], tmp_path)
    assert message in str(error.value)
    assert re.match(r".*tree\.xml:\d+: ", str(error.value))

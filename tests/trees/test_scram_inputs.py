"""The inputs that come with SCRAM (`apt install scram`), read and solved here: the figures are its own."""

import random
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest

from safety.trees import TreeError, solve
from safety.trees.formats.files import read_study, write
from safety.trees.formats.mef_names import decoded

INPUTS = Path("/usr/share/scram/input")
CASES = [
    "Baobab/baobab1.xml Baobab/baobab1-basic-events.xml",
    "Baobab/baobab2.xml Baobab/baobab2-basic-events.xml",
    "BSCU/BSCU.xml",
    "Chinese/chinese.xml Chinese/chinese-basic-events.xml",
    "Chinese/chinese.xml Chinese/high-prob.xml",
    "Chinese/chinese.xml Chinese/mcs_prob.xml",
    "Chinese/chinese.xml Chinese/mixed_mcs_prob.xml",
    "HIPPS/HIPPS.xml",
    "Lift/lift.xml",
    "ne574/ne574.xml",
    "SmallTree/SmallTree.xml",
    "Theatre/theatre.xml",
    "ThreeMotor/three_motor.xml",
    "TwoTrain/common_cause.xml",
    "TwoTrain/substitutions.xml",
    "TwoTrain/two_train.xml",
    "TwoTrain/two_train_alignment.xml",
    pytest.param("CEA9601/CEA9601.xml CEA9601/CEA9601-basic-events.xml", marks=pytest.mark.slow),
]
EVENT_TREES = [
    "EventTrees/attack.xml EventTrees/attack_alignment.xml",
    "EventTrees/bcd.xml",
    "EventTrees/gas_leak/gas_leak.xml EventTrees/gas_leak/gas_leak_reactive.xml",
    "EventTrees/gas_leak/gas_leak_reactive.xml",
    "ThreeMotor/three_motor.xml ThreeMotor/event_tree.xml",
    "TwoTrain/two_train.xml TwoTrain/event_tree.xml",
]
MISSION_TIME_H = 8760  # SCRAM's, unless told otherwise
pytestmark = pytest.mark.skipif(not (shutil.which("scram") and INPUTS.is_dir()), reason="SCRAM is not installed")


def paths(names):
    return [INPUTS / name for name in names.split()]


def scram(files, *options):
    """What SCRAM finds for each top event and phase, to the six digits that it prints."""
    command = ["scram", "--probability", "1", "--limit-order", "1", *options, *map(str, files)]  # its sum is exact
    report = subprocess.run(command, capture_output=True, check=True, timeout=300).stdout
    return {
        (found.get("name"), found.get("phase")): found.get("probability")
        for found in ElementTree.fromstring(report).iter("sum-of-products")
    }


@pytest.mark.parametrize("names", CASES)
def test_the_top_probability_is_that_of_scram(names):
    study = read_study(*paths(names), mission_time_h=MISSION_TIME_H)
    found = {
        (top, phase.name or None): f"{solve(tree).probability:.6g}"
        for top in study.tops
        for _, phase, tree in study.in_phases(top)
    }
    assert found == scram(paths(names), "--bdd", "--ccf", str(int(bool(study.ccf_groups))))


def test_substitutions_with_sources_give_the_cut_sets_of_scram():
    [file] = paths("TwoTrain/nondeclarative_substitutions.xml")
    study = read_study(file)
    command = ["scram", "--mocus", "--rare-event", "--probability", "1", str(file)]
    report = ElementTree.fromstring(subprocess.run(command, capture_output=True, check=True, timeout=60).stdout)
    products = {frozenset(event.get("name") for event in product) for product in report.iter("product")}
    assert set(map(frozenset, solve(study.quantified()).cut_sets())) == products


def test_what_scram_refuses_is_refused():
    with pytest.raises(TreeError, match=r'mef_example.xml:27: .*"F"'):
        read_study(*paths("EventTrees/mef_example.xml"))
    with pytest.raises(TreeError, match=r"config.xml:2: the root element is <scram>"):
        read_study(*paths("TwoTrain/config.xml"))


def test_no_input_is_left_out():
    tried = {name for names in CASES + EVENT_TREES for name in getattr(names, "values", [names])[0].split()}
    tried |= {"TwoTrain/nondeclarative_substitutions.xml", "EventTrees/mef_example.xml", "TwoTrain/config.xml"}
    assert tried == {str(path.relative_to(INPUTS)) for path in INPUTS.rglob("*.xml")}


@pytest.mark.parametrize("names", CASES[:-1] + EVENT_TREES)
def test_what_is_written_says_the_same_to_scram_and_to_us(tmp_path, names):
    study = read_study(*paths(names), mission_time_h=MISSION_TIME_H)
    for name in ("study.json", "study.xml"):
        write(study, tmp_path / name)
        assert read_study(tmp_path / name, mission_time_h=MISSION_TIME_H) == study
    ccf = str(int(bool(study.ccf_groups)))
    written = scram([tmp_path / "study.xml"], "--bdd", "--ccf", ccf)
    found = {(decoded(name), phase): probability for (name, phase), probability in written.items()}
    assert found == scram(paths(names), "--bdd", "--ccf", ccf)


def nested_containers(chance):
    """A fault tree in three containers, one inside the other; events are public or private and often namesakes."""
    paths = {"T": ["T"], "A": ["T", "A"], "B": ["T", "A", "B"]}
    roles = {container: chance.choice(["", "private", "public"]) for container in "AB"} | {"T": "public"}
    private = {"T": False, "A": roles["A"] == "private"}
    private["B"] = roles["B"] == "private" or (not roles["B"] and private["A"])
    inside, defined, public = dict.fromkeys(paths, ""), [], set()
    for container in paths:
        for name in chance.sample("xyz", chance.choice([1, 2])):
            role = chance.choice(["", "private", "public"])
            if hidden := role == "private" or (not role and private[container]):
                defined.append((container, name, False))
            elif name not in public:
                public.add(name)
                defined.append((container, name, True))
            if hidden or defined[-1][:2] == (container, name):
                shown = f'role="{role}"' if role else ""
                value = f'<float value="0.{chance.randint(1, 9)}"/>'
                inside[container] += f'<define-basic-event name="{name}" {shown}>{value}</define-basic-event>'
    for container, path in paths.items():
        references = set()
        for home, name, known in (chance.choice(defined) for _ in range(2)):
            ways = [[*paths[home], name]]
            ways += [[*paths[home][len(path) :], name]] * (paths[home][: len(path)] == path)
            ways += [[name]] * known
            references.add(".".join(chance.choice(ways)))
        inner = "".join(f'<event name="{one}"/>' for one in sorted(references))
        inner += {"T": '<event name="A.gA"/><event name="T.A.B.gB"/>'}.get(container, '<constant value="false"/>')
        inside[container] += f'<define-gate name="g{container}"><or>{inner}</or></define-gate>'
    a, b = (f'<define-component name="{one}"' + f' role="{roles[one]}"' * bool(roles[one]) for one in "AB")
    ends = "</define-component></define-component></define-fault-tree></opsa-mef>"
    return f'<opsa-mef><define-fault-tree name="T">{inside["T"]}{a}>{inside["A"]}{b}>{inside["B"]}{ends}'


@pytest.mark.parametrize("seed", [*range(25), *(pytest.param(n, marks=pytest.mark.slow) for n in range(25, 200))])
def test_private_and_public_names_mean_what_they_mean_to_scram(tmp_path, seed):
    file = tmp_path / "model.xml"
    file.write_text(nested_containers(random.Random(seed)))
    try:
        ours = f"{solve(read_study(file).quantified('gT')).probability:.6g}"
    except TreeError as error:  # an event twice in one gate, or a name that is private around and public outside
        assert "more than once" in str(error) or "may mean" in str(error), str(error)
        return
    assert scram([file], "--bdd")["gT", None] == ours

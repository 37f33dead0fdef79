"""A study: that all its parts come back from the formats that hold them, and that they are checked."""

from dataclasses import replace
from fractions import Fraction

import pytest

from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent, TreeError, solve
from safety.trees.common_cause import CcfGroup
from safety.trees.event_trees.definitions import (
    Block,
    Branch,
    Choice,
    CollectExpression,
    CollectFormula,
    Combined,
    EventTree,
    Fork,
    FunctionalEvent,
    FunctionalEventIs,
    InitiatingEvent,
    InitiatingEventIs,
    Link,
    NamedBranch,
    Path,
    Rule,
    Sequence,
    SetHouseEvent,
    ToBranch,
    ToSequence,
)
from safety.trees.expressions.distributions import Lognormal
from safety.trees.expressions.expression import Constant, MissionTime, Operation, Parameter
from safety.trees.expressions.lifetimes import Exponential
from safety.trees.formats.files import read, read_study, write
from safety.trees.study import Alignment, Phase, Study
from safety.trees.substitutions import Substitution

RATE = Parameter("rate", Lognormal("1e-5", 3, "0.95"), "hours-1")
EVENTS = (
    BasicEvent("ä 1", "1/3", description="first", source="P", attributes=(("flavor", "undeveloped"),)),
    BasicEvent("b", expression=Exponential(RATE, MissionTime()), mission_time_h=50),
    BasicEvent("c", None, "1e-4", 50),
    BasicEvent("d"),
)
GATES = (
    Gate("G.1", "vote", ("ä 1", "b", "c"), 2, "two of three"),
    Gate("G.2", "and", ("c", "G.2/2", "h")),
    Gate("G.2/2", "not", ("d",), inside="G.2"),
    Gate("s, hypothesis", "and", ("b", "c")),
    Gate("not G.1", "not", ("G.1",)),
)
RULE = Rule("rule", (CollectFormula("G.2"), SetHouseEvent("h", False)), "a rule")
HIDDEN = Rule("in a choice", (SetHouseEvent("h", True),))
TEST = Combined("and", (InitiatingEventIs("IE"), Combined("not", (FunctionalEventIs("F", "works"),))))
TREE = EventTree(
    "ET",
    (FunctionalEvent("F", "a function"), FunctionalEvent("F 2")),
    (Sequence("ok"), Sequence("bad", (Link("ET 2"),), "very bad"), Sequence("half", (RULE,))),
    (NamedBranch("further", Branch((RULE,), ToSequence("half")), "a branch"),),
    Branch(
        (SetHouseEvent("h", True),),
        Fork(
            "F",
            (
                Path("works", Branch((CollectFormula("not G.1"),), ToSequence("ok"))),
                Path("fails", Branch((CollectFormula("G.1"), Choice(TEST, Block((HIDDEN,)))), ToBranch("further"))),
                Path("odd", Branch((CollectExpression(Operation("mul", "0.5", RATE)),), ToSequence("bad"))),
            ),
        ),
    ),
    "an event tree",
)
OTHER = EventTree("ET 2", (), (Sequence("end"),), (), Branch((CollectExpression(Constant("0.1")),), ToSequence("end")))
STUDY = Study(
    "plant",
    GATES,
    EVENTS,
    (HouseEvent("h", False, "a condition"),),
    ("G.1", "G.2"),
    {"unused": Parameter("unused", Constant("1/7"), "years"), "rate": RATE},
    (
        CcfGroup(
            "uncertain",
            "alpha-factor",
            ("ä 1", "d"),
            {1: "0.9", 2: "0.1"},
            Lognormal("0.01", 2, "0.9"),
            description="x",
        ),
        CcfGroup("members'", "MGL", ("b", "c"), {2: Parameter("beta", Constant("0.2"))}),
    ),
    (
        InitiatingEvent("IE", "ET", Constant("0.25"), (SetHouseEvent("h", True),), "it starts"),
        InitiatingEvent("IE 2"),
    ),
    (TREE, OTHER),
    (
        Substitution("s", "s, hypothesis", "ä 1", description="one for two"),
        Substitution("t", "G.1", False, "delete-terms"),
        Substitution("u", "b", "d", "exchange-event", ("b", "c")),
    ),
    (Alignment("al", (Phase("run", "0.75"), Phase("repair", "0.25", (("h", True),), "one out")), "all year"),),
    "everything",
    Fraction(50),
    {"G.1": "A", "G.2": "B"},
)


@pytest.mark.parametrize("ending", ["json", "xml"])
def test_all_parts_of_a_study_come_back(tmp_path, ending):
    write(STUDY, tmp_path / f"s.{ending}")
    back = read_study(tmp_path / f"s.{ending}", mission_time_h=50)
    if ending == "xml":  # what MEF has no word for: names of inner gates, members' own probability, order of files
        assert back.ccf_groups[1].as_given[0] == Exponential(RATE, MissionTime())
        back = replace(back, ccf_groups=(back.ccf_groups[0], STUDY.ccf_groups[1]))
        again = tmp_path / "again.xml"
        write(back, again)
        assert read_study(again, mission_time_h=50).event_trees == back.event_trees
    for part in (
        "parameters",
        "ccf_groups",
        "initiating_events",
        "event_trees",
        "substitutions",
        "alignments",
        "tops",
        "name",
    ):
        assert getattr(back, part) == getattr(STUDY, part), part
    assert set(back.gates) == set(STUDY.gates)
    assert set(back.house_events) == set(STUDY.house_events)
    if ending == "json":
        assert back == STUDY
        assert set(back.events) == set(STUDY.events)


def test_json_tells_a_number_from_a_constant_expression(tmp_path):
    starts = tuple(InitiatingEvent(str(one), "ET", one) for one in (Fraction(1, 3), Constant("1/3")))
    study = replace(STUDY, initiating_events=starts)
    write(study, tmp_path / "s.json")
    assert read_study(tmp_path / "s.json") == study


def test_a_study_knows_the_parameters_of_its_parts():
    assert set(STUDY.parameters) == {"unused", "rate", "beta"}
    other = BasicEvent("e", expression=Parameter("rate", Constant("0.1")))
    with pytest.raises(
        TreeError, match=r'parameter "rate" is defined in two ways \(.*Lognormal.* and .*1/10.*\); rename'
    ):
        replace(STUDY, events=(*EVENTS, other))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"substitutions": (Substitution("s", "x", False),)}, 'substitution "s" names "x", which is no gate or event'),
        ({"substitutions": (Substitution("s", "G.1", "h"),)}, 'substitution "s" names "h", which is no basic event'),
        (
            {"alignments": (Alignment("a", (Phase("p", 1, (("b", True),)),)),)},
            'phase "p" names "b", which is no house event',
        ),
        (
            {"gates": (*GATES, Gate("x", "or", ("y",)))},
            'gate "x" has the input "y", which is neither a gate nor an event',
        ),
    ],
)
def test_what_is_not_there_is_missed(change, message):
    with pytest.raises(TreeError, match=message):
        replace(STUDY, **change)


def test_phases_fill_the_time_and_no_more():
    with pytest.raises(TreeError, match=r'time fraction of phase "p" is 1.5, expected between 0 and 1'):
        Phase("p", "1.5")
    Alignment("thirds", tuple(Phase(name, str(1 / 3)) for name in "abc"))
    with pytest.raises(TreeError, match=r'time fractions of alignment "a" add up to 0.9, expected 1'):
        Alignment("a", (Phase("p", "0.9"),))


def test_a_tree_takes_only_what_its_top_reaches():
    tree = STUDY.tree("G.2")
    assert [gate.name for gate in tree.gates] == ["G.2", "G.2/2"]
    assert [event.name for event in tree.events] == ["c", "d"]
    assert (tree.name, tree.mission_time_h) == ("B", 50)
    assert [one.top for one in STUDY.trees] == ["G.1", "G.2"]


def test_further_gates_and_states_for_the_sequences_of_event_trees():
    study = Study(
        "s", (Gate("g", "or", ("a", "h")),), (BasicEvent("a", "0.5"), BasicEvent("b", "0.5")), (HouseEvent("h", True),)
    )
    both = Gate("both", "and", ("g", "b"))
    assert solve(study.quantified("both", gates=(both,))).exact == Fraction(1, 2)
    assert solve(study.quantified("both", gates=(both,), house={"h": False})).exact == Fraction(1, 4)


def test_one_tree_is_read_with_all_that_is_said_of_it(tmp_path):
    study = Study(
        "s",
        (Gate("g", "and", ("a", "b")),),
        tuple(BasicEvent(name, "0.1") for name in "abc"),
        ccf_groups=(CcfGroup("x", "beta-factor", ("a", "b"), {2: "0.5"}, "0.1"),),
        substitutions=(Substitution("y", "a", "c"),),
    )
    for name in ("s.json", "s.xml"):
        write(study, tmp_path / name)
        assert solve(read(tmp_path / name)).exact == solve(study.quantified()).exact
    together = Fraction(5, 100) + Fraction(95, 100) * Fraction(5, 100) ** 2
    assert solve(study.quantified()).exact == together / 10


def test_the_format_of_a_tree_alone_is_as_before(tmp_path):
    write(FaultTree("t", "g", (Gate("g", "or", ("a",)),), (BasicEvent("a", "0.1"),)), tmp_path / "t.json")
    assert (tmp_path / "t.json").read_text() == (
        '{\n "format": "rightside/fault-tree/1",\n "name": "t",\n "top": "g",\n "gates": [\n  {\n   "name": "g",\n'
        '   "kind": "or",\n   "inputs": [\n    "a"\n   ]\n  }\n ],\n "basic_events": [\n  {\n   "name": "a",\n'
        '   "probability": "1/10"\n  }\n ],\n "house_events": []\n}\n'
    )

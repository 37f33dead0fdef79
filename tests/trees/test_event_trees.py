"""Event trees against a play of every state of the basic events, and by the rules of the format."""

import itertools
import json
import math
import random
from dataclasses import replace
from fractions import Fraction

import msgspec
import pytest

from safety.report.tree_schema import EventTree as EventTreeEntry
from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent, TreeError, solve
from safety.trees.event_trees import gates as event_tree_gates
from safety.trees.event_trees.answers import analyse, consequences
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
from safety.trees.event_trees.summary import event_tree_entries
from safety.trees.formats.files import read_study, write
from safety.trees.study import Study

I = InitiatingEvent("I", "tree")  # noqa: E741


def play(study, initiating, failed):
    """The sequences reached, each with the product of its expressions, when exactly `failed` have failed: by hand."""
    trees = {tree.name: tree for tree in study.event_trees}
    ends = {sequence.name: sequence for tree in study.event_trees for sequence in tree.sequences}

    def true(name, house):
        if name in failed or house.get(name):
            return True
        gates = (*study.gates, Gate("the formula", "or", (name,)))
        houses = tuple(replace(one, state=house[one.name]) for one in study.house_events)
        return FaultTree("x", "the formula", gates, study.events, houses).occurs(failed)

    def test(condition, states):
        match condition:
            case InitiatingEventIs(name):
                return name == initiating.name
            case FunctionalEventIs(name, state):
                return states.get(name) == state
        values = [test(part, states) for part in condition.parts]
        return {"and": all(values), "or": any(values), "not": not values[0]}[condition.kind]

    def do(instructions, world):
        for one in instructions:
            match one:
                case CollectFormula(name):
                    world["taken"] &= true(name, world["house"])
                case CollectExpression(factor):
                    world["factor"] *= Fraction(factor)
                case SetHouseEvent(name, state):
                    world["house"] = world["house"] | {name: state}
                case Block(inner) | Rule(_, inner):
                    do(inner, world)
                case Choice(condition, then, otherwise):
                    do([then] if test(condition, world["states"]) else [otherwise] if otherwise else [], world)
                case Link(name):
                    world["next"] = name

    def follow(tree, branch, world):
        do(branch.instructions, world)
        match branch.target:
            case Fork(name, paths):
                for path in paths:
                    yield from follow(tree, path.branch, world | {"states": world["states"] | {name: path.state}})
            case ToBranch(name):
                yield from follow(tree, next(n.branch for n in tree.branches if n.name == name), world)
            case ToSequence(name):
                do(ends[name].instructions, world)
                if "next" in world:
                    linked = trees[world.pop("next")]
                    yield from follow(linked, linked.initial, world)
                elif world["taken"]:
                    yield name, world["factor"]

    start = {"taken": True, "factor": Fraction(1), "states": {}}
    start["house"] = {one.name: one.state for one in study.house_events}
    do(initiating.instructions, start)
    return list(follow(trees[initiating.event_tree], trees[initiating.event_tree].initial, start))


def by_play(study, initiating, chances=None):
    """The probability of each sequence: the sum over all states of the basic events."""
    chances = {event.name: event.probability for event in study.events} | (chances or {})
    result = {}
    for failed in itertools.product((True, False), repeat=len(study.events)):
        names = {event.name for event, state in zip(study.events, failed, strict=True) if state}
        weight = math.prod(chances[e.name] if e.name in names else 1 - chances[e.name] for e in study.events)
        reached = play(study, initiating, names)
        for name in {name for name, _ in reached}:
            factors = {factor for end, factor in reached if end == name}
            result[name] = result.get(name, 0) + weight * sum(factors)
    return {name: chance for name, chance in result.items() if chance}


def answered(study, initiating=I):
    found = analyse(study, initiating).sequences
    return {name: one.probability.exact for name, one in found.items() if one.probability.exact}


def ends(*names):
    return tuple(Sequence(name) for name in names)


def study_of(gates, initial, sequences=("S", "R"), *, branches=(), columns="FGH", house=(), more=(), events="abcd"):
    chances = dict(zip("abcdef", ("0.1", "0.2", "0.3", "0.4", "0.25", "0.35"), strict=True))
    functional = tuple(FunctionalEvent(name) for name in columns)
    tree = EventTree(
        "tree", functional, ends(*sequences) if isinstance(sequences[0], str) else sequences, branches, initial
    )
    basic = tuple(BasicEvent(name, chances[name]) for name in events)
    return Study("study", tuple(gates), basic, tuple(house), initiating_events=(I,), event_trees=(tree, *more))


def two(column, gate, success, failure):
    """A fork whose success is the opposite of `gate`, which the gate "not ..." stands for."""
    return Branch((), Fork(column, (
        Path("success", replace(success, instructions=(CollectFormula(f"not {gate}"), *success.instructions))),
        Path("failure", replace(failure, instructions=(CollectFormula(gate), *failure.instructions))),
    )))  # fmt: skip


def end(name, *instructions):
    return Branch(instructions, ToSequence(name))


SYSTEMS = (
    Gate("f", "or", ("a", "b")),
    Gate("g", "and", ("b", "c")),
    Gate("h", "vote", ("a", "c", "d"), 2),
    *(Gate(f"not {name}", "not", (name,)) for name in "fgh"),
)


def test_sequences_that_share_events_are_solved_exactly():
    inner = two("G", "g", end("half"), two("H", "h", end("half"), end("lost")))
    study = study_of(SYSTEMS, two("F", "f", end("ok"), inner), ("ok", "half", "lost"))
    answer = analyse(study, I)
    assert answered(study) == by_play(study, I)
    assert answer.total.exact == 1 and answer.is_partition is True
    assert [len(one.courses) for one in answer.sequences.values()] == [1, 2, 1]


def test_a_success_is_neither_left_out_nor_reduced_to_deleted_terms():
    """f and not g: the delete-term approximation drops the cut sets of f that contain one of g, and no more."""
    study = study_of(SYSTEMS, two("G", "g", two("F", "f", end("R"), end("S")), end("R")))
    exact = answered(study)["S"]
    cuts_f, cuts_g = ([set(c) for c in solve(study.tree(top)).cut_sets()] for top in "fg")
    left = [cut for cut in cuts_f if not any(other <= cut for other in cuts_g)]
    gates = [Gate(f"cut {i}", "and", tuple(sorted(cut))) for i, cut in enumerate(left)]
    top = Gate("deleted", "or", tuple(gate.name for gate in gates))
    deleted = solve(FaultTree("deleted", "deleted", (top, *gates), study.events)).exact
    assert exact == by_play(study, I)["S"] == Fraction(28, 100) - Fraction(2, 10) * Fraction(3, 10)
    assert exact != deleted == solve(study.tree("f")).exact


def random_study(seed):
    chance = random.Random(seed)
    events = "abcdef"
    gates = []
    for i in range(5):
        below = chance.sample([*events, "x", "y", *(gate.name for gate in gates)], chance.randint(2, 3))
        kind = chance.choice(("and", "or", "or", "vote", "xor"))
        gates.append(Gate(f"g{i}", kind, tuple(below), 2 if kind == "vote" else None))
    gates += [Gate(f"not g{i}", "not", (f"g{i}",)) for i in range(5)]

    def instructions():
        some = []
        for _ in range(chance.choice((0, 0, 1, 2))):
            flip = SetHouseEvent(chance.choice("xy"), chance.random() < 0.5)
            test = chance.choice((FunctionalEventIs("F", "success"), Combined("not", (InitiatingEventIs("I"),))))
            extra = CollectFormula(chance.choice(gates).name)
            some.append(
                chance.choice(
                    (flip, flip, Choice(test, flip, extra), Rule(f"{flip.name} {flip.state}", (flip,)), Block((flip,)))
                )
            )
        return tuple(some)

    def grow(columns):
        here = instructions()
        if not columns or chance.random() < 0.15:
            return Branch(here, ToSequence(chance.choice(("S", "R", "T", "on"))))
        if chance.random() < 0.1:
            return Branch(here, ToBranch("shared"))
        gate = f"g{chance.randrange(5)}"
        return replace(two(columns[0], gate, grow(columns[1:]), grow(columns[1:])), instructions=here)

    functional = tuple(FunctionalEvent(name) for name in "FGH")
    onward = EventTree("onward", (FunctionalEvent("K"),), ends("U"), (), two("K", "g0", end("U"), end("S")))
    first = EventTree(
        "tree", functional, (*ends("S", "R", "T"), Sequence("on", (*instructions(), Link("onward")))),
        (NamedBranch("shared", end("R", SetHouseEvent("x", True), CollectFormula("g4"))),), grow("FGH"),
    )  # fmt: skip
    basic = tuple(BasicEvent(name, Fraction(chance.randint(1, 9), 10)) for name in events)
    house = (HouseEvent("x", False), HouseEvent("y", True))
    return Study("study", tuple(gates), basic, house, initiating_events=(I,), event_trees=(first, onward))


def disagreements(seeds):
    return [seed for seed in seeds if answered(random_study(seed)) != by_play(random_study(seed), I)]


def test_random_event_trees_agree_with_the_play_of_every_state():
    assert disagreements(range(30)) == []


@pytest.mark.slow
def test_many_random_event_trees_agree_with_the_play_of_every_state():
    assert disagreements(range(1000, 1300)) == []


@pytest.mark.parametrize("ending", [".json", ".xml"])
def test_written_and_read_again_they_say_the_same(ending, tmp_path):
    for seed in range(12):
        study = random_study(seed)
        write(study, tmp_path / f"study{ending}")
        assert answered(read_study(tmp_path / f"study{ending}")) == answered(study)


def test_house_events_that_are_not_set_for_what_is_collected_are_noticed(monkeypatch):
    monkeypatch.setattr(event_tree_gates.Formulas, "_copy", lambda self, root, house: root)
    assert any(disagreements([seed]) for seed in range(40))


def test_the_partition_is_decided_by_logic_and_stays_true_for_any_probability():
    fine = study_of(SYSTEMS, two("F", "f", end("S"), two("G", "g", end("R"), end("S"))))
    assert analyse(fine, I).is_partition is True
    unknown = replace(fine, events=tuple(BasicEvent(event.name) for event in fine.events))
    answer = analyse(unknown, I)
    assert (answer.total, answer.is_partition) == (None, True)


@pytest.mark.parametrize(
    ("gates", "wrong"),
    [
        (("f", "g"), ["two of its paths can be taken at once", "there are cases in which", "add up to"]),
        (("f", "f"), ["two of its paths can be taken at once", "there are cases in which", "add up to"]),
        (("f", "nothing"), ["two of its paths can be taken at once", "add up to"]),
        (("f and g", "not f"), ["there are cases in which none of its paths is taken", "add up to"]),
    ],
)
def test_a_partition_that_is_none_is_noticed(gates, wrong):
    """Paths that overlap, a bypass where nothing is collected, a case left out."""
    branches = [
        end(name, *([CollectFormula(gate)] if gate != "nothing" else []))
        for name, gate in zip("SR", gates, strict=True)
    ]
    fork = Branch((), Fork("F", tuple(Path(f"state {i}", branch) for i, branch in enumerate(branches))))
    answer = analyse(study_of((*SYSTEMS, Gate("f and g", "and", ("f", "g"))), fork), I)
    assert answer.is_partition is False
    assert len(answer.wrong) == len(wrong)
    assert all(start in found for start, found in zip(wrong, answer.wrong, strict=True))


def test_an_overlap_that_only_the_logic_sees_is_noticed():
    """f or g, and neither: both paths lead to S, of which the probability is 1 whether they overlap or not."""
    fork = Branch((), Fork("F", (Path("1", end("S", CollectFormula("f"))), Path("2", end("S")))))
    answer = analyse(study_of(SYSTEMS, fork), I)
    assert answer.total.exact == 1
    assert answer.wrong == ("two of its paths can be taken at once",)


def fractions_of(*pairs):
    paths = [Path(f"state {i}", end(name, CollectExpression(value))) for i, (name, value) in enumerate(pairs)]
    return study_of((), Branch((), Fork("F", tuple(paths))))


def test_split_fractions_multiply_and_add_up():
    study = fractions_of(("S", "0.7"), ("R", "0.2"), ("S", "0.1"))
    answer = analyse(study, I)
    assert answered(study) == {"S": Fraction(8, 10), "R": Fraction(2, 10)} == by_play(study, I)
    assert answer.is_partition is True and answer.sequences["S"].solution.counts == (1,)
    answer = analyse(fractions_of(("S", "0.7"), ("R", "0.9")), I)
    assert answer.is_partition is False and "add up to 1.6, not to 1" in answer.wrong[0]


def test_formulas_and_expressions_together():
    inner = Fork(
        "G",
        tuple(Path(n, end(n, CollectExpression(v), CollectFormula("g"))) for n, v in (("S", "0.25"), ("R", "0.75"))),
    )
    study = study_of(SYSTEMS, two("F", "f", Branch((), inner), end("R")))
    assert answered(study) == by_play(study, I)
    sequence = analyse(study, I).sequences["R"]
    for name, one in sequence.importance().items():
        high, low = (by_play(study, I, {name: Fraction(state)}).get("R", 0) for state in (1, 0))
        assert one.birnbaum == pytest.approx(float(high - low), abs=1e-15)
        assert one.risk_achievement_worth == pytest.approx(float(high / by_play(study, I)["R"]), rel=1e-12)


def test_importance_and_cut_sets_of_a_sequence():
    """f and not g: by f alone, positive parts only; b helps f and hinders the success of g."""
    study = study_of(SYSTEMS, two("G", "g", two("F", "f", end("R"), end("S")), end("R")))
    sequence = analyse(study, I).sequences["S"]
    assert set(sequence.solution.cut_sets()) == {("a",), ("b",)}
    for name, one in sequence.importance().items():
        high, low = (by_play(study, I, {name: Fraction(state)}).get("S", 0) for state in (1, 0))
        assert one.birnbaum == pytest.approx(float(high - low), abs=1e-15)
    assert sequence.importance()["c"].birnbaum < 0


def test_frequencies_and_consequences_over_all_initiating_events():
    study = fractions_of(("S", "0.7"), ("R", "0.3"))
    first, second = replace(I, frequency="1e-3"), InitiatingEvent("J", "tree", "2e-3")
    answers = [(analyse(study, one), Fraction(1)) for one in (first, second)]
    assert answers[0][0].frequency_of("S").exact == Fraction(7, 10_000)
    assert {name: one.exact for name, one in consequences(answers).items()} == {
        "S": Fraction(21, 10_000),
        "R": Fraction(9, 10_000),
    }
    assert consequences([*answers, (analyse(study, I), Fraction(1))]) == {"S": None, "R": None}
    tested = Choice(InitiatingEventIs("J"), CollectExpression("0"), CollectExpression("1"))
    only_i = study_of((), end("S", tested))
    assert [analyse(only_i, one).total.exact for one in (first, second)] == [1, 0]


def test_the_entry_of_a_results_document():
    study = study_of(SYSTEMS, two("F", "f", end("S"), two("G", "g", end("R"), end("S"))))
    study = replace(study, initiating_events=(replace(I, frequency="1/8760"), InitiatingEvent("idle")))
    (entry,) = event_tree_entries(study, source="x.xml")
    json.dumps(entry, allow_nan=False)
    assert msgspec.convert(entry, EventTreeEntry, strict=True).keys() == entry.keys()  # each key is declared
    assert (entry["id"], entry["event_tree"], entry["total"], entry["partition"], entry["wrong"]) == (
        "I",
        "tree",
        1.0,
        True,
        [],
    )
    one = next(one for one in entry["sequences"] if one["id"] == "R")
    assert one["probability_exact"] == str(by_play(study, I)["R"])
    assert one["frequency"] == float(by_play(study, I)["R"] / 8760)
    assert one["paths"] == [{"F": "failure", "G": "success"}]
    assert one["minimal_cut_sets"]["by_order"] == {"1": 2}
    assert {row["event"] for row in one["importance"]} == {"a", "b", "c"}


def cyclic():
    return (NamedBranch("x", Branch((), ToBranch("y"))), NamedBranch("y", Branch((), ToBranch("x"))))


WRONG = {
    'goes on with the branch "x", which it does not have': lambda: study_of((), Branch((), ToBranch("x"))),
    "branches in a cycle: x -> y -> x": lambda: study_of((), Branch((), ToBranch("x")), branches=cyclic()),
    'two forks of "F"': lambda: study_of(SYSTEMS, two("F", "f", end("S"), two("F", "g", end("S"), end("R")))),
    'fork of "Z", which is no functional event': lambda: study_of(SYSTEMS, two("Z", "f", end("S"), end("R"))),
    'two paths for the state "1"': lambda: study_of(
        (), Branch((), Fork("F", (Path("1", end("S")), Path("1", end("R")))))
    ),
    'the fork of "F" has no path': lambda: study_of((), Branch((), Fork("F", ()))),
    "in the middle of a branch": lambda: study_of((), end("S", Block((Link("tree"),)))),
    'ends in the sequence "Q", which is not defined': lambda: study_of((), end("Q")),
    'has two sequences "S"': lambda: study_of((), end("S"), ("S", "S")),
    "event trees linked in a cycle: tree -> tree": lambda: study_of((), end("S"), (Sequence("S", (Link("tree"),)),)),
    'leads to the event tree "far", which is not': lambda: study_of((), end("S"), (Sequence("S", (Link("far"),)),)),
    'uses two rules "x" that say different': lambda: study_of((), end("S", Rule("x", ()), Rule("x", (Block(()),)))),
    'two rules "x" say different things': lambda: study_of(
        (), end("S", Rule("x", ())), more=(EventTree("far", (), (), (), end("S", Rule("x", (Block(()),)))),)
    ),
    'collects "z", which is not defined': lambda: study_of(SYSTEMS, end("S", CollectFormula("z"))),
    'sets the house event "a", which': lambda: study_of(
        SYSTEMS, end("S", SetHouseEvent("a", True), CollectFormula("f"))
    ),
    "an expression of an event tree is -1, expected 0": lambda: study_of((), end("S", CollectExpression("-1"))),
    "a test is 'xor' of 1 parts": lambda: Combined("xor", (InitiatingEventIs("I"),)),
}


@pytest.mark.parametrize("message", WRONG)
def test_refused(message):
    with pytest.raises(TreeError) as error:
        analyse(WRONG[message](), I)
    assert message in str(error.value)

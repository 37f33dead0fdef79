"""Galileo text: what is read, what is refused and where, and the round trip."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent, TreeError
from safety.trees.dynamic.tree import Dependency, DynamicGate, DynamicTree, Restriction, TimedEvent
from safety.trees.formats.galileo import is_galileo, read_galileo, to_galileo
from tests.trees.random_dynamic import random_dynamic

EVENTS = '"A" lambda=1e-3;\n"B" lambda=2e-3 dorm=0.5;\n"C" prob=0.25;\n'


def read(text):
    return read_galileo(text.encode(), "plant.dft")


def test_every_construct_in_any_order():
    tree = read(
        EVENTS.replace('"C"', "C")
        + """// a comment; with a statement;
        "T" or V "P" "Q" S I L X F; /* two
        lines */ toplevel "T";
        V 2of3 "A" "B" C; "P" pand-excl "A" "B"; "Q" por "B" "A"; S wsp D "B"; I inhibit "A" C;
        D lambda = 1/3;
        F fdep "A" "B" D; X pdep=0.2 "B" C;
        L seq "A" "B"; M mutex "A" D;
        """
    )
    assert tree.top == "T"
    assert tree.gates == (
        DynamicGate("T", "or", ("V", "P", "Q", "S", "I")),  # dependencies and restrictions have no output
        DynamicGate("V", "vote", ("A", "B", "C"), 2),
        DynamicGate("P", "pand", ("A", "B"), exclusive=True),
        DynamicGate("Q", "por", ("B", "A")),
        DynamicGate("S", "spare", ("D", "B")),
        DynamicGate("I", "inhibit", ("A", "C")),
    )
    assert tree.events == (
        TimedEvent("A", Fraction(1, 1000)),
        TimedEvent("B", Fraction(1, 500), dormancy=Fraction(1, 2)),
        TimedEvent("C", probability=Fraction(1, 4)),
        TimedEvent("D", Fraction(1, 3)),
    )
    assert tree.dependencies == (Dependency("F", "A", ("B", "D")), Dependency("X", "B", ("C",), Fraction(1, 5)))
    assert tree.restrictions == (Restriction("L", "seq", ("A", "B")), Restriction("M", "mutex", ("A", "D")))
    assert tree.dynamic_elements == ("P", "Q", "S", "F", "X", "L", "M")
    assert read(to_galileo(tree)) == tree


@given(st.integers(0, 10**9), st.integers(3, 9))
def test_what_is_written_is_read_back(seed, events):
    tree = random_dynamic(seed, events)
    assert read(to_galileo(tree)) == tree


@given(st.fractions(0, 1000), st.fractions(0, 1))
def test_numbers_come_back_exactly(rate, chance):
    tree = DynamicTree(
        "T",
        "T",
        (DynamicGate("T", "or", ("A", "B")),),
        (TimedEvent("A", rate, dormancy=chance), TimedEvent("B", probability=chance)),
        (Dependency("D", "A", ("B",), chance),),
    )
    assert read(to_galileo(tree)) == tree


@pytest.mark.parametrize(
    ("vote", "k"),
    [("2of3", 2), ("vot2", 2), ("vote1", 1)],
)
def test_ways_to_write_a_vote(vote, k):
    assert read(f'toplevel T; T {vote} "A" "B" "C";' + EVENTS).gates[0].k == k


def test_a_top_that_is_an_event_gets_a_gate():
    tree = read('toplevel "A";' + EVENTS)
    assert (tree.top, tree.gates) == ("A (top)", (DynamicGate("A (top)", "or", ("A",)),))
    assert read(to_galileo(tree)) == tree


def test_cold_and_hot_reserve():
    rate = "A lambda=1; B lambda=1; C lambda=1;"
    assert [e.dormancy for e in read(f"toplevel T; T csp A B C; {rate}").events] == [1, 0, 0]
    assert [e.dormancy for e in read(f"toplevel T; T hsp A B C; {rate}").events] == [1, 1, 1]
    assert [e.dormancy for e in read(f"toplevel T; T wsp A B C; {rate}").events] == [1, 1, 1]
    with pytest.raises(TreeError, match='"B" has dormancy 1/2, but the csp gate "T" keeps it at 0'):
        read("toplevel T; T csp A B; A lambda=1; B lambda=1 dorm=0.5;")
    with pytest.raises(TreeError, match='"B" has dormancy 0, but the hsp gate "G" keeps it at 1'):
        read("toplevel T; T csp A B; G hsp C B; A lambda=1; B lambda=1; C lambda=1;")


def test_a_static_tree_both_ways():
    tree = read('toplevel "T"; "T" 2of3 "A" "B" "C";' + EVENTS)
    static = tree.static(Fraction(10))
    assert static.gates == (Gate("T", "vote", ("A", "B", "C"), 2),)
    assert static.nodes["A"].mission_time_h == 10
    assert DynamicTree.of(static) == DynamicTree(
        "T", "T", tree.gates, tuple(TimedEvent(e.name, e.rate_per_hour, e.probability) for e in tree.events)
    )
    with pytest.raises(TreeError, match=r'"A" has a rate of .* per hour and no mission time'):
        tree.static()
    with pytest.raises(TreeError, match='is a dynamic tree \\("T" depends on the order'):
        read('toplevel "T"; "T" pand "A" "B";' + EVENTS).static(Fraction(1))


def test_a_static_tree_is_written():
    events = (
        BasicEvent("a", Fraction(1, 8)),
        BasicEvent("b", rate_per_hour=Fraction(1, 100), mission_time_h=Fraction(1)),
    )
    tree = FaultTree("t", "t", (Gate("t", "or", ("a", "b", "h")),), events, (HouseEvent("h", True),))
    assert to_galileo(tree).splitlines() == [
        'toplevel "t";',
        '"t" or "a" "b" "h";',
        '"a" prob=125e-3 dorm=1;',
        '"b" lambda=1e-2 dorm=1;',
        '"h" prob=1 dorm=1;',
    ]
    with pytest.raises(TreeError, match='"t" is a not'):
        to_galileo(FaultTree("t", "t", (Gate("t", "not", ("a",)),), events[:1]))
    with pytest.raises(TreeError, match="holds a quote"):
        to_galileo(DynamicTree("t", "t", (DynamicGate("t", "or", ('a"b',)),), (TimedEvent('a"b', Fraction(1)),)))


def test_recognised_by_content():
    assert is_galileo(b'\xef\xbb\xbf// toplevel\n toplevel "A";')
    assert is_galileo(b'"A" lambda=1;\ntoplevel "B";')
    assert not is_galileo(b"<opsa-mef><label>toplevel </label></opsa-mef>")
    assert not is_galileo(b'{"toplevel": 1}') and not is_galileo(b"root = a & b;")


BAD = [
    ("", 1, "no top is named"),
    ("toplevel A;\ntoplevel B;", 2, 'toplevel is "B", but it was "A" before'),
    ("toplevel A B;", 1, "toplevel names 2 elements"),
    ("toplevel A;\nA or B\n", 2, 'the statement of "A" does not end'),
    ('toplevel A;\nA or "B;\n', 2, "a quote is not closed"),
    ("toplevel A;\n/* for ever", 2, "a comment not at all"),
    ('toplevel A;\n\nA or "";', 3, '"" is no name'),
    ("toplevel A;\nA or B;", 2, '"A" uses "B", which is neither a gate nor an event'),
    ("toplevel X;\nA or B; B lambda=1;", 1, 'the top "X" is no gate'),
    ("toplevel F;\nA or B C;\nB lambda=1;\nC lambda=1;F fdep B C;", 4, 'the top "F" is no gate'),
    ("toplevel A;\nA or B;\nB lambda=1;\nB lambda=2;", 4, '"B" is defined twice, first in line 3'),
    ("toplevel A;\nA or B B;\nB lambda=1;", 2, 'has the input "B" more than once'),
    ("toplevel A;\nA or;\n", 2, "has 0 inputs"),
    ("toplevel A;\nA;\n", 2, '"A" has no definition'),
    ("toplevel A;\nA 3of2 B C;\nB lambda=1; C lambda=1;", 2, "k = 3 of 2 inputs"),
    ("toplevel A;\nA 2of3 B C;\nB lambda=1; C lambda=1;", 2, "is a 2of3 with 2 inputs"),
    ("toplevel A;\nA xor B C;\nB lambda=1; C lambda=1;", 2, "is of type 'xor', expected one of and, or"),
    ("toplevel A;\nA or G;\nG and A B;\nB lambda=1;", 2, "cycle of gates: A -> G -> A"),
    ("toplevel A;\nA or B;\nB lambda=-1;", 3, 'rate_per_hour of event "B" is -1'),
    ("toplevel A;\nA or B;\nB prob=1.3;", 3, 'probability of event "B" is 13/10'),
    ("toplevel A;\nA or B;\nB lambda=fast;", 3, "lambda of event \"B\" is 'fast'"),
    ("toplevel A;\nA or B;\nB lambda=1 prob=0.5;", 3, "a rate and a probability"),
    ("toplevel A;\nA or B;\nB dorm=1;", 3, "neither a rate nor a probability"),
    ("toplevel A;\nA or B;\nB lambda=1 lambda=2;", 3, "lambda= more than once"),
    ("toplevel A;\nA or B;\nB lambda=1 dorm;", 3, "expected attribute=value"),
    ("toplevel A;\nA or B;\nB lambda=1 mean=3;", 3, "attribute 'mean', which is not supported"),
    ("toplevel A;\nA or B;\nB lambda=1 repair=3;", 3, "repair is not supported"),
    ("toplevel A;\nA or B;\nB rate=1 shape=2;", 3, "only shape=1"),
    ("toplevel A;\nA or B;\nB lambda=1;\nF fdep B;", 4, "expected a trigger and its dependents"),
    ("toplevel A;\nA or B;\nB lambda=1;\nF fdep B A;", 4, 'has the gate "A" as a dependent'),
    ("toplevel A;\nA or B;\nB lambda=1;\nF fdep B B;", 4, 'has its trigger "B" as a dependent'),
    ("toplevel A;\nA or B;\nB lambda=1;\nF pdep B;", 4, "a pdep without a probability"),
    ("toplevel A;\nA or B C;\nB lambda=1;C lambda=1;\nF pdep=2 B C;", 4, 'probability of dependency "F" is 2'),
    ("toplevel A;\nA or F;\nB lambda=1;C lambda=1;\nF fdep B C;", 2, "have no output"),
    ("toplevel A;\nA or B;\nB lambda=1;\nS seq B;", 4, "has 1 inputs, expected at least 2"),
    ("toplevel A;\nA or G H;\nG wsp B C;\nH wsp B D;\nB lambda=1;C lambda=1;D lambda=1;", 4, 'both begin with "B"'),
    ("toplevel A;\nA or B=;", 2, "expected names only"),
    ("toplevel A;\n= or B;", 2, "begins with '='"),
]


@pytest.mark.parametrize(("text", "line", "message"), BAD)
def test_what_is_wrong_is_said_with_its_line(text, line, message):
    with pytest.raises(TreeError) as found:
        read(text)
    assert str(found.value).startswith(f"plant.dft:{line}: ")
    assert message in str(found.value)


def test_bytes_that_are_no_text():
    with pytest.raises(TreeError, match=r"plant.dft:2: byte 0xff is not UTF-8"):
        read_galileo(b"toplevel A;\n\xff", "plant.dft")


@given(st.text(alphabet='AB"=; \n/*123ofdlamband.-_', max_size=60))
def test_no_text_brings_anything_but_a_tree_or_a_tree_error(text):
    try:
        read("toplevel A;A or B;B lambda=1;" + text)
    except TreeError as error:
        assert error.place.startswith("plant.dft:")

"""The Aralia trees against figures of SCRAM and of a program independent of ours (shared/oracles/fault_trees).

Read in place from $RIGHTSIDE_ORACLES, else from ../shared/oracles beside the project. The probability of nus9601 is
known to nobody: it is enclosed, and the enclosure compared with cut sets that anyone can confirm.
"""

import csv
import itertools

import pytest

from safety.trees import FaultTree, Gate, read, solve
from safety.trees.cut_sets.enclosures import enclose
from tests.oracles import SHARED

FOLDER = SHARED / "fault_trees"
ROWS = 28
SLOW = ("cea9601", "das9701")  # seconds to minutes
BEYOND = ("nus9601",)
LIKELY = (  # cut sets of nus9601 that SCRAM 0.16.2 finds up to order 3 (--zbdd -l 3)
    "e5 e1566 e1564", "e5 e1560 e1561", "e5 e1561 e1559", "e1562 e1567 e1564", "e1562 e1560 e1563",
    "e1562 e1563 e1559", "e1 e1558 e1557", "e4 e1558 e1557", "e2 e1558 e1557", "e3 e1558 e1557",
)  # fmt: skip

if not FOLDER.is_dir():
    pytest.skip(f"{FOLDER} is absent: {ROWS} oracle rows not checked; set RIGHTSIDE_ORACLES", allow_module_level=True)

with (FOLDER / "expected.csv").open(newline="") as file:
    EXPECTED = {row["name"]: row for row in csv.DictReader(file)}

SOLVED = [pytest.param(n, marks=pytest.mark.slow if n in SLOW else ()) for n in EXPECTED if n not in BEYOND]


def aralia(name):
    return read(FOLDER / "aralia" / f"{name}.xml")


def test_every_row_is_solved_or_named_as_beyond_reach():
    assert len(EXPECTED) == ROWS
    assert set(BEYOND) | set(SLOW) < set(EXPECTED)


@pytest.mark.parametrize("name", EXPECTED)
def test_as_many_gates_and_events_as_published(name):
    tree, row = aralia(name), EXPECTED[name]
    assert sum(not gate.inside for gate in tree.gates) == int(row["gates"])
    assert len(tree.events) == int(row["basic_events"])


@pytest.mark.parametrize("name", SOLVED)
def test_probability_and_cut_sets_by_order(name):
    solution, row = solve(aralia(name)), EXPECTED[name]
    assert solution.probability == pytest.approx(float(row["p_top"]), rel=1e-9, abs=0)
    low, high = solution.bounds
    assert low * (1 - 1e-12) <= float(row["p_top"]) <= high * (1 + 1e-12)  # printed with 14 digits
    if solution.nodes < 10_000:
        assert low <= solution.exact <= high
    assert sum(solution.counts) == int(row["mcs_total"])
    if row["mcs_by_order"]:
        assert list(solution.counts[1:]) == [int(n) for n in row["mcs_by_order"].split()]


@pytest.mark.slow
def test_the_probability_that_nobody_knows_is_enclosed_within_a_tenth():
    tree = aralia("nus9601")
    found = enclose(tree)
    assert 0 < found.lower <= found.upper <= 1.1 * found.lower
    assert {gate.kind for gate in tree.gates} <= {"and", "or", "vote"}  # monotone: any of its cut sets may be left out
    sets = [tuple(names.split()) for names in LIKELY]
    assert all(tree.occurs(one) for one in sets)
    gates = [Gate(f"set {i}", "and", one) for i, one in enumerate(sets)]
    some = [event for event in tree.events if any(event.name in one for one in sets)]
    part = FaultTree("part", "top", (*gates, Gate("top", "or", tuple(gate.name for gate in gates))), tuple(some))
    assert solve(part).exact <= found.upper


def test_the_smallest_of_seven_billion_cut_sets_are_listed_at_once():
    tree = aralia("edf9206")
    solution = solve(tree)
    first = list(itertools.islice(solution.cut_sets(), 100))
    assert [len(cut_set) for cut_set in first] == [6] * 8 + [7] * 72 + [8] * 20
    assert len(set(first)) == 100
    for cut_set in first:
        assert tree.occurs(cut_set)
        assert not any(tree.occurs(set(cut_set) - {event}) for event in cut_set)

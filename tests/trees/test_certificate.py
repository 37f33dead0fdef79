"""Certificates of solved trees: checked without anything of ours, and rejected as soon as they say anything else."""

import copy
import csv
import hashlib
import json
import math
import subprocess
import sys
from fractions import Fraction

import pytest

from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent, read, solve
from safety.trees import check_tree as checker
from safety.trees.certificate import certificate, write
from safety.trees.expressions.lifetimes import Weibull
from tests.oracles import SHARED
from tests.trees.brute import Truth, by_order
from tests.trees.random_trees import random_tree

GATES = (
    Gate("top", "or", ("pair", "voted", "guarded")),
    Gate("pair", "and", ("a", "b", "on")),
    Gate("voted", "vote", ("c", "d", "odd"), 2),
    Gate("odd", "xor", ("e", "f")),
    Gate("guarded", "and", ("g", "fine")),
    Gate("fine", "not", ("a",)),
)
PROBABILITIES = ("1/3", "0.2", "1e-3", "0.04", "1/7", "0.5", "1e-9")
EVENTS = tuple(BasicEvent(name, p) for name, p in zip("abcdefg", PROBABILITIES, strict=True))
TREE = FaultTree("guard", "top", GATES, EVENTS, (HouseEvent("on", True),))
MODULES = FaultTree(
    "modules",
    "top",
    (Gate("top", "vote", ("m", "n", "x"), 2), Gate("m", "or", ("a", "b")), Gate("n", "vote", ("c", "d", "e"), 2)),
    tuple(BasicEvent(name, "0.1") for name in "abcdex"),
)


def verdict(document):
    """What the checker says of a document, with the digests brought up to date: no forger would forget them."""
    for key in ("tree", "reduced"):
        document["sha256"][key] = hashlib.sha256(json.dumps(document[key], sort_keys=True).encode()).hexdigest()
    try:
        checker.check(json.loads(json.dumps(document)))
    except checker.Refused as refused:
        return refused.args[0]
    except (ValueError, TypeError, LookupError):
        return checker.UNREADABLE
    return checker.CHECKED


def test_a_certificate_is_checked_by_python_alone(tmp_path):
    file = tmp_path / "guard.json"
    write(solve(TREE), file)
    done = subprocess.run([sys.executable, "-I", "-S", checker.__file__, file], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    (report,) = json.loads(done.stdout)
    assert (report["verdict"], report["name"]) == (checker.CHECKED, "guard")
    assert report["cut_sets_by_order"] == list(solve(TREE).counts) == list(by_order(Truth(TREE).minimal()))
    assert Fraction(report["probability"][0]) <= Truth(TREE).probability() <= Fraction(report["probability"][1])


def test_the_checker_is_short_and_imports_nothing_of_ours():
    with open(checker.__file__, encoding="utf-8") as file:
        text = file.read()
    assert len(text.splitlines()) < 200
    assert "safety" not in text.replace("safety-", "")


@pytest.mark.parametrize("block", range(4))
def test_certificates_of_random_trees_are_checked(block):
    for seed in range(100 * block, 100 * (block + 1)):
        assert verdict(certificate(solve(random_tree(seed, 10)))) == checker.CHECKED, seed


def gate(document, name):
    return next(one for one in document["tree"]["gates"] if one[0] == name)


def last_node(document):
    return document["diagram"]["nodes"][-1]


FORGED = {
    "a node's branches": lambda c: last_node(c).__setitem__(slice(1, 3), last_node(c)[:0:-1]),
    "a node's opposite": lambda c: last_node(c).__setitem__(2, last_node(c)[2] ^ 1),
    "a node's variable": lambda c: last_node(c).__setitem__(0, c["diagram"]["nodes"][0][0]),
    "the root": lambda c: c["diagram"].__setitem__("root", c["diagram"]["root"] ^ 1),
    "the order": lambda c: c.__setitem__("order", c["order"][::-1]),
    "an event left out of the order": lambda c: c["order"].pop(),
    "the lower bound": lambda c: c.__setitem__("probability", [math.nextafter(c["probability"][1], 1), 1.0]),
    "the upper bound": lambda c: c.__setitem__("probability", [0.0, math.nextafter(c["probability"][0], 0)]),
    "the chance of an event": lambda c: c["tree"]["events"][0].__setitem__(1, "1/4"),
    "the kind of a gate": lambda c: gate(c, "pair").__setitem__(1, "or"),
    "an input of a gate": lambda c: gate(c, "pair").__setitem__(2, ["a", "c", "on"]),
    "the k of a vote": lambda c: gate(c, "voted").__setitem__(3, 1),
    "the top": lambda c: c["tree"].__setitem__("top", "voted"),
    "a house event": lambda c: c["tree"]["house_events"][0].__setitem__(1, False),
    "a simplified gate": lambda c: c["reduced"]["gates"][-1].__setitem__(0, "and"),
    "the number of cut sets": lambda c: c["cut_sets_by_order"].__setitem__(2, c["cut_sets_by_order"][2] + 1),
    "the order of cut sets": lambda c: c["cut_sets_by_order"].insert(0, 0),
    "the last cut sets": lambda c: c["cut_sets_by_order"].pop(),
}


@pytest.mark.parametrize("what", FORGED)
def test_a_forged_certificate_is_rejected(what):
    document = json.loads(json.dumps(certificate(solve(TREE))))
    assert verdict(copy.deepcopy(document)) == checker.CHECKED
    FORGED[what](document)
    assert verdict(document) == checker.REJECTED


UNREADABLE = {
    "a module is missing": lambda c: c["diagram"]["nodes"].__delitem__(slice(0, 2)),
    "a gate is missing": lambda c: c["tree"]["gates"].__delitem__(0),
    "a gate is there twice": lambda c: c["tree"]["gates"].append(c["tree"]["gates"][0]),
    "a gate without inputs": lambda c: gate(c, "m").__setitem__(2, []),
    "a not of two": lambda c: gate(c, "m").__setitem__(1, "not"),
    "an unknown gate": lambda c: gate(c, "m").__setitem__(1, "maybe"),
    "a cycle": lambda c: gate(c, "m").__setitem__(2, ["top", "a"]),
    "an event and a house event of one name": lambda c: c["tree"]["house_events"].append(["a", True]),
    "a chance above 1": lambda c: c["tree"]["events"][0].__setitem__(1, "4/3"),
    "no chance": lambda c: c["tree"]["events"][0].__setitem__(1, "often"),
    "another format": lambda c: c.__setitem__("format", "rightside certificate 1"),
    "a part is missing": lambda c: c.__delitem__("diagram"),
}


@pytest.mark.parametrize("what", UNREADABLE)
def test_what_is_no_certificate_is_not_accepted(what):
    document = json.loads(json.dumps(certificate(solve(MODULES))))
    assert verdict(copy.deepcopy(document)) == checker.CHECKED
    UNREADABLE[what](document)
    assert verdict(document) in (checker.UNREADABLE, checker.REJECTED)


def test_a_changed_digest_is_rejected_and_a_text_is_no_certificate(tmp_path):
    document = certificate(solve(TREE))
    document["sha256"]["reduced"] = "0" * 64
    (tmp_path / "forged.json").write_text(json.dumps(document), encoding="utf-8")
    (tmp_path / "text.json").write_text("no certificate", encoding="utf-8")
    files = [tmp_path / name for name in ("forged.json", "text.json", "absent.json")]
    assert [checker.examine(file)["verdict"] for file in files] == [
        checker.REJECTED, checker.UNREADABLE, checker.UNREADABLE,
    ]  # fmt: skip


def test_a_diagram_beyond_the_limit_is_undecided(monkeypatch):
    document = certificate(solve(TREE))
    monkeypatch.setattr(checker, "MOST_NODES", 10)
    assert verdict(document) == checker.UNDECIDED


@pytest.mark.parametrize("x", ["1/8", "1e-6", "7/3", "12345/1000", "800"])
def test_rates_are_enclosed(x):
    events = (BasicEvent("a", rate_per_hour=x, mission_time_h=1), BasicEvent("b", "1/3"))
    document = certificate(solve(FaultTree("t", "top", (Gate("top", "and", ("a", "b")),), events)))
    assert document["tree"]["events"][0][1] == f"1-exp(-{Fraction(x)})"
    assert verdict(document) == checker.CHECKED
    low, high = (Fraction(bound, checker.ONE) for bound in checker.chance(document["tree"]["events"][0][1]))
    assert low <= high <= low + Fraction(1, 10**300)
    assert math.isclose(low, -math.expm1(-float(Fraction(x))), rel_tol=1e-15)


def test_an_expression_stands_with_what_it_comes_to():
    events = (BasicEvent("a", expression=Weibull(1000, 1.5, 0, 80)), BasicEvent("b", "1/3"))
    solution = solve(FaultTree("t", "top", (Gate("top", "and", ("a", "b")),), events))
    document = certificate(solution)
    assert float(document["tree"]["events"][0][1]) == events[0].chance[0]
    assert verdict(document) == checker.CHECKED


def test_without_probabilities_function_and_cut_sets_are_certified():
    events = (BasicEvent("a"), BasicEvent("b", "1/3"))
    document = certificate(solve(FaultTree("t", "top", (Gate("top", "or", ("a", "b")),), events)))
    assert (document["probability"], verdict(document)) == (None, checker.CHECKED)


CERTIFIED = [
    "baobab1", "chinese", "das9201", "das9203", "das9204", "das9206", "das9208", "ftr10", "isp9601", "isp9603",
    "isp9605", "isp9606", "isp9607", "edf9201",
]  # fmt: skip
LONGER = ["elf9601", "edf9206", "das9601", "edfpa15p", "edfpa15q", "edfpa15r", "edfpa15b", "edfpa14p", "edfpa14b",
          "jbd9601", "edf9203"]  # fmt: skip


@pytest.mark.parametrize("name", CERTIFIED + [pytest.param(name, marks=pytest.mark.slow) for name in LONGER])
def test_public_trees_are_certified(name, tmp_path):
    folder = SHARED / "fault_trees"
    if not folder.is_dir():
        pytest.skip(f"{folder} is absent: the certificates of {len(CERTIFIED)} public trees are not checked")
    with (folder / "expected.csv").open(newline="") as file:
        expected = next(row for row in csv.DictReader(file) if row["name"] == name)
    write(solve(read(folder / "aralia" / f"{name}.xml")), tmp_path / "c.json")
    report = checker.examine(tmp_path / "c.json")
    assert (report["verdict"], report["why"]) == (checker.CHECKED, "")
    assert sum(report["cut_sets_by_order"]) == int(expected["mcs_total"])
    assert report["probability"][0] <= float(expected["p_top"]) * (1 + 1e-12)
    assert report["probability"][1] >= float(expected["p_top"]) * (1 - 1e-12)

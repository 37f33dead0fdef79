"""The entry of a results document."""

import json
import math
from fractions import Fraction

import msgspec
import pytest

from safety.report.schema import Tree
from safety.trees import BasicEvent, FaultTree, Gate, from_cut_sets, summary
from safety.trees.formats.json_form import to_document

TREE = FaultTree(
    "permit",
    "top",
    (Gate("top", "or", ("pair", "c")), Gate("pair", "and", ("a", "b"))),
    (BasicEvent("a", "1/3", source="P"), BasicEvent("b", "1/7", source="A"), BasicEvent("c", "1/10")),
)
KEYS = {"id", "source", "gates", "basic_events", "probability", "probability_low", "probability_high"}
KEYS |= {"minimal_cut_sets", "importance", "seconds", "exact", "structure"}


def test_the_entry_has_the_keys_of_the_results_document():
    entry = summary(TREE, source="permit.xml", read_s=0.5)
    assert entry.keys() >= KEYS
    assert (entry["id"], entry["source"], entry["gates"], entry["basic_events"]) == ("permit", "permit.xml", 2, 3)
    assert entry["exact"] == "1/7"
    assert entry["probability"] == 1 / 7
    assert Fraction(entry["probability_low"]) <= Fraction(1, 7) <= Fraction(entry["probability_high"])
    assert math.nextafter(entry["probability_low"], 1) == entry["probability_high"]
    assert entry["minimal_cut_sets"] == {
        "count": 2,
        "by_order": {"1": 1, "2": 1},
        "sets": [
            {"events": ["c"], "probability": 0.1},
            {"events": ["a", "b"], "probability": pytest.approx(1 / 21)},
        ],
        "not_listed": 0,
    }
    assert [row["event"] for row in entry["importance"]] == ["c", "a", "b"]
    assert entry["importance"][1]["source"] == "P"
    assert entry["structure"] == to_document(TREE)
    assert entry["seconds"]["total"] == entry["seconds"]["solve"] + 0.5


def test_the_entry_is_plain_and_fits_the_schema():
    entry = summary(TREE)
    assert json.loads(json.dumps(entry, allow_nan=False)) == entry
    msgspec.convert(entry, Tree)


def test_how_many_cut_sets_are_not_listed_is_said():
    sets = [(f"e{i}", f"e{i + 1}") for i in range(30)]
    tree = from_cut_sets("wide", sets, [BasicEvent(f"e{i}", "1e-3") for i in range(31)])
    found = summary(tree, listed=10)["minimal_cut_sets"]
    assert (found["count"], len(found["sets"]), found["not_listed"]) == (30, 10, 20)


def test_unknown_is_none_and_infinite_is_inf():
    gates = (Gate("top", "and", ("a", "b")),)
    unknown = summary(FaultTree("t", "top", gates, (BasicEvent("a"), BasicEvent("b", "0.5"))))
    assert [unknown[key] for key in ("probability", "probability_low", "probability_high", "exact")] == [None] * 4
    assert unknown["importance"] == []
    assert unknown["minimal_cut_sets"]["sets"] == [{"events": ["a", "b"], "probability": None}]
    known = summary(FaultTree("t", "top", gates, (BasicEvent("a", 0.5), BasicEvent("b", "0.5"))))
    assert {row["risk_reduction_worth"] for row in known["importance"]} == {"inf"}


def test_a_rational_too_long_to_write_still_gives_neighbouring_bounds():
    events = tuple(BasicEvent(f"e{i}", Fraction(1, 10**60 + 7 * i)) for i in range(80))
    entry = summary(FaultTree("t", "top", (Gate("top", "xor", tuple(e.name for e in events)),), events))
    assert entry["exact"] is None
    assert math.nextafter(entry["probability_low"], 1) == entry["probability_high"]


def test_rates_give_an_enclosure_and_no_rational():
    events = tuple(BasicEvent(name, rate_per_hour="1e-7", mission_time_h=8760) for name in "abc")
    entry = summary(FaultTree("2oo3", "top", (Gate("top", "vote", tuple("abc"), 2),), events))
    q = -math.expm1(-8.76e-4)
    assert entry["exact"] is None
    assert entry["probability_low"] < 3 * q**2 - 2 * q**3 < entry["probability_high"]
    assert entry["probability_high"] / entry["probability_low"] < 1 + 1e-13

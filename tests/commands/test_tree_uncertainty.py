"""`rightside tree FILE --uncertainty N` for event trees and dynamic trees: the same options and keys as for a tree."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from safety.report.html import html
from safety.report.results import validate
from tests.commands.conftest import Run, put
from tests.commands.test_tree_files import DYNAMIC, EVENT_TREE, LOGNORMAL, STATIC, solved

KEYS = {
    "method", "samples", "hypercubes", "seed", "variables", "correlated", "mean", "standard_error",
    "standard_deviation", "error_factor", "quantiles", "histogram", "set_to_range",
}  # fmt: skip
DATA = """<opsa-mef><model-data><define-parameter name="r" unit="hours-1"><attributes><attribute name="source"
 value="A"/></attributes><lognormal-deviate><float value="1e-3"/><float value="3"/><float value="0.95"/>
</lognormal-deviate></define-parameter><define-basic-event name="A"><exponential><parameter name="r"/>
<system-mission-time/></exponential></define-basic-event></model-data></opsa-mef>"""
GROUP = """<define-CCF-group name="G" model="beta-factor"><members><basic-event name="B"/>
<basic-event name="C"/></members><distribution><float value="0.1"/></distribution><factor level="2">
<float value="0.1"/></factor></define-CCF-group></opsa-mef>"""
UNSURE = EVENT_TREE.replace(
    'event-tree="after"/>', 'event-tree="after"><float value="0.5"/></define-initiating-event>', 1
)
UNSURE = UNSURE.replace(
    '<float value="0.1"/>', "<uniform-deviate><float value='0.05'/><float value='0.15'/></uniform-deviate>"
)


@pytest.fixture(autouse=True)
def files(project: Path) -> Path:
    texts = {
        "after.xml": UNSURE, "certain.xml": EVENT_TREE, "dynamic.dft": DYNAMIC, "static.dft": STATIC,
        "rates.xml": DATA, "tree.xml": LOGNORMAL, "cor.json": '{"rank_correlations": [["r", "a", 0.5]]}',
        "none.xml": "<opsa-mef><model-data/></opsa-mef>",
        "group.xml": DATA.replace("</opsa-mef>", GROUP),
        "wrong.xml": DATA.replace('name="A"', 'name="Z"'),
    }  # fmt: skip
    for name, text in texts.items():
        put(project, name, text)
    return project


def test_every_sequence_has_its_spread(run: Run) -> None:
    entry = solved(run, "after.xml", "--uncertainty", "400", "--seed", "3", section="event_trees")
    for row in entry["sequences"]:
        assert row["uncertainty"].keys() == row["frequency_uncertainty"].keys() == KEYS
        assert row["uncertainty"]["variables"] == ["a"] and row["uncertainty"]["seed"] == 3
        assert row["frequency_uncertainty"]["mean"] == pytest.approx(0.5 * row["uncertainty"]["mean"])
        assert row["frequency_of_all_initiating_events_uncertainty"] == row["frequency_uncertainty"]
    spill = entry["sequences"][1]["uncertainty"]
    assert 0.2 + 0.8 * 0.05 < spill["quantiles"][0]["value"] < spill["mean"] < 0.2 + 0.8 * 0.15
    assert spill["mean"] == pytest.approx(0.28, abs=4 * spill["standard_error"])


@pytest.mark.parametrize("words", [["after.xml"], ["dynamic.dft", "rates.xml", "--hours", "10"]])
def test_the_options_of_sampling_do_something(run: Run, words: list[str]) -> None:
    def values(*more: str) -> list[dict[str, Any]]:
        called = run("tree", *words, "--uncertainty", "200", *more, "--json", "-")
        assert called.code == 0, called.err
        document = json.loads(called.out)
        entries: list[dict[str, Any]] = document.get("event_trees") or document["trees"]
        for entry in entries:
            del entry["seconds"]
        return entries

    plain = values()
    assert values() == plain and values("--seed", "2") != plain
    cube = values("--lhs")[0]
    found = cube["sequences"][0]["uncertainty"] if "sequences" in cube else cube["uncertainty"]
    assert found["method"] == "Latin hypercube" and found["hypercubes"] and found["quantiles"][0]["confidence"] is None


def test_what_people_read_of_sequences(run: Run) -> None:
    said = run("tree", "after.xml", "--uncertainty", "200").out
    assert "uncertainty of the frequencies: 200 samples (Monte Carlo, seed 1) of 1 random variable" in said
    assert "95 %, with confidence 0.95 or more" in said and "over all initiating events" not in said
    assert "with confidence" not in run("tree", "after.xml", "--uncertainty", "200", "--lhs").out


def test_two_initiating_events_are_added_up(run: Run, project: Path) -> None:
    second = '<define-initiating-event name="fire" event-tree="after"><float value="2"/></define-initiating-event>'
    put(project, "two.xml", UNSURE.replace("<opsa-mef>", "<opsa-mef>" + second))
    called = run("tree", "two.xml", "--uncertainty", "200", "--json", "two.json")
    assert called.code == 0 and "over all initiating events" in called.out
    rows = [entry["sequences"][1] for entry in json.loads((project / "two.json").read_text())["event_trees"]]
    key = "frequency_of_all_initiating_events_uncertainty"
    assert rows[0][key]["mean"] == pytest.approx(sum(row["frequency_uncertainty"]["mean"] for row in rows))


def test_a_dynamic_tree_takes_its_data_from_another_file(run: Run) -> None:
    words = ("dynamic.dft", "rates.xml", "--hours", "10", "--uncertainty", "400")
    entry = solved(run, *words)
    assert entry["uncertainty"].keys() == KEYS and entry["uncertainty"]["variables"] == ["r"]
    assert entry["source"] == "dynamic.dft, rates.xml" and entry["probability"] < entry["uncertainty"]["mean"] * 2
    (event,) = [one for one in entry["structure"]["basic_events"] if one["name"] == "A"]
    assert event["source"] == "A" and event["rate_per_hour"] == "1/1000"
    said = run("tree", *words).out
    assert "uncertainty: 400 samples (Monte Carlo, seed 1) of 1 random variable" in said and "[A]" in said
    assert solved(run, "rates.xml", "dynamic.dft", *words[2:])["uncertainty"] == entry["uncertainty"]


def test_a_static_galileo_tree_takes_them_too(run: Run) -> None:
    words = ("static.dft", "rates.xml", "--hours", "10", "--uncertainty", "400")
    entry = solved(run, *words)
    assert entry["uncertainty"].keys() == KEYS | {"importance"} and entry["probability"] == pytest.approx(
        0.108955, 1e-4
    )


@pytest.mark.parametrize(
    ("words", "section", "why"),
    [
        (["certain.xml"], "event_trees", "the study holds no distribution"),
        (["after.xml", "--correlation", "cor.json"], "event_trees", 'names "r", which is no random variable'),
        (["after.xml", "--lhs", "--uncertainty", "33"], "event_trees", "33 samples cannot be shared out"),
        (["dynamic.dft", "--hours", "10"], "trees", "Galileo text holds plain numbers only; give the distributions"),
        (["dynamic.dft", "rates.xml"], "trees", "--hours H"),
    ],
)
def test_what_fails_is_said_and_the_rest_is_kept(run: Run, words: list[str], section: str, why: str) -> None:
    words = words if "--uncertainty" in words else [*words, "--uncertainty", "20"]
    entry = solved(run, *words, code=2, section=section)
    assert why in entry["errors"][0] and entry["errors"][0].startswith("--uncertainty: ")
    assert "uncertainty" not in entry and (entry.get("sequences") or entry["dynamic"])


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["dynamic.dft", "wrong.xml"], 'wrong.xml: the data are of "Z", which is no basic event of the tree "T"'),
        (
            ["dynamic.dft", "tree.xml"],
            "tree.xml: beside a Galileo tree only the data of its basic events are read, but there are gates",
        ),
        (["dynamic.dft", "group.xml"], "but there are ccf groups"),
        (["dynamic.dft", "none.xml"], "none.xml: no basic event is defined"),
        (["dynamic.dft", "static.dft"], "several files, and not all of them MEF"),
        (["after.xml", "--lhs"], "are of --uncertainty N; add it"),
        (["after.xml", "--uncertainty", "1"], "give a whole number, 2 or more"),
        (["dynamic.dft", "rates.xml", "--sensitivity"], "holds a dynamic tree"),
        (["dynamic.dft", "--hours", "1e400"], "mission_time_h is about 1e400 h, expected 0 to 1e+150"),
    ],
)
def test_bad_input(run: Run, words: list[str], why: str) -> None:
    called = run("tree", *words)
    assert called.code == 2 and why in called.err and "Traceback" not in called.err


def test_the_report_shows_event_trees(run: Run, project: Path) -> None:
    assert run("tree", "after.xml", "--uncertainty", "200", "--json", "out.json").code == 0
    document: dict[str, Any] = validate(json.loads((project / "out.json").read_text()))
    page = html(document)
    for words in (
        "Event trees",
        "Uncertainty of the frequency",
        "spill",
        "200 samples of its uncertain inputs",
        '<svg class="et"',
    ):
        assert words in page
    for row in document["event_trees"][0]["sequences"]:
        row["assumed"] = False
    assert "figures of the sequences safe, spill" in page and "figures of the sequences" not in html(document)
    document["event_trees"][0]["wrong"] = ["two of its paths can be taken at once"]
    assert "1 of 1 results is not as asked" in html(document)


ASSUMED = """<define-initiating-event name="fire" event-tree="after"><parameter name="guess"/></define-initiating-event>
<model-data><define-parameter name="guess"><attributes><attribute name="source" value="A"/></attributes>
<normal-deviate><float value="0.1"/><float value="0.2"/></normal-deviate></define-parameter></model-data>"""


def test_what_is_assumed_of_one_initiating_event_is_told_of_all_together(run: Run, project: Path) -> None:
    certain = UNSURE.replace('value="A"', 'value="R"')
    put(project, "two.xml", certain.replace("<opsa-mef>", "<opsa-mef>" + ASSUMED))
    said = run("tree", "two.xml", "--uncertainty", "200", "--json", "two.json", "--svg", "two.svg").out
    document: dict[str, Any] = validate(json.loads((project / "two.json").read_text()))
    fire, leak = document["event_trees"]
    assert fire["id"] == "fire" and fire["assumed"] and not leak["assumed"]
    for one in (*fire["sequences"], *leak["sequences"]):
        assert one["assumed_over_all"] and one["assumed"] is (one in fire["sequences"])
    page = html(document)
    told = [re.sub("<[^>]*>", " ", row) for row in page.split("<tr>")]
    safe = [row.split() for row in told if row.split()[:2] == ["safe", "stop"]]
    assert [row.count("[A]") for row in safe] == [3, 1]
    facts = [re.sub("<[^>]*>", "", fact).strip() for fact in re.findall("<dt>frequency</dt><dd>(.*?)</dd>", page)]
    assert facts == ["0.1 [A]", "0.5"]
    assert re.search(r"Out of range: \d+ samples of frequency of fire", page)
    assert "of 2 random variables, seed 1" in page
    assert "Uncertainty of the frequency over all initiating events" in page and "basic events a" in page
    assert "0.1 [A]<" in (project / "two.svg").read_text()
    together = said[said.index("over all initiating events") :]
    assert all("[A]" in line for line in together.splitlines() if line.startswith(("safe", "spill")))


def test_a_document_without_what_the_report_needs_is_refused(run: Run, project: Path) -> None:
    assert run("tree", "after.xml", "--json", "out.json").code == 0
    document = json.loads((project / "out.json").read_text())
    del document["event_trees"][0]["sequences"][0]["assumed"]
    put(project, "out.json", json.dumps(document))
    called = run("report", "--from", "out.json", "--to", "out")
    assert called.code == 2 and "assumed" in called.err and "Traceback" not in called.err


def test_an_export_that_loses_distributions_says_so(run: Run, project: Path) -> None:
    called = run("tree", "dynamic.dft", "rates.xml", "--export", "out.dft")
    assert "out.dft: this format holds no distributions, their means are written" in called.err
    assert '"A" lambda=1e-3' in (project / "out.dft").read_text()
    assert run("tree", "dynamic.dft", "--export", "again.dft").err == ""


def test_a_dynamic_tree_has_a_curve(run: Run) -> None:
    entry = solved(run, "dynamic.dft", "--hours", "10", "--curve", "4")
    curve = entry["curve"]
    assert curve["times_h"] == [0, 2.5, 5, 7.5, 10] and curve["unavailability"][-1] == pytest.approx(
        entry["probability"]
    )
    at_5 = solved(run, "dynamic.dft", "--hours", "5")["probability"]
    assert curve["unavailability"][2] == pytest.approx(at_5) and curve["unavailability"][0] == 0
    said = run("tree", "dynamic.dft", "--hours", "10", "--curve", "4").out
    assert "no frequency: it is not computed for dynamic trees" in said and "7.5" in said
    assert "give it by --hours H" in run("tree", "dynamic.dft", "--curve", "4").err


def test_the_picture_of_an_event_tree(run: Run, project: Path) -> None:
    called = run("tree", "after.xml", "--svg", "after.svg")
    assert called.code == 0 and "picture of after: after.svg" in called.err
    picture = (project / "after.svg").read_text()
    assert all(f">{words}<" in picture for words in ("leak", "stop", "works", "fails", "safe", "spill"))

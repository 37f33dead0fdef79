"""`rightside tree FILE`: every option does something, nothing is left out silently, what was computed is kept."""

import json
from pathlib import Path
from typing import Any

import pytest

from safety.commands import main
from safety.commands.tree import EXAMPLES, OF_FILES
from safety.trees import read, write
from tests.commands.conftest import Run, document, put

PUMPS: dict[str, Any] = {
    "format": "rightside/fault-tree/1", "name": "pumps", "top": "top",
    "gates": [
        {"name": "top", "kind": "or", "inputs": ["both", "c"]}, {"name": "both", "kind": "and", "inputs": ["a", "b"]}
    ],
    "basic_events": [
        {"name": "a", "rate_per_hour": "1e-3", "source": "A"}, {"name": "b", "rate_per_hour": "2e-3", "source": "P"},
        {"name": "c", "probability": "1e-4", "source": "P"},
    ],
}  # fmt: skip
UNKNOWN = PUMPS | {"basic_events": [{"name": name} for name in "abc"]}
WIDE = {
    "format": "rightside/fault-tree/1", "name": "wide", "top": "top",
    "gates": [{"name": "top", "kind": "vote", "k": 8, "inputs": [f"e{n}" for n in range(16)]}],
    "basic_events": [{"name": f"e{n}", "probability": f"1/{n + 2}"} for n in range(16)],
}  # fmt: skip
WITH_NOT = PUMPS | {"gates": [*PUMPS["gates"][:1], {"name": "both", "kind": "not", "inputs": ["a"]}]}
LOGNORMAL = """<opsa-mef><define-fault-tree name="pumps"><define-gate name="top"><or><event name="a"/><event name="b"/>
</or></define-gate></define-fault-tree><model-data><define-parameter name="q"><attributes><attribute name="source"
 value="A"/></attributes><lognormal-deviate><float value="0.2"/><float value="8"/><float value="0.95"/>
</lognormal-deviate></define-parameter><define-basic-event name="a"><parameter name="q"/></define-basic-event>
<define-basic-event name="b"><normal-deviate><float value="0.01"/><float value="0.02"/></normal-deviate>
</define-basic-event></model-data></opsa-mef>"""
EVENT_TREE = """<opsa-mef><define-initiating-event name="leak" event-tree="after"/><define-event-tree name="after">
<define-functional-event name="stop"/><define-sequence name="safe"/><define-sequence name="spill"/><initial-state>
<fork functional-event="stop"><path state="works"><collect-formula><not><gate name="g1"/></not></collect-formula>
<sequence name="safe"/></path><path state="fails"><collect-formula><gate name="g1"/></collect-formula>
<sequence name="spill"/></path></fork></initial-state></define-event-tree><define-fault-tree name="t">
<define-gate name="g1"><or><event name="a"/><event name="b"/></or></define-gate></define-fault-tree><model-data>
<define-basic-event name="a"><attributes><attribute name="source" value="A"/></attributes><float value="0.1"/>
</define-basic-event><define-basic-event name="b"><float value="0.2"/></define-basic-event></model-data></opsa-mef>"""
PHASES = """<define-alignment name="al"><define-phase name="run" time-fraction="0.75"/>
<define-phase name="stop" time-fraction="0.25"/></define-alignment></opsa-mef>"""
DYNAMIC = "toplevel T; T or A P; P pand B C; A lambda=1e-3; B lambda=1; C lambda=1;"
STATIC = 'toplevel "T"; "T" or "A" "B"; "A" lambda=1e-3; "B" prob=0.1;'
EVERYTHING = ("--gates", "--joint", "--sensitivity", "--curve", "2", "--sil", "--target", "c=0.5")


@pytest.fixture(autouse=True)
def files(project: Path) -> Path:
    phased = EVENT_TREE.partition("<define-initiating")[0] + EVENT_TREE[EVENT_TREE.index("<define-fault-tree") :]
    texts = {
        "pumps.json": json.dumps(PUMPS), "unknown.json": json.dumps(UNKNOWN), "not.json": json.dumps(WITH_NOT),
        "wide.json": json.dumps(WIDE),
        "lognormal.xml": LOGNORMAL, "after.xml": EVENT_TREE, "dynamic.dft": DYNAMIC, "static.dft": STATIC,
        "phases.xml": phased.replace("</opsa-mef>", PHASES),
        "cor.json": '{"rank_correlations": [["q", "b", 0.5]]}',
    }  # fmt: skip
    for name, text in texts.items():
        put(project, name, text)
    return project


def solved(run: Run, *words: str, code: int = 0, section: str = "trees") -> dict[str, Any]:
    called = run("tree", *words, "--json", "-")
    assert called.code == code, called.err
    entry: dict[str, Any] = json.loads(called.out)[section][0]
    return entry


@pytest.mark.parametrize("line", [line.partition("  ")[0] for line in EXAMPLES.strip().splitlines()])
def test_the_examples_of_the_help_work_as_printed(run: Run, whole: Path, line: str) -> None:
    trees, data = LOGNORMAL.split("<model-data>")
    rated = read(whole / "pumps.json", mission_time_h=8760)
    write(rated, whole / "permit.json")
    write(rated, whole / "permit.xml")
    if "rates.xml" in line or "--hours" not in line:
        put(whole, "permit.xml", trees + "</opsa-mef>" if "rates.xml" in line else LOGNORMAL)
    put(whole, "rates.xml", "<opsa-mef><model-data>" + data)
    put(whole, "permit.dft", STATIC)
    put(whole, "plant.dft", DYNAMIC)
    put(
        whole,
        "data.xml",
        "<opsa-mef><model-data>" + data.replace('name="b"', 'name="A"').replace('name="a"', 'name="B"'),
    )
    hazard = whole / "proofs/counter_hazard.py"
    hazard.write_text(hazard.read_text().replace("no_alarm", "no_brake"))
    called = run(*line.split()[1:])
    assert called.code == 0, called.err
    for option in ("--svg", "--certificate", "--export"):
        if option in line:
            assert (whole / line.split(option)[1].split()[0]).stat().st_size > 100


OPTIONS: dict[str, list[str]] = {
    "top": ["pumps.json", "--hours", "10", "--top", "both"], "hours": ["pumps.json", "--hours", "20"],
    "export": ["pumps.json", "--export", "new.xml"], "certificate": ["pumps.json", "--certificate", "new.xml"],
    "likeliest": ["pumps.json", "--likeliest"], "exact": ["wide.json", "--exact"], "gates": ["pumps.json", "--gates"],
    "joint": ["pumps.json", "--joint"], "prime_implicants": ["not.json", "--prime-implicants", "2"],
    "uncertainty": ["lognormal.xml", "--uncertainty", "50"], "lhs": ["lognormal.xml", "--uncertainty", "50", "--lhs"],
    "seed": ["lognormal.xml", "--uncertainty", "50", "--seed", "7"],
    "correlation": ["lognormal.xml", "--uncertainty", "50", "--correlation", "cor.json"],
    "sensitivity": ["pumps.json", "--sensitivity"], "target": ["pumps.json", "--target", "c=0.5"],
    "curve": ["pumps.json", "--curve", "2"], "sil": ["pumps.json", "--sil"],
    "ties": ["dynamic.dft", "--ties", "as written"],
}  # fmt: skip


def test_there_is_a_case_for_every_option_of_tree_files() -> None:
    assert OPTIONS.keys() == OF_FILES.keys() - {"order", "above"}


@pytest.mark.parametrize("option", OPTIONS)
def test_every_option_does_something(run: Run, project: Path, option: str) -> None:
    file, *words = OPTIONS[option]
    at = words.index("--" + option.replace("_", "-"))
    takes = 1 + (len(words) > at + 1 and not words[at + 1].startswith("--"))
    hours = [] if "--hours" in words else ["--hours", "10"]
    plain = run("tree", file, *(words[:at] + words[at + takes :]), *([] if option == "hours" else hours), "--json", "-")
    asked = run("tree", file, *words, *hours, "--json", "-")
    assert asked.code == 0, asked.err
    if option in ("export", "certificate"):
        assert (project / "new.xml").stat().st_size > 100
    elif option == "hours":
        assert plain.code == 2 and "--hours" in plain.err
    else:
        entries = [json.loads(called.out)["trees"][0] for called in (plain, asked)]
        for entry in entries:
            del entry["seconds"]
        assert entries[0] != entries[1]


def test_what_rests_on_an_assumed_event_is_marked_in_the_text(run: Run) -> None:
    called = run("tree", "pumps.json", "--hours", "100", *EVERYTHING)
    assert called.code == 0, called.err
    text = called.out
    for words in ("both ", "a & b ", "c  ", "50 ", "PFDavg", "PFH", "mean time to failure", "the top has probability"):
        lines = [line for line in text.splitlines() if line.startswith(words)]
        assert lines and all("[A]" in line for line in lines[-1:]), (words, lines)
    put_back = json.dumps(PUMPS).replace('"source": "A"', '"source": "P"')
    Path("pumps.json").write_text(put_back)
    assert "[A]" not in run("tree", "pumps.json", "--hours", "100", *EVERYTHING).out


def test_a_parameter_marked_assumed_makes_its_events_assumed(run: Run) -> None:
    called = run("tree", "lognormal.xml", "--uncertainty", "50")
    rows = {line.split()[0]: line for line in called.out.splitlines() if line}
    assert rows["a"].endswith("[A]") and not rows["b"].endswith("[A]")
    assert "[A]" in rows["probability"] and "[A]" in rows["mean"] and "[A]" in rows["0.5"]
    assert solved(run, "lognormal.xml")["importance"][0]["source"] == "A"


def test_samples_set_to_the_range_are_said(run: Run) -> None:
    words = ("lognormal.xml", "--uncertainty", "500")
    times = solved(run, *words)["uncertainty"]["set_to_range"]["b"]
    assert times > 50  # a normal of mean 0.01 and deviation 0.02 is below 0 in about 3 of 10
    assert f"b: {times} samples out of range, set to the nearer end of the range" in run("tree", *words).out


def test_sequences_that_rest_on_an_assumed_event_are_marked(run: Run) -> None:
    entry = solved(run, "after.xml", section="event_trees")
    assert [row["assumed"] for row in entry["sequences"]] == [True, True]
    assert {row["event"]: row["source"] for row in entry["sequences"][0]["importance"]} == {"a": "A", "b": ""}
    text = run("tree", "after.xml").out
    assert "0.28 [A]" in text and "0.72 [A]" in text and "sum over the sequences 1 [A]" in text
    unmarked = Path("after.xml").read_text().replace('value="A"', 'value="P"')
    Path("after.xml").write_text(unmarked)
    assert "[A]" not in run("tree", "after.xml").out


FREQUENCY = (
    """<define-initiating-event name="leak" event-tree="after"><parameter name="often"/></define-initiating-event>"""
)
OFTEN = """<define-parameter name="often"><attributes><attribute name="source" value="A"/></attributes>
<float value="0.5"/></define-parameter></model-data>"""


def test_an_assumed_frequency_marks_the_sequences_in_every_format(run: Run, project: Path) -> None:
    text = EVENT_TREE.replace('value="A"', 'value="P"').replace("</model-data>", OFTEN)
    text = text.replace('<define-initiating-event name="leak" event-tree="after"/>', FREQUENCY)
    put(project, "often.xml", text)
    assert run("tree", "often.xml", "--export", "often2.xml", "--export", "often.json").code == 0
    for name in ("often.xml", "often2.xml", "often.json"):
        assert "0.36 [A]" in run("tree", name).out
    put(project, "often.xml", text.replace('value="A"', 'value="P"'))
    assert "[A]" not in run("tree", "often.xml").out


def test_an_assumed_common_cause_factor_marks_the_tree(run: Run, project: Path) -> None:
    group = """<define-CCF-group name="g" model="beta-factor"><members><basic-event name="a"/><basic-event name="b"/>
    </members><distribution><float value="0.1"/></distribution><factor level="2"><parameter name="often"/></factor>
    </define-CCF-group></define-fault-tree>"""
    tree = EVENT_TREE[EVENT_TREE.index("<define-fault-tree") :].partition("<define-basic-event")[0]
    text = "<opsa-mef>" + tree.replace("</define-fault-tree>", group) + OFTEN + "</opsa-mef>"
    put(project, "group.xml", text)
    called = run("tree", "group.xml")
    assert called.code == 0, called.err
    assert "[A], enclosed" in called.out
    put(project, "group.xml", text.replace('value="A"', 'value="P"'))
    assert "[A]" not in run("tree", "group.xml").out


def test_phases_are_marked_too(run: Run) -> None:
    text = run("tree", "phases.xml").out
    assert "mean over the phases 0.28 [A]" in text


def test_exports_say_or_show_what_is_assumed(run: Run, project: Path) -> None:
    put(project, "plain.json", json.dumps(PUMPS).replace("_per_hour", "_or").replace("rate_or", "probability"))
    called = run("tree", "plain.json", "--export", "a.dft", "--export", "a.dag", "--export", "a.dot")
    assert called.code == 0, called.err
    for name in ("a.dft", "a.dag"):
        assert f"{name}: this format cannot hold the mark [A] of 1 event" in called.err
    assert "a.dot" not in called.err
    labels = [line for line in (project / "a.dot").read_text().splitlines() if "[A]" in line]
    assert len(labels) == 1 and labels[0].lstrip().startswith('"a" ')


def test_a_failing_extra_keeps_what_was_computed(run: Run, project: Path) -> None:
    words = (
        "lognormal.xml",
        "--target",
        "none=0.5",
        "--target",
        "b=0.5",
        "--export",
        "new.dft",
        "--export",
        "new.json",
    )
    entry = solved(run, *words, "--gates", code=2)
    assert entry["probability"] > 0 and entry["gate_importance"] and len(entry["targets"]) == 1
    dft, target = entry["errors"]
    assert dft.startswith("--export new.dft: ") and "an expression as its probability" in dft
    assert target.startswith('--target: "none" is neither')
    assert (project / "new.json").exists() and not (project / "new.dft").exists()
    called = run("tree", *words)
    assert called.code == 2 and "probability" in called.out and dft in called.err and target in called.err
    assert run("tree", *words, "--json", "kept.json").code == 2
    assert document(project / "kept.json")["trees"][0]["errors"] == entry["errors"]


@pytest.mark.parametrize("words", [["--timeout", "3"], ["-j", "2"], ["-x"]])
def test_options_of_hazards_are_refused_with_a_file(run: Run, words: list[str]) -> None:
    called = run("tree", "pumps.json", "--hours", "1", *words)
    assert (called.code, called.out) == (2, "") and f"{words[0]} is of the project's hazards" in called.err


@pytest.mark.parametrize("option", ["--export", "--json", "--svg", "--certificate"])
def test_inputs_are_not_written_over(run: Run, project: Path, option: str) -> None:
    before = (project / "pumps.json").read_bytes()
    (project / "link.json").symlink_to("pumps.json")
    for name in ("pumps.json", "./pumps.json", "link.json"):
        called = run("tree", "pumps.json", "--hours", "10", option, name)
        assert called.code == 2 and "give this result a file of its own" in called.err
    assert (project / "pumps.json").read_bytes() == before
    assert run("tree", "pumps.json", "--hours", "10", option, "one.json").code == 0
    twice = run("tree", "pumps.json", "--hours", "10", "--export", "two.xml", option, "two.xml")
    assert twice.code == 2


def test_cut_sets_with_not_are_called_what_they_are(run: Run) -> None:
    words = "cut sets: positive parts of the prime implicants (the tree has not or xor)"
    called = run("tree", "not.json", "--hours", "10")
    assert called.code == 0 and words in called.out and "(no fault needed)" in called.out
    assert words not in run("tree", "pumps.json", "--hours", "10").out


@pytest.mark.parametrize("option", ["--sensitivity", "--likeliest", "--gates", "--joint"])
def test_missing_probabilities_are_named(run: Run, option: str) -> None:
    called = run("tree", "unknown.json", option)
    assert called.code == 2 and "2 minimal cut sets" in called.out
    assert f'{option}: needs the probability of every basic event; "a" has none, nor have 2 more' in called.err


def test_a_gate_of_a_file_with_event_trees_is_solved(run: Run) -> None:
    assert solved(run, "after.xml", "--top", "g1")["probability"] == pytest.approx(0.28)


def test_files_that_hold_no_one_tree_are_told_in_the_words_of_the_command(run: Run, project: Path) -> None:
    bare = EVENT_TREE.replace('<define-initiating-event name="leak" event-tree="after"/>', "")
    put(project, "bare.xml", bare)
    put(project, "phases_only.xml", "<opsa-mef>" + PHASES)
    for name, said in (("bare.xml", "give --top GATE"), ("phases_only.xml", "no gate is defined")):
        called = run("tree", name)
        assert called.code == 2 and said in called.err and name in called.err and "read_study" not in called.err


@pytest.mark.parametrize(("name", "said"), [("phases.xml", "one for each phase")])
def test_pictures_of_several_trees_are_refused_before_solving(
    run: Run, monkeypatch: pytest.MonkeyPatch, name: str, said: str
) -> None:
    monkeypatch.setattr("safety.commands.tree_files.solve", lambda tree: pytest.fail("solved"))
    monkeypatch.setattr("safety.trees.event_trees.answers.solve", lambda tree: pytest.fail("solved"))
    called = run("tree", name, "--svg", "a.svg")
    assert called.code == 2 and said in called.err and not Path("a.svg").exists()


def test_a_dynamic_tree_is_drawn_and_exported(run: Run, project: Path) -> None:
    called = run("tree", "dynamic.dft", "--hours", "10", "--svg", "a.svg", "--export", "b.dft")
    assert called.code == 0, called.err
    assert "<svg" in (project / "a.svg").read_text()
    both = [solved(run, name, "--hours", "10")["probability"] for name in ("dynamic.dft", "b.dft")]
    assert both[0] == both[1]
    called = run("tree", "dynamic.dft", "--hours", "10", "--export", "b.xml")
    assert called.code == 2 and "only .dft can hold" in called.err


@pytest.mark.parametrize("ending", ["xml", "json"])
def test_event_trees_are_exported_whole(run: Run, ending: str) -> None:
    assert run("tree", "after.xml", "--export", f"new.{ending}").code == 0
    entries = [solved(run, name, section="event_trees") for name in ("after.xml", f"new.{ending}")]
    assert [[row["probability"] for row in entry["sequences"]] for entry in entries] == 2 * [[0.72, 0.28]]
    called = run("tree", "after.xml", "--export", "new.dft")
    assert called.code == 2 and "a study cannot be written as .dft" in called.err and "0.28" in called.out


def test_mission_times_that_galileo_cannot_hold_are_not_lost(run: Run, project: Path) -> None:
    timed = json.dumps(PUMPS).replace('"rate_per_hour": "2e-3"', '"rate_per_hour": "2e-3", "mission_time_h": 5')
    put(project, "timed.json", timed)
    called = run("tree", "timed.json", "--hours", "10", "--export", "new.dft")
    assert called.code == 2 and "rates with different mission times" in called.err
    assert run("tree", "pumps.json", "--hours", "10", "--export", "new.dft").code == 0


def test_missing_hours_are_asked_for_by_name(run: Run) -> None:
    called = run("tree", "static.dft", "--sil")
    assert called.code == 2 and "--hours" in called.err


def test_a_stale_kernel_is_no_fault_to_report(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from safety.trees.kernel import StaleKernel

    def stale(*_: object) -> None:
        raise StaleKernel("compile it anew with `python hatch_build.py`")

    monkeypatch.setattr("safety.commands.tree.run", stale)
    assert main(["tree", "x.json"]) == 70
    said = capsys.readouterr().err
    assert said == "rightside tree: compile it anew with `python hatch_build.py`\n"


def test_a_changed_name_in_a_certificate_is_rejected(run: Run, project: Path) -> None:
    run("tree", "pumps.json", "--hours", "10", "--certificate", "c.json")
    called = run("check", "c.json")
    assert called.code == 0 and "pumps: fault tree, 2 minimal cut sets" in called.err
    (project / "c.json").write_text((project / "c.json").read_text().replace('"pumps"', '"brakes"'))
    called = run("check", "c.json")
    assert called.code == 1 and "the sha256 of tree is not that of its content" in called.err


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no device that is always full")
def test_what_was_found_is_shown_even_where_the_disk_is_full(run: Run) -> None:
    called = run("tree", "pumps.json", "--hours", "10", "--json", "/dev/full")
    assert called.code == 2
    assert "probability 2.97007 × 10⁻⁴" in called.out and "/dev/full: No space left on device" in called.err


def test_the_exact_probability_is_shown_or_its_absence_is_told(run: Run) -> None:
    whole_text = run("tree", "wide.json", "--exact").out
    exact = solved(run, "wide.json", "--exact")["exact"]
    assert (
        f", exactly {exact}" if len(exact) <= 60 else f"; exactly in --json ({len(exact)} characters)"
    ) in whole_text
    called = run("tree", "pumps.json", "--hours", "10", "--exact")
    assert called.code == 4 and "no exact probability is given: an event has no rational one" in called.out
    assert "exactly" not in run("tree", "pumps.json", "--hours", "10").out

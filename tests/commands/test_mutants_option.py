"""`prove --mutants` on a small project: every mutant is in the document, what is left is shown with its line."""

import json
from pathlib import Path

import pytest

from safety.commands import mutants
from safety.commands.screen import Screen
from safety.prove.cache import Cache
from safety.report.standing import WEAKER
from tests.commands.conftest import Run, put

TIGHT = '''
    """Pulse counter, said exactly."""
    from models.counter import Counter
    from safety import PROVED, Bit, Scenario, Seen, claim, previous, select

    @claim(Counter, expect=PROVED, symbolic=["limit"], witness=Scenario(20, {"pulse": True}))
    def counts_exactly(s: Seen) -> Bit:
        """It counts each pulse below 15, from 0, and the alarm is there just from the limit on."""
        before, pulse = previous(s.n, 0), previous(s.pulse, False)
        return (s.n == select(pulse & (before < 15), (before + 1).sat(4), before)) & (s.alarm == (s.limit <= s.n))

    @claim(Counter, expect=PROVED)
    def no_alarm_before_eight(s: Seen) -> Bit:
        """As delivered the limit is 8."""
        return s.alarm == (s.n >= 8)
'''


def document(path: Path) -> dict:
    return json.loads(path.read_text(encoding="utf-8"))


def test_what_no_claim_notices_is_shown_with_its_line(run: Run, project: Path) -> None:
    called = run("prove", "--mutants", "-j", "1", "--json", "out.json")
    assert called.code == 4, called.err  # the one claim says nothing of fewer than twelve pulses
    found = document(project / "out.json")
    (model,) = found["models"]
    assert (found["schema"], found["interrupted"], model["id"]) == (mutants.SCHEMA, False, "Counter")
    assert model["mutants"] == len(found["mutants"]) == sum(model["verdicts"].values())
    assert model["verdicts"]["slack"] > 0
    assert model["without_result"] == model["elsewhere"] == 0
    slack = next(each for each in found["mutants"] if each["verdict"] == "slack")
    text = (project / slack["file"]).read_text(encoding="utf-8").splitlines()[slack["line"] - 1]
    assert slack["file"] == "models/counter.py"
    assert f"slack  models/counter.py:{slack['line']}" in called.err
    assert "self." in text or "seen" in text


def test_claims_that_say_all_leave_nothing(run: Run, project: Path) -> None:
    put(project, "proofs/counter.py", TIGHT)
    called = run("prove", "--mutants", "-j", "1", "--json", "out.json")
    found = document(project / "out.json")
    left = [each for each in found["mutants"] if each["verdict"] in mutants.LEFT]
    assert (called.code, left) == (0, []), called.err


def test_a_piece_that_was_examined_is_not_examined_again(run: Run, project: Path) -> None:
    """Seen by a mark in what was kept; another claim, or --no-cache, and it is worked out anew."""

    def marked(*more: str) -> bool:
        called = run("prove", "--mutants", "-j", "1", "--json", "out.json", *more)
        assert called.code == 0, called.err
        return any(each["how"] == "the mark" for each in document(project / "out.json")["mutants"])

    put(project, "proofs/counter.py", TIGHT)
    assert not marked()
    kept = Cache(project / ".rightside" / "cache", print)
    records = {path.stem: kept.get(path.stem) for path in kept.folder.glob("*.json")}
    ((key, piece),) = [(key, record) for key, record in records.items() if isinstance(record, list)]
    kept.put(key, [{**each, "how": "the mark"} for each in piece])
    assert marked()
    assert not marked("--no-cache")
    put(project, "proofs/counter.py", TIGHT.replace("s.n >= 8", "s.n > 7"))
    assert not marked()


def test_a_kill_is_run_again_when_other_claims_are_there(run: Run, project: Path) -> None:
    """With another claim all is examined, beginning with the runs that are kept, seen by a pause put before them."""

    def killed() -> dict[int, str]:
        run("prove", "--mutants", "-j", "1", "--json", "out.json")
        found = document(project / "out.json")["mutants"]
        return {each["number"]: each["how"] for each in found if each["verdict"] == "counterexample"}

    put(project, "proofs/counter.py", TIGHT)
    before = killed()
    kept = Cache(project / ".rightside" / "cache", print)
    for path in kept.folder.glob("*.json"):
        record = kept.get(path.stem)
        if isinstance(record, dict) and record["given"]:
            given = record["given"] | {"inputs": {"pulse": [[False, 1], *record["given"]["inputs"]["pulse"]]}}
            kept.put(path.stem, record | {"steps": record["steps"] + 1, "given": given})
    put(project, "proofs/counter.py", TIGHT.replace("s.n >= 8", "s.n > 7"))
    after = killed()
    assert before.keys() == after.keys()
    later = {number for number in before if after[number] != before[number]}
    assert len(later) > len(before) / 4  # others break the claim at once, and not in the pause


def test_settings_are_refused_and_nothing_selected_is_said(run: Run, project: Path) -> None:
    assert run("prove", "--mutants", "--set", "limit=5").code == 2
    called = run("prove", "--mutants", "-k", "with_a_fault")
    assert called.code == 5
    assert "nothing selected" in called.err


def entry(model: str, verdict: str, change: str = "- for +", file: str | None = "m.py", written: str = "") -> dict:
    return {"model": model, "file": file, "line": 3, "change": change, "verdict": verdict, "written": written}


def test_what_one_model_leaves_open_may_be_noticed_on_another() -> None:
    found = [entry("Small", "slack"), entry("Great", "twin"), entry("Small", "slack", "& for |")]
    mutants._notice(found)
    assert [each["noticed_on"] for each in found] == ["Great", None, None]
    found = [entry("Small", "slack"), entry("Great", "twin"), entry("Great", "slack")]
    mutants._notice(found)
    assert [each["noticed_on"] for each in found] == [None, None, None]
    found = [entry("Small", "slack"), entry("Great", "equivalent")]  # which does not say that a claim would notice
    mutants._notice(found)
    assert [each["noticed_on"] for each in found] == [None, None]


def test_only_a_change_that_is_killed_throughout_is_not_made_again() -> None:
    def again(*found: dict) -> bool:
        return mutants.noticed_on(entry("Great", "", written="x + 1"), mutants.killed_on(found)) is None

    assert not again(entry("Small", "counterexample"), entry("Small", "twin"))
    assert again(entry("Small", "counterexample"), entry("Small", "proof lost"))
    assert again(entry("Small", "counterexample"), entry("Small", "equivalent"))
    assert again(entry("Small", "counterexample"), entry("Small", "slack"))
    assert again(entry("Small", "counterexample"), entry("Small", "unclaimed"))
    assert again(entry("Small", "counterexample"), entry("Small", "twin") | {"verdict": None})  # no result
    assert again(entry("Small", "counterexample", "& for |"))
    assert again(entry("Small", mutants.ELSEWHERE))
    assert again()
    one, other = entry("Small", "twin", written="x + 1"), entry("Small", "equivalent", written="x + 0")
    assert not again(one, other)
    assert again(one, other, entry("Small", "slack", written="x + 1"))
    assert again(entry("Small", "equivalent", written="x + 1"), entry("Small", "twin", written="x + 0"))
    assert mutants.killed_on([entry("Small", "twin", file=None)]) == {}


def test_a_variant_comes_after_the_model_that_it_is_made_from() -> None:
    """What both share is then examined on the model of which more is claimed."""

    class Bench: ...

    class Variant(Bench): ...

    class Small: ...

    class Great: ...

    sizes = {Great: 100, Variant: 48, Bench: 50, Small: 49}
    assert sorted(sizes, key=lambda model: mutants._order(model, sizes)) == [Small, Bench, Variant, Great]


def test_a_lost_proof_is_no_kill(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    work = mutants._Work([], tmp_path, Screen(False))
    work.summaries = [{"id": "Small", "claims": 1, "mutants": 2}]
    rest = {"number": 1, "was": "x", "how": ""}
    work.entries = [entry("Small", "twin", "& for |") | rest, entry("Small", mutants.PROOF_LOST) | rest]
    assert work.end(str(tmp_path / "out.json"), 0.0) == WEAKER
    totals = document(tmp_path / "out.json")["totals"]
    assert (totals["mutants"], totals["killed"], totals["proof_lost"]) == (2, 1, 1)
    shown = capsys.readouterr().err
    assert "it is not shown whether a claim would notice" in shown
    assert "proof lost  m.py:3" in shown


TWO = '''
    """Two counters at the same pulses."""
    from models.counter import Counter
    from safety import PROVED, Bit, Model, Seen, claim, implies

    class Pair(Model, tick_s="1/100"):
        left: Counter
        right: Counter

        def step(self, pulse: Bit) -> tuple["Pair", Bit]:
            left, a = self.left.step(pulse)
            right, b = self.right.step(pulse)
            return Pair(left=left, right=right), a.alarm & b.alarm

    @claim(Pair, expect=PROVED)
    def alike(s: Seen) -> Bit:
        """Where both have counted the same, both give the alarm or none does."""
        return implies(s.left.n == s.right.n, s["left.alarm.out"] == s["right.alarm.out"])
'''


def test_a_greater_model_says_where_a_change_is_killed(run: Run, project: Path) -> None:
    put(project, "proofs/counter.py", TIGHT)
    put(project, "proofs/pair.py", TWO)
    called = run("prove", "--mutants", "-j", "1", "--json", "out.json")
    found = document(project / "out.json")
    small, great = found["models"]
    assert (small["id"], great["id"], small["elsewhere"]) == ("Counter", "Pair", 0), called.err
    assert great["elsewhere"] == great["verdicts"]["elsewhere"] > 0
    assert great["mutants"] == sum(great["verdicts"].values())
    told = [each for each in found["mutants"] if each["verdict"] == "elsewhere"]
    assert {each["noticed_on"] for each in told} == {"Counter"}
    killed = {(e["line"], e["change"]) for e in found["mutants"] if e["verdict"] in ("counterexample", "twin")}
    assert {(each["line"], each["change"]) for each in told} <= killed

"""A baseline says of each injection whether it became worse, in lists of ranges or, where they are long, by fault."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from safety.faults import Fault, flip
from safety.inject import Campaign, CampaignError, Judged, Result, baseline, number_sets, stuck_bits
from safety.inject.baseline import Comparison, Findings, compare
from safety.inject.baseline_file import SCHEMA, dumps, loads, same_campaign
from safety.inject.classes import CELLS
from safety.inject.number_sets import BITS, from_text, to_text

Make = Callable[..., Findings]

FAULTS, TICKS = 4, 10
LABELS = ("window", "relay")
SAME = {"window": (0, 20, 21), "relay": (30,)}


@pytest.fixture
def upsets(timer: Any) -> Campaign:
    """Four faults at ten steps each: number 13 is fault 1 at its fourth step."""
    return Campaign(
        id="c", model=timer, faults=[Fault(flip(bit), ["count"], name=f"fault {bit}") for bit in range(FAULTS)],
        onsets=range(TICKS), length=1, stimulus={"run": True}, measured=TICKS, hazard="lit",
        detectors=dict.fromkeys(LABELS, "alarm"),
    )  # fmt: skip


@pytest.fixture
def findings(upsets: Campaign) -> Callable[..., Findings]:
    """What a run with these numbers in the sets finds; nothing is run."""

    def make(undetected: tuple[int, ...] = (1, 2, 13), **detected: tuple[int, ...]) -> Findings:
        judged = Judged.alike(FAULTS * TICKS, CELLS.index("neutral/no"))
        judged.cells[list(undetected)] = CELLS.index("wrong/no")
        for label, numbers in (detected or SAME).items():
            judged.cells[list(numbers)] = CELLS.index("wrong/yes")
            judged.detector[list(numbers)] = LABELS.index(label)
        return Findings.of(Result.of(upsets, judged))

    return make


def kept(found: Findings) -> Any:
    """The record, after it has been in a file."""
    return loads(dumps({"c": found.record()}), "b.json")["c"]


HOW = {"listed": (4000, 100_000), "by fault": (0, 3)}


@pytest.fixture(params=list(HOW))
def how(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """How a record keeps its sets."""
    for name, length in zip(("RANGES", "LONGEST"), HOW[request.param], strict=True):
        monkeypatch.setattr(number_sets, name, length)
    return str(request.param)


def test_the_same_run_differs_in_nothing(findings: Make, how: str) -> None:
    before = kept(findings())
    told = before["dangerous_undetected"]
    assert ("by fault" if told is None else "listed") == how
    assert list(before["by_fault"]) == (["dangerous_undetected", "detected"] if how == "by fault" else [])
    assert compare(before, findings()) == Comparison()


def test_a_new_dangerous_undetected_injection_is_named(findings: Make) -> None:
    found = compare(kept(findings()), findings((1, 2, 13, 21, 39), window=(0, 20), relay=(30,)))
    first, other = "fault 2, transient at 1 for 1", "fault 3, transient at 9 for 1"
    assert found.new == {first: "detected by window", other: "safe or without effect"}
    assert found.worse and not found.lost and not found.gone


def test_a_lost_detection_is_named_with_what_it_is_now(findings: Make) -> None:
    found = compare(kept(findings()), findings(window=(20, 21), relay=(30,)))
    assert (found.lost, found.new, found.worse) == ({"fault 0, transient at 0 for 1": "no_effect"}, {}, True)


def test_a_detection_by_another_is_told_and_is_no_loss(findings: Make) -> None:
    found = compare(kept(findings()), findings(window=(0, 20, 30), relay=(21,)))
    assert (found.moved, found.worse) == (2, False)


def test_what_became_better_is_told(findings: Make) -> None:
    found = compare(kept(findings()), findings((1, 2), window=(0, 13, 20, 21), relay=(30,)))
    same = ["fault 1, transient at 3 for 1"]
    assert (found.gone, found.gained, found.worse) == (same, same, False)


@pytest.mark.parametrize(
    "worse",
    [
        {"undetected": (1, 2, 13, 14)},
        {"undetected": (1, 2, 14)},  # as many of the same fault, but another one
        {"window": (0, 20), "relay": (30,)},
        {"window": (0, 20, 22), "relay": (30,)},
    ],
)
def test_nothing_worse_goes_unseen(findings: Make, how: str, worse: Any) -> None:
    found = compare(kept(findings()), findings(**worse))
    assert found.worse
    if how == "by fault":
        assert all(said.startswith(("fault 1: ", "fault 2: ", "fault 0: ")) for said in found.unclear)
        assert all(one.startswith(said.partition(":")[0]) for said, one in found.unclear.items())


def test_without_ranges_a_fault_that_is_clean_now_is_an_improvement(
    findings: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("RANGES", "LONGEST"):
        monkeypatch.setattr(number_sets, name, 3)
    found = compare(kept(findings()), findings((1, 2)))
    assert (found.gone, found.worse) == (["fault 1"], False)


def test_more_than_can_be_named_is_counted(findings: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(baseline, "NAMED", 2)
    found = compare(kept(findings()), findings((1, 2, 13, 14, 15, 16)))
    assert (len(found.new), found.left_out) == (2, 1)


@pytest.mark.parametrize("numbers", [(), (5,), (0, 1, 2), (0, 2, 3, 9), (7, 8), tuple(range(0, 9000, 2))])
def test_numbers_read_back(numbers: tuple[int, ...]) -> None:
    text = to_text(np.array(numbers, dtype=np.int64))
    assert text is not None and from_text(text, 9000).tolist() == list(numbers)
    assert text.startswith(BITS) == (len(numbers) > 1000)


def test_the_shorter_text_is_taken_and_a_long_one_left_out() -> None:
    assert to_text(np.arange(2_000_000)) == "0-1999999"
    scattered = to_text(np.arange(0, 200_000, 2))
    assert scattered is not None and scattered.startswith(BITS) and len(scattered) < 40_000
    assert (to_text(np.arange(0, 200_000_000, 20_000)) or BITS).startswith("0 20000 ")
    assert to_text(np.arange(0, 2_000_000, 2)) is None


def test_equal_runs_give_equal_files(findings: Make) -> None:
    one, other = ({"b": findings().record(), "a": findings().record()} for _ in range(2))
    assert dumps(one) == dumps(dict(reversed(other.items())))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "b.json:1: no JSON"),
        ('{\n "schema": }', "b.json:2: no JSON"),
        ("[]", 'no baseline: it has no "schema"'),
        (json.dumps({"schema": "rightside/1", "campaigns": {}}), "give a file of --write-baseline"),
        (json.dumps({"schema": SCHEMA}), '"campaigns" is no object'),
        (json.dumps({"schema": SCHEMA, "campaigns": {"c": 1}}), "campaign 'c': it is no object"),
    ],
)
def test_a_file_that_is_no_baseline_is_refused_with_its_place(text: str, said: str) -> None:
    with pytest.raises(CampaignError, match=said):
        loads(text, "b.json")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"model": 3}, r"b\.json:3: campaign 'c': 'model' is 3, expected a text"),
        ({"dangerous_undetected": "0-"}, "'dangerous_undetected' is no set of injections: '0-' is no range"),
        ({"dangerous_undetected": "5-2"}, "'5-2' stands out of order"),
        ({"dangerous_undetected": "5 5"}, "'5' stands out of order"),
        ({"dangerous_undetected": "0-40"}, "it goes to 40, but they are numbered 0 to 39"),
        ({"dangerous_undetected": "0-99999999999999"}, "numbered 0 to 39"),
        ({"dangerous_undetected": "bits:?"}, "no base64"),
        ({"dangerous_undetected": "bits:////////"}, "it goes to 47"),
        ({"dangerous_undetected": 3}, "'dangerous_undetected' is no set"),
        ({"detected_by": {"x": 7}}, "'x' is no set"),
        ({"dangerous_undetected": None}, "'by_fault' lacks 'dangerous_undetected'"),
        ({"detected_by": {"x": None}}, "'by_fault' lacks 'detected'"),
        ({"by_fault": {"detected": {"a": 1}}}, "not a number and a digest"),
    ],
)
def test_a_record_that_is_none_is_refused_with_its_place(findings: Make, changes: Any, said: str) -> None:
    text = dumps({"c": {**findings().record(), **changes}})
    with pytest.raises(CampaignError, match=said):
        loads(text, "b.json")


def test_a_baseline_of_another_campaign_is_refused_with_what_differs(findings: Make, upsets: Campaign) -> None:
    record = kept(findings())
    same_campaign(record, upsets, "b.json")
    for changes, said in (
        ({"model": "N"}, "its model was 'N', is 'Timer'"),
        ({"faults": "all 39"}, "its faults was 'all 39', is 'all 40 single faults at 10 onsets'"),
        ({"space": "0"}, "as before, but other ones, or others at other times"),
    ):
        with pytest.raises(CampaignError, match=said):
            same_campaign({**record, **changes}, upsets, "b.json")


def test_the_identity_of_a_campaign_is_its_model_and_space(campaign: Callable[..., Campaign]) -> None:
    same = {"expect": {"safe": 1}, "confidence": 0.9, "engine": "lanes", "stimulus": lambda frame: {"run": True}}
    other = {"measured": 32, "run_in": 31, "sample": 5, "order": 2, "faults": stuck_bits("count")}
    this = baseline.identity(campaign())
    assert [name for name, value in same.items() if baseline.identity(campaign(**{name: value})) != this] == []
    assert [name for name, value in other.items() if baseline.identity(campaign(**{name: value})) == this] == []

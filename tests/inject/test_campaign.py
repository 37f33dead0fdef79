"""A campaign from declaration to results entry: classes, fractions, expectations, failure modes, replay, stop."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from collections.abc import Callable
from fractions import Fraction
from itertools import permutations
from pathlib import Path
from typing import Any

import msgspec
import pytest

from safety.faults import ANY_TIME, TRANSIENT, Fault, flip, frozen, stuck
from safety.inject import Campaign, CampaignError, Counts, Group, Judged, campaigns, running, stuck_bits, write_csv
from safety.inject import classes as classes_module
from safety.inject.effects import with_rates
from safety.report.schema import Campaign as Entry
from safety.report.standing import standing

Make = Callable[..., Campaign]


def test_every_injection_comes_to_a_class(campaign: Make) -> None:
    entry = campaign().run()
    assert entry["classes"] == {"safe": 2, "detected": 3, "dangerous_undetected": 4, "no_effect": 5}
    assert entry["cells"] == {"neutral/yes": 1, "neutral/no": 5, "safe/no": 2, "wrong/yes": 2, "wrong/no": 4}
    assert entry["groups"] == [
        {"group": "count", "counts": {"neutral/no": 3, "safe/no": 1, "wrong/yes": 1, "wrong/no": 3}},
        {"group": "lamp", "counts": {"safe/no": 1, "wrong/no": 1}},
        {"group": "input", "counts": {"neutral/no": 1, "wrong/yes": 1}},
        {"group": "watchdog", "counts": {"neutral/yes": 1, "neutral/no": 1}},
    ]


def test_coverage_and_safe_failure_fraction_are_those_of_the_standard(campaign: Make) -> None:
    entry = campaign().run()
    assert entry["diagnostic_coverage"] == {"value": 1 / 3, "low": 1 / 3, "high": 1 / 3, "exact": "1/3"}
    assert entry["safe_failure_fraction"] == 5 / 9  # safe: 2 undetected and the false alarm; of 6 dangerous 2 detected
    assert entry["detected_of_all"]["exact"] == "3/14"


def test_a_sample_has_an_interval_and_is_not_exhaustive(campaign: Make) -> None:
    whole, part = campaign().inject(), campaign(sample=9, seed=3).inject()
    found = part.diagnostic_coverage
    assert found is not None and found.exact is None and found.low <= 1 / 3 <= found.high
    assert whole.exhaustive and not part.exhaustive
    all_of_them, some = whole.dangerous_undetected_of_all, part.dangerous_undetected_of_all
    assert all_of_them is not None and str(all_of_them.exact) == "2/7"
    assert some is not None and some.exact is None and some.low <= 2 / 7 < some.high
    assert part.to_json()["expect"] == {"exhaustive": False}


def test_the_entry_has_the_keys_of_the_results_document(campaign: Make) -> None:
    entry = campaign().run()
    keys = {"id", "model", "faults", "injections", "exhaustive", "classes", "diagnostic_coverage"}
    keys |= {"safe_failure_fraction", "seconds", "injections_per_second", "fmeda", "groups", "expected", "as_expected"}
    assert keys <= entry.keys()
    msgspec.convert(json.loads(json.dumps(entry)), Entry)


# --- as declared ------------------------------------------------------------------------------------------------------


def test_a_count_other_than_declared_is_a_failure(campaign: Make) -> None:
    right = campaign(expect={"detected": 3, "wrong/no": 4}).run()
    wrong = campaign(expect={"detected": 2, "wrong/no": 4}).run()
    assert (right["as_expected"], right["surprises"]) == (True, [])
    assert (wrong["as_expected"], wrong["surprises"]) == (False, ["all: 3 detected, expected 2"])
    assert standing("campaigns", wrong).reason == "all: 3 detected, expected 2"


@pytest.mark.parametrize(
    ("expect", "surprise"),
    [
        ({"safe/no": 1, "wrong/no": 1}, []),
        ({"safe/no": 2}, ["lamp: 1 safe/no, expected 2", "lamp: 1 wrong/no, expected 0"]),
        ({"wrong/no": 1}, ["lamp: 1 safe/no, expected 0"]),
    ],
)
def test_a_group_other_than_declared_is_a_failure(campaign: Make, expect: dict[str, int], surprise: list[str]) -> None:
    result = campaign(faults=[Group("lamp", stuck_bits("lit"), expect=expect)]).inject()
    assert sorted(result.surprises()) == surprise


def test_a_wrong_class_rule_changes_the_result(campaign: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    declared = campaign(expect={"safe": 2, "dangerous_undetected": 4})
    assert declared.inject().surprises() == []
    monkeypatch.setitem(classes_module._UNDETECTED, "wrong/no", "safe")
    assert declared.inject().surprises() == ["all: 6 safe, expected 2", "all: 0 dangerous_undetected, expected 4"]


def test_a_run_on_both_sides_is_wrong(campaign: Make) -> None:
    everything = campaign(safe_side=lambda counts: counts["lit"].max(axis=0) != 8)
    assert everything.inject().tally["wrong/no"] == 4


# --- refusals ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"measured": 65}, "65 measured frames do not divide into blocks of 16"),
        ({"run_in": -1}, "run_in=-1"),
        ({"expect": {"detcted": 1}}, "expect names 'detcted'; did you mean detected"),
        ({"faults": [Group("g", stuck_bits("lit")), Fault(flip(), ["lit"])]}, "groups or faults, not both"),
        ({"faults": []}, "no fault"),
        (
            {"hazard": "lit", "wrong_side": None, "detected": None, "safe_side": None, "detectors": {"": "alarm"}},
            "a detector's label is empty",
        ),
        ({"constant": {"rnu": True}}, "no input 'rnu'; did you mean run"),
        ({"constant": {"run": 3}}, "input run is bit: 3 is not a value"),
        ({"stimulus": {}}, "frame 0 lacks the input run"),
        ({"stimulus": {"run": True, "go": True}}, "names 'go', which is no open input; the inputs are run"),
        ({"stimulus": {"run": 1}}, "frame 0: input run is bit: 1 is not a value"),
        ({"observe": {"lit": "lit", "alarm": "count"}}, "'alarm' observes a u4; write a comparison"),
        ({"wrong_side": lambda counts: counts.total("lit") > 0}, "fault-free run is judged wrong/no"),
        ({"detected": lambda counts: True}, "fault-free run is judged neutral/yes"),
    ],
)
def test_a_declaration_that_cannot_be_meant_is_refused(campaign: Make, changes: Any, message: str) -> None:
    with pytest.raises(CampaignError, match=message):
        campaign(**changes).inject()


def test_a_wire_that_is_not_observed_is_named(campaign: Make) -> None:
    with pytest.raises(KeyError, match="'lamp' is not observed; there is lit, alarm"):
        campaign(detected=lambda counts: counts.ever("lamp")).inject()


# --- failure modes ----------------------------------------------------------------------------------------------------


def rated(rate: str | None = "2e-8") -> list[Group]:
    return [
        Group("count", stuck_bits("count"), "counter", "bit stuck", "8e-8", "[A] invented"),
        Group("lamp", stuck_bits("lit"), "driver", "stuck", rate, "[A] invented"),
    ]


def test_rates_are_divided_by_what_was_found(campaign: Make) -> None:
    entry = campaign(faults=rated()).run()
    first = entry["fmeda"][0]
    assert [first[k] for k in ("part", "mode", "faults", "tag")] == ["counter", "bit stuck", 8, "A"]
    assert [first[k] for k in ("lambda_s", "lambda_dd", "lambda_du")] == [1e-8, 1e-8, 3e-8]
    assert entry["by_rate"]["diagnostic_coverage"]["exact"] == "1/5"  # 1e-8 of 1e-8 + 3e-8 + 1e-8
    assert entry["by_rate"]["safe_failure_fraction"]["exact"] == "3/7"  # 1e-8 + 1e-8 + 1e-8 of these and 4e-8


def test_without_rates_nothing_is_weighted(campaign: Make) -> None:
    entry = campaign().run()
    assert entry["by_rate"] is None
    assert entry["fmeda"][0]["lambda_du"] is None


def test_a_mode_without_weight_fails(campaign: Make) -> None:
    with pytest.raises(CampaignError, match="'lamp' has the rate 0 /h and would weigh nothing"):
        campaign(faults=rated("0")).run()
    with pytest.raises(CampaignError, match="'lamp' has no failure rate, others have"):
        campaign(faults=rated(None)).run()


def test_a_sample_without_a_rated_group_fails(campaign: Make) -> None:
    with pytest.raises(CampaignError, match="the sample has no fault of group 'lamp', which has a rate"):
        campaign(faults=rated(), sample=1, seed=0).run()


@pytest.mark.parametrize("changes", [{"faults": rated(None)}, {"faults": rated("0")}, {"sample": 1}])
def test_rates_that_cannot_weigh_are_refused_before_the_run(
    campaign: Make, changes: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Campaign, "judged", lambda *_: pytest.fail("it was run"))
    with pytest.raises(CampaignError, match=r"timer: .*group 'lamp'"):
        campaign(**{"faults": rated(), **changes}).inject()


def test_a_text_that_looks_like_a_formula_is_a_text_in_the_table(campaign: Make, tmp_path: Path) -> None:
    harmful = ["=1+1", "+5 V", "-5 V", "@SUM(A1)", "\tx", "plain=1", "'quoted"]
    groups = [
        Group(text, stuck_bits(point), text, f"{text} lost", "1e-8", "[A] invented")
        for text, point in zip(harmful, ("count", "lit", "run", "alarm", "sum", "still"), strict=False)
    ]
    write_csv(campaign(faults=groups).inject().rows, tmp_path / "fmeda.csv")
    with (tmp_path / "fmeda.csv").open(encoding="utf-8", newline="") as file:
        found = list(csv.DictReader(file))
    assert [row["part"] for row in found] == ["'=1+1", "'+5 V", "'-5 V", "'@SUM(A1)", "'\tx", "plain=1"]
    assert found[0]["mode"] == "'=1+1 lost" and float(found[0]["rate_per_h"]) == 1e-8
    bare = [Group(g.name, g.faults, g.part, g.mode) for g in groups if g.name != "\tx"]
    lines = (tmp_path / "fmeda.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    (tmp_path / "rates.csv").write_text("".join(line for line in lines if "\t" not in line), encoding="utf-8")
    assert [g.rate_per_h for g in with_rates(bare, tmp_path / "rates.csv")] == [Fraction("1e-8")] * 5


def test_the_table_is_written_as_csv(campaign: Make, tmp_path: Path) -> None:
    write_csv(campaign(faults=rated()).inject().rows, tmp_path / "fmeda.csv")
    with (tmp_path / "fmeda.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["part"] for row in rows] == ["counter", "driver"]
    assert rows[1]["rate_per_h"] == "2e-08" and rows[1]["tag"] == "A"


# --- runs -------------------------------------------------------------------------------------------------------------


def test_every_injection_replays_to_its_cell(campaign: Make) -> None:
    declared = campaign()
    for injection, cell in declared.inject().injections():
        assert declared.replay(injection.id).cell == cell
    assert declared.replay(None).cell == "neutral/no"


def test_a_replay_records_what_is_asked_for(campaign: Make) -> None:
    found = campaign().replay("lit stuck-at-1", keep=["count", "lit"])
    assert found.trace["lit"] == [True] * 96
    assert found.trace["count"][:3] == [8, 9, 10]


def test_dangerous_undetected_injections_are_listed_for_replay(campaign: Make) -> None:
    entry = campaign().run()
    assert len(entry["replay"]) == 4 and "timer::lit stuck-at-1" in entry["replay"]


def test_ctrl_c_keeps_the_ranges_that_are_complete(campaign: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running, "SMALLEST", 5)
    declared = campaign(expect={"safe": 2})
    whole = declared.judged

    def stop(low: int, high: int) -> Judged:
        if low:
            raise KeyboardInterrupt
        return whole(low, high)

    monkeypatch.setattr(declared, "judged", stop)
    result = declared.inject()
    assert result.interrupted and not result.exhaustive
    assert result.tally.injections == 5
    assert "interrupted after 5 of 14 injections" in result.surprises()
    entry = result.to_json()
    assert (sum(entry["classes"].values()), entry["diagnostic_coverage"], entry["by_rate"]) == (5, None, None)


def test_progress_ends_at_all(campaign: Make) -> None:
    shares: list[float] = []
    campaign().inject(lambda share, seconds: shares.append(share))
    assert shares[-1] == 1.0 and shares == sorted(shares)


def test_campaigns_register_under_their_id_once(campaign: Make) -> None:
    first = campaign(id="registered")
    assert first in campaigns()
    again = campaign(id="registered")
    assert again in campaigns() and first not in campaigns()
    with pytest.raises(CampaignError, match=r"'registered' of proofs\.other has the id of one of"):
        campaign(id="registered", module="proofs.other")


def test_a_fault_that_changes_nothing_is_not_effective(campaign: Make) -> None:
    result = campaign(constant={"run": True}, stimulus={}, faults=stuck_bits("run", "lit")).inject()
    assert result.tally.injections == 4 and result.effective == 3


def test_judges_see_blocks_totals_and_the_healthy_run(campaign: Make) -> None:
    shapes: list[Any] = []

    def judge(counts: Counts) -> Any:
        shapes.append((counts["lit"].shape, counts.total("lit").shape, counts.healthy("lit"), counts.runs))
        return counts.total("lit") > counts.healthy("lit")

    campaign(wrong_side=judge).inject()
    assert shapes == [((4, 1), (1,), 32, 1), ((4, 14), (14,), 32, 14)]


def test_declaring_a_campaign_loads_neither_numpy_nor_a_solver() -> None:
    code = "import sys, proofs.ts7_campaign; print(sorted({'numpy', 'z3', 'cvc5'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], cwd=Path(__file__).parents[2], capture_output=True, text=True)
    assert (done.stdout.strip(), done.stderr) == ("[]", "")


@pytest.mark.parametrize("engine", ["lanes", "native"])
@pytest.mark.parametrize("ticks", [2**31 - 5, 2**31, 2**32 + 1, 10**20])
def test_a_transient_that_outlasts_every_number_stays(
    campaign: Callable[..., Campaign], engine: str, ticks: int
) -> None:
    forever = campaign(faults=stuck_bits("*", onset=ANY_TIME, at=3), engine=engine)
    long = campaign(faults=stuck_bits("*", onset=TRANSIENT, at=3, ticks=ticks), engine=engine)
    at_onsets = campaign(faults=stuck_bits("*"), onsets=range(3, 4), length=ticks, engine=engine)
    expected = forever.inject().tally
    assert expected.dangerous_undetected and long.inject().tally == at_onsets.inject().tally == expected


@pytest.mark.parametrize("engine", ["lanes", "native"])
@pytest.mark.parametrize("order", list(permutations(range(3))))
def test_faults_that_meet_by_way_of_another_act_in_their_order(
    campaign: Make, engine: str, order: tuple[int, ...]
) -> None:
    """The frozen sum is built in; what shares a point with the stuck points, which share one with it, has to be too."""
    three = [
        Fault(frozen(), ["sum"], ANY_TIME, at=2),
        Fault(stuck(0), ["sum", "lit"], ANY_TIME, at=3),
        Fault(flip(), ["lit"], ANY_TIME, at=1),
    ]
    declared = campaign(faults=[three[i] for i in order], order=3, engine=engine, collapsing=False)
    seen = declared.engine_of().run(declared.space.batch(0, 1))
    again = running.outcome(declared, declared.replay(0).trace)
    assert {name: counts.tolist() for name, counts in seen.counts.items()} == {
        name: counts.tolist() for name, counts in again.counts.items()
    }

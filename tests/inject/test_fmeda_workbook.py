"""The workbook: what is on its sheets, that it does not change from one writing to the next, and what is refused."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from safety.faults import Fault, stuck
from safety.inject import CampaignError, Group, stuck_bits
from safety.inject.fmeda import COLUMNS, records
from safety.inject.workbook import MOST_NAMED, injections_behind, write_xlsx

Make = Callable[..., Any]
openpyxl = pytest.importorskip("openpyxl", reason="openpyxl writes the workbooks; pip install rightside[xlsx]")


def rated() -> list[Group]:
    return [
        Group("count", stuck_bits("count"), "counter", "=bit stuck", "8e-8", "[A] invented"),
        Group("lamp", stuck_bits("lit"), "driver", "stuck", "2e-8", "[P] list"),
    ]


def sheets(path: Path) -> dict[str, list[tuple[Any, ...]]]:
    book = openpyxl.load_workbook(path)
    return {sheet.title: [tuple(row) for row in sheet.iter_rows(values_only=True)] for sheet in book}


def test_the_workbook_says_what_the_result_says(campaign: Make, tmp_path: Path) -> None:
    result = campaign(faults=rated()).inject()
    write_xlsx(result, tmp_path / "table.xlsx")
    found = sheets(tmp_path / "table.xlsx")
    assert list(found) == ["FMEDA", "Totals", "Traceability", "Parameters"]
    book = openpyxl.load_workbook(tmp_path / "table.xlsx")
    assert "f" not in {cell.data_type for sheet in book for row in sheet for cell in row}  # no formula
    assert found["FMEDA"] == [COLUMNS, *(tuple(record.values()) for record in records(result.rows))]
    heading, *lines = found["Totals"]
    totals = {line[0]: dict(zip(heading, line, strict=True)) for line in lines}
    assert list(totals) == ["counter", "driver", "equipment"]
    by_rate = result.to_json()["by_rate"]
    assert totals["equipment"]["lambda_du"] == by_rate["lambda_du"] == totals["equipment"]["lambda_du_high"]
    assert totals["equipment"]["diagnostic_coverage"] == by_rate["diagnostic_coverage"]["value"]
    assert (totals["equipment"]["rate_per_h"], totals["equipment"]["tags"]) == (1e-7, "AP")
    parameters = {line[0]: line[1:] for line in found["Parameters"]}
    assert parameters["rate of counter: =bit stuck, 1/h"] == (8e-8, "A", "[A] invented")
    assert parameters["campaign"][0] == "timer" and parameters["all injected"][0] == "yes"


def test_control_characters_are_written_out(campaign: Make, tmp_path: Path) -> None:
    bell = Fault(stuck(0), ["lit"], name="lamp\x07 off")
    group = Group("lamp", [bell], "driver\x00", "stuck\x1f\tlow", "2e-8", "[P] list \x0b")
    write_xlsx(campaign(faults=[group]).inject(), tmp_path / "table.xlsx")
    found = sheets(tmp_path / "table.xlsx")
    assert found["FMEDA"][1][:2] == ("driver\\x00", "stuck\\x1f\tlow") and found["FMEDA"][1][-1] == "[P] list \\x0b"
    assert found["Traceability"][1][-1] == "timer::lamp\\x07 off"


def test_every_figure_is_traced_to_its_injections(campaign: Make, tmp_path: Path) -> None:
    result = campaign(faults=rated()).inject()
    write_xlsx(result, tmp_path / "table.xlsx")
    heading, *lines = sheets(tmp_path / "table.xlsx")["Traceability"]
    traced = [dict(zip(heading, line, strict=True)) for line in lines]
    for row in result.rows:
        for column in ("lambda_s", "lambda_dd", "lambda_du", "lambda_no_effect"):
            mine = [
                t
                for t in traced
                if (t["part"], t["mode"]) == (row.part, row.mode) and column in t["columns"].split(", ")
            ]
            named = [name for t in mine for name in t["replay"].split("\n")]
            assert sorted(named) == sorted(injections_behind(result, row, column))
            assert row.split().get(column, 0) in (row.rate * len(named) / row.tally.injections, 0)
    missed = [name for t in traced if t["cell"] == "wrong/no" for name in t["replay"].split("\n")]
    assert sorted(missed) == sorted(result.to_json()["replay"])


def test_the_injections_behind_a_figure_can_be_replayed(campaign: Make) -> None:
    declared = campaign(faults=rated())
    result = declared.inject()
    for row in result.rows:
        for selector in injections_behind(result, row, "diagnostic_coverage"):
            name, _, injection = selector.partition("::")
            number = declared.space.find(injection)
            assert name == declared.id and result.cell(number) in ("wrong/yes", "wrong/no")
    with pytest.raises(CampaignError, match="column 'rate_per_h' is not made of injections; choose one of faults"):
        next(injections_behind(result, result.rows[0], "rate_per_h"))


def test_of_many_injections_the_first_are_named_and_the_rest_counted(campaign: Make, tmp_path: Path) -> None:
    result = campaign(
        faults=[Group("count", stuck_bits("count"), rate_per_h="1e-8", source="[A] x")], onsets=range(64)
    ).inject()
    write_xlsx(result, tmp_path / "table.xlsx")
    heading, *lines = sheets(tmp_path / "table.xlsx")["Traceability"]
    number, replay = (heading.index(name) for name in ("injections", "replay"))
    many = [line for line in lines if line[number] > MOST_NAMED]
    assert many and sum(line[number] for line in lines) == 8 * 64
    for line in many:
        *names, last = line[replay].split("\n")
        assert len(names) == MOST_NAMED and last == f"... {line[number] - MOST_NAMED} more"


def test_the_same_result_gives_the_same_bytes(campaign: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result = campaign(faults=rated()).inject()
    write_xlsx(result, tmp_path / "one.xlsx")
    now = time.time()
    monkeypatch.setattr(time, "time", lambda: now + 86_400)
    time.sleep(1.1)  # the time in a workbook is in whole seconds
    write_xlsx(result, tmp_path / "two.xlsx")
    assert (tmp_path / "one.xlsx").read_bytes() == (tmp_path / "two.xlsx").read_bytes()


def test_rows_alone_have_no_traces(campaign: Make, tmp_path: Path) -> None:
    rows = campaign(faults=rated()).inject().rows
    write_xlsx(rows, tmp_path / "table.xlsx")
    assert list(sheets(tmp_path / "table.xlsx")) == ["FMEDA", "Totals", "Parameters"]


def test_without_openpyxl_it_is_said_what_to_install(
    campaign: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = campaign(faults=rated()).inject().rows
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(CampaignError, match=r"openpyxl is not installed; pip install rightside\[xlsx\]"):
        write_xlsx(rows, tmp_path / "table.xlsx")


def test_without_failure_modes_there_is_nothing_to_write(campaign: Make, tmp_path: Path) -> None:
    pairs = campaign(order=2).inject()
    with pytest.raises(CampaignError, match="there is no failure mode to write"):
        write_xlsx(pairs, tmp_path / "table.xlsx")
    assert not (tmp_path / "table.xlsx").exists()

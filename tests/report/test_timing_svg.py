"""The timing diagram and the table of changed cells tell the whole story, and say what they leave out."""

from typing import Any
from xml.etree import ElementTree as ET

import pytest

from safety.report.timing_svg import LANES, timing_svg
from safety.report.trace import Trace, word

Entry = dict[str, Any]
SVG = "{http://www.w3.org/2000/svg}"


def trace(values: dict[str, list[Any]], **more: Any) -> Entry:
    signals = [{"path": path, "kind": "number", "values": listed} for path, listed in values.items()]
    return {"steps": 9, "tick_s": "1/8000", "violated_at": None, "replayed": True, "signals": signals, **more}


def drawn(counterexample: Entry) -> ET.Element:
    return ET.fromstring(timing_svg(counterexample, "title"))


def words(root: ET.Element, class_: str | None = None) -> list[str]:
    return [node.text or "" for node in root.iter(f"{SVG}text") if class_ is None or node.get("class") == class_]


@pytest.fixture
def overspeed(sample: dict[str, Any]) -> Entry:
    return next(c["counterexample"] for c in sample["claims"] if c["id"] == "brakes_even_with_two")


def test_violation_and_fault_are_marked_once(overspeed: Entry) -> None:
    root = drawn(overspeed)
    assert (words(root, "badword"), words(root, "onsetword")) == (["violated"], ["fault"])


def test_the_violated_tick_is_on_the_axis_with_its_time(overspeed: Entry) -> None:
    assert {"302", "37.75"} <= set(words(drawn(overspeed)))


def test_every_signal_is_named(overspeed: Entry) -> None:
    assert {s["path"] + (f" [{s['unit']}]" if s["unit"] else "") for s in overspeed["signals"]} <= set(
        words(drawn(overspeed))
    )


def test_columns_cover_every_tick_once(overspeed: Entry) -> None:
    shown = Trace(overspeed)
    ticks = [column.tick + n for column in shown.columns() for n in range(column.ticks)]
    assert ticks == list(range(shown.first, shown.last + 1))


def test_a_calm_stretch_shrinks_and_nothing_changes_in_it(overspeed: Entry) -> None:
    shown = Trace(overspeed)
    calm = [column for column in shown.columns() if column.kind == "unchanged"]
    assert [column.ticks for column in calm] == [94, 185]
    assert not any(shown.changed(lane, c.tick + n) for lane in shown.lanes for c in calm for n in range(c.ticks))


@pytest.mark.parametrize("violated", [0, 3, 500, 998, 999])
def test_a_long_busy_trace_is_cut_but_never_at_the_violation(violated: int) -> None:
    busy = Trace(trace({"n": list(range(1000))}, violated_at=violated))
    columns = busy.columns(room=40)
    assert len(columns) <= 40 + 2
    assert sum(column.ticks for column in columns) == 1000
    assert any(column.kind == "tick" and column.tick == violated for column in columns)
    assert "left out" in {column.kind for column in columns}


def test_ticks_are_counted_from_the_first_one_listed() -> None:
    late = Trace(trace({"n": [1, 1, 2]}, first_tick=100, violated_at=102))
    assert (late.first, late.last, late.eventful()) == (100, 102, [100, 102])


def test_signals_beyond_the_twentieth_are_counted() -> None:
    many = drawn(trace({f"s{n}": [0, 1] for n in range(LANES + 3)}))
    assert "3 more signals are not drawn; results.json has them all" in words(many)


def test_a_trace_without_signals_draws_nothing() -> None:
    assert timing_svg(trace({}), "title") == ""


def test_an_event_clock_shows_no_milliseconds() -> None:
    assert "clock: events" in words(drawn(trace({"n": [0, 1]}, tick_s=None)))


def test_hostile_names_are_text() -> None:
    root = ET.fromstring(timing_svg(trace({"<script>&\"'": ["<b>", "]]>"]}), "<i>", "x"))
    assert root.find(f".//{SVG}script") is None
    assert "<script>&\"'" in words(root)


def test_the_same_trace_gives_the_same_text(overspeed: Entry) -> None:
    assert timing_svg(overspeed, "t") == timing_svg(overspeed, "t")


def test_a_table_marks_each_change_against_the_column_before() -> None:
    table = Trace(trace({"n": [5, 5, 6, 6, 5]}, violated_at=4)).table(room=9)
    assert table.ticks == [0, 2, 4]
    assert [(cell.text, cell.changed) for cell in table.rows[0].cells] == [("5", False), ("6", True), ("5", True)]


def test_a_table_without_room_keeps_the_start_and_the_end() -> None:
    table = Trace(trace({"n": list(range(50))}, violated_at=40)).table(room=4)
    assert (table.ticks, table.left_out) == ([0, 38, 39, 40], 37)


@pytest.mark.parametrize(
    ("value", "bit", "said"),
    [
        (True, True, "1"),
        (0, True, "0"),
        (None, True, "any"),
        (2.5, False, "2.5"),
        ("1/3", False, "1/3"),
        (7, False, "7"),
    ],
)
def test_word(value: Any, bit: bool, said: str) -> None:
    assert word(value, bit) == said

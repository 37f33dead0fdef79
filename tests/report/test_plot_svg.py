"""Plots: values lie where the axes say, series differ without colour, and equal plots are equal text."""

from __future__ import annotations

import re
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from safety.report.plot_svg import DASHES, HEIGHT, LEFT, MARKED, MARKERS, TOP, WIDTH, plot_svg
from safety.report.scales import Scale, scale_of
from safety.report.tree_text import text_width

SVG = "{http://www.w3.org/2000/svg}"


def axis(name: str = "x", log: bool = False, low: float | None = None, high: float | None = None) -> dict[str, Any]:
    return {"name": name, "unit": "km/h", "log": log, "low": low, "high": high}


def entry(*marks: dict[str, Any], **axes: dict[str, Any]) -> dict[str, Any]:
    plain = {"x": axis("x", low=0, high=10), "y": axis("y", low=0, high=100)}
    return {"id": "p", "kind": "plot", "title": "<A> & B", "assumed": [], "marks": list(marks)} | plain | axes


def curve(label: str, points: list[tuple[float, float]], kind: str = "curve", **more: Any) -> dict[str, Any]:
    return {"kind": kind, "label": label, "points": points} | more


def root(found: dict[str, Any]) -> ET.Element:
    return ET.fromstring(plot_svg(found, "ident"))


def with_class(found: dict[str, Any], name: str) -> list[ET.Element]:
    return [each for each in root(found).iter() if name in (each.get("class") or "").split()]


def places(markers: list[ET.Element]) -> list[tuple[float, ...]]:
    return [tuple(map(float, re.findall(r"-?[\d.]+", each.get("transform", "")))) for each in markers]


# --- scales ----------------------------------------------------------------------------------------------------------


def test_linear_and_logarithmic_places() -> None:
    assert [Scale(0, 10, 100, 200).at(v) for v in (0, 5, 10)] == [100, 150, 200]
    assert [round(Scale(1, 100, 0, 200, True).at(v)) for v in (1, 10, 100)] == [0, 100, 200]
    assert Scale(0, 10, 300, 100).at(2.5) == 250  # upwards


@pytest.mark.parametrize(
    ("scale", "most", "ticks"),
    [
        (Scale(0, 10, 0, 1), 10, [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10]),
        (Scale(0, 0.7, 0, 1), 8, [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]),
        (Scale(-3, 3, 0, 1), 6, [-3, -2, -1, 0, 1, 2, 3]),
        (Scale(0.6213, 0.6219, 0, 1), 6, [0.6213, 0.6214, 0.6215, 0.6216, 0.6217, 0.6218, 0.6219]),
        (Scale(90, 3000, 0, 1, True), 10, [100, 200, 500, 1000, 2000]),
        (Scale(1, 1e5, 0, 1, True), 12, [1, 3, 10, 30, 100, 300, 1000, 3000, 10_000, 30_000, 100_000]),
        (Scale(1e-12, 1, 0, 1, True), 8, [1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2, 1]),
        (Scale(100, 130, 0, 1, True), 6, [100, 105, 110, 115, 120, 125, 130]),
    ],
)
def test_ticks_are_round(scale: Scale, most: int, ticks: list[float]) -> None:
    assert scale.ticks(most) == ticks


def test_an_axis_without_ends_goes_a_little_beyond_its_values() -> None:
    scale = scale_of(axis(), [0, 50, 100], 0, 1)
    assert scale.low < 0 and scale.high > 100 and scale.high - scale.low < 110
    one = scale_of(axis(log=True), [10], 0, 1)
    assert one.low < 10 < one.high
    assert scale_of(axis(low=0), [5, 10], 0, 1).low == 0
    for value in (0.0, -3.0, 1e-12, 1e23):
        alone = scale_of(axis(), [value], 0, 100)
        assert alone.at(value) == pytest.approx(50)
        assert len(alone.ticks(8)) > 2


# --- pictures --------------------------------------------------------------------------------------------------------


def test_points_lie_where_the_axes_say_and_those_outside_are_left_out() -> None:
    found = entry(curve("dots", [(0, 0), (5, 50), (10, 100), (11, 50)], "points"))
    drawn = places(with_class(found, "mark"))[:-1]  # the last one is that of the legend
    assert drawn == [(LEFT, TOP + HEIGHT), (LEFT + WIDTH / 2, TOP + HEIGHT / 2), (LEFT + WIDTH, TOP)]


def test_a_curve_is_cut_off_at_the_axes() -> None:
    found = root(entry(curve("line", [(0, 0), (20, 200)])))
    group = next(each for each in found.iter(f"{SVG}g") if each.get("clip-path"))
    assert group.get("clip-path") == "url(#ident-area)" and len(list(group)) == 1
    area = next(found.iter(f"{SVG}clipPath"))
    assert area.get("id") == "ident-area" and area[0].get("width") == str(WIDTH)


def test_a_curve_has_markers_where_there_are_few_points() -> None:
    counts = {n: len(with_class(entry(curve("c", [(k % 10, k % 10) for k in range(n)])), "mark")) for n in (2, 3, 40)}
    assert counts == {2: 0, 3: 3 + 1, 40: 0} and MARKED < 40
    assert not with_class(entry(curve("steps", [(0, 1), (1, 1), (1, 2)], marked=False)), "mark")


def test_series_differ_without_colour() -> None:
    found = entry(*(curve(f"c{n}", [(0, n), (10, n), (5, n)]) for n in range(12)))
    looks = [(each.get("class"), each.get("stroke-dasharray")) for each in with_class(found, "curve")][:12]
    shapes = [each.get("d") for each in with_class(found, "mark")][: 12 * 3 : 3]
    assert len(set(zip(looks, shapes, strict=True))) == 12
    assert len({dash for _, dash in looks[:6]}) == len(DASHES) == len(MARKERS) == len(set(shapes[:6]))


def test_rules_and_bands_stand_at_their_values() -> None:
    rules = entry(
        curve("c", [(0, 1)], "points"),
        {"kind": "rule", "label": "at 5", "axis": "x", "at": [5.0]},
        {"kind": "rule", "label": "outside", "axis": "y", "at": [101.0]},
        {"kind": "band", "label": "20 to 40", "axis": "y", "at": [20.0, 40.0]},
        {"kind": "band", "label": "up to the edge", "axis": "x", "at": [8.0, 30.0]},
    )
    across, *_ = (each.get("d") for each in with_class(rules, "rule"))
    assert across == f"M{LEFT + WIDTH / 2:.1f} {TOP}v{HEIGHT}"
    low, edge = (each.attrib for each in with_class(rules, "band")[:2])
    assert (float(low["y"]), float(low["height"])) == (TOP + 0.6 * HEIGHT, 0.2 * HEIGHT)
    assert (float(edge["x"]), float(edge["width"])) == (LEFT + 0.8 * WIDTH, 0.2 * WIDTH)
    assert len(with_class(rules, "rule")) == 1 + 2  # one drawn, two in the legend


def test_names_turn_to_the_side_with_room() -> None:
    found = entry(curve("dots", [(0, 50), (10, 50)], "points", names=["left end", "right end"]))
    anchors = {each.text: each.get("text-anchor") for each in with_class(found, "over")}
    assert anchors == {"left end": "start", "right end": "end"}


def test_names_of_points_close_together_do_not_lie_on_each_other() -> None:
    close = [(5.0, 50.0), (5.1, 50.0), (5.2, 51.0), (5.3, 49.0)]
    found = entry(curve("dots", close, "points", names=["the first one", "the second", "the third", "the fourth"]))
    boxes = []
    for each in with_class(found, "over"):
        x, wide = float(each.get("x", "")), text_width(each.text or "")
        boxes.append((x - wide if each.get("text-anchor") == "end" else x, wide, float(each.get("y", ""))))
    for n, (x, wide, y) in enumerate(boxes):
        assert all(abs(y - v) >= 15 or x >= u + w or u >= x + wide for u, w, v in boxes[:n])


def test_a_falling_axis_has_its_high_end_on_the_left() -> None:
    found = entry(curve("dots", [(10, 0), (0, 100)], "points"), x=axis(low=0, high=10) | {"falling": True})
    assert places(with_class(found, "mark"))[:-1] == [(LEFT, TOP + HEIGHT), (LEFT + WIDTH, TOP)]
    band = entry(curve("c", [(0, 1)], "points"), {"kind": "band", "label": "b", "axis": "x", "at": [8.0, 30.0]},
                 x=axis(low=0, high=10) | {"falling": True})  # fmt: skip
    edge = with_class(band, "band")[0].attrib
    assert (float(edge["x"]), float(edge["width"])) == (LEFT, pytest.approx(0.2 * WIDTH))


def test_it_says_in_words_what_it_shows_and_escapes_them() -> None:
    found = root(entry(curve("a < b", [(0, 1), (1, 2)]), {"kind": "note", "text": "here & there", "at": [1, 1]}))
    assert found.get("aria-label") == "<A> & B. y (km/h) against x (km/h): a < b."
    words = [each.text for each in found.iter(f"{SVG}text")]
    assert {"x (km/h)", "y (km/h)", "a < b", "here & there", "100"} <= set(words)
    assert plot_svg(entry(curve("a", [(0, 1), (1, 2)])) | {"assumed": ["[A] n"]}, "i").count("[A]") == 1


def test_a_legend_of_many_series_goes_over_several_rows() -> None:
    few, many = (root(entry(*(curve(f"series number {n}", [(0, n), (1, n)]) for n in range(m)))) for m in (2, 20))
    assert float(many.get("height", "")) > float(few.get("height", "")) + 40
    assert all(float(each.get("x", "")) <= LEFT + WIDTH for each in many.iter(f"{SVG}text"))


def test_a_long_label_is_cut_and_said_in_full() -> None:
    label = "a series with a very long name, " * 12
    found = root(entry(curve(label, [(0, 1), (1, 1)])))
    shown = next(each.text for each in found.iter(f"{SVG}text") if (each.text or "").startswith("a series"))
    assert shown.endswith("…") and label in [each.text for each in found.iter(f"{SVG}title")]


def test_equal_plots_are_equal_text() -> None:
    found = entry(curve("c", [(k / 7, 100 / (k + 1)) for k in range(60)]))
    assert plot_svg(found, "i") == plot_svg(dict(found), "i") != plot_svg(found, "j")

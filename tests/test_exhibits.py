"""Exhibits: tables and plots as declared, what is refused, and the way into results and report."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from safety import exhibits
from safety.exhibits import Axis, Band, Column, Curve, Exhibit, ExhibitError, Mark, Note, Points, Row, Rule, plot, table
from safety.report.folder import check, write
from safety.report.gaps import gaps
from safety.report.html import html
from safety.report.results import ResultsError, dumps, empty, loads
from safety.report.standing import exit_code, standing

COLUMNS = (Column("speed", "km/h"), Column("time", "s", decimals=3, assumed=True), Column("agrees"))


def made(make: Callable[[], Any], **more: Any) -> Exhibit:
    """A table of these rows, as declared."""
    given = {"id": "t", "title": "Times", "source": "[D]", "columns": COLUMNS} | more
    table(**given)(make)
    return exhibits.declared()[-1]


def drawn(*marks: Mark, **axes: Axis) -> Exhibit:
    """A plot of these marks."""
    plot(id="p", title="Curves", source="[D]", **({"x": Axis("x"), "y": Axis("y")} | axes))(lambda: marks)
    return exhibits.declared()[-1]


def rows() -> Iterator[Row]:
    yield 250, Fraction(2, 3), True
    yield 5, 0.5, False


def test_a_table_keeps_exact_values_beside_the_doubles() -> None:
    entry = made(rows, says_no=["5: agrees"], assumed=["[A] n = 1"]).evaluate()
    assert entry["rows"] == [[250, {"value": 2 / 3, "exact": "2/3"}, True], [5, 0.5, False]]
    assert (entry["kind"], entry["as_expected"], entry["assumed"]) == ("table", True, ["[A] n = 1"])
    assert entry["columns"][1] == {"name": "time", "unit": "s", "decimals": 3, "assumed": True}
    assert loads(dumps(empty() | {"exhibits": [entry]}))["exhibits"] == [entry]


def test_a_second_no_of_the_same_name_is_one_too_many() -> None:
    twice = made(lambda: [*rows(), (5, 1, False)], says_no=["5: agrees"]).evaluate()
    assert (twice["as_expected"], twice["note"]) == (False, "no in 5: agrees, 5: agrees; expected in 5: agrees")


@pytest.mark.parametrize("says_no", [[], ["250: agrees"], ["5: agrees", "250: agrees"], ["5: time"]])
def test_a_check_that_says_otherwise_than_declared_fails(says_no: list[str]) -> None:
    entry = made(rows, says_no=says_no).evaluate()
    assert entry["as_expected"] is False
    assert standing("exhibits", entry).reason == f"no in 5: agrees; expected in {', '.join(says_no) or 'none'}"
    assert exit_code(empty() | {"exhibits": [entry]}) == 1


def test_a_plot_has_its_marks_in_order() -> None:
    entry = drawn(
        Band("range", x=(Fraction(1, 2), 2)),
        Curve("line", [(0, 1), (1, Fraction(1, 3))]),
        Points("ends", [(1, 1)], names=["one"]),
        Rule("limit", y=3),
        Note("here", (1, 2)),
    ).evaluate()
    assert entry["marks"] == [
        {"kind": "band", "label": "range", "axis": "x", "at": [0.5, 2.0]},
        {"kind": "curve", "label": "line", "points": [[0.0, 1.0], [1.0, 1 / 3]]},
        {"kind": "points", "label": "ends", "points": [[1.0, 1.0]], "names": ["one"]},
        {"kind": "rule", "label": "limit", "axis": "y", "at": [3.0]},
        {"kind": "note", "text": "here", "at": [1.0, 2.0]},
    ]
    assert standing("exhibits", entry).code == 0
    assert loads(dumps(empty() | {"exhibits": [entry]}))["exhibits"] == [entry]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: made(lambda: [(1, 2)]).evaluate(), "a row of 2 cells, .* in 3 columns"),
        (lambda: made(lambda: [(1, float("nan"), True)]).evaluate(), "a cell is nan; write what that means"),
        (lambda: made(lambda: [(1, object(), True)]).evaluate(), "it is text, a number, yes or no, or None"),
        (lambda: made(rows, columns=()), "t has no columns"),
        (lambda: made(lambda: None).evaluate(), "gives None; let it yield"),
        (lambda: made(lambda: []).evaluate(), "t is empty: its function gives nothing"),
        (lambda: made(lambda: [3]).evaluate(), "a row is 3; it is a list or tuple"),
        (lambda: drawn("line").evaluate(), "a mark is 'line'; it is a Curve"),  # type: ignore[arg-type]
        (lambda: drawn(Curve("c", [(0, 1, 2)])).evaluate(), "it is an x and a y"),  # type: ignore[list-item]
        (lambda: drawn(Curve("c", [("0", 1)])).evaluate(), "x = '0' is no number"),  # type: ignore[list-item]
        (lambda: drawn(Curve("c", [(10**400, 1)])).evaluate(), "is a finite number"),
        (lambda: drawn(Rule("r", x=1)).evaluate(), "neither a curve nor a point"),
        (lambda: drawn(Curve("c", [(0, 1)]), x=Axis("n", log=True)).evaluate(), "n = 0; .* above 0"),
        (lambda: drawn(Curve("c", [(0, float("inf"))])).evaluate(), "y = inf; a place on a plot is a finite number"),
        (lambda: drawn(Curve("c", [(0, 1)]), x=Axis("n", low=2, high=1)).evaluate(), "its low end comes first"),
        (lambda: drawn(Points("c", [(0, 1)], names=["a", "b"])).evaluate(), "2 names for the 1 points of 'c'"),
        (lambda: drawn(Curve("c", [(0, 1)]), Rule("r")).evaluate(), "'r' stands at an x or at a y"),
        (lambda: drawn(Curve("c", [(0, 1)]), Rule("r", x=1, y=2)).evaluate(), "give one of both"),
        (lambda: drawn(Curve("c", [(0, 1)]), Band("b", y=(2, 1))).evaluate(), "'b' from 2.0 to 1.0"),
    ],
)
def test_what_cannot_be_shown_is_refused(make: Callable[[], Any], words: str) -> None:
    with pytest.raises(ExhibitError, match=words):
        make()


def test_an_id_is_taken_once() -> None:
    table(id="twice", title="a", source="", columns=COLUMNS)(rows)
    with pytest.raises(ExhibitError, match=r"twice is declared twice, at .*; ids are unique"):
        table(id="twice", title="b", source="", columns=COLUMNS)(rows)


# --- report ----------------------------------------------------------------------------------------------------------


def shown(*found: Exhibit) -> dict[str, Any]:
    return empty() | {"exhibits": [one.evaluate() for one in found]}


def test_the_page_has_tables_with_units_marks_and_answers() -> None:
    page = html(shown(made(rows, says_no=["5: agrees"], assumed=["[A] n = 1"], note="A caption.")))
    for words in (
        "Tables and plots",
        "A caption.",
        "0.667",
        "0.500",
        "assumes [A] n = 1",
        'title="2/3"',
        ">yes<",
        ">no<",
    ):
        assert words in page
    assert 'time <span class="tag tag-A"' in page and "<script" not in page


def test_a_table_that_is_not_as_asked_says_so_in_the_page() -> None:
    page = html(shown(made(rows)))
    assert "no in 5: agrees; expected in none" in page and "1 of 1 results is not as asked" in page


def test_assumed_inputs_are_listed_with_what_is_not_shown() -> None:
    results = shown(made(rows, says_no=["5: agrees"], assumed=["[A] n = 1", "[D] m = 2"]))
    (group,) = [gap for gap in gaps(results) if gap.title == "Assumed inputs [A]"]
    assert [(item.label, item.text) for item in group.items] == [("t", "[A] n = 1")]


def test_plots_lie_in_the_folder_and_a_changed_one_is_stale(tmp_path: Path) -> None:
    results = shown(drawn(Curve("line", [(0, 1), (1, 2)])))
    write(results, tmp_path)
    drawing = tmp_path / "plots/p.svg"
    assert drawing.read_text().startswith("<svg") and check(results, tmp_path) == []
    drawing.write_text("edited")
    assert [(found.file, found.kind) for found in check(results, tmp_path)] == [("plots/p.svg", "stale")]
    write(empty(), tmp_path)
    assert not drawing.exists()


@pytest.mark.parametrize("name", ["x", "marks"])
def test_a_plot_that_cannot_be_drawn_is_an_error_of_its_file(tmp_path: Path, name: str) -> None:
    results = shown(drawn(Curve("line", [(0, 1), (1, 2)])))
    broken = {"x": {"name": "x"}, "marks": [{"kind": "curve"}]}[name]
    results["exhibits"][0][name] = broken
    with pytest.raises(ResultsError, match=r"exhibits"):
        write(results, tmp_path)


def test_declaring_needs_no_solver_and_no_array_library() -> None:
    code = "import sys, safety.exhibits; print(sorted({'z3', 'numpy', 'jinja2', 'msgspec'} & set(sys.modules)))"
    called = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert called.stdout.strip() == "[]"

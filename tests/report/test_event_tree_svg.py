"""The picture of an event tree: a line for every path, every state at its fork, figures once, all inside the frame."""

import re
from collections import Counter
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from safety.report.event_tree_svg import ROWS, event_tree_svg, event_trees_svg

Found = dict[str, Any]


def sequence(
    name: str, *paths: Found, chance: float = 0.25, frequency: float | None = 0.5, assumed: bool = False
) -> Found:
    return {"id": name, "paths": list(paths), "probability": chance, "frequency": frequency, "assumed": assumed}


def entry(*sequences: Found, columns: str = "FGH") -> Found:
    events = [{"id": name, "description": f"what {name} does"} for name in columns]
    return {
        "id": "leak",
        "event_tree": "after",
        "frequency": 2.0,
        "functional_events": events,
        "sequences": list(sequences),
    }


FORKED = entry(
    sequence("S", {"F": "works"}, {"F": "fails", "H": "works"}),
    sequence("T", {"F": "fails", "G": "no", "H": "fails"}, chance=0.125, assumed=True),
    sequence("U", {"F": "fails", "G": "yes", "H": "fails"}, chance=0.0625),
)


def texts(picture: str) -> list[tuple[str, float, float]]:
    root = ET.fromstring(picture)
    return [
        (one.text or "", float(one.get("x", 0)), float(one.get("y", 0)))
        for one in root.iter()
        if one.tag.endswith("text")
    ]


def lines(picture: str) -> list[tuple[float, float, float]]:
    """The horizontal lines: from, to, at which height."""
    return [(float(a), float(c), float(b)) for a, b, c in re.findall(r"M([\d.]+) ([\d.]+)H([\d.]+)", picture)]


def test_every_path_is_a_row_that_ends_in_its_sequence() -> None:
    found = texts(event_tree_svg(FORKED))
    right = next(x for words, x, _ in found if words == "sequence")
    rows = sorted((y, words) for words, x, y in found if x == right and words != "sequence")
    assert [words for _, words in rows] == ["S", "S", "T", "U"]
    ends = {at for _, to, at in lines(event_tree_svg(FORKED)) if abs(to - (right - 10)) < 1}
    assert len(ends) == 4 and all(any(abs(at + 4 - y) < 1 for at in ends) for y, _ in rows)


def test_states_stand_at_their_forks() -> None:
    counts = Counter(words for words, _, _ in texts(event_tree_svg(FORKED)))
    assert (counts["works"], counts["fails"], counts["no"], counts["yes"]) == (2, 3, 1, 1)
    places = {words: x for words, x, _ in texts(event_tree_svg(FORKED))}
    assert places["no"] == places["yes"] and places["G"] < places["no"] < places["H"]


def test_figures_stand_once_with_their_mark() -> None:
    counts = Counter(words for words, _, _ in texts(event_tree_svg(FORKED)))
    assert counts["0.25"] == 1 and counts["0.125 [A]"] == 1 and counts["0.5 [A]"] == 1
    bare = entry(sequence("S", {"F": "works"}, frequency=None))
    assert "frequency" not in Counter(words for words, _, _ in texts(event_tree_svg(bare)))


def test_rows_of_one_course_stand_together() -> None:
    mixed = entry(
        sequence("S", {"F": "a", "G": "1"}, {"F": "b", "G": "1"}), sequence("T", {"F": "a", "G": "2"}), columns="FG"
    )
    found = texts(event_tree_svg(mixed))
    assert Counter(words for words, _, _ in found)["a"] == 1
    rows = [words for _, words in sorted((y, w) for w, x, y in found if w in "ST" and x > 300)]
    assert rows == ["S", "T", "S"]


def test_columns_of_linked_trees_and_paths_that_look_alike() -> None:
    linked = entry(sequence("S", {"F": "a", "X": "b"}), sequence("T", {"F": "a", "X": "b"}), columns="F")
    found = [words for words, _, _ in texts(event_tree_svg(linked))]
    assert "X" in found and {"S", "T"} <= set(found)
    assert re.search(r"M[\d.]+ [\d.]+V[\d.]+", event_tree_svg(linked))


def test_what_is_left_out_is_counted() -> None:
    many = entry(*(sequence(f"S{n}", {"F": str(n)}) for n in range(ROWS + 7)), columns="F")
    assert "7 more paths are not shown" in event_tree_svg(many)
    assert "not shown" not in event_tree_svg(FORKED)


@pytest.mark.parametrize("picture", [event_tree_svg(FORKED), event_trees_svg([FORKED, FORKED])])
def test_all_is_inside_and_escaped(picture: str) -> None:
    root = ET.fromstring(picture)
    wide, high = float(root.get("width", 0)), float(root.get("height", 0))
    assert all(0 <= x < wide and 0 <= y <= high for _, x, y in texts(picture))
    assert all(0 <= a < b <= wide for a, b, _ in lines(picture))
    odd = entry(sequence("<S&>", {"F": '"<'}), columns="F")
    assert "<S&>" in [words for words, _, _ in texts(event_tree_svg(odd))]


def test_several_stand_below_one_another() -> None:
    assert event_trees_svg([FORKED]) == event_tree_svg(FORKED)
    both = event_trees_svg([FORKED, FORKED | {"id": "fire"}])
    shifts = [float(y) for y in re.findall(r"translate\(0 ([\d.]+)\)", both)]
    one = float(ET.fromstring(event_tree_svg(FORKED)).get("height", 0))
    assert shifts[0] == 0 and shifts[1] > one and both.count(">fire<") == 1

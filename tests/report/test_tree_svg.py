"""The fault-tree picture: everything drawn or said to be left out, nothing over anything else, always the same."""

import itertools
import random
import re
from xml.etree import ElementTree

import pytest

from safety.report.tree_layout import CARD_WIDTH, PADDING, text_width, wrapped
from safety.report.tree_svg import CARDS, INPUTS, power_of_ten, tree_svg
from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent, from_cut_sets, summary, to_document

SVG = "{http://www.w3.org/2000/svg}"
LONG = "channel_a.reference_oscillator.frequency_divider.output_stage_stuck_at_zero"

SMALL = FaultTree(
    "Wrong-side permit",
    "permit",
    (
        Gate("permit", "or", ("pair", "two of three", "no lock", "odd"), description="Permit while overspeeding"),
        Gate("pair", "and", ("a", "b")),
        Gate("two of three", "vote", ("a", "b", LONG), 2),
        Gate("no lock", "not", ("lock",)),
        Gate("odd", "xor", ("pair", "b")),
    ),
    (
        BasicEvent("a", "1.2e-7", source="P"),
        BasicEvent("b", rate_per_hour="1e-6", mission_time_h=1000, source="A", description="Zähler <steht>"),
        BasicEvent(LONG, 0.25),
    ),
    (HouseEvent("lock", True),),
)


def wide(sets):
    events = [BasicEvent(f"e{i:02}", "1e-3", source="PDAR"[i % 4]) for i in range(40)]
    pairs = list(itertools.combinations([event.name for event in events], 2))
    return from_cut_sets("hazard", random.Random(5).sample(pairs, sets), events)


def chain(depth):
    gates = [Gate(f"g{i}", "or" if i % 2 else "and", (f"g{i + 1}", f"e{i}", "shared")) for i in range(depth)]
    gates.append(Gate(f"g{depth}", "or", ("last",)))
    names = ["shared", "last", *(f"e{i}" for i in range(depth))]
    return FaultTree("chain", "g0", tuple(gates), tuple(BasicEvent(name, 0.5) for name in names))


def picture(tree):
    return tree_svg({"structure": to_document(tree), "probability": 0.5})


def texts(svg):
    return [element.text for element in ElementTree.fromstring(svg).iter(f"{SVG}text")]


def boxes(svg):
    """The cards and notes as (left, top, right, bottom)."""
    return [
        (x, y, x + float(rect.get("width")), y + float(rect.get("height")))
        for rect in ElementTree.fromstring(svg).iter(f"{SVG}rect")
        for x, y in [(float(rect.get("x")), float(rect.get("y")))]
    ]


def test_all_names_figures_and_tags_of_a_small_tree_are_drawn():
    svg = picture(SMALL)
    shown = texts(svg)
    joined = "".join(shown)
    for word in (
        "permit",
        "pair",
        "2/3",
        "Q = 1.2×10⁻⁷",
        "λ = 1×10⁻⁶/h",
        "T = 1,000 h",
        "P = 0.5 [A]",
        "P",
        "A",
        "holds",
    ):
        assert word in shown
    assert LONG in joined.replace(" ", "")
    assert "printed figure" in shown and "assumed figure" in shown and "derived figure" not in shown
    assert "drawn elsewhere in this picture" in shown  # the second use of "pair"
    assert "Complete: 5 gates and 3 events" in joined
    assert "Zähler &lt;steht&gt;" in svg


@pytest.mark.parametrize("tree", [SMALL, wide(3), wide(150), chain(6), chain(200)], ids=lambda t: t.name)
def test_no_card_lies_over_another_or_outside(tree):
    svg = picture(tree)
    width, height = map(float, re.search(r'viewBox="0 0 (\S+) (\S+)"', svg).groups())
    found = boxes(svg)
    for left, top, right, bottom in found:
        assert left >= 0 and top >= 0 and right <= width and bottom <= height
    for one, other in itertools.combinations(found, 2):
        assert one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]


def test_what_is_left_out_of_a_wide_tree_is_said():
    joined = " ".join(texts(picture(wide(150))))
    assert f"{150 - INPUTS + 1} more cut sets, not drawn" in joined
    assert "Not complete:" in joined


def test_inputs_that_are_no_cut_sets_are_not_called_so():
    events = tuple(BasicEvent(f"e{i}", 0.5) for i in range(20))
    tree = FaultTree("t", "top", (Gate("top", "and", tuple(e.name for e in events)),), events)
    assert f"{20 - INPUTS + 1} more inputs, not drawn" in " ".join(texts(picture(tree)))


def test_what_is_left_out_of_a_deep_tree_is_said():
    svg = picture(chain(200))
    assert re.search(r"\d+ gates and \d+ events below, not drawn", " ".join(texts(svg)))
    assert len(boxes(svg)) < CARDS[0] + 10


def test_the_same_entry_gives_the_same_picture():
    entry = summary(SMALL)
    assert tree_svg(entry) == tree_svg(dict(entry))


def test_an_entry_without_structure_has_no_picture():
    assert tree_svg({"id": "x"}) == ""


def test_text_is_wrapped_to_the_width_and_complete():
    for text in (LONG, "a b c " * 20, "x" * 100, "速度照査装置の誤り側故障", ""):
        lines = wrapped(text)
        assert "".join(lines).replace(" ", "") == text.replace(" ", "")
        assert all(text_width(line) <= CARD_WIDTH - 2 * PADDING for line in lines)


@pytest.mark.parametrize(
    ("value", "shown"),
    [(0, "0"), (1, "1"), (0.25, "0.25"), (1.2e-7, "1.2×10⁻⁷"), (1e-10, "1×10⁻¹⁰"), (0.0099999, "1×10⁻²")],
)
def test_numbers_are_short(value, shown):
    assert power_of_ten(value) == shown

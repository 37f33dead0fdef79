"""The fault-tree picture: all of the tree is drawn, nothing lies over anything else, transfers lead where they say."""

import itertools
import math
import random
import re
from collections import Counter
from typing import Any
from xml.etree import ElementTree

import pytest

from safety.report import tree_breaks, tree_layout
from safety.report.tree_breaks import NODES, WIDE
from safety.report.tree_shapes import SHAPES
from safety.report.tree_svg import tree_pages, tree_svg
from safety.report.tree_text import power_of_ten
from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent, read, summary, to_document
from safety.trees.importance.events import plain
from safety.trees.importance.gates import importance_of_gates
from tests.oracles import SHARED
from tests.report.drawn_tree import SVG, Picture, problems
from tests.report.drawn_tree import read as read_picture

ARALIA = SHARED / "fault_trees" / "aralia"
LONG = "channel_a.reference_oscillator.frequency_divider.output_stage_stuck_at_zero"
HOSTILE = "\"><script>alert(1)</script>'&<!--\x00 ]]> {{ 7*7 }}"

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


def wide(sets: int) -> FaultTree:
    """A flat tree of so many cut sets of two events."""
    events = tuple(BasicEvent(f"e{i:02}", "1e-3", source="PDAR"[i % 4]) for i in range(40))
    pairs = random.Random(5).sample(list(itertools.combinations([event.name for event in events], 2)), sets)
    gates = [Gate(f"cut set {n}", "and", pair) for n, pair in enumerate(pairs, 1)]
    return FaultTree("hazard", "top", (Gate("top", "or", tuple(gate.name for gate in gates)), *gates), events)


def fan(count: int, kind: str = "or") -> FaultTree:
    events = tuple(BasicEvent(f"e{i}", 0.5) for i in range(count))
    return FaultTree("fan", "top", (Gate("top", kind, tuple(e.name for e in events)),), events)


def chain(depth: int) -> FaultTree:
    gates = [Gate(f"g{i}", "or" if i % 2 else "and", (f"g{i + 1}", f"e{i}", "shared")) for i in range(depth)]
    gates.append(Gate(f"g{depth}", "or", ("last",)))
    names = ["shared", "last", *(f"e{i}" for i in range(depth))]
    return FaultTree("chain", "g0", tuple(gates), tuple(BasicEvent(name, 0.5) for name in names))


def grown(seed: int) -> FaultTree:
    """A tree of shared gates and events at random, with names and descriptions of all lengths."""
    chance = random.Random(seed)
    count = chance.randint(1, 60)
    names = [f"{'gate of some sub-system ' * chance.randint(0, 4)}{i}" for i in range(count)]
    events = [BasicEvent(f"{'x' * chance.choice([1, 30, 90])}{i}", 0.1) for i in range(2 * count)]
    gates = []
    for i, name in enumerate(names):
        later = names[i + 1 :][: chance.randint(1, 30)]
        of_gates = chance.sample(later, min(len(later), chance.randint(0, 4))) + names[i + 1 : i + 2]
        of_events = [event.name for event in chance.sample(events, min(len(events), chance.choice([1, 2, 3, 50])))]
        inputs = list(dict.fromkeys(of_gates + of_events))
        chance.shuffle(inputs)
        gates.append(Gate(name, "or", tuple(inputs), description="what it means " * chance.randint(0, 30)))
    return FaultTree(f"grown {seed}", names[0], tuple(gates), tuple(events))


def entry(tree: FaultTree, **more: Any) -> dict[str, Any]:
    return {"structure": to_document(tree), "probability": 0.5, **more}


def picture(tree: FaultTree) -> Picture:
    return read_picture(tree_svg(entry(tree)))


def gates(tree: FaultTree) -> dict[str, list[str]]:
    return {gate.name: sorted(gate.inputs) for gate in tree.inputs_first}


def texts(svg: str) -> list[str]:
    return [element.text or "" for element in ElementTree.fromstring(svg).iter(f"{SVG}text")]


TREES = [SMALL, wide(3), wide(150), fan(1), fan(WIDE), fan(WIDE + 1), fan(200), chain(6), chain(200)]
TREES += [grown(seed) for seed in range(12)]


@pytest.mark.parametrize("tree", TREES, ids=lambda tree: tree.name)
def test_the_whole_tree_is_drawn_on_small_pages_and_nothing_is_wrong_with_it(tree: FaultTree) -> None:
    drawn = picture(tree)
    assert drawn.gates() == gates(tree)
    assert problems(drawn) == []
    parts = Counter(card.name for card in drawn.cards if card.is_gate)
    assert {name for name, count in parts.items() if count > 1} <= {g.name for g in tree.gates if len(g.inputs) > WIDE}
    by_page = Counter(card.page for card in drawn.cards)
    widest = max(len(card.inputs) for card in drawn.cards)
    assert max(by_page.values()) <= max(NODES, widest + 1) <= WIDE + 1


@pytest.mark.parametrize("name", ["chinese", "baobab1", "isp9605", "das9601"])
def test_a_public_tree_is_drawn_whole(name: str) -> None:
    if not (ARALIA / f"{name}.xml").exists():
        pytest.skip(f"the public trees are not at {ARALIA}; set RIGHTSIDE_ORACLES")
    tree = read(ARALIA / f"{name}.xml")
    drawn = picture(tree)
    assert drawn.gates() == gates(tree)
    assert problems(drawn) == []


@pytest.mark.slow
def test_every_public_tree_is_drawn_whole() -> None:
    files = sorted(ARALIA.glob("*.xml"))
    if not files:
        pytest.skip(f"the public trees are not at {ARALIA}; set RIGHTSIDE_ORACLES")
    for file in files:
        tree = read(file)
        drawn = picture(tree)
        assert drawn.gates() == gates(tree)
        assert problems(drawn) == []


def test_a_tree_without_shared_gates_is_cut_as_rarely_as_possible() -> None:
    """Twelve gates of ten events below one: two fit on a page with the top, two on each other page."""
    events = [BasicEvent(f"e{n}", 0.5) for n in range(120)]
    tens = [Gate(f"g{n}", "and", tuple(e.name for e in events[10 * n : 10 * n + 10])) for n in range(12)]
    tree = FaultTree("t", "top", (Gate("top", "or", tuple(g.name for g in tens)), *tens), tuple(events))
    drawn = picture(tree)
    assert sum(bool(card.href) for card in drawn.cards) == 11
    assert set(drawn.sizes) == {0, 1, 2, 3, 4, 5, 6, 7}  # the index; the top and one gate; two gates on each


PLANTED = {
    "a card moved": (r'(data-n="pair"[^>]* transform="translate\()(\S+)', r"\g<1>9"),
    "a line that ends early": (r'(class="line" d="M[^"]*V)(\d+)"', r'\g<1>3"'),
    "a line to the wrong card": (r'(class="line" d="M\S+ \S+V\S+H)(\S+)V', r"\g<1>5V"),
    "a transfer that leads nowhere": (r'id="ft-g1"', 'id="ft-gone"'),
    "a page named wrongly": (r">page 2<", ">page 3<"),
    "a use not named": (r"; from page 1<", "; from page 3<"),
    "writing that leaves its card": (r'(class="name" x=")74', r"\g<1>140"),
    "a page too small": (r'(<svg class="ft" id="ft-p1".*?viewBox="0 0 )\d+', r"\g<1>300"),
}


@pytest.mark.parametrize("planted", PLANTED)
def test_a_planted_mistake_in_a_picture_is_found(planted: str) -> None:
    names = [f"e{n}" for n in range(30)]
    more = [Gate(f"g{n}", "and", tuple(names[n : n + 15])) for n in range(3)]
    top = Gate("permit", "or", (*SMALL.gates[0].inputs, *(gate.name for gate in more)))
    events = (*SMALL.events, *(BasicEvent(name, 0.5) for name in names))
    svg = tree_svg(entry(FaultTree("t", "permit", (top, *SMALL.gates[1:], *more), events, SMALL.house_events)))
    assert problems(read_picture(svg)) == []
    old, new = PLANTED[planted]
    broken, count = re.subn(old, new, svg, count=1, flags=re.DOTALL)
    assert count == 1 and broken != svg
    assert problems(read_picture(broken)) != []


@pytest.mark.parametrize(("name", "value"), [("BETWEEN", -20), ("LEVEL", 4), ("STACK_GAP", -4), ("SPINE", 10)])
def test_a_planted_mistake_in_the_layout_is_found(monkeypatch: pytest.MonkeyPatch, name: str, value: float) -> None:
    monkeypatch.setattr(tree_layout, name, value)
    assert any(problems(picture(tree)) for tree in (wide(30), chain(6)))


def test_a_gate_drawn_twice_or_not_at_all_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = tree_breaks.pages
    monkeypatch.setattr("safety.report.tree_cards.pages", lambda *of: [*whole(*of), whole(*of)[0]])
    assert picture(SMALL).gates() != gates(SMALL)
    monkeypatch.setattr("safety.report.tree_cards.pages", lambda *of: whole(*of)[:1])
    with pytest.raises(KeyError):
        picture(chain(200))


def test_all_names_figures_and_tags_of_a_small_tree_are_drawn() -> None:
    svg = tree_svg(entry(SMALL))
    shown = texts(svg)
    for word in ("permit", "pair", "2/3", "Q = 1.2×10⁻⁷", "λ = 1×10⁻⁶/h", "P = 0.5 [A]", "P", "A", "holds"):
        assert word in shown
    assert f"<title>{LONG}; Q = 0.25" in svg
    assert "printed figure" in shown and "assumed figure" in shown and "derived figure" not in shown
    assert "drawn elsewhere" in shown  # the second use of "pair"
    said = " ".join(shown)
    assert "Complete: 5 gates and 3 events." in said and "Mission time of every rate: 1,000 h." in said
    assert "Zähler &lt;steht&gt;" in svg


def test_a_long_name_is_cut_on_the_card_and_whole_in_the_title() -> None:
    name = f"{LONG}.{LONG}"
    svg = tree_svg(entry(FaultTree("t", "top", (Gate("top", "or", (name,)),), (BasicEvent(name, 0.5),))))
    assert f"<title>{name}; " in svg
    assert any(text.endswith("…") for text in texts(svg))


def test_an_event_used_several_times_is_marked_wherever_it_is() -> None:
    svg = tree_svg(entry(SMALL))
    assert svg.count("used 3 times</title>") == 3  # b
    assert svg.count("used 2 times</title>") == 2  # a
    assert svg.count('class="ring"') == 5 + 1  # and in the legend


def shape(symbol: str) -> str:
    return f'd="{SHAPES[symbol]}"'


def test_each_kind_of_gate_and_event_has_its_symbol() -> None:
    kinds = ["and", "or", "vote", "xor", "not", "pand", "por", "inhibit", "spare", "seq", "fdep", "pdep"]
    flavors = ["", "undeveloped", "conditional"]
    structure = {
        "name": "t",
        "top": "top",
        "gates": [{"name": "top", "kind": "or", "inputs": [*kinds, "h"]}]
        + [{"name": kind, "kind": kind, "inputs": ["x", "y"], "k": 1 if kind == "vote" else None} for kind in kinds],
        "basic_events": [
            {"name": name, "attributes": {"flavor": flavor}} for name, flavor in zip("xyz", flavors, strict=True)
        ],
        "house_events": [{"name": "h", "state": False}],
    }
    structure["gates"][1]["inputs"] = ["x", "y", "z"]
    structure["gates"][8] |= {"kind": "and", "attributes": {"flavor": "inhibit"}}
    svg = tree_svg({"structure": structure})
    for symbol in ("and", "or", "xor", "not", "inhibit", "house", "event", "undeveloped", "conditional"):
        assert shape(symbol) in svg, symbol
    for word in ("SPARE", "SEQ", "FDEP", "PDEP", "1/2"):
        assert f">{word}</text>" in svg
    assert svg.count('class="mark"') == 4  # pand and por, drawn and explained
    assert svg.count(">1</text>") >= 6  # the order of the inputs of gates to which it matters
    assert problems(read_picture(svg)) == []


def test_dependences_stand_beside_the_tree() -> None:
    structure = {
        "name": "t",
        "top": "top",
        "gates": [
            {"name": "top", "kind": "spare", "inputs": ["pump", "spare pump"]},
            {"name": "power", "kind": "and", "inputs": ["line 1", "line 2"]},
        ],
        "basic_events": [{"name": name} for name in ("pump", "spare pump", "line 1", "line 2")],
        "dependencies": [{"name": "supply", "kind": "fdep", "inputs": ["power", "pump", "spare pump"]}],
        "restrictions": [{"name": "order", "kind": "seq", "inputs": ["line 1", "line 2"]}],
    }
    svg = tree_svg({"structure": structure})
    drawn = read_picture(svg)
    assert problems(drawn) == [] and set(drawn.sizes) == {1}
    assert drawn.gates() == {
        one["name"]: sorted(one["inputs"]) for key in structure for one in structure[key] if "inputs" in one
    }
    assert "Complete: 2 gates and 4 events with 2 dependences." in " ".join(texts(svg))


def test_a_kind_nobody_has_heard_of_is_a_box_with_its_name() -> None:
    structure = {"name": "t", "top": "g", "gates": [{"name": "g", "kind": "quorum", "inputs": ["e"]}]}
    svg = tree_svg({"structure": structure | {"basic_events": [{"name": "e"}]}})
    assert ">QUORUM</text>" in svg and ">quorum</text>" in svg


def test_importance_is_printed_and_told_by_weight() -> None:
    rows = [
        {"event": name, "probability": 0.1, "fussell_vesely": value}
        for name, value in (("e0", 0.6), ("e1", 0.1), ("e2", 0.02), ("e3", 0.001), ("e4", None))
    ]
    svg = tree_svg(entry(fan(5), importance=rows))
    classes = dict(re.findall(r'data-n="(\w+)".*?<g class="(c[^"]*)"', svg))
    assert classes == {"top": "c", "e0": "c r3", "e1": "c r2", "e2": "c r1", "e3": "c", "e4": "c"}
    assert {"Q = 0.1, FV = 0.6", "Q = 0.1, FV = 1×10⁻³", "Q = 0.1"} <= set(texts(svg))
    widths = [float(width) for width in re.findall(r"\.r\d \.card \{ stroke-width: ([\d.]+)", svg)]
    assert widths == sorted(widths) and len(set(widths)) == 3


def test_probabilities_of_gates_are_shown_with_the_mark_of_assumed_inputs() -> None:
    rows = [{"gate": "pair", "probability": 1e-9, "fussell_vesely": 0.25}]
    shown = texts(tree_svg(entry(SMALL, gate_importance=rows)))
    assert {"P = 1×10⁻⁹ [A]", "FV = 0.25 [A]"} <= set(shown)
    assert "[A]: rests on assumed figures." in " ".join(shown)


def test_the_measures_of_gates_are_drawn_as_they_are_found() -> None:
    rows = [plain(measures) for measures in importance_of_gates(SMALL).values()]
    figures = set(", ".join(texts(tree_svg(entry(SMALL, gate_importance=rows)))).split(", "))
    a, b, c = 1.2e-7, -math.expm1(-1e-3), 0.25
    chances = {"pair": a * b, "two of three": a * b + (a + b - 2 * a * b) * c, "odd": b * (1 - a)}
    assert {f"P = {power_of_ten(chance)} [A]" for chance in chances.values()} <= figures
    assert "P = 0" in figures  # "no lock" does not rest on the assumed event


def test_an_assumed_event_without_a_tag_is_marked_at_its_figure() -> None:
    event = BasicEvent("e", 0.5, description="[A] made up")
    shown = texts(
        tree_svg(entry(FaultTree("t", "top", (Gate("top", "or", ("e", "f")),), (event, BasicEvent("f", 0.1)))))
    )
    assert {"Q = 0.5 [A]", "Q = 0.1", "P = 0.5 [A]"} <= set(shown)


def test_bounds_are_rounded_outwards() -> None:
    bounds = {"probability": None, "probability_low": 1.2399e-5, "probability_high": 2.3401e-5}
    shown = texts(tree_svg(entry(fan(2)) | bounds))
    assert {"P ≥ 1.23×10⁻⁵", "P ≤ 2.35×10⁻⁵"} <= set(shown)


def test_the_same_entry_gives_the_same_picture() -> None:
    assert tree_svg(entry(SMALL)) == tree_svg(entry(SMALL))
    assert tree_pages(entry(SMALL)) == [tree_svg(entry(SMALL))]


def test_a_solved_tree_is_drawn_with_its_figures() -> None:
    solved = summary(SMALL)
    figures = set(", ".join(texts(tree_svg(solved))).split(", "))
    assert f"P = {power_of_ten(solved['probability'])} [A]" in figures
    assert {f"FV = {power_of_ten(row['fussell_vesely'])} [A]" for row in solved["importance"]} <= figures


def test_pages_may_stand_alone_or_in_one_document() -> None:
    alone, together = tree_pages(entry(wide(60))), tree_pages(entry(wide(60)), "x", style=False, most=3)
    assert all("<style>" in page for page in alone) and len(alone) > 5
    assert not any("<style>" in page for page in together) and len(together) == 4
    for page in alone:
        ElementTree.fromstring(page)
    joined = "".join(together)
    idents = re.findall(r' id="([^"]*)"', joined)
    assert len(idents) == len(set(idents)) and all(ident.startswith("x-") for ident in idents)
    assert set(re.findall(r'href="#([^"]*)"', joined)) <= set(idents)


def test_hostile_names_are_escaped() -> None:
    tree = FaultTree(
        HOSTILE,
        HOSTILE + "top",
        (Gate(HOSTILE + "top", "or", (HOSTILE, "\n", "x" * 5000, "\u202eabc")),),
        tuple(BasicEvent(name, 0.5, description=HOSTILE) for name in (HOSTILE, "\n", "x" * 5000, "\u202eabc")),
    )
    for svg in (tree_svg(entry(tree)), *tree_pages(entry(tree))):
        whole = ElementTree.fromstring(svg)
        assert {element.tag.removeprefix(SVG) for element in whole.iter()} <= set(
            ["svg", "style", "g", "a", "path", "rect", "text", "title"]
        )
        assert "\x00" not in svg


def test_an_entry_without_structure_has_no_picture() -> None:
    assert tree_svg({"id": "x"}) == ""
    assert tree_pages({"id": "x"}) == []

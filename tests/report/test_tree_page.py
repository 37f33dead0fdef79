"""Fault trees on the page: static without a script, and in a browser folded, searched, zoomed and traced.

The browser runs the page itself; what it is asked to do is put behind the page's own script.
"""

import base64
import hashlib
import json
import os
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from safety.report.html import SCRIPT, TREE_PAGES, html
from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent, to_document

Found = dict[str, Any]
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome", "chrome"))), None)

NAMES = [f"channel {n} fails" for n in range(8)]
TREE = FaultTree(
    "Permit",
    "permit",
    (
        Gate("permit", "or", ("voter", "both", "no lock", *NAMES[:3])),
        Gate("voter", "vote", (*NAMES[:5], "bus"), 2),
        Gate("bus", "and", ("a", "b")),
        Gate("both", "and", ("bus", "c", "many")),
        Gate("no lock", "not", ("lock",)),
        Gate("many", "or", tuple(f"part {n}" for n in range(60))),
    ),
    tuple(BasicEvent(name, 0.01) for name in ("a", "b", "c", *NAMES, *(f"part {n}" for n in range(60)))),
    (HouseEvent("lock", True),),
)


CUT_SETS = [
    [NAMES[0]],
    [NAMES[3], NAMES[4]],
    ["a", "b", NAMES[3]],
    *(["a", "b", "c", f"part {n}"] for n in range(0, 60, 7)),
]


def page(tree: FaultTree) -> str:
    sets = [{"events": events} for events in CUT_SETS]
    solved = {"minimal_cut_sets": {"count": len(sets), "sets": sets}, "structure": to_document(tree)}
    return html({"schema": "rightside/1", "trees": [{"id": tree.name, **solved}]})


class Groups(HTMLParser):
    """The place of every group and the course of every line, in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        kinds = (given.get("class") or "").split()
        if tag in ("g", "a") and {"n", "s", "c"} & set(kinds):
            self.found.append(given.get("transform") or "translate(0 0)")
        elif tag == "path" and "line" in kinds:
            self.found.append(given.get("d") or "")


def test_only_the_script_of_the_trees_may_run() -> None:
    text = page(TREE)
    scripts = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    assert scripts == [SCRIPT]
    digest = base64.b64encode(hashlib.sha256(SCRIPT.encode()).digest()).decode()
    assert f"""content="default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-{digest}'\"""" in text
    assert "<script" not in html({"schema": "rightside/1", "trees": [{"id": "t"}]})


def test_a_script_that_could_end_early_or_reach_out_is_none() -> None:
    assert not re.search(
        r"</script|<!--|https?://(?!www\.w3\.org/2000/svg)|fetch|XMLHttp|innerHTML|eval|import", SCRIPT
    )


def test_without_a_script_all_pages_stand_there() -> None:
    text = page(TREE)
    assert {f'id="trees-Permit-p{n}"' for n in range(5)} <= set(re.findall(r'id="[^"]*-p\d+"', text))
    assert all(f'data-n="{event.name}"' in text for event in TREE.events if event.name in {*NAMES[:5], "part 59"})
    assert "All pages of this tree as one picture: trees/Permit.svg" in text


def test_a_tree_of_many_pages_is_shortened_on_the_page() -> None:
    gates = [Gate(f"g{i}", "or", (f"g{i + 1}", *(f"e{i}.{n}" for n in range(20)))) for i in range(TREE_PAGES + 9)]
    gates.append(Gate(f"g{TREE_PAGES + 9}", "or", ("last",)))
    events = [BasicEvent(name, 1e-6) for gate in gates for name in gate.inputs if not name.startswith("g")]
    text = page(FaultTree("long", "g0", tuple(gates), tuple(events)))
    assert f'id="trees-long-p{TREE_PAGES}"' in text and f'id="trees-long-p{TREE_PAGES + 1}"' not in text
    assert set(re.findall(r'href="#([^"]*)"', text)) <= set(re.findall(r' id="([^"]*)"', text))


# ---- in a browser

HELP = """
const out = {};
const tree = document.querySelector(".tree"), tools = document.querySelector(".tools");
const card = (name, n = 0) => [...tree.querySelectorAll(".n")].filter((one) => one.dataset.n === name)[n];
const seen = (one) => one.getClientRects().length > 0;
const press = (one, key) => one.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
const click = (one) => one.dispatchEvent(new MouseEvent("click", { bubbles: true, cancelable: true }));
const button = (text) => [...tools.querySelectorAll("button")].find((one) => one.textContent === text);
const faces = () => [...tree.querySelectorAll(".card")].filter((one) => seen(one) && one.closest(".n"))
  .map((one) => one.getBoundingClientRect());
const over = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
const overlaps = () => faces().flatMap((a, i, all) => all.slice(i + 1).filter((b) => over(a, b))).length;
const inputs = (one) => [...one.querySelectorAll(":scope > .n, :scope > .s > .n")];
const loose = () => [...tree.querySelectorAll(".n")].filter(seen).flatMap((one) =>
  [...one.querySelectorAll(":scope > .l > path")].filter(seen).filter((line, n) => {
    const end = line.getPointAtLength(line.getTotalLength()).matrixTransform(line.getScreenCTM());
    const box = inputs(one)[n].querySelector(".card").getBoundingClientRect();
    const [left, top] = [Math.abs(end.x - box.left), Math.abs(end.y - box.top)];
    const [across, down] = [Math.abs(end.x - (box.left + box.right) / 2), Math.abs(end.y - (box.top + box.bottom) / 2)];
    return Math.min(left + down, top + across) > 5;
  })).length;
const names = (kind) => [...new Set([...tree.querySelectorAll(kind)].map((one) => one.dataset.n))].sort();
"""

TELL = """
document.querySelector("#out").textContent = JSON.stringify(out);
"""


def browse(text: str, folder: Path, actions: str = "") -> str:
    """The page as it stands in a browser after `actions`, whose findings are in `out`."""
    if BROWSER is None:
        pytest.skip("no Chromium to open the page with: apt-get install chromium")
    if actions:
        text = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", text)
        text = text.replace("</body>", f'<pre id="out"></pre><script>{{{HELP}{actions}{TELL}}}</script></body>')
    file = folder / "page.html"
    file.write_text(text, encoding="utf-8")
    command = [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder / 'profile'}"]
    ran = subprocess.run(
        [*command, "--window-size=1300,900", "--dump-dom", file.as_uri()],
        capture_output=True,
        timeout=120,
        env=os.environ | {"HOME": str(folder)},
    )
    return ran.stdout.decode()


def done(tmp_path: Path, actions: str) -> Found:
    shown = browse(page(TREE), tmp_path, actions)
    told = re.search(r'<pre id="out">(.*?)</pre>', shown, re.DOTALL)
    assert told and told[1], "the script on the page failed"
    found: Found = json.loads(told[1].replace("&amp;", "&").replace("&lt;", "<").replace("&gt;", ">"))
    return found


def test_the_script_runs_and_places_every_card_where_it_stood(tmp_path: Path) -> None:
    static = page(TREE)
    shown = browse(static, tmp_path)
    assert shown.count('class="tools"') == 1
    before, after = (Groups(text).found for text in (static, shown))
    assert len(before) > 150 and before == after


def test_a_script_that_is_not_the_one_of_the_page_does_not_run(tmp_path: Path) -> None:
    assert 'class="tools"' not in browse(page(TREE).replace('"use strict";', '"use strict"; ;', 1), tmp_path)


PLANTED = {
    "cards left where they were": ("column.x = x;", "column.x = 0;"),
    "a vote that needs one more": ("count >= k", "count > k"),
    "a fold that hides nothing": ('toggle("folded", folded)', 'toggle("foled", folded)'),
    "lines left where they were": ('setAttribute("d"', 'setAttribute("data-d"'),
}


@pytest.mark.slow
@pytest.mark.parametrize("planted", PLANTED)
def test_a_planted_mistake_in_the_script_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, planted: str
) -> None:
    assert SCRIPT.count(PLANTED[planted][0]) == 1
    monkeypatch.setattr("safety.report.html.SCRIPT", SCRIPT.replace(*PLANTED[planted]))
    with pytest.raises(AssertionError):
        test_in_a_browser_trees_fold_are_searched_zoomed_and_traced(tmp_path)


def test_in_a_browser_trees_fold_are_searched_zoomed_and_traced(tmp_path: Path) -> None:
    found = done(
        tmp_path,
        """
const place = (one) => one.getAttribute("transform");
const places = () => [...tree.querySelectorAll(".n, .s, .c")].map(place).join();
const before = places();
out.static_overlaps = overlaps();
click(card("voter").querySelector(".c .gate"));
out.folded = [seen(card("voter")), card("voter").getAttribute("aria-expanded"), seen(card("bus"))];
out.badge = card("voter").querySelector(".c").lastElementChild.textContent;
out.folded_overlaps = overlaps();
out.loose = loose();
out.moved = places() !== before;
press(card("voter"), "Enter");
out.unfolded = [seen(card("bus")), places() === before];
click(button("Fold all"));
out.cards_folded = faces().length;
click(button("Unfold all"));
out.restored = places() === before;

press(card("permit"), "ArrowLeft");
out.by_key = card("permit").getAttribute("aria-expanded");
press(card("permit"), "ArrowRight"); press(card("permit"), "ArrowRight");
out.focus = document.activeElement.dataset.n;
press(document.activeElement, "End");
out.last = document.activeElement.dataset.n;
out.stops = tree.querySelectorAll('.n[tabindex="0"]').length;

click(button("Fold all"));
const search = tools.querySelector("input"), said = tools.querySelector("output");
search.value = "PART 5"; search.oninput();
out.search = [said.textContent, names(".hit"), names(".at"), seen(card("part 5"))];
search.onkeydown(new KeyboardEvent("keydown", { key: "Enter" }));
out.next = [said.textContent, names(".at")];
search.value = "nothing like it"; search.oninput();
out.nothing = [said.textContent, names(".hit")];
search.value = ""; search.oninput();

click(button("Fold all"));
const choice = tools.querySelector("select");
out.choices = [...choice.options].map((one) => one.textContent).slice(0, 3);
out.paths = {};
for (const one of [...choice.options].slice(1)) {
  choice.value = one.value;
  choice.onchange();
  out.paths[one.textContent] = names(".n.on");
}
out.path_seen = seen(card("permit"));
out.lines = tree.querySelectorAll(".line.on").length > 0;
choice.value = ""; choice.onchange();
out.no_path = [names(".n.on"), tree.querySelectorAll(".line.on").length];

const width = () => tree.querySelector("svg").getBoundingClientRect().width;
click(button("100 %")); const plain = width();
click(button("+")); out.larger = width() / plain;
press(card("permit"), "-"); out.again = width() / plain;
click(button("Fit")); out.fits = width() <= tree.clientWidth + 1;
press([...tree.querySelectorAll(".n")].find((one) => one.querySelector(":scope > a")), "Enter");
out.followed = document.activeElement.querySelector(":scope > a") === null && !!document.activeElement.id;
""",
    )
    assert found["static_overlaps"] == found["folded_overlaps"] == found["loose"] == 0
    assert found["folded"] == [True, "false", False] and found["badge"] == "+8" and found["moved"]
    assert found["unfolded"] == [True, True] and found["restored"]
    assert found["cards_folded"] == 4  # one for the first card of each page
    assert found["by_key"] == "false" and found["focus"] != "permit" and found["last"] == "part 59"
    assert found["stops"] == 1
    hits = ["part 5", *(f"part {n}" for n in range(50, 60))]
    assert found["search"] == ["1 of 11", hits, ["part 5"], True]
    assert found["next"] == ["2 of 11", ["part 50"]]
    assert found["nothing"] == ["none", []]
    assert found["choices"][:2] == ["none", f"1: {NAMES[0]}"]
    assert found["paths"] == {label: sorted(path(label.partition(": ")[2])) for label in found["paths"]}
    assert len(found["paths"]) == len(CUT_SETS) and found["path_seen"] and found["lines"]
    assert found["no_path"] == [[], 0]
    assert found["larger"] == pytest.approx(1.25) and found["again"] == pytest.approx(1.0) and found["fits"]
    assert found["followed"]


def path(joined: str) -> set[str]:
    """What occurs when the events of a cut set do, as far as the top event comes from it."""
    failed = {event for event in joined.split(" & ")} | {house.name for house in TREE.house_events if house.state}
    counts = {
        "or": lambda gate, count: count > 0, "and": lambda gate, count: count == len(gate.inputs),
        "vote": lambda gate, count: count >= gate.k, "not": lambda gate, count: count == 0,
    }  # fmt: skip
    for gate in TREE.inputs_first:
        if counts[gate.kind](gate, sum(name in failed for name in gate.inputs)):
            failed.add(gate.name)
    met = {TREE.top} & failed
    for gate in reversed(TREE.inputs_first):
        if gate.name in met:
            met |= failed & set(gate.inputs)
    return met

"""A fault-tree picture read back from its SVG: what is drawn where, which tree it shows, and what is wrong with it."""

from __future__ import annotations

import itertools
import re
from collections import defaultdict
from dataclasses import dataclass, field
from xml.etree import ElementTree

from safety.report.tree_layout import CARD_WIDTH, RADIUS, SYMBOL
from safety.report.tree_text import text_width

SVG = "{http://www.w3.org/2000/svg}"
Point = tuple[float, float]
Box = tuple[float, float, float, float]  # left, top, right, bottom
SLACK = 0.01  # px


@dataclass
class Drawn:
    """One card."""

    name: str
    page: int
    ident: str
    box: Box
    symbol: Box  # the room of its symbol
    is_gate: bool
    title: str
    href: str
    rows: list[str]
    texts: list[tuple[str, Point, bool]]  # with the place of its middle, and whether it is bold
    inputs: list[Drawn] = field(default_factory=list)
    lines: list[list[Point]] = field(default_factory=list)  # one for each input


@dataclass
class Picture:
    """All pages of a picture."""

    cards: list[Drawn]
    sizes: dict[int, Point]
    idents: set[str]

    def gates(self) -> dict[str, list[str]]:
        """The tree that is drawn: for each gate its inputs, in order of name."""
        found: defaultdict[str, list[str]] = defaultdict(list)
        for card in self.cards:
            if card.is_gate:
                found[card.name] += [below.name for below in card.inputs if below.name != card.name]
        return {name: sorted(inputs) for name, inputs in found.items()}


def read(svg: str) -> Picture:
    """A picture of one page or of several."""
    whole = ElementTree.fromstring(svg)
    pages = [whole] if whole.find(f"{SVG}svg") is None else whole.findall(f"{SVG}svg")
    picture = Picture([], {}, {found.get("id", "") for found in whole.iter()} - {""})
    for page in pages:
        number = int(page.get("id", "").rpartition("-p")[2])
        left, top, width, height = map(float, page.get("viewBox", "").split())
        assert (left, top) == (0, 0)
        picture.sizes[number] = width, height
        for ground in page.findall(f"{SVG}g[@class='p']"):
            at = _moved(ground, (0, 0))
            for group in ground.findall(f"{SVG}g[@class='n']"):
                _card(group, at, number, picture.cards)
    return picture


def _moved(element: ElementTree.Element, at: Point) -> Point:
    found = re.fullmatch(r"translate\((\S+) (\S+)\)", element.get("transform", "translate(0 0)"))
    assert found
    return at[0] + float(found[1]), at[1] + float(found[2])


def _card(group: ElementTree.Element, above: Point, page: int, cards: list[Drawn], in_stack: bool = False) -> Drawn:
    at = _moved(group, above)
    face = next(child for child in group if child.get("class", "").split()[:1] == ["c"])
    x, y = _moved(face, at)
    rect = face.find(f"{SVG}rect")
    height = float(rect.get("height"))
    middle = x + CARD_WIDTH / 2
    texts = face.findall(f"{SVG}text")
    card = Drawn(
        name=group.get("data-n", ""),
        page=page,
        ident=group.get("id", ""),
        box=(x, y, x + float(rect.get("width")), y + height),
        symbol=(x - 40, y + height / 2 - RADIUS, x - 40 + 2 * RADIUS, y + height / 2 + RADIUS)
        if in_stack
        else (middle - 30, y + height, middle + 68, y + height + SYMBOL),
        is_gate=bool(group.get("data-k")) and group.get("data-k") not in ("true", "false"),
        title=group.findtext(f"{SVG}title") or "",
        href=face.get("href", ""),
        rows=[text.text or "" for text in texts],
        texts=[
            (text.text or "", (x + float(text.get("x")), y + float(text.get("y"))), text.get("class") == "name")
            for text in texts
        ],
    )
    cards.append(card)
    for path in group.findall(f"{SVG}g[@class='l']/{SVG}path"):
        card.lines.append(_points(path.get("d", ""), at))
    for child in group:
        if child.get("class") == "n":
            card.inputs.append(_card(child, at, page, cards))
        elif child.get("class") == "s":
            card.inputs += [_card(inner, _moved(child, at), page, cards, True) for inner in child]
    return card


def _points(path: str, at: Point) -> list[Point]:
    """The corners of a path of M, H and V."""
    points: list[Point] = []
    for letter, numbers in re.findall(r"([MHV])([^MHV]*)", path):
        values = [float(value) for value in numbers.split()]
        if letter == "M":
            points.append((at[0] + values[0], at[1] + values[1]))
        elif letter == "H":
            points.append((at[0] + values[0], points[-1][1]))
        else:
            points.append((points[-1][0], at[1] + values[0]))
    return points


def problems(picture: Picture) -> list[str]:
    """What is wrong with a picture; empty if nothing is."""
    return [*_overlaps(picture), *_writing(picture), *_lines(picture), *_transfers(picture)]


def _apart(one: Box, other: Box) -> bool:
    return (
        one[2] <= other[0] + SLACK
        or other[2] <= one[0] + SLACK
        or one[3] <= other[1] + SLACK
        or other[3] <= one[1] + SLACK
    )


def _overlaps(picture: Picture) -> list[str]:
    found = []
    for page, (width, height) in picture.sizes.items():
        boxes = [
            (f"{what} of {card.name} on page {page}", card, box)
            for card in picture.cards
            if card.page == page
            for what, box in (("card", card.box), ("symbol", card.symbol))
        ]
        for what, _, box in boxes:
            if box[0] < 0 or box[1] < 0 or box[2] > width or box[3] > height:
                found.append(f"{what} lies outside")
        for (what, one, box), (other_what, other, other_box) in itertools.combinations(boxes, 2):
            if one is not other and not _apart(box, other_box):
                found.append(f"{what} lies over {other_what}")
    return found


def _writing(picture: Picture) -> list[str]:
    found = []
    for card in picture.cards:
        for text, (x, y), bold in card.texts:
            half = text_width(text, bold) / 2
            if x - half < card.box[0] or x + half > card.box[2] or y - 11 < card.box[1] or y + 3 > card.box[3]:
                found.append(f"{text!r} leaves the card of {card.name}")
        for (_, one, _), (_, other, _) in itertools.combinations(card.texts, 2):
            if abs(one[1] - other[1]) < 12:
                found.append(f"lines of {card.name} overlap")
    return found


def _lines(picture: Picture) -> list[str]:
    found = []
    for card in picture.cards:
        if len(card.lines) != len(card.inputs):
            found.append(f"{card.name} has {len(card.lines)} lines to {len(card.inputs)} inputs")
        for points, below in zip(card.lines, card.inputs, strict=False):
            left, top, right, bottom = below.box
            ends = ((left + right) / 2, top), (left, (top + bottom) / 2)
            if min(abs(points[-1][0] - x) + abs(points[-1][1] - y) for x, y in ends) > SLACK:
                found.append(f"the line from {card.name} to {below.name} does not end at its card")
            start = (card.box[0] + card.box[2]) / 2, card.box[3]
            if abs(points[0][0] - start[0]) > SLACK or not 40 < points[0][1] - start[1] < SYMBOL:
                found.append(f"the line from {card.name} to {below.name} does not start at its symbol")
            if len(points) > 2 and points[1][1] < start[1] + SYMBOL:
                found.append(f"the line from {card.name} to {below.name} runs through its symbol")
            for one, other in itertools.pairwise(points):
                segment = min(one[0], other[0]), min(one[1], other[1]), max(one[0], other[0]), max(one[1], other[1])
                for crossed in (c for c in picture.cards if c.page == card.page):
                    if not _apart(segment, crossed.box):
                        found.append(f"the line from {card.name} to {below.name} crosses {crossed.name}")
    return found


def _transfers(picture: Picture) -> list[str]:
    found = []
    targets = {card.ident: card for card in picture.cards if card.ident}
    several = len(picture.sizes) > 1
    used: defaultdict[str, set[int]] = defaultdict(set)
    for card in picture.cards:
        if not card.href:
            continue
        target = targets.get(card.href.removeprefix("#"))
        if target is None or target.name != card.name or not target.is_gate:
            found.append(f"the transfer to {card.name} on page {card.page} leads nowhere")
            continue
        used[target.ident].add(card.page)
        if several and f"page {target.page}" not in card.rows:
            found.append(f"the transfer to {card.name} on page {card.page} does not name page {target.page}")
    for ident, target in targets.items():
        said = re.search(r"; from pages? ([\d, ]+)$", target.title)
        named = {int(page) for page in said[1].split(", ")} if said else {target.page}
        if several and named != used[ident]:
            found.append(f"{target.name} on page {target.page} names pages {named}, used on {used[ident]}")
    return found

"""A fault tree as a picture: pages of about 25 cards with a symbol each, and transfers between them.

Every gate is drawn once, every other use of it is a transfer triangle that names the page and leads there; a basic
event is drawn wherever it is used. A tree of several pages begins with an index of them. Nothing is left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape
from typing import Any, NamedTuple

from safety.report.numbers import clean
from safety.report.tree_cards import ALL, Deck
from safety.report.tree_layout import BETWEEN, MARGIN, arrange
from safety.report.tree_legend import index_svg, legend_svg
from safety.report.tree_shapes import STYLE, tree_group
from safety.report.tree_text import LINE

NARROWEST = 560  # px
HEAD = 2 * LINE  # px over a page that is one of several

Entry = Mapping[str, Any]


class Sheet(NamedTuple):
    """One page of a picture: SVG content with its upper left corner at 0, 0."""

    ident: str
    label: str
    width: float  # px
    height: float  # px
    content: str

    def svg(self, place: str = "", style: bool = False) -> str:
        """As an SVG element; `place` are further attributes."""
        return (
            f'<svg class="ft" id="{self.ident}" xmlns="http://www.w3.org/2000/svg"{place} '
            f'viewBox="0 0 {self.width:g} {self.height:g}" width="{self.width:g}" height="{self.height:g}" '
            f'role="group" aria-label="{escape(self.label)}">{_style() if style else ""}{self.content}</svg>'
        )


def tree_svg(tree: Entry) -> str:
    """The picture of one entry of "trees" in a results document as one SVG, its pages below one another.

    Empty if the entry has no "structure". The same entry always gives the same text.
    """
    sheets = _sheets(tree, "ft")
    if len(sheets) < 2:
        return clean("".join(sheet.svg(style=True) for sheet in sheets))
    parts, y = [], 0.0
    for sheet in sheets:
        parts.append(sheet.svg(f' y="{y:g}"'))
        y += sheet.height + BETWEEN
    width = max(sheet.width for sheet in sheets)
    whole = Sheet("ft", sheets[0].label, width, y, "\n".join(["", *parts, ""]))
    return clean(whole.svg(style=True))


def tree_pages(tree: Entry, ident: str = "ft", style: bool = True, most: int = ALL) -> list[str]:
    """The same as one SVG element for each page, those of a tree of several pages after their index.

    `ident` begins all ids, so that several pictures may stand in one document. Without `style` the document brings
    STYLE. Pages after the first `most` are left out, and nothing links to them.
    """
    return [clean(sheet.svg(style=style)) for sheet in _sheets(tree, ident, most)]


def _style() -> str:
    return f"<style>{STYLE}</style>"


def _sheets(tree: Entry, ident: str, most: int = ALL) -> list[Sheet]:
    if not tree.get("structure"):
        return []
    deck = Deck(tree, ident, most)
    placed = [(*arrange(trees), trees) for trees in deck.trees[:most]]
    name, said = f"Fault tree {deck.name}", deck.said()
    if deck.count == 1:
        width, height, trees = placed[0]
        inner = max(width, NARROWEST)
        legend, room = legend_svg(deck, inner)
        content = _at((inner - width) / 2 + MARGIN, MARGIN, map(tree_group, trees), "p")
        content += _at(MARGIN, height + 2 * MARGIN, [legend], "k")
        return [Sheet(f"{ident}-p1", f"{name}. {said}", inner + 2 * MARGIN, height + room + 3 * MARGIN, content)]
    index, inner, height = index_svg(deck)
    legend, room = legend_svg(deck, inner)
    content = _at(MARGIN, MARGIN, [index]) + _at(MARGIN, height + 2 * MARGIN, [legend])
    sheets = [Sheet(f"{ident}-p0", f"{name}. {said}", inner + 2 * MARGIN, height + room + 3 * MARGIN, content)]
    for number, (width, height, trees) in enumerate(placed, 1):
        label = f"Page {number:,} of {deck.count:,}: {name}"
        inner = max(width, NARROWEST)
        head = f'<a href="#{ident}-p0"><text class="start head" y="11">{escape(label)}</text></a>'
        content = _at(MARGIN, MARGIN, [head])
        content += _at((inner - width) / 2 + MARGIN, MARGIN + HEAD, map(tree_group, trees), "p")
        sheets.append(Sheet(f"{ident}-p{number}", label, inner + 2 * MARGIN, height + HEAD + 2 * MARGIN, content))
    return sheets


def _at(x: float, y: float, content: Iterable[str], kind: str = "") -> str:
    classes = f' class="{kind}"' if kind else ""
    return f'<g{classes} transform="translate({x:g} {y:g})">{"".join(content)}</g>'

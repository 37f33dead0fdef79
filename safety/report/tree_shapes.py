"""How the cards of a fault-tree picture look: frames, symbols in the shapes of IEC 61025, the lines between them.

All writing stands on cards with their own ground and all lines are of a middle grey, so that a picture reads on a light
and on a dark page. Colours follow the page's custom properties where it has them. Importance is told by the weight of
the frame and by how dark a symbol is, and is printed, so that it needs no colour.
"""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from safety.report.tree_layout import (
    BAR,
    CARD_WIDTH,
    PADDING,
    RADIUS,
    SPINE,
    Card,
)
from safety.report.tree_text import LETTERS, LINE

STYLE = (
    """
.ft { --ft-ink: var(--ink, #1b1f24); --ft-dim: var(--dim, #59636e); --ft-card: var(--panel, #ffffff);
  --ft-link: var(--link, #0b5c8f); --ft-gate: #dbe9f4; --ft-gate1: #b3d1ea; --ft-gate2: #74a9d3; --ft-gate3: #1f5f94;
  --ft-event: #f6ecd2; --ft-event1: #ecd08a; --ft-event2: #cf9f32; --ft-event3: #855300; --ft-on3: #ffffff; }
@media screen and (prefers-color-scheme: dark) { .ft { --ft-ink: var(--ink, #e6e9ec); --ft-dim: var(--dim, #a4adb6);
  --ft-card: var(--panel, #20252b); --ft-link: var(--link, #7ab8e6); --ft-gate: #1f3a4f; --ft-gate1: #2b587a;
  --ft-gate2: #4183b3; --ft-gate3: #a9d4f5; --ft-event: #3e3216; --ft-event1: #66521f; --ft-event2: #a17d2a;
  --ft-event3: #ffd983; --ft-on3: #14181d; } }
.ft text { font: LETTERSpx system-ui, "Segoe UI", "DejaVu Sans", "Noto Sans CJK JP", Arial, sans-serif;
  fill: var(--ft-ink); text-anchor: middle; }
.ft text.name, .ft text.tag, .ft text.head { font-weight: 600; } .ft text.start { text-anchor: start; }
.ft text.dim { fill: var(--ft-dim); } .ft text.small { font-size: 10px; } .ft a text { fill: var(--ft-link); }
.ft .card { fill: var(--ft-card); stroke: #7d8791; } .ft .r1 .card { stroke-width: 1.8; }
.ft .r2 .card { stroke-width: 2.8; } .ft .r3 .card { stroke-width: 4; } .ft .card.top { stroke-width: 2.2; }
.ft .line { fill: none; stroke: #7d8791; stroke-width: 1.3; shape-rendering: crispEdges; }
.ft .mark { fill: none; stroke: #5f7f99; }
.ft .gate { fill: var(--ft-gate); stroke: #5f7f99; stroke-width: 1.3; stroke-linejoin: round; }
.ft .event { fill: var(--ft-event); stroke: #a08238; stroke-width: 1.3; } .ft .ring { fill: none; stroke: #a08238; }
.ft .way { fill: var(--ft-card); stroke: #5f7f99; stroke-width: 1.3; stroke-linejoin: round; }
.ft .r1 .gate { fill: var(--ft-gate1); } .ft .r2 .gate { fill: var(--ft-gate2); }
.ft .r3 .gate { fill: var(--ft-gate3); } .ft .r1 .event { fill: var(--ft-event1); }
.ft .r2 .event { fill: var(--ft-event2); } .ft .r3 .event { fill: var(--ft-event3); }
.ft .r3 text.tag:not(.small) { fill: var(--ft-on3); } .ft .r3 .ring { stroke: var(--ft-on3); }
.ft :target > .c > .card { stroke: var(--ft-link); stroke-width: 4; }
""".strip()
    .replace("LETTERS", str(LETTERS))
    .replace("\n  ", " ")
)

DOME = "M-22 50V32C-22 18 -12 10 0 10S22 18 22 32V50Z"
ARCH = "M0 10C15 17 22 32 22 52C10 45 -10 45 -22 52C-22 32 -15 17 0 10Z"
BOX = "M-30 14H30V48H-30Z"
OUTWARD = "M50 12L68 36H32Z"  # of a part used elsewhere, beside its symbol
TRIANGLE = "M0 10L22 48H-22Z"
SHAPES = {  # around x = 0, with the stem from y = 0 to 10
    "and": DOME,
    "or": ARCH,
    "vote": ARCH,
    "xor": ARCH + "M-22 57C-10 50 10 50 22 57",
    "not": "M0 17L19 50H-19ZM0 10a3.5 3.5 0 1 0 .01 0Z",
    "pand": DOME,
    "por": ARCH,
    "inhibit": "M-12 10H12L24 30L12 50H-12L-24 30Z",
    "transfer": TRIANGLE,
    "house": "M0 10L20 26V48H-20V26Z",
    "event": "M0 10a20 20 0 1 0 .01 0Z",
    "undeveloped": "M0 8L24 30L0 52L-24 30Z",
    "conditional": "M0 14a28 16 0 1 0 .01 0Z",
}  # what is not here is a box that holds its kind
MARKS = {"pand": "M-22 50L0 17L22 50", "por": "M-20 47L0 17L20 47"}  # the order matters
RINGS = {"event": "M0 14a16 16 0 1 0 .01 0Z", "undeveloped": "M0 13L19 30L0 47L-19 30Z"}  # used several times
FEET = {"or": 47, "vote": 47, "por": 47, "xor": 52, "transfer": 48}  # y at which the line to the inputs begins; else 50
FOOT = 50
LEAVES = {"event", "undeveloped", "conditional", "house"}


def tree_group(card: Card, in_stack: bool = False) -> str:
    """A card with its symbol as a group, which holds the lines to its inputs (one path each) and then their groups."""
    ident = f' id="{card.anchor}"' if card.anchor else ""
    kind = f' data-k="{escape(card.kind)}"' if card.kind else ""
    kind += f' data-of="{card.tag.partition("/")[0]}"' if card.kind == "vote" else ""
    classes = f"c r{card.rank}" if card.rank else "c"
    link = f'a href="#{card.leads_to}"' if card.leads_to else "g"
    inset = f' transform="translate({card.inset:g} 0)"' if card.inset else ""
    lines = f'<g class="l">{"".join(_lines(card))}</g>' if card.columns else ""
    below = "".join(map(_column, card.columns))
    return (
        f'<g class="n"{ident} data-n="{escape(card.name)}"{kind}{_move(card.x, card.y)}>'
        f'<title>{escape(card.title)}</title>{lines}<{link} class="{classes}"{inset}>{_frame(card)}{_writing(card)}'
        f"{_in_stack(card) if in_stack else _below_card(card)}</{link[0]}>{below}</g>"
    )


def _column(column: Card) -> str:
    if not column.is_stack:
        return tree_group(column)
    return f'<g class="s"{_move(column.x, column.y)}>{"".join(tree_group(card, True) for card in column.inputs)}</g>'


def _lines(card: Card) -> Iterator[str]:
    """From the symbol of a gate down to the bar, along it, and on to each input."""
    start = f"M{card.middle:g} {card.height + FEET.get(card.symbol, FOOT):g}"
    number = card.numbered_from
    for column in card.columns:
        x, y = column.x + column.middle, column.y
        for below in column.inputs if column.is_stack else [column]:
            down, across = (y + below.y + below.height / 2, f"H{column.x + below.x:g}") if column.is_stack else (y, "")
            yield f'<path class="line" d="{start}V{y - BAR:g}H{x:g}V{down:g}{across}"/>'
            if number:
                yield f'<text class="small" x="{x + 8:g}" y="{down - (20 if across else 4):g}">{number}</text>'
                number += 1


def _frame(card: Card) -> str:
    kind = "card top" if card.is_top else "card"
    return f'<rect class="{kind}" width="{CARD_WIDTH}" height="{card.height:g}" rx="3"/>'


def _writing(card: Card) -> str:
    return "".join(
        f'<text class="{kind}" x="{CARD_WIDTH / 2:g}" y="{PADDING + LINE * n + 11:g}">{escape(line)}</text>'
        for n, (kind, line) in enumerate(card.rows)
    )


def _below_card(card: Card) -> str:
    """The symbol under the card, and beside it the way to where the gate is used elsewhere."""
    symbol = f'<path class="line" d="M0 0V12"/>{symbol_svg(card.symbol, card.tag, card.uses > 1)}'
    if card.back:
        more = "+" if len(card.back) > 1 else ""
        symbol += f'<path class="line" d="M0 5H50V12"/><path class="way" d="{OUTWARD}"/>'
        symbol += f'<text class="small" x="50" y="31">{card.back[0]}{more}</text>' if card.back[0] else ""
    return f'<g transform="translate({CARD_WIDTH / 2:g} {card.height:g})">{symbol}</g>'


def _in_stack(card: Card) -> str:
    """The symbol on the line to the left of the card."""
    return (
        f'<g transform="translate({RADIUS - SPINE:g} {card.height / 2:g})">'
        f'<g transform="scale(.75) translate(0 -30)">{symbol_svg(card.symbol, "", card.uses > 1)}</g>'
        f"{_inside(card.symbol, card.tag, 4 if card.symbol in LEAVES else 10)}</g>"
    )


def symbol_svg(symbol: str, tag: str = "", repeated: bool = False) -> str:
    """The symbol around x = 0 below y = 0, with what stands in it: source tag, k/n, page of a transfer."""
    kind = "event" if symbol in LEAVES else "way" if symbol == "transfer" else "gate"
    parts = [f'<path class="{kind}" d="{SHAPES.get(symbol, BOX)}"/>']
    if symbol in MARKS:
        parts.append(f'<path class="mark" d="{MARKS[symbol]}"/>')
    if repeated and symbol in RINGS:
        parts.append(f'<path class="ring" d="{RINGS[symbol]}"/>')
    if symbol not in SHAPES:
        tag = tag or symbol.upper()[:6]
    return "".join(parts) + _inside(symbol, tag, 34 if symbol in LEAVES else 36 if symbol not in SHAPES else 42)


def _inside(symbol: str, tag: str, y: float) -> str:
    size = "tag small" if symbol == "transfer" else "tag"
    return f'<text class="{size}" y="{y:g}">{escape(tag)}</text>' if tag else ""


def _move(x: float, y: float) -> str:
    return f' transform="translate({x:g} {y:g})"'

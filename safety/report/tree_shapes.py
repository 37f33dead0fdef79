"""How the parts of a fault-tree picture look: cards, symbols in the shapes of IEC 61025, lines, legend.

All writing stands on cards with their own ground and all lines are of a middle grey, so that a picture reads on a light
and on a dark page. Colours follow the page's custom properties where it has them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from safety.report.tree_layout import (
    BAR,
    CARD_WIDTH,
    LINE,
    PADDING,
    RADIUS,
    SPINE,
    STACK_GAP,
    SYMBOL,
    Card,
    text_height,
    text_width,
    wrapped,
)
from safety.trees.tree import TAGS

STYLE = """
.ft { --ft-ink: var(--ink, #1b1f24); --ft-dim: var(--dim, #59636e); --ft-card: var(--panel, #ffffff);
  --ft-shape: #dbe9f4; --ft-event: #f6ecd2; --ft-note: #8a4b00; }
@media screen and (prefers-color-scheme: dark) { .ft { --ft-ink: var(--ink, #e6e9ec); --ft-dim: var(--dim, #a4adb6);
  --ft-card: var(--panel, #20252b); --ft-shape: #1f4560; --ft-event: #4d3d17; --ft-note: #f0b464; } }
.ft text { font: 11.5px system-ui, "Segoe UI", "DejaVu Sans", "Noto Sans CJK JP", Arial, sans-serif;
  fill: var(--ft-ink); text-anchor: middle; }
.ft text.name, .ft text.tag, .ft text.note { font-weight: 600; } .ft text.start { text-anchor: start; }
.ft text.dim { fill: var(--ft-dim); } .ft text.note { fill: var(--ft-note); }
.ft .card { fill: var(--ft-card); stroke: #7d8791; } .ft .top { stroke-width: 2.2; }
.ft .left-out { fill: var(--ft-card); stroke: #7d8791; stroke-dasharray: 5 4; }
.ft .line { fill: none; stroke: #7d8791; stroke-width: 1.3; }
.ft .gate { fill: var(--ft-shape); stroke: #5f7f99; stroke-width: 1.3; stroke-linejoin: round; }
.ft .event { fill: var(--ft-event); stroke: #a08238; stroke-width: 1.3; } .ft .ring { fill: none; stroke: #a08238; }
""".strip()

OR = "M0 10C15 17 22 32 22 52C10 45 -10 45 -22 52C-22 32 -15 17 0 10Z"
SHAPES = {  # around x = 0, with the stem from y = 0 to 10
    "and": "M-22 50V32C-22 18 -12 10 0 10S22 18 22 32V50Z",
    "or": OR,
    "vote": OR,
    "xor": OR + "M-22 57C-10 50 10 50 22 57",
    "not": "M0 17L19 50H-19ZM0 10a3.5 3.5 0 1 0 .01 0Z",
    "transfer": "M0 10L22 48H-22Z",
    "house": "M0 10L20 26V48H-20V26Z",
}
WORDS = {
    "and": "all inputs",
    "or": "any input",
    "vote": "at least k of n inputs",
    "xor": "odd number of inputs",
    "not": "input absent",
    "event": "basic event",
    "house": "fixed condition",
    "transfer": "drawn elsewhere in this picture",
}


def card_svg(card: Card) -> str:
    """The card with the symbol below it, or the stack with its symbols to the left."""
    if card.stack:
        return _stack(card)
    kind = "left-out" if card.symbol == "cut" else "card" if card.depth else "card top"
    parts = [_title(card), _frame(kind, card.x, card.y, card.height), *_text(card.middle, card.y, card.rows)]
    foot = card.y + card.height
    if card.symbol != "cut":
        parts.append(_at(card.middle, foot, symbol_svg(card.symbol, card.tag, card.vote, card.repeated)))
    if card.rest:
        top = foot + SYMBOL
        parts += [
            f'<path class="line" d="M{card.middle:.1f} {top - 10:.1f}v10"/>',
            _frame("left-out", card.x, top, text_height(card.rest_rows)),
            *_text(card.middle, top, card.rest_rows),
        ]
    return f"<g>{''.join(parts)}</g>"


def _stack(stack: Card) -> str:
    """Event cards below one another, each with its circle on the line that comes from the bar above."""
    parts, y, joint = [], stack.y, stack.y
    for card in stack.stack:
        row = max(card.height, 2 * RADIUS)
        joint = y + row / 2
        left = stack.x + SPINE
        parts.append(_title(card))
        parts.append(f'<path class="line" d="M{stack.middle:.1f} {joint:.1f}H{left:.1f}"/>')
        kind = "left-out" if card.symbol == "cut" else "card"
        parts.append(_frame(kind, left, joint - card.height / 2, card.height))
        parts += _text(left + CARD_WIDTH / 2, joint - card.height / 2, card.rows)
        if card.symbol != "cut":
            symbol = symbol_svg(card.symbol, card.tag, repeated=card.repeated, stem=False)
            scale = RADIUS / 20
            parts.append(
                f'<g transform="translate({stack.middle:.1f} {joint - 30 * scale:.1f}) scale({scale})">{symbol}</g>'
            )
        y += row + STACK_GAP
    spine = f'<path class="line" d="M{stack.middle:.1f} {stack.y - BAR:.1f}V{joint:.1f}"/>'
    return f"<g>{spine}{''.join(parts)}</g>"


def lines_svg(card: Card) -> str:
    """From the symbol of a gate down to the bar, along it, and down to each input."""
    bar = card.inputs[0].y - BAR
    ends = [below.middle for below in card.inputs]
    start = card.y + card.height + SYMBOL / 2  # behind the symbol, which is drawn over it
    along = f"M{min(ends):.1f} {bar:.1f}H{max(ends):.1f}" if len(ends) > 1 else ""
    drops = "".join(f"M{below.middle:.1f} {bar:.1f}V{below.y:.1f}" for below in card.inputs if not below.stack)
    return f'<path class="line" d="M{card.middle:.1f} {start:.1f}V{bar:.1f}{along}{drops}"/>'


def symbol_svg(symbol: str, tag: str = "", vote: str = "", repeated: bool = False, stem: bool = True) -> str:
    """The symbol around x = 0 below y = 0; a basic event holds its source tag, a vote its k/n."""
    parts = ['<path class="line" d="M0 0V12"/>'] if stem else []
    if symbol == "event":
        parts.append('<circle class="event" cy="30" r="20"/>')
        if repeated:
            parts.append('<circle class="ring" cy="30" r="16"/>')
    else:
        parts.append(f'<path class="{"event" if symbol == "house" else "gate"}" d="{SHAPES[symbol]}"/>')
    if tag or vote:
        parts.append(f'<text class="tag" y="{34 if tag else 38}">{escape(tag or vote)}</text>')
    return "".join(parts)


def legend_svg(cards: Sequence[Card], said: str, x: float, y: float, width: float) -> tuple[str, float]:
    """A card that explains the symbols and tags in `cards` and ends with `said`; and its height."""
    shown = [card for outer in cards for card in (outer, *outer.stack)]
    symbols = [symbol for symbol in WORDS if any(card.symbol == symbol for card in shown)]
    items = [(symbol_svg(symbol, vote="k/n" * (symbol == "vote")), WORDS[symbol]) for symbol in symbols]
    if any(card.repeated for card in shown):
        items.append((symbol_svg("event", repeated=True), "event with several uses"))
    tags = [tag for tag in TAGS if tag and any(card.tag == tag for card in shown)]
    items += [(symbol_svg("event", tag), f"{TAGS[tag]} figure") for tag in tags]
    parts, left, top = [], 0.0, 6.0
    for picture, words in items:
        room = 42 + text_width(words) + 14
        if left and left + room > width - 2 * PADDING:
            left, top = 0.0, top + 38
        parts.append(f'<g transform="translate({x + PADDING + left + 16:.1f} {y + top:.1f}) scale(.6)">{picture}</g>')
        parts.append(
            f'<text class="start dim" x="{x + PADDING + left + 36:.1f}" y="{y + top + 22:.1f}">{escape(words)}</text>'
        )
        left += room
    lines = wrapped(said, width=width - 2 * PADDING)
    top += 40
    parts += [
        f'<text class="start" x="{x + PADDING:.1f}" y="{y + top + PADDING + LINE * n:.1f}">{escape(line)}</text>'
        for n, line in enumerate(lines)
    ]
    height = top + PADDING + LINE * len(lines)
    return _frame("card", x, y, height, width) + "".join(parts), height


def _title(card: Card) -> str:
    tag = f"{TAGS[card.tag]} figure" if card.tag else ""
    full = "; ".join(part for part in (card.name, card.description, *card.figures, tag, card.rest) if part)
    return f"<title>{escape(full)}</title>"


def _frame(kind: str, x: float, y: float, height: float, width: float = CARD_WIDTH) -> str:
    return f'<rect class="{kind}" x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" rx="3"/>'


def _at(x: float, y: float, content: str) -> str:
    return f'<g transform="translate({x:.1f} {y:.1f})">{content}</g>'


def _text(middle: float, top: float, rows: Iterable[tuple[str, str]]) -> list[str]:
    return [
        f'<text class="{kind}" x="{middle:.1f}" y="{top + PADDING + LINE * n + 11:.1f}">{escape(line)}</text>'
        for n, (kind, line) in enumerate(rows)
    ]

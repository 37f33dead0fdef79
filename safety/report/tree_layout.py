"""The cards of a fault-tree picture and where they go: levels from the top down, subtrees as close as they fit.

Gates stand in levels. The basic events of one gate stand beside its gates or, to save width, below one another in a
stack that may reach past the levels under it. All lengths are px.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

LETTERS = 11.5  # font size
LINE = 14.5  # from line to line
PADDING = 8  # inside a card
CARD_WIDTH = 138
SYMBOL = 58  # height below a card that its symbol takes
RADIUS = 15  # of a basic event in a stack
SPINE = 40  # left of the cards in a stack, for the line that joins them and their symbols
STACK_GAP = 8  # between the cards in a stack
LEVEL = 30  # between a symbol and the cards below it
BAR = LEVEL / 2  # from the bar over the inputs of a gate down to their cards
BETWEEN = 16  # kept free between neighbours


@dataclass
class Card:
    """One card with its symbol, or a stack of event cards; `x`, `y` is the upper left corner, `depth` the level."""

    name: str
    symbol: str  # a gate kind, "event", "house", "transfer", "cut" (says what is left out) or "stack"
    depth: int
    description: str = ""
    figures: tuple[str, ...] = ()
    tag: str = ""
    vote: str = ""  # "k/n"
    rest: str = ""  # what lies below a gate that is not opened
    repeated: bool = False
    inputs: list[Card] = field(default_factory=list)
    stack: list[Card] = field(default_factory=list)
    x: float = 0.0
    y: float = 0.0

    def subtree(self) -> Iterator[Card]:
        """This card and all below, each before its inputs."""
        yield self
        for below in self.inputs:
            yield from below.subtree()

    @cached_property
    def rows(self) -> list[tuple[str, str]]:
        """The lines of text, each with its class in the style."""
        is_note = self.symbol == "cut"
        rows = [("name", line) for line in wrapped(self.name, bold=True)]
        rows += [("note" if is_note else "dim", line) for line in wrapped(self.description, bold=is_note)]
        return rows + [("figure", line) for line in self.figures]

    @cached_property
    def rest_rows(self) -> list[tuple[str, str]]:
        """The lines of text on what is not drawn below."""
        return [("note", line) for line in wrapped(self.rest, bold=True)]

    @cached_property
    def height(self) -> float:
        """Of the card, or of the whole stack, without a symbol below."""
        if self.stack:
            return sum(max(card.height, 2 * RADIUS) + STACK_GAP for card in self.stack) - STACK_GAP
        return text_height(self.rows)

    @property
    def bottom(self) -> float:
        """The y to which the card and what hangs below it reach."""
        if self.symbol in ("cut", "stack"):
            return self.y + self.height
        return self.y + self.height + SYMBOL + (text_height(self.rest_rows) if self.rest else 0)

    @property
    def middle(self) -> float:
        """The x at which the line from above arrives."""
        return self.x + (RADIUS if self.stack else CARD_WIDTH / 2)


class Box(NamedTuple):
    """A rectangle that something keeps to itself."""

    left: float
    right: float
    top: float
    bottom: float


def stack_events(top: Card) -> None:
    """Put the basic events of each gate, with the note on those left out, into one stack where there are several."""
    for card in top.subtree():
        leaves = [below for below in card.inputs if below.symbol in ("event", "house", "cut")]
        if len(leaves) > 1:
            first = card.inputs.index(leaves[0])
            stack = Card("", "stack", card.depth + 1, stack=leaves)
            card.inputs = [
                *(below for below in card.inputs[:first]),
                stack,
                *(below for below in card.inputs[first:] if below not in leaves),
            ]


def place(top: Card) -> Box:
    """Set `x` and `y` of `top` and of all below it; returns the room that they take."""
    cards = list(top.subtree())
    deepest = max(card.depth for card in cards)
    y = 0.0
    for depth in range(deepest + 1):
        level = [card for card in cards if card.depth == depth]
        for card in level:
            card.x, card.y = 0.0, y
        y = max((card.bottom for card in level if not card.stack), default=y) + LEVEL
    for card in cards:
        if [below.symbol for below in card.inputs] == ["stack"]:  # nothing to be level with
            card.inputs[0].y = card.bottom + BAR
    boxes = _pack(top)
    return Box(
        min(box.left for box in boxes),
        max(box.right for box in boxes),
        min(box.top for box in boxes),
        max(box.bottom for box in boxes),
    )


def _pack(card: Card) -> list[Box]:
    """Set each input right of those before it, as near as their boxes allow, and `card` over their middle."""
    packed: list[Box] = []
    for below in card.inputs:
        boxes = _pack(below)
        overlaps = [
            there.right + BETWEEN - here.left
            for there in packed
            for here in boxes
            if there.top < here.bottom and here.top < there.bottom
        ]
        shift = max(overlaps, default=0.0)
        for moved in below.subtree():
            moved.x += shift
        packed += [Box(box.left + shift, box.right + shift, box.top, box.bottom) for box in boxes]
    if card.inputs:
        card.x = (card.inputs[0].middle + card.inputs[-1].middle - CARD_WIDTH) / 2
    return packed + _own_boxes(card)


def _own_boxes(card: Card) -> list[Box]:
    """The room of the card with its symbol, and of the bar over its inputs."""
    width = CARD_WIDTH + (SPINE if card.stack else 0)
    own = Box(card.x, card.x + width, card.y - (BAR if card.depth else 0), card.bottom)
    if not card.inputs:
        return [own]
    bar = card.inputs[0].y - BAR
    ends = [below.middle for below in card.inputs]
    return [own, Box(min(ends), max(ends), bar - STACK_GAP, bar + STACK_GAP)]


def text_height(rows: list[tuple[str, str]]) -> float:
    """The height of a card with these lines."""
    return len(rows) * LINE + 2 * PADDING


def text_width(text: str, bold: bool = False) -> float:
    """About how wide `text` is, rather too much than too little."""
    ems = 0.0
    for c in text:
        if ord(c) > 0x2E80:  # Chinese, Japanese, Korean
            ems += 1.0
        elif c in "iljtfr.,:;'|![]() /":
            ems += 0.36
        elif c in "mwMW@%":
            ems += 0.9
        else:
            ems += 0.7 if c.isupper() else 0.6
    return ems * LETTERS * (1.08 if bold else 1.0)


def wrapped(text: str, bold: bool = False, width: float = CARD_WIDTH - 2 * PADDING) -> list[str]:
    """`text` in lines of at most `width`: broken at spaces, else after . _ - / : and only then inside a word."""
    lines = [""]
    for word in text.split():
        if lines[-1] and text_width(f"{lines[-1]} {word}", bold) <= width:
            lines[-1] += f" {word}"
            continue
        lines.append("")
        while text_width(word, bold) > width:
            fits = max(n for n in range(1, len(word)) if n == 1 or text_width(word[:n], bold) <= width)
            cut = max((n for n in range(2, fits + 1) if word[n - 1] in "._-/:"), default=fits)
            lines[-1] = word[:cut]
            lines.append("")
            word = word[cut:]
        lines[-1] = word
    return [line for line in lines if line]

"""The cards of a fault-tree picture and where they go. All lengths are px.

Each gate keeps a strip of the page to itself and all below it, so that nothing can overlap: its inputs stand side by
side under it, their strips touching but for a gap. Inputs with nothing below them may instead stand below one another
in stacks, so that a page does not grow too wide.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from safety.report.tree_text import LINE

PADDING = 8  # inside a card
CARD_WIDTH = 148
TEXT_WIDTH = CARD_WIDTH - 2 * PADDING
SYMBOL = 58  # height below a card that its symbol takes
RADIUS = 15  # of a symbol in a stack
SPINE = 40  # left of the cards in a stack, for the line that joins them and their symbols
STACK_GAP = 8  # between the cards in a stack
LEVEL = 30  # between a symbol and the cards below it
BAR = LEVEL / 2  # from the bar over the inputs of a gate down to their cards
BETWEEN = 16  # kept free between neighbours
MARGIN = 14  # around a page
WIDEST = 1160  # aimed at
ROWS = (1, 2, 3, 4, 5, 6, 8, 12, 18, 36)  # heights of stacks that are tried

SIZES = {  # what the script of the report places cards with
    "card": CARD_WIDTH,
    "symbol": SYMBOL,
    "radius": RADIUS,
    "spine": SPINE,
    "level": LEVEL,
    "between": BETWEEN,
    "widest": WIDEST,
    "margin": MARGIN,
}

Row = tuple[str, str]  # a class of the style, and a line of text


@dataclass(slots=True)
class Card:
    """One card with its symbol and the cards of its inputs, or a stack of cards that have none.

    `x`, `y` is the upper left corner of the strip within that of the gate above, `inset` the way from there to the
    card itself.
    """

    name: str
    symbol: str  # a gate kind, "event", "undeveloped", "conditional", "house", "transfer" or "stack"
    rows: Sequence[Row] = ()
    kind: str = ""  # of a gate; of a house event "true" or "false"
    title: str = ""
    about: str = ""  # description, or which inputs of the gate are here
    tag: str = ""  # inside the symbol: where a figure is from, k/n, the page that a transfer leads to
    rank: int = 0  # of the importance, 0 to 3
    uses: int = 1
    is_top: bool = False
    anchor: str = ""  # of a part that transfers lead to
    leads_to: str = ""  # of a transfer: the anchor of that part
    back: tuple[str, ...] = ()  # pages with transfers to this part
    numbered_from: int = 0  # of a gate to which the order of its inputs matters: the number of its first
    inputs: list[Card] = field(default_factory=list)
    columns: list[Card] = field(default_factory=list)  # the inputs as they stand side by side, those in stacks together
    x: float = 0.0
    y: float = 0.0
    inset: float = 0.0
    span: float = 0.0  # width of the strip
    reach: float = 0.0  # height of the strip
    height: float = 0.0  # of the card alone, or of the whole stack

    @property
    def is_stack(self) -> bool:
        """Whether this is no card, but several below one another."""
        return self.symbol == "stack"

    @property
    def middle(self) -> float:
        """The x within the strip at which the line from above arrives."""
        return self.inset + (RADIUS if self.is_stack else CARD_WIDTH / 2)

    @property
    def centre(self) -> float:
        """The x within the strip over which the gate above stands."""
        return self.span / 2 if self.is_stack else self.middle

    def subtree(self) -> Iterator[Card]:
        """This card and all below, each before its inputs, without the stacks."""
        yield self
        for below in self.inputs:
            yield from below.subtree()


def arrange(trees: Sequence[Card]) -> tuple[float, float]:
    """Place the trees of one page, with stacks as low as its width allows; returns width and height of the page."""
    for tree in trees:
        for card in tree.subtree():
            card.height = len(card.rows) * LINE + 2 * PADDING
    for rows in ROWS:
        for tree in trees:
            _place(tree, rows)
        if sum(tree.span + BETWEEN for tree in trees) - BETWEEN <= WIDEST:
            break
    x = y = width = height = 0.0
    for tree in trees:
        if x and x + tree.span > WIDEST:
            x, y = 0.0, height + LEVEL
        tree.x, tree.y = x, y
        x += tree.span + BETWEEN
        width, height = max(width, tree.x + tree.span), max(height, y + tree.reach)
    return width, height


def _place(card: Card, rows: int) -> None:
    """Set the room that `card` takes with all below it, and where in it everything stands."""
    if card.is_stack:
        _stack(card)
        return
    card.columns = _columns(card.inputs, rows)
    card.inset, card.span, card.reach = 0.0, CARD_WIDTH, card.height + SYMBOL
    if not card.columns:
        return
    x, y = 0.0, card.reach + LEVEL
    for column in card.columns:
        _place(column, rows)
        column.x, column.y = x, y
        x += column.span + BETWEEN
        card.reach = max(card.reach, y + column.reach)
    first, last = card.columns[0], card.columns[-1]
    card.inset = (first.x + first.centre + last.x + last.centre - CARD_WIDTH) / 2
    card.span = max(card.inset + CARD_WIDTH, last.x + last.span)


def _columns(inputs: list[Card], rows: int) -> list[Card]:
    """The inputs of a gate; those with nothing below them in stacks of at most `rows`."""
    leaves = [card for card in inputs if not card.inputs]
    if rows == 1 or len(leaves) < 2:
        return inputs
    size = -(-len(leaves) // -(-len(leaves) // rows))  # of about equal height
    stacks = [Card("", "stack", inputs=leaves[n : n + size]) for n in range(0, len(leaves), size)]
    first = inputs.index(leaves[0])
    gates = [card for card in inputs if card.inputs]
    return [*gates[:first], *stacks, *gates[first:]]


def _stack(stack: Card) -> None:
    y = 0.0
    for card in stack.inputs:
        row = max(card.height, 2 * RADIUS)
        card.x, card.y, card.inset = SPINE, y + (row - card.height) / 2, 0.0
        y += row + STACK_GAP
    stack.span, stack.reach = SPINE + CARD_WIDTH, y - STACK_GAP

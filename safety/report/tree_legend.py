"""What explains a fault-tree picture: the card with its symbols, marks and letters, and the index of its pages."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from html import escape

from safety.report.tree_cards import RANKS, Deck, counted
from safety.report.tree_layout import BETWEEN, LEVEL, PADDING, WIDEST, Card
from safety.report.tree_shapes import symbol_svg
from safety.report.tree_text import LINE, clipped, text_width, wrapped
from safety.trees.tree import TAGS

WORDS = {
    "and": "all inputs",
    "or": "any input",
    "vote": "at least k of n inputs",
    "xor": "odd number of inputs",
    "not": "input absent",
    "pand": "all inputs, in order",
    "por": "the first input before any other",
    "inhibit": "all inputs, the condition among them",
    "spare": "all inputs, each a spare of those before",
    "seq": "inputs only in order",
    "mutex": "at most one of the inputs",
    "fdep": "the first input brings the others about",
    "pdep": "the first input may bring the others about",
    "event": "basic event",
    "undeveloped": "event not developed further",
    "conditional": "condition",
    "house": "fixed condition",
    "transfer": "drawn elsewhere",
}
LETTERS = {
    "P": "probability of a gate's event",
    "Q": "probability of a basic event",
    "λ": "failure rate",
    "T": "mission time",
    "F": "Fussell-Vesely importance",
}
INDENT, DEEPEST = 14, 12  # px for each page on the way from the first, and how many are shown


def legend_svg(deck: Deck, width: float) -> tuple[str, float]:
    """A card that explains what is drawn and says how much it is; and its height, px."""
    x, y = 0.0, 6.0
    parts = []
    for symbol, words in _symbols(deck):
        room = 46 + text_width(words) + 14
        if x and x + room > width - 2 * PADDING:
            x, y = 0.0, y + 38
        parts.append(f'<g transform="translate({PADDING + x + 19:.1f} {y:g}) scale(.6)">{symbol}</g>')
        parts.append(f'<text class="start dim" x="{PADDING + x + 43:.1f}" y="{y + 22:g}">{escape(words)}</text>')
        x += room
    y += 38 + PADDING
    for line in wrapped(" ".join((deck.said(), *_sentences(deck))), width - 2 * PADDING):
        parts.append(f'<text class="start" x="{PADDING}" y="{y + 11:g}">{escape(line)}</text>')
        y += LINE
    height = y + PADDING
    return f'<rect class="card" width="{width:g}" height="{height:g}" rx="3"/>{"".join(parts)}', height


def index_svg(deck: Deck) -> tuple[str, float, float]:
    """The list of the pages, each with its gates and indented below the page that first leads to it.

    Returns the content and its width and height, px.
    """
    lines = list(_index_lines(deck))
    columns = 1 if len(lines) <= 30 else 2 if len(lines) <= 80 else 3
    rows = -(-len(lines) // columns)
    room = (WIDEST - (columns - 1) * LEVEL) / columns
    parts = [f'<text class="start head" y="11">{escape(f"Fault tree {deck.name}: pages")}</text>']
    for n, (page, depth, words) in enumerate(lines):
        x = (n // rows) * (room + LEVEL)
        indent = min(depth, DEEPEST) * INDENT
        y = (n % rows + 2) * (LINE + 4) + 11
        line = clipped(words, room - indent - 40, 1)[0]
        link = f'a href="#{deck.ident}-p{page}"' if page <= deck.most else "g"
        parts.append(
            f"<{link}><title>{escape(words)}</title>"
            f'<text class="start head" x="{x + indent:.1f}" y="{y:g}">{page}</text>'
            f'<text class="start" x="{x + indent + 36:.1f}" y="{y:g}">{escape(line)}</text></{link[0]}>'
        )
    return "".join(parts), WIDEST, (rows + 2) * (LINE + 4) + BETWEEN


def _index_lines(deck: Deck) -> Iterator[tuple[int, int, str]]:
    depths = {1: 0}
    for number, trees in enumerate(deck.trees, 1):
        depth = depths.setdefault(number, 1)
        cards = [card for tree in trees for card in tree.subtree()]
        for card in cards:
            if card.symbol == "transfer":
                depths.setdefault(int(card.tag), depth + 1)
        sorts = [
            sum(card.name in names for card in cards if card.symbol != "transfer")
            for names in (deck.gates, deck.events)
        ]
        names = "; ".join(f"{tree.name} ({tree.about})" if tree.about else tree.name for tree in trees)
        yield number, depth, f"{names}: {counted(sorts[0], 'gate')}, {counted(sorts[1], 'event')}"


def _cards(deck: Deck) -> Iterator[Card]:
    return (card for trees in deck.trees for tree in trees for card in tree.subtree())


def _symbols(deck: Deck) -> Iterator[tuple[str, str]]:
    """Each symbol that occurs, with what it means."""
    cards = list(_cards(deck))
    met = {card.symbol for card in cards}
    for symbol in (*WORDS, *sorted(met - WORDS.keys())):
        if symbol in met:
            words = WORDS.get(symbol, symbol)
            if symbol == "transfer" and deck.count > 1:
                words += ", on the page named; beside a gate: used on the page named"
            yield symbol_svg(symbol, "k/n" * (symbol == "vote")), words
    if any(card.uses > 1 for card in cards):
        yield symbol_svg("event", repeated=True), "event with several uses"
    tags = {card.tag for card in cards if card.name in deck.events}
    for tag in TAGS:
        if tag and tag in tags:
            yield symbol_svg("event", tag), f"{TAGS[tag]} figure"


def _sentences(deck: Deck) -> Iterator[str]:
    """What the letters in front of the figures mean, as far as they occur."""
    letters = {line[0] for card in _cards(deck) for kind, line in card.rows if kind == "figure"}
    letters |= {"F"} if any(deck.importance(name) is not None for name in deck.met) else set()
    said = [f"{'FV' if letter == 'F' else letter}: {words}" for letter, words in LETTERS.items() if letter in letters]
    if said:
        yield "; ".join(said) + "."
    if "λ" in letters and deck.common_time is not None:
        yield f"Mission time of every rate: {float(Fraction(deck.common_time)):,g} h."
    if "F" in letters:
        yield f"Frames and symbols are stronger from FV = {', '.join(map(str, sorted(RANKS)))} on."
    if deck.mark:
        yield f"{deck.mark.strip()}: rests on assumed figures."

"""A fault tree as a picture: one card and one symbol for each gate and event, in own layered layout.

A gate used more than once is drawn once and elsewhere shown by a transfer triangle; a basic event is drawn wherever it
is used. Wide gates and large trees are cut off, and each cut says in the picture how much it leaves out.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable, Mapping
from html import escape
from typing import Any

from safety.report.assumed import mark, rests_on_assumed
from safety.report.tree_layout import Card, place, stack_events
from safety.report.tree_shapes import STYLE, card_svg, legend_svg, lines_svg
from safety.trees.tree import BasicEvent

INPUTS = 10  # drawn of one gate
CARDS = (60, 45, 34, 25)  # drawn of one tree, after which no gate is opened any more: the most that keep within WIDEST
MARGIN = 14  # px around everything
NARROW, WIDE, WIDEST = 560, 1100, 1900  # px: least width, that from which events are stacked, and that aimed at
LETTERS = {
    "P": "probability of the top event",
    "Q": "probability of a basic event",
    "λ": "failure rate",
    "T": "mission time",
}

Entry = Mapping[str, Any]


def tree_svg(tree: Entry) -> str:
    """The picture of one entry of "trees" in a results document, as an SVG element; empty if it has no "structure".

    The same entry always gives the same text.
    """
    structure = tree.get("structure")
    if not structure:
        return ""
    for limit in CARDS:
        plan = _Plan(structure, tree.get("probability"), limit, mark(rests_on_assumed("trees", tree)))
        room = place(plan.top)
        if room.right - room.left > WIDE:
            stack_events(plan.top)
            room = place(plan.top)
        if room.right - room.left <= WIDEST:
            break
    cards = list(plan.top.subtree())
    width = max(room.right - room.left, NARROW) + 2 * MARGIN
    for card in cards:
        card.x += (width - room.left - room.right) / 2
        card.y += MARGIN
    end = room.bottom + 2 * MARGIN
    legend, legend_height = legend_svg(cards, f"{plan.said()} {_letters(cards)}", MARGIN, end, width - 2 * MARGIN)
    height = end + legend_height + MARGIN
    label = escape(f"Fault tree {structure['name']}. {plan.said()}")
    return "\n".join(
        [
            f'<svg class="ft" xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" '
            f'width="{width:.0f}" height="{height:.0f}" role="img" aria-label="{label}">',
            f"<style>{STYLE}</style>",
            *(lines_svg(card) for card in cards if card.inputs),
            *(card_svg(card) for card in cards),
            legend,
            "</svg>",
        ]
    )


class _Plan:
    """Which cards are drawn: gates are opened breadth first until the cards run out."""

    def __init__(self, structure: Entry, probability: Any, limit: int, mark: str) -> None:
        self.gates = {gate["name"]: gate for gate in structure["gates"]}
        self.named = {name for name, gate in self.gates.items() if not gate.get("inside")}
        self.events = {event["name"]: event for event in structure.get("basic_events", ())}
        self.houses = {house["name"]: house for house in structure.get("house_events", ())}
        self.uses = Counter(name for gate in self.gates.values() for name in gate["inputs"])
        self.drawn: set[str] = set()
        self.top = self._card(structure["top"], 0)
        if isinstance(probability, int | float):
            self.top.figures = (f"P = {power_of_ten(probability)}{mark}",)
        self._open(self.top, limit)

    def _open(self, top: Card, limit: int) -> None:
        count, agenda = 1, deque([top])
        while agenda:
            card = agenda.popleft()
            if card.symbol in ("event", "house", "transfer"):
                continue
            inputs = self.gates[card.name]["inputs"]
            shown = inputs if len(inputs) <= INPUTS else inputs[: INPUTS - 1]
            if card is not top and count + len(shown) > limit:
                card.rest = f"{self._counted(self._below(card.name) - {card.name})} below, not drawn"
                continue
            card.inputs = [self._card(name, card.depth + 1) for name in shown]
            count += len(shown)
            agenda.extend(card.inputs)
            if hidden := inputs[len(shown) :]:
                noun = "cut sets" if self._are_cut_sets(card, hidden) else "inputs"
                card.inputs.append(Card("", "cut", card.depth + 1, f"{len(hidden)} more {noun}, not drawn"))

    def _card(self, name: str, depth: int) -> Card:
        if name in self.events:
            self.drawn.add(name)
            event = self.events[name]
            card = Card(name, "event", depth, event.get("description", ""), _figures(event), event.get("source", ""))
            card.repeated = self.uses[name] > 1
            return card
        if name in self.houses:
            house = self.houses[name]
            return Card(
                name, "house", depth, house.get("description", ""), ("holds" if house["state"] else "does not hold",)
            )
        gate = self.gates[name]
        description = gate.get("description", "")
        if name in self.drawn:
            return Card(name, "transfer", depth, description)
        self.drawn.add(name)
        vote = f"{gate.get('k')}/{len(gate['inputs'])}" if gate["kind"] == "vote" else ""
        return Card(name, gate["kind"], depth, description, vote=vote)

    def _are_cut_sets(self, card: Card, inputs: Iterable[str]) -> bool:
        """Whether each input of an "or" at the top is an event or an "and" of events."""
        above = self.gates[self.top.name]
        if card.symbol != "or" or not (card is self.top or (above["kind"] == "or" and card.name in above["inputs"])):
            return False
        kinds = {name: self.gates[name]["kind"] for name in inputs if name in self.gates}
        return all(
            name in self.events or (kinds.get(name) == "and" and set(self.gates[name]["inputs"]) <= self.events.keys())
            for name in inputs
        )

    def _below(self, name: str) -> set[str]:
        met: set[str] = set()
        agenda = [name]
        while agenda:
            name = agenda.pop()
            if name not in met:
                met.add(name)
                agenda.extend(self.gates[name]["inputs"] if name in self.gates else ())
        return met

    def _counted(self, names: set[str]) -> str:
        sorts = ((self.named, "gate"), (self.events.keys(), "event"), (self.houses.keys(), "condition"))
        counts = [(len(names & of_sort), noun) for of_sort, noun in sorts]
        return " and ".join(f"{count:,} {noun}{'s' * (count != 1)}" for count, noun in counts if count)

    def said(self) -> str:
        """One sentence on how much of the tree is in the picture."""
        reached = self._below(self.top.name)
        gates, events = reached & self.named, reached & self.events.keys()
        if reached - self.houses.keys() <= self.drawn:
            return f"Complete: {self._counted(gates | events)}."
        return (
            f"Not complete: {len(gates & self.drawn):,} of {len(gates):,} gates and "
            f"{len(events & self.drawn):,} of {len(events):,} events are drawn."
        )


def _figures(event: Entry) -> tuple[str, ...]:
    """Probability, rate and mission time of a basic event, as far as they are known."""
    basic = BasicEvent(**event)
    figures = [] if basic.chance is None else [f"Q = {power_of_ten(basic.chance[0])}"]
    if basic.rate_per_hour is not None:
        figures.append(f"λ = {power_of_ten(float(basic.rate_per_hour))}/h")
        if basic.mission_time_h is not None:
            figures.append(f"T = {float(basic.mission_time_h):,g} h")
    return tuple(figures)


def _letters(cards: Iterable[Card]) -> str:
    """What the letters in front of the figures mean, as far as they occur."""
    used = {figure[0] for outer in cards for card in (outer, *outer.stack) for figure in card.figures}
    return "; ".join(f"{letter}: {meaning}" for letter, meaning in LETTERS.items() if letter in used)


def power_of_ten(value: float) -> str:
    """At most three digits: 0.25, 1.2×10⁻⁷."""
    if value == 0 or 0.01 <= value < 10_000:
        return f"{value:.3g}"
    mantissa, exponent = f"{value:.2e}".split("e")
    raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{mantissa.rstrip('0').rstrip('.')}×10{raised}"

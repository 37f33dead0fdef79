"""What is written on the cards of a fault-tree picture: names, figures with their marks, where transfers lead."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from typing import Any

from safety.report.assumed import assumed_events, mark
from safety.report.tree_breaks import Branch, Page, pages
from safety.report.tree_layout import TEXT_WIDTH, Card, Row
from safety.report.tree_text import clipped, power_of_ten, text_width
from safety.trees.tree import TAGS, BasicEvent

RANKS = (0.5, 0.1, 0.01)  # least Fussell-Vesely importance of what is drawn boldest, bolder, bold
BESIDE = ("dependencies", "restrictions")  # of a dynamic tree: drawn as trees of their own
NUMBERED = {"pand", "por", "seq", "spare", "fdep", "pdep"}  # kinds of gates to which the order of their inputs matters
NUMBERS = ("probability", "rate_per_hour", "mission_time_h")  # of a basic event
NAME_LINES, TEXT_LINES, TOP_LINES = 3, 2, 8  # at most, on one card
ALL = 10**9  # pages
Entry = Mapping[str, Any]


class Deck:
    """All cards of one entry of "trees", by page; only the first `most` pages can be linked to.

    `trees[p]` are the cards side by side on page p + 1. Raises what a structure that is none leads to: KeyError,
    TypeError, ValueError.
    """

    def __init__(self, entry: Entry, ident: str, most: int = ALL) -> None:
        structure = entry["structure"]
        self.name = structure["name"]
        self.ident, self.most = ident, most
        self.beside: list[Entry] = [one for key in BESIDE for one in structure.get(key, ())]
        self.gates: dict[str, Entry] = {gate["name"]: gate for gate in (*structure["gates"], *self.beside)}
        self.events: dict[str, Entry] = {event["name"]: event for event in structure.get("basic_events", ())}
        self.houses: dict[str, Entry] = {house["name"]: house for house in structure.get("house_events", ())}
        self.top = structure["top"]
        self.entry = entry
        self.assumed = self._resting_on(assumed_events(entry))
        self.mark = mark(bool(self.assumed))
        self.measured: dict[str, Entry] = {row["event"]: row for row in entry.get("importance") or ()}
        self.measured |= {row["gate"]: row for row in entry.get("gate_importance") or ()}
        times = {event.get("mission_time_h") for event in self.events.values() if event.get("rate_per_hour")}
        self.common_time = times.pop() if len(times) == 1 else None  # hours, of all events with a rate
        tops = [self.top, *(one["name"] for one in self.beside)]
        plan = pages(tops, {name: gate["inputs"] for name, gate in self.gates.items()})
        self.count = len(plan)
        self.met = {branch.name for page in plan for root in page for branch in root.subtree()}
        self.uses = Counter(name for gate in self.gates.values() if gate["name"] in self.met for name in gate["inputs"])
        self._find_transfers(plan)
        self.trees = [[self._tree(root, number) for root in page] for number, page in enumerate(plan, 1)]

    def _resting_on(self, events: set[str]) -> set[str]:
        """The given events and the gates to which they contribute."""
        users: defaultdict[str, list[str]] = defaultdict(list)
        for gate in self.gates.values():
            for name in gate["inputs"]:
                users[name].append(gate["name"])
        agenda = [*events]
        met = set(events)
        for name in agenda:
            above = [one for one in users[name] if one not in met]
            met.update(above)
            agenda += above
        return met

    def _find_transfers(self, plan: Sequence[Page]) -> None:
        """On which page each part of a gate is, and from which pages transfers lead to it."""
        self.page_of: dict[tuple[str, int], int] = {}
        self.back: defaultdict[tuple[str, int], dict[int, None]] = defaultdict(dict)
        for number, page in enumerate(plan, 1):
            for root in page:
                for branch in root.subtree():
                    if branch.is_transfer:
                        self.back[branch.key][number] = None
                    elif branch.name in self.gates:
                        self.page_of[branch.key] = number
        self.anchors = {key: f"{self.ident}-g{n}" for n, key in enumerate(self.back, 1)}

    def _tree(self, branch: Branch, page: int) -> Card:
        card = self._card(branch, page)
        card.inputs = [self._tree(below, page) for below in branch.inputs]
        return card

    def _card(self, branch: Branch, page: int) -> Card:
        if branch.name in self.events:
            return self._event(self.events[branch.name])
        if branch.name in self.houses:
            house = self.houses[branch.name]
            card = self._written(house, "house", ["holds" if house["state"] else "does not hold"])
            card.kind = "true" if house["state"] else "false"
            return card
        gate = self.gates[branch.name]
        if branch.is_transfer:
            return self._transfer(gate, branch)
        part = notes = self._part(gate, branch)
        back = tuple(map(str, self.back.get(branch.key, ())))
        if back and back != (str(page),):
            notes = [*part, f"from page{'s' * (len(back) > 1)} {', '.join(back)}"]
        symbol = "inhibit" if (gate["kind"], _flavor(gate)) == ("and", "inhibit") else gate["kind"]
        card = self._written(gate, symbol, self._figures(gate["name"]), notes, is_top=branch.key == (self.top, 0))
        card.kind, card.back = gate["kind"], back
        card.about = part[0] if part else card.about
        card.anchor = self.anchors.get(branch.key, "")
        if gate.get("k") is not None:
            card.tag = f"{gate['k']}/{len(gate['inputs'])}"
        if gate["kind"] in NUMBERED:
            card.numbered_from = branch.first + 1
        return card

    def _transfer(self, gate: Entry, branch: Branch) -> Card:
        page = self.page_of[branch.key]
        notes = [] if self.count == 1 else [f"page {page}"]
        if branch.first:
            notes = [f"inputs from {branch.first + 1} on", *notes]
        card = self._written({"name": gate["name"]}, "transfer", self._figures(gate["name"]), notes)
        card.tag = "" if self.count == 1 else str(page)
        card.leads_to = self.anchors[branch.key] if page <= self.most else ""
        return card

    def _part(self, gate: Entry, branch: Branch) -> list[str]:
        count = len(gate["inputs"])
        if (branch.first, branch.last) == (0, count):
            return []
        return [f"inputs {branch.first + 1:,} to {branch.last:,} of {count:,}"]

    def _event(self, event: Entry) -> Card:
        figures = self._figures(event["name"], event)
        if event.get("rate_per_hour") is not None:
            figures.append(f"λ = {power_of_ten(float(Fraction(event['rate_per_hour'])))}/h")
            if event.get("mission_time_h") is not None and self.common_time is None:
                figures.append(f"T = {float(Fraction(event['mission_time_h'])):,g} h")
        flavor = _flavor(event)
        card = self._written(event, flavor if flavor in ("undeveloped", "conditional") else "event", figures)
        card.tag = event.get("source", "")
        card.uses = self.uses[event["name"]]
        card.title = "; ".join(
            part
            for part in (
                card.title,
                f"{TAGS[card.tag]} figure" if card.tag else "",
                f"used {card.uses} times" if card.uses > 1 else "",
            )
            if part
        )
        return card

    def _figures(self, name: str, event: Entry | None = None) -> list[str]:
        """Probability and importance of a gate or event, as far as they are known."""
        row = self.measured.get(name, {})
        probability = row.get("probability")
        figures = []
        if name == self.top:
            figures += self._top_figures()
        elif event is not None:
            if probability is None:
                numbers = {key: event[key] for key in NUMBERS if key in event}
                probability = (BasicEvent(name, **numbers).chance or (None,))[0]
            untold = name in self.assumed and event.get("source") != "A"  # else it stands in the symbol
            figures += [] if probability is None else [f"Q = {power_of_ten(probability)}{mark(untold)}"]
        elif probability is not None:
            figures.append(f"P = {power_of_ten(probability)}{mark(name in self.assumed)}")
        importance = self.importance(name)
        if importance is not None:
            figures.append(f"FV = {power_of_ten(importance)}{self.mark}")
        return figures

    def _top_figures(self) -> list[str]:
        """The probability of the top event, or the bounds of it: 3 digits, rounded outwards."""
        probability = self.entry.get("probability")
        if isinstance(probability, int | float):
            return [f"P = {power_of_ten(probability)}{self.mark}"]
        bounds = (("≥", "probability_low", ROUND_FLOOR), ("≤", "probability_high", ROUND_CEILING))
        return [
            f"P {sign} {power_of_ten(float(Context(3, rounding).create_decimal(Decimal(bound))))}{self.mark}"
            for sign, key, rounding in bounds
            if isinstance(bound := self.entry.get(key), int | float)
        ]

    def importance(self, name: str) -> float | None:
        """The Fussell-Vesely importance of a gate or event, if known; the top itself has none."""
        value = None if name == self.top else self.measured.get(name, {}).get("fussell_vesely")
        return value if isinstance(value, int | float) else None

    def _written(
        self,
        node: Entry,
        symbol: str,
        figures: Sequence[str] = (),
        notes: Sequence[str] = (),
        is_top: bool = False,
    ) -> Card:
        """A card with the name, description and figures of a node; what does not fit is in its title."""
        name, description = node["name"], node.get("description", "")
        rows: list[Row] = [("name", line) for line in clipped(name, TEXT_WIDTH, NAME_LINES, bold=True)]
        rows += [("dim", line) for line in clipped(description, TEXT_WIDTH, TOP_LINES if is_top else TEXT_LINES)]
        rows += [("figure", line) for line in _paired(figures)]
        rows += [("dim", line) for note in notes for line in clipped(note, TEXT_WIDTH, TEXT_LINES)]
        importance = self.importance(name) or 0.0
        return Card(
            name,
            symbol,
            rows,
            title="; ".join(part for part in (name, description, *figures, *notes) if part),
            about=description,
            rank=sum(importance >= least for least in RANKS),
            is_top=is_top,
        )

    def said(self) -> str:
        """One sentence on the size of the tree."""
        named = [name for name, gate in self.gates.items() if name in self.met and not gate.get("inside")]
        events = self.met & self.events.keys()
        size = f"{counted(len(named) - len(self.beside), 'gate')} and {counted(len(events), 'event')}"
        size += f" with {counted(len(self.beside), 'dependence')}" if self.beside else ""
        return f"Complete: {size}." if self.count == 1 else f"Complete: {size} on {self.count:,} pages."


def _flavor(node: Entry) -> str:
    """What a gate or event is besides its kind, in the words of Open-PSA MEF: undeveloped, conditional, inhibit."""
    return str((node.get("attributes") or {}).get("flavor", ""))


def counted(count: int, noun: str) -> str:
    """1 gate, 2 gates."""
    return f"{count:,} {noun}{'s' * (count != 1)}"


def _paired(figures: Sequence[str]) -> list[str]:
    """Figures in lines, two on a line where they fit."""
    lines: list[str] = []
    for figure in figures:
        if lines and text_width(f"{lines[-1]}, {figure}") <= TEXT_WIDTH:
            lines[-1] += f", {figure}"
        else:
            lines.append(figure)
    return lines

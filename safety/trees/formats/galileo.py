"""Galileo text (.dft), the common form of dynamic fault trees: reader and writer.

A statement ends with ";", lines come in any order, names may stand in quotes, // and /* */ are comments.

    toplevel "System";                      "Pumps" 2of3 "P1" "P2" "P3";        "Cut" fdep "Bus" "P1" "P2";
    "System" or "Pumps" "Late";             "Late" pand "Alarm" "Fire";         "Maybe" pdep=0.2 "Bus" "P3";
    "P1" lambda=1e-4 dorm=0.5;              "Alarm" prob=0.01;                  "Line" seq "P1" "P2";

Gates: and, or, KofN (also votK), pand, por (-inc and -excl), wsp, csp, hsp, spare, inhibit. Then fdep, pdep=p, seq,
mutex, whose own output is a dummy: as an input of a gate it is left out, as Storm does. A top that is an event gets a
gate of its own. Rates are per hour. `dorm` is 1 unless said, but 0 for what a csp keeps in reserve. What the project
cannot solve (repair, Weibull, replication, coverage) is refused by name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NoReturn

from safety.trees.as_written import TreeError, exact
from safety.trees.dynamic.tree import Dependency, DynamicGate, DynamicTree, Restriction, TimedEvent
from safety.trees.tree import FaultTree

TOKEN = re.compile(
    r'(?P<space>\s+|//[^\n]*|/\*.*?\*/)|"(?P<quoted>[^"\n]*)"|(?P<mark>[;=])|(?P<word>[^\s;="]+)', re.DOTALL
)
TOPLEVEL = re.compile(rb"(?:^|;)\s*toplevel\s")
COMMENT = re.compile(rb"//[^\n]*|/\*.*?\*/", re.DOTALL)
VOTE = re.compile(r"(\d+)of(\d+)|vot(?:e|ing)?(\d+)")
SPARES = {"spare": None, "wsp": None, "csp": Fraction(0), "hsp": Fraction(1)}  # dormancy of what is in reserve
ORDERED = {
    f"{kind}{ending}": (kind, exclusive)
    for kind in ("pand", "por")
    for ending, exclusive in (("", False), ("-inc", False), ("-incl", False), ("-excl", True), ("-ex", True))
}
KNOWN = f"and, or, inhibit, 2of3, vot2, {', '.join([*ORDERED, *SPARES])}, fdep, pdep=0.5, seq, mutex"
NEUTRAL = {  # attributes that only their neutral value leaves solvable
    "repair": (0, "repair is not supported here, failures are for good; model repaired equipment as a Markov chain"),
    "cov": (
        1,
        "imperfect coverage is not supported; leave cov= out, or write the uncovered part as an event of its own",
    ),
    "res": (0, "recovery from transient faults is not supported; leave res= out, or reduce lambda by that share"),
    "spd": (0, "single-point shares are not supported; write that part as an event of its own"),
    "repl": (1, "replication is not supported; write each copy as an event of its own"),
    "phases": (1, "Erlang times are not supported; chain events with a cold spare gate"),
    "shape": (1, "only shape=1, an exponential time, is supported"),
    "priority": (0, "priorities are not supported; leave them out"),
}


def is_galileo(text: bytes) -> bool:
    """Whether `text` is Galileo: some statement of it begins with the word toplevel."""
    return b"toplevel" in text and TOPLEVEL.search(COMMENT.sub(b" ", text.removeprefix(b"\xef\xbb\xbf"))) is not None


def read_galileo(text: bytes, file: str) -> DynamicTree:
    """The tree in `text`; `file` is for messages. Raises TreeError with "file:line"."""
    return _Reader(file).read(text)


def to_galileo(tree: DynamicTree | FaultTree) -> str:
    """Galileo text of `tree`; `read_galileo` gives an equal tree back (named after its top).

    Raises TreeError: a quote or line break in a name; in a static tree a not or xor gate, an event without figure,
    rates with different mission times.
    """
    if isinstance(tree, FaultTree):
        times = {e.mission_time_h for e in tree.events if e.probability is None and e.rate_per_hour is not None}
        if len(times | ({tree.mission_time_h} - {None})) > 1:
            raise TreeError("rates with different mission times, which Galileo text cannot hold; write .json or .xml")
        tree = DynamicTree.of(tree)
    lines = [f"toplevel {_quoted(tree.top)};"]
    for gate in tree.gates:
        kind = f"{gate.k}of{len(gate.inputs)}" if gate.kind == "vote" else "wsp" if gate.kind == "spare" else gate.kind
        lines.append(_line(gate.name, kind + "-excl" * gate.exclusive, gate.inputs))
    for dependency in tree.dependencies:
        kind = "fdep" if dependency.probability == 1 else f"pdep={_number(dependency.probability)}"
        lines.append(_line(dependency.name, kind, (dependency.trigger, *dependency.dependents)))
    lines += [_line(restriction.name, restriction.kind, restriction.inputs) for restriction in tree.restrictions]
    for event in tree.events:
        if event.rate_per_hour is None:
            assert event.probability is not None
            figure = f"prob={_number(event.probability)}"
        else:
            figure = f"lambda={_number(event.rate_per_hour)}"
        lines.append(_line(event.name, f"{figure} dorm={_number(event.dormancy)}", ()))
    return "\n".join(lines) + "\n"


def _line(name: str, words: str, inputs: tuple[str, ...]) -> str:
    return " ".join([_quoted(name), words, *map(_quoted, inputs)]) + ";"


def _quoted(name: str) -> str:
    if '"' in name or "\n" in name:
        raise TreeError(f"the name {name!r} holds a quote or line break, which Galileo cannot write; rename it", name)
    return f'"{name}"'


def _number(value: Fraction) -> str:
    """A decimal where it ends, otherwise a fraction."""
    twos, fives, rest = 0, 0, value.denominator
    while rest % 2 == 0:
        rest, twos = rest // 2, twos + 1
    while rest % 5 == 0:
        rest, fives = rest // 5, fives + 1
    places = max(twos, fives)
    if rest > 1 or places > 30:
        return str(value)
    return f"{value.numerator * 10**places // value.denominator}e-{places}" if places else str(value)


@dataclass
class _Token:
    text: str
    mark: bool  # ; or =
    line: int


class _Reader:
    def __init__(self, file: str) -> None:
        self.file = file
        self.line = 1  # of the statement being read
        self.top = ""
        self.gates: list[DynamicGate] = []
        self.events: list[TimedEvent] = []
        self.dependencies: list[Dependency] = []
        self.restrictions: list[Restriction] = []
        self.lines: dict[str, int] = {}
        self.said_dormant: set[str] = set()  # events with a dorm= of their own
        self.reserve: dict[str, Fraction] = {}  # csp and hsp gates: dormancy of what is in reserve

    def read(self, text: bytes) -> DynamicTree:
        try:
            characters = text.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            self.line = text.count(b"\n", 0, error.start) + 1
            self.fail(f"byte {text[error.start]:#x} is not UTF-8; save the file as UTF-8")
        for statement in self.statements(characters):
            self.line = statement[0].line
            self.statement(statement)
        if not self.top:
            self.line = 1
            self.fail('no top is named; add a statement such as: toplevel "System";')
        self.leave_out_dummies()
        if any(event.name == self.top for event in self.events):
            self.top = self.gate_over(self.top)
        try:
            self.set_reserve()
            return DynamicTree(
                self.top,
                self.top,
                tuple(self.gates),
                tuple(self.events),
                tuple(self.dependencies),
                tuple(self.restrictions),
            )
        except TreeError as error:
            self.line = self.lines.get(error.item, self.line)
            self.fail(error.message, error.item)

    def fail(self, message: str, item: str = "") -> NoReturn:
        raise TreeError(message, item, f"{self.file}:{self.line}") from None

    def statements(self, text: str) -> Iterator[list[_Token]]:
        tokens: list[_Token] = []
        at, line = 0, 1
        while at < len(text):
            found = TOKEN.match(text, at)
            if found is None or (found.group().startswith("/*") and not found.group().endswith("*/")):
                self.line = line
                self.fail(
                    f"{text[at : at + 20]!r}: a quote is not closed on its line, or a comment not at all; close it"
                )
            at = found.end()
            if found["mark"] == ";":
                if tokens:
                    yield tokens
                tokens = []
            elif found["space"] is None:
                quoted = found["quoted"]
                tokens.append(_Token(found["word"] or found["mark"] or quoted or "", found["mark"] is not None, line))
                if quoted == "":
                    self.line = line
                    self.fail('"" is no name; name the element')
            line += found.group().count("\n")
        if tokens:
            self.line = tokens[0].line
            self.fail(f'the statement of "{tokens[0].text}" does not end; put a ";" after it')

    def statement(self, tokens: list[_Token]) -> None:
        words = [token.text for token in tokens]
        name = words[0]
        if tokens[0].mark:
            self.fail(f"a statement begins with {name!r}, expected a name")
        if name == "toplevel" and not (len(words) > 2 and tokens[2].mark):
            if len(words) != 2:
                self.fail(f"toplevel names {len(words) - 1} elements, expected exactly 1")
            if self.top:
                self.fail(f'toplevel is "{words[1]}", but it was "{self.top}" before; keep one of them')
            self.top, self.lines[words[1]] = words[1], self.lines.get(words[1], self.line)
            return
        if name in self.lines and name in self.defined:
            self.fail(f'"{name}" is defined twice, first in line {self.lines[name]}; rename or remove one', name)
        self.lines[name] = self.line
        if len(words) == 1:
            self.fail(f'"{name}" has no definition; give it a gate or lambda=', name)
        try:
            if len(tokens) > 2 and tokens[2].mark and words[1] != "pdep":
                self.event(name, tokens[1:])
            else:
                self.element(name, tokens[1:])
        except TreeError as error:
            self.fail(error.message, name)

    @property
    def defined(self) -> set[str]:
        return {
            *(gate.name for gate in self.gates),
            *(event.name for event in self.events),
            *(dependency.name for dependency in self.dependencies),
            *(restriction.name for restriction in self.restrictions),
        }

    def element(self, name: str, tokens: list[_Token]) -> None:
        kind, probability = tokens[0].text, Fraction(1)
        if kind == "pdep":
            if len(tokens) < 3 or not tokens[1].mark:
                raise TreeError(f'"{name}" is a pdep without a probability, expected for example pdep=0.2')
            probability = exact(tokens[2].text, f'pdep of "{name}"')
            tokens = tokens[2:]
        if marks := [token for token in tokens[1:] if token.mark]:
            raise TreeError(f'"{name}" ({kind}) has a "{marks[0].text}" among its inputs, expected names only')
        inputs = tuple(token.text for token in tokens[1:])
        vote = VOTE.fullmatch(kind)
        if kind in ("fdep", "pdep"):
            if len(inputs) < 2:
                raise TreeError(f'{kind} "{name}" has {len(inputs)} inputs, expected a trigger and its dependents')
            self.dependencies.append(Dependency(name, inputs[0], inputs[1:], probability))
        elif kind in ("seq", "mutex"):
            self.restrictions.append(Restriction(name, kind, inputs))
        elif vote:
            if vote[2] and int(vote[2]) != len(inputs):
                raise TreeError(f'"{name}" is a {kind} with {len(inputs)} inputs, expected {vote[2]}')
            self.gates.append(DynamicGate(name, "vote", inputs, int(vote[1] or vote[3])))
        elif kind in ORDERED:
            base, exclusive = ORDERED[kind]
            self.gates.append(DynamicGate(name, base, inputs, exclusive=exclusive))
        elif kind in SPARES:
            self.gates.append(DynamicGate(name, "spare", inputs))
            if (reserve := SPARES[kind]) is not None:
                self.reserve[name] = reserve
        elif kind in ("and", "or", "inhibit"):
            self.gates.append(DynamicGate(name, kind, inputs))
        else:
            raise TreeError(f'"{name}" is of type {kind!r}, expected one of {KNOWN}, or figures such as lambda=1e-4')

    def event(self, name: str, tokens: list[_Token]) -> None:
        figures: dict[str, Fraction] = {}
        for at in range(0, len(tokens), 3):
            key, *rest = tokens[at : at + 3]
            if len(rest) < 2 or not rest[0].mark or rest[1].mark or key.mark:
                raise TreeError(f'event "{name}": near {key.text!r} expected attribute=value, such as lambda=1e-4')
            if key.text in figures:
                raise TreeError(f'event "{name}" has {key.text}= more than once; keep one')
            figures[key.text] = exact(rest[1].text, f'{key.text} of event "{name}"')
        for attribute, (neutral, why) in NEUTRAL.items():
            if (value := figures.pop(attribute, neutral)) != neutral:
                raise TreeError(f'event "{name}" has {attribute}={float(value):g}: {why}')
        if "rate" in figures and "lambda" not in figures:
            figures["lambda"] = figures.pop("rate")
        if unknown := figures.keys() - {"lambda", "prob", "dorm"}:
            raise TreeError(
                f'event "{name}" has the attribute {min(unknown)!r}, which is not supported; '
                "expected lambda= (per hour) or prob=, and dorm="
            )
        if "dorm" in figures:
            self.said_dormant.add(name)
        self.events.append(
            TimedEvent(name, figures.get("lambda"), figures.get("prob"), figures.get("dorm", Fraction(1)))
        )

    def gate_over(self, event: str) -> str:
        """A gate for a top that is an event, as a tree has a gate on top."""
        name = f"{event} (top)"
        while name in self.lines:
            name += "'"
        self.gates.append(DynamicGate(name, "or", (event,)))
        return name

    def leave_out_dummies(self) -> None:
        dummies = {dependency.name for dependency in self.dependencies} | {r.name for r in self.restrictions}
        for at, gate in enumerate(self.gates):
            inputs = tuple(name for name in gate.inputs if name not in dummies)
            if inputs != gate.inputs:
                try:
                    self.gates[at] = replace(gate, inputs=inputs)
                except TreeError as error:
                    self.line = self.lines[gate.name]
                    self.fail(f"{error.message} (dependencies and restrictions have no output)", gate.name)

    def set_reserve(self) -> None:
        """Dormancy of what csp and hsp gates keep in reserve, where the event does not say it."""
        if not self.reserve:
            return
        below = DynamicTree(self.top, self.top, tuple(self.gates), tuple(self.events)).below
        set_by: dict[str, str] = {}
        for gate in self.gates:
            dormancy = self.reserve.get(gate.name)
            if dormancy is None:
                continue
            reserve = set().union(*(below[name] for name in gate.inputs[1:]))
            for at, event in enumerate(self.events):
                if event.name not in reserve or event.rate_per_hour is None:
                    continue
                other = set_by.setdefault(event.name, gate.name)
                if event.dormancy != dormancy and (event.name in self.said_dormant or other != gate.name):
                    kind = "hsp" if dormancy else "csp"
                    raise TreeError(
                        f'event "{event.name}" has dormancy {event.dormancy}, but the {kind} gate "{gate.name}" keeps '
                        f"it at {dormancy}; make the gate a wsp, or correct dorm=",
                        event.name,
                    )
                self.events[at] = replace(event, dormancy=dormancy)

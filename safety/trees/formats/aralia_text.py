"""Aralia text: a fault tree as equations.

    title                                  (optional)
    top := g1 & (a | ~b) & @(2, [a, b, c]);
    g1  := #(1, 2, [a, b, c]) | a ^ b;     /* comment */  // comment to the end of the line
    p(a) = 0.01;
    s(h) = true;

Operators, the tightest first: ~ or - or ! (not), & (and), | (or), => (implies), <=> (if and only if); ^ or # is the
exclusive or, which stands beside other operators only in parentheses, as programs disagree on its place. @(k, [...]) is
at least k, #(low, high, [...]) from low to high of the list. The semicolon may be left out. A name is letters, digits
and _, with single - and . between; any other name stands in double quotes, written as in JSON. A name without an
equation is a basic event; s() makes it a house event. Gates inside of formulas are named after the gate and their
place, "top/2". Descriptions, source tags and attributes have no place here and are left out.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from fractions import Fraction

from safety.trees.as_written import TreeError, exact
from safety.trees.formats.draft import Draft, at
from safety.trees.formats.nested import nested
from safety.trees.tree import BasicEvent, FaultTree, Gate, HouseEvent

NAME = r"[^\W\d]\w*(?:[-.]\w+)*"
TOKEN = re.compile(
    rf'(?P<space>\s+|//[^\n]*|/\*.*?\*/)|(?P<name>{NAME})|(?P<quoted>"(?:[^"\\\n]|\\.)*")'
    r"|(?P<number>\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?:/\d+)?|\.\d+(?:[eE][-+]?\d+)?)|(?P<sign><=>|=>|:=|[-~!&|^#@()\[\],;=])",
    re.DOTALL,
)
DEEPEST = 200  # formulas inside each other
KINDS = {"&": "and", "|": "or", "^": "xor", "#": "xor"}
SIGNS = {"and": " & ", "or": " | ", "xor": " ^ "}
Formula = str | tuple[str, int, list["Formula"]]  # a name, or kind, k and arguments


def is_aralia(text: bytes) -> bool:
    """Whether a text that is no XML, JSON or Galileo looks like one of these: it holds an equation."""
    return b":=" in text


def read_aralia(text: bytes, file: str, mission_time_h: Fraction | None = None) -> Draft:
    """The definitions in an Aralia text. Raises TreeError with file and line."""
    try:
        content = text.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise TreeError(f"{file}: not text in UTF-8 ({error.reason} at byte {error.start}); convert it") from None
    return _Reader(content, file, mission_time_h).draft


class _Reader:
    def __init__(self, content: str, file: str, mission_time_h: Fraction | None) -> None:
        self._tokens = _tokens(content, file)
        self._file = file
        self._depth = 0
        self._kind, self._text, self._line = next(self._tokens)
        self.draft = Draft(file, mission_time_h=mission_time_h)
        self._made: dict[int, str] = {}  # the gates of the formulas of one equation
        self._used: dict[str, str] = {}  # names in formulas, with the place where each first stands
        given: dict[str, tuple[str, bool | Fraction]] = {}
        first = True
        while self._kind != "end":
            self._statement(given, first)
            first = False
        self._define_events(given)

    def _statement(self, given: dict[str, tuple[str, bool | Fraction]], first: bool) -> None:
        place = self._place
        name = self._name()
        if self._text == ":=":
            self._next()
            formula = self._formula()
            self._made.clear()
            self._gate(name, formula, place)
        elif self._text == "(" and name in ("p", "s"):
            self._next()
            event = self._name()
            self._expect(")")
            self._expect("=")
            if event in given:
                raise TreeError(f'"{event}" is given a value twice; remove one', event, place)
            given[event] = place, self._truth() if name == "s" else self._number()
        elif first:
            self.draft.name = name
            return
        else:
            raise self._error("expected :=")
        if self._text == ";":
            self._next()

    def _define_events(self, given: dict[str, tuple[str, bool | Fraction]]) -> None:
        gates = {gate.name for gate in self.draft.gates}
        for name, place in self._used.items():
            if name not in gates and name not in given:
                self.draft.add(BasicEvent(name), place)
        for name, (place, value) in given.items():
            with at(place):
                self.draft.add(HouseEvent(name, value) if isinstance(value, bool) else BasicEvent(name, value), place)

    def _gate(self, name: str, formula: Formula, place: str, inside: str = "") -> None:
        if isinstance(formula, str):
            formula = ("or", 0, [formula])
        kind, k, arguments = formula
        inputs = []
        for number, argument in enumerate(arguments, 1):
            if isinstance(argument, str):
                inputs.append(argument)
                self._used.setdefault(argument, place)
            elif id(argument) in self._made:  # the list of #( stands in two gates
                inputs.append(self._made[id(argument)])
            else:
                inputs.append(f"{name}/{number}")
                self._gate(inputs[-1], argument, place, inside or name)
                self._made[id(argument)] = inputs[-1]
        with at(place):
            self.draft.add(Gate(name, kind, tuple(inputs), k if kind == "vote" else None, inside=inside), place)

    def _formula(self) -> Formula:
        left = self._implication()
        if self._text != "<=>":
            return left
        self._next()
        return "not", 0, [("xor", 0, [left, self._implication()])]

    def _implication(self) -> Formula:
        left = self._chain()
        if self._text != "=>":
            return left
        self._next()
        return "or", 0, [("not", 0, [left]), self._chain()]

    def _chain(self) -> Formula:
        """Arguments joined by & and |, or all of them by the exclusive or."""
        place, signs, operands = self._place, [], [self._operand()]
        while self._text in KINDS:
            signs.append(KINDS[self._text])
            self._next()
            operands.append(self._operand())
        if "xor" in signs:
            if len(set(signs)) > 1:
                raise TreeError(
                    "an exclusive or stands beside another operator; put parentheses around it", place=place
                )
            return "xor", 0, operands
        alternatives = [[operands[0]]]
        for sign, operand in zip(signs, operands[1:], strict=True):
            if sign == "and":
                alternatives[-1].append(operand)
            else:
                alternatives.append([operand])
        return _joined("or", [_joined("and", factors) for factors in alternatives])

    def _operand(self) -> Formula:
        self._depth += 1
        if self._depth > DEEPEST:
            raise self._error("nested too deeply; give inner formulas names of their own")
        formula: Formula
        if self._kind in ("name", "quoted"):
            formula = self._name()
        elif self._text in ("~", "-", "!"):
            self._next()
            formula = "not", 0, [self._operand()]
        elif self._text == "@":
            [k], arguments = self._listed(1)
            formula = "vote", k, arguments
        elif self._text == "#":
            (low, high), arguments = self._listed(2)
            formula = self._from_to(low, high, arguments)
        else:
            self._expect("(")
            formula = self._formula()
            self._expect(")")
        self._depth -= 1
        return formula

    def _listed(self, count: int) -> tuple[list[int], list[Formula]]:
        """The whole numbers and the list of arguments of @( and #(."""
        self._next()
        self._expect("(")
        numbers = []
        for _ in range(count):
            if self._kind != "number" or not self._text.isdecimal() or len(self._text) > 9:
                raise self._error("expected a whole number")
            numbers.append(int(self._text))
            self._next()
            self._expect(",")
        self._expect("[")
        arguments = [self._formula()]
        while self._text == ",":
            self._next()
            arguments.append(self._formula())
        self._expect("]")
        self._expect(")")
        return numbers, arguments

    def _from_to(self, low: int, high: int, arguments: list[Formula]) -> Formula:
        if not low <= high <= len(arguments) or (low, high) == (0, len(arguments)):
            raise self._error(f"limits {low} and {high} of {len(arguments)} arguments; correct them, in")
        more: Formula = "not", 0, [("vote", high + 1, arguments)]
        if high == len(arguments):
            return "vote", low, arguments
        return more if low == 0 else ("and", 0, [("vote", low, arguments), more])

    def _name(self) -> str:
        kind, text = self._kind, self._text
        if kind not in ("name", "quoted"):
            raise self._error("expected a name")
        try:
            name = str(json.loads(text)) if kind == "quoted" else text
        except ValueError:
            raise self._error("no string as in JSON") from None
        self._next()
        return name

    def _truth(self) -> bool:
        name = self._name()
        if name not in ("true", "false"):
            raise TreeError(f'"{name}" is no state, expected true or false; correct it', place=self._place)
        return name == "true"

    def _number(self) -> Fraction:
        if self._kind != "number":
            raise self._error("expected a number")
        with at(self._place):
            number = exact(self._text, "a probability")
        self._next()
        return number

    def _expect(self, text: str) -> None:
        if self._text != text or self._kind != "sign":
            raise self._error(f"expected {text}")
        self._next()

    def _next(self) -> None:
        self._kind, self._text, self._line = next(self._tokens)

    @property
    def _place(self) -> str:
        return f"{self._file}:{self._line}"

    def _error(self, what: str) -> TreeError:
        found = f'"{self._text[:40]}"' if self._kind != "end" else "the end of the text"
        return TreeError(f"{what} at {found}; correct it", place=self._place)


def _joined(kind: str, arguments: list[Formula]) -> Formula:
    return arguments[0] if len(arguments) == 1 else (kind, 0, arguments)


def _tokens(content: str, file: str) -> Iterator[tuple[str, str, int]]:
    """Kind, text and line of every token; at last "end" without end."""
    line, start = 1, 0
    while start < len(content):
        found = TOKEN.match(content, start)
        if found is None:
            raise TreeError(
                f"{content[start : start + 20]!r} is no part of an Aralia text, or is not closed; correct it",
                place=f"{file}:{line}",
            )
        if found.lastgroup != "space":
            yield str(found.lastgroup), found.group(), line
        line, start = line + content.count("\n", start, found.end()), found.end()
    while True:
        yield "end", "", line


def to_aralia(tree: FaultTree) -> str:
    """`tree` as Aralia text; `read` gives an equal tree back if its events have probabilities, and no label, tag or
    attribute, and its one-input gates are or or not.

    Raises TreeError for an event with a rate or an expression, which Aralia text cannot hold.
    """
    inline = nested(tree.gates, (tree.top,))
    gates = {gate.name: gate for gate in tree.gates}

    def formula(gate: Gate) -> str:
        parts = [f"({formula(gates[name])})" if name in inline else _written(name) for name in gate.inputs]
        if gate.kind == "vote":
            return f"@({gate.k}, [{', '.join(parts)}])"
        return f"~{parts[0]}" if gate.kind == "not" else SIGNS[gate.kind].join(parts)

    lines = [_written(tree.name)]
    lines += [f"{_written(gate.name)} := {formula(gate)};" for gate in tree.gates if gate.name not in inline]
    for event in tree.events:
        if event.probability is not None:
            lines.append(f"p({_written(event.name)}) = {event.probability};")
        elif event.rate_per_hour is not None or event.expression is not None:
            raise TreeError(
                f'basic event "{event.name}" has a rate or an expression, Aralia text holds probabilities only; '
                "write MEF or JSON",
                event.name,
            )
    lines += [f"s({_written(house.name)}) = {str(house.state).lower()};" for house in tree.house_events]
    return "\n".join(lines) + "\n"


def _written(name: str) -> str:
    return name if re.fullmatch(NAME, name) else json.dumps(name, ensure_ascii=False)

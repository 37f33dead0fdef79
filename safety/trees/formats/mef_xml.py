"""Writing the elements of Open-PSA MEF: each function gives the lines of one, indented by one blank a level."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape, quoteattr

from safety.trees.as_written import Rational, TreeError, exact
from safety.trees.formats.mef_names import encoded
from safety.trees.formats.xml_elements import NAMES

if TYPE_CHECKING:
    from safety.trees.expressions.expression import Expression, Parameter

Lines = list[str]
ILLEGAL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
HEAD = '<?xml version="1.0" encoding="UTF-8"?>'


def parameters(definitions: Mapping[str, Parameter]) -> Lines:
    """The definitions of parameters."""
    lines: Lines = []
    for one in definitions.values():
        unit = {"unit": one.unit} if one.unit else {}
        source = attributes([("source", one.source)] if one.source else [])
        lines += element("define-parameter", {"name": one.name} | unit, source + expression(one.definition))
    return element("model-data", {}, lines) if lines else []


def expression(given: Expression) -> Lines:
    """An expression; a parameter in it by its name."""
    from safety.trees.expressions.expression import Constant, Parameter

    if isinstance(given, Constant):
        return number(given.number)
    if isinstance(given, Parameter):
        return element("parameter", {"name": given.name})
    parts = [expression(argument) for argument in given.arguments]
    pairs: Lines = []
    if given.tag == "switch":
        for place in range(0, len(parts) - 1, 2):
            pairs += element("case", {}, parts[place] + parts[place + 1])
        return element("switch", {}, pairs + parts[-1])
    if given.tag == "histogram":
        for place in range(1, len(parts), 2):
            pairs += element("bin", {}, parts[place] + parts[place + 1])
        return element("histogram", {}, parts[0] + pairs)
    return element(given.tag, {}, [line for part in parts for line in part])


def value(given: Rational | Expression) -> Lines:
    """A number or an expression."""
    from safety.trees.expressions.expression import Expression

    return expression(given) if isinstance(given, Expression) else number(exact(given, "a number"))


def number(given: Fraction) -> Lines:
    """A number as a decimal, or as a quotient where that would not end."""
    twos = fives = 0
    rest = given.denominator
    while rest % 2 == 0:
        rest, twos = rest // 2, twos + 1
    while rest % 5 == 0:
        rest, fives = rest // 5, fives + 1
    if rest > 1:
        return element("div", {}, number(Fraction(given.numerator)) + number(Fraction(given.denominator)))
    places = max(twos, fives)
    digits = given.numerator * 10**places // given.denominator
    written = Decimal((int(digits < 0), tuple(map(int, str(abs(digits)))), -places))
    return [f'<float value="{written}"/>']


def constant(state: bool) -> Lines:
    """A truth value."""
    return [f'<constant value="{str(state).lower()}"/>']


def label(text: str) -> Lines:
    """A label, if there is one to give."""
    evened = " ".join(text.split())
    return [f"<label>{escape(_legal(evened))}</label>"] if evened else []


def attributes(pairs: Iterable[tuple[str, str]]) -> Lines:
    """The element of attributes, if there are any."""
    inner = [line for name, text in pairs for line in element("attribute", {"name": name, "value": text})]
    return element("attributes", {}, inner) if inner else []


def element(tag: str, attributes: Mapping[str, str], inner: Lines | None = None) -> Lines:
    """An element; the attributes in NAMES are names and are written by the rule of `mef_names`."""
    shown = {key: encoded(text) if key in NAMES else _legal(text) for key, text in attributes.items()}
    head = "".join([tag, *(f" {key}={quoteattr(text)}" for key, text in shown.items())])
    if not inner:
        return [f"<{head}/>"]
    return [f"<{head}>", *(f" {line}" for line in inner), f"</{tag}>"]


def _legal(text: str) -> str:
    if found := ILLEGAL.search(text):
        raise TreeError(f"the text {text[:40]!r} holds {found[0]!r}, which XML cannot hold; remove it")
    return text


def document(name: str, lines: Lines) -> str:
    """The whole file of a model that may have a name."""
    return "\n".join([HEAD, *element("opsa-mef", {"name": name} if name else {}, lines), ""])

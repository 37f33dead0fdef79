"""Printed numbers: what a text such as "0.56422" stands for, what rounds to it, and what a slip of the pen makes of it.

A text stands for every number within half a unit of its last digit, both ends included: how a tie is rounded is not
said in print.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import floor

from safety.audit.exceptions import AuditError
from safety.audit.spans import Span

_GROUPS = r"[1-9][0-9]{0,2}([, \u00a0\u202f])[0-9]{3}(?:\3[0-9]{3})*"  # 132,791: a comma parts groups of three
_NUMBER = re.compile(rf"([-+−]?)((?:{_GROUPS}|[0-9]+)(?:\.[0-9]+)?|\.[0-9]+)")
MOST_DIGITS = 40
FAR = 3  # places that a decimal point may have moved beyond the digits
SPARE = 1  # digits shown of a recomputed value beyond those printed
REPLACED, EXCHANGED, POINT = "one digit replaced", "two neighbouring digits exchanged", "decimal point moved or lost"
LOST, DOUBLED = "one digit lost", "one digit doubled"


@dataclass(frozen=True)
class Text:
    """A number as printed; `step` is the worth of its last digit that counts."""

    text: str
    value: Fraction
    step: Fraction

    @property
    def span(self) -> Span:
        """All numbers that round to it."""
        return Span(self.value - self.step / 2, self.value + self.step / 2)


def text(printed: str, digits: int | None = None) -> Text:
    """Read a printed number: sign, digits (commas or spaces between groups of three), decimal point.

    `digits` is how many significant digits count; without a decimal point all are taken to, unless it says otherwise.
    Raises AuditError for anything else.
    """
    found = _NUMBER.fullmatch(printed.strip())
    if found is None or len(printed) > MOST_DIGITS:
        raise AuditError(
            f"{printed[:MOST_DIGITS]!r} is no printed number; write it as in print, with a decimal point and the unit "
            f"apart: '0.5', '132,791'"
        )
    plain = re.sub(r"[^\d.]", "", found[2])
    value = Fraction(plain) * (-1 if found[1] in ("-", "−") else 1)
    places = len(plain.partition(".")[2])
    step = Fraction(1, 10**places)
    if digits is not None:
        counted = len(plain.replace(".", "").lstrip("0"))
        if not 0 < digits <= counted:
            raise AuditError(f"{printed!r} has {counted} significant digits; digits={digits} does not fit")
        step *= Fraction(10) ** (counted - digits)
    return Text(printed.strip(), value, step)


def slips(printed: Text) -> Iterator[tuple[Text, str]]:
    """What may have been meant if one slip of the pen made this text, the commonest slips first, each with its name."""
    sign = "-" if printed.value < 0 else ""
    plain = re.sub(r"[^\d.]", "", printed.text)
    seen = {plain}
    for made, kind in _slips(plain):
        tidy = made if "." not in made or not made.startswith(".") else f"0{made}"
        if made not in seen and re.fullmatch(r"\d+(\.\d+)?", tidy) and not re.match(r"0\d", tidy):
            seen.add(made)
            yield text(sign + tidy), kind


def _slips(plain: str) -> Iterator[tuple[str, str]]:
    digits = [n for n, sign in enumerate(plain) if sign != "."]
    for n in digits:
        yield from ((plain[:n] + new + plain[n + 1 :], REPLACED) for new in "0123456789")
    for a, b in pairwise(digits):
        yield plain[:a] + plain[b] + plain[a + 1 : b] + plain[a] + plain[b + 1 :], EXCHANGED
    bare = plain.replace(".", "").lstrip("0")
    for point in range(-FAR, len(bare) + FAR + 1):
        inside = f"{bare[:point]}.{bare[point:]}" if 0 < point < len(bare) else bare + "0" * (point - len(bare))
        yield (inside if point > 0 else f"0.{'0' * -point}{bare}"), POINT
    for n in range(len(plain) + 1):
        yield from ((plain[:n] + new + plain[n:], LOST) for new in "0123456789")
    for a, b in pairwise(digits):
        if plain[a] == plain[b] and b == a + 1:
            yield plain[:a] + plain[b:], DOUBLED


def shown(value: Span, like: Text) -> str:
    """A recomputed value with a digit more than was printed, or as a range where its ends show as different."""
    step = like.step / 10**SPARE
    ends = [_decimal(end, step) for end in (value.low, value.high)]
    return ends[0] if ends[0] == ends[1] else f"{ends[0]} .. {ends[1]}"


def _decimal(value: Fraction, step: Fraction) -> str:
    """Rounded to a step that is a power of ten, halves upwards; zeros at the end of decimals are left out."""
    if step >= 1:
        return str(floor(value / step + Fraction(1, 2)) * int(step))
    places = len(str(step.denominator)) - 1
    whole = floor(value / step + Fraction(1, 2))
    digits = f"{abs(whole):0{places + 1}d}"
    return ("-" if whole < 0 else "") + f"{digits[:-places]}.{digits[-places:]}".rstrip("0").rstrip(".")

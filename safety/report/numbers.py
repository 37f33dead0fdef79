"""Numbers, units and tags as an engineer writes them."""

from __future__ import annotations

import re
from collections.abc import Mapping

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any

UNKNOWN = "unknown"
TAGS = {"P": "printed", "D": "derived", "A": "assumed", "R": "reconstructed"}
_SUPER = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_TAG = re.compile(r"\[([PDAR])\]")


def number(value: Any, digits: int = 4) -> str:
    """4312500 -> 4 312 500, 2.77778e-05 -> 2.778 × 10⁻⁵, "inf" -> ∞, None -> unknown; anything else as it is."""
    if value is None:
        return UNKNOWN
    if value == "inf" or value == float("inf"):
        return "∞"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return _grouped(str(value))
    if not isinstance(value, float):
        return str(value)
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    if value == 0 or -3 <= int(exponent) < 6:
        plain = f"{value:.{max(0, digits - 1 - int(exponent))}f}" if value else "0"
        whole, _, part = plain.partition(".")
        part = part.rstrip("0")
        return _grouped(whole) + (f".{part}" if part else "")
    return f"{mantissa.rstrip('0').rstrip('.').replace('-', '−')} × 10{str(int(exponent)).translate(_SUPER)}"


def exact_text(found: Mapping[str, Any] | None) -> str:
    """An exact value, with the double beside it where it is no whole number: "4855/8192 = 0.592651"."""
    if found is None:
        return UNKNOWN
    exact = str(found["exact"])
    return f"{exact} = {found['value']:.6g}" if "/" in exact else exact


def bracket_text(bracket: Mapping[str, Any]) -> str:
    """The ends of a bracket: the largest value that is reached, the smallest proved not to be exceeded."""
    return f"[{exact_text(bracket['low'])}, {exact_text(bracket['high'])}] {bracket.get('unit', '')}".rstrip()


def cell_text(cell: Any, decimals: int | None = None) -> str:
    """A cell of a table: a number with so many decimals where they are said, an int without; None is empty."""
    if cell is None:
        return ""
    value = cell["value"] if isinstance(cell, Mapping) else cell
    if decimals is None or not isinstance(value, float):
        return number(value, 6)
    whole, _, part = f"{value:.{decimals}f}".partition(".")
    return _grouped(whole).replace("-", "−") + (f".{part}" if part else "")


def faults_text(faults: str | Mapping[str, Any] | None) -> str:
    """A fault budget in words: "at most 1 of 12"."""
    if faults is None or isinstance(faults, str):
        return faults or "none"
    if not faults["of"] or not faults["most"]:
        return "none"
    return f"at most {faults['most']} of {len(faults['of'])}"


def tags_of(text: str) -> set[str]:
    """The source tags in a text: "[A] the window is 0.5 s" has A."""
    return set(_TAG.findall(text))


def clean(text: str) -> str:
    """What XML and HTML cannot hold (control characters, lone surrogates) becomes U+FFFD."""
    return re.sub("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff\ufffe\uffff]", "\ufffd", text)


def one_line(text: str) -> str:
    """The same on one line of a terminal, which obeys further characters: those become U+FFFD, too."""
    return re.sub("[\x80-\x9f\u2028\u2029]", "\ufffd", re.sub("[\n\r\t]", " ", clean(text)))


def _grouped(digits: str) -> str:
    sign, digits = ("−", digits[1:]) if digits.startswith("-") else ("", digits)
    return sign + (f"{int(digits):,}".replace(",", "\u202f") if len(digits) > 4 else digits)


def weakest_text(entry: Mapping[str, Any]) -> str:
    """The weakest safe value as it was found: `proved from 3613, refuted at 2828 frame`."""
    above = entry.get("safe") != "below"
    unit = f" {entry['unit']}" if entry.get("unit") else ""
    safe, bad = (exact_text(v) if isinstance(v, Mapping) else v for v in (entry["safe_from"], entry["refuted_at"]))
    if entry.get("everywhere"):
        return f"proved all over the range, {'from' if above else 'up to'} {safe}{unit}"
    proved = "proved nowhere" if safe is None else f"proved {'from' if above else 'up to'} {safe}"
    return f"{proved}, {'not refuted' if bad is None else f'refuted at {bad}'}{unit}"

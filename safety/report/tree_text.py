"""Writing on the cards of a fault-tree picture: how wide it is, how it is wrapped and cut, how numbers are written."""

from __future__ import annotations

from functools import lru_cache

LETTERS = 11.5  # font size, px
LINE = 14  # px from line to line
BOLD = 1.08  # how much wider bold writing is


class _Widths(dict[str, float]):
    """The width of each character in px, rather too much than too little."""

    def __missing__(self, c: str) -> float:
        if ord(c) > 0x2E80:  # Chinese, Japanese, Korean
            ems = 1.0
        elif c in "iljtfr.,:;'|![]() /":
            ems = 0.36
        elif c in "mwMW@%":
            ems = 0.9
        else:
            ems = 0.7 if c.isupper() else 0.6
        self[c] = ems * LETTERS
        return self[c]


_WIDTHS = _Widths()


def text_width(text: str, bold: bool = False) -> float:
    """About how wide `text` is in px."""
    return sum(map(_WIDTHS.__getitem__, text)) * (BOLD if bold else 1.0)


@lru_cache(maxsize=4096)
def wrapped(text: str, width: float, bold: bool = False) -> tuple[str, ...]:
    """`text` in lines of at most `width` px: broken at spaces, else after . _ - / : and only then inside a word."""
    if text and "\n" not in text and "  " not in text and text_width(text, bold) <= width:
        return (text.strip(),) if text.strip() else ()
    lines = [""]
    for word in text.split():
        if lines[-1] and text_width(f"{lines[-1]} {word}", bold) <= width:
            lines[-1] += f" {word}"
            continue
        lines.append("")
        while text_width(word, bold) > width:
            fits = _fitting(word, width, bold)
            cut = max((n for n in range(2, fits + 1) if word[n - 1] in "._-/:"), default=fits)
            lines[-1] = word[:cut]
            lines.append("")
            word = word[cut:]
        lines[-1] = word
    return tuple(line for line in lines if line)


def clipped(text: str, width: float, most: int, bold: bool = False) -> tuple[str, ...]:
    """The same in at most `most` lines; an ellipsis says that something is left out."""
    longest = most * int(width // 3)  # characters, more than can fit
    lines = wrapped(text[:longest], width, bold)
    if len(lines) <= most and len(text) <= longest:
        return lines
    last = lines[:most][-1]
    while text_width(f"{last}…", bold) > width:
        last = last[:-1]
    return (*lines[: most - 1], f"{last}…")


def _fitting(word: str, width: float, bold: bool) -> int:
    """How many characters of a word that is too long fit on a line, at least one."""
    room = width / (BOLD if bold else 1.0)
    for n, c in enumerate(word):
        room -= _WIDTHS[c]
        if room < 0:
            return max(n, 1)
    return len(word)


_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def power_of_ten(value: float) -> str:
    """At most three digits: 0.25, 1.2×10⁻⁷."""
    if value == 0 or 0.01 <= value < 10_000:
        return f"{value:.3g}"
    mantissa, exponent = f"{value:.2e}".split("e")
    return f"{mantissa.rstrip('0').rstrip('.')}×10{str(int(exponent)).translate(_RAISED)}"

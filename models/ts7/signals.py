"""TS-7 signal selection: from the lines 0S1..90S1 to the word of the speed limit.

One step is one frame, 125 us.  Words: 1 unit = 0.47124 km/h.
Source: six signals on level-converted lines, the words in a data matrix [P]; the words themselves [D].
"""

from __future__ import annotations

from typing import NamedTuple

from safety import U8, Bit, Model, UInt, parameter, point, select, word


class Lines(NamedTuple):
    """ATC signal lines, true = active; healthy equipment has one active, no signal none."""

    s0: Bit
    s25: Bit
    s45: Bit
    s65: Bit
    s75: Bit
    s90: Bit


class Selection(Model, tick_s="125e-6"):
    """Level converters and row selection: the lowest active signal wins; no line active gives word 0."""

    word25: U8 = parameter(53, unit="word", within=(0, 255), source="[D] nearest to 25 km/h: 24.976")
    word45: U8 = parameter(95, unit="word", within=(0, 255), source="[D] nearest to 45 km/h: 44.768")
    word65: U8 = parameter(138, unit="word", within=(0, 255), source="[D] nearest to 65 km/h: 65.031")
    word75: U8 = parameter(159, unit="word", within=(0, 255), source="[D] nearest to 75 km/h: 74.927")
    word90: U8 = parameter(191, unit="word", within=(0, 255), source="[D] nearest to 90 km/h: 90.007")

    def step(self, lines: Lines) -> tuple[Selection, UInt]:
        """The word of the signal that the converters show."""
        seen = Lines(*(point(f"line.{name}", line) for name, line in zip(Lines._fields, lines, strict=True)))
        words = (word(0, 8), self.word25, self.word45, self.word65, self.word75, self.word90)
        return type(self)(), point("word", self.chosen(seen, words))

    def chosen(self, lines: Lines, words: tuple[UInt, ...]) -> UInt:
        """The word of the lowest active signal."""
        result = word(0, 8)
        for line, datum in reversed(list(zip(lines, words, strict=True))):
            result = select(line, datum, result)
        return result


class WiredOr(Selection, tick_s="125e-6"):
    """The hazard variant: rows wire-ORed onto the columns, so that 25 with 65 reads as 90 km/h."""

    def chosen(self, lines: Lines, words: tuple[UInt, ...]) -> UInt:
        """All active rows at once."""
        result = word(0, 8)
        for line, datum in zip(lines, words, strict=True):
            result = result | select(line, datum, 0)
        return result

"""Wrong selection of the signal: more than one line active, or none."""

from __future__ import annotations

from models.ts7.signals import Lines, Selection
from safety import UInt, any_of, select, word


class HighestSignal(Selection):
    """The highest active signal wins, not the lowest."""

    def chosen(self, lines: Lines, words: tuple[UInt, ...]) -> UInt:
        result = word(0, 8)
        for line, datum in zip(lines, words, strict=True):
            result = select(line, datum, result)
        return result


class LeastSignedWord(Selection):
    """The least active word wins, but words are compared as signed numbers: 138 reads as -118, less than 53."""

    def chosen(self, lines: Lines, words: tuple[UInt, ...]) -> UInt:
        result = select(lines.s0, word(0, 8), word(127, 8))
        for line, datum in list(zip(lines, words, strict=True))[1:]:
            result = select(line & (datum ^ 128 < result ^ 128), datum, result)
        return result


class NoLineIsNinety(Selection):
    """Without an active line the word of 90 km/h is selected, not 0."""

    def chosen(self, lines: Lines, words: tuple[UInt, ...]) -> UInt:
        return select(any_of(*lines), super().chosen(lines, words), words[-1])

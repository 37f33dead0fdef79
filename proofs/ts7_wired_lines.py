"""TS-7 signal selection: lines that touch, or rows that are wired together, against the reference rule.

One step is one frame, 125 us.  The reference takes the lowest active line; the variant puts all active rows on the
columns at once.

Main results: on the reference two lines that touch, wired-OR or wired-AND, never permit more than the signal that is
given.  On wired rows no active signal permits less than its word, and two together may permit more than either: 25 and
65 read as 90.
Source: six lines onto one matrix [P]; lowest active line, wired rows [A].
"""

from __future__ import annotations

from itertools import combinations

from models.ts7.signals import Selection, WiredOr
from proofs.ts7_brake_chain import WORDS
from safety import (
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    all_of,
    at_most,
    claim,
    count,
    implies,
    select,
    wired_and,
    wired_or,
    word,
)

PAIRS = list(combinations(WORDS, 2))
TOUCHING = {
    kind: [Fault(make(), [f"line.{x}", f"line.{y}"], name=f"{x} and {y} {kind}") for x, y in PAIRS]
    for kind, make in (("wired-OR", wired_or), ("wired-AND", wired_and))
}
TWO_TOUCH = at_most(1, [*TOUCHING["wired-OR"], *TOUCHING["wired-AND"]])


def one_signal(s: Seen) -> Bit:
    """One line is active, or none."""
    return count(*(s.lines[line] for line in WORDS)) <= 1


def no_more_than_given(s: Seen) -> Bit:
    """The word is not above that of the signal that is given, 0 without one."""
    given = word(0, 8)
    for line, value in WORDS.items():
        given = select(s.lines[line], value, given)
    return s.word <= given


def together(*lines: str, fault: str = "") -> Scenario:
    """These lines active, for three frames."""
    return Scenario(3, {f"lines.{line}": True for line in lines}, present=[fault] if fault else [])


@claim(Selection, faults=TWO_TOUCH, given=one_signal, expect=PROVED, requirement="TS7-16", source="[A] lowest line",
       witness=together("s65", fault="s25 and s65 wired-OR"))  # fmt: skip
def lines_that_touch_permit_no_more(s: Seen) -> Bit:
    """One signal, any two lines touching, wired-OR or wired-AND: the word is never above that of the signal."""
    return no_more_than_given(s)


@claim(WiredOr, faults=TWO_TOUCH, given=one_signal, expect=REFUTED, requirement="TS7-16", source="[A] wired rows",
       twin_of=lines_that_touch_permit_no_more, scenario=together("s65", fault="s25 and s65 wired-OR"))  # fmt: skip
def lines_that_touch_permit_no_more_on_wired_rows(s: Seen) -> Bit:
    """The same on wired rows.  False: signal 65, its line touching that of 25, reads as 90."""
    return no_more_than_given(s)


@claim(WiredOr, expect=PROVED, requirement="TS7-16", source="[A] wired rows", witness=together("s25", "s65"))
def wired_rows_permit_no_less_than_any_signal(s: Seen) -> Bit:
    """Wired rows, any lines active: the word is not below that of any active line, so never below the lowest."""
    return all_of(*(implies(s.lines[line], s.word >= value) for line, value in WORDS.items()))


@claim(WiredOr, expect=REFUTED, requirement="TS7-16", source="[A] wired rows", defeat=True,
       twin_of=wired_rows_permit_no_less_than_any_signal, scenario=together("s25", "s65"))  # fmt: skip
def wired_rows_permit_no_more_than_the_highest(s: Seen) -> Bit:
    """Wired rows, any lines active: the word is that of some line, at most the highest.  False: 53 | 138 is 191."""
    return implies(~s.lines.s90, s.word <= WORDS["s75"]) & implies(~s.lines.s90 & ~s.lines.s75, s.word <= WORDS["s65"])

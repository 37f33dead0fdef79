"""What is declared of a paper: one entry for everything printed that is recomputed, and the register of all."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from safety.audit.exceptions import AuditError
from safety.audit.known import Known, printed
from safety.audit.spans import Span
from safety.audit.text import Text
from safety.audit.verdict import CONFIRMED, INCONSISTENT, MISPRINT, NOT_DERIVABLE, Judged

_declared: dict[str, Entry] = {}


@dataclass(eq=False, kw_only=True)
class Entry:
    """Something printed; `judge` gives the verdict on it, unless it is that on a `claim`."""

    id: str
    paper: str
    kind: str
    printed: str
    requirement: str = ""
    unit: str = ""
    where: str
    how: str
    claim: str = ""
    place: tuple[str, int] = ("", 0)
    judge: Callable[[], Judged] = field(repr=False)
    inputs: Callable[[], list[str]] = field(default=list, repr=False)

    @cached_property
    def judged(self) -> Judged:
        """The verdict, worked out once.  Raises AuditError."""
        return self.judge()

    def evaluate(self) -> dict[str, Any]:
        """The entry under "figures" of the results document.

        Raises AuditError, with the id, for what cannot be judged; Disagreement of solvers.
        """
        try:
            judged = self.judged.to_json() | ({"claim": self.claim} if self.claim else {})
            inputs = self.inputs()
        except (AuditError, ArithmeticError) as error:
            raise AuditError(f"{self.id}: {error}") from None
        about = {"id": self.id, "paper": self.paper, "where": self.where, "kind": self.kind, "printed": self.printed}
        about |= {"requirement": self.requirement} if self.requirement else {}
        return {**about, "unit": self.unit or None, "how": self.how, "inputs": inputs, **judged}


@dataclass(eq=False, kw_only=True)
class Figure(Entry):
    """A printed number; it may be an input of others.  `if_printed` gives the verdict on another text in its place."""

    text: Text
    if_printed: Callable[[Text], Judged] = field(repr=False)

    def as_printed(self) -> Known:
        """The number that stands in print."""
        return Known(Span(self.text.value), self.text.span, "P", self.text.text)

    def as_meant(self) -> Known:
        """The same, unless it is a misprint: then the number that was meant, or what it is once others are mended."""
        judged = self.judged
        if judged.mended:
            return printed(judged.mended)
        if judged.verdict == MISPRINT and judged.value is not None:
            return Known(judged.value, judged.value, "D", judged.recomputed)
        return self.as_printed()


def by_claim(claim: str, verdict: str) -> Judged:
    """The verdict on words that a claim states, from that on the claim; of none, nothing is known."""
    if verdict == "proved":
        return Judged(CONFIRMED, f"{claim} is proved")
    if verdict == "refuted":
        return Judged(INCONSISTENT, f"{claim} is refuted")
    return Judged(NOT_DERIVABLE, "", f"{claim} is {verdict}" if verdict else f"{claim} has no verdict here yet")


def declared() -> tuple[Entry, ...]:
    """All that is declared so far, in order.  A file that is imported again replaces its own."""
    return tuple(_declared.values())


def register(new: Entry) -> None:
    """Add an entry, with the line outside this package that declares it.  Raises AuditError for an id that is taken."""
    caller, package = sys._getframe(1), Path(__file__).parent
    while Path(caller.f_code.co_filename).parent == package and caller.f_back is not None:
        caller = caller.f_back
    new.place = caller.f_code.co_filename, caller.f_lineno
    old = _declared.get(new.id)
    if old is not None and old.place != new.place:
        first, second = (f"{file}:{line}" for file, line in (old.place, new.place))
        raise AuditError(f"{new.id} is declared twice, at {first} and {second}; ids are unique")
    _declared[new.id] = new

"""What is declared of a paper: one entry for everything printed that is recomputed, and the register of all."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from safety.audit.exceptions import AuditError
from safety.audit.known import Known, printed
from safety.audit.spans import Span
from safety.audit.text import Text
from safety.audit.verdict import CONFIRMED, INCONSISTENT, MISPRINT, Judged

ASSUMED_TAG = "[A]"
_declared: dict[str, Entry] = {}


@dataclass(eq=False, kw_only=True)
class Entry:
    """Something printed; `judge` gives the verdict on it, unless it is that on a `claim`, or on what that `denies`."""

    id: str
    paper: str
    kind: str
    printed: str
    published: bool = True
    requirement: str = ""
    unit: str = ""
    where: str
    how: str
    claim: str = ""
    denies: bool = False
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
            judged |= {"denies": True} if self.denies else {}
            inputs = self.inputs()
        except (AuditError, ArithmeticError) as error:
            raise AuditError(f"{self.id}: {error}") from None
        about: dict[str, Any] = {
            "id": self.id,
            "paper": self.paper,
            "where": self.where,
            "kind": self.kind,
            "printed": self.printed,
        }
        about |= {} if self.published else {"published": False}
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


def by_claim(
    claim: str, found: Mapping[str, Any] | None = None, altered: Sequence[str] = (), denies: bool = False
) -> Judged:
    """The verdict on words that a claim states, by the entry of the claim in the results; without one there is none.

    Words that deny what the claim states are confirmed where it is refuted.  `altered` are parameters that were set to
    other values than the words are about: then nothing is decided either.
    """
    if found is None:
        return Judged(None, "", f"not run: `rightside verify`, or `rightside prove -k {claim}`")
    if altered:
        return Judged(None, "", f"not judged: {claim} was asked with another {', '.join(altered)}")
    verdict = found["verdict"]
    if verdict not in ("proved", "refuted"):
        return Judged(None, "", f"open: {claim} is {verdict}")
    agrees = (verdict == "proved") != denies
    return Judged(CONFIRMED if agrees else INCONSISTENT, f"{claim} is {verdict}", assumed=_assumed(found))


def _assumed(claim: Mapping[str, Any]) -> tuple[str, ...]:
    """What a claim assumes: its parameters, premises and source that are tagged A."""
    tagged = [each for each in claim.get("parameters") or () if ASSUMED_TAG in (each.get("source") or "")]
    texts = [_parameter(each) for each in tagged]
    said = [*(claim.get("assumptions") or ()), claim.get("source") or ""]
    return tuple(dict.fromkeys([*texts, *(text for text in said if ASSUMED_TAG in text)]))


def _parameter(each: Mapping[str, Any]) -> str:
    if each.get("value") is None:
        return f"{each['name']}, whatever is admitted"
    return f"{each['name']} = {each['value']} {each.get('unit') or ''}".rstrip()


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

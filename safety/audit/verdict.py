"""The verdict on something printed, and what it rests on."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

from safety.audit.spans import Span

Verdict = Literal["confirmed", "rounding", "misprint", "inconsistent", "not derivable", "assumed"]
CONFIRMED: Verdict = "confirmed"
ROUNDING: Verdict = "rounding"
MISPRINT: Verdict = "misprint"
INCONSISTENT: Verdict = "inconsistent"
NOT_DERIVABLE: Verdict = "not derivable"
ASSUMED: Verdict = "assumed"
AGREES = (CONFIRMED, ROUNDING)


@dataclass(frozen=True)
class Judged:
    """A verdict with the recomputed value, why, and where there is one the text that a slip of the pen spoilt.

    `verdict` is None as long as the claim that decides has none.
    """

    verdict: Verdict | None
    recomputed: str
    note: str = ""
    mended: str = ""
    slip: str = ""
    evidence: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()
    agreed_by: tuple[str, ...] = ()
    counterexample: dict[str, str] = field(default_factory=dict)
    value: Span | None = field(default=None, compare=False)  # of a number, in its printed unit

    def unless(self, other: Judged, told: str) -> Judged:
        """The same with an admissible value of an assumed input for which the verdict is another one."""
        note = f"{self.verdict} with the reference, {other.verdict} with {told}"
        return Judged(ASSUMED, self.recomputed, note, assumed=self.assumed, value=self.value)

    def to_json(self) -> dict[str, Any]:
        """The keys of an entry under "figures" that the judgement fills."""
        entry: dict[str, Any] = {"verdict": self.verdict, "recomputed": self.recomputed, "note": self.note}
        for name in ("mended", "slip", "counterexample"):
            if getattr(self, name):
                entry[name] = getattr(self, name)
        if self.value is not None:
            entry["value"] = {"value": float(self.value.middle), "exact": str(self.value.low)}
            if not self.value.exact:
                entry["value"] = {"low": float(self.value.low), "high": float(self.value.high)}
        for name in ("evidence", "assumed", "agreed_by"):
            if getattr(self, name):
                entry[name] = list(getattr(self, name))
        return entry

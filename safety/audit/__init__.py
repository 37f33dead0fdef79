"""Audit of published figures: every printed number and equation recomputed, with a verdict that nobody enters.

    from safety.audit import Paper, printed

    paper = Paper("clock", "A clock, 1960")
    paper.symbol("f", "kHz", "oscillator", printed("32.768"))
    paper.figure("period", "30.5", "us", where="page 2", by="1/f")

Verdicts: confirmed · rounding · misprint · inconsistent · not derivable · assumed; see `number`, `equation`,
`statement` and `wording` for how each comes about.
"""

from safety.audit.entry import Entry, Figure, declared
from safety.audit.exceptions import AuditError
from safety.audit.known import Known, assumed, derived, printed, reconstructed, unknown
from safety.audit.paper import Paper
from safety.audit.spans import Span, sqrt
from safety.audit.verdict import Judged

__all__ = [
    "AuditError",
    "Entry",
    "Figure",
    "Judged",
    "Known",
    "Paper",
    "Span",
    "assumed",
    "declared",
    "derived",
    "printed",
    "reconstructed",
    "sqrt",
    "unknown",
]

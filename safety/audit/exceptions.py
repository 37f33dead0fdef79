"""What an audit refuses: a declaration that cannot be judged."""

from __future__ import annotations


class AuditError(ValueError):
    """A figure, formula or unit that cannot be read or judged; the message has the text and what to write instead."""

    exit_code = 2


class Undecided(AuditError):
    """What neither a point nor boxes that cover all the ranges could settle."""

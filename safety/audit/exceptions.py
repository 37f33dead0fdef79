"""What an audit refuses: a declaration that cannot be judged."""

from __future__ import annotations


class AuditError(ValueError):
    """A figure, formula or unit that cannot be read or judged; the message has the text and what to write instead."""

    exit_code = 2

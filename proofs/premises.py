"""Premises by the piece: what a claim is given, of which its twins leave out one."""

from __future__ import annotations

from collections.abc import Callable

from safety import Bit, Seen, all_of

Premise = Callable[[Seen], Bit]


def together(*premises: Premise) -> Premise:
    """All of these, told as the list of what each says."""

    def given(s: Seen) -> Bit:
        return all_of(*(premise(s) for premise in premises))

    given.__doc__ = "; ".join((premise.__doc__ or "").rstrip(".") for premise in premises)
    return given

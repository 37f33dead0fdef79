"""Candidate lemmas: a guard and what it entails, a bit or a lower bound on a whole-number expression.

A bound can give way (become lower) when a state is found that it excludes and must not; a bit can only be dropped.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

from safety.prove.synthesis.sampling import Rows, evaluate
from safety.terms import Bit, Int
from safety.terms.graph import describe, postorder
from safety.terms.values import implies

if TYPE_CHECKING:
    from safety.prove.synthesis.sampling import Lanes

MOST_RETREATS = 8


@dataclass(eq=False)
class Candidate:
    """`guard` implies `shown`, or `shown >= bound`."""

    guard: Bit
    shown: Bit | Int
    bound: int | None = None
    text: str = ""
    retreats: int = field(default=0)

    @property
    def lemma(self) -> Bit:
        """The candidate as a formula over registers."""
        conclusion = self.shown if self.bound is None else cast(Int, self.shown) >= self.bound
        if self.guard.is_const and self.guard.attr:
            return cast(Bit, conclusion)
        return implies(self.guard, cast(Bit, conclusion))

    @property
    def name(self) -> str:
        """A short text: what it says."""
        shown = self.text or describe(self.shown)
        conclusion = shown if self.bound is None else f"{shown} >= {self.bound}"
        return conclusion if self.guard.is_const else f"{describe(self.guard)}: {conclusion}"

    @functools.cached_property
    def product(self) -> bool:
        """Whether registers are multiplied with one another: hard questions for a solver."""
        return any(t.op == "mul" and not any(a.is_const for a in t.args) for t in postorder([self.shown]))

    def retreat(self, value: int | None) -> bool:
        """Lower the bound to a value; false when the candidate has to be dropped instead."""
        if self.bound is None or value is None or self.retreats >= MOST_RETREATS:
            return False
        self.retreats += 1
        self.bound = min(self.bound, value)
        return True


def fit(candidates: Sequence[Candidate], rows: Rows) -> list[Candidate]:
    """The candidates that agree with sampled states; bounds are lowered to them, or set by them.

    Where there are no states, those remain whose bounds are known.
    """
    if not rows or not len(next(iter(rows.values()))):
        return [c for c in candidates if c.bound is not None or c.shown.sort.kind == "bit"]
    columns = evaluate([t for c in candidates for t in (c.guard, c.shown)], rows)
    kept: list[Candidate] = []
    for c, guard, shown in zip(candidates, columns[::2], columns[1::2], strict=True):
        if c.shown.sort.kind == "bit":
            if bool((shown | ~guard).all()):
                kept.append(c)
            continue
        least = _least(guard, shown)
        if least is not None:
            c.bound = least if c.bound is None else min(c.bound, least)
        if c.bound is not None:
            kept.append(c)
    return kept


def _least(guard: Lanes, values: Lanes) -> int | None:
    inside = values[guard.astype(bool)]
    return int(inside.min()) if len(inside) else None

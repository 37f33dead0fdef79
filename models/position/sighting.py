"""A balise that is seen at a true place, as a bench for the correction.

The surroundings choose the true position of the head, the position on board, and which balise of the line data is seen:
none of them for a balise that is not listed.
"""

from __future__ import annotations

from typing import NamedTuple, Self

from models.position.correction import Ahead, Correction, Crowded, Matched, Where
from models.position.odometer import Fix, step_s
from safety import U2, Bit, Model, Real


class Sight(NamedTuple):
    """A balise, if `seen`, and the true position of the head."""

    seen: Bit
    kind: U2
    which: Ahead  # the balise of the line data that it is
    head: Real  # m


class Beheld(NamedTuple):
    """The balise as it stands in the line data, and what the correction makes of it."""

    place: Real
    kind_of: U2
    layout: Real  # w of the widest interval, m
    matched: Matched


class Sighting(Model, tick_s=step_s):
    """Correction and truth."""

    correction: Correction

    def step(self, sight: Sight, at: Where, code: Fix) -> tuple[Self, Beheld]:
        """A balise, or none, or what a code tells."""
        part = self.correction
        own = part.data.stored().one_of(sight.which)
        correction, matched = part.step(sight.seen, sight.kind, at, code)
        following = type(self)(correction=correction)
        return following, Beheld(own.place, own.kind, part.window(part.widest), matched)


class CrowdedSighting(Sighting, tick_s=step_s):
    """The same with any line data."""

    correction: Crowded

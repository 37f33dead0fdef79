"""From a code that is read to the place of the train: the groups that are installed, each with its place.

    read as it stands    the train runs with rising places: it is at the first balise, and the way since, beyond it
    read as its mirror   it runs with falling places: it is at the last balise, less the way since
    not installed        nothing is told

The way since the first balise is counted; a slip or slide in it has the group rejected.  So the place is known within
e + eps times that way.  Groups are refused where two could be taken for each other, one way or the other, or where they
stand too near each other for the guard.
Source: codes checked against those installed, direction by codes without mirror images [P]; places, numbers [A].
"""

from __future__ import annotations

import itertools
from fractions import Fraction
from typing import ClassVar, NamedTuple

from models.kinematics import nearest
from models.position.code import SPAN, Code, check, mirror
from models.position.decoder import Decoder, DecoderData, Reading
from models.position.odometer import Fix, step_s
from safety import Bit, Model, ModelError, Real, any_of, point, real, require, select


class Group(NamedTuple):
    """A group, read with rising places, and the place of its first balise, m."""

    code: Code
    at: Fraction


class Told(NamedTuple):
    """What is known at the end of the stretch, in places of the line; `rising` is the direction of running."""

    fix: Fix
    rising: Bit


class Placing(DecoderData, tick_s=step_s):
    """The groups of a line."""

    groups: ClassVar[tuple[Group, ...]] = (
        Group((5, 12, 30), Fraction(1_000)),
        Group((7, 20, 31), Fraction(30_000)),
        Group((2, 25, 32), Fraction(60_000)),
    )

    def step(self, reading: Reading) -> tuple[Placing, Told]:
        """What a reading tells."""
        self.check_groups()
        rising = [(reads(reading, code), real(at)) for code, at in self.groups]
        falling = [(reads(reading, mirror(code)), real(at + SPAN)) for code, at in self.groups]
        first = real(0)
        for here, place in (*rising, *falling):
            first = select(here, place, first)
        up = any_of(*(here for here, _ in rising))
        given = point("told", reading.accepted & (up | any_of(*(here for here, _ in falling))))
        place = first + select(up, reading.origin, -reading.origin)
        off = self.jitter + self.eps * reading.origin
        return type(self)(), Told(Fix(given, place - off, place, place + off), up)

    def check_groups(self) -> None:
        """Refuse groups that can be taken for each other, or are too near for the guard."""
        check_directed(self.groups)
        for before, after in itertools.pairwise(sorted(self.groups, key=lambda group: group.at)):
            least = before.at + SPAN + 2 * (SPAN + self.slack())
            label = f"ends of the groups at {before.at} and {after.at} m more than 2W apart"
            require(label, real(after.at) > least, nearest("place", least, "m", side="any above"))


class AnyGroups(Placing, tick_s=step_s):
    """To be refuted: a code and its mirror image, both installed."""

    groups = (Group((5, 12, 30), Fraction(1_000)), Group((10, 28, 35), Fraction(30_000)))

    def check_groups(self) -> None:
        """Refuse nothing."""


class CodeReader(Model, tick_s=step_s):
    """Decoder and groups: from balises to a fix."""

    decoder: Decoder
    placing: Placing

    def step(self, run: Real, balise: Bit, reverses: Bit, slips: Bit) -> tuple[CodeReader, Told]:
        """Inputs as those of the decoder; the fix is as of the end of the stretch."""
        decoder, reading = self.decoder.step(run, balise, reverses, slips)
        placing, told = self.placing.step(reading)
        return type(self)(decoder=decoder, placing=placing), told


def reads(reading: Reading, code: Code) -> Bit:
    """Whether this is the code that is read."""
    return (reading.p == code[0]) & (reading.q == code[1]) & (reading.r == code[2])


def check_directed(groups: tuple[Group, ...]) -> None:
    """Refuse codes that do not tell place and direction: `ModelError` for one installed twice, either way."""
    seen: dict[Code, Code] = {}
    for code, at in groups:
        for read in (check(code), mirror(code)):
            if read in seen:
                raise ModelError(
                    f"group {code} at {at} m reads {read} as {seen[read]} does, one of them backwards; install a code "
                    "that is neither its own mirror image nor that of another one, e.g. of models.position.code_sets"
                )
            seen[read] = code

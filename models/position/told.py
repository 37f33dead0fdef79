"""A train that has passed an installed group, either way, as a bench for what the code tells."""

from __future__ import annotations

from typing import NamedTuple, Self

from models.position.code import SPAN, mirror
from models.position.decoder import Reading
from models.position.odometer import step_s
from models.position.placing import AnyGroups, Placing, Told, reads
from safety import U2, Bit, Model, Real, bit, real, select


class Ran(NamedTuple):
    """The group that was passed, by its number, which way, and the true way since."""

    group: U2
    rising: Bit
    jitter: Real  # of the first detection, m
    way: Real  # since then, m


class Truth(NamedTuple):
    """What is true, and what is told."""

    head: Real  # place, m
    own: Bit  # the reading is the group's, for this direction
    told: Told


class Telling(Model, tick_s=step_s):
    """Installed groups and truth."""

    placing: Placing

    def step(self, ran: Ran, reading: Reading) -> tuple[Self, Truth]:
        """A reading after a group."""
        first, own = real(0), bit(False)
        for n, (code, at) in enumerate(self.placing.groups):
            here = ran.group == n
            first = select(here, select(ran.rising, real(at), real(at + SPAN)), first)
            own = own | (here & select(ran.rising, reads(reading, code), reads(reading, mirror(code))))
        head = first + select(ran.rising, ran.jitter + ran.way, -ran.jitter - ran.way)
        placing, told = self.placing.step(reading)
        return type(self)(placing=placing), Truth(head, own, told)


class UndirectedTelling(Telling, tick_s=step_s):
    """The same with a code and its mirror image."""

    placing: AnyGroups

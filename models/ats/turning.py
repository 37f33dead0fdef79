"""How a diverging route comes to the target of the turnout on board: branch balise, coil, target; without positions.

`due` is the truth: a branch balise has been passed while the diverging route was set.
Source: branch balise [P]; rules of the pattern set [A].
"""

from __future__ import annotations

from typing import NamedTuple

from models.ats.ats_sp import Coil
from models.ats.stretch import Balises
from models.ats.supervision import Target
from models.position.correction import BRANCH
from models.position.odometer import step_s
from safety import U2, Bit, Model, bit, power_up, real


class Turned(NamedTuple):
    """What a cycle shows."""

    unlimited: Bit  # the diverging route was told, and no pattern acts


class Turning(Model, tick_s=step_s):
    """Branch balise to target."""

    balises: Balises
    coil: Coil
    target: Target
    due: Bit = power_up(False)

    def step(self, reached: Bit, kind: U2, diverging: Bit) -> tuple[Turning, Turned]:
        """One cycle: whether a balise is passed, of which kind, and the route."""
        balises, shift = self.balises.step(reached, kind, bit(False), diverging)
        coil, read = self.coil.step(shift)
        made = read.seen & (read.kind == BRANCH) & read.stop
        target, demand = self.target.step(made, real(0), bit(False))
        due = self.due | (reached & (kind == BRANCH) & diverging)
        return type(self)(balises=balises, coil=coil, target=target, due=due), Turned(due & ~demand.on)

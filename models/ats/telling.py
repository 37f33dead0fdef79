"""How a home signal at stop comes to its target on board: balises, oscillation unit, coil, release; without positions.

What `Stretch` shows for single rides is provable of this part for every order of balises.  `due` is the truth: a signal
balise has been passed at stop and the signal has not been cleared since.
Source: states of balises [P]; rules of the pattern set [A].
"""

from __future__ import annotations

from typing import NamedTuple

from models.ats.ats_sp import Coil
from models.ats.stretch import Balises, FalseShift
from models.ats.supervision import Target
from models.position.correction import RELEASE, SIGNAL
from models.position.odometer import step_s
from safety import U2, Bit, Model, bit, point, power_up, real


class Told(NamedTuple):
    """What a cycle shows."""

    forgotten: Bit  # a stop was passed, and no pattern acts


class Telling(Model, tick_s=step_s):
    """Balises to target."""

    balises: Balises
    unit: FalseShift
    coil: Coil
    target: Target
    due: Bit = power_up(False)

    def step(self, reached: Bit, kind: U2, stop: Bit) -> tuple[Telling, Told]:
        """One cycle: whether a balise is passed, of which kind, and the signal."""
        balises, shift = self.balises.step(reached, kind, stop, bit(False))
        unit, shown = self.unit.step(shift)
        coil, read = self.coil.step(shown)
        made = read.seen & (read.kind == SIGNAL) & read.stop
        told = read.seen & ((read.kind == SIGNAL) | (read.kind == RELEASE)) & ~read.stop
        target, demand = self.target.step(made, real(0), told | point("phase_released", bit(False)))
        due = stop & (self.due | (reached & (kind == SIGNAL)))
        return type(self)(balises=balises, unit=unit, coil=coil, target=target, due=due), Told(due & ~demand.on)

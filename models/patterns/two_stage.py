"""Two-stage fixed pattern: a stored curve from each of two balises, whose distances to the signal are fixed by rule.

The first balise starts a curve that falls to V_mid and holds it; the second starts the curve to the stop, at which
point both meet: V_mid is the ceiling at D2.  Nothing tells the train where a balise really lies: one that is laid
nearer than the rule is a latent wrong-side fault.  One step is one cycle of 0.1 s.
Source: two-stage fixed pattern (section 2.3); D1, D2, V_mid [A].

Main results: ceilings of 98.175 km/h at the first and 50.543 km/h (V_mid) at the second balise.
"""

from __future__ import annotations

from fractions import Fraction

from models.kinematics import (
    B_SERVICE,
    MARGIN,
    T_SERVICE,
    Interval,
    at_least,
    ceiling,
    not_negative,
    refuse,
    stops_within,
)
from models.patterns.slips import Plain
from models.patterns.supervised import Outcome
from models.patterns.supervisor import Seen
from models.patterns.train import TICK, Brake, T, Train
from safety import Bit, Model, Real, bit, parameter, point, power_up, require, select

D1, D2 = Fraction(600), Fraction(180)  # m from the balises to the signal [A]
NEARER = "[A] by how much the balise is read nearer than the rule; D2 or more: not at all"


def passing_ceilings(
    d1: Fraction = D1, d2: Fraction = D2, m: Fraction = MARGIN, b: Fraction = B_SERVICE, t: Fraction = T_SERVICE
) -> tuple[Interval, Interval]:
    """Ceilings, m/s, on passing the first and the second balise, the second being V_mid.

    Raises ModelError where the second lies within the margin, or the first no farther than the second.
    """
    not_negative("margin", m, "m")
    if d2 <= m:
        refuse("D2", d2, "m", "no way is left before the margin", f"above {at_least(m)} m")
    if d1 < d2:
        refuse("D1", d1, "m", "the first balise lies behind the second", f"{at_least(d2)} m")
    return ceiling(d1 - m, b, t), ceiling(d2 - m, b, t)


class TwoStageRun(Model, tick_s=TICK):
    """A train without traction between the first balise and the signal."""

    guard: Plain
    brake: Brake
    train: Train
    second: Bit = power_up(False)  # the second balise was read
    d2: Real = parameter(D2, unit="m", within=(20, 600), source="[A] second balise to signal")
    margin: Real = parameter(MARGIN, unit="m", within=(0, 50), source="[A] before the signal")
    nearer_1: Real = parameter(0, unit="m", within=(0, 600), source=NEARER)
    nearer_2: Real = parameter(0, unit="m", within=(0, 600), source=NEARER)

    def step(self, reached: Real, moving: Real) -> tuple[TwoStageRun, Outcome]:
        """One cycle."""
        b, t, v, x, left = self.guard.b_s, self.guard.t_s, self.train.v, self.train.x, self.brake.left
        mid = self.d2 - self.margin
        require("way is left before the margin at the second balise", mid > 0,
                lambda: f"the nearest admissible D2 is above {at_least(self.margin.attr)} m")  # fmt: skip
        first = select(x + self.nearer_1 > mid, x + self.nearer_1, mid)
        believed = select(self.second, x + self.nearer_2, first)
        guard, lines = self.guard.step(Seen(v, v, believed, believed, bit(False)))
        brake, acts = self.brake.step(lines.service, t)
        train = self.train.step(reached, moving, select(acts, -b, 0))
        second = self.second | point("second_balise", train.x + self.nearer_2 <= mid)
        outcome = Outcome(lines, stops_within(v, x, b, left), (left >= 0) & (left <= t - T))
        return type(self)(guard=guard, brake=brake, train=train, second=second), outcome

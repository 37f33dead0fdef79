"""A train in discrete time: its front towards a point, as ghost truth for all that supervises it.

One step is one cycle of 0.1 s [A].  The surroundings choose the speed at the end of the cycle and for how long of it
the train moves (`models.kinematics.motion`): any constant acceleration within the cycle, a standstill on the way
included, exactly and without a quotient.  They are bound by `push`, the greatest acceleration that brakes and traction
allow: below 0 it is a brake that gives at least so much.
Speeds in m/s, distances in m in the direction of running.
"""

from __future__ import annotations

from fractions import Fraction

from models.kinematics import CYCLE, Quantity, at_least, gains_at_most, is_motion, moved, refuse, shown, way_doubled
from safety import ANY, Bit, Model, Real, assume, point, power_up, select

TICK = "0.1"
T = CYCLE


class Train(Model, tick_s=TICK):
    """The front of a train; it does not run backwards."""

    v: Real = power_up(ANY)  # m/s
    x: Real = power_up(ANY)  # m left before the protected point, the margin taken off; below 0 behind it

    def step(self, reached: Real, moving: Real, push: Real) -> Train:
        """One cycle; `reached` m/s at its end, `moving` s of it, `push` m/s^2 at most."""
        assume("the train runs forward", self.v >= 0)
        assume("it moves until the cycle ends or it stands", is_motion(reached, moving, T))
        assume("it gains no more speed than it can, a braked train loses no less than is guaranteed",
               gains_at_most(self.v, reached, moving, push))  # fmt: skip
        return type(self)(v=reached, x=self.x - way_doubled(self.v, reached, moving) / 2)


class Brake(Model, tick_s=TICK):
    """A brake on an energise-to-release line, as slow as a reaction budget allows.

    The budget t runs from the last sample that permitted the train to run: one cycle to the next sample, one of
    processing until the line drops, the build-up, and up to one cycle more, as the brake counts in whole cycles only.
    So it stands for every brake that builds up within t - 3 T.  It is not counted on in the cycle that releases it.
    """

    left: Real = power_up(ANY)  # s, most time until it acts, should its line be dropped now

    def step(self, asked: Bit, t: Real) -> tuple[Brake, Bit]:
        """One cycle; whether it acts in the whole of it, its line having been dropped long enough."""
        down = point("line_down", asked)
        acts = point("acts", down & (self.left <= T))
        left = select(down, select(acts, 0, self.left - T), t - T)
        return type(self)(left=left), acts


def check_budget(t: Fraction, build_up: Fraction) -> None:
    """Refuse a reaction budget that a brake with this build-up time does not keep; ModelError with the least."""
    least = build_up + 3 * T
    if t < least:
        refuse(
            "reaction budget", t, "s", f"sample, processing and {shown(build_up)} s of build-up", f"{at_least(least)} s"
        )


def runs(v: Quantity, accelerations: list[Fraction]) -> tuple[list[Fraction], list[Fraction]]:
    """`reached` and `moving` for each cycle of a train at v that is given an acceleration in each: for scenarios."""
    pairs = []
    for acceleration in accelerations:
        pairs.append(moved(v, acceleration, T))
        v = pairs[-1][0]
    return [reached for reached, _ in pairs], [moving for _, moving in pairs]

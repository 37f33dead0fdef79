"""Follow-up control: speed-distance diagrams of runs of the regulator along its curve, on gradients.

Source: principle [P]; regulator, lag, limits of the effort [A].

Main results: with one curve at -20 permille the train runs 1.5 to 1.8 km/h above the curve, with that of the
gradient's bin 0.3 to 0.4 km/h; where the limits of the effort leave no margin it leaves the curve for good.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from math import sqrt
from typing import NamedTuple

from models.kinematics import B_SERVICE, CYCLE, KMH
from models.patterns.follow_up import SHARPEST, FollowUp, WithoutMargin, pull
from proofs.patterns_drawn import speed, to_go
from safety.exhibits import Axis, Curve, Mark, Rule, plot
from safety.trace import Live

FROM = 100.0  # km/h, where the brake starts
GRAIN = 10**7  # parts of q
SOURCE = "[P] principle; runs of the model"
ASSUMED = ("[A] b_0 2.5 km/h/s, gain 0.5 1/s, lag 0.5 s, effort 0 to 1.2 m/s^2", "[A] gradients +-20 ‰")
STRONG = Fraction(11, 10)  # m/s^2: a curve that leaves no margin below 1.2 at -20 permille


class Passed(NamedTuple):
    """A place of a run: m to go, speed and the curve's speed there, km/h, and the model's error, km/h."""

    x: float
    v: float
    curve: float
    error: float


def along(model: type[FollowUp], gradient: int, b: Fraction = B_SERVICE) -> list[Passed]:
    """A run from the brake start on a gradient (off the curve's, permille) to where the curve is no longer followed."""
    live = Live(model, settings={"curve": b})
    rate, cycle, off = float(b), float(CYCLE), float(pull(gradient))
    v = FROM * float(KMH)
    x, passed = v * v / (2 * rate), list[Passed]()
    while True:
        curve, state = sqrt(2 * rate * x), live.state
        passed.append(Passed(x, *(each / float(KMH) for each in (v, curve, float(state["error"])))))
        a = rate + float(state["surplus"]) + off
        later = v - a * cycle
        x -= (v + later) / 2 * cycle
        v, following = later, sqrt(2 * rate * x)
        q = Fraction(round(GRAIN * rate * cycle / (curve + following - rate * cycle)), GRAIN)
        if q > SHARPEST:
            return passed
        live.step({"i": gradient, "q": q})


@cache
def runs() -> dict[str, list[Passed]]:
    """One curve at both ends of the gradients, and the curve of a bin 4 permille off."""
    cases = {"-20 ‰, one curve": -20, "-4 ‰ off the selected curve": -4, "+20 ‰, one curve": 20}
    return {label: along(FollowUp, gradient) for label, gradient in cases.items()}


@plot(id="patterns_plots.follow_up", title="Follow-up control along its curve", requirement="SP-P2", assumed=ASSUMED,
      source=SOURCE, x=to_go(600, 0, "the stop"), y=speed(110))  # fmt: skip
def follow_up() -> Iterator[Mark]:
    """All runs stay close to the curve; one with a curve of 1.1 m/s^2 and no margin in the effort does not."""
    followed = runs()
    yield Curve("curve, 2.5 km/h/s", [(p.x, p.curve) for p in followed["-20 ‰, one curve"]])
    for label, passed in followed.items():
        yield Curve(label, [(p.x, p.v) for p in passed])
    leaves = along(WithoutMargin, -20, STRONG)
    yield Curve("curve, 1.1 m/s^2", [(p.x, p.curve) for p in leaves])
    yield Curve("-20 ‰, no margin", [(p.x, p.v) for p in leaves])
    yield Rule("the stop", x=0)


@plot(id="patterns_plots.follow_up_error", title="Follow-up control: how far above the curve the train runs",
      requirement="SP-P2", assumed=ASSUMED, source=SOURCE, x=to_go(600, 0, "the stop"),
      y=Axis("speed above the curve", "km/h", low=-3, high=6))  # fmt: skip
def follow_up_error() -> Iterator[Mark]:
    """The error settles where the correction is that of the gradient; without margin it grows without end."""
    for label, passed in runs().items():
        yield Curve(label, [(p.x, p.error) for p in passed])
    yield Curve("-20 ‰, no margin", [(p.x, p.error) for p in along(WithoutMargin, -20, STRONG)])
    yield Rule("on the curve", y=0)

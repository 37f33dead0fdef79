"""Speed steps and the two-stage fixed pattern: speed-distance diagrams of runs of the models.

Source: speed steps, stored pattern [P]; ladder, worst train, distances [A].

Main results: the worst train admitted needs 825.0 m where a pattern needs 750.0; a better one brakes as early, though a
pattern of its own is 518.5 m.  In sections that are laid for the better one the worst passes the signal; so does one
whose balises lie nearer than the rule.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from models.kinematics import B_SERVICE, CYCLE, KMH, MARGIN, T_SERVICE, moved, mps
from models.patterns.step_supervision import LADDER, WORST, Sections, ShortSections, sections
from models.patterns.two_stage import D1, D2, TwoStageRun, passing_ceilings
from proofs.patterns_drawn import BRAKES, SERVICE, Course, Gear, Place, drawn, pattern, speed, steps, to_go
from proofs.patterns_plots import at_point, braked
from safety import run
from safety.exhibits import Mark, Points, Rule, plot
from safety.trace import Live

BETTER = 3 * KMH  # m/s^2 [A]
BEFORE = 60  # m ahead of the first section
SAMPLES, FAR_BEYOND = 20, Fraction(-1000)


def slowed(v: Fraction, limit: Fraction, x: Fraction, gear: Gear, until: Fraction) -> list[Place]:
    """Through a section that begins at x: free run, brake down to the limit, then at the limit; m to go, km/h."""
    reached = x - v * gear.t - (v * v - limit * limit) / (2 * gear.b)
    if reached < until:
        return braked(v, x, gear, until)
    falling = [v + (limit - v) * n / SAMPLES for n in range(SAMPLES + 1)]
    begins = x - v * gear.t
    along = [(begins - (v * v - each * each) / (2 * gear.b), each / KMH) for each in falling]
    held = [(until, limit / KMH)] if limit > 0 else []
    return [(x, v / KMH), *along, *held]


def through(model: type[Sections], lengths: Sequence[Fraction], b: Fraction) -> Course:
    """A train that enters each section as fast as it may: admitted, and judged, by a run of the model."""
    course, braking = Course(), False
    v, x = mps(LADDER[0]), sum(lengths, Fraction(0))
    course.places.append((x + BEFORE, v / KMH))
    rows: list[dict[str, Fraction]] = []
    for limit, length in zip(map(mps, LADDER[1:]), lengths, strict=True):
        gear = Gear(b, Fraction(0) if braking else T_SERVICE)  # a brake that acts already goes on
        course.began += [] if braking else [(SERVICE, (x, v / KMH))]
        course.places += slowed(v, limit, x, gear, x - length)
        leaving = max(at_point(v, x, gear, x - length), limit)
        rows.append({"limit": limit, "length": length, "leaving": leaving})
        v, x, braking = leaving, x - length, leaving > limit
    seen = run(model, rows, start={"entry": mps(LADDER[0]), "before": mps(LADDER[0])}, settings={"b": b})
    if seen["out"][-1]:  # the last limit was exceeded: on behind the signal
        course.places += braked(v, x, Gear(b, Fraction(0)), FAR_BEYOND)
    return course


def ladder_runs() -> dict[str, Course]:
    """The worst train and a better one in sections laid for the worst, and the worst in sections for the better."""
    laid, short = sections(), sections(b=BETTER)
    return {
        "2.0 km/h/s": through(Sections, laid, WORST),
        "3.0 km/h/s": through(Sections, laid, BETTER),
        "2.0, sections for 3.0": through(ShortSections, short, WORST),
    }


@plot(id="patterns_plots.steps", title="Speed steps 100/65/45/25/0 against one pattern", requirement="SP-S1",
      assumed=("[A] ladder", "[A] worst train 2.0 km/h/s, better one 3.0 km/h/s, 2 s"), x=to_go(900, 200),
      y=speed(120), source="[P] steps; runs of the model")  # fmt: skip
def step_ladder() -> Iterator[Mark]:
    """The worst train just keeps each limit, the better one is early; in shorter sections the worst overruns."""
    laid = sections()
    ends = [sum(laid[k:], Fraction(0)) for k in range(len(laid))]
    yield steps("limit", list(zip([ends[0] + BEFORE, *ends], LADDER, strict=True)))
    yield pattern("pattern, 2.0 km/h/s", Gear(WORST, T_SERVICE), 850, margin=0)
    yield pattern("pattern, 3.0 km/h/s", Gear(BETTER, T_SERVICE), 850, margin=0)
    yield from drawn(ladder_runs())
    yield Rule("signal", x=0)


# --- two-stage fixed pattern -----------------------------------------------------------------------------------------

NEARER = 60  # m


def two_stages(nearer: int = 0) -> Course:
    """A driver who coasts at 95 km/h past the first balise; both balises may lie nearer to the signal than the rule."""
    v, x, course = mps(95), D1 - nearer - MARGIN, Course()
    start = {"train.v": v, "train.x": x, "brake.left": T_SERVICE - CYCLE}
    live = Live(TwoStageRun, start=start, settings={"nearer_1": nearer, "nearer_2": nearer})
    while live.state["train.v"] > 0:
        acts = live.state["brake.left"] <= CYCLE
        reached, moving = moved(live.state["train.v"], -B_SERVICE if acts else 0, CYCLE)
        braking = live.state["guard.braking"]
        shown = live.shown({"reached": reached, "moving": moving})
        course.places.append((shown["train.x"] + MARGIN, shown["train.v"] / KMH))
        course.began += [(SERVICE, course.end)] if shown["lines.service"] and not braking else []
    course.places.append((live.state["train.x"] + MARGIN, Fraction(0)))
    return course


@plot(id="patterns_plots.two_stage", title="Two-stage fixed pattern: balises as the rule has them, and 60 m nearer",
      requirement="SP-P1", assumed=("[A] balises at 600 and 180 m, margin 10 m", "[A] b_s 2.5 km/h/s, t_s 2 s"),
      x=to_go(650, 100), y=speed(110), source="[P] stored pattern from fixed distances; runs of the model")  # fmt: skip
def two_stage() -> Iterator[Mark]:
    """The stored curve counts on the fixed distances: from balises that lie nearer the train passes the signal."""
    yield pattern("stored curve", BRAKES[SERVICE], int(D1))
    yield Rule("V_mid", y=passing_ceilings()[1].middle / KMH)
    yield from drawn({"as the rule": two_stages(), "60 m nearer": two_stages(NEARER)})
    yield Points("balise by the rule", [(D1, 0), (D2, 0)])
    yield Points("balise laid nearer", [(D1 - NEARER, 0), (D2 - NEARER, 0)])
    yield Rule("signal", x=0)

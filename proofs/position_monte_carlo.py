"""The odometer in slides, sampled: how far the single estimate is off, and that the train stays in the interval.

Each mission is a braking with one slide, drawn with a pinned seed and run on the model; shares are bounded by Clopper
and Pearson, quantiles by order statistics, at 99 %.  This is sampling, not proof: the distributions are assumed [A],
and what is rare is not seen; for the interval AP-1 is the proof.  Drawn uniformly, [A]:

    speed 20 to 40 m/s, scale error -0.9 to 0.9 %, the place told, 2 s of coasting, then
    2 to 8 s of braking with 0.3 to 0.9 m/s^2 on a rail that grips
    1 to 6 s of slide: the train loses 0.2 to 1.2 m/s^2, the wheel 2 to 8 m/s^2 down to a standstill
    8 s of braking as before: the wheel grips at once

The odometer takes the braking before the slide for that in it.  The error is what the estimate has gained on the train
since the slide began, so that the scale error counts from there; below 0 it is dangerous, for the train is farther than
the estimate says.  It grows after the slide as long as SLIDE is not left.

Results of 400 missions: none leaves the interval, so that at most 1.4 % do, with 99 % confidence; in 160 the estimate
errs to the dangerous side when the slide ends, in 163 8 s later, of all in one of twenty by 3.8 m or more and by 17 m;
in 318 it is so far off that SLIDE is not left.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from fractions import Fraction
from functools import cache
from itertools import accumulate
from typing import Any, NamedTuple

from models.kinematics import CYCLE
from models.position.ride import Ride
from safety import Model
from safety.exhibits import Column, table
from safety.exhibits import Row as Cells
from safety.inject.statistics import clopper_pearson
from safety.trace import Live

MISSIONS, SEED, CONFIDENCE = 400, 2009, 0.99
Row = Mapping[str, Any]
COASTS, AFTER = 20, 80  # cycles before the braking, and after the slide


class Slide(NamedTuple):
    """A braking with a slide."""

    speed: int  # m/s
    scale: Fraction  # of the wheel, as long as it grips
    b: Fraction  # m/s^2, with grip
    braked: int  # cycles, before the slide
    lasts: int  # cycles
    b_true: Fraction  # m/s^2, in the slide
    b_wheel: Fraction  # m/s^2, of the wheel in the slide


def hundredths(pick: random.Random, low: int, high: int) -> Fraction:
    """Uniform from low to high hundredths."""
    return Fraction(pick.randint(low, high), 100)


@cache
def slides() -> tuple[Slide, ...]:
    """Those drawn."""
    pick = random.Random(SEED)
    return tuple(
        Slide(pick.randint(20, 40), Fraction(pick.randint(-9, 9), 1000), hundredths(pick, 30, 90),
              pick.randint(20, 80), pick.randint(10, 60), hundredths(pick, 20, 120), hundredths(pick, 200, 800))
        for _ in range(MISSIONS)
    )  # fmt: skip


def cycles(slide: Slide) -> Iterator[tuple[Fraction, Fraction, bool]]:
    """Gain in m/s^2 between mean speeds, wheel in m/s, whether it slides, cycle by cycle."""
    v = wheel = Fraction(slide.speed)
    grips, before = COASTS + slide.braked, Fraction(0)
    for k in range(grips + slide.lasts + AFTER):
        sliding = grips <= k < grips + slide.lasts
        b = Fraction(0) if k < COASTS else slide.b_true if sliding else slide.b
        gain, before = -(before + b) / 2, b
        v = max(v + gain * CYCLE, Fraction(0))
        wheel = max(wheel - slide.b_wheel * CYCLE, Fraction(0)) if sliding else v * (1 + slide.scale)
        yield gain, wheel, sliding


KEPT = ("kept.gains", "kept.loses", "kept.over")
SHOWN = (*KEPT, "kept.under", "there", "odometer.low", "odometer.guess", "odometer.high", "odometer.watch.sliding")


class Outcome(NamedTuple):
    """What a mission came to."""

    kept: bool  # the premises of AP-1
    inside: bool  # the train was in the interval, in every cycle
    recovered: bool  # NORMAL again at the end
    slid: Fraction  # m, error at the end of the slide
    later: Fraction  # m, error at the end of the mission


def inputs(gain: Fraction, wheel: Fraction, slides: bool, place: Fraction | None = None) -> Row:
    """A cycle; the place is told at its beginning, or is not."""
    fix = {"fix.given": place is not None} | dict.fromkeys(("fix.low", "fix.place", "fix.high"), place or 0)
    return {"at.gain": gain, "at.wheel": wheel, "at.spins": False, "at.slides": slides, **fix}


class Bench:
    """A train, its wheel and an odometer, run up once for all missions that begin alike."""

    def __init__(self, model: type[Model] = Ride) -> None:
        self.standing = Live(model, keep=SHOWN)
        self.runs: dict[tuple[Fraction, int], Live] = {}

    def running(self, scale: Fraction, speed: int) -> Live:
        """At that speed in m/s, reached with 1 m/s^2."""
        if not speed:
            return copy(self.standing)
        if (scale, speed) not in self.runs:
            live = self.runs[scale, speed] = self.running(scale, speed - 1)
            for _ in range(10):
                live.step(inputs(Fraction(1), (live.state["speed"] + CYCLE) * (1 + scale), False))
        return copy(self.runs[scale, speed])

    def mission(self, slide: Slide) -> Outcome:
        """One mission."""
        live, kept, inside, off = self.running(slide.scale, slide.speed), True, True, [Fraction(0)]
        place = live.state["way"]
        for gain, wheel, slides in cycles(slide):
            now, place = live.shown(inputs(gain, wheel, slides, place)), None
            kept &= (now["odometer.watch.sliding"] if slides else now["kept.under"]) and all(now[name] for name in KEPT)
            inside &= now["odometer.low"] <= now["there"] <= now["odometer.high"]
            off.append(now["odometer.guess"] - now["there"])
        begins = COASTS + slide.braked
        error = [each - off[begins] for each in off]
        return Outcome(kept, inside, not now["odometer.watch.sliding"], error[begins + slide.lasts], error[-1])


@cache
def missions() -> tuple[Outcome, ...]:
    """All that were drawn, on the bench as it is."""
    return tuple(map(Bench().mission, slides()))


# --- how often, and how far -------------------------------------------------------------------------------------------

BREAKS, LEAVES, PERSISTS = "breaks a premise of AP-1", "leaves the interval", "SLIDE persists"
SLID, LATER = "dangerous error at the end of the slide", "dangerous error 8 s later"
PINNED = {BREAKS: 0, LEAVES: 0, PERSISTS: 318, SLID: 160, LATER: 163}
ASSUMED = ("[A] distributions of speed, scale error, braking and slide",)


def counts(seen: Sequence[Outcome]) -> dict[str, int]:
    """In how many of these missions."""
    return {
        BREAKS: sum(not each.kept for each in seen), LEAVES: sum(not each.inside for each in seen),
        PERSISTS: sum(not each.recovered for each in seen),
        SLID: sum(each.slid < 0 for each in seen), LATER: sum(each.later < 0 for each in seen),
    }  # fmt: skip


@table(
    id="position.slides_sampled", title="Missions with a slide, drawn with a pinned seed", requirement="AP-1",
    source="[A] distributions; runs of the model, bounds of Clopper and Pearson at 99 %", assumed=ASSUMED,
    note="Sampled, not proved.",
    columns=(Column("what happens"), Column("missions"), Column("of"),
             Column("share, least", decimals=4, assumed=True), Column("share, greatest", decimals=4, assumed=True),
             Column("as pinned")),
)  # fmt: skip
def sampled() -> Iterator[Cells]:
    """A kind of outcome a row."""
    for what, hits in counts(missions()).items():
        low, high = clopper_pearson(hits, MISSIONS, CONFIDENCE)
        yield what, hits, MISSIONS, Fraction(low), Fraction(high), hits == PINNED[what]


def quantile(values: Sequence[Fraction], share: Fraction) -> tuple[Fraction, Fraction, Fraction]:
    """The least value that this share of the sample does not exceed, and bounds of it, whatever the distribution.

    Of n values, at most h do not exceed the quantile with the probability P(Bin(n, share) <= h), or less; where that is
    half of what confidence leaves open, the next value is a lower bound.  From above likewise.
    """
    ranked, n, tail = sorted(values), len(values), (1 - Fraction(str(CONFIDENCE))) / 2
    at_most = list(accumulate(math.comb(n, h) * share**h * (1 - share) ** (n - h) for h in range(n + 1)))
    low = sum(chance <= tail for chance in at_most) - 1
    high = sum(chance < 1 - tail for chance in at_most)
    if low < 0 or high >= n:
        raise ValueError(f"{n} values bound no quantile of {share} at {CONFIDENCE}; draw more")
    return ranked[math.ceil(share * n) - 1], ranked[low], ranked[high]


@table(
    id="position.slide_errors_sampled", title="Error of the single estimate by a slide", requirement="AP-2",
    source="[A] distributions; runs of the model, bounds by order statistics at 99 %", assumed=ASSUMED,
    note="Sampled, not proved. At the end of the slide, and 8 s later. Below 0 it is dangerous.",
    columns=(Column("quantile"), Column("error", "m", decimals=2, assumed=True),
             Column("least", "m", decimals=2, assumed=True), Column("greatest", "m", decimals=2, assumed=True)),
)  # fmt: skip
def errors() -> Iterator[Cells]:
    """A quantile a row."""
    for when, found in (("slide", [each.slid for each in missions()]), ("later", [each.later for each in missions()])):
        for percent in (5, 25, 50, 75, 95):
            yield f"{when}, {percent} %", *quantile(found, Fraction(percent, 100))

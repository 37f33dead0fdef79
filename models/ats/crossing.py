"""Level-crossing warning time: the start of the warning is put off for a train that stops before the crossing.

    plain       the warning starts when the head reaches the start point, whatever the train will do
    put off     past the start point, as long as the ground hears "stopping"; the train says so only while the
                pattern to its stop mark is active, and that lies before the crossing
    announced   the train falls silent `notice` seconds before it departs: the warning starts

Loss of the message is plain control from there on: longer, safe.  A train that says "stopping" without a pattern and
passes is dangerous.  A step is a time stamp; the train's head is at `head` (m, the crossing is at 0, the line runs up
to it).  That an active pattern keeps the head before its target is AV-1, here a premise.
Source: principle [P]; 30 s, 100 km/h, 100 m, 0.7 m/s^2, dwell 30 s, T_min 20 s [A].
Main results: warning 30.0 s for an express, 93.30 s for a stopping train without control; it runs 16.90 s from the mark
to the crossing, so departure has to be announced 13.10 s before; without the pattern the warning is shorter than 20 s.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple, Self

from models.kinematics import B_SERVICE, Interval, at_least, at_most, mps, nearest, refuse, root
from safety import ANY, Bit, Model, Real, assume, parameter, point, power_up, require, select

WARNING = Fraction(30)  # s, T_w [A]
LEAST_WARNING = Fraction(20)  # s, T_min [A]
LINE_SPEED = mps(100)  # [A]
MARK = Fraction(100)  # m, stop mark before the crossing [A]
DWELL = Fraction(30)  # s [A]
STARTING = Fraction("0.7")  # m/s^2 [A]
NOTICE = Fraction("13.1")  # s [D], for 30 s


def start_point(speed: Fraction = LINE_SPEED, warning: Fraction = WARNING) -> Fraction:
    """Where the plain warning starts, m before the crossing."""
    return speed * warning


def run_from_mark(mark: Fraction = MARK, a: Fraction = STARTING) -> Interval:
    """Seconds from the departure at the stop mark to the crossing."""
    return root(2 * mark / a)


def stopping_warning(
    speed: Fraction = LINE_SPEED, mark: Fraction = MARK, b: Fraction = B_SERVICE, dwell: Fraction = DWELL
) -> Interval:
    """Seconds of warning without control, of a train that stops at the mark.

    Raises ModelError where the train has to brake before the start point.
    """
    approach = start_point(speed) - mark
    brakes = speed * speed / (2 * b)
    if brakes > approach:
        refuse("stop mark", mark, "m before the crossing", f"a train brakes for {float(brakes):g} m, from before the "
               "start point on", f"{at_most(start_point(speed) - brakes)} m")  # fmt: skip
    until = (approach - brakes) / speed + speed / b + dwell
    run = run_from_mark(mark)
    return Interval(until + run.low, until + run.high)


def notice_for(warning: Fraction = WARNING, mark: Fraction = MARK, a: Fraction = STARTING) -> Interval:
    """Seconds before departure at which it has to be announced.

    Raises ModelError where the run from the mark takes longer than the warning: then none is needed.
    """
    run = run_from_mark(mark, a)
    if warning <= run.high:
        refuse("warning", warning, "s", f"the run from the mark takes {float(run.high):g} s",
               f"above {at_least(run.high)} s")  # fmt: skip
    return Interval(warning - run.high, warning - run.low)


class Told(NamedTuple):
    """What the ground does."""

    warning: Bit
    put_off: Bit  # past the start point, and no warning yet
    too_short: Bit  # the head is at the crossing, and the warning has been on for less than T_min


class Says(NamedTuple):
    """What happens at a time stamp."""

    stops: Bit  # the timetable says stop, and on board the pattern is made
    lost: Bit  # the message does not get through
    announces: Bit
    departs: Bit


class OnTheLine(Model, event="a change of its inputs"):
    """A train that comes up to the crossing, and the places on its way."""

    head: Real = power_up(ANY)
    speed: Real = power_up(ANY)
    start: Real = parameter(start_point(), unit="m", within=(1, 3000), source="[A] 30 s at 100 km/h")
    mark: Real = parameter(MARK, unit="m", within=(1, 1000), source="[A] stop mark before the crossing")
    v_max: Real = parameter(LINE_SPEED, unit="m/s", within=(1, 100), source="[A] 100 km/h")
    a_max: Real = parameter(STARTING, unit="m/s^2", within=(Fraction(1, 10), 3), source="[A] 0.7 m/s^2")

    def moved(self, elapsed: Real, way: Real, reached: Real) -> Real:
        """Where the head is after `way`; what the line and the train allow is assumed."""
        require("the stop mark lies between start point and crossing", self.mark < self.start,
                nearest("mark", self.start, "m before the crossing", at_most, "any below"))  # fmt: skip
        head = self.head + way
        assume("the train runs forward", (elapsed >= 0) & (way >= 0) & (reached >= 0))
        assume("no faster than the line speed", (reached <= self.v_max) & (way <= self.v_max * elapsed))
        assume("gains a_max at most", reached <= self.speed + self.a_max * elapsed)
        assume("no farther than that takes it", 2 * way <= (2 * self.speed + self.a_max * elapsed) * elapsed)
        assume("a time stamp at the start point", (self.head >= -self.start) | (head <= -self.start))
        return head


class OnBoard(NamedTuple):
    """The pattern to the stop mark and the message after a time stamp."""

    pattern: Bit
    stopping: Bit
    silent: Bit
    waited: Real
    departs: Bit


class Stopping(OnTheLine, event="a change of its inputs"):
    """What the train says, and how it departs."""

    pattern: Bit = power_up(False)
    silent: Bit = power_up(False)  # the departure is announced
    waited: Real = power_up(0)  # s since then
    departed: Bit = power_up(False)
    notice: Real = parameter(NOTICE, unit="s", within=(0, 120), source="[D] for 30 s of warning")

    def told(self, elapsed: Real, head: Real, reached: Real, says: Says) -> OnBoard:
        """The pattern is made outside the start point; with it the train stays before the mark."""
        active = self.pattern | (says.stops & (head <= -self.start) & ~self.departed)
        held = self.held(active)
        assume("AV-1: before the target of an active pattern", ~held | (head <= -self.mark))
        silent = self.silent | says.announces
        waited = select(self.silent, self.waited + elapsed, 0)
        departs = held & silent & says.departs & (reached == 0) & (waited >= self.notice)
        return OnBoard(active & ~departs, point("stopping", active & ~silent & ~departs), silent, waited, departs)

    def held(self, active: Bit) -> Bit:
        """Whether the pattern to the stop mark is enforced."""
        return active


class Crossing(Stopping, event="a change of its inputs"):
    """The train, the loop that hears it, and the crossing's warning."""

    since: Real = power_up(0)  # s since the departure
    warns: Bit = power_up(False)
    warned: Real = power_up(0)  # s for which the warning has been on
    least: Real = parameter(LEAST_WARNING, unit="s", within=(1, 60), source="[A] T_min 20 s")

    def step(self, elapsed: Real, way: Real, reached: Real, says: Says) -> tuple[Self, Told]:
        """The train runs `way` until this time stamp and is then at `reached`; then loop and ground act."""
        head = self.moved(elapsed, way, reached)
        board = self.told(elapsed, head, reached, says)
        heard, past = point("heard", board.stopping & ~says.lost), head >= -self.start
        warns = point("warning", self.warns | (past & ~heard))
        warned = select(self.warns, self.warned + elapsed, 0)
        following = type(self)(
            head=head, speed=reached, pattern=board.pattern, silent=board.silent, waited=board.waited,
            departed=self.departed | board.departs, since=select(self.departed, self.since + elapsed, 0), warns=warns,
            warned=warned,
        )  # fmt: skip
        short = point("short", (head >= 0) & (warned < self.least))
        return following, Told(warns, past & ~warns, short)


class NoPattern(Crossing, event="a change of its inputs"):
    """The variant to be refuted: the train says "stopping" by the timetable alone, no pattern holds it."""

    def held(self, active: Bit) -> Bit:
        """Nothing does."""
        return active & ~active

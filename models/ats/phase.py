"""The phase of the track-circuit current as a release: read by an antenna ahead of the first axle.

Where stop and caution of a signal shift the phase of the signal current, N in the section before a signal says that it
is not at stop; R says stop; NONE (a train ahead, a broken rail, no supply) says nothing and keeps the pattern.

    released    N for `stable` without a break, all that time surely in the signal's approach section and `joint` away
                from its insulated joints, where adjacent sections may carry opposite phases

    back at stop    R, there, where N was read before: the pattern is made again (extension)

The receiver stamps the last change of its reading, so the time is exact though the step is a cycle: of a reading that
changed within the cycle `age` tells how long ago (s).
Source: phase release [P]; 0.3 s, 10 m, interval instead of position, the extension [A]; only time within the section
counts [A].
Main results: NONE never releases, N for 0.29 s neither, N for 0.31 s does; without the 10 m the next section's phase
does.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple, Self

from models.kinematics import CYCLE, nearest
from models.position.odometer import Position, step_s
from safety import Bit, Model, Real, assume, parameter, point, power_up, require, select


class Phase(NamedTuple):
    """What the receiver reads: N or R with enough amplitude, neither is NONE."""

    n: Bit
    r: Bit
    changed: Bit  # within this cycle
    age: Real  # s since then; counts only where it changed


class Told(NamedTuple):
    """What the receiver makes of it."""

    proceed: Bit  # the signal ahead is not at stop
    stop: Bit  # it is again


class PhaseReceiver(Model, tick_s=step_s):
    """The receiver of one signal's approach section, from `begins` to `ends` (m along the line)."""

    stable: Real = power_up(0)  # s for which N has held within the section
    here_before: Bit = power_up(False)  # within the section at the last cycle
    was_clear: Bit = power_up(False)  # N has been read within the section, and no R since
    cycle: Real = parameter(CYCLE, unit="s", within=(Fraction(1, 1000), 1), source="[A] control cycle")
    stability: Real = parameter(Fraction("0.3"), unit="s", within=(Fraction(1, 1000), 5), source="[A] T_stab")
    joint: Real = parameter(10, unit="m", within=(0, 100), source="[A] on both sides of an insulated joint")
    begins: Real = parameter(0, unit="m", within=(-10_000, 10_000), source="[A] line data: entry joint")
    ends: Real = parameter(600, unit="m", within=(-10_000, 10_000), source="[A] line data: joint at the signal")

    def step(self, phase: Phase, where: Position) -> tuple[Self, Told]:
        """One cycle: the reading at its end; what it tells of the signal ahead."""
        least = self.begins + 2 * self.joint
        require("the section is longer than both joint zones", self.ends > least,
                nearest("ends", least, "m", side="any above"))  # fmt: skip
        n, r = point("n", phase.n), point("r", phase.r)
        assume("a change is as old as the cycle at most", (phase.age >= 0) & (phase.age <= self.cycle))
        here = self.here(where)
        held = select(phase.changed, phase.age, self.stable + self.cycle)
        stable = select(n & ~r & here & self.here_before, held, 0)
        back = point("back_at_stop", self.was_clear & here & r & ~n)
        was_clear = here & ((n & ~r) | self.was_clear) & ~back
        following = type(self)(stable=stable, here_before=here, was_clear=was_clear)
        return following, Told(point("released", stable >= self.stability), back)

    def here(self, where: Position) -> Bit:
        """Surely within the section, away from its joints."""
        return (where.low >= self.begins + self.joint) & (where.high <= self.ends - self.joint)


class LostPhaseReleases(PhaseReceiver, tick_s=step_s):
    """The variant to be refuted: what is not R is taken for N."""

    def step(self, phase: Phase, where: Position) -> tuple[Self, Told]:
        """NONE is read as N."""
        return super().step(phase._replace(n=~phase.r), where)


class NoJointRule(PhaseReceiver, tick_s=step_s):
    """The variant to be refuted: the phase is believed next to a joint, too."""

    def here(self, where: Position) -> Bit:
        """Somewhere in the section, as estimated."""
        return (where.guess >= self.begins) & (where.guess <= self.ends)


class AnySection(PhaseReceiver, tick_s=step_s):
    """The variant to be refuted: the phase of any section is believed."""

    def here(self, where: Position) -> Bit:
        """Anywhere, but not at a joint of this section."""
        begin, end = self.begins, self.ends
        before = where.high <= begin - self.joint
        return before | super().here(where) | (where.low >= end + self.joint)


class PhaseBench(Model, tick_s=step_s):
    """The receiver beside the truth: for how long N has been read without a break, and where the train is."""

    receiver: PhaseReceiver
    lasted: Real = power_up(0)  # s until the last cycle

    def step(self, phase: Phase, where: Position, pos: Real) -> tuple[Self, Heard]:
        """One cycle; `pos` is the true place of the antenna."""
        good = phase.n & ~phase.r
        lasting = select(good, select(phase.changed, phase.age, self.lasted + self.receiver.cycle), 0)
        receiver, told = self.receiver.step(phase, where)
        return type(self)(receiver=receiver, lasted=lasting), Heard(told.proceed, lasting, pos)


class LostPhaseBench(PhaseBench, tick_s=step_s):
    """With the receiver that takes what is not R for N."""

    receiver: LostPhaseReleases


class NoJointBench(PhaseBench, tick_s=step_s):
    """With the receiver that believes the phase next to a joint."""

    receiver: NoJointRule


class AnySectionBench(PhaseBench, tick_s=step_s):
    """With the receiver that believes the phase of any section."""

    receiver: AnySection


class Heard(NamedTuple):
    """What the bench shows."""

    released: Bit
    lasting: Real  # s for which N has now been read
    at: Real  # m, true place

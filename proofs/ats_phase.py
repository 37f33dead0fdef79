"""Phase release: never without a stable N in the right section, and soon enough where there is one.

Source: phase change as a release [P]; T_stab 0.3 s, 10 m [A].
Main results: AV-3 for all cycles, times, zones and sections; AV-5 for the phase: T_stab + T; a receiver that takes a
lost phase for N, believes it next to a joint, or that of another section, is refuted.
"""

from __future__ import annotations

from fractions import Fraction

from models.ats.phase import AnySectionBench, LostPhaseBench, NoJointBench, PhaseBench
from models.kinematics import CYCLE
from safety import PROVED, REFUTED, Bit, Seen, claim, implies
from safety.prove.bounds import Bound, between, claim_bracket, reals

SOURCE = "[P] phase release; [A] T_stab, joint zone"
STABLE = Fraction("0.3")  # s
OPEN = tuple(f"receiver.{name}" for name in ("cycle", "stability", "joint", "begins", "ends"))

# --- AV-3: never too early -------------------------------------------------------------------------------------------


def within(s: Seen) -> Bit:
    """The antenna is within the interval."""
    return (s.where.low <= s.at) & (s.at <= s.where.high)


def counted(s: Seen) -> Bit:
    """Lemma: the receiver has counted no more than N has lasted."""
    return (s.receiver.stable >= 0) & (s.receiver.stable <= s.lasted)


@claim(PhaseBench, expect=PROVED, given=within, lemmas=[counted], symbolic=OPEN, requirement="AV-3", source=SOURCE)
def only_a_stable_phase_releases(s: Seen) -> Bit:
    """A release means that N, not R or NONE, has been read for T_stab without a break, and that the antenna truly is in
    the signal's section, away from its joints: for ever and for all times, zones and sections."""
    r = s.receiver
    here = (s.at >= r.begins + r.joint) & (s.at <= r.ends - r.joint)
    return implies(s.released, s.phase.n & ~s.phase.r & (s.lasting >= r.stability) & here)


@claim(LostPhaseBench, expect=REFUTED, given=within, symbolic=OPEN, requirement="AV-3", source=SOURCE,
       twin_of=only_a_stable_phase_releases)  # fmt: skip
def a_lost_phase_releases(s: Seen) -> Bit:
    """So it is where a lost phase is taken for N."""
    return only_a_stable_phase_releases(s)


@claim(NoJointBench, expect=REFUTED, given=within, symbolic=OPEN, requirement="AV-3", source=SOURCE,
       twin_of=only_a_stable_phase_releases)  # fmt: skip
def a_joint_releases(s: Seen) -> Bit:
    """So it is where the phase is believed next to a joint."""
    return only_a_stable_phase_releases(s)


@claim(AnySectionBench, expect=REFUTED, given=within, symbolic=OPEN, requirement="AV-3", source=SOURCE,
       twin_of=only_a_stable_phase_releases)  # fmt: skip
def another_section_releases(s: Seen) -> Bit:
    """So it is where the phase of another section is believed."""
    return only_a_stable_phase_releases(s)


@claim(PhaseBench, expect=REFUTED, symbolic=OPEN, requirement="AV-3", source=SOURCE,
       twin_of=only_a_stable_phase_releases)  # fmt: skip
def a_wrong_position_releases(s: Seen) -> Bit:
    """So it is where the interval does not hold the antenna."""
    return only_a_stable_phase_releases(s)


@claim(PhaseBench, expect=PROVED, symbolic=OPEN, requirement="AV-3", source=SOURCE)
def no_phase_never_releases(s: Seen) -> Bit:
    """A cycle in which N is not read gives no release, however long before it was."""
    return implies(~s.phase.n, ~s.released)


@claim(LostPhaseBench, expect=REFUTED, symbolic=OPEN, requirement="AV-3", source=SOURCE,
       twin_of=no_phase_never_releases)  # fmt: skip
def no_phase_never_releases_where_lost_is_n(s: Seen) -> Bit:
    """So it is where a lost phase is taken for N."""
    return no_phase_never_releases(s)


# --- AV-5: soon enough -----------------------------------------------------------------------------------------------


def in_section(s: Seen) -> Bit:
    """The interval lies within the section, away from its joints."""
    r = s.receiver
    return (s.where.low >= r.begins + r.joint) & (s.where.high <= r.ends - r.joint)


def been_there(s: Seen) -> Bit:
    """The train has been there for a cycle; no N has been read so far."""
    return s.receiver.here_before & (s.receiver.stable == 0) & (s.lasted == 0)


def counting(s: Seen) -> Bit:
    """Lemma: within the section the receiver has counted all."""
    return s.receiver.here_before & (s.lasted == s.receiver.stable)


@claim(PhaseBench, expect=PROVED, start=been_there, given=in_section, anywhere=True, lemmas=[counting], symbolic=OPEN,
       requirement="AV-5", source=SOURCE)  # fmt: skip
def a_stable_phase_releases_in_time(s: Seen) -> Bit:
    """Within the section, away from its joints, N that has lasted for T_stab at the end of a cycle has released: the
    delay is less than T_stab + T, for all of both."""
    return implies(s.lasting >= s.receiver.stability, s.released)


@claim(PhaseBench, expect=REFUTED, start=been_there, anywhere=True, symbolic=OPEN, requirement="AV-5", source=SOURCE,
       twin_of=a_stable_phase_releases_in_time)  # fmt: skip
def a_stable_phase_releases_in_time_anywhere(s: Seen) -> Bit:
    """So it has outside the section or next to a joint."""
    return a_stable_phase_releases_in_time(s)


def just_come(s: Seen) -> Bit:
    """The train has not been there for a cycle yet; no N has been read so far."""
    return ~s.receiver.here_before & (s.receiver.stable == 0) & (s.lasted == 0)


@claim(PhaseBench, expect=REFUTED, start=just_come, given=in_section, anywhere=True, symbolic=OPEN,
       requirement="AV-5", source=SOURCE, twin_of=a_stable_phase_releases_in_time)  # fmt: skip
def a_stable_phase_releases_in_time_where_the_train_just_came(s: Seen) -> Bit:
    """So it has in the first cycle within the section."""
    return a_stable_phase_releases_in_time(s)


@claim(PhaseBench, expect=REFUTED, start=been_there, given=in_section, anywhere=True, symbolic=OPEN,
       requirement="AV-5", source=SOURCE, twin_of=a_stable_phase_releases_in_time)  # fmt: skip
def a_phase_releases_sooner(s: Seen) -> Bit:
    """N that has lasted for half of T_stab has released."""
    return implies(2 * s.lasting >= s.receiver.stability, s.released)


CYCLES, AGE = reals("cycles age")
claim_bracket(
    Bound(
        "ats_phase.lateness",
        "Delay of a release by the phase, within the section and away from its joints",
        CYCLES * CYCLE - AGE,  # at the end of the last of so many cycles, begun `age` before the change
        (between(0, AGE, CYCLE), between(1, CYCLES, 20), (CYCLES - 1) * CYCLE - AGE <= STABLE),
        whole=(CYCLES,), unit="s", requirement="AV-5", source=SOURCE, assumed=("[A] T_stab 0.3 s, T 0.1 s",),
    )
)  # fmt: skip

"""Point and continuous control: the train stands at D, and the channel bounds what a missing inductor does.

Speeds m/s, distances m.  Steps of 0.1 s for the equipment, the way to the next point for the approach.
Source: limits 40, 25, 15 km/h and stop at D, channel [P]; 0.5 m/s^2 after 2 s, 40 km/h by the channel alone [A].

Main results: with all inductors a train stands at D, for ever; with any of them missing it may pass D, by 25.694 m (C),
36.420 m (B) or 75.231 m (A), but at 40 km/h at most, and is braked there.  The limit falls only, until the section is
clear; loss of the current takes it to 0.
"""

from __future__ import annotations

from fractions import Fraction

from models.kinematics import need, root
from models.patterns.point_continuous import (
    DECELERATION,
    FREE_RUN,
    LIMITS,
    LINE,
    WAYS,
    InductorApproach,
    PointAndContinuous,
)
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    all_of,
    any_of,
    any_of_faults,
    at_most,
    claim,
    implies,
    open_circuit,
    previous,
    select,
    stuck,
)

SOURCE = "[P] inductors and continuous channel; distances [A]"
MISSING = [Fault(open_circuit(), [f"inductor_{n}"], ANY_TIME, name=f"inductor {n} missing") for n in "abcd"]
LINES = [Fault(open_circuit(), [p], ANY_TIME, name=f"{p} lost") for p in ("track_current", "valve")]

# --- the equipment ---------------------------------------------------------------------------------------------------


def held_is_no_less_than_0(s: Seen) -> Bit:
    """The limit that is held is 0 or more."""
    return all_of(s.held >= 0)


@claim(PointAndContinuous, expect=PROVED, faults=any_of_faults([*MISSING, *LINES]), symbolic=("approach",),
       lemmas=[held_is_no_less_than_0], requirement="SP-H1", source=SOURCE)  # fmt: skip
def limit_only_falls_until_clear(s: Seen) -> Bit:
    """Until the channel says that the section is clear the limit never rises, whatever is missing or lost."""
    return implies(~s.clear, s.limit <= previous(s.limit, 0))


@claim(PointAndContinuous, expect=REFUTED, requirement="SP-H1", twin_of=limit_only_falls_until_clear)
def limit_only_falls(s: Seen) -> Bit:
    """The limit never rises, clear or not."""
    return all_of(s.limit <= previous(s.limit, 0))


@claim(PointAndContinuous, expect=PROVED, faults=any_of_faults([*MISSING, *LINES]), symbolic=("approach",),
       requirement="SP-H1", source="[P] continuous channel")  # fmt: skip
def loss_of_the_current_brakes(s: Seen) -> Bit:
    """Without current in the rails the limit is 0 and the brake comes at once, whatever is missing."""
    return implies(~s.current | ~s.track_current, (s.limit <= 0) & s.brake)


@claim(PointAndContinuous, expect=PROVED, lemmas=[held_is_no_less_than_0], symbolic=("approach",), requirement="SP-H1",
       source=SOURCE)  # fmt: skip
def limit_is_just_this(s: Seen) -> Bit:
    """The limit is 0 without current, the line's in a clear section, else the least of that before, of what the channel
    admits and of the inductors passed; the brake comes just above it, and without current."""
    targets = zip("abcd", (*LIMITS[1:], LIMITS[-1]), strict=True)
    asked = [s.held, s.approach, *(select(s.passed[name], to, s.held) for name, to in targets)]
    least = all_of(*(s.limit <= each for each in asked)) & any_of(*(s.limit == each for each in asked))
    limit = select(s.current, select(s.clear, s.limit == LINE, least), s.limit == 0)
    return all_of(limit, s.brake == ((s.v > s.limit) | ~s.current))


@claim(PointAndContinuous, expect=REFUTED, symbolic=("approach",), requirement="SP-H1", twin_of=limit_is_just_this)
def limit_is_that_of_the_channel(s: Seen) -> Bit:
    """The limit is what the channel admits.  False: the inductors lower it."""
    return implies(s.current & ~s.clear, s.limit == s.approach)


HIGHER = Fault(stuck(1), ["receiver"], ANY_TIME, name="receiver decodes clear")


@claim(PointAndContinuous, expect=PROVED, faults=any_of_faults([*MISSING, *LINES]), symbolic=("approach",),
       requirement="SP-C1", source=SOURCE)  # fmt: skip
def channel_bounds_the_limit(s: Seen) -> Bit:
    """In a section that is not clear the limit is at most what the channel alone admits, whatever inductors are
    missing."""
    return implies(~s.clear, s.limit <= s.approach)


@claim(PointAndContinuous, expect=REFUTED, defeat=True, faults=at_most(1, [HIGHER]), symbolic=("approach",),
       requirement="SP-C1", source="[A] decodes a higher code", twin_of=channel_bounds_the_limit)  # fmt: skip
def channel_bounds_the_limit_whatever_it_decodes(s: Seen) -> Bit:
    """The same with a receiver that decodes a clear section where there is none.  False."""
    return channel_bounds_the_limit(s)


@claim(PointAndContinuous, expect=REFUTED, defeat=True, faults=any_of_faults([*MISSING, *LINES, HIGHER]),
       requirement="SP-H1", source="[A] wrong-side: decodes a higher code", twin_of=loss_of_the_current_brakes,
       scenario=Scenario(1, {"current": True}, present=[HIGHER.name]))  # fmt: skip
def section_that_is_not_clear_brakes(s: Seen) -> Bit:
    """A section that is not clear brakes at power-up.  False: a receiver may decode a clear one."""
    return implies(~s.clear, s.brake)


# --- the approach ----------------------------------------------------------------------------------------------------


def slowed(s: Seen) -> Bit:
    """The train keeps to 40 km/h from A on, and is slowed to the limit of the last point; no traction above it."""
    limit = s.onboard.held
    way = 2 * DECELERATION * s.way
    braked = (need(s.before, DECELERATION, FREE_RUN, s.v) >= way) & (s.v <= s.before)
    return implies(s.entered & ~s.past_a, s.v <= LIMITS[0]) & implies(s.past_a, (s.v <= limit) | braked)


def at_each_point(s: Seen) -> Bit:
    """What is known when the next point comes."""
    falls = (s.past_b, LIMITS[1], LIMITS[2]), (s.past_c, LIMITS[2], LIMITS[3])
    known = implies(s.past_a, s.entered & (s.before <= LIMITS[0]) & (s.onboard.held <= LIMITS[1])) & (s.before >= 0)
    for past, speed, limit in falls:
        known = known & implies(past, (s.before <= speed) & (s.onboard.held <= limit))
    return all_of(known, implies(s.past_b, s.past_a), implies(s.past_c, s.past_b))


ALONG = Scenario(5, {"v": lambda k: LIMITS[max(0, min(k, 4) - 1)]})


@claim(
    InductorApproach,
    expect=PROVED,
    given=slowed,
    lemmas=[at_each_point],
    requirement="SP-M1",
    source=SOURCE,
    witness=ALONG,
)
def train_stands_at_the_signal(s: Seen) -> Bit:
    """With all inductors the train is at 25 km/h or less at B, at 15 at C, and stands at D, in every section."""
    at_b, at_c = s.past_a & ~s.past_b, s.past_b & ~s.past_c
    return implies(at_b, s.v <= LIMITS[1]) & implies(at_c, s.v <= LIMITS[2]) & implies(s.at_signal, s.v <= 0)


@claim(InductorApproach, expect=REFUTED, requirement="SP-M1", source="[A] braking", twin_of=train_stands_at_the_signal,
       scenario=Scenario(5, {"v": LIMITS[0]}))  # fmt: skip
def train_stands_at_the_signal_without_brake(s: Seen) -> Bit:
    """The same of a train that is not slowed.  False."""
    return implies(s.at_signal, s.v <= 0)


def with_missing(missing: str, first: Fraction = LIMITS[0]) -> list[Fraction]:
    """Speeds at A, B, C, D where an inductor is missing, slowed only when told to; each the greatest, from below."""
    speeds, limit, told = [first], LIMITS[0] if missing == "a" else LIMITS[1], missing != "a"
    free = FREE_RUN
    for way, name, following in zip(WAYS, "bcd", (*LIMITS[2:], LIMITS[3]), strict=True):
        v = speeds[-1]
        lost = 2 * DECELERATION * (way - v * free)
        braked = root(max(v * v - lost, Fraction(0))).low if told and v > limit else v
        speeds.append(min(v, max(braked, limit)) if told and v > limit else v)
        free = Fraction(0) if told and speeds[-1] > limit else FREE_RUN
        if name != missing:
            limit, told = following, True
    return speeds


def slowed_from_any_speed(s: Seen) -> Bit:
    """The train is slowed to the limit of the last point; no traction above it."""
    way = 2 * DECELERATION * s.way
    braked = (need(s.before, DECELERATION, FREE_RUN, s.v) >= way) & (s.v <= s.before)
    return implies(s.past_a, (s.v <= s.onboard.held) | braked)


FROM_THE_LINE = with_missing("", LINE)


@claim(InductorApproach, expect=REFUTED, given=slowed_from_any_speed, requirement="SP-M1", source="[A] 40 km/h at A",
       twin_of=train_stands_at_the_signal,
       scenario=Scenario(5, {"v": lambda k: FROM_THE_LINE[max(0, min(k, 4) - 1)]}))  # fmt: skip
def train_stands_at_the_signal_from_line_speed(s: Seen) -> Bit:
    """The same of a train that passes A at line speed.  False: the ways are laid for 40 km/h there."""
    return implies(s.at_signal, s.v <= 0)


def missing(name: str, metres: str) -> None:
    """One inductor is missing."""
    fault = Fault(open_circuit(), [f"onboard.inductor_{name}"], ANY_TIME, name=f"inductor {name} missing")

    def formula(s: Seen) -> Bit:
        return implies(s.at_signal, s.v <= 0)

    formula.__name__ = f"train_stands_at_the_signal_without_inductor_{name}"
    formula.__doc__ = f"The train stands at D without inductor {name.upper()}.  False: it passes D, by {metres} m."
    speeds = with_missing(name)
    run = Scenario(5, {"v": lambda k: speeds[max(0, min(k, 4) - 1)]}, present=[fault.name])
    claim(InductorApproach, expect=REFUTED, defeat=True, faults=at_most(1, [fault]), given=slowed, requirement="SP-M1",
          source="[P] a missing inductor leaves the limit", twin_of=train_stands_at_the_signal,
          scenario=run)(formula)  # fmt: skip


for inductor, beyond in (("a", "75.231"), ("b", "36.420"), ("c", "25.694")):
    missing(inductor, beyond)

ANY_MISSING = [
    Fault(open_circuit(), [f"onboard.inductor_{n}"], ANY_TIME, name=f"inductor {n} missing") for n in "abcd"
]  # fmt: skip


def never_faster(s: Seen) -> Bit:
    """From A on the train keeps to 40 km/h."""
    return (
        implies(s.past_a, (s.before <= LIMITS[0]) & s.entered)
        & implies(s.past_b, s.past_a)
        & implies(s.past_c, s.past_b)
        & implies(s.entered & s.past_a, s.onboard.held <= LIMITS[0])
    )


@claim(InductorApproach, expect=PROVED, faults=any_of_faults(ANY_MISSING), given=slowed, lemmas=[never_faster],
       requirement="SP-C1", source=SOURCE, witness=ALONG)  # fmt: skip
def channel_bounds_a_missing_inductor(s: Seen) -> Bit:
    """Whatever inductors are missing, D is passed at 40 km/h at most, and the brake comes there."""
    return implies(s.at_signal, (s.v <= LIMITS[0]) & s.brake)


NO_END = Fault(stuck(1), ["onboard.track_current"], ANY_TIME, name="current behind D")


@claim(InductorApproach, expect=REFUTED, defeat=True, faults=any_of_faults([*ANY_MISSING, NO_END]), given=slowed,
       requirement="SP-C1", source="[A] stray current", twin_of=channel_bounds_a_missing_inductor,
       scenario=Scenario(5, {"v": LIMITS[0]}, present=[f.name for f in [*ANY_MISSING, NO_END]]))  # fmt: skip
def inductors_and_channel_missing_are_bounded(s: Seen) -> Bit:
    """The same where the rails behind D carry a current.  False: nothing is left that brakes."""
    return implies(s.at_signal, s.brake)

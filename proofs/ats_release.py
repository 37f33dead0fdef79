"""Release balises: how late a change to proceed is seen, and that a change back to stop is not seen at all.

Source: release balises [P]; spacing, delays, t_e, b_e [A].
Main results: AV-5 for release balises, least upper bounds; the widest spacing for a delay of 20 s from 25 km/h up; a
signal that returns to stop after the last release balise leaves no pattern, by balises or by phase (AV-4); an emergency
brake from 100 m out then stops in front of the signal up to 45.22 km/h, at 45.23 km/h it does not (AS-11).
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from models.ats.ats_s import EMERGENCY, Approach
from models.ats.release import Following
from models.kinematics import B_EMERGENCY, T_EMERGENCY, mps
from proofs.ats_s import in_braking, in_free_run, no_faster
from safety import PROVED, REFUTED, Bit, Scenario, Seen, claim, implies, previous
from safety.prove.bounds import Bound, between, claim_bound, claim_bracket, reals
from safety.prove.weakest import BELOW, weakest_real

SOURCE = "[P] release balises; [A] rules in detail"

# --- AV-5: how late --------------------------------------------------------------------------------------------------

delay, speed, rest, spacing = reals("delay speed rest spacing")


def lateness(slowest: int, widest: int) -> Bound:
    """Delay of the reading of a change to proceed, at least so many km/h, balises at most so many metres apart."""
    return Bound(
        f"ats_release.lateness_at_{slowest}",
        f"Delay until the next release balise, from {slowest} km/h up, balises {widest} m apart",
        delay,
        (delay * speed == rest, between(0, rest, widest), between(mps(slowest), speed, mps(130)),
         between(0, delay, 200)),
        unit="s", requirement="AV-5", source=SOURCE, assumed=("[A] the train does not stop on the way",),
    )  # fmt: skip


for slowest, least in ((45, "16.0"), (25, "28.8")):
    within = claim_bound(lateness(slowest, 200), Fraction(least), expect=PROVED)
    claim_bound(lateness(slowest, 200), Fraction(least) - Fraction(1, 100), id=f"ats_release.sooner_at_{slowest}",
                expect=REFUTED, twin_of=within)  # fmt: skip
claim_bracket(lateness(45, 200), id="ats_release.latest_at_45")
claim_bracket(lateness(25, 200), id="ats_release.latest_at_25")

_spaced = Bound(
    "ats_release.lateness_by_spacing",
    "Delay until the next release balise, from 25 km/h up",
    delay,
    (delay * speed == rest, rest >= 0, rest <= spacing, between(1, spacing, 1000), between(mps(25), speed, mps(130)),
     between(0, delay, 200)),
    unit="s", requirement="AV-5", source=SOURCE, assumed=("[A] the train does not stop on the way",),
)  # fmt: skip
weakest_real(_spaced, Fraction(20), spacing, safe=BELOW, within=(1, 1000), gap=Fraction(1, 100), unit="m",
             id="ats_release.widest_spacing_for_20_s", at={"speed": "25 km/h and more"})  # fmt: skip

# --- AV-4: what is not followed --------------------------------------------------------------------------------------


def undisturbed(s: Seen) -> Bit:
    """The driver does not reset."""
    return ~s.reset


def does_not_return(s: Seen) -> Bit:
    """The signal does not return to stop while the train comes up to it; the driver does not reset."""
    return ~(s.inside & s.stop & ~previous(s.stop, False)) & ~s.reset


def kept(s: Seen) -> Bit:
    """Lemma: where the signal was at stop a cycle ago, on the approach, the target is active."""
    return implies(s.inside & previous(s.stop, False), s.sp.home.target.active)


@claim(Following, expect=PROVED, given=does_not_return, lemmas=[kept], requirement="AV-4", source=SOURCE)
def pattern_while_at_stop(s: Seen) -> Bit:
    """Between signal balise and signal there is a pattern while the signal is at stop: it has been from the balise
    on."""
    return implies(s.approaching & s.stop, s.sp.home.target.pattern)


RETURNS = Scenario(
    10, {
        "stop": lambda k: k < 3 or k > 5, "passed.signal": lambda k: k == 1, "passed.release": lambda k: k == 4,
        "where.low": lambda k: 30 * k, "where.guess": lambda k: 30 * k, "where.high": lambda k: 30 * k,
        "where.fastest": mps(40), "where.slowest": mps(40),
    },
)  # fmt: skip
BY_PHASE = Scenario(
    12, {
        "stop": lambda k: k < 3 or k > 9, "passed.signal": lambda k: k == 1, "phase.n": lambda k: 3 <= k <= 9,
        "phase.r": lambda k: k < 3 or k > 9, "where.low": lambda k: 30 * k, "where.guess": lambda k: 30 * k,
        "where.high": lambda k: 30 * k, "where.fastest": mps(40), "where.slowest": mps(40),
    },
)  # fmt: skip


@claim(Following, expect=REFUTED, given=undisturbed, requirement="AV-4", source=SOURCE, defeat=True, scenario=RETURNS,
       twin_of=pattern_while_at_stop)  # fmt: skip
def pattern_while_at_stop_again(s: Seen) -> Bit:
    """There is a pattern while the signal is at stop, also where it returned to stop after a release balise."""
    return pattern_while_at_stop(s)


def by_phase_only(s: Seen) -> Bit:
    """No release balise; the driver does not reset."""
    return ~s.passed.release & ~s.reset


@claim(Following, expect=REFUTED, given=by_phase_only, requirement="AV-4", source=SOURCE, defeat=True,
       scenario=BY_PHASE, twin_of=pattern_while_at_stop)  # fmt: skip
def pattern_while_at_stop_again_by_phase(s: Seen) -> Bit:
    """There is a pattern while the signal is at stop, also where it returned to stop after a release by the phase."""
    return pattern_while_at_stop(s)


def stays_at_stop(s: Seen) -> Bit:
    """The signal does not return to stop while the train comes up to it; the driver may reset."""
    return ~(s.inside & s.stop & ~previous(s.stop, False))


@claim(Following, expect=REFUTED, given=stays_at_stop, requirement="AV-2", source=SOURCE, defeat=True,
       twin_of=pattern_while_at_stop)  # fmt: skip
def pattern_while_at_stop_after_a_reset(s: Seen) -> Bit:
    """There is a pattern while the signal is at stop, also after a stop and reset between balise and signal."""
    return pattern_while_at_stop(s)


# --- AV-4: the driver's emergency brake ------------------------------------------------------------------------------


def restored(kmh: str) -> Callable[[Seen], Bit]:
    """The start of an emergency brake from 100 m out."""

    def start(s: Seen) -> Bit:
        v = mps(kmh)
        brake = ~s.reading & (s.ats.state == EMERGENCY) & (s.ordered == 0) & (s.to_go == 100)
        return brake & (s.speed >= 0) & (s.speed <= v) & (s.warned_at == v) & (s.way == v * v / (2 * B_EMERGENCY))

    start.__doc__ = f"The emergency brake is applied 100 m before the signal, at {kmh} km/h or less."
    return start


def applied(s: Seen) -> Bit:
    """Lemma: nothing takes it off."""
    return ~s.reading & (s.ats.state == EMERGENCY)


def as_built(s: Seen) -> Bit:
    """Free run and emergency brake as assumed."""
    return (s.t_e == T_EMERGENCY) & (s.b_e == B_EMERGENCY)


@claim(Approach, expect=PROVED, start=restored("45.22"), anywhere=True,
       lemmas=[applied, no_faster, in_free_run, in_braking], symbolic=["t_e", "b_e"], given=as_built,
       requirement="AV-4", source="[A] t_e, b_e")  # fmt: skip
def an_emergency_brake_100_m_out_suffices(s: Seen) -> Bit:
    """Up to 45.22 km/h an emergency brake from 100 m out stops in front of the signal."""
    return s.to_go >= 0


@claim(Approach, expect=REFUTED, start=restored("45.23"), anywhere=True, symbolic=["t_e", "b_e"], given=as_built,
       requirement="AV-4", source="[A] t_e, b_e", twin_of=an_emergency_brake_100_m_out_suffices)  # fmt: skip
def an_emergency_brake_100_m_out_suffices_at_45_23(s: Seen) -> Bit:
    """So it does up to 45.23 km/h."""
    return s.to_go >= 0

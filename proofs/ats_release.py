"""Release balises: how late a change to proceed is seen, and that a change back to stop is not seen at all.

Source: release balises [P]; spacing, delays, t_e, b_e [A].
Main results: AV-5 for release balises, least upper bounds; the widest spacing for a delay of 20 s from 25 km/h up; a
signal that returns to stop has its pattern again from the next release balise on, or at once by the phase, behind the
last release balise and without the phase none (AV-4); an emergency
brake from 100 m out then stops in front of the signal up to 45.22 km/h, at 45.23 km/h it does not (AS-11).
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from models.ats.ats_s import EMERGENCY, Approach
from models.ats.release import Following, OnlyByBalise, OnlyByPhase
from models.kinematics import B_EMERGENCY, T_EMERGENCY, mps
from proofs.ats_phase import in_section
from proofs.ats_s import in_braking, in_free_run, no_faster
from proofs.premises import Premise, together
from safety import PROVED, REFUTED, Bit, Scenario, Seen, claim, implies, previous
from safety.prove.bounds import Bound, between, claim_bound, claim_bracket, reals
from safety.prove.weakest import BELOW, weakest_real

SOURCE = "[P] release balises; [A] rules in detail, extension"
SECTION = tuple(f"receiver.{name}" for name in ("joint", "begins", "ends"))

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


@claim(OnlyByBalise, expect=REFUTED, given=by_phase_only, requirement="AV-4", source=SOURCE, defeat=True,
       scenario=BY_PHASE, twin_of=pattern_while_at_stop)  # fmt: skip
def pattern_while_at_stop_again_by_phase(s: Seen) -> Bit:
    """There is a pattern while the signal is at stop, also where it returned to stop after a release by the phase,
    which does not make it again."""
    return pattern_while_at_stop(s)


def known(s: Seen) -> Bit:
    """Lemma: where a balise was passed at stop, and the signal has been at stop since, the target is active."""
    return implies(s.inside & s.read, s.sp.home.target.active)


@claim(Following, expect=PROVED, given=undisturbed, lemmas=[known], requirement="AV-4", source=SOURCE)
def pattern_from_the_next_balise_on(s: Seen) -> Bit:
    """A signal that returned to stop has its pattern from the next release balise on, as long as it is at stop."""
    return implies(s.approaching & s.known_at_stop, s.sp.home.target.pattern)


@claim(OnlyByPhase, expect=REFUTED, given=undisturbed, requirement="AV-4", source=SOURCE,
       twin_of=pattern_from_the_next_balise_on)  # fmt: skip
def pattern_from_the_next_balise_on_without_re_creation(s: Seen) -> Bit:
    """So it has where a release balise at stop does not make it again."""
    return pattern_from_the_next_balise_on(s)


@claim(Following, expect=REFUTED, requirement="AV-4", source=SOURCE, twin_of=pattern_from_the_next_balise_on)
def pattern_from_the_next_balise_on_after_a_reset(s: Seen) -> Bit:
    """So it has where the driver resets behind it."""
    return pattern_from_the_next_balise_on(s)


def phase_tells(s: Seen) -> Bit:
    """The phase is N or R, as the signal is."""
    return ~(s.stop ^ s.phase.r) & (s.stop ^ s.phase.n)


def phase_premises(s: Seen) -> Bit:
    """In the section, where the phase shows the signal; the driver does not reset."""
    return in_section(s) & phase_tells(s) & undisturbed(s)


def followed(s: Seen) -> Bit:
    """Lemma: on the approach the target is active, or the receiver has read N last."""
    return implies(s.inside, s.sp.home.target.active | s.receiver.was_clear)


@claim(Following, expect=PROVED, given=phase_premises, lemmas=[followed], symbolic=SECTION, requirement="AV-4",
       source=SOURCE)  # fmt: skip
def pattern_while_at_stop_by_phase(s: Seen) -> Bit:
    """With the extension there is a pattern whenever the signal is at stop, also where it returned, in the section and
    as long as the phase shows the signal there."""
    return implies(s.approaching & s.stop, s.sp.home.target.pattern)


def drops(name: str, model: type[Following], *kept: Premise) -> None:
    """The twin with these premises only."""

    def fewer(s: Seen) -> Bit:
        return pattern_while_at_stop_by_phase(s)

    fewer.__name__ = f"pattern_while_at_stop_by_phase_{name.replace(' ', '_')}"
    fewer.__doc__ = f"So it is {name}."
    fewer.__module__ = __name__
    claim(model, expect=REFUTED, given=together(*kept), symbolic=SECTION, requirement="AV-4", source=SOURCE,
          twin_of=pattern_while_at_stop_by_phase)(fewer)  # fmt: skip


drops("without the extension", OnlyByBalise, in_section, phase_tells, undisturbed)
drops("outside the section", Following, phase_tells, undisturbed)
drops("without a phase", Following, in_section, undisturbed)
drops("after a reset", Following, in_section, phase_tells)


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
    return an_emergency_brake_100_m_out_suffices(s)


@claim(Approach, expect=REFUTED, start=restored("45.22"), anywhere=True, symbolic=["t_e", "b_e"], requirement="AV-4",
       source="[A] t_e, b_e", twin_of=an_emergency_brake_100_m_out_suffices)  # fmt: skip
def an_emergency_brake_100_m_out_suffices_with_any_brake(s: Seen) -> Bit:
    """So it does with any free run and deceleration."""
    return an_emergency_brake_100_m_out_suffices(s)


def restored_nearer(s: Seen) -> Bit:
    """The same at 45.22 km/h, 99 m before the signal."""
    v = mps("45.22")
    brake = ~s.reading & (s.ats.state == EMERGENCY) & (s.ordered == 0) & (s.to_go == 99)
    return brake & (s.speed >= 0) & (s.speed <= v) & (s.warned_at == v) & (s.way == v * v / (2 * B_EMERGENCY))


@claim(Approach, expect=REFUTED, start=restored_nearer, anywhere=True, symbolic=["t_e", "b_e"], given=as_built,
       requirement="AV-4", source="[A] t_e, b_e", twin_of=an_emergency_brake_100_m_out_suffices)  # fmt: skip
def an_emergency_brake_99_m_out_suffices(s: Seen) -> Bit:
    """So it does from 99 m out."""
    return an_emergency_brake_100_m_out_suffices(s)

"""Two-stage and one-stage patterns, and outputs that are energised to release (SP-P4, SP-F1), on the models.

Source: patterns, sections 2.3 and 2.4, SP-P4, SP-F1 [D]; distances, budget, four lines [A].

Main results: the two-stage pattern keeps the point where both balises lie as the rule says and are read; one laid
nearer, or not read, is refuted.  The one-stage pattern intervenes only where the stop no longer fits.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from models.kinematics import B_SERVICE, MARGIN, T_SERVICE, distance, need
from models.patterns.held_lines import HeldLine
from models.patterns.one_stage import LaterRun
from models.patterns.slips import WithoutTraction
from models.patterns.train import T, runs
from models.patterns.two_stage import D2, TwoStageRun
from safety import PROVED, REFUTED, Bit, Fault, Scenario, Seen, all_of, at_most, claim, implies, previous, stuck

STAGES: dict[str, Any] = {"requirement": "SP-P1", "source": "[D] stored curves; [A] D1, D2, V_mid"}
LATEST: dict[str, Any] = {"requirement": "SP-P4", "source": "[P] intervention at the last moment needed for safety"}


def coasting(v: Fraction, x: Fraction, cycles: int, **sizes: Fraction) -> Scenario:
    """A train that coasts at v from x for so many cycles and then has the guaranteed brake; parameters left open."""
    reached, moving = runs(v, [Fraction(0)] * cycles + [-B_SERVICE] * 400)
    start = {"train.v": v, "train.x": x, "brake.left": T_SERVICE - T, **sizes}
    inputs = {"reached": reached.__getitem__, "moving": moving.__getitem__}
    return Scenario(cycles + 400, inputs, start)


# --- two stages ------------------------------------------------------------------------------------------------------


SIZES = ("d2", "margin")
USUAL = {"d2": D2, "margin": MARGIN}
OPEN = (*SIZES, *(f"guard.{name}" for name in ("b_s", "t_s", "a", "h", "b_e", "t_e", "t_w")))


def stop_fits(s: Seen) -> Bit:
    """With the time left until the brake acts, the stop fits."""
    return s.fits


def within_budget(s: Seen) -> Bit:
    """The time left until the brake acts is within the budget."""
    return s.budgeted


def second_read_in_time(s: Seen) -> Bit:
    """The second balise was read, or lies ahead."""
    return s.second | (s["train.x"] > s["d2"] - s["margin"])


def at_the_first_balise(s: Seen) -> Bit:
    """The train's stop fits; the second balise lies ahead."""
    return s.fits & s.budgeted & (s["train.v"] >= 0) & (s["train.x"] > s["d2"] - s["margin"])


@claim(TwoStageRun, start=at_the_first_balise, lemmas=[stop_fits, within_budget, second_read_in_time], symbolic=OPEN,
       expect=PROVED, **STAGES)  # fmt: skip
def two_stages_keep_the_point(s: Seen) -> Bit:
    """A train under the two-stage pattern never passes the point a margin before the signal: for all brakes, budgets,
    places of the second balise and margins."""
    return s["train.x"] >= 0


@claim(TwoStageRun, start=at_the_first_balise, settings={"nearer_2": 30}, symbolic=SIZES, expect=REFUTED,
       scenario=coasting(Fraction(14), Fraction(175), 44, **USUAL),
       twin_of=two_stages_keep_the_point, **STAGES)  # fmt: skip
def two_stages_keep_the_point_with_the_second_balise_nearer(s: Seen) -> Bit:
    """The same with the second balise laid 30 m nearer than the rule.  False: a latent fault, seen by nobody."""
    return two_stages_keep_the_point(s)


@claim(TwoStageRun, start=at_the_first_balise, settings={"nearer_1": 30}, symbolic=SIZES, expect=REFUTED,
       scenario=coasting(Fraction(15), Fraction(195), 35, **USUAL),
       twin_of=two_stages_keep_the_point, **STAGES)  # fmt: skip
def two_stages_keep_the_point_with_the_first_balise_nearer(s: Seen) -> Bit:
    """The same with the first balise laid 30 m nearer than the rule.  False: V_mid comes too late."""
    return two_stages_keep_the_point(s)


@claim(TwoStageRun, start=at_the_first_balise, settings={"nearer_2": 180}, symbolic=SIZES, expect=REFUTED,
       scenario=coasting(Fraction(14), Fraction(175), 140, **USUAL),
       twin_of=two_stages_keep_the_point, **STAGES)  # fmt: skip
def two_stages_keep_the_point_without_the_second_balise(s: Seen) -> Bit:
    """The same where the second balise is not read before the signal.  False: the train goes on at V_mid."""
    return two_stages_keep_the_point(s)


@claim(TwoStageRun, expect=REFUTED, steps=3, twin_of=two_stages_keep_the_point, **STAGES)
def two_stages_keep_the_point_wherever_it_starts(s: Seen) -> Bit:
    """The same wherever the train is at power-up.  False."""
    return two_stages_keep_the_point(s)


# --- one stage: the last moment --------------------------------------------------------------------------------------


def exact(s: Seen) -> Bit:
    """Speed and distance are known exactly."""
    return all_of(*(s.errors[end] <= 0 for end in ("slow", "fast", "near", "far")))


@claim(WithoutTraction, given=exact, expect=PROVED, **LATEST)
def the_pattern_intervenes_only_where_the_stop_no_longer_fits(s: Seen) -> Bit:
    """With exact inputs the brake is asked for only where free run and braking take more than the way left."""
    return implies(s["guard.over"], need(s["train.v"], B_SERVICE, T_SERVICE) > 2 * B_SERVICE * s["train.x"])


@claim(WithoutTraction, expect=REFUTED, steps=1, **LATEST,
       twin_of=the_pattern_intervenes_only_where_the_stop_no_longer_fits)  # fmt: skip
def the_pattern_intervenes_only_where_the_stop_no_longer_fits_by_intervals(s: Seen) -> Bit:
    """The same with intervals.  False: their width makes the brake come earlier, which is the safe side."""
    return the_pattern_intervenes_only_where_the_stop_no_longer_fits(s)


@claim(LaterRun, start=lambda s: s.fits & s.budgeted & (s["train.v"] >= 0), expect=REFUTED, **LATEST,
       scenario=coasting(Fraction(20), distance(Fraction(20), B_SERVICE, T_SERVICE), 24),
       twin_of=the_pattern_intervenes_only_where_the_stop_no_longer_fits)  # fmt: skip
def a_later_intervention_keeps_the_point(s: Seen) -> Bit:
    """A rule that permits some speeds above the ceiling keeps the point, too.  False: it overruns."""
    return s["train.x"] >= 0


# --- energise to release ---------------------------------------------------------------------------------------------

LINES = ("supply", "cycle", "speed_valid", "code")


@claim(HeldLine, expect=PROVED, requirement="SP-F1", source="[P] energise to release; [A] one cycle")
def whatever_is_lost_is_the_brake(s: Seen) -> Bit:
    """A cycle after supply, program cycle, validity of the speed or code is lost, the brake is on."""
    lost = ~all_of(*(s.held[line] for line in LINES))
    return implies(previous(lost, initially=True), s.out)


@claim(HeldLine, faults=at_most(1, [Fault(stuck(1), [line]) for line in LINES]), expect=REFUTED, requirement="SP-F1",
       source="[A]", steps=3, twin_of=whatever_is_lost_is_the_brake)  # fmt: skip
def whatever_is_lost_is_the_brake_with_a_line_held(s: Seen) -> Bit:
    """The same with one of the four held by a fault.  False: its loss is not seen."""
    return whatever_is_lost_is_the_brake(s)

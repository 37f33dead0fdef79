"""On-board microcomputers, 1991: words that claims decide, slips of the pen, and what nothing in print decides.

Source: words as the specification reports them [P]; the models that decide take brakes, cycles, jitter and times [A].

Main results: intervention at the pattern is the last moment from which the stop is possible; the last chapter has a
wrong number; outlook, tests and cost are not derivable.
"""

from __future__ import annotations

from proofs.onboard_1991_figures import paper
from safety.audit import derived, printed

for _name, _unit, _about in (
    ("chapter_before", "1", "number of the chapter before"),
    ("counted", "1", "place of a chapter"),
    ("found", "1", "what tests found"),
    ("wanted", "1", "what is wanted"),
):
    paper.symbol(_name, _unit, _about)

# --- decided by claims -----------------------------------------------------------------------------------------------

for _requirement, _name, _text, _where, _claim in (
    ("AS-1", "alarm.brakes", "5 s after the alarm the emergency brake acts unless the brake was operated",
     "section 3(2)(a)", "ats_s.an_unanswered_stop_brakes"),
    ("SP-P4", "later.last_moment", "intervention is put off to the last moment needed for safety", "section 3(2)",
     "kinematics.above_the_ceiling_it_overruns"),
    ("SP-P1", "later.safe", "the same: it is not put off beyond that", "section 3(2)", "kinematics.stop_fits"),
    ("AV-7", "dual.compared", "two processors in step on one bus clock: any difference stops the train",
     "processors", "dual_processor.a_mismatch_brakes_for_ever"),
    ("AV-7", "dual.permit", "outputs permit only if both processors permit", "processors",
     "dual_processor.runs_only_if_both_permit"),
    ("AV-6", "branch.limit", "the limit at a branch depends on the branching direction", "ATS-SP",
     "ats_supervision_targets.turnout_is_not_entered_too_fast"),
    ("AV-3", "phase.release", "the phase of the signal current tells that the signal ahead is not at stop",
     "figure 6, ATS-SP", "ats_phase.only_a_stable_phase_releases"),
    ("AP-5", "codes.recognised", "five balises are recognised as a group", "section 4(3)",
     "position_reading.a_true_group_is_accepted"),
    *(("AP-5", f"codes.{_slot}", f"the arrangement gives the absolute position: {_slot} slot", "section 4(3)",
       f"position_reading.{_slot}_slot_is_read") for _slot in ("first", "second", "third")),
    ("AP-4", "correction.matched", "the position is that of the matching balise in the line data", "section 4(3)",
     "position_correction.a_match_is_right_within_half_the_spacing"),
    ("AO-1", "crossing.delay", "the warning is delayed for trains that stop before the crossing", "options",
     "ats_crossing.delay_needs_a_stop_pattern"),
    ("AR-5", "radio.routes", "trains answer requests to cancel a route; points move outside every authority",
     "section 5", "radio_points.points_move_outside_every_authority"),
    ("AR-3", "radio.follows", "trains follow each other at the limit that the one ahead leaves", "section 5",
     "radio_moving_block.the_follower_never_passes_the_leader"),
):  # fmt: skip
    paper.under(_requirement).decided(_name, _text, where=_where, claim=_claim)
paper.under("AS-3").decided(
    "alarm.alone", "ATS-S does not supervise a driver who has operated the brake", where="section 3(2)(a)",
    claim="ats_s.no_train_passes_a_stop_signal", denies=True,
)  # fmt: skip
paper.under("AP-2").decided(
    "accuracy.large_error", "the accuracy holds as long as no large error arises: a slide makes one",
    where="section 4(3)", claim="position_drift.count_falls_less_than_56_4_short", denies=True,
)  # fmt: skip

# --- names and numbers -----------------------------------------------------------------------------------------------

paper.figure("chapter", "8", "1", where="number of the last chapter", by="chapter_before + 1",
             also={"its place": "counted"},
             given={"chapter_before": printed("5", exact=True), "counted": derived(6)})  # fmt: skip
paper.named("word.global", "Grobal", where="text on satellite positioning", means="as in Global Positioning System",
            names={"Global": "as in Global Positioning System"})  # fmt: skip

# --- what nothing in print decides -----------------------------------------------------------------------------------

POSITION, OPTIONS, RADIO = "section 4(3), position", "options and outlook", "section 5, radio"
for _name, _text, _where in (
    ("release", "release balises between the first balise and the signal all show the same state", "ATS-SP"),
    ("ats_s", "ATS-S is cheap and efficient for mixed traffic", "section 3(2)(a)"),
    ("gps", "satellite positioning is not accurate enough, and there are tunnels", POSITION),
    ("doppler", "Doppler speedometer and accelerometer are not certain enough alone", POSITION),
    ("odometer", "runs with slip-prone stock gave the prospect of practical accuracy", POSITION),
    ("kept", "trains with ATS-S alone keep working: signal balises are unchanged, others are of other kinds", POSITION),
    ("loop", "the loop of a level crossing gives the train its absolute position", OPTIONS),
    ("functions", "body tilt and ventilation by position are planned", OPTIONS),
    ("runs", "runs with JR West, Kyushu and East confirmed the performance", OPTIONS),
    ("cold", "high speed in cold regions, snow and cold resistance are still open", OPTIONS),
    ("service", "the first line is expected in service the year after", OPTIONS),
    ("medium", "space wave on conventional lines, the leaky coaxial cable on Shinkansen", RADIO),
    ("energy", "energy-saving and headway-shortening running from the leader's position and speed", RADIO),
    ("laboratory", "basics of radio and position and laboratory tests are finished", RADIO),
    ("field", "field tests on San'yo Shinkansen in fiscal 1991, on Joetsu Shinkansen the year after", RADIO),
):
    paper.statement(f"told.{_name}", _text, where=_where, holds="found > wanted")

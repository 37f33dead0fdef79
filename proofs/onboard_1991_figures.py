"""On-board microcomputers, 1991: every printed number, recomputed, and the words that numbers can judge.

The paper prints principles and few numbers.  9139 is the number of ways to place three balises in 39 slots between two
fixed ones, and no other binomial coefficient is; the rest follows from nothing in print.
Source: numbers and words [P]; 39 slots [D]; brakes, errors, 600 m, blocks [A].

Main results: 9,139 positions are told apart only where the direction of running is known; the accuracy over 1 km holds
without an uncorrected slide; reference points every several 10 km need balises between; 5 s of alarm fit into 600 m up
to a speed that rests on the brake; a moving block is always shorter than fixed blocks that hold the same braking way.
"""

from __future__ import annotations

from proofs.atc_1961_physics import declare
from safety.audit import Known, Paper, assumed, derived, printed

paper = Paper("onboard_1991", "Train Control by on-board Microcomputers (1991)")
declare(paper)


def exactly(text: str) -> Known:
    """A printed count or setting."""
    return printed(text, exact=True)


SLOTS = derived(39)  # the only n with 9139 = C(n, k), 2 <= k <= n/2: see onboard_1991_derived_figures
EPSILON = assumed("1", "0.3", "1")
SYMBOLS: tuple[tuple[str, str, str, Known | None, str], ...] = (  # name, unit, what it is, value, definition
    ("alarm", "s", "alarm before the emergency brake", exactly("5"), ""),
    ("alarm_found", "s", "the same, as somebody chose it", None, ""),
    ("D_req", "m", "needed before the signal without an action of the driver", None,
     "V*(alarm + t_e) + V^2/(2*b_e)"),
    ("D_rule", "m", "longest stopping distance allowed", assumed("600", "600", "600"), ""),
    ("slots", "1", "places between the outer balises", SLOTS, ""),
    ("inner", "1", "balises between the outer ones", derived(3), ""),
    ("codes", "1", "arrangements", None, "slots*(slots - 1)*(slots - 2)/6"),
    ("palindromes", "1", "that read alike both ways", None, "(slots - 1)/2"),
    ("classes", "1", "told apart whatever the direction", None, "(codes + palindromes)/2"),
    ("spacing", "m", "between balises, at most", printed("1000", digits=1), ""),
    ("reference_spacing", "m", "between reference points", assumed("30000", "20000", "90000"), ""),
    ("ε", "%", "error of the counted distance", EPSILON, ""),
    ("slid", "m", "lost in a locked slide of 3 s from 20 m/s", assumed("56.4", "54.1", "60"), ""),
    ("states", "1", "of a balise with shifted frequency, at most", printed("6"), ""),
    ("needed", "1", "states of a kind of balise: stop, not stop", derived(2), ""),
    ("kinds", "1", "signal, release, branch, reference", derived(4), ""),
    ("choice", "1", "a number that somebody chose", None, ""),
    ("speeds", "1", "speeds of continuous codes", exactly("20"), ""),
    ("V_1", "km/h", "limit of the first step", None, ""),
    ("V_2", "km/h", "of the second", None, ""),
    ("b_worst", "km/h/s", "deceleration of the worst train admitted", None, ""),
    ("pattern", "m", "way under a one-stage pattern", None, "V*t + V^2/(2*b)"),
    ("stepped", "m", "the same in three steps, for the worst train", None,
     "V*t + (V^2 - V_1^2)/(2*b_worst) + V_1*t + (V_1^2 - V_2^2)/(2*b_worst) + V_2*t + V_2^2/(2*b_worst)"),
    ("t_sys", "s", "reports, reaction, free run", None, ""),
    ("length", "m", "of a train", None, ""),
    ("block", "m", "length of a fixed block", None, ""),
    ("blocks", "1", "kept clear", None, ""),
    ("moving", "s", "headway with a moving block", None, "t_sys + V/(2*b) + (length + gap)/V"),
    ("fixed", "s", "headway with fixed blocks", None, "t_sys + (blocks*block + length)/V"),
    ("gap", "m", "margin behind the train ahead", None, ""),
)  # fmt: skip
for _name, _unit, _about, _known, _by in SYMBOLS:
    paper.symbol(_name, _unit, _about, _known, by=_by)

# --- 2, 3 point and continuous control -------------------------------------------------------------------------------

METHODS = "section 3(2)"
paper.figure("alarm", "5", "s", where=f"{METHODS}(a)", by="alarm_found")
paper.under("AS-2").statement(
    "alarm.fits", "5 s of alarm, then the emergency brake, before the signal", where=f"{METHODS}(a), within 600 m",
    holds="D_req <= D_rule", given={"V": assumed("100", "60", "130")},
)  # fmt: skip
for _name, _text, _where in (
    ("aspects_least", "3", "aspects of a signal, from"),
    ("aspects_most", "5", "aspects of a signal, to"),
    ("transponder_bits", "48", "bits of the transponder of ATS-P"),
    ("speeds_least", "5", "speeds of continuous codes so far, from"),
    ("speeds_most", "7", "speeds of continuous codes so far, to"),
    ("speeds_now", "20", "speeds of continuous codes now"),
    ("processor_bits", "8", "bits of a processor"),
    ("states", "6", "states of a balise, at most about"),
):
    paper.figure(f"count.{_name}", _text, "1", where=_where, by="choice")
paper.statement("states.kind", "at most about 6 states of a balise: enough for each kind", where=METHODS,
                holds="needed <= states")  # fmt: skip
paper.statement("states.together", "the same, read: enough to tell the kinds apart by frequency alone", where=METHODS,
                holds="kinds*needed <= states")  # fmt: skip
later = paper.under("SP-P4")
LADDER = ("V > V_1", "V_1 > V_2", "b >= b_worst")
later.equation("later.than_steps", "pattern < stepped", where=f"{METHODS}: the pattern intervenes later than steps",
               when=LADDER)  # fmt: skip

# --- 4 position ------------------------------------------------------------------------------------------------------

POSITION = "section 4(3)"
codes = paper.under("AP-5")
count = codes.figure("codes", "9,139", "1", where=f"{POSITION}, combinations of five balises", by="codes")
codes.figure("balises", "5", "1", where=f"{POSITION}, balises of a group", by="inner + 2")
paper.under("AP-8").statement(
    "codes.both_ways", "9,139 combinations, read: told apart whatever the direction of running", where=POSITION,
    holds="classes >= codes",
)  # fmt: skip
BETWEEN = f"{POSITION}, balises at most about 1 km apart"
WITHIN = {"m": derived(10, rests_on=("m = 10",))}
OVER_1_KM = {**WITHIN, "spacing": exactly("1000")}
near = paper.under("AP-3")
near.statement("accuracy.counted", "the accuracy is sufficiently high", where=f"{BETWEEN}, no slip, slide or creep",
               holds="ε*spacing <= m", given=OVER_1_KM)  # fmt: skip
near.statement("accuracy.slid", "the accuracy is sufficiently high", where=f"{BETWEEN}, with a slide uncorrected",
               holds="ε*spacing + slid <= m", given=OVER_1_KM)  # fmt: skip
EVERY = f"{POSITION}, reference points every several 10 km"
near.statement("reference.alone", "reference points every several 10 km suffice", where=f"{EVERY}, no balise between",
               holds="ε*reference_spacing <= m", given=WITHIN)  # fmt: skip
near.statement("reference.with_balises", "reference points every several 10 km suffice",
               where=f"{EVERY}, balises at most 1 km apart between", holds="ε*spacing <= m",
               given=OVER_1_KM)  # fmt: skip

# --- 5 radio ---------------------------------------------------------------------------------------------------------

paper.under("AR-9").equation(
    "moving_block", "moving < fixed", where="section 5: a moving block comes close to the limit of the brakes",
    when=("(blocks - 1)*block >= V^2/(2*b)", "gap < block", "blocks > 1"),
    note="fixed blocks of which all but one hold the braking way",
)  # fmt: skip

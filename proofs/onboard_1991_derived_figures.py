"""On-board microcomputers, 1991: what the specifications work out of patterns, codes and position, not in print.

Source: 9,139, 5 s, 1 km [P]; brakes, ladder, wheel, jitter, spacings, times [A]; the rest [D].

Main results: with the reference all of them hold as they stand in the specifications; the whole difference between
steps and a pattern for the same train is the repeated free run.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import comb

from proofs.atc_1961_physics import BRAKES, CEILING, FASTEST, STANDING, through
from proofs.onboard_1991_figures import exactly, paper
from safety.audit import Known, Paper, Span, assumed, derived

figures = Paper("onboard_1991_derived", f"{paper.title}, figures derived from it (specifications)", published=False)
figures.symbols = paper.symbols
for _name, _unit, _about, _known, _by in (
    ("D_1", "m", "first balise to the signal", assumed("600", "400", "800"), ""),
    ("D_2", "m", "second balise to the signal", assumed("180", "100", "300"), ""),
    ("wheel", "mm", "diameter that is set", assumed("860", "780", "910"), ""),
    ("real", "mm", "true diameter", None, ""),
    ("pulses", "1", "of the speed generator for one turn", assumed("60", "16", "200", whole=True), ""),
    ("π", "1", "", derived(Span(Fraction("3.14159265358979"), Fraction("3.14159265358980"))), ""),
    ("km_run", "m", "the way that is looked at", derived(1000), ""),
    ("sliding", "s", "duration of a slide", None, ""),
    ("b_true", "m/s^2", "true deceleration in it", None, ""),
    ("b_ref", "m/s^2", "deceleration that is reckoned with", None, ""),
    ("v_slide", "m/s", "speed at its start", None, ""),
    ("u", "m", "width of a slot", assumed("1", "0.5", "2"), ""),
    ("L", "m", "between the outer balises", None, "(slots + 1)*u"),
    ("jitter", "m", "of the detection of a balise, either way", None, ""),
    ("slip", "%", "creep of the wheel", None, ""),
    ("nearest", "1", "least spacing, in slots", None, ""),
):  # fmt: skip
    paper.symbol(_name, _unit, _about, _known, by=_by)

# --- 2.2 to 2.4 of the pattern specification: steps and patterns -----------------------------------------------------

LADDER = (100, 65, 45, 25, 0)
WORST: dict[str, Known | str] = {"b": assumed("2.0", "1.5", "3"), "t": BRAKES["t_s"]}
OWN: dict[str, Known | str] = {"b": assumed("3.0", "2", "4"), "t": BRAKES["t_s"]}
steps = figures.under("SP-S1")
for (_high, _low), _text in zip(pairwise(LADDER), ("456.60", "188.89", "122.22", "57.29"), strict=True):
    steps.figure(f"steps.{_high}", _text, "m", where="section lengths, 2.0 km/h/s", by=through((_high, _low)),
                 given=WORST)  # fmt: skip
for _name, _text, _limits, _given in (
    ("sum", "825.0", LADDER, WORST),
    ("pattern", "750.0", (100, 0), WORST),
    ("pattern_own", "518.52", (100, 0), OWN),
):
    steps.figure(f"steps.{_name}", _text, "m", where="100/65/45/25/0 against one pattern", by=through(_limits),
                 given=_given)  # fmt: skip
steps.equation("steps.difference", "stepped - pattern = (V_1 + V_2)*t", where="the same train: repeated free runs",
               given={"b": "b_worst"})  # fmt: skip
for _speed, _text in ((25, "35.218"), (45, "99.107")):
    figures.under("SP-S2").figure(
        f"steps.overlap_{_speed}", _text, "m", where="overlap behind a last step above 0", by="V*t_e + V^2/(2*b_e)",
        given={"V": derived(_speed)},
    )  # fmt: skip
for _name, _text in (("D_1", "98.175"), ("D_2", "50.543")):
    figures.figure(f"two_stage.{_name}", _text, "km/h", where="two-stage pattern, ceiling at a balise", by=CEILING,
                   given={"x": _name, "b": "b_s", "t": "t_s", "V1": STANDING})  # fmt: skip

# --- ATS-S -----------------------------------------------------------------------------------------------------------

PASSIVE = {85: "440.18", 95: "529.66", 100: "577.38", 110: "678.77", 120: "788.10", 130: "905.36"}
alarm = figures.under("AS-2")
for _speed, _text in PASSIVE.items():
    alarm.figure(f"passive.{_speed}", _text, "m", where="section 2, driver passive", by="D_req",
                 given={"V": derived(_speed)})  # fmt: skip
for _name, _text, _unit, _by, _more in (
    ("fastest", "102.30", "km/h", FASTEST, {"t": "alarm + t_e"}),
    ("fastest_braked", "117.83", "km/h", FASTEST, {"t": "t_e"}),
    ("alarm_alone", "138.89", "m", "V*alarm", {"V": derived(100)}),
):
    alarm.figure(f"passive.{_name}", _text, _unit, where="section 2, 600 m", by=_by,
                 given={"l": "D_rule", "b": "b_e", **_more})  # fmt: skip

# --- 3 counted distance ----------------------------------------------------------------------------------------------

COUNTED = "section 3, counted distance"
figures.figure("wheel.pulse", "45.0295", "mm", where=COUNTED, by="π*wheel/pulses")
for _real, _text, _by in (
    (910, "58.14", "km_run*(real/wheel - 1)"),
    (840, "23.81", "km_run*(wheel/real - 1)"),
):
    figures.figure(f"wheel.{_real}", _text, "m", where=f"{COUNTED}, {_real} mm wheels set as 860", by=_by,
                   given={"real": derived(_real)})  # fmt: skip
drift = figures.under("AP-3")
for _share, _text in (("0.3", "3"), ("0.5", "5"), ("1", "10")):
    drift.figure(f"drift.{_share}", _text, "m", where=f"{COUNTED}, over 1 km", by="ε*km_run",
                 given={"ε": derived(_share)})  # fmt: skip
for _name, _text, _by in (
    ("missed", "20", "2*ε*km_run"),
    ("thirty", "300", "30*ε*km_run"),
    ("creep", "120", "slip*km_run"),
):
    drift.figure(f"drift.{_name}", _text, "m", where=COUNTED, by=_by, given={"ε": derived("1"), "slip": derived("12")})
drift.figure("drift.interval", "20", "m", where=f"{COUNTED}, interval after 1 km at 1 %", by="2*ε*km_run",
             given={"ε": derived("1")})  # fmt: skip
for _name, _text, _holds in (
    ("speeds", "20 speeds need 5 bits", "2^4 < speeds <= 2^5"),
    ("states", "6 states are 2.58 bits", "2^129 < states^50 < 2^130"),
):
    figures.statement(f"bits.{_name}", _text, where="bits of a code", holds=_holds,
                      given={"states": exactly("6")})  # fmt: skip
SLIDE = {"v_slide": derived(20), "sliding": derived(3), "b_true": derived("0.8")}
TRUE = "(v_slide*sliding - b_true*sliding^2/2)"
RECKONED = "(v_slide*sliding - b_ref*sliding^2/2)"
slide = figures.under("AP-2")
for _name, _text, _by, _ref in (
    ("true", "56.4", TRUE, "0"),
    ("held", "60.0", RECKONED, "0"),
    ("held_error", "3.6", f"{RECKONED} - {TRUE}", "0"),
    ("reckoned_0.6", "57.3", RECKONED, "0.6"),
    ("error_0.6", "0.9", f"{RECKONED} - {TRUE}", "0.6"),
    ("reckoned_1.0", "55.5", RECKONED, "1.0"),
    ("error_1.0", "-0.9", f"{RECKONED} - {TRUE}", "1.0"),
):
    slide.figure(f"slide.{_name}", _text, "m", where="section 3.1, wheel locked 3 s from 20 m/s", by=_by,
                 given={**SLIDE, "b_ref": derived(_ref)})  # fmt: skip
slide.equation("slide.error", f"{RECKONED} - {TRUE} = (b_true - b_ref)*sliding^2/2", where="section 3.1")
slide.rule("slide.safe", "b_ref <= b_true", where="section 3.1: when the reckoned way is not too short",
           iff=f"{RECKONED} >= {TRUE}")  # fmt: skip

# --- 4 the code ------------------------------------------------------------------------------------------------------


def alike(count: Span) -> Fraction:
    """The pairs (n, k), 2 <= k <= n/2, with C(n, k) = the count: k >= 2 leaves n^2 < 4 times the count."""
    wanted = int(count) if isinstance(count, Fraction) else int(count.middle)
    most = 2 * int(wanted**0.5) + 2
    return Fraction(sum(comb(n, k) == wanted for n in range(4, most) for k in range(2, n // 2 + 1)))


CODE = "section 4, code"
codes = figures.under("AP-5")
codes.figure("codes.ways", "1", "1", where=f"{CODE}: binomials of 9139", by=alike, given={"count": exactly("9139")})
for _name, _text, _by in (
    ("palindromes", "19", "palindromes"),
    ("others", "9120", "codes - palindromes"),
    ("mirror_pairs", "4560", "(codes - palindromes)/2"),
    ("classes", "4579", "classes"),
    ("usable_both_ways", "4560", "classes - palindromes"),
    ("neighbours", "108", "inner*(slots - inner)"),
    ("wrong_readings", "110", "inner*(slots - inner) + 2"),
    ("thinned", "247", "slots*(slots - 1)/2/(inner*(inner - 1)/2)"),
    ("beside", "25,308", "(slots - 1)*(slots - 2)*(slots - 3)/2"),
    ("beside_mean", "5.538", "(slots - 1)*(slots - 2)*(slots - 3)/codes"),
):
    codes.figure(f"codes.{_name}", _text, "1", where=CODE, by=_by)
for _slots, _text in ((1, "40"), (2, "44"), (3, "48"), (4, "52")):
    codes.figure(f"codes.span_{_slots}", _text, "1", where=f"{CODE}, span in units for a least spacing",
                 by="slots + 1 + 4*(nearest - 1)", given={"nearest": derived(_slots)})  # fmt: skip
for _jitter, _text in (("0.05", "1.0811"), ("0.10", "0.8108"), ("0.20", "0.2703")):
    codes.figure(f"decode.plain_{_jitter}", _text, "%", where=f"{CODE}, plain decoding of the gaps",
                 by="(u/2 - 2*jitter)/((slots - 2)*u)", given={"jitter": derived(_jitter)})  # fmt: skip
AT_10 = {"jitter": derived("0.10")}
for _name, _text, _unit, _by in (
    ("cumulative", "0.7692", "%", "(u/2 - 2*jitter)/(slots*u)"),
    ("normalised", "0.200", "1", "2*jitter/u"),
    ("calibration", "0.5", "%", "2*jitter/L"),
    ("span", "40", "m", "L"),
):
    codes.figure(f"decode.{_name}", _text, _unit, where=f"{CODE}, decoding", by=_by, given=AT_10)
codes.figure("decode.most_jitter", "0.125", "m", where=f"{CODE}, jitter that a quarter slot bears", by="u/4/2")

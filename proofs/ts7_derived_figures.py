"""TS-7: the equations E1 to E11 and the figures that the specification derives from the printed ones, recomputed.

The equations are proved from what they are about: pulses counted in a turn or in 256 frames, mean times summed over the
states of a repairable two-out-of-three system.  The figures take the words of the reference design.
Source: derived from table 1 and section 3.1 [D]; 60 pulses a turn, divider 16, unit of the wheel word [A].

Main result: all of them hold.
"""

from __future__ import annotations

from fractions import Fraction

from models.ts7.numbers import (
    CHECK_WORD,
    DIAMETERS_MM,
    DIVIDER,
    PI,
    PULSES_A_REVOLUTION,
    ROLLBACK_WORD,
    ROLLBACK_WORD_OF_TABLE,
    WORD,
    full_scale_wheel_word,
)
from proofs.ts7_figures import fixed
from safety.audit import Known, Paper, Span, derived, printed

paper = Paper("ts7_derived", "TS-7, figures derived from the paper (specification)")

SYMBOLS: tuple[tuple[str, str, str, Known | None, str], ...] = (  # name, unit, what it is, value, definition
    ("osc", "kHz", "oscillator", printed("512", exact=True), ""),
    ("words", "1", "words of the ring", printed("4", exact=True), ""),
    ("bits", "1", "bits of a word", printed("8", exact=True), ""),
    ("frame", "ms", "time of a frame", None, "words*bits*2/osc"),
    ("r", "kHz", "operation frequency", None, "1/frame"),
    ("rate", "Hz", "how often a word is added", None, ""),
    ("D", "1", "word of a limit", None, ""),
    ("B", "1", "modulus of a word", None, "2^8"),
    ("N", "1", "divider behind the ring", fixed(DIVIDER), ""),
    ("Z", "1", "pulses of the generator a turn", fixed(PULSES_A_REVOLUTION), ""),
    ("π", "1", "", derived(Span(PI.low, PI.high)), ""),
    ("u", "mm", "diameter of one unit of the wheel word", fixed(5), ""),
    ("base", "mm", "diameter whose wheel word would be B", None, "B*u"),
    ("d", "mm", "true wheel diameter", None, ""),
    ("d'", "mm", "diameter that the switch shows", None, ""),
    ("d_least", "mm", "smallest wheel", printed("780", exact=True), ""),
    ("step", "mm", "step of the switch", printed("10", exact=True), ""),
    ("D_w", "1", "wheel word", None, "d'/u"),
    ("V", "km/h", "speed", None, ""),
    ("V_E", "km/h", "limit", None, ""),
    ("t", "s", "a time", None, ""),
    ("f_O", "Hz", "overflows of a word: D in B additions", None, "D/(B/rate)"),
    ("f_p", "Hz", "reference", None, "f_O/N"),
    ("f_s", "Hz", "generator: Z pulses a turn", None, "Z*V/(π*d)"),
    ("f_v", "Hz", "corrected: D_w overflows in B pulses", None, "D_w/(B/f_s)"),
    ("k", "Hz/(km/h)", "f_v a km/h, the switch set right", None, "Z/(π*base)"),
    ("unit_speed", "km/h", "speed of one unit of a word", None, "r/(B*N)/k"),
    ("limit", "km/h", "speed of a word", None, "D*unit_speed"),
    ("indicated", "km/h", "speed that f_v stands for", None, "f_v/k"),
    ("permitted", "km/h", "true speed whose f_v is that of the limit", None, "V_E*k*B*π*d/(D_w*Z)"),
    ("f_chk", "Hz", "check frequency", None, "check_word*r/B"),
    ("check_word", "1", "", derived(CHECK_WORD), ""),
    ("surplus", "1", "pulses of f_v above f_p after t", None, "k*V*t - k*V_E*t"),
    ("ppm", "ppm", "drift of the oscillator", fixed(100), ""),
    ("top", "km/h", "highest check speed", printed("90", exact=True), ""),
    ("off", "1", "steps by which the switch is off", None, ""),
    ("worst_word", "1", "word of the check speed with the worst error", None, ""),
    ("signal", "km/h", "its check speed", None, ""),
    ("half_step", "km/h", "half a step at the smallest wheel, at the highest speed", None, "top*step/2/d_least"),
    ("λ", "1/h", "failure rate of a channel", None, ""),
    ("λc", "1/h", "failure rate of the common part", None, ""),
    ("μ", "1/h", "repair rate of a channel", None, ""),
    ("all_up", "h", "mean time with three channels in order", None, "1/(3*λ + λc)"),
    ("one_down", "h", "mean time with one failed", None, "1/(2*λ + μ + λc)"),
    ("fails", "1", "chance that a channel fails before the common part", None, "3*λ*all_up"),
    ("mended", "1", "chance that it is repaired before another fails", None, "μ*one_down"),
    ("MTTF", "h", "mean time to failure", None, "(all_up + fails*one_down)/(1 - fails*mended)"),
    ("MTBF", "h", "printed", printed("30000", exact=True), ""),
    ("channel", "h", "MTBF of a channel", None, "1/λ"),
    ("common", "h", "MTBF of the common part", None, "1/λc"),
    ("repair", "h", "time of a repair", None, ""),
    ("c_share", "1", "rate of the common part for each of a channel", None, ""),
)
for _name, _unit, _about, _known, _by in SYMBOLS:
    paper.symbol(_name, _unit, _about, _known, by=_by)

# --- equations -------------------------------------------------------------------------------------------------------

RIGHT = {"D_w": "d/u", "d'": "d"}  # the switch set right
for _number, _text, _given in (
    ("E1", "frame = 32*2/osc", {"words": "4", "bits": "8"}),
    ("E2", "f_O = rate*D/256", {}),
    ("E3", "f_p = r*D/(256*N)", {"rate": "r"}),
    ("E4", "f_v = f_s*D_w/256", {}),
    ("E4_any_diameter", "f_v = V*Z/(π*base)", RIGHT),
    ("E5", "limit = f_p/k", {"rate": "r"}),
    ("E6_indicated", "indicated = V*d'/d", {}),
    ("E6_permitted", "permitted = V_E*d/d'", {}),
    ("E7", "f_chk = r*check_word/256", {}),
    ("E8", "MTTF = 5/(6*λ)", {"λc": "0", "μ": "0"}),
    ("E9", "MTTF = 3/(2*λ + λc) - 2/(3*λ + λc)", {"μ": "0"}),
    ("E10", "MTTF = (5*λ + μ + λc)/((3*λ + λc)*(2*λ + λc) + μ*λc)", {}),
    ("E11", "surplus = k*(V - V_E)*t", {}),
):
    paper.equation(_number, _text, where=f"specification 2, {_number.partition('_')[0]}", given=_given)

# --- 1.3 ring arithmetic: words and rates ----------------------------------------------------------------------------

ARITHMETIC = "specification 1.3"
TABLE = {  # raw overflow Hz, f_p Hz, speed of the word km/h, its error km/h
    25: ("1656.25", "103.5156", "24.9757", "-0.0243"),
    45: ("2968.75", "185.5469", "44.7677", "-0.2323"),
    65: ("4312.50", "269.5312", "65.0310", "0.0310"),
    75: ("4968.75", "310.5469", "74.9270", "-0.0730"),
    90: ("5968.75", "373.0469", "90.0066", "0.0066"),
}
for _speed, (_raw, _reference, _of_word, _error) in TABLE.items():
    at, of_word = f"{ARITHMETIC}, {_speed} km/h", {"D": fixed(WORD[_speed]), "rate": "r"}
    row = f"word_{_speed}"
    paper.figure(f"{row}.overflow", _raw, "Hz", where=at, by="f_O", given=of_word)
    paper.figure(f"{row}.reference", _reference, "Hz", where=at, by="f_p", given=of_word)
    paper.figure(f"{row}.speed", _of_word, "km/h", where=at, by="limit", given=of_word)
    paper.figure(f"{row}.error", _error, "km/h", where=at, by="limit - signal",
                 given={**of_word, "signal": derived(_speed)})  # fmt: skip
ROLL_BACK = {"D": fixed(ROLLBACK_WORD), "rate": "r"}
paper.figure("reverse.overflow", "343.75", "Hz", where=f"{ARITHMETIC}, reverse", by="f_O", given=ROLL_BACK)
paper.figure("reverse.reference", "21.4844", "Hz", where=f"{ARITHMETIC}, reverse", by="f_p", given=ROLL_BACK)
paper.figure("reverse.speed", "5.1836", "km/h", where=f"{ARITHMETIC}, reverse", by="limit", given=ROLL_BACK)
paper.figure("reverse.speed_13", "6.126", "km/h", where=f"{ARITHMETIC}, reverse with D = 13", by="limit",
             given={"D": fixed(ROLLBACK_WORD_OF_TABLE)})  # fmt: skip
paper.figure("ring.one_period", "16", "kHz", where=f"{ARITHMETIC}, factor 2", by="osc/(words*bits)")
paper.figure("ring.bit_rate", "256", "kHz", where=f"{ARITHMETIC}, factor 2", by="osc/2")
paper.figure("ring.unit", "31.25", "Hz", where=f"{ARITHMETIC}, overflow a unit", by="r/B")
paper.figure("ring.reference_unit", "1.953125", "Hz", where=f"{ARITHMETIC}, f_p a unit", by="r/(B*N)")
paper.figure("speed.factor", "4.144660", "Hz/(km/h)", where=f"{ARITHMETIC}, f_v", by="k")
paper.figure("speed.unit", "0.47124", "km/h", where=f"{ARITHMETIC}, unit of a word", by="unit_speed")
paper.figure("speed.unit_without_divider", "7.54", "km/h", where=f"{ARITHMETIC}, without divider", by="unit_speed*N")
paper.figure("wheel.base", "1280", "mm", where=f"{ARITHMETIC}, ratio d/1280", by="base")
FULL_SCALE = max(abs(Fraction(full_scale_wheel_word(mm) * 860, 255 * mm) - 1) for mm in DIAMETERS_MM)
paper.figure("wheel.full_scale", "0.1207", "%", where=f"{ARITHMETIC}, full-scale words", by="off",
             given={"off": derived(FULL_SCALE)})  # fmt: skip
paper.figure("check.frequency", "2656.25", "Hz", where="specification 1.5", by="f_chk")
paper.figure("check.below_third", "0.39", "%", where="specification 1.5, below 8000/3", by="1 - 3*f_chk/r")
paper.figure("lowering", "1.885", "km/h", where="specification 1.6, four words", by="4*unit_speed")
paper.figure("consumption", "65", "%", where="specification 1.2, 130 VA on 200 VA", by="130/200")

# --- 3 accuracy and beat ---------------------------------------------------------------------------------------------

FIGURES = "specification 3"
WORST = {"worst_word": fixed(WORD[45]), "signal": derived(45)}
paper.figure("accuracy.half_step", "0.577", "km/h", where=f"{FIGURES}, half wheel step", by="half_step")
paper.figure("accuracy.drift", "0.009", "km/h", where=f"{FIGURES}, 100 ppm", by="top*ppm")
paper.figure("accuracy.envelope", "0.818", "km/h", where=f"{FIGURES}, envelope", given=WORST,
             by="signal - worst_word*unit_speed + half_step + top*ppm")  # fmt: skip
paper.figure("accuracy.at_90", "0.593", "km/h", where=f"{FIGURES}, at 90 alone", given={"D": fixed(WORD[90])},
             by="limit*(1 + ppm)*(1 + step/2/d_least) - top")  # fmt: skip
for _steps, _least, _most in ((1, "1.059", "1.154"), (2, "2.143", "2.308")):
    for _end, _printed, _wheel in (("least", _least, 860 - 10 * _steps), ("most", _most, 780)):
        paper.figure(f"accuracy.switch_{_steps}_{_end}", _printed, "km/h", where="specification 8, P14",
                     by="top*off*step/d'", given={"off": derived(_steps), "d'": derived(_wheel)})  # fmt: skip
for _pulses, _printed in ((1, "0.804"), (2, "1.608")):
    paper.figure(f"beat.{_pulses}", _printed, "km/h", where="specification 2, E11", by="off/(k*t)",
                 given={"off": derived(_pulses), "t": printed("0.3", exact=True)})  # fmt: skip

# --- 4 MTBF ----------------------------------------------------------------------------------------------------------

FAMILY = "specification 4"
paper.figure("mtbf.series", "0.000033333", "1/h", where=f"{FAMILY}, first failure",
             by="1/MTBF")  # fmt: skip
paper.figure("mtbf.no_repair", "0.0000277778", "1/h", where=f"{FAMILY}, E8", by="5/(6*MTBF)")
paper.figure("mtbf.no_repair_channel", "36 000", "h", where=f"{FAMILY}, E8", by="6*MTBF/5", digits=5)
for _share, _rate in (("0.1", "0.000026114"), ("0.25", "0.000023932"), ("0.5", "0.000020952")):
    paper.figure(f"mtbf.common_{_share}", _rate, "1/h", where=f"{FAMILY}, E9",
                 by="(3/(2 + c_share) - 2/(3 + c_share))/MTBF", given={"c_share": derived(_share)})  # fmt: skip
FORWARD = f"{FAMILY}: mean time to failure with the rates found, by E10"
for _hours, _channel in ((8, "1180"), (24, "2019"), (72, "3424"), (168, "5095")):
    paper.statement(
        f"mtbf.repair_{_hours}h", f"repair in {_hours} h, channel MTBF {_channel} h: 30 000 h", where=FORWARD,
        holds="MTTF = MTBF", given={"λ": "1/channel", "μ": "1/repair", "λc": derived(0), "repair": derived(_hours),
                                    "channel": printed(_channel, digits=4)})  # fmt: skip
for _mean, _common in ((5_000, "36 085"), (10_000, "31 337"), (20_000, "30 325"), (36_000, "30 100")):
    paper.statement(
        f"mtbf.common_part_{_mean}h", f"channel MTBF {_mean} h, repair in 24 h, common MTBF {_common} h: 30 000 h",
        where=FORWARD, holds="MTTF = MTBF",
        given={"λ": "1/channel", "μ": "1/repair", "λc": "1/common", "common": printed(_common, digits=5),
               "repair": derived(24), "channel": derived(_mean)})  # fmt: skip

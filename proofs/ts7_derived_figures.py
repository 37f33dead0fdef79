"""TS-7: the equations E1 to E11 and the figures worked out from the printed ones, recomputed: not in print.

The equations are proved from what they are about: pulses counted in a turn or in 256 frames, mean times summed over the
states of a repairable two-out-of-three system.  The figures take the words of the reference design.
Source: derived from table 1 and section 3.1 [D]; fractions of the check window [R]; assumed [A]: words of the matrix,
within the offsets that a channel admits; 60 (30 to 80) pulses a turn and divider 16 (8 to 16), with which the word of
90 km/h fits into 8 bits; 5 (4 to 10) mm a unit of the wheel word, with which that of the greatest wheel does.

Main result: all of them hold for the reference design, those without an assumed input for every other one.
"""

from __future__ import annotations

from fractions import Fraction
from math import floor

from models.ts7.channel import ChannelData
from models.ts7.numbers import CHECK_WORD, DIVIDER, PI, PULSES_A_REVOLUTION, ROLLBACK_WORD_OF_TABLE, WORD
from proofs.ts7_figures import LOWERED, ROLL_BACK
from safety.audit import Known, Paper, Span, assumed, derived, printed, reconstructed

paper = Paper("ts7_derived", "TS-7: worked out from the paper, which does not print it", published=False)


def word(reference: int) -> Known:
    """A word of the matrix [A], with all offsets of its limit that the model of a channel admits."""
    offset = vars(ChannelData)["offset"]
    return assumed(reference, reference + offset.low, reference + offset.high, whole=True)


WHEEL = {name: printed(mm, exact=True) for name, mm in (("d_least", "780"), ("d_most", "860"), ("step", "10"))}
WHEEL_UNIT, FULL_WORD = assumed(5, 4, 10, whole=True), assumed(255, 128, 255, whole=True)

SYMBOLS: tuple[tuple[str, str, str, Known | None, str], ...] = (  # name, unit, what it is, value, definition
    ("osc", "kHz", "oscillator", printed("512", exact=True), ""),
    ("words", "1", "words of the ring", printed("4", exact=True), ""),
    ("bits", "1", "bits of a word", printed("8", exact=True), ""),
    ("two", "1", "oscillator periods of a bit time", reconstructed(2), ""),
    ("frame", "ms", "time of a frame", None, "words*bits*two/osc"),
    ("r", "kHz", "operation frequency", None, "1/frame"),
    ("rate", "Hz", "how often a word is added", None, ""),
    ("D", "1", "word of a limit", None, ""),
    ("B", "1", "modulus of a word", None, "2^8"),
    ("N", "1", "divider behind the ring", assumed(DIVIDER, 8, 16, whole=True), ""),
    ("Z", "1", "pulses of the generator a turn", assumed(PULSES_A_REVOLUTION, 30, 80, whole=True), ""),
    ("π", "1", "", derived(Span(PI.low, PI.high)), ""),
    ("u", "mm", "diameter of one unit of the wheel word", WHEEL_UNIT, ""),
    ("base", "mm", "diameter whose wheel word would be B", None, "B*u"),
    ("d", "mm", "true wheel diameter", None, ""),
    ("d'", "mm", "diameter that the switch shows", None, ""),
    ("d_least", "mm", "smallest wheel", WHEEL["d_least"], ""),
    ("d_most", "mm", "greatest wheel", WHEEL["d_most"], ""),
    ("full_word", "1", "word of the greatest wheel, if the words go up to full scale", FULL_WORD, ""),
    ("step", "mm", "step of the switch", WHEEL["step"], ""),
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
    ("check_word", "1", "", reconstructed(CHECK_WORD), ""),
    ("surplus", "1", "pulses of f_v above f_p after t", None, "k*V*t - k*V_E*t"),
    ("third", "1", "share of the word frequency", reconstructed(Fraction(1, 3)), ""),
    ("low_share", "1", "lower end of the check window", reconstructed(Fraction(1, 4)), ""),
    ("high_share", "1", "upper end", reconstructed(Fraction(1, 2)), ""),
    ("lowering", "1", "words by which the others are lowered", LOWERED, ""),
    ("ppm", "ppm", "drift of the oscillator", assumed(100, 0, 1000), ""),
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
    ("consumption", "V*A", "of the equipment", printed("130", exact=True), ""),
    ("rating", "V*A", "of the power part", printed("200", exact=True), ""),
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
    ("E1", "frame = 32*2/osc", {"words": "4", "bits": "8", "two": "2"}),
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
TABLE = {  # word, lowered word, raw overflow Hz, f_p Hz, speed of the word km/h, its error km/h
    25: ("53", "49", "1656.25", "103.5156", "24.9757", "-0.0243"),
    45: ("95", "91", "2968.75", "185.5469", "44.7677", "-0.2323"),
    65: ("138", "134", "4312.50", "269.5312", "65.0310", "0.0310"),
    75: ("159", "155", "4968.75", "310.5469", "74.9270", "-0.0730"),
    90: ("191", "187", "5968.75", "373.0469", "90.0066", "0.0066"),
}
for _speed, (_nearest, _lowered, _raw, _reference, _of_word, _error) in TABLE.items():
    at = f"{ARITHMETIC}, {_speed} km/h"
    of_word: dict[str, Known | str] = {"D": word(WORD[_speed]), "rate": "r"}
    row = f"word_{_speed}"
    paper.figure(f"{row}.nearest", _nearest, "1", where=at, by="signal/unit_speed",
                 given={"signal": printed(str(_speed), exact=True)})  # fmt: skip
    paper.figure(f"{row}.lowered", _lowered, "1", where="specification 1.6, lowered word", by="D - lowering",
                 given=of_word)  # fmt: skip
    paper.figure(f"{row}.overflow", _raw, "Hz", where=at, by="f_O", given=of_word)
    paper.figure(f"{row}.reference", _reference, "Hz", where=at, by="f_p", given=of_word)
    paper.figure(f"{row}.speed", _of_word, "km/h", where=at, by="limit", given=of_word)
    paper.figure(f"{row}.error", _error, "km/h", where=at, by="limit - signal",
                 given={**of_word, "signal": printed(str(_speed), exact=True)})  # fmt: skip
REVERSE: dict[str, Known | str] = {"D": ROLL_BACK, "rate": "r"}
paper.figure("reverse.overflow", "343.75", "Hz", where=f"{ARITHMETIC}, reverse", by="f_O", given=REVERSE)
paper.figure("reverse.reference", "21.4844", "Hz", where=f"{ARITHMETIC}, reverse", by="f_p", given=REVERSE)
paper.figure("reverse.speed", "5.1836", "km/h", where=f"{ARITHMETIC}, reverse", by="limit", given=REVERSE)
paper.figure("reverse.speed_13", "6.126", "km/h", where=f"{ARITHMETIC}, reverse with D = 13", by="limit",
             given={"D": word(ROLLBACK_WORD_OF_TABLE)})  # fmt: skip
paper.figure("ring.one_period", "16", "kHz", where=f"{ARITHMETIC}, factor 2", by="osc/(words*bits)")
paper.figure("ring.bit_rate", "256", "kHz", where=f"{ARITHMETIC}, factor 2", by="osc/two")
paper.figure("ring.unit", "31.25", "Hz", where=f"{ARITHMETIC}, overflow a unit", by="r/B")
paper.figure("ring.reference_unit", "1.953125", "Hz", where=f"{ARITHMETIC}, f_p a unit", by="r/(B*N)")
paper.figure("speed.factor", "4.144660", "Hz/(km/h)", where=f"{ARITHMETIC}, f_v", by="k")
paper.figure("speed.unit", "0.47124", "km/h", where=f"{ARITHMETIC}, unit of a word", by="unit_speed")
paper.figure("speed.unit_without_divider", "7.54", "km/h", where=f"{ARITHMETIC}, without divider", by="unit_speed*N")
paper.figure("wheel.base", "1280", "mm", where=f"{ARITHMETIC}, ratio d/1280", by="base")


def wheel_steps(d_least: Fraction, d_most: Fraction, step: Fraction) -> list[Fraction]:
    """The diameters at which the switch can stand."""
    return [d_least + n * step for n in range(int((d_most - d_least) / step) + 1)]


def whole_words(d_least: Fraction, d_most: Fraction, step: Fraction, u: Fraction | Span) -> int | Span:
    """Steps of the switch with a whole wheel word of 8 bits."""
    steps = wheel_steps(d_least, d_most, step)
    if isinstance(u, Span):
        return Span(0, len(steps))
    words = (diameter / u for diameter in steps)
    return sum(word.denominator == 1 and word < 256 for word in words)


def full_scale_error(
    d_least: Fraction, d_most: Fraction, step: Fraction, full_word: Fraction | Span
) -> Fraction | Span:
    """Greatest relative error, in percent, of the words nearest to full scale times diameter over the greatest one."""
    if isinstance(full_word, Span):
        return Span(0, 100)
    exact = (full_word * diameter / d_most for diameter in wheel_steps(d_least, d_most, step))
    return max(abs(floor(word + Fraction(1, 2)) / word - 1) for word in exact) * 100


paper.figure("wheel.whole_words", "9", "1", where=f"{ARITHMETIC}, wheel words 156 to 172", by=whole_words,
             given={**WHEEL, "u": WHEEL_UNIT})  # fmt: skip
paper.figure("wheel.full_scale", "0.1207", "%", where=f"{ARITHMETIC}, full-scale words", by=full_scale_error,
             given={**WHEEL, "full_word": FULL_WORD})  # fmt: skip
CHECK_WORDS = {"word": ("85", "B*third"), "least": ("65", "B*low_share + 1"), "most": ("127", "B*high_share - 1")}
for _end, (_printed, _by) in CHECK_WORDS.items():
    paper.figure(f"check.{_end}", _printed, "1", where="specification 1.5, words in the window", by=_by)
paper.figure("check.frequency", "2656.25", "Hz", where="specification 1.5", by="f_chk")
paper.figure("check.below_third", "0.39", "%", where="specification 1.5, below 8000/3", by="1 - f_chk/(third*r)")
paper.figure("lowering", "1.885", "km/h", where="specification 1.6, four words", by="lowering*unit_speed")
paper.figure("consumption", "65", "%", where="specification 1.2, 130 VA on 200 VA", by="consumption/rating")

# --- 3 accuracy and beat ---------------------------------------------------------------------------------------------

FIGURES = "specification 3"
WORST = {"worst_word": word(WORD[45]), "signal": printed("45", exact=True)}
paper.figure("accuracy.half_step", "0.577", "km/h", where=f"{FIGURES}, half wheel step", by="half_step")
paper.figure("accuracy.drift", "0.009", "km/h", where=f"{FIGURES}, 100 ppm", by="top*ppm")
paper.figure("accuracy.envelope", "0.818", "km/h", where=f"{FIGURES}, envelope", given=WORST,
             by="signal - worst_word*unit_speed + half_step + top*ppm")  # fmt: skip
paper.figure("accuracy.at_90", "0.593", "km/h", where=f"{FIGURES}, at 90 alone", given={"D": word(WORD[90])},
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


def rounded(hours: int) -> Known:
    """A time found here and rounded to an hour."""
    return derived(hours, hours - Fraction(1, 2), hours + Fraction(1, 2))


for _hours, _channel in ((8, 1180), (24, 2019), (72, 3424), (168, 5095)):
    paper.statement(
        f"mtbf.repair_{_hours}h", f"repair in {_hours} h, channel MTBF {_channel} h: 30 000 h", where=FORWARD,
        holds="MTTF = MTBF", given={"λ": "1/channel", "μ": "1/repair", "λc": derived(0), "repair": derived(_hours),
                                    "channel": rounded(_channel)})  # fmt: skip
for _mean, _common in ((5_000, 36_085), (10_000, 31_337), (20_000, 30_325), (36_000, 30_100)):
    paper.statement(
        f"mtbf.common_part_{_mean}h", f"channel MTBF {_mean} h, repair in 24 h, common MTBF {_common} h: 30 000 h",
        where=FORWARD, holds="MTTF = MTBF",
        given={"λ": "1/channel", "μ": "1/repair", "λc": "1/common", "common": rounded(_common),
               "repair": derived(24), "channel": derived(_mean)})  # fmt: skip
paper.figure("mtbf.common_part_rate", "0.000031911", "1/h", where="specification 8, P20", by="1/common",
             given={"common": rounded(31_337)})  # fmt: skip

"""TS-7: every number printed in the paper, recomputed from the other printed ones, the models or a campaign.

The print is badly damaged: fractions all read "%", some limits are lost.  What is not in print, but worked out from it,
stands in `ts7_derived_figures`, with the equations.
Source: Table 1, sections 2 and 3, conclusion [P]; fractions of the check window, label of roll-back [R]; unit and words
of the matrix, comparator [A]: within what the models admit, and a unit of which the highest speed takes all 8 bits.

Main results: 512 kHz and 4 words of 8 bits give 16 kHz, so one bit time takes two periods for the printed 8 kHz; the
reverse detection has two nominal values, of which the second lies within the tolerance of the first; "most faults
detected" and "whichever function fails ... is detected" are false of single words and outputs (77 of 163 single faults
detected, at every signal) and true of the path that all words share; the MTBF fixes no structure, boards "half" and
parts "%" cannot be derived.
"""

from __future__ import annotations

from collections.abc import Callable
from datetime import date
from fractions import Fraction
from functools import cache
from typing import Any

from models.ts7.channel import ChannelData
from models.ts7.numbers import CHECK_WORD, WORD
from proofs.ts7_campaign import ring_single_stuck
from safety.audit import Known, Paper, assumed, derived, printed, reconstructed
from safety.inject.campaign import changed

paper = Paper("ts7", "ATC Equipment for Sobu Subway Line Cars (1972)")


def admitted(name: str) -> Known:
    """A word that no source gives [A]: all that the model of a channel admits."""
    word = vars(ChannelData)[name]
    return assumed(word.default, word.low, word.high, whole=True)


CHECKED = ("25", "45", "65", "75", "90")  # table 1, check speeds
SIGNALS = ("0", "25", "45", "65", "75", "90")  # table 1, control signals; lines 0S1 .. 90S1
UNIT = assumed("0.47124", "0.353", "0.703")  # 90/255 to 90/128: the word of the highest speed takes all 8 bits
ROLL_BACK, LOWERED = admitted("rollback_word"), admitted("lowering")

SYMBOLS: tuple[tuple[str, str, str, Known | None, str], ...] = (  # name, unit, what it is, value, definition
    ("osc", "kHz", "oscillator", printed("512", exact=True), ""),
    ("words", "1", "words of the ring", printed("4", exact=True), ""),
    ("bits", "1", "bits of a word", printed("8", exact=True), ""),
    ("rate", "kHz", "operation frequency: a frame", printed("8", exact=True), ""),
    ("frame", "ms", "time of a frame", printed("0.125", exact=True), ""),
    ("periods", "1", "oscillator periods of a bit time", None, "osc/(words*bits*rate)"),
    ("two", "1", "oscillator periods of a bit time, two-phase clock", reconstructed(2), ""),
    ("least_wheel", "mm", "smallest diameter", printed("780", exact=True), ""),
    ("most_wheel", "mm", "greatest diameter", printed("860", exact=True), ""),
    ("step", "mm", "step of the wheel switch", printed("10", exact=True), ""),
    ("steps", "1", "steps of the wheel switch", printed("9", exact=True), ""),
    ("ic_boards", "1", "boards of ICs in a tray", printed("3", exact=True), ""),
    ("buffers", "1", "input and output boards in a tray", printed("2", exact=True), ""),
    ("D", "1", "word of a speed", None, ""),
    ("unit", "km/h", "speed of one unit of a word", UNIT, ""),
    ("B", "1", "modulus of a word", None, "2^8"),
    ("limit", "km/h", "speed of a word", None, "D*unit"),
    ("signal", "km/h", "control signal", None, ""),
    ("word_error", "km/h", "of the word nearest to a speed, at most", None, "unit/2"),
    ("wheel_error", "km/h", "half a step of the switch, at the smallest wheel", None, "top*step/2/least_wheel"),
    ("drift", "ppm", "of the oscillator", assumed(100, 0, 1000), ""),
    ("top", "km/h", "highest check speed", printed("90", exact=True), ""),
    ("accuracy", "km/h", "of the speed check, either way", printed("2.0", exact=True), ""),
    ("nominal", "km/h", "reverse detection in table 1", printed("6.0"), ""),
    ("told", "km/h", "reverse detection in the text", printed("5"), ""),
    ("tolerance", "km/h", "of reverse detection", printed("2.0", exact=True), ""),
    ("low_voltage", "V", "speed input at 2 km/h", printed("0.8", exact=True), ""),
    ("slow", "km/h", "speed at that voltage", printed("2", exact=True), ""),
    ("high_voltage", "V", "greatest speed input", printed("10", exact=True), ""),
    ("load_resistance", "ohm", "of the speed input, illegible", None, ""),
    ("mains", "Hz", "frequency of the power part", printed("60", exact=True), ""),
    ("mains_off", "Hz", "its tolerance", printed("3", exact=True), ""),
    ("mains_admitted", "%", "tolerance of what it feeds", printed("5", exact=True), ""),
    ("voltage_off", "%", "tolerance of the power part's voltage", printed("10", exact=True), ""),
    ("voltage_admitted", "%", "tolerance of what it feeds", printed("10", exact=True), ""),
    ("consumption", "V*A", "of the equipment", printed("130", exact=True), ""),
    ("rating", "V*A", "of the power part", printed("200", exact=True), ""),
    ("overload", "V*A", "for 2 minutes", printed("300", exact=True), ""),
    ("warm", "K", "continuous, above 0 Celsius", printed("50", exact=True), ""),
    ("hot", "K", "at which it may be switched on, above 0 Celsius", printed("60", exact=True), ""),
    ("cold", "K", "continuous, above 0 Celsius", printed("-10", exact=True), ""),
    ("low_share", "1", "share of the word frequency, lower end of the window", reconstructed(Fraction(1, 4)), ""),
    ("high_share", "1", "upper end", reconstructed(Fraction(1, 2)), ""),
    ("check", "Hz", "check frequency of the ring", None, "check_word*rate/B"),
    ("check_word", "1", "", reconstructed(CHECK_WORD), ""),
    ("share", "1", "a share that is printed '%'", None, ""),
    ("boards_before", "1", "boards of the predecessor", None, ""),
    ("faults", "1", "single stuck faults of a channel's ring, data matrix and adder", None, ""),
    ("found", "1", "those that the check window detects", None, ""),
    ("λ", "1/h", "failure rate of a channel", None, ""),
)
for _name, _unit, _about, _known, _by in SYMBOLS:
    paper.symbol(_name, _unit, _about, _known, by=_by, signed=_name == "cold")

# --- 3.1 the ring ----------------------------------------------------------------------------------------------------

RING = "section 3.1"
frame = paper.figure("ring.frame", "0.125", "ms", where=RING, by="1/rate")
paper.figure(
    "ring.rate", "8", "kHz", where=RING, by="osc/(words*bits)", also={"the printed time of a frame": "1/frame"}
)
paper.figure("ring.rate_by_frame", "8", "kHz", where=RING, by="1/frame")
paper.figure("ring.oscillator", "512", "kHz", where=RING, by="words*bits*rate")
paper.figure("ring.words", "4", "1", where=RING, by="osc/(two*bits*rate)")
paper.figure("ring.bits", "8", "1", where=RING, by="osc/(two*words*rate)")
paper.statement(
    "ring.two_periods", "512 kHz, 4 words of 8 bits, 8 kHz: two oscillator periods a bit time", where=RING,
    holds="periods = two",
)  # fmt: skip

# --- table 1 ---------------------------------------------------------------------------------------------------------

TABLE = "table 1"
for _checked, _signal in zip(CHECKED, SIGNALS[1:], strict=True):
    paper.figure(
        f"table1.check_speed_{_checked}", _checked, "km/h", where=f"{TABLE}, check speeds", by="signal",
        given={"signal": printed(_signal, exact=True)},
    )  # fmt: skip
    paper.decided(
        f"table1.accuracy_{_checked}", f"speed-check accuracy +-2.0 km/h, at {_checked}", where=f"{TABLE}, accuracy",
        claim=f"ts7_accuracy.error_of_limit_{_checked}",
    )  # fmt: skip
paper.statement(
    "table1.accuracy", "speed-check accuracy +-2.0 km/h, with half a wheel step and drift", where=f"{TABLE}, accuracy",
    holds="word_error + wheel_error + top*drift <= accuracy",
)  # fmt: skip

WHEEL = f"{TABLE}, wheel-diameter correction"
paper.figure("table1.wheel_steps", "9", "1", where=WHEEL, by="(most_wheel - least_wheel)/step + 1")
paper.figure("table1.wheel_step", "10", "mm", where=WHEEL, by="(most_wheel - least_wheel)/(steps - 1)")
paper.figure("table1.least_wheel", "780", "mm", where=WHEEL, by="most_wheel - (steps - 1)*step")
paper.figure("table1.most_wheel", "860", "mm", where=WHEEL, by="least_wheel + (steps - 1)*step")
REVERSE = f"{TABLE}, item 8 (label damaged)"
paper.statement("table1.reverse_nominal", "6.0 km/h, and 5 km/h in the text: one nominal value", where=REVERSE,
                holds="nominal = told")  # fmt: skip
paper.statement("table1.reverse_range", "6.0 +- 2.0 km/h, and 5 km/h in the text: consistent", where=REVERSE,
                holds="nominal - tolerance <= told <= nominal + tolerance")  # fmt: skip
paper.statement("table1.reverse_word", "6.0 +- 2.0 km/h, kept by the word of the model", where=REVERSE,
                holds="nominal - tolerance <= limit <= nominal + tolerance", given={"D": ROLL_BACK})  # fmt: skip
paper.figure("text.reverse", "5", "km/h", where="section 3.2, reverse detection", by="limit", given={"D": ROLL_BACK})
paper.decided("table1.reverse_reported", "reverse detection at 8 km/h at the latest", where=REVERSE,
              claim="ts7_rollback.reports_eight_backward")  # fmt: skip
paper.decided("table1.reverse_false", "no reverse detection below 4 km/h", where=REVERSE,
              claim="ts7_rollback.below_four_is_no_roll_back")  # fmt: skip

RESPONSE = f"{TABLE}, response 0.3 s"
for _what, _claim in {
    "brake": "brakes_within_the_printed_response",
    "release": "releases_within_the_printed_response",
    "brake_without_signal": "brakes_without_signal_within_the_printed_response",
}.items():
    paper.decided(f"table1.response_{_what}", f"response at most 0.3 s: {_what.replace('_', ' ')}", where=RESPONSE,
                  claim=f"ts7_channel.{_claim}")  # fmt: skip
paper.decided("table1.response_reverse", "response at most 0.3 s: reverse detection", where=RESPONSE,
              claim="ts7_rollback.reports_eight_backward_within_the_printed_response")  # fmt: skip

INPUT = f"{TABLE}, speed input"
paper.statement("table1.voltage", "0.8 V at 2 km/h, 10 V at most", where=INPUT, holds="low_voltage <= high_voltage")
paper.statement("table1.voltage_not_proportional", "10 V at most: less than 0.8 V at 2 km/h would make at 90",
                where=INPUT, holds="high_voltage < low_voltage*top/slow")  # fmt: skip
paper.figure("table1.load_resistance", "517", "ohm", where=f"{INPUT}, load (unit illegible)", by="load_resistance")

POWER = f"{TABLE}, power part"
paper.figure("table1.mains_tolerance", "3", "Hz", where=POWER, by="mains*mains_admitted")
paper.figure("table1.mains_admitted", "5", "%", where=f"{TABLE}, supply of the equipment", by="mains_off/mains")
paper.statement("table1.voltage_tolerance", "AC 100 V +-10 % out, +-10 % admitted", where=POWER,
                holds="voltage_off <= voltage_admitted")  # fmt: skip
paper.statement("table1.consumption", "130 VA on a power part of 200 VA", where=POWER, holds="consumption <= rating")
paper.statement("table1.full_load", "load 0 to 200 VA, 300 VA for 2 minutes", where=POWER, holds="rating < overload")
paper.figure("table1.overload", "150", "%", where=POWER, by="overload/rating")
paper.statement("table1.temperature", "-10 to +50 C continuous, switched on at +60 C", where=f"{TABLE}, temperature",
                holds="cold < warm < hot")  # fmt: skip
paper.figure("text.boards", "5", "1", where="section 2, a tray", by="ic_boards + buffers")

# --- 1.5 the check window, whose fractions are all printed "%" -------------------------------------------------------

WINDOW = "section 3.2, fault detection"

paper.statement("window.share", '"%-frequency of the reference": which share it is', where=WINDOW, holds="share < 1")
paper.statement("window.between", "normal if 1/3 lies between 1/4 and 1/2 of the word frequency", where=WINDOW,
                holds="low_share*rate < check < high_share*rate")  # fmt: skip
paper.decided("window.dead_check", "the fault is detected: a dead check word, within 64 ms", where=WINDOW,
              claim="ts7_window.dead_check_is_found")  # fmt: skip

# --- what is said of faults, against the campaign --------------------------------------------------------------------


@cache
def campaign(signal: int = 65) -> dict[str, Any]:
    """What the campaign of all single stuck faults finds with the word of a signal; wrong side is above 67/65 of it."""
    return changed(ring_single_stuck, constant={**ring_single_stuck.constant, "d0": WORD[signal]}).run()


def by_campaign(found: Callable[[dict[str, Any]], Fraction | int]) -> Callable[[], Known]:
    """What is found with the word of 65 km/h, and with those of the other signals: none of them is in print [A]."""

    def known() -> Known:
        values = [found(campaign(signal)) for signal in WORD]
        return assumed(found(campaign()), min(values), max(values))

    return known


SHARED = ("stage", "carry", "sum", "data")  # what all words go through


def number(wanted: Callable[[str], Any], groups: Callable[[str], bool] = lambda group: True) -> Callable[[], Known]:
    """How many faults of these groups are in classes such as `wrong/no`: direction, and whether detected."""

    def count(result: dict[str, Any]) -> int:
        chosen = (each["counts"] for each in result["groups"] if groups(each["group"]))
        return sum(n for counts in chosen for cell, n in counts.items() if wanted(cell))

    return by_campaign(count)


def detected(cell: str) -> bool:
    """Of a class: the check window finds it."""
    return cell.endswith("/yes")


ALL, FOUND = number(bool), number(detected)
WRONG = number(lambda cell: cell.startswith("wrong/"))
UNSEEN = number(lambda cell: cell == "wrong/no")
SAYS = "conclusion: most faults are detected"
paper.statement(
    "faults.most", SAYS, where="conclusion", holds="found > faults/2", given={"found": FOUND, "faults": ALL}
)
paper.statement(
    "faults.most_effective", f"{SAYS}: of those that change anything", where="conclusion", holds="share > 1/2",
    given={"share": by_campaign(lambda result: Fraction(result["detected_of_effective"]["exact"]))},
)  # fmt: skip
paper.statement(
    "faults.most_wrong_side", f"{SAYS}: of the wrong-side ones", where="conclusion", holds="found > faults/2",
    given={"found": number(lambda cell: cell == "wrong/yes"), "faults": WRONG},
)  # fmt: skip
paper.statement(
    "faults.shared_path", "whichever shared function fails, the fault is detected", where="section 3.2",
    holds="found = faults",
    given={"found": number(detected, SHARED.__contains__), "faults": number(bool, SHARED.__contains__)},
)  # fmt: skip
paper.statement(
    "faults.whichever", "whichever function fails, the motion stops and the fault is detected", where="section 3.2",
    holds="found = faults", given={"found": FOUND, "faults": ALL},
)  # fmt: skip
paper.statement(
    "faults.whichever_wrong_side", "whichever function fails: no wrong-side fault stays undetected",
    where="section 3.2; conclusion, at one place", holds="faults = 0", given={"faults": UNSEEN},
)  # fmt: skip

# --- brake and synchronisation ---------------------------------------------------------------------------------------

BRAKE = "section 3.2, brake synchronisation"
paper.figure("brake.lowering", "2", "km/h", where=BRAKE, by="limit", given={"D": LOWERED})
for _what, _printed, _claim in (
    ("only_lowers", "the level of the others is lowered by 2 km/h", "ts7_thresholds.lowering_only_lowers"),
    ("healthy", "if they brake too, all are normal: limits within 2.0 km/h",
     "ts7_thresholds.nobody_isolated_within_two"),
    ("within_accuracy", "if they do not, the first is faulty: limits within +-2.0 km/h",
     "ts7_thresholds.nobody_isolated_within_the_published_accuracy"),
    ("cut_off", "if they do not, the first is cut off", "ts7_synchronisation.a_lone_brake_is_isolated"),
    ("dual_fault", "two channels faulty: emergency brake at once", "ts7_power.two_isolated_channels_apply_eb"),
    ("reverse", "any channel's reverse detection: emergency brake", "ts7_power.any_reverse_detection_applies_eb"),
    ("power", "loss of inverter and motor-generator: all relays drop",
     "ts7_power.stops_a_frame_after_the_release_time"),
    ("change_over", "loss of the inverter alone: no permanent stop", "ts7_power.inverter_loss_is_no_permanent_stop"),
):  # fmt: skip
    paper.decided(f"brake.{_what}", _printed, where=BRAKE, claim=_claim)

# --- reliability, size, tests ----------------------------------------------------------------------------------------

paper.figure("mtbf", "30 000", "h", where="conclusion, MTBF about 30 000 h", by="5/(6*λ)", digits=1)
paper.statement("boards.half", "boards reduced to about half", where="conclusion",
                holds="(ic_boards + buffers)/boards_before <= 1/2")  # fmt: skip
paper.statement("parts.share", 'parts about "%" of the conventional system', where="section 3.1", holds="share < 1")
paper.statement("parts.range", 'parts reduced to "% to %"', where="section 3.2", holds="1/3 <= share <= 1/2")

TESTS = "section 4, car tests, 1972"
PERIODS = ((date(1972, 5, 26), date(1972, 6, 1)), (date(1972, 6, 28), date(1972, 6, 30)))
SERVICE = date(1972, 7, 15)
DAYS = sum((last - first).days + 1 for first, last in PERIODS)
paper.symbol("tested", "day", "days of both periods of tests", derived(DAYS))
paper.symbol("test_periods", "1", "periods of tests", derived(len(PERIODS)))
paper.symbol("before_service", "day", "from the last test to service", derived((SERVICE - PERIODS[-1][1]).days))
paper.figure("tests.read_as_days", "21", "day", where=f"{TESTS}: 21 of a damaged sign, read as days", by="tested")
paper.figure("tests.read_as_periods", "2", "1", where=f"{TESTS}: the same, read as 2 periods", by="test_periods")
paper.statement("tests.before_service", "tests up to 30 June, service from 15 July", where=TESTS,
                holds="before_service > 0")  # fmt: skip

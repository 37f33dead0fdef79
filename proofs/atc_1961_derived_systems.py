"""Automatic train control of 1961: what the specification works out of foreign lines, the limiter and the program.

Source: limits, mileages, 250 km/h, 500 km, 3 h, 130 s, +-7.5 s [P]; decelerations, ladder, headway [A]; the rest [D].

Main results: with the reference all of them hold as they stand in the specification; the ladder of decelerations saves
773 m against a single 1.5 km/h/s from 210 km/h.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from proofs.atc_1961_derived_figures import figures
from proofs.atc_1961_figures import KMH, MILES, exactly, paper
from proofs.atc_1961_physics import STOP, through
from safety.audit import Known, Span, assumed, derived

MILE = Fraction("1.609344")  # km

# --- 2.2, 2.3 foreign lines ------------------------------------------------------------------------------------------

SOVIET = {"b": assumed("1.8", "1.2", "3"), "t": assumed("2", "0.5", "4")}  # 1.8 km/h/s is 0.5 m/s^2
AMERICAN = {"b": assumed("2.16", "1.5", "3"), "t": assumed("3", "1", "5")}  # 2.16 km/h/s is 0.6 m/s^2
LIMITS = [*map(int, KMH.values()), 0]
for _name, _first, _text in (("CD", 2, "25.694"), ("BD", 1, "70.448"), ("AD", 0, "167.901")):
    figures.figure(f"soviet.{_name}", _text, "m", where="section 2.3, distances", by=through(LIMITS[_first:]),
                   given=SOVIET)  # fmt: skip
for (_name, _miles), _text in zip(MILES.items(), ("144.841", "72.420", "40.234", "24.140"), strict=True):
    figures.figure(f"american.{_name}", _text, "km/h", where="section 2.2, limits in km/h", by=_name,
                   given={_name: exactly(_miles)})  # fmt: skip
for _from, _to, _text in (
    (90, 45, "1132.41"), (45, 25, "293.50"), (25, 15, "100.14"), (25, 0, "137.61"), (15, 0, "57.59"),
):  # fmt: skip
    figures.figure(f"american.{_from}_to_{_to}", _text, "m", where="section 2.2, distances",
                   by=through((_from * MILE, _to * MILE)), given=AMERICAN)  # fmt: skip
for _name, _unit, _text in (("miles", "mile", "25 635"), ("km", "km", "41 256")):
    figures.figure(f"american.mileage_{_name}", _text, _unit, where="section 2.2, three mileages together",
                   by="first + second + third", given={"first": exactly("15 084"), "second": exactly("1 951"),
                                                       "third": exactly("8 600")})  # fmt: skip

# --- 3.2 stepped high-speed limiter ----------------------------------------------------------------------------------

LADDER = ((210, 160, "1.5"), (160, 110, "2.0"), (110, 70, "2.4"), (70, 30, "2.8"), (30, 0, "2.8"))  # km/h, km/h/s
OF_LADDER = ("the ladder of speeds and decelerations",)
FREE = {"t": assumed("2", "0.5", "4")}


def of_ladder(running: Fraction | int) -> Callable[..., Span]:
    """The way in m through the ladder, with so much of the free runs counted, as a relation of `t`."""

    def way(t: Span) -> Span:
        parts = [through((high, low))(derived(brake).value, running * t) for high, low, brake in LADDER]
        return sum(parts[1:], parts[0])

    way.__doc__ = f"all steps of the ladder, {'with' if running else 'without'} their free runs"
    return way


for (_high, _low, _brake), _text in zip(LADDER, ("1829.63", "1026.39", "477.78", "237.30", "61.31"), strict=True):
    figures.figure(f"limiter.{_high}", _text, "m", where="section 3.2, section lengths", by=through((_high, _low)),
                   given={"b": derived(_brake, rests_on=OF_LADDER), **FREE})  # fmt: skip
figures.figure("limiter.sum", "3632.41", "m", where="section 3.2, all sections", by=of_ladder(1), given=FREE)
figures.figure("limiter.braking", "3310.19", "m", where="section 3.2, all sections, no free run", by=of_ladder(0),
               given=FREE)  # fmt: skip
AT_210: dict[str, Known | str] = {"V": derived(210), "b": derived("1.5", rests_on=OF_LADDER), "t": derived(0)}
paper.symbol("scatter", "s", "of the build-up time", assumed("0.5", "0", "1"))
paper.symbol("misread", "%", "error of the speed reading", assumed("1", "0", "3"))
LONGER = "((V*(1 + misread))^2 - V^2)/(2*b)"
for _name, _text, _unit, _by, _given in (
    ("single", "4083.33", "m", STOP, AT_210),
    ("scatter", "29.17", "m", "V*scatter", AT_210),
    ("misread", "82.08", "m", LONGER, AT_210),
    ("misread_share", "4.8", "%", f"{LONGER}/((V^2 - V1^2)/(2*b))", {**AT_210, "V1": derived(160)}),
    ("step", "1712.96", "m", "(V^2 - V1^2)/(2*b)", {**AT_210, "V1": derived(160)}),
):
    figures.figure(f"limiter.at_210_{_name}", _text, _unit, where="section 3.2, from 210 km/h", by=_by, given=_given)

# --- 4.2 on-board program --------------------------------------------------------------------------------------------

paper.symbol("drift", "km/h", "bias of the mean speed", by="way/time*punctual/time")
paper.symbol("before", "s", "headway before the gain", assumed("120", "60", "600"))
paper.symbol("after", "s", "headway after it", by="before/(1 + gain)")
PROGRAM = "section 4.2"
_constant: dict[str, Known | str] = {"τ": exactly("130")}
for _name, _text, _unit, _by in (
    ("mean", "166.667", "km/h", "way/time"),
    ("share", "0.0694", "%", "punctual/time"),
    ("way_at_top", "520.8", "m", "top*punctual"),
    ("way_at_mean", "347.2", "m", "way/time*punctual"),
    ("bias", "0.116", "km/h", "drift"),
    ("constant_way", "9.03", "km", "top*τ"),
    ("constants", "83.1", "1", "time/τ"),
    ("at_top", "2", "h", "way/top"),
    ("reserve", "1", "h", "time - way/top"),
):
    figures.figure(f"program.{_name}", _text, _unit, where=PROGRAM, by=_by, given=_constant)
for _gain, _factor, _seconds in (("12", "0.8929", "107.14"), ("15", "0.8696", "104.35")):
    _more: dict[str, Known | str] = {"gain": exactly(_gain)}
    figures.figure(f"traffic.{_gain}_factor", _factor, "1", where="more traffic, as a factor of the headway",
                   by="1/(1 + gain)", given=_more)  # fmt: skip
    figures.figure(f"traffic.{_gain}_headway", _seconds, "s", where="more traffic, as a headway", by="after",
                   given=_more)  # fmt: skip

"""Automatic train control of 1961: the numbers that the specification works out and the paper does not print.

Distances, ceilings and marker places rest on assumed decelerations and times; the note of each says what it is with the
reference.  Gradient bins are asked for at a given deceleration, so that only gravity is assumed in them.
Source: 5 curves, limits of foreign lines, mileages, 250 km/h, 500 km, 3 h [P]; section 1 and ladders [A]; the rest [D].

Main results: with the reference all of them hold as they stand in the specification; the scatter of +-25 m with five
curves needs 3.4374 km/h/s, the marker that leaves out the free run costs 2.859 m.
"""

from __future__ import annotations

from fractions import Fraction

from proofs.atc_1961_figures import paper
from proofs.atc_1961_physics import BRAKES, CEILING, CONSERVATIVE, OF_BIN, STANDING, STOP
from safety.audit import Known, Paper, assumed, derived
from safety.audit.paper import Given

figures = Paper("atc_1961_derived", f"{paper.title}, figures derived from it (specification)", published=False)
figures.symbols = paper.symbols

# --- 1 stopping distances and ceilings -------------------------------------------------------------------------------

SERVICE: dict[str, Known | str] = {"b": "b_s", "t": "t_s", "V1": STANDING}
EMERGENCY: dict[str, Known | str] = {"b": "b_e", "t": "t_e", "V1": STANDING}
DISTANCES = {
    25: ("48.611", "35.218"),
    45: ("137.500", "99.107"),
    65: ("270.833", "194.742"),
    95: ("554.167", "397.718"),
    100: ("611.111", "438.492"),
    110: ("733.333", "525.992"),
    130: ("1011.11", "724.802"),
}
physics = figures.under("SP-P6")
for _speed, _pair in DISTANCES.items():
    for _name, _text, _brake in zip(("service", "emergency"), _pair, (SERVICE, EMERGENCY), strict=True):
        physics.figure(f"stop.{_name}_{_speed}", _text, "m", where=f"{_name} brake from {_speed} km/h", by=STOP,
                       given={**_brake, "V": derived(_speed)})  # fmt: skip
for _gradient, _text in ((-20, "829.775"), (20, "488.760")):
    physics.figure(f"stop.service_at_{_gradient}", _text, "m", where=f"service brake from 100 km/h at {_gradient} ‰",
                   by=f"V*t_s + V^2/(2*(b_s {'-' if _gradient < 0 else '+'} g*p))",
                   given={"V": derived(100), "p": derived(20)})  # fmt: skip
for _place, _text in ((50, "22.295"), (100, "35.559"), (200, "53.694"), (400, "78.934"), (600, "98.175")):
    physics.figure(f"ceiling.{_place}", _text, "km/h", where=f"service pattern at {_place} m", by=CEILING,
                   given={**SERVICE, "x": derived(_place)})  # fmt: skip
AT_400 = {"x": derived(400)}
for _sign, _name, _text in (("-", "down_20", "67.477"), ("+", "up_20", "88.687")):
    physics.figure(f"ceiling.400_{_name}", _text, "km/h", where="service pattern, 400 m before the point, 20 ‰",
                   by=CEILING, given={**SERVICE, **AT_400, "b": f"b_s {_sign} g*p", "p": derived(20)})  # fmt: skip
physics.figure("ceiling.400_emergency", "94.025", "km/h", where="emergency pattern, 400 m before the point", by=CEILING,
               given={**EMERGENCY, **AT_400})  # fmt: skip
figures.under("SP-P3").figure("ceiling.400_conservative", "73.346", "km/h", by=CONSERVATIVE,
                              where="service pattern under traction, 400 m before the point",
                              given={**SERVICE, **AT_400})  # fmt: skip
physics.figure("ceiling.target_65", "93.234", "km/h", where="service pattern, 300 m before 65 km/h must be held",
               by=CEILING, given={**SERVICE, "V1": derived(65), "X": derived(300)})  # fmt: skip

# --- 2.5 several ground markers --------------------------------------------------------------------------------------

for _name, _unit, _about, _known, _by in (
    ("Vmax", "km/h", "top speed", assumed("100", "60", "130"), ""),
    ("l_4", "m", "marker 4 to the signal", assumed("50", "30", "200"), ""),
    ("B", "km/h", "check speed at marker 3, release speed", assumed("30", "10", "30.5"), ""),
    ("v4", "km/h", "greatest speed at 4 that stops before the signal", None,
     "sqrt((b_e*t_e)^2 + 2*b_e*l_4) - b_e*t_e"),
    ("x2", "m", "marker 2 to the signal", None, "l_4 + Vmax*t_s + (Vmax^2 - v4^2)/(2*b_s)"),
    ("A", "km/h", "check speed at marker 2", None,
     "(sqrt((b_s*t_s)^2 + 2*(B^2 + v4^2 + 2*b_s*(x2 - l_4))) - b_s*t_s)/2"),
    ("x3", "m", "marker 3 to the signal", None, "l_4 + A*t_s + (A^2 - v4^2)/(2*b_s)"),
    ("x1", "m", "marker 1 to the signal", None, "x3 + Vmax*t_s + (Vmax^2 - B^2)/(2*b_s)"),
    ("x2_drawn", "m", "marker 2 where the standard curve meets the top speed", None, "l_4 + Vmax^2/(2*b_s)"),
    ("v4_drawn", "km/h", "speed at 4 then", None, "sqrt(Vmax^2 - 2*b_s*(x2_drawn - l_4 - Vmax*t_s))"),
    ("v4_traction", "km/h", "speed at 4 after traction from 2 to 3", None,
     "sqrt(Vmax^2 - 2*b_s*(x3 - l_4 - Vmax*t_s))"),
    ("v4_gone", "km/h", "the same after t_e under the service brake", None, "v4_drawn - b_s*t_e"),
):  # fmt: skip
    paper.symbol(_name, _unit, _about, _known, by=_by)
markers = figures.under("SP-M1")
for _name, _text, _unit, _by in (
    ("fastest", "30.633", "km/h", "v4"),
    ("A", "74.677", "km/h", "A"),
    ("x1", "910.279", "m", "x1"),
    ("x2", "608.980", "m", "x2"),
    ("x3", "349.168", "m", "x3"),
    ("from_B", "48.214", "m", "B*t_e + B^2/(2*b_e)"),
    ("drawn", "605.556", "m", "x2_drawn"),
    ("drawn_speed", "31.623", "km/h", "v4_drawn"),
    ("drawn_overrun", "2.859", "m", "v4_drawn*t_e + v4_drawn^2/(2*b_e) - l_4"),
    ("drawn_credited", "43.224", "m", "v4_drawn*t_e - b_s*t_e^2/2 + v4_gone^2/(2*b_e)"),
    ("traction_speed", "74.933", "km/h", "v4_traction"),
    ("traction_overrun", "204.039", "m", "v4_traction*t_e + v4_traction^2/(2*b_e) - l_4"),
):
    markers.figure(f"markers.{_name}", _text, _unit, where="section 3.1.1, marker scheme", by=_by)

FIXED = {name: derived(known.value.low, rests_on=(f"{name} = {known.value.low}",)) for name, known in BRAKES.items()}
paper.under("SP-M1").statement(
    "markers.X", "a driver who brakes at 1 and never eases would stop short, at X", where="section 3.1.1",
    holds="x1 - Vmax*t_s - Vmax^2/(2*b_s) > l_4", given=FIXED,
)  # fmt: skip

# --- 2.6 function generator ------------------------------------------------------------------------------------------

BINS = {  # km/h/s: (overrun, short) by centre of the bin -16, -8, 0, 8, 16 permille
    "2.5": (("56.50", "48.81"), ("42.60", "37.50"), ("33.26", "29.70"), ("26.69", "24.11"), ("21.89", "19.96")),
    "3.0": (("35.11", "31.26"), ("28.01", "25.25"), ("22.87", "20.81"), ("19.02", "17.45"), ("16.07", "14.85")),
    "3.5": (("23.92", "21.72"), ("19.81", "18.15"), ("16.68", "15.39"), ("14.24", "13.22"), ("12.30", "11.47")),
    "4.0": (("17.33", "15.96"), ("14.75", "13.67"), ("12.71", "11.84"), ("11.06", "10.35"), ("9.71", "9.13")),
}
ONE_CURVE = {"2.5": ("341.0", "6.32"), "3.0": ("230.7", "9.07"), "3.5": ("166.9", "12.30"), "4.0": ("126.5", "15.99")}
EXACT_G = derived("9.80665", rests_on=("g = 9.80665",))
FROM_100: dict[str, Known | str] = {"v0": derived(100), "g": EXACT_G}
SMALLEST = "(sqrt((v0^2/far)^2 + 4*b^2) - v0^2/far)/(2*g)"  # gradient whose spread is `far`
paper.symbol("below", "km/h/s", "a deceleration that is too little")
paper.symbol("enough", "km/h/s", "one that is enough")
generator = figures.under("SP-G1")
for _rate, _row in BINS.items():
    _with: Given = {**FROM_100, "b": derived(_rate)}
    for _centre, _texts in zip((-16, -8, 0, 8, 16), _row, strict=True):
        _overrun: Given = {**_with, "p": derived(4 - _centre), "q": derived(-_centre)}
        _short: Given = {**_with, "p": derived(-_centre), "q": derived(-_centre - 4)}
        for _name, _text, _given in zip(("overrun", "short"), _texts, (_overrun, _short), strict=True):
            generator.figure(f"bins.{_rate}.{_centre}.{_name}", _text, "m", by=OF_BIN, given=_given,
                             where=f"100 km/h, {_rate} km/h/s, bin round {_centre} ‰")  # fmt: skip
    _spread, _least = ONE_CURVE[_rate]
    generator.figure(f"bins.{_rate}.spread", _spread, "m", where=f"100 km/h, {_rate} km/h/s, one curve, +-20 ‰",
                     by="spread", given=_with)  # fmt: skip
    generator.figure(f"bins.{_rate}.gradient", _least, "m/km", where="+-gradient with a spread of 100 m", by=SMALLEST,
                     given=_with)  # fmt: skip
LEAST = "g*(p + q)/2 + sqrt((g*(p - q)/2)^2 + v0^2*g*(p - q)/(2*bound))"  # deceleration that keeps a bin
STEEPEST, LEVEL = {"p": derived(20), "q": derived(16)}, {"p": derived(4), "q": STANDING}
OF_20 = {**FROM_100, "p": derived(20)}
for _name, _text, _by, _given in (
    ("level_bin", "2.872", LEAST, {**FROM_100, **LEVEL}),
    ("equal_distances", "2.889", "sqrt((g*p)^2 + g*p*v0^2/(2*curves*bound))", OF_20),
    ("spread_of_100", "4.4846", "sqrt((g*p)^2 + g*p*v0^2/far)", OF_20),
):
    generator.figure(f"least.{_name}", _text, "km/h/s", where="deceleration that keeps the scatter", by=_by,
                     given=_given)  # fmt: skip
generator.statement("least.all_bins", "3.4374 km/h/s keeps all bins, less does not", holds=f"below < {LEAST} <= enough",
                    where="deceleration that keeps the scatter", given={
                        **FROM_100, **STEEPEST, "below": derived("3.4373"), "enough": derived("3.4374"),
                    })  # fmt: skip
for _rotating, _text in (("0.06", "3.321"), ("0.10", "3.249")):
    _pull = derived(EXACT_G.value.low / (1 + Fraction(_rotating)), rests_on=(f"g = 9.80665, rho = {_rotating}",))
    generator.figure(f"least.all_bins_{_rotating}", _text, "km/h/s", by=LEAST,
                     where=f"deceleration that keeps all bins, rotating mass {_rotating}",
                     given={**FROM_100, **STEEPEST, "g": _pull})  # fmt: skip
for _name, _text, _by in (("one_curve", "0.196", "demand"), ("selected", "0.03923", "demand_selected")):
    figures.figure(f"follow_up.{_name}", _text, "m/s^2", where="section 3.1.3, demanded correction at 20 ‰", by=_by,
                   given={"g": EXACT_G})  # fmt: skip

"""Automatic train control of 1961: every printed number of chapters 2, 3 and 4.2, recomputed.

Nothing else in print is a function of most of them: limits of foreign lines, mileages, years.
Source: numbers [P]; decelerations, free-run times, headways [A]; the rest [D].

Main results: a gradient of +-20 % would leave no deceleration, +-20 permille is meant; one curve for +-20 permille
spreads the stops from 100 km/h over more than 100 m at every admissible deceleration; +-25 m with five curves rests on
the deceleration; 250 km/h, 500 km, 3 h and +-7.5 s go together, but follow from nothing.
"""

from __future__ import annotations

from proofs.atc_1961_physics import declare
from safety.audit import Known, Paper, assumed, printed

paper = Paper("atc_1961", "Automatic Train Control Equipment (1961)")
declare(paper)


def exactly(text: str) -> Known:
    """A printed count or setting."""
    return printed(text, exact=True)


SYMBOLS: tuple[tuple[str, str, str, Known | None, str], ...] = (  # name, unit, what it is, value, definition
    ("curves", "1", "standard curves that the gradient signal selects from", exactly("5"), ""),
    ("steepest", "m/km", "gradient either way, read as permille", exactly("20"), ""),
    ("steepest_percent", "%", "the same as it is printed", exactly("20"), ""),
    ("half_bin", "m/km", "gradient either way of a curve's own", None, "steepest/curves"),
    ("curves_wanted", "1", "the same, as somebody chose it", None, ""),
    ("bound", "m", "scatter either way with the curves selected", exactly("25"), ""),
    ("far", "m", "scatter that is exceeded with one curve", exactly("100"), ""),
    ("brake", "km/h/s", "deceleration of the stock", assumed("2.5", "1.5", "4"), ""),
    ("fast", "km/h", "speed of the comparison", exactly("100"), ""),
    ("v_one", "km/h", "a speed at which the brake comes on", None, ""),
    ("v_other", "km/h", "another one", None, ""),
    ("spread", "m", "stopping distances down and up the steepest gradient, subtracted", None,
     "v0^2/2*(1/(b - g*steepest) - 1/(b + g*steepest))"),
    ("spread_one", "m", "the same from one speed", None, "v_one^2/2*(1/(b - g*steepest) - 1/(b + g*steepest))"),
    ("spread_other", "m", "the same from another", None, "v_other^2/2*(1/(b - g*steepest) - 1/(b + g*steepest))"),
    ("worst", "m", "overrun in the bin that falls most", None,
     "v0^2/2*(1/(b - g*steepest) - 1/(b - g*(steepest - half_bin)))"),
    ("demand", "m/s^2", "correction of the brake on a gradient, one curve", None, "g*steepest"),
    ("demand_selected", "m/s^2", "the same with the curves selected", None, "g*half_bin"),
    ("clear", "mile/h", "American limit, clear", None, ""),
    ("approach_medium", "mile/h", "American limit, approach medium", None, ""),
    ("approach", "mile/h", "American limit, approach", None, ""),
    ("red", "mile/h", "American limit after the B point", None, ""),
    ("B_point", "m", "from the B point to the stop signal", None, ""),
    ("V_A", "km/h", "Soviet limit from A", None, ""),
    ("V_B", "km/h", "from B", None, ""),
    ("V_C", "km/h", "from C", None, ""),
    ("first", "mile", "first American mileage", None, ""),
    ("second", "mile", "second", None, ""),
    ("third", "mile", "third", None, ""),
    ("route", "km", "length of a system in use", None, ""),
    ("vehicles", "1", "equipped vehicles", None, ""),
    ("since", "1", "year in which a system began", None, ""),
    ("saving", "%", "energy saved", None, ""),
    ("gain", "%", "traffic gained", None, ""),
    ("top", "km/h", "greatest speed of the planned trains", exactly("250"), ""),
    ("way", "km", "the run", exactly("500"), ""),
    ("time", "h", "time for it", exactly("3"), ""),
    ("punctual", "s", "deviation aimed at, either way", exactly("7.5"), ""),
    ("τ", "s", "time constant of the train", None, ""),
    ("punctual_found", "s", "deviation reached", None, ""),
)  # fmt: skip
for _name, _unit, _about, _known, _by in SYMBOLS:
    paper.symbol(_name, _unit, _about, _known, by=_by)

# --- 3.1 scatter of stops on gradients -------------------------------------------------------------------------------

STOPS = "section 3.1.2, brake-start control"
FROM_100 = {"v0": "fast", "b": "brake"}
paper.statement("gradient.spread", "from 100 km/h the stops often lie more than 100 m apart", where=STOPS,
                holds="spread > far", given=FROM_100)  # fmt: skip
paper.wording("gradient.speed", "if the initial speed changes, the spread naturally becomes larger",
              where=f"{STOPS}, read: with a higher one", says="spread rises with v0",
              when=("b > g*steepest",))  # fmt: skip
paper.equation("gradient.any_speed", "spread_other > spread_one", where=f"{STOPS}, the same, read: with any other one",
               when=("b > g*steepest",))  # fmt: skip
paper.statement("gradient.percent", "gradients within +-20 %", where=f"{STOPS}: what is left of the brake downhill",
                holds="brake - g*steepest_percent > 0")  # fmt: skip
paper.statement("gradient.permille", "gradients within +-20, read as permille",
                where=f"{STOPS}: what is left of the brake downhill", holds="brake - g*steepest > 0")  # fmt: skip
narrow = paper.under("SP-G1")
narrow.statement("gradient.curves", "with 5 curves the scatter is about +-25 m", where=f"{STOPS}, in all bins",
                 holds="worst <= bound", given=FROM_100)  # fmt: skip
narrow.statement("gradient.worth", "5 curves in place of one make the scatter smaller", where=STOPS,
                 holds="worst < spread/2", given=FROM_100)  # fmt: skip
paper.figure("gradient.count", "5", "1", where=f"{STOPS}, number of curves", by="curves_wanted")
paper.equation("follow_up.smaller", "demand_selected < demand", where="section 3.1.3: less is left to be corrected",
               when=("curves > 1",))  # fmt: skip

# --- 2.2 to 2.4 limits of foreign lines ------------------------------------------------------------------------------

AMERICAN, SOVIET = "section 2.2, figure 3", "section 2.3, figure 4"
MILES = {"clear": "90", "approach_medium": "45", "approach": "25", "red": "15"}
for _name, _text in MILES.items():
    paper.figure(f"american.{_name}", _text, "mile/h", where=AMERICAN, by=_name)
_miles = {name: exactly(text) for name, text in MILES.items()}
paper.statement("american.falls", "limits 90, 45, 25 and 15 mph fall towards the stop signal", where=AMERICAN,
                holds="clear > approach_medium > approach > red", given=_miles)  # fmt: skip
paper.statement("american.b_point", "the B point lies a brake distance before the stop signal", where=AMERICAN,
                holds="B_point >= V*t_s + V^2/(2*b_s)", given={"V": "approach", **_miles})  # fmt: skip
KMH = {"V_A": "40", "V_B": "25", "V_C": "15"}
for _name, _text in KMH.items():
    paper.figure(f"soviet.{_name}", _text, "km/h", where=SOVIET, by=_name)
paper.statement("soviet.falls", "40 from A, 25 from B, 15 from C, stopped at D", where=SOVIET,
                holds="V_A > V_B > V_C > 0", given={n: exactly(t) for n, t in KMH.items()})  # fmt: skip

# --- 2 systems in use ------------------------------------------------------------------------------------------------

IN_USE = "systems in use"
for _name, _text, _unit, _by, _where in (
    ("trip_stop", "1914", "1", "since", "mechanical trip stop"),
    ("hamburg_since", "1930", "1", "since", "permanent magnets, Hamburg"),
    ("hamburg_cars", "450", "1", "vehicles", "permanent magnets, Hamburg"),
    ("german_since", "1939", "1", "since", "inductive stop, Germany"),
    ("german_route", "3600", "km", "route", "inductive stop, Germany"),
    ("german_vehicles", "1000", "1", "vehicles", "inductive stop, Germany"),
    ("jnr_b_point", "1950", "1", "since", "B point, Japanese National Railways"),
    ("american_first", "15 084", "mile", "first", "United States, first of three mileages"),
    ("american_second", "1 951", "mile", "second", "United States, second"),
    ("american_third", "8 600", "mile", "third", "United States, third"),
    ("energy_least", "5", "%", "saving", "energy saved, from"),
    ("energy_most", "7", "%", "saving", "energy saved, to"),
    ("traffic_least", "12", "%", "gain", "more traffic, from"),
    ("traffic_most", "15", "%", "gain", "more traffic, to"),
):
    paper.figure(f"in_use.{_name}", _text, _unit, where=f"{IN_USE}, {_where}", by=_by)

# --- 4.2 on-board program --------------------------------------------------------------------------------------------

PROGRAM = "section 4.2"
paper.statement("program.reachable", "500 km in 3 h with 250 km/h at most", where=PROGRAM, holds="top > way/time")
paper.figure("program.punctual", "7.5", "s", where=f"{PROGRAM}, deviation in 3 h, either way", by="punctual_found")
paper.figure("program.time_constant", "130", "s", where=f"{PROGRAM}, time constant", by="τ")

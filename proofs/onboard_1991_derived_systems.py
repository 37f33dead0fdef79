"""On-board microcomputers, 1991: what the specifications work out of release, processors, crossings and radio.

Source: nothing of it is in print; spacings, rates, times, blocks, train lengths [A]; relations [D].

Main results: with the reference all of them hold as they stand in the specification; the headway of a moving block is
least at the speed whose braking way is the train's length and margin together.
"""

from __future__ import annotations

from proofs.atc_1961_physics import FASTEST, STOP
from proofs.onboard_1991_derived_figures import figures
from proofs.onboard_1991_figures import paper
from safety.audit import Known, assumed, derived

for _name, _unit, _about, _known, _by in (
    ("release_spacing", "m", "last release balise to the signal", assumed("200", "50", "600"), ""),
    ("restored", "m", "to the signal when it goes back to stop", assumed("100", "20", "600"), ""),
    ("λ", "1/h", "failure rate of a processor", assumed("0.00001", "0.0000001", "0.001"), ""),
    ("λ_c", "1/h", "of the comparator", assumed("0.000001", "0.00000001", "0.0001"), ""),
    ("β", "1", "share of common causes", assumed("0.01", "0.001", "0.1"), ""),
    ("cycle", "s", "cycle of the processors", assumed("0.1", "0.05", "1"), ""),
    ("T_w", "s", "warning of a level crossing", assumed("30", "20", "60"), ""),
    ("V_line", "km/h", "line speed", assumed("100", "60", "130"), ""),
    ("mark", "m", "stop mark of the station to the crossing", assumed("100", "20", "300"), ""),
    ("dwell", "s", "stop in the station", assumed("30", "10", "120"), ""),
    ("start", "m/s^2", "acceleration of departure", assumed("0.7", "0.3", "1.2"), ""),
    ("place", "m", "where the warning starts, before the crossing", None, "T_w*V_line"),
    ("cross", "s", "run from the mark to the crossing", None, "sqrt(2*mark/start)"),
    ("to_mark", "s", "run from that place to a stop at the mark", None,
     "(place - mark - V_line^2/(2*b_s))/V_line + V_line/b_s"),
    ("T_r", "s", "between reports", assumed("1", "0.5", "3"), ""),
    ("T_c", "s", "latency of a report", assumed("0.5", "0.1", "1"), ""),
    ("T_loss", "s", "until radio is taken as lost", assumed("3", "1", "10"), ""),
    ("limit_of", "1/h", "dangerous rate of a common cause", None, "β*λ"),
    ("together", "1/h", "both fail in one cycle", None, "2*λ^2*cycle"),
    ("V_best", "km/h", "speed of the least headway", None, "sqrt(2*b*(length + gap))"),
):  # fmt: skip
    paper.symbol(_name, _unit, _about, _known, by=_by)

# --- 6 release, 7 processors -----------------------------------------------------------------------------------------

for _speed, _text in ((45, "16.0"), (25, "28.8")):
    figures.under("AV-5").figure(f"release.delay_{_speed}", _text, "s", where="section 6, release balises 200 m apart",
                                 by="release_spacing/V", given={"V": derived(_speed)})  # fmt: skip
figures.under("AV-4").figure("release.restored", "45.22", "km/h", where="section 6, signal back at stop 100 m ahead",
                             by=FASTEST, given={"l": "restored", "b": "b_e", "t": "t_e"}, digits=4)  # fmt: skip
for _name, _text, _unit, _by in (
    ("mtbf", "47 619", "h", "1/(2*λ + λ_c)"),
    ("common", "0.0000001", "1/h", "limit_of"),
    ("coincidence", "0.00000000000000556", "1/h", "together"),
):
    figures.under("AV-7").figure(f"dual.{_name}", _text, _unit, where="section 7, two processors", by=_by)

# --- 8.2 level crossing ----------------------------------------------------------------------------------------------

for _name, _text, _unit, _by in (
    ("place", "833.33", "m", "place"),
    ("express", "30.0", "s", "place/V_line"),
    ("stopping", "93.30", "s", "to_mark + dwell + cross"),
    ("from_mark", "16.90", "s", "cross"),
    ("announced", "13.10", "s", "T_w - cross"),
):
    figures.under("AO-2").figure(f"crossing.{_name}", _text, _unit, where="section 8.2, level crossing", by=_by)

# --- 9 radio ---------------------------------------------------------------------------------------------------------

for _name, _speed, _text, _slow in (
    ("100", 100, "41.67", {}),
    ("270", 270, "112.5", {}),
    ("270_slow", 270, "300", {"T_r": derived(3), "T_c": derived(1)}),
):
    figures.under("AR-7").figure(f"radio.stale_{_name}", _text, "m", where="section 9, staleness of a report",
                                 by="(T_r + T_c)*V", given={"V": derived(_speed), **_slow})  # fmt: skip
figures.under("AR-7").figure("radio.lost", "694.44", "m", where="section 9, way after the loss, 100 km/h",
                             by=f"V*T_loss + {STOP}",
                             given={"V": derived(100), "b": "b_s", "t": "t_s"})  # fmt: skip
SHORT: dict[str, Known | str] = {
    "length": assumed("200", "100", "400"), "gap": assumed("50", "10", "200"), "t_sys": assumed("5", "2", "15"),
}  # fmt: skip
LONG: dict[str, Known | str] = {**SHORT, "length": assumed("400", "200", "400"), "V": derived(270)}
AT_100: dict[str, Known | str] = {**SHORT, "V": derived(100)}
LEAST = "t_sys + sqrt(2*(length + gap)/b)"
headway = figures.under("AR-9")
for _name, _text, _unit, _by, _given in (
    ("best_2.5", "67.08", "km/h", "V_best", {**SHORT, "b": "b_s"}),
    ("least_2.5", "31.83", "s", LEAST, {**SHORT, "b": "b_s"}),
    ("at_100_2.5", "34.00", "s", "moving", {**AT_100, "b": "b_s"}),
    ("best_3.5", "79.37", "km/h", "V_best", {**SHORT, "b": "b_e"}),
    ("least_3.5", "27.68", "s", LEAST, {**SHORT, "b": "b_e"}),
    ("at_100_3.5", "28.29", "s", "moving", {**AT_100, "b": "b_e"}),
    ("at_270_2.5", "65.0", "s", "moving", {**LONG, "b": "b_s"}),
    ("at_270_3.5", "49.57", "s", "moving", {**LONG, "b": "b_e"}),
):
    headway.figure(f"headway.{_name}", _text, _unit, where="section 9, moving block", by=_by, given=_given)
BLOCKS: dict[str, Known | str] = {
    **AT_100, "b": "b_s", "blocks": assumed("2", "2", "4", whole=True), "block": assumed("600", "300", "1200"),
}  # fmt: skip
headway.figure("headway.fixed", "55.4", "s", where="section 9, fixed block", by="fixed", given=BLOCKS)
headway.figure("headway.gain", "21.4", "s", where="section 9, what the moving block saves", by="fixed - moving",
               given=BLOCKS)  # fmt: skip
headway.equation("headway.best", "V = V_best", where="section 9: where the headway is least", least="moving")
headway.equation("headway.least", f"moving >= {LEAST}", where="section 9: at any speed")

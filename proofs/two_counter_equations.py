"""Two-counter ATC: the equations of the paper and its words about them, judged by the theory behind them.

The theory: counter 2 keeps the gate open for n2E speed pulses, counter 1 counts f1 meanwhile; a sample is Tp + Tc, of
N speed pulses.  Figure 2: the first count t1..t3 is just missed, so the speed at t2, halfway, is V'E; the next
sample ends at t4.  All symbols without a definition are free and above 0.  A rule "brake where ..." is asked both ways:
it brakes where a brake is due, and nowhere else.
Source: equations (1) to (25), sections 2 to 4 [P]; figure 2 [R]; steady state of (1) [D].

Main results: (6) has a wrong symbol, (7) holds only without preparation, (1) adds a frequency to a number, the words at
(24) have both directions reversed; (8) to (23) and (25) hold, (5) to the first order.
"""

from __future__ import annotations

from models.two_counter.numbers import COUNTING_S, N1F, N1F_RANGE
from safety.audit import Paper, assumed, derived, printed

COUNTING_RANGE = ("0.3117388", "0.3117396")  # Tc that the seven frequencies of table 2(A) leave
TITLE = "T. Konishi, Automatic Train Control by Digital Device (1967)"
paper = Paper("two_counter", TITLE).under("TC-A")

SYMBOLS = (  # name, unit, what it is, definition
    ("VE", "km/h", "check speed", ""),
    ("f1", "Hz", "standard oscillator", ""),
    ("f2", "Hz", "speed signal", ""),
    ("f2E", "Hz", "speed signal at the check speed", ""),
    ("k", "1", "feedback of the reversible counter", ""),
    ("k'", "Hz/(km/h)", "speed signal a km/h", ""),
    ("U", "s", "unit of time of the reversible counter", ""),
    ("n", "1", "reading of the reversible counter: where f2 = k n f1", "f2/(k*f1)"),
    ("nE", "1", "its reading at the check speed", "f2E/(k*f1)"),
    ("n_sum", "1", "its reading if it sums over one unit of time", ""),
    ("Tp", "s", "preparation", ""),
    ("Ts", "s", "sampling time", "Tp + Tc"),
    ("W", "s", "time that the gate is open", ""),
    ("n1", "1", "pulses of f1 while the gate is open", "f1*W"),
    ("n2E", "1", "speed pulses counted", "f2E*Tc"),
    ("n_min", "1", "least n2E that the setting asks for", ""),
    ("ε", "km/h", "setting accuracy asked for", ""),
    ("ΔVs", "km/h", "static error", "VE/n1F"),
    ("V'E", "km/h", "speed from which a sample brakes", "VE + ΔVs"),
    ("T''c", "s", "counting time of the first window", ""),
    ("T''s", "s", "sampling time of the next sample", ""),
    ("t1", "s", "first count starts", ""),
    ("t2", "s", "half of it is over", "t1 + T''c/2"),
    ("t3", "s", "it ends", "t1 + T''c"),
    ("t4", "s", "the next sample ends", "t3 + T''s"),
    ("V20", "km/h", "speed at t1", "V'E + α*(t1 - t2)"),
    ("V21", "km/h", "speed at t4", "V'E + α*(t4 - t2)"),
    ("ΔV1", "km/h", "gained from t2 to t3", "α*(t3 - t2)"),
    ("ΔV2", "km/h", "gained from t3 to t4", "α*(t4 - t3)"),
    ("VF", "km/h", "speed at t3", "V'E + ΔV1"),
    ("N", "1", "pulses of the next sample", "k'*(VF*T''s + α*T''s^2/2)"),
    ("T's", "s", "sampling time at V'E", "N/(k'*V'E)"),
    ("ΔVd", "km/h", "dynamic error", "V21 - V'E"),
    ("ΔV", "km/h", "total error", "ΔVs + ΔVd"),
    ("K", "1", "share of the samples in the dynamic error", ""),
    ("r", "1", "total error relative to the check speed", ""),
    ("q", "s", "one over f1", ""),
    ("n_opt", "1", "n1F at which f1 is least", "2/r"),
    ("n_asy", "1", "n1F at the asymptote", ""),
    ("fM", "Hz", "least f1", "K*α*n_opt^2/VE/(r*n_opt - 1)"),
)
for _name, _unit, _about, _by in SYMBOLS:
    paper.symbol(_name, _unit, _about, by=_by)
paper.symbol("α", "km/h/s", "acceleration", printed("1", exact=True))
paper.symbol("n1F", "1", "count that releases", assumed(N1F, *N1F_RANGE, whole=True))
paper.symbol("Tc", "s", "counting time", derived(COUNTING_S, *COUNTING_RANGE), by="n1F/f1")


paper.equation("eq1", "n = f2/(k*f1 + 1)", where="(1)")
paper.equation(
    "eq1_one_unit_of_time",
    "n = f2*U/(k*f1*U + 1)",
    where="(1), read as a sum over one unit of time",
    given={"n": "n_sum", "f2": "n_sum/U + k*n_sum*f1"},
)
paper.rule("eq2", "n >= nE", where="(2): brake", iff="f2 >= f2E")
paper.equation("eq3", "n1 = f1*n2E/f2", where="(3)", given={"n2E": "f2*W"}, note="both count while the gate is open")
GATE = {"W": "n2E/f2"}  # until n2E speed pulses have come
paper.rule("eq4", "n1 <= n1F", where="(4): brake", iff="f2 >= f2E", given=GATE)
paper.rule("circuit", "n1 < n1F", where="section 5: brake unless counter 1 reaches n1F", iff="f2 > f2E", given=GATE)
paper.rule("eq4_and_circuit", "n1 < n1F", where="(4) against section 5: brake", iff="n1 <= n1F", given=GATE)
paper.equation(
    "eq5",
    "ΔVs = VE/n1F",
    where="(5)",
    given={"ΔVs": "VE/(n1F - 1)"},
    when=("n1F > 1",),
    neglecting="1/n1F",
    note="so that every phase counts at most n1F - 1",
)
paper.equation("eq6", "Ts = Tp + Pc", where="(6)")
paper.equation("eq7", "n1F/f1", of="Ts", where="(7), going on from (6)")
paper.equation(
    "eq8", "V'E = VE + ΔVs", where="(8)", when=("n1F > 1",), given={"V'E": "VE*n1F/(n1F - 1)", "ΔVs": "VE/(n1F - 1)"}
)
paper.equation("eq9", "T's*V'E = (V'E + ΔV1 + ΔV2/2)*T''s", where="(9)")
paper.equation("eq10", "ΔV1 = α*T''c/2", where="(10)")
paper.equation("eq11", "ΔV2 = α*T''s", where="(11)")
paper.equation("eq12", "T''s = (sqrt(1 + 2*α*T's*V'E/VF^2) - 1)*VF/α", where="(12)")
paper.equation("eq13", "ΔVd = ΔV1 + ΔV2", where="(13)")
EQ_14 = "α*T''c/2 + (sqrt(1 + 2*α*T's*V'E/VF^2) - 1)*VF"
paper.equation("eq14", f"ΔVd = {EQ_14}", where="(14)")
paper.equation("eq15", "ΔV = VE/n1F + α*(T''c/2 + T''s)", where="(15) [R]: (5) and (13) with (10) and (11)")
paper.equation("eq16", "ΔV = VE/n1F + α*Ts*(T''c/(2*Ts) + T''s/Ts)", where="(16)")
paper.equation("eq17", "n1F = f1*n2E/f2E", where="(17)")

SHARE = {"K": "T''c/(2*Ts) + T''s/Ts"}  # printed below (18)
CHOICE = "f1 = K*α*n1F^2/VE/(ΔV*n1F/VE - 1)"
paper.equation("eq18", CHOICE, where="(18), with (7) as printed", given={**SHARE, "Tp": "0"}, note="Ts = n1F/f1")
paper.equation("eq18_with_preparation", CHOICE, where="(18), with Ts = Tp + Tc", given=SHARE)
paper.equation(
    "eq19",
    "n_opt = 2/r",
    where="(19)",
    given={"n_opt": "n_sum"},
    when=("r*n_opt > 1",),
    least="K*α*n_opt^2/VE/(r*n_opt - 1)",
)
paper.equation("eq20", "fM = 4*K*α/(VE*r^2)", where="(20)")
paper.equation(
    "eq21", "n_asy = 1/r", where="(21): as f1 grows", given={"r": "1/n_asy + K*α*n_asy*q/VE", "q": "0"}, note="q = 1/f1"
)
paper.equation("eq22", "fM = K*α*n_opt^2/VE", where="(22)")
paper.equation("eq23", "ΔV = 2*VE/n_opt", where="(23)", given={"ΔV": "r*VE"})
ERROR = {"ΔV": "VE/n1F + K*α*n1F/f1"}
paper.wording(
    "after_eq23", "ΔV becomes independent of α", where="after (23)", says="ΔV does not depend on α", given=ERROR
)
paper.wording(
    "after_eq23_retuned",
    "ΔV becomes independent of α",
    where="after (23), f1 being set anew to (22) for each α",
    says="ΔV does not depend on α",
    given={**ERROR, "f1": "K*α*n1F^2/VE"},
)
paper.rule(
    "eq24", "f1 <= f2E/n2E*n1F", where="(24), n2E being its lower limit", iff="f2E*Tc >= n_min", given={"n2E": "n_min"}
)
paper.wording(
    "at_eq24_direction",
    "a smaller Ts makes n2E larger",
    where="at (24)",
    says="n2E falls with Ts",
    given={"n2E": "f2E*(Ts - Tp)"},
    when=("Ts > Tp",),
)
paper.rule(
    "at_eq24_limit", "n2E <= VE/ε", where="at (24): the setting accuracy VE/n2E gives an upper limit of n2E",
    iff="VE/n2E <= ε",
)  # fmt: skip
paper.equation("eq25", "ΔVd = V21 - V20 - ΔV1", where="(25)")

"""Two-counter ATC: the printed numbers and words outside tables 2(A) and 2(B): times, brake test, figure 4, table 1.

The bracket of n1F comes from the brake test of section 6.1, which therefore cannot be held against it; it is held
against the n1F of a crossing in figure 4.  The bracket itself is in `two_counter_derived_figures`.
Words without a number, on structure and safety, are decided by claims or are not derivable.
Source: printed numbers and words [P]; n1F within its bracket [A].

Main results: 0.312 s is the counting time, not the sampling time; at 1 km/h/s the two counters are not the more
accurate by (16), 0.238 against 0.2 %, only by the static error; at the optimum twice the α makes 0.9375 km/h.
"""

from __future__ import annotations

from models.two_counter.numbers import BRAKE_TEST_HZ, BRAKE_TEST_SIGNAL_HZ, BRAKE_TEST_SPEED, DYNAMIC, TABLE_1
from proofs.two_counter_equations import ERROR, paper
from proofs.two_counter_figures import AT_250, DRAWN, N2E, TARGET, TOP, TOTAL
from safety.audit import Known, printed

SYMBOLS = (  # name, unit, what it is, definition
    ("ratio", "Hz", "f2E/n2E of a line in figure 4", ""),
    ("least_ratio", "Hz", "the smallest there", ""),
    ("most_ratio", "Hz", "the greatest there", ""),
    ("settling", "s", "settling time of the reversible counter", "c/(k*f1)"),
    ("c", "1", "the same in time constants", ""),
    ("other_accuracy", "%", "of the reversible counter", ""),
    ("accuracy", "%", "of the two counters, as printed", ""),
    ("parts", "1", "parts of the two counters", ""),
    ("other_parts", "1", "parts of the reversible counter", ""),
    ("least_digital", "%", "error of digital methods, from", ""),
    ("most_digital", "%", "to", ""),
    ("analogue", "%", "error of analogue methods in general", ""),
    ("digital", "%", "error of digital methods in general", ""),
    ("undetected", "1", "single faults of the reversible counter without a brake", ""),
)
for _name, _unit, _about, _by in SYMBOLS:
    paper.symbol(_name, _unit, _about, by=_by)

# --- times -----------------------------------------------------------------------------------------------------------

PERIOD, SAMPLE = "0.312", "Tc + n_p*Tc/n2E"
TO_BRAKE = "(2*n2E + n_p + n_r)*Tc/n2E"  # at a constant speed
paper.figure("times.sampling", PERIOD, "s", where="section 6.2, sampling period", by=SAMPLE, given=AT_250)
paper.figure("times.counting", PERIOD, "s", where="section 6.2, sampling period, read as the counting time", by="Tc")
paper.statement(
    "times.constant",
    "the sampling time at each check speed is constant",
    where="text on the prototype; the slowest and the fastest check speed",
    holds=f"{SAMPLE} = Tc + n_p*Tc/n_below",
    given={"n2E": N2E[5], "n_below": N2E[250]},
)
paper.figure(
    "times.samples_to_brake",
    "2",
    "1",
    where="section 6.2, dynamic test: about two samples from t1 to t4",
    by=f"time/({SAMPLE})",
    given={**AT_250, "time": printed(DYNAMIC[0].time)},
)

# --- brake test, figure 4 --------------------------------------------------------------------------------------------

AT_30 = {"n2E": N2E[BRAKE_TEST_SPEED], "f2": printed(str(BRAKE_TEST_SIGNAL_HZ), exact=True)}
CROSSING = "1/(share - K*α/(ratio*Vmax))"  # (18) for f1 = ratio*n1F
LABEL_K = printed("1.5", exact=True)
OF_FIGURE_4: dict[str, Known | str] = {
    **TOP,
    "n1F": CROSSING,
    "share": TARGET,
    "K": LABEL_K,
    "ratio": printed("3", exact=True),
}
for _name, _sign in (("brake", "<"), ("release", ">=")):
    _hz = str(BRAKE_TEST_HZ[_name])
    paper.statement(
        f"brake_test.{_name}",
        f"{_hz} c/s at 5 c/s, check speed 30: {_name}",
        where="section 6.1; n1F where the curve of 0.25 % crosses the line f2E/n2E = 3 in figure 4",
        holds=f"f1*n2E/f2 {_sign} n1F",
        given={**AT_30, **OF_FIGURE_4, "f1": printed(_hz, exact=True)},
    )
paper.figure(
    "figure4.K", "1.5", "1", where="figure 4, K at 250 km/h, with the preparation", by="3/2 + n_p/n2E", given=AT_250
)
paper.statement(
    "figure4.ratios",
    "lines f2E/n2E = 3, 5, 7, 10",
    where="figure 4, the prototype lies among them",
    holds="least_ratio <= 1/Tc <= most_ratio",
    given={"least_ratio": printed("3", exact=True), "most_ratio": printed("10", exact=True)},
)
paper.figure(
    "after_eq23.doubled",
    "0.625",
    "km/h",
    where='after (23), "ΔV becomes independent of α": at n1F = 800, f1 = 3840 Hz of figure 4, with α = 2 km/h/s',
    by=ERROR["ΔV"],
    given={
        "VE": TOP["Vmax"],
        "n1F": "2/share",
        "f1": "n1F^2*K*(α/2)/VE",  # (22) for half that α
        "share": TARGET,
        "K": LABEL_K,
        "α": printed("2", exact=True),
    },
)

# --- table 1 and the text --------------------------------------------------------------------------------------------

REVERSIBLE, COUNTERS = TABLE_1
compared = paper.under("TC-T1")
ALIKE = {"other_accuracy": printed(REVERSIBLE.accuracy, exact=True)}
compared.figure(
    "table1.two_counters.accuracy",
    COUNTERS.accuracy,
    "%",
    where="table 1, two counters, accuracy, total error by (16)",
    by=TOTAL,
    given=DRAWN,
)
compared.figure(
    "table1.two_counters.accuracy_static", COUNTERS.accuracy, "%", where="table 1, read as the static error alone",
    by="1/n1F",
)  # fmt: skip
compared.figure(
    "table1.two_counters.response", COUNTERS.response, "s", where="table 1, two counters, response: one sample",
    by=SAMPLE, given=AT_250,
)  # fmt: skip
compared.figure(
    "table1.two_counters.response_worst",
    COUNTERS.response,
    "s",
    where="table 1, read as the longest time to the brake at a constant speed",
    by=TO_BRAKE,
    given=AT_250,
)
compared.figure(
    "table1.reversible.accuracy", REVERSIBLE.accuracy, "%", where="table 1, reversible counter: one of nE pulses",
    by="1/nE",
)  # fmt: skip
compared.figure(
    "table1.reversible.response", REVERSIBLE.response, "s", where="table 1, reversible counter: settling", by="settling"
)
BETTER = "at about 1 km/h/s the two counters are the more accurate"
for _name, _how, _holds, _given in (
    ("", "total error by (16)", f"{TOTAL} < other_accuracy", {**DRAWN, **ALIKE}),
    ("_static", "read as the static error alone", "1/n1F < other_accuracy", ALIKE),
    ("_by_table", "the accuracies of table 1 itself", "accuracy < other_accuracy",
     {**ALIKE, "accuracy": printed(COUNTERS.accuracy, exact=True)}),
):  # fmt: skip
    compared.statement(
        f"table1.better{_name}",
        BETTER,
        where=f"text at table 1, {_how}, against the printed one of the reversible counter",
        holds=_holds,
        given=_given,
    )
compared.statement(
    "table1.response_alike",
    "in response both are about equal",
    where="text at table 1, one sample against the settling time",
    holds=f"settling = {SAMPLE}",
    given=AT_250,
)
compared.statement(
    "table1.structure",
    f"structure: {REVERSIBLE.structure}, {COUNTERS.structure}",
    where="table 1, in parts, of which no number is printed",
    holds="parts < other_parts",
)
compared.statement(
    "table1.reversible.safety",
    REVERSIBLE.safety,
    where="table 1, reversible counter, safety: no circuit of it is printed",
    holds="undetected > 0",
)
for _name, _text, _where, _claim in (
    ("two_counters.safety", COUNTERS.safety, "table 1, two counters, safety: counter 1, AND1, gate circuit 1, FF6",
     "circuit.a_count_that_is_not_reached_brakes"),
    ("two_counters.safety_alone", COUNTERS.safety, "table 1, read as safe without multiplicity: a dead generator",
     "defeats.brakes_with_the_generator_open"),
    ("multiplicity", "both need multiplicity for safety",
     "text at table 1, the two counters: a second generator shows the first one dead",
     "watchdog.a_dead_generator_is_found"),
):  # fmt: skip
    compared.decided(f"table1.{_name}", _text, where=_where, claim=f"two_counter_{_claim}")
compared.statement(
    "text.prototype",
    "digital methods: 0.2 to 0.3 %",
    where="text, the prototype is one of them, by (16)",
    holds=f"least_digital <= {TOTAL} <= most_digital",
    given={**DRAWN, "least_digital": printed("0.2", exact=True), "most_digital": printed("0.3", exact=True)},
)
for _name, _printed in {"analogue": ("2", "3"), "digital": ("0.2", "0.3")}.items():
    for _end, _text in zip(("least", "most"), _printed, strict=True):
        compared.figure(f"text.{_name}_{_end}", _text, "%", where=f"text, {_name} methods in general", by=_name)

# --- words that claims about the model decide ------------------------------------------------------------------------

for _name, _text, _claim in (
    ("signal_2_sets", "overspeed: FF6 remains set by signal 2", "literal.never_releases_if_signal_2_sets"),
    ("signal_1_resets", "overspeed: FF2 is reset by signal 1", "literal.never_releases_if_signal_1_resets"),
    ("consistent", "overspeed: FF6 stays reset, signal 1 sets FF2: brake", "decision.no_release_on_overspeed"),
):
    _where = "section 5" + (", read so that all its other sentences hold" if _name == "consistent" else "")
    paper.under("TC-2").decided(f"section5.{_name}", _text, where=_where, claim=f"two_counter_{_claim}")

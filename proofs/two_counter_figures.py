"""Two-counter ATC: every number printed in the paper, recomputed from the other printed ones.

Tables 2(A) and 2(B) row by row, the errors drawn from them, the brake test of section 6.1, figure 4, table 1 and the
text.  The equations stand in `two_counter_equations`.
Source: printed numbers [P]; presets, counting time and the four pulses of preparation [D]; n1F within its bracket [A].

Main results: the decimal point of the oscillator column is lost; 1659.87 is 1659.89, 0.48332 is 0.48322, 0.56422 is
0.51422, so that the headline 0.235 % is 0.2147 %; 0.312 s is the counting time, not the sampling time.
"""

from __future__ import annotations

from models.two_counter.numbers import (
    CHECK_SPEEDS,
    COUNTING_S,
    DYNAMIC,
    DYNAMIC_SHARE,
    STATIC,
    STATIC_SHARE,
    TABLE_1,
    TOTAL_SHARE,
    pulses,
)
from proofs.two_counter_equations import paper
from safety.audit import Figure, derived, printed

SYMBOLS = (  # name, unit, what it is, definition
    ("oscillator", "Hz", "of the test, 8 times as fast as the speed signal", ""),
    ("signal", "Hz", "speed signal at which the brake comes", ""),
    ("threshold", "Hz", "the same by theory", ""),
    ("error", "Hz", "static error", ""),
    ("time", "s", "t4 - t1", ""),
    ("time_elsewhere", "s", "t4 - t1 in another row", ""),
    ("dynamic_elsewhere", "km/h", "dynamic error in that row", ""),
    ("half", "s", "T''c/2, the same in all rows", "time_elsewhere - dynamic_elsewhere/α"),
    ("ramp", "km/h/s", "acceleration of the test", ""),
    ("start", "Hz", "speed signal at t1: the first count is just missed", "n2E/Tc - k'*ramp*Tc/2"),
    ("below", "km/h", "dynamic error by theory in a row beside", ""),
    ("above", "km/h", "the same in another", ""),
    ("n_below", "1", "n2E there", ""),
    ("n_above", "1", "n2E in the other", ""),
    ("static", "%", "static error", ""),
    ("dynamic", "km/h", "dynamic error", ""),
    ("Vmax", "km/h", "maximum check speed", ""),
    ("share", "%", "error allowed, relative to it", ""),
    ("least_ratio", "Hz", "smallest f2E/n2E in figure 4", ""),
    ("most_ratio", "Hz", "greatest f2E/n2E in figure 4", ""),
    ("settling", "s", "settling time of the reversible counter", "c/(k*f1)"),
    ("c", "1", "the same in time constants", ""),
    ("other_accuracy", "%", "of the reversible counter", ""),
    ("least_digital", "%", "error of digital methods, from", ""),
    ("most_digital", "%", "to", ""),
    ("analogue", "%", "error of analogue methods in general", ""),
    ("digital", "%", "error of digital methods in general", ""),
)
for _name, _unit, _about, _by in SYMBOLS:
    paper.symbol(_name, _unit, _about, by=_by)

N2E = {speed: derived(pulses(speed)) for speed in CHECK_SPEEDS}
REFERENCE = {"time_elsewhere": printed(DYNAMIC[2].time), "dynamic_elsewhere": printed(DYNAMIC[2].measured)}
SCALE = {"k'": derived(2 / COUNTING_S)}
SET_RAMP, TEST_RAMP = {"ramp": printed("1", exact=True)}, {"ramp": printed("1")}  # as set; as far as it is printed
TO_READ_OUT = "(sqrt(start^2 + 2*k'*ramp*(2*n2E + 5)) - start)/(k'*ramp)"
ON_THE_LINE = "below + (above - below)*(1/n2E - 1/n_below)/(1/n_above - 1/n_below)"

threshold: dict[int, Figure] = {}
oscillator: dict[int, Figure] = {}
dynamic: dict[int, Figure] = {}

paper.figure("table2a.divider", "8", "1", where="table 2(A), set-up", by="2^3")
for row in STATIC:
    at, name = f"table 2(A), {row.speed} km/h", f"table2a.{row.speed}"
    threshold[row.speed] = paper.figure(
        f"{name}.theory", row.theory, "Hz", where=f"{at}, theory", by="n2E/Tc", given={"n2E": N2E[row.speed]}
    )
    seen = {"threshold": printed(row.theory), "error": printed(row.error), "signal": printed(row.signal)}
    oscillator[row.speed] = paper.figure(
        f"{name}.oscillator",
        f"{int(row.oscillator):,}",
        "Hz",
        where=f"{at}, oscillator",
        by="8*(threshold + error)",
        given=seen,
        also={"the speed signal beside it": "8*signal"},
    )
    signal = paper.figure(
        f"{name}.signal",
        row.signal,
        "Hz",
        where=f"{at}, 1/8 of it",
        by="oscillator/8",
        given={**seen, "oscillator": oscillator[row.speed]},
        also={"the columns beside it": "threshold + error"},
    )
    paper.figure(
        f"{name}.error",
        row.error,
        "Hz",
        where=f"{at}, error",
        by="signal - threshold",
        given={"signal": signal, "threshold": threshold[row.speed]},
    )

for place, shown in enumerate(DYNAMIC):
    at, name, n2e = f"table 2(B), {shown.speed} km/h", f"table2b.{shown.speed}", {"n2E": N2E[shown.speed]}
    other = DYNAMIC[2] if place != 2 else DYNAMIC[0]
    half = {"time_elsewhere": printed(other.time), "dynamic_elsewhere": printed(other.measured)}
    paper.figure(
        f"{name}.time", shown.time, "s", where=f"{at}, t4 - t1", by=TO_READ_OUT, given={**n2e, **SCALE, **TEST_RAMP}
    )
    dynamic[shown.speed] = paper.figure(
        f"{name}.measured",
        shown.measured,
        "km/h",
        where=f"{at}, dynamic error measured",
        by="α*(time - half)",
        given={"time": printed(shown.time), **half, **n2e, **SCALE, **SET_RAMP},
        also={"the exact model": f"α*({TO_READ_OUT} - half)"},
    )
    first = min(max(place - 1, 0), len(DYNAMIC) - 3)
    below, above = (row for row in DYNAMIC[first : first + 3] if row is not shown)
    beside = {"below": printed(below.theory), "above": printed(above.theory)}
    paper.figure(
        f"{name}.theory",
        shown.theory,
        "km/h",
        where=f"{at}, dynamic error by theory",
        by="α*(3*half + 4*Tc/n2E)",
        given={**half, **n2e, **beside, "n_below": N2E[below.speed], "n_above": N2E[above.speed]},
        also={"the line through two other rows": ON_THE_LINE},
    )

# --- the errors drawn from the tables --------------------------------------------------------------------------------

TOP = {"Vmax": printed("250", exact=True)}
AT_250 = {"n2E": N2E[250]}
TOTAL = "1/n1F + α*(3*half + 4*Tc/n2E)/Vmax"  # (16) relative to the maximum check speed
OF_MAXIMUM = "static + dynamic/Vmax"

paper.figure(
    "errors.static_hz",
    "0.15",
    "Hz",
    where="section 6.2, largest static error",
    by="threshold - oscillator/8",
    given={"threshold": threshold[250], "oscillator": oscillator[250]},
)
paper.figure(
    "errors.static_percent", STATIC_SHARE, "%", where="section 6.2, static error", by="error/threshold",
    given={"error": printed("0.15"), "threshold": threshold[250]},
)  # fmt: skip
paper.figure(
    "errors.dynamic", "0.564", "km/h", where="section 6.2, largest dynamic error", by="dynamic",
    given={"dynamic": dynamic[5]},
)  # fmt: skip
paper.figure(
    "errors.dynamic_percent",
    DYNAMIC_SHARE,
    "%",
    where="section 6.2, the same relative to 250 km/h",
    by="dynamic/Vmax",
    given={**TOP, "dynamic": dynamic[5]},
)
paper.figure(
    "errors.total_percent",
    TOTAL_SHARE,
    "%",
    where="section 6.2, total error of all check speeds, relative to 250 km/h",
    by=OF_MAXIMUM,
    given={**TOP, "static": printed(STATIC_SHARE), "dynamic": dynamic[5]},
)
paper.figure(
    "errors.total_percent_at_250",
    TOTAL_SHARE,
    "%",
    where="conclusion, read as the total error at 250 km/h",
    by=OF_MAXIMUM,
    given={**TOP, "static": printed(STATIC_SHARE), "dynamic": dynamic[250]},
)
paper.figure(
    "errors.total_percent_by_eq16",
    TOTAL_SHARE,
    "%",
    where="conclusion, by (16) instead of adding measured errors",
    by=TOTAL,
    given={**TOP, **AT_250, **REFERENCE},
)
paper.figure(
    "errors.allowed", "0.625", "km/h", where="target, 0.25 % of 250 km/h", by="share*Vmax",
    given={**TOP, "share": printed("0.25", exact=True)},
)  # fmt: skip
paper.statement(
    "errors.within_the_allowed",
    "total error within 0.25 %",
    where="conclusion, by (16)",
    holds="Vmax/n1F + α*(3*half + 4*Tc/n2E) <= share*Vmax",
    given={**TOP, **AT_250, **REFERENCE, "share": printed("0.25", exact=True)},
)

# --- times -----------------------------------------------------------------------------------------------------------

PERIOD, SAMPLE = "0.312", "Tc + 4*Tc/n2E"
paper.figure("times.sampling", PERIOD, "s", where="section 6.2, sampling period", by=SAMPLE, given=AT_250)
paper.figure("times.counting", PERIOD, "s", where="section 6.2, sampling period, read as the counting time", by="Tc")
paper.statement(
    "times.constant",
    "the sampling time at each check speed is constant",
    where="text on the prototype; the slowest and the fastest check speed",
    holds=f"{SAMPLE} = Tc + 4*Tc/n_below",
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

AT_30 = {"n2E": N2E[30], "f2": printed("5", exact=True)}
paper.statement(
    "brake_test.brake",
    "120 c/s at 5 c/s, check speed 30: brake",
    where="section 6.1",
    holds="f1*n2E/f2 < n1F",
    given={**AT_30, "f1": printed("120", exact=True)},
)
paper.statement(
    "brake_test.release",
    "150 c/s at 5 c/s, check speed 30: release",
    where="section 6.1",
    holds="f1*n2E/f2 >= n1F",
    given={**AT_30, "f1": printed("150", exact=True)},
)
paper.figure(
    "figure4.K", "1.5", "1", where="figure 4, K at 250 km/h, with the preparation", by="3/2 + 4/n2E", given=AT_250
)
paper.statement(
    "figure4.ratios",
    "lines f2E/n2E = 3, 5, 7, 10",
    where="figure 4, the prototype lies among them",
    holds="least_ratio <= 1/Tc <= most_ratio",
    given={"least_ratio": printed("3", exact=True), "most_ratio": printed("10", exact=True)},
)
for _curve in ("0.25", "0.3", "0.5", "1.0"):
    paper.statement(
        f"figure4.curve_{_curve}",
        f"curve of {_curve} %",
        where="figure 4, the prototype lies on its better side",
        holds="1/n1F + 3/2*α*Tc/Vmax <= share",
        given={**TOP, "share": printed(_curve, exact=True)},
    )

# --- table 1 and the text --------------------------------------------------------------------------------------------

REVERSIBLE, COUNTERS = TABLE_1
compared = paper.under("TC-T1")
compared.figure(
    "table1.two_counters.accuracy",
    COUNTERS.accuracy,
    "%",
    where="table 1, two counters, accuracy, total error by (16)",
    by=TOTAL,
    given={**TOP, **AT_250, **REFERENCE},
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
    by="(2*n2E + 5)*Tc/n2E",
    given=AT_250,
)
compared.figure(
    "table1.reversible.accuracy", REVERSIBLE.accuracy, "%", where="table 1, reversible counter: one of nE pulses",
    by="1/nE",
)  # fmt: skip
compared.figure(
    "table1.reversible.response", REVERSIBLE.response, "s", where="table 1, reversible counter: settling", by="settling"
)
compared.statement(
    "table1.better",
    "at about 1 km/h/s the two counters are the more accurate",
    where="text at table 1, total error by (16) against the reversible counter's",
    holds=f"{TOTAL} < other_accuracy",
    given={**TOP, **AT_250, **REFERENCE, "other_accuracy": printed(REVERSIBLE.accuracy)},
)
compared.statement(
    "text.prototype",
    "digital methods: 0.2 to 0.3 %",
    where="text, the prototype is one of them, by (16)",
    holds=f"least_digital <= {TOTAL} <= most_digital",
    given={
        **TOP,
        **AT_250,
        **REFERENCE,
        "least_digital": printed("0.2", exact=True),
        "most_digital": printed("0.3", exact=True),
    },
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

"""Two-counter ATC: every number of tables 2(A) and 2(B), recomputed from the other printed ones, and the errors drawn.

The equations stand in `two_counter_equations`, the rest of the text in `two_counter_figures_text`, what the
specification derives from the tables in `two_counter_derived_figures`.
A measured t4 - t1 is judged by the column beside it.  The exact model, which has no free parameter, gives none of the
seven to the last digit (`time_exact`): they differ by 0.013 to 0.244 ms.  `time_within` asks for no more than the
0.25 ms of the specification, which is the largest of these differences rounded up.
Source: printed numbers [P]; presets, counting time, pulses of preparation and read-out [D]; n1F within its bracket [A].

Main results: the decimal point of the oscillator column is lost; 1659.87 is 1659.89, 0.48332 is 0.48322, 0.56422 is
0.51422, so that the headline 0.235 % is 0.2147 %.
"""

from __future__ import annotations

from models.two_counter.numbers import (
    CHECK_SPEEDS,
    DYNAMIC,
    DYNAMIC_SHARE,
    PREPARATION_PULSES,
    READ_OUT_PULSES,
    STATIC,
    STATIC_SHARE,
    TOTAL_SHARE,
    pulses,
)
from proofs.two_counter_equations import EQ_14, paper
from safety.audit import Figure, derived, printed

SYMBOLS = (  # name, unit, what it is, definition
    ("oscillator", "Hz", "of the test, 8 times as fast as the speed signal", ""),
    ("signal", "Hz", "speed signal at which the brake comes", ""),
    ("threshold", "Hz", "the same by theory", ""),
    ("error", "Hz", "static error", ""),
    ("time", "s", "t4 - t1", ""),
    ("measured", "km/h", "dynamic error measured", ""),
    ("time_elsewhere", "s", "t4 - t1 in another row", ""),
    ("dynamic_elsewhere", "km/h", "dynamic error measured in that row", ""),
    ("half", "s", "T''c/2, the same in all rows", "time_elsewhere - dynamic_elsewhere/α"),
    ("start", "Hz", "speed signal at t1: the first count is just missed", "n2E/Tc - k'*α*Tc/2"),
    ("below", "km/h", "dynamic error by theory in a row beside", ""),
    ("above", "km/h", "the same in another", ""),
    ("n_below", "1", "n2E there", ""),
    ("n_above", "1", "n2E in the other", ""),
    ("static", "%", "static error", ""),
    ("dynamic", "km/h", "dynamic error", ""),
    ("Vmax", "km/h", "maximum check speed", ""),
    ("share", "%", "error allowed, relative to it", ""),
)
for _name, _unit, _about, _by in SYMBOLS:
    paper.symbol(_name, _unit, _about, by=_by)
paper.symbol("divider", "1", "of the static test: three binary stages", printed("8", exact=True))
paper.symbol("n_p", "1", "speed pulses of the preparation", derived(PREPARATION_PULSES))
paper.symbol("n_r", "1", "speed pulses from the end of a count to the read-out", derived(READ_OUT_PULSES))
paper.symbol("per_kmh", "1/(km/h)", "pulses that n2E grows by", derived(2))
paper.symbol("agreement", "ms", "how near the specification puts exact model and measurement", derived("0.25"))

N2E = {speed: derived(pulses(speed)) for speed in CHECK_SPEEDS}
REFERENCE = {"time_elsewhere": printed(DYNAMIC[2].time), "dynamic_elsewhere": printed(DYNAMIC[2].measured)}
SCALE = {"k'": "per_kmh/Tc"}
TO_READ_OUT = "(sqrt(start^2 + 2*k'*α*(2*n2E + n_p + n_r)) - start)/(k'*α)"
TABLED = "α*(3*half + n_p*Tc/n2E)"  # (13) to the first order, T''s being T''c + Tp
ON_THE_LINE = "below + (above - below)*(1/n2E - 1/n_below)/(1/n_above - 1/n_below)"
BY_EQ_14 = {  # the speed scale passing through the origin, T''c being Tc
    **SCALE, "V'E": "n2E/(k'*Tc)", "T''c": "Tc", "ΔV1": "α*Tc/2", "T's": "Tc + n_p*Tc/n2E",
}  # fmt: skip

threshold: dict[int, Figure] = {}
oscillator: dict[int, Figure] = {}
dynamic: dict[int, Figure] = {}

# --- table 2(A) ------------------------------------------------------------------------------------------------------

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
        by="divider*(threshold + error)",
        given=seen,
        also={"the speed signal beside it": "divider*signal"},
    )
    signal = paper.figure(
        f"{name}.signal",
        row.signal,
        "Hz",
        where=f"{at}, 1/8 of it",
        by="oscillator/divider",
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

# --- table 2(B) ------------------------------------------------------------------------------------------------------

for place, shown in enumerate(DYNAMIC):
    at, name, n2e = f"table 2(B), {shown.speed} km/h", f"table2b.{shown.speed}", {"n2E": N2E[shown.speed]}
    other = DYNAMIC[2] if place != 2 else DYNAMIC[0]
    half = {"time_elsewhere": printed(other.time), "dynamic_elsewhere": printed(other.measured)}
    dynamic[shown.speed] = paper.figure(
        f"{name}.measured",
        shown.measured,
        "km/h",
        where=f"{at}, dynamic error measured",
        by="α*(time - half)",
        given={"time": printed(shown.time), **half, **n2e, **SCALE},
        also={"the exact model": f"α*({TO_READ_OUT} - half)"},
    )
    paper.figure(
        f"{name}.time",
        shown.time,
        "s",
        where=f"{at}, t4 - t1, from the column beside it",
        by="measured/α + half",
        given={"measured": dynamic[shown.speed], **half, **n2e, **SCALE},
        also={"the exact model": TO_READ_OUT},
    )
    paper.statement(
        f"{name}.time_within",
        f"{shown.time} s",
        where=f"{at}, t4 - t1, within 0.25 ms of the exact model",
        holds=f"time - agreement <= {TO_READ_OUT} <= time + agreement",
        given={**n2e, **SCALE, "time": printed(shown.time, exact=True)},
    )
    paper.figure(
        f"{name}.time_exact",
        shown.time,
        "s",
        where=f"{at}, t4 - t1, against the exact model to the last digit",
        by=TO_READ_OUT,
        given={**n2e, **SCALE},
    )
    first = min(max(place - 1, 0), len(DYNAMIC) - 3)
    below, above = (row for row in DYNAMIC[first : first + 3] if row is not shown)
    beside = {"below": printed(below.theory), "above": printed(above.theory)}
    paper.figure(
        f"{name}.theory",
        shown.theory,
        "km/h",
        where=f"{at}, dynamic error by theory",
        by=TABLED,
        given={**half, **n2e, **beside, "n_below": N2E[below.speed], "n_above": N2E[above.speed]},
        also={"the line through two other rows": ON_THE_LINE},
    )
for shown in (DYNAMIC[0], DYNAMIC[-1]):
    paper.figure(
        f"table2b.{shown.speed}.theory_by_eq14",
        shown.theory,
        "km/h",
        where=f"table 2(B), {shown.speed} km/h, dynamic error by theory, against (14) itself",
        by=EQ_14,
        given={"n2E": N2E[shown.speed], **BY_EQ_14},
    )

AT_250 = {"n2E": N2E[250]}
paper.statement(
    "table2b.counting_time",
    "T''c",
    where="table 2(B), time less error, twice: the counting time of table 2(A)",
    holds="2*half = Tc",
    given=REFERENCE,
)

# --- the errors drawn from the tables --------------------------------------------------------------------------------

TOP = {"Vmax": printed("250", exact=True)}
DRAWN = {**TOP, **AT_250, **REFERENCE}
TOTAL = f"1/n1F + {TABLED}/Vmax"  # (16) relative to the maximum check speed
OF_MAXIMUM = "static + dynamic/Vmax"
TARGET = printed("0.25", exact=True)

paper.figure(
    "errors.static_hz",
    "0.15",
    "Hz",
    where="section 6.2, largest static error",
    by="threshold - oscillator/divider",
    given={"threshold": threshold[250], "oscillator": oscillator[250]},
)
paper.figure(
    "errors.static_percent", STATIC_SHARE, "%", where="section 6.2, static error", by="error/threshold",
    given={"error": printed("0.15"), "threshold": threshold[250]},
)  # fmt: skip
paper.figure(
    "errors.static_percent_of_own_row",
    STATIC_SHARE,
    "%",
    where="section 6.2, read as the largest relative to its own row, 70 km/h",
    by="(threshold - oscillator/divider)/threshold",
    given={"threshold": threshold[70], "oscillator": oscillator[70]},
)
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
    given=DRAWN,
)
paper.figure(
    "errors.allowed", "0.625", "km/h", where="target, 0.25 % of 250 km/h", by="share*Vmax",
    given={**TOP, "share": TARGET},
)  # fmt: skip
paper.statement(
    "errors.within_the_allowed",
    "total error within 0.25 %",
    where="conclusion, by (16)",
    holds=f"Vmax/n1F + {TABLED} <= share*Vmax",
    given={**DRAWN, "share": TARGET},
)

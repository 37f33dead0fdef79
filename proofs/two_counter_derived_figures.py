"""Two-counter ATC: the figures that the specification derives from the printed ones, recomputed.

None of them stands in the paper.  Figure 4 is lost but for its labels: the optimum and the crossings of each curve
follow from (18), and the crossing of 0.25 % with the line of 3 is where the reference n1F = 2000 comes from.
Source: tables 2(A), 2(B), brake test of section 6.1, labels of figure 4 [P]; the rest [D]; n1F = 2000, 2048 [A].

Main results: all of them hold; the total errors and the sure excess at one n1F rest on that n1F [A].
"""

from __future__ import annotations

from fractions import Fraction
from itertools import permutations

from models.two_counter.numbers import (
    BRAKE_TEST_HZ,
    CHECK_SPEEDS,
    DYNAMIC,
    N1F_RANGE,
    STATIC,
    half_unit,
    pulses,
)
from proofs.two_counter_equations import COUNTING_RANGE, EQ_14, paper
from proofs.two_counter_figures import (
    AT_250,
    BY_EQ_14,
    DRAWN,
    N2E,
    OF_MAXIMUM,
    REFERENCE,
    SCALE,
    TARGET,
    TOP,
    TOTAL,
    dynamic,
    oscillator,
)
from proofs.two_counter_figures_text import AT_30, CROSSING, LABEL_K, SAMPLE, TO_BRAKE
from safety.audit import Known, Paper, assumed, derived, printed

TITLE = "Two-counter ATC, figures derived from the paper (specification)"
figures = Paper("two_counter_derived", TITLE, published=False).under("TC-A")
figures.symbols = paper.symbols

SUSPECT = 30  # its theory value is the misprint of table 2(B)
SOUND = [row for row in DYNAMIC if row.speed != SUSPECT]
for _speed in CHECK_SPEEDS:
    paper.symbol(f"osc_{_speed}", "Hz", f"oscillator of the static test at {_speed} km/h")
    paper.symbol(f"n_{_speed}", "1", f"n2E at {_speed} km/h")
    paper.symbol(f"f_{_speed}", "Hz", f"f2E at {_speed} km/h")
    paper.symbol(f"d_{_speed}", "km/h", f"dynamic error by theory at {_speed} km/h")
MEAN = " + ".join(f"1/f_{row.speed}" for row in SOUND)
SQUARES = " + ".join(f"(1/f_{row.speed} - mean)^2" for row in SOUND)
for _name, _unit, _about, _by in (
    ("half_unit", "Hz", "of the last digit of a frequency", ""),
    ("speed_below", "km/h", "a check speed", ""),
    ("speed_above", "km/h", "a higher one", ""),
    ("mean", "s", "mean of 1/f2E, six rows", f"({MEAN})/{len(SOUND)}"),
    ("squares", "s^2", "squares of the differences from it, summed", SQUARES),
    ("measured_Tc", "s", "mean counting time by the static test",
     f"divider*({' + '.join(f'n_{v}/osc_{v}' for v in CHECK_SPEEDS)})/{len(CHECK_SPEEDS)}"),
):  # fmt: skip
    paper.symbol(_name, _unit, _about, by=_by)

# --- table 2(A) ------------------------------------------------------------------------------------------------------

HALF_UNIT = half_unit(STATIC[0].theory)
LEAST = max(STATIC, key=lambda row: pulses(row.speed) / (Fraction(row.theory) + HALF_UNIT))
MOST = min(STATIC, key=lambda row: pulses(row.speed) / (Fraction(row.theory) - HALF_UNIT))
for _name, _row, _sign, _value in (("least", LEAST, "+", COUNTING_RANGE[0]), ("most", MOST, "-", COUNTING_RANGE[1])):
    figures.figure(
        f"Tc_{_name}",
        _value,
        "s",
        where=f"table 2(A), {_name} Tc that all rows leave, set by {_row.speed} km/h",
        by=f"n2E/(threshold {_sign} half_unit)",
        given={
            "n2E": N2E[_row.speed],
            "threshold": printed(_row.theory, exact=True),
            "half_unit": derived(HALF_UNIT),
        },
    )


def gained(pair: tuple[int, int]) -> tuple[Fraction, int]:
    """Pulses and km/h between two check speeds."""
    return pulses(pair[0]) - pulses(pair[1]), pair[0] - pair[1]


PAIRS = [pair for pair in permutations(CHECK_SPEEDS, 2) if pair[0] > pair[1]]
FLATTEST = max(PAIRS, key=lambda pair: (gained(pair)[0] - 1) / gained(pair)[1])
STEEPEST = min(PAIRS, key=lambda pair: (gained(pair)[0] + 1) / gained(pair)[1])
for _name, (_above, _below), _sign, _value in (
    ("least", FLATTEST, "-", "1.99355"),
    ("most", STEEPEST, "+", "2.00000"),
):
    figures.figure(
        f"slope_{_name}",
        _value,
        "1/(km/h)",
        where=f"table 2(A), n2E = floor(s V + c) + 1/2 in all rows: s {_name}, set by {_above} and {_below} km/h",
        by=f"(n_above - n_below {_sign} 1)/(speed_above - speed_below)",
        given={
            "n_above": N2E[_above],
            "n_below": N2E[_below],
            "speed_above": printed(str(_above), exact=True),
            "speed_below": printed(str(_below), exact=True),
        },
    )

READ = {f"osc_{v}": oscillator[v] for v in CHECK_SPEEDS} | {f"n_{v}": N2E[v] for v in CHECK_SPEEDS}
figures.figure(
    "measured_Tc", "0.311771", "s", where="table 2(A), mean of seven rows", by="measured_Tc", given=READ
)  # fmt: skip
figures.figure(
    "crystal",
    "-102",
    "ppm",
    where="table 2(A), the one error of the crystal that explains the static errors: calibration, not quantisation",
    by="Tc/measured_Tc - 1",
    given=READ,
)

# --- table 2(B) ------------------------------------------------------------------------------------------------------

LEVER = " + ".join(f"(1/f_{row.speed} - mean)*d_{row.speed}" for row in SOUND)
figures.figure(
    "preparation",
    "4.0003",
    "1",
    where="table 2(B), theory, without 30 km/h: pulses by the least squares of α*(3/2*T''c + pulses/f2E)",
    by=f"({LEVER})/(α*squares)",
    given={f"d_{row.speed}": printed(row.theory, exact=True) for row in SOUND}
    | {f"f_{row.speed}": printed(row.theory, exact=True) for row in STATIC if row.speed != SUSPECT},
)
figures.figure(
    "counting_time", "0.31156", "s", where="table 2(B), time less error, twice: T''c of all rows", by="2*half",
    given=REFERENCE,
)  # fmt: skip
for _speed, _value in ((250, "0.31155"), (5, "0.30837")):
    figures.figure(
        f"counting_time_{_speed}",
        _value,
        "s",
        where=f"T''c as the paper defines it, {_speed} km/h, the static error neglected",
        by="n2E/(n2E/Tc + k'*α*Tc/2)",
        given={"n2E": N2E[_speed], **SCALE},
    )
figures.figure(
    "half_a_counting_time", "0.15578", "s", where="half of that at 250 km/h: where 0.31156 comes from",
    by="n2E/(n2E/Tc + k'*α*Tc/2)/2", given={**AT_250, **SCALE},
)  # fmt: skip
for _speed, _value in zip(
    CHECK_SPEEDS, ("0.46964", "0.47001", "0.47071", "0.47200", "0.47421", "0.48086", "0.50332"), strict=True
):
    figures.figure(
        f"eq14_{_speed}", _value, "km/h", where=f"(14) itself, {_speed} km/h", by=EQ_14,
        given={"n2E": N2E[_speed], **BY_EQ_14},
    )  # fmt: skip
for _speed, _value in zip(
    CHECK_SPEEDS, ("0.31415", "0.31459", "0.31542", "0.31697", "0.31961", "0.32762", "0.35549"), strict=True
):
    figures.figure(
        f"Ts_{_speed}", _value, "s", where=f"sampling time, {_speed} km/h", by=SAMPLE, given={"n2E": N2E[_speed]}
    )
for _speed, _value in ((250, "0.62649"), (5, "0.67817")):
    figures.figure(
        f"response_{_speed}", _value, "s", where=f"longest time to the brake at a constant speed, {_speed} km/h",
        by=TO_BRAKE, given={"n2E": N2E[_speed]},
    )  # fmt: skip

# --- total error -----------------------------------------------------------------------------------------------------

figures.figure(
    "total_corrected",
    "0.2147",
    "%",
    where="total of all check speeds, 0.51422 in place of 0.56422",
    by=OF_MAXIMUM,
    given={**TOP, "static": "error/threshold", "error": printed("0.15"), "threshold": printed(STATIC[0].theory),
           "dynamic": dynamic[5]},
)  # fmt: skip
figures.figure(
    "total_of_250",
    "0.1972",
    "%",
    where="total of 250 km/h alone",
    by=OF_MAXIMUM,
    given={**TOP, "static": "error/threshold", "error": printed("0.15"), "threshold": printed(STATIC[0].theory),
           "dynamic": dynamic[250]},
)  # fmt: skip
for _name, _n1f, _value in (
    ("most_n1F", derived(N1F_RANGE[1]), "0.2304"),
    ("n1F_2048", assumed(2048, *N1F_RANGE), "0.2367"),
    ("n1F_2000", assumed(2000, *N1F_RANGE), "0.2379"),
    ("least_n1F", derived(N1F_RANGE[0]), "0.2410"),
):
    figures.figure(
        f"total_with_{_name}", _value, "%", where=f"total by (16), n1F = {_n1f.value.middle}", by=TOTAL,
        given={**DRAWN, "n1F": _n1f},
    )  # fmt: skip
for _speed, _value in ((250, "0.12944"), (5, "0.00713")):
    figures.figure(
        f"sure_{_speed}",
        _value,
        "km/h",
        where=f"excess from which every phase brakes, {_speed} km/h on the scale through the origin",
        by="n2E/Tc/(k'*(n1F - 1))",
        given={"n2E": N2E[_speed], **SCALE},
    )
figures.statement(
    "n1F_of_the_target",
    "n1F >= 1611",
    where="counts that keep 0.625 km/h with 0.46975 km/h of dynamic error",
    holds="n_below < Vmax/(share*Vmax - dynamic) <= n_above",
    given={
        **TOP,
        "share": TARGET,
        "dynamic": printed(DYNAMIC[0].theory),
        "n_below": derived(1610),
        "n_above": derived(1611),
    },
)

# --- brake test, figure 4 --------------------------------------------------------------------------------------------

for _name, _value in (("brake", "1884"), ("release", "2355")):
    figures.figure(
        f"bracket_{_name}",
        _value,
        "1",
        where=f"section 6.1: n1F is {'more than' if _name == 'brake' else 'at most'} the count at which it {_name}s",
        by="f1*n2E/f2",
        given={**AT_30, "f1": printed(str(BRAKE_TEST_HZ[_name]), exact=True)},
    )
for _curve, _count, _hz, _crossings in (
    ("0.25", "800", "3840", ("2000", "769.23", "608.70", "526.32")),
    ("0.3", "666.67", "2666.67", ("1000", "555.56", "466.67", "416.67")),
    ("0.5", "400", "960", ("333.33", "263.16", "241.38", "227.27")),
    ("1.0", "200", "240", ("125", "113.64", "109.37", "106.38")),
):
    _share: dict[str, Known | str] = {"share": printed(_curve, exact=True), "r": "share"}
    figures.figure(
        f"figure4.{_curve}.count", _count, "1", where=f"figure 4, {_curve} %: n1F of the least f1", by="n_opt",
        given=_share,
    )  # fmt: skip
    figures.figure(
        f"figure4.{_curve}.least", _hz, "Hz", where=f"figure 4, {_curve} %: the least f1", by="fM",
        given={**_share, "K": LABEL_K, "VE": TOP["Vmax"]},
    )  # fmt: skip
    for _ratio, _value in zip(("3", "5", "7", "10"), _crossings, strict=True):
        figures.figure(
            f"figure4.{_curve}.at_{_ratio}",
            _value,
            "1",
            where=f"figure 4, {_curve} %: n1F on the line f2E/n2E = {_ratio}",
            by=CROSSING,
            given={**TOP, **_share, "K": LABEL_K, "ratio": printed(_ratio, exact=True)},
        )
figures.figure(
    "figure4.prototype",
    "1588.4",
    "1",
    where="figure 4, 0.25 %: n1F on the line of the prototype, 1/Tc, the preparation neglected",
    by=CROSSING,
    given={**TOP, "share": TARGET, "K": LABEL_K, "ratio": "1/Tc"},
)

"""The failure-mode table: columns against a second calculation, bounds, totals, and rates from a table."""

from __future__ import annotations

import csv
import itertools
import math
import random
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from safety.inject.classes import CELLS, Tally
from safety.inject.effects import with_rates
from safety.inject.figures import BEHIND, FIGURES, RATES
from safety.inject.fmeda import COLUMNS, Row, records, totals, write_csv
from safety.inject.space import CampaignError, Group
from safety.inject.statistics import clustered, clustered_ratio, hypergeometric_limits

Make = Callable[..., Any]


def group(name: str = "g", part: str = "", mode: str = "", rate: str | None = "1e-7") -> Group:
    return Group(name, [], part, mode, rate, "[A] invented" if rate else "")


def row(counts: dict[str, int], of: int | None = -1, rate: str | None = "1e-7", **more: Any) -> Row:
    tally = Tally(counts)
    return Row(group(rate=rate), tally.injections if of == -1 else of, tally, **more)


# --- a second calculation, from the definitions of IEC 61508-4 and nothing of ours ------------------------------------


def by_the_standard(outcomes: list[tuple[str, bool]], rate: Fraction) -> dict[str, Fraction | None]:
    """Each fault by itself, with an equal part of the rate: (what it does to the output, whether it is detected)."""
    each = rate / len(outcomes)
    sums = {"s": Fraction(0), "dd": Fraction(0), "du": Fraction(0), "no": Fraction(0)}
    for effect, detected in outcomes:
        if effect == "wrong":  # 3.6.7: may bring the equipment into a hazardous state
            kind = "dd" if detected else "du"
        elif effect == "safe" or detected:  # 3.6.8: brings, or by its detection leads to, the safe state
            kind = "s"
        else:  # 3.6.14: has no effect on the function
            kind = "no"
        sums[kind] += each
    dangerous = sums["dd"] + sums["du"]
    failures = sums["s"] + dangerous
    return {
        "lambda_s": sums["s"],
        "lambda_dd": sums["dd"],
        "lambda_du": sums["du"],
        "lambda_no_effect": sums["no"],
        "diagnostic_coverage": sums["dd"] / dangerous if dangerous else None,  # 3.8.6
        "safe_failure_fraction": (sums["s"] + sums["dd"]) / failures if dangerous or sums["s"] else None,  # 3.6.15
    }


def draw(pick: random.Random, number: int) -> list[tuple[str, bool]]:
    kinds = pick.sample(["wrong", "safe", "neutral"], pick.randint(1, 3))
    return [(pick.choice(kinds), pick.random() < 0.6) for _ in range(number)]


def tallied(outcomes: list[tuple[str, bool]]) -> Tally:
    return Tally.of([f"{effect}/{'yes' if detected else 'no'}" for effect, detected in outcomes])


@pytest.mark.parametrize("seed", range(40))
def test_every_column_agrees_with_a_second_calculation(seed: int, tmp_path: Path) -> None:
    pick = random.Random(seed)
    modes = [draw(pick, pick.randint(1, 60)) for _ in range(pick.randint(1, 6))]
    rates = [Fraction(pick.randint(1, 10**6), 10**13) for _ in modes]
    rows = [
        Row(Group(f"m{i}", [], f"part {i % 2}", f"mode {i}", rate, "[A] drawn"), len(mode), tallied(mode))
        for i, (mode, rate) in enumerate(zip(modes, rates, strict=True))
    ]
    expected = [by_the_standard(mode, rate) for mode, rate in zip(modes, rates, strict=True)]
    for found, values in zip(rows, expected, strict=True):
        for name, value in values.items():
            figure = found.figure(name)
            assert (figure and (figure.value, figure.low, figure.high)) == (None if value is None else (value,) * 3)
        assert sum(found.figure(name).value for name in RATES) == found.rate
    write_csv(rows, tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(encoding="utf-8", newline="") as file:
        for line, mode, values in zip(csv.DictReader(file), modes, expected, strict=True):
            for name, value in values.items():
                for column in (name, f"{name}_low", f"{name}_high"):
                    assert (
                        line[column] == ""
                        if value is None
                        else abs(float(line[column]) / float(value or 1) - (value != 0)) < 1e-12
                    )
            for name, number in by_class(mode).items():
                assert int(line[name]) == number
    for total in totals(rows):
        members = [i for i, r in enumerate(rows) if r in total.rows]
        sums = {name: sum((expected[i][name] for i in members), Fraction(0)) for name in RATES}
        dangerous = sums["lambda_dd"] + sums["lambda_du"]
        for name, value in sums.items():
            assert total.figure(name).value == value
        assert total.rate == sum((rates[i] for i in members), Fraction(0))
        coverage = total.figure("diagnostic_coverage")
        assert (coverage and coverage.value) == (sums["lambda_dd"] / dangerous if dangerous else None)
        fraction = total.figure("safe_failure_fraction")
        whole = dangerous + sums["lambda_s"]
        assert (fraction and fraction.value) == ((sums["lambda_s"] + sums["lambda_dd"]) / whole if whole else None)


def by_class(outcomes: list[tuple[str, bool]]) -> dict[str, int]:
    return {
        "faults": len(outcomes),
        "detected": sum(found for _, found in outcomes),
        "dangerous_undetected": sum(effect == "wrong" and not found for effect, found in outcomes),
        "safe": sum(effect == "safe" and not found for effect, found in outcomes),
        "no_effect": sum(effect == "neutral" and not found for effect, found in outcomes),
        "dangerous_detected": sum(effect == "wrong" and found for effect, found in outcomes),
    }


# --- bounds -----------------------------------------------------------------------------------------------------------


def test_a_sample_has_bounds_around_every_figure() -> None:
    found = row({"wrong/yes": 40, "wrong/no": 2, "safe/no": 8}, of=500)
    low, high = hypergeometric_limits(2, 50, 500)
    figure = found.figure("lambda_du")
    assert figure is not None
    assert (figure.value, figure.low, figure.high) == tuple(
        Fraction("1e-7") * share for share in (Fraction(2, 50), Fraction(low, 500), Fraction(high, 500))
    )
    for name in FIGURES:
        figure = found.figure(name)
        assert figure is not None and figure.low <= figure.value <= figure.high and figure.low < figure.high


def test_the_bounds_hold_the_truth_as_often_as_stated() -> None:
    """All samples of 4 of a mode with 9 faults: the exact probability that a figure's bounds hold its true value."""
    space = ["wrong/yes"] * 4 + ["wrong/no"] * 2 + ["safe/yes", "neutral/yes", "neutral/no"]
    truth = Row(group(), 9, Tally.of(space))
    held = dict.fromkeys(FIGURES, 0)
    for sample in itertools.combinations(space, 4):
        found = Row(group(), 9, Tally.of(sample), confidence=0.8)
        for name in FIGURES:
            figure, true = found.figure(name), truth.figure(name)
            held[name] += figure is None or figure.low <= true.value <= figure.high
    assert min(held.values()) >= 0.8 * math.comb(9, 4)


def test_a_campaign_cut_short_leaves_open_what_it_has_not_tried() -> None:
    found = row({"wrong/yes": 3, "wrong/no": 1}, of=10, at_random=False)
    figures = [found.figure(name) for name in ("lambda_dd", "diagnostic_coverage")]
    assert [(f.low, f.high) for f in figures] == [
        (Fraction("0.3e-7"), Fraction("0.9e-7")),
        (Fraction(3, 10), Fraction(9, 10)),
    ]
    assert totals([found, found])[-1].figure("lambda_du") is None


def test_injections_without_end_have_bounds_of_independent_trials() -> None:
    known, endless = (row({"wrong/yes": 30, "wrong/no": 1}, of=of).figure("lambda_du") for of in (40, None))
    assert known is not None and endless is not None
    assert endless.low < known.low < known.value == endless.value < known.high < endless.high
    unknown = row({"wrong/yes": 30}, of=None, at_random=False).figure("diagnostic_coverage")
    assert unknown is not None and (unknown.low, unknown.high) == (0, 1)


def test_under_drawn_scenarios_it_is_the_scenarios_that_count() -> None:
    each = (
        Tally({"wrong/yes": 90, "wrong/no": 10}),
        Tally({"wrong/yes": 100}),
        Tally({"wrong/yes": 80, "safe/no": 20}),
    )
    whole = Tally({"wrong/yes": 270, "wrong/no": 10, "safe/no": 20})
    found = Row(group(), 300, whole, scenarios=each)
    assert not found.exhaustive
    rate = found.figure("lambda_du")
    assert rate is not None and rate.value == Fraction("1e-7") / 30
    low, high = clustered([Fraction(1, 10), Fraction(0), Fraction(0)])
    assert (rate.low, rate.high) == (Fraction("1e-7") * Fraction(low), Fraction("1e-7") * Fraction(high))
    assert rate.high > 20 * row(dict(whole.cells), of=10**6).figure("lambda_du").value  # three trials say little
    two = totals([found, Row(group("h", rate="3e-7"), 300, whole, scenarios=each)])[-1]
    both = two.figure("lambda_du")
    assert both is not None and both.value == Fraction("4e-7") / 30
    assert both.high == Fraction("4e-7") * Fraction(high)  # the modes share the scenarios, so nothing is gained
    coverage = two.figure("diagnostic_coverage")
    good = [Fraction(9, 10), Fraction(1), Fraction(8, 10)]
    assert coverage is not None and coverage.value == Fraction(27, 28)
    assert (coverage.low, coverage.high) == clustered_ratio(good, [Fraction(1, 10), Fraction(0), Fraction(0)])


def test_a_mode_not_tried_leaves_the_total_open() -> None:
    tried, untried = row({"wrong/yes": 3}), row({}, of=5)
    assert untried.figure("lambda_s") is None and untried.figure("diagnostic_coverage") is None
    assert totals([tried, untried])[-1].figure("lambda_dd") is None


def test_rows_of_different_confidence_have_totals_that_hold_for_the_higher() -> None:
    counts = {"wrong/yes": 30, "wrong/no": 3}
    totalled = [
        totals([row(counts, of=9999, confidence=one), row(counts, of=9999, confidence=0.99)])[-1] for one in (0.8, 0.99)
    ]
    for name in FIGURES:
        assert totalled[0].figure(name) == totalled[1].figure(name)


def test_a_scenario_in_which_a_mode_was_not_tried_says_nothing_of_the_sum() -> None:
    some, none = Tally({"wrong/yes": 9, "wrong/no": 1}), Tally({})
    first = Row(group("g"), 30, Tally({"wrong/yes": 27, "wrong/no": 3}), scenarios=(some, some, some))
    other = Row(group("h"), 30, Tally({"wrong/yes": 18, "wrong/no": 2}), scenarios=(some, none, some))
    rate = totals([first, other])[-1].figure("lambda_du")
    low, high = clustered([Fraction(1, 10)] * 2)
    assert rate is not None
    assert (rate.low, rate.high) == (Fraction("2e-7") * Fraction(low), Fraction("2e-7") * Fraction(high))
    never = Row(group("h"), 30, Tally({"safe/no": 1}), scenarios=(none, none, none))
    assert totals([first, never])[-1].figure("lambda_du") is None


def test_without_rates_there_are_fractions_only() -> None:
    found = row({"wrong/yes": 3, "wrong/no": 1}, rate=None)
    assert found.figure("lambda_dd") is None
    assert found.figure("diagnostic_coverage").value == Fraction(3, 4)
    assert totals([found])[0].rate is None


def test_the_bounds_of_a_total_are_narrower_than_the_sum_of_those_of_its_rows() -> None:
    rows = [
        Row(group(f"m{i}", "part", f"mode {i}"), 10_000, Tally({"wrong/yes": 500, "wrong/no": 1})) for i in range(5)
    ]
    whole = totals(rows)[0].figure("lambda_du")
    assert whole is not None and whole.value == pytest.approx(5e-7 / 501)
    assert whole.high < sum(r.figure("lambda_du").high for r in rows)


def test_every_column_of_numbers_says_which_injections_it_is_made_of() -> None:
    told = {c for c in COLUMNS if c not in ("part", "mode", "rate_per_h", "exhaustive", "tag", "source")}
    assert {c.removesuffix("_low").removesuffix("_high") for c in told} == set(BEHIND)
    assert all(set(cells) <= set(CELLS) for cells in BEHIND.values())


def test_the_records_have_the_columns() -> None:
    assert [tuple(record) for record in records([row({"safe/no": 1})])] == [COLUMNS]


# --- rates from a table -----------------------------------------------------------------------------------------------


GROUPS = [
    Group("stage", [], "ring", "stuck"),
    Group("carry", [], "ring", "open"),
    Group("relay", [], "relay", "welded"),
]


def table(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "effects.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_rates_are_read_from_a_table(tmp_path: Path) -> None:
    path = table(
        tmp_path,
        "Part,mode,rate_per_h,source,remark\n"
        "ring,open,2e-9,[A] guess,\nring,stuck,6.4e-8,[P] list,x\nrelay,,0.5e-9,[D] sum,\n",
    )
    found = with_rates(GROUPS, path)
    assert [(g.name, g.rate_per_h, g.source) for g in found] == [
        ("stage", Fraction("6.4e-8"), "[P] list"),
        ("carry", Fraction("2e-9"), "[A] guess"),
        ("relay", Fraction("5e-10"), "[D] sum"),
    ]


def test_rates_of_parts_are_divided_by_mode(tmp_path: Path) -> None:
    path = table(
        tmp_path,
        "part,mode,fit,share,source\nring,open,120,15 %,[A] a\nring,stuck,120,0.85,[A] b\nrelay,welded,7,,[A] c\n",
    )
    assert [g.rate_per_h for g in with_rates(GROUPS, path)] == [Fraction("102e-9"), Fraction("18e-9"), Fraction("7e-9")]


HEAD, REST = "part,mode,rate_per_h,source\n", "ring,open,1e-9,[A]\nrelay,welded,1e-9,[A]\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD + REST + "ring,stuk,1e-9,[A]\n", r"effects.csv:4: no group has 'ring: stuk'; did you mean ring: stuck"),
        (HEAD + REST + "ring,stuck,fast,[A]\n", r"effects.csv:4: rate_per_h is 'fast'; write a number above 0"),
        (HEAD + REST + "ring,stuck,0,[A]\n", r"effects.csv:4: rate_per_h is '0'"),
        (HEAD + REST + "ring,stuck,-1e-9,[A]\n", r"rate_per_h is '-1e-9'"),
        (
            HEAD + REST + 'ring,stuck,"1,5e-9",[A]\n',
            r"rate_per_h is '1,5e-9'; write a number above 0 with a decimal point",
        ),
        (HEAD + REST + "ring,stuck,1e-9,list\n", r"effects.csv:4: source 'list'; start it with \[P\]"),
        (HEAD + REST + "ring,stuck,1e-9\n", r"effects.csv:4: the line has more or fewer fields"),
        (HEAD + REST + "ring,stuck,1e-9,[A],a,b\n", r"effects.csv:4: the line has more or fewer fields"),
        (HEAD + REST, r"effects.csv: no line for 'ring: stuck' \(group 'stage'\); add one"),
        (HEAD + REST + "ring,open,1e-9,[A]\n", r"effects.csv:4: 'ring: open' stands in .*effects.csv:2 already"),
        (HEAD + REST + "ring,,1e-9,[A]\n", r"effects.csv:4: no group has 'ring: '"),
        ("part,mode,source\n", r"effects.csv:1: the columns are part, mode, source; there have to be"),
        ("part,mode,rate_per_h,fit,source\n", r"either rate_per_h or fit"),
        (HEAD, r"effects.csv: there is no line after the heading"),
        ("", r"effects.csv:1: the columns are none"),
        (
            "part,mode,fit,share,source\nring,open,9,0.2,[A]\nring,stuck,9,0.7,[A]\nrelay,,9,,[A]\n",
            r"the shares of part 'ring' sum to 0.9; they have to sum to 1",
        ),
        (
            "part,mode,fit,share,source\nring,open,9,1,[A]\nring,stuck,9,,[A]\nrelay,,9,,[A]\n",
            r"the shares of part 'ring' sum to 1, and one is missing",
        ),
    ],
)
def test_a_table_that_cannot_be_meant_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(CampaignError, match=message):
        with_rates(GROUPS, table(tmp_path, text))


def test_a_table_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(CampaignError, match=r"missing.csv: cannot be read as CSV"):
        with_rates(GROUPS, tmp_path / "missing.csv")
    (tmp_path / "binary.csv").write_bytes(b"\xff\xfe\x00p")
    with pytest.raises(CampaignError, match=r"binary.csv: cannot be read as CSV"):
        with_rates(GROUPS, tmp_path / "binary.csv")

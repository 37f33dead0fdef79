"""The audit of the two-counter paper would notice if the paper said anything else, and never fails to answer."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator
from fractions import Fraction

import pytest

from proofs import two_counter_derived_figures, two_counter_figures_text
from proofs.two_counter_equations import ERROR, paper
from proofs.two_counter_figures import AT_250, DRAWN, N2E, SCALE, TABLED, TO_READ_OUT, TOTAL
from proofs.two_counter_figures_text import AT_30, OF_FIGURE_4
from safety.audit import Figure, Known, Paper, declared, derived, entry, printed
from safety.audit.equation import Court
from safety.audit.formula import Formula, Relation, relation
from safety.audit.text import Text, slips, text
from safety.audit.units import Mismatch

FILES = (two_counter_figures_text, two_counter_derived_figures)
FIGURES = {
    each.id: each
    for each in declared()
    if isinstance(each, Figure) and each.id.startswith(("two_counter.", "two_counter_derived."))
}
SETTLED = ("confirmed", "rounding", "misprint", "inconsistent")


def moved(figure: Figure, units: int) -> Text:
    """Its text with the last digit that counts changed by some units."""
    new, step = figure.text.value + units * figure.text.step, figure.text.step
    places = len(str(step.denominator)) - 1
    return text(f"{float(new):.{places}f}")


def is_confirmed(figure: Figure, other: Text) -> bool:
    """Whether the recomputed value rounds to a text: what "confirmed" has to mean."""
    assert figure.judged.value is not None
    return abs(figure.judged.value.middle - other.value) <= other.step / 2


@pytest.mark.parametrize("name", FIGURES)
def test_another_printed_number_has_another_verdict_and_always_one(name: str) -> None:
    figure = FIGURES[name]
    others = [moved(figure, units) for units in (-30, -1, 1)]
    others += [each for each, _ in slips(figure.text)][:: max(1, len(list(slips(figure.text))) // 2)]
    for other in others:
        judged = figure.if_printed(other)
        if figure.judged.verdict not in SETTLED:
            assert judged.verdict not in ("confirmed", "rounding"), other
        else:
            assert (judged.verdict == "confirmed") == is_confirmed(figure, other), other


def test_one_unit_of_the_last_digit_is_enough() -> None:
    sound = [each for each in FIGURES.values() if each.judged.verdict == "confirmed" and not each.judged.note]
    assert len(sound) > 90
    for figure in sound:
        assert not any(is_confirmed(figure, moved(figure, unit)) for unit in (-1, 1)), figure.id


@pytest.mark.parametrize("other", ["0.66900", "0.67100", "0.66990", "0.67010", "0.64050"])
def test_a_time_that_is_somewhat_wrong_is_not_put_down_to_rounding(other: str) -> None:
    assert FIGURES["two_counter.table2b.5.time"].if_printed(text(other)).verdict in ("misprint", "inconsistent")
    assert FIGURES["two_counter.table2b.5.time_exact"].if_printed(text(other)).verdict == "inconsistent"


# --- slips -----------------------------------------------------------------------------------------------------------

SOUND = [
    each
    for name, each in FIGURES.items()
    if name.startswith("two_counter.table2") and name.endswith((".measured", ".signal", ".time"))
    if each.judged.verdict == "confirmed"
]


def altered(printed: str, chance: random.Random) -> str:
    """One digit replaced, or two neighbours exchanged."""
    places = [n for n, sign in enumerate(printed) if sign.isdecimal()]
    while True:
        digits = list(printed)
        if chance.random() < 0.5:
            digits[chance.choice(places)] = chance.choice("0123456789")
        else:
            n = chance.randrange(len(places) - 1)
            a, b = places[n : n + 2]
            digits[a], digits[b] = digits[b], digits[a]
        if digits != list(printed):
            return "".join(digits)


def test_a_slip_put_into_a_sound_figure_is_found_and_mended() -> None:
    chance, found, right = random.Random(1967), Counter[str | None](), 0
    for _ in range(80):
        figure = chance.choice(SOUND)
        judged = figure.if_printed(text(altered(figure.printed, chance)))
        found[judged.verdict] += 1
        right += bool(judged.mended) and text(judged.mended).value == figure.text.value
    assert found["confirmed"] == 0
    assert right == found["misprint"] > 50


# --- equations and rules ---------------------------------------------------------------------------------------------

INVERSE = {"+": "-", "-": "+", "*": "/", "/": "*"}
CONFIRMED = [
    each.id.removeprefix("two_counter.")
    for each in declared()
    if each.id.startswith("two_counter.") and each.kind == "equation" and each.judged.verdict == "confirmed"
]


def swapped(each: Formula) -> Iterator[Formula]:
    """With one sign of operation replaced by its inverse, or a number or an exponent greater by one."""
    if each.op in INVERSE:
        yield Formula(INVERSE[each.op], each.parts)
    if each.op in ("number", "^"):
        yield Formula(each.op, each.parts, number=each.number + 1)
    for n, part in enumerate(each.parts):
        yield from (Formula(each.op, (*each.parts[:n], new, *each.parts[n + 1 :]), each.name, each.number)
                    for new in swapped(part))  # fmt: skip


def holds(name: str, other: Relation) -> bool | None:
    """Whether another relation in the place of a printed one holds; units that differ make it false."""
    try:
        return Court(paper.symbols, {}).holds(paper.equations[name], other).holds
    except Mismatch:
        return False


@pytest.mark.parametrize("name", CONFIRMED)
def test_no_altered_equation_is_confirmed(name: str) -> None:
    right = paper.equations[name].relation
    for n, side in enumerate(right.sides):
        for other in swapped(side):
            changed = Relation((*right.sides[:n], other, *right.sides[n + 1 :]), right.signs)
            assert holds(name, changed) is False, changed


RULES = ("eq2", "eq4", "circuit", "eq24")
OTHER_SIGN = {"<=": ("<", ">=", ">"), ">=": (">", "<=", "<"), "<": ("<=", ">", ">="), ">": (">=", "<", "<=")}


@pytest.mark.parametrize("name", RULES)
@pytest.mark.parametrize(
    "factor", [Fraction(1, 1000), Fraction(1, 2), Fraction(1001, 1000), Fraction(2), Fraction(1000)]
)
def test_a_rule_with_another_threshold_is_not_confirmed(name: str, factor: Fraction) -> None:
    right = paper.equations[name].relation
    scaled = Formula("*", (Formula("number", number=factor), right.sides[1]))
    assert holds(name, right)
    assert holds(name, Relation((right.sides[0], scaled), right.signs)) is False


@pytest.mark.parametrize("name", RULES)
def test_a_rule_with_another_sign_is_not_confirmed(name: str) -> None:
    right = paper.equations[name].relation
    for sign in OTHER_SIGN[right.signs[0]]:
        assert holds(name, Relation(right.sides, (sign,))) is False


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("eq4", "n1 <= 1000*n1F"),
        ("eq4", "n1 - n1 <= n1F"),
        ("eq2", "n >= nE/2"),
        ("eq24", "f1 <= 5*f2E/n2E*n1F"),
        ("eq19", "n_opt < 2/r"),
        ("eq19", "n_opt >= 2/r"),
        ("eq19", "n_opt = 1/r"),
        ("eq19", "n_opt = 3/r"),
    ],
)
def test_what_a_careless_reading_would_confirm_is_not(name: str, wrong: str) -> None:
    assert holds(name, relation(wrong)) is False


# --- sentences -------------------------------------------------------------------------------------------------------


@pytest.fixture
def scratch(monkeypatch: pytest.MonkeyPatch) -> Paper:
    """A paper with the same symbols, whose entries are forgotten."""
    monkeypatch.setattr(entry, "_declared", dict(entry._declared))
    new = Paper("scratch", "altered")
    new.symbols = paper.symbols
    return new


def exact(value: str) -> Known:
    """A printed setting."""
    return printed(value, exact=True)


SAYS = ("rises with", "falls with", "does not depend on")


@pytest.mark.parametrize(
    ("quantity", "over", "given", "true"),
    [
        ("n2E", "Ts", {"n2E": "f2E*(Ts - Tp)"}, "rises with"),
        ("ΔV", "α", ERROR, "rises with"),
        ("ΔV", "α", {**ERROR, "f1": "K*α*n1F^2/VE"}, "does not depend on"),
        ("ΔVs", "n1F", {}, "falls with"),
    ],
)
def test_of_three_directions_one_is_confirmed(
    scratch: Paper, quantity: str, over: str, given: dict[str, str], true: str
) -> None:
    for n, says in enumerate(SAYS):
        when = ("Ts > Tp",) if over == "Ts" else ()
        each = scratch.wording(str(n), says, where="", says=f"{quantity} {says} {over}", given=given, when=when)
        assert each.judged.verdict == ("confirmed" if says == true else "inconsistent")


BRAKE_TEST = {**AT_30, **OF_FIGURE_4}
WITHIN = f"time - agreement <= {TO_READ_OUT} <= time + agreement"
AT_5, AT_TOP = {"n2E": N2E[5], **SCALE}, {**AT_250, **SCALE}


@pytest.mark.parametrize(
    ("holds", "given", "verdict"),
    [
        (WITHIN, {**AT_5, "time": exact("0.67000")}, "confirmed"),
        (WITHIN, {**AT_5, "time": exact("0.67001")}, "inconsistent"),
        (WITHIN, {**AT_5, "time": exact("0.67000"), "agreement": derived("0.24")}, "inconsistent"),
        (WITHIN, {**AT_TOP, "time": exact("0.62640")}, "inconsistent"),
        (WITHIN, {**AT_TOP, "time": exact("0.62610"), "n_r": derived(0)}, "inconsistent"),
        ("f1*n2E/f2 < n1F", {**BRAKE_TEST, "f1": exact("127")}, "confirmed"),
        ("f1*n2E/f2 < n1F", {**BRAKE_TEST, "f1": exact("128")}, "inconsistent"),
        ("f1*n2E/f2 >= n1F", {**BRAKE_TEST, "f1": exact("127")}, "inconsistent"),
        (f"{TOTAL} < other_accuracy", {**DRAWN, "other_accuracy": exact("0.2")}, "inconsistent"),
        (f"{TOTAL} < other_accuracy", {**DRAWN, "other_accuracy": exact("0.24")}, "assumed"),
        (f"{TOTAL} < other_accuracy", {**DRAWN, "other_accuracy": exact("0.25")}, "confirmed"),
        (f"Vmax/n1F + {TABLED} <= share*Vmax", {**DRAWN, "share": exact("0.23")}, "inconsistent"),
        (f"least_digital <= {TOTAL}", {**DRAWN, "least_digital": exact("0.25")}, "inconsistent"),
        ("least_ratio <= 1/Tc", {"least_ratio": exact("4")}, "inconsistent"),
    ],
)
def test_a_sentence_with_another_number(
    scratch: Paper, holds: str, given: dict[str, Known | str], verdict: str
) -> None:
    assert scratch.statement("altered", "altered", where="nowhere", holds=holds, given=given).judged.verdict == verdict

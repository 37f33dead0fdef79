"""The audit of the two-counter paper comes to what the specification says, and would notice if the paper said else."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator
from fractions import Fraction

import pytest

from models.two_counter import theory
from models.two_counter.numbers import (
    ACCELERATION,
    COUNTING_S,
    COUNTING_S_OF_TABLE_2B,
    DYNAMIC,
    HZ_PER_KMH,
    pulses,
    threshold_hz,
)
from proofs import two_counter_decision, two_counter_figures, two_counter_literal
from safety import PROVED, REFUTED
from safety.audit import Entry, Figure, declared
from safety.audit.equation import Court
from safety.audit.formula import Formula, Relation
from safety.audit.text import text
from safety.audit.units import Mismatch
from safety.prove.claims import registered

PAPER = two_counter_figures.paper
FILES = (two_counter_decision, two_counter_literal)  # whose claims decide on words
ENTRIES: dict[str, Entry] = {
    entry.id.removeprefix("two_counter."): entry for entry in declared() if entry.id.startswith("two_counter.")
}
SPEEDS = (250, 210, 160, 110, 70, 30, 5)

# The verdict table of the specification, row by row: entry, verdict, recomputed (or meant) value
NUMBERS = [
    ("errors.total_percent", "misprint", "0.2147"),
    ("errors.total_percent_by_eq16", "assumed", "0.2379"),  # 0.2304 to 0.2410 over the bracket of n1F
    ("errors.allowed", "confirmed", "0.625"),
    ("errors.total_percent_at_250", "inconsistent", "0.1971"),  # 0.1972 with 0.00904 in place of the printed 0.009
    ("errors.dynamic", "misprint", "0.5142"),
    ("errors.dynamic_percent", "misprint", "0.2057"),
    ("errors.static_hz", "confirmed", "0.153"),
    ("errors.static_percent", "confirmed", "0.009"),
    *((f"table2a.{speed}.theory", "confirmed", "") for speed in SPEEDS),
    *(
        (f"table2a.{speed}.oscillator", "misprint", meant)
        for speed, meant in zip(
            SPEEDS, ("13279.1", "11226.2", "8685.9", "6120.0", "4067.0", "2014.3", "731.3"), strict=True
        )
    ),
    ("table2a.250.signal", "misprint", "1659.89"),
    *((f"table2a.{speed}.signal", "confirmed", "") for speed in SPEEDS[1:]),
    *((f"table2a.{speed}.error", "confirmed", "") for speed in SPEEDS),
    *((f"table2b.{speed}.theory", "confirmed", "") for speed in (250, 160, 70, 5)),
    ("table2b.210.theory", "rounding", "0.47019"),  # within 2e-5: T''c/2 is a difference of five-digit numbers
    ("table2b.110.theory", "rounding", "0.472568"),
    ("table2b.30.theory", "misprint", "0.48322"),
    *((f"table2b.{speed}.measured", "confirmed", "") for speed in SPEEDS[:-1]),
    ("table2b.5.measured", "misprint", "0.51422"),
    *((f"table2b.{speed}.time", "rounding", "") for speed in SPEEDS),  # confirmed within 0.25 ms, see below
    ("times.sampling", "inconsistent", "0.3141"),
    ("times.counting", "confirmed", "0.3117"),
    ("times.constant", "inconsistent", ""),
    ("figure4.ratios", "confirmed", ""),
    ("table1.two_counters.accuracy", "inconsistent", "0.24"),  # "only order of magnitude"
    ("table1.two_counters.accuracy_static", "assumed", "0.05"),
    ("table1.two_counters.response", "confirmed", "0.31"),
    ("table1.two_counters.response_worst", "inconsistent", "0.63"),
    ("table1.reversible.accuracy", "not derivable", ""),
    ("table1.reversible.response", "not derivable", ""),
    *((f"text.{kind}_{end}", "not derivable", "") for kind in ("analogue", "digital") for end in ("least", "most")),
    ("brake_test.brake", "confirmed", ""),
    ("brake_test.release", "confirmed", ""),
]
EQUATIONS = {
    "eq1": "inconsistent",  # "doubtful": a frequency plus a number
    "eq5": "rounding",  # "first order"
    "eq6": "misprint",
    "eq7": "inconsistent",
    "eq4_and_circuit": "inconsistent",
    "at_eq24_direction": "inconsistent",
    "at_eq24_limit": "inconsistent",
    "after_eq23": "inconsistent",  # "misleading"
    **{f"eq{n}": "confirmed" for n in (2, 3, 4, *range(8, 15), *range(17, 26))},
    "eq15_16": "confirmed",
}


@pytest.mark.parametrize(("name", "verdict", "value"), NUMBERS, ids=[each[0] for each in NUMBERS])
def test_a_number_is_judged_as_the_specification_judges_it(name: str, verdict: str, value: str) -> None:
    judged = ENTRIES[name].judged
    assert judged.verdict == verdict
    assert value in ("", judged.mended or judged.recomputed)


@pytest.mark.parametrize(("name", "verdict"), EQUATIONS.items())
def test_an_equation_is_judged_as_the_specification_judges_it(name: str, verdict: str) -> None:
    assert ENTRIES[name].judged.verdict == verdict


def test_every_verdict_has_its_reason() -> None:
    assert ENTRIES["eq6"].judged.mended == "Ts = Tp + Tc"
    assert "true where Tp = 0" in ENTRIES["eq7"].judged.note
    assert ENTRIES["eq1"].judged.note == "s^-1 and a pure number cannot be added"
    assert ENTRIES["at_eq24_direction"].judged.note == "reversed: n2E rises with Ts"
    assert ENTRIES["at_eq24_limit"].judged.note.endswith("reversed: true is n2E >= VE/ε")
    assert ENTRIES["after_eq23"].judged.note == "in fact: ΔV rises with α"
    assert "table2b.5.measured (0.56422 for 0.51422)" in ENTRIES["errors.total_percent"].judged.note
    assert all(ENTRIES[name].judged.evidence for name, verdict, _ in NUMBERS if verdict == "misprint")


def test_all_of_the_paper_is_there() -> None:
    kinds = Counter(entry.kind for entry in ENTRIES.values())
    assert kinds["number"] > 65 and kinds["equation"] > 27 and len(ENTRIES) > 110
    assert all(entry.where for entry in ENTRIES.values())


# --- the same by the error theory, which shares no formula with the audit --------------------------------------------


@pytest.mark.parametrize("row", DYNAMIC)
def test_the_measured_times_are_within_a_quarter_of_a_millisecond_of_the_exact_model(row: object) -> None:
    speed, time = row.speed, Fraction(row.time)  # type: ignore[attr-defined]
    exact = theory.time_to_read_out(pulses(speed), COUNTING_S, HZ_PER_KMH, ACCELERATION).middle
    recomputed = Fraction(ENTRIES[f"table2b.{speed}.time"].judged.recomputed)
    assert abs(recomputed - exact) <= Fraction("5e-7")
    assert abs(exact - time) <= Fraction("0.00025")


@pytest.mark.parametrize("speed", SPEEDS)
def test_the_theory_column_is_that_of_the_error_theory(speed: int) -> None:
    expected = theory.dynamic_error_tabled(ACCELERATION, COUNTING_S_OF_TABLE_2B, threshold_hz(speed))
    judged = ENTRIES[f"table2b.{speed}.theory"].judged
    assert abs(Fraction(judged.recomputed) - expected) <= Fraction("5e-7")


# --- it would notice -------------------------------------------------------------------------------------------------

SOUND = [
    name
    for name, verdict, _ in NUMBERS
    if verdict == "confirmed" and name.startswith("table2") and name.endswith((".measured", ".signal"))
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
    chance, found, right = random.Random(1967), Counter[str](), 0
    for _ in range(150):
        figure = ENTRIES[chance.choice(SOUND)]
        assert isinstance(figure, Figure)
        judged = figure.if_printed(text(altered(figure.printed, chance)))
        found[judged.verdict] += 1
        right += bool(judged.mended) and text(judged.mended).value == figure.text.value
    assert found["confirmed"] == 0
    assert right == found["misprint"] > 120


@pytest.mark.parametrize("name", ["table2b.250.theory", "table2b.5.theory", "table2a.30.theory"])
def test_the_last_digit_matters(name: str) -> None:
    figure = ENTRIES[name]
    assert isinstance(figure, Figure)
    for units in (-1, 1):
        other = text(f"{float(figure.text.value + units * figure.text.step):.5f}"[: len(figure.printed)])
        assert figure.if_printed(other).verdict != "confirmed"


INVERSE = {"+": "-", "-": "+", "*": "/", "/": "*"}


def swapped(each: Formula) -> Iterator[Formula]:
    """With one sign of operation replaced by its inverse, or a number or an exponent greater by one."""
    if each.op in INVERSE:
        yield Formula(INVERSE[each.op], each.parts)
    if each.op in ("number", "^"):
        yield Formula(each.op, each.parts, number=each.number + 1)
    for n, part in enumerate(each.parts):
        yield from (Formula(each.op, (*each.parts[:n], new, *each.parts[n + 1 :]), each.name, each.number)
                    for new in swapped(part))  # fmt: skip


ALTERED = [
    (name, n, other)
    for name, verdict in EQUATIONS.items()
    if verdict == "confirmed" and name in PAPER.equations
    for n, side in enumerate(PAPER.equations[name].relation.sides)
    for other in swapped(side)
]


def test_no_altered_equation_is_confirmed() -> None:
    assert len(ALTERED) > 80
    for name, n, other in ALTERED:
        printed = PAPER.equations[name].relation
        changed = Relation((*printed.sides[:n], other, *printed.sides[n + 1 :]), printed.signs)
        try:
            answer = Court(PAPER.symbols, {}).holds(PAPER.equations[name], changed)
        except Mismatch:
            continue
        assert answer.holds is False, changed


def test_words_rest_on_claims_that_are_stated_as_they_are_judged() -> None:
    expected = {claim.id: claim.expect for claim in registered()}
    words = {name: expected[entry.claim] for name, entry in ENTRIES.items() if entry.claim}
    assert words == {
        "section5.signal_2_sets": REFUTED,
        "section5.signal_1_resets": REFUTED,
        "section5.consistent": PROVED,
    }


def test_every_entry_is_of_a_requirement() -> None:
    assert Counter(entry.requirement for entry in ENTRIES.values()).keys() == {"TC-A", "TC-T1", "TC-2"}

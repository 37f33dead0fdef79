"""Verdicts on equations, statements and wordings; each can fail."""

from fractions import Fraction
from typing import Any

import pytest

from safety.audit import AuditError, Judged, Paper, printed, unknown
from safety.audit.algebra import decide
from safety.audit.formula import relation
from safety.prove.solve import Disagreement


@pytest.fixture
def ride(paper: Paper) -> Paper:
    """Uniform acceleration from a speed."""
    for name, unit, by in (
        ("u", "m/s", ""), ("a", "m/s^2", ""), ("t", "s", ""), ("v", "m/s", "u + a*t"), ("s", "m", "u*t + a*t^2/2"),
        ("M", "kg", ""), ("w", "m/s", "v"), ("x", "1", ""), ("y", "1", ""),
    ):  # fmt: skip
        paper.symbol(name, unit, by=by)
    return paper


def judged(paper: Paper, text: str, **about: Any) -> Judged:
    return paper.equation("equation", text, where="(1)", **about).judged


@pytest.mark.parametrize(
    "text",
    [
        "v^2 = u^2 + 2*a*s", "t = (v - u)/a", "t = (sqrt(u^2 + 2*a*s) - u)/a", "s = (u + v)/2*t", "v >= u", "s > u*t",
        "u <= s/t < v", "u = sqrt(v^2 - 2*a*s)",
    ],
)  # fmt: skip
def test_what_follows_from_the_theory_is_confirmed_by_two_routes(ride: Paper, text: str) -> None:
    found = judged(ride, text)
    assert found.verdict == "confirmed"
    assert len(found.agreed_by) >= 2


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("v^2 = u^2 + a*s", "at "),
        ("v = u - a*t", "at "),
        ("t = (sqrt(u^2 + 2*a*s) + u)/a", "at "),
        ("s = u*t + a*t/2", "cannot be added"),
        ("v = u + 1", "cannot be added"),
        ("s = v", "s is m, v is m s^-1"),
        ("v <= u", "reversed: true is v >= u"),
        ("v = u", "true where a = 0; "),
        ("Z + Y = u", "Y, Z is defined nowhere"),
    ],
)
def test_what_contradicts_it_is_inconsistent_and_says_why(ride: Paper, text: str, why: str) -> None:
    found = judged(ride, text)
    assert found.verdict == "inconsistent"
    assert why.rstrip("; ") in found.note


def test_a_counterexample_is_one(ride: Paper) -> None:
    at = {name: Fraction(value) for name, value in judged(ride, "v^2 = u^2 + a*s").counterexample.items()}
    v, s = at["u"] + at["a"] * at["t"], at["u"] * at["t"] + at["a"] * at["t"] ** 2 / 2
    assert v**2 != at["u"] ** 2 + at["a"] * s


def test_a_symbol_that_is_defined_nowhere_is_a_misprint_for_the_only_one_that_fits(ride: Paper) -> None:
    found = judged(ride, "v = u + a*T0")
    assert (found.verdict, found.mended, found.slip) == ("misprint", "v = u + a*t", "t printed as T0")
    assert found.evidence == ("T0 is defined nowhere",)


def test_a_known_symbol_in_the_wrong_place_is_one_if_another_equation_has_the_right_one(ride: Paper) -> None:
    wrong = "s = (u + u)/2*t"
    assert judged(ride, wrong).verdict == "inconsistent"
    ride.equation("other", "v = u + a*t", where="(2)")
    found = ride.equation("again", wrong, where="(3)").judged
    assert (found.verdict, found.mended) == ("misprint", "s = (v + u)/2*t")
    assert "v stands in other" in found.evidence


def test_only_the_printed_side_is_searched_for_a_slip(ride: Paper) -> None:
    ride.equation("other", "w = v", where="(2)")
    assert judged(ride, "u + a*t", of="u").verdict == "inconsistent"
    assert ride.equation("whole", "u = u + a*t", where="(3)").judged.verdict == "misprint"


def test_a_neglected_quantity_is_rounding_up_to_that(ride: Paper) -> None:
    about = {"given": {"x": "1/(y - 1)"}, "when": ("y > 1",)}
    assert judged(ride, "x = 1/y", **about, neglecting="1/y").verdict == "rounding"
    assert ride.equation("less", "x = 1/y", where="", **about, neglecting="1/(2*y)").judged.verdict == "inconsistent"


def test_the_least_value_is_found_where_it_is(ride: Paper) -> None:
    least = "x^2/(y*x - 1)"
    assert judged(ride, "x = 2/y", least=least, when=("y*x > 1",)).verdict == "confirmed"
    assert ride.equation("other", "x = 3/y", where="", least=least, when=("y*x > 1",)).judged.verdict == "inconsistent"


def test_what_is_true_nowhere_is_not_taken_for_true(ride: Paper) -> None:
    with pytest.raises(AuditError, match="no point was found"):
        judged(ride, "v = u", when=("a < 0",))
    with pytest.raises(AuditError, match="no point was found"):
        judged(ride, "x = 1/(y - y)")


def test_exact_points_and_solvers_have_to_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("safety.audit.algebra.true_at", lambda each, at: True)
    with pytest.raises(Disagreement, match="but there it holds"):
        decide(relation("x + 1 = x"))


@pytest.mark.parametrize(
    ("says", "verdict", "note"),
    [
        ("s rises with t", "confirmed", ""),
        ("s falls with t", "inconsistent", "reversed: s rises with t"),
        ("s does not depend on t", "inconsistent", "in fact: s rises with t"),
        ("s does not depend on M", "confirmed", ""),
        ("s rises with M", "inconsistent", "M does not stand in it"),
        ("x falls with y", "confirmed", ""),
        ("w does not depend on t", "inconsistent", "w neither rises nor falls with t throughout"),
        ("e rises with z", "inconsistent", "e neither rises nor falls with z throughout"),  # z may be below 0
    ],
)
def test_a_direction_is_that_of_the_theory(ride: Paper, says: str, verdict: str, note: str) -> None:
    ride.symbol("z", "1", signed=True)
    ride.symbol("e", "1", by="z^2")
    given = {"x": "1/y", "w": "t*(u/a - t)*u/(u/a*u/a)*a/a"}
    found = ride.wording("wording", "words", where="text", says=says, given=given).judged
    assert (found.verdict, found.note) == (verdict, note)


@pytest.mark.parametrize(
    ("holds", "verdict"),
    [
        ("T < 1", "confirmed"),
        ("T >= 1", "rounding"),
        ("T >= 1.001", "inconsistent"),
        ("0.9 <= T <= 1.1", "confirmed"),
        ("0.9 <= T < 0.99", "inconsistent"),
        ("T*(1 + load) <= 1.1", "confirmed"),
        ("T*(1 + load) <= 1.015", "assumed"),
        ("T + unheard > 1", "not derivable"),
    ],
)
def test_a_sentence_holds_for_its_numbers(paper: Paper, holds: str, verdict: str) -> None:
    assert paper.statement("statement", "words", where="text", holds=holds).judged.verdict == verdict


def test_a_range_in_a_sentence_leaves_it_open(paper: Paper) -> None:
    for name, given, verdict in (("a", unknown(0, 5), "not derivable"), ("b", unknown(3, 5), "inconsistent")):
        found = paper.statement(name, "words", where="", holds="T >= unheard", given={"unheard": given}).judged
        assert found.verdict == verdict
    found = paper.statement("c", "", where="", holds="T >= unheard", given={"unheard": printed("0.5")}).judged
    assert found.verdict == "confirmed"


def test_words_that_a_claim_states_wait_for_it(paper: Paper) -> None:
    entry = paper.decided("said", "words", where="text", claim="clock.runs").evaluate()
    assert (entry["verdict"], entry["claim"]) == ("not derivable", "clock.runs")


def test_a_direction_is_one_within_its_conditions(ride: Paper) -> None:
    falls = {"x": "y*(2 - y)"}
    assert ride.wording("all", "", where="", says="x rises with y", given=falls).judged.verdict == "inconsistent"
    part = ride.wording("part", "", where="", says="x rises with y", given=falls, when=("y < 1",))
    assert part.judged.verdict == "confirmed"

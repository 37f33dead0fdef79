"""Verdicts on equations, statements and wordings; each can fail."""

from fractions import Fraction
from typing import Any

import pytest

from safety.audit import AuditError, Judged, Paper, assumed, derived, printed, unknown
from safety.audit.algebra import decide
from safety.audit.equation import Court
from safety.audit.formula import relation
from safety.prove.solve import Disagreement
from safety.report.figures import decided


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
    ride.symbol("n", "1", known=assumed(200, 150, 300, whole=True))
    about: dict[str, Any] = {"where": "", "given": {"x": "1/(n - 1)"}, "when": ("n > 1",)}
    close = ride.equation("close", "x = 1/n", **about, neglecting="1/n").judged
    assert (close.verdict, close.assumed) == ("rounding", ("n = 200 (150 .. 300)",))
    for name, text, share in (
        ("less", "x = 1/n", "1/(2*n)"), ("sign", "x < 1/n", "1/n"), ("middle", "x = 7 = 1/n", "1/n"),
        ("last", "1/n = x = 7", "1/n"),
    ):  # fmt: skip
        found = ride.equation(name, text, **about, neglecting=share).judged
        assert found.verdict == "inconsistent", text


@pytest.mark.parametrize(
    ("share", "why"),
    [("1", "0 .. 0.01 may be neglected"), ("2/n", "is 0.00667 .. 0.0133"), ("-1/n", "may be neg"), ("1/y", "give y a"),
     ("1/(n - 200)", "cannot be evaluated")],
)  # fmt: skip
def test_what_is_not_small_is_not_neglected(ride: Paper, share: str, why: str) -> None:
    ride.symbol("n", "1", known=assumed(200, 150, 300, whole=True))
    with pytest.raises(AuditError, match=why):
        judged(ride, "x = 1/n", given={"x": "1/(n - 1)"}, when=("n > 1",), neglecting=share)


def test_the_least_value_is_found_where_it_is(ride: Paper) -> None:
    least = "x^2/(y*x - 1)"
    assert judged(ride, "x = 2/y", least=least, when=("y*x > 1",)).verdict == "confirmed"
    for n, (text, why) in enumerate({
        "x = 3/y": "at ", "x < 2/y": "at one value of x", "x >= 2/y": "at one value of x", "x = 2/y = 3/y": "at ",
        "x = 3/y = 2/y": "at ", "x = 1/y": "does not hold where x = 1/y", "x = x": "both sides",
        "x = 1/(y - y)": "meaning",
    }.items()):  # fmt: skip
        found = ride.equation(f"other{n}", text, where="", least=least, when=("y*x > 1",)).judged
        assert (found.verdict, why in found.note) == ("inconsistent", True), (text, found)
    with pytest.raises(AuditError, match="without a definition"):
        ride.equation("defined", "v = 2*u", where="", least="v^2").evaluate()


def test_what_is_true_nowhere_is_not_taken_for_true(ride: Paper) -> None:
    with pytest.raises(AuditError, match="no point was found"):
        judged(ride, "v = u", when=("a < 0",))


@pytest.mark.parametrize(
    "text", ["x = y/2 + sqrt(-(y - 1)^2)", "x = y/2 + sqrt(1 - y)*0", "x = y/2 + 0/(y - 3)", "x = y/2 + 0*(y - 3)^-1",
             "x = y/2 + 0/(1/y - 1/3)", "x = 1/(y - y)"]
)  # fmt: skip
def test_what_has_a_meaning_only_here_and_there_is_not_true(ride: Paper, text: str) -> None:
    found = judged(ride, text, given={"x": "y/2"})
    assert (found.verdict, found.note[:13]) == ("inconsistent", "it has no mea")
    assert "y" in found.counterexample


def test_a_meaning_is_asked_for_where_the_theory_has_one(ride: Paper) -> None:
    assert judged(ride, "x = 1/(y - 3)", given={"x": "1/(y - 3)"}).verdict == "confirmed"
    within = ride.equation("within", "x = y/2 + 0*sqrt(y - 3)", where="", given={"x": "y/2"}, when=("y > 3",))
    assert within.judged.verdict == "confirmed"


def test_a_rule_holds_where_its_condition_does_and_nowhere_else(ride: Paper) -> None:
    rule = ride.rule("rule", "v >= 2*u", where="(5)", iff="a*t >= u")
    assert rule.judged.verdict == "confirmed"
    assert len(rule.judged.agreed_by) >= 2
    court, each = Court(ride.symbols, {}), ride.equations["rule"]
    for other in ("v >= u", "1000*v >= 2*u", "v >= 3*u", "v > 2*u", "v <= 2*u", "v - v >= u - u"):
        assert court.holds(each, relation(other)).holds is False, other
    loose = ride.rule("loose", "v >= u", where="", iff="a*t >= u").judged
    assert (loose.verdict, loose.note.split(";")[0]) == (
        "inconsistent", "holds wherever a*t >= u, but also where that is not so",
    )  # fmt: skip
    assert ride.rule("tight", "v >= 3*u", where="", iff="a*t >= u").judged.note.startswith("does not hold wherever")
    flipped = ride.rule("flipped", "v < 2*u", where="", iff="a*t >= u").judged
    assert "reversed" not in flipped.note and flipped.verdict == "inconsistent"
    with pytest.raises(AuditError, match="has one side"):
        ride.rule("empty", "v >= u", where="", iff="a*t")


def test_of_a_bare_inequality_no_misprint_is_made(ride: Paper) -> None:
    ride.symbol("twice", "m/s", by="2*v")
    ride.equation("other", "twice = 2*v", where="(2)")
    assert judged(ride, "u > v").verdict == "inconsistent"  # twice > v is true, but so is many another
    assert ride.equation("unheard", "U > v", where="(3)").judged.verdict == "misprint"


def test_letters_that_look_alike_are_one(ride: Paper) -> None:
    ride.symbol("\u00b5", "1", by="2*x")
    assert judged(ride, "\u03bc = 2*x").verdict == "confirmed"
    assert ride.wording("w", "", where="", says="\u00b5 rises with x").judged.verdict == "confirmed"


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
        ("T < 1.001", "confirmed"),
        ("T < 1", "rounding"),  # of what rounds to 32.77 some is less than 32.768
        ("T >= 1", "not derivable"),
        ("T = 1", "rounding"),
        ("T = 1.001", "inconsistent"),
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


@pytest.mark.parametrize("holds", ["stages^60 < stages^70", "1/stages^60 > 0", "stages^70 > stages^60"])
def test_sides_that_are_beyond_comparison_are_refused(paper: Paper, holds: str) -> None:
    with pytest.raises(AuditError, match="divide both, or take roots"):
        _ = paper.statement("far", "", where="", holds=holds).judged


def test_words_that_a_claim_states_wait_for_it(paper: Paper) -> None:
    entry = paper.decided("said", "words", where="text", claim="clock.runs").evaluate()
    assert (entry["verdict"], entry["claim"]) == (None, "clock.runs")


@pytest.mark.parametrize(
    ("claim", "settings", "verdict", "note"),
    [
        ({"verdict": "proved"}, {}, "confirmed", ""),
        ({"verdict": "refuted"}, {}, "inconsistent", ""),
        *(({"verdict": word}, {}, None, f"open: clock.runs is {word}") for word in ("bounded", "vacuous", "undecided")),
        (None, {}, None, "not run: `rightside verify`, or `rightside prove -k clock.runs`"),
        ({"verdict": "proved"}, {"ring.load": 2}, None, "not judged: clock.runs was asked with another ring.load"),
        ({"verdict": "proved"}, {"load": 2}, None, "not judged: clock.runs was asked with another load"),
        ({"verdict": "proved"}, {"pace": 2}, "confirmed", ""),
    ],
)
def test_a_claim_decides_when_it_is_proved_or_refuted_as_it_stands(
    claim: dict[str, Any] | None, settings: dict[str, Any], verdict: str | None, note: str
) -> None:
    about = {
        "id": "clock.runs",
        "parameters": [
            {"name": "ring.load", "value": "1", "unit": "s", "source": "[A] taken"},
            {"name": "ring.turn", "value": None, "unit": "s", "source": "[A] taken"},
        ],
    }
    claims = [] if claim is None else [{**about, **claim}]
    found = decided({"id": "said", "claim": "clock.runs", "verdict": None}, {"claims": claims, "settings": settings})
    assert (found["verdict"], found["note"], found.get("waits", False)) == (verdict, note, claim is None)
    assert found.get("assumed") == (["ring.load = 1 s", "ring.turn, whatever is admitted"] if verdict else None)


def test_a_sentence_over_counts_is_asked_at_whole_values(paper: Paper) -> None:
    given = {"load": assumed(1, 1, 4, whole=True)}
    holds = "(load - 5/2)*(load - 5/2) >= 1/4"  # false between 2 and 3 only
    assert paper.statement("whole", "", where="", holds=holds, given=given).judged.verdict == "confirmed"
    real = {"load": assumed(1, 1, 4)}
    found = paper.statement("real", "", where="", holds=holds, given=real).judged
    assert found.verdict == "assumed"
    assert found.note == "confirmed with the reference, inconsistent with load = 2.5, in place of 1 (1 .. 4)"


def test_all_assumed_inputs_of_a_sentence_move_at_once(paper: Paper) -> None:
    paper.symbol("weight", "1", known=assumed(0, 0, 1))
    given = {"load": assumed(0, 0, 1)}
    assert paper.statement("both", "", where="", holds="load*weight < 1", given=given).judged.verdict == "assumed"
    assert paper.statement("never", "", where="", holds="load*weight > 1", given=given).judged.verdict == "inconsistent"
    assert paper.statement("some", "", where="", holds="load > 1/2", given=given).judged.verdict == "assumed"


def test_numbers_in_a_relation_and_assumed_origins_are_told(paper: Paper) -> None:
    worked_out = derived(3, rests_on={"load": assumed("0.01", "0", "0.02"), "divisor": derived(2)})
    entry = paper.statement("s", "", where="", holds="2*stages > 5/3", given={"stages": worked_out}).evaluate()
    assert entry["inputs"] == ["stages = 3 [D], resting on load = 0.01 (0 .. 0.02) [A]", "2 in the relation [D]",
                               "5, 3 in the relation [D]"]  # fmt: skip
    assert (entry["verdict"], entry["assumed"]) == ("confirmed", ["load = 0.01 (0 .. 0.02)"])


def test_a_direction_is_one_within_its_conditions(ride: Paper) -> None:
    falls = {"x": "y*(2 - y)"}
    assert ride.wording("all", "", where="", says="x rises with y", given=falls).judged.verdict == "inconsistent"
    part = ride.wording("part", "", where="", says="x rises with y", given=falls, when=("y < 1",))
    assert part.judged.verdict == "confirmed"

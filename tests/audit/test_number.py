"""Verdicts on numbers: each of the six comes about as it is said, and goes when its cause does."""

from fractions import Fraction
from typing import Any

import pytest

from safety.audit import AuditError, Judged, Paper, Span, assumed, derived, printed, unknown

EVIDENCE = {"counted apart": "counted"}


def judged(paper: Paper, text: str, unit: str = "s", **about: Any) -> Judged:
    return paper.figure("figure", text, unit, where="table 1", **about).judged


def test_what_rounds_to_the_text_is_confirmed(paper: Paper) -> None:
    assert judged(paper, "0.99994", by="T") == Judged("confirmed", "0.999939")


@pytest.mark.parametrize("text", ["0.12", "0.13"])
def test_a_tie_is_confirmed_either_way_and_says_so(paper: Paper, text: str) -> None:
    found = judged(paper, text, "1", by="1/8")
    assert (found.verdict, found.note) == ("confirmed", "a tie: it rounds either way")


def test_units_are_converted(paper: Paper) -> None:
    assert judged(paper, "999.94", "ms", by="T").verdict == "confirmed"
    with pytest.raises(AuditError, match="is s, but is given in 'Hz'"):
        judged(paper, "1", "Hz", by="T")


def test_what_inputs_within_their_precision_give_is_rounding_with_the_inputs(paper: Paper) -> None:
    found = judged(paper, "1.0000", by="T")  # at f = 32.768, printed as 32.77
    assert (found.verdict, found.recomputed) == ("rounding", "0.99994")
    name, _, rest = found.note.removeprefix("as printed for ").partition(" = ")
    value = Fraction(rest.partition(",")[0])
    assert name == "f" and abs(value - Fraction("32.77")) <= Fraction("0.005")
    assert abs(2**15 / value / 1000 - 1) <= Fraction("0.00005")


def test_an_input_that_stands_for_itself_explains_nothing(paper: Paper) -> None:
    exact = {"f": printed("32.77", exact=True)}
    assert judged(paper, "1.0000", by="T", given=exact).verdict == "inconsistent"


def test_a_slip_with_evidence_is_a_misprint(paper: Paper) -> None:
    paper.symbol("counted", "s", "in another table", printed("1.000"))
    found = judged(paper, "0.93994", by="T", also=EVIDENCE)
    assert (found.verdict, found.mended, found.slip) == ("misprint", "0.99994", "one digit replaced")
    assert found.evidence == ("counted apart: counted = 0.9995 .. 1.0005",)


@pytest.mark.parametrize(
    ("also", "counted", "why"),
    [
        ({}, "1.000", "no independent relation is known"),
        (EVIDENCE, "0.940", "no independent relation speaks for that"),  # it speaks for what is printed
        (EVIDENCE, "0.97", "no independent relation speaks for that"),  # for neither
        (EVIDENCE, "1", "no independent relation speaks for that"),  # too coarse to tell
    ],
)
def test_a_slip_without_evidence_is_inconsistent(paper: Paper, also: Any, counted: str, why: str) -> None:
    paper.symbol("counted", "s", "in another table", printed(counted))
    found = judged(paper, "0.93994", by="T", also=also)
    assert (found.verdict, found.note) == ("inconsistent", f"one digit replaced would give 0.99994, but {why}")


def test_evidence_that_rests_on_the_same_inputs_is_refused(paper: Paper) -> None:
    with pytest.raises(AuditError, match="rests on the same inputs"):
        judged(paper, "0.93994", by="T", also={"itself": "2*T - divisor/f"})


@pytest.mark.parametrize(
    "relation", ["T + 0*counted", "T + counted - counted", "T*counted/counted", "T + counted/10^9"]
)
def test_evidence_has_to_move_with_an_input_of_its_own(paper: Paper, relation: str) -> None:
    paper.symbol("counted", "s", "in another table", printed("1.000"))
    with pytest.raises(AuditError, match="counted does not change it"):
        judged(paper, "0.93994", by="T", also={"disguised": relation})
    with pytest.raises(AuditError, match="unheard has no value"):
        paper.figure("free", "0.93994", "s", where="", by="T", also={"open": "unheard"}).evaluate()


def test_what_no_single_slip_explains_is_inconsistent(paper: Paper) -> None:
    paper.symbol("counted", "s", "in another table", printed("1.000"))
    assert judged(paper, "0.51234", by="T", also=EVIDENCE) == Judged(
        "inconsistent", "0.999939", "no single slip of the pen explains it"
    )


def test_what_follows_from_a_misprint_is_spoilt_with_it(paper: Paper) -> None:
    paper.symbol("counted", "s", "in another table", printed("1.000"))
    paper.symbol("one", "s", "a period")
    first = paper.figure("first", "0.93994", "s", where="table 1", by="T", also=EVIDENCE)
    twice = paper.figure("twice", "1.880", "s", where="text", by="2*one", given={"one": first})
    right = paper.figure("right", "2.000", "s", where="text", by="2*one", given={"one": first})
    other = paper.figure("other", "1.700", "s", where="text", by="2*one", given={"one": first})
    assert (twice.judged.verdict, twice.judged.recomputed) == ("misprint", "1.9999")
    assert "clock.first (0.93994 for 0.99994)" in twice.judged.note
    assert (right.judged.verdict, other.judged.verdict) == ("confirmed", "inconsistent")
    half = paper.figure("half", "0.940", "s", where="text", by="one/2", given={"one": twice})
    assert (half.judged.verdict, half.judged.recomputed) == ("misprint", "0.9999")


def test_what_an_unknown_symbol_leaves_free_is_not_derivable(paper: Paper) -> None:
    found = judged(paper, "3", by="T + unheard")
    assert found.verdict == "not derivable"
    assert found.note.startswith("nothing fixes unheard: unheard = 0.001 gives 1; unheard = 1 gives 2")


@pytest.mark.parametrize(
    ("low", "high", "verdict"),
    [("0", "5", "not derivable"), ("1.999", "2.001", "confirmed"), ("7", "9", "inconsistent")],
)
def test_a_range_leaves_the_value_free_only_if_it_is_wide(paper: Paper, low: str, high: str, verdict: str) -> None:
    assert judged(paper, "3", by="T + unheard", given={"unheard": unknown(low, high)}).verdict == verdict


@pytest.mark.parametrize(
    ("text", "verdict"), [("1", "confirmed"), ("1.01", "assumed"), ("1.018", "assumed"), ("1.5", "inconsistent")]
)
def test_what_hangs_on_an_assumed_input_says_so(paper: Paper, text: str, verdict: str) -> None:
    found = judged(paper, text, by="T*(1 + load)", given={"f": derived("32.768")})
    assert found.verdict == verdict
    assert found.assumed == ("load = 0.01 (0 .. 0.02)",)


A = ("load", "weight")
RANGES = {
    "inside": ("0", "load*(4 - load) - 3", {"load": (1, 1, 3)}, "load = 2"),  # the ends give 0
    "both at once": ("0", "load*weight", {"load": (0, 0, 1), "weight": (0, 0, 1)}, "weight = 1"),
    "only together": ("5", "load + weight", {"load": (0, 0, 2), "weight": (0, 0, 3)}, "load = 2"),
    "a slip elsewhere": ("132", "load", {"load": (150, 150, 154)}, "misprint with load = 152"),
    "no slip elsewhere": ("132", "load", {"load": (152, 150, 154)}, "inconsistent with load = 150"),
    "right elsewhere": ("132", "load", {"load": (152, 130, 154)}, "confirmed with load = 13"),
    "rounding elsewhere": ("3.1", "load*near", {"load": (1, 1, 2)}, "confirmed with load = 1.03"),
}


@pytest.mark.parametrize("name", RANGES)
def test_no_admissible_value_escapes(paper: Paper, name: str) -> None:
    text, by, ranges, why = RANGES[name]
    paper.symbol("weight", "1")
    paper.symbol("near", "1", known=printed("3"))
    paper.symbol("seen", "1", known=printed("152"))
    given = {name: assumed(*values) for name, values in ranges.items()}
    found = judged(paper, text, "1", by=by, given=given, also={"seen": "seen"})
    assert (found.verdict, why in found.note) == ("assumed", True), found
    assert len(found.assumed) == len(ranges)


def test_a_count_is_whole_in_every_witness(paper: Paper) -> None:
    cube = "load*(load - 1)*(load - 2)*(load - 3)"
    for n, (text, by, load, verdict) in enumerate((
        ("3.5", "load", assumed(2, 1, 9, whole=True), "inconsistent"),
        ("3.5", "load", assumed(2, 1, 9), "assumed"),
        ("7", "load", assumed(2, 1, 9, whole=True), "assumed"),
        ("0", cube, assumed(1, 0, 3, whole=True), "confirmed"),
        ("0", cube, assumed(1, 0, 3), "assumed"),
        ("3.5", "load", unknown(1, 9, whole=True), "inconsistent"),
        ("3.5", "load", unknown(1, 9), "not derivable"),
    )):  # fmt: skip
        found = paper.figure(f"count{n}", text, "1", where="", by=by, given={"load": load}).judged
        assert found.verdict == verdict, (text, found)
    for low, value in (("0.5", 1), ("0", "1.5")):
        with pytest.raises(AuditError, match="count"):
            assumed(value, low, 3, whole=True)


def test_a_range_and_an_assumed_input_are_looked_at_together(paper: Paper) -> None:
    paper.symbol("wide", "1", known=unknown(-1, 1))
    given = {"load": assumed(0, 0, 2)}
    found = judged(paper, "0", "1", by="load*wide", given=given)
    assert (found.verdict, "not derivable with load = 2" in found.note) == ("assumed", True), found
    far = paper.figure(
        "far", "132", "1", where="", by="152 + wide", also={"seen": "load"}, given={"load": derived(152)}
    )
    assert far.judged.verdict == "inconsistent"  # not a misprint of 152, which only some values of it give


def test_rounding_lasts_for_all_admissible_values_or_is_assumed(paper: Paper) -> None:
    paper.symbol("near", "1", known=printed("3"))
    for name, high, verdict in (("narrow", "1.01", "rounding"), ("wide", "1.5", "assumed")):
        given = {"load": assumed(1, 1, high)}
        found = paper.figure(name, "3.1", "1", where="", by="load*near", given=given).judged
        assert found.verdict == verdict, found


def test_what_boxes_cannot_decide_is_not_derivable(paper: Paper) -> None:
    def leap(x: Any) -> Any:
        """Whole tens, with a leap at each whole number."""
        low, high = (x.low, x.high) if isinstance(x, Span) else (x, x)
        return Span(low // 1 * 10, high // 1 * 10)

    given = {"x": derived("1.9", "1", "2.5")}
    found = judged(paper, "15", "1", by=leap, given=given)
    assert (found.verdict, found.note[:12]) == ("not derivable", "not decided:")


def test_what_a_function_rests_on_is_told(paper: Paper) -> None:
    def twice(x: Any) -> Any:
        """Twice."""
        return 2 * x

    given = {"x": derived(3, rests_on=["the words of the matrix = reference"])}
    entry = paper.figure("twice", "6", "1", where="", by=twice, given=given).evaluate()
    assert (entry["verdict"], entry["assumed"]) == ("confirmed", ["the words of the matrix = reference"])
    assert entry["inputs"] == ["x = 3 [D], resting on the words of the matrix = reference [A]"]
    assert (
        paper.figure("formula", "5", "s", where="", by="4*T + 1*T").evaluate()["inputs"][-1] == "4 in the relation [D]"
    )


def test_a_function_may_be_the_relation(paper: Paper) -> None:
    def squared(x: Any) -> Any:
        """The square, of a table elsewhere."""
        return x * x

    given = {"x": printed("1.4")}
    figure = paper.figure("square", "2", "1", where="text", by=squared, given=given)
    assert (figure.judged.verdict, figure.how) == ("confirmed", "The square, of a table elsewhere.")
    assert judged(paper, "2.00", "1", by=squared, given=given).verdict == "rounding"
    with pytest.raises(AuditError, match="asks for x"):
        judged(paper, "2.00", "1", by=squared)
    with pytest.raises(AuditError, match=r"0\.1 is not exact"):
        judged(paper, "2.00", "1", by=lambda: 0.1)


def test_an_enclosure_may_be_the_value(paper: Paper) -> None:
    assert judged(paper, "3.14", "1", by=lambda: Span(Fraction("3.141"), Fraction("3.142"))).verdict == "confirmed"
    assert judged(paper, "3.14", "1", by=lambda: Span(3, 4)).verdict == "not derivable"


def test_division_by_zero_is_the_authors(paper: Paper) -> None:
    figure = paper.figure("zero", "1", "1", where="", by="divisor/(stages - 15)")
    with pytest.raises(AuditError, match=r"clock\.zero: .*cannot be evaluated"):
        figure.evaluate()


@pytest.mark.parametrize(
    ("declare", "why"),
    [
        (lambda p: p.symbol("f", "Hz"), "declared twice"),
        (lambda p: p.symbol("g", "furlong"), "there is no 'furlong'"),
        (lambda p: p.figure("a", "1 s", "s", where="", by="T"), "no printed number"),
        (lambda p: p.figure("a", "1", "s", where="", by="T +"), "missing at the end"),
        (lambda p: p.figure("a", "1", "s", where="", by="X").judged, "there is no symbol 'X'"),
        (lambda p: p.figure("a", "1", "s", where="", by="T", given={"tee": derived(1)}).judged, "no symbol 'tee'"),
        (
            lambda p: p.figure("a", "1", "s", where="", by="T", given={"T": "f"}).judged,
            "is in 's', but its definition f is",
        ),
        (lambda p: p.equation("a", "T = divisor/f", where="", when=("X > 1",)).judged, "there is no symbol 'X'"),
        (lambda p: p.equation("a", "T = divisor/f", where="", given={"f": "X/T"}).judged, "there is no symbol 'X'"),
        (lambda p: p.equation("a", "T = divisor/f", where="", least="X").judged, "there is no symbol 'X'"),
        (lambda p: p.wording("a", "words", where="", says="T rises with f", when=("X > 1",)).judged, "no symbol 'X'"),
        (lambda p: p.statement("a", "words", where="", holds="T > 1", given={"T": "f"}).judged, "its definition f is"),
        (lambda p: p.statement("a", "words", where="", holds="T"), "states nothing"),
        (lambda p: p.equation("a", "T", where=""), "has one side"),
        (lambda p: p.wording("a", "words", where="", says="T grows"), "cannot be read"),
        (lambda p: assumed("3", "0", "2"), "does not lie in its range"),
        (lambda p: derived("3", "2"), "both ends"),
    ],
)
def test_a_wrong_declaration_is_refused(paper: Paper, declare: Any, why: str) -> None:
    with pytest.raises(AuditError, match=why):
        declare(paper)


def test_a_circle_of_definitions_is_refused(paper: Paper) -> None:
    paper.symbol("a", "1", by="b")
    paper.symbol("b", "1", by="a")
    with pytest.raises(AuditError, match="run in a circle"):
        judged(paper, "1", "1", by="a")


def test_two_lines_may_not_share_an_id(paper: Paper) -> None:
    paper.figure("a", "1", "s", where="", by="T")
    with pytest.raises(AuditError, match="declared twice"):
        paper.figure("a", "2", "s", where="", by="T")

"""Rate statements: what they write, when a target is met, and when they refuse to answer."""

import json
from fractions import Fraction
from math import inf, nextafter

import pytest

from safety.rates.claims import Rate, Route, at_least, at_most, declared, printed, rate
from safety.rates.enclosure import Enclosure
from safety.rates.exceptions import DeclarationError, NotExact, NumericsFailed, RoutesDisagree, UnitError
from safety.rates.units import quantity

THIRD = Fraction(1, 3)


def declare(name: str, *results: object, **more: object) -> Rate:
    routes: dict[str, Route] = {f"route {i}": lambda result=result: result for i, result in enumerate(results)}  # type: ignore[misc]
    fields = {"quantity": "a time", "unit": "h", "source": "here [D]", **more}
    return rate(id=f"test.{name}", routes=routes, **fields)  # type: ignore[arg-type]


def test_the_entry_has_the_keys_of_the_results_document() -> None:
    repair = quantity("24 h", "A", "exchange of a tray")
    entry = declare(
        "keys", THIRD, THIRD, target=at_least("0.3 h"), inputs={"repair": repair, "channel": quantity("1e-4 /h", "P")}
    ).evaluate()
    assert entry == {
        "id": "test.keys",
        "quantity": "a time",
        "value": 1 / 3,
        "low": 1 / 3,
        "high": nextafter(1 / 3, 1),
        "unit": "h",
        "method": "route 0",
        "source": "here [D]",
        "target": "at least 0.3 h",
        "met": True,
        "exact": "1/3",
        "agreed_by": ["route 0", "route 1"],
        "assumed": ["repair = 24 h: exchange of a tray"],
    }
    assert json.loads(json.dumps(entry)) == entry


def test_infinity_is_a_text_and_has_no_fraction() -> None:
    entry = declare("infinite", inf, Enclosure.exactly(inf), target=at_least("1 h")).evaluate()
    assert (entry["value"], entry["low"], entry["high"], entry["met"], "exact" in entry) == (
        "inf",
        "inf",
        "inf",
        True,
        False,
    )


def test_the_narrowest_route_gives_the_figure() -> None:
    around = Enclosure(THIRD - Fraction(1, 10**9), THIRD + Fraction(1, 10**9))
    assert declare("narrow", around, THIRD).evaluate()["method"] == "route 1"
    entry = declare("wide", around, around).evaluate()
    assert entry["low"] < entry["value"] < entry["high"] and "exact" not in entry


@pytest.mark.parametrize("other", [THIRD + Fraction(1, 10**30), inf, Enclosure(Fraction(1, 2), Fraction(1, 2))])
def test_routes_that_differ_stop_with_an_exit_code_of_their_own(other: object) -> None:
    with pytest.raises(RoutesDisagree, match=r"'route 0' gives 0\.333.*'route 1' gives") as caught:
        declare("differ", THIRD, other).evaluate()
    assert caught.value.exit_code == 6


def test_vague_and_unbounded_answers_are_no_evidence() -> None:
    with pytest.raises(NumericsFailed, match="route 1"):
        declare("vague", THIRD, Enclosure(Fraction(0), Fraction(1))).evaluate()
    with pytest.raises(NotExact, match="float"):
        declare("double", THIRD, 1 / 3).evaluate()


def test_one_route_another_unit_or_a_taken_id_is_refused() -> None:
    with pytest.raises(DeclarationError, match="two"):
        declare("lonely", THIRD)
    with pytest.raises(DeclarationError, match="at most 1e-9 /h"):
        declare("unit", THIRD, THIRD, target=at_most("1e-9 /h"))
    with pytest.raises(DeclarationError, match="FIT"):
        declare("fit", THIRD, THIRD, unit="FIT")
    first = declare("again", THIRD, THIRD)
    assert declare("again", THIRD, THIRD) in declared() and first not in declared()
    with pytest.raises(DeclarationError, match=r"declared twice.*test_claims"):
        rate(id="test.again", quantity="", unit="h", source="", routes={"a": lambda: THIRD, "b": lambda: THIRD})


@pytest.mark.parametrize(
    ("text", "digits", "low", "high"),
    [
        ("36 000 h", 2, 35_500, 36_500),
        ("36 000 h", 5, Fraction("35999.5"), Fraction("36000.5")),
        ("30 000 h", 1, 25_000, 35_000),
        ("2.77778e-5 /h", None, Fraction("2.777775e-5"), Fraction("2.777785e-5")),
        ("2 d", None, 36, 60),
        ("90.0 %", None, "0.8995", "0.9005"),
        ("1000 h", 1, 500, 1500),
        ("0.1 /h", None, "0.05", "0.15"),
    ],
)
def test_a_printed_figure_covers_what_rounds_to_it(
    text: str, digits: int | None, low: int | str, high: int | str
) -> None:
    target = printed(text, digits)
    assert (target.low, target.high) == (Fraction(low), Fraction(high))


def test_met_is_open_when_the_figure_lies_across_an_end() -> None:
    bound = at_most("1e-9 /h")
    ends = [Fraction(n, 10**10) for n in (1, 10, 11, 20)]
    assert [bound.met(ends[0], ends[1]), bound.met(ends[0], ends[2]), bound.met(ends[2], ends[3])] == [
        True,
        None,
        False,
    ]
    assert printed("36 000 h", digits=2).met(Fraction(35_499), Fraction(35_499)) is False


def test_a_printed_figure_must_show_its_precision() -> None:
    for text in ("36 000 h", "1/3 /h"):
        with pytest.raises(DeclarationError, match="digits="):
            printed(text)
    with pytest.raises(DeclarationError, match="at_most"):
        printed("0 /h", digits=1)
    with pytest.raises(UnitError):
        printed("about 3")

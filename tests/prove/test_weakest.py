"""The weakest safe parameter: found exactly, never claimed across a hole, and honest where it stays open."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import msgspec
import pytest

from safety import PROVED, Bit, Model, ModelError, Real, Scenario, Seen, UInt, implies, parameter, power_up, select
from safety import U4 as Small
from safety.prove import weakest as weak
from safety.prove.outcome import Limits
from safety.prove.weakest import ABOVE, BELOW, Synthesis, weakest, weakest_of
from safety.prove.weakest_found import Found
from safety.prove.weakest_search import find
from safety.report.schema import Document
from safety.report.standing import standing
from tests.prove.small import asked

QUICK = Limits(timeout=10, synthesis=0, simulation=1, portfolio=0)


class Tank(Model, event="tick"):
    """Fills while `fill`, and empties at once at the limit."""

    level: Small = power_up(0)
    limit: Small = parameter(5, unit="litre", within=(1, 12), source="[A]")

    def step(self, fill: Bit) -> tuple[Tank, UInt]:
        full = self.level >= self.limit
        return Tank(level=select(full, 0, select(fill, (self.level + 1).low(4), self.level))), self.level


def last() -> Synthesis:
    return weak.declared()[-1]


def low(s: Seen) -> Bit:
    """The tank holds seven at most."""
    return s.level <= 7


def within_limit(s: Seen) -> Bit:
    return s.level <= s.limit


def look(formula: Any = low, **more: Any) -> Found:
    usual: dict[str, Any] = {"safe": BELOW, "within": (1, 12), "id": "tank.limit", "lemmas": [within_limit]}
    weakest(Tank, "limit", **(usual | more))(formula)
    return find(last(), QUICK)


@pytest.mark.parametrize("lemmas", [[within_limit], []])
@pytest.mark.parametrize("scenarios", [[], [Scenario(20, {"fill": True})]])
def test_the_greatest_safe_limit_is_exact(lemmas: list[Any], scenarios: list[Scenario]) -> None:
    found = look(lemmas=lemmas, scenarios=scenarios)
    assert (found.safe_from, found.refuted_at, found.exact, found.settled) == (7, 8, True, True)
    assert found.proof.agreed_by == ["z3", "cvc5"]
    assert found.run.counterexample["level"][-1] == 8
    assert standing("syntheses", found.to_json()).code == 0


def test_an_end_of_the_range_may_be_safe() -> None:
    found = look(within=(1, 6))
    assert (found.safe_from, found.refuted_at, found.everywhere, found.exact) == (6, None, True, True)


def test_that_nothing_is_safe_is_said() -> None:
    found = look(within=(9, 12))
    assert (found.safe_from, found.refuted_at) == (None, 9)
    assert standing("syntheses", found.to_json()).code == 1


def test_without_a_run_it_stays_open() -> None:
    found = look(scenarios=[Scenario(3, {"fill": True})])
    assert (found.safe_from, found.refuted_at, found.exact, found.settled) == (7, None, False, False)
    assert standing("syntheses", found.to_json()).code == 4


def test_a_wrong_lemma_proves_nothing() -> None:
    def never_full(s: Seen) -> Bit:
        return s.level <= 3

    found = look(lemmas=[never_full])
    assert (found.safe_from, standing("syntheses", found.to_json()).code) == (3, 4)


def test_a_gap_wider_than_asked_is_weaker_than_asked() -> None:
    found = look(lemmas=[within_limit], scenarios=[Scenario(20, {"fill": lambda k: k < 10})], gap=1)
    assert (found.safe_from, found.refuted_at) == (7, 8)
    wide = replace(found, refuted_at=10)
    assert (wide.exact, wide.settled, standing("syntheses", wide.to_json()).code) == (False, False, 4)


def holes(n: int) -> Any:
    """The counter never shows this number."""
    return asked(lambda s: implies(s.n == n, s.n != 5), id="test.holes")


def test_values_behind_a_hole_are_not_called_safe() -> None:
    weakest_of("n", safe=ABOVE, within=(1, 9), id="test.holes")(holes)
    found = find(last(), QUICK)
    assert (found.safe_from, found.refuted_at, found.exact) == (6, 5, True)


def test_a_family_that_covers_is_proved_once() -> None:
    def late(n: int) -> Any:
        """While the counter is kept down it is never on."""
        stops = Scenario(9, {"go": lambda k: k < 3})
        return asked(lambda s: ~s.passed, id="test.late", given=lambda s: s.n <= n, scenario=stops)

    weakest_of("n", safe=BELOW, within=(0, 9), covers=True, id="test.late")(late)
    found = find(last(), QUICK)
    assert (found.safe_from, found.refuted_at, found.exact) == (2, 3, True)


def other_given(n: int) -> Any:
    """What is given does not grow with the value."""
    return asked(lambda s: s.n <= 9, id="test.cover", given=lambda s: s.n == n, anywhere=True)


def other_start(n: int) -> Any:
    """Where it starts does not grow with the value."""
    return asked(lambda s: s.n <= 9, id="test.cover", given=lambda s: ~s.go, start=lambda s: s.n == n, anywhere=True)


@pytest.mark.parametrize(
    ("family", "within", "words"),
    [
        (other_given, (0, 2), "the claim of 0 does not cover that of 1: what is given differs"),
        (other_start, (4, 9), "does not cover that of 5: where it starts differs"),
        (holes, (6, 9), "does not cover that of 7: model or sentence differs"),
    ],
)
def test_a_family_that_does_not_cover_is_refused(family: Any, within: tuple[int, int], words: str) -> None:
    weakest_of("n", safe=ABOVE, within=within, covers=True, id="test.cover")(family)
    with pytest.raises(ModelError, match=words):
        find(last(), QUICK)


def never_above(n: int) -> Any:
    """Below 4 no run keeps what is given."""
    return asked(
        lambda s: s.n <= 15, id="test.empty", given=lambda s: s.n.int() <= n - 4, anywhere=True, lemmas=(wide,)
    )


def never_high(n: int) -> Any:
    """Below 4 the premise is never met."""
    return asked(lambda s: implies(s.n >= 4, s.n <= 15), id="test.empty", given=lambda s: s.n <= n, lemmas=(wide,),
                 anywhere=True)  # fmt: skip


def wide(s: Seen) -> Bit:
    return s.n <= 15


@pytest.mark.parametrize("family", [never_above, never_high])
def test_a_claim_that_says_nothing_is_not_covered_by_one_that_does(family: Any) -> None:
    weakest_of("n", safe=BELOW, within=(0, 9), covers=True, id="test.empty")(family)
    with pytest.raises(ModelError, match=r"the claim of [0-3] says nothing, so it is not shown to be safe"):
        find(last(), QUICK)
    weakest_of("n", safe=BELOW, within=(4, 9), covers=True, id="test.empty")(family)
    assert find(last(), QUICK).everywhere


def test_too_many_values_to_be_proved_one_by_one_are_refused() -> None:
    with pytest.raises(ModelError, match="each of these values is looked at: shorten the range"):
        weakest_of("n", safe=ABOVE, within=(1, 5000), id="test.holes")(holes)


def other_type(n: int) -> Any:
    """Makes no claim."""
    return f"claim of {n}"


@pytest.mark.parametrize(
    ("family", "within", "words"),
    [
        (other_type, (1, 5), "test.bad makes 'claim of 1' of 1; return a Claim"),
        (lambda n: [][n], (1, 5), "test.bad makes no claim of 1: IndexError: list index out of range"),
        (other_given, (1.5, 4.5), r"test.bad: within=\(1.5, 4.5\); its two ends are whole numbers"),
    ],
)
def test_a_family_that_makes_no_claims_is_refused(family: Any, within: Any, words: str) -> None:
    with pytest.raises(ModelError, match=words):
        weakest_of("n", safe=BELOW, within=within, id="test.bad")(family)


def small(s: Seen) -> Bit:
    """The limit is six at most."""
    return s.limit <= 6


def not_nine(s: Seen) -> Bit:
    """The limit is not nine."""
    return s.limit != 9


def holds_any(s: Seen) -> Bit:
    """The tank holds twelve at most."""
    return s.level <= 12


@pytest.mark.parametrize(
    ("given", "formula", "safe", "missing", "lemmas"),
    [
        (small, low, BELOW, 12, [within_limit]),
        (small, low, BELOW, 12, []),
        (small, holds_any, ABOVE, 12, [within_limit]),
        (not_nine, holds_any, ABOVE, 9, [within_limit]),
        (not_nine, holds_any, BELOW, 9, [within_limit]),
    ],
)
def test_no_value_that_is_left_out_is_called_safe(
    given: Any, formula: Any, safe: str, missing: int, lemmas: list[Any]
) -> None:
    with pytest.raises(ModelError, match=f"what is given leaves out limit {missing}, so nothing is proved of it"):
        look(formula, given=given, safe=safe, lemmas=lemmas)


def test_where_the_safe_end_is_left_out_nothing_is_proved() -> None:
    found = look(holds_any, given=small, safe=ABOVE, lemmas=[])
    assert (found.safe_from, found.refuted_at) == (None, None)
    assert "no run starts" in found.why


def as_full(s: Seen) -> Bit:
    """It starts full or one litre above."""
    return (s.level == s.limit) | (s.level == s.limit + 1)


def test_each_value_may_be_possible_in_a_way_of_its_own() -> None:
    found = look(holds_any, start=as_full, given=lambda s: s.level <= 12, anywhere=True, lemmas=[])
    assert found.everywhere


def test_an_entry_has_the_shape_of_the_results_document() -> None:
    entry = look().to_json()
    msgspec.convert({"schema": "rightside/1", "syntheses": [entry]}, Document)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"within": (4, 4)}, "give two different values, the lower one first"),
        ({"safe": "left"}, "safe='left'; it is ABOVE or BELOW"),
        ({"gap": 0}, "a whole number from 1 up"),
        ({"gap": Fraction(1, 2)}, "a whole number from 1 up"),
        ({"gap": "1"}, "a whole number from 1 up"),
        ({"within": (1.5, 7.5)}, "its two ends are whole numbers"),
        ({"within": ("1", "7")}, "its two ends are whole numbers"),
        ({"within": (False, 7)}, "its two ends are whole numbers"),
        ({"within": 7}, "its two ends are whole numbers"),
        ({"within": (1, 40)}, r"within=\(1, 40\), but limit lies in 1..12 litre"),
        ({"within": (-3, 12)}, r"within=\(-3, 12\), but limit lies in 1..12 litre"),
        ({"settings": {"limit": 3}}, "limit = 3 is set, but it is left open here"),
        ({"settings": {"limit": 99}}, "limit = 99 is set, but it is left open here"),
        ({"formula": lambda s: s.level <= 7}, "tank.limit says nothing: give it a docstring"),
    ],
)
def test_a_declaration_that_cannot_be_used_is_refused(more: dict[str, Any], words: str) -> None:
    with pytest.raises(ModelError, match=words):
        look(more.pop("formula", low), **more)


def test_a_parameter_that_is_none_is_refused() -> None:
    weakest(Tank, "limt", safe=BELOW, within=(1, 12), id="tank.limit")(low)
    with pytest.raises(ModelError, match="did you mean limit"):
        find(last(), QUICK)


@pytest.mark.parametrize("value", [3, 99])
def test_what_is_left_open_or_held_cannot_be_set(value: int) -> None:
    weakest(Tank, "limit", safe=BELOW, within=(1, 12), id="tank.limit", lemmas=[within_limit])(low)
    with pytest.raises(ModelError, match=f"tank.limit: limit = {value} is set, but it is left open here"):
        find(last(), QUICK, settings={"limit": value})

    def held(n: int) -> Any:
        """The tank never holds more than its limit."""
        return asked(lambda s: s.level <= n, Tank, id="test.held", settings={"limit": n})

    weakest_of("limit", safe=ABOVE, within=(4, 6), id="test.held")(held)
    assert find(last(), QUICK).everywhere
    with pytest.raises(ModelError, match=f"test.held: limit = {value} is set, but it is held here"):
        find(last(), QUICK, settings={"limit": value})


def test_the_verdict_comes_from_the_one_who_is_asked() -> None:
    """A cache that knows nothing better is asked for each proof; its refusal leaves nothing safe."""
    weakest(Tank, "limit", safe=BELOW, within=(1, 12), id="tank.limit", lemmas=[within_limit])(low)

    def refuses(problem: Any, limits: Limits) -> Any:
        from safety.prove.outcome import Outcome

        return Outcome(problem.claim, "undecided", problem, why="not today")

    found = find(last(), QUICK, refuses)
    assert (found.safe_from, found.refuted_at) == (None, None)
    assert standing("syntheses", found.to_json()).code == 3
    assert PROVED not in str(found.proof)


class Scales(Model, event="tick"):
    """Says whether what is put on it is above a real limit."""

    limit: Real = parameter(5, unit="kg", within=(1, 12), source="[A]")

    def step(self, weight: Real) -> tuple[Scales, Bit]:
        return Scales(), weight > self.limit


def test_a_real_parameter_is_refused_with_what_to_write() -> None:
    @weakest(Scales, "limit", safe=ABOVE, within=(1, 12), id="scales.limit")
    def light(s: Seen) -> Bit:
        """Nothing is too heavy."""
        return ~s.out

    with pytest.raises(ModelError, match="limit is a real; weakest goes through whole numbers, so use"):
        find(last(), QUICK)

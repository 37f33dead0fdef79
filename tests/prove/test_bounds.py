"""Error bounds: the corners where a bound goes wrong, and the routes against each other."""

from __future__ import annotations

import json
from fractions import Fraction as F

import pytest

from safety import ModelError
from safety.prove.bounds import (
    Bound,
    Limits,
    between,
    bracket,
    check,
    magnitude,
    reals,
)
from safety.prove.bounds.points import Point
from safety.prove.bounds.routes import BOXES, NLSAT, Question
from safety.prove.claims import PROVED, REFUTED, UNDECIDED, VACUOUS
from safety.prove.solve import SAT, UNKNOWN, UNSAT, Disagreement
from safety.terms import Bit, Real, TermError, UInt, implies, real, select
from safety.terms.graph import uint, variable
from safety.terms.values import all_of
from tests.prove.bounded import bound, narrow

x, y, z = reals("x y z")
# --- where a bound can go wrong ---------------------------------------------------------------------------------------


def test_nothing_given_can_happen() -> None:
    nothing = bound(x, between(0, x, 1), x > 2)
    assert check(nothing, 5).verdict == VACUOUS and bracket(nothing).verdict == VACUOUS
    assert check(bound(x, between(0, x, 1), x * x == 2), 5).verdict == VACUOUS


def test_a_bound_of_zero_may_only_be_approached() -> None:
    found = bracket(bound(0 - x, x > 0, x < 5))
    assert (found.verdict, found.high, found.why) == (PROVED, 0, "approached, but not reached")
    assert found.low is not None and -F(1, 1000) < found.low < 0


def test_an_unbounded_quantity_has_no_bracket() -> None:
    found = bracket(bound(x, x >= 0))
    assert found.verdict == UNDECIDED and "no upper bound" in found.why and found.high is None
    assert check(bound(x, x >= 0), 10**6).verdict == REFUTED


def test_an_unbounded_variable_does_not_matter_where_the_quantity_is_bounded() -> None:
    assert check(bound(0 - x * x, x * y == 1), 0, strict=True).verdict == PROVED


def test_a_divisor_that_can_be_zero_is_named() -> None:
    for per in (x, x * x):
        with pytest.raises(ModelError, match=r"not above zero at \{'x': '0'\}"):
            check(bound(x, between(0, x, 1), per=per), 5)
    assert check(bound(x, between(F(1, 10), x, 1), per=x * x), 10).verdict == PROVED


@pytest.mark.parametrize(
    ("quantity", "given", "most"),
    [
        (x * y + x, (between(0, x, 2), between(-1, y, 3)), F(8)),  # at a corner
        (x * (1 - x), (between(0, x, 1),), F(1, 4)),  # inside
        (0 - x * x, (between(-5, x, 5),), F(0)),
        (x * y, (between(0, x, 2), between(0, y, 2), x * x + y * y <= 4), F(2)),  # where a constraint ends
        (select(x < 1, x, 2 - x), (between(0, x, 3),), F(1)),  # at a kink
    ],
)
def test_strict_and_not_strict_at_the_bound_itself(quantity: Real, given: tuple[Bit, ...], most: F) -> None:
    just = bound(quantity, *given)
    below = most - F(1, 10**6)
    assert check(just, most).verdict == PROVED
    assert check(just, below).verdict == REFUTED
    assert check(just, most + F(1, 10**6), strict=True).verdict == PROVED
    found = bracket(just)
    assert found.verdict == PROVED and found.low is not None and found.high is not None
    assert found.low <= most <= found.high


def test_a_bound_that_is_reached_is_refuted_when_strict() -> None:
    found = check(bound(x * (1 - x), between(0, x, 1)), F(1, 4), strict=True)
    assert found.verdict == REFUTED and found.witness == {x: (F(1, 2), F(1, 2))}


def test_a_root_is_a_witness_between_fractions() -> None:
    found = bracket(bound(x, between(0, x, 9), x * x == 2))
    assert found.verdict == PROVED and found.witness is not None and found.low is not None
    low, high = found.witness[x]
    assert low < high and low * low < 2 < high * high and found.low == low


@pytest.mark.parametrize("scale", [F(10**30), F(1, 10**30)])
def test_scale_does_not_matter(scale: F) -> None:
    area = bound(x * y * scale, between(0, x, 1), between(0, y, 7), x + y <= 5)
    assert narrow(bracket(area), 4 * scale)
    assert check(area, 4 * scale).verdict == PROVED
    assert check(area, F(399, 100) * scale).verdict == REFUTED


def test_connectives_fall_into_cases() -> None:
    either = bound(x, between(0, x, 9), implies(y > 0, x < 2), (y > 0) ^ (x > 5), between(-1, y, 1))
    found = bracket(either)
    assert found.high == 9 and check(Bound("b", "s", x, (*either.given, y > 0)), 2, strict=True).verdict == PROVED


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda: bound(1, x > 0), "it is a Real"),
        (lambda: bound(x, True), "each is a Bit"),
        (lambda: bound(real(1)), "has no variable"),
        (lambda: bound(x, whole=(x + 1,)), "name variables"),
        (lambda: between(2, x, 1), "holds nowhere"),
        (lambda: reals("a b a"), "share a name"),
        (lambda: bracket(bound(x, between(0, x, 1)), F(0)), "width above 0"),
    ],
)
def test_a_wrong_statement_is_refused(wrong, message: str) -> None:
    with pytest.raises(ModelError, match=message):
        wrong()


def test_words_are_no_reals() -> None:
    word = variable("w", uint(8))
    assert isinstance(word, UInt)
    with pytest.raises(TermError, match="w is a u8: bounds range over reals"):
        check(bound(word.real()), 3)


def test_where_one_route_has_no_answer_it_is_said() -> None:
    circle = bound(x + y, x * x + y * y == 1, magnitude(x) + magnitude(y) + magnitude(z) > 0)
    found = check(circle, 2, limits=Limits(boxes=1))
    assert found.verdict == PROVED and BOXES not in found.agreed_by
    assert len(found.agreed_by) == 2 or "one route only" in found.why


def test_routes_that_contradict_each_other_are_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("safety.prove.bounds.boxes.first_box", lambda case, size: (None, None))  # nothing is possible
    monkeypatch.setattr(Question, "_near", lambda self, encoder, model: None)
    with pytest.raises(Disagreement, match="exact boxes: the formula cannot hold; but z3 nlsat"):
        check(bound(x, between(0, x, 1)), F(1, 2))


def test_a_point_that_does_not_replay_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("safety.prove.bounds.routes.holds", lambda formula, values: False)
    with pytest.raises(Disagreement, match="does not meet the formula"):
        check(bound(x, between(0, x, 1)), F(1, 2))


def test_results_are_plain() -> None:
    area = bound(x * y, between(0, x, 1), between(0, y, 1))
    proved, refuted = check(area, 1).to_json(), check(area, F(1, 3)).to_json(expect=REFUTED)
    assert (proved["verdict"], proved["agreed_by"], proved["certificate"]) == (
        PROVED,
        [NLSAT, BOXES],
        {"kind": "real", "routes": [NLSAT, BOXES]},
    )
    assert refuted["as_expected"] and refuted["counterexample"]["replayed"] and refuted["limit"]["exact"] == "1/3"
    whole = bracket(area).to_json()
    assert whole["bracket"]["high"]["exact"] == "1" and whole["bracket"]["relative_width"] == 0
    assert json.loads(json.dumps([proved, refuted, whole])) == [proved, refuted, whole]


# --- the routes against each other ------------------------------------------------------------------------------------


def chance_formula(seed: int) -> Bit:
    """A formula over x, y and z between small numbers: sums, products, selects, every relation."""
    from random import Random

    chance = Random(seed)

    def number() -> F:
        return F(chance.choice([-3, -2, -1, 1, 2, 3]), chance.choice([1, 1, 2]))

    def term(depth: int) -> Real:
        if depth == 0:
            return chance.choice([x, y, z, x, y, real(number())])
        a, b = term(depth - 1), term(depth - 1)
        chosen = select(a < b, term(depth - 1), a) if chance.random() < 0.3 else a * number() + number()
        return chance.choice([a + b, a - b, a * b, a * b, chosen])

    def relation() -> Bit:
        a, b = term(chance.choice([1, 2])), term(1)
        return chance.choice([a == b, a <= b, a < b, ~(a <= b), implies(a <= b, term(1) < term(1))])

    ranges = [between(chance.choice([-2, -1, 0, 1]), v, chance.choice([1, 2, 3])) for v in (x, y, z)]
    given = [relation() for _ in range(chance.randrange(4))]
    return all_of(*ranges, *given, term(2) > term(1) + chance.randrange(4))


FORMULAS = [
    between(-2, x, 2) & (x * x < 1),
    between(-2, x, 2) & (x * x * x < -7),
    between(0, x, 2) & between(0, y, 2) & (x * y > 3) & (x + y < F(7, 2)),
    between(0, x, 2) & between(0, y, 2) & (x * y > 3) & (x + y < 3),
    between(-1, x, 1) & between(-1, y, 1) & (x * x == y) & (x > y),
    between(0, x, 9) & between(1, y, 2) & (x * y == 3) & (x > 2),
    *(chance_formula(seed) for seed in range(60)),
]


def both(formula: Bit) -> tuple[str, str]:
    question = Question(formula, (), Limits(boxes=100))
    return question.nlsat().answer, question.boxes().answer


def test_the_routes_agree_on_chance_formulas() -> None:
    answers = [both(formula) for formula in FORMULAS]
    assert [pair for pair in answers if UNKNOWN not in pair and pair[0] != pair[1]] == []
    assert sum(UNKNOWN in pair for pair in answers) <= 6
    assert min(sum(pair == (answer, answer) for pair in answers) for answer in (SAT, UNSAT)) >= 15


@pytest.mark.parametrize(
    ("where", "planted"),
    [
        ("narrow._reached", lambda relation, slope, value: (-value[1] / slope[1], -value[0] / slope[1])),
        ("points.certain", lambda atom, box: True),
        ("boxes.impossible", lambda atom, box: atom.polynomial.over(box)[0] < 0),
        ("boxes.reduced", lambda case, box, kept: []),
        ("boxes.settle", lambda case, guess, fixed, whole: Point(tuple((g, g) for g in guess))),
        ("polynomials.raised", lambda interval, power: (interval[0] ** power, interval[1] ** power)),
    ],
)
def test_a_bug_planted_in_the_boxes_is_found(where: str, planted, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"safety.prove.bounds.{where}", planted)

    def wrong(formula: Bit) -> bool:
        try:
            one, other = both(formula)
        except Disagreement:
            return True
        return UNKNOWN not in (one, other) and one != other

    assert any(wrong(formula) for formula in FORMULAS)

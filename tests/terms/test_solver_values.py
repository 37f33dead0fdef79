"""`Encoder.value` gives exact Python values of a solver's model, for every sort, solver and arithmetic."""

from fractions import Fraction
from typing import Any

import pytest

from safety.terms import TermError
from safety.terms.graph import BIT, REAL, Sort, integer, uint
from safety.terms.smt import SOLVERS, Encoder
from tests.terms.agreement import constant_of, is_exact
from tests.terms.graphs import RANGES, WIDTHS, edges

SORTS = [BIT, *map(uint, WIDTHS), *(integer(low, high) for low, high in RANGES)]

both_solvers = pytest.mark.parametrize("solver", SOLVERS)
both_arithmetics = pytest.mark.parametrize("integers", [True, False], ids=["integers", "vectors"])


def value_of(encoder: Encoder, name: str, sort: Sort, value: Any) -> Any:
    x = encoder.variable(name, sort)
    query = encoder.k.Solver()
    query.add(x == constant_of(encoder.k, value, sort, encoder.integers), *encoder.ranges)
    assert str(query.check()) == "sat"
    return encoder.value(query.model(), x, sort)


@both_solvers
@both_arithmetics
@pytest.mark.parametrize("sort", SORTS, ids=str)
def test_words_integers_and_bits_come_back(solver: str, integers: bool, sort: Sort) -> None:
    for value in edges(sort):
        found = value_of(Encoder(solver, integers), "x", sort, value)
        assert found == value
        assert is_exact(sort, found)


@both_solvers
@pytest.mark.parametrize("value", [0, 7, -7, Fraction(-1, 3), Fraction(10**40 + 1, 3), Fraction(1, 10**40)])
def test_rationals_come_back(solver: str, value: Fraction | int) -> None:
    found = value_of(Encoder(solver, integers=True), "x", REAL, value)
    assert found == value
    assert is_exact(REAL, found)


@both_solvers
def test_an_irrational_value_is_an_error_that_says_so(solver: str) -> None:
    encoder = Encoder(solver, integers=True)
    x = encoder.variable("x", REAL)
    query = encoder.k.SolverFor("QF_NRA")
    query.add(x * x == 2, x > 0)
    assert str(query.check()) == "sat"
    with pytest.raises(TermError, match=r"^x is .*, which no fraction is; state the claim on squares"):
        encoder.value(query.model(), x, REAL)


@both_solvers
@both_arithmetics
def test_variables_that_the_solver_never_saw_have_values(solver: str, integers: bool) -> None:
    encoder = Encoder(solver, integers)
    query = encoder.k.Solver()
    query.add(encoder.variable("seen", BIT))
    query.check()
    for sort in (BIT, uint(8), uint(128)):
        name = f"unseen {sort}"
        assert sort.admits(encoder.value(query.model(), encoder.variable(name, sort), sort))


@both_solvers
def test_a_value_out_of_range_is_an_error(solver: str) -> None:
    encoder = Encoder(solver, integers=True)
    x = encoder.variable("x", uint(8))
    query = encoder.k.Solver()
    query.add(x == 300)
    assert str(query.check()) == "sat"
    with pytest.raises(TermError, match="x is 300 in the solver's answer, not a value of u8; assert the `ranges`"):
        encoder.value(query.model(), x, uint(8))


@both_solvers
@both_arithmetics
def test_a_variable_ranges_over_its_sort_and_no_more(solver: str, integers: bool) -> None:
    for sort in (uint(3), integer(-5, 2), integer(3, 3), integer(-9, -2)):
        encoder = Encoder(solver, integers)
        x = encoder.variable("x", sort)
        query = encoder.k.Solver()
        query.add(*encoder.ranges, encoder.k.BoolVal(True))
        found = []
        while str(query.check()) == "sat":
            found.append(encoder.value(query.model(), x, sort))
            query.add(x != constant_of(encoder.k, found[-1], sort, integers))
        assert sorted(found) == list(range(sort.bounds[0], sort.bounds[1] + 1))


@both_solvers
def test_ticks_share_variables_and_ranges(solver: str) -> None:
    first = Encoder(solver, integers=True)
    second = first.step_context()
    x = first.variable("x", uint(8))
    assert second.variable("x", uint(8)) is x
    assert second.ranges is first.ranges
    assert len(first.ranges) == 2
    with pytest.raises(TermError, match="two variables are named x, a u8 and a bit"):
        second.variable("x", BIT)

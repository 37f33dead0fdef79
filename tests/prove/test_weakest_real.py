"""The weakest safe value of a real variable: bracketed, never claimed across a hole or where it cannot be."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import msgspec
import pytest

from safety import ModelError
from safety.prove.bounds import Bound, between, reals
from safety.prove.outcome import Limits
from safety.prove.weakest import BELOW, weakest_real
from safety.prove.weakest_found import Found
from safety.prove.weakest_search import find
from safety.report.schema import Document
from safety.report.standing import standing

QUICK = Limits(timeout=10, synthesis=0, simulation=1, portfolio=0)


def square(limit: int = 2, gap: Fraction = Fraction(1, 1000), within: tuple[int, int] = (0, 3)) -> Found:
    (x,) = reals("x")
    bound = Bound("square", "x squared", x * x, (between(0, x, 3),))
    return find(weakest_real(bound, limit, x, safe=BELOW, within=within, gap=gap, id="test.square"), QUICK)


def test_a_real_parameter_is_bracketed() -> None:
    found = square()
    assert isinstance(found.safe_from, Fraction)
    assert isinstance(found.refuted_at, Fraction)
    assert found.safe_from**2 <= 2 < found.refuted_at**2
    assert found.settled
    assert not found.exact
    assert found.refuted_at - found.safe_from <= Fraction(1, 1000)
    assert len(found.proof.agreed_by) == 2
    entry = found.to_json()
    assert entry["safe_from"] == {"value": float(found.safe_from), "exact": str(found.safe_from)}


@pytest.mark.parametrize(("limit", "code"), [(9, 0), (-1, 1)])
def test_a_real_parameter_may_be_safe_all_over_or_nowhere(limit: int, code: int) -> None:
    assert standing("syntheses", square(limit).to_json()).code == code


def hump(left: Fraction, right: Fraction) -> Found:
    """Broken strictly between two values, with both ends of the range safe."""
    (x,) = reals("x")
    bound = Bound("hump", "hump", (x - left) * (right - x), (between(0, x, 3),))
    return find(weakest_real(bound, 0, x, safe=BELOW, within=(0, 3), gap=Fraction(1, 100), id="test.hump"), QUICK)


def test_a_hole_among_reals_is_not_passed() -> None:
    found = hump(Fraction(1), Fraction(2))
    assert found.safe_from is not None
    assert found.refuted_at is not None
    assert found.safe_from <= 1 < found.refuted_at < 2
    assert not found.everywhere


def of_real(given: Any, **more: Any) -> Found:
    x, y = reals("x y")
    bound = Bound("square", "x squared", x * x, (*given(x, y), between(0, y, 1)))
    usual: dict[str, Any] = {"safe": BELOW, "within": (0, 40), "gap": Fraction(1), "id": "test.real"}
    return find(weakest_real(bound, 1600, x, **(usual | more)), QUICK)


@pytest.mark.parametrize(
    ("given", "missing"),
    [
        (lambda x, y: [between(0, x, 5)], "40"),
        (lambda x, y: [(x <= 10) | (x >= 20)], "[0-9/]*"),
        (lambda x, y: [x <= 39 + 2 * y, x + y <= 40], "40|[0-9/]*"),
    ],
)
def test_no_real_that_is_left_out_is_called_safe(given: Any, missing: str) -> None:
    with pytest.raises(ModelError, match=f"what is given leaves out x ({missing}), so nothing is proved of it"):
        of_real(given)


def test_reals_that_are_possible_each_in_its_own_way_are_safe() -> None:
    found = of_real(lambda x, y: [x <= 10 + 30 * y, x >= 20 * y])
    assert found.everywhere


def test_reals_of_which_it_is_not_shown_that_they_are_possible_are_not_safe() -> None:
    """For each x there is one y only: no number of points serves them all."""
    found = of_real(lambda x, y: [x == 40 * y])
    assert (found.safe_from, found.proof, found.refuted_at) == (None, None, None)
    assert "proved from 40 on, but not that what is given leaves all these values possible" in found.why
    assert standing("syntheses", found.to_json()).code == 3


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"within": (0.0, 3.0)}, "its two ends are exact: whole numbers or fractions"),
        ({"gap": 0.1}, "for reals an exact one above 0"),
        ({"variable": "z"}, "test.real: z is no variable of square; name one that it reads"),
    ],
)
def test_a_real_declaration_that_cannot_be_used_is_refused(more: dict[str, Any], words: str) -> None:
    x, z = reals("x z")
    bound = Bound("square", "x squared", x * x, (between(0, x, 3),))
    usual: dict[str, Any] = {"safe": BELOW, "within": (0, 3), "gap": Fraction(1), "id": "test.real"}
    with pytest.raises(ModelError, match=words):
        weakest_real(bound, 2, z if more.pop("variable", "") else x, **(usual | more))


def test_an_entry_has_the_shape_of_the_results_document() -> None:
    msgspec.convert({"schema": "rightside/1", "syntheses": [square().to_json()]}, Document)

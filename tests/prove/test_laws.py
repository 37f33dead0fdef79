"""Laws over all reals: decided by two solvers, refuted at exact points, never empty."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from safety import PROVED, REFUTED, VACUOUS, Bit, Real, implies
from safety.commands.certify import certified_over_reals
from safety.prove import check
from safety.prove.bounds import Bound, BoundClaim, between, reals
from safety.prove.bounds.claims import _registry
from safety.prove.certificate import unlike, write_certificate
from safety.prove.laws import LawClaim, law
from safety.system import ModelError


def found(sentence: Callable[..., Bit], expect: str, **more: Any) -> tuple[dict[str, Any], LawClaim]:
    """The entry of a law declared for this test alone, and the claim."""
    before = dict(_registry)
    try:
        law(expect=expect, **more)(sentence)
        claim = next(c for name, c in _registry.items() if name not in before)
    finally:
        _registry.clear()
        _registry.update(before)
    assert isinstance(claim, LawClaim)
    return claim.evaluate(20), claim


def braking(v: Real, x: Real, b: Real, d: Real, h: Real) -> Bit:
    """Braking at b or more keeps the square of the speed below 2 b x."""
    slower, nearer = v - d * h, x - v * h + d * h * h / 2
    return implies(
        (v * v <= 2 * b * x) & (b > 0) & (d >= b) & (h >= 0) & (slower >= 0), slower * slower <= 2 * b * nearer
    )


def braking_less(v: Real, x: Real, b: Real, d: Real, h: Real) -> Bit:
    """So does braking at any rate."""
    slower, nearer = v - d * h, x - v * h + d * h * h / 2
    return implies(
        (v * v <= 2 * b * x) & (b > 0) & (d >= 0) & (h >= 0) & (slower >= 0), slower * slower <= 2 * b * nearer
    )


def test_a_law_is_proved_by_both_solvers_for_all_reals() -> None:
    entry, _ = found(braking, PROVED, requirement="R-1", source="[D] algebra", assumed=("[A] b",))
    assert (entry["verdict"], entry["as_expected"], entry["model"]) == (PROVED, True, None)
    assert entry["agreed_by"] == ["z3 nlsat", "cvc5"]
    assert entry["certificate"] == {"kind": "real", "routes": ["z3 nlsat", "cvc5"]}
    assert (entry["requirement"], entry["source"], entry["assumptions"]) == ("R-1", "[D] algebra", ["[A] b"])


def test_its_twin_is_refuted_at_an_exact_point() -> None:
    entry, claim = found(braking_less, REFUTED, twin_of=braking)
    assert (entry["verdict"], entry["role"], entry["twin_of"]) == (REFUTED, "twin", "test_laws.braking")
    values = entry["counterexample"]["values"]
    assert claim.broken_at(values)
    assert not claim.broken_at({**values, "v": "0", "d": "0"})


def test_a_root_that_no_fraction_is_refutes_too() -> None:
    def too_small(r: Real) -> Bit:
        """The root of 2 is below 1.4."""
        return implies((r * r == 2) & (r >= 0), 5 * r < 7)

    entry, claim = found(too_small, REFUTED)
    assert entry["verdict"] == REFUTED and claim.broken_at(entry["counterexample"]["values"])
    assert entry["counterexample"]["values"]["r"].startswith("[")


@pytest.mark.parametrize("twice", [False, True])
def test_a_premise_that_cannot_happen_proves_nothing(twice: bool) -> None:
    def empty(x: Real, y: Real) -> Bit:
        """Nothing."""
        inner = implies(y > x, x == 5)
        return implies((x > 1) & (y < x), inner) if twice else implies((x > 1) & (x * x < 1), x == 5)

    assert found(empty, VACUOUS)[0]["verdict"] == VACUOUS


def test_what_is_no_law_is_refused() -> None:
    def silent(x: Real) -> Bit:
        return x > 0

    def number(x: Real) -> Any:
        """A number."""
        return x + 1

    for sentence, told in ((silent, "says nothing"), (number, "a law is a Bit")):
        with pytest.raises(ModelError, match=told):
            law(expect=PROVED)(sentence)
    with pytest.raises(ModelError, match="of a law it is one of"):
        law(expect="bounded")(braking)


def test_a_law_and_a_bound_have_certificates_of_kind_real_and_a_false_one_is_rejected(tmp_path: Path) -> None:
    told: list[str] = []
    entry, claim = found(braking, PROVED)
    made = certified_over_reals(claim, entry, tmp_path, 20, told.append, told.append)
    assert made is not None and made["kind"] == "real" and made["routes"] == entry["agreed_by"]
    report = check.examine(Path(made["file"]))
    assert report["verdict"] == check.REAL and unlike(report, claim.problem()) == ""
    _, other = found(braking_less, REFUTED)
    assert unlike(report, other.problem())
    write_certificate(other.problem(), 0, tmp_path / "false.zip")
    assert check.examine(tmp_path / "false.zip")["verdict"] == check.REJECTED


def test_what_was_not_proved_and_what_has_no_limit_has_no_certificate(tmp_path: Path) -> None:
    told: list[str] = []
    entry, claim = found(braking_less, REFUTED)
    assert certified_over_reals(claim, entry, tmp_path, 20, told.append, told.append) is None and told == []
    (x,) = reals("x")
    bracketed = BoundClaim(id="b.x", expect=PROVED, bound=Bound("b.x", "x", x, (between(0, x, 1),)))
    entry = bracketed.evaluate(20)
    assert certified_over_reals(bracketed, entry, tmp_path, 20, told.append, told.append) == entry["certificate"]
    assert "no certificate" in told[-1] and list(tmp_path.iterdir()) == []

"""Bounds as claims: how they are declared, what becomes of them in the results, and the project's own ones."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from fractions import Fraction as F
from pathlib import Path
from typing import Any

import pytest

import safety.prove.bounds.claims as bounds
from safety import ModelError
from safety.prove.bounds import Bound, BoundClaim, between, claim_bound, claim_bracket, reals
from safety.prove.bounds.routes import BOXES, NLSAT
from safety.prove.claims import BOUNDED, PROVED, REFUTED, UNDECIDED, VACUOUS
from safety.report.results import validate
from safety.report.schema import SCHEMA
from safety.report.standing import standing

x, y = reals("x y")
AREA = Bound(
    "scratch.area", "Area", x * y, (between(0, x, 1), between(0, y, F(3, 2))), unit="m2", requirement="B-1",
    source="[P] table 1", assumed=("[A] the sides",),
)  # fmt: skip


@pytest.fixture(autouse=True)
def apart(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(bounds, "_registry", {})
    yield


def entry(claim: BoundClaim) -> Any:
    """The entry of a claim, once it has gone through JSON and been found to be in shape."""
    found = json.loads(json.dumps(claim.evaluate(20.0)))
    validate({"schema": SCHEMA, "claims": [found]})
    return found


def code(claim: BoundClaim) -> int:
    return standing("claims", entry(claim)).code


def test_a_proved_bound_names_both_routes_and_says_what_its_certificate_is_worth() -> None:
    found = entry(claim_bound(AREA, F(3, 2), expect=PROVED))
    told = {key: found[key] for key in ("id", "model", "requirement", "source", "statement", "role", "user_lemmas")}
    assert told == {
        "id": "scratch.area", "model": None, "requirement": "B-1", "source": "[P] table 1",
        "statement": "Area <= 1.5 m2", "role": "claim", "user_lemmas": 0,
    }  # fmt: skip
    assert (found["verdict"], found["as_expected"], found["counterexample"]) == (PROVED, True, None)
    assert found["certificate"] == {"kind": "real", "routes": [NLSAT, BOXES]} and found["agreed_by"] == [NLSAT, BOXES]
    assert found["limit"] == {"value": 1.5, "exact": "3/2", "unit": "m2"}
    assert found["assumptions"][0] == "[A] the sides"


def test_a_twin_is_refuted_at_an_exact_point_that_fractions_alone_confirm() -> None:
    kept = claim_bound(AREA, F(3, 2), expect=PROVED)
    twin = claim_bound(AREA, F(3, 2), strict=True, id="scratch.twin", expect=REFUTED, twin_of=kept)
    found = entry(twin)
    assert (found["verdict"], found["role"], found["twin_of"], found["certificate"]) == (
        REFUTED, "twin", "scratch.area", None,
    )  # fmt: skip
    point = found["counterexample"]
    assert point["values"] == {"x": "1", "y": "3/2"} and point["value"]["exact"] == "3/2" and point["replayed"]
    assert point["replay"] == "rightside replay scratch.twin"
    assert twin.broken_at(point["values"])
    assert not twin.broken_at({"x": "1", "y": "149/100"}) and not twin.broken_at({"x": "2", "y": "3/2"})
    with pytest.raises(ModelError, match="is about x, y"):
        twin.broken_at({"x": "1"})
    with pytest.raises(ModelError, match="'1/0' is no value"):
        twin.broken_at({"x": "1/0", "y": "1"})


def test_a_bracket_shows_the_value_reached_and_the_one_proved() -> None:
    found = entry(claim_bracket(Bound("b", "x, its square up to 2", x, (x * x <= 2, x >= 0), unit="m")))
    ends = found["bracket"]
    low, high = F(ends["low"]["exact"]), F(ends["high"]["exact"])
    assert found["verdict"] == PROVED and low * low < 2 < high * high and high - low < F(1, 5000)
    assert F(ends["witness"]["x"]) == low and ends["unit"] == "m"


@pytest.mark.parametrize(
    ("limit", "expect", "wanted"),
    [
        (2, PROVED, 0), (1, REFUTED, 0), (1, PROVED, 1), (2, REFUTED, 1), (2, VACUOUS, 0), (1, UNDECIDED, 1),
    ],
)  # fmt: skip
def test_a_verdict_that_is_not_the_one_expected_is_a_failure(limit: int, expect: str, wanted: int) -> None:
    claim = claim_bound(AREA, limit, expect=expect)
    assert code(claim) == wanted
    assert entry(claim)["as_expected"] == (entry(claim)["verdict"] == expect)


def test_vacuous_is_weaker_and_a_bracket_without_an_upper_end_undecided() -> None:
    nothing = Bound("scratch.nothing", "Nothing", x, (x > 1, x < 0))
    assert code(claim_bound(nothing, 1, expect=PROVED)) == 4
    assert code(claim_bracket(Bound("scratch.open", "Open", x, (x >= 0,)))) == 3


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"limit": 0.5}, "limit=0.5 is not exact"),
        ({"limit": True}, "limit=True is not exact"),
        ({"limit": 10**5000}, "greater unit"),
        ({"expect": BOUNDED}, "expect='bounded'"),
        ({"expect": "proven"}, "expect='proven'"),
        ({"twin_of": "scratch.area"}, "twin_of='scratch.area'"),
    ],
)
def test_what_cannot_be_claimed_is_refused_where_it_is_written(arguments: dict[str, Any], told: str) -> None:
    with pytest.raises(ModelError, match=told):
        claim_bound(AREA, **{"limit": 1, "expect": PROVED, **arguments})
    assert bounds.declared() == []


def test_a_bracket_is_never_refuted_and_has_a_width() -> None:
    with pytest.raises(ModelError, match="expect='refuted'"):
        claim_bracket(AREA, expect=REFUTED)
    for width in (F(0), 0.1, True):
        with pytest.raises(ModelError, match="width="):
            claim_bracket(AREA, width=width)  # type: ignore[arg-type]


def test_an_id_is_used_once_also_in_a_loop() -> None:
    for limit in (2, 3):
        if limit == 3:
            with pytest.raises(ModelError, match=r"two claims are called 'scratch.area', at .*test_bounds_claims"):
                claim_bound(AREA, limit, expect=PROVED)
        else:
            claim_bound(AREA, limit, expect=PROVED)


def test_a_file_that_is_read_again_replaces_its_own() -> None:
    source = compile("claim = claim_bound(AREA, limit, expect='proved')", "again.py", "exec")
    for limit in (2, 3):
        exec(source, {"claim_bound": claim_bound, "AREA": AREA, "limit": limit, "__name__": "again"})
    assert [(one.limit, one.module, one.line) for one in bounds.declared()] == [(F(3), "again", 1)]


def test_points_do_not_depend_on_what_a_process_was_asked_before() -> None:
    """z3's terms are numbered as they are made; the points it gives follow the numbers."""
    script = """
import sys
from proofs import ts7_accuracy
from safety.prove.bounds.claims import declared
by_id = {claim.id: claim for claim in declared()}
for name in sys.argv[1:]:
    found = by_id[f"ts7_accuracy.{name}"].evaluate(20.0)
print((found["counterexample"] or found["bracket"])["%s"])
"""
    root = Path(__file__).resolve().parents[2]
    for wanted, key, before in (
        ("error_of_limit_90_is_less", "values", ["error_of_limit_65", "worst_error"]),
        ("worst_error", "witness", ["error_of_limit_90_is_less", "error_of_limit_45"]),
    ):
        said = {
            subprocess.run(
                [sys.executable, "-c", script % key, *names],
                cwd=root, env={"PYTHONPATH": str(root)}, capture_output=True, text=True, check=True,
            ).stdout
            for names in ([wanted], [*before, wanted])
        }  # fmt: skip
        assert len(said) == 1


def test_routes_that_contradict_each_other_end_with_6(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from safety.commands.evaluate import Order, evaluate
    from safety.commands.selection import items
    from safety.project import Config, Project
    from safety.prove.bounds.routes import Question, Reply
    from safety.prove.solve import UNSAT

    monkeypatch.setattr(Question, "nlsat", lambda self: Reply(UNSAT, [NLSAT]))
    claim_bound(AREA, 1, expect=PROVED)
    project = Project(tmp_path, Config())
    (item,) = (item for item in items(project, ["claims"]) if item.is_bound)
    found = evaluate(project, item, Order(), lambda note: None).entry
    assert found is not None and (found["model"], found["verdict"]) == (None, UNDECIDED)
    validate({"schema": SCHEMA, "claims": [found]})
    assert standing("claims", found).code == 6


def test_a_proof_by_one_route_alone_is_named_among_what_is_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    from safety.prove.bounds.routes import Question, Reply
    from safety.prove.solve import UNKNOWN
    from safety.report.gaps import gaps

    def lonely(found: Any) -> list[str]:
        return [it.label for gap in gaps({"claims": [found]}) if gap.title == "One engine only" for it in gap.items]

    kept = claim_bound(AREA, 2, expect=PROVED)
    assert lonely(entry(kept)) == []
    for name in ("nlsat", "cvc5"):
        monkeypatch.setattr(Question, name, lambda self: Reply(UNKNOWN, why="no time"))
    found = entry(kept)
    assert (found["verdict"], found["certificate"]["routes"]) == (PROVED, [BOXES])
    assert lonely(found) == ["scratch.area"] and "one route only" in found["why"]

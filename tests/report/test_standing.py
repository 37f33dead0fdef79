"""The exit code for every combination of what was asked and what came out."""

import itertools
from typing import Any

import pytest

from safety.report.standing import WORST_FIRST, exit_code, standing

Entry = dict[str, Any]
TRACE = {"steps": 1, "violated_at": 0, "replayed": True, "signals": []}

#            got: proved bounded vacuous refuted undecided
CLAIMS = {
    "proved": (0, 4, 4, 1, 3),
    "bounded": (0, 0, 4, 1, 3),
    "vacuous": (0, 4, 0, 1, 3),
    "refuted": (1, 1, 1, 0, 3),
    "undecided": (0, 0, 4, 1, 0),
}
VERDICTS = ("proved", "bounded", "vacuous", "refuted", "undecided")


def claim(expect: str, verdict: str, **more: Any) -> Entry:
    trace = TRACE if verdict == "refuted" else None
    return {"id": "c", "model": "m", "expect": expect, "verdict": verdict, "counterexample": trace, **more}


def campaign(exhaustive: bool, **more: Any) -> Entry:
    classes = dict.fromkeys(("safe", "detected", "dangerous_undetected", "no_effect"), 1)
    return {"id": "k", "injections": 4, "exhaustive": exhaustive, "classes": classes, **more}


@pytest.mark.parametrize(("expect", "verdict"), list(itertools.product(CLAIMS, VERDICTS)))
def test_claim(expect: str, verdict: str) -> None:
    assert exit_code({"claims": [claim(expect, verdict)]}) == CLAIMS[expect][VERDICTS.index(verdict)]


@pytest.mark.parametrize("verdict", VERDICTS)
def test_a_verdict_that_is_expected_is_as_asked(verdict: str) -> None:
    assert standing("claims", claim(verdict, verdict)) == (0, "")


@pytest.mark.parametrize(
    ("section", "entry", "code"),
    [
        ("claims", claim("proved", "proved", disagreed_by=["cvc5: refuted"]), 6),
        ("claims", claim("refuted", "refuted", counterexample=TRACE | {"replayed": False}), 6),
        ("claims", claim("proved", "refuted", counterexample=TRACE | {"replayed": False}), 6),
        ("claims", claim("refuted", "refuted", counterexample=None), 4),
        ("claims", claim("proved", "proved", error="out of range"), 70),
        ("campaigns", campaign(True), 0),
        ("campaigns", campaign(False), 4),
        ("campaigns", campaign(False, expect={"exhaustive": False}), 0),
        ("campaigns", campaign(True, as_expected=False), 1),
        ("campaigns", campaign(True, error="kernel"), 70),
        ("campaigns", campaign(True, as_expected=False, disagreed_by=["the Python reading"]), 6),
        ("trees", {"id": "t", "probability": 0.1}, 0),
        ("trees", {"id": "t", "probability": None, "probability_low": 0.1, "probability_high": 0.2}, 0),
        ("trees", {"id": "t", "probability": None, "probability_low": 0.1}, 3),
        ("trees", {"id": "t", "probability": 0.1, "target": 0.01, "met": False}, 1),
        ("trees", {"id": "t", "probability": 0.1, "as_expected": False}, 1),
        ("rates", {"id": "r", "quantity": "q", "target": None, "met": None}, 0),
        ("rates", {"id": "r", "quantity": "q", "target": 1e-9, "met": True}, 0),
        ("rates", {"id": "r", "quantity": "q", "target": 1e-9, "met": False}, 1),
        ("rates", {"id": "r", "quantity": "q", "target": 1e-9, "met": None}, 3),
        ("rates", {"id": "r", "quantity": "q", "target": 1e-9, "met": True, "agree": False}, 6),
        ("figures", {"id": "f", "verdict": "misprint"}, 0),
        ("figures", {"id": "f", "verdict": "misprint", "as_expected": False, "note": "new"}, 1),
    ],
)
def test_entry(section: str, entry: Entry, code: int) -> None:
    judged = standing(section, entry)
    assert (judged.code, exit_code({section: [entry]})) == (code, code)
    assert bool(judged.reason) == bool(code)


ONE_OF_EACH = {
    70: claim("proved", "proved", error="x"),
    6: claim("proved", "proved", disagreed_by=["cvc5"]),
    1: claim("proved", "refuted"),
    3: claim("proved", "undecided"),
    4: claim("proved", "bounded"),
    0: claim("proved", "proved"),
}


@pytest.mark.parametrize("codes", [c for n in range(1, 7) for c in itertools.combinations(ONE_OF_EACH, n)])
def test_the_worst_wins(codes: tuple[int, ...]) -> None:
    assert exit_code({"claims": [ONE_OF_EACH[code] for code in reversed(codes)]}) == min(codes, key=WORST_FIRST.index)


def test_the_order_of_badness_is_fixed() -> None:
    assert WORST_FIRST == (70, 6, 1, 3, 4, 0)


@pytest.mark.parametrize("nothing", [{}, {"claims": [], "rates": []}, {"parameters": [{"id": "p"}]}])
def test_nothing_selected(nothing: dict[str, Any]) -> None:
    assert exit_code(nothing) == 5


def test_the_sample_misses_a_target(sample: dict[str, Any]) -> None:
    assert exit_code(sample) == 1

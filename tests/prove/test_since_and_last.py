"""`since` and `last` beside plain Python: on random runs, and as what induction is told of them."""

from __future__ import annotations

import random
from typing import Any

import pytest

from safety.model import Model, power_up
from safety.prove.claims import PROVED, REFUTED, Claim, Formula, Scenario, Seen, claim, last, once, registered, since
from safety.prove.problem import build_problem
from safety.prove.prove import prove
from safety.prove.search import scripted
from safety.system import ModelError
from safety.terms import U4, Bit, UInt, implies, select


class Watched(Model, event="step"):
    """A register that holds the word seen with the last event, and whether a condition has held since."""

    kept: U4 = power_up(5)
    held: Bit = power_up(False)

    def step(self, event: Bit, condition: Bit, word: U4) -> Watched:
        return type(self)(kept=select(event, word, self.kept), held=event | (self.held & condition))


def made(formula: Formula, **more: Any) -> Claim:
    """The formula as a claim."""
    formula.__doc__ = "A sentence."
    claim(Watched, **{"expect": PROVED, **more})(formula)
    return next(c for c in registered() if c.formula is formula)


def test_on_random_runs() -> None:
    random.seed(3)
    steps = [(random.random() < 0.2, random.random() < 0.7, random.randrange(16)) for _ in range(300)]
    held: list[bool] = []
    kept: list[int] = []
    for k in range(len(steps)):
        events = [j for j in range(k) if steps[j][0]]
        held.append(bool(events) and all(steps[j][1] for j in range(events[-1] + 1, k)))
        kept.append(steps[events[-1]][2] if events else 5)

    def formula(s: Seen) -> Bit:
        return (last(s.word, s.event, 5) == kept_now(s)) & ~(since(s.event, s.condition) ^ s.held)

    def kept_now(s: Seen) -> UInt:
        return s.kept

    inputs = {name: (lambda k, i=i: steps[k][i]) for i, name in enumerate(("event", "condition", "word"))}
    run = scripted(build_problem(made(formula)), Scenario(len(steps), inputs))
    assert all(run["claim.holds"])
    assert run["kept"] == kept and run["held"] == held  # so the model's registers are what the words say


def test_they_are_what_the_model_holds() -> None:
    def same(s: Seen) -> Bit:
        return (last(s.word, s.event, 5) == s.kept) & ~(since(s.event, s.condition) ^ s.held)

    assert prove(made(same, lemmas=[same])).verdict == PROVED


def test_the_event_itself_need_not_meet_the_condition() -> None:
    def strict(s: Seen) -> Bit:
        return implies(since(s.event, s.condition), ~once(s.event & ~s.condition))

    found = prove(made(strict, expect=REFUTED))
    assert found.verdict == REFUTED
    assert found.counterexample is not None and len(found.counterexample) == 2


def test_a_value_that_the_word_cannot_hold_is_refused() -> None:
    def wrong(s: Seen) -> Bit:
        return last(s.word, s.event, 16) == s.kept

    with pytest.raises(ModelError, match=r"last\(word, 16\): before the first step it is a value of"):
        build_problem(made(wrong))

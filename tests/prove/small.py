"""A small counter, and claims about it that are in no registry."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from safety.model import Model, point, power_up
from safety.prove.claims import INTEGERS, PROVED, Claim, Seen
from safety.prove.prove import Limits, Outcome, prove
from safety.terms import U4, Bit, implies, select


class Lamps(NamedTuple):
    on: Bit
    high: Bit


class Counter(Model, event="tick"):
    """Counts modulo 16 while asked to; `on` once it has passed 3."""

    n: U4 = power_up(0)
    passed: Bit = power_up(False)

    def step(self, go: Bit) -> tuple[Counter, Lamps]:
        n = point("n", select(go, (self.n + 1).low(4), self.n))
        passed = point("passed", self.passed | (self.n == 3))
        return Counter(n=n, passed=passed), Lamps(on=passed, high=point("high", self.n >= 8))


def asked(formula: Callable[[Seen], Bit], model: type[Model] = Counter, **changes: Any) -> Claim:
    usual: dict[str, Any] = {
        "id": "test.claim", "model": model, "formula": formula, "statement": "said", "expect": PROVED,
        "requirement": "", "source": "", "faults": None, "given": None, "start": None, "lemmas": (), "symbolic": (),
        "settings": {}, "steps": 12, "induction": 1, "arithmetic": INTEGERS, "scenario": None, "witness": None,
        "twin_of": None,
    }  # fmt: skip
    return Claim(**(usual | changes))


def verdict(formula: Callable[[Seen], Bit], model: type[Model] = Counter, **changes: Any) -> Outcome:
    return prove(asked(formula, model, **changes), Limits(20))


def with_no_search_for_proofs(formula: Callable[[Seen], Bit], **changes: Any) -> Outcome:
    """The verdict by induction over the claim's own lemmas and bounded search alone."""
    return prove(asked(formula, **changes), Limits(20, synthesis=0, simulation=0, portfolio=0))


def below_sixteen(s: Seen) -> Bit:
    """What the width says."""
    return s.n.int() < 16


def passed_in_time(s: Seen) -> Bit:
    """A lemma: above 3 it has passed 3."""
    return implies(s.n > 3, s.passed)

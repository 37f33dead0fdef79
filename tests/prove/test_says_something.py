"""A verdict must say something: a sentence true of any model is told so, a search before the premise bounds nothing."""

from collections.abc import Iterator
from typing import NamedTuple

import pytest

from safety import ANY, BOUNDED, PROVED, U8, Bit, Model, Scenario, Seen, claim, implies, persists, power_up
from safety.prove import claims
from safety.prove.claims import Claim
from safety.prove.prove import Limits, prove


class Out(NamedTuple):
    full: Bit


class Counter(Model, tick_s=1):
    """Counts up to 200 and stays there; the phase is anything."""

    n: U8 = power_up(0)
    phase: U8 = power_up(ANY)

    def step(self, up: Bit) -> tuple["Counter", Out]:
        more = up & (self.n < 200)
        return Counter(n=(self.n + more.word()).low(8), phase=self.phase), Out(full=self.n == 200)


@pytest.fixture(autouse=True)
def own_registry(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(claims, "_registry", {})
    yield


def only() -> Claim:
    (declared,) = claims.registered()
    return declared


def test_a_sentence_that_is_true_of_any_model_is_told_so() -> None:
    @claim(Counter, expect=PROVED)
    def full_or_not(s: Seen) -> Bit:
        """The counter is full or it is not."""
        return s.full | ~s.full

    outcome = prove(only())
    assert outcome.verdict == "proved"
    assert "whatever the model does" in outcome.why


def test_a_range_that_the_type_promises_is_told_apart_from_one_that_the_model_keeps() -> None:
    @claim(Counter, expect=PROVED)
    def in_its_byte(s: Seen) -> Bit:
        """The count fits into its byte."""
        return s.n <= 255

    assert "whatever the model does" in prove(only()).why
    claims._registry.clear()

    @claim(Counter, expect=PROVED)
    def up_to_200(s: Seen) -> Bit:
        """The count never passes 200."""
        return s.n <= 200

    outcome = prove(only())
    assert (outcome.verdict, outcome.why) == ("proved", "")


LATE = Scenario(steps=210, inputs={"up": True})


@pytest.mark.parametrize(("steps", "verdict"), [(20, "undecided"), (28, "bounded")])
def test_a_search_that_ends_before_the_premise_bounds_nothing(steps: int, verdict: str) -> None:
    @claim(Counter, expect=BOUNDED, steps=steps, induction=0, witness=LATE)
    def odd_phase_stays(s: Seen) -> Bit:
        """After 25 steps of counting the count is 24 at least (true, and not inductive by itself)."""
        return implies(persists(s.up, ticks=25), s.n >= 24)

    outcome = prove(only(), Limits(synthesis=0, portfolio=0))  # a lemma for it would soon be found
    assert outcome.verdict == verdict
    assert ("ends before the premise" in outcome.why) == (verdict == "undecided")

"""Inductive validity core: what a proof rests on is named, all else may be anything, and both can be checked."""

from __future__ import annotations

from typing import NamedTuple

import pytest

from safety.model import Model, assume, point, power_up
from safety.prove.claims import Claim, Seen
from safety.prove.core import ValidityCore, _Search, assumptions_of, validity_core
from safety.prove.problem import build_problem
from safety.prove.solve import Disagreement
from safety.system import ModelError
from safety.terms import U3, Bit, implies, select
from tests.prove.small import asked


class Lights(NamedTuple):
    high: Bit
    odd: Bit


class Parity(Model, event="tick"):
    """Whether a count is odd."""

    odd: Bit = power_up(False)

    def step(self, go: Bit) -> tuple[Parity, Bit]:
        return Parity(odd=point("now", self.odd ^ go)), self.odd


class Pair(Model, event="tick"):
    """A counter that stops at 5, and its parity."""

    n: U3 = power_up(0)
    parity: Parity

    def step(self, go: Bit, never: Bit) -> tuple[Pair, Lights]:
        assume("never is false", ~never)
        n = select(go & (self.n < 5), (self.n + 1).low(3), self.n)
        parity, odd = self.parity.step(go)
        return Pair(n=point("next.n", n), parity=parity), Lights(high=self.n > 5, odd=odd | never)


def at_most_five(s: Seen) -> Bit:
    """The counter stays at 5 or below."""
    return s.n <= 5


def odd_is_low(s: Seen) -> Bit:
    """Lemma that nobody needs."""
    return implies(s.n == 0, s.n < 3)


def never_high(s: Seen) -> Bit:
    """The high light stays dark."""
    return ~s.high


def odd_as_held(s: Seen) -> Bit:
    """The light shows the parity."""
    return s.odd == s.parity.odd


def core_of(claim: Claim) -> ValidityCore:
    return validity_core(build_problem(claim))


HIGH = asked(never_high, Pair, lemmas=(at_most_five, odd_is_low))


def test_what_a_proof_needs_is_named_and_nothing_else() -> None:
    core = core_of(HIGH)
    assert (core.registers, core.points, core.lemmas) == (("n",), ("next.n",), ("at most five",))
    assert (core.assumptions, core.inputs, core.spared) == ((), ("go",), ("parity",))
    assert str(core) == "rests on n, next.n; does not need parity"


def test_an_assumption_is_named_where_it_is_needed() -> None:
    core = core_of(asked(odd_as_held, Pair))
    assert core.assumptions == ("never is false",)
    assert core.spared == ("parity",)  # the light is compared with whatever the register holds


def test_what_is_given_is_named_conjunct_by_conjunct() -> None:
    def quiet(s: Seen) -> Bit:
        """Nothing is counted, the parity is even."""
        return ~s.go & ~s.parity.odd

    def stays_zero(s: Seen) -> Bit:
        """The counter stays at 0."""
        return s.n == 0

    claim = asked(stays_zero, Pair, given=quiet, lemmas=(stays_zero,))
    assert set(assumptions_of(build_problem(claim))) == {"never is false", "~go", "~parity.odd"}
    assert core_of(claim).assumptions == ("~go",)


def test_a_claim_without_a_proof_has_no_core() -> None:
    with pytest.raises(ModelError, match="no proof to look into"):
        core_of(asked(never_high, Pair, induction=0))


@pytest.mark.parametrize("planted", ["n", "point next.n", "lemma at most five"])
def test_a_core_that_lacks_something_fails_its_proof(planted: str) -> None:
    search = _Search(build_problem(HIGH), 0, 20.0)
    search.walk()
    search.confirm()
    search.needed.remove(planted)
    with pytest.raises(Disagreement):
        search.confirm()

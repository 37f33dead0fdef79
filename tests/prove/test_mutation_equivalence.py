"""What one claim has proved of the healthy model, another may use where its faults and its start leave that alone."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safety.faults import Fault, at_most
from safety.kinds import memory_flip, stuck
from safety.prove.claims import Claim, Seen
from safety.prove.mutants import COUNTEREXAMPLE, EQUIVALENT
from safety.prove.mutation_case import Subject
from safety.terms import Bit, implies
from tests.prove.small import asked
from tests.prove.test_mutants import ABOVE_FIVE, TOP, Climber, at_most_four, fate, stays_lit

STAYS = asked(stays_lit, Climber, id="stays")
LAMP = at_most(1, [Fault(stuck(1), ["lit now"], name="lamp")])
FLIP = at_most(1, [Fault(memory_flip(), ["n"], name="flip")])


@pytest.mark.parametrize(
    ("other", "touched"),
    [
        (STAYS, set()),
        (replace(STAYS, faults=LAMP), {"lit"}),
        (replace(STAYS, faults=FLIP), {"n", "lit"}),
        (replace(STAYS, anywhere=True), {"n", "lit", "aside"}),
        (replace(STAYS, given=lambda s: s.go), set()),
        (replace(STAYS, start=at_most_four), set()),
    ],
    ids=["healthy", "lamp", "flip", "anywhere", "given", "start"],
)
def test_a_lemma_holds_where_nothing_reaches_its_registers(other: Claim, touched: set[str]) -> None:
    """Above 5 there is no state, as the claim `top` has proved; a flipped register gets there all the same."""
    (case,) = Subject([other]).proved
    names = {s.var.uid: path for path, s in case.mutants.system.state.items()}
    assert {names[uid] for uid in case.untouched} == {"n", "lit", "aside"} - touched
    assert (fate(ABOVE_FIVE, TOP, other).kind == EQUIVALENT) is ("n" not in touched or other.anywhere)


def dark_at_six(s: Seen) -> Bit:
    """At 6, where it never comes, the lamp is on only if it was before."""
    return implies(s.n == 6, s.on == s.lit)


def test_a_claim_about_any_state_counts_as_long_as_it_is_proved() -> None:
    noticing = asked(dark_at_six, Climber, id="any state", anywhere=True)
    assert fate(ABOVE_FIVE, TOP, STAYS).kind == EQUIVALENT
    assert fate(ABOVE_FIVE, TOP, noticing).kind == COUNTEREXAMPLE

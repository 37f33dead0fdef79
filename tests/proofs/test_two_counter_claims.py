"""Claims about the two-counter ATC: verdicts, twins, what lemmas are needed for, and the figures they amount to."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from models.two_counter.numbers import CHECK_SPEEDS, COUNTING_S, HZ_PER_KMH, N1F, pulses, threshold_hz
from models.two_counter.train import KMH
from proofs import (
    two_counter_circuit,
    two_counter_decision,
    two_counter_defeats,
    two_counter_literal,
    two_counter_monotone,
    two_counter_refinement,
    two_counter_response,
)
from proofs.two_counter_formulas import ROWS, greatest_permitted, least_too_fast
from safety import PROVED, REFUTED
from safety.prove.claims import Claim
from safety.prove.induction import by_induction
from safety.prove.problem import build_problem
from safety.prove.prove import prove
from safety.prove.search import scripted
from tests.proofs.verdicts import OWN_LEMMAS, check, claims_of, of

MODULES = (
    two_counter_circuit, two_counter_decision, two_counter_defeats, two_counter_literal, two_counter_monotone,
    two_counter_refinement, two_counter_response,
)  # fmt: skip
CLAIMS = {name: claim for module in MODULES for name, claim in claims_of(module).items()}
PERIOD = COUNTING_S / N1F  # s


@pytest.mark.parametrize("claim", CLAIMS.values(), ids=list(CLAIMS))
def test_verdict(claim: Claim) -> None:
    check(prove(claim, OWN_LEMMAS))


def test_every_proved_claim_has_a_twin_that_fails() -> None:
    twins = {c.twin_of for c in CLAIMS.values() if c.expect == REFUTED}
    alone = [name for name, c in CLAIMS.items() if c.expect == PROVED and c.id not in twins]
    assert alone == ["equation_4_is_the_circuit_with_n1f_plus_1", "never_releases_if_read_consistently"]


@pytest.mark.parametrize("claim", [c for c in CLAIMS.values() if c.lemmas], ids=lambda c: c.formula.__name__)
def test_no_lemma_can_be_left_out(claim: Claim) -> None:
    for left_out in claim.lemmas:
        rest = tuple(lemma for lemma in claim.lemmas if lemma is not left_out)
        problem = build_problem(replace(claim, lemmas=rest))
        assert not by_induction(problem, claim.induction, True, 10.0, ("z3",)).proved, left_out.__name__


DEFEATS = [c for c in CLAIMS.values() if c.formula.__module__ == two_counter_defeats.__name__]
BY_A_FAULT = [c for c in DEFEATS if c.scenario and c.scenario.present]


@pytest.mark.parametrize("claim", BY_A_FAULT, ids=lambda c: c.formula.__name__)
def test_the_fault_is_to_blame(claim: Claim) -> None:
    """The same run without the fault keeps the claim."""
    assert claim.scenario is not None
    kept = ["claim.holds", "claim.premise", "claim.given"]
    run = scripted(build_problem(claim), replace(claim.scenario, present=()), keep=kept)
    assert all(run["claim.holds"]) and any(run["claim.premise"])


def test_each_letter_of_property_15_has_a_defeat() -> None:
    letters = {d.letter for d in two_counter_defeats.DEFEATS}
    assert sorted(letters | {"m"}) == list("abcdefghijklm")


def test_response_is_within_the_printed_form() -> None:
    """(2 n2E + 5)/f2E: 0.62649 s at 250 km/h, 0.67817 s at 5; the least speed that is too fast needs a little less."""
    printed = {v: (2 * pulses(v) + 5) / threshold_hz(v) for v in CHECK_SPEEDS}
    proved = {v: two_counter_response.periods(m) * PERIOD for v, m in ROWS.items()}
    assert round(float(printed[250]), 5) == 0.62649 and round(float(printed[5]), 5) == 0.67817
    for v in CHECK_SPEEDS:
        assert proved[v] <= printed[v] < proved[v] * Fraction(N1F, N1F - 1) + 2 * PERIOD
    assert (two_counter_response.periods(ROWS[250]), two_counter_response.periods(ROWS[5])) == (4018, 4349)


def test_guaranteed_brake_excess() -> None:
    """f2E n1F/(n1F - 1) lies 0.12944 km/h above f2E at 250 km/h, 0.00713 at 5; a unit of speed is 0.0005 km/h."""
    for v, printed in ((250, "0.12944"), (5, "0.00713")):
        exact = threshold_hz(v) / (N1F - 1) / HZ_PER_KMH
        assert abs(exact - Fraction(printed)) <= Fraction(1, 200_000)
        excess = Fraction(least_too_fast(ROWS[v]) - greatest_permitted(ROWS[v]), KMH)
        assert 0 <= excess - exact < Fraction(1, KMH)


def test_the_literal_runs_release_at_twenty_five_times_the_limit() -> None:
    """The runs are the solver's, replayed; the readings release though no window has held n1F pulses."""
    literal = two_counter_literal
    for claim in (literal.never_releases_if_signal_2_sets, literal.never_releases_if_signal_1_resets):
        run = of(claim).counterexample
        assert run is not None
        assert not run["brake"][-1] and run["speed"][-1] == 800_000
        assert max(run["circuit.counter1.n"]) < N1F


def test_equation_4_parts_from_the_circuit_at_n1f_only() -> None:
    run = of(two_counter_decision.brakes_by_equation_4).counterexample
    assert run is not None
    assert run["signal1"][-1] and run["circuit.counter1.n"][-1] == N1F and not run["brake"][-1]


def test_the_permitted_speed_moves_with_the_oscillator() -> None:
    edge = {error: 10**6 + error for error in range(-20_000, 20_001, 100)}
    for m in ROWS.values():
        limits = [least_too_fast(m, e) for e in edge.values()]
        assert limits == sorted(limits) and len(set(limits)) > 1

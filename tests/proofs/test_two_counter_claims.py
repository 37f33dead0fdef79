"""Claims about the two-counter ATC: verdicts, twins, what lemmas are needed for, and the figures they amount to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from math import ceil

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
from proofs.two_counter_formulas import ROWS, greatest_permitted, least_too_fast, limit_of_release, line
from safety import PROVED, REFUTED, Scenario
from safety.prove.claims import Claim
from safety.prove.induction import by_induction
from safety.prove.problem import build_problem
from safety.prove.prove import prove
from safety.prove.search import scripted
from safety.system import ModelError
from tests.proofs.verdicts import OWN_LEMMAS, check, claims_of, of

MODULES = (
    two_counter_circuit, two_counter_decision, two_counter_defeats, two_counter_literal, two_counter_monotone,
    two_counter_refinement, two_counter_response,
)  # fmt: skip
CLAIMS = {name: claim for module in MODULES for name, claim in claims_of(module).items()}
PERIOD = COUNTING_S / N1F  # s
SEEN = ["claim.holds", "claim.premise", "claim.given"]


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


def rounded(speed: Fraction, start: Fraction) -> Callable[[int], int]:
    """The steps of a train at a constant speed that is no whole number, `start` turned at power-up."""
    return lambda k: ceil(start + speed * (k + 1)) - ceil(start + speed * k)


@pytest.mark.parametrize("v", [250, 5])
@pytest.mark.parametrize("start", [Fraction(1), Fraction(123_457, 7), Fraction(999_999, 2)])
def test_speeds_between_two_units_are_in_the_premise(v: int, start: Fraction) -> None:
    """Just at the limit, where single steps are below the next unit; a thousandth of a unit slower is out of it."""
    claim, limit = CLAIMS["no_release_on_overspeed"], limit_of_release(ROWS[v])
    for speed, inside in ((limit, True), (limit - Fraction(1, 1000), False)):
        steps = rounded(speed, start)
        assert min(steps(k) for k in range(2600)) < least_too_fast(ROWS[v])
        run = Scenario(2600, {**line(v), "speed": steps}, {"train.phase": ceil(start) - 1})
        found = scripted(build_problem(claim), run, keep=SEEN)
        assert any(found["claim.premise"]) is inside and all(found["claim.holds"])


def test_a_train_that_is_never_slower_is_never_behind() -> None:
    """Of two speeds between the same two units the lesser one has the greater step now and then."""
    a, b = (rounded(500_000 + Fraction(tenths, 10), Fraction(8)) for tenths in (4, 6))
    assert any(a(k) > b(k) for k in range(50))
    claim = CLAIMS["of_two_windows_the_faster_is_judged_no_better"]
    run = replace(two_counter_monotone.both_too_fast(), inputs={**line(250), "speed_a": a, "speed_b": b})
    assert all(scripted(build_problem(claim), run, keep=SEEN)["claim.given"])
    exchanged = replace(run, inputs={**line(250), "speed_a": b, "speed_b": a})
    with pytest.raises(ModelError, match="breaks an assumption"):
        scripted(build_problem(claim), exchanged, keep=SEEN)


def test_equation_4_parts_from_the_circuit_at_n1f_only() -> None:
    run = of(two_counter_decision.brakes_by_equation_4).counterexample
    assert run is not None
    assert run["signal1"][-1] and run["circuit.counter1.n"][-1] == N1F and not run["brake"][-1]


def test_the_permitted_speed_moves_with_the_oscillator() -> None:
    edge = {error: 10**6 + error for error in range(-20_000, 20_001, 100)}
    for m in ROWS.values():
        limits = [least_too_fast(m, e) for e in edge.values()]
        assert limits == sorted(limits) and len(set(limits)) > 1

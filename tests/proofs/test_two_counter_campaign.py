"""Two-counter ATC: the wrong-side faults that are injected are the cut sets that are proved, neither more nor less."""

from __future__ import annotations

import pytest

from models.two_counter.failures import component_faults
from proofs import two_counter_campaign as campaigns
from proofs import two_counter_watchdog as extensions
from proofs.two_counter_hazards import PAIRS, SIMULATED, SINGLES
from proofs.two_counter_rates import wrong_in_the_campaigns
from safety import REFUTED
from safety.prove.claims import registered
from safety.prove.prove import Limits, prove

NUMBER = 125
CLAIMS = {c.id: c for c in registered() if c.id.startswith("two_counter_watchdog.")}


def test_every_mode_is_injected_at_each_moment() -> None:
    names = [fault.name for fault in component_faults()]
    assert len(names) == len(set(names)) == NUMBER
    for campaign in campaigns.SINGLE:
        result = campaign.inject()
        assert result.exhaustive and not result.surprises()
        assert sorted(found.faults[0].name for found, _ in result.injections()) == sorted(names)


def test_wrong_side_singles_are_exactly_the_single_cut_sets() -> None:
    """The one fault more is one of those that no proof is about; another of these is harmless in each run."""
    wrong = wrong_in_the_campaigns()
    assert wrong - set(SIMULATED) == set(SINGLES)
    assert wrong & set(SIMULATED) == {"generator 5 km/h low"}


def test_wrong_side_pairs_hold_a_wrong_side_single_or_are_the_proved_pairs() -> None:
    result = campaigns.pairs.inject()
    assert result.exhaustive and not result.surprises()
    assert result.tally.injections == NUMBER * (NUMBER - 1) // 2
    singles = wrong_in_the_campaigns()
    pairs = [(frozenset(f.name for f in found.faults), cell.startswith("wrong")) for found, cell in result.injections()]
    assert {pair for pair, wrong in pairs if wrong and not pair & singles} == {frozenset(pair) for pair in PAIRS}
    assert sum(1 for pair, wrong in pairs if not wrong and pair & singles) == 1333


def test_nothing_detects_a_fault() -> None:
    assert all(campaign.inject().tally.dangerous_detected == 0 for campaign in campaigns.SINGLE)


# --- what a watchdog and a second generator buy ----------------------------------------------------------------------


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    outcome = prove(CLAIMS[name], Limits(synthesis=0, simulation=0, portfolio=0))
    assert outcome.as_expected, outcome.why
    assert outcome.verdict == REFUTED or (outcome.agreed_by == ["z3", "cvc5"] and outcome.premise_at is not None)


@pytest.mark.parametrize(
    ("which", "harmless", "remaining"),
    [("watchdog", extensions.HOLDING, 33), ("second generator", extensions.GENERATOR, 59)],
)
def test_what_is_bought(which: str, harmless: tuple[str, ...], remaining: int) -> None:
    left = extensions.left(which)
    assert wrong_in_the_campaigns() - left == set(harmless)
    assert not left - wrong_in_the_campaigns(), "it adds no dangerous mode"
    assert len(left) == remaining


def test_slowest_train_that_the_watchdog_leaves_alone() -> None:
    """(n2E + 4)/T_w of 250 km/h, in units of 1/2000 km/h on the frequency scale, from the printed frequency."""
    hertz = (517.5 + 4) / (12_831 * 155.8695e-6)
    assert extensions.SLOWEST / 2000 == pytest.approx(hertz / 6.415623, rel=1e-4) == pytest.approx(40.64, abs=0.01)

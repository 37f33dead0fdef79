"""Which parts are faulty: exact probabilities, and a probability of failure from one injection for each pattern."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest

from models.ts7.voting import CommonPart
from safety.faults import Fault, stuck
from safety.inject import Campaign, CampaignError
from safety.inject.patterns import by_count, by_pattern
from safety.inject.statistics import Trials, total

P = Fraction("1e-5")  # that a channel's brake relay is welded when it is needed; INVENTED, to show the calculation


def test_patterns_and_counts_have_their_exact_probabilities() -> None:
    given = {"a": Fraction(1, 10), "b": Fraction(1, 5), "c": Fraction(1, 2)}
    patterns = by_pattern(given)
    assert patterns[frozenset("ab")] == Fraction(1, 10) * Fraction(1, 5) * Fraction(1, 2)
    counts = by_count(given.values())
    assert counts == [sum(w for s, w in patterns.items() if len(s) == k) for k in range(4)]
    assert sum(counts) == sum(patterns.values()) == 1


def lost(channels: frozenset[str]) -> Fault:
    """The brake relays of these channels stay closed."""
    return Fault(stuck(1), [f"{channel}.nbrr_relay.contact" for channel in sorted(channels)], name=pattern(channels))


def pattern(channels: frozenset[str]) -> str:
    return "welded: " + " ".join(sorted(channels))


def demand(frame: int) -> dict[str, bool]:
    """All channels drive, then all command the brake."""
    return {f"{channel}.{wire}": wire == "drive" and frame < RUNS for channel in "abc" for wire in WIRES} | {
        "supply": True
    }


RUNS, BRAKES, WIRES = 1000, 1000, ("drive", "brake", "fault", "rev")  # frames: all relays operate, then release


def test_the_brake_of_ts7_fails_with_the_probability_of_two_welded_relays() -> None:
    """Every pattern of welded brake relays is injected into the common part; each weighs its probability."""
    weights = by_pattern(dict.fromkeys("abc", P))
    brake = Campaign(
        id="patterns_of_welded_relays",
        model=CommonPart,
        faults=[lost(channels) for channels in weights if channels],
        stimulus=demand,
        run_in=RUNS,
        measured=BRAKES,
        block=BRAKES // 4,
        observe={"nb": "nb"},
        wrong_side=lambda counts: counts["nb"][-1] < BRAKES // 4,  # still runs at the end
        detected=lambda counts: counts.ever("nb") & False,
        engine="lanes",
    )
    cells = {injection.id: cell for injection, cell in brake.inject().injections()}
    strata = [
        Trials(pattern(channels), weight, int(cells.get(pattern(channels)) == "wrong/no"), 1, exhaustive=True)
        for channels, weight in weights.items()
    ]
    assert total(strata).exact == 3 * P**2 * (1 - P) + P**3
    assert {name for name, cell in cells.items() if cell == "wrong/no"} == {
        pattern(channels) for channels in weights if len(channels) >= 2
    }


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: by_pattern({"a": "1.5"}), "part 'a': probability 1.5 does not lie between 0 and 1"),
        (lambda: by_count([0.1]), r"0\.1 is a float; write it in quotes"),
        (lambda: by_pattern(dict.fromkeys(map(str, range(17)), "0.1")), "17 parts"),
    ],
)
def test_impossible_probabilities_are_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(CampaignError, match=message):
        call()

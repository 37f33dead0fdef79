"""TS-7, all pairs of failure modes: what is dangerous is a single one with anything, or two silent channels."""

from __future__ import annotations

from proofs.ts7_pairs_campaign import all_pairs
from proofs.ts7_system_campaign import overspeed


def test_a_dangerous_pair_holds_a_dangerous_mode_or_silences_two_channels() -> None:
    alone = {found.faults[0].name for found, cell in overspeed.inject().injections() if cell.startswith("wrong")}
    result = all_pairs.inject()
    assert result.exhaustive and not result.surprises()
    assert result.tally.injections == 392 * 391 // 2
    dangerous = [(frozenset(f.name for f in found.faults), c) for found, c in result.injections() if c[:5] == "wrong"]
    new = {pair for pair, _ in dangerous if not pair & alone}
    ways = {name for pair in new for name in pair}
    assert (len(dangerous), len(alone), len(new), len(ways)) == (3392, 7, 3 * 16 * 16, 3 * 16)
    partners = {name: {other for pair in new for other in pair if name in pair} - {name} for name in ways}
    assert {len(others) for others in partners.values()} == {32}, "any way of each of the two other channels"
    assert {cell for pair, cell in dangerous if pair in new} == {"wrong/no"}

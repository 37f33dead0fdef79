"""What every test of a proof file asks: the verdicts as stated, both solvers agreed, a twin that fails at hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from importlib import import_module
from types import ModuleType
from typing import Any

from safety import PROVED, REFUTED
from safety.audit import Entry
from safety.prove.bounds.claims import declared
from safety.prove.claims import Claim, claim_id, registered
from safety.prove.prove import Limits, Outcome, prove

OWN_LEMMAS = Limits(synthesis=0, simulation=0, portfolio=0)  # nothing is looked for but short runs
SHORT = Limits(synthesis=5, simulation=1, portfolio=0)  # lemmas are looked for, but not for long


def claims_of(module: ModuleType) -> dict[str, Claim]:
    """The claims of a proof file by function name."""
    return {c.formula.__name__: c for c in registered() if c.formula.__module__ == module.__name__}


def of(stated: Callable[..., Any], limits: Limits | None = None, **changed: Any) -> Outcome:
    """The outcome of a claim, perhaps changed."""
    claim = next(c for c in registered() if c.id == claim_id(stated))
    return prove(replace(claim, **changed), limits)


def check(outcome: Outcome) -> None:
    """The verdict is the one stated; a proof has both solvers and a premise that happens, a refutation its run."""
    assert outcome.as_expected, f"{outcome.verdict}: {outcome.why}"
    if outcome.verdict == PROVED:
        assert outcome.agreed_by == ["z3", "cvc5"]
        assert outcome.premise_at is not None
    if outcome.verdict == REFUTED:
        assert outcome.counterexample is not None
        assert not outcome.counterexample["claim.holds"][-1]


def without_twin(claims: dict[str, Claim], excused: Sequence[str] = ()) -> list[str]:
    """Proved claims for whose requirement no claim is stated that must fail."""
    refuted = {c.requirement for c in claims.values() if c.expect == REFUTED}
    return [n for n, c in claims.items() if c.expect == PROVED and c.requirement not in refuted and n not in excused]


def stated_in(entries: Mapping[str, Entry]) -> dict[str, str]:
    """What the claims are stated to come to, by which the words of a paper are judged."""
    words = {name: entry.claim for name, entry in entries.items() if entry.claim}
    for module in sorted({claim.partition(".")[0] for claim in words.values()}):
        import_module(f"proofs.{module}")
    expected = {claim.id: claim.expect for claim in (*registered(), *declared())}
    return {name: expected[claim] for name, claim in words.items()}

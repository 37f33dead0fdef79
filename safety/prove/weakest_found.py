"""What came of the search for the weakest safe value, and its entry in the results document."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from safety.prove.claims import REFUTED
from safety.prove.outcome import Outcome
from safety.prove.record import counterexample, surroundings
from safety.prove.stimulus import stimulus
from safety.prove.weakest import Synthesis, Value


@dataclass
class Found:
    """What came of a synthesis: the two values with what shows them; None where there is none.

    With `safe_from` and without `refuted_at`, either the whole range is safe, or `why` says that no run was found.
    """

    synthesis: Synthesis
    safe_from: Value | None = None
    refuted_at: Value | None = None
    proof: Any = None
    run: Any = None
    why: str = ""
    questions: int = 0
    seconds: float = 0.0

    @property
    def everywhere(self) -> bool:
        """Whether the whole range is proved safe."""
        return self.safe_from == self.synthesis.loosest

    @property
    def between(self) -> Value | None:
        """How far the two values lie apart; None where one is missing."""
        if self.safe_from is None or self.refuted_at is None:
            return None
        return apart(self.safe_from, self.refuted_at)

    @property
    def exact(self) -> bool:
        """Whether no value is left open."""
        return self.everywhere or (self.synthesis.bound is None and self.between == 1)

    @property
    def settled(self) -> bool:
        """Whether it is as near as was asked."""
        return self.everywhere or (self.between is not None and self.between <= self.synthesis.gap)

    def to_json(self) -> dict[str, Any]:
        """The entry under "syntheses" of the results document."""
        s = self.synthesis
        told: dict[str, Any] = {
            "id": s.id,
            "model": s.model.__name__ if s.model else None,
            "requirement": s.requirement or None,
            "source": s.source or None,
            "statement": s.statement,
            "parameter": s.parameter,
            "unit": s.unit or None,
            "safe": s.safe,
            "at": dict(s.at),
            "within": [_plain(v) for v in s.within],
            "safe_from": _plain(self.safe_from),
            "refuted_at": _plain(self.refuted_at),
            "everywhere": self.everywhere,
            "exact": self.exact,
            "gap": _plain(s.gap),
            "settled": self.settled,
            "for_all": s.for_all,
            "why": self.why or None,
            "seconds": round(self.seconds, 3),
            "questions": self.questions,
        }
        told |= {"limit": _plain(s.limit)} if s.bound else {}
        return told | _shown(self.proof, self.run)


def apart(one: Value, other: Value) -> Value:
    """How far two values lie apart."""
    return one - other if one > other else other - one


def _plain(value: Value | None) -> Any:
    """A fraction as the nearest double and as it is."""
    return {"value": float(value), "exact": str(value)} if isinstance(value, Fraction) else value


def _shown(proof: Any, run: Any) -> dict[str, Any]:
    """What shows the two values, as the entry tells it."""
    told: dict[str, Any] = {"proof": None, "refutation": None}
    if isinstance(proof, Outcome):
        told["proof"] = {
            "method": proof.method,
            "agreed_by": proof.agreed_by,
            "why": proof.why or None,
            "user_lemmas": len(proof.claim.lemmas),
            "found_lemmas": len(proof.found),
        }
        told |= surroundings(proof.problem)
    elif proof is not None:
        told["proof"] = {"method": "error bound over reals", "agreed_by": proof.agreed_by, "why": proof.why or None}
        told["assumptions"] = list(proof.bound.assumed)
    if isinstance(run, Outcome):
        shown = counterexample(run)
        told["refutation"] = {"method": run.method, "steps": run.steps}
        given = stimulus(run.counterexample) if run.counterexample else None
        told["counterexample"] = shown | {"stimulus": given, "vcd": None}
    elif run is not None:
        told["refutation"] = {"method": "exact point", "steps": None}
        told["counterexample"] = run.to_json(REFUTED)["counterexample"]
    return told

"""What may be spent on a claim, and what was found out about it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from safety.prove.claims import BOUNDED, PROVED, REFUTED, UNDECIDED, Claim
from safety.prove.induction import Answer
from safety.prove.problem import Problem
from safety.trace import Trace


@dataclass
class Limits:
    """Seconds for one solver question, for finding lemmas, for simulation and for other engines; which solvers.

    What has 0 seconds is left out.
    """

    timeout: float = 60.0
    solvers: tuple[str, ...] = ("z3", "cvc5")
    synthesis: float = 30.0
    simulation: float = 4.0
    portfolio: float = 20.0


@dataclass
class Outcome:
    """What was found out about a claim.

    `problem` has the lemmas that the proof rests on; `found` names those that the tool found itself.  `steps` is the
    length of a counterexample or the depth of a bounded verdict; `why` explains anything but success.
    """

    claim: Claim
    verdict: str
    problem: Problem | None = None
    method: str = ""
    steps: int | None = None
    agreed_by: list[str] = field(default_factory=list)
    counterexample: Trace | None = None
    premise_at: int | None = None
    candidate: dict[str, Any] = field(default_factory=dict)
    why: str = ""
    seconds: float = 0.0
    questions: int = 0
    found: tuple[str, ...] = ()

    @property
    def as_expected(self) -> bool:
        """Whether the verdict is the one that the claim states; a bounded one has to reach as far as was asked."""
        short = self.verdict == BOUNDED and (self.steps or 0) < self.claim.steps
        return self.verdict == self.claim.expect and not short

    def because(self, *reasons: str) -> None:
        """Add to `why`, keeping what it says already."""
        self.why = "; ".join(filter(None, [self.why, *reasons]))

    def proved(self, method: str, agreed_by: list[str], why: str = "") -> None:
        """Take a proof; what failed before it is of no interest any more."""
        self.verdict, self.method, self.agreed_by, self.why = PROVED, method, agreed_by, why
        self.steps, self.candidate = None, {}

    def refuted(self, run: Trace, method: str) -> None:
        """Take a counterexample, replayed."""
        self.verdict, self.counterexample, self.method, self.steps = REFUTED, run, method, len(run)
        self.agreed_by, self.candidate, self.why = [], {}, ""

    def undecided(self) -> None:
        """Take back a verdict that says nothing; the reasons stay."""
        self.verdict, self.method, self.steps, self.agreed_by = UNDECIDED, "", None, []


def who_is_silent(answer: Answer) -> str:
    """What to say of a proof that not all solvers have confirmed; nothing where two have."""
    if len(answer.agreed_by) > 1:
        return ""
    told = [f"{name} left open {what}" for name, what in answer.silent.items()]
    who = f"one solver only, {answer.agreed_by[0]}" if answer.agreed_by else "no single solver for all obligations"
    return "; ".join([f"confirmed by {who}", *told])

"""The least upper bound of a quantity, between a value that is reached and one that is proved not to be exceeded."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from safety.prove.bounds.replay import Witness, shown
from safety.prove.bounds.routes import Limits, Reply
from safety.prove.bounds.statement import WIDTH, Bound
from safety.prove.bounds.verdict import ask, entry, exact
from safety.prove.claims import PROVED, UNDECIDED, VACUOUS
from safety.prove.simplest import simplest
from safety.prove.solve import UNSAT, Disagreement
from safety.system import ModelError
from safety.terms import Bit

STEPS = 200  # questions that a bracket may ask
HIGHEST = 1 << 240  # times the first value reached: above it no upper bound is looked for
ROUND = 100  # the largest numerator and denominator of a value that may be a bound by design


@dataclass(frozen=True, eq=False)
class Bracket:
    """The least upper bound of a quantity: refuted below `low`, proved to be at most `high`.

    The witness reaches `low` exactly; `agreed_by` are the routes that prove `high`.  The verdict is proved where both
    ends are certified and near enough, vacuous where nothing is possible at all, else undecided (`why`).
    """

    bound: Bound
    verdict: str
    low: Fraction | None = None
    high: Fraction | None = None
    witness: Witness | None = None
    agreed_by: list[str] = field(default_factory=list)
    questions: int = 0
    why: str = ""
    seconds: float = 0.0

    @property
    def width(self) -> Fraction | None:
        """The width relative to the larger end; 0 where the bound is attained and exact."""
        if self.low is None or self.high is None:
            return None
        scale = max(abs(self.low), abs(self.high))
        return (self.high - self.low) / scale if scale else Fraction(0)

    def to_json(self, expect: str = PROVED) -> dict[str, Any]:
        """An entry for the "claims" of the results document, with "bracket" beside the usual keys."""
        return {
            **entry(self.bound, self.verdict, expect, self.agreed_by, self.why, self.seconds),
            "statement": self.bound.least(),
            "questions": self.questions,
            "bracket": {
                "low": None if self.low is None else exact(self.low),
                "high": None if self.high is None else exact(self.high),
                "unit": self.bound.unit,
                "relative_width": None if self.width is None else float(self.width),
                "witness": shown(self.witness) if self.witness else None,
            },
        }


def bracket(bound: Bound, width: Fraction = WIDTH, limits: Limits | None = None) -> Bracket:
    """The least upper bound of the quantity between two certified ends, `width` apart relative to the larger.

    Raises as `check`; `ModelError` also unless the width is above 0.
    """
    if width <= 0:
        raise ModelError(f"{bound.id}: width={width}; a bracket has a relative width above 0")
    began = time.perf_counter()
    search = _Bracketing(bound, width, limits or Limits())
    found = search.run()
    return Bracket(**{**found, "questions": search.questions, "seconds": time.perf_counter() - began})


class _Bracketing:
    """Halves the gap between a value that is reached and one that is not, then has both routes prove the latter."""

    def __init__(self, bound: Bound, width: Fraction, limits: Limits) -> None:
        self.bound, self.width, self.limits, self.questions = bound, width, limits, 0
        self.low: Fraction | None = None
        self.first = Fraction(0)
        self.witness: Witness | None = None

    def run(self) -> dict[str, Any]:
        found = {"bound": self.bound, "verdict": UNDECIDED}
        first = self._put(self.bound.situation & (self.bound.per > 0), thorough=True)
        if first.answer == UNSAT:
            divided = self._put(self.bound.situation & (self.bound.per <= 0), thorough=True)
            if divided.answer != UNSAT:
                return {**found, "why": f"no point with per above zero; whether it can be less is open: {divided.why}"}
            return {**found, "verdict": VACUOUS, "agreed_by": first.agreed_by, "why": "what is given cannot happen"}
        if first.witness is None:
            return {**found, "why": first.why}
        self._reach(first.witness)
        high, why = self._close_in()
        found |= {"low": self.low, "witness": self.witness}
        if high is None:
            return {**found, "why": why}
        proof = self._put(self.bound.beyond(high), thorough=True)
        if proof.witness is not None:
            raise Disagreement(
                f"{self.bound.id}: {high} was found not to be exceeded, but is at {shown(proof.witness)}"
            )
        if proof.answer != UNSAT:
            return {**found, "why": f"nothing was found above {high}, but that is not proved: {proof.why}"}
        near = "approached, but not reached" if high == 0 != self.low else ""
        return {**found, "verdict": PROVED, "high": high, "agreed_by": proof.agreed_by, "why": proof.alone or near}

    def _put(self, formula: Bit, thorough: bool = False) -> Reply:
        self.questions += 1
        return ask(self.bound, formula, self.limits, thorough)

    def _reach(self, witness: Witness | None) -> None:
        """Remember a point, if it is one and its value is the highest so far."""
        value = self.bound.at(witness) if witness else None
        if value is not None and (self.low is None or value[0] > self.low):
            self.low, self.witness = value[0], witness

    def _close_in(self) -> tuple[Fraction | None, str]:
        """A value that is not exceeded, near enough above the one reached; none, and why."""
        assert self.low is not None
        high: Fraction | None = None
        self.first = stride = max(abs(self.low), Fraction(1, 1 << 20))
        tried, run = set[Fraction](), 0
        while self.questions < STEPS:
            if high is None:
                guess, stride = self.low + stride, max(16 * stride, 2 * abs(self.low))
            elif self.low < high and _round(self.low) and self.low not in tried:
                guess = self.low  # a round value that is reached may well be the bound itself
            elif self._near_enough(high):
                guess = simplest(self.low, high)  # so may the simplest value in the gap
                if guess in tried or not _round(guess):
                    return self._loosened(high), ""
            else:
                guess = _between(self.low, high, run)
            tried.add(guess)
            found = self._put(self.bound.beyond(guess))
            if found.witness is not None:
                self._reach(found.witness)
                run = max(run, 0) + 1
            elif found.answer != UNSAT:
                return None, f"no route decides whether {guess} is exceeded: {found.why}"
            else:
                high, run = guess, min(run, 0) - 1
                if _round(guess) and guess > self.low:
                    self._reach(self._put(self.bound.beyond(guess, reached=True)).witness)
            if stride > self.first * HIGHEST:
                return None, f"no upper bound found: {float(self.low):g} is exceeded"
        return None, f"{STEPS} questions did not close the gap above {float(self.low):g}"

    def _near_enough(self, high: Fraction) -> bool:
        """Whether the gap is half as wide as it may be, below a bound of 0 beside the first value reached."""
        assert self.low is not None
        scale = self.first if high == 0 else max(abs(self.low), abs(high))
        return (high - self.low) * 2 <= self.width * scale

    def _loosened(self, high: Fraction) -> Fraction:
        """The farthest value that the width allows above the one reached: the slack helps the proof."""
        assert self.low is not None
        if high in (self.low, 0):
            return high
        room = self.width * max(abs(self.low), abs(high)) * Fraction(99, 100)
        return max(high, simplest(self.low + room * Fraction(99, 100), self.low + room)) if room else high


def _round(x: Fraction) -> bool:
    return max(abs(x.numerator), x.denominator) <= ROUND


def _between(low: Fraction, high: Fraction, run: int) -> Fraction:
    """A simple fraction in a gap: near its middle; after a run of answers alike (counted down below 0), nearer one end.

    Far apart and of one sign, it is in the middle of their powers.
    """
    if low > 0 and high > 16 * low:
        middle = low * (1 << (int(high / low).bit_length() // 2))
        return simplest(middle * Fraction(7, 8), middle * Fraction(9, 8))
    share = Fraction(1, 2 ** min(abs(run) + 1, 8))
    reach = (high - low) * share
    if run < 0:
        return simplest(low + reach * Fraction(3, 4), low + reach * Fraction(5, 4))
    return simplest(high - reach * Fraction(5, 4), high - reach * Fraction(3, 4))

"""The search for the weakest safe value: the range is halved, each step asks for a proof or for a counterexample."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

from safety.prove import search
from safety.prove.claims import PROVED, REFUTED, Claim, Scenario
from safety.prove.engines.engine import in_integers
from safety.prove.induction import Obligation, discharge, property_obligations
from safety.prove.outcome import Limits, Outcome
from safety.prove.premises import show_premises
from safety.prove.problem import Problem
from safety.prove.prove import decide, stated
from safety.prove.weakest import ABOVE, Synthesis, Value
from safety.prove.weakest_found import Found, apart
from safety.prove.weakest_given import NotShownError, left_out_of_model, left_out_of_reals
from safety.system import ModelError
from safety.terms import UInt
from safety.tracing import fitting

if TYPE_CHECKING:
    from safety.prove.bounds import Finding

Decide = Callable[[Problem, Limits], Outcome]
Say = Callable[[str], None]


def find(
    synthesis: Synthesis,
    limits: Limits | None = None,
    decided: Decide = decide,
    say: Say = lambda text: None,
    settings: Mapping[str, Any] | None = None,
) -> Found:
    """Look for the weakest safe value; `decided` gives the verdict on a problem, `say` is told what is tried.

    `settings` are those of other parameters of the model.  Raises as `prove`, and `check` for bounds; and `ModelError`
    for a value said to be safe that `given` leaves out, a range beyond the parameter's, a setting of what is held.
    """
    began = time.perf_counter()
    limits = limits or Limits()
    asked: _Asked = _OfBound(synthesis, limits) if synthesis.bound else _OfClaims(synthesis, limits, decided, settings)
    asked.say = say
    found = asked.run()
    found.questions, found.seconds = asked.questions, time.perf_counter() - began
    return found


class _Asked(ABC):
    """Both kinds of questions about a synthesis, and how the range is halved by their answers."""

    def __init__(self, synthesis: Synthesis, limits: Limits) -> None:
        self.synthesis, self.limits = synthesis, limits
        self.questions, self.why = 0, ""
        self.say: Say = lambda text: None

    @abstractmethod
    def prove(self, value: Value) -> Any:
        """What proves all values from this one on; None where nothing does."""

    @abstractmethod
    def refute(self, value: Value) -> tuple[Value, Any] | None:
        """A value from this one on that is refuted, and what shows it."""

    @abstractmethod
    def left_out(self, value: Value) -> Value | None:
        """A value from this one on that what is given leaves out; None if there is none.  Raises `NotShownError`."""

    def guess(self) -> Value | None:
        """Where the proofs end, most likely, if that is soon said; it is to be confirmed."""
        return None

    def shown(self, value: Value, run: Any) -> Any:
        """The run that is shown, made out of what `refute` gave."""
        return run

    @property
    def step(self) -> Value:
        """Values nearer than this are not told apart."""
        return Fraction(self.synthesis.gap) / 2 if self.synthesis.bound else 1

    def run(self) -> Found:
        """Halve the range."""
        s = self.synthesis
        found = Found(s)
        likely = self.guess()
        if likely is not None and self._try(found, likely):
            open_ = s.loosest if found.everywhere else self.looser(likely)
        elif self._try(found, s.strictest):
            open_ = s.strictest if self._try(found, s.loosest) else self._halve(found)
        else:
            worst = self.refute(s.strictest)
            found.refuted_at, found.run = worst or (None, None)
            found.why = f"no value is safe: {s.strictest} is not" if worst else f"not proved anywhere: {self.why}"
        self._all_possible(found)
        if found.safe_from is not None and not found.everywhere:
            self._refuted(found, open_)
        if found.refuted_at is not None:
            found.run = self.shown(found.refuted_at, found.run)
        return found

    def looser(self, value: Value) -> Value:
        """The value next to one, towards the loosest."""
        return value - self.step if self.synthesis.safe == ABOVE else value + self.step

    def middle(self, one: Value, other: Value) -> Value:
        """Half-way."""
        return (one + other) / Fraction(2) if self.synthesis.bound else (int(one) + int(other)) // 2

    def _halve(self, found: Found) -> Value:
        """Move `safe_from` towards the loosest value; gives the nearest value that is not proved."""
        open_ = self.synthesis.loosest
        while found.safe_from is not None and apart(found.safe_from, open_) > self.step:
            value = self.middle(found.safe_from, open_)
            open_ = open_ if self._try(found, value) else value
        return open_

    def _try(self, found: Found, value: Value) -> bool:
        """Take a value as safe, if it is proved to be."""
        self.say(f"{self.synthesis.parameter} {value}")
        proof = self.prove(value)
        if proof is not None:
            found.safe_from, found.proof = value, proof
        return proof is not None

    def _all_possible(self, found: Found) -> None:
        """Refuse a safe side of which what is given leaves values out: the proof says nothing of them."""
        if found.safe_from is None:
            return
        s, value = self.synthesis, found.safe_from
        try:
            missing = self.left_out(value)
        except NotShownError as error:
            found.safe_from = found.proof = None
            found.why = f"proved from {value} on, but not that what is given leaves all these values possible: {error}"
            return
        if missing is not None:
            raise ModelError(
                f"{s.id}: what is given leaves out {s.parameter} {missing}, so nothing is proved of it; "
                f"shorten within={s.within} or change what is given"
            )

    def _refuted(self, found: Found, near: Value) -> None:
        """The refuted value nearest to the safe one, if any."""
        hit = self.refute(near) or self.refute(self.synthesis.loosest)
        if hit is None:
            found.why = f"no run breaks it at {near} or at {self.synthesis.loosest}"
            found.why += f": {self.why}" if self.why else ""
            return
        found.refuted_at, found.run = hit
        while apart(found.refuted_at, near) > self.step:
            value = self.middle(near, found.refuted_at)
            hit = self.refute(value)
            if hit is None:
                near = value
            else:
                found.refuted_at, found.run = hit


class _OfClaims(_Asked):
    """About a model: verdicts on claims, and runs."""

    def __init__(
        self, synthesis: Synthesis, limits: Limits, decided: Decide, settings: Mapping[str, Any] | None
    ) -> None:
        super().__init__(synthesis, limits)
        assert synthesis.proving is not None and synthesis.breaking is not None
        self.proving, self.breaking, self.decided = synthesis.proving, synthesis.breaking, decided
        self.settings = dict(settings or {})
        if synthesis.free:
            used = self._open.system.settings[synthesis.free]
            sort = self._open.system.lookup(synthesis.free).sort
            if sort.kind not in ("uint", "int"):
                raise ModelError(
                    f"{synthesis.id}: {used.path} is a {sort}; weakest goes through whole numbers, "
                    "so use weakest_of with covers=True"
                )
            if synthesis.within[0] < used.low or used.high < synthesis.within[1]:
                raise ModelError(
                    f"{synthesis.id}: within={synthesis.within}, but {used.path} lies in {used.low}..{used.high} "
                    f"{used.unit} ({used.source}); shorten the range"
                )

    def stated(self, claim: Claim) -> Problem:
        """What a claim asks, with the settings of the other parameters."""
        self._refuse(claim, self.settings, claim.settings, "held")
        self._refuse(claim, {**claim.settings, **self.settings}, dict.fromkeys(claim.symbolic), "left open")
        return stated(claim, self.settings)

    def _refuse(self, claim: Claim, settings: Mapping[str, Any], own: Mapping[str, Any], how: str) -> None:
        """Refuse settings of what the claim itself says: they would change nothing, or what is looked for."""
        kept = fitting(claim.model, own)
        for path, value in fitting(claim.model, settings).items():
            if path in kept:
                raise ModelError(f"{self.synthesis.id}: {path} = {value} is set, but it is {how} here; leave it out")

    def left_out(self, value: Value) -> Value | None:
        """Asked of a parameter of the model; of a family, each value has been proved or shown to say something."""
        if not self.synthesis.free:
            return None
        ends = (int(self.synthesis.strictest), int(value))
        return left_out_of_model(self._open, self.synthesis.free, ends, self.limits)

    def prove(self, value: Value) -> Outcome | None:
        """One proof for all values from this one on, or one for each of them."""
        end = int(self.synthesis.strictest)
        toward = 1 if end >= value else -1
        others = range(int(value) + toward, end + toward, toward)
        proof = self._proof(value)
        if proof is not None and self.synthesis.covers and not self.synthesis.free:
            self._show_cover(int(value), others)
        elif proof is not None and not self.synthesis.covers and not all(self._proof(v) for v in others):
            return None
        return proof

    def _show_cover(self, value: int, others: range) -> None:
        """Show that whatever the claims of other values are about, that of this one is about too; and that they are
        about something."""
        one = self.stated(replace(self.proving(value), scenario=None))
        for v in others:
            other = self.stated(replace(self.proving(v), scenario=None))
            asked = [
                Obligation("what is given", True, ((0, (other.given,)),), 0, one.given),
                Obligation("where it starts", True, ((0, (other.given, other.start)),), 0, one.start),
            ]
            what = "" if _said(one) == _said(other) else "model or sentence"
            what = what or discharge(one, asked, in_integers(one), self.limits.timeout, self.limits.solvers).failed
            self.questions += 1
            if what:
                raise ModelError(
                    f"{self.synthesis.id}: the claim of {value} does not cover that of {v}: {what} differs; "
                    "leave out covers=True, and each value is proved by itself"
                )
            said = Outcome(other.claim, PROVED, other)
            show_premises(other, said, self.limits)
            if said.verdict != PROVED:
                raise ModelError(
                    f"{self.synthesis.id}: the claim of {v} says nothing, so it is not shown to be safe: {said.why}; "
                    f"shorten within={self.synthesis.within}"
                )

    def _proof(self, value: Value) -> Outcome | None:
        self.questions += 1
        outcome = self.decided(
            self.stated(replace(self.proving(int(value)), expect=PROVED, scenario=None)), self._proofs_only()
        )
        if outcome.verdict == PROVED:
            return outcome
        self.why = outcome.why
        return None

    def _proofs_only(self) -> Limits:
        return replace(self.limits, simulation=0.0, portfolio=0.0)

    def guess(self) -> Value | None:
        """By the property alone, one solver: the lemmas are taken to hold all over the range."""
        safe, open_ = int(self.synthesis.strictest), int(self.synthesis.loosest)
        if not self.proving(safe).lemmas or not self._follows(safe):
            return None
        if self._follows(open_):
            return open_
        while abs(safe - open_) > 1:
            value = (safe + open_) // 2
            safe, open_ = (value, open_) if self._follows(value) else (safe, value)
        return safe

    def _follows(self, value: int) -> bool:
        self.questions += 1
        problem = self._problem(value)
        asked = property_obligations(problem, 0)
        return discharge(problem, asked, in_integers(problem), self.limits.timeout, self.limits.solvers[:1]).proved

    @cached_property
    def _open(self) -> Problem:
        """The widest problem: a parameter of the model is a register in it, that each question holds closer."""
        return self.stated(self.proving(int(self.synthesis.loosest)))

    def _problem(self, value: int) -> Problem:
        """What is asked for all values from this one on."""
        if not self.synthesis.free:
            return self.stated(self.proving(value))
        free = cast(UInt, self._open.system.lookup(self.synthesis.free))
        side = free >= value if self.synthesis.safe == ABOVE else free <= value
        return replace(self._open, given=self._open.given & side)

    def refute(self, value: Value) -> tuple[Value, Any] | None:
        """A run at this very value: one of the scenarios, else one that is searched for."""
        self.questions += 1
        claim = self.breaking(int(value))
        scripts = self.synthesis.scripts(int(value))
        if not scripts:
            outcome = self.decided(self.stated(replace(claim, expect=REFUTED)), replace(self.limits, portfolio=0.0))
            return (value, outcome) if outcome.verdict == REFUTED else None
        problem = self._open if self.synthesis.free else self.stated(replace(claim, scenario=None))
        hit = next((script for script in scripts if self._breaks(problem, script)), None)
        return (value, hit) if hit is not None else None

    def _breaks(self, problem: Problem, script: Scenario) -> bool:
        try:
            return False in search.scripted(problem, script, ["claim.holds", "claim.given"])["claim.holds"]
        except ModelError as error:  # it does not keep what is given at this value
            self.why = str(error)
            return False

    def shown(self, value: Value, run: Any) -> Outcome:
        """The whole run of a scenario, recorded."""
        if isinstance(run, Outcome):
            return run
        problem = self.stated(replace(self.breaking(int(value)), scenario=None))
        broken = search.cut_at(search.scripted(problem, run), "claim.holds", False)
        assert broken is not None
        outcome = Outcome(problem.claim, REFUTED, problem)
        outcome.refuted(broken, "scripted scenario, replayed")
        return outcome


def _said(problem: Problem) -> list[Any]:
    """What tells whether two problems differ in what is given at most: terms by uid, and power-up."""
    terms = (problem.holds, *(s.var for s in problem.system.states), *problem.system.roots())
    inputs = [v.uid for v in problem.system.inputs.values()]
    return [[t.uid for t in terms], inputs, [s.power_up for s in problem.system.states]]


class _OfBound(_Asked):
    """About a bound over reals, its variable held to one side of a value."""

    def prove(self, value: Value) -> Finding | None:
        """Both routes, or what they say."""
        finding = self._check(value)
        if finding.verdict == PROVED:
            return finding
        self.why = finding.why
        return None

    def refute(self, value: Value) -> tuple[Value, Finding] | None:
        """The point at which the limit is exceeded; its own value of the variable is what is refuted."""
        finding = self._check(value)
        if finding.verdict != REFUTED or finding.witness is None:
            return None
        ends = next((ends for x, ends in finding.witness.items() if str(x.attr) == self.synthesis.parameter), None)
        return (ends[0], finding) if ends is not None and ends[0] == ends[1] else None

    def left_out(self, value: Value) -> Value | None:
        """Asked of the bound's variable."""
        from safety.prove.bounds.statement import reals

        s = self.synthesis
        assert s.bound is not None
        (x,) = reals(s.parameter)
        return left_out_of_reals(s.bound.situation, s.bound.whole, x, (s.strictest, value), self.limits.timeout)

    def _check(self, value: Value) -> Finding:
        from safety.prove.bounds import Limits as Seconds
        from safety.prove.bounds import check
        from safety.prove.bounds.statement import reals

        self.questions += 1
        s = self.synthesis
        assert s.bound is not None
        (x,) = reals(s.parameter)
        low, high = sorted((Fraction(value), Fraction(s.strictest)))
        held = replace(s.bound, given=(*s.bound.given, x >= low, x <= high))
        return check(held, s.limit, limits=Seconds(self.limits.timeout))

"""Mutation coverage of proofs: would the claims on a model notice if the model said something else?

Each mutant of a model (`safety.prove.mutation`) is put to all claims on that model:

    counterexample  a proved claim is false in a run of the mutant
    vacuous         a proved claim says nothing any more: the run that shows its premise does not, or none can
    twin            a claim that must be refuted is proved instead
    proof lost      a proof no longer goes through and no run breaks the claim: whether one would notice is not shown
    equivalent      the mutant steps as the model does, in every state that matters: shown by a solver
    slack           all claims are proved, yet there is a run in which registers or outputs differ
    undecided       none of these could be shown
    unclaimed       no claim on the model depends on the place

The first three kill the mutant.  Slack says which claim is missing; a mutant whose proof is lost may be slack too.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from safety.prove import claims, search
from safety.prove.claims import PROVED, REFUTED, Scenario
from safety.prove.engines.engine import uses_reals
from safety.prove.exclusions import exclusions
from safety.prove.mutation import Mutant
from safety.prove.mutation_case import Case, Subject
from safety.prove.mutation_kept import Kills
from safety.prove.mutation_pair import difference
from safety.prove.mutation_questions import (
    breakable,
    equivalent,
    equivalent_for,
    in_either_reading,
    same_from_power_up,
    still_proved,
)
from safety.prove.mutation_runs import Course, Lanes, Seen, confirmed, course_of, only, single
from safety.prove.outcome import Limits, Outcome
from safety.prove.problem import Problem, premise_name
from safety.prove.prove import decide
from safety.system import ModelError
from safety.terms import Bit, bit
from safety.terms.graph import variables

COUNTEREXAMPLE, VACUOUS, TWIN, PROOF_LOST = "counterexample", "vacuous", "twin", "proof lost"
EQUIVALENT, SLACK, UNDECIDED, UNCLAIMED = "equivalent", "slack", "undecided", "unclaimed"
KILLED = (COUNTEREXAMPLE, VACUOUS, TWIN)
KINDS = (*KILLED, PROOF_LOST, EQUIVALENT, SLACK, UNDECIDED, UNCLAIMED)
SHORT = 12  # steps of the search for a run behind a proof that is lost
FAR = 20  # steps of the search for a run in which a mutant differs
DRIVEN = (3, 6)  # times the limit of a question: what directed runs may take, at first and where in doubt
DECIDED = 0.5  # of that limit: for lemmas, simulation, or other engines, of one claim on one mutant


@dataclass(frozen=True)
class Fate:
    """What became of a mutant: the kind, the claim that it came by, and what was seen."""

    mutant: Mutant
    kind: str
    claim: str = ""
    how: str = ""


def examine(subject: Subject, numbers: Iterable[int], kills: Kills | None = None) -> list[Fate]:
    """What becomes of these mutants; what is found is kept among the kills, and what was found is tried again first."""
    return _Examination(subject, set(numbers), kills or Kills(None, subject.mutants)).fates()


def _length(case: Case) -> int:
    """How long the known runs of a claim are."""
    return sum(len(known.rows) for known in case.courses)


def _alike(problem: Problem, numbers: set[int], timeout: float, known: Sequence[Bit]) -> set[int]:
    """The mutants that step alike in the states that a problem leaves."""
    return in_either_reading(
        lambda left, integers: equivalent_for(problem, left, integers, timeout, known), numbers, uses_reals(problem)
    )


class _Examination:
    """What is known of some mutants so far; each step of `fates` takes those away whose fate it settles."""

    def __init__(self, subject: Subject, numbers: set[int], kills: Kills) -> None:
        self.subject, self.left, self.timeout, self.kills = subject, numbers, subject.timeout, kills
        self.settled: dict[int, Fate] = {}
        self.differs: dict[int, tuple[str, str]] = {}  # a claim on whose known run it differs, and where
        self.lost: dict[int, dict[Case, str]] = {}  # claims that are not proved any more with their lemmas
        self.open: dict[int, dict[Case, str]] = {}  # claims of which it is not known

    def fates(self) -> list[Fate]:
        """All fates, in the order of the mutants."""
        numbers, proved = sorted(self.left), self.subject.proved
        self._kill_again()
        self._equivalent()
        self._unclaimed()
        self._run()
        self._drive(doubtful=False)
        for case in proved:
            self._prove(case)
        self._equivalent_for_claims(self._of_the_step() - self.lost.keys(), found=False)
        self._search_for_lost()
        self._drive(doubtful=True)
        self._equivalent_at_power_up()
        self._equivalent_for_claims(self._of_the_step(), found=True)
        for number in sorted(self.left & (self.lost.keys() | self.open.keys())):
            self._decide(number)
        for case in sorted(self.subject.refuted, key=_length):
            self._twin(case)
        for number in sorted(self.lost.keys() & self.left):
            case, label = next(iter(self.lost[number].items()))
            self.settle(number, PROOF_LOST, case.claim.id, label)
        self._slack()
        return [self.settled[n] for n in numbers]

    def settle(self, number: int, kind: str, claim: str = "", how: str = "") -> None:
        self.settled[number] = Fate(self.subject.mutants[number], kind, claim, how)
        self.left.discard(number)

    def _broken(self, number: int, case: Case, course: Course, step: int) -> None:
        """A run on the Python reading breaks a claim at a step."""
        self.kills.keep(self.subject.mutants[number], case, course, step)
        self.settle(number, COUNTEREXAMPLE, case.claim.id, f"after {step + 1} steps")

    def _asked(self, case: Case) -> set[int]:
        """The mutants that can be put to a claim all at once."""
        return self.left & case.sees - case.restarting

    def _unclaimed(self) -> None:
        seen = set().union(*(case.sees for case in (*self.subject.proved, *self.subject.refuted)))
        values = {number for steps in self.subject.mutants.settings.values() for number, _ in steps}
        for number in self.left - seen:
            why = "no claim works with the value as written" if number in values else "no claim depends on it"
            self.settle(number, UNCLAIMED, "", why)

    def _kill_again(self) -> None:
        """What an earlier run has killed, by the same run."""
        self.kills.recall(self.left)
        for case in self.subject.proved:
            for number, course, step in self.kills.again(case, self.left & case.sees):
                self._broken(number, case, course, step)
            if case.claim.witness is not None:
                self._witness(case, case.claim.witness, self.kills.unmet(case))

    def _followed(self, case: Case, numbers: Collection[int]) -> Iterator[tuple[Course, dict[int, Seen]]]:
        """The mutants on the claim's known runs; where they first differ is kept in mind."""
        if not numbers or not case.courses:
            return
        lanes = Lanes(case.problem, [self.subject.mutants[n] for n in sorted(numbers)])
        for known in case.courses:
            found = lanes.follow(known)
            for number, seen in found.items():
                if seen.differs:
                    step, name = seen.differs
                    self.differs.setdefault(number, (case.claim.id, f"{name} differs at step {step} of its run"))
            yield known, found

    def _run(self) -> None:
        """Mutants on the claims' known runs, the short ones first; then what shows a premise no more."""
        unmet: list[tuple[Case, Scenario, set[int]]] = []
        for case in sorted(self.subject.proved, key=_length):
            for known, found in self._followed(case, self._asked(case)):
                for number, seen in found.items():
                    if seen.broken is not None and number in self.left:
                        confirmed(self._single(case, number), known, seen.broken)
                        self._broken(number, case, known, seen.broken)
                witness = case.claim.witness  # if it has one, it is the first of its runs
                if witness is not None and case.claim.scenario is None and known is case.courses[0]:
                    unmet.append((case, witness, {number for number, seen in found.items() if not seen.met}))
        for case, witness, numbers in unmet:
            self._witness(case, witness, numbers)

    def _single(self, case: Case, number: int) -> Problem:
        return case.single(self.subject.mutants[number])

    def _drive(self, doubtful: bool) -> None:
        """Mutants on many long runs, all claims that assume the same at once; longer ones where in doubt."""
        for panel in self.subject.panels:
            numbers = set().union(*(self._asked(case) for case in panel.cases))
            if doubtful:
                doubts = {n: self.lost.get(n, {}).keys() | self.open.get(n, {}).keys() for n in numbers}
                numbers = {n for n in numbers if any(case in doubts[n] for case in panel.cases)}
            mutants = [self.subject.mutants[n] for n in sorted(numbers)]
            if not mutants:
                continue
            seconds, patience = (DRIVEN[1] * self.timeout, 3) if doubtful else (DRIVEN[0] * self.timeout, 0)
            for number, course, step in panel.drive.broken(mutants, seconds, patience):
                case = panel.broken_by(self.subject.mutants[number], course, step)
                self._broken(number, case, course, step)

    def _witness(self, case: Case, script: Scenario, numbers: set[int]) -> None:
        """Mutants in which the run that shows a claim's premise shows it no more: then nobody accepts the claim."""
        for number in sorted(self.left & numbers):
            problem = self._single(case, number)
            premises = [premise_name(problem, i) for i in range(len(problem.premises))]
            try:
                run = search.scripted(problem, script, [*premises, "claim.given"])
            except ModelError as error:
                self._unmet(number, case, str(error))
                continue
            if not any(True in run[premise] for premise in premises):
                self._unmet(number, case, f"its premise is not met in the {script.steps} steps")

    def _unmet(self, number: int, case: Case, how: str) -> None:
        self.kills.keep_unmet(self.subject.mutants[number], case)
        self.settle(number, VACUOUS, case.claim.id, how)

    def _twin(self, case: Case) -> None:
        """A twin kills where it is proved of the mutant; that nothing refutes it in some steps is not enough."""
        left = self._asked(case)
        for _, found in self._followed(case, left):
            left = left - {number for number, seen in found.items() if seen.broken is not None}
        if left:
            some = case.some(left)
            left = left - breakable(some, ~some.holds, left, SHORT, uses_reals(some), self.timeout).failed.keys()
        for number in sorted(left | (self.left & case.sees & case.restarting)):
            outcome = self._decided(case, number)
            if outcome.verdict == PROVED:
                self.settle(number, TWIN, case.claim.id, f"proved: {outcome.method}")
            elif outcome.verdict != REFUTED:
                self.open.setdefault(number, {})[case] = "neither refuted nor proved"

    def _decided(self, case: Case, number: int) -> Outcome:
        """A claim on a mutant, with lemmas that the tool finds; a proof is tried before runs.

        A twin is false, or it is true: whether its premise can happen is not asked.
        """
        seconds = DECIDED * self.timeout
        problem = replace(self._single(case, number), lemmas={})
        if case.claim.expect == REFUTED:
            problem = replace(problem, premises=(bit(True),))
        plain = replace(problem.claim, witness=None, scenario=None, expect=PROVED)
        engines = 0 if case.proved else seconds  # what induction proves of the model is no riddle for its mutant
        limits = Limits(seconds, synthesis=seconds, simulation=seconds / 2, portfolio=engines)
        return decide(replace(problem, claim=plain), limits)

    def _decide(self, number: int) -> None:
        """Whether the claims whose proofs are lost, or were not there, are true of the mutant."""
        for case in [*self.lost.get(number, ()), *self.open.get(number, ())]:
            outcome = self._decided(case, number)
            if outcome.verdict == REFUTED:
                assert outcome.counterexample is not None
                course = course_of(self._single(case, number), outcome.counterexample)
                self._broken(number, case, course, len(outcome.counterexample) - 1)
                return
            if outcome.verdict == claims.VACUOUS:
                self.settle(number, VACUOUS, case.claim.id, outcome.why)
                return
            if outcome.verdict == PROVED:
                for some in (self.lost, self.open):
                    some.get(number, {}).pop(case, None)
                    if number in some and not some[number]:
                        del some[number]

    def _of_the_step(self) -> set[int]:
        """Mutants whose step is changed: one that powers up otherwise, or has another parameter, steps like the model.

        It is not the model for that: what it powers up with, or is delivered with, is what is changed.
        """
        values = {number for steps in self.subject.mutants.settings.values() for number, _ in steps}
        return {number for number in self.left - values if self.subject.mutants[number].power_up is None}

    def _equivalent(self) -> None:
        asked, timeout = self._of_the_step(), self.timeout
        if not asked:
            return
        some = self.subject.mutants.some(asked)
        alike = in_either_reading(
            lambda left, integers: equivalent(some, left, integers, timeout),
            asked,
            uses_reals(self.subject.healthy(asked)),
        )
        for number in alike:
            self.settle(number, EQUIVALENT, "", "the same step in every state, whatever faults act")

    def _equivalent_at_power_up(self) -> None:
        """Another value at power-up that is gone after the first step, unseen, in all runs that claims are about."""
        healthy = single(self.subject.healthy(()), None)
        for number in sorted(self.left):
            mutant = self.subject.mutants[number]
            if mutant.power_up is None:
                continue
            seeing = [case for case in self.subject.proved if number in case.sees]
            about = [healthy, *(case.as_written for case in seeing)]
            if not any(number in case.restarting for case in seeing) and all(
                same_from_power_up(problem, mutant, uses_reals(problem), self.timeout) for problem in about
            ):
                self.settle(number, EQUIVALENT, "", "the same outputs at power-up, the same registers from then on")

    def _prove(self, case: Case) -> None:
        asked, told = self._asked(case), {}
        if asked:
            found = still_proved(case.some(asked), asked, case.integers, self.timeout)
            if found is None:
                told = {number: (self.open, "it has no proof by induction to compare with") for number in asked}
            else:
                told = {number: (self.lost, label) for number, label in found.failed.items()}
                told |= {number: (self.open, why) for number, why in found.open.items()}
        for number in self.left & case.sees & case.restarting:
            told[number] = self.open, "a fault gives the register its value at power-up again"
        for number, (where, why) in told.items():
            where.setdefault(number, {})[case] = why

    def _search_for_lost(self) -> None:
        """A proof that is lost may be so for a run that breaks the claim."""
        for case in self.subject.proved:
            numbers = {n for n in self.left if case in self.lost.get(n, ())}
            if not numbers:
                continue
            some = case.some(numbers)
            steps = min(case.claim.steps, SHORT)
            found = breakable(some, ~some.holds, numbers, steps, uses_reals(some), self.timeout)
            for number in found.failed:
                problem = self._single(case, number)
                run = search.bounded(problem, ~problem.holds, steps, uses_reals(problem), self.timeout).run
                if run is not None:
                    self._broken(number, case, course_of(problem, run), len(run) - 1)

    def _equivalent_for_claims(self, numbers: set[int], found: bool) -> None:
        """Equivalent in every state that proved lemmas and assumptions leave, for each claim that sees the mutant.

        Without faults it is so in all runs, or else the mutant might show in runs that none of the claims is about.
        With `found`, registers that were found to exclude one another do so too.
        """
        timeout, kept = self.timeout, numbers
        if not kept:
            return
        healthy = self.subject.healthy(kept)
        known = exclusions(single(healthy, None), timeout) if found else ()
        registers = {s.var.uid for s in self.subject.mutants.system.states}
        always = _alike(healthy, kept, timeout, (*known, *self._lemmas_for(registers, self.subject.open)))
        for case in self.subject.proved:
            asked = kept & case.sees
            if case.claim.anywhere:  # its states are those of no run: enough that its proof still goes through
                asked = {n for n in asked if case in self.lost.get(n, ()) or case in self.open.get(n, ())}
            if asked:
                some, as_written = case.some(asked), case.as_written
                if not case.proved:  # what its lemmas say may be false
                    some, as_written = replace(some, lemmas={}), replace(as_written, lemmas={})
                known = exclusions(as_written, timeout) if found else ()
                known = (*known, *self._lemmas_for(case.untouched, set(case.claim.symbolic)))
                kept = kept - asked | _alike(some, asked, timeout, known)
                always |= asked if case.unconditional else set()
        for number in sorted(kept & always):
            self.settle(number, EQUIVALENT, "", "the same step in every state that the claims' invariants leave")

    def _lemmas_for(self, registers: set[int], symbolic: set[str]) -> list[Bit]:
        """Lemmas of all runs, proved here, that speak of these registers only: so they hold for other claims too.

        A lemma that is proved with a parameter left open holds for each value of it.
        """
        return [
            lemma
            for case in self.subject.proved
            if case.proved and case.unconditional and symbolic <= set(case.claim.symbolic)
            for lemma in case.as_written.lemmas.values()
            if all(v.uid in registers for v in variables([lemma]))
        ]

    def _slack(self) -> None:
        """Where all proofs go through and the mutant is not equivalent: the run in which it differs."""
        for number in sorted(self.left - self.open.keys()):
            if number in self.differs or self._search_for_difference(number):
                self.settle(number, SLACK, *self.differs[number])
        for number in sorted(self.left):
            why = [f"{case.claim.id}: {why}" for case, why in self.open.get(number, {}).items()]
            silent = f"no run of up to {FAR} steps is known in which it differs"
            self.settle(number, UNDECIDED, "", "; ".join(why) or silent)

    def _search_for_difference(self, number: int) -> bool:
        mutant = self.subject.mutants[number]
        faulted = [
            (c.claim.id, c.problem) for c in self.subject.proved if c.claim.faults and number in c.sees - c.restarting
        ]
        for claim, problem in [("", self.subject.healthy({number})), *faulted]:
            some = only(problem, {number})
            found = difference(some, mutant, FAR, uses_reals(some), self.timeout / 4)
            if found is not None:
                self.differs[number] = claim, f"{found[1]} differs after {len(found[0])} steps"
                return True
        return False

"""Response times: that a conclusion is there once a condition has held for so many steps, without unrolling them.

Induction carries one bound along, so it adds up the worst that every register can hold at one moment; in the equipment
these worsts do not come together.  Here the steps are taken at once.  In turn:

    1. the watching register counts a step only while the condition holds, so it has held for `steps` steps in a row;
    2. each register is a sum of flows and carries (`safety.prove.flows`), and in the race between them there is a set
       `held` of states that is closed under these steps and entails the conclusion (`safety.prove.race`): without the
       conclusion at the end, none of the steps was in it;
    3. facts of one step outside that set: the sums, the ranges, what flows (`safety.prove.step_facts`);
    4. summed over the whole time, sampled around the first and the last events of a clock, they have no solution
       (`safety.prove.closed_form`).

1 to 3 are obligations like those of an induction, from any register content that the lemmas allow; all four are put to
every solver.  Nothing rests on how the facts were found.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import cast

from safety.prove.claims import BITS
from safety.prove.closed_form import ClosedForm, excluded, too_few
from safety.prove.extremes import NotFound
from safety.prove.flows import Reader, as_int, is_whole
from safety.prove.induction import Answer, Obligation, discharge, lemma_obligations
from safety.prove.problem import Problem
from safety.prove.race import changes, is_latch, races, reached
from safety.prove.solve import SAT, UNKNOWN, UNSAT, Disagreement
from safety.prove.step_facts import same_inputs, step_facts
from safety.prove.synthesis.sampling import conjuncts, plain
from safety.system import State
from safety.terms import Bit
from safety.terms.graph import Term, variables
from safety.terms.values import all_of

ENDS = (2, 3, 4)  # events of the clock that are sampled at each end


@dataclass(frozen=True)
class Response:
    """`premise` entails `conclusion`; where it holds, so does `condition`, for `steps` steps with this one.

    `watch` counts them.
    """

    watch: State
    condition: Bit
    steps: int
    premise: Bit
    conclusion: Bit


def by_response(
    problem: Problem, timeout: float, solvers: tuple[str, ...] = ("z3", "cvc5")
) -> tuple[Answer, str] | None:
    """The outcome and its method in words; None for a claim that is not about response times.

    Such a claim is `implies(persists(condition, steps) & ..., conclusion)` or a conjunction of these.  `timeout` is in
    seconds for each question.  Raises `Disagreement` when solvers differ.
    """
    wanted = responses(problem)
    if not wanted or problem.claim.arithmetic == BITS:
        return None
    answer = lemma_obligations(problem, True, timeout, solvers)
    sampled: set[int] = set()
    for response in wanted:
        if answer.proved:
            found, events = _prove(problem, response, timeout, solvers)
            answer = found.after(answer)
            sampled.add(events)
    if not answer.proved:
        return answer, ""
    steps = " and ".join(str(n) for n in sorted({r.steps for r in wanted}))
    return answer, f"closed form of {steps} steps, {max(sampled)} events sampled, integers"


def responses(problem: Problem) -> list[Response]:
    """The response times that a claim is made of; none where a part of it is of another form."""
    found = [_response(problem, part) for part in conjuncts(problem.holds)]
    return [r for r in found if r is not None] if None not in found else []


def _response(problem: Problem, part: Term) -> Response | None:
    if part.op != "implies":
        return None
    premise, conclusion = cast(tuple[Bit, Bit], part.args)
    for asked in conjuncts(premise):
        if asked.op == "le" and type((least := plain(asked.args[0])).attr) is int and least.is_const:
            for watch in problem.system.states:
                counts = watch.var is plain(asked.args[1]) and is_whole(watch.var)
                if counts and watch.power_up == 0 and watch.next.op == "select":
                    condition = cast(Bit, watch.next.args[0])
                    return Response(watch, condition, least.attr + 1, premise, conclusion)
    return None


def _prove(problem: Problem, response: Response, timeout: float, solvers: tuple[str, ...]) -> tuple[Answer, int]:
    """The outcome for one response time, and how many events of the clock were sampled."""
    answer, why = Answer(False), "no race decides it"
    try:
        for form, obligations in closed_forms(problem, response, timeout):
            answer = discharge(problem, obligations, True, timeout, solvers)
            if answer.proved:
                last, events = _exclude(problem, form, timeout, solvers)
                answer = last.after(answer)
                if answer.proved:
                    return answer, events
            why = answer.failed
    except NotFound as reason:
        why = str(reason)
    answer.proved, answer.agreed_by, answer.failed = False, [], f"response time: {why}"
    return answer, 0


def closed_forms(problem: Problem, response: Response, timeout: float) -> Iterator[tuple[ClosedForm, list[Obligation]]]:
    """For each race that may decide it, the closed form of the steps before the last, and what it rests on.

    Raises `NotFound` where the condition cannot hold, or the conclusion depends on too much.
    """
    states = reached(problem.system, [response.conclusion])
    known = (*problem.lemmas.values(), problem.given)
    base = (*known, response.condition)
    reader = Reader([s.var for s in problem.system.states], same_inputs(problem, states, base, timeout))
    change = changes(reader, states)
    read = {v.uid for v in variables([response.conclusion])}
    latches = [cast(Bit, s.var) for s in states if is_latch(s) and s.var.uid in read]
    for race in races(problem, reader, change, base, latches, timeout):
        try:
            facts = step_facts(problem, race, reader, change, base, response.steps - 1, timeout)
        except NotFound:
            continue
        inside, outside = (0, (*base, race.held)), (0, (*base, ~race.held))
        decided = (0, (*known, response.premise, race.held))
        yield (
            facts.form,
            [
                *_watching(response),
                Obligation("what is held stays held", True, (inside,), 1, race.held),
                Obligation("what is held concludes", True, (decided,), 0, response.conclusion),
                Obligation("facts of one step", True, (outside,), 0, all_of(*facts.always)),
                Obligation("sums of one step", True, (outside, (1, (~race.held,))), 0, all_of(*facts.moves)),
            ],
        )


def _watching(response: Response) -> list[Obligation]:
    """That the watch starts anew where the condition fails and counts no step twice; and the condition holds now."""
    now, then = as_int(response.watch.var), as_int(response.watch.next)
    counts = (response.condition | (then == 0)) & (then <= now + 1)
    return [
        Obligation("the watch counts steps in a row", True, (), 0, counts),
        Obligation("the condition holds now", True, ((0, (response.premise,)),), 0, response.condition),
    ]


def _exclude(problem: Problem, form: ClosedForm, timeout: float, solvers: tuple[str, ...]) -> tuple[Answer, int]:
    """The sum over the whole time, sampled at more and more events until it has no solution."""
    clock = form.clock()
    if clock is None:
        return Answer(False, failed="no carry comes at a rate that is known"), 0
    event, often = clock
    asked = 0
    for ends in (n for n in ENDS if 2 * n <= often):
        results: dict[str, str] = {}
        for name in solvers:
            if SAT not in results.values():
                results[name] = excluded(form, event, ends, name, timeout)
        asked += len(results)
        if UNSAT in results.values():
            if SAT in results.values():
                raise Disagreement(f"{problem.claim.id}: the sum over {form.steps} steps: {results}")
            enough = {name: too_few(form, event, 2 * ends, name, timeout) for name in solvers}
            agreed = [name for name in solvers if results[name] == enough[name] == UNSAT]
            silent = {n: "the sum over the whole time" for n in solvers if UNKNOWN in (results[n], enough[n])}
            return Answer(bool(agreed), agreed, "", {}, 0, asked + len(enough), silent), 2 * ends
    return Answer(
        False, failed="the sum over the whole time has solutions (states sampled, no run)", questions=asked
    ), 0

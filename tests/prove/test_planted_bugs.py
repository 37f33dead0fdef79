"""Each part of the prover that carries weight, broken on purpose: the comparison with enumeration turns red."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from safety import kinds
from safety.faults import ANY_TIME
from safety.prove import claims, induction, problem, prove, search, solve
from safety.prove.solve import Disagreement
from safety.system import State
from safety.terms import bit
from tests.prove.test_against_enumeration import verdicts

instrument = importlib.import_module("safety.faults.instrument")  # the package has a function of this name
Plant = Callable[[pytest.MonkeyPatch], None]

invariance, property_obligations, build = induction.invariance, induction.property_obligations, prove.build_problem


def no_lemma_at_power_up(m: pytest.MonkeyPatch) -> None:
    m.setattr(induction, "invariance", lambda p: [o for o in invariance(p) if "power-up" not in o.label])


def no_lemma_kept(m: pytest.MonkeyPatch) -> None:
    m.setattr(induction, "invariance", lambda p: [o for o in invariance(p) if "power-up" in o.label])


def lemmas_kept_from_power_up_only(m: pytest.MonkeyPatch) -> None:
    m.setattr(induction, "invariance", lambda p: [replace(o, anywhere=False) for o in invariance(p)])


def the_first_lemma_only(m: pytest.MonkeyPatch) -> None:
    m.setattr(induction, "invariance", lambda p: [o for o in invariance(p) if f"'{next(iter(p.lemmas))}'" in o.label])


def no_first_steps(m: pytest.MonkeyPatch) -> None:
    m.setattr(induction, "property_obligations", lambda p, k: property_obligations(p, k)[:1])


def one_first_step_too_few(m: pytest.MonkeyPatch) -> None:
    m.setattr(induction, "property_obligations", lambda p, k: property_obligations(p, k)[: max(k, 1)])


def property_from_power_up_only(m: pytest.MonkeyPatch) -> None:
    m.setattr(
        induction, "property_obligations", lambda p, k: [replace(o, anywhere=False) for o in property_obligations(p, k)]
    )


def property_assumed(m: pytest.MonkeyPatch) -> None:
    def assumed(p: Any, k: int) -> Any:
        return [replace(o, assumed=(*o.assumed, (o.step, (o.shown,)))) for o in property_obligations(p, k)]

    m.setattr(induction, "property_obligations", assumed)


def unknown_taken_for_unsat(m: pytest.MonkeyPatch) -> None:
    check = solve.Solver.check
    m.setattr(solve.Solver, "check", lambda self: "unsat" if check(self) == "unsat" else "unknown")


def premise_is_the_conclusion(m: pytest.MonkeyPatch) -> None:
    m.setattr(problem, "premises_of", lambda holds: [holds.args[1]] if holds.op == "implies" else [bit(True)])


def premises_met_by_any(m: pytest.MonkeyPatch) -> None:
    def first(p: Any, *rest: Any) -> None:
        found = search.bounded(p, p.premise, p.claim.steps, False, 20)
        rest[0].premise_at = len(found.run) - 1 if found.run else None

    m.setattr(prove, "show_premises", first)


def with_problem(change: Callable[[Any], Any]) -> Plant:
    return lambda m: m.setattr(prove, "build_problem", lambda *args: change(build(*args)))


def budget_forgotten(m: pytest.MonkeyPatch) -> None:
    m.setattr(problem, "within", lambda budget, faulted: bit(True))


def power_up_anywhere(m: pytest.MonkeyPatch) -> None:
    init = solve.Unrolling.__init__
    m.setattr(
        solve.Unrolling,
        "__init__",
        lambda self, system, solver, integers, anywhere=False: init(self, system, solver, integers, True),
    )


def one_step_less(m: pytest.MonkeyPatch) -> None:
    bounded = search.bounded

    def shorter(p: Any, target: Any, steps: int, *rest: Any, **more: Any) -> search.Found:
        found = bounded(p, target, steps - 1, *rest, **more)
        return found if found.run else replace(found, searched=steps)

    m.setattr(search, "bounded", shorter)


def not_the_shortest(m: pytest.MonkeyPatch) -> None:
    check = solve.Solver.check
    asked: dict[int, int] = {}

    def late(self: solve.Solver) -> str:
        asked[id(self.raw)] = asked.get(id(self.raw), 0) + 1
        return "unsat" if asked[id(self.raw)] == 1 and self.finite else check(self)

    m.setattr(solve.Solver, "check", late)


def monitor(name: str, make: Callable[..., Any]) -> Plant:
    def plant(m: pytest.MonkeyPatch) -> None:
        register = claims._register

        def wrong(key: Any, honest: Callable[[str], State]) -> Any:
            return register(key, (lambda label: make(honest(label))) if key[0] == name else honest)

        m.setattr(claims, "_register", wrong)

    return plant


def activity(make: Callable[..., Any]) -> Plant:
    """Another answer to whether a fault is present, acts and has acted before."""

    def plant(m: pytest.MonkeyPatch) -> None:
        honest = instrument._Instrument.activity
        m.setattr(instrument._Instrument, "activity", lambda self, i, *rest: make(*honest(self, i, *rest)))

    return plant


def effects_swapped(m: pytest.MonkeyPatch) -> None:
    m.setattr(instrument, "choose", lambda condition, then, otherwise: kinds.choose(condition, otherwise, then))


def memory_frozen_too_late(m: pytest.MonkeyPatch) -> None:
    m.setattr(kinds.Seat, "then", lambda self, register, value: None)


def once_on_stays_not(m: pytest.MonkeyPatch) -> None:
    honest = instrument._Instrument.activity

    def forgetful(self: Any, index: int, fault: Any, present: bool | None) -> Any:
        found = honest(self, index, fault, present)
        if fault.onset == ANY_TIME:
            self.states[-1] = replace(self.states[-1], next=self.states[-1].var)
        return found

    m.setattr(instrument._Instrument, "activity", forgetful)


PLANTS: dict[str, Plant] = {
    "no lemma at power-up": no_lemma_at_power_up,
    "no lemma kept": no_lemma_kept,
    "lemmas kept from power-up only": lemmas_kept_from_power_up_only,
    "the first lemma only": the_first_lemma_only,
    "no first steps": no_first_steps,
    "one first step too few": one_first_step_too_few,
    "property from power-up only": property_from_power_up_only,
    "property assumed": property_assumed,
    "premise is the conclusion": premise_is_the_conclusion,
    "premises met by any": premises_met_by_any,
    "budget forgotten": budget_forgotten,
    "given forgotten": with_problem(lambda p: replace(p, given=bit(True))),
    "start forgotten": with_problem(lambda p: replace(p, start=bit(True))),
    "start at every step": with_problem(lambda p: replace(p, given=p.given & p.start)),
    "power-up anywhere": power_up_anywhere,
    "one step less": one_step_less,
    "not the shortest": not_the_shortest,
    "never refuted": unknown_taken_for_unsat,
    "once forgets": monitor("once", lambda s: replace(s, next=s.var)),
    "age forgets nothing": monitor("age", lambda s: replace(s, next=s.next.args[1])),
    "previous is true at first": monitor("previous", lambda s: replace(s, power_up=True)),
    "total starts at one": monitor("total", lambda s: replace(s, power_up=1)),
    "a fault acts though absent": activity(lambda there, active, acted: (there, ~active, acted)),
    "a fault has acted before": activity(lambda there, active, acted: (there, active, bit(True))),
    "a fault goes again": once_on_stays_not,
    "effects swapped": effects_swapped,
    "memory frozen": memory_frozen_too_late,
}


SELDOM_SEEN = {"lemmas kept from power-up only": 750, "the first lemma only": 490}  # first seed to look at


@pytest.mark.parametrize("name", PLANTS)
def test_a_planted_bug_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    PLANTS[name](monkeypatch)
    first = SELDOM_SEEN.get(name, 0)
    with pytest.raises((AssertionError, Disagreement)):
        verdicts(range(first, first + 300))

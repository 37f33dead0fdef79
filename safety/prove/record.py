"""Outcomes as entries of the results document, and the short texts shown on a terminal."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

from safety.faults import FROM_START, PREFIX, now_name, present_name
from safety.prove.claims import REFUTED, Claim
from safety.prove.hazards import CutSets, Hazard
from safety.prove.problem import Problem, named_in
from safety.prove.prove import Outcome
from safety.system import ANY
from safety.trace import Trace

SHOWN_FAULTS = 8  # names in the text of a fault budget; all stand beside it
_ADDED = re.compile(rf"watch\.|{PREFIX}\d+(\.|$)")  # registers that the proof adds to the model's own


def claim_entry(outcome: Outcome) -> dict[str, Any]:
    """A claim's entry under "claims" (keys: the results document)."""
    claim, problem = outcome.claim, outcome.problem
    return {
        "id": claim.id,
        "model": claim.model.__name__,
        "requirement": claim.requirement or None,
        "source": claim.source or None,
        "statement": claim.statement,
        "role": claim.role,
        "twin_of": claim.twin_of,
        "expect": claim.expect,
        "verdict": outcome.verdict,
        "as_expected": outcome.as_expected,
        "strength": {"kind": outcome.verdict, "steps": outcome.steps},
        "faults": fault_text(claim, problem),
        "fault_budget": fault_budget(claim, problem),
        "method": outcome.method or None,
        "why": outcome.why or None,
        "user_lemmas": len(claim.lemmas),
        "found_lemmas": len(outcome.found),
        "lemmas": list(problem.lemmas) if problem else [],
        "agreed_by": outcome.agreed_by,
        "certificate": None,
        "candidate": {path: _plain(v) for path, v in outcome.candidate.items()} or None,
        "seconds": round(outcome.seconds, 3),
        "questions": outcome.questions,
        "vacuity": _vacuity(outcome),
        "counterexample": counterexample(outcome) if outcome.counterexample else None,
        **surroundings(problem),
    }


def fault_text(claim: Claim, problem: Problem | None) -> str | None:
    """The fault budget in words: `at most 1 of 3: a, b, c`."""
    budget = fault_budget(claim, problem)
    if not budget["of"]:
        return None
    most = "any number" if budget["most"] is None else f"at most {budget['most']}"
    shown = ", ".join(budget["of"][:SHOWN_FAULTS]) + (", ..." if len(budget["of"]) > SHOWN_FAULTS else "")
    return f"{most} of {len(budget['of'])}: {shown}"


def fault_budget(claim: Claim, problem: Problem | None) -> dict[str, Any]:
    """The fault budget: how many at most (None: any number), of which."""
    names = [str(f) for f in problem.faults] if problem else []
    return {"most": claim.faults.most if claim.faults else 0, "of": names}


def surroundings(problem: Problem | None) -> dict[str, Any]:
    """Clock, power-up, parameters with source tags, assumptions."""
    if problem is None:
        return {}
    system = problem.system
    registers = [s for s in system.states if not _ADDED.match(s.path)]
    formulas = {"given": problem.claim.given, "start": problem.claim.start}
    return {
        "clock": {"tick_s": str(system.clock.period)} if system.clock.period else {"event": system.clock.event},
        "power_up": ", ".join(f"{s.path}={_show(s.power_up)}" for s in registers),
        "parameters": [
            {
                "name": p.path,
                "value": _plain(p.value),
                "unit": p.unit,
                "low": _plain(p.low),
                "high": _plain(p.high),
                "source": p.source,
            }
            for p in system.settings.values()
        ],
        "tags": sorted({p.tag for p in system.settings.values()}),
        "assumptions": [
            *system.assumptions,
            *(f"{role}: {' '.join((f.__doc__ or f.__name__).split())}" for role, f in formulas.items() if f),
        ],
    }


def counterexample(outcome: Outcome) -> dict[str, Any]:
    """The replayed run of a refuted claim: the signals that tell its story, each with all its changes."""
    trace, problem = outcome.counterexample, outcome.problem
    assert trace is not None and problem is not None
    present = [str(f) for i, f in enumerate(problem.faults) if _present(trace, i)]
    return {
        **trace.to_json(story(trace, problem)),
        "violated_at": len(trace) - 1,
        "replayed": True,
        "faults": present,
        "fault_onset": _onset(trace, problem),
        "chosen": {p: _plain(v) for p, v in trace.chosen.items()},
        "replay": f"rightside replay {outcome.claim.id}",
        "vcd": f"{outcome.claim.id}.vcd",
    }


def _vacuity(outcome: Outcome) -> dict[str, Any] | None:
    """Where the premise was first reached; None for a claim without one, or whose verdict does not need it."""
    if outcome.problem is None or outcome.problem.premise.is_const or outcome.verdict == REFUTED:
        return None
    return {"premise_reached_at": outcome.premise_at}


def _onset(trace: Trace, problem: Problem) -> int | None:
    """The first step at which a fault that is present acts."""
    first: list[int] = []
    for i, fault in enumerate(problem.faults):
        now = trace.columns.get(now_name(i), [])
        if _present(trace, i) and (fault.onset == FROM_START or True in now):
            first.append(0 if fault.onset == FROM_START else now.index(True))
    return min(first, default=None)


def story(trace: Trace, problem: Problem) -> list[str]:
    """Signals worth showing: those the claim names, inputs and outputs of the whole, then those that seldom change."""
    return [*trace.telling(list(named_in(problem))), "claim.premise", "claim.holds"]


def _present(trace: Trace, index: int) -> bool:
    column = trace.columns.get(present_name(index))
    return bool(column and column[0])


def cut_set_entry(result: CutSets, hazard: Hazard) -> dict[str, Any]:
    """What the tree's entry says about how its cut sets were found."""
    return {
        "id": result.id,
        "statement": hazard.claim.statement,
        "requirement": hazard.claim.requirement or None,
        "complete_to_order": result.complete_to,
        "complete_at_all_orders": result.all_orders,
        "why": result.why or None,
        "agreed_by": result.agreed_by,
        "minimal_by": result.minimal_by,
        "not_minimal": [list(one) for one in result.not_minimal],
        "confirmed": result.by_order("confirmed"),
        "candidate": result.by_order("candidate"),
        "cut_sets": [{"faults": list(s.faults), "status": s.status, "steps": s.steps} for s in result.sets],
    }


def _plain(value: Any) -> Any:
    return str(value) if isinstance(value, Fraction) else value


def _show(value: Any) -> str:
    return "ANY" if value is ANY else str(value)

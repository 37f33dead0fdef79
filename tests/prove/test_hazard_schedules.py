"""Cut sets of a voter against all schedules of its faults; that no part of a set suffices; what there is at any time.

The equipment is small enough to walk through every state that inputs, onsets and free choices can lead to, on the
Python reading, with no solver, claim or lemma.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

from safety.faults import (
    ANY_TIME,
    INTERMITTENT,
    TRANSIENT,
    Fault,
    byzantine,
    delayed,
    flip,
    frozen,
    instrument,
    stuck,
)
from safety.model import Model, point, power_up
from safety.prove import hazards
from safety.prove.claims import Scenario, Seen, age, persists, struck
from safety.prove.hazards import CANDIDATE, CONFIRMED, Hazard, cut_sets
from safety.prove.problem import build_problem
from safety.prove.prove import Limits
from safety.prove.solve import Disagreement, Solver
from safety.terms import Bit, at_least, implies
from safety.terms.graph import BIT
from safety.trace import Stepper, initial_state
from safety.tracing import trace
from tests.prove.test_hazards import WELDED, Votes, braking, declared, minimal, moves

# --- brute force over all schedules --------------------------------------------------------------------------------


class Voter(Model, event="tick"):
    """Three channels ask for the brake when it is too fast; two of three are believed; a relay acts a step later."""

    asked: Bit = power_up(False)

    def step(self, fast: Bit) -> tuple[Voter, Bit]:
        a, b, c = (point(name, fast) for name in "abc")
        vote = point("vote", (a & b) | (b & c) | (a & c))
        return Voter(asked=vote), point("brake", self.asked)


STRIKING = [
    Fault(stuck(0), ["a"], ANY_TIME, name="a dead"),
    Fault(stuck(1), ["a"], ANY_TIME, name="a asks always"),
    Fault(byzantine(), ["b"], ANY_TIME, name="b anything"),
    Fault(flip(), ["c"], TRANSIENT, ticks=1, name="c flips once"),
    Fault(delayed(1), ["c"], ANY_TIME, name="c late"),
    Fault(stuck(0), ["vote"], INTERMITTENT, name="vote loose"),
    Fault(frozen(), ["vote"], ANY_TIME, name="vote frozen"),
    Fault(stuck(0), ["brake"], name="brake cut"),
]
LONG = 3  # steps too fast, after which there has to be a brake


def runs_on(s: Seen) -> Bit:
    return persists(s.fast, LONG) & ~s.out


def voted(s: Seen) -> Bit:
    """A lemma: a step after two steps too fast the relay is asked, unless the vote or two channels have failed."""
    channels = [struck(s, "a dead"), struck(s, "b anything"), struck(s, "c flips once", "c late")]
    excused = struck(s, "vote loose", "vote frozen") | at_least(2, *channels)
    return implies((age(s.fast, LONG) >= 2) & ~s.asked, excused)


def in_time(names: tuple[str, ...]) -> list[Scenario]:
    """Too fast from some step on, the faults from another."""
    values = {"b": False} if "b anything" in names else {}
    starts = itertools.product(range(4), range(8))
    return [Scenario(8, {"fast": lambda k, n=n: k >= n}, at=at, values=values) for n, at in starts]  # type: ignore[misc]


def by_schedules(names: Sequence[str]) -> bool:
    """Whether the hazard can happen with these faults in: all inputs, onsets and free choices, without end."""
    built = instrument(trace(Voter), [f for f in STRIKING if f.name in names])
    stepper = Stepper.of(built.system, ["brake"])
    free = list(itertools.product([False, True], repeat=len(built.system.inputs)))
    assert all(var.sort == BIT for var in built.system.inputs.values())
    fast = list(built.system.inputs).index("fast")
    starts = [(initial_state(built.system, {})[0], 0)]
    seen, edge = set(starts), starts
    for state, before in edge:  # grows while it is walked
        for given in free:
            result = stepper.function(*state, *given)
            lasting = min(before + 1, LONG) if given[fast] else 0
            if lasting == LONG and not result[len(state)]:
                return True
            following = (result[: len(state)], lasting)
            if following not in seen:
                seen.add(following)
                edge.append(following)
    return False


def pairs_by_schedules() -> list[tuple[str, ...]]:
    names = [fault.name for fault in STRIKING]
    return minimal([s for n in range(3) for s in itertools.combinations(names, n) if by_schedules(s)])


def voter() -> Hazard:
    return declared(runs_on, Voter, STRIKING, scenarios=in_time, lemmas=[voted], most=2)


def test_singles_and_pairs_are_those_of_all_schedules() -> None:
    found = cut_sets(voter())
    assert sorted(s.faults for s in found.sets if s.status == CONFIRMED) == pairs_by_schedules() == sorted([
        ("vote loose",), ("vote frozen",), ("brake cut",),
        ("a dead", "b anything"), ("a dead", "c flips once"), ("b anything", "c flips once"),
    ])  # fmt: skip
    candidates = [s.faults for s in found.sets if s.status == CANDIDATE]
    assert candidates == [("a dead", "c late"), ("b anything", "c late")]  # late only once: the lemma forgives too much
    assert found.complete_to == 2


def test_a_schedule_that_is_left_out_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    tame = [replace(f, kind=stuck(1)) if f.name == "b anything" else f for f in STRIKING]
    monkeypatch.setitem(globals(), "STRIKING", tame)
    truth = pairs_by_schedules()
    monkeypatch.undo()
    assert truth != sorted(s.faults for s in cut_sets(voter()).sets if s.status == CONFIRMED)


# --- minimality ----------------------------------------------------------------------------------------------------


def test_each_solver_shows_that_no_part_of_a_set_suffices() -> None:
    found = cut_sets(declared(moves, Votes, WELDED, scenarios=braking))
    assert (found.minimal_by, found.not_minimal) == (["z3", "cvc5"], [])
    assert cut_sets(voter()).minimal_by == ["z3", "cvc5"]
    nothing = cut_sets(declared(lambda s: s.brake, Votes, WELDED, scenarios=braking))
    assert (nothing.minimal_by, nothing.not_minimal) == (["z3", "cvc5"], [])


def test_a_set_with_a_fault_too_many_is_flagged() -> None:
    hazard = declared(moves, Votes, WELDED, scenarios=braking)
    found = cut_sets(hazard)
    found.sets += [hazards.CutSet(faults, CONFIRMED) for faults in (("c", "output"), ("a", "b", "c"))]
    hazards._check_minimal(build_problem(hazard.claim), found, Limits(20))
    assert (found.not_minimal, found.minimal_by) == ([("c", "output"), ("a", "b", "c")], [])
    assert found.why == "not minimal: a part suffices of c + output; a + b + c"


def test_solvers_that_differ_on_a_part_stop_everything(monkeypatch: pytest.MonkeyPatch) -> None:
    parts = hazards._parts
    lying = {"sat": {("a", "b")}}

    def split(problem: Any, sets: Any, solver: str, limits: Limits) -> Any:
        return ("sat", lying["sat"]) if solver == "cvc5" else parts(problem, sets, solver, limits)

    monkeypatch.setattr(hazards, "_parts", split)
    with pytest.raises(Disagreement, match="whether a part of a cut set suffices"):
        cut_sets(declared(moves, Votes, WELDED, scenarios=braking))


def test_a_solver_without_an_answer_shows_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    check = Solver.check
    monkeypatch.setattr(Solver, "check", lambda self: "unknown" if self.name == "cvc5" else check(self))
    found = cut_sets(declared(moves, Votes, WELDED, scenarios=braking))
    assert (found.minimal_by, found.not_minimal) == (["z3"], [])


# --- what there is at any time -------------------------------------------------------------------------------------


def test_progress_is_shown_what_there_is_after_each_order() -> None:
    seen: list[tuple[int, int]] = []
    cut_sets(
        declared(moves, Votes, WELDED, scenarios=braking),
        progress=lambda so: seen.append((so.complete_to, len(so.sets))),
    )
    assert seen == [(0, 0), (1, 1), (2, 4), (3, 4), (4, 4)]

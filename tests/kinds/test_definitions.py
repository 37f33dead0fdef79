"""Each kind is its definition: what a run shows is allowed, and a proof allows just what is allowed."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import pytest

from safety.faults import ANY_TIME, FROM_START, INTERMITTENT, ONSETS, TRANSIENT, Fault, instrument, schedule
from safety.kinds import Kind, Part, Seat, choose, makers
from safety.prove.solve import SAT, UNSAT, Solver, Unrolling
from safety.system import ANY, ModelError
from safety.terms.graph import BIT, integer
from safety.terms.values import build, const
from safety.trace import run
from safety.tracing import trace
from tests.kinds import by_hand
from tests.kinds.by_hand import CASES, IDLE, VALUES, Case, Desk, allowed, patterns

DESK = trace(Desk)
STEPS, TICKS = 4, 2
ANYTHING = {"byzantine", "power dip"}  # kinds after which nothing is strange, somewhere


def onset_of(case: Case, onset: str, at: int = 0, ticks: int | None = TICKS) -> Fault:
    limited = ticks if onset == TRANSIENT else None
    return Fault(case.kind, case.at, onset, at=0 if onset == FROM_START else at, ticks=limited)


def given_at_random(case: Case, rng: random.Random, steps: int) -> list[Any]:
    rows = [tuple(rng.choice(VALUES[name]) for name in case.given) for _ in range(steps)]
    return [row if len(row) > 1 else row[0] for row in rows]


def row(case: Case, given: Any) -> dict[str, Any]:
    values = given if len(case.given) > 1 else (given,)
    return IDLE | dict(zip(case.given, values, strict=True))


def shown_in_run(case: Case, fault: Fault, given: Sequence[Any], start: dict[str, Any]) -> list[Any]:
    faulted = instrument(DESK, [fault])
    choose = schedule(faulted)
    start = {s.path: start[s.path] for s in faulted.system.states if s.power_up is ANY and s.path in start}
    found = run(faulted.system, lambda k: row(case, given[k]) | choose(k), len(given), start=start)
    columns = [found[name] for name in case.shown]
    return [*zip(*columns, strict=True)] if len(columns) > 1 else columns[0]


def runs_as_defined(case: Case) -> bool:
    """Whether runs of 24 steps, of every onset, show what the rule allows."""
    rng = random.Random(str(case))
    for onset in ONSETS:
        for at in (0, 3, 17):
            fault = replace(onset_of(case, onset, at, 5), ticks={TRANSIENT: 5, INTERMITTENT: 9}.get(onset))
            given = given_at_random(case, rng, 24)
            first, end = fault.window()
            acts = [first <= t and (end is None or t < end) for t in range(24)]
            start = {f"fault0.{case.at[0]}.last": rng.choice(VALUES[case.given[0]]), "cell.kept": rng.randrange(4)}
            if not allowed(case, acts, given, shown_in_run(case, fault, given, start)):
                return False
    return True


class Asked:
    """Questions about courses of values of a system with a fault, put to a solver one after the other."""

    def __init__(self, case: Case, fault: Fault) -> None:
        self.case = case
        self.faulted = instrument(DESK, [fault]).system
        self.unrolling = Unrolling(self.faulted, "z3", integers=True)
        self.solver = Solver("z3", self.unrolling.k, 20)
        self.known: dict[Any, Any] = {}

    def _is(self, step: int, name: str, value: Any) -> Any:
        key = step, name, value
        if key not in self.known:
            term = self.faulted.lookup(name)
            same = build("eq", (term, const(value, term.sort)), None, BIT)
            self.known[key] = self.unrolling.at(step, [same])[0]
            self.solver.add_ranges(self.unrolling)
        return self.known[key]

    def possible(self, given: Sequence[Any], shown: Sequence[Any]) -> bool:
        """Whether there is a run that shows this."""
        facts = []
        for k, now in enumerate(shown):
            facts += [self._is(k, name, value) for name, value in row(self.case, given[k]).items()]
            values = now if len(self.case.shown) > 1 else (now,)
            facts += [self._is(k, name, value) for name, value in zip(self.case.shown, values, strict=True)]
        self.solver.push()
        self.solver.add(*facts)
        answer = self.solver.check()
        self.solver.pop()
        assert answer in (SAT, UNSAT)
        return answer == SAT


def courses(case: Case, onset: str, given: Sequence[Any], rng: random.Random) -> Iterator[tuple[Any, ...]]:
    """Courses of values that the rule allows, each followed by some of which one value is another."""
    values = [*itertools.product(case.values, repeat=2)] if len(case.shown) > 1 else list(case.values)
    ways = [*patterns(onset, TICKS, len(given))]
    for _ in range(12):
        acts = rng.choice(ways)
        shown: list[Any] = []
        for t in range(len(given)):
            shown.append(rng.choice([v for v in values if case.rule(t, acts, given, [*shown, v])]))
        yield tuple(shown)
        for _ in range(3):
            k = rng.randrange(len(given))
            yield (*shown[:k], rng.choice(values), *shown[k + 1 :])


def proves_as_defined(case: Case) -> bool:
    """Whether the solver finds the courses of values that the rule allows, those of runs among them, and no others."""
    rng = random.Random(str(case))
    for onset in (FROM_START, rng.choice([ANY_TIME, TRANSIENT, INTERMITTENT])):
        fault = onset_of(case, onset)
        asked = Asked(case, fault)
        given = given_at_random(case, rng, STEPS)
        answers = {asked.possible(given, shown_in_run(case, fault, given, {}))}
        for shown in courses(case, onset, given, rng):
            allows = any(allowed(case, acts, given, shown) for acts in patterns(onset, TICKS, STEPS))
            answers.add(allows)
            if asked.possible(given, shown) != allows:
                return False
        if True not in answers or (onset == FROM_START and False not in answers and case.kind.name not in ANYTHING):
            return False
    return True


@pytest.mark.parametrize("case", CASES, ids=str)
def test_a_run_shows_what_the_definition_says(case: Case) -> None:
    assert runs_as_defined(case)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_a_proof_allows_what_the_definition_says_and_nothing_else(case: Case) -> None:
    assert proves_as_defined(case)


def test_every_kind_has_a_definition() -> None:
    assert makers().keys() <= {*by_hand._cases.__code__.co_names}


# --- a kind that is not its definition is found ---------------------------------------------------------------------


def planted() -> Iterator[Case]:
    """Cases with another kind than the one that they define: the next that acts on the same."""
    alike = ({"stuck-at-0", "open"}, {"stuck-at-1", "welded"})
    for shown in dict.fromkeys(case.shown for case in CASES):
        same = [case for case in CASES if case.shown == shown]
        for one, other in zip(same, [*same[1:], same[0]], strict=True):
            if one is not other and not any({one.kind.name, other.kind.name} <= names for names in alike):
                yield replace(one, kind=other.kind)


def _noise_upwards(seat: Seat, healthy: Any) -> Any:
    return (healthy + seat.free("value", BIT).word()).sat(2)


def _frozen_at_zero(seat: Seat, healthy: Any) -> Any:
    last = seat.register("last", healthy.sort, 0)
    seat.then(last, choose(seat.active, last, healthy))
    return last


def _dip_to_zero(seat: Seat, part: Part) -> tuple[Any, ...]:
    return tuple(const(s.power_up if s.power_up is not ANY else 0, s.var.sort) for s in part.states)


def _drawn_too_far(seat: Seat, healthy: Any) -> Any:
    chosen = seat.free("value", integer(-1, 1), lambda point, step: 2)
    return (healthy + chosen).sat(2)


NARROW = {  # what a proof would not see though a run may be right
    "noise of 1": Kind("noise of 1", "", _noise_upwards),
    "frozen": Kind("frozen", "", _frozen_at_zero),
    "power dip": Kind("power dip", "", update=_dip_to_zero),
}


@pytest.mark.parametrize("case", [*planted()], ids=str)
def test_another_kind_in_its_place_is_found(case: Case) -> None:
    assert not (runs_as_defined(case) and proves_as_defined(case))


def test_a_proof_that_leaves_out_what_may_be_is_found() -> None:
    for name, kind in NARROW.items():
        for case in [c for c in CASES if c.kind.name == name and c.shown in (("word",), ("cell.kept",))]:
            assert runs_as_defined(replace(case, kind=kind)) or name == "noise of 1"
            assert not proves_as_defined(replace(case, kind=kind))


def test_a_run_that_takes_what_a_proof_does_not_allow_is_refused() -> None:
    (case,) = (c for c in CASES if c.kind.name == "noise of 1")
    with pytest.raises(ModelError, match="2 is not a value of it"):
        runs_as_defined(replace(case, kind=Kind("too far", "", _drawn_too_far, ("uint",))))

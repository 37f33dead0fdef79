"""Directed simulation: deep violations and premises are found, what is given is kept, nothing false is reported."""

from __future__ import annotations

from typing import Any, NamedTuple

import pytest

from safety.faults import ANY_TIME, Fault, at_most, byzantine
from safety.model import ANY, Model, parameter, point, power_up
from safety.prove import falsify as searched
from safety.prove.claims import Formula, age, previous, total
from safety.prove.falsify import falsify, reach
from safety.prove.problem import Problem, build_problem
from safety.prove.solve import Disagreement
from safety.terms import U4, U8, U16, U20, Bit, Real, implies, real, select
from tests.prove.small import asked


class Odometer(Model, event="tick"):
    """Adds what it is given; counts how often it was not."""

    way: U20 = power_up(0)
    rest: U4 = power_up(ANY)

    def step(self, x: U16, go: Bit) -> Odometer:
        return Odometer(way=(self.way + select(go, x, 0)).sat(20), rest=select(go, 0, (self.rest + 1).sat(4)))


class Seal(NamedTuple):
    open: Bit


class Sealed(Model, event="tick"):
    """Opens at a word that nobody guesses."""

    key: U16 = power_up(ANY)
    n: U8 = power_up(0)

    def step(self, x: U16) -> tuple[Sealed, Seal]:
        return Sealed(key=(self.key * 5 + 7).low(16), n=(self.n + 1).sat(8)), Seal(open=point("open", x == self.key))


class Slow(Model, event="tick"):
    """Counts by a word that is left open."""

    k: U8 = parameter(3, unit="1", within=(1, 9), source="[A]")
    n: U20 = power_up(0)

    def step(self) -> Slow:
        return Slow(n=(self.n + self.k).sat(20))


class Exact(Model, event="tick"):
    r: Real = power_up(0)

    def step(self, x: Bit) -> Exact:
        return Exact(r=self.r + select(x, real(1), real(0)))


def problem(formula: Formula, model: type[Model] = Odometer, **changes: Any) -> Problem:
    return build_problem(asked(formula, model, **changes))


def test_a_violation_thousands_of_steps_deep_is_found() -> None:
    run = falsify(problem(lambda s: s.way < 30_000, given=lambda s: s.x <= 7), 10_000, 20)
    assert run is not None and len(run) >= 30_000 // 7
    assert run["claim.holds"][-1] is False and all(run["claim.holds"][:-1]) and all(run["claim.given"])


def test_a_premise_is_reached() -> None:
    held = problem(lambda s: implies(age(s.go & (s.x == 77), 900) >= 900, s.way >= 77 * 900))
    (premise,) = held.premises
    run = reach(held, premise, 5000, 20)
    assert run is not None and run["claim.premise"][-1] is True and len(run) == 901
    assert falsify(held, 1500, 0.5) is None


def test_what_random_inputs_never_meet_the_solver_does() -> None:
    run = falsify(problem(lambda s: s.n < 40, Sealed, given=lambda s: s.open), 100, 60)
    assert run is not None and len(run) == 41 and all(run["open"])


def test_assumptions_that_contradict_give_no_run() -> None:
    assert falsify(problem(lambda s: s.n < 3, Sealed, given=lambda s: (s.x == 1) & (s.x == 2)), 50, 2) is None


def test_the_start_is_kept() -> None:
    only = problem(lambda s: s.rest != 9, start=lambda s: (s.rest == 4) | (s.rest == 11))
    run = falsify(only, 50, 20)
    assert run is not None and run["rest"][0] in (4, 11)


def test_at_most_one_fault_is_present() -> None:
    faults = [Fault(byzantine(), ["open"], ANY_TIME, name=f"f{i}") for i in range(6)]
    run = falsify(problem(lambda s: ~s.open, Sealed, faults=at_most(1, faults), given=lambda s: s.n >= s.n), 50, 20)
    assert run is not None and sum(run[f"fault{i}"][0] for i in range(6)) <= 1


def test_an_open_parameter_stays_in_its_range() -> None:
    fast, slow = (problem(lambda s, n=n: s.n != n, Slow, symbolic=["k"]) for n in (9 * 2000, 2000))
    run = falsify(fast, 2001, 20)
    assert run is not None and run["k"][0] == 9
    late = falsify(slow, 2001, 20)
    assert late is not None and 1 <= late["k"][0] <= 9
    assert falsify(problem(lambda s: s.n < 1001 * 9, Slow, symbolic=["k"]), 1001, 1) is None


def test_a_register_that_holds_an_input_keeps_it() -> None:
    """Lanes of an input are new at each step: a register may hold those of the step before."""
    assert falsify(problem(lambda s: implies(previous(s.go, False), s.rest == 0)), 300, 1) is None


def test_sums_are_followed() -> None:
    run = falsify(problem(lambda s: total(s.x, 60_000) < 60_000, given=lambda s: s.x <= 9), 10_000, 20)
    assert run is not None and len(run) > 60_000 // 9


def test_the_same_seed_finds_the_same_run() -> None:
    first, second = (falsify(problem(lambda s: s.way < 50), 100, 20, seed=5) for _ in "12")
    assert first is not None and second is not None and first.columns == second.columns


def test_reals_are_left_to_the_solver() -> None:
    assert falsify(problem(lambda s: s.r < 1, Exact), 10, 5) is None


def test_it_ends_in_time() -> None:
    assert falsify(problem(lambda s: s.way.int() < 1 << 20), 100_000, 1) is None  # or hangs


def test_a_run_that_is_none_is_not_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = problem(lambda s: s.way < 30_000)

    def astray(self: Any, corners: Any) -> Any:
        return self._replayed({}, [{"x": 0, "go": False}])

    monkeypatch.setattr(searched._Hunt, "_standing", astray)
    with pytest.raises(Disagreement):
        falsify(wrong, 100, 5)

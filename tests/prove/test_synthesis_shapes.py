"""Templates over shapes: each finds the lemma that a proof needs, and none proves a near miss."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Annotated, Any

import pytest

from safety.model import Model, power_up
from safety.prove.claims import BITS, INTEGERS, PROVED, Formula, Seen, age, once, previous
from safety.prove.induction import by_induction
from safety.prove.problem import Problem, build_problem
from safety.prove.prove import Limits, prove
from safety.prove.synthesis.candidates import fit
from safety.prove.synthesis.houdini import Pruner
from safety.prove.synthesis.sampling import Sampler, joined
from safety.prove.synthesis.shapes import codes, congruences, courses, differences, limits, tables
from safety.prove.synthesis.synthesise import Found, layers, synthesise
from safety.prove.synthesis.templates import Neighbourhood, atoms, ceilings
from safety.terms import Bit, UInt, count, implies, select
from tests.prove.small import asked

U3, U4, U5 = (Annotated[UInt, n] for n in (3, 4, 5))


BOTH = ("z3", "cvc5")


def proof(model: type[Model], formula: Formula, given: Formula | None = None) -> tuple[Found, list[str]]:
    """The lemmas that were found, and the solvers that prove them and the property."""
    problem = build_problem(asked(formula, model, given=given))
    found = synthesise(problem, 10)
    if found.depth is None:
        return found, []
    whole = replace(problem, lemmas=found.lemmas)
    return found, by_induction(whole, found.depth, found.arithmetic == INTEGERS, 10, BOTH).agreed_by


def next_to(value: UInt, turns: int) -> UInt:
    return select(value == turns - 1, 0, (value + 1).low(value.width))


# --- codes ---------------------------------------------------------------------------------------------------------


def gray(width: int, turns: int) -> type[Model]:
    class Gray(Model, event="tick"):
        n: Annotated[UInt, width] = power_up(0)
        code: Annotated[UInt, width] = power_up(0)

        def step(self, go: Bit) -> Gray:
            n = select(go, next_to(self.n, turns), self.n)
            return Gray(n=n, code=n ^ (n >> 1).widen(width))

    return Gray


def one_bit(s: Seen) -> Bit:
    change = s.code ^ previous(s.code, 0)
    return count(*(change.bit(i) for i in range(change.width))) <= 1


def test_a_code_is_read_off_the_model_and_proved_in_bits() -> None:
    found, agreed_by = proof(gray(12, 4096), one_bit)
    assert [*found.lemmas] == ["(code == (n ^ n.slice(1, 11)))"]
    assert (found.arithmetic, agreed_by) == (BITS, [*BOTH])


def test_a_verdict_says_that_it_was_reached_in_bits() -> None:
    outcome = prove(asked(one_bit, gray(4, 16)), Limits(10, portfolio=0))
    assert outcome.verdict == PROVED
    assert outcome.method == "induction of depth 1, 1 found lemmas, bits"


# --- tables --------------------------------------------------------------------------------------------------------


def ring(turns: int) -> type[Model]:
    class Ring(Model, event="tick"):
        r: U5 = power_up(1)
        at: U3 = power_up(0)

        def step(self, go: Bit) -> Ring:
            turned = self.r.low(4).concat(self.r.slice(4, 1))
            return Ring(r=select(go, turned, self.r), at=select(go, next_to(self.at, turns), self.at))

    return Ring


def agree(s: Seen) -> Bit:
    return ~(s.r.bit(3) ^ (s.at == 3))


# --- congruences ---------------------------------------------------------------------------------------------------


class Wheels(Model, event="tick"):
    """Two wheels of 6 and 4 teeth: they meet at places of the same remainder by 2."""

    a: U3 = power_up(1)
    b: U3 = power_up(0)
    met: Bit = power_up(False)

    def step(self, go: Bit) -> Wheels:
        a, b = (select(go, next_to(v, n), v) for v, n in ((self.a, 6), (self.b, 4)))
        return Wheels(a=a, b=b, met=self.met | ((self.a == 3) & (self.b == 1)))


def never_met(s: Seen) -> Bit:
    return ~s.met


class Meeting(Wheels, event="tick"):
    """The same, with places of equal remainder."""

    def step(self, go: Bit) -> Meeting:
        a, b = (select(go, next_to(v, n), v) for v, n in ((self.a, 6), (self.b, 4)))
        return Meeting(a=a, b=b, met=self.met | ((self.a == 3) & (self.b == 2)))


# --- courses -------------------------------------------------------------------------------------------------------


class Peak(Model, event="tick"):
    """A peak that falls by 3 a tick."""

    m: Annotated[UInt, 10] = power_up(0)

    def step(self, x: Annotated[UInt, 10]) -> Peak:
        less = self.m.sat_sub(3)
        return Peak(m=select(x > less, x, less))


def at_most_900(s: Seen) -> Bit:
    return s.x <= 900


def gone(ticks: int) -> Formula:
    return lambda s: implies(age(s.x <= 300, 200) >= ticks, s.m <= 300)


class Integral(Model, event="tick"):
    """A sum that is taken back now and then."""

    n: Annotated[UInt, 9] = power_up(4)

    def step(self, x: U3, back: Bit) -> Integral:
        return Integral(n=select(back, 0, (self.n + x).sat(9)))


def back_in_time(s: Seen) -> Bit:
    return (s.x <= 5) & (age(~s.back, 30) < 30)


def at_most(bound: int) -> Formula:
    return lambda s: s.n <= bound


class Monostable(Model, event="tick"):
    """On for 700 ticks after a trigger."""

    t: Annotated[UInt, 10] = power_up(0)

    def step(self, trigger: Bit) -> Monostable:
        return Monostable(t=select(trigger, 700, self.t.sat_sub(1)))


def on_for(ticks: int) -> Formula:
    return lambda s: implies(once(s.trigger) & (age(~s.trigger, 701) < ticks), s.t > 0)


# --- differences ---------------------------------------------------------------------------------------------------


def window(wide: int) -> type[Model]:
    class Window(Model, event="tick"):
        f: U5 = power_up(0)
        p: U4 = power_up(3)
        seen: Bit = power_up(False)
        missed: Bit = power_up(False)

        def step(self) -> Window:
            inside = (self.f >= 2) & (self.f < 2 + wide)
            seen = inside & (self.seen | (self.p == 0))
            missed = (self.f == 1 + wide) & ~seen
            return Window(f=next_to(self.f, 25), p=next_to(self.p, 9), seen=seen, missed=self.missed | missed)

    return Window


def none_missed(s: Seen) -> Bit:
    return ~s.missed


CASES: list[tuple[type[Model], Formula, type[Model], Formula, Formula | None]] = [
    (gray(4, 16), one_bit, gray(4, 10), one_bit, None),
    (ring(5), agree, ring(6), agree, None),
    (Wheels, never_met, Meeting, never_met, None),
    (Peak, gone(200), Peak, gone(199), at_most_900),
    (Integral, at_most(149), Integral, at_most(148), back_in_time),
    (Monostable, on_for(700), Monostable, on_for(701), None),
    (window(9), none_missed, window(8), none_missed, None),
]


@pytest.mark.parametrize(("model", "formula", "wrong_model", "wrong", "given"), CASES)
def test_a_lemma_is_found_and_a_near_miss_is_not_proved(
    model: type[Model], formula: Formula, wrong_model: type[Model], wrong: Formula, given: Formula | None
) -> None:
    found, agreed_by = proof(model, formula, given)
    assert found.lemmas
    assert agreed_by == [*BOTH]
    assert proof(wrong_model, wrong, given)[0].depth is None


# --- each template by itself ---------------------------------------------------------------------------------------


def whole(model: type[Model], formula: Formula, given: Formula | None = None) -> Problem:
    return [*layers(build_problem(asked(formula, model, given=given)))][-1]


def names(template: Callable[..., Any], problem: Problem) -> list[str]:
    """What a template guesses and pruning keeps."""
    sampler = Sampler(problem)
    rows, steps = joined(sampler.run(sampler.starts(64), 40)), sampler.steps(2000)
    near = Neighbourhood(problem)
    arguments = {
        codes: (near,), tables: (near, rows), congruences: (near, steps), limits: (near, rows),
        courses: (near, steps, atoms(problem)), differences: (near, steps),
    }  # fmt: skip
    guessed = fit(template(*arguments[template]), rows)
    assert guessed
    return [c.name for c in Pruner(problem).prune([*ceilings(problem, rows), *guessed])]


def test_a_table_holds_value_by_value() -> None:
    assert {f"(at == {i}): (r == {1 << i})" for i in range(5)} <= {*names(tables, whole(ring(5), agree))}


def test_a_table_that_short_runs_suggest_is_given_up() -> None:
    class Drifting(Model, event="tick"):
        a: U4 = power_up(0)
        b: U4 = power_up(0)

        def step(self, go: Bit) -> Drifting:
            return Drifting(
                a=select(go, next_to(self.a, 16), self.a),
                b=select(go, next_to(self.b, 12), self.b),
            )

    problem = whole(Drifting, lambda s: s.a == s.b)
    sampler = Sampler(problem)
    guessed = tables(Neighbourhood(problem), joined(sampler.run(sampler.starts(64), 9)))
    assert len(guessed) > 4
    assert Pruner(problem).prune(guessed) == []


def test_limits_and_courses_are_found() -> None:
    problem = whole(Peak, gone(200), at_most_900)
    assert "(m <= 900)" in names(limits, problem)
    assert "~(m <= 300): -m - 3*watch.age0 >= -900" in names(courses, problem)
    assert "-n + 5*watch.age0 >= -4" in names(courses, whole(Integral, at_most(149), back_in_time))
    assert "watch.once0: t + watch.age1 >= 700" in names(courses, whole(Monostable, on_for(700)))


def test_registers_that_only_an_assumption_reads_come_last() -> None:
    problem = build_problem(asked(at_most(149), Integral, given=back_in_time))
    paths = [[s.path for s in part.system.states] for part in layers(problem)]
    assert paths == [["n"], ["n", "watch.age0"]]

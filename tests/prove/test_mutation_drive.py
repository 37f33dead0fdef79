"""Directed runs of mutants: they reach where times run out, and what they find is replayed before it counts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from safety.model import Model, parameter, power_up
from safety.prove.claims import REFUTED, Claim, Scenario, Seen, age
from safety.prove.mutants import COUNTEREXAMPLE, EQUIVALENT, UNCLAIMED, Fate, examine
from safety.prove.mutation_case import Case, Panel, Subject
from safety.prove.mutation_drive import Drive
from safety.prove.mutation_runs import Course
from safety.prove.solve import Disagreement
from safety.terms import U10, U12, Bit, implies, select
from tests.prove.small import asked

HOLD = 700  # steps: far deeper than any search looks


class Timer(Model, event="tick"):
    """Runs while it is told to and rings at the end of its time; stopped at any time it begins anew."""

    n: U12 = power_up(0)
    hold: U10 = parameter(HOLD, unit="tick", within=(1, 1000), source="[A]")

    def step(self, go: Bit) -> tuple[Timer, Bit]:
        rings = go & (self.n >= self.hold - 1)
        return Timer(n=select(go & ~rings, (self.n + 1).low(12), 0)), rings


def rings_in_time(s: Seen) -> Bit:
    """It rings where it has been told to go for the time since it last rang."""
    return s.out == (s.go & (age(s.go & ~s.out, 1023) + 1 >= HOLD))


def never_late(s: Seen) -> Bit:
    """It has not counted further than its time."""
    return s.n <= 1000


DELIVERED = asked(rings_in_time, Timer, id="delivered")
OPEN = asked(never_late, Timer, id="open", symbolic=("hold",))


def number(subject: Subject, text: str) -> int:
    (found,) = [m.number for m in subject.mutants.mutants if f"{m.was}: {m.change}" == text]
    return found


def fate(text: str, *claims: Claim) -> Fate:
    subject = Subject(claims)
    return examine(subject, [number(subject, text)])[0]


@pytest.mark.parametrize("step", ["-1", "+1"])
def test_a_time_one_step_off_is_found_at_its_end(step: str) -> None:
    found = fate(f"parameter hold: {step}", DELIVERED, OPEN)
    assert (found.kind, found.claim) == (COUNTEREXAMPLE, "delivered")
    assert int(found.how.split()[1]) >= HOLD - 1


def test_another_value_of_a_parameter_is_never_equivalent() -> None:
    """With it left open the step is the same, yet what is delivered is not."""
    assert fate("parameter hold: +1", OPEN).kind == UNCLAIMED
    other = asked(lambda s: s.n <= 4095, Timer, id="other")
    assert fate("parameter hold: +1", OPEN, other).kind not in (EQUIVALENT, COUNTEREXAMPLE)


def drive(*claims: Claim) -> tuple[Subject, Panel]:
    subject = Subject(claims)
    (panel,) = subject.panels
    return subject, panel


def test_nobody_breaks_a_claim_that_is_true_of_it() -> None:
    """The model as it is and a mutant that only rings early: neither ever counts beyond the greatest time."""
    subject, panel = drive(OPEN)
    early = subject.mutants[number(subject, "(hold - 1): 0 for 1")]
    assert list(panel.drive.broken([early], 2.0, 1)) == []


def test_the_same_courses_each_time() -> None:
    first, second = (drive(DELIVERED)[1].drive.course(500) for _ in "12")
    assert first[0] == second[0]
    assert all(map(np.array_equal, first[1], second[1]))


def test_a_find_is_replayed() -> None:
    """A step too soon, or on the model as it is, nothing is broken: the lanes are not believed."""
    subject, panel = drive(DELIVERED)
    late = subject.mutants[number(subject, "(n + 1): 0 for 1")]
    ((_, course, step),) = panel.drive.broken([late], 20.0, 2)
    assert panel.broken_by(late, course, step).claim.id == "delivered"
    for wrong in (step - 1, step + 1):
        with pytest.raises(Disagreement):
            panel.broken_by(late, replace(course, rows=(*course.rows, course.rows[-1])), wrong)
    harmless = subject.mutants[number(subject, "n at power-up: 1 for 0")]
    with pytest.raises(Disagreement):
        panel.broken_by(harmless, Course(course.rows[:1], course.start, ()), 0)


def test_claims_that_assume_the_same_run_side_by_side() -> None:
    told = asked(never_late, Timer, id="told", given=lambda s: s.go)
    subject = Subject([DELIVERED, replace(DELIVERED, id="again"), OPEN, told])
    assert [[case.claim.id for case in panel.cases] for panel in subject.panels] == [
        ["delivered", "again"], ["open"], ["told"],
    ]  # fmt: skip


def test_the_runs_of_its_twins_are_known_runs_of_a_claim() -> None:
    """Where they assume the same; so what shows in them is found without a search."""
    rings = Scenario(HOLD + 10, {"go": True})
    twin = replace(DELIVERED, id="twin", expect=REFUTED, twin_of="delivered", scenario=rings)
    other = replace(twin, id="other", given=lambda s: s.go)
    (case,) = Subject([DELIVERED, twin, other]).proved
    assert [len(course.rows) for course in case.courses] == [HOLD + 10]
    (alone,) = Subject([DELIVERED, other]).proved
    assert alone.courses == []


def test_swarms_come_only_where_a_claim_is_in_doubt() -> None:
    subject, panel = drive(replace(OPEN, given=lambda s: s.go))
    early = subject.mutants[number(subject, "(hold - 1): 0 for 1")]
    assert list(panel.drive.broken([early], 2.0, 0)) == []
    assert not panel.drive.roused
    assert list(panel.drive.broken([early], 2.0, 1)) == []
    assert panel.drive.roused


def test_a_course_keeps_to_what_its_start_admits() -> None:
    """What is left open takes a value of its range."""
    subject = Subject([replace(OPEN, formula=lambda s: implies(s.go, s.n <= 1000))])
    case: Case = subject.proved[0]
    values = {start["hold"] for start in Drive(case.stated, ()).starts}
    assert len(values) > 2
    assert all(1 <= value <= 1000 for value in values)

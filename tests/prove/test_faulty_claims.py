"""Claims about faulty equipment: frames, onsets, assumptions and parts mean what they say."""

from __future__ import annotations

import pytest

from safety.faults import ANY_TIME, INTERMITTENT, Budget, Fault, any_of_faults, byzantine, stuck
from safety.model import Model, assume, point, power_up
from safety.prove.claims import (
    PROVED,
    REFUTED,
    Seen,
    faulty,
    has,
    new_fault,
    previous,
    struck,
)
from safety.prove.problem import build_problem
from safety.system import ModelError
from safety.terms import U4, Bit, bit, implies
from tests.prove.small import Counter, asked, verdict


class Pair(Model, event="tick"):
    """Keeps the last two values of a wire that is false when healthy."""

    last: Bit = power_up(False)
    before: Bit = power_up(False)

    def step(self) -> Pair:
        return Pair(last=point("wire", bit(False)), before=self.last)


WIRE = {onset: any_of_faults([Fault(byzantine(), ["wire"], onset, name="wire")]) for onset in ("from start", ANY_TIME)}


@pytest.mark.parametrize("onset", WIRE)
def test_a_byzantine_point_is_free_at_every_step_of_a_frame(onset: str) -> None:
    def alike(s: Seen) -> Bit:
        return s.last == s.before

    found = verdict(alike, Pair, faults=WIRE[onset], steps_per_frame=2, expect=REFUTED)
    assert (found.verdict, found.steps) == (REFUTED, 2)


def test_a_fault_may_begin_within_a_frame() -> None:
    stuck_at_1 = any_of_faults([Fault(stuck(1), ["wire"], ANY_TIME, name="wire")])

    def both_or_none(s: Seen) -> Bit:
        return s.last == s.before

    assert verdict(both_or_none, Pair, faults=stuck_at_1, steps_per_frame=2, expect=REFUTED).verdict == REFUTED
    found = verdict(
        lambda s: implies(s.before, s.last), Pair, faults=stuck_at_1, steps_per_frame=2,
        lemmas=[lambda s: implies(s.before, s.last), lambda s: implies(s.last, struck(s, "wire"))],
    )  # fmt: skip
    assert found.verdict == PROVED


def test_a_frame_with_a_fault_that_begins_in_it_has_a_new_fault() -> None:
    faults = any_of_faults([Fault(stuck(1), ["wire"], ANY_TIME, name="wire")])

    def noticed(s: Seen) -> Bit:
        return implies(s.last & ~previous(s.last, False), previous(new_fault(s), False))

    lemma = [lambda s: implies(s.last, struck(s, "wire"))]
    assert verdict(noticed, Pair, faults=faults, steps_per_frame=3, lemmas=lemma, induction=2).verdict == PROVED


def test_an_intermittent_fault_has_struck_once_it_acted() -> None:
    faults = any_of_faults([Fault(stuck(1), ["high"], INTERMITTENT, name="high")])
    found = verdict(
        lambda s: implies(struck(s, "high"), previous(s.high, False) | (s.n > 0)), faults=faults, expect=REFUTED
    )
    assert found.verdict == REFUTED and found.steps is not None and found.steps > 2
    assert verdict(lambda s: implies(struck(s, "high"), has(s, "high")), faults=faults, induction=2).verdict == PROVED


class Meter(Model, event="tick"):
    """A part that assumes what it measures."""

    def step(self, level: U4) -> tuple[Meter, Bit]:
        assume("level below 9", level < 9)
        return Meter(), point("over", level > 7)


class Tank(Model, event="tick"):
    """Feeds the meter through a register that a fault can reach."""

    meter: Meter
    level: U4 = power_up(0)

    def step(self) -> tuple[Tank, Bit]:
        meter, over = self.meter.step(self.level)
        return Tank(meter=meter, level=point("level", (self.level + 1).low(3))), over


def test_an_assumption_does_not_hold_a_fault_down() -> None:
    level = any_of_faults([Fault(byzantine(), ["level"])])
    with pytest.raises(ModelError, match=r"faults reach what the model assumes, 'meter\.level below 9'"):
        verdict(lambda s: s.level < 9, Tank, faults=level)
    assert (
        verdict(lambda s: s.level < 9, Tank, faults=any_of_faults([Fault(stuck(0), ["meter.over"])])).verdict == PROVED
    )


class Two(Model, event="tick"):
    """Two counters."""

    a: Counter
    b: Counter

    def step(self, go: Bit) -> Two:
        (a, _), (b, _) = self.a.step(go), self.b.step(go)
        return Two(a=a, b=b)


@pytest.mark.parametrize("pattern", ["a.high", "a.*", "*.high"])
def test_a_part_is_faulty_by_what_its_patterns_reach(pattern: str) -> None:
    faults = Budget([Fault(stuck(1), [pattern], name="high")], 1)
    problem = build_problem(asked(lambda s: s.a.high | faulty(s, "a"), Two, faults=faults))
    seen = Seen(problem.system, problem.faulted)
    assert faulty(seen, "a") is faulty(seen.a) is faulty(seen) is has(seen, "high")
    assert (faulty(seen, "b") is has(seen, "high")) == (pattern == "*.high")
    with pytest.raises(ModelError, match="Two has no part 'c'; there is a, b"):
        faulty(seen, "c")

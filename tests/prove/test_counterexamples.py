"""Counterexamples: shortest, smallest, the same whatever the solver does, and shown as they ran."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from safety.faults import ANY_TIME, TRANSIENT, Fault, any_of_faults, flip, frozen
from safety.model import Model, point, power_up
from safety.prove import record, search
from safety.prove.claims import REFUTED, Scenario, Seen
from safety.prove.problem import build_problem
from safety.prove.prove import Limits, prove
from safety.prove.solve import Disagreement, Solver
from safety.system import ANY, ModelError
from safety.terms import U2, U4, Bit, select
from tests.prove import naive
from tests.prove.naive import Machine
from tests.prove.small import asked, verdict


class Lock(Model, event="tick"):
    """Opens after three digits whose sum is 7; starts with any key."""

    key: U2 = power_up(ANY)
    sum_: U4 = power_up(0)
    n: U2 = power_up(0)

    def step(self, digit: U2, push: Bit) -> tuple[Lock, Bit]:
        done = self.n == 3
        take = push & ~done
        return (
            Lock(
                key=self.key,
                sum_=select(take, (self.sum_ + digit).low(4), self.sum_),
                n=select(take, (self.n + 1).low(2), self.n),
            ),
            point("opens", done & (self.sum_ == 7) & (self.key >= 2)),
        )


def smallest_by_hand() -> tuple[int, list[tuple[int, bool]]]:
    """Key and inputs of the shortest run that opens, the smallest in the order of registers, then of inputs by step."""
    digits = itertools.product(range(4), repeat=3)
    first = min(d for d in digits if sum(d) == 7)
    return 2, [*((d, True) for d in first), (0, False)]


@pytest.mark.parametrize("seed", range(6))
def test_the_run_is_the_smallest_whatever_the_seed(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    made = Solver.__post_init__

    def seeded(self: Solver) -> None:
        made(self)
        self.raw.set("random_seed", seed)
        if seed % 2 and not self.finite:
            self.raw.set("smt.arith.solver", 2)

    monkeypatch.setattr(Solver, "__post_init__", seeded)
    found = verdict(lambda s: ~s.out, Lock, expect=REFUTED).counterexample
    assert found is not None
    assert (found.chosen["key"], list(zip(found["digit"], found["push"], strict=True))) == smallest_by_hand()


@pytest.mark.parametrize("integers", [False, True])
def test_both_ways_to_ask_give_the_same_run(integers: bool) -> None:
    problem = build_problem(asked(lambda s: ~s.out, Lock))
    found = search.bounded(problem, ~problem.holds, 9, integers, 20).run
    assert found is not None
    assert (found.chosen["key"], list(zip(found["digit"], found["push"], strict=True))) == smallest_by_hand()


def test_an_answer_that_does_not_run_is_a_disagreement(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "_smallest", lambda *_: {})
    with pytest.raises(Disagreement, match="does not do on the Python reading what it should"):
        verdict(lambda s: ~s.out, Lock, expect=REFUTED)


def test_a_run_outside_the_assumptions_is_a_disagreement() -> None:
    problem = build_problem(asked(lambda s: s.n == 0, given=lambda s: ~s.go))
    with pytest.raises(Disagreement):
        search.replay(problem, {("go", 0): True}, 2, ~problem.holds)


def test_scripts_are_checked_by_name() -> None:
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"inputs": {"goo": True}}, "the scenario sets 'goo'; did you mean go"),
        ({"present": ["x"]}, "the scenario wants the fault 'x'; there is high"),
        ({"values": {"high": True}}, "the scenario gives values at 'high'"),
        ({"start": {"m": 1}}, "Counter has no register 'm'"),
        ({"start": {"n": 1}}, "only registers declared ANY can be set"),
    ]
    faults = any_of_faults([Fault(flip(), ["high"], ANY_TIME, name="high")])
    problem = build_problem(asked(lambda s: s.on, faults=faults))
    for script, says in wrong:
        with pytest.raises(ModelError, match=says):
            search.scripted(problem, Scenario(3, **script))


def test_a_script_acts_from_its_step_on() -> None:
    faults = any_of_faults([Fault(flip(), ["high"], TRANSIENT, ticks=2, name="high")])
    problem = build_problem(asked(lambda s: s.on, faults=faults))
    found = search.scripted(problem, Scenario(6, present=["high"], at=2))
    assert found["high"] == [False, False, True, True, False, False]
    assert search.scripted(problem, Scenario(6, at=2))["high"] == [False] * 6


class Dotted(Model, event="tick"):
    """An input whose name ends as a fault's choices do."""

    def step(self, now: Bit, value: U2) -> tuple[Dotted, Bit]:
        return Dotted(), point("seen", now & (value == 0))


def test_inputs_of_the_model_are_no_choices_of_a_fault() -> None:
    faults = any_of_faults([Fault(frozen(), ["seen"], ANY_TIME, name="f")])
    problem = build_problem(asked(lambda s: s.seen, Dotted, faults=faults))
    found = search.scripted(problem, Scenario(3, {"now": True}, present=["f"], at=9, values={}))
    assert found["now"] == [True] * 3 and found["fault0.now"] == [False] * 3


def test_what_is_recorded_of_a_counterexample() -> None:
    faults = any_of_faults([Fault(flip(), ["high"], ANY_TIME, name="high"), Fault(frozen(), ["passed"], name="p")])

    def quiet_until_3(s: Seen) -> Bit:
        """Nothing is high while n is 2."""
        return ~(s.high & (s.n == 2))

    found = prove(asked(quiet_until_3, expect=REFUTED, faults=faults, given=lambda s: s.go), Limits(20))
    entry = record.claim_entry(found)
    assert (entry["verdict"], entry["strength"], entry["agreed_by"]) == (REFUTED, {"kind": REFUTED, "steps": 3}, [])
    shown = entry["counterexample"]
    assert shown["faults"] == ["high, any time"] and shown["violated_at"] == 2
    assert shown["fault_onset"] == found.counterexample["fault0.now"].index(True)  # type: ignore[index]
    assert entry["power_up"] == "n=0, passed=False"


def test_a_register_that_begins_like_a_fault_is_shown() -> None:
    class Faulty(Model, event="tick"):
        """Its register is called faulty."""

        faulty: Bit = power_up(True)

        def step(self) -> Faulty:
            return Faulty(faulty=self.faulty)

    assert record.claim_entry(verdict(lambda s: s["faulty"], Faulty))["power_up"] == "faulty=True"


def test_enumeration_finds_no_smaller_run() -> None:
    """On random equipment: of all shortest runs, the one shown is the least in register and input order."""
    from tests.prove.test_against_enumeration import drawn

    shown = 0
    for seed in range(20_000, 20_120):
        made = drawn(seed)
        if made is None or made[1].verdict != REFUTED or made[0].asked.faults or len(made[1].counterexample or ()) > 4:
            continue
        machine, found = made
        trace = found.counterexample
        assert trace is not None
        keys = [k for k in ("x", "y") if k in trace.chosen]
        mine = ([trace.chosen[k] for k in keys], [(trace["p"][k], trace["q"][k]) for k in range(len(trace))])
        assert mine == least_by_hand(machine, keys, len(trace)), f"seed {seed}"
        shown += 1
    assert shown > 15


def least_by_hand(machine: Machine, keys: list[str], steps: int) -> Any:
    wires = list(itertools.product([False, True], repeat=2))
    found = []
    for state in machine.starts():
        for run in itertools.product(wires, repeat=steps):
            here, ok = state, True
            for k, (p, q) in enumerate(run):
                env, here = machine.step(here, {"p": p, "q": q})
                ok = ok and machine.allowed(env) and naive.value(machine.asked.holds, env) == (k < steps - 1)
            if ok:
                found.append(([{"x": state[0], "y": state[1]}[k] for k in keys], list(run)))
    return min(found)

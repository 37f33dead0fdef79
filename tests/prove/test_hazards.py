"""Minimal cut sets against brute force: every set of faults of small equipment, run through all its states."""

from __future__ import annotations

import itertools
import random
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

from safety.faults import ANY_TIME, Fault, stuck
from safety.model import Model, assume, point, power_up
from safety.prove import hazards, search
from safety.prove.claims import INTEGERS, PROVED, Claim, Formula, Scenario, Seen, struck
from safety.prove.hazards import CANDIDATE, CONFIRMED, Hazard, cut_sets
from safety.prove.prove import Limits
from safety.prove.solve import Disagreement, Solver
from safety.system import ModelError
from safety.terms import U2, Bit, implies, select
from tests.prove import chance, naive, translated
from tests.prove.naive import Machine, Question

STEPS = 4


def declared(formula: Formula, model: type[Model], faults: Any, **changes: Any) -> Hazard:
    """A hazard that is in no registry."""
    claim = Claim(
        "test.hazard", model, lambda s: ~formula(s), "said", PROVED, "", "", hazards.any_of_faults(faults),
        changes.pop("given", None), None, tuple(changes.pop("lemmas", ())), (), {}, 1, 0, INTEGERS, None, None, None,
        "hazard",
    )  # fmt: skip
    usual: dict[str, Any] = {"scenarios": lambda names: (), "most": 4, "rates": {}, "hours": "1", "expect": {}}
    return Hazard(claim, **(usual | changes))


def minimal(sets: list[tuple[str, ...]]) -> list[tuple[str, ...]]:
    return sorted(s for s in sets if not any(set(t) < set(s) for t in sets))


class Votes(Model, event="tick"):
    """Two of three wires keep the train moving; the hazard is that it moves although all ask for the brake."""

    held: Bit = power_up(False)

    def step(self, brake: Bit) -> tuple[Votes, Bit]:
        a, b, c = (point(name, ~brake) for name in "abc")
        moves = point("output", (a & b) | (b & c) | (a & c))
        return Votes(held=moves), moves


WELDED = [Fault(stuck(1), [p], name=p) for p in ("a", "b", "c", "output")]


def moves(s: Seen) -> Bit:
    return s.out & s.brake


def braking(names: tuple[str, ...]) -> Sequence[Scenario]:
    return [Scenario(2, {"brake": True})]


def test_the_vote_has_its_four_cut_sets() -> None:
    found = cut_sets(declared(moves, Votes, WELDED, scenarios=braking))
    assert [(s.faults, s.status, s.steps) for s in found.sets] == [
        (("output",), CONFIRMED, 1), (("a", "b"), CONFIRMED, 1), (("a", "c"), CONFIRMED, 1), (("b", "c"), CONFIRMED, 1),
    ]  # fmt: skip
    assert (found.complete_to, found.all_orders, found.by_order()) == (4, True, {1: 1, 2: 3})
    assert found.agreed_by == ["z3", "cvc5"]


def test_without_a_scenario_they_are_candidates_and_have_no_run() -> None:
    hazard = declared(moves, Votes, WELDED)
    found = cut_sets(hazard)
    assert found.by_order(CANDIDATE) == {1: 1, 2: 3} and not found.by_order(CONFIRMED)
    with pytest.raises(ModelError, match="output is a candidate: no scenario confirmed it"):
        hazards.replay(hazard, found.sets[0])


def test_a_confirmed_set_is_run_with_its_own_faults_only() -> None:
    wrong = declared(
        moves, Votes, WELDED, scenarios=lambda names: [Scenario(2, {"brake": True}, present=["a", "output"])]
    )
    found = cut_sets(wrong)
    assert found.by_order(CONFIRMED) == {1: 1, 2: 3}
    for one in found.sets:
        assert one.script is not None and tuple(one.script.present) == one.faults
        assert hazards.replay(wrong, one)["out"][-1] is True


def test_orders_beyond_the_limit_are_not_claimed() -> None:
    found = cut_sets(declared(moves, Votes, WELDED[:3], scenarios=braking, most=1))
    assert (found.sets, found.complete_to, found.all_orders) == ([], 1, False)
    assert found.agreed_by == ["z3", "cvc5"]


def test_no_fault_at_all_is_order_zero() -> None:
    found = cut_sets(declared(lambda s: s.brake, Votes, WELDED, scenarios=braking))
    assert [(s.faults, s.order) for s in found.sets] == [((), 0)]
    found = cut_sets(declared(moves, Votes, []))
    assert (found.sets, found.all_orders) == ([], True)


def test_assumptions_that_contradict_make_no_equipment_safe() -> None:
    class Impossible(Model, event="tick"):
        """Assumes what cannot be."""

        def step(self, brake: Bit) -> tuple[Impossible, Bit]:
            assume("nothing", brake & ~brake)
            return Impossible(), point("output", ~brake)

    for hazard in (
        declared(moves, Impossible, WELDED[3:]),
        declared(moves, Votes, WELDED, given=lambda s: s.brake & ~s.brake),
    ):
        with pytest.raises(ModelError, match="the assumptions contradict one another"):
            cut_sets(hazard)


def test_a_lemma_that_a_fault_breaks_is_refused() -> None:
    faults = [Fault(stuck(1), [p], ANY_TIME, name=p) for p in ("a", "output")]
    broken = declared(moves, Votes, faults, lemmas=[lambda s: ~s.held], given=lambda s: s.brake)
    with pytest.raises(ModelError, match=r"is kept by a step: not shown for every combination of faults; guard"):
        cut_sets(broken)
    guarded = declared(
        moves, Votes, faults, lemmas=[lambda s: implies(s.held, struck(s, "output"))], given=lambda s: s.brake
    )
    assert cut_sets(guarded).by_order() == {1: 1}


def test_a_second_solver_that_finds_more_stops_everything(monkeypatch: pytest.MonkeyPatch) -> None:
    check = Solver.check
    monkeypatch.setattr(Solver, "check", lambda self: "sat" if self.name == "cvc5" else check(self))
    with pytest.raises(Disagreement, match="cvc5 finds one more cut set"):
        cut_sets(declared(moves, Votes, WELDED, scenarios=braking))
    monkeypatch.setattr(Solver, "check", lambda self: "unknown" if self.name == "cvc5" else check(self))
    assert cut_sets(declared(moves, Votes, WELDED, scenarios=braking)).agreed_by == ["z3"]


def test_a_solver_that_gives_up_completes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    check, asked = Solver.check, [0]

    def tired(self: Solver) -> str:
        asked[0] += 1
        return "unknown" if asked[0] > 4 else check(self)

    monkeypatch.setattr(Solver, "check", tired)
    found = cut_sets(declared(moves, Votes, WELDED, scenarios=braking), Limits(20, ("z3",)))
    assert (found.complete_to, found.all_orders) == (1, False) and "no answer at order 2" in found.why


def test_two_hazards_of_a_name_are_refused() -> None:
    namespace: dict[str, Any] = {"hazard": hazards.hazard, "Votes": Votes, "__name__": "twice"}
    text = "@hazard(Votes, faults=[], scenarios=lambda names: [])\ndef moves(s):\n    'It moves.'\n    return s.out\n"
    exec(compile(text, "twice.py", "exec"), namespace)
    exec(compile(text, "twice.py", "exec"), dict(namespace))  # read again
    with pytest.raises(ModelError, match=r"two hazards are called 'twice\.moves'"):
        exec(compile(text + text, "twice.py", "exec"), namespace)
    hazards._registry.pop("twice.moves")


# --- brute force ---------------------------------------------------------------------------------------------------


def by_hand(machine: Machine) -> list[tuple[str, ...]]:
    """The minimal sets of faults with which the hazard can happen within the steps, from the naive machine."""
    n = len(machine.asked.faults)
    guilty = []
    for chosen in itertools.product([False, True], repeat=n):
        level = {s for s in machine.starts() if s[2] == chosen}
        for _ in range(STEPS):
            stepped = [machine.step(s, c) for s in level for c in machine.choices(s)]
            if any(not naive.value(machine.asked.holds, env) for env, _ in stepped):
                guilty.append(tuple(f"f{i}" for i in range(n) if chosen[i]))
                break
            level = {following for _, following in stepped}
    return minimal(guilty)


def all_scripts(names: tuple[str, ...]) -> list[Scenario]:
    """Every run of the two inputs."""
    pairs = list(itertools.product([False, True], repeat=2))
    runs = itertools.product(pairs, repeat=STEPS)
    return [
        Scenario(STEPS, {"p": lambda k, r=r: r[k][0], "q": lambda k, r=r: r[k][1]})  # type: ignore[misc]
        for r in runs
    ]


def drawn(seed: int) -> tuple[Machine, Hazard] | None:
    """Equipment without memory of the inputs' past, three simple faults, and a hazard in what it shows."""
    rng = random.Random(seed)
    made = replace(chance.equipment(rng), x0=0, y0=False, assumed=None)
    kinds = ("stuck0", "stuck1", "flip", "open", "welded", "delayed")
    faults = tuple(dict.fromkeys(chance.broken(rng, rng.choice(kinds), "from start") for _ in range(3)))
    bad = chance.wire(rng, ["good", "level", "p"], 2)
    if naive.constant(bad) is not None:
        return None
    machine = Machine(made, Question(("not", bad), faults=faults))
    broken = [translated.fault(f, i) for i, f in enumerate(faults)]

    def happens(s: Seen) -> Bit:
        return translated.term(bad, lambda name: s[name])

    return machine, declared(happens, translated.model(made), broken, scenarios=all_scripts)


def agreeing(seeds: range) -> int:
    """How many hazards have the cut sets that brute force gives; a candidate may stand for true sets above it."""
    exact = 0
    for seed in seeds:
        made = drawn(seed)
        if made is None:
            continue
        machine, hazard = made
        truth = by_hand(machine)
        try:
            found = cut_sets(hazard, Limits(20, ("z3",)))
        except ModelError as error:
            assert "names no signal" in str(error)
            continue
        assert found.all_orders
        confirmed = sorted(s.faults for s in found.sets if s.status == CONFIRMED)
        every = [set(s.faults) for s in found.sets]
        assert set(confirmed) <= set(truth), f"seed {seed}: {confirmed} against {truth}"
        assert all(any(one <= set(true) for one in every) for true in truth), f"seed {seed}: a cut set is lost"
        exact += confirmed == truth
    return exact


def test_cut_sets_are_those_of_brute_force() -> None:
    assert agreeing(range(150)) > 100


def test_a_lost_cut_set_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    exclude = hazards._Question.exclude
    monkeypatch.setattr(hazards._Question, "exclude", lambda self, chosen: exclude(self, chosen[:1]))
    with pytest.raises(AssertionError):
        test_the_vote_has_its_four_cut_sets()


def test_a_set_confirmed_without_its_run_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "with_faults", lambda problem, names: problem)
    monkeypatch.setattr(
        hazards, "replace", lambda script, present: replace(script, present=("f0", "f1", "f2")[: len(script.inputs)])
    )
    with pytest.raises((AssertionError, ModelError)):
        agreeing(range(60))


class Slow(Model, event="tick"):
    """Counts to three while its input is not stuck."""

    n: U2 = power_up(0)

    def step(self, go: Bit) -> tuple[Slow, Bit]:
        n = select(point("go", go) & (self.n < 3), (self.n + 1).low(2), self.n)
        return Slow(n=n), point("full", self.n == 3)


def test_weak_lemmas_add_candidates_and_lose_nothing() -> None:
    faults = [Fault(stuck(1), ["go"], name="go"), Fault(stuck(1), ["full"], name="full")]

    def runs(names: tuple[str, ...]) -> list[Scenario]:
        return [Scenario(6, {"go": False})]

    def full(s: Seen) -> Bit:
        return s.full

    weak = declared(full, Slow, faults, scenarios=runs, given=lambda s: ~s.go)
    assert [(s.faults, s.status) for s in cut_sets(weak).sets] == [((), CANDIDATE)]
    lemma = [lambda s: implies(s.n > 0, struck(s, "go"))]
    strong = declared(full, Slow, faults, scenarios=runs, given=lambda s: ~s.go, lemmas=lemma)
    assert [(s.faults, s.status, s.steps) for s in cut_sets(strong).sets] == [
        (("full",), CONFIRMED, 1), (("go",), CONFIRMED, 4),
    ]  # fmt: skip

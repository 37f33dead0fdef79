"""Lemma synthesis: conserved forms, pruning, and that nothing rests on how a lemma was found."""

from dataclasses import replace
from typing import NamedTuple

import pytest

from safety import (
    ANY,
    ANY_TIME,
    PROVED,
    REFUTED,
    TRANSIENT,
    U8,
    Bit,
    Fault,
    Model,
    Seen,
    at_most,
    byzantine,
    claim,
    implies,
    persists,
    point,
    power_up,
    select,
    stuck,
    total,
)
from safety.prove import prove as flow
from safety.prove.claims import registered
from safety.prove.induction import by_induction, lemma_obligations
from safety.prove.problem import build_problem
from safety.prove.prove import Limits, prove
from safety.prove.record import claim_entry
from safety.prove.synthesis.candidates import Candidate
from safety.prove.synthesis.conserved import forms, groups, reads
from safety.prove.synthesis.houdini import Pruner
from safety.prove.synthesis.minimal import needed
from safety.prove.synthesis.sampling import Sampler, evaluate
from safety.prove.synthesis.synthesise import Found, synthesise
from safety.prove.synthesis.templates import TRUE
from safety.terms.values import bit
from tests.prove.small import asked

QUICK = Limits(timeout=20.0, synthesis=20.0, simulation=2.0, portfolio=0.0)


class Trip(NamedTuple):
    trip: Bit


class Race(Model, tick_s="1e-3"):
    """Two accumulators feed a counter from 0 to 7; the trip is latched at 7."""

    v: U8 = power_up(ANY)
    r: U8 = power_up(ANY)
    d: U8 = power_up(0)
    latch: Bit = power_up(False)

    def step(self, kv: U8, kr: U8) -> tuple["Race", Trip]:
        fast, slow = self.v + kv, self.r + kr
        up, down = point("up", fast.bit(8) & ~slow.bit(8)), slow.bit(8) & ~fast.bit(8)
        d = select(up & (self.d < 7), (self.d + 1).low(8), select(down, self.d.sat_sub(1), self.d))
        latch = self.latch | (d == 7)
        return type(self)(v=fast.low(8), r=slow.low(8), d=d, latch=latch), Trip(latch)


LEAST = (256 * 7 + 255 + 15) // 16  # ticks of a lead of 16 after which a counter of 7 is full, from any phases


def sixteen_ahead(s: Seen) -> Bit:
    return s.kv.int() - s.kr.int() >= 16


@claim(Race, expect=PROVED, requirement="S1")
def trips(s: Seen) -> Bit:
    """A lead of 16 for 128 ticks trips."""
    return implies(persists(sixteen_ahead(s), LEAST), s.trip)


@claim(Race, expect=REFUTED, twin_of=trips, requirement="S1")
def trips_in_half_the_time(s: Seen) -> Bit:
    """A lead of 16 for 64 ticks trips."""
    return implies(persists(sixteen_ahead(s), LEAST // 2), s.trip)


WILD = at_most(1, [Fault(byzantine(), "up", ANY_TIME, name="wild")])


@claim(Race, expect=REFUTED, twin_of=trips, requirement="S1", faults=WILD)
def trips_with_a_wild_pulse(s: Seen) -> Bit:
    """A lead of 16 for 128 ticks trips, though the pulses up may be anything."""
    return implies(persists(sixteen_ahead(s), LEAST), s.trip)


@claim(Race, expect=PROVED, requirement="S2")
def pulses_are_counted(s: Seen) -> Bit:
    """100 pulses of v take at least 100 ticks."""
    return implies(total((s.v + s.kv).bit(8).word(), 100) == 100, total(bit(True).word(), 200) >= 99)


def problem_of(formula):
    return build_problem(next(c for c in registered() if c.formula is formula))


def register(problem, path):
    return problem.system.state[path].var


def the_form(problem, text):
    sampler = Sampler(problem)
    sampler.draw_states.range[register(problem, "d").uid][1] = 7  # what the driver shows first: it does not pass 7
    steps = sampler.steps(4000, share=0.1)
    found = [
        form
        for group in groups(problem.system.states, ())
        for form in forms(steps, group, (), reads(group, [*sampler.inputs, *sampler.points]))
    ]
    names = [{v.attr: c for c, (v,) in form.terms} for form in found if not form.product]
    return next((form for form, name in zip(found, names, strict=True) if name == text), None)


POTENTIAL = {"d": 256, "v": 1, "r": -1}


def test_the_potential_of_a_race_is_found_and_holds_in_steps_not_seen():
    problem = problem_of(trips)
    form = the_form(problem, POTENTIAL)
    assert form is not None
    assert {v.attr: c for v, c in form.change if v is not None} == {"kv": 1, "kr": -1}
    fresh = Sampler(problem, seed=77).steps(2000, share=0.1)
    before, after = (evaluate([form.term()], rows)[0] for rows in (fresh.before, fresh.after))
    d = register(problem, "d")
    inner = (fresh.before[d.uid] > 0) & (fresh.before[d.uid] < 7)
    kv, kr = (fresh.inputs[problem.system.inputs[n].uid] for n in ("kv", "kr"))
    assert inner.sum() > 20
    assert ((after - before)[inner] == (kv - kr)[inner]).all()


class Gated(Model, tick_s="1e-3"):
    """Counts to 20 while it is let; out from 10 on."""

    n: U8 = power_up(0)

    def step(self, go: Bit, reset: Bit) -> tuple["Gated", Trip]:
        counts = point("go", go) & (self.n < 20)
        return Gated(n=select(reset, 0, select(counts, (self.n + 1).low(8), self.n))), Trip(self.n >= 10)


@pytest.mark.parametrize("onset", [{}, {"onset": ANY_TIME}, {"onset": TRANSIENT, "ticks": 5}])
def test_a_fault_whose_registers_are_far_away_breaks_no_search(onset):
    """The registers nearest to the property do not include those of the fault, and yet the lemmas are guarded by it."""

    def comes(s: Seen) -> Bit:
        """Let for 13 ticks, it is out."""
        return implies(persists(s.go & ~s.reset, 13), s.trip)

    stops = at_most(1, [Fault(stuck(0), "go", **onset, name="stops")])
    found = synthesise(build_problem(asked(comes, Gated, faults=stops)), 10.0)
    assert found.depth is None and found.why


class Leaky(Race, tick_s="1e-3"):
    """A race that loses a pulse where the accumulator ends at 3."""

    def step(self, kv: U8, kr: U8) -> tuple["Leaky", Trip]:
        following, trip = super().step(kv, kr)
        lost = following.v == 3
        d = select(lost, self.d, following.d)
        return type(self)(v=following.v, r=following.r, d=d, latch=following.latch), trip


@claim(Leaky, expect=REFUTED, twin_of=trips, requirement="S1")
def trips_though_it_leaks(s: Seen) -> Bit:
    """A lead of 16 for 128 ticks trips, with pulses that get lost."""
    return implies(persists(sixteen_ahead(s), LEAST), s.trip)


def test_a_race_that_leaks_has_no_potential():
    assert the_form(problem_of(trips_though_it_leaks), POTENTIAL) is None


def test_a_bound_gives_way_to_the_least_value_and_what_is_false_goes():
    problem = problem_of(trips)
    d, latch = register(problem, "d"), register(problem, "latch")
    bound, false, true = Candidate(TRUE, -d.int(), -3), Candidate(TRUE, ~latch), Candidate(d == 7, latch)
    kept = Pruner(problem).prune([bound, false, true])
    assert [id(c) for c in kept] == [id(bound), id(true)]
    assert bound.bound == -7
    answer = lemma_obligations(replace(problem, lemmas={c.name: c.lemma for c in kept}), True, 20.0, ("z3", "cvc5"))
    assert answer.proved and answer.agreed_by == ["z3", "cvc5"]


def test_only_lemmas_that_the_proof_rests_on_are_kept():
    problem = problem_of(trips)
    found = synthesise(problem, 20.0)
    assert found.depth is not None
    more = {**found.lemmas, "idle": register(problem, "v") <= 255}
    kept = needed(problem, more, found.depth, True)
    assert kept and set(kept) <= set(found.lemmas)
    assert by_induction(replace(problem, lemmas=kept), found.depth, True, 20.0, ("z3", "cvc5")).proved


def test_a_found_proof_has_no_user_lemmas_and_two_solvers():
    outcome = prove(next(c for c in registered() if c.formula is trips), QUICK)
    entry = claim_entry(outcome)
    assert (outcome.verdict, outcome.agreed_by) == (PROVED, ["z3", "cvc5"])
    assert entry["user_lemmas"] == 0
    assert entry["found_lemmas"] == len(outcome.problem.lemmas) > 0


@pytest.mark.parametrize("formula", [trips_in_half_the_time, trips_with_a_wild_pulse])
def test_a_claim_that_asks_too_much_is_refuted(formula):
    assert prove(next(c for c in registered() if c.formula is formula), QUICK).verdict == REFUTED


def test_sums_run_against_sums():
    assert prove(next(c for c in registered() if c.formula is pulses_are_counted), QUICK).verdict == PROVED


def test_a_wrong_guess_proves_nothing(monkeypatch):
    """The finder says that a false lemma will do: the obligations are asked again, and refuse it."""
    from safety.prove.synthesis import synthesise as module

    problem = problem_of(trips_in_half_the_time)
    d = register(problem, "d")
    monkeypatch.setattr(module, "synthesise", lambda *_, **__: Found({"d stays at 7": d == 7}, 0))
    means = flow._Attempt(problem, flow.Outcome(problem.claim, "undecided", problem), QUICK, lambda _: None)
    assert not means.lemmas()
    assert means.outcome.verdict != PROVED


def test_without_time_it_says_so():
    found = synthesise(problem_of(trips), 0.0)
    assert found.depth is None
    assert "stopped" in found.why

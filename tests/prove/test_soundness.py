"""Cases in which a prover says more than it knows: each is asked of the whole path from claim to verdict."""

from __future__ import annotations

import gc
from fractions import Fraction
from typing import Any

import pytest

from safety.faults import ANY_TIME, Fault, any_of_faults, at_most, stuck
from safety.model import Model, assume, parameter, point, power_up
from safety.prove import claims, solve
from safety.prove.claims import (
    BITS,
    BOUNDED,
    PROVED,
    REFUTED,
    UNDECIDED,
    VACUOUS,
    Scenario,
    Seen,
    age,
    has,
    previous,
)
from safety.prove.problem import build_problem
from safety.prove.prove import Limits, prove
from safety.prove.solve import Unrolling
from safety.system import ANY, ModelError
from safety.terms import U2, U4, U8, Bit, Real, UInt, bit, implies, select, word
from safety.terms.graph import graph_size
from safety.tracing import trace
from tests.prove.small import Counter, asked, below_sixteen, passed_in_time, verdict, with_no_search_for_proofs

# --- premises ------------------------------------------------------------------------------------------------------


def test_premises_that_exclude_each_other_are_each_shown() -> None:
    found = verdict(lambda s: implies(s.go, s.n <= 15) & implies(~s.go, s.n <= 15))
    assert (found.verdict, found.premise_at) == (PROVED, 0)


def test_one_premise_that_never_happens_is_enough_to_be_vacuous() -> None:
    found = verdict(
        lambda s: implies(s.go, s.n <= 15) & implies(s.go & (s.n > 3) & ~s.passed, s.on), lemmas=[passed_in_time]
    )
    assert found.verdict == VACUOUS
    assert found.why.startswith("the premise") and found.agreed_by == ["z3", "cvc5"]


def test_an_inner_premise_that_never_happens_is_vacuous() -> None:
    found = verdict(lambda s: implies(s.go, implies((s.n > 3) & ~s.passed, s.on)), lemmas=[passed_in_time])
    assert found.verdict == VACUOUS


class Assuming(Model, event="tick"):
    """Assumes a thing and its opposite."""

    n: U2 = power_up(0)

    def step(self, go: Bit) -> Assuming:
        assume("it goes", go)
        assume("it does not go", ~go)
        return Assuming(n=self.n)


@pytest.mark.parametrize(
    "changes",
    [
        {"given": lambda s: s.go & ~s.go},
        {"start": lambda s: s.n == 1},
        {"model": Assuming},
        {"given": lambda s: s.n > 0},
        {"faults": at_most(0, [Fault(stuck(1), ["high"])]), "given": lambda s: has(s, "high stuck-at-1")},
        {"given": lambda s: s.n > 0, "lemmas": [lambda s: s.n < 3]},
    ],
    ids=["given", "start", "assume", "given at power-up", "budget", "with a lemma that does not hold"],
)
@pytest.mark.parametrize("expect", [PROVED, REFUTED])
def test_assumptions_that_contradict_prove_nothing(changes: dict[str, Any], expect: str) -> None:
    found = verdict(lambda s: s.n == 2, **({"expect": expect} | changes))
    assert (found.verdict, found.why) == (VACUOUS, "the assumptions contradict one another: no run starts")


def test_a_premise_beyond_the_bound_is_undecided_until_a_witness_shows_it() -> None:
    def late(s: Seen) -> Bit:
        return implies(s.n == 15, s.high)

    assert with_no_search_for_proofs(late).verdict == UNDECIDED
    found = verdict(late)  # simulation goes further than the search
    assert (found.verdict, found.premise_at) == (PROVED, 15)
    found = verdict(late, witness=Scenario(20, {"go": True}))
    assert (found.verdict, found.premise_at) == (PROVED, 15)
    with pytest.raises(ModelError, match="never reaches the premise in 4 steps"):
        verdict(late, witness=Scenario(4, {"go": True}))
    with pytest.raises(ModelError, match="breaks an assumption of the claim at step 3"):
        verdict(late, witness=Scenario(20, {"go": True}), given=lambda s: s.n < 3)


# --- lemmas --------------------------------------------------------------------------------------------------------


def test_lemmas_of_one_name_all_count() -> None:
    lemmas = [lambda s: s.n < 3, lambda s: s.n <= 15]
    assert list(build_problem(asked(lambda s: s.on, lemmas=lemmas)).lemmas) == ["<lambda>", "<lambda> (2)"]
    assert verdict(lambda s: s.n < 3, lemmas=lemmas).verdict == REFUTED


def test_a_lemma_may_use_the_assumptions_of_its_own_step_only() -> None:
    class Late(Model, event="tick"):
        """The register shows what came in the step before."""

        seen: Bit = power_up(ANY)

        def step(self, go: Bit) -> Late:
            return Late(seen=go)

    found = verdict(lambda s: s.seen, Late, given=lambda s: s.go, lemmas=[lambda s: s.seen])
    assert (found.verdict, found.steps) == (REFUTED, 1)
    assert verdict(lambda s: s.seen, Late, given=lambda s: s.go, start=lambda s: s.seen).verdict == PROVED


def test_deeper_induction_needs_its_first_steps() -> None:
    def not_two_ago(s: Seen) -> Bit:
        return implies(previous(previous(s.go, False), False), s.go)

    found = verdict(not_two_ago, given=lambda s: implies(previous(s.go, False), s.go), induction=3)
    assert (found.verdict, found.premise_at) == (PROVED, 2)


# --- one name, two things ------------------------------------------------------------------------------------------


class Watch(Model, event="tick"):
    """A part whose register has the name of a watching one."""

    age0: U2 = power_up(2)

    def step(self) -> Watch:
        return Watch(age0=self.age0)


class Watched(Model, event="tick"):
    """Holds such a part."""

    watch: Watch

    def step(self, go: Bit) -> Watched:
        return Watched(watch=self.watch.step())


class Fault0(Model, event="tick"):
    """Has a register of the name of a fault's."""

    fault0: Bit = power_up(True)

    def step(self) -> Fault0:
        return Fault0(fault0=point("p", self.fault0))


def test_a_register_never_shares_a_variable() -> None:
    with pytest.raises(ModelError, match=r"two registers or inputs are called 'watch\.age0'"):
        verdict(lambda s: age(s.go, 3) <= 3, Watched)
    with pytest.raises(ModelError, match="'fault0' is a name of the registers of faults"):
        verdict(lambda s: s.fault0, Fault0, faults=any_of_faults([Fault(stuck(0), ["p"])]))
    assert verdict(lambda s: s.fault0, Fault0).verdict == PROVED


def test_models_of_the_same_names_do_not_mix() -> None:
    class Wide(Model, event="tick"):
        """Its n is wider."""

        n: U8 = power_up(0)

        def step(self, go: Bit) -> Wide:
            return Wide(n=select(go, (self.n + 1).low(8), self.n))

    narrow, wide = verdict(lambda s: s.n <= 15), verdict(lambda s: s.n <= 15, Wide, steps=20)
    assert (narrow.verdict, wide.verdict, wide.steps) == (PROVED, REFUTED, 17)


def test_terms_of_another_model_are_refused() -> None:
    foreign = trace(Watched).state["watch.age0"].var
    with pytest.raises(ModelError, match=r"reads watch\.age0, which Counter does not have"):
        verdict(lambda s: implies(s.on, foreign == 1))
    with pytest.raises(ModelError, match=r"reads watch\.age0"):
        verdict(lambda s: s.on, given=lambda s: foreign == 1)


def test_two_claims_of_a_name_are_refused() -> None:
    namespace: dict[str, Any] = {"claim": claims.claim, "Counter": Counter, "__name__": "twice"}
    text = "@claim(Counter, expect='proved')\ndef said(s):\n    'It is so.'\n    return s.on\n"
    exec(compile(text, "twice.py", "exec"), namespace)
    exec(compile(text, "twice.py", "exec"), dict(namespace))  # read again
    with pytest.raises(ModelError, match=r"two claims are called 'twice\.said'"):
        exec(compile(text + text, "twice.py", "exec"), namespace)
    claims._registry.pop("twice.said")


def test_two_faults_of_a_name_are_refused() -> None:
    twice = [Fault(stuck(0), ["high"]), Fault(stuck(0), ["high"], ANY_TIME)]
    with pytest.raises(ModelError, match="two faults are called 'high stuck-at-0'"):
        verdict(lambda s: s.on, faults=any_of_faults(twice))


def test_a_claim_says_something_of_the_model() -> None:
    with pytest.raises(ModelError, match="names no signal"):
        verdict(lambda s: bit(True))
    with pytest.raises(ModelError, match="reads the input go; lemmas and start read registers only"):
        verdict(lambda s: s.on, lemmas=[lambda s: s.go])
    with pytest.raises(ModelError, match="a claim returns a Bit"):
        verdict(lambda s: s.n)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"steps": 0}, "steps=0; it is a whole number from 1 up"),
        ({"induction": -1}, "induction=-1"),
        ({"steps_per_frame": 0}, "steps_per_frame=0"),
        ({"arithmetic": "floats"}, "it is INTEGERS or BITS"),
        ({"expect": "true"}, "it is one of proved, bounded"),
    ],
)
def test_a_claim_is_checked_where_it_is_declared(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(ModelError, match=says):
        claims.claim(Counter, **({"expect": PROVED} | changes))


# --- time ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("formula", "says"),
    [
        (lambda s: previous(s.n, 16) == 0, "before the first step it is a value of u4"),
        (lambda s: previous(s.on, 0), "before the first step it is a value of bit"),
        (lambda s: previous(s.n, s.n) == 0, "before the first step"),
        (lambda s: age(s.on, 0) == 0, "age(..., 0): a number of steps"),
        (lambda s: claims.persists(s.on, 0), "persists(..., 0)"),
        (lambda s: claims.total(s.n, -1) == 0, "total(..., -1)"),
    ],
)
def test_time_is_counted_from_one_up(formula: Any, says: str) -> None:
    with pytest.raises(ModelError) as caught:
        verdict(formula)
    assert says in str(caught.value)


def test_time_operators_belong_to_claims() -> None:
    with pytest.raises(ModelError, match="inside claims and lemmas only"):
        age(trace(Counter).signals["on"], 3)  # type: ignore[arg-type]


# --- parameters and reals ------------------------------------------------------------------------------------------


class Scaled(Model, event="tick"):
    """Adds an amount that is fixed for a run."""

    amount: U4 = parameter(3, unit="unit", within=(2, 5), source="[A] test", init=False)
    sum_: U8 = power_up(0)

    def step(self) -> Scaled:
        return Scaled(sum_=(self.sum_ + self.amount).low(8))


def test_an_open_parameter_is_anything_in_its_range_and_never_changes() -> None:
    def grows(s: Seen) -> Bit:
        return implies(s.sum_ <= 250, (s.sum_ + s.amount) <= s.sum_ + 5)

    assert verdict(grows, Scaled, symbolic=("amount",)).verdict == PROVED
    assert (
        verdict(lambda s: previous(s.amount, 2) <= s.amount, Scaled, symbolic=("amount",), induction=2).verdict
        == PROVED
    )
    found = verdict(lambda s: s.sum_ != 10, Scaled, symbolic=("amount",), expect=REFUTED)
    assert found.steps == 3 and found.counterexample is not None and found.counterexample.chosen["amount"] == 5

    def never_ten(s: Seen) -> Bit:
        """False after 174 steps, as 3 * 174 = 522 = 2 * 256 + 10."""
        return s.sum_ != 10

    kept = with_no_search_for_proofs(never_ten, model=Scaled, settings={"amount": 3}, steps=5)
    assert (kept.verdict, kept.steps) == (BOUNDED, 5)
    assert verdict(never_ten, Scaled, settings={"amount": 3}, steps=5).steps == 175


class Filter(Model, event="tick"):
    """Follows a real input at a rate of one half."""

    y: Real = power_up(0)

    def step(self, u: Real) -> Filter:
        return Filter(y=(self.y + u) / 2)


def test_reals_are_proved_and_refuted_exactly() -> None:
    def within(s: Seen) -> Bit:
        return (s.u <= 3) & (s.u >= -3)

    def small(s: Seen) -> Bit:
        return (s.y <= 3) & (s.y >= -3)

    found = verdict(small, Filter, given=within, arithmetic=BITS)  # a real has no bits: asked in integers
    assert (found.verdict, found.agreed_by) == (PROVED, ["z3", "cvc5"])

    def below(s: Seen) -> Bit:
        """True: the mean of two numbers below 3 and at most 3 is below 3."""
        return s.y < 3

    kept = with_no_search_for_proofs(below, model=Filter, given=within, induction=0, steps=4)
    assert (kept.verdict, kept.steps) == (BOUNDED, 4)
    assert verdict(below, Filter, given=within, induction=0, steps=4).verdict == PROVED  # by another engine
    found = verdict(lambda s: s.y <= Fraction(5, 2), Filter, given=within, expect=REFUTED)
    assert (found.verdict, found.steps) == (REFUTED, 4)
    assert (
        verdict(lambda s: s.go, given=lambda s: s.n.real() / 2 >= 0, arithmetic=BITS, expect=REFUTED).verdict == REFUTED
    )


def test_a_run_that_no_fraction_can_show_is_not_called_a_counterexample() -> None:
    found = prove(asked(lambda s: s.u * s.u != 2, Filter, expect=REFUTED), Limits(20, ("z3",)))
    assert found.verdict == UNDECIDED and "no fraction is" in found.why
    found = verdict(lambda s: (s.u * s.u < 2) | (s.u * s.u > Fraction(201, 100)), Filter, expect=REFUTED)
    assert found.verdict == REFUTED


# --- memory --------------------------------------------------------------------------------------------------------


def test_a_claim_leaves_no_terms_behind() -> None:
    verdict(below_sixteen, lemmas=[passed_in_time])
    gc.collect()
    before = graph_size()
    for k in range(5):
        verdict(lambda s, k=k: s.n + word(k, 3) <= UInt.__add__(s.n, word(k, 3)), steps=3)  # type: ignore[misc]
    gc.collect()
    assert graph_size() <= before


def test_an_unrolling_from_power_up_starts_there() -> None:
    system = trace(Counter)
    fixed, free = Unrolling(system, "z3", True), Unrolling(system, "z3", True, anywhere=True)
    assert str(fixed.at(0, [system.state["n"].var])[0]) == "0"
    assert str(free.at(0, [system.state["n"].var])[0]) == "n@0"
    assert solve.UNKNOWN == "unknown"

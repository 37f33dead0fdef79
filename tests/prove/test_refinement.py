"""Two levels of one thing: refinements that hold, and the twin of each that must fail."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

import pytest

from safety.faults import ANY_TIME, Budget, Fault, any_of_faults, byzantine, stuck
from safety.model import Model, assume, parameter, point, power_up
from safety.prove.claims import BITS, PROVED, REFUTED, Claim, Seen
from safety.prove.prove import Limits, Outcome, prove
from safety.prove.refinement import Refinement, build_refinement
from safety.system import ANY, ModelError
from safety.terms import U1, U2, U4, Bit, Int, select, word


class Serial(NamedTuple):
    sum_: Bit


class Adder(Model, tick_s="1e-6"):
    """Adds 1 to a word of two bits, a bit a step, the lowest first; `place` says which bit is next."""

    word: U2 = power_up(0)
    carry: Bit = power_up(False)
    place: U1 = power_up(0)

    def step(self, go: Bit) -> tuple[Adder, Serial]:
        first = self.place == 0
        carry_in = select(first, go, self.carry)
        low = self.word.bit(0)
        total = point("total", low ^ carry_in)
        turned = total.word().concat(self.word.slice(1, 1))
        return Adder(word=turned, carry=low & carry_in, place=self.place ^ 1), Serial(sum_=total)


class Count(NamedTuple):
    odd: Bit
    high: Bit


class Counts(Model, tick_s="2e-6"):
    """A count modulo 4, a step a word."""

    n: U2 = power_up(0)

    def step(self, go: Bit) -> tuple[Counts, Count]:
        n = select(go, (self.n + 1).low(2), self.n)
        return Counts(n=n), Count(odd=n.bit(0), high=n.bit(1))


def the_word(s: Seen) -> Mapping[str, Any]:
    """The word in the ring is the count."""
    return {"n": s.word}


def at_the_first_bit(s: Seen) -> Bit:
    return s.place == 0


def refined(lower: type[Model] = Adder, upper: type[Model] = Counts, **changes: Any) -> Claim:
    read = changes.pop("read", the_word)
    steps, at = changes.pop("steps", 2), changes.pop("at", at_the_first_bit)
    outputs = changes.pop("outputs", {"high": "sum_"})
    faults: Budget | None = changes.pop("faults", None)
    expect = changes.pop("expect", PROVED)
    return Claim(
        "test.refinement", lower, read, "said", expect, "", "", faults, None, None, (), (), {}, 6, 1, BITS, None, None,
        None, "refinement", False, Refinement(upper, steps, read, at, outputs),
    )  # fmt: skip


def verdict(**changes: Any) -> Outcome:
    return prove(refined(**changes), Limits(20))


def test_two_bit_times_are_one_word_time() -> None:
    found = verdict()
    assert (found.verdict, found.agreed_by) == (PROVED, ["z3", "cvc5"])
    assert found.problem is not None and str(found.problem.system.clock) == "every 2 us"


class ForgetsCarry(Adder, tick_s="1e-6"):
    """The carry does not reach the upper bit."""

    def step(self, go: Bit) -> tuple[Adder, Serial]:
        after, out = super().step(go)
        return type(self)(word=after.word, carry=after.carry & ~after.carry, place=after.place), out


TWINS: dict[str, dict[str, Any]] = {
    "one bit time": {"steps": 1, "at": None},
    "three bit times": {"steps": 3},
    "wrong output": {"outputs": {"odd": "sum_"}},
    "wrong reading": {"read": lambda s: {"n": s.word ^ 1}},
    "planted bug": {"lower": ForgetsCarry},
    "a fault": {"faults": any_of_faults([Fault(stuck(0), ["total"])])},
    "a fault within a frame": {"faults": any_of_faults([Fault(byzantine(), ["total"], ANY_TIME)])},
}


@pytest.mark.parametrize("changes", TWINS.values(), ids=TWINS.keys())
def test_the_twin_fails(changes: dict[str, Any]) -> None:
    found = verdict(expect=REFUTED, **changes)
    assert found.verdict == REFUTED and found.counterexample is not None
    assert found.counterexample["claim.holds"][-1] is False


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"outputs": ["high"]}, "Adder has no output 'high'"),
        ({"outputs": {"hihg": "sum_"}}, "Counts has no output 'hihg'; did you mean high?"),
        ({"outputs": {"high": "word"}}, "Adder has no output 'word'"),
        ({"read": lambda s: {}}, r"the registers of Counts are \['n'\]; 'n' differs"),
        ({"read": lambda s: {"n": s.word, "m": s.word}}, "'m' differs"),
        ({"read": lambda s: {"n": s.word + 1}}, r"n as read is u2, given u3 \(word \+ 1\); wrap it with"),
        ({"steps": 0}, "0 steps as one; write 1 or more"),
    ],
)
def test_what_does_not_fit_is_refused(changes: dict[str, Any], says: str) -> None:
    if isinstance(changes.get("outputs"), list):
        changes = {"outputs": {o: o for o in changes["outputs"]}}
    with pytest.raises(ModelError, match=says):
        verdict(**changes)


def test_the_upper_model_starts_where_the_lower_one_does_and_nowhere_else() -> None:
    class Any4(Model, event="tick"):
        """Holds a word of four bits."""

        n: U4 = power_up(ANY)

        def step(self, go: Bit) -> Any4:
            return Any4(n=self.n)

    class Any2(Model, event="tick"):
        """Holds a number up to 3."""

        n: Annotated[Int, (0, 3)] = power_up(ANY)

        def step(self, go: Bit) -> Any2:
            return Any2(n=self.n)

    kept = {"lower": Any4, "upper": Any2, "steps": 1, "at": None, "outputs": {}, "read": lambda s: {"n": s.n}}
    with pytest.raises(ModelError, match=r"n as read is int\[0, 3\], given u4 n; clamp it"):
        verdict(**kept)  # else every start above 3 would be left out
    assert verdict(**(kept | {"read": lambda s: {"n": s.n.low(2)}})).verdict == PROVED


class Careful(Counts, tick_s="2e-6"):
    """Assumes that it never reaches 3."""

    def step(self, go: Bit) -> tuple[Counts, Count]:
        assume("below 3", self.n < 3)
        after, out = super().step(go)
        return type(self)(n=after.n), out


class Idle(Counts, tick_s="2e-6"):
    """Assumes that nothing comes, and does nothing."""

    def step(self, go: Bit) -> tuple[Counts, Count]:
        assume("nothing comes", ~go)
        _, out = super().step(go & ~go)
        return type(self)(n=self.n), out


def test_what_the_upper_model_assumes_of_itself_has_to_be_shown() -> None:
    found = verdict(upper=Careful, outputs={}, expect=REFUTED)
    assert (found.verdict, found.steps) == (REFUTED, 4)
    found = verdict(upper=Idle, outputs={})
    assert found.verdict == PROVED and found.problem is not None
    assert "Idle: nothing comes" in found.problem.system.assumptions


class Step(Counts, tick_s="2e-6"):
    """Counts by an amount that can be set."""

    by: U2 = parameter(1, unit="1", within=(0, 3), source="[A] test", init=False)

    def step(self, go: Bit) -> tuple[Counts, Count]:
        n = select(go, (self.n + self.by).low(2), self.n)
        return type(self)(n=n), Count(odd=n.bit(0), high=n.bit(1))


def test_settings_reach_both_models() -> None:
    claim = refined(upper=Step)
    assert prove(claim, Limits(20)).verdict == PROVED
    assert prove(claim, Limits(20), {"by": 2}).verdict == REFUTED
    problem = build_refinement(claim, {"by": 2})
    assert problem.system.settings["spec.by"].value == 2


def test_a_name_of_the_upper_model_is_not_taken_twice() -> None:
    class Part(Model, tick_s="1e-6"):
        """Holds a register called n."""

        n: U2 = power_up(0)

        def step(self) -> Part:
            return Part(n=self.n)

    class WithSpec(Model, tick_s="1e-6"):
        """Has a part called spec."""

        spec: Part

        def step(self, go: Bit) -> WithSpec:
            return WithSpec(spec=self.spec.step())

    with pytest.raises(ModelError, match=r"two registers or inputs are called 'spec\.n'"):
        verdict(lower=WithSpec, upper=Counts, steps=1, at=None, outputs={}, read=lambda s: {"n": s.spec.n})


def test_inputs_have_one_name_in_both() -> None:
    class Other(Model, tick_s="2e-6"):
        """Reads another input."""

        n: U2 = power_up(0)

        def step(self, come: Bit) -> Other:
            return Other(n=select(come, word(1, 2), self.n))

    with pytest.raises(ModelError, match="Other has the input come: bit; give Adder one of that name and type"):
        verdict(upper=Other, outputs={})

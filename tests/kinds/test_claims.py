"""Claims about equipment whose lines, clocks, supplies or sensors fail: one that holds, and its twin that must not."""

from __future__ import annotations

from typing import Any

import pytest

from safety.faults import ANY_TIME, FROM_START, INTERMITTENT, TRANSIENT, Fault, any_of_faults, common_cause
from safety.kinds import (
    bridge,
    clock_fast,
    clock_slow,
    clock_stop,
    drift,
    intermittent,
    memory_flip,
    noise,
    open_circuit,
    power_dip,
    slow_to_release,
    stuck,
    swapped,
    wired_and,
    wired_or,
)
from safety.model import Model, point, power_up
from safety.prove.claims import PROVED, REFUTED, Claim, Formula, has, previous, struck
from safety.prove.prove import Limits, prove
from safety.system import ANY
from safety.terms import U2, U4, Bit, bit, implies


class Counter(Model, event="tick"):
    """Counts round by one."""

    n: U2 = power_up(0)
    kept: U2 = power_up(ANY)

    def step(self) -> Counter:
        return Counter(n=(self.n + 1).low(2), kept=self.kept)


class Pair(Model, event="tick"):
    """Two counters compared, two lines that are never both on, a reading, and a relay that follows a line."""

    one: Counter
    other: Counter

    def step(self, lift: Bit, v: U4) -> Pair:
        point("up", lift)
        point("down", ~lift)
        point("speed", ((v // 2) + 4).widen(4))
        return Pair(one=self.one.step(), other=self.other.step())


def outcome(faults: list[Fault], formula: Formula, arithmetic: str = "bits") -> str:
    claim = Claim(
        "f.f", Pair, formula, "said", PROVED, "", "", any_of_faults(faults), None, None, (), (), {}, 6, 2, arithmetic,
        None, None, None,
    )  # fmt: skip
    found = prove(claim, Limits(20, ("z3",)))
    if found.verdict == REFUTED:
        assert (
            found.counterexample is not None and found.counterexample["claim.holds"][-1] is False
        )  # as the Python reading has it
    return found.verdict


def apart(s: Any) -> Any:
    """How far the first counter is ahead of the second, round by four."""
    return (s.one.n.int() - s.other.n.int()).low(2)


def in_turn(s: Any) -> Bit:
    """After one comes two, in the first counter."""
    return implies(previous(s.one.n == 1, False), s.one.n == 2)


def steady(s: Any, counter: str) -> Bit:
    """What a counter keeps, it keeps."""
    low = s[f"{counter}.kept"].bit(0)
    return implies(previous(bit(True), False), ~(low ^ previous(low, False)))


LINES = ["up", "down"]


@pytest.mark.parametrize(
    ("faults", "holds", "fails"),
    [
        ([Fault(clock_stop(), ["Pair"], ANY_TIME)], lambda s: apart(s) == 0, in_turn),
        ([Fault(clock_stop(), ["one"], TRANSIENT, ticks=1, name="c")],
         lambda s: implies(~struck(s, "c"), apart(s) == 0), lambda s: apart(s) == 0),
        ([Fault(clock_slow(2), ["one"], name="c")], lambda s: implies(~has(s, "c"), in_turn(s)), in_turn),
        ([Fault(clock_fast(3), ["one"])], lambda s: (apart(s) == 0) | (apart(s) == 2), lambda s: apart(s) == 0),
        ([Fault(power_dip(), ["one"], TRANSIENT, ticks=1)], lambda s: steady(s, "other"), lambda s: steady(s, "one")),
        ([Fault(power_dip(), ["one", "other"], TRANSIENT, ticks=2)], lambda s: apart(s) == 0, in_turn),
        ([Fault(memory_flip(bit=1), ["one.n"], INTERMITTENT)], lambda s: ~apart(s).bit(0), lambda s: apart(s) == 0),
        ([Fault(wired_or(), LINES, ANY_TIME)], lambda s: s.up | s.down, lambda s: s.up ^ s.down),
        ([Fault(wired_and(), LINES, ANY_TIME)], lambda s: ~(s.up & s.down), lambda s: s.up ^ s.down),
        ([Fault(bridge(), LINES, name="b")], lambda s: implies(has(s, "b"), ~(s.up ^ s.down)),
         lambda s: implies(has(s, "b"), s.up)),
        ([Fault(swapped(), LINES, INTERMITTENT)], lambda s: s.up ^ s.down, lambda s: ~(s.up ^ s.lift)),
        ([Fault(noise(2), ["speed"])], lambda s: (s.speed >= 2) & (s.speed <= 13), lambda s: s.speed >= 3),
        ([Fault(drift(1), ["speed"], TRANSIENT, ticks=2)], lambda s: s.speed <= 13, lambda s: s.speed <= 12),
        ([Fault(slow_to_release(2), ["up"])], lambda s: s.up | s.down, lambda s: ~(s.up & s.down)),
        ([Fault(intermittent(stuck(1), 1, 2), ["up"])], lambda s: s.up | s.down, lambda s: s.up ^ s.down),
        ([common_cause("supply", {"one": power_dip(), "up": open_circuit()}, onset=ANY_TIME)],
         lambda s: ~(s.up & s.down), lambda s: s.up | s.down),
        ([Fault(clock_stop(), ["one"], ANY_TIME, name="c"), Fault(swapped(), LINES, FROM_START, name="x")],
         lambda s: implies(~has(s, "c"), apart(s) == 0) & (s.up ^ s.down),
         lambda s: implies(~has(s, "x"), apart(s) == 0)),
    ],
    ids=lambda v: ", ".join(map(str, v)) if isinstance(v, list) else "",
)  # fmt: skip
def test_a_claim_and_its_twin(faults: list[Fault], holds: Formula, fails: Formula) -> None:
    arithmetic = "integers" if "speed" in str(faults[0].points) else "bits"
    assert outcome(faults, holds, arithmetic) == PROVED
    assert outcome(faults, fails, arithmetic) == REFUTED

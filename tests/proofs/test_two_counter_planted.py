"""Bugs planted in the two-counter ATC: each is refuted, by a replayed run, by a claim that holds of it as it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import pytest

from models.two_counter import step_s
from models.two_counter.circuit import Circuit, CommandMemory, Counter1, Counter2
from models.two_counter.equipment import Equipment
from models.two_counter.failures import component_faults
from models.two_counter.selection import Selection
from models.two_counter.train import Oscillator, PulseCount
from proofs import two_counter_circuit as circuit
from proofs import two_counter_decision as decision
from proofs import two_counter_refinement as refinement
from proofs import two_counter_response as response
from proofs.two_counter_formulas import ROWS, greatest_permitted, least_too_fast, steadily
from safety import PROVED, REFUTED, Bit, Scenario, UInt, any_of_faults, bit, point, power_up, select
from safety.model import Model
from safety.prove.claims import Claim, claim_id, registered
from safety.prove.problem import build_problem
from safety.prove.prove import Limits, prove
from safety.prove.search import scripted

SHORT = Limits(timeout=10, synthesis=0, simulation=0, portfolio=0)
NAMED = {fault.name: fault for fault in component_faults()}
LIMIT, PERMITTED = least_too_fast(ROWS[250]), greatest_permitted(ROWS[250])
AT_LIMIT = steadily(250, LIMIT, 2100)
AT_F2E = steadily(250, PERMITTED, 2100, left=PERMITTED - 1)
SLOWER = steadily(250, PERMITTED * 9 // 10, 5000)


def with_circuit(of: type[Circuit]) -> type[Equipment]:
    """The equipment with another circuit."""

    class Changed(Equipment, tick_s=step_s):
        circuit: of  # type: ignore[valid-type]

    return Changed


def with_counter2(of: type[Counter2]) -> type[Equipment]:
    class Changed(Circuit, tick_s=step_s):
        counter2: of  # type: ignore[valid-type]

    return with_circuit(Changed)


class OneTooLate(Counter2, tick_s=step_s):
    def reached(self, counted: UInt, preset: UInt) -> Bit:
        return counted > preset


class OneTooSoon(Counter2, tick_s=step_s):
    def reached(self, counted: UInt, preset: UInt) -> Bit:
        return counted + 1 >= preset


class ThreeInTen(Counter2, tick_s=step_s):
    """The stage of 128 is not decoded."""

    def reached(self, counted: UInt, preset: UInt) -> Bit:
        return (counted & 0b11101111111) >= (preset & 0b11101111111)


class Crossed(Circuit, tick_s=step_s):
    def of_ff2(self, and2: Bit, and3: Bit) -> tuple[Bit, Bit]:
        return and3, and2


class OnlyReset(Circuit, tick_s=step_s):
    def of_ff2(self, and2: Bit, and3: Bit) -> tuple[Bit, Bit]:
        return bit(False), and3


class NeverReset(Circuit, tick_s=step_s):
    def of_ff6(self, enough: Bit, signal2: Bit) -> tuple[Bit, Bit]:
        return enough, bit(False)


class NeverEnough(Circuit, tick_s=step_s):
    def of_ff6(self, enough: Bit, signal2: Bit) -> tuple[Bit, Bit]:
        return bit(False), signal2


class NotStrobed(Circuit, tick_s=step_s):
    def strobed(self, name: str, opened: Bit, read_out: Bit) -> Bit:
        return point(name, opened)


class Energised(Circuit, tick_s=step_s):
    def energised(self, brake: Bit) -> Bit:
        return brake


class ReleasedAtPowerUp(CommandMemory, tick_s=step_s):
    on: Bit = power_up(False)


class StartsReleased(Circuit, tick_s=step_s):
    ff2: ReleasedAtPowerUp


class OnePulseMore(Counter1, tick_s=step_s):
    def step(self, pulses: PulseCount, reset: Bit) -> tuple[Counter1, Bit]:
        before = select(reset, 0, self.n)
        n = (before + pulses).low(11)
        return type(self)(n=n), (pulses > 0) & (n > self.n1f)


class OnePulseFewer(Counter1, tick_s=step_s):
    def step(self, pulses: PulseCount, reset: Bit) -> tuple[Counter1, Bit]:
        before = select(reset, 0, self.n)
        n = (before + pulses).low(11)
        return type(self)(n=n), (pulses > 0) & (n >= self.n1f - 1)


class NeedsMore(Circuit, tick_s=step_s):
    counter1: OnePulseMore


class NeedsFewer(Circuit, tick_s=step_s):
    counter1: OnePulseFewer


class HighestForNone(Selection, tick_s=step_s):
    def none_selected(self) -> UInt:
        return self.m250


class NoneIsFastest(Equipment, tick_s=step_s):
    selection: HighestForNone


class Silent(Oscillator, tick_s=step_s):
    def step(self) -> tuple[Oscillator, PulseCount]:
        return type(self)(), point("f1", bit(False)).word().int().clip(0, 2)


class WithoutOscillator(Equipment, tick_s=step_s):
    oscillator: Silent


@dataclass(frozen=True)
class Bug:
    """A change of the equipment (another model, a fault from the start, or a setting), a claim that finds it, and the
    run tried for it, if a short search is not enough."""

    found_by: Callable[..., Any]
    model: type[Model] | None = None
    fault: str = ""
    settings: dict[str, Any] = field(default_factory=dict)
    run: Scenario | None = None


BUGS = {
    "gate closes an edge late": Bug(decision.no_release_on_overspeed, with_counter2(OneTooLate), run=AT_LIMIT),
    "gate closes an edge early": Bug(decision.no_needless_brake, with_counter2(OneTooSoon), run=AT_F2E),
    "a stage is not decoded": Bug(decision.no_needless_brake, with_counter2(ThreeInTen), run=steadily(160, 300_000)),
    "signal 1 always": Bug(circuit.signals_come_in_order, fault="signal 1 always"),
    "AND2 and AND3 crossed": Bug(circuit.one_of_and2_and_and3_is_open, with_circuit(Crossed)),
    "FF2 is never set": Bug(response.overspeed_brakes_in_time, with_circuit(OnlyReset), run=response.worst_case(250)),
    "FF6 is never reset": Bug(circuit.signals_come_in_order, with_circuit(NeverReset), run=SLOWER),
    "FF6 is never set": Bug(decision.no_needless_brake, with_circuit(NeverEnough), run=SLOWER),
    "AND2 and AND3 not strobed": Bug(decision.releases_exactly_after_n1f_pulses, with_circuit(NotStrobed), run=SLOWER),
    "energised is brake": Bug(decision.releases_exactly_after_n1f_pulses, with_circuit(Energised)),
    "released at power-up": Bug(decision.releases_exactly_after_n1f_pulses, with_circuit(StartsReleased)),
    "n1F + 1 needed": Bug(decision.no_needless_brake, with_circuit(NeedsMore), run=AT_F2E),
    "n1F - 1 enough": Bug(decision.no_release_on_overspeed, with_circuit(NeedsFewer), run=AT_LIMIT),
    "no line is 250 km/h": Bug(circuit.the_lowest_line_sets_the_preset, NoneIsFastest),
    "no oscillator": Bug(decision.no_needless_brake, WithoutOscillator, run=SLOWER),
    "preset of 5 is 60": Bug(circuit.the_lowest_line_sets_the_preset, settings={"selection.m5": 60}),
    "oscillator 600 ppm fast": Bug(decision.no_release_on_overspeed, settings={"oscillator.error": 600}, run=AT_LIMIT),
    "oscillator 600 ppm slow": Bug(decision.no_needless_brake, settings={"oscillator.error": -600}, run=AT_F2E),
    "wheel 1 mm larger": Bug(decision.no_release_on_overspeed, settings={"train.wheel": 911}, run=AT_LIMIT),
    "relay releases late": Bug(
        response.overspeed_brakes_in_time, settings={"circuit.ry1.release": 9}, run=response.worst_case(250)
    ),
    "signal 1 missing": Bug(circuit.signals_come_in_order, fault="signal 1 missing"),
    "signal 2 missing": Bug(circuit.signals_come_in_order, fault="signal 2 missing", run=SLOWER),
    "signals 2 and 3 swapped": Bug(circuit.signals_come_in_order, fault="signals 2 and 3 swapped", run=SLOWER),
    "counter 1 not reset": Bug(circuit.signals_come_in_order, fault="counter 1 is not reset", run=SLOWER),
    "AND1 always open": Bug(circuit.signals_come_in_order, fault="AND1 at 1", run=SLOWER),
    "counter 2 misses counts": Bug(
        decision.no_release_on_overspeed,
        fault="counter 2 misses one count in 100",
        run=steadily(250, LIMIT * 201 // 200),
    ),
}


def of_claim(formula: Callable[..., Any]) -> Claim:
    return next(c for c in registered() if c.id == claim_id(formula))


def about(bug: Bug) -> Claim:
    """The claim about the equipment with the bug."""
    claim = of_claim(bug.found_by)
    changed = replace(claim, model=bug.model or claim.model, settings=bug.settings, expect=REFUTED, lemmas=())
    if not bug.fault:
        return replace(changed, scenario=bug.run)
    run = replace(bug.run, present=[bug.fault]) if bug.run else None
    return replace(changed, scenario=run, faults=any_of_faults([NAMED[bug.fault]]))


@pytest.mark.parametrize("name", BUGS)
def test_a_planted_bug_is_refuted(name: str) -> None:
    assert of_claim(BUGS[name].found_by).expect == PROVED
    found = prove(about(BUGS[name]), SHORT)
    assert found.verdict == REFUTED, found.why
    assert found.counterexample is not None and not found.counterexample["claim.holds"][-1]


@pytest.mark.parametrize("name", [n for n, bug in BUGS.items() if bug.run])
def test_the_run_breaks_nothing_without_the_bug(name: str) -> None:
    run = BUGS[name].run
    assert run is not None
    kept = scripted(build_problem(of_claim(BUGS[name].found_by)), run, keep=["claim.holds", "claim.given"])
    assert all(kept["claim.holds"])


def test_a_circuit_that_needs_more_is_no_refinement() -> None:
    """Gate circuit 1 one pulse off: circuit and sample equation part."""
    claim = of_claim(refinement.the_circuit_is_the_sample_equation)
    start = {f"{model}train.phase": AT_F2E.start["train.phase"] for model in ("", "spec.")}
    found = prove(
        replace(claim, model=with_circuit(NeedsMore), expect=REFUTED, scenario=replace(AT_F2E, start=start)), SHORT
    )
    assert found.verdict == REFUTED, found.why

"""Dual processors: the program and the check word told a second time, the claims, every upset, and planted bugs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import pytest

from models.dual_processor import BUS_CYCLE, Comparator, OnBoard, OutputUnit, Processor, Reading, Words
from proofs import dual_processor as proofs
from proofs import dual_processor_campaign as campaign
from proofs import dual_processor_hazards as hazard_file
from proofs import dual_processor_rates
from proofs.dual_processor import NEAR, RUN, STRIKE
from safety import ANY_TIME, REFUTED, TRANSIENT, Bit, Fault, UInt, clock_slow, power_dip, run, stuck
from safety.faults import instrument, schedule
from safety.model import Model
from safety.prove.claims import claim_id, registered
from safety.prove.hazards import CONFIRMED, CutSets, cut_sets, hazards
from safety.prove.prove import Limits, prove
from safety.rates.claims import declared
from safety.trace import Trace
from safety.tracing import trace
from tests.proofs.verdicts import check, claims_of
from tests.seeded.planting import planted

STANDING_STILL: dict[str, Any] = {
    "reading.balise": False, "reading.stop": False, "reading.distance": 0, "reading.run": 0, "reading.speed": 0,
}  # fmt: skip
CLAIMS = claims_of(proofs)
OWN = Limits(synthesis=0, simulation=0, portfolio=0)


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    check(prove(CLAIMS[name], OWN))


def test_every_proved_claim_has_a_twin_that_fails() -> None:
    twins = {claim.twin_of for claim in CLAIMS.values() if claim.expect == REFUTED}
    proved = [claim for claim in CLAIMS.values() if claim.expect != REFUTED]
    assert proved and {claim.id for claim in proved} <= twins


def broken(fault: Fault, row: Callable[[int], dict[str, Any]], steps: int) -> Trace:
    """A run with a fault, which strikes where it says."""
    built = instrument(trace(OnBoard), [fault])
    choices = schedule(built)
    return run(built.system, lambda step: STANDING_STILL | row(step) | choices(step), steps)


# --- the model, told a second time ------------------------------------------------------------------------------------


def told(readings: Sequence[dict[str, int]]) -> list[bool]:
    """The command that holds in each cycle, by the words of the description."""
    permit, active, left, told_stop, permits = False, True, 0, False, []
    for step, now in enumerate(readings):
        permits.append(permit)
        if step % 4 == 0:
            told_stop = bool(now["balise"] and now["stop"])
            active = active and not (now["balise"] and not now["stop"])
        elif step % 4 == 1 and told_stop:
            active, left = True, now["distance"]
        elif step % 4 == 2:
            left = max(0, left - now["run"])
        elif step % 4 == 3:
            permit = not active or now["speed"] ** 2 <= left
    return permits


def ride(step: int) -> dict[str, int]:
    """A signal at stop, approached at 6 with brakes from 20 m on; cleared at step 60."""
    return {"balise": step in (8, 60), "stop": step < 60, "distance": 50, "run": 1, "speed": 6 if step < 70 else 9}


def test_both_processors_do_what_the_description_says() -> None:
    rides = [ride(step) for step in range(120)]
    seen = run(OnBoard, [{f"reading.{k}": v for k, v in now.items()} for now in rides], steps=120)
    assert seen["safe"] == told(rides)
    assert seen["brake"][5:] == [not permit for permit in told(rides)][5:]
    assert Counter(seen["brake"]) != Counter([True] * 120), "it runs at least once"


def remainder(value: int, degree: int = 4, polynomial: int = 0b10011) -> int:
    """Division over GF(2), digit by digit."""
    for k in reversed(range(degree, value.bit_length())):
        if value >> k & 1:
            value ^= polynomial << (k - degree)
    return value


@pytest.mark.parametrize("entry", [0, 1, 2, 77, 128, 200, 255])
def test_check_word_is_the_remainder_of_the_division(entry: int) -> None:
    seen = run(OnBoard, STANDING_STILL | {"reading.distance": entry}, steps=1)
    assert sum(seen[f"line.rom.check{k}"][0] << k for k in range(4)) == remainder(entry << 4)
    assert seen["line.usable"] == [True]


# --- acceptance -------------------------------------------------------------------------------------------------------


def test_as_12_single_bit_fault_brakes_within_a_compare_cycle_and_an_identical_fault_does_not() -> None:
    alone, both = campaign.one.inject(), campaign.both.inject()
    assert Counter(cell for _, cell in alone.injections()) == {"neutral/yes": 48 * 40}
    assert Counter(cell for _, cell in both.injections()) == {"wrong/no": 231, "neutral/no": 24 * 40 - 231}
    mtbf = next(r for r in declared() if r.id == "dual-processor.mtbf").evaluate()
    assert (round(mtbf["value"]), mtbf["met"], len(mtbf["agreed_by"])) == (47_619, True, 2)


def test_as_12_latency_of_each_upset_is_one_cycle() -> None:
    """Replayed on the Python reading, one bit of each word: braked in the next cycle and ever after."""
    for fault in proofs.FLIPS[::5]:
        seen = broken(replace(fault, at=20), lambda step: {"reading.balise": True, "reading.speed": 3}, 40)
        assert seen["brake"][20] is False
        assert all(seen["brake"][21:]), fault.name


@pytest.mark.parametrize("rate", [r for r in declared() if r.id.startswith("dual-processor.")], ids=lambda r: r.id)
def test_rates_agree_by_two_routes_and_meet_what_is_specified(rate: Any) -> None:
    entry = rate.evaluate()
    assert len(entry["agreed_by"]) == 2
    assert entry["met"] is not False
    assert entry["assumed"], "every figure of this part is [A] and says so"


# --- hazards ----------------------------------------------------------------------------------------------------------


@cache
def found() -> CutSets:
    return cut_sets(next(h for h in hazards() if h.id.startswith("dual_processor_hazards.")))


def test_cut_sets_are_complete_confirmed_and_those_of_the_tree() -> None:
    sets = found()
    assert sets.all_orders
    assert sets.by_order() == sets.by_order(CONFIRMED) == {1: 3, 2: 2}
    expected = {frozenset(one) for one in dual_processor_rates.cut_sets()}
    assert {frozenset(one.faults) for one in sets.sets} == expected


def test_no_single_fault_of_a_processor_comparator_clock_or_supply_is_a_cut_set() -> None:
    assert {one.faults[0] for one in found().sets if one.order == 1} == set(hazard_file.SINGLES)


@pytest.mark.parametrize(
    "fault",
    [
        Fault(stuck(0), ["dual.clock"], ANY_TIME, at=STRIKE),
        Fault(stuck(0), ["dual.output.supply"], ANY_TIME, at=STRIKE),
        Fault(power_dip(), ["dual"], TRANSIENT, at=STRIKE, ticks=3),
        Fault(clock_slow(2), ["dual"], ANY_TIME, at=STRIKE),
    ],
    ids=["clock", "supply", "brown-out", "slow clock"],
)
def test_loss_of_clock_or_supply_never_leaves_the_train_running_on(fault: Fault) -> None:
    """Running free (a signal cleared), the fault, then a signal at stop too near: braked within four sweeps."""
    seen = broken(fault, lambda step: NEAR | {"reading.stop": step >= STRIKE}, 2 * RUN)
    assert seen["brake"][STRIKE - 1] is False
    assert all(seen["brake"][STRIKE + 17 :])


# --- planted ----------------------------------------------------------------------------------------------------------


class IgnoresTheDistance(Comparator, tick_s=BUS_CYCLE):
    def compared(self, words: Words) -> Sequence[Bit | UInt]:
        return *words[:3], words.stored.low(3)


class GoesOn(Comparator, tick_s=BUS_CYCLE):
    def level_after(self, clock: Bit, stopped: Bit) -> Bit:
        return self.level ^ clock


class HoldsLevel(OutputUnit, tick_s=BUS_CYCLE):
    def alive(self, signal: Bit) -> Bit:
        return signal | self.before


class ForgetsAtOnce(Processor, tick_s=BUS_CYCLE):
    """Another program in one of the two: a difference that healthy parts show."""

    def step(self, reading: Reading, usable: Bit, runs: Bit) -> tuple[Processor, Words]:
        following, words = super().step(reading, usable, runs)
        return following, words._replace(data=words.data & 1)


PLANTED = [
    (proofs.any_flipped_bit_brakes, {"dual.comparator": IgnoresTheDistance}),
    (proofs.a_mismatch_brakes_for_ever, {"dual.comparator": GoesOn}),
    (proofs.a_signal_that_stands_still_brakes, {"dual.output": HoldsLevel}),
    (proofs.one_broken_processor_is_safe, {"dual.comparator": GoesOn}),
]


@pytest.mark.parametrize("stated, places", PLANTED, ids=lambda x: getattr(x, "__name__", ""))
def test_planted_bug_is_refuted_by_a_replayed_run(stated: Any, places: dict[str, type[Model]]) -> None:
    healthy = next(c for c in registered() if c.id == claim_id(stated))
    wrong = replace(healthy, model=planted(healthy.model, places), expect=REFUTED, lemmas=())
    outcome = prove(wrong, Limits(synthesis=0, simulation=0, portfolio=0))
    assert outcome.verdict == REFUTED
    assert outcome.counterexample is not None


def test_another_program_in_one_processor_stops_the_train() -> None:
    changed = planted(OnBoard, {"dual.a": ForgetsAtOnce})
    seen = run(
        changed, STANDING_STILL | {"reading.balise": True, "reading.stop": True, "reading.distance": 100}, steps=12
    )
    assert all(seen["brake"]) and seen["dual.comparator.stopped"][-1]

"""Mistakes planted in the driver and around it, each of which shows in the outcome of some random batch.

A mistake must not write beside its memory: it has to show as a wrong number.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from safety.faults import Fault, byzantine
from safety.inject.engine import NEVER, Batch, Outcome, Task, Timing
from safety.inject.masks import Mask
from safety.inject.native import NativeEngine, masking, program, sweep
from safety.inject.native.driver import Driver
from safety.inject.native.kernel import UNUSED, Kernel
from safety.inject.native.program import Program
from safety.inject.native.routine import Routine
from safety.system import System
from safety.terms.graph import BIT
from tests.inject.native_systems import differences, random_batch, random_task


@pytest.fixture(autouse=True)
def short_stretches(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    for name, number in (("NEW_RUNS", 1), ("SHORTEST", 9), ("MOST", 1000), ("WORTH_WHILE", -1)):
        monkeypatch.setattr(sweep, name, number)


FORMS = ("words", "sliced")
SAMPLES = range(12)
BUILT_IN = 0  # the sample whose faults no mask can carry


@functools.cache
def sample(number: int) -> tuple[Task, Batch, Outcome]:
    """A task, a batch, and its outcome when nothing is left out."""
    task = random_task(number, Timing(4, 36, 9, 1), atoms=16, masks_only=True)
    if number == BUILT_IN:
        task = replace(task, atoms=tuple(chosen_by_step(task.system)))
    batch = random_batch(task, number, 700)
    return task, batch, NativeEngine(task, prune=False, form="words").run(batch)


def chosen_by_step(system: System) -> Iterator[Fault]:
    """Faults that are built in and show another value at each step."""
    for point, term in system.points.items():
        low, high = term.sort.bounds
        values = [low, high, high, low, high, low, low, high]
        yield Fault(byzantine(), [point], values={point: [bool(v) for v in values] if term.sort == BIT else values})


def found(form: str) -> Iterator[bool]:
    for number in SAMPLES:
        task, batch, right = sample(number)
        yield bool(differences(NativeEngine(task, form=form).run(batch), right))


Plant = Callable[[pytest.MonkeyPatch], None]
MISTAKES: dict[str, Plant] = {}


def mistake(plant: Plant) -> Plant:
    MISTAKES[plant.__name__.replace("_", " ")] = plant
    return plant


@pytest.mark.parametrize("form", FORMS)
def test_without_a_mistake_nothing_is_found(form: str) -> None:
    assert not any(found(form))


# --- the time at which a fault acts ----------------------------------------------------------------------------------


def acting(begins: str, ends: str) -> Callable[[Driver, str, str], str]:
    def acts(self: Driver, first: str, end: str) -> str:
        k, now = self.k, self.now.value
        return k.op(f"and i1 {k.is_(begins, 'i64', first, now)}, {k.is_(ends, 'i64', now, end)}")

    return acts


@mistake
def a_fault_begins_a_step_late(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(Driver, "_acts", acting("slt", "slt"))


@mistake
def a_fault_ends_a_step_late(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(Driver, "_acts", acting("sle", "sle"))


@mistake
def a_fault_never_ends(patch: pytest.MonkeyPatch) -> None:
    right = masking.masking
    patch.setattr(program, "masking", lambda kernel: [right(kernel)[0], idle(kernel, "pass", "i64 %lane")])


def idle(kernel: Kernel, name: str, last: str) -> Routine:
    return Routine(kernel.target, name, ["ptr %taps", "ptr %entry", last])


@mistake
def faults_of_a_run_act_in_reverse_order(patch: pytest.MonkeyPatch) -> None:
    right = Driver._masks

    def wrong(self: Driver, condition: str, place: str, lane: str, function: str) -> None:
        last = self.k.op(f"sub i64 {self.given['wide']}, 1")
        right(self, condition, self.k.op(f"sub i64 {last}, {place}"), lane, function)

    patch.setattr(Driver, "_masks", wrong)


@mistake
def a_fault_is_forgotten_in_the_next_step(patch: pytest.MonkeyPatch) -> None:
    after(patch, Driver, "_change", lambda self: self.active.set(0))


@mistake
def masks_stay_for_the_next_group(patch: pytest.MonkeyPatch) -> None:
    before(patch, Driver, "_finish", lambda self: self.active.set(0))


def after(patch: pytest.MonkeyPatch, cls: type, name: str, more: Callable[[Any], None]) -> None:
    right = getattr(cls, name)

    def wrong(self: Any, *args: Any) -> None:
        right(self, *args)
        more(self)

    patch.setattr(cls, name, wrong)


def before(patch: pytest.MonkeyPatch, cls: type, name: str, more: Callable[[Any], None]) -> None:
    right = getattr(cls, name)

    def wrong(self: Any, *args: Any) -> None:
        more(self)
        right(self, *args)

    patch.setattr(cls, name, wrong)


# --- registers -------------------------------------------------------------------------------------------------------


def forgetting(name: str, which: slice | list[int]) -> Plant:
    """A function that leaves out some of the registers."""

    def plant(patch: pytest.MonkeyPatch) -> None:
        right = getattr(Kernel, name)

        def wrong(self: Any) -> Any:
            whole, _, _ = self.registers, self.kept.places, self.state.offsets
            self.__dict__["registers"] = whole[which] if isinstance(which, slice) else [whole[k] for k in which]
            try:
                return right(self)
            finally:
                self.__dict__["registers"] = whole

        patch.setattr(Kernel, name, wrong)

    return plant


for function in ("restore", "record", "give", "take"):
    MISTAKES[f"{function} leaves out the first register"] = forgetting(function, slice(1, None))
    MISTAKES[f"{function} leaves out every other register"] = forgetting(function, slice(None, None, 2))


# --- what is counted -------------------------------------------------------------------------------------------------


@mistake
def a_difference_counts_the_other_way(patch: pytest.MonkeyPatch) -> None:
    right = Driver._count
    patch.setattr(
        Driver, "_count", lambda self, wire, lanes, more: right(self, wire, lanes, self.k.op(f"sub i16 0, {more}"))
    )


@mistake
def counts_go_to_another_block(patch: pytest.MonkeyPatch) -> None:
    right = Program.stretch

    def wrong(self: Program, *args: Any, **how: Any) -> Any:
        seen = right(self, *args, **how)
        return seen._replace(counts=np.roll(seen.counts, 1, axis=1))

    patch.setattr(Program, "stretch", wrong)


@mistake
def counts_of_two_wires_are_exchanged(patch: pytest.MonkeyPatch) -> None:
    right = Driver._count
    patch.setattr(
        Driver,
        "_count",
        lambda self, wire, *rest: right(self, self.kernel.counted[wire == self.kernel.counted[0]], *rest),
    )


@mistake
def counts_stay_for_the_next_group(patch: pytest.MonkeyPatch) -> None:
    right = Driver._finish

    def wrong(self: Driver, group: str) -> None:
        flush, self._flush = self._flush, lambda: None  # type: ignore[method-assign]
        right(self, group)
        self._flush = flush  # type: ignore[method-assign]

    patch.setattr(Driver, "_finish", wrong)


@mistake
def the_last_true_frame_for_the_first(patch: pytest.MonkeyPatch) -> None:
    right = Routine.is_
    inside: list[int] = []

    def came(self: Driver, *args: Any) -> None:
        inside.append(1)
        inner(self, *args)
        inside.pop()

    inner = Driver._came
    patch.setattr(Driver, "_came", came)
    patch.setattr(
        Routine, "is_", lambda self, how, kind, x, y: right(self, how, kind, y if inside else x, x if inside else y)
    )


@mistake
def what_a_leap_passes_is_not_seen(patch: pytest.MonkeyPatch) -> None:
    right = Driver._leap

    def wrong(self: Driver) -> None:
        missed, self.missed = self.missed, []
        right(self)
        self.missed = missed

    patch.setattr(Driver, "_leap", wrong)


@mistake
def what_comes_after_a_stretch_is_not_seen(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(sweep, "_next", lambda p, step: np.full(p.kernel.watched, NEVER, np.int32))


@mistake
def a_frame_ends_a_step_early(patch: pytest.MonkeyPatch) -> None:
    rolled(patch, "tally", -1)


@mistake
def a_block_ends_a_step_early(patch: pytest.MonkeyPatch) -> None:
    right = Program._time

    def wrong(self: Program, rows: Any) -> None:
        right(self, rows)
        last = rows["tally"] == 2
        rows["tally"] = np.where(rows["tally"] > 0, 1 + np.roll(last, -1), 0)

    patch.setattr(Program, "_time", wrong)


@mistake
def the_next_true_frame_is_that_of_the_step_before(patch: pytest.MonkeyPatch) -> None:
    rolled(patch, "next0", 1)


@mistake
def the_fault_free_wires_are_those_of_the_step_before(patch: pytest.MonkeyPatch) -> None:
    rolled(patch, "wire0", 1)


def rolled(patch: pytest.MonkeyPatch, field: str, by: int) -> None:
    right = Program._time

    def wrong(self: Program, rows: Any) -> None:
        right(self, rows)
        rows[field] = np.roll(rows[field], by)

    patch.setattr(Program, "_time", wrong)


# --- lanes and stretches ---------------------------------------------------------------------------------------------


@mistake
def lanes_are_one_place_off(patch: pytest.MonkeyPatch) -> None:
    right = program._chosen
    patch.setattr(program, "_chosen", lambda array, columns, none: np.roll(right(array, columns, none), 1, axis=1))


@mistake
def a_run_inherits_from_another(patch: pytest.MonkeyPatch) -> None:
    right = sweep._one_of_each

    def wrong(*args: Any) -> tuple[Any, Any]:
        chosen, heirs = right(*args)
        return chosen, np.where(heirs >= 0, (heirs + 1) % max(len(chosen), 1), heirs)

    patch.setattr(sweep, "_one_of_each", wrong)


@mistake
def runs_with_faults_to_come_are_one(patch: pytest.MonkeyPatch) -> None:
    right = sweep._one_of_each
    patch.setattr(sweep, "_one_of_each", lambda records, goes_on, pending: right(records, goes_on, pending & False))


@mistake
def equal_digests_are_equal_states(patch: pytest.MonkeyPatch) -> None:
    right = sweep._one_of_each
    patch.setattr(sweep, "_digest", lambda words: words[:, 0])
    patch.setattr(sweep, "_one_of_each", lambda records, *rest: right(records[:, :1], *rest))


@mistake
def runs_that_are_apart_end_with_the_stretch(patch: pytest.MonkeyPatch) -> None:
    right = sweep._one_of_each
    patch.setattr(sweep, "_one_of_each", lambda records, goes_on, pending: right(records, pending, pending))


@mistake
def the_outcome_is_in_the_order_of_the_groups(patch: pytest.MonkeyPatch) -> None:
    right = Program.stretch

    def wrong(self: Program, runs: Batch, *args: Any, **how: Any) -> Any:
        seen = right(self, runs, *args, **how)
        return seen._replace(counts=seen.counts[:, :, ::-1], came=seen.came[:, ::-1])

    patch.setattr(Program, "stretch", wrong)


# --- faults that are built in ----------------------------------------------------------------------------------------


@mistake
def a_switch_stays_off(patch: pytest.MonkeyPatch) -> None:
    right = Program._entry
    patch.setattr(
        Program, "_entry",
        lambda self, keep, turn, mask, at: right(self, keep, turn, Mask(0, 0) if keep is UNUSED else mask, at),
    )  # fmt: skip


@mistake
def choices_come_a_step_late(patch: pytest.MonkeyPatch) -> None:
    right = Program._choices
    patch.setattr(Program, "_choices", lambda self, total: {n: np.roll(a, 1) for n, a in right(self, total).items()})


@mistake
def a_mask_blocks_what_should_pass(patch: pytest.MonkeyPatch) -> None:
    right = Program._passing.func

    def wrong(self: Program) -> Any:
        block = right(self)
        block[np.flatnonzero(block)[:1]] = 0
        return block

    patch.setattr(Program, "_passing", property(wrong))


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    expect_found(MISTAKES[name], "words", monkeypatch)


def expect_found(plant: Plant, form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for number in SAMPLES:
        sample(number)
    plant(monkeypatch)
    assert any(found(form))


@pytest.mark.parametrize("form", FORMS)
def test_states_of_one_digest_stay_apart(form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweep, "_digest", lambda words: np.zeros(len(words), np.uint64))
    assert not any(found(form))

"""The native engine gives the outcome of the NumPy lanes and of the Python run, on every kind of processor."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from proofs.ts7_system_campaign import overspeed
from safety.faults import Fault, flip, stuck
from safety.inject import CampaignError
from safety.inject.engine import NEVER, NONE, Batch, Task, Timing
from safety.inject.lanes import LaneEngine
from safety.inject.native import NativeEngine, engine, sweep
from safety.system import ModelError
from safety.terms import TermError
from safety.terms.graph import BIT, REAL, uint, variable
from safety.terms.native_bits import slices_pay
from safety.terms.values import bit
from tests.inject.native_systems import apart_from_python, differences, random_batch, random_task
from tests.terms.agreement import targets

TARGETS = targets()
FORMS = ("words", "sliced")
RUNS = 70


@pytest.fixture(autouse=True)
def nothing_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@pytest.fixture
def short_stretches(monkeypatch: pytest.MonkeyPatch) -> None:
    """Even a small batch is run in stretches."""
    for name, number in (("NEW_RUNS", 1), ("SHORTEST", 5), ("MOST", 1000), ("WORTH_WHILE", -1)):
        monkeypatch.setattr(sweep, name, number)


EACH = [(seed, processor) for seed in range(60) for processor in TARGETS]
FEW = {(seed, list(TARGETS)[seed % len(TARGETS)]) for seed in range(3)}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("processor", TARGETS)
def test_outcome_of_masks_is_that_of_the_python_run(processor: str, form: str) -> None:
    compare(random_task(8, masks_only=True), 8, processor, form)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(
    ("seed", "processor"), [pytest.param(*one, marks=[] if one in FEW else pytest.mark.slow) for one in EACH]
)
def test_outcome_of_all_kinds_is_that_of_the_python_run(seed: int, processor: str, form: str) -> None:
    compare(random_task(seed, Timing(3, 24, 8, 1 + (seed % 4 == 1)), atoms=10), seed, processor, form)


def compare(task: Task, seed: int, processor: str, form: str) -> None:
    batch = random_batch(task, seed, RUNS)
    found = NativeEngine(task, target=TARGETS[processor], form=form).run(batch)
    assert apart_from_python(task, batch, found, range(0, RUNS, 2)) == []
    try:
        lanes = LaneEngine(task).run(batch)
    except ModelError as refused:
        assert "draws a value at each step" in str(refused)  # within a frame the lanes cannot
    else:
        assert differences(found, lanes) == []


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("seed", range(4))
def test_what_is_left_out_changes_nothing(seed: int, form: str, short_stretches: None) -> None:
    masks_only = seed % 2 == 0
    task = random_task(seed, Timing(5, 40, 10, 1), atoms=20 if masks_only else 6, masks_only=masks_only)
    batch = random_batch(task, seed, 500 if form == "words" else 1200)
    batch.atoms[:, ::50] = NONE
    batch.first[:, 1::50] = NEVER - 1
    whole = NativeEngine(task, prune=False, form="words").run(batch)
    assert differences(NativeEngine(task, form=form).run(batch), whole) == []
    if masks_only:
        assert differences(NativeEngine(task, form=form, prune=False).run(batch), whole) == []


def test_the_cheaper_form_is_chosen() -> None:
    x: Any = variable("x", uint(16))
    assert slices_pay([(x + 1).low(16) == 7], [x])
    assert not slices_pay([(x * x).bit(3)], [x])


def test_an_unknown_form_is_refused() -> None:
    with pytest.raises(ModelError, match="form 'slice'; did you mean"):
        NativeEngine(random_task(1, masks_only=True), form="slice")


def test_faults_at_one_point_act_in_the_order_of_their_rows() -> None:
    task = random_task(1, masks_only=True)
    point = next(p for p, t in task.system.points.items() if t.sort == BIT)
    atoms = (Fault(stuck(0), [point]), Fault(flip(), [point]), Fault(stuck(1), [point]))
    task = replace(task, atoms=atoms)
    rows = np.array([[a, b] for a in range(3) for b in range(3)]).T.astype(np.int32)
    batch = Batch(rows, np.zeros_like(rows), np.full_like(rows, NEVER))
    for form in FORMS:
        found = NativeEngine(task, form=form).run(batch)
        assert apart_from_python(task, batch, found, range(9)) == []


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("prune", [True, False])
def test_runs_without_faults_are_the_fault_free_run(prune: bool, form: str) -> None:
    task = random_task(2, masks_only=True)
    nothing = np.full((2, 3), NONE, np.int32)
    native = NativeEngine(task, prune=prune, form=form)
    found, golden = native.run(Batch(nothing, nothing, nothing)), native.golden
    assert all(np.array_equal(found.counts[name], np.repeat(golden.counts[name], 3, axis=1)) for name in task.count)
    assert all(np.array_equal(found.first[name], np.repeat(golden.first[name], 3)) for name in task.watch)
    assert differences(golden, LaneEngine(task).golden) == []


def test_an_empty_batch() -> None:
    task = random_task(2, masks_only=True)
    nothing = np.zeros((1, 0), np.int32)
    found = NativeEngine(task).run(Batch(nothing, nothing, nothing))
    assert {array.shape for array in found.counts.values()} == {(3, 0)}


def test_more_faults_than_are_built_in_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "MOST_BUILT_IN", 3)
    task = random_task(3, atoms=10)
    batch = random_batch(task, 3, 24)
    assert apart_from_python(task, batch, NativeEngine(task).run(batch), range(24)) == []


def test_inputs_of_64_bits_are_exact() -> None:
    task = random_task(5, masks_only=True)
    wide: Any = variable("wide", uint(64))
    wires = {"w0": wide == 2**63 + 1, "w1": wide < 2**53 + 1, "w2": bit(False)}
    system = replace(task.system, inputs={**task.system.inputs, "wide": wide}, signals=wires)
    rows = [{**task.inputs(frame), "wide": (2**63 + 1, 2**53, 2**64 - 1)[frame % 3]} for frame in range(27)]
    task = replace(task, system=system, atoms=(), inputs=rows.__getitem__)
    nothing = np.full((1, 1), NONE, np.int32)
    batch = Batch(nothing, nothing, nothing)
    assert apart_from_python(task, batch, NativeEngine(task).run(batch), [0]) == []


# --- what does not fit -----------------------------------------------------------------------------------------------


def test_a_broken_assumption_is_refused_at_its_step() -> None:
    task = random_task(4, masks_only=True)
    x: Any = task.system.inputs["x1"]
    broken = replace(task.system, assumptions={"x1 is never at its top": x < x.sort.bounds[1]})
    rows = [{**task.inputs(frame), "x1": x.sort.bounds[1] * (frame == 7)} for frame in range(task.timing.frames)]
    with pytest.raises(CampaignError, match="breaks the assumption 'x1 is never at its top' of the model at step 7"):
        _ = NativeEngine(replace(task, system=broken, inputs=rows.__getitem__)).golden


def test_a_fault_may_break_an_assumption() -> None:
    task = random_task(4, masks_only=True)
    point: Any = next(t for t in task.system.points.values() if t.sort == BIT)
    held = [NativeEngine(task).run(batch := random_batch(task, 4, RUNS))]
    assumed = replace(task.system, assumptions={"always": point | ~point})
    held.append(NativeEngine(replace(task, system=assumed)).run(batch))
    assert differences(*held) == []


@pytest.mark.parametrize(("sort", "message"), [(REAL, "is a real"), (uint(70), "more than the 64 bits")])
def test_a_model_that_does_not_fit_is_refused(sort: Any, message: str) -> None:
    task = random_task(5, masks_only=True)
    wide: Any = variable("wide", sort)
    system = replace(
        task.system, inputs={**task.system.inputs, "wide": wide}, signals={"w0": wide < 1, "w1": bit(True)}
    )
    with pytest.raises(TermError, match=message):
        NativeEngine(replace(task, system=system, atoms=(), watch=()))


def test_a_kind_that_does_not_fit_its_point_is_refused() -> None:
    task = random_task(6, masks_only=True)
    number = next(p for p, t in task.system.points.items() if t.sort.kind == "int")
    with pytest.raises(ModelError, match="does not apply to"):
        NativeEngine(replace(task, atoms=(Fault(stuck(0), [number]),)))


# --- TS-7 ------------------------------------------------------------------------------------------------------------


def ts7(frames: int, block: int) -> Task:
    """Every bit of every point of the whole equipment stuck and flipped; the train is just above the limit."""
    system = overspeed.system
    bits = [
        (point, b)
        for point, term in system.points.items()
        for b in ([None] if term.sort == BIT else range(term.sort.width))
    ]
    atoms = [Fault(kind, [point]) for point, b in bits for kind in (stuck(0, b), stuck(1, b), flip(b))]
    wires = [name for name in system.signals if name.startswith("observed")]
    ride = overspeed.timing.frames - frames
    return Task(
        system, tuple(atoms), tuple(wires[:2]), tuple(wires[1:]), Timing(0, frames, block, 1),
        lambda frame: overspeed.inputs(ride + frame), overspeed.start,
    )  # fmt: skip


def ts7_batch(task: Task, runs: int) -> Batch:
    rng, frames = np.random.default_rng(runs), task.timing.frames
    first = rng.integers(0, frames, (1, runs))
    end = np.where(rng.random((1, runs)) < 0.3, NEVER, first + rng.integers(1, 9, (1, runs)))
    atoms = rng.integers(0, len(task.atoms), (1, runs))
    return Batch(*(a.astype(np.int32) for a in (atoms, first, end)))


@pytest.mark.parametrize(
    ("runs", "frames"),
    [
        (100_000, 64),
        pytest.param(1_000_000, 64, marks=pytest.mark.slow),
        pytest.param(1_000, 8_000, marks=pytest.mark.slow),
    ],
)
def test_random_faults_of_ts7(runs: int, frames: int) -> None:
    task = ts7(frames, 16)
    batch = ts7_batch(task, runs)
    found = NativeEngine(task, form="sliced").run(batch)
    assert differences(found, LaneEngine(task).run(batch)) == []
    assert differences(found, NativeEngine(task, form="words").run(batch)) == []
    assert differences(found, NativeEngine(task, prune=False).run(batch)) == []
    assert apart_from_python(task, batch, found, range(0, runs, runs // (20 if frames < 100 else 4))) == []

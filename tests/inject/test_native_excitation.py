"""Of several faults that stay, those that change nothing are left out; the outcome is that of all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from safety.inject.engine import NEVER, NONE, Batch, Outcome, Task, Timing
from safety.inject.native import NativeEngine, engine, excitation
from safety.inject.native.excitation import Excitation
from tests.inject.native_systems import apart_from_python, differences, random_task

FIRST = 6


@pytest.fixture(autouse=True)
def even_for_few_runs(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(engine, "REDUCING_PAYS", 0)
    monkeypatch.setattr(excitation, "PAYS", 0)


def several(seed: int, order: int) -> tuple[Task, Batch]:
    """Many faults that stay, at random; often two at one point, in some rows none."""
    task = random_task(seed, Timing(2, 24, 8, 1), atoms=14, masks_only=True)
    atoms = np.random.default_rng(seed).integers(NONE, len(task.atoms), (order, 600)).astype(np.int32)
    return task, Batch(atoms, np.full_like(atoms, FIRST), np.full_like(atoms, NEVER))


def outcome(task: Task, batch: Batch) -> tuple[Outcome, int]:
    """What the engine gives, and how many runs it made for it."""
    native, made = NativeEngine(task), 0
    inner: Callable[..., Outcome] = engine.sweep.run

    def counted(program: Any, runs: Batch, **how: Any) -> Outcome:
        nonlocal made
        made += runs.runs
        return inner(program, runs, **how)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(engine.sweep, "run", counted)
        return native.run(batch), made


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize("seed", [*range(4), *(pytest.param(n, marks=pytest.mark.slow) for n in range(4, 60))])
def test_the_outcome_is_that_of_all_faults(seed: int, order: int) -> None:
    task, batch = several(seed, order)
    found, _ = outcome(task, batch)
    assert differences(found, NativeEngine(task, prune=False).run(batch)) == []
    assert apart_from_python(task, batch, found, range(0, 600, 100)) == []


@pytest.mark.parametrize("order", [2, 3])
def test_fewer_runs_are_made(order: int, monkeypatch: pytest.MonkeyPatch) -> None:
    made = outcome(*several(0, order))[1]
    altered(monkeypatch, lambda self, atoms, found: found | True)
    assert made < outcome(*several(0, order))[1]


def test_faults_that_pass_or_begin_at_different_steps_are_all_run() -> None:
    task, batch = several(0, 2)
    column = np.flatnonzero(batch.atoms[0] != NONE)[0]
    later = batch.first.copy()
    later[0, column] += 1
    short = batch.end.copy()
    short[0, column] = FIRST + 2
    for other in (Batch(batch.atoms, later, batch.end), Batch(batch.atoms, batch.first, short)):
        assert outcome(task, other)[1] == batch.runs


# --- mistakes ---------------------------------------------------------------------------------------------------------


def shows(order: int) -> Iterator[bool]:
    for seed in range(6):
        task, batch = several(seed, order)
        yield bool(differences(NativeEngine(task).run(batch), NativeEngine(task, prune=False).run(batch)))


def altered(patch: pytest.MonkeyPatch, change: Callable[[Excitation, Any, Any], Any]) -> None:
    right = Excitation.changes
    patch.setattr(Excitation, "changes", lambda self, atoms: change(self, atoms, right(self, atoms)))


def test_nothing_shows_without_a_mistake() -> None:
    assert not any(shows(3))


@pytest.mark.parametrize("order", [2, 3])
def test_a_bit_that_is_not_noted_shows(order: int, monkeypatch: pytest.MonkeyPatch) -> None:
    for which in ("ONES", "ZEROS"):
        with monkeypatch.context() as patch:
            right = excitation.noting

            def wrong(system: Any, points: Any, which: str = which, right: Any = right) -> Any:
                found = right(system, points)
                name = getattr(excitation, which)
                states = [s if not s.path.endswith(name) else type(s)(s.var, s.var, s.power_up) for s in found.states]
                return type(found)(**{**found.__dict__, "states": tuple(states)})

            patch.setattr(excitation, "noting", wrong)
            assert any(shows(order))


def test_faults_that_share_a_point_show(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Excitation, "_share", property(lambda self: np.zeros((len(self.masks) + 1,) * 2, np.bool_)))
    assert any(shows(2))


def test_a_pair_taken_for_another_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    altered(monkeypatch, lambda self, atoms, found: np.roll(found, 1, axis=0) if len(atoms) == 2 else found)
    assert any(shows(3))


def test_a_fault_alone_taken_for_another_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    altered(monkeypatch, lambda self, atoms, found: np.roll(found, 1, axis=0) if len(atoms) == 1 else found)
    assert any(shows(2))


def test_an_outcome_taken_for_another_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    right = Excitation.reduced
    monkeypatch.setattr(Excitation, "reduced", lambda self, atoms: np.roll(right(self, atoms), 1, axis=1))
    assert any(shows(2))

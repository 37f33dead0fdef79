"""kill -9 of workers and of the driver at any moment: only what they had in hand is lost, and nothing differs."""

from __future__ import annotations

import contextlib
import random
import subprocess
import time
from pathlib import Path

import pytest

from safety.inject.store import store as stores
from tests.inject import timer_project as timer

pytestmark = pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="finds processes in /proc")


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return timer.write(tmp_path_factory.mktemp("killed"))


@pytest.fixture(scope="module")
def undisturbed(root: Path) -> dict[str, bytes]:
    """The shards of a run without any trouble."""
    stored = timer.whole(root, root / "undisturbed")
    assert stored.complete and len(stored.shards) == 26
    return timer.files(stored.folder)


def pieces(root: Path, what: str = "begin") -> int:
    return sum(timer.told(root)[what].values())


def reach(root: Path, process: subprocess.Popen[str], number: float) -> None:
    """Wait until so many pieces have been begun, or the driver has ended."""
    timer.until(lambda: pieces(root) >= number or process.poll() is not None)


def run_and_kill(root: Path, store: Path, pick: random.Random, *, of_26: float) -> int:
    """Run the campaign; kill a worker at some moment and the driver at another; returns how many workers fell."""
    process, before, killed = timer.driver(root, store), pieces(root), 0
    first, second = sorted(pick.uniform(0, of_26) for _ in range(2))
    for share, whom in ((first, "worker"), (second, "driver")):
        reach(root, process, before + share * 26)
        time.sleep(pick.uniform(0, 0.04))
        there = timer.workers(root, process.pid)
        if whom == "worker" and there:
            timer.kill(pick.choice(there))
            killed += 1
    process.kill()
    process.communicate()
    timer.wait_for_workers_to_end(root)
    return killed


def kill_again_and_again(root: Path, store: Path, undisturbed: dict[str, bytes], times: int, seed: int) -> None:
    pick, workers_killed = random.Random(seed), 0
    (root / "log").unlink(missing_ok=True)
    for _ in range(times):
        workers_killed += run_and_kill(root, store, pick, of_26=1.5 / times)
        left = [path.name for path in store.glob(f"*/{stores.NEW}*")]
        there = {name: data for name, data in files_if_any(store).items() if name not in left}
        assert there.items() <= undisturbed.items(), "a shard is there whole, or not at all"
    last = timer.driver(root, store)
    said, _ = last.communicate(timeout=timer.PATIENCE_S)
    assert (last.returncode, said.splitlines()[-1:]) == (0, ["() 0"]), said
    found = files_if_any(store)
    assert {name: data for name, data in found.items() if not name.startswith(stores.NEW)} == undisturbed
    redone = pieces(root) - len(undisturbed)
    assert redone <= times * timer.WORKERS + workers_killed, "a driver costs a piece a worker, a worker one piece"


def files_if_any(store: Path) -> dict[str, bytes]:
    return {name: data for folder in store.glob("*/") for name, data in timer.files(folder).items()}


def test_whoever_is_killed_the_shards_are_the_same(root: Path, undisturbed: dict[str, bytes]) -> None:
    kill_again_and_again(root, root / "few", undisturbed, times=2, seed=1)


def test_killed_workers_cost_nothing_but_time(root: Path, undisturbed: dict[str, bytes]) -> None:
    """What they had in hand is given out again, in the same run."""
    (root / "log").unlink(missing_ok=True)
    process, pick = timer.driver(root, root / "workers"), random.Random(4)
    for done in (3, 10, 17):
        reach(root, process, done)
        timer.kill(pick.choice(timer.workers(root, process.pid)))
    said, _ = process.communicate(timeout=timer.PATIENCE_S)
    assert said.splitlines() == ["() 0"]
    assert files_if_any(root / "workers") == undisturbed
    assert pieces(root) <= len(undisturbed) + 3


@pytest.mark.slow
def test_whoever_is_killed_at_twenty_moments_the_shards_are_the_same(root: Path, undisturbed: dict[str, bytes]) -> None:
    kill_again_and_again(root, root / "many", undisturbed, times=20, seed=2)


@pytest.mark.slow
def test_a_driver_killed_before_it_is_ready_costs_nothing(root: Path, undisturbed: dict[str, bytes]) -> None:
    """Moments spread over a whole run, its start included."""
    pick = random.Random(3)
    for _ in range(20):
        process = timer.driver(root, root / "early")
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.communicate(timeout=pick.uniform(0, 1.5))
        process.kill()
        process.communicate()
    timer.wait_for_workers_to_end(root)
    last = timer.driver(root, root / "early")
    last.communicate(timeout=timer.PATIENCE_S)
    assert last.returncode == 0
    assert timer.files(timer.opened(root, root / "early").folder) == undisturbed


def test_a_planted_loss_is_seen(root: Path, undisturbed: dict[str, bytes], tmp_path: Path) -> None:
    """A shard written in place, not renamed into it, can be there in part: the comparison sees it."""
    name = next(iter(undisturbed))
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / name).write_bytes(undisturbed[name][:-1])
    assert not files_if_any(tmp_path).items() <= undisturbed.items()


def test_a_piece_that_ends_its_worker_each_time_is_given_up_and_the_rest_goes_on(tmp_path: Path) -> None:
    root = timer.write(tmp_path)
    poison = timer.CAMPAIGN.replace('log(f"begin {low}")', 'log(f"begin {low}"); os._exit(9) if low == 80 else None')
    (root / "proofs" / "timer.py").write_text(poison)
    process = timer.driver(root, tmp_path / "store")
    said, _ = process.communicate(timeout=timer.PATIENCE_S)
    assert "timer: injections 80 to 119 are given up: 3 workers died of it, the last by exit code 9" in said
    assert said.strip().endswith(" 1"), "one range is missing"
    assert timer.told(root)["begin"][80] == 3
    assert sum(timer.told(root)["end"].values()) == 25

"""Campaigns on a real Dask cluster of this machine: a worker is killed, then the scheduler."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from safety.commands.declared import Declared
from safety.inject.store import Store, Stored, StoreError, open_executor, run_sharded
from tests.inject import timer_project as timer

pytest.importorskip("distributed", reason="Dask is not installed: pip install rightside[cluster]")


class LocalCluster:
    """A scheduler and two workers, each a process."""

    def __init__(self, root: Path, workers: int = 2, without: str = "") -> None:
        self.root, self.file, self.without = root, root / "scheduler.json", without
        self.scheduler = self._start("dask_scheduler", "--port", "0")
        self.workers: list[subprocess.Popen[bytes]] = []
        for _ in range(workers):
            self.join()
        timer.until(lambda: self.file.exists() and self.file.read_text())
        address = json.loads(self.file.read_text())["address"]
        self.address = address.replace("tcp://", "dask://")

    def join(self) -> None:
        """One more worker."""
        self.workers.append(self._start("dask_worker", "--no-nanny", "--nthreads", "1"))

    def _start(self, what: str, *options: str) -> subprocess.Popen[bytes]:
        path = {"PYTHONPATH": str(self.root / "bare")} if what == self.without else {}
        environment = timer.environment(self.root) | path
        quiet = ("--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(self.file))
        return subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.{what}", *quiet, *options],
            cwd=self.root, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip

    def end(self) -> None:
        for process in (self.scheduler, *self.workers):
            process.kill()
            process.wait()


@pytest.fixture
def root(tmp_path: Path) -> Path:
    return timer.write(tmp_path)


@pytest.fixture
def cluster(root: Path) -> Iterator[LocalCluster]:
    there = LocalCluster(root)
    yield there
    there.end()


def run(root: Path, cluster: LocalCluster, at_half: Callable[[], object]) -> Stored:
    """Run the campaign there; something happens when half of it is done."""
    happens = iter([at_half])

    def progress(share: float, seconds: float) -> None:
        if share > 0.5:
            next(happens, lambda: None)()

    find = Declared(str(root), "timer")
    with open_executor(cluster.address) as executor:
        return run_sharded(find(), find, Store(root / "store"), executor, size=timer.SIZE, progress=progress)


def test_a_cluster_survives_its_workers_and_a_campaign_its_cluster(root: Path, cluster: LocalCluster) -> None:
    whole = timer.files(timer.whole(root, root / "undisturbed").folder)
    stored = run(root, cluster, cluster.workers[0].kill)
    assert (stored.complete, stored.problems) == (True, ())
    assert timer.files(stored.folder) == whole
    assert cluster.workers[0].wait() and cluster.workers[1].poll() is None

    for path in sorted(stored.folder.iterdir())[6:]:
        path.unlink()
    with pytest.raises(StoreError, match=r"timer: the cluster .* of 1040 injections are kept.*--resume"):
        run(root, cluster, cluster.scheduler.kill)
    there = timer.files(stored.folder)
    assert len(there) > 13 and there.items() <= whole.items(), "what was done is kept"
    assert timer.files(timer.whole(root, root / "store").folder) == whole, "and the rest is made elsewhere"


@pytest.fixture
def bare(root: Path) -> Path:
    """What stands before the package that is installed."""
    (root / "bare/safety").mkdir(parents=True)
    (root / "bare/safety/__init__.py").write_text("")
    return root


@pytest.mark.parametrize(
    ("without", "named", "late_s"),
    [("dask_scheduler", "the scheduler", 0), ("dask_worker", "the worker", 0), ("dask_worker", "the worker", 2)],
)
def test_a_machine_without_the_package_is_named(bare: Path, without: str, named: str, late_s: int) -> None:
    there = LocalCluster(bare, workers=0, without=without)
    joins = threading.Timer(late_s, there.join)
    joins.start()
    try:
        with pytest.raises(StoreError, match=f"{named} .* does not find the package safety of rightside") as caught:
            run(bare, there, lambda: None)
        assert caught.value.exit_code == 2
    finally:
        joins.join()
        there.end()

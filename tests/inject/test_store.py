"""The store: what was made is found again, what is damaged is made again, what cannot be kept is said."""

from __future__ import annotations

import errno
import os
import resource
import sqlite3
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from safety.commands.declared import Declared
from safety.inject import Campaign, CampaignError
from safety.inject.store import Part, Store, Stored, StoreError, campaign_key, open_executor, run_sharded
from safety.inject.store import store as stores
from safety.inject.store.running import cuts, shard_size
from safety.inject.store.shards import decode, encode
from safety.project import ProjectError
from tests.inject import timer_project as timer

Make = Callable[..., Stored]
SHARDS = 26


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return timer.write(tmp_path_factory.mktemp("stored"))


@pytest.fixture(scope="module")
def whole(root: Path) -> Stored:
    return timer.whole(root, root / "whole")


@pytest.fixture
def said() -> list[str]:
    return []


@pytest.fixture
def make(root: Path, tmp_path: Path, said: list[str]) -> Make:
    """Run the campaign, or a part of it, into a store of the test's own."""

    def make(**options: Any) -> Stored:
        find = Declared(str(root), "timer")
        with open_executor("serial") as executor:
            return run_sharded(find(), find, Store(tmp_path, said.append), executor, size=timer.SIZE, **options)

    return make


def begun(root: Path, monkeypatch: pytest.MonkeyPatch, run: Callable[[], object]) -> int:
    """How many pieces are begun in a run."""
    monkeypatch.setenv("LOG", str(root / "log"))
    (root / "log").unlink(missing_ok=True)
    run()
    return sum(timer.told(root)["begin"].values())


# --- what is there ---------------------------------------------------------------------------------------------------


def test_the_shards_together_are_the_campaign(whole: Stored) -> None:
    plain = whole.campaign.inject()
    stored = whole.result()
    assert (whole.complete, whole.made, whole.total, len(whole.shards)) == (True, 1040, 1040, SHARDS)
    for one, other in zip(stored.judged.arrays, plain.judged.arrays, strict=True):
        assert (one == other).all()
    assert (stored.tally, stored.interrupted) == (plain.tally, False)
    undetected = [number for number, cell in enumerate(plain.judged.cells) if cell == 5]
    assert whole.undetected() == undetected and len(undetected) == 227
    listed = whole.store.asked(lambda ledger: ledger.undetected(whole.key))
    assert listed[0] == (undetected[0], whole.campaign.space.injection(undetected[0]).id)
    assert sum(whole.histogram.values()) == 1040


def test_only_what_is_missing_is_made(make: Make, whole: Stored, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    half = make(part=Part(1, 2))
    assert [len(gap) for gap in half.missing] == [timer.SIZE] * 13
    assert (half.made, half.complete, half.result().interrupted) == (520, False, True)
    assert begun(root, monkeypatch, make) == 13
    assert begun(root, monkeypatch, make) == 0
    assert timer.files(make().folder) == timer.files(whole.folder)
    assert make().digest == whole.digest != half.digest


def test_without_resume_all_is_made_again_and_compared(make: Make, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make()
    assert begun(root, monkeypatch, lambda: make(resume=False)) == SHARDS
    campaign = Declared(str(root), "timer")()
    monkeypatch.setattr(type(campaign), "judged", lambda self, low, high: _turned(type(self).__base__, self, low, high))
    with pytest.raises(StoreError, match="injections 0 to 39 came to something else than before"):
        make(resume=False)


def _turned(kind: Any, campaign: Any, low: int, high: int) -> Any:
    found = kind.judged(campaign, low, high)
    found.cells[0] ^= 1
    return found


def test_progress_is_told_up_to_the_end(make: Make) -> None:
    shares: list[float] = []
    make(part=Part(2, 2), progress=lambda share, seconds: shares.append(share))
    assert shares == sorted(shares) and shares[-1] == 1 and len(shares) == 13


def test_an_interruption_keeps_what_is_done(make: Make, whole: Stored) -> None:
    def stop(share: float, seconds: float) -> None:
        if share > 0.3:
            raise KeyboardInterrupt

    stored = make(progress=stop)
    assert (stored.interrupted, len(stored.shards)) == (True, 8)
    assert timer.files(make().folder) == timer.files(whole.folder)


def test_an_error_of_the_campaign_is_told_and_keeps_what_is_done(
    make: Make, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kind = type(Declared(str(root), "timer")())

    def broken(self: Any, low: int, high: int) -> Any:
        if low == 200:
            raise CampaignError("the fault-free run is judged faulty")
        return kind.__base__.judged(self, low, high)

    monkeypatch.setattr(kind, "judged", broken)
    with pytest.raises(CampaignError, match="judged faulty"):
        make()
    monkeypatch.undo()
    assert begun(root, monkeypatch, make) == SHARDS - 5


def test_a_list_too_long_for_the_ledger_is_read_from_the_shards(
    make: Make, whole: Stored, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stores, "LISTED", 15)
    stored = make()
    assert 0 < len(stored.store.asked(lambda ledger: ledger.undetected(stored.key))) < 227
    assert stored.undetected() == whole.undetected()


@pytest.mark.parametrize("kind", [ThreadPoolExecutor, ProcessPoolExecutor])
def test_any_executor_will_do(kind: type[Executor], root: Path, whole: Stored, tmp_path: Path) -> None:
    find, options = Declared(str(root), "timer"), {"mp_context": get_context("spawn")}
    with kind(3, **(options if kind is ProcessPoolExecutor else {})) as executor:  # type: ignore[call-arg]
        stored = run_sharded(find(), find, Store(tmp_path), executor, size=timer.SIZE)
    assert timer.files(stored.folder) == timer.files(whole.folder)


def test_threads_take_turns(root: Path, whole: Stored, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A worker of Dask may have many threads, and a campaign has one engine."""
    kind, inside = type(whole.campaign), threading.Lock()

    def alone(self: Any, low: int, high: int) -> Any:
        assert inside.acquire(blocking=False), "two at a time"
        time.sleep(0.001)
        found = kind.__base__.judged(self, low, high)
        inside.release()
        return found

    monkeypatch.setattr(kind, "judged", alone)
    with ThreadPoolExecutor(4) as executor:
        assert run_sharded(whole.campaign, lambda: whole.campaign, Store(tmp_path), executor, size=timer.SIZE).complete


def test_two_drivers_in_one_store_do_not_harm_each_other(root: Path, whole: Stored, tmp_path: Path) -> None:
    both = [timer.driver(root, tmp_path, "serial") for _ in range(2)]
    said = [process.communicate(timeout=timer.PATIENCE_S)[0] for process in both]
    assert [process.returncode for process in both] == [0, 0], said
    assert timer.files(timer.opened(root, tmp_path).folder) == timer.files(whole.folder)


def test_what_a_killed_driver_was_writing_is_removed_later(make: Make, tmp_path: Path) -> None:
    folder = make(part=Part(1, 26)).folder
    old, new = (folder / f"{stores.NEW}{name}" for name in ("machine-1", "machine-2"))
    for path in (old, new):
        path.write_bytes(b"half")
    os.utime(old, (0, 0))
    make(part=Part(1, 26))
    assert (old.exists(), new.exists()) == (False, True)


def test_a_shard_has_its_name_only_when_all_of_it_is_on_the_disk(make: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    events: list[str] = []
    sync, rename = os.fsync, Path.replace

    def synced(handle: int) -> None:
        events.append("folder" if stat.S_ISDIR(os.fstat(handle).st_mode) else f"file of {os.fstat(handle).st_size}")
        sync(handle)

    def renamed(self: Path, target: Path) -> Path:
        assert not target.exists()
        events.append(f"named {self.stat().st_size}")
        return rename(self, target)

    monkeypatch.setattr(os, "fsync", synced)
    monkeypatch.setattr(Path, "replace", renamed)
    sizes = [path.stat().st_size for path in sorted(make().folder.iterdir())]
    assert events == [event for size in sizes for event in (f"file of {size}", f"named {size}", "folder")]


# --- damage ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "damage", [lambda data: data[:-1], lambda data: b"", lambda data: data[:99] + b"?" + data[100:]]
)
def test_a_damaged_shard_is_made_again(
    make: Make, whole: Stored, said: list[str], damage: Callable[[bytes], bytes]
) -> None:
    path = make().folder / f"{80:012d}-{120:012d}.shard"
    path.write_bytes(damage(path.read_bytes()))
    stored = make()
    assert said == [f"{path} is damaged: its checksum is wrong; it has to be made again"]
    assert timer.files(stored.folder) == timer.files(whole.folder)


def test_a_shard_of_another_campaign_or_size_is_not_taken(make: Make, whole: Stored, root: Path) -> None:
    folder = make(part=Part(1, 2)).folder
    with pytest.raises(StoreError, match="cut with another size"):
        find = Declared(str(root), "timer")
        with open_executor("serial") as executor:
            run_sharded(find(), find, Store(folder.parent), executor, size=64)
    stranger = next(whole.folder.iterdir())
    _, judged = decode(stranger.read_bytes())
    (folder / f"{0:012d}-{40:012d}.shard").write_bytes(encode("other", "f" * 64, 0, 1040, judged)[1])
    with pytest.raises(StoreError, match=r"belongs to another campaign.*move it away"):
        make()


def change(ledger: Path, statement: str) -> None:
    base = sqlite3.connect(ledger)
    with base:
        base.execute(statement)
    base.close()


@pytest.mark.parametrize(
    "damage",
    [
        lambda path: path.unlink(),
        lambda path: path.write_bytes(b"no ledger at all" * 100),
        lambda path: path.write_bytes(path.read_bytes()[:5000]),
        lambda path: change(path, "DELETE FROM undetected WHERE number % 7 = 0"),
        lambda path: change(path, "UPDATE undetected SET number = 1 WHERE number = 2"),
        lambda path: change(path, "UPDATE undetected SET id = 'another' WHERE number = 3"),
        lambda path: change(path, "UPDATE shards SET digest = 'x' WHERE lo = 80"),
        lambda path: change(path, "DELETE FROM shards"),
        lambda path: change(path, "INSERT INTO undetected SELECT key, 1, id FROM undetected WHERE number = 2"),
    ],
)
def test_a_damaged_ledger_loses_nothing(
    make: Make, tmp_path: Path, whole: Stored, damage: Callable[[Path], None]
) -> None:
    make()
    damage(tmp_path / "ledger.sqlite")
    stored = make()
    assert stored.undetected() == whole.undetected()
    names = dict(stored.store.asked(lambda ledger: ledger.undetected(stored.key)))
    assert names == {number: whole.campaign.space.injection(number).id for number in whole.undetected()}


def test_documents_of_a_ledger_outlive_its_making_anew(make: Make) -> None:
    stored = make()
    for document in ("1e-9", "1e-9", "2e-9"):
        stored.keep("fmeda", [{"du": document}])
    stored.store.rebuild()
    again = make()
    assert [document for _, document in again.kept("fmeda")] == [[{"du": "1e-9"}], [{"du": "2e-9"}]]
    assert again.kept("baseline") == []
    assert again.store.asked(lambda ledger: ledger.campaigns()) == {again.key: ("timer", 1040)}


# --- what cannot be kept ---------------------------------------------------------------------------------------------


def test_a_full_disk_is_told_and_loses_nothing(make: Make, whole: Stored, monkeypatch: pytest.MonkeyPatch) -> None:
    count = iter(range(1000))

    def full(handle: int) -> None:
        if next(count) >= 10:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StoreError, match=r"No space left on device; 200 of 1040 injections are kept; make room"):
        make()
    monkeypatch.undo()
    stored = make()
    assert timer.files(stored.folder) == timer.files(whole.folder), "nothing half written is left"


def test_files_that_may_not_grow_are_told_of(root: Path, whole: Stored, tmp_path: Path) -> None:
    """A real limit of the operating system, which the ledger meets first."""
    process = subprocess.run(
        [sys.executable, timer.__file__, str(root), str(tmp_path), "serial"],
        env=timer.environment(root), capture_output=True, text=True, timeout=timer.PATIENCE_S,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (42_000, 42_000)),
    )  # fmt: skip
    assert "StoreError" in process.stderr and "the shards are kept" in process.stderr
    assert 0 < len(timer.files(tmp_path / whole.folder.name)) < SHARDS
    assert timer.files(timer.whole(root, tmp_path).folder) == timer.files(whole.folder)


def test_a_store_that_cannot_be_written_is_told(whole: Stored, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match=r"Not a directory; make room or give another --store"):
        Store(tmp_path / "file").open(whole.campaign, whole.key)


# --- which part, which campaign --------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["", "1", "0/2", "3/2", "a/b", "1/0", "-1/2", "1/2/3"])
def test_a_part_is_i_of_n(text: str) -> None:
    with pytest.raises(StoreError, match=r"write i/n with i from 1 to n, e\.g\. 2/8"):
        Part.parse(text)


def test_cuts_follow_from_the_campaign_alone(whole: Stored) -> None:
    """About a second of work each, whoever does it; 64 times as long a run, so many fewer injections."""
    longer = SimpleNamespace(frames=64 * whole.campaign.timing.frames, steps=1)
    found = [
        shard_size(cast(Campaign, SimpleNamespace(system=whole.campaign.system, timing=timing, space=range(number))))
        for number, timing in [
            (1040, whole.campaign.timing), (10**8, whole.campaign.timing), (10**9, whole.campaign.timing),
            (10**9, longer), (10**9, SimpleNamespace(frames=10**9, steps=1)),
        ]
    ]  # fmt: skip
    assert found == [2**16, 2**21, 2**22, 2**22, 2**16]
    assert cuts(100, 40) == [(0, 40), (40, 80), (80, 100)] and cuts(80, 40) == [(0, 40), (40, 80)]


def test_parts_divide_the_shards(make: Make) -> None:
    assert Part.parse("2/8") == Part(2, 8)
    for number in (1, 2, 3):
        stored = make(part=Part(number, 3))
    assert stored.complete


def test_a_campaign_that_changed_starts_anew_and_says_so(tmp_path: Path, said: list[str]) -> None:
    first = timer.whole(timer.write(tmp_path / "one"), tmp_path / "store")
    other = timer.write(tmp_path / "two")
    (other / "proofs" / "timer.py").write_text(timer.CAMPAIGN.replace("LIMIT, PAUSE = 8", "LIMIT, PAUSE = 9"))
    campaign = Declared(str(other), "timer")()
    stored = Store(tmp_path / "store", said.append).open(campaign, campaign_key(campaign))
    assert stored.made == 0 and len(timer.files(first.folder)) == SHARDS
    assert said == [
        f"timer is not what it was: it starts anew in {stored.folder.name}/; what was found before is left in "
        f"{first.folder.name}/"
    ]


def test_a_worker_that_finds_another_campaign_is_refused(root: Path, tmp_path: Path) -> None:
    other = timer.write(tmp_path / "other")
    (other / "models" / "timer.py").write_text(timer.MODEL.replace("total >= 8", "total >= 9"))
    campaign = Declared(str(root), "timer")()
    campaign_key(campaign)
    with open_executor("serial") as executor, pytest.raises(StoreError, match="give all machines the same files"):
        run_sharded(campaign, Declared(str(other), "timer"), Store(tmp_path / "store"), executor, size=timer.SIZE)


def test_a_worker_without_the_campaign_says_where_it_looked(root: Path, tmp_path: Path) -> None:
    with pytest.raises(ProjectError, match=r"declares no campaign nothing: .*RIGHTSIDE_PROJECT"):
        Declared(str(root), "nothing")()
    with pytest.raises(ProjectError, match="no such folder"):
        Declared(str(tmp_path / "absent"), "timer")()

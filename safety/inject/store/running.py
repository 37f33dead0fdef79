"""A campaign run shard by shard: what is missing is given out, what comes back is stored, whoever is killed meanwhile.

A worker is given its next shard when the last one is stored, so a driver that is killed loses at most one shard a
worker.  Cuts depend on the campaign alone, and a shard on its injections alone: the files are the same to the last byte
for any number of workers, machines and interruptions.
"""

from __future__ import annotations

import itertools
import os
import socket
import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from safety.inject.store.keys import campaign_key
from safety.inject.store.pool import GoneError, WorkerDiedError
from safety.inject.store.shards import StoreError, encode
from safety.inject.store.store import Store, Stored, shards

if TYPE_CHECKING:
    from safety.inject.campaign import Campaign, Progress

Find = Callable[[], "Campaign"]

LEAST, MOST = 1 << 16, 1 << 22  # injections of a shard
RATE = 8 * 10**12  # operations a second, those that are pruned counted: what a second is reckoned with, everywhere
PIECES = 32  # at least so many shards, as long as they are no smaller than the least: so that many can work
POLL_S = 0.5
FEW = 5  # gaps that are named
_ONE_AT_A_TIME = threading.Lock()  # a campaign's engine has one set of lanes; a worker of Dask may have many threads


@dataclass(frozen=True)
class Part:
    """Every `of`-th shard, from the `number`-th on: what one of several machines takes."""

    number: int = 1
    of: int = 1

    def __post_init__(self) -> None:
        if not 1 <= self.number <= self.of:
            raise StoreError(f"shard {self.number}/{self.of}: write i/n with i from 1 to n, e.g. 2/8")

    @classmethod
    def parse(cls, text: str) -> Part:
        """`2/8`.  Raises `StoreError` for anything else."""
        number, _, of = text.partition("/")
        if not (number.isdecimal() and of.isdecimal()):
            raise StoreError(f"shard {text!r}: write i/n with i from 1 to n, e.g. 2/8")
        return cls(int(number), int(of))


@dataclass(frozen=True)
class Made:
    """A shard's file, who made it and in how many seconds."""

    data: bytes
    seconds: float
    worker: str


@dataclass(frozen=True)
class Job:
    """The injections `lo` to `hi` of the campaign that `find` finds and that has this key; can be pickled."""

    find: Find
    key: str
    lo: int
    hi: int

    def __call__(self) -> Made:
        """Inject.  Raises `StoreError` when the campaign found here is not the one that was meant."""
        began = time.perf_counter()
        worker = f"{socket.gethostname()}:{os.getpid()}"
        with _ONE_AT_A_TIME:
            campaign = self.find()
            if campaign_key(campaign) != self.key:
                raise StoreError(
                    f"{campaign.id} as worker {worker} finds it is not the driver's: give all machines the same files "
                    "and Python, and start the workers again"
                )
            judged = campaign.judged(self.lo, self.hi)
        _, data = encode(campaign.id, self.key, self.lo, len(campaign.space), judged)
        return Made(data, time.perf_counter() - began, worker)


def shard_size(campaign: Campaign) -> int:
    """Injections of a shard, about a second of work: a power of 2 that follows from the campaign alone."""
    from safety.terms.graph import postorder

    operations = len(list(postorder(campaign.system.roots())))
    steps = campaign.timing.frames * campaign.timing.steps
    wanted = min(RATE // (operations * steps), len(campaign.space) // PIECES)
    return min(max(1 << wanted.bit_length() >> 1, LEAST), MOST)


def cuts(total: int, size: int) -> list[tuple[int, int]]:
    """The ranges that injections divide into."""
    return [(lo, min(lo + size, total)) for lo in range(0, total, size)]


def run_sharded(
    campaign: Campaign,
    find: Find,
    store: Store,
    executor: Executor,
    *,
    part: Part = Part(),
    resume: bool = True,
    progress: Progress | None = None,
    size: int | None = None,
) -> Stored:
    """Make the shards that are missing (without `resume`: all of them again, to be compared), and store them.

    `find` gives the campaign in a worker, so it has to be picklable; `progress(share, seconds)` is called as shards
    come in.  Ctrl-C ends the run with what is stored.  A shard that ends its workers is left out and told of in
    `problems`.  Raises `StoreError` when the store cannot be used or the cluster is gone, and whatever the campaign
    itself raises; what is stored remains.
    """
    stored = store.open(campaign, campaign_key(campaign))
    mine = cuts(stored.total, size or shard_size(campaign))[part.number - 1 :: part.of]
    todo = [piece for piece in mine if not (resume and piece in stored.shards)]
    began, of = time.monotonic(), _count(mine)
    waiting, left = iter(todo), _count(todo)
    at_work: dict[Future[Made], tuple[int, int]] = {}
    try:
        while True:
            for lo, hi in itertools.islice(waiting, max(_workers(executor) - len(at_work), 0)):
                at_work[executor.submit(Job(find, stored.key, lo, hi))] = lo, hi
            if not at_work:
                break
            came = {future: at_work.pop(future) for future in wait(at_work, POLL_S, FIRST_COMPLETED).done}
            _take(came, stored)
            left -= _count(came.values())
            if progress is not None and came:
                progress(1 - left / of, time.monotonic() - began)
    except GoneError as error:
        raise StoreError(
            f"{campaign.id}: {error}; {stored.made} of {stored.total} injections are kept: see to the cluster, then "
            "run with --resume"
        ) from None
    except KeyboardInterrupt:
        stored.interrupted = True
        executor.shutdown(wait=False, cancel_futures=True)
    finally:
        for future in at_work:
            future.cancel()
    return stored


def _take(came: Mapping[Future[Made], tuple[int, int]], stored: Stored) -> None:
    """Store what came in; only then raise what went wrong."""
    wrong: list[BaseException] = []
    for future, (lo, hi) in came.items():
        error = future.exception()
        if error is None:
            made = future.result()
            stored.add(made.data, made.seconds, made.worker)
        elif isinstance(error, WorkerDiedError):
            stored.problems += (f"{stored.campaign.id}: injections {lo} to {hi - 1} are given up: {error}",)
        else:
            wrong.append(error)
    if wrong:
        raise wrong[0]


def _workers(executor: Executor) -> int:
    """How many calls an executor makes at a time."""
    return getattr(executor, "workers", None) or getattr(executor, "_max_workers", None) or os.cpu_count() or 1


def _count(pieces: Iterable[tuple[int, int]]) -> int:
    return sum(hi - lo for lo, hi in pieces)


def merge(campaign: Campaign, folders: Sequence[Path], store: Store) -> Stored:
    """Take the shards of a campaign from other stores, or folders of shards, into a store.

    What is missing then is told, and said by `missing`; so is a folder without any, where another has some: of a small
    campaign not every machine makes one.  Raises `StoreError` for a folder that does not exist, where none holds a
    shard of this campaign, and for ranges that overlap or disagree.
    """
    some = False
    stored = store.open(campaign, campaign_key(campaign))
    for folder in folders:
        if not folder.is_dir():
            raise StoreError(f"{folder}: no such folder; give a store, or a folder of shards")
        inner = folder / store.folder(stored.key).name
        place = inner if inner.is_dir() else folder
        found = shards(place, store.note, remove=False)
        some = some or bool(found)
        if not found:
            store.note(f"{folder} holds no shard of {campaign.id} as it stands (key {stored.key[:12]})")
        for header in found.values():
            stored.add((place / header.name).read_bytes())
    if folders and not some:
        raise StoreError(
            f"no shard of {campaign.id} is there to merge: give the stores of parts that were made from the same files "
            "and Python, choose other campaigns with -k, or leave --merge out to make them here"
        )
    if gaps := stored.missing:
        few = ", ".join(f"{gap.start} to {gap.stop - 1}" for gap in gaps[:FEW]) + (", ..." if len(gaps) > FEW else "")
        store.note(f"{campaign.id}: {stored.total - stored.made} of {stored.total} injections are missing: {few}")
    return stored

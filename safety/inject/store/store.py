"""A store: a folder of campaigns as they stood, each with its shards, and the ledger over all of them.

    <store>/ledger.sqlite
    <store>/<first 12 digits of the key>/000000000000-000000065536.shard ...

A shard is written under another name, brought to the disk and then renamed, so at any moment there is the whole of it
or nothing, whoever is killed; several processes may write into one store.  What a folder holds is what its files say:
each is read and checked when the folder is opened, a damaged one is removed and made again.
"""

from __future__ import annotations

import contextlib
import os
import socket
import sqlite3
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from safety.canonical import digest
from safety.inject.store.ledger import Ledger
from safety.inject.store.shards import UNDETECTED, DamagedError, Header, StoreError, decode, head

if TYPE_CHECKING:
    from safety.inject.campaign import Campaign
    from safety.inject.judging import Judged
    from safety.inject.result import Result

FOLDER = ".rightside/campaigns"  # of a project's own store
SUFFIX, NEW = ".shard", ".new-"
LISTED = 256  # dangerous undetected of a shard in the ledger; of more, the shard itself tells
ELSEWHERE = "make room or give another --store, then run with --resume"
LEFT_OVER_S = 3600.0  # a file that is still being written after this time belongs to a process that is gone

Note = Callable[[str], None]
Found = TypeVar("Found")


class Store:
    """A folder of campaigns; `note` is told of what was damaged, left over or left behind."""

    def __init__(self, root: Path, note: Note = lambda text: None) -> None:
        self.root, self.note = root, note
        self._ledger = Ledger(root)

    def folder(self, key: str) -> Path:
        """Where the shards of a campaign's key lie."""
        return self.root / key[:12]

    def open(self, campaign: Campaign, key: str) -> Stored:
        """What is there of a campaign.  Raises `StoreError` for a folder that cannot be written or read."""
        with told(self.root, ELSEWHERE):
            self.folder(key).mkdir(parents=True, exist_ok=True)
            found = Stored(self, campaign, key)
            known = self.asked(Ledger.campaigns)
        for old, (name, _) in known.items():
            if name == campaign.id and old != key and not found.shards:
                self.note(
                    f"{campaign.id} is not what it was: it starts anew in {self.folder(key).name}/; what was found "
                    f"before is left in {self.folder(old).name}/"
                )
        return found

    def asked(self, what: Callable[[Ledger], Found]) -> Found:
        """Ask the ledger, or enter something; a damaged one is made anew from the shards first."""
        try:
            return what(self._ledger)
        except sqlite3.OperationalError as error:  # full, locked, read-only: nothing is wrong with what is there
            raise StoreError(
                f"{self.root}: the ledger cannot be used: {error}; the shards are kept; {ELSEWHERE}"
            ) from None
        except sqlite3.DatabaseError as error:
            self.note(f"the ledger is damaged ({error}); it is made anew from the shards")
            self.rebuild()
            return what(self._ledger)

    def rebuild(self) -> None:
        """Make the ledger anew from the shards; the old file is set aside."""
        with told(self.root, ELSEWHERE):
            if self._ledger.path.exists():
                self._ledger.begin_anew()
            for folder in sorted(path for path in self.root.iterdir() if path.is_dir()):
                for header in shards(folder, self.note).values():
                    self._ledger.enter(header, [])  # the ids follow when the campaign is opened


def shards(folder: Path, note: Note, *, remove: bool = True) -> dict[tuple[int, int], Header]:
    """The shards of a folder by range, in order, without damaged ones; these are removed, if so wished.

    Raises `StoreError` when ranges overlap or keys differ.
    """
    found: dict[tuple[int, int], Header] = {}
    for path in sorted(folder.glob(f"*{SUFFIX}")):
        try:
            header = head(path.read_bytes())
        except DamagedError as error:
            note(f"{path} is damaged: {error}; it has to be made again")
            if remove:
                path.unlink(missing_ok=True)
            continue
        last = next(reversed(found.values()), header)
        if header.key != last.key or header.of != last.of:
            raise StoreError(f"{path} belongs to another campaign ({header.campaign}) than {last.name}; move it away")
        if last is not header and header.lo < last.hi:
            raise StoreError(f"{path} overlaps {last.name}: they were cut with different sizes; move one away")
        found[header.lo, header.hi] = header
    return found


class Stored:
    """What a store holds of a campaign as it stands: its shards, and what is missing.

    `problems` are shards that were given up; `interrupted`: Ctrl-C ended the run that this came from.
    """

    def __init__(self, store: Store, campaign: Campaign, key: str) -> None:
        self.store, self.campaign, self.key = store, campaign, key
        self.folder, self.total = store.folder(key), len(campaign.space)
        self.problems: tuple[str, ...] = ()
        self.interrupted = False
        _remove_left_overs(self.folder)
        self.shards = shards(self.folder, store.note)
        for header in self.shards.values():
            if header.key != key or header.of != self.total:
                raise StoreError(f"{self.folder / header.name} belongs to another campaign; move it away")
        self._enter_what_is_there()

    def _enter_what_is_there(self) -> None:
        entered = self.store.asked(lambda ledger: ledger.entered(self.key))
        for place, header in self.shards.items():
            listed = header.undetected if header.undetected <= LISTED else 0
            if entered.get(place) != (header.digest, listed):
                self._enter(header, self._undetected(header))

    def _enter(self, header: Header, *told: Any) -> None:
        self.store.asked(lambda ledger: ledger.enter(header, *told))

    def _undetected(self, header: Header) -> list[tuple[int, str]]:
        """Number and id of the dangerous undetected injections of a shard; none when there are too many to list."""
        if not 0 < header.undetected <= LISTED:
            return []
        numbers = self._numbers(header)
        return [(number, self.campaign.space.injection(number).id) for number in numbers]

    def _numbers(self, header: Header) -> list[int]:
        found = self._read(header).cells == UNDETECTED
        return [header.lo + int(place) for place in found.nonzero()[0]]

    # --- what is there ---------------------------------------------------------------------------------------------

    @property
    def made(self) -> int:
        """How many injections are there."""
        return sum(hi - lo for lo, hi in self.shards)

    @property
    def missing(self) -> list[range]:
        """The ranges that are not there."""
        found, end = [], 0
        for lo, hi in [*sorted(self.shards), (self.total, self.total)]:
            if end < lo:
                found.append(range(end, lo))
            end = hi
        return found

    @property
    def complete(self) -> bool:
        """Whether every injection is there."""
        return not self.missing

    @property
    def histogram(self) -> Mapping[tuple[int, int], int]:
        """How many injections came to each cell and detector."""
        counts: dict[tuple[int, int], int] = {}
        for header in self.shards.values():
            for kind, number in header.histogram.items():
                counts[kind] = counts.get(kind, 0) + number
        return counts

    @property
    def digest(self) -> str:
        """A digest of all answers: equal for any number of workers, machines and interruptions."""
        told = [f"{lo}-{hi} {header.digest}" for (lo, hi), header in sorted(self.shards.items())]
        return digest([self.key, *told])

    def parts(self) -> Iterator[tuple[int, Judged]]:
        """The answers shard by shard, in order, each with the number of its first injection."""
        for (lo, _), header in sorted(self.shards.items()):
            yield lo, self._read(header)

    def result(self, seconds: float = 0.0) -> Result:
        """The result of the campaign; with shards missing, it says that it was interrupted."""
        from safety.inject.judging import UNMADE, Judged
        from safety.inject.result import Result

        whole = Judged.alike(self.total, UNMADE)
        for lo, judged in self.parts():
            whole.put(slice(lo, lo + len(judged)), judged)
        return Result.of(self.campaign, whole, seconds=seconds, interrupted=not self.complete)

    def undetected(self) -> list[int]:
        """The numbers of the dangerous undetected injections, in order."""
        listed = {number for number, _ in self.store.asked(lambda ledger: ledger.undetected(self.key))}
        unlisted = (header for header in self.shards.values() if header.undetected > LISTED)
        return sorted(listed.union(*map(self._numbers, unlisted)))

    def kept(self, kind: str) -> list[tuple[str, Any]]:
        """What was concluded from the campaign, oldest first: when, and the document; see `keep`."""
        return self.store.asked(lambda ledger: ledger.kept(self.key, kind))

    def keep(self, kind: str, document: Any) -> None:
        """Keep plain data in the ledger unless it is what was kept last; `kind`: a word such as "fmeda", "baseline"."""
        if [told for _, told in self.kept(kind)][-1:] != [document]:
            self.store.asked(lambda ledger: ledger.keep(self.key, kind, document))

    def _read(self, header: Header) -> Judged:
        path = self.folder / header.name
        try:
            found, judged = decode(path.read_bytes())
        except (OSError, DamagedError) as error:
            raise StoreError(f"{path}: {error}; run again with --resume, which makes it again") from None
        if found != header:
            raise StoreError(f"{path} was replaced while it was in use; run again")
        return judged

    # --- what is added ---------------------------------------------------------------------------------------------

    def add(self, data: bytes, seconds: float | None = None, worker: str | None = None) -> None:
        """Add a shard; one that is there already has to hold the same answers, and stays.

        Raises `StoreError` when it does not, or when the shard cannot be written.
        """
        header = head(data)
        if header.key != self.key:
            raise StoreError(f"{header.name} is of another campaign ({header.campaign}, key {header.key[:12]})")
        for lo, hi in self.shards:
            if lo < header.hi and header.lo < hi and (lo, hi) != (header.lo, header.hi):
                raise StoreError(f"{header.name} overlaps the injections {lo} to {hi - 1}, cut with another size")
        path = self.folder / header.name
        there = self.shards.get((header.lo, header.hi))
        with told(self.folder, f"{self.made} of {self.total} injections are kept; {ELSEWHERE}"):
            if there is None and path.exists():  # another process has made it meanwhile
                there = head(path.read_bytes())
            if there is None:
                _write(path, data)
        if there is not None and there.digest != header.digest:
            raise StoreError(
                f"{self.campaign.id}: injections {header.lo} to {header.hi - 1} came to something else than before; "
                "a campaign has to give the same answers each time: look for randomness or time in its functions"
            )
        header = there or header  # alike, but perhaps named after another campaign that is the same
        self.shards[header.lo, header.hi] = header
        self._enter(header, self._undetected(header), seconds, worker)


def _write(path: Path, data: bytes) -> None:
    new = path.with_name(f"{NEW}{socket.gethostname()}-{os.getpid()}")
    try:
        with new.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        new.replace(path)
    except BaseException:
        new.unlink(missing_ok=True)
        raise
    with contextlib.suppress(OSError):  # where a folder cannot be opened (Windows), the file system sees to it
        handle = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _remove_left_overs(folder: Path) -> None:
    for path in folder.glob(f"{NEW}*"):
        with contextlib.suppress(FileNotFoundError):
            if time.time() - path.stat().st_mtime > LEFT_OVER_S:
                path.unlink()


@contextlib.contextmanager
def told(place: Path, what_to_do: str) -> Iterator[None]:
    """An error of the operating system as one that says what to do."""
    try:
        yield
    except OSError as error:
        raise StoreError(f"{place}: {error.strerror or error}; {what_to_do}") from None

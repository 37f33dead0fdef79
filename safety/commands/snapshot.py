"""Results of a project as it stands: while none of the files that they were made from changes, nothing is traced.

The key is a digest of all files in models/ and proofs/, of pyproject.toml, of this package's own text and of the
versions beneath it.  Whatever other files the workers read, installed packages among them, stands beside the results
with time and size; when one of them differs, the results do not count.
"""

from __future__ import annotations

import dataclasses
import importlib.util
import os
import sys
import sysconfig
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from safety.canonical import PACKAGE, digest, files, text_of
from safety.commands.recall import usable
from safety.commands.selection import Item
from safety.commands.versions import versions
from safety.prove.cache import ENGINES, Cache
from safety.report.schema import Entry
from safety.report.standing import DISAGREE, INTERNAL, UNDECIDED, standing

PATTERNS = ("models/**/*", "proofs/**/*", "pyproject.toml")
Read = list[tuple[str, Any]]  # files with time and size


class Snapshot:
    """The entries kept for a project, and the items that it declares (None: not known)."""

    def __init__(self, root: Path, cache: Cache) -> None:
        self.root, self.cache = root, cache
        self.stamp = self._stamp()
        own, package = (files(root, PATTERNS), files(PACKAGE, ["**/*.py"]))
        self.files = {str(path) for path in own}
        used = [f"{name} {text}" for name, text in versions().items()]
        self.key = digest([text_of(root, own), text_of(PACKAGE, package), *used])
        record: dict[str, Any] = cache.get(self.key) or {}
        if any(_told(path) != told for path, told in record.get("reads", {}).items()):
            record = {}
        self.items = [Item(**one) for one in record["items"]] if record else None
        self.entries: dict[str, Any] = record.get("entries", {})
        self.reads: dict[str, Any] = record.get("reads", {})

    def entry(self, item: Item, timeout: float) -> Entry | None:
        """The entry of an item, marked as an earlier one; None when there is none that will do."""
        record = self.entries.get(_name(item), {})
        return {**record["entry"], "cached": True} if usable(record, timeout) else None

    def keep(self, items: Sequence[Item], entries: Iterable[tuple[Item, Entry]], timeout: float, reads: Read) -> None:
        """Keep what a run found, unless a file changed while it ran."""
        for item, entry in entries:
            if not _lasting(item, entry):
                self.entries.pop(_name(item), None)
            elif not entry.get("cached") or _name(item) not in self.entries:
                plain = {name: value for name, value in entry.items() if name not in ("cached", "rechecked")}
                self.entries[_name(item)] = {"entry": plain, "timeout": timeout, "settled": _settled(item, entry)}
        others = {path: told for path, told in reads if path not in self.files}
        as_read = all(_told(path) == told for path, told in reads if path in others)
        if as_read and self._stamp() == self.stamp:
            told = [dataclasses.asdict(item) for item in items]
            self.cache.put(self.key, {"items": told, "entries": self.entries, "reads": {**self.reads, **others}})

    def _stamp(self) -> dict[str, Any]:
        return {str(path): _told(path) for path in [*files(self.root, PATTERNS), *files(PACKAGE, ["**/*.py"])]}


def _name(item: Item) -> str:
    return f"{item.section} {item.id}"


def _settled(item: Item, entry: Entry) -> bool:
    """Whether more time could not find out more."""
    if item.section == "claims":
        return bool(entry.get("counterexample")) or (_confirmed(entry) and entry["verdict"] in ("proved", "vacuous"))
    return item.section != "trees" or bool(entry.get("complete_at_all_orders"))


def _lasting(item: Item, entry: Entry) -> bool:
    """Whether an entry may be shown again: a result, confirmed by all solvers where it rests on solvers."""
    if standing(item.section, entry).code in (INTERNAL, DISAGREE, UNDECIDED):
        return False
    if item.section == "claims":
        return _settled(item, entry) or entry["verdict"] in ("bounded", "undecided")
    return item.section != "trees" or (_confirmed(entry) and not entry.get("why"))


def _confirmed(entry: Entry) -> bool:
    return len(entry.get("agreed_by") or ()) >= len(ENGINES)


def _told(path: str | Path) -> list[int] | None:
    """When a file was changed last, and its size; None where there is none."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return [found.st_mtime_ns, found.st_size]


class Reads:
    """The files that this process reads, apart from those of Python itself, of this package, and what it has made."""

    def __init__(self, project: Path) -> None:
        from safety.terms import llvm

        paths = sysconfig.get_paths()
        passed = [
            paths["stdlib"],
            paths["platstdlib"],
            str(PACKAGE),
            str(project / ".rightside"),
            os.path.abspath(llvm.home()),  # goes by what it was compiled from
            "/proc",
            "/sys",
            "/dev",
        ]
        self.passed = tuple(home.rstrip(os.sep) + os.sep for home in passed)
        self.installed = (paths["purelib"], paths["platlib"])  # these lie in the first two
        self.seen: set[str] = set()
        self.new: list[tuple[str, Any]] = []
        sys.addaudithook(self._hear)

    def taken(self) -> Read:
        """Those since the last call, each with its time and size when it was read."""
        new, self.new = self.new, []
        return new

    def _hear(self, event: str, told: tuple[Any, ...]) -> None:
        if event != "open" or not isinstance(told[0], str | bytes) or told[2] & os.O_ACCMODE == os.O_WRONLY:
            return
        path = os.path.abspath(os.fsdecode(told[0]))
        if path.endswith(".pyc"):
            try:
                path = importlib.util.source_from_cache(path)
            except ValueError:
                return
        if path not in self.seen and (not path.startswith(self.passed) or path.startswith(self.installed)):
            self.seen.add(path)
            self.new.append((path, _told(path)))

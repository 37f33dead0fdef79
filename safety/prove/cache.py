"""Results kept between runs: a small file for each key, checked whenever it is read, the longest unused removed first.

A record is plain data, never code.  It is found under a key that stands for everything it rests on, and is read back
only when its checksum, made over key and content, is right: a damaged, cut or renamed file counts as absent.
"""

from __future__ import annotations

import contextlib
import json
import os
import tempfile
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any

from safety.canonical import PACKAGE, READINGS, digest, files, text_of

LARGEST = 64 << 20  # bytes in all
ENGINES = ("z3-solver", "cvc5")  # distributions that verdicts rest on
PROVER = (*READINGS, "prove/**/*.py")  # what a verdict is made by, below the package

Warn = Callable[[str], None]


class Cache:
    """Records by key in a folder; `warn` is told of a record that cannot be used, and once if none can be written."""

    def __init__(self, folder: Path, warn: Warn, largest: int = LARGEST) -> None:
        self.folder, self.warn, self.largest = folder, warn, largest
        self.writable = True

    def get(self, key: str) -> Any:
        """The record of a key; None when there is none that is whole."""
        path = self._path(key)
        try:
            data = path.read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            self.warn(f"cache: {path.name} cannot be read ({error.strerror}); its result is worked out anew")
            return None
        seal, _, content = data.partition(b"\n")
        try:
            if seal.decode() != _seal(key, content):
                raise ValueError("its checksum is wrong")
            record = json.loads(content)
        except ValueError as error:
            self.warn(f"cache: {path.name} is damaged ({error}); its result is worked out anew")
            return None
        with contextlib.suppress(OSError):
            os.utime(path)  # used now: it goes last
        return record

    def put(self, key: str, record: Any) -> None:
        """Keep a record of plain data; another process sees the whole of it or nothing."""
        content = json.dumps(record, separators=(",", ":")).encode()
        path = self._path(key)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=".new-")
            try:
                with open(handle, "wb") as file:
                    file.write(_seal(key, content).encode() + b"\n" + content)
                os.replace(temporary, path)
            except BaseException:
                os.unlink(temporary)
                raise
        except OSError as error:
            if self.writable:
                self.warn(f"cache: results cannot be kept in {self.folder}: {error.strerror}")
            self.writable = False

    def drop(self, key: str) -> None:
        """Forget a record."""
        with contextlib.suppress(OSError):
            self._path(key).unlink(missing_ok=True)

    def prune(self) -> None:
        """Remove the records that were not used for longest, until the others fit."""
        found = []
        with contextlib.suppress(OSError):
            for entry in os.scandir(self.folder):
                with contextlib.suppress(FileNotFoundError):  # another process prunes too
                    told = entry.stat()
                    found.append((told.st_mtime_ns, told.st_size, entry.path))
        left = sum(size for _, size, _ in found)
        for _, size, path in sorted(found):
            if left <= self.largest:
                return
            with contextlib.suppress(OSError):
                os.unlink(path)
            left -= size

    def _path(self, key: str) -> Path:
        return self.folder / f"{key}.json"


def prover() -> str:
    """What gives the verdicts: this package's own text and the solvers' versions."""
    return digest([text_of(PACKAGE, files(PACKAGE, PROVER)), *(f"{name} {_version(name)}" for name in ENGINES)])


def _version(distribution: str) -> str:
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return "absent"


def _seal(key: str, content: bytes) -> str:
    return digest([key, content])

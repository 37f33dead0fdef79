"""The ledger of a store: an index over its shards, in SQLite, for questions that should not read them all.

    campaigns   key, id, total                      a campaign as it stood: another model or fault makes another key
    shards      key, lo, hi, digest, listed, seconds, worker        `listed`: a digest of its rows in `undetected`
    undetected  key, number, id                     the dangerous undetected injections, `number` in enumeration order
    documents   key, kind, made, document           what was concluded at that time: failure-mode tables, baselines

All but the documents follows from the shards: a ledger that is gone or damaged is made again from them, with what
documents can still be read.
"""

from __future__ import annotations

import contextlib
import json
import sqlite3
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from safety.canonical import digest
from safety.inject.store.shards import Header

FILE = "ledger.sqlite"
PATIENCE_S = 30.0  # while another process writes
SCHEMA = """
CREATE TABLE IF NOT EXISTS campaigns (key TEXT PRIMARY KEY, id TEXT NOT NULL, total INTEGER NOT NULL) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS shards (
    key TEXT, lo INTEGER, hi INTEGER, digest TEXT NOT NULL, listed TEXT NOT NULL, seconds REAL, worker TEXT,
    PRIMARY KEY (key, lo)
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS undetected (key TEXT, number INTEGER, id TEXT NOT NULL, PRIMARY KEY (key, number))
WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS documents (key TEXT, kind TEXT, made TEXT, document TEXT NOT NULL);
"""
ROWS = "SELECT number, id FROM undetected WHERE key = ? AND number >= ? AND number < ? ORDER BY number"
MOST = 2**63 - 1

Row = tuple[int, str]


class Ledger:
    """The ledger in a folder.  Each question or entry opens it anew and is one transaction, so it can be shared.

    Every method raises `sqlite3.DatabaseError` when the file is damaged.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / FILE

    @contextlib.contextmanager
    def _open(self, synchronous: str = "OFF") -> Iterator[sqlite3.Connection]:
        """Entries are not waited for: a power cut may cost some, or the file; the shards have them all."""
        with contextlib.closing(sqlite3.connect(self.path, timeout=PATIENCE_S)) as base, base:
            base.execute("PRAGMA journal_mode = WAL")
            base.execute(f"PRAGMA synchronous = {synchronous}")
            base.executescript(SCHEMA)
            yield base

    def enter(
        self,
        header: Header,
        undetected: Sequence[Row],
        seconds: float | None = None,
        worker: str | None = None,
    ) -> None:
        """Enter a shard, its dangerous undetected injections (number, id), and who made it in what time."""
        told = (header.key, header.lo, header.hi, header.digest, _seal(undetected), seconds, worker)
        with self._open() as base:
            base.execute("INSERT OR REPLACE INTO campaigns VALUES (?, ?, ?)", (header.key, header.campaign, header.of))
            base.execute("DELETE FROM undetected WHERE key = ? AND number >= ? AND number < ?", (told[:3]))
            base.executemany("INSERT INTO undetected VALUES (?, ?, ?)", ((header.key, *row) for row in undetected))
            base.execute("INSERT OR REPLACE INTO shards VALUES (?, ?, ?, ?, ?, ?, ?)", told)

    def entered(self, key: str) -> dict[tuple[int, int], tuple[str, int]]:
        """The shards of a campaign by range: digest, and how many dangerous undetected are listed.

        A shard whose rows are not those that were entered is left out.
        """
        found = {}
        with self._open() as base:
            question = "SELECT lo, hi, digest, listed FROM shards WHERE key = ?"
            for lo, hi, sum_, seal in base.execute(question, (key,)).fetchall():
                rows = base.execute(ROWS, (key, lo, hi)).fetchall()
                if _seal(rows) == seal:
                    found[lo, hi] = sum_, len(rows)
        return found

    def undetected(self, key: str) -> list[Row]:
        """The dangerous undetected injections that are listed, by number and id."""
        with self._open() as base:
            return base.execute(ROWS, (key, 0, MOST)).fetchall()

    def campaigns(self) -> dict[str, tuple[str, int]]:
        """The campaigns by key: id, injections in all."""
        with self._open() as base:
            return {key: (name, of) for key, name, of in base.execute("SELECT key, id, total FROM campaigns")}

    def work(self, key: str) -> list[tuple[int, int, float, str]]:
        """Who made which shard in what time: lo, hi, seconds, worker; without those that were merely found."""
        question = "SELECT lo, hi, seconds, worker FROM shards WHERE key = ? AND worker IS NOT NULL ORDER BY lo"
        with self._open() as base:
            return list(base.execute(question, (key,)))

    def keep(self, key: str, kind: str, document: Any) -> None:
        """Keep plain data with a campaign."""
        made = datetime.now(UTC).isoformat(timespec="seconds")
        with self._open("FULL") as base:
            base.execute("INSERT INTO documents VALUES (?, ?, ?, ?)", (key, kind, made, json.dumps(document)))

    def kept(self, key: str, kind: str) -> list[tuple[str, Any]]:
        """What was kept with a campaign, oldest first: when, and the document."""
        question = "SELECT made, document FROM documents WHERE key = ? AND kind = ? ORDER BY rowid"
        with self._open() as base:
            return [(made, json.loads(text)) for made, text in base.execute(question, (key, kind))]

    def begin_anew(self) -> None:
        """Set the file aside and begin an empty one, with those documents that can still be read."""
        documents = []
        with contextlib.suppress(sqlite3.DatabaseError), self._open() as base:
            documents = base.execute("SELECT * FROM documents").fetchall()
        for name in ("-wal", "-shm"):
            Path(f"{self.path}{name}").unlink(missing_ok=True)
        self.path.replace(self.path.with_suffix(".damaged"))
        with self._open() as base:
            base.executemany("INSERT INTO documents VALUES (?, ?, ?, ?)", documents)


def _seal(rows: Sequence[Row]) -> str:
    return digest(f"{number} {name}" for number, name in rows)

"""Campaigns of which the shards are kept in a store: made where the command says, put together in this process."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from safety.commands.declared import Declared
from safety.commands.evaluate import Note
from safety.commands.injecting import Wishes, pace
from safety.inject.store import Part, Store, merge, run_sharded
from safety.inject.store.executors import Serial
from safety.project import Value

if TYPE_CHECKING:
    from safety.inject import Campaign, Result


@dataclass(frozen=True)
class Kept:
    """Where the shards of campaigns are kept, who makes them, and which; `merge` are stores to take some from."""

    store: Path
    executor: Executor
    root: Path
    settings: Mapping[str, Value]
    wishes: Wishes
    resume: bool
    merge: Sequence[str]
    told: Callable[[str], None]

    def take(self, campaign: Campaign) -> None:
        """Take the shards of a campaign from the other stores.  Raises `StoreError` where these have none of it."""
        if self.merge:
            merge(campaign, [Path(folder) for folder in self.merge], Store(self.store, self.told))

    def run(self, campaign: Campaign, note: Note) -> tuple[Result, Sequence[str]]:
        """The result of a campaign out of its shards, and what kept shards from being made."""
        store = Store(self.store, self.told)
        began = time.monotonic()
        stored = run_sharded(
            campaign, self._find(campaign), store, self.executor,
            part=Part.parse(self.wishes.shard or "1/1"), resume=self.resume, progress=pace(campaign, note),
        )  # fmt: skip
        if stored.interrupted:
            self.told(f"{campaign.id}: {stored.made} of {stored.total} injections are kept; --resume goes on")
            raise KeyboardInterrupt
        result = stored.result(time.monotonic() - began)
        if stored.complete:
            stored.keep("fmeda", [row.to_json() for row in result.rows])
        return result, stored.problems

    def _find(self, campaign: Campaign) -> Callable[[], Campaign]:
        """How whoever makes a shard comes by the campaign."""
        if isinstance(self.executor, Serial):
            return lambda: campaign
        changes = tuple(self.wishes.changes.items())
        return Declared(str(self.root), campaign.id, tuple(self.settings.items()), changes)

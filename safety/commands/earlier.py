"""Results of earlier runs as a command uses them: what is taken, what is proved again, what is kept."""

from __future__ import annotations

import math
import sys
from argparse import Namespace
from collections.abc import Iterator, Sequence
from typing import Any

from safety.canonical import digest
from safety.commands import CommandError
from safety.commands.recall import folder, key_of, usable
from safety.commands.selection import Item, items
from safety.commands.snapshot import Read, Snapshot
from safety.project import Project
from safety.prove.cache import Cache
from safety.report.results import Results

SECTIONS = ("claims", "syntheses", "campaigns", "trees", "rates", "figures", "exhibits")


class Earlier:
    """The results of earlier runs of a project; `again`: claims that are proved in any case."""

    def __init__(self, project: Project, args: Namespace) -> None:
        self.args, self.timeout = args, args.timeout or project.config.timeout
        self.cache = Cache(folder(project.root), lambda text: print(text, file=sys.stderr))
        self.snapshot = Snapshot(project.root, self.cache)
        self.all: Sequence[Item] | None = self.snapshot.items
        self.again: list[str] = []
        self.reads: Read = []

    @property
    def known(self) -> bool:
        """Whether the project is as it was in an earlier run, so that it need not be loaded to be listed."""
        return self.snapshot.items is not None

    def items(self, project: Project, sections: Sequence[str]) -> list[Item]:
        """What the project declares in these sections."""
        if self.all is None:
            self.all = items(project, SECTIONS)
        return [item for section in sections for item in self.all if item.section == section]

    def entry(self, item: Item) -> dict[str, Any] | None:
        """The entry of an item, unless it has to be worked out (also for its files, or in order up to the first)."""
        if self.args.first or item.id in self.again:
            return None
        found = self.snapshot.entry(item, self.timeout)
        waveform = getattr(self.args, "vcd", None) and found and found.get("counterexample")
        if not found or waveform:
            return None
        made = found.get("certificate") or {}
        if getattr(self.args, "certify", None):
            return None if found.get("verdict") == "proved" else found
        if "file" not in made:
            return found
        routes = {key: made[key] for key in ("kind", "routes")} if "routes" in made else None
        return found | {"certificate": routes}

    def chosen(self, project: Project, chosen: list[Item]) -> list[Item]:
        """What --changed leaves; --recheck draws its share of the claims that have a result."""
        share, seed = self.args.recheck
        if not (self.args.changed or share):
            return chosen
        have = [item for item in chosen if self._has(project, item)]
        if self.args.changed:
            return [item for item in chosen if item not in have]
        claims = [item.id for item in have if item.section == "claims" and not item.is_bound]
        drawn = sorted(claims, key=lambda id_: digest([seed, id_]))
        self.again = drawn[: math.ceil(share * len(claims))]
        return chosen

    def keep(self, results: Results) -> None:
        """Keep the entries of this run."""
        by_name = {(item.section, item.id): item for item in self.all or ()}
        found = [(by_name[name, entry["id"]], entry) for name in SECTIONS for entry in results.get(name, ())]
        if any(not entry.get("cached") for _, entry in found) or not self.known:
            self.snapshot.keep(self.all or (), found, self.timeout, self.reads)
            self.cache.prune()

    def _has(self, project: Project, item: Item) -> bool:
        if self.snapshot.entry(item, self.timeout):
            return True
        if item.section != "claims" or item.is_bound:
            return False
        from safety.commands.evaluate import find, fitting_claim
        from safety.prove.prove import Limits, stated

        if self.known:
            project.load_proofs()
        try:
            claim = find(project.claims, item.id)
            key = key_of(stated(claim, fitting_claim(claim, project.config.settings)), Limits(self.timeout))
        except Exception:  # its worker says what is wrong with it
            return False
        return bool(key) and usable(self.cache.get(str(key)), self.timeout)


def of(project: Project, args: Namespace) -> Earlier | None:
    """The earlier results that a command may use.  Raises CommandError for options that contradict one another."""
    if not hasattr(args, "cache"):
        return None
    if args.cache and not args.settings:
        return Earlier(project, args)
    if args.changed or args.recheck[0]:
        raise CommandError(
            "--changed and --recheck go by results of earlier runs; leave out --no-cache, and --set, whose are not kept"
        )
    return None


def told(results: Results) -> Iterator[str]:
    """What the screen says of them."""
    entries = [entry for section in SECTIONS for entry in results.get(section, ())]
    cached = sum(bool(entry.get("cached")) for entry in entries)
    if cached:
        yield f"{cached} of {len(entries)} results are of an earlier run (cached); --no-cache works them out anew"
    again = sum(bool(entry.get("rechecked")) for entry in entries)
    if again:
        yield f"{again} cached result{'s' * (again > 1)} proved again, with the same outcome"

"""A campaign as a worker finds it, on this machine or another: by the root of its project, its id, the settings."""

from __future__ import annotations

import functools
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from safety.commands.evaluate import find, fitting
from safety.project import ProjectError, Value, open_project

if TYPE_CHECKING:
    from safety.inject import Campaign

ROOT = "RIGHTSIDE_PROJECT"  # environment variable: where the project lies on a machine where it lies elsewhere


@dataclass(frozen=True)
class Declared:
    """Where a campaign is declared; called, it is that campaign, with some fields changed.  Can be pickled."""

    root: str
    campaign: str
    settings: tuple[tuple[str, Value], ...] = ()
    changes: tuple[tuple[str, Any], ...] = ()

    def __call__(self) -> Campaign:
        """The campaign, loaded once in a process.  Raises `ProjectError` when it is not there."""
        return _load(self, os.environ.get(ROOT, self.root))


@functools.lru_cache(maxsize=8)
def _load(declared: Declared, root: str) -> Campaign:
    from safety.inject.campaign import changed

    project = open_project(Path(root))
    project.load_proofs()
    if declared.campaign not in (campaign.id for campaign in project.campaigns):
        why = "; ".join(map(str, project.problems)) or f"give all machines the same files, or set {ROOT} on this one"
        raise ProjectError(f"{root} declares no campaign {declared.campaign}: {why}")
    campaign = find(project.campaigns, declared.campaign)
    wanted = fitting(campaign.model, dict(declared.settings)) if isinstance(campaign.model, type) else {}
    return changed(campaign, settings={**campaign.settings, **wanted}, **dict(declared.changes))

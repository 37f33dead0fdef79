"""Tests kept apart: what one declares or imports from a project on disk is gone when it has ended."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

import safety.audit.entry
import safety.commands.declared
import safety.exhibits
import safety.inject.campaign
import safety.prove.bounds.claims
import safety.prove.claims
import safety.prove.hazards
import safety.prove.weakest
import safety.prove.written_for
import safety.rates.claims

REGISTRIES: tuple[tuple[ModuleType, str], ...] = (
    (safety.prove.claims, "_registry"),
    (safety.prove.bounds.claims, "_registry"),
    (safety.prove.hazards, "_registry"),
    (safety.prove.hazards, "_formulas"),
    (safety.prove.weakest, "_registry"),
    (safety.prove.written_for, "_registry"),
    (safety.inject.campaign, "_registry"),
    (safety.rates.claims, "_declared"),
    (safety.rates.claims, "_places"),
    (safety.exhibits, "_declared"),
    (safety.audit.entry, "_declared"),
)


def imported() -> dict[str, ModuleType]:
    """The modules of a project."""
    return {name: module for name, module in sys.modules.items() if name.partition(".")[0] in ("models", "proofs")}


def forget() -> None:
    """As in a process that has loaded no project."""
    for name in imported():
        del sys.modules[name]
    for home, name in REGISTRIES:
        getattr(home, name).clear()
    safety.commands.declared._load.cache_clear()


@contextmanager
def kept() -> Iterator[None]:
    """Models, proofs and what they declare are afterwards as they were."""
    modules, path = imported(), list(sys.path)
    declared: list[dict[str, Any]] = [dict(getattr(home, name)) for home, name in REGISTRIES]
    yield
    forget()
    sys.modules.update(modules)
    sys.path[:] = path
    for (home, name), before in zip(REGISTRIES, declared, strict=True):
        getattr(home, name).update(before)

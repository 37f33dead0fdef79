"""What a campaign found: counts, coverage with bounds, failure modes, and whether it is as declared."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

from safety.inject.classes import Tally, class_of
from safety.inject.fmeda import Row, rated
from safety.inject.space import CampaignError, Injection
from safety.inject.statistics import Share, share, weighted

if TYPE_CHECKING:
    from safety.inject.campaign import Campaign


@dataclass(eq=False)
class Result:
    """Outcome of a campaign: `cells` by position of the injection, `effective` those that change the equipment at all.

    A fault changes nothing by construction when it acts on a constant and keeps its value.  An interrupted campaign has
    counts but no fractions: what was done first is no random sample.
    """

    campaign: Campaign
    cells: Mapping[int, str]
    effective: Set[int]
    seconds: float
    interrupted: bool = False

    @property
    def exhaustive(self) -> bool:
        """Whether every injection of the space was made."""
        return self.campaign.space.exhaustive and len(self.cells) == self.campaign.space.population

    @cached_property
    def tally(self) -> Tally:
        """Counts over all injections made."""
        return Tally.of(list(self.cells.values()))

    @cached_property
    def groups(self) -> dict[str, Tally]:
        """Counts by group; a pair of groups counts as `one & other`."""
        found: dict[str, list[str]] = {}
        for position, cell in self.cells.items():
            found.setdefault(self.campaign.space.injections[position].group, []).append(cell)
        return {name: Tally.of(cells) for name, cells in found.items()}

    @cached_property
    def rows(self) -> list[Row]:
        """The failure-mode table, a row a group; empty for a campaign of pairs."""
        space = self.campaign.space
        if self.campaign.order > 1:
            return []
        return [Row(g, space.sizes[g.name], self.groups.get(g.name, Tally.of([]))) for g in space.groups]

    def injections(self, *classes: str) -> Iterator[tuple[Injection, str]]:
        """The injections made with their cell, all or those of some classes."""
        for position, cell in self.cells.items():
            if not classes or class_of(cell) in classes:
                yield self.campaign.space.injections[position], cell

    # --- fractions -------------------------------------------------------------------------------------------------

    @property
    def diagnostic_coverage(self) -> Share | None:
        """Dangerous detected / dangerous, every fault counting alike (IEC 61508-4, 3.8.6)."""
        good = self.tally.dangerous_detected
        return self._share(good, good + self.tally.dangerous_undetected)

    @property
    def safe_failure_fraction(self) -> Share | None:
        """(safe + dangerous detected) / (safe + dangerous), every fault counting alike (IEC 61508-4, 3.6.15)."""
        good = self.tally.safe + self.tally.dangerous_detected
        return self._share(good, good + self.tally.dangerous_undetected)

    @property
    def detected_of_all(self) -> Share | None:
        """Detected / all injections, whatever their direction."""
        return self._share(self.tally.classes["detected"], self.tally.injections)

    @property
    def detected_of_effective(self) -> Share | None:
        """Detected / injections that change the equipment at all."""
        return self._share(self.tally.classes["detected"], len(self.effective))

    @property
    def dangerous_undetected_of_all(self) -> Share | None:
        """Dangerous undetected / all injections: how likely an injection drawn at random is one."""
        return self._share(self.tally.dangerous_undetected, self.tally.injections)

    def _share(self, hits: int, of: int) -> Share | None:
        if self.interrupted:
            return None
        return share(hits, of, exhaustive=self.exhaustive, confidence=self.campaign.confidence)

    def weighted(self, *, safe_too: bool = False) -> Share | None:
        """Diagnostic coverage (`safe_too`: safe failure fraction) weighted by failure rates; None without rates.

        Raises `CampaignError` when only some groups have a rate, one has the rate 0, or a sample has none of a group.
        """
        if self.interrupted or not self.rows or not rated(self.rows, self.campaign.id):
            return None
        for row in self.rows:
            if not row.tally.injections:
                raise CampaignError(
                    f"{self.campaign.id}: the sample has no fault of group {row.group.name!r}, which has a rate; "
                    "draw more, or inject all"
                )
        strata = [row.stratum(exhaustive=row.of == row.tally.injections) for row in self.rows]
        return weighted(strata, safe_too=safe_too, confidence=self.campaign.confidence)

    # --- as declared -----------------------------------------------------------------------------------------------

    def surprises(self) -> list[str]:
        """Where the counts differ from those declared, a line each."""
        found = (
            []
            if not self.interrupted
            else [f"interrupted after {len(self.cells)} of {len(self.campaign.space.injections)} injections"]
        )
        found += _differences("all", self.campaign.expect or {}, self.tally)
        for group in self.campaign.space.groups:
            if group.expect is not None:
                tally = self.groups.get(group.name, Tally.of([]))
                unnamed = {cell: 0 for cell in tally.table}
                found += _differences(group.name, {**unnamed, **group.expect}, tally)
        return found

    def to_json(self) -> dict[str, Any]:
        """The entry of the results document."""
        campaign, space = self.campaign, self.campaign.space
        surprises = self.surprises()
        return {
            "id": campaign.id,
            "model": model_name(campaign),
            "faults": space.statement,
            "injections": self.tally.injections,
            "exhaustive": self.exhaustive,
            "classes": self.tally.classes,
            "diagnostic_coverage": _json(self.diagnostic_coverage),
            "safe_failure_fraction": None if self.safe_failure_fraction is None else self.safe_failure_fraction.value,
            "safe_failure_fraction_bounds": _json(self.safe_failure_fraction),
            "confidence": None if self.exhaustive else campaign.confidence,
            "detected_of_all": _json(self.detected_of_all),
            "detected_of_effective": _json(self.detected_of_effective),
            "dangerous_undetected_of_all": _json(self.dangerous_undetected_of_all),
            "by_rate": self._by_rate(),
            "cells": self.tally.table,
            "groups": [{"group": name, "counts": tally.table} for name, tally in self.groups.items()],
            "fmeda": [row.to_json() for row in self.rows],
            "expected": dict(campaign.expect or {}),
            "expect": {"exhaustive": space.exhaustive},
            "as_expected": not surprises,
            "surprises": surprises,
            "note": "; ".join(surprises),
            "interrupted": self.interrupted,
            "replay": [f"{campaign.id}::{injection.id}" for injection, _ in self.injections("dangerous_undetected")],
            "seconds": self.seconds,
            "injections_per_second": self.tally.injections / self.seconds if self.seconds else None,
        }

    def _by_rate(self) -> dict[str, Any] | None:
        coverage, fraction = self.weighted(), self.weighted(safe_too=True)
        if self.interrupted or not self.rows or self.rows[0].rate is None:
            return None
        sums = {
            name: sum((row.split()[name] or Fraction(0) for row in self.rows), Fraction(0))
            for name in self.rows[0].split()
        }
        return {
            "diagnostic_coverage": _json(coverage),
            "safe_failure_fraction": _json(fraction),
            **{n: float(v) for n, v in sums.items()},
        }


def _differences(where: str, expect: Mapping[str, int], tally: Tally) -> list[str]:
    counts = {**tally.classes, **{cell: tally[cell] for cell in expect if "/" in cell}}
    return [
        f"{where}: {counts[name]} {name}, expected {number}"
        for name, number in expect.items()
        if counts[name] != number
    ]


def _json(found: Share | None) -> dict[str, Any] | None:
    return None if found is None else found.to_json()


def model_name(campaign: Campaign) -> str:
    """Name of the model's class, or of a system."""
    model = campaign.model
    return model.__name__ if isinstance(model, type) else model.name

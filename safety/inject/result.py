"""What a campaign found: counts, coverage with bounds, failure modes, and whether it is as declared."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING, Any, TypeVar

from safety.inject.classes import CELLS, Tally, class_of
from safety.inject.counting import by_key, latencies, pieces
from safety.inject.estimates import by_rate, estimate
from safety.inject.figures import GOOD
from safety.inject.fmeda import Row
from safety.inject.judging import UNMADE, Judged
from safety.inject.space import CampaignError, Injection
from safety.inject.statistics import Share, share

if TYPE_CHECKING:
    from safety.inject.campaign import Campaign

Name = TypeVar("Name", str, int)
MOST_REPLAYS = 1000  # injections named in the results document


@dataclass(eq=False)
class Result:
    """Outcome of a campaign: how each injection came out, by number (`UNMADE` where it was not made).

    An interrupted campaign has counts but no fractions: what was done first is no random sample.
    """

    campaign: Campaign
    judged: Judged
    seconds: float
    interrupted: bool = False

    @classmethod
    def of(cls, campaign: Campaign, judged: Judged, *, seconds: float = 0.0, interrupted: bool = False) -> Result:
        """The result of a campaign from its injections, all in order of number; raises `CampaignError` else."""
        if len(judged) != len(campaign.space):
            raise CampaignError(f"{campaign.id}: {len(judged)} results for {len(campaign.space)} injections")
        return cls(campaign, judged, seconds, interrupted)

    @property
    def exhaustive(self) -> bool:
        """Whether every injection that there is was made."""
        return self.campaign.space.exhaustive and not self.campaign.vary and self.tally.injections == len(self.judged)

    @cached_property
    def _by_key(self) -> dict[int, list[int]]:
        """Number of injections in each cell, by scenario and groups as one number."""
        space = self.campaign.space
        return by_key(self.judged, space.keys, space.scenarios * space.group_keys)

    @cached_property
    def tally(self) -> Tally:
        """Counts over all injections made."""
        columns = zip(*self._by_key.values(), strict=True)
        return Tally.numbered([sum(column) for column in columns] or [0] * len(CELLS))

    @cached_property
    def groups(self) -> dict[str, Tally]:
        """Counts by group; a pair of groups counts as `one & other`."""
        return self._summed(lambda key: self.campaign.space.group_name(key % self.campaign.space.group_keys))

    @cached_property
    def by_scenario(self) -> dict[int, Tally]:
        """Counts by scenario."""
        return self._summed(lambda key: key // self.campaign.space.group_keys)

    def _summed(self, name: Callable[[int], Name]) -> dict[Name, Tally]:
        found: dict[Name, list[int]] = {}
        for key, numbers in self._by_key.items():
            found[name(key)] = [a + b for a, b in zip(found.get(name(key), [0] * len(CELLS)), numbers, strict=True)]
        return {each: Tally.numbered(numbers) for each, numbers in found.items()}

    @cached_property
    def effective(self) -> int:
        """How many of the injections made change the equipment at all.

        A fault changes nothing by construction when it acts on a constant and keeps its value.
        """
        idle, space = self.campaign.collapse().idle, self.campaign.space
        if not idle.any():
            return self.tally.injections
        number = 0
        for low, high in pieces(len(self.judged)):
            quiet = idle[space.members(space.positions(low, high))].all(axis=0)
            number += int((~quiet & (self.judged.cells[low:high] != UNMADE)).sum())
        return number

    @cached_property
    def detected_by(self) -> dict[str, dict[str, Any]]:
        """For each detector how many injections it was the first to find, and the histogram of the latency."""
        names = list(self.campaign.detectors)
        return dict(zip(names, latencies(self.judged, len(names)), strict=True))

    @cached_property
    def rows(self) -> list[Row]:
        """The failure-mode table, a row a group; empty for a campaign of pairs or triples."""
        campaign, space, none = self.campaign, self.campaign.space, Tally.of([])
        if campaign.order > 1:
            return []
        scenarios = range(space.scenarios) if campaign.vary else ()
        return [
            Row(group, None if group.drawn else space.sizes[group.name], self.groups.get(group.name, none),
                campaign.confidence, not self.interrupted,
                tuple(self._under(scenario, place) for scenario in scenarios))
            for place, group in enumerate(space.groups)
        ]  # fmt: skip

    def _under(self, scenario: int, group: int) -> Tally:
        """Counts of a group in a scenario."""
        return Tally.numbered(self._by_key.get(scenario * self.campaign.space.group_keys + group, [0] * len(CELLS)))

    def cell(self, number: int) -> str:
        """The cell of an injection, e.g. "wrong/no"."""
        return CELLS[int(self.judged.cells[number])]

    def numbers(self, *classes: str) -> Iterator[int]:
        """The numbers of the injections made, all or those of some classes."""
        import numpy as np

        wanted = np.zeros(256, dtype=np.bool_)  # by cell
        wanted[[i for i, cell in enumerate(CELLS) if not classes or class_of(cell) in classes]] = True
        for low, high in pieces(len(self.judged)):
            yield from (low + np.flatnonzero(wanted[self.judged.cells[low:high]])).tolist()

    def injections(self, *classes: str) -> Iterator[tuple[Injection, str]]:
        """The injections made with their cell, all or those of some classes."""
        for number in self.numbers(*classes):
            yield self.campaign.space.injection(number), self.cell(number)

    def _dangerous(self) -> Iterator[Injection]:
        return (injection for injection, _ in self.injections("dangerous_undetected"))

    # --- fractions -------------------------------------------------------------------------------------------------

    @property
    def diagnostic_coverage(self) -> Share | None:
        """Dangerous detected / dangerous, every fault counting alike (IEC 61508-4, 3.8.6)."""
        return estimate(self, GOOD["diagnostic_coverage"], ["wrong/no"])

    @property
    def safe_failure_fraction(self) -> Share | None:
        """(safe + dangerous detected) / (safe + dangerous), every fault counting alike (IEC 61508-4, 3.6.15)."""
        return estimate(self, GOOD["safe_failure_fraction"], ["wrong/no"])

    @property
    def detected_of_all(self) -> Share | None:
        """Detected / all injections, whatever their direction."""
        return self._of_all([cell for cell in CELLS if class_of(cell) == "detected"])

    @property
    def detected_of_effective(self) -> Share | None:
        """Detected / injections that change the equipment at all; None where these were drawn in parts."""
        space = self.campaign.space
        if self.interrupted or self.campaign.vary or space.by_group or space.drawn:
            return None
        detected = self.tally.classes["detected"]
        return share(detected, self.effective, exhaustive=self.exhaustive, confidence=self.campaign.confidence)

    @property
    def dangerous_undetected_of_all(self) -> Share | None:
        """Dangerous undetected / all injections: how likely an injection drawn at random is one."""
        return self._of_all(["wrong/no"])

    def _of_all(self, cells: Sequence[str]) -> Share | None:
        return estimate(self, cells, [cell for cell in CELLS if cell not in cells])

    def weighted(self, *, safe_too: bool = False) -> Share | None:
        """Diagnostic coverage (`safe_too`: safe failure fraction) weighted by failure rates; None without rates."""
        return by_rate(self, GOOD["safe_failure_fraction" if safe_too else "diagnostic_coverage"], ["wrong/no"])

    # --- as declared -----------------------------------------------------------------------------------------------

    def surprises(self) -> list[str]:
        """Where the counts differ from those declared, a line each."""
        found = (
            []
            if not self.interrupted
            else [f"interrupted after {self.tally.injections} of {len(self.judged)} injections"]
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
            "unweighted": {
                "diagnostic_coverage": _json(self.diagnostic_coverage),
                "safe_failure_fraction": _json(self.safe_failure_fraction),
            },
            "by_rate": self._by_rate(),
            "detected_by": self.detected_by,
            "scenarios": self._scenarios(),
            "cells": self.tally.table,
            "groups": [{"group": name, "counts": tally.table} for name, tally in self.groups.items()],
            "fmeda": [row.to_json() for row in self.rows],
            "expected": dict(campaign.expect or {}),
            "expect": {"exhaustive": space.exhaustive and not campaign.vary},
            "as_expected": not surprises,
            "surprises": surprises,
            "note": "; ".join(surprises),
            "interrupted": self.interrupted,
            "replay": [f"{campaign.id}::{injection.id}" for injection in islice(self._dangerous(), MOST_REPLAYS)],
            "replay_of": self.tally.classes["dangerous_undetected"],
            "engine": campaign.engine_used,
            "engine_note": campaign.engine_note,
            "collapsed": campaign.collapse().to_json() if campaign.collapsing else None,
            "seconds": self.seconds,
            "injections_per_second": self.tally.injections / self.seconds if self.seconds else None,
        }

    def _scenarios(self) -> list[dict[str, Any]]:
        """What was drawn for each scenario, and how its injections came out; empty where nothing is drawn."""
        if not self.campaign.vary:
            return []
        drawn = {number: self.campaign.variant(number).told for number in self.by_scenario}
        return [{"drawn": drawn[number], "counts": tally.table} for number, tally in self.by_scenario.items()]

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

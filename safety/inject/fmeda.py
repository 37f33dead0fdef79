"""Failure modes, effects and diagnostics: a row for each group of faults, with its failure rate divided.

A group's rate is shared evenly by its faults, so lambda_S, lambda_DD and lambda_DU are the rate times the shares found.
Rates are 1/h and exact; the tag of their source stays with them.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, cast

from safety.inject.classes import CLASSES, Tally
from safety.inject.space import CampaignError, Group
from safety.inject.statistics import Stratum


@dataclass(frozen=True)
class Row:
    """One failure mode with the outcome of its injections; `of` is how many there are in all, tried or not."""

    group: Group
    of: int
    tally: Tally

    @property
    def rate(self) -> Fraction | None:
        """Failure rate of the whole mode, 1/h."""
        return cast("Fraction | None", self.group.rate_per_h)

    def share_of_rate(self, count: int) -> Fraction | None:
        """The part of the rate, 1/h, that `count` of the tried faults stand for."""
        if self.rate is None or not self.tally.injections:
            return None
        return self.rate * Fraction(count, self.tally.injections)

    def split(self) -> dict[str, Fraction | None]:
        """lambda_S, lambda_DD, lambda_DU in 1/h."""
        t = self.tally
        counts = {"lambda_s": t.safe, "lambda_dd": t.dangerous_detected, "lambda_du": t.dangerous_undetected}
        return {name: self.share_of_rate(count) for name, count in counts.items()}

    def coverage(self) -> Fraction | None:
        """Diagnostic coverage of the mode: dangerous detected / dangerous."""
        good, bad = self.tally.dangerous_detected, self.tally.dangerous_undetected
        return Fraction(good, good + bad) if good + bad else None

    def safe_failure_fraction(self) -> Fraction | None:
        """(safe + dangerous detected) / (safe + dangerous) of the mode."""
        good, bad = self.tally.safe + self.tally.dangerous_detected, self.tally.dangerous_undetected
        return Fraction(good, good + bad) if good + bad else None

    def stratum(self, *, exhaustive: bool) -> Stratum:
        """The mode as a stratum that weighs its rate."""
        t = self.tally
        return Stratum(
            self.group.name,
            self.rate or Fraction(0),
            t.injections,
            t.safe,
            t.dangerous_detected,
            t.dangerous_undetected,
            exhaustive,
        )

    def to_json(self) -> dict[str, Any]:
        """The row with plain numbers; `faults` counts the injections made."""
        return {
            "part": self.group.part or self.group.name,
            "mode": self.group.mode or self.group.name,
            "faults": self.tally.injections,
            "rate_per_h": _plain(self.rate),
            **{name: self.tally.classes[name] for name in CLASSES},
            "dangerous_detected": self.tally.dangerous_detected,
            **{name: _plain(value) for name, value in self.split().items()},
            "diagnostic_coverage": _plain(self.coverage()),
            "safe_failure_fraction": _plain(self.safe_failure_fraction()),
            "tag": self.group.tag,
            "source": self.group.source,
        }


def _plain(value: Fraction | None) -> float | None:
    return None if value is None else float(value)


def rated(rows: Sequence[Row], place: str) -> bool:
    """Whether rates are given.  Raises `CampaignError` when only some rows have one, or one is not above 0."""
    without = [row.group.name for row in rows if row.rate is None]
    if len(without) == len(rows):
        return False
    if without:
        raise CampaignError(
            f"{place}: group {without[0]!r} has no failure rate, others have; give it one, or none to any"
        )
    for row in rows:
        if cast(Fraction, row.rate) <= 0:
            raise CampaignError(
                f"{place}: group {row.group.name!r} has the rate {row.rate} /h and would weigh nothing; "
                "give a rate above 0 or leave the group out"
            )
    return True


COLUMNS = (
    "part", "mode", "faults", "rate_per_h", *CLASSES, "dangerous_detected", "lambda_s", "lambda_dd", "lambda_du",
    "diagnostic_coverage", "safe_failure_fraction", "tag", "source",
)  # fmt: skip


def write_csv(rows: Iterable[Row], path: str | Path) -> None:
    """Write the table: a header line, then a line a mode; an unknown value is an empty cell."""
    with Path(path).open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(row.to_json() for row in rows)

"""Failure modes, effects and diagnostics: a row for each group of faults, with its failure rate divided.

A group's rate is shared evenly by its faults, so lambda_S, lambda_DD and lambda_DU are the rate times the shares found.
Rates are 1/h and exact; the tag of their source stays with them.  Every figure has bounds: none where all faults of the
mode were injected, hypergeometric ones where a sample was drawn, and what the faults left out could do where a campaign
was cut short.  Under scenarios that are drawn it is the scenarios that count as trials.  lambda_DU of the equipment is
what a tolerable hazard rate of EN 50129 is compared with.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, cast

from safety.inject.classes import CLASSES, Tally
from safety.inject.counting import pieces
from safety.inject.figures import FIGURES, GOOD, RATES, Figure, count, good
from safety.inject.space import CampaignError, Group, Space
from safety.inject.statistics import (
    Stratum,
    Trials,
    bounds,
    clustered,
    clustered_ratio,
    total,
    weighted,
)

UNKNOWN = (Fraction(0), Fraction(1))


@dataclass(frozen=True)
class Row:
    """One failure mode with the outcome of its injections.

    `of`: how many injections there are in all, tried or not; None where there is no end of them.  `at_random`: those
    tried are a random sample, which those of a campaign cut short are not.  `scenarios`: the outcome under each
    scenario, where these are drawn.
    """

    group: Group
    of: int | None
    tally: Tally
    confidence: float = 0.99
    at_random: bool = True
    scenarios: tuple[Tally, ...] = ()

    @property
    def rate(self) -> Fraction | None:
        """Failure rate of the whole mode, 1/h."""
        return cast("Fraction | None", self.group.rate_per_h)

    @property
    def part(self) -> str:
        """The part that fails; the group's name where none is given."""
        return self.group.part or self.group.name

    @property
    def mode(self) -> str:
        """How it fails; the group's name where it is not given."""
        return self.group.mode or self.group.name

    @property
    def exhaustive(self) -> bool:
        """Whether every injection of the mode was made, under the only stimulus that there is."""
        return self.of == self.tally.injections and not self.scenarios

    def share_of_rate(self, count: int) -> Fraction | None:
        """The part of the rate, 1/h, that `count` of the tried faults stand for."""
        if self.rate is None or not self.tally.injections:
            return None
        return self.rate * Fraction(count, self.tally.injections)

    def split(self) -> dict[str, Fraction | None]:
        """lambda_S, lambda_DD, lambda_DU in 1/h."""
        return {name: self.share_of_rate(count(self.tally, name)) for name in ("lambda_s", "lambda_dd", "lambda_du")}

    def coverage(self) -> Fraction | None:
        """Diagnostic coverage of the mode: dangerous detected / dangerous."""
        return self._fraction("diagnostic_coverage")

    def safe_failure_fraction(self) -> Fraction | None:
        """(safe + dangerous detected) / (safe + dangerous) of the mode."""
        return self._fraction("safe_failure_fraction")

    def _fraction(self, name: str) -> Fraction | None:
        of = count(self.tally, name)
        return Fraction(good(self.tally, name), of) if of else None

    def figure(self, name: str) -> Figure | None:
        """One of `FIGURES` with its bounds; None where it is unknown: no rate, nothing tried, nothing dangerous.

        Each holds by itself with the row's confidence.  Raises `KeyError` for another name.
        """
        if name in GOOD:
            value = self._fraction(name)
            return None if value is None else Figure(value, *self._bounds_of_fraction(name))
        tried, found = self.tally.injections, count(self.tally, name)
        if self.rate is None or not tried:
            return None
        return Figure(Fraction(found, tried), *self._bounds_of_rate(name)).times(self.rate)

    def _bounds_of_rate(self, name: str) -> tuple[Fraction, Fraction]:
        found, tried = count(self.tally, name), self.tally.injections
        if self.scenarios:
            return _exactly(clustered(self.shares(RATES[name]), self.confidence)) if self.at_random else UNKNOWN
        if self.of is None:
            return bounds(found, tried, None, self.confidence) if self.at_random else UNKNOWN
        if self.at_random and not self.exhaustive:
            return bounds(found, tried, self.of, self.confidence)
        return Fraction(found, self.of), Fraction(self.of - (tried - found), self.of)

    def _bounds_of_fraction(self, name: str) -> tuple[Fraction, Fraction]:
        """Of those not tried, it is not known how many have an effect."""
        found, tried = good(self.tally, name), count(self.tally, name)
        if self.scenarios:
            shares = self.shares(GOOD[name]), self.shares(("wrong/no",))
            return _exactly(clustered_ratio(*shares, self.confidence)) if self.at_random else UNKNOWN
        if self.at_random and not self.exhaustive:
            return bounds(found, tried, None, self.confidence)
        if self.of is None:
            return UNKNOWN
        untried = self.of - self.tally.injections
        return Fraction(found, tried + untried), Fraction(found + untried, tried + untried)

    def shares(self, cells: Sequence[str]) -> list[Fraction]:
        """The share of some cells under each scenario in which the mode was tried."""
        return [_share(tally, cells) for tally in self.scenarios if tally.injections]

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
            self.of,
        )

    def to_json(self) -> dict[str, Any]:
        """The row with plain numbers; `faults` counts the injections made, `bounds` are low and high of the figures."""
        figures = {name: self.figure(name) for name in FIGURES}
        return {
            "part": self.part,
            "mode": self.mode,
            "faults": self.tally.injections,
            "rate_per_h": _plain(self.rate),
            **{name: self.tally.classes[name] for name in CLASSES},
            "dangerous_detected": self.tally.dangerous_detected,
            **{name: _plain(figure.value if figure else None) for name, figure in figures.items()},
            "bounds": {name: [float(f.low), float(f.high)] for name, f in figures.items() if f},
            "exhaustive": self.exhaustive,
            "tag": self.group.tag,
            "source": self.group.source,
        }


@dataclass(frozen=True)
class Total:
    """The rows of one part, or of the whole equipment, together."""

    name: str
    rows: tuple[Row, ...]

    @property
    def rate(self) -> Fraction | None:
        """Sum of the failure rates, 1/h; None where one is missing."""
        rates = [row.rate for row in self.rows]
        return None if None in rates else sum(cast("list[Fraction]", rates), Fraction(0))

    @property
    def tags(self) -> str:
        """The tags of the rates that it is made of, e.g. "AP"."""
        return "".join(sorted({row.group.tag for row in self.rows}))

    def figure(self, name: str) -> Figure | None:
        """One of `FIGURES` over the rows, weighted by rate; its bounds hold for all rows at once.

        None where a rate is missing or 0, a mode was not tried, nothing is dangerous, or a campaign was cut short.
        """
        rows = self.rows
        if not all(r.rate and r.tally.injections and (r.at_random or r.exhaustive) for r in rows):
            return None
        confidence = max(row.confidence for row in rows)
        if any(row.scenarios for row in rows):
            return self._under_scenarios(name, confidence)
        if name in GOOD:
            strata = [row.stratum(exhaustive=row.exhaustive) for row in rows]
            return Figure.of(weighted(strata, safe_too=name == "safe_failure_fraction", confidence=confidence))
        trials = [
            Trials(r.group.name, cast(Fraction, r.rate), count(r.tally, name), r.tally.injections, r.exhaustive, r.of)
            for r in rows
        ]
        return Figure.of(total(trials, confidence))

    def _under_scenarios(self, name: str, confidence: float) -> Figure | None:
        """The modes have each scenario in common, so what is independent is their sum under each."""
        wanted, bad = self._shares(RATES.get(name) or GOOD[name]), self._shares(("wrong/no",))
        if not wanted:
            return None
        if name in RATES:
            bounds = _exactly(clustered(wanted, confidence))
            return Figure(sum(wanted, Fraction(0)) / len(wanted), *bounds).times(cast(Fraction, self.rate))
        both = sum(wanted, Fraction(0)) + sum(bad, Fraction(0))
        bounds = _exactly(clustered_ratio(wanted, bad, confidence))
        return Figure(sum(wanted, Fraction(0)) / both, *bounds) if both else None

    def _shares(self, cells: Sequence[str]) -> list[Fraction]:
        """The share of the whole rate that comes to some cells, under each scenario in which every mode was tried."""
        return [
            sum(
                (cast(Fraction, r.rate) * _share(t, cells) for r, t in zip(self.rows, tallies, strict=True)),
                Fraction(0),
            )
            / cast(Fraction, self.rate)
            for tallies in zip(*(row.scenarios for row in self.rows), strict=True)
            if all(tally.injections for tally in tallies)
        ]


def totals(rows: Sequence[Row]) -> list[Total]:
    """A total for each part, in the order of its first row, and last that of all rows, named "equipment"."""
    parts: dict[str, list[Row]] = {}
    for row in rows:
        parts.setdefault(row.part, []).append(row)
    return [*(Total(part, tuple(members)) for part, members in parts.items()), Total("equipment", tuple(rows))]


def _share(tally: Tally, cells: Sequence[str]) -> Fraction:
    return Fraction(sum(tally[cell] for cell in cells), tally.injections)


def _plain(value: Fraction | None) -> float | None:
    return None if value is None else float(value)


def _exactly(bounds: tuple[float, float]) -> tuple[Fraction, Fraction]:
    return Fraction(bounds[0]), Fraction(bounds[1])


def rated(groups: Sequence[Group], place: str) -> bool:
    """Whether rates are given.  Raises `CampaignError` when only some groups have one, or one is not above 0."""
    without = [group.name for group in groups if group.rate_per_h is None]
    if len(without) == len(groups):
        return False
    if without:
        raise CampaignError(
            f"{place}: group {without[0]!r} has no failure rate, others have; give it one, or none to any"
        )
    for group in groups:
        if cast(Fraction, group.rate_per_h) <= 0:
            raise CampaignError(
                f"{place}: group {group.name!r} has the rate {group.rate_per_h} /h and would weigh nothing; "
                "give a rate above 0 or leave the group out"
            )
    return True


def check_rates(space: Space, place: str) -> None:
    """Refuse, before anything is run, what would leave figures by rate without a group.

    Raises `CampaignError` as `rated` does, and when a sample has no injection of a group with a rate, in any scenario.
    """
    import numpy as np

    if space.order > 1 or not rated(space.groups, place) or space.chosen is None:
        return
    numbers = np.zeros(space.scenarios * space.group_keys, dtype=np.int64)
    for low, high in pieces(len(space)):
        numbers += np.bincount(space.keys(low, high), minlength=len(numbers))
    for key in np.flatnonzero(numbers == 0)[:1]:
        raise CampaignError(
            f"{place}: the sample has no fault of group {space.group_name(int(key) % space.group_keys)!r}, "
            "which has a rate; draw more, or inject all"
        )


COLUMNS = (
    "part", "mode", "faults", "rate_per_h", *CLASSES, "dangerous_detected",
    *(column for name in FIGURES for column in (name, f"{name}_low", f"{name}_high")), "exhaustive", "tag", "source",
)  # fmt: skip


def records(rows: Iterable[Row]) -> list[dict[str, Any]]:
    """The rows by column, with plain numbers; None is unknown."""
    found = []
    for row in rows:
        record = row.to_json()
        bounds = record.pop("bounds")
        for name in FIGURES:
            record[f"{name}_low"], record[f"{name}_high"] = bounds.get(name, (None, None))
        found.append({column: record[column] for column in COLUMNS})
    return found


FORMULA = ("=", "+", "-", "@", "\t", "\r")  # a spreadsheet may take a cell of a CSV file that begins so for a formula


def write_csv(rows: Iterable[Row], path: str | Path) -> None:
    """Write the table: a header line, then a line a mode; an unknown value is an empty cell.

    An apostrophe stands before a text that a spreadsheet would take for a formula; `with_rates` takes it off again.
    """
    with Path(path).open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        for record in records(rows):
            writer.writerow({column: _cell(value) for column, value in record.items()})


def _cell(value: Any) -> Any:
    return f"'{value}" if isinstance(value, str) and value.startswith(FORMULA) else value

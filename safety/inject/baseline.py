"""Baselines: what a campaign found, kept in a file, and what a later run of the same campaign found otherwise.

A record has no time and nothing of the machine in it.  It knows injections by their numbers in the space, as ranges, so
the space has to be the same; where the ranges would grow too long, counts and a digest for each fault stand for them: a
change is then seen all the same, and named by its fault.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import astuple, dataclass, field
from typing import TYPE_CHECKING, Any

from safety.inject.classes import CELLS, class_of
from safety.inject.result import model_name
from safety.inject.space import CampaignError, identify

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from safety.inject.campaign import Campaign
    from safety.inject.judging import Judged
    from safety.inject.result import Result

    Numbers = npt.NDArray[np.int64]

SCHEMA = "rightside/baseline/1"
LONGEST = 20_000  # characters of a list of ranges
NAMED = 1000  # injections that a record or a comparison names
SETS = ("dangerous_undetected", "detected")


@dataclass(frozen=True, eq=False)
class Findings:
    """What a run found: the numbers, ascending, of the injections that are dangerous undetected, and detected by whom.

    `coverage` is the diagnostic coverage as in the results document.
    """

    campaign: Campaign
    classes: Mapping[str, int]
    coverage: Mapping[str, Any] | None
    undetected: Numbers
    detected: Mapping[str, Numbers]
    judged: Judged

    @classmethod
    def of(cls, result: Result) -> Findings:
        """The findings of a result; a campaign with judges of its own does not say who detects."""
        import numpy as np

        judged, labels = result.judged, list(result.campaign.detectors)
        by = {label: np.flatnonzero(judged.detector == place) for place, label in enumerate(labels)}
        found = _in_class(judged, "detected")
        by |= {"": np.setdiff1d(found, _union(by.values()))}
        coverage = result.diagnostic_coverage
        return cls(
            result.campaign, result.tally.classes, None if coverage is None else coverage.to_json(),
            _in_class(judged, "dangerous_undetected"), {label: n for label, n in by.items() if len(n)}, judged,
        )  # fmt: skip

    @property
    def all_detected(self) -> Numbers:
        """Numbers of the injections that are detected by anyone."""
        return _union(self.detected.values())

    def name(self, number: int) -> str:
        """The id of an injection."""
        return self.campaign.space.injection(number).id

    def class_at(self, number: int) -> str:
        """The class of an injection."""
        return class_of(CELLS[self.judged.cells[number]])

    def record(self) -> dict[str, Any]:
        """What a baseline file keeps of the run."""
        sets = {"dangerous_undetected": to_ranges(self.undetected), "detected": to_ranges(self.all_detected)}
        record: dict[str, Any] = {
            **identity(self.campaign),
            "classes": dict(self.classes),
            "diagnostic_coverage": self.coverage,
            "named": [self.name(int(number)) for number in self.undetected[:NAMED]],
            "detected_by": {label: to_ranges(numbers) for label, numbers in self.detected.items()},
            **sets,
        }
        return record if None not in sets.values() else record | {"by_fault": self.by_fault()}

    def by_fault(self) -> dict[str, dict[str, list[Any]]]:
        """For each fault and set: how many of the injections it takes part in, a digest of which, and the first."""
        space, found = self.campaign.space, dict[str, dict[str, list[Any]]]()
        for name, numbers in zip(SETS, (self.undetected, self.all_detected), strict=True):
            members = space.members(numbers if space.chosen is None else space.chosen[numbers])
            for place, fault in enumerate(space.singles):
                own = numbers[(members == place).any(axis=0)]
                if len(own):
                    found.setdefault(identify(fault), {})[name] = [len(own), _digest(own), self.name(int(own[0]))]
        return found


def identity(campaign: Campaign) -> dict[str, Any]:
    """What has to be the same for a record to be of this campaign: its model's name and its space."""
    space = campaign.space
    onsets = None if space.onsets is None else [space.onsets.start, space.onsets.stop, space.onsets.step]
    drawn = None if space.chosen is None else _digest(space.chosen)
    seed = campaign.seed if campaign.vary else None
    told = [
        [identify(fault) for fault in space.singles],
        space.order,
        onsets,
        space.length,
        space.scenarios,
        drawn,
        seed,
    ]
    text = json.dumps([*told, *astuple(campaign.timing)])
    return {
        "model": model_name(campaign),
        "faults": space.statement,
        "injections": len(space),
        "space": hashlib.sha256(text.encode()).hexdigest()[:16],
    }


def _in_class(judged: Judged, wanted: str) -> Numbers:
    import numpy as np

    return np.flatnonzero(
        np.isin(judged.cells, [place for place, cell in enumerate(CELLS) if class_of(cell) == wanted])
    )


@dataclass
class Comparison:
    """What is otherwise than in the baseline: ids of injections, or of faults where the baseline does not list them."""

    new: dict[str, str] = field(default_factory=dict)  # dangerous undetected now: what it was
    lost: dict[str, str] = field(default_factory=dict)  # no longer detected: what it is
    gone: list[str] = field(default_factory=list)  # no longer dangerous undetected
    gained: list[str] = field(default_factory=list)  # detected now
    unclear: dict[str, str] = field(default_factory=dict)  # an injection of a fault with changes: what changed
    moved: int = 0  # detected before and now, by others
    left_out: int = 0  # more of any kind, not named

    @property
    def worse(self) -> bool:
        """Whether the run has something that the baseline has not accepted."""
        return bool(self.new or self.lost or self.unclear)

    def to_json(self) -> dict[str, Any]:
        """Plain values, for the entry of the results document."""
        return dict(self.__dict__)


# --- a run against a record ------------------------------------------------------------------------------------------


def compare(record: Mapping[str, Any], now: Findings) -> Comparison:
    """What a run found otherwise than a record of the same campaign."""
    found = Comparison()
    if any(record[name] is None for name in SETS):
        _compare_by_fault(record, now, found)
        return found
    import numpy as np

    before, was_detected = (from_ranges(record[name]) for name in SETS)
    is_detected = now.all_detected
    by = {label: from_ranges(text) for label, text in record["detected_by"].items() if text is not None}
    for number in _some(np.setdiff1d(now.undetected, before), found):
        found.new[now.name(number)] = _who(by, number) or "safe or without effect"
    lost = np.setdiff1d(np.setdiff1d(was_detected, is_detected), now.undetected)
    for number in _some(lost, found):
        found.lost[now.name(number)] = now.class_at(number)
    found.gone += [now.name(p) for p in _some(np.setdiff1d(before, now.undetected), found)]
    found.gained += [now.name(p) for p in _some(np.setdiff1d(is_detected, was_detected), found)]
    if len(by) == len(record["detected_by"]):
        both = np.intersect1d(was_detected, is_detected)
        labels = by.keys() | now.detected.keys()
        found.moved = len(_union(_changed(by, now.detected, label, both) for label in labels))
    return found


def _compare_by_fault(record: Mapping[str, Any], now: Findings, found: Comparison) -> None:
    before, after = record["by_fault"], now.by_fault()
    for fault in sorted(before.keys() | after.keys()):
        for name in SETS:
            was, here = (by.get(fault, {}).get(name, [0, "", ""]) for by in (before, after))
            if was[:2] == here[:2] or (name == "detected" and not was[0]):
                continue
            if name == "dangerous_undetected" and not here[0]:
                found.gone.append(fault)
                continue
            words = name.replace("_", " ")
            found.unclear.setdefault(here[2] or was[2], f"{fault}: {was[0]} {words} before, {here[0]} now")


def _some(numbers: Numbers, found: Comparison) -> Iterator[int]:
    found.left_out += max(0, len(numbers) - NAMED)
    yield from numbers[:NAMED].tolist()


def _changed(before: Mapping[str, Numbers], now: Mapping[str, Numbers], label: str, both: Numbers) -> Numbers:
    import numpy as np

    none = from_ranges("")
    return np.intersect1d(np.setxor1d(before.get(label, none), now.get(label, none)), both)


def _who(by: Mapping[str, Numbers], number: int) -> str:
    labels = [label for label, numbers in by.items() if number in numbers]
    return f"detected by {labels[0]}".removesuffix(" by ") if labels else ""


def _union(sets: Iterable[Numbers]) -> Numbers:
    import numpy as np

    return np.unique(np.concatenate([np.empty(0, dtype=np.int64), *sets]))


# --- numbers as text -----------------------------------------------------------------------------------------------


def to_ranges(numbers: Numbers) -> str | None:
    """Ascending numbers as `0-31 35`; None where that takes more than `LONGEST` characters."""
    import numpy as np

    if not len(numbers):
        return ""
    breaks = np.flatnonzero(np.diff(numbers) != 1)
    firsts, lasts = numbers[np.r_[0, breaks + 1]], numbers[np.r_[breaks, len(numbers) - 1]]
    if 2 * len(firsts) > LONGEST:
        return None
    text = " ".join(str(a) if a == b else f"{a}-{b}" for a, b in zip(firsts.tolist(), lasts.tolist(), strict=True))
    return text if len(text) <= LONGEST else None


def from_ranges(text: str) -> Numbers:
    """The numbers that `to_ranges` wrote.  Raises `ValueError` for any other text."""
    import numpy as np

    pairs = _pairs(text)
    return np.concatenate([np.empty(0, dtype=np.int64), *(np.arange(first, last + 1) for first, last in pairs)])


def _pairs(text: str) -> list[tuple[int, int]]:
    found: list[tuple[int, int]] = []
    for part in text.split():
        first, dash, last = part.partition("-")
        pair = int(first), int(last if dash else first)
        if pair[0] > pair[1] or (found and pair[0] <= found[-1][1]):
            raise ValueError(f"{part!r} stands out of order")
        found.append(pair)
    return found


def _digest(numbers: Numbers) -> str:
    return hashlib.sha256(numbers.astype("<i8").tobytes()).hexdigest()[:16]


# --- files -----------------------------------------------------------------------------------------------------------


def dumps(records: Mapping[str, Mapping[str, Any]]) -> str:
    """The text of a baseline file: records by campaign, in a fixed order."""
    return json.dumps({"schema": SCHEMA, "campaigns": records}, indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def loads(text: str, name: str) -> dict[str, dict[str, Any]]:
    """The records of a baseline file by campaign; `name` stands in messages for the file.

    Raises `CampaignError` with the place and what was expected there.
    """
    try:
        document = json.loads(text)
    except json.JSONDecodeError as bad:
        raise CampaignError(
            f"{name}:{bad.lineno}: no JSON: {bad.msg}; `rightside inject --write-baseline {name}` writes a new one"
        ) from None
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        raise CampaignError(f'{name}:1: no baseline: it has no "schema": "{SCHEMA}"; give a file of --write-baseline')
    records = document.get("campaigns")
    if not isinstance(records, dict):
        raise CampaignError(f'{name}: "campaigns" is no object; write it anew with --write-baseline {name}')
    for campaign, record in records.items():
        wrong = _wrong(record)
        if wrong:
            line = next((n for n, row in enumerate(text.splitlines(), 1) if f"{json.dumps(campaign)}:" in row), 1)
            raise CampaignError(f"{name}:{line}: campaign {campaign!r}: {wrong}; write it anew with --write-baseline")
    return records


def _wrong(record: Any) -> str:
    """What keeps a record from being one, or nothing."""
    if not isinstance(record, dict):
        return "it is no object"
    shape = {"model": str, "faults": str, "space": str, "injections": int, "classes": dict, "detected_by": dict}
    for key, kind in shape.items():
        if not isinstance(record.get(key), kind):
            return f"{key!r} is {record.get(key)!r}, expected {_KINDS[kind]}"
    for name, text in {**{k: record.get(k, 0) for k in SETS}, **record["detected_by"]}.items():
        try:
            last = _pairs(text)[-1:] if text is not None else []
        except (AttributeError, ValueError):
            return f"{name!r} is {text!r}, expected ranges such as '0-31 35'"
        if last and last[0][1] >= record["injections"]:
            return f"{name!r} goes to {last[0][1]}, but there are {record['injections']} injections"
    if any(record[name] is None for name in SETS) and not isinstance(record.get("by_fault"), dict):
        return "'by_fault' is not there, though ranges are left out"
    return ""


_KINDS = {str: "a text", int: "a number", dict: "an object"}


def same_campaign(record: Mapping[str, Any], campaign: Campaign, file: str) -> None:
    """Refuse a record of another campaign.  Raises `CampaignError` with what differs and what to do."""
    now = identity(campaign)
    differs = [
        f"its {what} was {record[what]!r}, is {now[what]!r}"
        for what in ("model", "faults")
        if record[what] != now[what]
    ]
    if not differs and any(record[key] != value for key, value in now.items()):
        differs = [f"{now['faults']} as before, but other ones, or others at other times"]
    if differs:
        raise CampaignError(
            f"{file}: campaign {campaign.id!r} is another one: {'; '.join(differs)}; look at its results, then accept "
            f"them with `rightside inject -k {campaign.id} --write-baseline {file}`"
        )

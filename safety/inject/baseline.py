"""Baselines: what a campaign found, as a record to be kept, and what a later run of the campaign found otherwise.

A record has no time and nothing of the machine in it.  It knows injections by their numbers in the space, so the space
has to be the same.  A set of them that takes too long to write down is kept as a count and a digest for each fault: a
change is then seen all the same, and named by its fault.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import astuple, dataclass, field
from typing import TYPE_CHECKING, Any

from safety.inject.classes import CELLS, class_of
from safety.inject.number_sets import from_text, to_text
from safety.inject.result import model_name
from safety.inject.space import identify

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from safety.inject.campaign import Campaign
    from safety.inject.judging import Judged
    from safety.inject.result import Result

    Numbers = npt.NDArray[np.int64]

READ = 200  # injections that a record names for who reads it
NAMED = 1000  # injections that a comparison names
SEARCHED = 2**20  # injections among which one of a fault is looked for
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
        undetected = to_text(self.undetected)
        detected = {label: to_text(numbers) for label, numbers in self.detected.items()}
        return {
            **identity(self.campaign),
            "classes": dict(self.classes),
            "diagnostic_coverage": self.coverage,
            "named": [self.name(int(number)) for number in self.undetected[:READ]],
            "dangerous_undetected": undetected,
            "detected_by": detected,
            "by_fault": {
                **({"dangerous_undetected": self.by_fault(self.undetected)} if undetected is None else {}),
                **({"detected": self.by_fault(self.all_detected)} if None in detected.values() else {}),
            },
        }

    def by_fault(self, numbers: Numbers) -> dict[str, list[Any]]:
        """For each fault, how many of these injections it takes part in, and a digest of which."""
        space, found = self.campaign.space, dict[str, list[Any]]()
        members = space.members(numbers if space.chosen is None else space.chosen[numbers])
        for place, fault in enumerate(space.singles):
            own = numbers[(members == place).any(axis=0)]
            if len(own):
                found[identify(fault)] = [len(own), _digest(own)]
        return found

    def one_of(self, fault: str, numbers: Numbers) -> int:
        """One of these injections in which a fault takes part, or else any; the fault by its id."""
        import numpy as np

        space = self.campaign.space
        place = [identify(single) for single in space.singles].index(fault)
        for some in (numbers, np.arange(min(len(space), SEARCHED))):
            members = space.members(some if space.chosen is None else space.chosen[some])
            own = some[(members == place).any(axis=0)]
            if len(own):
                return int(own[0])
        return 0


def identity(campaign: Campaign) -> dict[str, Any]:
    """What has to be the same for a record to be of this campaign: its model's name and its space."""
    space = campaign.space
    onsets = None if space.onsets is None else [space.onsets.start, space.onsets.stop, space.onsets.step]
    drawn = None if space.chosen is None else _digest(space.chosen)
    seed = campaign.seed if campaign.vary else None
    told = [[identify(fault) for fault in space.singles], space.order, onsets, space.length, space.scenarios]
    text = json.dumps([*told, drawn, seed, *astuple(campaign.timing)])
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
    unclear: dict[str, str] = field(default_factory=dict)  # what changed of a fault: one of its injections
    moved: int = 0  # detected before and now, by others
    left_out: int = 0  # more of any kind, not named

    @property
    def worse(self) -> bool:
        """Whether the run has something that the baseline has not accepted."""
        return bool(self.new or self.lost or self.unclear)

    def to_json(self) -> dict[str, Any]:
        """Plain values, for the entry of the results document."""
        return dict(self.__dict__)


# --- a run against a record -----------------------------------------------------------------------------------------


def compare(record: Mapping[str, Any], now: Findings) -> Comparison:
    """What a run found otherwise than a record of the same campaign."""
    import numpy as np

    found, below, told = Comparison(), record["injections"], record["detected_by"]
    else_ = "safe or without effect" if None not in told.values() else "not that"
    by = {label: from_text(text, below) for label, text in told.items() if text is not None}
    is_detected = now.all_detected
    if record["dangerous_undetected"] is None:
        _compare_by_fault("dangerous_undetected", record, now, now.undetected, found)
    else:
        before = from_text(record["dangerous_undetected"], below)
        for number in _some(np.setdiff1d(now.undetected, before), found):
            found.new[now.name(number)] = _who(by, number) or else_
        found.gone += [now.name(number) for number in _some(np.setdiff1d(before, now.undetected), found)]
    if len(by) < len(told):
        _compare_by_fault("detected", record, now, is_detected, found)
        return found
    was_detected = _union(by.values())
    lost = np.setdiff1d(np.setdiff1d(was_detected, is_detected), now.undetected)
    for number in _some(lost, found):
        found.lost[now.name(number)] = now.class_at(number)
    found.gained += [now.name(number) for number in _some(np.setdiff1d(is_detected, was_detected), found)]
    both = np.intersect1d(was_detected, is_detected)
    found.moved = len(_union(_changed(by, now.detected, label, both) for label in by.keys() | now.detected.keys()))
    return found


def _compare_by_fault(name: str, record: Mapping[str, Any], now: Findings, numbers: Numbers, found: Comparison) -> None:
    before, after = record["by_fault"][name], now.by_fault(numbers)
    for fault in sorted(before.keys() | after.keys()):
        was, here = (by.get(fault, [0, ""]) for by in (before, after))
        if was == here:
            continue
        if name == "dangerous_undetected" and not here[0]:
            found.gone.append(fault)
        elif name == "detected" and not was[0]:
            found.gained.append(fault)
        else:
            told = f"{fault}: {was[0]} {name.replace('_', ' ')} before, {here[0]} now"
            found.unclear[told] = now.name(now.one_of(fault, numbers))


def _some(numbers: Numbers, found: Comparison) -> Iterator[int]:
    found.left_out += max(0, len(numbers) - NAMED)
    yield from numbers[:NAMED].tolist()


def _changed(before: Mapping[str, Numbers], now: Mapping[str, Numbers], label: str, both: Numbers) -> Numbers:
    import numpy as np

    none = np.empty(0, dtype=np.int64)
    return np.intersect1d(np.setxor1d(before.get(label, none), now.get(label, none)), both)


def _who(by: Mapping[str, Numbers], number: int) -> str:
    labels = [label for label, numbers in by.items() if number in numbers]
    return f"detected by {labels[0]}".removesuffix(" by ") if labels else ""


def _union(sets: Iterable[Numbers]) -> Numbers:
    import numpy as np

    return np.unique(np.concatenate([np.empty(0, dtype=np.int64), *sets]))


def _digest(numbers: Numbers) -> str:
    return hashlib.sha256(numbers.astype("<i8").tobytes()).hexdigest()[:16]

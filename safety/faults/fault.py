"""A fault: a kind at points, with its onset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from safety.kinds import Kind
from safety.system import ModelError

FROM_START, ANY_TIME, TRANSIENT, INTERMITTENT = "from start", "any time", "transient", "intermittent"
ONSETS = (FROM_START, ANY_TIME, TRANSIENT, INTERMITTENT)


@dataclass(frozen=True)
class Fault:
    """A kind at points (full names or patterns such as `a.*`; a kind of parts at parts), with its onset.

    `at` and `ticks` fix the schedule of a run, `values` (by point, one a step, the last for ever) what a run takes
    where the kind leaves a choice; in a proof the onset is free unless it is FROM_START, and `ticks` bounds a
    transient.  `name` identifies the fault in results.
    """

    kind: Kind
    points: Sequence[str]
    onset: str = FROM_START
    at: int = 0
    ticks: int | None = None
    name: str = ""
    values: Mapping[str, Sequence[Any]] | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        if not isinstance(self.kind, Kind):
            raise ModelError(f"Fault({self.kind!r}, ...): that is no fault kind; write e.g. stuck(0)")
        for number in (self.at, 0 if self.ticks is None else self.ticks):
            if not hasattr(number, "__index__"):
                raise ModelError(f"a fault's at and ticks count steps: {number!r} is no whole number")
        if self.onset not in ONSETS:
            raise ModelError(f"fault onset {self.onset!r}; it is one of: {', '.join(ONSETS)}")
        if self.onset == TRANSIENT and (self.ticks is None or self.ticks < 1):
            raise ModelError("a transient fault needs its greatest length: Fault(..., onset=TRANSIENT, ticks=n)")
        if self.onset == INTERMITTENT and self.ticks is not None and self.ticks < 1:
            raise ModelError(f"an intermittent fault with ticks={self.ticks} never acts; give 1 or more, or none")
        if self.at < 0:
            raise ModelError(f"a fault begins at step 0 or later: at={self.at} is before power-up; choose another `at`")
        if self.onset == FROM_START and self.at:
            raise ModelError(
                f"a fault with at={self.at} is not there from the start: write onset=ANY_TIME or TRANSIENT"
            )
        if self.ticks is not None and self.onset in (FROM_START, ANY_TIME):
            raise ModelError(
                f"a fault {self.onset} stays for ever; ticks={self.ticks} is for TRANSIENT or INTERMITTENT"
            )
        if isinstance(self.points, str):
            object.__setattr__(self, "points", [self.points])
        if not self.name:
            object.__setattr__(self, "name", f"{'+'.join(self.points)} {self.kind}")

    def __str__(self) -> str:
        return self.name if self.onset == FROM_START else f"{self.name}, {self.onset}"

    def window(self) -> tuple[int, int | None]:
        """Steps at which the fault acts in a run: from the first to before the second (None: to the end)."""
        return self.at, None if self.ticks is None else self.at + self.ticks

    def acts(self, step: int) -> bool:
        """Whether the fault acts at a step of a run."""
        first, end = self.window()
        return first <= step and (end is None or step < end)


def common_cause(
    name: str,
    members: Mapping[str, Kind],
    *,
    onset: str = FROM_START,
    at: int = 0,
    ticks: int | None = None,
    values: Mapping[str, Sequence[Any]] | None = None,
) -> Fault:
    """One cause at several places, each with a kind of its own: present, beginning and ending together.

        common_cause("supply of a", {"a": power_dip(), "a.out.*": open_circuit()}, onset=TRANSIENT, ticks=5)

    A key is a point, a pattern, or a part for a kind of parts; several points of a kind that joins them are written as
    one key, `"a.x+a.y"`.  Source of the term: IEC 61508-4:2010, 3.6.10.  Raises `ModelError` for an empty group.
    """
    if not members or not all(isinstance(kind, Kind) for kind in members.values()):
        raise ModelError(f"common cause {name!r}: write common_cause(name, {{point: kind, ...}}), one member or more")
    kinds = "; ".join(f"{points}: {kind}" for points, kind in members.items())
    kind = Kind("common cause", f"all at once: {kinds}", members=tuple(members.items()))
    return Fault(kind, list(members), onset, at, ticks, name, values)

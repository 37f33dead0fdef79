"""Campaigns: which faults are injected into which model, under what stimulus, and how each run is judged.

A campaign is declared at the top level of a proofs file and registers itself.  It states the counts it expects, so a
changed result is a failure.  Time counts in frames of `steps_per_frame` model steps, in which inputs do not change;
wires are observed at the last step of a frame, counted from `run_in` on, in blocks of `block` frames.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from safety.inject.classes import CELLS, CLASSES, Judge
from safety.inject.lanes import Timing
from safety.inject.space import CampaignError, Faults, Group, Space, enumerate_space
from safety.model import Model
from safety.system import System, nearest, substitute
from safety.terms import Bit
from safety.terms.graph import BIT
from safety.terms.values import const
from safety.tracing import trace

if TYPE_CHECKING:
    from safety.inject.result import Result
    from safety.inject.running import Replay

Row = Mapping[str, Any]
Progress = Callable[[float, float], None]


def observed(name: str) -> str:
    """Name of the signal that carries an observed wire."""
    return f"observed {name}"


class Wires:
    """The signals of a system by full name, to observe something made of several of them."""

    def __init__(self, system: System) -> None:
        self._system = system

    def __getitem__(self, path: str) -> Any:
        return self._system.lookup(path)


@dataclass(eq=False, kw_only=True)
class Campaign:
    """A fault-injection campaign.

    `wrong_side`, `safe_side` and `detected` judge many runs side by side: from `Counts` to one truth value a run, by
    arithmetic, comparison, `&`, `|` and `~` only.  A run on both sides counts as wrong; what is neither wrong, safe
    nor detected has no effect.

    `faults`: groups, or a list or function of faults (then one group).  `stimulus`: inputs of a frame, fixed or by its
    number; `constant`: inputs that never change, folded into the model.  `observe`: a wire's name, or a function of all
    wires, for each name used in the judges.  `order` 2 injects pairs; `sample` draws so many with `seed`.  `expect`:
    counts of classes or of `direction/detected` cells.
    """

    id: str
    model: type[Model] | System
    faults: Sequence[Group] | Faults | Sequence[Any]
    observe: Mapping[str, str | Callable[[Wires], Bit]]
    wrong_side: Judge
    detected: Judge
    measured: int
    safe_side: Judge | None = None
    stimulus: Row | Callable[[int], Row] = field(default_factory=dict)
    constant: Row = field(default_factory=dict)
    settings: Row = field(default_factory=dict)
    start: Row = field(default_factory=dict)
    run_in: int = 0
    block: int | None = None
    steps_per_frame: int = 1
    order: int = 1
    sample: int | None = None
    seed: int = 0
    confidence: float = 0.99
    expect: Mapping[str, int] | None = None
    module: str = ""

    def __post_init__(self) -> None:
        self.module = self.module or sys._getframe(2).f_globals.get("__name__", "")
        block = self.measured if self.block is None else self.block
        if self.measured < 1 or block < 1 or self.measured % block:
            raise CampaignError(
                f"{self.id}: {self.measured} measured frames do not divide into blocks of {block}; choose a multiple"
            )
        if self.run_in < 0 or self.steps_per_frame < 1:
            raise CampaignError(
                f"{self.id}: run_in={self.run_in}, steps_per_frame={self.steps_per_frame}; they start at 0 and at 1"
            )
        self.timing = Timing(self.run_in, self.measured, block, self.steps_per_frame)
        for name in (n for row in (self.expect, *(g.expect for g in self._groups())) for n in row or ()):
            if name not in (*CLASSES, *CELLS):
                raise CampaignError(f"{self.id}: expect names {name!r}; {nearest(name, (*CLASSES, *CELLS))}")
        register(self)

    def _groups(self) -> list[Group]:
        if callable(self.faults):
            return [Group("faults", self.faults)]
        listed = list(self.faults)
        groups = [item for item in listed if isinstance(item, Group)]
        if groups and len(groups) != len(listed):
            raise CampaignError(
                f"{self.id}: faults are groups or faults, not both; put the single ones into a Group(...)"
            )
        return groups or [Group("faults", listed)]

    @cached_property
    def system(self) -> System:
        """The traced model with constant inputs folded in and the observed wires among its signals."""
        system = self.model if isinstance(self.model, System) else trace(self.model, self.settings)
        values: dict[int, Any] = {}
        for name, value in self.constant.items():
            if name not in system.inputs:
                raise CampaignError(f"{self.id}: {system.name} has no input {name!r}; {nearest(name, system.inputs)}")
            sort = system.inputs[name].sort
            if not sort.admits(value):
                raise CampaignError(f"{self.id}: input {name} is {sort}: {value!r} is not a value of it")
            values[system.inputs[name].uid] = const(value, sort)
        system = replace(system, inputs={n: t for n, t in system.inputs.items() if n not in self.constant})
        system = system.mapped(lambda roots: substitute(roots, values))
        wires = Wires(system)
        seen = {name: wires[w] if isinstance(w, str) else w(wires) for name, w in self.observe.items()}
        for name, wire in seen.items():
            if wire.sort != BIT:
                raise CampaignError(f"{self.id}: {name!r} observes a {wire.sort}; write a comparison or .bit(i)")
        return replace(system, signals={**system.signals, **{observed(name): wire for name, wire in seen.items()}})

    @cached_property
    def space(self) -> Space:
        """The injections.  Raises `ModelError` for an unknown point, `CampaignError` for an empty list."""
        return enumerate_space(self.system, self._groups(), order=self.order, sample=self.sample, seed=self.seed)

    def inputs(self, frame: int) -> Row:
        """The stimulus of a frame, checked.  Raises `CampaignError` for a name or value that does not fit."""
        row = self.stimulus(frame) if callable(self.stimulus) else self.stimulus
        inputs = self.system.inputs
        if row.keys() != inputs.keys():
            name = sorted(row.keys() ^ inputs.keys())[0]
            wrong = f"lacks the input {name}" if name in inputs else f"names {name!r}, which is no open input"
            raise CampaignError(f"{self.id}: frame {frame} {wrong}; the inputs are {', '.join(inputs) or 'none'}")
        for name, value in row.items():
            if not inputs[name].sort.admits(value):
                raise CampaignError(
                    f"{self.id}: frame {frame}: input {name} is {inputs[name].sort}: {value!r} is not a value of it"
                )
        return row

    @cached_property
    def healthy_counts(self) -> Mapping[str, Any]:
        """Counts of the fault-free run on the Python reading, by observed name; shape (blocks, 1)."""
        from safety.inject.running import healthy_counts

        return healthy_counts(self)

    def run(self, progress: Progress | None = None) -> dict[str, Any]:
        """Inject everything and return the entry of the results document; see `inject`."""
        return self.inject(progress).to_json()

    def inject(self, progress: Progress | None = None) -> Result:
        """Inject everything.

        `progress(share, seconds)` is called about twice a second.  Ctrl-C ends the campaign with the batches that are
        complete; the result then says so.  Raises `CampaignError` when the fault-free run is judged faulty.
        """
        from safety.inject.running import inject

        return inject(self, progress)

    def replay(self, injection: str | int | None, *, keep: Sequence[str] = ()) -> Replay:
        """Run one injection again on the Python reading, by id or position (None: fault-free).

        `keep` names signals to record besides the observed wires.  Raises `CampaignError` for an unknown injection.
        """
        from safety.inject.running import replay

        return replay(self, injection, keep)


_registry: dict[str, Campaign] = {}


def register(campaign: Campaign) -> None:
    """Enter a campaign; it takes the place of one with its id from the same module (a reload).

    Raises `CampaignError` when another module has a campaign of this id.
    """
    other = _registry.get(campaign.id)
    if other is not None and other.module != campaign.module:
        raise CampaignError(
            f"campaign {campaign.id!r} of {campaign.module} has the id of one of {other.module}; give it another"
        )
    _registry[campaign.id] = campaign


def campaigns() -> tuple[Campaign, ...]:
    """The campaigns declared so far, in order."""
    return tuple(_registry.values())

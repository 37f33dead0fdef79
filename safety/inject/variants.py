"""The model and stimulus of a campaign with constants folded in: one, or as many as scenarios are drawn.

    vary={"wheel": Uniform(780, 880), "speed": lambda pick: profile(pick.uniform(0, 70))}, scenarios=20, seed=1

What is named is an input, a setting of the model, or a register that has no value at power-up.  An input that is drawn
is constant in its scenario, or follows the function of the frame that was drawn for it.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from safety.inject.engine import Task
from safety.inject.monitors import observed, observing
from safety.inject.space import CampaignError
from safety.system import ANY, System, nearest, substitute
from safety.terms.values import const
from safety.tracing import trace

if TYPE_CHECKING:
    from safety.inject.campaign import Campaign

Row = Mapping[str, Any]


@dataclass(frozen=True)
class Uniform:
    """A value between two bounds, both included: a whole number where these are, else in 10^6 equal steps."""

    low: int | Fraction
    high: int | Fraction

    def __call__(self, pick: random.Random) -> int | Fraction:
        """Draw one."""
        if isinstance(self.low, int) and isinstance(self.high, int):
            return pick.randint(self.low, self.high)
        return self.low + (self.high - self.low) * Fraction(pick.randint(0, 10**6), 10**6)


@dataclass(frozen=True)
class Choice:
    """One of some values, each as likely."""

    values: Sequence[Any]

    def __call__(self, pick: random.Random) -> Any:
        """Draw one."""
        return pick.choice(self.values)


Draw = Callable[[random.Random], Any]


@dataclass(frozen=True)
class Variant:
    """A system with its constants folded in, its stimulus by frame, power-up values, and what was drawn for it."""

    campaign: Campaign
    system: System
    stimulus: Row | Callable[[int], Row]
    following: Mapping[str, Callable[[int], Any]]
    start: Row
    values: Row

    def inputs(self, frame: int) -> Row:
        """The stimulus of a frame, checked.  Raises `CampaignError` for a name or value that does not fit."""
        row = self.stimulus(frame) if callable(self.stimulus) else self.stimulus
        if self.values:
            row = {name: value for name, value in row.items() if name not in self.values}
            row |= {name: value(frame) for name, value in self.following.items()}
        inputs, name = self.system.inputs, self.campaign.id
        if row.keys() != inputs.keys():
            other = sorted(row.keys() ^ inputs.keys())[0]
            wrong = f"lacks the input {other}" if other in inputs else f"names {other!r}, which is no open input"
            raise CampaignError(f"{name}: frame {frame} {wrong}; the inputs are {', '.join(inputs) or 'none'}")
        for path, value in row.items():
            if not inputs[path].sort.admits(value):
                raise CampaignError(
                    f"{name}: frame {frame}: input {path} is {inputs[path].sort}: {value!r} is not a value of it"
                )
        return row

    @property
    def told(self) -> dict[str, Any]:
        """What was drawn, for results: numbers as they are, fractions as `p/q`, functions by name."""
        plain = {name: getattr(v, "__name__", v) if callable(v) else v for name, v in self.values.items()}
        return {name: v if isinstance(v, bool | int | str) else str(v) for name, v in plain.items()}

    @property
    def task(self) -> Task:
        """What an engine is asked."""
        campaign = self.campaign
        return Task(
            self.system,
            campaign.space.singles,
            tuple(map(observed, campaign.observe)),
            tuple(map(observed, campaign.watched)),
            campaign.timing,
            self.inputs,
            self.start,
        )


def variant(campaign: Campaign, number: int) -> Variant:
    """The scenario of a number; what it draws depends on the campaign's seed and this number only.

    Raises `CampaignError` for a name that nothing has, or a value that does not fit.
    """
    pick = random.Random(f"{campaign.seed} {number}")
    values = {name: draw(pick) for name, draw in campaign.vary.items()}
    model = campaign.model
    settings = {} if isinstance(model, System) else trace(model, campaign.settings).settings if values else {}
    drawn_settings = {name: value for name, value in values.items() if name in settings}
    system = model if isinstance(model, System) else trace(model, {**campaign.settings, **drawn_settings})
    start = {name: v for name, v in values.items() if name in system.state and system.state[name].power_up is ANY}
    following = {name: value for name, value in values.items() if name in system.inputs and callable(value)}
    constant = {**campaign.constant, **{n: v for n, v in values.items() if n in system.inputs and n not in following}}
    for name in values:
        if name not in (*drawn_settings, *start, *following, *constant):
            known = (*system.inputs, *settings, *(s.path for s in system.states if s.power_up is ANY))
            raise CampaignError(f"{campaign.id}: vary names {name!r}; {nearest(name, known)}")
    try:
        whole = _folded(observing(system, campaign.looked_at, campaign.steps_per_frame), constant)
    except CampaignError as wrong:
        raise CampaignError(f"{campaign.id}: {wrong}") from None
    return Variant(campaign, whole, campaign.stimulus, following, {**campaign.start, **start}, values)


def _folded(system: System, constant: Row) -> System:
    """The system without the inputs that are constant."""
    values: dict[int, Any] = {}
    for name, value in constant.items():
        if name not in system.inputs:
            raise CampaignError(f"{system.name} has no input {name!r}; {nearest(name, system.inputs)}")
        sort = system.inputs[name].sort
        if not sort.admits(value):
            raise CampaignError(f"input {name} is {sort}: {value!r} is not a value of it")
        values[system.inputs[name].uid] = const(value, sort)
    system = replace(system, inputs={n: t for n, t in system.inputs.items() if n not in constant})
    return system.mapped(lambda roots: substitute(roots, values))

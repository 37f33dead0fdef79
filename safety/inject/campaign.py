"""Campaigns: which faults are injected into which model, under what stimulus, and how each run is judged.

A campaign is declared at the top level of a proofs file and registers itself.  It states the counts it expects, so a
changed result is a failure.  Time counts in frames of `steps_per_frame` model steps, in which inputs do not change;
wires are observed at the last step of a frame, counted from `run_in` on, in blocks of `block` frames.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

from safety.inject.classes import CELLS, CLASSES, Judge
from safety.inject.engine import AUTO, ENGINES, NEVER, Engine, Outcome, Timing, engine_for
from safety.inject.enumeration import enumerate_space
from safety.inject.fmeda import check_rates
from safety.inject.judging import HAZARD, SAFE, Judged, detector, judged
from safety.inject.monitors import Watched
from safety.inject.space import CampaignError, Faults, Group, Injection, Space, check_schedule, identify, window
from safety.inject.variants import Draw, Row, Variant, variant
from safety.model import Model
from safety.system import System, nearest

if TYPE_CHECKING:
    from safety.inject.collapse import Collapse
    from safety.inject.result import Result
    from safety.inject.running import Replay

Progress = Callable[[float, float], None]


@dataclass(eq=False, kw_only=True)
class Campaign:
    """A fault-injection campaign.

    What is injected: `faults`, groups, or a list or function of faults (then one group), each with its own schedule, or
    at all `onsets` (model steps) for `length` steps (None: it stays); singly, or in all pairs or triples (`order`).
    `sample` draws so many (or so many of each group) with `seed`.

    When: the first `run_in` frames pass unjudged, so what a fault does only then is not seen: one that has ended by
    then counts only by what it leaves behind.

    Under what: `stimulus`, inputs of a frame, fixed or by its number; `constant`, inputs that never change, folded into
    the model; `vary`, inputs, settings or open registers by how each is drawn, anew for each of the `scenarios`.

    How it is judged, by one of two forms.  By wires (a name, or a function of all `Wires`): dangerous when `hazard`
    comes, detected when one of the `detectors` (by label) comes no later than the hazard, safe when `safe` comes; all
    in the measured frames.  Or by functions: `wrong_side`, `safe_side` and `detected` judge many runs side by side,
    from `Counts` of what they `observe` and `watch` to one truth value a run, by arithmetic, comparison, `&`, `|` and
    `~` only.  A run on both sides counts as wrong; what is neither wrong, safe nor detected has no effect.

    `expect`: counts of classes or of `direction/detected` cells.  `engine`: "auto", "native" or "lanes".  Faults that
    come to the same by construction are run once (`collapsing`); `audit` runs all and compares.  `target_coverage`:
    what the lower bound of the diagnostic coverage has to reach, exact, e.g. "9/10" or "0.9".  `proofs`: claims and
    hazards whose violation the wrong side is; the single faults that they cover are closed by proof (`safety.closure`).
    """

    id: str
    model: type[Model] | System
    faults: Sequence[Group] | Faults | Sequence[Any]
    measured: int
    hazard: Watched | None = None
    detectors: Mapping[str, Watched] = field(default_factory=dict)
    safe: Watched | None = None
    observe: Mapping[str, Watched] = field(default_factory=dict)
    watch: Mapping[str, Watched] = field(default_factory=dict)
    wrong_side: Judge | None = None
    detected: Judge | None = None
    safe_side: Judge | None = None
    stimulus: Row | Callable[[int], Row] = field(default_factory=dict)
    constant: Row = field(default_factory=dict)
    settings: Row = field(default_factory=dict)
    start: Row = field(default_factory=dict)
    vary: Mapping[str, Draw] = field(default_factory=dict)
    scenarios: int = 1
    run_in: int = 0
    block: int | None = None
    steps_per_frame: int = 1
    order: int = 1
    onsets: range | None = None
    length: int | None = None
    sample: int | Mapping[str, int] | None = None
    seed: int = 0
    confidence: float = 0.99
    expect: Mapping[str, int] | None = None
    engine: str = AUTO
    collapsing: bool = True
    audit: bool = False
    target_coverage: Fraction | str | None = None
    proofs: Sequence[Callable[..., Any]] = ()
    module: str = ""

    def __post_init__(self) -> None:
        caller = sys._getframe(2)
        while caller.f_globals.get("__name__") == "dataclasses" and caller.f_back:  # made by `replace`
            caller = caller.f_back
        self.module = self.module or caller.f_globals.get("__name__", "")
        self.place = caller.f_code.co_filename, caller.f_lineno  # where it is declared
        if self.target_coverage is not None:
            self.target_coverage = exact_share(self.target_coverage, f"{self.id}: target_coverage")
        for name in ("measured", "run_in", "block", "steps_per_frame", "scenarios", "order"):
            value = getattr(self, name)
            if type(value) is not int and not (name == "block" and value is None):
                raise CampaignError(f"{self.id}: {name}={value!r} is no whole number")
        if not 0 < self.confidence < 1:
            raise CampaignError(f"{self.id}: confidence={self.confidence!r} lies between 0 and 1, e.g. 0.99")
        block = self.measured if self.block is None else self.block
        if self.measured < 1 or block < 1 or self.measured % block:
            raise CampaignError(
                f"{self.id}: {self.measured} measured frames do not divide into blocks of {block}; choose a multiple"
            )
        if self.run_in < 0 or self.steps_per_frame < 1:
            raise CampaignError(
                f"{self.id}: run_in={self.run_in}, steps_per_frame={self.steps_per_frame}; they start at 0 and at 1"
            )
        if self.scenarios < 1 or (self.scenarios > 1 and not self.vary):
            raise CampaignError(f"{self.id}: scenarios={self.scenarios} goes with vary, which says what is drawn")
        if self.engine not in ENGINES:
            raise CampaignError(f"{self.id}: engine={self.engine!r}; {nearest(self.engine, ENGINES)}")
        self._check_form()
        self.timing = Timing(self.run_in, self.measured, block, self.steps_per_frame)
        for name in (n for row in (self.expect, *(g.expect for g in self._groups())) for n in row or ()):
            if name not in (*CLASSES, *CELLS):
                raise CampaignError(f"{self.id}: expect names {name!r}; {nearest(name, (*CLASSES, *CELLS))}")
        self._engines: dict[int, Engine] = {}
        self.tick: Callable[[float], None] = lambda share: None  # told how much of a batch is done
        register(self)

    def _check_form(self) -> None:
        by_wires = {"hazard": self.hazard, "detectors": self.detectors or None, "safe": self.safe}
        by_functions = {"wrong_side": self.wrong_side, "detected": self.detected, "safe_side": self.safe_side}
        given = [[n for n, v in form.items() if v is not None] for form in (by_wires, by_functions)]
        if given[0] and given[1]:
            raise CampaignError(f"{self.id}: {given[0][0]} and {given[1][0]} are two forms of judging; choose one")
        if self.hazard is None and (self.wrong_side is None or self.detected is None):
            raise CampaignError(f"{self.id}: say when a run is dangerous: hazard=..., or wrong_side= and detected=")
        if self.hazard is not None and len(self.detectors) > 200:
            raise CampaignError(f"{self.id}: {len(self.detectors)} detectors; join some, 200 can be told apart")
        if any(not label.strip() for label in self.detectors):
            raise CampaignError(f"{self.id}: a detector's label is empty; results tell by it who detects: name it")

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

    # --- what is run -------------------------------------------------------------------------------------------------

    @cached_property
    def watched(self) -> Mapping[str, Watched]:
        """Wires whose first true frame is asked for, by name."""
        found = dict(self.watch)
        if self.hazard is not None:
            found |= {HAZARD: self.hazard} | {detector(label): wire for label, wire in self.detectors.items()}
        return found | ({} if self.safe is None else {SAFE: self.safe})

    @cached_property
    def looked_at(self) -> Mapping[str, Watched]:
        """All wires that are counted or watched, by name; raises `CampaignError` where one name stands for two."""
        for name in self.observe.keys() & self.watched.keys():
            if self.observe[name] is not self.watched[name]:
                raise CampaignError(f"{self.id}: {name!r} names two wires; give one of them another name")
        return {**self.observe, **self.watched}

    @property
    def system(self) -> System:
        """The traced model with constant inputs folded in and what is looked at among its signals."""
        return self.variant(0).system

    def variant(self, scenario: int) -> Variant:
        """The system and stimulus of a scenario; there is one, number 0, unless some are drawn."""
        if scenario not in self._variants:
            self._variants[scenario] = variant(self, scenario)
        return self._variants[scenario]

    @cached_property
    def _variants(self) -> dict[int, Variant]:
        return {}

    def inputs(self, frame: int) -> Row:
        """The stimulus of a frame, checked; see `Variant.inputs`."""
        return self.variant(0).inputs(frame)

    @cached_property
    def space(self) -> Space:
        """The injections.

        Raises `ModelError` for an unknown point, `CampaignError` for what cannot be injected, and for failure rates of
        some groups only or a sample without a rated one.
        """
        space = enumerate_space(
            self.system, self._groups(), order=self.order, onsets=self.onsets, length=self.length,
            scenarios=self.scenarios, sample=self.sample, seed=self.seed,
        )  # fmt: skip
        for fault in space.singles:
            if self.steps_per_frame > 1 and fault.values:
                raise CampaignError(
                    f"fault {fault.name!r} has values step by step, but steps_per_frame={self.steps_per_frame} holds "
                    "them for a frame; use steps_per_frame=1"
                )
            if self.onsets is None:
                check_schedule(identify(fault), *window(fault), self.timing)
        for step in self.onsets or ():
            end = NEVER if self.length is None else step + self.length
            check_schedule(space.singles[0].name, step, end, self.timing)
        check_rates(space, self.id)
        return space

    def collapse(self, scenario: int = 0) -> Collapse:
        """Which single faults come to the same in a scenario.  Raises `ModelError` for a kind that does not fit."""
        if scenario not in self._collapses:
            from safety.inject.collapse import collapse

            task = self.variant(scenario).task
            self._collapses[scenario] = collapse(task.system, task.atoms, (*task.count, *task.watch))
        return self._collapses[scenario]

    @cached_property
    def _collapses(self) -> dict[int, Collapse]:
        return {}

    def engine_of(self, scenario: int = 0) -> Engine:
        """What runs the injections of a scenario; the last one asked for is kept."""
        if scenario not in self._engines:
            self._engines = {scenario: engine_for(self.variant(scenario).task, self.engine)}
        return self._engines[scenario]

    @property
    def engine_used(self) -> str | None:
        """Name of the engine that ran last in this process; None where none did."""
        return next((engine.name for engine in self._engines.values()), None)

    @property
    def engine_note(self) -> str:
        """Why that is not the native one, or how many runs with reals it left to exact lanes, or nothing."""
        return next((engine.note for engine in self._engines.values()), "")

    # --- doing it ----------------------------------------------------------------------------------------------------

    def judged(self, low: int, high: int) -> Judged:
        """How the injections numbered `low` to `high` (not included) come out.

        The whole campaign is the concatenation of its ranges, whatever they are and whoever runs them.  Raises
        `CampaignError` when the fault-free run is judged faulty.
        """
        return judged(self, low, high)

    @cached_property
    def healthy(self) -> Outcome:
        """What is seen of the fault-free run on the Python reading."""
        from safety.inject.running import healthy

        return healthy(self)

    def run(self, progress: Progress | None = None) -> dict[str, Any]:
        """Inject everything and return the entry of the results document; see `inject`."""
        return self.inject(progress).to_json()

    def inject(self, progress: Progress | None = None) -> Result:
        """Inject everything.

        `progress(share, seconds)` is called about twice a second.  Ctrl-C ends the campaign with the ranges that are
        complete; the result then says so.  Raises `CampaignError` when the fault-free run is judged faulty.
        """
        from safety.inject.running import inject

        return inject(self, progress)

    def replay(self, injection: str | int | Injection | None, *, keep: Sequence[str] = ()) -> Replay:
        """Run one injection again on the Python reading: by id or number, any other one as it is (None: fault-free).

        `keep` names signals to record besides the observed wires.  Raises `CampaignError` for an unknown injection.
        """
        from safety.inject.running import replay

        return replay(self, injection, keep)


def exact_share(value: Fraction | str, what: str) -> Fraction:
    """A share of 0 to 1 as it is written.  Raises `CampaignError`, which begins with `what`, for anything else."""
    try:
        found = Fraction(-1) if isinstance(value, float) else Fraction(value)
    except (ValueError, ZeroDivisionError):
        found = Fraction(-1)
    if not 0 <= found <= 1:
        raise CampaignError(f"{what} is {value!r}; write a share from 0 to 1 in quotes, e.g. '0.9' or '9/10'")
    return found


_registry: dict[str, Campaign] = {}


def changed(campaign: Campaign, **changes: Any) -> Campaign:
    """The campaign with some fields changed, for a run beside it; what the files declare under its id stays so."""
    other = replace(campaign, **changes)
    other.place = campaign.place
    register(campaign)
    return other


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

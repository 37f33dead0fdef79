"""A traced model: states with power-up values, inputs, named signals, clock and assumptions, as terms.

Every reading of a model starts here.  Faults, monitors and repetition each turn one system into another, so whatever
can be done to a system can be done to all of them.
"""

from __future__ import annotations

import difflib
import functools
import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from safety.terms import Bit
from safety.terms.graph import Term, rewrite, variable
from safety.terms.values import bit, build


class ModelError(TypeError):
    """A model is written or used wrongly; the message names the signal and what to write instead."""

    exit_code = 2


class _Any:
    """The power-up value that may be anything."""

    def __repr__(self) -> str:
        return "ANY"

    def __reduce__(self) -> str:
        return "ANY"  # a copy, or one from another process, is the one


ANY = _Any()
OUTPUT = " (output)"  # added to the name of an output that an input has too
PowerUpValue = bool | int | Fraction | _Any


@dataclass(frozen=True)
class Clock:
    """When a step happens: every `period` seconds, or at each `event`."""

    period: Fraction | None = None
    event: str | None = None

    def __str__(self) -> str:
        if self.period is None:
            return f"at each {self.event}"
        return f"every {float(self.period * 1_000_000):g} us"


@dataclass(frozen=True)
class Pace:
    """A clock whose period follows from parameters: `seconds` takes them by bare name.

    Its defaults stand for parameters that a model does not have.
    """

    seconds: Callable[..., Any]

    @property
    def names(self) -> tuple[str, ...]:
        """Bare names of the parameters."""
        return tuple(inspect.signature(self.seconds).parameters)

    def clock(self, whole: str, values: Mapping[str, Mapping[str, Any]]) -> Clock:
        """The clock of a model whose parameters, by bare name and then full name, have these values; None: left open.

        Raises `ModelError` where the values of two parts disagree, or no period comes of them.
        """
        for of in values.values():
            if len(set(of.values())) > 1:
                told = " and ".join(f"{path} = {value}" for path, value in of.items())
                raise ModelError(f"{whole}: {told}: steps of different length; one system has one clock")
        given = {name: next(iter(of.values())) for name, of in values.items()}
        left = [name for name, value in given.items() if value is None]
        if left:
            return Clock(event=f"step, whose length follows from {', '.join(left)}")
        period = self.seconds(**given)
        if type(period) is not Fraction or period <= 0:
            raise ModelError(
                f"{whole}: tick_s={self} gives {period!r} for {given}; a period is a Fraction of seconds, above 0"
            )
        return Clock(period)

    def __str__(self) -> str:
        return f"{self.seconds.__name__}({', '.join(self.names)})"


@dataclass(frozen=True, eq=False)
class State:
    """One register: its variable, the term of its next value, and what it holds at power-up."""

    var: Term
    next: Term
    power_up: PowerUpValue

    @property
    def path(self) -> str:
        """Full name, e.g. `a.acc`."""
        return str(self.var.attr)

    def __eq__(self, other: object) -> bool:
        same = isinstance(other, State) and self.var is other.var and self.next is other.next
        return same and self.power_up == other.power_up  # type: ignore[attr-defined]

    def __hash__(self) -> int:
        return hash((self.var, self.next))


@dataclass(frozen=True)
class Setting:
    """A parameter as used: value (None when left symbolic), unit, admissible range, source with its tag, default."""

    path: str
    value: Any
    unit: str
    low: Any
    high: Any
    source: str
    default: Any = None

    @property
    def tag(self) -> str:
        """P printed, D derived, A assumed, R reconstructed."""
        return self.source[1]


@dataclass(frozen=True)
class System:
    """A traced model.  Terms read the variables of `states` and `inputs` only.

    `start` restricts the power-up state, `assumptions` (label to bit) every step.  `signals` are the outputs of the
    model and of its parts, `points` the places where a fault can act; both by full name.
    """

    name: str
    clock: Clock
    states: tuple[State, ...]
    inputs: Mapping[str, Term]
    signals: Mapping[str, Term]
    points: Mapping[str, Term]
    settings: Mapping[str, Setting]
    parts: Mapping[str, str]
    assumptions: Mapping[str, Term] = field(default_factory=dict)
    start: Bit = field(default_factory=lambda: bit(True))

    def __post_init__(self) -> None:
        taken: set[str] = set()
        for path in (*(s.path for s in self.states), *self.inputs):
            if path in taken:  # one variable would have to obey two laws
                raise ModelError(f"{self.name}: two registers or inputs are called {path!r}; give one another name")
            taken.add(path)
        for path in self.signals:
            if path in taken:
                kind = "a register" if path in self.state else "an input"
                raise ModelError(f"{self.name}: output {path!r} has the name of {kind}; give it another")

    @functools.cached_property
    def state(self) -> Mapping[str, State]:
        """Registers by full name."""
        return {s.path: s for s in self.states}

    def roots(self) -> list[Term]:
        """Every term that the system consists of."""
        nexts = (s.next for s in self.states)
        return [*nexts, *self.signals.values(), *self.points.values(), *self.assumptions.values()]

    def mapped(self, change: Callable[[list[Term]], list[Term]]) -> System:
        """The system with all its terms replaced in one go."""
        new = iter(change(self.roots()))
        return replace(
            self,
            states=tuple(replace(s, next=next(new)) for s in self.states),
            signals={name: next(new) for name in self.signals},
            points={name: next(new) for name in self.points},
            assumptions={name: next(new) for name in self.assumptions},
        )

    def lookup(self, path: str) -> Term:
        """The term of a full name: a signal, else a point, an input, a register.

        Raises `ModelError` with the nearest names when there is none.
        """
        for table in (self.signals, self.state, self.inputs, self.points):
            if path in table:
                found = table[path]
                return found.var if isinstance(found, State) else found
        raise ModelError(f"{self.name} has no signal {path!r}; {nearest(path, self.names())}")

    def names(self) -> list[str]:
        """All full names."""
        return sorted({*self.signals, *self.points, *self.inputs, *self.state})


def nearest(name: str, names: Iterable[str]) -> str:
    """`did you mean ...` or `there is ...`, for messages."""
    names = sorted(names)
    close = difflib.get_close_matches(name, names, n=3, cutoff=0.5)
    if close:
        return "did you mean " + " or ".join(close) + "?"
    return "there is " + (", ".join(names[:12]) + (", ..." if len(names) > 12 else "") if names else "none")


def substitute(terms: Iterable[Term], mapping: Mapping[int, Term]) -> list[Term]:
    """The terms with variables (by uid) replaced, rebuilt and folded."""

    def rule(old: Term, args: tuple[Term, ...]) -> Term:
        if old.uid in mapping:
            return mapping[old.uid]
        if not old.args:
            return old
        return build(old.op, args, old.attr, old.sort)

    return rewrite(terms, rule)


def substeps(system: System, steps: int, free: Iterable[str] = ()) -> list[dict[int, Term]]:
    """For each of `steps` steps taken in a row, what stands for each variable: registers by what they then hold.

    Inputs are held, except those named in `free`: they are chosen anew at each step (the last keeps the bare name).
    """
    if steps < 1:
        raise ModelError(f"{system.name}: {steps} steps as one; write 1 or more")
    maps: list[dict[int, Term]] = []
    held = {s.var.uid: s.var for s in system.states}
    for k in range(steps):
        if k:
            following = substitute([s.next for s in system.states], maps[-1])
            held = {s.var.uid: term for s, term in zip(system.states, following, strict=True)}
        last = k == steps - 1
        fresh = {name: system.inputs[name] for name in free if not last}
        maps.append(held | {v.uid: variable(substep_name(name, k), v.sort) for name, v in fresh.items()})
    return maps


def substep_name(name: str, k: int) -> str:
    """The name of an input or assumption at a step before the last of those taken as one."""
    return f"{name} (step {k})"


def repeat(system: System, steps: int, free: Iterable[str] = ()) -> System:
    """`steps` steps as one, the inputs held (but those in `free` chosen anew at each); assumptions hold in each.

    Signals and points are those of the last step.  The clock's period grows accordingly.
    """
    *before, last = substeps(system, steps, free)
    assumed = list(system.assumptions.values())
    assumptions: dict[str, Term] = {}
    inputs = dict(system.inputs)
    for k, held in enumerate(before):
        names = [substep_name(label, k) for label in system.assumptions]
        assumptions |= dict(zip(names, substitute(assumed, held), strict=True))
        inputs |= {substep_name(name, k): held[system.inputs[name].uid] for name in free}
    whole = system.mapped(lambda terms: substitute(terms, last))
    clock = system.clock
    period = clock.period * steps if clock.period else None
    clock = Clock(period, f"{steps} x {clock.event}" if clock.event and steps > 1 else clock.event)
    return replace(whole, clock=clock, inputs=inputs, assumptions=assumptions | dict(whole.assumptions))

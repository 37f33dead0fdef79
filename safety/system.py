"""A traced model: states with power-up values, inputs, named signals, clock and assumptions, as terms.

Every reading of a model starts here.  Faults, monitors and repetition each turn one system into another, so whatever
can be done to a system can be done to all of them.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from safety.terms import Bit
from safety.terms.graph import Term, rewrite
from safety.terms.values import bit, build


class ModelError(TypeError):
    """A model is written or used wrongly; the message names the signal and what to write instead."""

    exit_code = 2


class _Any:
    """The power-up value that may be anything."""

    def __repr__(self) -> str:
        return "ANY"


ANY = _Any()
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
class State:
    """One register: its variable, the term of its next value, and what it holds at power-up."""

    var: Term
    next: Term
    power_up: PowerUpValue

    @property
    def path(self) -> str:
        """Full name, e.g. `a.acc`."""
        return str(self.var.attr)


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

    @property
    def state(self) -> Mapping[str, State]:
        """Registers by full name."""
        return {s.path: s for s in self.states}

    def roots(self) -> list[Term]:
        """Every term that the system consists of."""
        return [*(s.next for s in self.states), *self.signals.values(), *self.points.values(), *self.assumptions.values()]

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


def repeat(system: System, steps: int) -> System:
    """`steps` steps as one, the inputs held; signals and points are those of the last step, assumptions hold in each.

    The clock's period grows accordingly.
    """
    held = {s.var.uid: s.var for s in system.states}
    assumptions: dict[str, Term] = {}
    roots = [*(s.next for s in system.states), *system.assumptions.values()]
    for k in range(steps - 1):
        new = substitute(roots, held)
        held = {s.var.uid: t for s, t in zip(system.states, new, strict=False)}
        assumptions |= {f"{name} (step {k})": t for name, t in zip(system.assumptions, new[len(system.states) :], strict=True)}
    last = system.mapped(lambda terms: substitute(terms, held))
    period = system.clock.period
    clock = Clock(period * steps if period else None, f"{steps} x {system.clock.event}" if system.clock.event else None)
    return replace(last, clock=clock, assumptions=assumptions | dict(last.assumptions))



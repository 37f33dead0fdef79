"""What a trace collects while `step` runs, and how a model speaks to it: `point`, `assume`, `require`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any, TypeVar, cast

from safety.system import ModelError, Setting, State
from safety.terms import Bit, Int, Real, Term, UInt
from safety.terms.graph import describe, node, variables

AnyTerm = TypeVar("AnyTerm", Bit, UInt, Int, Real)


@dataclass
class Scope:
    """What a trace collects while `step` runs."""

    root: str
    settings: Mapping[str, Any]
    symbolic: frozenset[str]
    direct: bool = False
    path: str = ""
    signals: dict[str, Term] = field(default_factory=dict)
    points: dict[str, Term] = field(default_factory=dict)
    used: dict[str, Setting] = field(default_factory=dict)
    rigid: dict[str, State] = field(default_factory=dict)
    parts: dict[str, str] = field(default_factory=dict)
    assumptions: dict[str, Term] = field(default_factory=dict)
    start: list[Bit] = field(default_factory=list)
    stepped: set[str] = field(default_factory=set)

    @contextmanager
    def within(self, path: str) -> Iterator[None]:
        """While the part of a path takes its step."""
        before, self.path = self.path, path
        try:
            yield
        finally:
            self.path = before


current: ContextVar[Scope | None] = ContextVar("scope", default=None)


def point(name: str, value: AnyTerm) -> AnyTerm:
    """Name a place where a fault can act; healthy it is `value`.  The full name takes the path of the part.

    Raises `ModelError` when the name is used twice in one step, or the value is no term.
    """
    scope = current.get()
    if not isinstance(value, Term):
        raise ModelError(
            f"point {name!r} is given {value!r}; a fault acts on a term: write bit(...), word(...) or real(...)"
        )
    if scope is None:
        return value
    full = scope.path + name
    if full in scope.points:
        raise ModelError(f"point {full!r} is named twice in one step; give the second one a name of its own")
    named = value if scope.direct else node("point", (value,), full, value.sort)
    scope.points[full] = named
    return cast(AnyTerm, named)


def assume(label: str, condition: Bit) -> None:
    """State what the surroundings guarantee at every step; it is shown in each result and checked in each run.

    Raises `ModelError` when two assumptions of a step share a label, or the condition is no bit.
    """
    scope = current.get()
    if not isinstance(condition, Bit):
        raise ModelError(f"assume({label!r}) is given {condition!r}; an assumption is a bit, e.g. a comparison")
    if scope is None:
        return
    full = scope.path + label
    if full in scope.assumptions:
        raise ModelError(f"{full!r} is assumed twice in one step; give the second assumption a text of its own")
    scope.assumptions[full] = condition


def require(label: str, condition: Bit, nearest: str | Callable[[], str]) -> None:
    """State what parameters have to fulfil together; `nearest` says which admissible values are next.

    With parameters that are set, the model is refused where the condition is false (`ModelError`); where one is left
    open, the condition is assumed of it and shown in each result.
    Raises `ModelError` for a condition that is no bit, or reads more than parameters.
    """
    if not isinstance(condition, Bit):
        raise ModelError(f"require({label!r}) is given {condition!r}; a requirement is a bit, e.g. a comparison")
    scope = current.get()
    place = scope.path if scope else ""
    if condition.is_const:
        if not condition.attr:
            raise ModelError(
                f"{place}{label}: not with these parameters; {nearest if isinstance(nearest, str) else nearest()}"
            )
        return
    open_ones = {s.var.uid for s in scope.rigid.values()} if scope else set()
    moving = next((v for v in variables([condition]) if v.uid not in open_ones), None)
    if moving is not None:
        raise ModelError(f"require({label!r}) reads {describe(moving)}, which is no parameter; use assume for inputs")
    assume(label, condition)

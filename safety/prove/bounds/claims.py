"""Bounds as claims of a proof file, worked out by `rightside prove` and `verify` like any other.

    error = error_of_limit(90)
    within = claim_bound(error, Fraction("0.593"), expect=PROVED)
    claim_bound(error, Fraction("0.592"), id="ts7_accuracy.too_tight", expect=REFUTED, twin_of=within)
    claim_bracket(error, id="ts7_accuracy.least_upper_bound")

A certificate of kind "real" names the two routes that agree, a solver and the boxes with exact ends: neither leaves a
proof that could be checked bit by bit, as those of claims about models can.  A refutation is an exact point.
"""

from __future__ import annotations

import sys
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from types import FrameType
from typing import TYPE_CHECKING, Any, TypeVar

from safety.prove.bounds.replay import holds, read
from safety.prove.bounds.statement import WIDTH, Bound, Exact, Stated
from safety.prove.claims import PROVED, REFUTED, UNDECIDED, VACUOUS, Claim
from safety.system import Clock, ModelError, System
from safety.terms import Bit, bit
from safety.terms.graph import variables

if TYPE_CHECKING:
    from safety.prove.problem import Problem

R = TypeVar("R", bound="RealClaim")
LARGEST = 1 << 1000  # limits stay below it, so that a double can stand beside the exact value
_registry: dict[str, RealClaim] = {}


@dataclass(frozen=True, eq=False, kw_only=True)
class RealClaim(ABC):
    """A claim over reals, which no model has.  `line` is where it stands."""

    id: str
    expect: str
    role: str = "claim"
    twin_of: str | None = None
    module: str = ""
    file: str = ""
    line: int = 1
    namespace: Mapping[str, Any] = field(default_factory=dict, repr=False)

    @property
    @abstractmethod
    def statement(self) -> str:
        """The sentence that is proved or refuted."""

    @property
    @abstractmethod
    def about(self) -> Stated:
        """What is claimed, with requirement and source."""

    @abstractmethod
    def found(self, seconds: float) -> dict[str, Any]:
        """What is found of it, each route having so many seconds for a question."""

    @abstractmethod
    def violation(self) -> Bit:
        """The points at which it is broken; raises `ModelError` where none could be named."""

    def problem(self) -> Problem:
        """It as a problem without registers, for a certificate; raises `ModelError` as `violation`."""
        from safety.faults import Faulted
        from safety.model import Model
        from safety.prove.problem import Problem

        holds = ~self.violation()
        inputs = {str(v.attr): v for v in variables([holds])}
        system = System("real numbers", Clock(event="any point"), (), inputs, {}, {}, {}, {})
        claim = Claim(self.id, Model, lambda s: holds, self.statement, self.expect)
        return Problem(claim, system, Faulted(system, (), (), (), ()), holds, (bit(True),), bit(True), bit(True), {})

    def evaluate(self, seconds: float) -> dict[str, Any]:
        """The entry under "claims" of the results document.  Raises as `check`, `bracket` and `law`."""
        found = self.found(seconds)
        if found["counterexample"]:
            found["counterexample"]["replay"] = f"rightside replay {self.id}"
        return {**found, "id": self.id, "role": self.role, "twin_of": self.twin_of}

    def broken_at(self, values: Mapping[str, str]) -> bool:
        """Whether it is broken at a point, as the results have it; no solver is asked.

        Raises `ModelError` for a point that does not name the variables, or has no numbers.
        """
        formula = self.violation()
        names = {str(v.attr): v for v in variables([formula])}
        if values.keys() != names.keys():
            raise ModelError(f"{self.id} is about {', '.join(names)}; the point names {', '.join(values) or 'nothing'}")
        return holds(formula, {term: read(values[name]) for name, term in names.items()})


@dataclass(frozen=True, eq=False, kw_only=True)
class BoundClaim(RealClaim):
    """A bound with its limit, or without one: then its least upper bound is bracketed."""

    bound: Bound
    limit: Fraction | None = None
    strict: bool = False
    width: Fraction = WIDTH

    @property
    def statement(self) -> str:
        """That the limit is kept, or what is bracketed."""
        return self.bound.least() if self.limit is None else self.bound.sentence(self.limit, self.strict)

    @property
    def about(self) -> Stated:
        """The bound."""
        return self.bound

    def found(self, seconds: float) -> dict[str, Any]:
        """The verdict on the limit, or the bracket."""
        from safety.prove.bounds import Limits, bracket, check  # here, since FLINT and solvers take their time

        if self.limit is None:
            return bracket(self.bound, self.width, Limits(seconds)).to_json(self.expect)
        return check(self.bound, self.limit, self.strict, Limits(seconds)).to_json(self.expect)

    def violation(self) -> Bit:
        """Where the limit is exceeded."""
        if self.limit is None:
            raise ModelError(f"{self.id} has no limit that could be exceeded")
        return self.bound.beyond(self.limit, reached=self.strict)


def claim_bound(
    bound: Bound,
    limit: Exact,
    *,
    expect: str,
    strict: bool = False,
    id: str = "",
    twin_of: BoundClaim | None = None,
    defeat: bool = False,
) -> BoundClaim:
    """Claim that a quantity stays at or below a limit (below it, if strict); the unit is the bound's.

    `id` is the bound's own where nothing else is said.  A `twin_of` another bound, or a `defeat`, as of any claim.
    Raises `ModelError` for a limit that is not exact, a verdict that no bound can have, or an id that is taken.
    """
    if isinstance(limit, bool) or not isinstance(limit, int | Fraction):
        raise ModelError(f"{id or bound.id}: limit={limit!r} is not exact; give an int or a Fraction")
    if not -LARGEST < limit < LARGEST:
        raise ModelError(f"{id or bound.id}: the limit is greater than a double can be; state it in a greater unit")
    if twin_of is not None and not isinstance(twin_of, BoundClaim):
        raise ModelError(f"{id or bound.id}: twin_of={twin_of!r}; it is what claim_bound or claim_bracket gave")
    _expects(id or bound.id, expect, (PROVED, REFUTED, VACUOUS, UNDECIDED))
    role = "defeat" if defeat else "twin" if twin_of else "claim"
    twin = twin_of.id if twin_of else None
    return register(
        BoundClaim(
            id=id or bound.id, bound=bound, expect=expect, limit=Fraction(limit), strict=strict, role=role,
            twin_of=twin, **_place(),
        )
    )  # fmt: skip


def claim_bracket(bound: Bound, *, width: Fraction = WIDTH, expect: str = PROVED, id: str = "") -> BoundClaim:
    """Claim that a quantity has a least upper bound, and show it between two ends of a relative width.

    Proved where the lower end is reached at an exact point and the upper one proved.  Raises as `claim_bound`.
    """
    if isinstance(width, bool) or not isinstance(width, int | Fraction) or not width > 0:
        raise ModelError(f"{id or bound.id}: width={width!r}; it is exact and above 0, such as Fraction(1, 1000)")
    _expects(id or bound.id, expect, (PROVED, VACUOUS, UNDECIDED))
    return register(BoundClaim(id=id or bound.id, bound=bound, expect=expect, width=Fraction(width), **_place()))


def declared() -> list[RealClaim]:
    """All claims over reals that imported proof files have declared, in order."""
    return list(_registry.values())


def _expects(name: str, expect: str, possible: tuple[str, ...]) -> None:
    if expect not in possible:
        raise ModelError(f"{name}: expect={expect!r}; here it is one of {', '.join(possible)}")


def _place() -> dict[str, Any]:
    """Where the caller of our caller declares."""
    caller: FrameType = sys._getframe(2)
    names = caller.f_globals
    return {
        "module": names.get("__name__", ""),
        "file": caller.f_code.co_filename,
        "line": caller.f_lineno,
        "namespace": names,
    }


def register(new: R) -> R:
    """Add a claim; a file that is read again, and so has new names, replaces its own."""
    old = _registry.get(new.id)
    if old is not None and (old.file != new.file or old.namespace is new.namespace):
        places = f"{old.file}:{old.line} and {new.file}:{new.line}"
        raise ModelError(f"two claims are called {new.id!r}, at {places}; give one another id=")
    _registry[new.id] = new
    return new

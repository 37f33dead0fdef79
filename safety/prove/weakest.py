"""The weakest value of a parameter that is safe, between a proof and a counterexample.

    @weakest(Ts7, "common.sync.frames", safe=ABOVE, within=(2400, 8000), lemmas=[...], scenarios=[...], unit="frame")
    def nobody_isolated(s: Seen) -> Bit:
        \"\"\"Limits within one word of each other: no healthy channel is isolated.\"\"\"
        return ~any_of(*three(s, "targets."))

`safe_from` is a value from which on, up to the safe end of the range, the sentence is proved: of a model's parameter by
one proof for all these values, the parameter left open.  `refuted_at` is the value nearest to it at which a run breaks
the sentence; so nothing rests on whether values in between are ordered.  Next to each other the two are exact; what
lies between them is open.  The range is halved only to save questions.

`weakest_of` takes any family of claims with a whole number in it: each value on the safe side is proved by itself,
unless the claim of one value is shown to say what those of the others say too (`covers`).  `weakest_real` takes a
variable of a bound over reals.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from safety.faults import Budget
from safety.model import Model
from safety.prove.claims import INTEGERS, PROVED, Claim, F, Formula, Scenario, Seen, claim_id
from safety.system import ModelError
from safety.terms import Bit, Real
from safety.terms.graph import describe, variables

if TYPE_CHECKING:
    from safety.prove.bounds import Bound

ABOVE, BELOW = "above", "below"
EVERY = 1000  # values that are proved one by one
Value = int | Fraction
Family = Callable[[int], Claim]


@dataclass(frozen=True, eq=False)
class Synthesis:
    """What is looked for: the weakest value of `parameter` within a range, safe towards `safe`.

    `gap` is how far refuted and proved value may lie apart.  `at` tells what else is held fixed, by name.  `proving`
    gives the claim for all values from one on (if it `covers` them), `breaking` the one at that value; a bound over
    reals has neither.  `free` is the parameter where it is one of the model, left open.
    """

    id: str
    statement: str
    parameter: str
    within: tuple[Value, Value]
    safe: str
    gap: Value
    unit: str = ""
    requirement: str = ""
    source: str = ""
    at: Mapping[str, Any] = field(default_factory=dict)
    proving: Family | None = None
    breaking: Family | None = None
    scenarios: Sequence[Scenario] = ()
    free: str = ""
    bound: Bound | None = None
    limit: Fraction = Fraction(0)
    covers: bool = True
    place: tuple[str, int] = ("", 1)

    @property
    def for_all(self) -> str:
        """By what the proof is one of all values on the safe side."""
        if self.free or self.bound:
            return "one proof, the parameter left open"
        return "one proof, the claim of a value covers the others" if self.covers else "a proof for each value"

    def scripts(self, value: int) -> list[Scenario]:
        """The runs to try at a value."""
        if self.free:
            return [replace(each, start={**each.start, self.free: value}) for each in self.scenarios]
        own = self.breaking(value).scenario if self.breaking else None
        return [own] if own else []

    @property
    def strictest(self) -> Value:
        """The end of the range where the sentence is most likely to hold."""
        return self.within[self.safe == ABOVE]

    @property
    def loosest(self) -> Value:
        """The other end."""
        return self.within[self.safe != ABOVE]

    @property
    def model(self) -> type[Model] | None:
        """The model that it is about; None for a bound over reals."""
        return self.breaking(int(self.strictest)).model if self.breaking else None


_registry: dict[str, Synthesis] = {}


def declared() -> list[Synthesis]:
    """All that imported proof files have declared, in order."""
    return list(_registry.values())


def weakest(
    model: type[Model],
    parameter: str,
    *,
    safe: str,
    within: tuple[int, int],
    scenarios: Sequence[Scenario] = (),
    gap: int = 1,
    unit: str = "",
    id: str = "",
    at: Mapping[str, Any] | None = None,
    requirement: str = "",
    source: str = "",
    faults: Budget | None = None,
    given: Formula | None = None,
    start: Formula | None = None,
    lemmas: Sequence[Formula] = (),
    symbolic: Sequence[str] = (),
    settings: Mapping[str, Any] | None = None,
    anywhere: bool = False,
    arithmetic: str = INTEGERS,
    steps: int = 20,
    witness: Scenario | None = None,
) -> Callable[[F], F]:
    """Look for the weakest value of a model's parameter at which the decorated formula holds.

    `scenarios` are runs to try as counterexamples, the parameter set to the value; without any they are searched for.
    `at` names what else is held fixed, for the reader.  The rest is as of a claim.
    Raises `ModelError` for a range that is none, an unknown side, or a formula without a statement.
    """

    def declare(formula: F) -> F:
        name = id or claim_id(formula)
        base = Claim(
            name, model, formula, _said(name, formula), PROVED, requirement, source, faults, given, start,
            tuple(lemmas), (*symbolic, parameter), dict(settings or {}), steps=steps, arithmetic=arithmetic,
            witness=witness, anywhere=anywhere,
        )  # fmt: skip

        def proving(value: int) -> Claim:
            return replace(base, given=_held(base.given, parameter, ">=" if safe == ABOVE else "<=", value))

        def breaking(value: int) -> Claim:
            return replace(base, given=_held(base.given, parameter, "==", value))

        _register(
            Synthesis(
                name, base.statement, parameter, within, safe, gap, unit, requirement, source, dict(at or {}),
                proving, breaking, tuple(scenarios), parameter, place=_place(formula),
            )
        )  # fmt: skip
        return formula

    return declare


def weakest_of(
    parameter: str,
    *,
    safe: str,
    within: tuple[int, int],
    gap: int = 1,
    unit: str = "",
    id: str = "",
    at: Mapping[str, Any] | None = None,
    covers: bool = False,
) -> Callable[[Family], Family]:
    """Look for the weakest value at which the claim holds that the decorated function makes of it.

    The claim's `scenario` is the run to try at that value.
    `covers`: the claim of a value is about all that those of the values on its safe side are about, which is shown too.
    Raises as `weakest`.
    """

    def declare(family: Family) -> Family:
        name = id or claim_id(family)
        _check_range(name, within, (int,))

        def made(value: int) -> Claim:
            try:
                one = family(value)
            except Exception as error:
                raise ModelError(f"{name} makes no claim of {value}: {type(error).__name__}: {error}") from error
            if not isinstance(one, Claim):
                raise ModelError(f"{name} makes {one!r} of {value}; return a Claim")
            return one

        one = made(within[0])
        _register(
            Synthesis(
                name, _said(name, family), parameter, within, safe, gap, unit, one.requirement, one.source,
                dict(at or {}), made, made, covers=covers, place=_place(family),
            )
        )  # fmt: skip
        return family

    return declare


def weakest_real(
    bound: Bound,
    limit: int | Fraction,
    variable: Real,
    *,
    safe: str,
    within: tuple[int | Fraction, int | Fraction],
    gap: Fraction,
    id: str,
    unit: str = "",
    at: Mapping[str, Any] | None = None,
) -> Synthesis:
    """Look for the weakest value of a variable of a bound, from which on the quantity stays at or below the limit.

    `bound.given` should leave the variable open over the range; `unit` is its unit.  Raises as `weakest`.
    """
    caller = sys._getframe(1)
    if all(v is not variable for v in variables([bound.quantity, bound.per, *bound.given])):
        raise ModelError(f"{id}: {describe(variable)} is no variable of {bound.id}; name one that it reads")
    found = Synthesis(
        id, bound.sentence(Fraction(limit)), str(variable.attr), within, safe, gap, unit, bound.requirement,
        bound.source, dict(at or {}), bound=replace(bound, id=id), limit=Fraction(limit),
        place=(caller.f_code.co_filename, caller.f_lineno),
    )  # fmt: skip
    return _register(found)


def _held(given: Formula | None, parameter: str, sign: str, value: int) -> Formula:
    """What is given, and the parameter held to a value or to one side of it."""

    def formula(s: Seen) -> Bit:
        free = s[parameter]
        here: Bit = {"==": free == value, ">=": free >= value, "<=": free <= value}[sign]
        return here if given is None else given(s) & here

    told = " ".join((given.__doc__ or given.__name__).split()) if given else ""
    formula.__doc__ = "; ".join(filter(None, [told, f"{parameter} {sign} {value}"]))
    return formula


def _said(name: str, about: Callable[..., Any]) -> str:
    statement = " ".join((about.__doc__ or "").split())
    if not statement:
        raise ModelError(f"{name} says nothing: give it a docstring in plain words")
    return statement


def _place(about: Callable[..., Any]) -> tuple[str, int]:
    return about.__code__.co_filename, about.__code__.co_firstlineno


def _check_range(name: str, within: tuple[Value, Value], kinds: tuple[type, ...]) -> None:
    if not isinstance(within, tuple) or len(within) != 2 or any(type(end) not in kinds for end in within):
        kind = "whole numbers" if kinds == (int,) else "exact: whole numbers or fractions"
        raise ModelError(f"{name}: within={within!r}; its two ends are {kind}")
    low, high = within
    if not low < high:
        raise ModelError(f"{name}: within={within}; give two different values, the lower one first")


def _register(new: Synthesis) -> Synthesis:
    exact = (int,) if new.bound is None else (int, Fraction)
    _check_range(new.id, new.within, exact)
    low, high = new.within
    if new.safe not in (ABOVE, BELOW):
        raise ModelError(f"{new.id}: safe={new.safe!r}; it is ABOVE or BELOW")
    if type(new.gap) not in exact or new.gap <= 0:
        raise ModelError(f"{new.id}: gap={new.gap!r}; it is a whole number from 1 up, for reals an exact one above 0")
    if not new.free and new.bound is None and high - low > EVERY:
        raise ModelError(f"{new.id}: within={new.within}; each of these values is looked at: shorten the range")
    old = _registry.get(new.id)
    if old is not None and old.place != new.place and old.place[0] == new.place[0]:
        raise ModelError(f"two syntheses are called {new.id!r}, at lines {old.place[1]} and {new.place[1]}; rename one")
    _registry[new.id] = new
    return new

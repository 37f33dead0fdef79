"""The symbols of a paper: unit, meaning, value, and the definition by other symbols; and relations bound to values."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any, TypeAlias

from safety.audit.exceptions import AuditError
from safety.audit.formula import MOST_PLACES, Formula, decimal, formula, not_too_large
from safety.audit.known import Known
from safety.audit.spans import NUMBERS, Span, span
from safety.audit.units import Unit, dimension, unit

By: TypeAlias = str | Callable[..., Any]
Function: TypeAlias = Callable[[Mapping[str, Span]], Span]


DIGITS = 8  # of an input that is shown


@dataclass(frozen=True)
class Symbol:
    """A quantity: `by` defines it where it has no value of its own; it is above 0 unless `signed`."""

    name: str
    unit: str
    about: str = ""
    known: Known | None = None
    by: Formula | None = None
    signed: bool = False


@dataclass(frozen=True)
class Bound:
    """A relation with its inputs: `function` gives the value in `unit` from values of the inputs in their own units."""

    text: str
    inputs: Mapping[str, Known]
    free: tuple[str, ...]  # symbols in it of which nothing is known
    function: Function
    numbers: tuple[Fraction, ...] = ()  # that stand in it

    def told(self) -> list[str]:
        """The inputs, each with its value and tag."""
        inputs = [f"{name} = {known}" for name, known in self.inputs.items()]
        numbers = ", ".join(decimal(number) for number in self.numbers if number not in (0, 1))
        return [*inputs, *([f"{numbers} in the relation [D]"] if numbers else [])]

    def start(self) -> dict[str, Span]:
        """The inputs at their best values."""
        return {name: known.value for name, known in self.inputs.items()}

    def ranges(self, tags: str) -> dict[str, Span]:
        """The inputs of these tags in their ranges."""
        return {name: known.range for name, known in self.inputs.items() if known.tag in tags}

    @property
    def whole(self) -> frozenset[str]:
        """The inputs that count something."""
        return frozenset(name for name, known in self.inputs.items() if known.whole)

    @property
    def assumed(self) -> tuple[str, ...]:
        """The assumed inputs, each with its value; those too that a value worked out elsewhere rests on."""
        return tuple(dict.fromkeys(text for name, known in self.inputs.items() for text in known.assumed(name)))

    def at(self, point: Mapping[str, Fraction]) -> Bound:
        """The same with some inputs fixed."""
        fixed = {name: replace(self.inputs[name], value=Span(v), range=Span(v)) for name, v in point.items()}
        return replace(self, inputs={**self.inputs, **fixed})

    def moved(self, point: Mapping[str, Fraction]) -> str:
        """The inputs of a point that are not at their best values."""
        away = {name: value for name, value in point.items() if value != self.inputs[name].value.middle}
        return ", ".join(
            f"{name} = {float(value):.{DIGITS}g}, in place of {self.inputs[name].text}" for name, value in away.items()
        )

    def nominal(self) -> Span:
        """The value at the best values of all inputs."""
        return self.function(self.start())

    def everywhere(self) -> Span:
        """An enclosure of the values over all ranges."""
        return self.function({name: known.range for name, known in self.inputs.items()})


@dataclass
class Symbols:
    """The symbols of one paper by name."""

    of: dict[str, Symbol] = field(default_factory=dict)

    @property
    def signed(self) -> frozenset[str]:
        """Those that may be 0 or below."""
        return frozenset(name for name, symbol in self.of.items() if symbol.signed)

    def known(self, name: str) -> Symbol:
        """The symbol of a name.  Raises AuditError, with the names that there are."""
        if name not in self.of:
            raise AuditError(f"there is no symbol {name!r}; declare it with symbol(); there are {', '.join(self.of)}")
        return self.of[name]

    def units(self, names: set[str]) -> dict[str, Unit]:
        """The units of symbols."""
        return {name: unit(self.known(name).unit) for name in names}

    def check(self, given: Mapping[str, Any]) -> None:
        """Refuse definitions of symbols that are not declared, or that have another dimension than their symbol.

        Raises AuditError.  A definition without a symbol, such as 0, has any dimension.
        """
        own = {name: symbol.by for name, symbol in self.of.items() if symbol.by is not None}
        here = {name: formula(by) for name, by in given.items() if isinstance(by, str)}
        for name in given:
            self.known(name)
        for name, by in (own | here).items():
            found = dimension(by, self.units(by.names))
            if by.names and found != unit(self.known(name).unit).dimension:
                is_ = Unit(Fraction(1), found).named()
                raise AuditError(f"{name} is in {self.of[name].unit!r}, but its definition {by} is {is_}")

    def expanded(self, each: Formula, given: Mapping[str, Any], values: bool, keep: str = "") -> Formula:
        """Definitions put in for symbols, until only those remain that have none, and the one to `keep`.

        With `values`, symbols that have a value stay too; what `given` says of a symbol goes before its own definition.
        Raises AuditError for a definition that runs in a circle.
        """
        for _ in range(len(self.of) + 1):
            names = each.names - {keep}
            by = {name: found for name in names if (found := self._definition(name, given, values)) is not None}
            if not by:
                return each
            sizes = {name: sum(1 for _ in put.places()) for name, put in by.items()}
            if sum(sizes.get(name, 1) for name in each.places()) > MOST_PLACES:
                raise AuditError(f"with the definitions of {', '.join(sorted(by))} put in it is too long to be judged")
            each = each.replaced(by)
            not_too_large(each)
        raise AuditError(f"the definitions of {', '.join(sorted(by))} run in a circle")

    def _definition(self, name: str, given: Mapping[str, Any], values: bool) -> Formula | None:
        if name in given:
            return formula(given[name]) if isinstance(given[name], str) else None
        own = self.of.get(name)
        return None if own is None or (values and own.known is not None) else own.by

    def unit_of(self, each: Formula, given: Mapping[str, Known | str]) -> str:
        """The unit of a symbol of the same dimension in a formula; `1` for a pure number.

        Raises AuditError when none has it.
        """
        whole = self.expanded(each, given, values=True)
        units = self.units(whole.names | each.names)
        wanted = dimension(whole, units)
        places = (*each.places(), *whole.places())
        same = (self.of[name].unit for name in places if units[name].dimension == wanted)
        found = next(same, "" if wanted else "1")
        if not found:
            raise AuditError(
                f"{each} has no symbol of its own unit, {Unit(Fraction(1), wanted).named()}; define one by it"
            )
        return found

    def bound(self, by: By, to: str, given: Mapping[str, Known | str]) -> Bound:
        """A relation that gives a value in the unit `to`.  Raises AuditError for symbols or units that do not fit."""
        if callable(by):
            return _called(by, given)
        self.check(given)
        return self.bound_formula(formula(by), to, given)

    def bound_formula(self, each: Formula, to: str, given: Mapping[str, Known | str]) -> Bound:
        """The same for a formula; all its symbols have units."""
        whole = self.expanded(each, given, values=True)
        units = self.units(whole.names | each.names)
        found, wanted = dimension(whole, units), unit(to)
        if found != wanted.dimension:
            raise AuditError(f"{each} is {Unit(Fraction(1), found).named()}, but is given in {to!r}")
        inputs: dict[str, Known] = {}
        for name in whole.places():
            known = given[name] if name in given else self.of[name].known
            if isinstance(known, Known):
                inputs[name] = known
        free = tuple(dict.fromkeys(name for name in whole.places() if name not in inputs))

        def value(at: Mapping[str, Span]) -> Span:
            coherent = {name: each * units[name].scale for name, each in at.items()}
            return span(whole.over(NUMBERS, coherent)) / wanted.scale

        numbers = () if each.op == "number" else tuple(dict.fromkeys(whole.numbers()))
        return Bound(str(each), inputs, free, value, numbers)


def _called(by: Callable[..., Any], given: Mapping[str, Known | str]) -> Bound:
    """A function of the names it asks for; an input of no width is a Fraction, any other a Span."""
    names = list(inspect.signature(by).parameters)
    missing = [name for name in names if not isinstance(given.get(name), Known)]
    if missing:
        raise AuditError(f"{by.__name__} asks for {', '.join(missing)}; give each a value in given=")

    def value(at: Mapping[str, Span]) -> Span:
        return span(by(**{name: each.low if each.exact else each for name, each in at.items()}))

    inputs = {name: known for name in names if isinstance(known := given[name], Known)}
    return Bound((by.__doc__ or by.__name__).strip().splitlines()[0], inputs, (), value)

"""A paper under audit: its symbols, and everything printed in it that is recomputed.

    paper = Paper("clock", "A clock, 1960")
    paper.symbol("f", "kHz", "oscillator", printed("32.77"))
    paper.symbol("divisor", "1", "of its frequency", derived(2**15))
    paper.symbol("T", "s", "period", by="divisor/f")
    paper.figure("period", "0.9999", "s", where="table 1", by="T")
    paper.equation("eq1", "divisor = f*T", where="(1)")

No verdict is entered: it follows from the relation and the printed precision.  Ids are `clock.rate` and so on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from typing import TypeAlias

from safety.audit import number, statement, wording
from safety.audit.entry import Entry, Figure, by_claim, register
from safety.audit.equation import Court, Equation
from safety.audit.exceptions import AuditError
from safety.audit.formula import formula, relation
from safety.audit.known import Known
from safety.audit.symbols import Bound, By, Symbol, Symbols
from safety.audit.text import Text, text
from safety.audit.units import unit
from safety.audit.verdict import AGREES, MISPRINT, Judged

Given: TypeAlias = Mapping[str, "Known | str | Figure | Callable[[], Known]"]
NO_GIVEN: Given = {}


class Paper:
    """The declarations of one paper; ids begin with its own."""

    def __init__(self, id: str, title: str) -> None:
        self.id, self.title = id, title
        self.requirement = ""
        self.symbols = Symbols()
        self.equations: dict[str, Equation] = {}

    def under(self, requirement: str) -> Paper:
        """The same paper, for what is declared under a requirement."""
        other = copy(self)
        other.requirement = requirement
        return other

    def symbol(
        self, name: str, unit: str, about: str = "", known: Known | None = None, *, by: str = "", signed: bool = False
    ) -> None:
        """Declare a symbol with its unit, and what is known of it: a value, a definition by others, both or nothing.

        Raises AuditError for a name that is taken, or a unit or formula that cannot be read.
        """
        if name in self.symbols.of:
            raise AuditError(f"{self.id}: the symbol {name!r} is declared twice")
        _readable(unit)
        self.symbols.of[name] = Symbol(name, unit, about, known, formula(by) if by else None, signed)

    def figure(
        self,
        name: str,
        printed: str,
        unit: str,
        *,
        where: str,
        by: By,
        given: Given = NO_GIVEN,
        also: Mapping[str, By] | None = None,
        digits: int | None = None,
    ) -> Figure:
        """Declare a printed number, the relation that gives it, and relations that are independent of that one.

        `by` is a formula, or a function of names in `given`.  `given` holds values, definitions (as text), figures,
        or functions that work a value out when it is asked for.
        Raises AuditError for an id that is taken, or a text, unit or formula that cannot be read.
        """
        read = text(printed, digits)
        _readable(unit)
        how = by if isinstance(by, str) else (by.__doc__ or by.__name__).strip().splitlines()[0]
        for each in (by, *(also or {}).values()):
            if isinstance(each, str):
                formula(each)

        def bound(each: By, meant: bool) -> Bound:
            return self.symbols.bound(each, unit, _values(given, meant))

        def judge(read: Text) -> Judged:
            others = {label: bound(each, True) for label, each in (also or {}).items()}
            main = bound(by, True)
            _independent(main, others)
            found = number.judge(read, main, others)
            spoilt = [each for each in given.values() if isinstance(each, Figure) and each.judged.verdict == MISPRINT]
            if found.verdict in AGREES or not spoilt:
                return found
            return _inherited(found, number.judge(read, bound(by, False), {}), spoilt)

        def inputs() -> list[str]:
            return [f"{name} = {known}" for name, known in bound(by, True).inputs.items()]

        new = Figure(
            id=f"{self.id}.{name}",
            paper=self.title,
            kind="number",
            requirement=self.requirement,
            printed=printed,
            unit=unit,
            where=where,
            how=how,
            judge=lambda: judge(read),
            inputs=inputs,
            text=read,
            if_printed=judge,
        )
        register(new)
        return new

    def statement(self, name: str, printed: str, *, where: str, holds: str, given: Given = NO_GIVEN) -> Entry:
        """Declare a sentence with numbers in it; `holds` is the same as a relation, of quantities that are known.

        A side that is a number alone is in the unit of the first symbol: `4 <= v <= 8`.
        """
        read = relation(holds)
        if not read.signs:
            raise AuditError(f"{self.id}.{name}: {holds!r} states nothing; write a relation such as 'a <= b'")

        def parts() -> list[statement.Part]:
            values = _values(given, True)
            self.symbols.check(values)
            to = self.symbols.unit_of(statement.main_side(read.sides), values)
            bounds = [self.symbols.bound_formula(side, to if side.names else "1", values) for side in read.sides]
            return [statement.part(a, sign, b) for a, sign, b in zip(bounds, read.signs, bounds[1:], strict=False)]

        def inputs() -> list[str]:
            return sorted({f"{n} = {known}" for each in parts() for n, known in each.difference.inputs.items()})

        return self._entry(name, "statement", printed, where, holds, lambda: statement.judge(parts()), inputs)

    def equation(
        self,
        name: str,
        printed: str,
        *,
        where: str,
        of: str = "",
        given: Mapping[str, str] | None = None,
        when: Sequence[str] = (),
        neglecting: str = "",
        least: str = "",
        note: str = "",
    ) -> Entry:
        """Declare a printed equation: an identity, for all positive values of the symbols that have no definition.

        `of` is the left side, where the print goes on with "= ..." from the line before.  `given` has definitions for
        this equation alone, `when` conditions.  `neglecting` is a relative error up to which the equation is meant.
        `least` is a quantity that is least where the left side, a symbol, has the value of the right one.
        """
        read = relation(printed)
        if not (read.signs or of):
            raise AuditError(f"{self.id}.{name}: {printed!r} has one side; give the other with of=")
        each = Equation(
            read,
            formula(of) if of else None,
            dict(given or {}),
            tuple(relation(condition) for condition in when),
            formula(neglecting) if neglecting else None,
            formula(least) if least else None,
        )
        self.equations[name] = each
        how = "; ".join(
            filter(
                None,
                (
                    f"least value of {least}" if least else "identity by the theory",
                    ", ".join(f"{symbol} := {by}" for symbol, by in (given or {}).items()),
                    f"where {', '.join(when)}" if when else "",
                    note,
                ),
            )
        )
        shown = f"= {printed}" if of else printed
        return self._entry(name, "equation", shown, where, how, lambda: self._court(name).judge(each), list)

    def wording(
        self, name: str, printed: str, *, where: str, says: str, given: Mapping[str, str] | None = None,
        when: Sequence[str] = (),
    ) -> Entry:  # fmt: skip
        """Declare words that give a direction; `says` is `x rises with y`, `falls with` or `does not depend on`."""
        wording.read(says)
        conditions = tuple(relation(condition) for condition in when)
        return self._entry(
            name,
            "wording",
            printed,
            where,
            says,
            lambda: wording.judge(says, self.symbols, given or {}, conditions),
            list,
        )

    def decided(self, name: str, printed: str, *, where: str, claim: str) -> Entry:
        """Declare words that a claim states: confirmed where it is proved, inconsistent where it is refuted."""
        new = self._entry(name, "claim", printed, where, f"claim {claim}", lambda: by_claim(claim, ""), list)
        new.claim = claim
        return new

    def _court(self, name: str) -> Court:
        used: dict[str, tuple[str, ...]] = {}
        for other, each in self.equations.items():
            if other != name:
                for place in set().union(*(side.names for side in each.relation.sides)):
                    used[place] = (*used.get(place, ()), other)
        return Court(self.symbols, used)

    def _entry(
        self, name: str, kind: str, printed: str, where: str, how: str, judge: Callable[[], Judged],
        inputs: Callable[[], list[str]],
    ) -> Entry:  # fmt: skip
        new = Entry(
            id=f"{self.id}.{name}",
            paper=self.title,
            kind=kind,
            requirement=self.requirement,
            printed=printed,
            where=where,
            how=how,
            judge=judge,
            inputs=inputs,
        )
        register(new)
        return new


def _values(given: Given, meant: bool) -> dict[str, Known | str]:
    """What is given, figures as the numbers that were meant or as those in print."""
    return {name: _value(each, meant) for name, each in given.items()}


def _value(each: Known | str | Figure | Callable[[], Known], meant: bool) -> Known | str:
    if isinstance(each, Figure):
        return each.as_meant() if meant else each.as_printed()
    return each() if callable(each) else each


def _inherited(found: Judged, as_printed: Judged, spoilt: Sequence[Figure]) -> Judged:
    """A number that follows from another's misprint, and not from what was meant there, is spoilt with it."""
    if as_printed.verdict not in AGREES:
        return found
    names = ", ".join(
        f"{each.id} ({each.printed} for {each.judged.mended or each.judged.recomputed})" for each in spoilt
    )
    note = f"follows from a misprint: {names}"
    evidence = tuple(told for each in spoilt for told in each.judged.evidence)
    return Judged(MISPRINT, found.recomputed, note, evidence=evidence, value=found.value)


def _independent(main: Bound, others: Mapping[str, Bound]) -> None:
    """Refuse evidence that rests on nothing but what the relation itself rests on."""
    for label, other in others.items():
        if other.text == main.text or not other.inputs.keys() - main.inputs.keys():
            raise AuditError(f"evidence {label!r} rests on the same inputs as the relation; give an independent one")


def _readable(text: str) -> None:
    unit(text)

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
from fractions import Fraction
from typing import TypeAlias

from safety.audit import named, number, statement, wording
from safety.audit.entry import Entry, Figure, by_claim, register
from safety.audit.equation import Court, Equation
from safety.audit.exceptions import AuditError
from safety.audit.formula import Relation, formula, relation, spelled
from safety.audit.known import Known
from safety.audit.spans import Span
from safety.audit.symbols import Bound, By, Symbol, Symbols
from safety.audit.text import Text, text
from safety.audit.units import unit
from safety.audit.verdict import AGREES, MISPRINT, Judged

Given: TypeAlias = Mapping[str, "Known | str | Figure | Callable[[], Known]"]
NO_GIVEN: Given = {}


class Paper:
    """The declarations of one paper; ids begin with its own.  What it does not print itself is not `published`."""

    def __init__(self, id: str, title: str, *, published: bool = True) -> None:
        self.id, self.title, self.published = id, title, published
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
        name = spelled(name)
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

        def judge(stands: Text) -> Judged:
            others = {label: bound(each, True) for label, each in (also or {}).items()}
            main = bound(by, True)
            _independent(read, main, others)
            found = number.judge(stands, main, others)
            spoilt = [each for each in given.values() if isinstance(each, Figure) and each.judged.verdict == MISPRINT]
            if found.verdict in AGREES or not spoilt:
                return found
            return _inherited(found, number.judge(stands, bound(by, False), {}), spoilt)

        def inputs() -> list[str]:
            return bound(by, True).told()

        new = Figure(
            id=f"{self.id}.{name}",
            paper=self.title,
            published=self.published,
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
            return list(dict.fromkeys(told for each in parts() for side in each.sides for told in side.told()))

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
        about = f"least value of {least}" if least else "identity by the theory"
        each = Equation(
            self._printed(name, printed, of),
            formula(of) if of else None,
            _definitions(given),
            tuple(relation(condition) for condition in when),
            formula(neglecting) if neglecting else None,
            formula(least) if least else None,
        )
        return self._equation(name, f"= {printed}" if of else printed, where, each, about, note)

    def rule(
        self, name: str, printed: str, *, where: str, iff: str, given: Mapping[str, str] | None = None,
        when: Sequence[str] = (), note: str = "",
    ) -> Entry:  # fmt: skip
        """Declare a printed rule of decision: it holds where the condition `iff` does, and nowhere else.

        `given` and `when` as of an equation.
        """
        conditions = tuple(relation(condition) for condition in when)
        stands_for = self._printed(f"{name}: iff", iff, "")
        each = Equation(self._printed(name, printed, ""), None, _definitions(given), conditions, iff=stands_for)
        return self._equation(name, printed, where, each, f"exactly where {iff}", note)

    def _printed(self, name: str, printed: str, of: str) -> Relation:
        read = relation(printed)
        if not (read.signs or of):
            raise AuditError(f"{self.id}.{name}: {printed!r} has one side; give the other with of=")
        return read

    def _equation(self, name: str, shown: str, where: str, each: Equation, about: str, note: str) -> Entry:
        self.equations[name] = each
        definitions = ", ".join(f"{symbol} := {by}" for symbol, by in (each.given or {}).items())
        conditions = f"where {', '.join(map(str, each.when))}" if each.when else ""
        how = "; ".join(filter(None, (about, definitions, conditions, note)))
        return self._entry(name, "equation", shown, where, how, lambda: self._court(name).judge(each), list)

    def wording(
        self, name: str, printed: str, *, where: str, says: str, given: Mapping[str, str] | None = None,
        when: Sequence[str] = (),
    ) -> Entry:  # fmt: skip
        """Declare words that give a direction; `says` is `x rises with y`, `falls with` or `does not depend on`."""
        wording.read(spelled(says))
        conditions = tuple(relation(condition) for condition in when)
        return self._entry(
            name,
            "wording",
            printed,
            where,
            says,
            lambda: wording.judge(spelled(says), self.symbols, _definitions(given), conditions),
            list,
        )

    def named(self, name: str, printed: str, *, where: str, means: str, names: Mapping[str, str]) -> Entry:
        """Declare a name in print, of a figure or a word: it is to be that of what is meant.

        `names` are the right ones, each with what it stands for.
        """
        return self._entry(
            name, "name", printed, where, f"the name of {means}", lambda: named.judge(printed, means, names), list
        )

    def decided(self, name: str, printed: str, *, where: str, claim: str, denies: bool = False) -> Entry:
        """Declare words that a claim states: confirmed where it is proved, inconsistent where it is refuted.

        Of words that say the contrary of the claim, `denies`, it is the other way round.  Until then there is no
        verdict.
        """
        how = f"the contrary of claim {claim}" if denies else f"claim {claim}"
        new = self._entry(name, "claim", printed, where, how, lambda: by_claim(claim), list)
        new.claim, new.denies = claim, denies
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
            published=self.published,
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
    return {spelled(name): _value(each, meant) for name, each in given.items()}


def _definitions(given: Mapping[str, str] | None) -> dict[str, str]:
    return {spelled(name): by for name, by in (given or {}).items()}


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


def _independent(printed: Text, main: Bound, others: Mapping[str, Bound]) -> None:
    """Refuse evidence that rests on nothing but what the relation itself rests on.

    Of an input that only it has, twice as much (or 1 in place of 0) must move it by more than what is printed can tell.
    """
    for label, other in others.items():
        if other.free:
            raise AuditError(f"evidence {label!r}: {', '.join(other.free)} has no value")
        own = sorted(other.inputs.keys() - main.inputs.keys())
        if not any(_moves(other, name, printed.step / 2) for name in own):
            raise AuditError(
                f"evidence {label!r} rests on the same inputs as the relation"
                + (f": {', '.join(own)} does not change it" if own else "")
                + "; give an independent one"
            )


def _moves(by: Bound, name: str, least: Fraction) -> bool:
    """Whether another value of an input changes the value by more than the least that counts."""
    start = by.start()
    here = by.function(start)
    there = start[name] + start[name] if start[name].middle else Span(1)
    try:
        return abs(by.function({**start, name: there}).middle - here.middle) > least
    except ArithmeticError:
        return True


def _readable(text: str) -> None:
    unit(text)

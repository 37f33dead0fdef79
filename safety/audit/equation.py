"""The verdict on a printed equation: its units, its truth for all values, and the symbol that a slip put into it.

The symbols are put back to what the theory defines them by; what is left is free, and the equation is true when it
has a meaning, and holds, whatever positive values the free ones have.  A rule is true when it holds exactly where the
condition holds that it stands for.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from safety.audit.algebra import Answer, decide
from safety.audit.exceptions import AuditError
from safety.audit.formula import Formula, Relation, constant, decimal, symbol
from safety.audit.spans import NUMBERS, Span
from safety.audit.symbols import Symbols
from safety.audit.units import Mismatch, Unit, dimension
from safety.audit.verdict import CONFIRMED, INCONSISTENT, MISPRINT, NOT_DERIVABLE, ROUNDING, Judged

FLIPPED = {"<=": ">=", ">=": "<=", "<": ">", ">": "<"}
DIGITS = 6
NEGLIGIBLE = Fraction(1, 100)  # the largest relative error that may be neglected


@dataclass(frozen=True)
class Equation:
    """A printed relation, and what goes with it.

    `of` is the side that the print carries over from the line before; `given` what symbols stand for here; `when` the
    conditions; `iff` the condition that a rule stands for; `neglecting` a small quantity up to which it is meant;
    `least` what is least where the left side, a symbol, has the value of the others.
    """

    relation: Relation
    of: Formula | None = None
    given: Mapping[str, str] | None = None
    when: tuple[Relation, ...] = ()
    neglecting: Formula | None = None
    least: Formula | None = None
    iff: Relation | None = None

    @property
    def conditions(self) -> tuple[Relation, ...]:
        """All that it speaks of besides what is printed."""
        return (*self.when, *((self.iff,) if self.iff else ()))

    def whole(self, printed: Relation) -> Relation:
        """With the side that is carried over."""
        return printed if self.of is None else Relation((self.of, *printed.sides), ("=", *printed.signs))


@dataclass
class Court:
    """Judges the equations of one paper; `used` are the symbols that its other equations use."""

    symbols: Symbols
    used: Mapping[str, tuple[str, ...]]

    def judge(self, each: Equation) -> Judged:
        """The verdict.  Raises AuditError for a declaration that cannot be judged, Disagreement of solvers."""
        self.symbols.check(each.given or {})
        for other in each.conditions:
            self._same_units(other)
        for one in filter(None, (each.neglecting, each.least)):
            self.symbols.units(one.names)
        small = self._negligible(each)
        unheard = sorted(name for name in self._names(each.relation) if name not in self.symbols.of)
        try:
            answer = Answer(False) if unheard else self.holds(each, each.relation)
            wrong_units = ""
        except Mismatch as error:
            answer, wrong_units = Answer(False), str(error)
        if answer.holds:
            return Judged(CONFIRMED, str(each.relation), agreed_by=answer.agreed_by)
        if answer.holds is None:
            return Judged(NOT_DERIVABLE, "", f"not decided: {answer.why}")
        if each.neglecting is not None and not unheard and not wrong_units:
            close = self._close(each)
            if close.holds:
                note = f"equal but for a relative error of at most {each.neglecting}, which is neglected"
                return Judged(ROUNDING, self._theory(each), note, assumed=small, agreed_by=close.agreed_by)
        return self._mended(each, answer, unheard, wrong_units)

    # --- truth -------------------------------------------------------------------------------------------------------

    def holds(self, each: Equation, printed: Relation) -> Answer:
        """Whether a relation in the place of the printed one holds.  Raises Mismatch where its units differ."""
        whole = each.whole(printed)
        self._same_units(whole)
        if each.least is not None:
            return self._least(each, whole)
        if each.iff is not None:
            return self._exactly_where(each, whole, each.iff)
        return self._decided(each, whole)

    def _decided(self, each: Equation, relation: Relation, *when: Relation) -> Answer:
        """Whether a relation holds wherever what its symbols stand for has a meaning."""
        theory = [self._side(each, symbol(name)) for name in sorted(self._names(relation))]
        conditions = [self._expanded(each, one) for one in (*each.when, *when)]
        return decide(self._expanded(each, relation), conditions, self.symbols.signed, theory)

    def _exactly_where(self, each: Equation, whole: Relation, iff: Relation) -> Answer:
        """Whether a rule holds where its condition does, and nowhere else."""
        there = self._decided(each, whole, iff)
        if not there.holds:
            return there._replace(why=there.why or f"does not hold wherever {iff}")
        elsewhere = self._decided(each, iff, whole)
        if not elsewhere.holds:
            return elsewhere._replace(why=elsewhere.why or f"holds wherever {iff}, but also where that is not so")
        return Answer(True, _both(there, elsewhere))

    def _least(self, each: Equation, whole: Relation) -> Answer:
        """Whether the quantity is least where the symbol on the left has the values on the right, and only there."""
        over = self._side(each, whole.sides[0])
        if over.op != "name":
            raise AuditError(f"{whole.sides[0]} is {over} here; least= asks for a symbol without a definition")
        if set(whole.signs) - {"="}:
            return Answer(False, why=f"{each.least} is least at one value of {whole.sides[0]}, not in a range")
        found = Answer(True)
        for side in whole.sides[1:]:
            answer = self._least_at(each, over.name, self._side(each, side))
            if not answer.holds:
                return answer
            found = Answer(True, _both(found, answer) if found.agreed_by else answer.agreed_by)
        return found

    def _least_at(self, each: Equation, over: str, value: Formula) -> Answer:
        assert each.least is not None
        if over in value.names:
            return Answer(False, why=f"{over} stands on both sides")
        least, signed = self._side(each, each.least), self.symbols.signed
        when = [self._expanded(each, one) for one in each.when]
        others = [one for one in when if over not in self._names(one)]
        for one in when:
            met = one if one in others else decide(one.replaced({over: value}), others, signed)
            if isinstance(met, Answer) and not met.holds:
                return met._replace(why=met.why or f"{one} does not hold where {over} = {value}")
        elsewhere = Relation((_square_of(symbol(over), value), constant(0)), (">",))
        higher = Relation((least, least.replaced({over: value})), (">",))
        return decide(higher, [*when, elsewhere], signed, [least])

    def _close(self, each: Equation) -> Answer:
        """Whether all sides differ by at most the neglected share of what is true, the left one; in squares."""
        assert each.neglecting is not None
        whole = each.whole(each.relation)
        if set(whole.signs) - {"="}:
            return Answer(False)
        left, found = whole.sides[0], Answer(True)
        share = Formula("*", (each.neglecting, left))
        for right in whole.sides[1:]:
            close = Relation((_square_of(left, right), Formula("*", (share, share))), ("<=",))
            answer = self._decided(each, close)
            if not answer.holds:
                return answer
            found = Answer(True, _both(found, answer) if found.agreed_by else answer.agreed_by)
        return found

    def _negligible(self, each: Equation) -> tuple[str, ...]:
        """Refuse to neglect what is not small for all admissible values; the assumed ones that it rests on."""
        if each.neglecting is None:
            return ()
        share = self.symbols.bound_formula(each.neglecting, "1", each.given or {})
        if share.free:
            raise AuditError(f"neglecting={each.neglecting}: give {', '.join(share.free)} a value, so that it is small")
        try:
            most = share.everywhere()
        except ArithmeticError as error:
            raise AuditError(f"neglecting={each.neglecting} cannot be evaluated: {error}") from None
        if not 0 <= most.low <= most.high <= NEGLIGIBLE:
            told = f"{float(most.low):.3g} .. {float(most.high):.3g}"
            raise AuditError(f"neglecting={each.neglecting} is {told}; 0 .. {float(NEGLIGIBLE):g} may be neglected")
        return share.assumed

    def _side(self, each: Equation, side: Formula) -> Formula:
        return self.symbols.expanded(side, each.given or {}, values=False)

    def _expanded(self, each: Equation, relation: Relation) -> Relation:
        return Relation(tuple(self._side(each, side) for side in relation.sides), relation.signs)

    def _same_units(self, whole: Relation) -> None:
        units = self.symbols.units(self._names(whole))
        first = dimension(whole.sides[0], units)
        for side in whole.sides[1:]:
            other = dimension(side, units)
            if other != first and side.names:
                left, right = (Unit(Fraction(1), each).named() for each in (first, other))
                raise Mismatch(f"{whole.sides[0]} is {left}, {side} is {right}")

    def _names(self, relation: Relation) -> set[str]:
        return set().union(*(side.names for side in relation.sides))

    # --- what was meant ----------------------------------------------------------------------------------------------

    def _mended(self, each: Equation, answer: Answer, unheard: Sequence[str], wrong_units: str) -> Judged:
        """A misprint where one other symbol makes it true and something independent speaks for that one."""
        found = [
            (f"{new} printed as {old}", mended, evidence)
            for old, new, mended in self._slips(each, unheard)
            if (evidence := self._evidence(old, new, unheard))
        ]
        if found:
            slip, mended, evidence = found[0]
            others = "; ".join(f"or {slip}" for slip, _, _ in found[1:])
            note = "; ".join(filter(None, (wrong_units, others)))
            return Judged(MISPRINT, str(mended), note, str(mended), slip, evidence)
        at = {name: decimal(value) for name, value in (answer.point or {}).items()}
        why = f"{', '.join(unheard)} is defined nowhere" if unheard else wrong_units
        told = () if why else (answer.why, self._difference(each, answer), self._only_where(each), self._flip(each))
        return Judged(INCONSISTENT, self._theory(each), why or "; ".join(filter(None, told)), counterexample=at)

    def _evidence(self, old: str, new: str, unheard: Sequence[str]) -> tuple[str, ...]:
        """What speaks for another symbol in place of the printed one, besides that it makes the equation true."""
        nowhere = f"{old} is defined nowhere" if old in unheard else ""
        elsewhere = f"{new} stands in {', '.join(self.used[new])}" if self.used.get(new) else ""
        return tuple(filter(None, (nowhere, elsewhere)))

    def _slips(self, each: Equation, unheard: Sequence[str]) -> Iterator[tuple[str, str, Relation]]:
        """Every true relation that one other symbol in one place makes; a symbol defined nowhere has to go.

        Of a bare inequality there are too many: any larger quantity makes it true.
        """
        if each.iff is None and not unheard and set(each.relation.signs) - {"="}:
            return
        for old, put in each.relation.slipped():
            if len(unheard) > 1 or (unheard and old not in unheard):
                continue
            for new in filter(old.__ne__, self.symbols.of):
                with contextlib.suppress(AuditError):
                    if not self._trivial(each, put(new)) and self.holds(each, put(new)).holds:
                        yield old, new, put(new)

    def _trivial(self, each: Equation, mended: Relation) -> bool:
        """Whether it says that something equals itself."""
        sides = each.whole(mended).sides
        return len(set(sides)) < len(sides)

    def _difference(self, each: Equation, answer: Answer) -> str:
        if answer.point is None:
            return ""
        at, told = {name: Span(value) for name, value in answer.point.items()}, []
        for side in each.whole(each.relation).sides:
            with contextlib.suppress(ArithmeticError, KeyError):  # a side without a meaning, or free of the point
                value = self._side(each, side).over(NUMBERS, at)
                told.append(f"{side} = {float(value.middle):.{DIGITS}g}")
        where = ", ".join(f"{name} = {decimal(value)}" for name, value in answer.point.items())
        return f"at {where}" + (f": {', '.join(told)}" if told else "")

    def _only_where(self, each: Equation) -> str:
        """The symbol that has to be 0 for the equation to be true, if there is one."""
        if each.least is not None or each.iff is not None or set(each.relation.signs) - {"="}:
            return ""
        expanded, *when = (self._expanded(each, one) for one in (each.whole(each.relation), *each.when))
        for name in sorted(self._names(expanded)):
            zero = {name: constant(0)}
            try:
                if decide(expanded.replaced(zero), [one.replaced(zero) for one in when], self.symbols.signed).holds:
                    return f"true where {name} = 0"
            except AuditError:
                continue
        return ""

    def _flip(self, each: Equation) -> str:
        """Whether an inequality is true the other way round."""
        signs = each.relation.signs
        if len(signs) != 1 or signs[0] not in FLIPPED:
            return ""
        other = Relation(each.relation.sides, (FLIPPED[signs[0]],))
        return f"reversed: true is {other}" if self.holds(each, other).holds else ""

    def _theory(self, each: Equation) -> str:
        """What the left side is by the theory; the printed relation where that does not define it."""
        left = each.whole(each.relation).sides[0]
        theory = self._side(each, left)
        return str(each.relation) if theory == left else f"{left} = {theory}"


def _both(a: Answer, b: Answer) -> tuple[str, ...]:
    """The solvers that agree on two answers."""
    return tuple(dict.fromkeys(who for who in (*a.agreed_by, *b.agreed_by) if who in b.agreed_by or "points" in who))


def _square_of(a: Formula, b: Formula) -> Formula:
    difference = Formula("-", (a, b))
    return Formula("*", (difference, difference))

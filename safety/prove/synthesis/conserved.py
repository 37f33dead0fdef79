"""Conserved forms: whole-number combinations of registers whose change in a step is a combination of the inputs.

A pulse that moves between phase, divider and counter cancels in such a form, so it tells how far one train of pulses is
ahead of another to the last fraction of a pulse.  The forms are the integer null space of sampled differences, exact;
no register is named: each register is looked at with what its next value reads.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import gcd
from typing import TYPE_CHECKING, Any, cast

from safety.prove.flows import as_int, is_whole
from safety.prove.synthesis.sampling import Steps
from safety.system import State
from safety.terms import Int
from safety.terms.graph import Term, postorder, variables

if TYPE_CHECKING:
    import numpy.typing as npt

    Matrix = npt.NDArray[Any]

ROWS = 3  # sampled steps for each column
MOST_COLUMNS = 40
FEW = 8  # registers that are looked at all together


@dataclass(frozen=True, eq=False)
class Form:
    """Coefficients times registers (or products of two); a step changes it by `change`: inputs, points, None for 1."""

    terms: tuple[tuple[int, tuple[Term, ...]], ...]
    change: tuple[tuple[Term | None, int], ...]

    @property
    def key(self) -> tuple[object, object]:
        """What tells the form from others."""
        change = tuple((v.uid if v is not None else -1, c) for v, c in self.change)
        return tuple((c, *(v.uid for v in factors)) for c, factors in self.terms), change

    @property
    def steady(self) -> int | None:
        """By how much every step changes the form; None where that depends on inputs."""
        if any(v is not None for v, _ in self.change):
            return None
        return sum(c for _, c in self.change)

    @property
    def product(self) -> bool:
        """Whether registers are multiplied with one another."""
        return any(len(factors) > 1 for _, factors in self.terms)

    @property
    def registers(self) -> list[Term]:
        """The registers of the form."""
        return distinct(v for _, factors in self.terms for v in factors)

    def term(self) -> Int:
        """The form as a term."""
        return combination(self.terms)


def combination(terms: Iterable[tuple[int, tuple[Term, ...]]]) -> Int:
    """Sum of coefficients times products of registers."""
    total: Any = None
    for c, factors in terms:
        product: Any = as_int(factors[0])
        for v in factors[1:]:
            product = product * as_int(v)
        part = product if c == 1 else product * c
        total = part if total is None else total + part
    return cast(Int, total)


def distinct(terms: Iterable[Term]) -> list[Term]:
    """Each term once, in order."""
    return list({v.uid: v for v in terms}.values())


def forms(steps: Steps, group: Sequence[State], watching: Sequence[State], free: Sequence[Term]) -> list[Form]:
    """The conserved forms of a group of registers: with wraps taken for pulses, and with wraps taken for resets.

    `free` are the inputs and points that a change may depend on.  A register that never changes here, and one that
    watches and stands still, may also be a factor.
    """
    moving = [s for s in group if is_whole(s.var) and s.next is not s.var]
    factors = {s.var.uid for s in watching}
    rigid = [s.var for s in group if is_whole(s.var) and s.next is s.var]
    saturating = _saturating(steps, moving)
    resets, all_jumps = (jumps(steps, moving, wraps) for wraps in (False, True))
    found: dict[object, Form] = {}
    for clean in (~saturating, ~saturating & ~resets, ~saturating & ~all_jumps):
        differences = [(s.var, _difference(steps, (s.var,))[clean]) for s in moving]
        still = [x for x, d in differences if not d.any() and x.uid in factors]
        columns: list[tuple[Any, Matrix]] = [((x,), d) for x, d in differences if d.any()]
        moved = [key for (key,), _ in columns]
        columns += [((p, x), _difference(steps, (p, x))[clean]) for p in (*rigid, *still) for x in moved]
        values = [(v, steps.inputs[v.uid][clean]) for v in free if is_whole(v)]
        values += [(p, steps.before[p.uid][clean]) for p in rigid]
        columns += _varying([(v, column.astype(object)) for v, column in values])
        columns.append((None, _ones(int(clean.sum()))))
        if moved and len(columns) <= MOST_COLUMNS and clean.sum() >= ROWS * len(columns):
            found |= {f.key: f for f in _without_clocks(_null_space(columns))}
    return [*found.values(), *_differences(list(found.values()))]


def _differences(found: Sequence[Form]) -> list[Form]:
    """Forms that change by the same inputs, one less the other."""
    pairs = itertools.combinations([f for f in found if f.steady is None], 2)
    return [minus(f, g) for f, g in pairs if f.key[1] == g.key[1]]


def minus(f: Form, g: Form) -> Form:
    """The difference of two forms that change alike."""
    terms: dict[tuple[int, ...], tuple[int, tuple[Term, ...]]] = {}
    for sign, form in ((1, f), (-1, g)):
        for c, factors in form.terms:
            key = tuple(v.uid for v in factors)
            terms[key] = (terms.get(key, (0, factors))[0] + sign * c, factors)
    return Form(tuple(t for t in terms.values() if t[0]), ())


def _same(x: tuple[Term, ...], y: tuple[Term, ...]) -> bool:
    return [v.uid for v in x] == [v.uid for v in y]


def _varying(columns: list[tuple[Any, Matrix]]) -> list[tuple[Any, Matrix]]:
    """The columns without those that are constant or equal to an earlier one."""
    kept: dict[bytes, tuple[Any, Matrix]] = {}
    for key, values in columns:
        if len(values) and (values != values[0]).any():
            kept.setdefault(repr(values[:200].tolist()).encode(), (key, values))
    return list(kept.values())


def _without_clocks(found: list[Form]) -> list[Form]:
    """The forms, a steady change of each taken out by a register that counts steps."""
    clock = next((f for f in found if len(f.terms) == 1 and f.steady == 1 and f.terms[0][0] == 1), None)
    if clock is None:
        return found
    result = [clock]
    for form in found:
        steady = sum(c for v, c in form.change if v is None)
        if form is clock:
            continue
        ((_, key),) = clock.terms
        kept = tuple((c, k) for c, k in form.terms if not _same(k, key))
        merged = sum(c for c, k in form.terms if _same(k, key)) - steady
        terms = (*kept, (merged, key)) if merged else kept
        if terms:
            result.append(Form(terms, tuple((v, c) for v, c in form.change if v is not None)))
    return result


def _ones(n: int) -> Matrix:
    import numpy as np

    return np.ones(n, dtype=np.int64)


def _difference(steps: Steps, factors: tuple[Term, ...]) -> Matrix:
    before: Any = 1
    after: Any = 1
    for v in factors:
        before, after = before * steps.before[v.uid].astype(object), after * steps.after[v.uid].astype(object)
    return cast("Matrix", after - before)


def _saturating(steps: Steps, group: Sequence[State]) -> Matrix:
    """Steps in which a register stands at an end of its range at which it stops instead of wrapping."""
    import numpy as np

    found = np.zeros(len(steps), dtype=bool)
    for s in group:
        before, after = steps.before[s.var.uid], steps.after[s.var.uid]
        if not len(before):
            continue
        low, high = int(before.min()), int(before.max())
        for end in (low, high):
            at_end = before == end
            if high > low and not (2 * abs(after[at_end] - end) > high - low).any():
                far = abs(after - before)
                strides = bool(((far > 1) & (after != end) & (2 * far < high - low)).any())
                found |= at_end | ((after == end) & (2 * far < high - low) & strides)
    return found


def jumps(steps: Steps, group: Sequence[State], wraps: bool) -> Matrix:
    """Steps in which a register goes to a constant instead of counting; `wraps`: from its top to its bottom too."""
    import numpy as np

    found = np.zeros(len(steps), dtype=bool)
    for s in group:
        before, after = steps.before[s.var.uid], steps.after[s.var.uid]
        low = s.var.sort.bounds[0]
        down = bool(((after - before == -1) & (after > low)).any())
        constants = {int(t.attr) for t in postorder([s.next]) if t.is_const and is_whole(t)}
        for reset in {low, *constants, *([s.power_up] if type(s.power_up) is int else [])}:
            far = abs(after - before) > 1
            jump = (after == reset) & (far | ((before - after == 1) & (reset == low) & (not down)))
            found |= jump if wraps or not len(before) else jump & ((before != before.max()) | (reset != low))
    return found


def _null_space(columns: Sequence[tuple[Any, Matrix]]) -> list[Form]:
    """Reduced integer basis of the combinations that vanish in every row; rows are taken in until all of them do."""
    import numpy as np
    from flint import fmpz_mat

    n = len(columns)
    table = np.array([values.astype(object) for _, values in columns], dtype=object).T
    chosen = list(range(min(len(table), ROWS * n)))
    for _ in range(n + 1):
        basis, rank = fmpz_mat([[int(x) for x in table[k]] for k in chosen]).nullspace()
        if not rank:
            return []
        vectors = np.array([[int(basis[i, j]) for i in range(n)] for j in range(rank)], dtype=object)
        wrong = [int(np.flatnonzero(residue)[0]) for residue in (table @ v for v in vectors) if residue.any()]
        if not wrong:
            break
        chosen += wrong
    reduced = fmpz_mat([list(v) for v in vectors]).lll()
    found = [[int(reduced[j, i]) for i in range(n)] for j in range(rank)]
    return [f for f in (_form(v, columns) for v in found) if f is not None]


def _form(vector: Sequence[int], columns: Sequence[tuple[Any, Matrix]]) -> Form | None:
    divisor = gcd(*vector)
    sign = 1
    terms = [(c // divisor, key) for c, (key, _) in zip(vector, columns, strict=True) if c and isinstance(key, tuple)]
    if not terms:
        return None
    if terms[0][0] < 0:
        sign = -1
    change = [
        (key, -sign * c // divisor)
        for c, (key, _) in zip(vector, columns, strict=True)
        if c and not isinstance(key, tuple)
    ]
    return Form(tuple((sign * c, key) for c, key in terms), tuple(change))


def units(states: Sequence[State]) -> list[Form]:
    """Each register as a form by itself."""
    return [Form(((1, (s.var,)),), ()) for s in states if is_whole(s.var) and s.next is not s.var]


def pairs(states: Sequence[State], groups: Sequence[Sequence[State]], watching: Sequence[State]) -> list[Form]:
    """Sums and differences of two registers that are read together, or of which one watches."""
    together = [{s.var.uid for s in group} for group in groups]
    watch = {s.var.uid for s in watching}
    moving = [s.var for s in states if is_whole(s.var) and s.next is not s.var]
    found = []
    for x, y in itertools.combinations(moving, 2):
        if {x.uid, y.uid} & watch or any({x.uid, y.uid} <= group for group in together):
            found += [Form(((1, (x,)), (sign, (y,))), ()) for sign in (1, -1)]
    return found


def groups(states: Sequence[State], watching: Sequence[State]) -> list[list[State]]:
    """For each register the registers that its next value reads, itself and those that watch; each group once.

    Few registers are looked at all together as well.
    """
    by_uid = {s.var.uid: s for s in states}
    found: dict[frozenset[int], list[State]] = {}
    for s in states:
        if is_whole(s.var) and s.next is not s.var:
            read = [by_uid[v.uid] for v in variables([s.next]) if v.uid in by_uid]
            members = {m.var.uid: m for m in [s, *read, *watching] if is_whole(m.var)}
            found[frozenset(members)] = list(members.values())
    everything = {s.var.uid: s for s in states if is_whole(s.var)}
    if len(everything) <= FEW:
        found[frozenset(everything)] = list(everything.values())
    return sorted(found.values(), key=len, reverse=True)


def reads(states: Iterable[State], of: Iterable[Term]) -> list[Term]:
    """The terms among `of` that the next values of registers are made from."""
    known = {t.uid for t in of}
    return [t for t in postorder(s.next for s in states) if t.uid in known]

"""Graphs to compare readings on: random ones for hypothesis, and for every operation a few that lie on its edges."""

import itertools
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

from hypothesis import strategies as st

from safety.terms import Bit, UInt, bit, implies, real, select, word
from safety.terms.graph import BIT, REAL, Sort, Term, integer, node, uint, variable
from safety.terms.table import OPERATIONS
from safety.terms.values import const

WIDTHS = (1, 2, 7, 8, 9, 31, 32, 33, 63, 64, 65, 128)
RANGES = (
    *((0, 0), (-1, 0), (3, 9), (-9, -2), (-8, -8), (-128, 127), (-7, 300), (-(2**31), 5)),
    *((-(2**63), 2**63 - 1), (-(2**63) - 1, 3), (-1, 2**63), (-(2**64), 2**64), (2**63, 2**65)),
)
WIDEST = 300  # bits: beyond them nothing new happens, and solvers slow down

Graph = tuple[list[Term], list[dict[Term, Any]]]  # outputs, and the inputs of several lanes


def edges(sort: Sort) -> list[Any]:
    """Values where something can go wrong."""
    if sort.kind == "bit":
        return [False, True]
    if sort.kind == "real":
        return [Fraction(0), Fraction(-1), Fraction(1, 3), Fraction(-22, 7), Fraction(2**70 + 1, 3)]
    low, high = sort.bounds
    near = (low, low + 1, -1, 0, 1, 200, high // 2, high // 2 + 1, high - 1, high)
    return sorted({value for value in near if low <= value <= high})


def values(sort: Sort) -> st.SearchStrategy[Any]:
    some = st.sampled_from(edges(sort))
    if sort.kind == "bit":
        return some
    if sort.kind == "real":
        return some | st.builds(Fraction, st.integers(-1000, 1000), st.integers(1, 12))
    return some | st.integers(*sort.bounds)


# --- random graphs -------------------------------------------------------------------------------------------------

SORTS = {
    "bit": st.just(BIT),
    "uint": st.sampled_from(WIDTHS).map(uint),
    "int": st.sampled_from(RANGES).map(lambda r: integer(*r)),
    "real": st.just(REAL),
}


class Maker:
    """A pool of terms that grows by one operation at a time, each from terms that are there."""

    def __init__(self, draw: Callable[[st.SearchStrategy[Any]], Any], reals: bool) -> None:
        self.draw, self.reals = draw, reals
        self.numbers = ("uint", "int", "real") if reals else ("uint", "int")
        word_sort = draw(SORTS["uint"])
        sorts = [BIT, BIT, word_sort, word_sort, draw(SORTS["uint"]), draw(SORTS["int"]), draw(SORTS["int"])]
        self.pool: list[Term] = [variable(f"x{i}", s) for i, s in enumerate(sorts + [REAL, REAL] * reals)]
        self.inputs = list(self.pool)

    def any_of(self, *kinds: str) -> Any:
        return self.draw(st.sampled_from([t for t in self.pool if t.sort.kind in kinds]))

    def like(self, term: Term) -> Any:
        """A term, or a constant, of the same sort."""
        same = st.sampled_from([t for t in self.pool if t.sort == term.sort])
        return self.draw(same | values(term.sort).map(lambda value: const(value, term.sort)))

    def number(self) -> Any:
        return self.any_of(*self.numbers)

    def between(self, low: int, high: int) -> int:
        return int(self.draw(st.integers(low, high)))

    def grow(self, operation: str) -> None:
        made: Term = MAKERS[operation](self)
        if made.sort.kind in ("bit", "real") or all(abs(b) < 1 << WIDEST for b in made.sort.bounds):
            self.pool.append(made)


def _point(m: Maker) -> Term:
    x = m.any_of("bit", *m.numbers)
    x = m.like(x)
    return node("point", (x,), f"p{len(m.pool)}", x.sort)


def _const(m: Maker) -> Term:
    sort = m.draw(st.one_of(*(SORTS[kind] for kind in ("bit", *m.numbers))))
    return const(m.draw(values(sort)), sort)


def _cast(m: Maker) -> Any:
    x = m.any_of("uint", "int") if m.reals else m.any_of("uint")
    if x.sort.kind == "int" or (m.reals and m.draw(st.booleans())):
        return x.real()
    return x.int() if m.draw(st.booleans()) else x.widen(x.width + m.between(1, 3))


def _clip(m: Maker) -> Any:
    x = m.any_of("uint", "int")
    if x.sort.kind == "uint" or m.draw(st.booleans()):
        return x.sat(m.draw(st.sampled_from(WIDTHS)))
    return x.clip(*m.draw(st.sampled_from(RANGES)))


def _slice(m: Maker) -> Any:
    x = m.any_of("uint", "int")
    if x.sort.kind == "int" or m.draw(st.booleans()):
        return x.low(m.draw(st.sampled_from(WIDTHS)))
    start = m.between(0, x.width - 1)
    return x.slice(start, m.between(1, x.width - start))


def _select(m: Maker) -> Any:
    x = m.any_of("bit", *m.numbers)
    y = m.like(x) if x.sort.kind in ("bit", "uint") else m.number()
    if x.sort.kind == "int" and y.sort.kind == "real":
        return select(m.any_of("bit"), y, x)
    return select(m.any_of("bit"), x, y)


def _same_words(m: Maker) -> tuple[Any, Any]:
    x = m.any_of("uint")
    return x, m.like(x)


def _bit_of(m: Maker) -> Any:
    x = m.any_of("uint")
    return x.bit(m.between(0, x.width - 1))


DIVISORS = st.sampled_from([1, 2, 3, 7, 10, 255, 256, 2**31, 2**63 - 1, 2**63, 2**64 + 1, 2**130])

MAKERS: dict[str, Callable[[Maker], Any]] = {
    "const": _const,
    "point": _point,
    "not": lambda m: ~m.any_of("bit"),
    "and": lambda m: m.any_of("bit") & m.any_of("bit"),
    "or": lambda m: m.any_of("bit") | m.any_of("bit"),
    "xor": lambda m: m.any_of("bit") ^ m.any_of("bit"),
    "implies": lambda m: implies(m.any_of("bit"), m.any_of("bit")),
    "add": lambda m: m.number() + m.number(),
    "sub": lambda m: m.number() - m.number(),
    "mul": lambda m: m.number() * m.number(),
    "eq": lambda m: m.number() == m.like(m.number()) if m.draw(st.booleans()) else m.any_of("bit") == m.any_of("bit"),
    "lt": lambda m: m.number() < m.number(),
    "le": lambda m: m.number() <= m.number(),
    "select": _select,
    "cast": _cast,
    "clip": _clip,
    "slice": _slice,
    "bit": _bit_of,
    "concat": lambda m: m.any_of("uint").concat(m.any_of("uint")),
    "div": lambda m: m.any_of("uint") // m.draw(DIVISORS),
    "mod": lambda m: m.any_of("uint") % m.draw(DIVISORS),
    "band": lambda m: UInt.__and__(*_same_words(m)),
    "bor": lambda m: UInt.__or__(*_same_words(m)),
    "bxor": lambda m: UInt.__xor__(*_same_words(m)),
}


@st.composite
def graphs(draw: Any, reals: bool = False, lanes: int = 3, largest: int = 16) -> Graph:
    """A random graph over all operations, and values for its variables in some lanes."""
    maker = Maker(draw, reals)
    for operation in draw(st.lists(st.sampled_from(sorted(MAKERS)), min_size=1, max_size=largest)):
        maker.grow(operation)
    rows = [{v: draw(values(v.sort)) for v in maker.inputs} for _ in range(lanes)]
    return maker.pool, rows


# --- graphs on the edges of each operation -------------------------------------------------------------------------


def _words(*widths: int) -> Iterator[Any]:
    return (variable(f"u{i}_{width}", uint(width)) for i, width in enumerate(widths))


def _ints(*ranges: tuple[int, int]) -> Iterator[Any]:
    return (variable(f"i{i}_{low}_{high}", integer(low, high)) for i, (low, high) in enumerate(ranges))


P: Any = variable("p", BIT)
Q: Any = variable("q", BIT)
R: Any = variable("r", REAL)
S: Any = variable("s", REAL)
A8, B8, N4, A64, B64 = _words(8, 8, 4, 64, 64)
A63, B63 = _words(63, 63)
H, J, K, L, INT64, BIG = _ints((-7, 300), (-9, -2), (-128, 127), (-8, 7), (-(2**63), 2**63 - 1), (-(2**64), 2**64))
PAIRS = [
    *((A8, B8), (A8, N4), (N4, A8), (A8, H), (H, A8), (A8, K), (K, L), (L, H), (H, J)),
    *((A64, B64), (A63, B63), (A8, A64), (BIG, A8), (J, BIG), (INT64, A8), (INT64, L)),
]


def _pairs(f: Callable[[Any, Any], Any], reals: bool = True) -> list[Term]:
    return [f(x, y) for x, y in PAIRS] + ([f(R, S), f(A8, R), f(R, H)] if reals else [])


def _fixed(value: Any, sort: Sort, name: str) -> Any:
    """A point that carries a constant: it stays in the graph."""
    return node("point", (const(value, sort),), name, sort)


EDGES: dict[str, list[Any]] = {
    "const": [
        *(
            bit(True),
            bit(False) ^ P,
            word(200, 8) < A8,
            A64 + word(2**64 - 1, 64),
            H + 5,
            R + Fraction(1, 3),
            real(-2) < R,
        ),
        *(const(b, BIG.sort) for b in BIG.sort.bounds),
    ],
    "point": [
        *(node("point", (x,), f"here {x.attr}", x.sort) for x in (P, A8, A64, H, R)),
        *(_fixed(True, BIT, "on") & P, _fixed(9, uint(8), "nine") + A8, _fixed(2**70, uint(71), "big")),
    ],
    "not": [~P, ~_fixed(True, BIT, "on"), ~_fixed(True, BIT, "on") | P],
    "and": [P & Q],
    "or": [P | Q],
    "xor": [P ^ Q],
    "implies": [implies(P, Q), implies(_fixed(True, BIT, "on"), Q)],
    "add": _pairs(lambda x, y: x + y),
    "sub": _pairs(lambda x, y: x - y),
    "mul": [*_pairs(lambda x, y: x * y), _fixed(3 * 2**60, uint(63), "a").low(62) * select(P, INT64, L)],
    "eq": [*_pairs(lambda x, y: x == y), P == Q],
    "lt": _pairs(lambda x, y: x < y),
    "le": _pairs(lambda x, y: x <= y),
    "select": [
        *(select(P, x, y) for x, y in ((P ^ Q, Q), (A8, B8), (A64, B64), (H, J), (H, A8), (J, BIG), (R, S), (R, A8))),
        *(select(P, const(2**63, uint(64)), const(5, uint(64))), select(P, word(1, 1), word(0, 1))),
    ],
    "cast": [
        *(A8.widen(9), N4.widen(64), A64.widen(65), A63.widen(64), A8.int(), A64.int()),
        select(P, K, H),
        A8.real(),
        H.real(),
        BIG.real(),
    ],
    "clip": [
        *(A8.sat(4), A64.sat(8), H.sat(4), H.sat(64), J.sat(8), BIG.sat(8), BIG.sat(64)),
        H.clip(-3, 9),
        J.clip(2, 5),
        (A8 + B8).sat(8),
        variable("near 0", integer(3, 200)).clip(-3, 150),  # type: ignore[attr-defined]
    ],
    "slice": [
        *(A8.low(7), A8.low(1), A8.slice(1, 3), A8.slice(3, 5), A64.slice(1, 62), A64.slice(32, 32), (A8 + B8).low(8)),
        *(
            H.low(4),
            H.low(8),
            H.low(64),
            J.low(4),
            J.low(63),
            J.low(128),
            BIG.low(64),
            (N4 - 3).low(4),
            (A8 * 7).low(8),
        ),
    ],
    "bit": [A8.bit(0), A8.bit(3), A8.bit(7), A64.bit(63), A64.bit(31), (A8 + B8).bit(8)],
    "concat": [A8.concat(N4), N4.concat(A8), A8.concat(A64), A64.concat(A8), N4.concat(A63)],
    "div": [*(A8 // n for n in (1, 3, 10, 255, 256, 300, 2**70)), A64 // 3, A64 // 2**63, A63 // 2**63],
    "mod": [*(A8 % n for n in (1, 3, 10, 255, 256, 300, 2**70)), A64 % 3, A64 % 2**63, A63 % 2**63],
    "band": [A8 & B8, A64 & B64, A8 & 0xF0],
    "bor": [A8 | B8, A64 | B64, A8 | 0xF0],
    "bxor": [A8 ^ B8, A64 ^ B64, ~A8, ~A64],
}


def edge_rows(outputs: list[Term], most: int = 30) -> list[dict[Term, Any]]:
    """Edge values of the variables in combination, thinned out evenly."""
    from safety.terms.graph import variables

    inputs = variables(outputs)
    rows = [dict(zip(inputs, row, strict=True)) for row in itertools.product(*(edges(v.sort) for v in inputs))]
    return rows[:: -(-len(rows) // most)] + rows[-1:]


def edge_graphs(operation: str) -> Iterator[Graph]:
    """Small graphs of an operation with values on its edges."""
    for output in EDGES[operation]:
        yield [output], edge_rows([output])


assert EDGES.keys() == MAKERS.keys() == OPERATIONS.keys() - {"var"}
assert isinstance(P, Bit)

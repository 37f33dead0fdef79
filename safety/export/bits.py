"""The bit-level reading of terms: one column beside those of `safety.terms.table`, for and-inverter graphs.

An entry takes the graph, the term and the words of its arguments.  A wire is a word of one bit, a bounded integer has
as many bits of two's complement as its range needs.  It shares nothing with the solver columns but the terms, so that
an error in one of them shows.  A real has no bits: `TermError`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from safety.export.gates import FALSE, Gates, Word, constant, invert
from safety.terms.graph import Sort, Term, TermError, describe, postorder

Entry = Callable[..., Word]


def bits_of(sort: Sort) -> int:
    """Bits of a sort: a wire has 1, a word its width, an integer those of two's complement; a real has none."""
    if sort.kind == "bit":
        return 1
    if sort.kind == "uint":
        return sort.width
    low, high = sort.bounds
    bits = 1
    while not (-(1 << bits - 1) <= low and high < 1 << bits - 1):
        bits += 1
    return bits


def fitted(x: Word, sort: Sort, bits: int) -> Word:
    """The word of a value of `sort`, extended by its own sign rule, or cut, to `bits`."""
    above = x[-1] if sort.kind == "int" else FALSE
    return (x + (above,) * (bits - len(x)))[:bits]


def _signed(*sorts: Sort) -> int:
    """Bits of two's complement that hold the values of all these sorts."""
    return max(bits_of(s) + (s.kind != "int") for s in sorts)


def _pair(t: Term, x: Word, y: Word, bits: int) -> tuple[Word, Word]:
    return fitted(x, t.args[0].sort, bits), fitted(y, t.args[1].sort, bits)


def _arithmetic(name: str) -> Entry:
    """At the width of the result, which holds the exact value."""
    return lambda g, t, x, y: getattr(g, name)(*_pair(t, x, y, bits_of(t.sort)))


def _gate(f: Callable[[Gates, int, int], int]) -> Entry:
    """A gate on each pair of bits."""
    return lambda g, t, x, y: tuple(f(g, a, b) for a, b in zip(x, y, strict=True))


def _compared(f: Callable[[Gates, Word, Word], int]) -> Entry:
    """A comparison of the exact values, in two's complement."""
    return lambda g, t, x, y: (f(g, *_pair(t, x, y, _signed(*(a.sort for a in t.args)))),)


def _clip(g: Gates, t: Term, x: Word) -> Word:
    source = t.args[0].sort
    bits = _signed(source, t.sort)
    x = fitted(x, source, bits)
    low, high = (constant(b, bits) for b in t.sort.bounds)
    inside = g.pick(g.below_signed(x, low), low, g.pick(g.below_signed(high, x), high, x))
    return inside[: bits_of(t.sort)]


def _slice(g: Gates, t: Term, x: Word) -> Word:
    start, count = t.attr
    return fitted(x, t.args[0].sort, max(len(x), start + count))[start : start + count]


GATES: dict[str, Entry] = {
    "const": lambda g, t: constant(int(t.attr), bits_of(t.sort)),
    "point": lambda g, t, x: x,
    "not": lambda g, t, x: invert(x),
    "and": _gate(Gates.both),
    "or": _gate(Gates.either),
    "xor": _gate(Gates.differ),
    "implies": _gate(lambda g, a, b: g.either(a ^ 1, b)),
    "add": _arithmetic("add"),
    "sub": _arithmetic("subtract"),
    "mul": _arithmetic("multiply"),
    "eq": _compared(Gates.same),
    "lt": _compared(Gates.below_signed),
    "le": _compared(lambda g, x, y: g.below_signed(y, x) ^ 1),
    "select": lambda g, t, c, x, y: g.pick(c[0], x, y),
    "cast": lambda g, t, x: fitted(x, t.args[0].sort, bits_of(t.sort)),
    "clip": _clip,
    "slice": _slice,
    "bit": lambda g, t, x: (x[t.attr],),
    "concat": lambda g, t, x, y: y + x,
    "div": lambda g, t, x: fitted(g.divide(x, t.attr)[0], t.args[0].sort, bits_of(t.sort)),
    "mod": lambda g, t, x: fitted(g.divide(x, t.attr)[1], t.args[0].sort, bits_of(t.sort)),
    "band": _gate(Gates.both),
    "bor": _gate(Gates.either),
    "bxor": _gate(Gates.differ),
}


def refuse_real(term: Term) -> None:
    """Raise `TermError` for a term without a bit-level reading."""
    if term.sort.kind == "real":
        raise TermError(f"{describe(term)} is a real: it has no bits; write SMT-LIB or VMT over integers")


class Bits:
    """Reads terms into a graph.  Every variable is bound to a word first, with `bind`."""

    def __init__(self, gates: Gates) -> None:
        self.gates = gates
        self.known: dict[int, Word] = {}

    def bind(self, term: Term, word: Word) -> None:
        """Use `word` wherever `term` stands; `TermError` unless it has as many bits as the sort."""
        if len(word) != bits_of(term.sort):
            raise TermError(f"{describe(term)}: {term.sort} has {bits_of(term.sort)} bits, not {len(word)}")
        self.known[term.uid] = word

    def __call__(self, terms: Iterable[Term]) -> list[Word]:
        """The words of the terms.  Raises `TermError` for a real and for a variable that is not bound."""
        terms = list(terms)
        for term in postorder(terms, self.known):
            refuse_real(term)
            if term.op == "var":
                raise TermError(f"{describe(term)} is not bound to a word")
            self.known[term.uid] = GATES[term.op](self.gates, term, *(self.known[a.uid] for a in term.args))
        return [self.known[t.uid] for t in terms]

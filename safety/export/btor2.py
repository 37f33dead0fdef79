"""A claim as a word-level BTOR2 file.

Source: A. Niemetz, M. Preiner, C. Wolf, A. Biere, Btor2, BtorMC and Boolector 3.0, 2018.
"""

from __future__ import annotations

from safety.export.expressions import BOOL, Expression, Names, Reading, Width, below
from safety.export.transition import Problem, power_up, transition
from safety.terms.graph import Value

FIRST = "tool.first"
_NAMED = {
    **{"not": "not", "and": "and", "or": "or", "xor": "xor", "=>": "implies", "ite": "ite", "=": "eq"},
    **{"bvand": "and", "bvor": "or", "bvxor": "xor", "bvadd": "add", "bvsub": "sub", "bvmul": "mul"},
    **{"bvult": "ult", "bvule": "ulte", "bvslt": "slt", "bvsle": "slte", "bvudiv": "udiv", "bvurem": "urem"},
    **{"concat": "concat", "zero_extend": "uext", "sign_extend": "sext", "extract": "slice"},
}


class _Lines:
    """The lines written so far; each has a number."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.sorts: dict[int, int] = {}
        self.nodes: dict[int, int] = {}

    def add(self, *words: object) -> int:
        """A new line; its number."""
        number = len(self.lines) + 1
        self.lines.append(" ".join(str(word) for word in (number, *words)))
        return number

    def sort(self, sort: Width) -> int:
        """The line of a sort; a truth value is a word of one bit."""
        bits = 1 if sort == BOOL else int(sort)
        if bits not in self.sorts:
            self.sorts[bits] = self.add("sort", "bitvec", bits)
        return self.sorts[bits]

    def variable(self, kind: str, x: Expression) -> int:
        """A state or an input."""
        self.nodes[x.number] = self.add(kind, self.sort(x.sort), x.attr)
        return self.nodes[x.number]

    def node(self, root: Expression) -> int:
        """The line of an expression, after those of what it is made of."""
        for x in below([root]):
            if x.number not in self.nodes:
                sort, args = self.sort(x.sort), [self.nodes[a.number] for a in x.args]
                if x.op == "const":
                    self.nodes[x.number] = self.add("constd", sort, int(x.attr))
                else:
                    self.nodes[x.number] = self.add(_NAMED[x.op], sort, *args, *_numbers(x.attr))
        return self.nodes[root.number]


def _numbers(attr: object) -> tuple[object, ...]:
    return () if attr is None else attr if isinstance(attr, tuple) else (attr,)


def btor2(problem: Problem, lemmas: bool = False) -> str:
    """The claim in BTOR2: its `bad` is unreachable under its constraints exactly if the claim holds for ever.

    `lemmas` have to hold as the claim does.  Signals and points are outputs.  Raises `TermError` for a claim over
    reals.
    """
    what = transition(problem, lemmas)
    reading = Reading(integers=False)
    file, names = _Lines(), Names(" \t\n")
    for v in what.inputs:
        file.variable("input", reading.bind(v, names.new(str(v.attr))))
    held = {s: _register(file, reading.bind(s.var, names.new(s.path)), power_up(s)) for s in what.states}
    first = reading.k.variable(names.new(FIRST), BOOL)
    start, given, holds, *following = reading([what.start, what.given, what.holds, *(s.next for s in what.states)])
    for (s, number), after in zip(held.items(), following, strict=True):
        file.add("next", file.sort(reading.sort(s.var.sort)), number, file.node(after))
    if what.has_start:
        number = _register(file, first, True)
        file.add("next", file.sort(BOOL), number, file.node(reading.k.BoolVal(False)))
        file.add("constraint", file.node(reading.k.Implies(first, start)))
    if not given.is_true:
        file.add("constraint", file.node(given))
    for path, term in what.named.items():
        file.add("output", file.node(reading([term])[0]), names.new(path))
    file.add("bad", file.node(reading.k.Not(holds)), names.new("violated"))
    return f"; {what.name}: a claim of rightside\n" + "\n".join(file.lines) + "\n"


def _register(file: _Lines, x: Expression, value: Value | None) -> int:
    """The line of a state; its power-up value stands before it, as the format demands."""
    if value is None:
        return file.variable("state", x)
    before = file.node(x.home.constant(int(value), x.sort))
    number = file.variable("state", x)
    file.add("init", file.sort(x.sort), number, before)
    return number

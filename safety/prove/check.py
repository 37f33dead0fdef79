"""Check a certificate of a proof: one file that needs Python, z3 and cvc5, and nothing of rightside.

    python check.py [--timeout SECONDS] FILE...

Exit code: 0 checked, 1 rejected, 2 not a certificate, 3 undecided, 4 weaker, 6 the engines disagree.  A certificate is
a zip of certificate.json, which says what is claimed, and for each obligation 1.smt2, 1.cnf and 1.lrat, which follow
from it and have to be, sign by sign, what is derived here again.  z3 and cvc5 have to find each text contradictory, and
the LRAT proof has to derive the empty clause from the clauses; where one of the three is missing, the certificate is
weaker.  Reals have no clauses: `checked (real)` is the two solvers.  In certificate.json a node is [operation,
arguments before it, attribute, sort], a register [name, variable, next, power-up value or null for any].  Numbers are
exact: each node's sort holds every value that its operation gives.  With lemmas L and depth d the obligations are

    start:     start, given at step 0              =>  each lemma at step 0
    step:      L, given at step 0, any registers   =>  each lemma at step 1
    property:  L at step 0, given at steps 0..d, holds before d  =>  holds at d;  and holds at 0..d-1 from the start

In clauses a number is a sum of products of two's-complement atoms, added atom by atom (variables alone before others),
multiplied row by row, divided by long division; gates are and, xor and majority; constants fold, equal gates are one.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import re
import sys
import zipfile
import zlib
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

FORMAT, MAIN, SOLVERS = "rightside certificate 1", "certificate.json", ("z3", "cvc5")
CHECKED, REAL, WEAKER, UNDECIDED, REJECTED = "checked", "checked (real)", "weaker", "undecided", "rejected"
UNREADABLE, DISAGREE = "not a certificate", "engines disagree"
EXIT = {CHECKED: 0, REAL: 0, WEAKER: 4, UNDECIDED: 3, REJECTED: 1, UNREADABLE: 2, DISAGREE: 6}  # best first
MOST_BYTES, MOST_NODES, MOST_BITS, MOST_GATES, MOST_STEPS, MOST_TERMS = 1 << 28, 100_000, 512, 2_000_000, 1000, 4096
TRUE, FALSE = 1, -1


class Malformed(Exception):
    """The file is no certificate."""


class Rejected(Exception):
    """The certificate does not prove what it says."""


def need(condition: object, place: str, expected: str) -> None:
    """Refuse the file unless the condition is met."""
    if not condition:
        raise Malformed(f"{place}: expected {expected}"[:500])


# --- what certificate.json says --------------------------------------------------------------------------------------


class Sort(NamedTuple):
    """`bit`, `real`, `word` (written u8) or `int` (written int[-3, 5])."""

    kind: str
    low: int = 0
    high: int = 1

    @property
    def whole(self) -> bool:
        """Whether its values are whole numbers."""
        return self.kind in ("word", "int")

    @property
    def bits(self) -> int:
        """Bits in two's complement, the sign included."""
        return 1 + max((b if b >= 0 else -b - 1).bit_length() for b in (self.low, self.high))


class Node(NamedTuple):
    """A term."""

    op: str
    args: tuple[int, ...]
    attr: Any
    sort: Sort


class Obligation(NamedTuple):
    """Formulas assumed at steps, and one to be shown; `anywhere`: from any register content."""

    label: str
    anywhere: bool
    assumed: tuple[tuple[int, int], ...]
    step: int
    shown: int


class Certificate(NamedTuple):
    """The json, read; `registers`: next node and power-up value by name."""

    nodes: list[Node]
    registers: dict[str, tuple[int, Any]]
    given: int
    start: int
    holds: int
    lemmas: dict[str, int]
    depth: int
    integers: bool


LOGIC, WORDS = ("not", "and", "or", "xor", "implies"), ("band", "bor", "bxor", "concat", "div", "mod")
ARITY = dict.fromkeys((*LOGIC, *WORDS, "add", "sub", "mul", "eq", "lt", "le"), 2) | {"const": 0, "var": 0, "select": 3}
ARITY |= dict.fromkeys(("point", "not", "cast", "clip", "slice", "bit", "div", "mod"), 1)
RANGES: dict[str, Callable[..., tuple[int, int]]] = {
    "add": lambda n, x, y: (x.low + y.low, x.high + y.high),
    "sub": lambda n, x, y: (x.low - y.high, x.high - y.low),
    "mul": lambda n, x, y: (min(c := [p * q for p in x[1:] for q in y[1:]]), max(c)),
    "select": lambda n, c, x, y: (min(x.low, y.low), max(x.high, y.high)),
    "cast": lambda n, x: x[1:],
    "slice": lambda n, x: (0, (1 << n[1]) - 1),
    "concat": lambda n, x, y: (0, (x.high << y.bits - 1) + y.high),
    "div": lambda n, x: (0, x.high // n),
    "mod": lambda n, x: (0, min(x.high, n - 1)),
    **dict.fromkeys(WORDS[:3], lambda n, x, y: (0, max(x.high, y.high))),
}


def well_sorted(op: str, attr: Any, sort: Sort, a: Sequence[Sort]) -> bool:
    """Whether an operation applies to these sorts, and its own has every value that it can take."""
    kinds, whole, real = {s.kind for s in a}, all(s.whole for s in a), all(s.kind == "real" for s in a)
    if op in LOGIC:
        return kinds | {sort.kind} == {"bit"}
    if op == "point":
        return a[0] == sort
    if op in ("eq", "lt", "le", "bit"):
        return sort.kind == "bit" and (whole or (real and op != "bit") or (op == "eq" and kinds == {"bit"}))
    if op == "select":
        if a[0].kind != "bit" or a[1] == a[2] == sort:
            return a[0].kind == "bit"
        whole = a[1].whole and a[2].whole
    if sort.kind == "real":
        return real if op in ("add", "sub", "mul") else whole and op == "cast"
    if not whole or not sort.whole or (op in WORDS and kinds | {sort.kind} != {"word"}):
        return False
    low, high = (sort.low, sort.high) if op == "clip" else RANGES[op](attr, *a)
    return sort.low <= low and high <= sort.high


def sort_of(text: Any, place: str) -> Sort:
    """The sort of a text."""
    found = re.fullmatch(r"bit|real|u(\d{1,3})|int\[(-?\d{1,200}), (-?\d{1,200})\]", text if type(text) is str else "")
    if found is None or found[0] == "u0":
        raise Malformed(f"{place}: expected a sort, bit, real, u8 or int[-3, 5], not {text!r}"[:300])
    low, high = (0, (1 << int(found[1] or 1)) - 1) if found[2] is None else (int(found[2]), int(found[3]))
    sort = Sort("int" if found[2] else "word" if found[1] else found[0], low, high)
    need(low <= high and sort.bits <= MOST_BITS, place, f"least and greatest value of less than {MOST_BITS} bits")
    return sort


def constant(value: Any, sort: Sort, place: str) -> Any:
    """The value that a constant of a sort stands for."""
    kind = {"bit": bool, "real": str}.get(sort.kind, int)
    fits = re.fullmatch(r"-?\d{1,400}(/[1-9]\d{0,399})?", value) if type(value) is str else not sort.whole
    fits = fits or (type(value) is int and sort.low <= value <= sort.high)
    need(type(value) is kind and fits, place, f'a {sort.kind} value, e.g. 7, true or "-1/3", not {value!r}')
    return Fraction(value) if sort.kind == "real" else value


def row(value: Any, length: int, place: str) -> list[Any]:
    """A list of so many entries."""
    need(type(value) is list and len(value) == length, place, f"a list of {length} entries")
    return list(value)


def name(value: Any, place: str, taken: Iterable[str] = ()) -> str:
    """A name that nothing else has, harmless in a text for solvers."""
    need(type(value) is str and re.fullmatch(r"[^|\\\x00-\x1f\x7f-\x9f\u2028\u2029]{1,300}", value), place, "a name")
    need(value not in taken, place, f"a name of its own, not {value!r} again")
    return str(value)


def node_of(entry: Any, before: Sequence[Node], place: str) -> Node:
    """One node, well sorted over those before it."""
    op, args, attr, text = row(entry, 4, place)
    need(type(op) is str and op in ARITY, place, f"an operation, not {op!r}")
    args, sort = row(args, ARITY[op], f"{place}, arguments of {op}"), sort_of(text, place)
    need(all(type(a) is int and 0 <= a < len(before) for a in args), place, f"arguments before it, not {args}")
    if op == "const":
        return Node(op, (), constant(attr, sort, place), sort)
    if op in ("var", "point"):
        name(attr, place)
    elif op in ("slice", "bit", "div", "mod"):
        least, most = (1, 1 << MOST_BITS - 1) if op in ("div", "mod") else (0, MOST_BITS)
        numbers = row(attr, 2, place) if op == "slice" else [attr]
        need(all(type(n) is int and least <= n < most for n in numbers), place, f"numbers for {op}, not {attr!r}")
    else:
        need(attr is None, place, f"no attribute of {op}")
    sorts = [before[a].sort for a in args]
    need(op == "var" or well_sorted(op, attr, sort, sorts), place, f"a sort for {op} of {sorts}, not {sort}")
    return Node(op, tuple(args), attr, sort)


def read(json_: Any) -> Certificate:
    """The certificate of a json, each reference to what it has to be; else `Malformed`."""
    kinds: dict[str, type] = dict.fromkeys(("nodes", "registers", "inputs", "lemmas", "obligations", "agreed_by"), list)
    kinds |= {"format": str, "claim": dict, "model": dict, "arithmetic": str, "depth": int}
    kinds |= {"given": int, "start": int, "holds": int}
    need(type(json_) is dict and json_.keys() == kinds.keys(), MAIN, f"an object with the keys {sorted(kinds)}")
    for key, kind in kinds.items():
        need(type(json_[key]) is kind, key, kind.__name__)
    for key, keys in {"claim": {"id", "statement", "faults", "sha256"}, "model": {"name", "sha256"}}.items():
        need(json_[key].keys() == keys, key, f"the keys {sorted(keys)}")
    texts = [*json_["model"].values(), json_["claim"]["id"], json_["claim"]["statement"], json_["claim"]["sha256"]]
    texts += [*row(json_["claim"]["faults"], len(json_["claim"]["faults"]), "claim.faults"), *json_["agreed_by"]]
    need(all(type(t) is str and t.isprintable() for t in texts), "claim, model, agreed_by", "printable texts")
    need(json_["format"] == FORMAT, "format", repr(FORMAT))
    need(json_["arithmetic"] in ("integers", "bits"), "arithmetic", "integers or bits")
    need(0 <= json_["depth"] <= MOST_STEPS, "depth", f"a number up to {MOST_STEPS}")
    need(len(json_["nodes"]) <= MOST_NODES, "nodes", f"at most {MOST_NODES}")
    nodes: list[Node] = []
    variables: dict[str, int] = {}
    for i, one in enumerate(json_["nodes"]):
        nodes.append(node_of(one, nodes, f"nodes[{i}]"))
        if nodes[i].op == "var":
            variables[name(nodes[i].attr, f"nodes[{i}]", variables)] = i

    def at(value: Any, place: str, sort: Sort) -> int:
        need(type(value) is int and 0 <= value < len(nodes), place, f"the number of a node, not {value!r}")
        need(nodes[value].sort == sort, place, f"a node of {sort}")
        return int(value)

    state: dict[str, tuple[int, Any]] = {}
    for i, one in enumerate(json_["registers"]):
        place = f"registers[{i}]"
        called, var, following, power_up = row(one, 4, place)
        need(type(var) is int and variables.get(name(called, place, state)) == var, place, "the variable of its name")
        sort = nodes[var].sort
        state[called] = at(following, place, sort), None if power_up is None else constant(power_up, sort, place)
    inputs: set[str] = set()
    for i, one in enumerate(json_["inputs"]):
        inputs.add(name(one, f"inputs[{i}]", inputs | state.keys()))
    need(variables.keys() <= inputs | state.keys(), "nodes", "no variable but registers and inputs")
    lemmas: dict[str, int] = {}
    for i, one in enumerate(json_["lemmas"]):
        called, root = row(one, 2, f"lemmas[{i}]")
        lemmas[name(called, f"lemmas[{i}]", lemmas)] = at(root, f"lemmas[{i}]", Sort("bit"))
    given, start, holds = (at(json_[key], key, Sort("bit")) for key in ("given", "start", "holds"))
    seen = {nodes[i].attr for i in cone(nodes, [start, *lemmas.values()]) if nodes[i].op == "var"}
    need(not seen & inputs, "start, lemmas", f"registers only, not the inputs {sorted(seen & inputs)[:3]}")
    return Certificate(nodes, state, given, start, holds, lemmas, json_["depth"], json_["arithmetic"] == "integers")


def cone(nodes: Sequence[Node], roots: Iterable[int]) -> list[int]:
    """The nodes under the roots, in order."""
    edge = list(roots)
    met = set(edge)
    for i in edge:  # grows while it is walked
        edge += (new := [a for a in nodes[i].args if a not in met])
        met.update(new)
    return sorted(met)


def hashes(json_: Any) -> tuple[str, str]:
    """SHA-256 of the transition system and of the claim on it: whatever the order of nodes, without the proof."""

    def digest(*parts: Any) -> str:
        return hashlib.sha256(json.dumps(parts, separators=(",", ":")).encode()).hexdigest()

    of: list[str] = []
    for op, args, attr, sort in json_["nodes"]:
        of.append(digest(op, [of[a] for a in args], attr, sort))
    registers = sorted(digest(called, of[var], of[after], value) for called, var, after, value in json_["registers"])
    model = digest(json_["model"]["name"], registers, sorted(json_["inputs"]))
    texts = [json_["claim"][key] for key in ("id", "statement", "faults")]
    return model, digest(model, *texts, *(of[json_[key]] for key in ("holds", "given", "start")))


# --- obligations -----------------------------------------------------------------------------------------------------


def obligations(c: Certificate) -> list[Obligation]:
    """What induction has to show, in order."""
    first, lemmas = ((0, c.start), (0, c.given)), tuple((0, root) for root in c.lemmas.values())
    found = [Obligation(f"lemma '{called}' at power-up", False, first, 0, root) for called, root in c.lemmas.items()]
    for called, root in c.lemmas.items():
        found.append(Obligation(f"lemma '{called}' is kept by a step", True, (*lemmas, (0, c.given)), 1, root))
    held = [(k, root) for k in range(c.depth) for root in (c.given, c.holds)]
    found.append(Obligation("the property follows", True, (*lemmas, *held, (c.depth, c.given)), c.depth, c.holds))
    for k in range(c.depth):
        given = [(j, c.given) for j in range(k + 1)]
        found.append(Obligation(f"the property at step {k}", False, ((0, c.start), *given), k, c.holds))
    return found


def needed(c: Certificate, one: Obligation) -> list[list[int]]:
    """The nodes that an obligation needs at each step: variables of registers first, then in order."""
    roots: list[list[int]] = [[] for _ in range(one.step + 1)]
    for step, root in (*one.assumed, (one.step, one.shown)):
        roots[step].append(root)
    for step in reversed(range(len(roots))):
        roots[step] = cone(c.nodes, roots[step])
        states = [i for i in roots[step] if c.nodes[i].op == "var" and c.nodes[i].attr in c.registers]
        roots[step] = states + [i for i in roots[step] if i not in set(states)]
        if step:
            roots[step - 1] += [c.registers[c.nodes[i].attr][0] for i in states]
    return roots


def unrolled(c: Certificate, one: Obligation, leaf: Callable[..., Any], apply: Callable[..., Any]) -> list[Any]:
    """What is assumed and, last, what is shown, made by `leaf(name, step, sort)` and `apply(node, sorts, *values)`."""
    values: dict[tuple[int, int], Any] = {}
    for step, indices in enumerate(needed(c, one)):
        for i in indices:
            n = c.nodes[i]
            register = c.registers.get(n.attr) if n.op == "var" else None
            if register and step:
                values[step, i] = values[step - 1, register[0]]
            elif register and not one.anywhere and register[1] is not None:
                values[step, i] = apply(Node("const", (), register[1], n.sort), [])
            elif n.op == "var":
                values[step, i] = leaf(n.attr, step, n.sort)
            else:
                values[step, i] = apply(n, [c.nodes[a].sort for a in n.args], *(values[step, a] for a in n.args))
    return [values[at] for at in (*one.assumed, (one.step, one.shown))]


# --- clauses ---------------------------------------------------------------------------------------------------------

Bits = list[int]
Form = dict[tuple[tuple[int, ...], ...], int]
MEANING: dict[str, Callable[..., list[tuple[int, ...]]]] = {
    "and": lambda g, a, b: [(-g, a), (-g, b), (g, -a, -b)],
    "xor": lambda g, a, b: [(-g, a, b), (-g, -a, -b), (g, -a, b), (g, a, -b)],
    "maj": lambda g, a, b, c: [(-g, a, b), (-g, a, c), (-g, b, c), (g, -a, -b), (g, -a, -c), (g, -b, -c)],
    **dict.fromkeys(("var", "true"), lambda g, *name: []),
}


class Blaster:
    """Terms as literals of gates: a bit is one, a whole number a sum of products of atoms, `{(atom, ...): factor}`.

    An atom is a number in two's complement, its literals from the lowest to the sign; the product of none is 1.
    """

    def __init__(self) -> None:
        self.made: list[tuple[Any, ...]] = [(), ("true",)]
        self.index: dict[tuple[Any, ...], int] = {}
        self.ranges: list[int] = []

    def gate(self, *key: Any) -> int:
        """The literal of a gate or a variable."""
        if key not in self.index:
            need(len(self.made) < MOST_GATES, "clauses", f"at most {MOST_GATES} gates")
            self.index[key] = len(self.made)
            self.made.append(key)
        return self.index[key]

    def both(self, a: int, b: int) -> int:
        """And."""
        if FALSE in (a, b) or a == -b:
            return FALSE
        return (b if a == TRUE else a) if TRUE in (a, b) or a == b else self.gate("and", min(a, b), max(a, b))

    def either(self, a: int, b: int) -> int:
        """Or."""
        return -self.both(-a, -b)

    def differ(self, a: int, b: int) -> int:
        """Xor."""
        sign, a, b = (1 if (a > 0) == (b > 0) else -1), min(abs(a), abs(b)), max(abs(a), abs(b))
        if a in (b, TRUE):
            return sign * FALSE if a == b else -sign * b
        return sign * self.gate("xor", a, b)

    def carry(self, a: int, b: int, c: int) -> int:
        """Majority."""
        a, b, c = sorted((a, b, c), key=abs)
        if abs(b) in (abs(a), abs(c)):
            return (a if a == b else c) if abs(a) == abs(b) else (b if b == c else a)
        if abs(a) == TRUE:
            return self.either(b, c) if a == TRUE else self.both(b, c)
        return self.gate("maj", a, b, c) if a > 0 else -self.gate("maj", -a, -b, -c)

    def choose(self, c: int, a: int, b: int) -> int:
        """`a` where `c`, else `b`."""
        return self.either(self.both(c, a), self.both(-c, b))

    def sum(self, x: Bits, y: Bits, bits: int, sign: int = 1) -> Bits:
        """x + sign * y, cut to so many bits."""
        total, carry = [], -sign
        for a, b in zip(sized(x, bits), sized(y, bits), strict=True):
            total.append(self.differ(self.differ(a, sign * b), carry))
            carry = self.carry(a, sign * b, carry)
        return total

    def product(self, x: Bits, y: Bits, bits: int) -> Bits:
        """The product, cut to so many bits: a shifted row for each bit of `y`, the sign's subtracted."""
        total = [FALSE]
        for i, b in enumerate(y):
            if b != FALSE:
                shifted = [FALSE] * i + [self.both(a, b) for a in sized(x, bits)]
                total = self.sum(total, shifted, bits, -1 if i == len(y) - 1 else 1)
        return sized(total, bits)

    def bits(self, x: Form, bits: int) -> Bits:
        """A sum of products in so many bits: that over variables and the constant, and the rest, then their sum."""
        sums = [[FALSE], [FALSE]]
        for atoms, factor in sorted(x.items(), key=lambda one: (not one[0], [max(map(abs, a)) for a in one[0]], one)):
            product = number(abs(factor))
            for one in atoms:
                product = self.product(list(one), product, min(bits, len(one) + len(product)))
            rest = any(self.made[abs(b)][0] not in ("var", "true") for one in atoms for b in one)
            sums[rest] = self.sum(sums[rest], product, bits, 1 if factor > 0 else -1)
        return self.sum(sums[0], sums[1], bits)

    def value(self, x: Form, sort: Sort) -> Bits:
        """A number of a sort in the sort's bits."""
        bits = self.bits(x, sort.bits)
        return [*bits[:-1], FALSE] if sort.low >= 0 else bits

    def less(self, x: Form, y: Form, bits: int) -> int:
        """Whether x < y: the sign of the difference, which has so many bits."""
        return self.bits(plus(x, y, -1), bits)[-1]

    def equal(self, x: Form, y: Form, bits: int) -> int:
        """Whether x = y, the difference having so many bits: all bits of what is added and of what is subtracted."""
        apart, same = plus(x, y, -1), TRUE
        sides = ({a: f for a, f in apart.items() if f > 0}, {a: -f for a, f in apart.items() if f < 0})
        for a, b in zip(*(self.bits(side, bits) for side in sides), strict=True):
            same = self.both(same, -self.differ(a, b))
        return same

    def chosen(self, c: int, x: Form, y: Form, bits: int) -> Form:
        """`x` where `c`, else `y`: y + c * (x - y) where they have something in common, else bit by bit."""
        apart = plus(x, y, -1)
        if not apart.keys() - {()}:
            return plus(y, atom([c, FALSE]), apart.get((), 0))
        if len(apart) < len(x) + len(y) or not (x.keys() - {()} and y.keys() - {()}):
            return plus(y, atom([self.both(c, b) for b in self.bits(apart, bits)]))
        return atom([self.choose(c, a, b) for a, b in zip(self.bits(x, bits), self.bits(y, bits), strict=True)])

    def clipped(self, x: Form, sort: Sort, bits: int) -> Form:
        """The value, or the nearest that the sort has."""
        x = self.chosen(self.less(whole(sort.high), x, bits), whole(sort.high), x, bits)
        return self.chosen(self.less(x, whole(sort.low), bits), whole(sort.low), x, bits)

    def cut(self, x: Form, sort: Sort, start: int, count: int) -> Form:
        """Some bits of a number: the lowest are what is left without the upper ones."""
        bits = self.value(x, sort)
        if start == 0:
            return plus(x, atom(bits[count:] or bits[-1:]), -1 << count)
        return atom([*sized(bits, start + count)[start:], FALSE])

    def quotient(self, x: Form, sort: Sort, by: int) -> Form:
        """A word by a constant, by long division from the highest bit down."""
        divisor, quotient, rest = number(by), [FALSE], [FALSE]
        bits = len(divisor) + 1
        for b in reversed(self.value(x, sort)):
            rest = sized([b, *rest], bits)
            less = self.sum(rest, divisor, bits, -1)
            rest = [self.choose(less[-1], a, b) for a, b in zip(rest, less, strict=True)]
            quotient = [-less[-1], *quotient]
        return atom(quotient)

    def leaf(self, called: str, step: int, sort: Sort) -> Any:
        """A variable at a step; what its sort promises is noted in `ranges`."""
        bits = [self.gate("var", called, step, i) for i in range(sort.bits - (sort.kind != "int"))]
        if sort.kind == "bit":
            return bits[0]
        x = atom([*bits, FALSE] if sort.kind == "word" else bits)
        if sort.kind == "int":
            beyond = self.less(x, whole(sort.low), sort.bits + 1), self.less(whole(sort.high), x, sort.bits + 1)
            self.ranges += [-literal for literal in beyond]
        return x

    def apply(self, n: Node, sorts: Sequence[Sort], *args: Any) -> Any:
        """The value of an operation on arguments of these sorts; all differences fit one bit more than the widest."""
        return BLAST[n.op](self, n, sorts, 1 + max(s.bits for s in (*sorts, n.sort)), *args)


BLAST: dict[str, Callable[..., Any]] = {
    "const": lambda g, n, s, w: (TRUE if n.attr else FALSE) if n.sort.kind == "bit" else whole(n.attr),
    **dict.fromkeys(("point", "cast"), lambda g, n, s, w, x: x),
    "not": lambda g, n, s, w, x: -x,
    "and": lambda g, n, s, w, x, y: g.both(x, y),
    "or": lambda g, n, s, w, x, y: g.either(x, y),
    "implies": lambda g, n, s, w, x, y: g.either(-x, y),
    "xor": lambda g, n, s, w, x, y: g.differ(x, y),
    "eq": lambda g, n, s, w, x, y: g.equal(x, y, w) if s[0].whole else -g.differ(x, y),
    "lt": lambda g, n, s, w, x, y: g.less(x, y, w),
    "le": lambda g, n, s, w, x, y: -g.less(y, x, w),
    "bit": lambda g, n, s, w, x: sized(g.value(x, s[0]), n.attr + 1)[n.attr],
    "select": lambda g, n, s, w, c, x, y: g.chosen(c, x, y, w) if n.sort.whole else g.choose(c, x, y),
    "add": lambda g, n, s, w, x, y: plus(x, y),
    "sub": lambda g, n, s, w, x, y: plus(x, y, -1),
    "mul": lambda g, n, s, w, x, y: times(x, y),
    "clip": lambda g, n, s, w, x: g.clipped(x, n.sort, w),
    "slice": lambda g, n, s, w, x: g.cut(x, s[0], *n.attr),
    "concat": lambda g, n, s, w, x, y: plus(y, x, 1 << s[1].bits - 1),
    "div": lambda g, n, s, w, x: g.quotient(x, s[0], n.attr),
    "mod": lambda g, n, s, w, x: plus(x, g.quotient(x, s[0], n.attr), -n.attr),
    "band": lambda g, n, s, w, x, y: atom(list(map(g.both, g.value(x, n.sort), g.value(y, n.sort)))),
    "bor": lambda g, n, s, w, x, y: atom(list(map(g.either, g.value(x, n.sort), g.value(y, n.sort)))),
    "bxor": lambda g, n, s, w, x, y: atom(list(map(g.differ, g.value(x, n.sort), g.value(y, n.sort)))),
}


def number(value: int) -> Bits:
    """A constant in two's complement."""
    return [TRUE if value >> i & 1 else FALSE for i in range(Sort("int", value, value).bits)]


def sized(x: Bits, bits: int) -> Bits:
    """The number with its sign repeated up to so many bits, or cut to them."""
    return (x + [x[-1]] * (bits - len(x)))[:bits]


def whole(value: int) -> Form:
    """A constant."""
    return {(): value} if value else {}


def atom(bits: Bits) -> Form:
    """A number of these bits; a constant has no atom, zeros below are a factor, and not b is 1 - b."""
    if all(abs(b) == TRUE for b in bits):
        return whole(sum((b > 0) << i for i, b in enumerate(bits)) - ((bits[-1] > 0) << len(bits)))
    zeros = next(i for i, b in enumerate(bits) if b != FALSE)
    bits = bits[zeros:]
    while len(bits) > 1 and bits[-1] == bits[-2]:
        bits = bits[:-1]
    if bits[0] < 0 and bits[1:] == [FALSE]:
        return {(): 1 << zeros, ((-bits[0], FALSE),): -1 << zeros}
    return {(tuple(bits),): 1 << zeros}


def plus(x: Form, y: Form, factor: int = 1) -> Form:
    """x + factor * y."""
    total = {a: f for a in (*x, *y) if (f := x.get(a, 0) + factor * y.get(a, 0))}
    need(
        len(total) <= MOST_TERMS and all(abs(f) >> 4 * MOST_BITS == 0 for f in total.values()), "clauses", "short sums"
    )
    return total


def times(x: Form, y: Form) -> Form:
    """The product."""
    total: Form = {}
    for a, f in x.items():
        total = plus(total, {tuple(sorted((*a, *b))): g for b, g in y.items()}, f)
    return total


def clauses(c: Certificate, one: Obligation) -> list[tuple[int, ...]] | None:
    """An obligation's negation as clauses, contradictory if and only if it holds; None where it has reals."""
    if any(c.nodes[i].sort.kind == "real" for step in needed(c, one) for i in step):
        return None
    gates = Blaster()
    *assumed, shown = unrolled(c, one, gates.leaf, gates.apply)
    asserted = [*gates.ranges, *assumed, -shown]
    edge = [TRUE, *map(abs, asserted)]
    met = set(edge)
    for g in edge:  # grows while it is walked
        edge += (new := [abs(a) for a in gates.made[g][1:] if gates.made[g][0] != "var" and abs(a) not in met])
        met.update(new)
    count = {g: i for i, g in enumerate(sorted(met), 1)}
    found = [(TRUE,)] + [clause for g in sorted(met) for clause in MEANING[gates.made[g][0]](g, *gates.made[g][1:])]
    found += [(literal,) for literal in asserted]
    return [tuple(count[a] if a > 0 else -count[-a] for a in clause) for clause in found]


def dimacs(label: str, found: Sequence[Sequence[int]]) -> str:
    """Clauses as text."""
    most = max(abs(literal) for clause in found for literal in clause)
    lines = (" ".join(map(str, (*clause, 0))) for clause in found)
    return "\n".join([f"c {label}", f"p cnf {most} {len(found)}", *lines, ""])


def check_lrat(found: Sequence[Sequence[int]], proof: str) -> None:
    """Check that each step of a proof follows by unit propagation over the clauses it names, up to the empty clause.

    Raises `Rejected` where it does not.
    """
    known, last = {i: frozenset(clause) for i, clause in enumerate(found, 1)}, len(found)
    for line, text in enumerate(proof.splitlines(), 1):
        try:
            step, *rest, end = map(int, text.split())
            cut = rest.index(0)
            clause, used = frozenset(rest[:cut]), [known[hint] for hint in rest[cut + 1 :]]
        except (ValueError, KeyError):
            step, end, clause, used = 0, 0, frozenset(), []
        false, conflict = set(clause), False
        for one in used:
            unit = one - false
            if conflict or len(unit) > 1:
                conflict = False
                break
            conflict = not unit
            for literal in unit:
                false.add(-literal)
        if not conflict or step <= last or end != 0:
            raise Rejected(f"the proof's line {line} does not follow: {text[:80]}")
        if not clause:
            return
        known[step], last = clause, step
    raise Rejected("the proof does not derive the empty clause")


# --- texts for the solvers -------------------------------------------------------------------------------------------

INTEGERS = {
    **{op: f"({op} {{0}} {{1}})" for op in ("and", "or", "xor")} | {"not": "(not {0})", "implies": "(=> {0} {1})"},
    **{"eq": "(= {0} {1})", "lt": "(< {0} {1})", "le": "(<= {0} {1})", "select": "(ite {0} {1} {2})"},
    **{"add": "(+ {0} {1})", "sub": "(- {0} {1})", "mul": "(* {0} {1})", "concat": "(+ (* {0} {scale}) {1})"},
    **{"point": "{0}", "cast": "{0}", "const": "{const}", "div": "(div {0} {by})", "mod": "(mod {0} {by})"},
    "clip": "(ite (< {0} {low}) {low} (ite (< {high} {0}) {high} {0}))",
    **{"slice": "(mod (div {0} {scale}) {size})", "bit": "(= (mod (div {0} {scale}) 2) 1)"},
}
SIGNS = {"(+ ": "(bvadd ", "(- ": "(bvsub ", "(* ": "(bvmul ", "(< ": "(bvslt ", "(<= ": "(bvsle ", "(div ": "(bvudiv "}


def as_vectors(text: str) -> str:
    """The same operation on bit-vectors that are wide enough for all values."""
    for sign, other in {**SIGNS, "(mod ": "(bvurem "}.items():
        text = text.replace(sign, other)
    return text


VECTORS = {op: as_vectors(text) for op, text in INTEGERS.items()} | {
    op: f"(bv{op[1:]} {{0}} {{1}})" for op in WORDS[:3]
}
VECTORS |= {"slice": "(bvand (bvashr {0} {by}) {mask})", "bit": "(= ((_ extract 0 0) (bvashr {0} {by})) #b1)"}


class Text:
    """An obligation in SMT-LIB: numbers as integers and reals, or all whole numbers as bit-vectors of one width."""

    def __init__(self, c: Certificate, one: Obligation) -> None:
        nodes = [c.nodes[i] for step in needed(c, one) for i in step]
        attributes = [Sort("int", 0, n.attr) for n in nodes if n.op in ("div", "mod", "bit")]
        self.width = 0 if c.integers else 2 + max(sort.bits for sort in (*attributes, *(n.sort for n in nodes)))
        self.lines = [f"; {one.label}", f"(set-logic {'ALL' if c.integers else 'QF_BV'})"]
        *assumed, shown = unrolled(c, one, self.leaf, self.apply)
        self.lines += [*(f"(assert {x})" for x in assumed), f"(assert (not {shown}))", "(check-sat)", ""]

    def number(self, value: Any) -> str:
        """A constant."""
        if type(value) is Fraction:
            return f"(/ {value.numerator}.0 {value.denominator}.0)" if value >= 0 else f"(- {self.number(-value)})"
        if self.width:
            return f"(_ bv{value % (1 << self.width)} {self.width})"
        return str(value) if value >= 0 else f"(- {-value})"

    def sort(self, sort: Sort, bits: int = 0) -> str:
        """A sort."""
        return {"bit": "Bool", "real": "Real"}.get(
            sort.kind, f"(_ BitVec {bits or self.width})" if self.width else "Int"
        )

    def leaf(self, called: str, step: int, sort: Sort) -> str:
        """A variable at a step, within its range."""
        x = called = f"|{called}@{step}|"
        self.lines.append(f"(declare-const {x} {self.sort(sort, sort.bits)})")
        if sort.whole:
            x = f"((_ sign_extend {self.width - sort.bits}) {called})" if self.width else called
            le = "bvsle" if self.width else "<="
            bounds = f"({le} {self.number(sort.low)} {x}) ({le} {x} {self.number(sort.high)})"
            self.lines.append(f"(assert (and {bounds}))")
        return x

    def apply(self, n: Node, sorts: Sequence[Sort], *args: str) -> str:
        """The name of a new definition."""
        by = n.attr[0] if n.op == "slice" else n.attr if n.op in ("div", "mod", "bit") else 0
        shift = sorts[1].bits - 1 if n.op == "concat" else by if n.op in ("slice", "bit") else 0
        size = 1 << n.attr[1] if n.op == "slice" else 1
        values = dict(low=n.sort.low, high=n.sort.high, by=by, scale=1 << shift, size=size, mask=size - 1)
        const = str(n.attr).lower() if n.sort.kind == "bit" else self.number(n.attr) if n.op == "const" else ""
        text = self.template(n, sorts).format(*args, const=const, **{k: self.number(v) for k, v in values.items()})
        self.lines.append(f"(define-fun t{len(self.lines)} () {self.sort(n.sort)} {text})")
        return f"t{len(self.lines) - 1}"

    def template(self, n: Node, sorts: Sequence[Sort]) -> str:
        """How an operation is written."""
        if self.width:
            return VECTORS[n.op]
        if n.op in WORDS[:3]:
            odd = "(= (mod (div {%d} %d) 2) 1)"
            bits = ((1 << i, odd % (0, 1 << i), odd % (1, 1 << i)) for i in range(n.sort.bits - 1))
            return f"(+ 0 {' '.join(f'(ite ({n.op[1:]} {x} {y}) {size} 0)' for size, x, y in bits)})"
        if n.op == "slice" and n.attr[0] == 0:  # one carry or borrow needs no division, which solvers find hard
            low, high, size = sorts[0].low, sorts[0].high, 1 << n.attr[1]
            if low >= 0 and high < 2 * size:
                return "(ite (<= {size} {0}) (- {0} {size}) {0})"
            if -size <= low and high < size:
                return "(ite (< {0} 0) (+ {0} {size}) {0})"
        return "(to_real {0})" if n.op == "cast" and n.sort.kind == "real" else INTEGERS[n.op]


def smt(c: Certificate, one: Obligation) -> str:
    """An obligation's negation in SMT-LIB, contradictory if and only if it holds."""
    return "\n".join(Text(c, one).lines)


def ask(solver: str, text: str, seconds: float) -> str:
    """sat, unsat, or why neither."""
    finite = text.splitlines()[1] == "(set-logic QF_BV)"
    try:
        if solver == "z3":
            import z3

            asked = z3.SolverFor("QF_FD") if finite else z3.Solver()
            asked.set("timeout", int(1000 * seconds))
            asked.from_string(text)
            return str(asked.check())
        import cvc5

        engine = cvc5.Solver(cvc5.TermManager())
        for option, value in {
            "tlimit-per": str(int(1000 * seconds)),
            **({"bitblast": "eager"} if finite else {}),
        }.items():
            engine.setOption(option, value)
        parser, answer = cvc5.InputParser(engine), ""
        parser.setStringInput(cvc5.InputLanguage.SMT_LIB_2_6, text, "obligation")
        while not (command := parser.nextCommand()).isNull():
            answer += str(command.invoke(engine, parser.getSymbolManager())).strip()
        return answer
    except ImportError:
        return "not installed"
    except Exception as error:  # a solver that breaks down has not answered
        return f"{type(error).__name__}: {error}"[:200]


# --- the check -------------------------------------------------------------------------------------------------------


def opened(path: Path) -> tuple[dict[str, str], Any]:
    """The texts in a zip, and the json of the first."""
    try:
        with zipfile.ZipFile(path) as archive:
            infos = archive.infolist()
            need(len({i.filename for i in infos}) == len(infos), path.name, "files of different names")
            need(sum(i.file_size for i in infos) <= MOST_BYTES, path.name, f"at most {MOST_BYTES} bytes")
            files = {i.filename: archive.read(i).decode() for i in infos}
        return files, json.loads(files[MAIN])
    except (OSError, zipfile.BadZipFile, zlib.error, RuntimeError, ValueError, KeyError, EOFError) as error:
        raise Malformed(f"{path.name}: expected a zip of texts with {MAIN}: {error}"[:300]) from None


def examined(c: Certificate, i: int, one: Obligation, files: dict[str, str], seconds: float) -> dict[str, Any]:
    """What the solvers and the bits say of an obligation; raises `Rejected` for a text that is not its own."""
    found, text = clauses(c, one), smt(c, one)
    for file, derived in {f"{i}.smt2": text, f"{i}.cnf": found and dimacs(one.label, found)}.items():
        if files.get(file) != derived:
            raise Rejected(f"{file} is not what follows from {MAIN}")
    bits = "reals" if found is None else "proof" if f"{i}.lrat" in files else "no proof"
    if found is not None and bits == "proof":
        check_lrat(found, files[f"{i}.lrat"])
    said = {solver: ask(solver, text, seconds) for solver in SOLVERS}
    answers = {*said.values()} | ({"unsat"} if bits == "proof" else set())
    verdict = REAL if bits == "reals" else CHECKED
    if "sat" in answers:
        verdict = DISAGREE if "unsat" in answers else REJECTED
    elif answers != {"unsat"} or bits == "no proof":
        verdict = WEAKER if "unsat" in answers else UNDECIDED
    return {"label": one.label, "verdict": verdict, **said, "bits": bits}


def examine(path: Path, seconds: float = 60.0) -> dict[str, Any]:
    """The report on a certificate, ready for json: `verdict`, `why`, what is claimed, and each obligation."""
    told: list[dict[str, Any]] = []
    report: dict[str, Any] = {"file": str(path), "verdict": CHECKED, "why": "", "obligations": told}
    try:
        files, json_ = opened(path)
        c = read(json_)
        every = list(enumerate(obligations(c), 1))
        rows, labels = json_["obligations"], [one.label for _, one in every]
        need([row(one, 2, "obligations")[0] for one in rows] == labels, "obligations", f"of this induction: {labels}")
        need(all(type(note) is str and note.isprintable() for _, note in rows), "obligations", "printable notes")
        allowed = {MAIN} | {f"{i}.{kind}" for i, _ in every for kind in ("smt2", "cnf", "lrat")}
        need(files.keys() <= allowed, path.name, f"no file but its own, not {sorted(files.keys() - allowed)[:3]}")
        report |= {key: json_[key] for key in ("claim", "model", "depth")} | {"lemmas": [*c.lemmas]}
        if hashes(json_) != (json_["model"]["sha256"], json_["claim"]["sha256"]):
            raise Rejected("the sha256 of the model or the claim is not that of its content")
        for i, one in every:
            told.append(examined(c, i, one, files, seconds) | {"note": rows[i - 1][1]})
        report["verdict"] = max((one["verdict"] for one in told), key=list(EXIT).index)
    except (Malformed, RecursionError) as error:
        report |= {"verdict": UNREADABLE, "why": str(error)}
    except Rejected as error:
        report |= {"verdict": REJECTED, "why": str(error)}
    return report


def worst(verdicts: Iterable[str]) -> int:
    """The exit code of the worst verdict."""
    return EXIT[max(verdicts, key=list(EXIT).index, default=UNREADABLE)]


def main(words: Sequence[str]) -> int:
    """Check files, print what was found, and return the exit code of the worst."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", metavar="FILE", nargs="+", type=Path)
    parser.add_argument("--timeout", metavar="SECONDS", type=float, default=60.0, help="for each question to a solver")
    args = parser.parse_args(words)
    reports = [examine(file, args.timeout) for file in args.files]
    print(json.dumps(reports, indent=1))
    return worst(report["verdict"] for report in reports)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""Check certificates of proofs: one file that needs Python, z3 and cvc5, and nothing else.

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


class Malformed(Exception):
    """The file is no certificate."""


class Rejected(Exception):
    """The certificate does not prove what it says."""


def _need(condition: object, place: str, expected: str) -> None:
    if not condition:
        raise Malformed(f"{place}: expected {expected}"[:500])


# --- what certificate.json says --------------------------------------------------------------------------------------


class Sort(NamedTuple):
    """`bit`, `real`, `word` (written u8) or `int` (written int[-3, 5])."""

    kind: str
    low: int = 0
    high: int = 1

    @property
    def bits(self) -> int:
        """Bits in two's complement, the sign included; 0 where the values are no whole numbers."""
        return 1 + max(self.high, ~self.low).bit_length() if self.kind in ("word", "int") else 0


class Node(NamedTuple):
    """A term."""

    op: str
    args: list[int]
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


SHAPE: Any = {  # a list of one shape has any number of entries, a tuple just its own
    **dict.fromkeys(("format", "arithmetic"), str) | dict.fromkeys(("depth", "given", "start", "holds"), int),
    "claim": {"id": str, "statement": str, "faults": [str], "sha256": str},
    "model": {"name": str, "sha256": str},
    "nodes": [(str, [int], object, str)],
    "registers": [(str, int, int, object)],
    "lemmas": [(str, int)],
    "obligations": [(str, str)],
    "inputs": [str],
    "agreed_by": [str],
}
SIGNATURES = {  # initials of the kinds of arguments and result; n is a word or an int
    **dict.fromkeys(("const", "var"), ">b|>r|>n") | {"point": "b>b|r>r|n>n", "select": "bbb>b|brr>r|bnn>n"},
    **dict.fromkeys(("and", "or", "xor", "implies"), "bb>b") | {"not": "b>b", "bit": "n>b", "eq": "bb>b|rr>b|nn>b"},
    **dict.fromkeys(("lt", "le"), "rr>b|nn>b") | dict.fromkeys(("add", "sub", "mul"), "rr>r|nn>n"),
    **dict.fromkeys(("clip", "slice"), "n>n") | {"cast": "n>n|n>r", "concat": "ww>w", "div": "w>w", "mod": "w>w"},
    **dict.fromkeys(WORDWISE := ("band", "bor", "bxor"), "ww>w"),
}
ARITY = {op: signature.index(">") for op, signature in SIGNATURES.items()}
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
    **dict.fromkeys(WORDWISE, lambda n, x, y: (0, max(x.high, y.high))),
}
ATTRIBUTES: dict[str, Any] = dict.fromkeys(("bit", "div", "mod"), int) | dict.fromkeys(("var", "point"), str)
ATTRIBUTES |= {"slice": (int, int), "const": object}


def _shaped(value: Any, shape: Any, place: str) -> None:
    """Refuse a value that is not of a shape."""
    if isinstance(shape, dict):
        _need(type(value) is dict and value.keys() == shape.keys(), place, f"an object with the keys {sorted(shape)}")
        for key in shape:
            _shaped(value[key], shape[key], f"{place}, {key}")
    elif isinstance(shape, list | tuple):
        length = "any" if isinstance(shape, list) else len(shape)
        _need(type(value) is list and length in ("any", len(value)), place, f"a list of {length} entries")
        for i, one in enumerate(value):
            _shaped(one, shape[0 if length == "any" else i], f"{place}[{i}]")
    else:
        _need(shape is object or type(value) is shape, place, f"{shape.__name__}, not {value!r}")
        _need(type(value) is not str or value.isprintable(), place, "printable text")


def _names(found: Sequence[str], place: str) -> None:
    """Refuse names that come twice or that would mean something in a text for solvers."""
    _need(all(re.fullmatch(r"[^|\\]{1,300}", one) for one in found), place, "names, without | and \\")
    _need(len(set(found)) == len(found), place, f"each name once, not as in {found}")


def sort_of(text: str, place: str) -> Sort:
    """The sort of a text."""
    found = re.fullmatch(r"bit|real|u([1-9]\d{0,2})|int\[(-?\d{1,200}), (-?\d{1,200})\]", text, re.ASCII)
    if found is None:
        raise Malformed(f"{place}: expected a sort, bit, real, u8 or int[-3, 5], not {text!r}"[:300])
    low, high = (0, (1 << int(found[1] or 1)) - 1) if found[2] is None else (int(found[2]), int(found[3]))
    sort = Sort("int" if found[2] else "word" if found[1] else found[0], low, high)
    _need(low <= high and sort.bits <= MOST_BITS, place, f"least and greatest value of less than {MOST_BITS} bits")
    return sort


def _constant(value: Any, sort: Sort, place: str) -> Any:
    """The value that a constant of a sort stands for."""
    if sort.kind == "real":
        fits = type(value) is str and bool(re.fullmatch(r"-?\d{1,400}(/[1-9]\d{0,399})?", value, re.ASCII))
    else:
        fits = type(value) is (int if sort.bits else bool) and sort.low <= value <= sort.high
    _need(fits, place, f'a {sort.kind} value, e.g. 7, true or "-1/3", not {value!r}')
    return Fraction(value) if sort.kind == "real" else value


def well_sorted(op: str, attr: Any, sort: Sort, args: Sequence[Sort]) -> bool:
    """Whether an operation applies to these sorts, and its own has every value that it can take."""
    kinds = "".join(s.kind[0] for s in args) + ">" + sort.kind[0]
    if not re.fullmatch(SIGNATURES[op].replace("n", "[wi]"), kinds) or (op == "point" and args[0] != sort):
        return False
    low, high = RANGES[op](attr, *args) if sort.bits and op in RANGES else sort[1:]
    return sort.low <= low and high <= sort.high


def _node(entry: Any, before: Sequence[Node], place: str) -> Node:
    """One node, well sorted over those before it."""
    op, args, attr, text = entry
    sort = sort_of(text, place)
    _need(op in ARITY and len(args) == ARITY[op], place, f"an operation and its arguments, not {op} of {args}")
    _need(all(0 <= a < len(before) for a in args), place, f"arguments before it, not {args}")
    _shaped(attr, ATTRIBUTES.get(op, type(None)), f"{place}, attribute of {op}")
    least, most = (1, 1 << MOST_BITS - 1) if op in ("div", "mod") else (0, MOST_BITS)
    numbers = attr if op == "slice" else [attr] if type(attr) is int and op != "const" else []
    _need(all(least <= n < most for n in numbers), place, f"numbers for {op}, not {attr}")
    sorts = [before[a].sort for a in args]
    _need(well_sorted(op, attr, sort, sorts), place, f"a sort for {op} of {sorts}, not {sort}")
    return Node(op, args, _constant(attr, sort, place) if op == "const" else attr, sort)


def read(json_: Any) -> Certificate:
    """The certificate of a json, each reference to what it has to be; else `Malformed`."""
    _shaped(json_, SHAPE, MAIN)
    _need(json_["format"] == FORMAT, "format", repr(FORMAT))
    _need(json_["arithmetic"] in ("integers", "bits"), "arithmetic", "integers or bits")
    _need(0 <= json_["depth"] <= MOST_STEPS, "depth", f"a number up to {MOST_STEPS}")
    _need(len(json_["nodes"]) <= MOST_NODES, "nodes", f"at most {MOST_NODES}")
    nodes: list[Node] = []
    for i, entry in enumerate(json_["nodes"]):
        nodes.append(_node(entry, nodes, f"nodes[{i}]"))
    variables = {n.attr: i for i, n in enumerate(nodes) if n.op == "var"}
    _names([n.attr for n in nodes if n.op == "var"], "nodes")
    _names([*(entry[0] for entry in json_["registers"]), *json_["inputs"]], "registers, inputs")
    _names([called for called, _ in json_["lemmas"]], "lemmas")

    def at(index: int, place: str, sort: Sort) -> int:
        _need(0 <= index < len(nodes) and nodes[index].sort == sort, place, f"a node of {sort}, not {index}")
        return index

    registers: dict[str, tuple[int, Any]] = {}
    for called, var, following, power_up in json_["registers"]:
        place = f"register {called}"
        _need(variables.get(called) == var, place, "the variable of its name")
        sort = nodes[var].sort
        registers[called] = at(following, place, sort), None if power_up is None else _constant(power_up, sort, place)
    _need(variables.keys() <= {*json_["inputs"], *registers}, "nodes", "no variable but registers and inputs")
    lemmas = {called: at(root, f"lemma {called}", Sort("bit")) for called, root in json_["lemmas"]}
    given, start, holds = (at(json_[key], key, Sort("bit")) for key in ("given", "start", "holds"))
    seen = {nodes[i].attr for i in _cone(nodes, [start, *lemmas.values()]) if nodes[i].op == "var"} - registers.keys()
    _need(not seen, "start, lemmas", f"registers only, not the inputs {sorted(seen)[:3]}")
    return Certificate(nodes, registers, given, start, holds, lemmas, json_["depth"], json_["arithmetic"] == "integers")


def _cone(nodes: Sequence[Node], roots: Iterable[int]) -> list[int]:
    """The nodes under the roots, in order."""
    met = set(edge := list(roots))
    for i in edge:  # grows while it is walked
        edge += (new := set(nodes[i].args) - met)
        met |= new
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


def _needed(c: Certificate, one: Obligation) -> list[list[int]]:
    """The nodes that an obligation needs at each step: variables of registers first, then in order."""
    roots: list[list[int]] = [[] for _ in range(one.step + 1)]
    for step, root in (*one.assumed, (one.step, one.shown)):
        roots[step].append(root)
    for step in reversed(range(len(roots))):
        is_state = {i: c.nodes[i].op == "var" and c.nodes[i].attr in c.registers for i in _cone(c.nodes, roots[step])}
        roots[step] = sorted(is_state, key=lambda i: not is_state[i])
        if step:
            roots[step - 1] += [c.registers[c.nodes[i].attr][0] for i in is_state if is_state[i]]
    return roots


def _unrolled(c: Certificate, one: Obligation, leaf: Callable[..., Any], apply: Callable[..., Any]) -> list[Any]:
    """What is assumed and, last, what is shown, made by `leaf(name, step, sort)` and `apply(node, sorts, *values)`."""
    values: dict[tuple[int, int], Any] = {}
    for step, indices in enumerate(_needed(c, one)):
        for i in indices:
            n = c.nodes[i]
            register = c.registers.get(n.attr) if n.op == "var" else None
            if register and step:
                values[step, i] = values[step - 1, register[0]]
            elif register and not one.anywhere and register[1] is not None:
                values[step, i] = apply(Node("const", [], register[1], n.sort), [])
            elif n.op == "var":
                values[step, i] = leaf(n.attr, step, n.sort)
            else:
                values[step, i] = apply(n, [c.nodes[a].sort for a in n.args], *(values[step, a] for a in n.args))
    return [values[at] for at in (*one.assumed, (one.step, one.shown))]


# --- clauses ---------------------------------------------------------------------------------------------------------

Bits = list[int]  # literals in two's complement, the sign last
Form = dict[tuple[tuple[int, ...], ...], int]  # factors of products of atoms; the product of none is 1
TRUE, FALSE = 1, -1
MEANING: dict[str, Callable[..., list[tuple[int, ...]]]] = {
    "and": lambda g, a, b: [(-g, a), (-g, b), (g, -a, -b)],
    "xor": lambda g, a, b: [(-g, a, b), (-g, -a, -b), (g, -a, b), (g, a, -b)],
    "maj": lambda g, a, b, c: [(-g, a, b), (-g, a, c), (-g, b, c), (g, -a, -b), (g, -a, -c), (g, -b, -c)],
    "true": lambda g: [(g,)],
    "var": lambda g, *name: [],
}
GATES: dict[str, Callable[..., Any]] = {  # from gates, node, sorts of arguments, bits of any difference, arguments
    "const": lambda g, n, s, w: {(): n.attr} if n.sort.bits else TRUE if n.attr else FALSE,
    **dict.fromkeys(("point", "cast"), lambda g, n, s, w, x: x),
    "not": lambda g, n, s, w, x: -x,
    "and": lambda g, n, s, w, x, y: g.both(x, y),
    "or": lambda g, n, s, w, x, y: g.either(x, y),
    "implies": lambda g, n, s, w, x, y: g.either(-x, y),
    "xor": lambda g, n, s, w, x, y: g.differ(x, y),
    "eq": lambda g, n, s, w, x, y: g.equal(x, y, w) if s[0].bits else -g.differ(x, y),
    "lt": lambda g, n, s, w, x, y: g.less(x, y, w),
    "le": lambda g, n, s, w, x, y: -g.less(y, x, w),
    "bit": lambda g, n, s, w, x: _sized(g.value(x, s[0]), n.attr + 1)[n.attr],
    "select": lambda g, n, s, w, c, x, y: g.chosen(c, x, y, w) if n.sort.bits else g.choose(c, x, y),
    "add": lambda g, n, s, w, x, y: _plus(x, y),
    "sub": lambda g, n, s, w, x, y: _plus(x, y, -1),
    "mul": lambda g, n, s, w, x, y: _times(x, y),
    "clip": lambda g, n, s, w, x: g.most(g.most(x, n.sort.high, 1, w), n.sort.low, -1, w),
    "slice": lambda g, n, s, w, x: g.cut(x, s[0], *n.attr),
    "concat": lambda g, n, s, w, x, y: _plus(y, x, 1 << s[1].bits - 1),
    "div": lambda g, n, s, w, x: g.quotient(x, s[0], n.attr),
    "mod": lambda g, n, s, w, x: _plus(x, g.quotient(x, s[0], n.attr), -n.attr),
    "band": lambda g, n, s, w, x, y: _atom(list(map(g.both, g.value(x, n.sort), g.value(y, n.sort)))),
    "bor": lambda g, n, s, w, x, y: _atom(list(map(g.either, g.value(x, n.sort), g.value(y, n.sort)))),
    "bxor": lambda g, n, s, w, x, y: _atom(list(map(g.differ, g.value(x, n.sort), g.value(y, n.sort)))),
}


def _sized(x: Bits, bits: int) -> Bits:
    """The number with its sign repeated up to so many bits, or cut to them."""
    return (x + [x[-1]] * (bits - len(x)))[:bits]


def _number(value: int) -> Bits:
    return [TRUE if value >> i & 1 else FALSE for i in range(Sort("int", value, value).bits)]


def _atom(bits: Bits) -> Form:
    """A number of these bits; a constant has no atom, zeros below are a factor, and not b is 1 - b."""
    if all(abs(b) == TRUE for b in bits):
        return {(): sum((b > 0) << i for i, b in enumerate(bits)) - ((bits[-1] > 0) << len(bits))}
    zeros = next(i for i, b in enumerate(bits) if b != FALSE)
    bits = bits[zeros:]
    while len(bits) > 1 and bits[-1] == bits[-2]:
        bits = bits[:-1]
    if bits[0] < 0 and bits[1:] == [FALSE]:
        return {(): 1 << zeros, ((-bits[0], FALSE),): -1 << zeros}
    return {(tuple(bits),): 1 << zeros}


def _plus(x: Form, y: Form, factor: int = 1) -> Form:
    """x + factor * y."""
    total = {a: f for a in (*x, *y) if (f := x.get(a, 0) + factor * y.get(a, 0))}
    small = len(total) <= MOST_TERMS and all(abs(f) >> 4 * MOST_BITS == 0 for f in total.values())
    _need(small, "clauses", "short sums")
    return total


def _times(x: Form, y: Form) -> Form:
    total: Form = {}
    for a, f in x.items():
        total = _plus(total, {tuple(sorted((*a, *b))): g for b, g in y.items()}, f)
    return total


class _Gates:
    """Terms as literals: a bit is one, a whole number a `Form`; what the sorts of variables promise is in `ranges`."""

    def __init__(self) -> None:
        self.made: list[tuple[Any, ...]] = [(), ("true",)]
        self.index: dict[tuple[Any, ...], int] = {}
        self.ranges: list[int] = []

    def gate(self, *key: Any) -> int:
        if key not in self.index:
            _need(len(self.made) < MOST_GATES, "clauses", f"at most {MOST_GATES} gates")
            self.index[key] = len(self.made)
            self.made.append(key)
        return self.index[key]

    def both(self, a: int, b: int) -> int:
        if FALSE in (a, b) or a == -b:
            return FALSE
        return (b if a == TRUE else a) if TRUE in (a, b) or a == b else self.gate("and", min(a, b), max(a, b))

    def either(self, a: int, b: int) -> int:
        return -self.both(-a, -b)

    def differ(self, a: int, b: int) -> int:
        sign, (a, b) = (1 if (a > 0) == (b > 0) else -1), sorted((abs(a), abs(b)))
        if a in (b, TRUE):
            return sign * FALSE if a == b else -sign * b
        return sign * self.gate("xor", a, b)

    def majority(self, a: int, b: int, c: int) -> int:
        a, b, c = sorted((a, b, c), key=abs)
        if abs(b) in (abs(a), abs(c)):
            return (a if a == b else c) if abs(a) == abs(b) else (b if b == c else a)
        if abs(a) == TRUE:
            return self.either(b, c) if a == TRUE else self.both(b, c)
        return self.gate("maj", a, b, c) if a > 0 else -self.gate("maj", -a, -b, -c)

    def choose(self, c: int, a: int, b: int) -> int:
        return self.either(self.both(c, a), self.both(-c, b))

    def sum(self, x: Bits, y: Bits, bits: int, sign: int = 1) -> Bits:
        """x + sign * y, cut to so many bits."""
        total, carry = [], -sign
        for a, b in zip(_sized(x, bits), _sized(y, bits), strict=True):
            total.append(self.differ(self.differ(a, sign * b), carry))
            carry = self.majority(a, sign * b, carry)
        return total

    def product(self, x: Bits, y: Bits, bits: int) -> Bits:
        """The product, cut to so many bits: a shifted row for each bit of `y`, the sign's subtracted."""
        total = [FALSE]
        for i, b in enumerate(y):
            if b != FALSE:
                shifted = [FALSE] * i + [self.both(a, b) for a in _sized(x, bits)]
                total = self.sum(total, shifted, bits, -1 if i == len(y) - 1 else 1)
        return _sized(total, bits)

    def bits(self, x: Form, bits: int) -> Bits:
        """A sum of products in so many bits: that over variables and the constant, and the rest, then their sum."""
        sums = [[FALSE], [FALSE]]
        for atoms, factor in sorted(x.items(), key=lambda one: (not one[0], [max(map(abs, a)) for a in one[0]], one)):
            product = _number(abs(factor))
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
        return self.bits(_plus(x, y, -1), bits)[-1]

    def equal(self, x: Form, y: Form, bits: int) -> int:
        """Whether x = y, the difference having so many bits: all bits of what is added and of what is subtracted."""
        apart, same = _plus(x, y, -1), TRUE
        sides = [self.bits({a: sign * f for a, f in apart.items() if sign * f > 0}, bits) for sign in (1, -1)]
        for a, b in zip(*sides, strict=True):
            same = self.both(same, -self.differ(a, b))
        return same

    def chosen(self, c: int, x: Form, y: Form, bits: int) -> Form:
        """`x` where `c`, else `y`: y + c * (x - y) where they have something in common, else bit by bit."""
        apart = _plus(x, y, -1)
        if not apart.keys() - {()}:
            return _plus(y, _atom([c, FALSE]), apart.get((), 0))
        if len(apart) < len(x) + len(y) or not (x.keys() - {()} and y.keys() - {()}):
            return _plus(y, _atom([self.both(c, b) for b in self.bits(apart, bits)]))
        return _atom([self.choose(c, a, b) for a, b in zip(self.bits(x, bits), self.bits(y, bits), strict=True)])

    def most(self, x: Form, limit: int, sign: int, bits: int) -> Form:
        """The limit where x is beyond it, upwards for the sign 1, else x."""
        beyond = self.less({(): limit}, x, bits) if sign > 0 else self.less(x, {(): limit}, bits)
        return self.chosen(beyond, {(): limit}, x, bits)

    def cut(self, x: Form, sort: Sort, start: int, count: int) -> Form:
        """Some bits of a number: the lowest are what is left without the upper ones."""
        bits = self.value(x, sort)
        if start == 0:
            return _plus(x, _atom(bits[count:] or bits[-1:]), -1 << count)
        return _atom([*_sized(bits, start + count)[start:], FALSE])

    def quotient(self, x: Form, sort: Sort, by: int) -> Form:
        """A word by a constant, by long division from the highest bit down."""
        divisor, quotient, rest = _number(by), [FALSE], [FALSE]
        for b in reversed(self.value(x, sort)):
            rest = _sized([b, *rest], len(divisor) + 1)
            less = self.sum(rest, divisor, len(rest), -1)
            rest = [self.choose(less[-1], a, b) for a, b in zip(rest, less, strict=True)]
            quotient = [-less[-1], *quotient]
        return _atom(quotient)

    def leaf(self, called: str, step: int, sort: Sort) -> Any:
        bits = [self.gate("var", called, step, i) for i in range(sort.bits - (sort.kind == "word") or 1)]
        if sort.kind == "bit":
            return bits[0]
        x = _atom([*bits, FALSE] if sort.kind == "word" else bits)
        if sort.kind == "int":
            beyond = self.less(x, {(): sort.low}, sort.bits + 1), self.less({(): sort.high}, x, sort.bits + 1)
            self.ranges += [-literal for literal in beyond]
        return x

    def apply(self, n: Node, sorts: Sequence[Sort], *args: Any) -> Any:
        return GATES[n.op](self, n, sorts, 1 + max(s.bits for s in (*sorts, n.sort)), *args)


def clauses(c: Certificate, one: Obligation) -> list[tuple[int, ...]] | None:
    """An obligation's negation as clauses, contradictory if and only if it holds; None where it has reals."""
    if any(c.nodes[i].sort.kind == "real" for step in _needed(c, one) for i in step):
        return None
    gates = _Gates()
    *assumed, shown = _unrolled(c, one, gates.leaf, gates.apply)
    asserted = [*gates.ranges, *assumed, -shown]
    met = set(edge := [TRUE, *map(abs, asserted)])
    for g in edge:  # grows while it is walked
        edge += (new := {abs(a) for a in gates.made[g][1:] if gates.made[g][0] != "var"} - met)
        met |= new
    count = {g: i for i, g in enumerate(sorted(met), 1)}
    found = [clause for g in sorted(met) for clause in MEANING[gates.made[g][0]](g, *gates.made[g][1:])]
    found += [(literal,) for literal in asserted]
    return [tuple(count[a] if a > 0 else -count[-a] for a in clause) for clause in found]


def dimacs(label: str, found: Sequence[Sequence[int]]) -> str:
    """Clauses as text."""
    most = max(abs(literal) for clause in found for literal in clause)
    lines = (" ".join(map(str, (*clause, 0))) for clause in found)
    return "\n".join([f"c {label}", f"p cnf {most} {len(found)}", *lines, ""])


def check_lrat(found: Sequence[Sequence[int]], proof: str) -> None:
    """Refuse a proof unless each step follows by unit propagation over the clauses it names, up to the empty clause."""
    known, last = {i: frozenset(clause) for i, clause in enumerate(found, 1)}, len(found)
    for line, text in enumerate(proof.splitlines(), 1):
        try:
            step, *rest, end = map(int, text.split())
            cut = rest.index(0)
            clause, *used = frozenset(rest[:cut]), *(known[hint] for hint in rest[cut + 1 :])
            false = set(clause)
            for one in used[:-1]:
                (unit,) = one - false
                false.add(-unit)
            follows = used[-1] <= false and step > last and end == 0
        except (ValueError, LookupError):
            follows = False
        if not follows:
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
VECTORS = INTEGERS | {op: f"(bv{op[1:]} {{0}} {{1}})" for op in WORDWISE}
VECTORS |= {"slice": "(bvand (bvashr {0} {by}) {mask})", "bit": "(= ((_ extract 0 0) (bvashr {0} {by})) #b1)"}
SIGNS = {"+": "bvadd", "-": "bvsub", "*": "bvmul", "<": "bvslt", "<=": "bvsle", "div": "bvudiv", "mod": "bvurem"}


def _written(value: Any, width: int) -> str:
    """A constant, as a bit-vector where there is a width."""
    if type(value) is bool:
        return str(value).lower()
    if type(value) is Fraction:
        return f"(/ {value.numerator}.0 {value.denominator}.0)" if value >= 0 else f"(- {_written(-value, 0)})"
    return f"(_ bv{value % (1 << width)} {width})" if width else f"{value}" if value >= 0 else f"(- {-value})"


def _template(n: Node, sorts: Sequence[Sort], width: int) -> str:
    """How an operation is written: with integers, or the same with signs for bit-vectors that hold all values."""
    if width:
        return re.sub(r"(?<=\()[-+*<=a-z]+(?= )", lambda sign: SIGNS.get(sign[0], sign[0]), VECTORS[n.op])
    if n.op in WORDWISE:
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
    """An obligation's negation, contradictory if and only if it holds; in bits, numbers are vectors of one width."""
    nodes = [c.nodes[i] for step in _needed(c, one) for i in step]
    numbers = [Sort("int", 0, n.attr) for n in nodes if n.op in ("div", "mod", "bit")]
    width = 0 if c.integers else 2 + max(sort.bits for sort in (*numbers, *(n.sort for n in nodes)))
    reals_only = {"real"} <= {n.sort.kind for n in nodes} <= {"real", "bit"}
    lines = [f"; {one.label}", f"(set-logic {'QF_NRA' if reals_only else 'ALL' if c.integers else 'QF_BV'})"]

    def sort(of: Sort, bits: int) -> str:
        return {"bit": "Bool", "real": "Real"}.get(of.kind, f"(_ BitVec {bits})" if width else "Int")

    def leaf(called: str, step: int, of: Sort) -> str:
        x = called = f"|{called}@{step}|"
        lines.append(f"(declare-const {x} {sort(of, of.bits)})")
        if of.bits:
            x, le = (f"((_ sign_extend {width - of.bits}) {called})", "bvsle") if width else (called, "<=")
            lines.append(f"(assert (and ({le} {_written(of.low, width)} {x}) ({le} {x} {_written(of.high, width)})))")
        return x

    def apply(n: Node, sorts: Sequence[Sort], *args: str) -> str:
        by = n.attr[0] if n.op == "slice" else n.attr if n.op in ("div", "mod", "bit") else 0
        shift = sorts[1].bits - 1 if n.op == "concat" else by if n.op in ("slice", "bit") else 0
        size = 1 << n.attr[1] if n.op == "slice" else 1
        values = dict(low=n.sort.low, high=n.sort.high, by=by, scale=1 << shift, size=size, mask=size - 1)
        values |= {"const": n.attr} if n.op == "const" else {}
        text = _template(n, sorts, width).format(*args, **{key: _written(v, width) for key, v in values.items()})
        lines.append(f"(define-fun t{len(lines)} () {sort(n.sort, width)} {text})")
        return f"t{len(lines) - 1}"

    *assumed, shown = _unrolled(c, one, leaf, apply)
    return "\n".join([*lines, *(f"(assert {x})" for x in assumed), f"(assert (not {shown}))", "(check-sat)", ""])


def ask(solver: str, text: str, seconds: float) -> str:
    """sat, unsat, or why neither."""
    logic, limit = text.splitlines()[1][len("(set-logic ") : -1], int(1000 * seconds)
    finite = logic == "QF_BV"
    try:
        if solver == "z3":
            import z3

            real = z3.OrElse(z3.TryFor("smt", 5000), "qfnra")  # many bits defeat the latter, products the former
            asked = z3.SolverFor("QF_FD") if finite else z3.Solver() if logic == "ALL" else real.solver()
            asked.set("timeout", limit)
            asked.from_string(text)
            return str(asked.check())
        import cvc5

        engine = cvc5.Solver(cvc5.TermManager())
        engine.setOption("tlimit-per", str(limit))
        if finite:
            engine.setOption("bitblast", "eager")
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
            _need(len({i.filename for i in infos}) == len(infos), path.name, "files of different names")
            _need(sum(i.file_size for i in infos) <= MOST_BYTES, path.name, f"at most {MOST_BYTES} bytes")
            files = {i.filename: archive.read(i).decode() for i in infos}
        return files, json.loads(files[MAIN])
    except (OSError, zipfile.BadZipFile, zlib.error, RuntimeError, ValueError, KeyError, EOFError) as error:
        raise Malformed(f"{path.name}: expected a zip of texts with {MAIN}: {error}"[:300]) from None


def _examined(c: Certificate, i: int, one: Obligation, files: dict[str, str], seconds: float) -> dict[str, Any]:
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
        labels = [one.label for _, one in every]
        _need([label for label, _ in json_["obligations"]] == labels, "obligations", f"of this induction: {labels}")
        allowed = {MAIN} | {f"{i}.{kind}" for i, _ in every for kind in ("smt2", "cnf", "lrat")}
        _need(files.keys() <= allowed, path.name, f"no file but its own, not {sorted(files.keys() - allowed)[:3]}")
        report |= {key: json_[key] for key in ("claim", "model", "depth")} | {"lemmas": [*c.lemmas]}
        if hashes(json_) != (json_["model"]["sha256"], json_["claim"]["sha256"]):
            raise Rejected("the sha256 of the model or the claim is not that of its content")
        for i, one in every:
            told.append(_examined(c, i, one, files, seconds) | {"note": json_["obligations"][i - 1][1]})
        report["verdict"] = worst(one["verdict"] for one in told)
    except (Malformed, RecursionError) as error:
        report |= {"verdict": UNREADABLE, "why": str(error)}
    except Rejected as error:
        report |= {"verdict": REJECTED, "why": str(error)}
    return report


def worst(verdicts: Iterable[str]) -> str:
    """The verdict on all."""
    return max(verdicts, key=list(EXIT).index)


def main(words: Sequence[str]) -> int:
    """Check files, print what was found, and return the exit code of the worst."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", metavar="FILE", nargs="+", type=Path)
    parser.add_argument("--timeout", metavar="SECONDS", type=float, default=60.0, help="for each question to a solver")
    args = parser.parse_args(words)
    reports = [examine(file, args.timeout) for file in args.files]
    print(json.dumps(reports, indent=1))
    return EXIT[worst(report["verdict"] for report in reports)]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

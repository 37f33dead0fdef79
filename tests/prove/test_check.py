"""The stand-alone checker: its two translations against the direct reading, its LRAT, and bugs planted in each."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings

from safety.prove import check
from safety.prove.certificate import described
from safety.prove.claims import BITS, INTEGERS
from safety.system import State
from safety.terms import Term, all_of, implies, select
from safety.terms.direct import evaluate
from safety.terms.graph import integer, node, postorder, uint, variable, variables
from safety.terms.values import const
from tests.prove.certified import problem_of
from tests.terms.graphs import A8, EDGES, N4, Graph, P, edge_graphs, edge_rows, graphs

OPERATIONS = sorted(EDGES)


def widest(outputs: list[Term]) -> int:
    """Bits of the widest number under the outputs."""
    return max(check.sort_of(str(t.sort), "").bits for t in postorder(outputs))


def is_finite(graph: Graph) -> bool:
    return all(t.sort.kind != "real" for t in postorder(graph[0]))


ONE_MORE: Any = select(~P, A8 + 1, A8.widen(9))
EXTRA: list[Term] = [ONE_MORE, ONE_MORE - A8, select(P, A8, N4.widen(8)) - N4, (A8 + N4).low(8) - A8]


# --- as gates --------------------------------------------------------------------------------------------------------


def bits_of(value: Any) -> Callable[[int], bool]:
    return lambda i: bool(int(value) >> i & 1)


def simulated(blaster: check._Gates, row: dict[str, Any]) -> list[bool]:
    """The value of every gate under values of the variables."""
    values = [False, True]
    of: dict[str, Callable[..., bool]] = {
        "and": lambda a, b: a and b, "xor": lambda a, b: a != b, "maj": lambda a, b, c: a + b + c > 1,
    }  # fmt: skip
    for kind, *args in blaster.made[2:]:
        if kind == "var":
            name, _, i = args
            values.append(bits_of(row[name])(i))
        else:
            values.append(of[kind](*(values[a] if a > 0 else not values[-a] for a in args)))
    return values


def number_of(x: Any, blaster: check._Gates, values: list[bool]) -> int:
    """The number, or the truth, that literals stand for."""

    def true(literal: int) -> bool:
        return values[literal] if literal > 0 else not values[-literal]

    if isinstance(x, int):
        return true(x)
    total = 0
    for atoms, factor in x.items():
        for bits in atoms:
            factor *= sum(true(b) << i for i, b in enumerate(bits)) - (true(bits[-1]) << len(bits))
        total += factor
    return total


def gates_agree(graph: Graph) -> bool:
    """Whether the gates of a graph, and the bits of its numbers, have the values of the direct reading."""
    outputs, rows = graph
    states = [State(variable(f"out{i}", t.sort), t, None) for i, t in enumerate(outputs)]  # type: ignore[arg-type]
    states = [State(s.var, s.next, _least(s.var)) for s in states]
    c = check.read(
        described(problem_of(states, variables(outputs), variable("out0", outputs[0].sort) == outputs[0]), 0)
    )
    blaster, made = check._Gates(), []
    for n in c.nodes:
        sorts, args = [c.nodes[a].sort for a in n.args], [made[a] for a in n.args]
        made.append(blaster.leaf(n.attr, 0, n.sort) if n.op == "var" else blaster.apply(n, sorts, *args))
    found = [made[c.registers[f"out{i}"][0]] for i in range(len(outputs))]
    sorts = [c.nodes[c.registers[f"out{i}"][0]].sort for i in range(len(outputs))]
    words = [blaster.value(x, sort) if sort.bits else x for x, sort in zip(found, sorts, strict=True)]
    for row in rows:
        values = simulated(blaster, {v.attr: value for v, value in row.items()} | {s.path: s.power_up for s in states})
        expected = evaluate(outputs, row)
        if [number_of(x, blaster, values) for x in found] != expected:
            return False
        as_bits = [number_of({(tuple(x),): 1} if isinstance(x, list) else x, blaster, values) for x in words]
        ranges = all(number_of(literal, blaster, values) for literal in blaster.ranges)
        if as_bits != expected or not ranges:
            return False
    return True


def _least(v: Term) -> Any:
    return False if v.sort.kind == "bit" else v.sort.low or 0


@pytest.mark.parametrize("operation", OPERATIONS)
def test_gates_have_the_values_of_the_direct_reading(operation: str) -> None:
    assert all(gates_agree(graph) for graph in edge_graphs(operation) if is_finite(graph) and widest(graph[0]) <= 70)


def widened(graph: Graph) -> Graph:
    """The same operations, in sorts with more values than they give: words stay words where they have to."""

    def wider(t: Term) -> Term:
        if t.sort.kind not in ("uint", "int") or t.op in ("const", "var", "point", "cast"):
            return t
        low, high = t.sort.bounds
        sort = uint(t.sort.width + 1) if t.op in ("div", "mod", *check.WORDWISE) else integer(low - 3, high + 9)
        return t if t.op == "concat" else node(t.op, t.args, t.attr, sort)

    return [wider(t) for t in graph[0]], graph[1]


NARROW = ("select", "add", "sub", "mul", "slice", "clip", "div", "mod", "band", "bor", "bxor")


@pytest.mark.parametrize("operation", NARROW)
def test_a_sort_that_is_wider_than_needed_changes_no_value(operation: str) -> None:
    small = [widened(graph) for graph in few(operation)]
    plain = [
        t for outputs, _ in few(operation) for t in outputs if t.op == operation and t.sort.kind in ("uint", "int")
    ]
    assert plain and not {t.uid for t in plain} & {t.uid for outputs, _ in small for t in outputs}
    assert all(gates_agree(graph) for graph in small if is_finite(graph))
    assert all(texts_agree(graph, arithmetic, ("z3",)) for graph in small for arithmetic in (INTEGERS, BITS))


@settings(max_examples=20, deadline=None)
@given(graphs(largest=8))
def test_gates_of_random_graphs_have_the_values_of_the_direct_reading(graph: Graph) -> None:
    assert gates_agree(([t for t in graph[0] if widest([t]) <= 140], graph[1]))


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(graphs())
def test_gates_of_many_random_graphs_have_the_values_of_the_direct_reading(graph: Graph) -> None:
    assert gates_agree(graph)


def _without_sign(x: list[int], bits: int) -> list[int]:
    return (x + [check.FALSE] * (bits - len(x)))[:bits]


BLAST, RIGHT = check.GATES, check._Gates
GATE_BUGS: dict[str, Callable[[Any], None]] = {
    "numbers are extended with zeros": lambda m: m.setattr(check, "_sized", _without_sign),
    "a difference lacks its carry": lambda m: m.setattr(
        RIGHT, "sum", (lambda right: lambda g, x, y, n, sign=1: right(g, x, [sign * b for b in y], n))(RIGHT.sum)
    ),
    "the carry is an or": lambda m: m.setattr(RIGHT, "majority", lambda g, a, b, c: g.either(a, g.either(b, c))),
    "a choice takes the other": lambda m: m.setattr(
        RIGHT, "choose", lambda g, c, a, b: g.either(g.both(-c, a), g.both(c, b))
    ),
    "products leave out the last row": lambda m: m.setattr(
        RIGHT, "product", (lambda right: lambda g, x, y, n: right(g, x, [*y[:-1], check.FALSE], n))(RIGHT.product)
    ),
    "a cut starts one bit late": lambda m: m.setattr(
        RIGHT, "cut", (lambda right: lambda g, x, s, start, count: right(g, x, s, start + 1, count))(RIGHT.cut)
    ),
    "a sum forgets the constant": lambda m: m.setattr(
        RIGHT, "bits", (lambda right: lambda g, x, n: right(g, {a: f for a, f in x.items() if a}, n))(RIGHT.bits)
    ),
    "not b is 1 + b": lambda m: m.setattr(
        check, "_atom", (lambda right: lambda bits: {a: abs(f) for a, f in right(bits).items()})(check._atom)
    ),
    "factors are not multiplied": lambda m: m.setattr(check, "_times", lambda x, y: check._plus(x, y)),
    "equality of the lowest bits": lambda m: m.setattr(
        RIGHT, "equal", (lambda right: lambda g, x, y, n: right(g, x, y, 2))(RIGHT.equal)
    ),
    "less of one bit too few": lambda m: m.setattr(
        RIGHT, "less", (lambda right: lambda g, x, y, n: right(g, x, y, n - 1))(RIGHT.less)
    ),
}


def _altered(op: str) -> Callable[..., Any]:
    def wrong(g: Any, n: Any, *given: Any) -> Any:
        right = BLAST[op](g, n, *given)
        return check._plus(right, {(): 1}) if n.sort.bits else -right

    return wrong


@pytest.mark.parametrize("operation", OPERATIONS)
def test_a_wrong_gate_of_any_operation_is_found(operation: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(check, "GATES", BLAST | {operation: _altered(operation)})
    assert not all(gates_agree(graph) for graph in edge_graphs(operation) if is_finite(graph))


SMALL = [g for operation in OPERATIONS for g in edge_graphs(operation) if is_finite(g) and widest(g[0]) <= 20]
SMALL += [([term], edge_rows([term])) for term in EXTRA]
SMALL = [(outputs, rows[:: max(1, len(rows) // 6)]) for outputs, rows in SMALL]


def test_the_small_graphs_agree() -> None:
    assert all(gates_agree(graph) for graph in SMALL)


@pytest.mark.parametrize("bug", GATE_BUGS)
def test_a_bug_planted_in_the_gates_is_found(bug: str, monkeypatch: pytest.MonkeyPatch) -> None:
    GATE_BUGS[bug](monkeypatch)
    assert not all(gates_agree(graph) for graph in SMALL)


# --- as texts --------------------------------------------------------------------------------------------------------


def texts(graph: Graph, arithmetic: str) -> Iterator[tuple[str, str]]:
    """Obligations in SMT-LIB that say: at these inputs that value (unsat), and: not that value there (sat)."""
    outputs, rows = graph

    def is_(t: Any, value: Any) -> Any:
        return (t if value else ~t) if t.sort.kind == "bit" else t == const(value, t.sort)

    said = []
    for row in rows:
        at = all_of(*(is_(v, row[v]) for v in variables(outputs)))
        value = all_of(*(is_(t, value) for t, value in zip(outputs, evaluate(outputs, row), strict=True)))
        said.append((at, value))
    every = all_of(*(implies(at, value) for at, value in said))
    for holds, answer in ((every, "unsat"), (implies(said[-1][0], ~said[-1][1]), "sat")):
        c = check.read(described(problem_of([], variables(outputs), holds, arithmetic=arithmetic), 0))
        yield check.smt(c, check.obligations(c)[0]), answer


def texts_agree(graph: Graph, arithmetic: str, solvers: tuple[str, ...] = check.SOLVERS) -> bool:
    """Whether the solvers find the values of the direct reading, and no others, in the texts."""
    if arithmetic == BITS and not is_finite(graph):
        return True
    return all(check.ask(s, text, 20) == answer for text, answer in texts(graph, arithmetic) for s in solvers)


def few(operation: str) -> Iterator[Graph]:
    """The graphs of an operation as one, in a few lanes each."""
    for outputs, rows in edge_graphs(operation):
        if widest(outputs) <= 20:
            yield outputs, rows[:: max(1, len(rows) // 3)]


@pytest.mark.parametrize("arithmetic", [INTEGERS, BITS])
@pytest.mark.parametrize("operation", OPERATIONS)
def test_texts_have_the_values_of_the_direct_reading(operation: str, arithmetic: str) -> None:
    assert all(texts_agree(graph, arithmetic) for graph in few(operation))


@pytest.mark.parametrize("arithmetic", [INTEGERS, BITS])
@pytest.mark.parametrize("operation", OPERATIONS)
def test_a_wrong_text_of_any_operation_is_found(
    operation: str, arithmetic: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = check._template

    def wrong(n: Any, sorts: Any, width: int) -> str:
        if n.op != operation:
            return right(n, sorts, width)
        if n.sort.kind == "bit":
            return f"(not {right(n, sorts, width)})"
        one, zero = (check._written(Fraction(x) if n.sort.kind == "real" else x, width) for x in (1, 0))
        return f"(ite (= {right(n, sorts, width)} {one}) {zero} {one})"

    monkeypatch.setattr(check, "_template", wrong)
    assert not all(texts_agree(graph, arithmetic, ("z3",)) for graph in few(operation))

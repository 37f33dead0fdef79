"""The and-inverter reading agrees with the direct one, and a wrong entry in any row is found."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import pytest
from hypothesis import given, settings

from safety.export.bits import GATES, Bits, bits_of
from safety.export.gates import FALSE, TRUE, Gates, constant, invert
from safety.terms import TermError
from safety.terms.column_solvers import vector_bits
from safety.terms.direct import evaluate
from safety.terms.graph import BIT, REAL, Sort, Term, integer, uint, variable, variables
from safety.terms.table import OPERATIONS
from tests.terms.agreement import Disagreement, has_reals
from tests.terms.graphs import EDGES, RANGES, WIDTHS, Graph, edge_graphs, graphs

Entry = Callable[..., Any]


def values_of(gates: Gates, given: Mapping[int, bool]) -> list[bool]:
    """The value of every node; inputs by literal."""
    found = [False]
    for n, inputs in enumerate(gates.inputs[1:], start=1):
        if inputs is None:
            found.append(given[2 * n])
        else:
            a, b = inputs
            found.append((found[a >> 1] ^ bool(a & 1)) and (found[b >> 1] ^ bool(b & 1)))
    return found


def check(outputs: Sequence[Term], rows: Sequence[Mapping[Term, Any]]) -> None:
    """Raise `Disagreement` unless the graph computes what the direct reading does."""
    try:
        reading = Bits(Gates())
        for v in variables(outputs):
            reading.bind(v, tuple(reading.gates.variable() for _ in range(bits_of(v.sort))))
        words = reading(outputs)
    except Exception as error:
        raise Disagreement(f"{type(error).__name__}: {error}") from error
    for row in rows:
        given = {
            literal: bool(row[v] >> i & 1) for v in variables(outputs) for i, literal in enumerate(reading.known[v.uid])
        }
        nodes = values_of(reading.gates, given)
        for term, word, right in zip(outputs, words, evaluate(outputs, row), strict=True):
            bits = [nodes[literal >> 1] ^ bool(literal & 1) for literal in word]
            expected = [bool(right >> i & 1) for i in range(bits_of(term.sort))]
            if bits != expected:
                raise Disagreement(f"{term} is {bits}, directly {right!r}, for {row}")


@pytest.mark.parametrize("examples", [250, pytest.param(5_000, marks=pytest.mark.slow)])
def test_the_reading_agrees_on_random_graphs(examples: int) -> None:
    def agrees(graph: Graph) -> None:
        check(*graph)

    settings(max_examples=examples, database=None)(given(graphs())(agrees))()


@pytest.mark.parametrize("operation", EDGES)
def test_the_reading_agrees_on_the_edges_of(operation: str) -> None:
    for outputs, rows in edge_graphs(operation):
        if not has_reals(outputs):
            check(outputs, rows)


def test_every_operation_has_an_entry() -> None:
    assert GATES.keys() == OPERATIONS.keys() - {"var"}


@pytest.mark.parametrize("sort", [*map(uint, WIDTHS), *(integer(*bounds) for bounds in RANGES)], ids=str)
def test_a_sort_has_as_many_bits_here_as_in_the_solvers(sort: Sort) -> None:
    assert bits_of(sort) == vector_bits(sort)


# --- it can fail ---------------------------------------------------------------------------------------------------


def swapped(row: str) -> Entry:
    """The right entry with its last two operands exchanged."""
    right = GATES[row]

    def wrong(g: Gates, t: Any, *args: Any) -> Any:
        from tests.terms.test_planted_bugs import seen

        first, (x, y) = args[:-2], args[-2:]
        return right(g, seen(t, args=(*t.args[:-2], t.args[-1], t.args[-2])), *first, y, x)

    return wrong


def inverted(row: str) -> Entry:
    """The right entry, the lowest bit of the result inverted."""
    right = GATES[row]

    def wrong(g: Gates, t: Any, *args: Any) -> Any:
        low, *above = right(g, t, *args)
        return (low ^ 1, *above)

    return wrong


def no_sign(row: str) -> Entry:
    """The right entry on integers extended as if they were unsigned."""
    right = GATES[row]

    def wrong(g: Gates, t: Any, *args: Any) -> Any:
        longest = bits_of(t.sort) + 70
        args = tuple(
            x if a.sort.kind == "bit" else (*x, *(FALSE,) * longest) for a, x in zip(t.args, args, strict=True)
        )
        return right(g, t, *args)

    return wrong


BUGS: list[tuple[str, str, Entry]] = [
    *((row, "inverted", inverted(row)) for row in GATES),
    *((row, "swapped", swapped(row)) for row in ("implies", "sub", "lt", "le", "select", "concat")),
    *((row, "no sign", no_sign(row)) for row in ("add", "sub", "mul", "eq", "lt", "le", "clip", "slice")),
    ("lt", "unsigned", lambda g, t, x, y: (g.below(*(w + (FALSE,) * (400 - len(w)) for w in (x, y))),)),
    ("le", "less", GATES["lt"]),
    ("div", "remainder", GATES["mod"]),
    ("mod", "quotient", GATES["div"]),
    ("and", "or", GATES["or"]),
    ("xor", "or", GATES["or"]),
    ("bxor", "or", GATES["or"]),
    ("clip", "cut", lambda g, t, x: (x * 99)[: bits_of(t.sort)]),
    ("slice", "from 0", lambda g, t, x: (x + (FALSE,) * 130)[: t.attr[1]]),
    ("bit", "the lowest", lambda g, t, x: (x[0],)),
    ("sub", "no borrow", lambda g, t, x, y: g.add(*(GATES["cast"](g, t, w) for w in (x, y)))),
    ("not", "none", lambda g, t, x: x),
    ("const", "ones", lambda g, t: invert(constant(0, bits_of(t.sort)))),
]


@pytest.mark.parametrize(("row", "what", "entry"), BUGS, ids=[f"{row}-{what}" for row, what, _ in BUGS])
def test_a_planted_wrong_entry_is_found(row: str, what: str, entry: Entry, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(GATES, row, entry)
    with pytest.raises(Disagreement):
        for outputs, rows in edge_graphs(row):
            if not has_reals(outputs):
                check(outputs, rows)


def test_a_wrong_entry_is_planted_in_every_row() -> None:
    assert {row for row, _, _ in BUGS} == GATES.keys()


# --- the graph -----------------------------------------------------------------------------------------------------


def test_the_graph_folds_what_is_constant_and_keeps_one_gate_for_one_structure() -> None:
    g = Gates()
    a, b = g.variable(), g.variable()
    assert (g.both(a, FALSE), g.both(TRUE, a), g.both(a, a), g.both(a, a ^ 1)) == (FALSE, a, a, FALSE)
    ab = g.both(a, b)
    assert g.both(b, a) == ab
    assert (g.both(ab, a), g.both(ab, b ^ 1), g.both(ab ^ 1, a ^ 1)) == (ab, FALSE, a ^ 1)
    assert g.both(ab ^ 1, a) == g.both(a, b ^ 1)
    assert (g.choose(a, b, b), g.choose(TRUE, a, b), g.choose(FALSE, a, b)) == (b, a, b)


@pytest.mark.parametrize("word", [variable("r", REAL) < 1, variable("r", REAL)])
def test_a_real_is_refused_by_name(word: Term) -> None:
    with pytest.raises(TermError, match=r"\br\b.*is a real: it has no bits; write SMT-LIB or VMT"):
        Bits(Gates())([word])


def test_a_variable_that_is_not_bound_is_refused() -> None:
    with pytest.raises(TermError, match="p is not bound to a word"):
        Bits(Gates())([variable("p", BIT)])
    with pytest.raises(TermError, match="w: u8 has 8 bits, not 1"):
        Bits(Gates()).bind(variable("w", uint(8)), (TRUE,))

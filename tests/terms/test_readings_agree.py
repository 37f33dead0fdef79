"""All readings of a graph agree: direct, Python, lanes, and SMT on integers and bit-vectors with z3 and cvc5."""

from collections.abc import Callable

import pytest
from hypothesis import HealthCheck, Phase, find, given, settings
from hypothesis import strategies as st

from safety.terms import TermError, UInt, select
from safety.terms.graph import BIT, Term, node, postorder, uint, variable, variables
from safety.terms.smt import SOLVERS, Encoder
from safety.terms.table import OPERATIONS
from safety.terms.texts import source
from tests.terms.agreement import BITS, INTEGERS, READINGS, TEXTS, VECTORS, check, has_reals
from tests.terms.graphs import EDGES, MAKERS, Graph, edge_graphs, edges, graphs

CALM = settings(
    deadline=None,
    database=None,
    derandomize=True,
    report_multiple_bugs=False,
    phases=[Phase.generate, Phase.shrink],
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def on(examples: int, strategy: st.SearchStrategy[Graph], test: Callable[[Graph], None]) -> None:
    settings(CALM, max_examples=examples)(given(strategy)(test))()


def examples(few: int, many: int) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("examples", [few, pytest.param(many, marks=pytest.mark.slow)])


@examples(300, 5_000)
@pytest.mark.parametrize("reading", [*TEXTS, *BITS])
def test_generated_readings_agree_on_words_and_integers(reading: str, examples: int) -> None:
    on(examples, graphs(), lambda graph: check(reading, *graph))


@examples(100, 3_000)
@pytest.mark.parametrize("reading", TEXTS)
def test_generated_readings_agree_on_reals(reading: str, examples: int) -> None:
    on(examples, graphs(reals=True), lambda graph: check(reading, *graph))


@examples(60, 1_000)
@pytest.mark.parametrize("reading", [*INTEGERS, *VECTORS])
def test_solver_readings_agree_on_words_and_integers(reading: str, examples: int) -> None:
    on(examples, graphs(lanes=2, largest=10), lambda graph: check(reading, *graph))


@examples(40, 600)
@pytest.mark.parametrize("reading", INTEGERS)
def test_integer_readings_agree_on_reals(reading: str, examples: int) -> None:
    on(examples, graphs(reals=True, lanes=2, largest=10), lambda graph: check(reading, *graph))


@pytest.mark.parametrize("solver", SOLVERS)
def test_bit_vector_reading_refuses_every_real(solver: str) -> None:
    def refused(graph: Graph) -> None:
        for output in graph[0]:
            if has_reals([output]):
                with pytest.raises(TermError, match="is a real: it has no bit-vector reading"):
                    Encoder(solver, integers=False)([output])

    on(20, graphs(reals=True), refused)


@pytest.mark.parametrize("reading", READINGS)
@pytest.mark.parametrize("operation", EDGES)
def test_readings_agree_on_the_edges_of(operation: str, reading: str) -> None:
    for outputs, rows in edge_graphs(operation):
        if reading not in VECTORS or not has_reals(outputs):
            check(reading, outputs, rows)


def test_generator_has_a_maker_for_every_operation() -> None:
    assert MAKERS.keys() == OPERATIONS.keys() - {"var"}


@pytest.mark.parametrize("operation", MAKERS)
def test_generator_reaches(operation: str) -> None:
    def reached(graph: Graph) -> bool:
        return any(term.op == operation for term in postorder(graph[0]))

    find(graphs(reals=True, lanes=0), reached, settings=settings(CALM, max_examples=2_000, phases=[Phase.generate]))


# --- depth and size ------------------------------------------------------------------------------------------------

DEEP = 5_000


def counter(steps: int) -> Term:
    """A sum that wraps, saturates and holds by turns: a few nodes a step, each on top of the last."""
    total: UInt = variable("start", uint(8))  # type: ignore[assignment]
    more: UInt = variable("more", uint(4))  # type: ignore[assignment]
    for i in range(steps):
        total = (total + more).low(8) if i % 3 else select(total > 200, total, (total + i % 7).sat(8))
    return total


def parity(steps: int) -> Term:
    """A chain of gates that nothing shares."""
    p, q = variable("p", BIT), variable("q", BIT)
    for i in range(steps):
        p = node(("and", "or", "xor", "implies")[i % 4], (q, p), None, BIT)
    return p


def named(steps: int) -> Term:
    """A chain of points, each used twice: written out, the source would double at every step."""
    x = variable("x", uint(1))
    for i in range(steps):
        x = node("point", (node("bxor", (node("point", (x,), f"a{i}", x.sort), x), None, x.sort),), f"b{i}", x.sort)
    return x


@pytest.mark.parametrize("reading", READINGS)
@pytest.mark.parametrize(("chain", "steps"), [(counter, DEEP // 2), (parity, DEEP), (named, DEEP // 2)])
def test_readings_agree_on_deep_chains(chain: Callable[[int], Term], steps: int, reading: str) -> None:
    output = chain(steps)
    assert len(postorder([output])) > DEEP
    check(reading, [output], [{v: edges(v.sort)[-1] for v in variables([output])}])


@pytest.mark.parametrize("column", ["python", "lanes"])
def test_source_of_shared_terms_is_written_once(column: str) -> None:
    x = named(400)
    assert len(source(column, [variable("x", uint(1))], [x])) < 100 * 400


@pytest.mark.parametrize("reading", TEXTS)
def test_many_inputs_and_outputs(reading: str) -> None:
    inputs = [variable(f"x{i}", BIT) for i in range(2_000)]
    outputs = [node("xor", (a, b), None, BIT) for a, b in zip(inputs, inputs[::-1], strict=True)]
    check(reading, outputs, [{v: i % 3 == 0 for i, v in enumerate(inputs)}])

"""Random systems over all operations, with a claim each; and claims without registers for every operation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from random import Random
from typing import Any

from hypothesis import strategies as st

from safety.system import ANY, Clock, State, System, substitute
from safety.terms import Bit
from safety.terms.direct import evaluate
from safety.terms.graph import Sort, Term, postorder, variable, variables
from safety.terms.values import all_of, bit, const
from tests.terms.agreement import has_reals
from tests.terms.graphs import EDGES, MAKERS, Maker, edges, values


@dataclass(frozen=True)
class Question:
    """A problem to export that no claim stands behind."""

    system: System
    holds: Any
    given: Any = field(default_factory=lambda: bit(True))
    start: Any = field(default_factory=lambda: bit(True))
    lemmas: Mapping[str, Bit] = field(default_factory=dict)


def system_of(states: list[State], inputs: list[Term], signals: Mapping[str, Term]) -> System:
    by_name = {str(v.attr): v for v in inputs}
    return System("Drawn", Clock(event="tick"), tuple(states), by_name, signals, {}, {}, {})


def fitted(x: Any, sort: Sort) -> Any:
    """Some value of the sort, made of another one."""
    if sort.kind == "bit":
        return x if x.sort.kind == "bit" else x.low(1).bit(0)
    x = x.word() if x.sort.kind == "bit" else x
    if sort.kind == "uint":
        return x.low(sort.width)
    return (x if x.sort.kind == "int" else x.int()).clip(*sort.bounds)


@st.composite
def questions(draw: Any) -> Question:
    """A system with registers of each sort, some of them free at power-up, and a claim about them and the inputs."""
    maker = Maker(draw, reals=False)
    for operation in draw(st.lists(st.sampled_from(sorted(MAKERS)), min_size=4, max_size=14)):
        maker.grow(operation)
    some = st.sampled_from(maker.pool)
    registers = [v for v in maker.inputs if draw(st.booleans())]
    states = [State(v, fitted(draw(some), v.sort), draw(st.just(ANY) | values(v.sort))) for v in registers]
    inputs = [v for v in maker.inputs if not any(v is r for r in registers)]
    kept = draw(st.sampled_from(registers)) if registers else bit(True)
    holds, given = (fitted(draw(some), bit(True).sort) | fitted(draw(some), bit(True).sort) for _ in range(2))
    start = fitted(kept, bit(True).sort)
    said = {"holds": holds, "given": given, "start": start}
    return Question(system_of(states, inputs, said), holds, given, start)


def operations_question(seed: int, widest: int, rows: int = 6) -> Question:
    """Every operation on its edges: under inputs that are given, each result is what the direct reading says.

    The inputs, a set of them for each row, are edge values drawn anew for each seed.  Graphs with a number of more
    than `widest` bits are left out.
    """
    rng = Random(seed)
    graphs = [t for graphs in EDGES.values() for t in graphs if not has_reals([t]) and _widest(t) <= widest]
    holds, given, inputs = [], [], []
    for k in range(rows):
        row = {v: rng.choice(edges(v.sort)) for v in variables(graphs)}
        own = {v.uid: variable(f"{v.attr} {k}", v.sort) for v in row}
        results = zip(substitute(graphs, own), evaluate(graphs, row), strict=True)
        inputs += own.values()
        holds += [t == const(value, t.sort) for t, value in results]
        given += [own[v.uid] == const(value, v.sort) for v, value in row.items()]
    return Question(system_of([], inputs, {}), all_of(*holds), all_of(*given))


def _widest(output: Term) -> int:
    return max(max(abs(b) for b in t.sort.bounds).bit_length() for t in postorder([output]))

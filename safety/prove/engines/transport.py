"""Problems and results between processes: pickled, terms as a table (graphs are deep), without what stays at home.

What a claim says as Python functions cannot travel and is not needed: the problem holds it as terms.
"""

from __future__ import annotations

import io
import pickle
from dataclasses import replace
from typing import Any

from safety.faults import Faulted
from safety.model import Model
from safety.prove.claims import Seen
from safety.prove.problem import Problem
from safety.terms import Bit
from safety.terms.graph import Term, node, postorder


def portable(problem: Problem) -> Problem:
    """The problem with a stand-in for its claim and its faults: they may hold functions, which cannot travel."""
    claim = replace(
        problem.claim, model=Model, formula=_stayed_at_home, given=None, start=None, lemmas=(), faults=None,
        scenario=None, witness=None, refinement=None,
    )  # fmt: skip
    return replace(problem, claim=claim, faulted=Faulted(problem.system, (), (), (), ()))


def _stayed_at_home(_: Seen) -> Bit:
    raise AssertionError("a claim that has travelled is a stand-in; its problem holds the formulas")


def packed(value: Any) -> bytes:
    """Any picklable value, its terms of any depth."""
    body = io.BytesIO()
    pickler = _Pickler(body, protocol=pickle.HIGHEST_PROTOCOL)
    pickler.dump(value)
    rows = [(t.uid, t.op, tuple(a.uid for a in t.args), t.attr, t.sort) for t in postorder(pickler.terms)]
    return pickle.dumps((rows, body.getvalue()), protocol=pickle.HIGHEST_PROTOCOL)


def unpacked(data: bytes) -> Any:
    """The value back; its terms are those of this process that have the same structure."""
    rows, body = pickle.loads(data)
    reader = _Unpickler(io.BytesIO(body))
    for uid, op, args, attr, sort in rows:
        reader.terms[uid] = node(op, tuple(reader.terms[a] for a in args), attr, sort)
    return reader.load()


class _Pickler(pickle.Pickler):
    def __init__(self, file: io.BytesIO, protocol: int) -> None:
        super().__init__(file, protocol)
        self.terms: list[Term] = []

    def persistent_id(self, value: Any) -> int | None:
        if not isinstance(value, Term):
            return None
        self.terms.append(value)
        return value.uid


class _Unpickler(pickle.Unpickler):
    def __init__(self, file: io.BytesIO) -> None:
        super().__init__(file)
        self.terms: dict[int, Term] = {}

    def persistent_load(self, uid: int) -> Term:
        return self.terms[uid]

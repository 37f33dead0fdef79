"""The direct reading: a term's value by walking the graph; slow and obvious, the twin of the generated readings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

from safety.terms.graph import Term, TermError, describe, postorder
from safety.terms.table import OPERATIONS


def evaluate(outputs: Iterable[Term], values: Mapping[Term, Any]) -> list[Any]:
    """Values of the outputs (bool, int, Fraction), given a value for each variable under them.

    Raises `TermError` for a variable without a value and for a value outside its variable's sort.
    """
    outputs = list(outputs)
    known: dict[int, Any] = {}
    for variable, value in values.items():
        if not variable.sort.admits(value):
            raise TermError(f"{describe(variable)} is {variable.sort}: {value!r} is not a value of it")
        known[variable.uid] = Fraction(value) if variable.sort.kind == "real" else value
    for term in postorder(outputs, set(known)):
        if term.op == "var":
            raise TermError(f"{describe(term)} has no value; give one")
        known[term.uid] = OPERATIONS[term.op].direct(term, *(known[a.uid] for a in term.args))
    return [known[t.uid] for t in outputs]

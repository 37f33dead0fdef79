"""Writing expressions in the project's own JSON (`json_study` has their form and reads them back).

Apart from all that a study holds, which takes longer to import than a small tree to solve.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from safety.trees.expressions.expression import Constant, Expression, Parameter


def expression_to_json(expression: Expression) -> Any:
    """An expression as JSON."""
    if isinstance(expression, Constant):
        return str(expression.number)
    if isinstance(expression, Parameter):
        return {"parameter": expression.name}
    return {expression.tag: [expression_to_json(argument) for argument in expression.arguments]}


def parameters_to_json(expressions: Iterable[Expression]) -> list[dict[str, Any]]:
    """The parameters that expressions use, as JSON."""
    found: dict[str, Parameter] = {}
    for expression in expressions:
        found |= expression.parameters
    return [
        {"name": one.name, "expression": expression_to_json(one.definition)}
        | {key: value for key, value in (("unit", one.unit), ("source", one.source)) if value}
        for one in found.values()
    ]

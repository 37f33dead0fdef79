"""The generated readings: a term graph as straight-line source, compiled once; Python numbers or NumPy lanes.

The Python reading serves reference runs and replay, the lanes serve campaigns.  Both come from one generator and
differ only in the table's column.
"""

from __future__ import annotations

import hashlib
import linecache
from collections import Counter
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from safety.terms.graph import Term, TermError, Value, describe, postorder
from safety.terms.table import OPERATIONS, is_object, literal

NESTING = 12  # expressions deeper than this get a name of their own; parsers limit nesting


def source(column: str, inputs: Sequence[Term], outputs: Sequence[Term], name: str = "step") -> str:
    """Source of a function from the inputs (variables, in order) to the tuple of outputs.

    `column` is `python` or `lanes`.  What reads no input is computed here, once.  Raises `TermError` for a variable
    that is not an input.
    """
    names = {term.uid: f"v{i}" for i, term in enumerate(inputs)}
    order = postorder(outputs, names)
    uses = Counter(t.uid for users in (*(t.args for t in order), outputs) for t in users)
    fixed: dict[int, Value] = {}
    text = dict(names)
    depth = dict.fromkeys(names, 0)
    lines = [f"def {name}({', '.join(names[t.uid] for t in inputs)}):"]
    for term in order:
        if term.op == "var":
            raise TermError(
                f"{describe(term)} is read but not bound: it belongs to another model or was created outside `step`"
            )
        row, level = OPERATIONS[term.op], 0
        if term.is_const:
            fixed[term.uid], expression = term.attr, getattr(row, column)(term)
        elif all(a.uid in fixed for a in term.args):
            fixed[term.uid] = row.direct(term, *(fixed[a.uid] for a in term.args))
            expression = literal(fixed[term.uid])
        else:
            expression = getattr(row, column)(term, *(text[a.uid] for a in term.args))
            level = 1 + max(depth[a.uid] for a in term.args)
        if level > NESTING or (level and uses[term.uid] > 1 and not expression.isidentifier()):
            lines.append(f"    t{len(lines)} = {expression}")
            expression, level = f"t{len(lines) - 1}", 0
        text[term.uid], depth[term.uid] = expression, level
    spread = column == "lanes" and inputs
    results = (_in_every_lane(text[t.uid], t) if spread and t.uid in fixed else text[t.uid] for t in outputs)
    lines.append(f"    return ({''.join(r + ', ' for r in results)})")
    return "\n".join(lines) + "\n"


def _in_every_lane(constant: str, term: Term) -> str:
    kind = "bool" if term.sort.kind == "bit" else "object" if is_object(term.sort) else "np.int64"
    return f"np.full(len(v0), {constant}, {kind})"


def _compiled(text: str, name: str, environment: dict[str, Any]) -> Callable[..., tuple[Any, ...]]:
    file = f"<{name} {hashlib.sha256(text.encode()).hexdigest()[:12]}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    exec(compile(text, file, "exec"), environment)
    function: Callable[..., tuple[Any, ...]] = environment[name]
    return function


def compile_python(inputs: Sequence[Term], outputs: Sequence[Term]) -> Callable[..., tuple[Any, ...]]:
    """The Python reading: a function of bool, int and Fraction values; `TermError` for a variable not among the inputs.

    Values are not checked against their sorts.
    """
    return _compiled(source("python", inputs, outputs), "step", {"Fraction": Fraction})


def compile_lanes(inputs: Sequence[Term], outputs: Sequence[Term]) -> Callable[..., tuple[Any, ...]]:
    """The lanes reading: a function of arrays of one length, of the `lane_type` of each input, to such arrays.

    Values are not checked against their sorts.  Without inputs the outputs are scalars.  Raises `TermError` for a
    variable not among the inputs.
    """
    import numpy as np

    environment = {
        "Fraction": Fraction,
        "np": np,
        "words": lambda x: np.asarray(x, dtype=np.int64),
        "objects": lambda x: np.asarray(x).astype(object),  # Python's own integers, also from a single int64
        "wires": lambda x: np.asarray(x, dtype=np.bool_),
        "fractions": np.frompyfunc(lambda x: Fraction(int(x)), 1, 1),
    }
    return _compiled(source("lanes", inputs, outputs), "step", environment)


def lane_type(term: Term) -> Any:
    """The NumPy dtype that lanes of a term have: bool, int64, or object beyond 64 bits and for reals."""
    import numpy as np

    return np.dtype(np.bool_ if term.sort.kind == "bit" else object if is_object(term.sort) else np.int64)

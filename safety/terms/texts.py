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

from safety.terms.graph import Term, TermError, describe, postorder
from safety.terms.table import OPERATIONS, is_object

NESTING = 12  # expressions deeper than this get a name of their own; parsers limit nesting


def source(column: str, inputs: Sequence[Term], outputs: Sequence[Term], name: str = "step") -> str:
    """Source of a function from the inputs (variables, in order) to the tuple of outputs."""
    names = {term.uid: f"v{i}" for i, term in enumerate(inputs)}
    order = postorder(outputs)
    uses = Counter(a.uid for t in order for a in t.args)
    text: dict[int, str] = {}
    depth: dict[int, int] = {}
    lines = [f"def {name}({', '.join(names[t.uid] for t in inputs)}):"]
    for term in order:
        if term.uid in names:
            text[term.uid], depth[term.uid] = names[term.uid], 0
            continue
        if term.op == "var":
            raise TermError(f"{describe(term)} is read but not bound: it belongs to another model or was created outside `step`")
        expression = getattr(OPERATIONS[term.op], column)(term, *(text[a.uid] for a in term.args))
        level = 1 + max((depth[a.uid] for a in term.args), default=0)
        if term.args and term.op != "point" and (uses[term.uid] > 1 or level > NESTING):
            lines.append(f"    t{len(lines)} = {expression}")
            expression, level = f"t{len(lines) - 1}", 0
        text[term.uid], depth[term.uid] = expression, level
    lines.append(f"    return ({''.join(text[t.uid] + ', ' for t in outputs)})")
    return "\n".join(lines) + "\n"


def _compiled(text: str, name: str, environment: dict[str, Any]) -> Callable[..., tuple[Any, ...]]:
    file = f"<{name} {hashlib.sha256(text.encode()).hexdigest()[:12]}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    exec(compile(text, file, "exec"), environment)
    function: Callable[..., tuple[Any, ...]] = environment[name]
    return function


def compile_python(inputs: Sequence[Term], outputs: Sequence[Term]) -> Callable[..., tuple[Any, ...]]:
    """The Python reading: a function of bool, int and Fraction values."""
    return _compiled(source("python", inputs, outputs), "step", {"Fraction": Fraction})


def compile_lanes(inputs: Sequence[Term], outputs: Sequence[Term]) -> Callable[..., tuple[Any, ...]]:
    """The lanes reading: a function of arrays of one length (bool, int64, object beyond 64 bits and for reals)."""
    import numpy as np

    def fractions(x: Any) -> Any:
        return np.array([Fraction(int(v)) for v in x], dtype=object)

    return _compiled(source("lanes", inputs, outputs), "step", {"Fraction": Fraction, "np": np, "fractions": fractions})


def lane_type(term: Term) -> Any:
    """The NumPy dtype that lanes of a term have."""
    import numpy as np

    return np.bool_ if term.sort.kind == "bit" else np.dtype(object) if is_object(term.sort) else np.int64

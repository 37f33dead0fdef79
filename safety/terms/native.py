"""The native reading: a term graph as LLVM vector code, the twin of the NumPy lanes at the speed of the processor."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from safety.terms.column_doubles import DOUBLES
from safety.terms.column_native import bit_of, lane_vector, mask_of, vector, width
from safety.terms.graph import BIT, Term, TermError, describe, postorder
from safety.terms.llvm import Library, Target, host
from safety.terms.table import OPERATIONS, is_object


class Writer:
    """LLVM text of a function's body, instruction by instruction; `names` says how each term written is called."""

    def __init__(self, target: Target) -> None:
        self.lanes, self.packed, self.sliced = target.lanes, target.packed, target.sliced
        self.ternary = target.ternary
        self.lines: list[str] = []
        self.names: dict[int, str] = {}
        self.intrinsics: set[str] = set()
        self.count = 0

    def fresh(self) -> str:
        """A name not used before."""
        self.count += 1
        return f"%v{self.count}"

    def op(self, text: str) -> str:
        """Write an instruction; the name of its result."""
        name = self.fresh()
        self.lines.append(f"{name} = {text}")
        return name

    def call(self, intrinsic: str, kind: str, *args: str) -> str:
        """Write a call of an intrinsic whose arguments and result are of one type; the name of its result."""
        full = f"@llvm.{intrinsic}.{kind.strip('<>').replace(' x ', '').replace('double', 'f64')}"
        full = re.sub(r"\.(\d+[if]\d+)$", r".v\1", full)
        self.intrinsics.add(f"declare {kind} {full}({', '.join([kind] * len(args))})")
        return self.op(f"call {kind} {full}({', '.join(f'{kind} {a}' for a in args)})")

    def of(self, term: Term) -> str:
        """The name of a term written before."""
        return self.names[term.uid]

    def write(self, roots: Iterable[Term]) -> None:
        """Write what the roots need and is not there yet.

        Raises `TermError` for a real, a number beyond 64 bits, or a variable that is not bound.
        """
        for term in postorder(roots, self.names):
            lane_vector(self, term)
            if term.op == "var":
                self.names[term.uid] = self.variable(term)
            else:
                arguments = (self.names[a.uid] for a in term.args)
                entry = DOUBLES[term.op] if term.op in DOUBLES else OPERATIONS[term.op].native
                self.names[term.uid] = entry(self, term, *arguments)

    def variable(self, term: Term) -> str:
        """Write what binds a variable, at its first use; here only those that have a name already are bound."""
        raise TermError(
            f"{describe(term)} is read but not bound: it belongs to another model or was created outside `step`"
        )


ATTRIBUTES = 'nounwind "prefer-vector-width"="512" "min-legal-vector-width"="512" alignstack(64)'


def native_source(inputs: Sequence[Term], outputs: Sequence[Term], target: Target) -> str:
    """LLVM text of `step(inputs, outputs, vectors)`: tables of array addresses, and how many vectors an array has."""
    k = Writer(target)
    k.lines += ["br label %loop", "loop:", "%i = phi i64 [ 0, %entry ], [ %next, %loop ]"]

    def place(table: str, position: int, term: Term) -> str:
        array = k.op(f"load ptr, ptr {k.op(f'getelementptr ptr, ptr %{table}, i64 {position}')}")
        size = k.lanes * bytes_of(term)
        return k.op(f"getelementptr i8, ptr {array}, i64 {k.op(f'mul i64 %i, {size}')}")

    for i, term in enumerate(inputs):
        k.names[term.uid] = load_bytes(k, term, place("inputs", i, term))
    k.write(outputs)
    for i, term in enumerate(outputs):
        store_bytes(k, term, k.names[term.uid], place("outputs", i, term))
    k.lines += ["%next = add i64 %i, 1", "%more = icmp ult i64 %next, %vectors", "br i1 %more, label %loop, label %end"]
    body = "\n".join(f"  {line}" for line in k.lines)
    head = f"define void @step(ptr %inputs, ptr %outputs, i64 %vectors) {ATTRIBUTES} {{"
    return "\n".join([*sorted(k.intrinsics), head, "entry:", body, "end:", "  ret void", "}", ""])


def load_bytes(k: Writer, term: Term, place: str) -> str:
    """A term's lanes from memory, where a bit is a byte."""
    if term.sort != BIT:
        return k.op(f"load {lane_vector(k, term)}, ptr {place}, align 1")
    kind = vector(k, 8)
    return bit_of(k, k.op(f"icmp ne {kind} {k.op(f'load {kind}, ptr {place}, align 1')}, zeroinitializer"))


def store_bytes(k: Writer, term: Term, name: str, place: str) -> None:
    """A term's lanes into memory, where a bit is a byte of 0 or 1."""
    kind = lane_vector(k, term)
    if term.sort == BIT:
        kind, name = vector(k, 8), k.op(f"zext {vector(k, 1)} {mask_of(k, name)} to {vector(k, 8)}")
    k.lines.append(f"store {kind} {name}, ptr {place}, align 1")


def bytes_of(term: Term) -> int:
    """Bytes of one lane of a term in memory."""
    return 1 if term.sort == BIT else width(term) // 8


def native_type(term: Term) -> Any:
    """The NumPy dtype of a term's lanes in memory."""
    import numpy as np

    if term.sort == BIT:
        return np.dtype(np.bool_)
    return np.dtype(f"{'i' if term.sort.bounds[0] < 0 else 'u'}{bytes_of(term)}")


def compile_native(
    inputs: Sequence[Term], outputs: Sequence[Term], target: Target | None = None
) -> Callable[..., tuple[Any, ...]]:
    """The native reading: a function of arrays of one length to such arrays, of the types that the NumPy lanes have.

    Values are not checked against their sorts.  Without inputs the outputs have one lane.  Raises `TermError` for a
    real, a number beyond 64 bits, or a variable not among the inputs.
    """
    import ctypes

    import numpy as np

    target = target or host()
    library = Library(native_source(inputs, outputs, target), target)
    run = library.function("step", ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64)

    def table(arrays: Sequence[Any]) -> Any:
        return (ctypes.c_void_p * max(len(arrays), 1))(*(a.ctypes.data for a in arrays))

    def step(*given: Any) -> tuple[Any, ...]:
        lanes = len(given[0]) if given else 1
        vectors = max(-(-lanes // target.lanes), 1)
        arrays = []
        for term, values in zip(inputs, given, strict=True):
            arrays.append(np.zeros(vectors * target.lanes, native_type(term)))
            arrays[-1][:lanes] = values
        results = [np.empty(vectors * target.lanes, native_type(term)) for term in outputs]
        run(table(arrays), table(results), vectors)
        wide = (np.bool_ if t.sort == BIT else object if is_object(t.sort) else np.int64 for t in outputs)
        return tuple(r[:lanes].astype(kind) for r, kind in zip(results, wide, strict=True))

    step.library = library  # type: ignore[attr-defined]  # the code lives as long as the function
    return step

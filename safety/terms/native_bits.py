"""The native reading bit by bit: a word is its bits, a bit of all lanes is one vector (a plane), terms are gates.

A vector of 512 bits then has 512 lanes, where words of 8 bits leave 64; an addition costs two instructions a bit on a
processor whose vectors have functions of three operands, a wire one where a byte would cost as much.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from safety.terms.column_bits import size_of
from safety.terms.column_native import bit_type, width
from safety.terms.graph import BIT, Term, postorder
from safety.terms.llvm import Library, Target
from safety.terms.native import ATTRIBUTES, Writer, bytes_of
from safety.terms.slicing import Slices, leaves
from safety.terms.table import is_object
from safety.terms.ternary import Function, cover

TERNARY = "@llvm.x86.avx512.pternlog.q.512"
AtPoint = Callable[[Term, Sequence[str]], Sequence[str]]  # a point and its healthy bits: the bits that are seen there


class Gates:
    """Writes bits, each once, and with each root only what it needs and is not there yet.

    `slices` are what the roots are of; `at_point` writes what a point that stands for itself does to its bits.
    """

    def __init__(self, k: Writer, slices: Slices, roots: Sequence[Term], at_point: AtPoint | None = None) -> None:
        self.k, self._slices, self._at_point = k, slices, at_point
        self._functions: dict[int, Function] = cover(self._with_points(roots)) if k.ternary else {}

    def _with_points(self, roots: Sequence[Term]) -> list[Term]:
        """The roots and all bits that points among their terms, and among those of these points, take."""
        found, new = list(roots), list(roots)
        seen: set[int] = set()
        while new:
            points = [self._slices.points[t.uid] for t in postorder(new) if t.uid in self._slices.points]
            new = [bit for point in points if point.uid not in seen for bit in self._slices.of(point.args[0])]
            seen |= {point.uid for point in points}
            found += new
        return found

    def of(self, bit: Term) -> str:
        """The name of a bit, written if it is not there."""
        stack = [bit]
        while stack:
            needs = [t for t in self._needs(stack[-1]) if t.uid not in self.k.names]
            stack += needs[::-1]
            if not needs:
                self._write(stack.pop())
        return self.k.names[bit.uid]

    def _needs(self, bit: Term) -> Sequence[Term]:
        if bit.uid in self.k.names:
            return ()
        if bit.uid in self._slices.points:
            return self._slices.of(self._slices.points[bit.uid].args[0])
        return self._functions[bit.uid].inputs if bit.uid in self._functions else bit.args

    def _write(self, bit: Term) -> None:
        k, kind = self.k, bit_type(self.k)
        if bit.uid in k.names:
            return
        if bit.uid in self._slices.points:
            point = self._slices.points[bit.uid]
            assert self._at_point is not None
            healthy = [k.names[x.uid] for x in self._slices.of(point.args[0])]
            k.names |= {x.uid: name for x, name in zip(leaves(point), self._at_point(point, healthy), strict=True)}
        elif bit.uid in self._functions and len(inputs := self._functions[bit.uid].inputs) == 3:
            k.intrinsics.add(f"declare {kind} {TERNARY}({kind}, {kind}, {kind}, i32)")
            given = ", ".join(f"{kind} {k.names[x.uid]}" for x in inputs)
            k.names[bit.uid] = k.op(f"call {kind} {TERNARY}({given}, i32 {self._functions[bit.uid].table})")
        else:
            k.write([bit])


# --- a function of arrays --------------------------------------------------------------------------------------------


def sliced_source(inputs: Sequence[Term], outputs: Sequence[Term], target: Target) -> str:
    """LLVM text of `step(inputs, outputs, vectors)`: arrays of planes, those of one vector of lanes after the other."""
    k, slices = Writer(target), Slices()
    roots = [bit for term in outputs for bit in slices.of(term)]
    k.lines += ["br label %loop", "loop:", "%i = phi i64 [ 0, %entry ], [ %next, %loop ]"]
    planes, kind = _planes(inputs), bit_type(k)

    def place(array: str, many: int, number: int) -> str:
        first = k.op(f"mul i64 %i, {many}")
        return k.op(f"getelementptr {kind}, ptr %{array}, i64 {k.op(f'add i64 {first}, {number}')}")

    for number, bit in enumerate(planes):
        k.names[bit.uid] = k.op(f"load {kind}, ptr {place('inputs', len(planes), number)}, align 8")
    gates = Gates(k, slices, roots)
    for number, bit in enumerate(roots):
        k.lines.append(f"store {kind} {gates.of(bit)}, ptr {place('outputs', len(roots), number)}, align 8")
    k.lines += ["%next = add i64 %i, 1", "%more = icmp ult i64 %next, %vectors", "br i1 %more, label %loop, label %end"]
    body = "\n".join(f"  {line}" for line in k.lines)
    head = f"define void @step(ptr noalias %inputs, ptr noalias %outputs, i64 %vectors) {ATTRIBUTES} {{"
    return "\n".join([*sorted(k.intrinsics), head, "entry:", body, "end:", "  ret void", "}", ""])


def _planes(terms: Sequence[Term]) -> list[Term]:
    return [bit for term in terms for bit in leaves(term)]


def compile_sliced(inputs: Sequence[Term], outputs: Sequence[Term], target: Target) -> Callable[..., tuple[Any, ...]]:
    """As `native.compile_native`, for a target in slices."""
    import ctypes

    import numpy as np

    library = Library(sliced_source(inputs, outputs, target), target)
    run = library.function("step", ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64)
    sizes = [size_of(t.sort) for t in outputs]

    def step(*given: Any) -> tuple[Any, ...]:
        lanes = len(given[0]) if given else 1
        vectors = max(-(-lanes // target.lanes), 1)
        bits = np.zeros((len(_planes(inputs)), vectors * target.lanes), np.bool_)
        rows = iter(bits)
        for term, values in zip(inputs, given, strict=True):
            whole = np.asarray(values).astype(object)
            for i in range(size_of(term.sort)):
                next(rows)[:lanes] = whole >> i & 1
        planes = np.packbits(bits.reshape(len(bits), vectors, target.lanes).swapaxes(0, 1), axis=2, bitorder="little")
        found = np.zeros((vectors, sum(sizes), target.lanes // 8), np.uint8)
        run(np.ascontiguousarray(planes).ctypes.data, found.ctypes.data, vectors)
        unpacked = np.unpackbits(found, axis=2, bitorder="little").swapaxes(0, 1)
        lines = unpacked.reshape(sum(sizes), vectors * target.lanes)[:, :lanes].astype(object)
        results, place = [], 0
        for term, size in zip(outputs, sizes, strict=True):
            number = sum(lines[place + i] << i for i in range(size))
            if term.sort.bounds[0] < 0:
                number = number - (number >> size - 1 << size)
            wide = np.bool_ if term.sort == BIT else object if is_object(term.sort) else np.int64
            results.append(number.astype(wide))
            place += size
        return tuple(results)

    step.library = library  # type: ignore[attr-defined]  # the code lives as long as the function
    return step


# --- which form is cheaper -------------------------------------------------------------------------------------------

FREE = {"const", "var", "point", "cast"}  # in both forms
WIRING = {"slice", "bit", "concat"}  # free in slices
GATES_A_BIT = {"add": 2, "sub": 2, "clip": 2}  # where it is not one
ON_WORDS = {"mul": 3, "div": 20, "mod": 20}  # vector instructions, where it is not one


def slices_pay(terms: Sequence[Term], held: Sequence[Term]) -> bool:
    """Whether the gates of terms, and of registers held, are fewer for each lane than instructions on words.

    A vector of words has an eighth of the lanes; a product or a division has a gate or more for each pair of bits.
    Raises `TermError` for a real, and beyond 64 bits.
    """
    gates = sum(size_of(t.sort) for t in held)
    words = sum(bytes_of(t) for t in held)
    for t in postorder(terms):
        width(t)
        if t.op in FREE:
            continue
        sizes = [size_of(a.sort) for a in t.args]
        words += max(map(bytes_of, (t, *t.args))) * ON_WORDS.get(t.op, 1)
        if t.op == "mul":
            gates += 2 * sizes[0] * sizes[1]
        elif t.op in ("div", "mod"):
            gates += 3 * sizes[0] * int(t.attr).bit_length()
        elif t.op not in WIRING:
            gates += max(sizes) * GATES_A_BIT.get(t.op, 1)
    return gates <= 8 * words

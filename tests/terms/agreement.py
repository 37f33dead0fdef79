"""Whether the readings of a graph agree: each reading's values for the same inputs, against those of the direct one."""

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from safety.terms import TermError
from safety.terms.direct import evaluate
from safety.terms.graph import Sort, Term, postorder, variables
from safety.terms.llvm import AVX2, AVX512, PLAIN, Target, host
from safety.terms.native import compile_native
from safety.terms.native_bits import compile_sliced
from safety.terms.slicing import Slices
from safety.terms.smt import SOLVERS, Encoder
from safety.terms.table import vector_bits
from safety.terms.texts import compile_lanes, compile_python, lane_type

Row = Mapping[Term, Any]
Values = list[list[Any]]  # a list per row of inputs, a value per output
Reading = Callable[[Sequence[Term], Sequence[Row], Values], Values]


class Disagreement(AssertionError):
    """A reading gave other values than the direct one, or broke."""


def python(outputs: Sequence[Term], rows: Sequence[Row], expected: Values) -> Values:
    inputs = variables(outputs)
    step = compile_python(inputs, outputs)
    return [list(step(*(row[v] for v in inputs))) for row in rows]


def lanes(outputs: Sequence[Term], rows: Sequence[Row], expected: Values) -> Values:
    inputs = variables(outputs)
    arrays = [np.array([row[v] for row in rows], dtype=lane_type(v)) for v in inputs]
    results = compile_lanes(inputs, outputs)(*arrays)
    if inputs:
        for term, result in zip(outputs, results, strict=True):
            assert result.dtype == lane_type(term), f"{term} has lanes of {result.dtype}"
            assert result.shape == (len(rows),), f"{term} has lanes of shape {result.shape}"
        results = tuple(result.tolist() for result in results)
    else:
        results = tuple([np.asarray(result).item()] * len(rows) for result in results)
    return [list(values) for values in zip(*results, strict=True)]


def solver(name: str, integers: bool) -> Reading:
    def reading(outputs: Sequence[Term], rows: Sequence[Row], expected: Values) -> Values:
        """Values in a model under fixed inputs; then no other values are possible."""
        encoder = Encoder(name, integers)
        k = encoder.k
        fixed, results = [], []
        for number, row in enumerate(rows):
            context = encoder.step_context()
            for v in variables(outputs):
                constant = encoder.variable(f"{v.attr}@{number}", v.sort)
                context.bind(v, constant)
                fixed.append(constant == constant_of(k, row[v], v.sort, integers))
            results.append(context(outputs))
        query = k.Solver()
        query.add(*encoder.ranges, *fixed, k.BoolVal(True))
        assert str(query.check()) == "sat", "the inputs contradict their ranges"
        model = query.model()
        found = [[encoder.value(model, x, t.sort) for x, t in zip(r, outputs, strict=True)] for r in results]
        if found == expected:
            query = k.Solver()
            others = [
                x != constant_of(k, value, t.sort, integers)
                for r, values in zip(results, expected, strict=True)
                for x, value, t in zip(r, values, outputs, strict=True)
            ]
            query.add(*encoder.ranges, *fixed, k.Or(*others, k.BoolVal(False)))
            assert str(query.check()) == "unsat", "other outputs are possible too"
        return found

    return reading


def constant_of(k: Any, value: Any, sort: Sort, integers: bool) -> Any:
    """A solver constant, made without the table."""
    if sort.kind == "bit":
        return k.BoolVal(value)
    if sort.kind == "real":
        return k.RealVal(str(value))
    return k.IntVal(value) if integers else k.BitVecVal(value % (1 << vector_bits(sort)), vector_bits(sort))


def compiled(inputs: Sequence[Term], outputs: Sequence[Term], target: Target) -> Any:
    """The native reading in the form of the target."""
    return (compile_sliced if target.sliced else compile_native)(inputs, outputs, target)


def bits(outputs: Sequence[Term], rows: Sequence[Row], expected: Values) -> Values:
    """Each bit read directly, and numbers made of them; beyond 64 bits the reading refuses."""
    found = [list(values) for values in expected]
    for i, output in enumerate(outputs):
        if not fits_64_bits(output):
            continue
        slices = Slices()
        planes = slices.of(output)
        for row, values in zip(found, rows, strict=True):
            given = {
                bit: bool(value >> k & 1)
                for variable in variables([output])
                for value in [int(values[variable])]
                for k, bit in enumerate(slices.of(variable))
            }
            number = sum(value << k for k, value in enumerate(evaluate(planes, given)))
            if output.sort.bounds[0] < 0 and number >> len(planes) - 1:
                number -= 1 << len(planes)
            row[i] = bool(number) if output.sort.kind == "bit" else number
    return found


def native(target: Target) -> Reading:
    def reading(outputs: Sequence[Term], rows: Sequence[Row], expected: Values) -> Values:
        """Values of the outputs that 64 bits hold; each other one has to be refused."""
        found = [list(values) for values in expected]
        fit = [i for i, output in enumerate(outputs) if fits_64_bits(output)]
        for i, output in enumerate(outputs):
            if i not in fit:
                try:
                    compiled(variables([output]), [output], target)
                except TermError:
                    continue
                raise AssertionError(f"{output} is not refused")
        inputs = variables([outputs[i] for i in fit])
        arrays = [np.array([row[v] for row in rows], dtype=lane_type(v)) for v in inputs]
        results = compiled(inputs, [outputs[i] for i in fit], target)(*arrays) if fit else ()
        for i, result in zip(fit, results, strict=True):
            assert result.dtype == lane_type(outputs[i]), f"{outputs[i]} has lanes of {result.dtype}"
            values = result.tolist() if inputs else result.tolist() * len(rows)
            for row, value in zip(found, values, strict=True):
                row[i] = value
        return found

    return reading


def fits_64_bits(output: Term) -> bool:
    """Whether all that a term is made of is a bit or a number of 64 bits."""
    sorts = {t.sort for t in postorder([output]) if t.sort.kind != "bit"}
    if any(s.kind == "real" for s in sorts):
        return False
    return all(high < 2 ** (64 if low >= 0 else 63) and low >= -(2**63) for low, high in (s.bounds for s in sorts))


def targets() -> dict[str, Target]:
    """The kinds of processor whose code this one runs."""
    features = host().features.split(",")
    can = {"avx512": (AVX512, "+avx512bw"), "avx2": (AVX2, "+avx2")}
    return {name: target for name, (target, feature) in can.items() if feature in features} | {"plain": PLAIN}


NATIVE: dict[str, Reading] = {"native": native(host())}
BITS: dict[str, Reading] = {"bits": bits}
TEXTS: dict[str, Reading] = {"python": python, "lanes": lanes}
INTEGERS: dict[str, Reading] = {f"integer {name}": solver(name, True) for name in SOLVERS}
VECTORS: dict[str, Reading] = {f"vector {name}": solver(name, False) for name in SOLVERS}
READINGS = {**TEXTS, **NATIVE, **BITS, **INTEGERS, **VECTORS}
COLUMNS = {
    "direct": ("python",),
    "python": ("python",),
    "lanes": ("lanes",),
    "integer": tuple(INTEGERS),
    "vector": tuple(VECTORS),
    "native": tuple(NATIVE),
    "bits": tuple(BITS),
}  # column of the table: the readings that show an error in it


def is_exact(sort: Sort, value: Any) -> bool:
    """Whether a value is of the one Python type of its sort, and in it."""
    return type(value) is {"bit": bool, "real": Fraction}.get(sort.kind, int) and sort.admits(value)


def check(name: str, outputs: Sequence[Term], rows: Sequence[Row]) -> None:
    """Raise `Disagreement` unless a reading and the direct one give the same values of the right types."""
    try:
        expected = [evaluate(outputs, row) for row in rows]
        found = READINGS[name](outputs, rows, expected)
    except Exception as error:
        raise Disagreement(f"{name}: {type(error).__name__}: {error}") from error
    for row, want, got in zip(rows, expected, found, strict=True):
        for term, right, value in zip(outputs, want, got, strict=True):
            if value != right or not (is_exact(term.sort, value) and is_exact(term.sort, right)):
                raise Disagreement(f"{name}: {term} is {value!r}, directly {right!r}, for {row}")


def has_reals(outputs: Sequence[Term]) -> bool:
    return any(t.sort.kind == "real" for t in postorder(outputs))

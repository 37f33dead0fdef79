"""A system with reals as one that native code can run: each real gives way to two doubles that enclose it.

A comparison is decided when all reals of its enclosures compare alike; where they do not, the lane takes a mark that it
never loses, and what it shows is not believed.  Nothing else about a run has to know of reals: the mark is a register
and a watched wire like others.  So lanes may be left out or share a run where their registers are equal: from equal
enclosures on they have the same enclosures, decide the same comparisons, each of them rightly for every real enclosed,
and take the same marks; and a lane without a mark has shown what the exact reading shows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

from safety.inject.kernel import live_states
from safety.inject.native.scales import Scales
from safety.inject.native.tapped import Tapped
from safety.system import State, System
from safety.terms.column_doubles import DOUBLE, apply, constants, encloses, enclosure, fits
from safety.terms.graph import BIT, REAL, Term, postorder, variable, variables
from safety.terms.values import Bit, any_of, build
from safety.trace import initial_state, run

if TYPE_CHECKING:
    import numpy.typing as npt

    from safety.inject.native.program import Program
    from safety.trace import Trace

    Array = npt.NDArray[Any]

UNDECIDED = "undecided comparison"  # a register, and the wire that shows it
HELD = "undecided comparison before"
LOW, HIGH = " low", " high"  # the doubles of a register or input are called after it

Pair = tuple[Term, Term]


class EnclosureError(Exception):
    """The fault-free run in doubles does not enclose the exact one: a defect of the engine, whose results are void."""

    exit_code = 70


@dataclass(frozen=True)
class Enclosed(Tapped):
    """A tapped system in doubles; `healthy` is the same while no fault acts;
    `scales` says of which multiple of a real they are."""

    healthy: System
    scales: Scales

    def without_faults(self) -> System:
        """See `Tapped`."""
        return self.healthy


def enclosed(exact: Tapped, wires: Sequence[str], start: Mapping[str, Any]) -> Enclosed:
    """A tapped system in doubles, with what the wires depend on, `UNDECIDED` among them, and power-up values set."""
    system, seen = exact.system, [name for name in wires if name != UNDECIDED]
    live = live_states(system.states, variables(system.lookup(name) for name in seen))
    values, _ = initial_state(system, start)
    power_up = {s.path: value for s, value in zip(system.states, values, strict=True)}
    both = system, exact.without_faults()
    following = [(s.var, one.state[s.path].next) for one in both for s in live]
    scales = Scales([*(n for _, n in following), *(one.lookup(name) for one in both for name in seen)], following)
    versions = [_in_doubles(one, live, seen, power_up, scales) for one in both]

    def choices(step: int) -> Mapping[str, Any]:
        given = exact.choices(step).items()
        return dict(_spread(system.inputs, {n: _scaled(v, system.inputs[n], scales) for n, v in given}, enclosure))

    return Enclosed(versions[0], exact.masks, exact.switches, choices, exact.changes, versions[1], scales)


def _scaled(value: Any, var: Term, scales: Scales) -> Any:
    return value * scales.of(var) if var.sort == REAL else value


def _in_doubles(
    system: System, live: Sequence[State], wires: Sequence[str], power_up: Mapping[str, Any], scales: Scales
) -> System:
    lowering = Lowering(scales)
    observed = {name: system.lookup(name) for name in wires}
    following = [system.state[s.path].next for s in live]
    lowering.write([*following, *observed.values()])
    states: list[State] = []
    for s, term in zip(live, following, strict=True):
        if s.var.sort == REAL:
            scale = scales.of(s.var)
            first = enclosure(power_up[s.path] * scale)
            parts = zip(_pair_of(s.var), lowering.at(term, scale), first, strict=True)
            states += [State(var, after, value) for var, after, value in parts]
        else:
            states.append(State(s.var, lowering.new[term.uid], power_up[s.path]))
    held = cast(Bit, variable(HELD, BIT))
    mark = any_of(held, *lowering.marks)
    states.append(State(held, mark, False))
    inputs: dict[str, Term] = {}
    for name, term in system.inputs.items():
        inputs |= {str(v.attr): v for v in _pair_of(term)} if term.sort == REAL else {name: term}
    named = {s.path for s in states} | inputs.keys()
    signals = {name: lowering.new[term.uid] for name, term in observed.items() if name not in named}
    return replace(
        system,
        states=tuple(states),
        inputs=inputs,
        signals=signals | {UNDECIDED: mark},
        points={},
        assumptions={},
    )


def _pair_of(var: Term) -> Pair:
    return variable(f"{var.attr}{LOW}", DOUBLE), variable(f"{var.attr}{HIGH}", DOUBLE)


def _spread(
    inputs: Mapping[str, Term], given: Mapping[str, Any], parts: Callable[[Any], tuple[Any, Any]]
) -> Iterable[tuple[str, Any]]:
    """What is given for inputs, that of a real as its two doubles."""
    for name, value in given.items():
        if inputs[name].sort == REAL:
            yield from zip((name + LOW, name + HIGH), parts(value), strict=True)
        else:
            yield name, value


def stimulus_in_doubles(inputs: Mapping[str, Term], given: Mapping[str, Array], scales: Scales) -> Mapping[str, Array]:
    """Each input of a system in doubles, a value a frame."""
    import numpy as np

    def parts(values: Array) -> tuple[Array, Array]:
        both = np.array([enclosure(value) for value in values], object).reshape(-1, 2)
        return both[:, 0], both[:, 1]

    return dict(_spread(inputs, {name: _scaled(values, inputs[name], scales) for name, values in given.items()}, parts))


class Lowering:
    """Terms in doubles: `pairs` of each real, `new` for each other term, and the `marks` of undecided comparisons."""

    def __init__(self, scales: Scales) -> None:
        self.scales = scales
        self.pairs: dict[int, Pair] = {}
        self.new: dict[int, Term] = {}
        self.marks: list[Bit] = []

    def write(self, roots: Iterable[Term]) -> None:
        """Lower what the roots need."""
        for term in postorder(roots):
            if term.sort == REAL:
                if not term.is_const:
                    self.pairs[term.uid] = self._real(term)
            elif term.args and term.args[0].sort == REAL:
                scale = next((self.scales.of(a) for a in term.args if not a.is_const), 1)
                self.new[term.uid] = self._compared(term.op, *(self.at(a, scale) for a in term.args))
            else:
                args = tuple(self.new[a.uid] for a in term.args)
                self.new[term.uid] = build(term.op, args, term.attr, term.sort) if args else term

    def at(self, term: Term, scale: int) -> Pair:
        """A real in a unit, which is its own unless it is a constant."""
        return constants(term.attr * scale) if term.is_const else self.pairs[term.uid]

    def _real(self, term: Term) -> Pair:
        scale = self.scales.of(term)
        if term.op == "var":
            return _pair_of(term)
        if term.op == "cast":
            whole = self.new[term.args[0].uid]
            if whole.is_const:
                return constants(whole.attr * scale)
            down = apply("cast_down", whole)
            return _times((down, down if fits(whole.sort) else apply("cast_up", whole)), Fraction(scale))
        if term.op == "select":
            condition, x, y = self.new[term.args[0].uid], *(self.at(a, scale) for a in term.args[1:])
            low, high = (build("select", (condition, *ends), None, DOUBLE) for ends in zip(x, y, strict=True))
            return low, high
        if term.op == "mul":
            return self._multiplied(term, Fraction(scale))
        (low, high), *others = (self.at(a, scale) for a in term.args)
        if term.op == "point":
            return low, high
        (least, greatest), *_ = others
        if term.op == "add":
            return apply("add_down", low, least), apply("add_up", high, greatest)
        assert term.op == "sub", term.op
        return apply("sub_down", low, greatest), apply("sub_up", high, least)

    def _multiplied(self, term: Term, scale: Fraction) -> Pair:
        x, y = term.args
        if x.is_const:
            x, y = y, x
        if y.is_const:
            return _times(self.pairs[x.uid], y.attr * scale / self.scales.of(x))
        product = _product(self.pairs[x.uid], self.pairs[y.uid])
        return _times(product, scale / (self.scales.of(x) * self.scales.of(y)))

    def _compared(self, op: str, x: Pair, y: Pair) -> Term:
        """A comparison: true where it holds for all reals enclosed; a mark where it is neither that nor never."""
        (a, b), (c, d) = x, y
        holds, fails = {
            "eq": lambda: ((_up_to(b, c) & _up_to(d, a)), (_below(b, c) | _below(d, a))),
            "lt": lambda: (_below(b, c), _up_to(d, a)),
            "le": lambda: (_up_to(b, c), _below(d, a)),
        }[op]()
        self.marks.append(~(holds | fails))
        return holds


def _below(x: Term, y: Term) -> Bit:
    return cast(Bit, apply("below", x, y))


def _up_to(x: Term, y: Term) -> Bit:
    return cast(Bit, apply("up_to", x, y))


def _times(x: Pair, factor: Fraction) -> Pair:
    return x if factor == 1 else _product(x, constants(factor))


def _product(x: Pair, y: Pair) -> Pair:
    """All four products of bounds, or fewer where a factor is a constant, whose sign is known."""
    if y[0].is_const:
        negative = cast(int, y[0].attr) >> 63 == 1
        low, high = (x[1], x[0]) if negative else x
        if negative == (cast(int, y[1].attr) >> 63 == 1):
            return apply("mul_down", low, low, *y), apply("mul_up", high, high, *y)
    return apply("mul_down", *x, *y), apply("mul_up", *x, *y)


# --- the fault-free run ----------------------------------------------------------------------------------------------


def check_enclosed(program: Program, exact: Trace) -> None:
    """The fault-free run in doubles encloses the exact one, as long as no comparison was undecided.

    Raises `EnclosureError` naming what is outside, and its step.
    """
    rows, kernel = program.rows, program.kernel
    place = {str(term.attr): f"v{i}" for i, term in enumerate(kernel.row.given)}
    marked = rows[place[HELD]][: len(exact)].tolist()
    scales = scales_of(program)
    believed = marked.index(1) if 1 in marked else len(exact)
    for path, values in exact.columns.items():
        if exact.sort(path) == REAL and path + LOW in place:
            low, high = (rows[place[path + part]].tolist() for part in (LOW, HIGH))
        elif path in place:
            low = rows[place[path]].tolist()
        else:
            continue
        for step in range(believed):
            if exact.sort(path) != REAL and low[step] != values[step]:
                raise EnclosureError(f"{path} is {values[step]} at step {step}, but {low[step]} in native code")
            if exact.sort(path) == REAL and not encloses(low[step], high[step], values[step] * scales[path]):
                raise EnclosureError(f"{path} = {values[step]} at step {step} lies outside its doubles")


def scales_of(program: Program) -> Mapping[str, int]:
    """Of which multiple of each register or input the doubles are."""
    tapped = program.kernel.tapped
    assert isinstance(tapped, Enclosed)
    paths = {str(term.attr).removesuffix(LOW) for term in program.kernel.row.given}
    return {path: tapped.scales.of(variable(path, REAL)) for path in paths}


def exact_run(program: Program, system: System, inputs: Callable[[int], Mapping[str, Any]], start: Any) -> Trace:
    """The fault-free run on the Python reading, with the registers that the program has.

    Raises `ModelError` when it breaks an assumption.
    """
    paths = {s.path.removesuffix(LOW) for s in program.kernel.registers}
    t = program.task.timing
    kept = [path for path in system.state if path in paths]
    return run(system, lambda step: inputs(step // t.steps), t.frames * t.steps, start=start, keep=kept)

"""Runs on the Python reading, and what a run leaves: a `Trace` as table, VCD or JSON."""

from __future__ import annotations

import itertools
import operator
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from typing import Any

from safety.model import Model
from safety.system import ANY, ModelError, State, System, nearest
from safety.terms.graph import Sort
from safety.terms.texts import compile_python
from safety.tracing import trace

TOLD = 18  # signals that tell a story
OFTEN = 400  # more changes tell nothing
SELDOM = 12  # changes of a signal that seldom changes
INTERNAL = re.compile(r"claim\.|watch\.|fault\d+(\.|$)")  # registers of claims and faults

Row = Mapping[str, Any]
Inputs = Iterable[Row] | Mapping[str, Any] | Callable[[int], Row]


@dataclass
class Trace:
    """Values of every signal at every step: `trace["a.u"]` is a list, one value a step.

    A register's value at step k is the one before the step; points and outputs are those of the step.
    `chosen` holds the power-up values that ANY left open.
    """

    system: System
    steps: int
    columns: dict[str, list[Any]]
    chosen: dict[str, Any] = field(default_factory=dict)

    def __getitem__(self, path: str) -> list[Any]:
        if path not in self.columns:
            raise ModelError(f"{self.system.name} has no signal {path!r}; {nearest(path, self.columns)}")
        return self.columns[path]

    def __len__(self) -> int:
        return self.steps

    def sort(self, path: str) -> Sort:
        """The sort of a signal."""
        return self.system.lookup(path).sort

    def row(self, step: int) -> dict[str, Any]:
        """All values of one step."""
        return {path: values[step] for path, values in self.columns.items()}

    def changes(self, first: int = 0, last: int | None = None) -> Iterator[tuple[int, dict[str, Any]]]:
        """Steps with the signals that differ from the step before (all of them at the first)."""
        previous: dict[str, Any] = {}
        for k in range(first, self.steps if last is None else last + 1):
            row = self.row(k)
            changed = {p: v for p, v in row.items() if p not in previous or previous[p] != v}
            if changed:
                yield k, changed
            previous = row

    def telling(self, first: Sequence[str] = ()) -> list[str]:
        """Signals that tell the run's story: `first`, inputs and outputs of the whole, then those that seldom change.

        What watches, what hardly ever stands still, and a second name for one course of values are left out.
        """
        changes = {p: sum(x != y for x, y in pairwise(values)) for p, values in self.columns.items()}
        outer = [p for p in (*self.system.inputs, *self.system.signals) if changes.get(p) and self._of_the_whole(p)]
        moving = sorted((p for p in changes if changes[p]), key=lambda p: (p.count("."), changes[p], p))
        seldom = [p for p in moving if changes[p] <= max(SELDOM, len(self) // 4)]
        shown: dict[tuple[str, ...], str] = {}
        for path in dict.fromkeys([*(p for p in first if p in changes), *outer, *seldom]):
            if not INTERNAL.match(path) and changes[path] <= OFTEN:
                shown.setdefault(tuple(map(str, self[path])), path)
        return list(shown.values())[:TOLD]

    def _of_the_whole(self, path: str) -> bool:
        return "." not in path or path in self.system.inputs

    def table(self, paths: Sequence[str] | None = None, first: int = 0, last: int | None = None) -> str:
        """A text table, a line a step at which something changed; an unchanged cell is a dot.

        Raises `ModelError` for a path that the run does not have.
        """
        paths = list(paths or self.columns)
        for path in paths:
            self[path]
        lines = [["step", *paths]]
        for k, changed in self.changes(first, last):
            cells = [show(changed[p]) if p in changed else "." for p in paths]
            if any(c != "." for c in cells):
                lines.append([str(k), *cells])
        widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
        return "\n".join("  ".join(c.rjust(w) for c, w in zip(line, widths, strict=True)) for line in lines)

    def vcd(self) -> str:
        """The run as a value change dump (IEEE 1364): parts are scopes, a real is the nearest double.

        The time unit is the coarsest that a step is a whole number of; where there is none, times are rounded to less
        than a millionth of a step.  An event is one unit.
        """
        unit, scale = _timescale(self.system.clock.period)
        names = {p: _code(i) for i, p in enumerate(self.columns)}
        lines = [
            "$version rightside $end",
            f"$comment one step is {_amount(scale)} x {unit}; steps {self.system.clock} $end",
            f"$timescale {unit} $end",
            *_declarations({p: (self.sort(p), code) for p, code in names.items()}, self.system.name),
            "$enddefinitions $end",
        ]
        for k, changed in self.changes():
            lines.append(f"#{round(k * scale)}")
            lines += [_vcd_value(self.sort(p), v, names[p]) for p, v in changed.items()]
        return "\n".join([*lines, f"#{round(self.steps * scale)}", ""])

    def to_json(self, paths: Sequence[str] | None = None) -> dict[str, Any]:
        """Signals with kind and, for each, its changes as [step, value]; exact rationals as `p/q`."""
        kinds = {"bit": "bit"}
        return {
            "steps": self.steps,
            "tick_s": str(self.system.clock.period) if self.system.clock.period else None,
            "signals": [
                {"path": p, "kind": kinds.get(self.sort(p).kind, "number"), "unit": "", "changes": self._steps(p)}
                for p in (paths or self.columns)
            ],
        }  # fmt: skip

    def _steps(self, path: str) -> list[list[Any]]:
        values = [str(v) if isinstance(v, Fraction) else v for v in self[path]]
        return [[k, v] for k, v in enumerate(values) if k == 0 or v != values[k - 1]]


def show(value: Any) -> str:
    """A value as a short text: bits as 0 and 1."""
    return str(int(value)) if isinstance(value, bool) else str(value)


_UNITS = {"1 s": 1, "1 ms": 10**3, "1 us": 10**6, "1 ns": 10**9, "1 ps": 10**12, "1 fs": 10**15}


def _timescale(period: Fraction | None) -> tuple[str, Fraction]:
    """A unit of time and how many of it a step takes: a whole number, else a million or more; 1 for an event."""
    if period is None:
        return "1 ns", Fraction(1)
    scales = {unit: period * per_second for unit, per_second in _UNITS.items()}
    whole = (item for item in scales.items() if item[1].denominator == 1)
    fine = (item for item in scales.items() if item[1] >= 10**6)
    return next(whole, None) or next(fine, ("1 fs", scales["1 fs"]))


def _amount(scale: Fraction) -> str:
    """Times of a step are whole, or rounded."""
    return str(scale) if scale.denominator == 1 else f"about {float(scale):.12g}"


def _declarations(signals: Mapping[str, tuple[Sort, str]], whole: str) -> Iterator[str]:
    """The variables of a dump, those of a part within its scope."""
    yield f"$scope module {_word(whole)} $end"
    inside: list[str] = []
    for path in sorted(signals, key=lambda p: (p.split(".")[:-1], p)):
        sort, code = signals[path]
        *scopes, name = map(_word, path.split("."))
        shared = next(
            (i for i, (x, y) in enumerate(zip(inside, scopes, strict=False)) if x != y), min(len(inside), len(scopes))
        )
        yield from ["$upscope $end"] * (len(inside) - shared)
        yield from (f"$scope module {scope} $end" for scope in scopes[shared:])
        inside = scopes
        yield f"$var {'real' if sort.kind == 'real' else 'wire'} {_bits(sort)} {code} {name} $end"
    yield from ["$upscope $end"] * (len(inside) + 1)


def _word(text: str) -> str:
    return "_".join(text.split())


def _bits(sort: Sort) -> int:
    """Bits of a value in a dump: an integer that can be negative is two's complement."""
    if sort.kind == "real":
        return 64
    low, high = sort.bounds
    return max(low.bit_length(), high.bit_length(), 1) + (low < 0)


def _code(i: int) -> str:
    digits = ""
    while True:
        i, r = divmod(i, 94)
        digits += chr(33 + r)
        if not i:
            return digits


def _vcd_value(sort: Sort, value: Any, code: str) -> str:
    if sort.kind == "bit":
        return f"{int(value)}{code}"
    if sort.kind == "real":
        return f"r{float(value):.17g} {code}"
    return f"b{value % (1 << _bits(sort)):b} {code}"


@dataclass
class Stepper:
    """A system compiled on the Python reading: next registers, observed signals and assumptions, in this order."""

    system: System
    function: Callable[..., tuple[Any, ...]]
    observed: list[str]

    @classmethod
    def of(cls, system: System, keep: Sequence[str] | None = None) -> Stepper:
        """Compile a system's step; with `keep` only those signals are computed besides the registers."""
        inputs = [*(s.var for s in system.states), *system.inputs.values()]
        known = dict.fromkeys(
            p for p in (*system.points, *system.signals) if p not in system.state and p not in system.inputs
        )
        observed = [p for p in known if keep is None or p in keep]
        outputs = [
            *(s.next for s in system.states),
            *(system.lookup(p) for p in observed),
            *system.assumptions.values(),
        ]
        return cls(system, compile_python(inputs, outputs), observed)


def run(
    model: type[Model] | System,
    inputs: Inputs = (),
    steps: int | None = None,
    *,
    start: Mapping[str, Any] | None = None,
    settings: Mapping[str, Any] | None = None,
    keep: Sequence[str] | None = None,
) -> Trace:
    """Run a model on the Python reading.

    `inputs` gives a row a step: a sequence, one row for all steps, or a function of the step number (`steps` then says
    how many).  `start` sets power-up values that are ANY (0 or false else); `keep` restricts the recorded signals.
    Raises `ModelError` for an unknown or missing input, a value outside its sort, or a broken assumption.
    """
    live = Live(model, start=start, settings=settings, keep=keep)
    kept = live.paths if keep is None else list(keep)
    index = [live.paths.index(p) for p in kept]
    columns: list[list[Any]] = [[] for _ in kept]
    for row in _rows(inputs, steps):
        values = live.step(row)
        for column, i in zip(columns, index, strict=True):
            column.append(values[i])
    return Trace(live.system, live.count, dict(zip(kept, columns, strict=True)), live.chosen)


class Live:
    """A model that is run step by step, each row being given in view of what the model shows: closed loops.

    `paths` names what is recorded, `keep` restricts it as in `run`; `chosen` are the power-up values that were ANY.
    Raises `ModelError` as `run` does.
    """

    def __init__(
        self,
        model: type[Model] | System,
        *,
        start: Mapping[str, Any] | None = None,
        settings: Mapping[str, Any] | None = None,
        keep: Sequence[str] | None = None,
    ) -> None:
        self.system = model if isinstance(model, System) else trace(model, settings)
        for path in keep or ():
            self.system.lookup(path)
        self._stepper = Stepper.of(self.system, keep)
        self._state, self.chosen = initial_state(self.system, start or {})
        self.paths = [*self.system.state, *self.system.inputs, *self._stepper.observed]
        self.count = 0
        self._inputs, self._given = list(self.system.inputs), list[Any]()

    @property
    def state(self) -> dict[str, Any]:
        """The registers before the next step."""
        return dict(zip(self.system.state, self._state, strict=True))

    def step(self, row: Row) -> tuple[Any, ...]:
        """Take one step: the values of `paths` in it."""
        system, n, watched = self.system, len(self.system.states), len(self._stepper.observed)
        self._given = _checked(system, row, self._inputs, self.count, self._given)
        result = self._stepper.function(*self._state, *self._given)
        if False in result[n + watched :]:
            label = list(system.assumptions)[result[n + watched :].index(False)]
            raise ModelError(
                f"step {self.count} of {system.name} breaks the assumption {label!r}: choose inputs that keep it"
            )
        values = (*self._state, *self._given, *result[n : n + watched])
        self._state = result[:n]
        self.count += 1
        return values

    def shown(self, row: Row) -> dict[str, Any]:
        """Take one step: what each path shows in it."""
        return dict(zip(self.paths, self.step(row), strict=True))


def _rows(inputs: Inputs, steps: int | None) -> Iterator[Row]:
    if callable(inputs) or isinstance(inputs, Mapping):
        if steps is None:
            raise ModelError("say how many steps to run: run(..., steps=n)")
        return (inputs(k) if callable(inputs) else inputs for k in range(steps))
    rows = iter(inputs) if inputs else itertools.repeat({})
    if not inputs and steps is None:
        raise ModelError("say how many steps to run: run(..., steps=n)")
    return itertools.islice(rows, steps)


def initial_state(system: System, start: Mapping[str, Any]) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """Power-up values in the order of the registers, and those that ANY left open as they were chosen.

    What `start` does not say is 0 or false, or the least value that there is; of an open parameter it is the default.
    """
    for path in start:
        if path not in system.state:
            raise ModelError(f"{system.name} has no register {path!r}; {nearest(path, system.state)}")
    values, chosen = [], {}
    for s in system.states:
        if s.power_up is not ANY:
            value = s.power_up
            if start.get(s.path, value) != value:
                raise ModelError(
                    f"{s.path} is {value!r} at power-up, not {start[s.path]!r}: only registers declared ANY can be set"
                )
        else:
            value = chosen[s.path] = start.get(s.path, _unset(system, s))
        if not s.var.sort.admits(value):
            raise ModelError(f"{s.path} is {s.var.sort}: {value!r} is not a value of it")
        values.append(value)
    _in_range(system, chosen)
    return tuple(values), chosen


def _unset(system: System, state: State) -> Any:
    if state.path in system.settings:
        return system.settings[state.path].default
    return least(state.var.sort)


def least(sort: Sort) -> Any:
    """The value that stands where none is given: 0 or false, or the least of a range."""
    return {"bit": False, "real": Fraction(0)}.get(sort.kind, sort.low)


def _in_range(system: System, chosen: Mapping[str, Any]) -> None:
    """Refuse an open parameter outside its range."""
    for path, value in chosen.items():
        setting = system.settings.get(path)
        if setting is not None and not setting.low <= value <= setting.high:
            raise ModelError(f"{path} = {value} lies outside {setting.low}..{setting.high} {setting.unit}")


def _checked(system: System, row: Row, names: list[str], step: int, before: list[Any]) -> list[Any]:
    """The inputs of a step in order; values that are those of the step before need no second look."""
    try:
        values = [row[name] for name in names]
    except KeyError:
        values = []
    if len(row) != len(names) or len(values) != len(names):
        for name in row:
            if name not in system.inputs:
                raise ModelError(f"{system.name} has no input {name!r} (step {step}); {nearest(name, names)}")
        missing = ", ".join(name for name in names if name not in row)
        raise ModelError(f"step {step} of {system.name} lacks the input {missing}")
    if len(before) == len(values) and all(map(operator.is_, values, before)):
        return before
    for name, value in zip(names, values, strict=True):
        sort = system.inputs[name].sort
        if not sort.admits(value):
            raise ModelError(f"step {step}: input {name} is {sort}: {value!r} is not a value of it")
    return values

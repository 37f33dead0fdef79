"""Models: one plain `step` function over typed terms, with registers, parameters, named points and parts.

    class Divider(Model, tick_s="125e-6"):
        \"\"\"Every third pulse.\"\"\"
        n: U2 = power_up(0)
        def step(self, pulse: Bit) -> tuple[Divider, Out]: ...

A register needs a power-up value or ANY; every step returns every register, so a forgotten update is an error.  A part
is a field whose type is a model, and a call of its `step`.  `point("ref", v)` names a place where faults can act.
"""

from __future__ import annotations

import functools
import inspect
import sys
import typing
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from fractions import Fraction
from typing import Any, Literal, TypeVar, cast, dataclass_transform

from safety.system import ANY, Clock, ModelError, PowerUpValue, Setting, State, System, nearest
from safety.terms import Bit, Int, Real, Term, UInt
from safety.terms.graph import BIT, REAL, Sort, describe, integer, node, uint, variable
from safety.terms.values import all_of, bit, const

AnyTerm = TypeVar("AnyTerm", Bit, UInt, Int, Real)


@dataclass(frozen=True)
class PowerUp:
    """A register's value when power comes."""

    value: PowerUpValue


def power_up(value: PowerUpValue) -> Any:
    """Declare a register: its value at power-up, or ANY."""
    return PowerUp(value)


@dataclass(frozen=True)
class Parameter:
    """A typed quantity that is fixed for a run: default, unit, admissible range, source."""

    default: Any
    unit: str
    low: Any
    high: Any
    source: str
    name: str = ""

    def __get__(self, owner: Model | None, _: type | None = None) -> Any:
        if owner is None:
            return self
        return _parameter_value(owner, self)


def parameter(default: Any, *, unit: str, within: tuple[Any, Any], source: str, init: Literal[False] = False) -> Any:
    """Declare a parameter; `source` starts with its tag: [P] printed, [D] derived, [A] assumed, [R] reconstructed.

    Raises `ModelError` when the tag is missing or the default lies outside `within`.
    """
    if source[:3] not in ("[P]", "[D]", "[A]", "[R]"):
        raise ModelError(f"parameter source {source!r}: start it with [P], [D], [A] or [R]")
    if not within[0] <= default <= within[1]:
        raise ModelError(f"parameter default {default} {unit} lies outside {within[0]}..{within[1]}")
    return Parameter(default, unit, within[0], within[1], source)


@dataclass
class _Scope:
    """What a trace collects while `step` runs."""

    root: str
    settings: Mapping[str, Any]
    symbolic: frozenset[str]
    direct: bool = False
    path: str = ""
    signals: dict[str, Term] = field(default_factory=dict)
    points: dict[str, Term] = field(default_factory=dict)
    used: dict[str, Setting] = field(default_factory=dict)
    rigid: dict[str, State] = field(default_factory=dict)
    parts: dict[str, str] = field(default_factory=dict)
    assumptions: dict[str, Term] = field(default_factory=dict)
    start: list[Bit] = field(default_factory=list)

    @contextmanager
    def within(self, path: str) -> Iterator[None]:
        before, self.path = self.path, path
        try:
            yield
        finally:
            self.path = before


_scope: ContextVar[_Scope | None] = ContextVar("scope", default=None)


def point(name: str, value: AnyTerm) -> AnyTerm:
    """Name a place where a fault can act; healthy it is `value`.  The full name takes the path of the part.

    Raises `ModelError` when the name is used twice in one step.
    """
    scope = _scope.get()
    if scope is None:
        return value
    full = scope.path + name
    if full in scope.points:
        raise ModelError(f"point {full!r} is named twice in one step; give the second one a name of its own")
    named = value if scope.direct else node("point", (value,), full, value.sort)
    scope.points[full] = named
    return cast(AnyTerm, named)


def assume(label: str, condition: Bit) -> None:
    """State what the surroundings guarantee at every step; it is shown in each result and checked in each run."""
    scope = _scope.get()
    if scope is not None:
        scope.assumptions[scope.path + label] = condition


@dataclass_transform(kw_only_default=True, frozen_default=True, field_specifiers=(power_up, parameter))
class Model:
    """Base of all models; subclass with `tick_s=` (seconds a step) or `event=` (what a step happens at)."""

    _clock: typing.ClassVar[Clock | None] = None
    _locals: typing.ClassVar[Mapping[str, Any]] = {}
    _path = ""

    def __init_subclass__(cls, *, tick_s: float | str | Fraction | None = None, event: str | None = None) -> None:
        if tick_s is not None and event is not None:
            raise ModelError(f"{cls.__name__}: a clock is a period or an event, not both")
        if tick_s is not None:
            cls._clock = Clock(period=Fraction(str(tick_s)))
        elif event is not None:
            cls._clock = Clock(event=event)
        cls._locals = sys._getframe(1).f_locals
        if "step" in cls.__dict__:
            cls.step = _recorded(cls.__dict__["step"])  # type: ignore[attr-defined]
        for name, value in list(cls.__dict__.items()):
            if isinstance(value, Parameter):
                setattr(cls, name, Parameter(value.default, value.unit, value.low, value.high, value.source, name))

    def __init__(self, **values: Any) -> None:
        cls = type(self)
        fields = {**registers(cls), **parts(cls)}
        missing, unknown = fields.keys() - values.keys(), values.keys() - fields.keys()
        if missing:
            raise ModelError(f"{cls.__name__}(...) lacks {', '.join(sorted(missing))}: every step returns every register and part")
        if unknown:
            name = sorted(unknown)[0]
            raise ModelError(f"{cls.__name__} has no register or part {name!r}; {nearest(name, fields)}")
        for name, kind in fields.items():
            value = values[name]
            if isinstance(kind, type):
                if not isinstance(value, kind):
                    raise ModelError(f"{cls.__name__}({name}=...) is a {kind.__name__}, not {value!r}")
            else:
                value = _fit(value, kind[0], f"next({cls.__name__}.{name})")
            object.__setattr__(self, name, value)

    def __setattr__(self, name: str, value: object) -> None:
        raise ModelError(f"{type(self).__name__}.{name} cannot be assigned; return a new {type(self).__name__}({name}=...)")


def registers(cls: type[Model]) -> dict[str, tuple[Sort, PowerUpValue]]:
    """Sort and power-up value of each register of a model class, in order."""
    return _shape(cls)[0]


def parts(cls: type[Model]) -> dict[str, type[Model]]:
    """Model class of each part of a model class, in order."""
    return _shape(cls)[1]


@functools.cache
def _shape(cls: type[Model]) -> tuple[dict[str, tuple[Sort, PowerUpValue]], dict[str, type[Model]]]:
    found: dict[str, tuple[Sort, PowerUpValue]] = {}
    inner: dict[str, type[Model]] = {}
    for name, annotation in _hints(cls, cls).items():
        if name.startswith("_") or typing.get_origin(annotation) is typing.ClassVar:
            continue
        declared = cls.__dict__.get(name, getattr(cls, name, None))
        if isinstance(annotation, type) and issubclass(annotation, Model):
            inner[name] = annotation
        elif isinstance(declared, PowerUp):
            sort = sort_of(annotation, f"{cls.__name__}.{name}")
            if not isinstance(declared.value, type(ANY)) and not sort.admits(declared.value):
                raise ModelError(f"{cls.__name__}.{name}: power_up({declared.value!r}) is not a value of {sort}")
            found[name] = sort, declared.value
        elif not isinstance(declared, Parameter):
            raise ModelError(f"{cls.__name__}.{name} has no power-up value; write `= power_up(0)` or `= power_up(ANY)`")
    return found, inner


def _hints(cls: type[Model], thing: Any) -> dict[str, Any]:
    try:
        return typing.get_type_hints(thing, localns={**cls._locals, cls.__name__: cls}, include_extras=True)
    except NameError as error:
        raise ModelError(f"{cls.__name__}: {error.name!r} in an annotation is not defined; import it") from None


def sort_of(annotation: Any, where: str) -> Sort:
    """The sort that an annotation stands for: Bit, Annotated[UInt, bits], Annotated[Int, (low, high)] or Real."""
    if annotation is Bit:
        return BIT
    if annotation is Real:
        return REAL
    base, *extra = (typing.get_args(annotation) if typing.get_origin(annotation) is typing.Annotated else (annotation,))
    if base is UInt and extra:
        return uint(extra[0])
    if base is Int and extra:
        return integer(*extra[0])
    raise ModelError(f"{where}: {annotation!r} is no signal type; write Bit, U8 (Annotated[UInt, 8]), Annotated[Int, (low, high)] or Real")


def _fit(value: Any, sort: Sort, where: str) -> Term:
    """A value for a place of a sort: literals become constants, narrower words gain zeros, nothing is cut."""
    if not isinstance(value, Term):
        if not sort.admits(value):
            raise ModelError(f"{where} is {sort}: {value!r} is not a value of it")
        return const(value, sort)
    if value.sort == sort:
        return value
    if value.sort.is_number and sort.is_number and REAL not in (value.sort, sort):
        (low, high), (least, greatest) = value.sort.bounds, sort.bounds
        if least <= low and high <= greatest:
            return cast(Term, value.widen(sort.width) if sort.kind == value.sort.kind == "uint" else _range_cast(value, sort))
        remedy = f"wrap it with .low({sort.width}) or saturate it with .sat({sort.width})" if sort.kind == "uint" else "clamp it with .clip(low, high)"
        raise ModelError(f"{where} is {sort}, given {value.sort} {describe(value)}; {remedy}")
    remedy = "write .word()" if value.sort == BIT else "write a comparison or .bit(i)" if sort == BIT else "write .real()"
    raise ModelError(f"{where} is {sort}, given {value.sort} {describe(value)}; {remedy}")


def _range_cast(value: Term, sort: Sort) -> Term:
    from safety.terms.values import build

    return build("cast", (value,), None, sort)


def _is_bundle(annotation: Any) -> bool:
    return isinstance(annotation, type) and issubclass(annotation, tuple) and hasattr(annotation, "_fields")


def _flatten(value: Any, prefix: str) -> Iterator[tuple[str, Term]]:
    """Full names and terms of an output: a term, or (nested) named tuples of terms."""
    if isinstance(value, Term):
        yield prefix, value
    elif hasattr(value, "_fields"):
        for name, item in zip(value._fields, value, strict=True):
            yield from _flatten(item, f"{prefix}.{name}" if prefix else name)
    elif isinstance(value, bool):
        yield prefix, bit(value)
    else:
        raise ModelError(f"output {prefix or '(the result)'} is {value!r}; outputs are terms or named tuples of terms")


def _recorded(step: Any) -> Any:
    """`step` as written, with its inputs fitted to their types and its outputs noted under the part's name."""

    @functools.wraps(step)
    def call(self: Model, *args: Any, **kwargs: Any) -> Any:
        cls, scope = type(self), _scope.get()
        hints = _hints(cls, step)
        bound = inspect.signature(step).bind(self, *args, **kwargs)
        for name, value in list(bound.arguments.items())[1:]:
            if not _is_bundle(hints[name]):
                bound.arguments[name] = _fit(value, sort_of(hints[name], f"{cls.__name__}.step({name})"), f"{cls.__name__}.step({name}=...)")
        prefix = self._path
        if scope is None:
            return step(*bound.args, **bound.kwargs)
        with scope.within(prefix):
            result = step(*bound.args, **bound.kwargs)
        following, outputs = result if type(result) is tuple and len(result) == 2 else (result, None)
        if not isinstance(following, cls):
            raise ModelError(f"{cls.__name__}.step returns {following!r}; it returns the next {cls.__name__}, or that and its outputs")
        if outputs is not None:
            for name, term in _flatten(outputs, ""):
                if name in registers(cls) or name in parts(cls):
                    raise ModelError(f"{cls.__name__}: output {name!r} has the name of a register or part; give it another")
                scope.signals[prefix + (name or "out")] = term
        return result

    return call


def _parameter_value(owner: Model, declared: Parameter) -> Term:
    scope = _scope.get()
    cls = type(owner)
    sort = sort_of(_hints(cls, cls)[declared.name], f"{cls.__name__}.{declared.name}")
    if scope is None:
        return const(declared.default, sort)
    path = scope.path + declared.name
    if path in scope.symbolic:
        if path not in scope.rigid:
            var = variable(path, sort)
            scope.rigid[path] = State(var, var, ANY)
            scope.start.append(cast(Bit, (var >= declared.low) & (var <= declared.high)))  # type: ignore[operator]
            scope.used[path] = Setting(path, None, declared.unit, declared.low, declared.high, declared.source)
        return scope.rigid[path].var
    value = scope.settings.get(path, declared.default)
    if not sort.admits(value) or not declared.low <= value <= declared.high:
        near = min(max(value, declared.low), declared.high) if isinstance(value, int | Fraction) else declared.default
        raise ModelError(
            f"{path} = {value} {declared.unit} lies outside {declared.low}..{declared.high} {declared.unit}; the nearest admissible value is {near}"
        )
    scope.used[path] = Setting(path, value, declared.unit, declared.low, declared.high, declared.source)
    return const(value, sort)


def _instance(cls: type[Model], path: str, value: Any) -> Model:
    """An instance whose registers are `value(path, sort, power_up)`, with parts, knowing its own path."""
    new = object.__new__(cls)
    object.__setattr__(new, "_path", path)
    for name, (sort, start) in registers(cls).items():
        object.__setattr__(new, name, value(path + name, sort, start))
    for name, part in parts(cls).items():
        object.__setattr__(new, name, _instance(part, f"{path}{name}.", value))
    return new


def _part_names(cls: type[Model], path: str = "") -> Iterator[tuple[str, str]]:
    for name, part in parts(cls).items():
        yield path + name, part.__name__
        yield from _part_names(part, f"{path}{name}.")


def _clock_of(cls: type[Model]) -> Clock:
    clocks = {c for c in (cls._clock, *(_clock_of(p) for p in parts(cls).values())) if c is not None}
    if len(clocks) > 1:
        raise ModelError(f"{cls.__name__} and its parts step {' and '.join(sorted(map(str, clocks)))}; one system has one clock")
    if not clocks:
        raise ModelError(f"{cls.__name__} has no clock; write class {cls.__name__}(Model, tick_s=...) or event=...")
    return clocks.pop()


def _inputs(cls: type[Model], make: Any) -> tuple[dict[str, Any], dict[str, Term]]:
    """Arguments for `step`, and the same flat by name."""
    step = cls.__dict__.get("step") or getattr(cls, "step", None)
    if step is None:
        raise ModelError(f"{cls.__name__} has no step")
    hints = _hints(cls, inspect.unwrap(step))
    flat: dict[str, Term] = {}

    def value(annotation: Any, name: str) -> Any:
        if _is_bundle(annotation):
            fields = _hints(cls, annotation)
            return annotation(*(value(fields[f], f"{name}.{f}") for f in annotation._fields))
        flat[name] = make(name, sort_of(annotation, f"{cls.__name__}.step({name})"))
        return flat[name]

    names = list(inspect.signature(step).parameters)[1:]
    for name in names:
        if name not in hints:
            raise ModelError(f"{cls.__name__}.step({name}) has no type; annotate it, e.g. {name}: Bit")
    return {name: value(hints[name], name) for name in names}, flat


def resolve(cls: type[Model], settings: Mapping[str, Any]) -> dict[str, Any]:
    """Settings by full name: a key is a full name, a pattern, or the bare name of parameters in several parts.

    Raises `ModelError` when a key fits nothing.
    """
    known = {path: None for path, _ in _parameters(cls)}
    full: dict[str, Any] = {}
    for key, value in settings.items():
        hits = [p for p in known if fnmatchcase(p, key) or p.rsplit(".", 1)[-1] == key]
        if not hits:
            raise ModelError(f"{cls.__name__} has no parameter {key!r}; {nearest(key, known)}")
        full |= dict.fromkeys(hits, value)
    return full


def _parameters(cls: type[Model], path: str = "") -> Iterator[tuple[str, Parameter]]:
    for klass in reversed(cls.__mro__):
        for name, value in klass.__dict__.items():
            if isinstance(value, Parameter):
                yield path + name, value
    for name, part in parts(cls).items():
        yield from _parameters(part, f"{path}{name}.")


def trace(cls: type[Model], settings: Mapping[str, Any] | None = None, symbolic: Iterable[str] = ()) -> System:
    """Run `step` once on variables and keep what it built.

    `settings` fixes parameters (see `resolve`), `symbolic` leaves the named ones open within their range.
    Raises `ModelError` for a model that is not well formed.
    """
    full = resolve(cls, settings or {})
    open_ = frozenset(resolve(cls, dict.fromkeys(symbolic)))
    scope = _Scope(cls.__name__, full, open_)
    states: list[tuple[Term, PowerUpValue]] = []

    def register(path: str, sort: Sort, start: PowerUpValue) -> Term:
        states.append((variable(path, sort), start))
        return states[-1][0]

    before = _instance(cls, "", register)
    arguments, inputs = _inputs(cls, variable)
    clash = inputs.keys() & {str(v.attr) for v, _ in states}
    if clash:
        raise ModelError(f"{cls.__name__}: input {sorted(clash)[0]!r} has the name of a register; give it another")
    token = _scope.set(scope)
    try:
        result = before.step(**arguments)  # type: ignore[attr-defined]
    finally:
        _scope.reset(token)
    after = result[0] if isinstance(result, tuple) else result
    nexts = dict(_register_terms(after, ""))
    return System(
        name=cls.__name__,
        clock=_clock_of(cls),
        states=(*(State(v, nexts[str(v.attr)], start) for v, start in states), *scope.rigid.values()),
        inputs=inputs,
        signals=scope.signals,
        points=scope.points,
        settings=scope.used,
        parts=dict(_part_names(cls)),
        assumptions=scope.assumptions,
        start=all_of(*scope.start),
    )


def _register_terms(model: Model, path: str) -> Iterator[tuple[str, Term]]:
    for name in registers(type(model)):
        yield path + name, getattr(model, name)
    for name in parts(type(model)):
        yield from _register_terms(getattr(model, name), f"{path}{name}.")


def direct_step(
    cls: type[Model], state: Mapping[str, Any], inputs: Mapping[str, Any], settings: Mapping[str, Any] | None = None
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The direct reading: call `step` itself on constant values; returns next registers, and outputs with points.

    Slow and obvious: nothing is traced, generated or compiled.
    """
    scope = _Scope(cls.__name__, resolve(cls, settings or {}), frozenset(), direct=True)
    before = _instance(cls, "", lambda path, sort, _: const(state[path], sort))
    arguments, _ = _inputs(cls, lambda name, sort: const(inputs[name], sort))
    token = _scope.set(scope)
    try:
        result = before.step(**arguments)  # type: ignore[attr-defined]
    finally:
        _scope.reset(token)
    after = result[0] if isinstance(result, tuple) else result
    return (
        {path: term.attr for path, term in _register_terms(after, "")},
        {path: term.attr for path, term in {**scope.points, **scope.signals}.items()},
    )

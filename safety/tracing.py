"""From a model to a system: `step` runs once on variables and what it builds is kept; or on values (direct reading)."""

from __future__ import annotations

import contextlib
import inspect
from collections.abc import Iterable, Iterator, Mapping
from fnmatch import fnmatchcase
from typing import Any

from safety.fields import Parameter, sort_of
from safety.model import Model, hints, is_bundle, parts, registers
from safety.scope import Scope, current
from safety.system import OUTPUT, Clock, ModelError, Pace, PowerUpValue, State, System, nearest
from safety.terms import Term
from safety.terms.graph import Sort, variable
from safety.terms.values import all_of, const


def _instance(cls: type[Model], path: str, value: Any) -> Model:
    """An instance whose registers are `value(path, sort, power_up)`, with parts, knowing its own path."""
    new = object.__new__(cls)
    object.__setattr__(new, "_path", path)
    object.__setattr__(new, "_old", True)
    for name, (sort, start) in registers(cls).items():
        object.__setattr__(new, name, value(path + name, sort, start))
    for name, part in parts(cls).items():
        object.__setattr__(new, name, _instance(part, f"{path}{name}.", value))
    return new


def _part_names(cls: type[Model], path: str = "") -> Iterator[tuple[str, str]]:
    for name, part in parts(cls).items():
        yield path + name, part.__name__
        yield from _part_names(part, f"{path}{name}.")


def _clock_of(cls: type[Model]) -> Clock | Pace:
    clocks = {c for c in (cls._clock, *(_clock_of(p) for p in parts(cls).values())) if c is not None}
    if len(clocks) > 1:
        rates = " and ".join(sorted(map(str, clocks)))
        raise ModelError(f"{cls.__name__} and its parts step {rates}; one system has one clock")
    if not clocks:
        raise ModelError(f"{cls.__name__} has no clock; write class {cls.__name__}(Model, tick_s=...) or event=...")
    return clocks.pop()


def _read(whole: Model, names: Iterable[str]) -> dict[str, dict[str, Any]]:
    """The values of parameters, by bare name and full name; None for one that is left open."""
    found: dict[str, dict[str, Any]] = {}
    for name in names:
        if isinstance(getattr(type(whole), name, None), Parameter):
            term = getattr(whole, name)
            found.setdefault(name, {})[f"{whole._path}{name}"] = term.attr if term.op == "const" else None
    for part in parts(type(whole)):
        for name, of in _read(getattr(whole, part), names).items():
            found.setdefault(name, {}).update(of)
    return found


def _inputs(cls: type[Model], make: Any) -> tuple[dict[str, Any], dict[str, Term]]:
    """Arguments for `step`, and the same flat by name."""
    step = cls.__dict__.get("step") or getattr(cls, "step", None)
    if step is None:
        raise ModelError(f"{cls.__name__} has no step")
    types = hints(cls, inspect.unwrap(step))
    flat: dict[str, Term] = {}

    def value(annotation: Any, name: str) -> Any:
        if is_bundle(annotation):
            fields = hints(cls, annotation)
            return annotation(*(value(fields[f], f"{name}.{f}") for f in annotation._fields))
        flat[name] = make(name, sort_of(annotation, f"{cls.__name__}.step({name})"))
        return flat[name]

    names = list(inspect.signature(step).parameters)[1:]
    for name in names:
        if name not in types:
            raise ModelError(f"{cls.__name__}.step({name}) has no type; annotate it, e.g. {name}: Bit")
    return {name: value(types[name], name) for name in names}, flat


def resolve(cls: type[Model], settings: Mapping[str, Any]) -> dict[str, Any]:
    """Settings by full name: a key is a full name, a pattern, or the bare name of parameters in several parts.

    Raises `ModelError` when a key fits nothing.
    """
    known = {path for path, _ in parameters(cls)}
    bare = {path.rpartition(".")[2] for path in known}
    full: dict[str, Any] = {}
    for key, value in settings.items():
        hits = [p for p in sorted(known) if fnmatchcase(p, key) or p.rsplit(".", 1)[-1] == key]
        if not hits:
            raise ModelError(f"{cls.__name__} has no parameter {key!r}; {nearest(key, known | bare)}")
        full |= dict.fromkeys(hits, value)
    return full


def fitting(cls: type[Model], settings: Mapping[str, Any]) -> dict[str, Any]:
    """Settings by full name; those that fit no parameter are left out."""
    found: dict[str, Any] = {}
    for key, value in settings.items():
        with contextlib.suppress(ModelError):
            found |= resolve(cls, {key: value})
    return found


def parameters(cls: type[Model], path: str = "") -> Iterator[tuple[str, Parameter]]:
    """Full name and declaration of each parameter of a model and its parts; of one declared anew the last counts."""
    for klass in reversed(cls.__mro__):
        for name, value in klass.__dict__.items():
            if isinstance(value, Parameter):
                yield path + name, value
    for name, part in parts(cls).items():
        yield from parameters(part, f"{path}{name}.")


def trace(cls: type[Model], settings: Mapping[str, Any] | None = None, symbolic: Iterable[str] = ()) -> System:
    """Run `step` once on variables and keep what it built.

    `settings` fixes parameters (see `resolve`), `symbolic` leaves the named ones open within their range.
    Raises `ModelError` for a model that is not well formed.
    """
    full = resolve(cls, settings or {})
    open_ = frozenset(resolve(cls, dict.fromkeys(symbolic)))
    scope = Scope(cls.__name__, full, open_)
    states: list[tuple[Term, PowerUpValue]] = []

    def register(path: str, sort: Sort, start: PowerUpValue) -> Term:
        states.append((variable(path, sort), start))
        return states[-1][0]

    before = _instance(cls, "", register)
    arguments, inputs = _inputs(cls, variable)
    clash = inputs.keys() & {str(v.attr) for v, _ in states}
    if clash:
        raise ModelError(f"{cls.__name__}: input {sorted(clash)[0]!r} has the name of a register; give it another")
    nexts = _stepped(cls, scope, before, arguments)
    clock = _clock(cls, scope, before)
    for path in _part_names(cls):
        if f"{path[0]}." not in scope.stepped:
            raise ModelError(
                f"{cls.__name__}: part {path[0]!r} is never stepped; call self.{path[0]}.step(...) or leave it out"
            )
    return System(
        name=cls.__name__,
        clock=clock,
        states=(*(State(v, nexts[str(v.attr)], start) for v, start in states), *scope.rigid.values()),
        inputs=inputs,
        signals={_apart(name, inputs): term for name, term in scope.signals.items()},
        points=scope.points,
        settings=scope.used,
        parts=dict(_part_names(cls)),
        assumptions=scope.assumptions,
        start=all_of(*scope.start),
    )


def _stepped(cls: type[Model], scope: Scope, before: Model, arguments: Mapping[str, Any]) -> dict[str, Term]:
    """Take the step within a scope; the next registers by full name."""
    token = current.set(scope)
    try:
        result = before.step(**arguments)  # type: ignore[attr-defined]
    finally:
        current.reset(token)
    return dict(_register_terms(result[0] if isinstance(result, tuple) else result, ""))


def _clock(cls: type[Model], scope: Scope, whole: Model) -> Clock:
    """The clock of a model, for the values that its parameters have."""
    declared = _clock_of(cls)
    if isinstance(declared, Clock):
        return declared
    token = current.set(scope)
    try:
        return declared.clock(cls.__name__, _read(whole, declared.names))
    finally:
        current.reset(token)


def _apart(name: str, inputs: Mapping[str, Term]) -> str:
    """The name of an output; one that an input has too is told from it."""
    return f"{name}{OUTPUT}" if name in inputs else name


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
    scope = Scope(cls.__name__, resolve(cls, settings or {}), frozenset(), direct=True)
    before = _instance(cls, "", lambda path, sort, _: const(state[path], sort))
    arguments, _ = _inputs(cls, lambda name, sort: const(inputs[name], sort))
    nexts = _stepped(cls, scope, before, arguments)
    seen = {**scope.points, **{_apart(name, inputs): term for name, term in scope.signals.items()}}
    return {path: term.attr for path, term in nexts.items()}, {path: term.attr for path, term in seen.items()}

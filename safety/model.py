"""Models: one plain `step` function over typed terms, with registers, parameters, named points and parts.

    class Divider(Model, tick_s="125e-6"):
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
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Any, cast, dataclass_transform

from safety.fields import Parameter, PowerUp, fit, parameter, power_up, sort_of
from safety.scope import assume, current, point
from safety.system import ANY, Clock, ModelError, PowerUpValue, Setting, State, nearest
from safety.terms import Bit, Term
from safety.terms.graph import Sort, variable
from safety.terms.values import bit, const

__all__ = ["ANY", "Model", "ModelError", "assume", "parameter", "parts", "point", "power_up", "registers"]


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
                value = fit(value, kind[0], f"next({cls.__name__}.{name})")
            object.__setattr__(self, name, value)

    def __setattr__(self, name: str, value: object) -> None:
        raise ModelError(f"{type(self).__name__}.{name} cannot be assigned; return a new {type(self).__name__}({name}=...)")

    def parameter_value(self, declared: Parameter) -> Term:
        """The value of one of this model's parameters: set, default, or a rigid register where it is left open."""
        scope = current.get()
        cls = type(self)
        sort = sort_of(hints(cls, cls)[declared.name], f"{cls.__name__}.{declared.name}")
        if scope is None:
            return const(declared.default, sort)
        path = scope.path + declared.name
        if path in scope.symbolic:
            if path not in scope.rigid:
                var = variable(path, sort)
                scope.rigid[path] = State(var, var, ANY)
                scope.start.append(cast(Bit, (var >= declared.low) & (var <= declared.high)))  # type: ignore[operator]
                scope.used[path] = Setting(path, None, declared.unit, declared.low, declared.high, declared.source, declared.default)
            return scope.rigid[path].var
        value = scope.settings.get(path, declared.default)
        if not sort.admits(value) or not declared.low <= value <= declared.high:
            near = min(max(value, declared.low), declared.high) if isinstance(value, int | Fraction) else declared.default
            raise ModelError(
                f"{path} = {value} {declared.unit} lies outside {declared.low}..{declared.high} {declared.unit}; the nearest admissible value is {near}"
            )
        scope.used[path] = Setting(path, value, declared.unit, declared.low, declared.high, declared.source, declared.default)
        return const(value, sort)


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
    for name, annotation in hints(cls, cls).items():
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


def hints(cls: type[Model], thing: Any) -> dict[str, Any]:
    try:
        return typing.get_type_hints(thing, localns={**cls._locals, cls.__name__: cls}, include_extras=True)
    except NameError as error:
        raise ModelError(f"{cls.__name__}: {error.name!r} in an annotation is not defined; import it") from None


def is_bundle(annotation: Any) -> bool:
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
        cls, scope = type(self), current.get()
        types = hints(cls, step)
        bound = inspect.signature(step).bind(self, *args, **kwargs)
        for name, value in list(bound.arguments.items())[1:]:
            if not is_bundle(types[name]):
                bound.arguments[name] = fit(value, sort_of(types[name], f"{cls.__name__}.step({name})"), f"{cls.__name__}.step({name}=...)")
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

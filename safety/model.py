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
from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from typing import Any, Self, cast, dataclass_transform

from safety.fields import Parameter, PowerUp, fit, parameter, power_up, sort_of
from safety.scope import assume, current, point, require
from safety.system import ANY, Clock, ModelError, Pace, PowerUpValue, Setting, State, nearest
from safety.terms import Bit, Int, Term, UInt
from safety.terms.graph import BIT, REAL, Sort, variable
from safety.terms.values import const

__all__ = ["ANY", "Model", "ModelError", "assume", "parameter", "parts", "point", "power_up", "registers", "require"]

Tick = float | str | Fraction | Callable[..., Fraction]


@dataclass_transform(kw_only_default=True, frozen_default=True, field_specifiers=(power_up, parameter))
class Model:
    """Base of all models; subclass with `tick_s=` (seconds a step) or `event=` (what a step happens at).

    `tick_s` may be a function of parameters, see `Pace`: `def tick(rate: int = 8000) -> Fraction`.
    """

    _clock: typing.ClassVar[Clock | Pace | None] = None
    _locals: typing.ClassVar[Mapping[str, Any]] = {}
    _path: typing.ClassVar[str | None] = (
        None  # full name with a dot at the end; known to the parts that a trace has made
    )
    _old = False  # whether it is the part before its step

    def __init_subclass__(cls, *, tick_s: Tick | None = None, event: str | None = None) -> None:
        if tick_s is not None and event is not None:
            raise ModelError(f"{cls.__name__}: a clock is a period or an event, not both")
        if tick_s is not None:
            cls._clock = Pace(tick_s) if callable(tick_s) else Clock(period=_seconds(cls, tick_s))
        elif event is not None:
            cls._clock = Clock(event=event)
        cls._locals = sys._getframe(1).f_locals
        if "step" in cls.__dict__:
            cls.step = _recorded(cls.__dict__["step"], cls)  # type: ignore[attr-defined]
        for name, value in list(cls.__dict__.items()):
            if isinstance(value, Parameter):
                setattr(cls, name, Parameter(value.default, value.unit, value.low, value.high, value.source, name))

    def __init__(self, **values: Any) -> None:
        cls = type(self)
        own, inner = registers(cls), parts(cls)
        missing, unknown = {*own, *inner} - values.keys(), values.keys() - {*own, *inner}
        if missing:
            names = ", ".join(sorted(missing))
            raise ModelError(f"{cls.__name__}(...) lacks {names}: every step returns every register and part")
        if unknown:
            name = sorted(unknown)[0]
            raise ModelError(f"{cls.__name__} has no register or part {name!r}; {nearest(name, {*own, *inner})}")
        for name, kind in inner.items():
            if not isinstance(values[name], kind):
                raise ModelError(f"{cls.__name__}({name}=...) is a {kind.__name__}, not {values[name]!r}")
            _in_its_place(cls, name, values[name])
            object.__setattr__(self, name, values[name])
        for name, (sort, _) in own.items():
            object.__setattr__(self, name, fit(values[name], sort, f"next({cls.__name__}.{name})"))

    def __setattr__(self, name: str, value: object) -> None:
        raise ModelError(
            f"{type(self).__name__}.{name} cannot be assigned; return a new {type(self).__name__}({name}=...)"
        )

    def replaced(self, **values: Any) -> Self:
        """The same with other values of some registers: for a part that its owner corrects after the part's step.

        Raises `ModelError` for a name that is no register.
        """
        cls, following = type(self), object.__new__(type(self))
        own = registers(cls)
        unknown = values.keys() - own.keys()
        if unknown:
            name = sorted(unknown)[0]
            raise ModelError(f"{cls.__name__} has no register {name!r}; {nearest(name, own)}")
        for name, value in vars(self).items():
            object.__setattr__(following, name, value)
        for name, value in values.items():
            object.__setattr__(following, name, fit(value, own[name][0], f"next({cls.__name__}.{name})"))
        return following

    def parameter_value(self, declared: Parameter) -> Term:
        """The value of one of this model's parameters: set, default, or a rigid register where it is left open."""
        scope = current.get()
        cls = type(self)
        sort = sort_of(hints(cls, cls)[declared.name], f"{cls.__name__}.{declared.name}")
        if scope is None:
            return const(declared.default, sort)
        path = self._place("read the parameter " + declared.name) + declared.name
        if path in scope.symbolic:
            if path not in scope.rigid:
                var = variable(path, sort)
                scope.rigid[path] = State(var, var, ANY)
                if sort != BIT:
                    scope.start.append(cast(Bit, (var >= declared.low) & (var <= declared.high)))
                scope.used[path] = _setting(path, None, declared)
            return scope.rigid[path].var
        value = scope.settings.get(path, declared.default)
        if isinstance(value, Fraction) and value.denominator == 1 and sort != REAL:
            value = int(value)  # 930.0 is a whole number
        if not sort.admits(value) or not declared.low <= value <= declared.high:
            raise ModelError(f"{path} = {value} {declared.unit} {_outside(declared, sort, value)}")
        scope.used[path] = _setting(path, value, declared)
        return const(value, sort)

    def _place(self, doing: str) -> str:
        """The path, with a dot at the end; `ModelError` for an instance that the step has made itself."""
        if self._path is None:
            name = type(self).__name__
            raise ModelError(
                f"cannot {doing} of a {name} made within a step; a part is a field: `{name.lower()}: {name}`"
            )
        return self._path


def _setting(path: str, value: Any, declared: Parameter) -> Setting:
    return Setting(path, value, declared.unit, declared.low, declared.high, declared.source, declared.default)


def _outside(declared: Parameter, sort: Sort, value: Any) -> str:
    """Why a parameter does not take a value, with the nearest one that it takes."""
    if sort == BIT:
        return f"is not a value of {sort}; write true or false ({declared.source})"
    within = f"{declared.low}..{declared.high} {declared.unit}"
    if isinstance(value, bool) or not isinstance(value, int | Fraction):
        return f"is not a value of {sort}; write an exact number in {within}, e.g. {declared.default}"
    if sort != REAL and value != round(value):
        return f"is no whole number; write one in {within}, e.g. {declared.default} ({declared.source})"
    near = min(max(value if sort == REAL else round(value), declared.low), declared.high)
    return f"lies outside {within}; the nearest admissible value is {near} ({declared.source})"


def _seconds(cls: type[Model], tick_s: float | str | Fraction) -> Fraction:
    try:
        period = Fraction(str(tick_s))
    except (ValueError, ZeroDivisionError):
        period = Fraction(0)
    if period <= 0:
        raise ModelError(f'{cls.__name__}: tick_s={tick_s!r} is not a time; write the seconds of a step, e.g. "125e-6"')
    return period


def _in_its_place(cls: type[Model], name: str, part: Model) -> None:
    """Refuse a part that belongs to another field, or that has been stepped and is returned as it was before."""
    scope = current.get()
    if scope is None or part._path is None:
        return
    if part._path != f"{scope.path}{name}.":
        raise ModelError(
            f"{cls.__name__}({name}=...) is given the part {part._path[:-1]!r}; return each part as itself"
        )
    if part._path in scope.stepped and part._old and (registers(type(part)) or parts(type(part))):
        raise ModelError(f"{cls.__name__}({name}=...) is given {name!r} as it was; return what {name}.step(...) gave")


def registers(cls: type[Model]) -> dict[str, tuple[Sort, PowerUpValue]]:
    """Sort and power-up value of each register of a model class, in order."""
    return _shape(cast(Any, cls))[0]


def parts(cls: type[Model]) -> dict[str, type[Model]]:
    """Model class of each part of a model class, in order."""
    return _shape(cast(Any, cls))[1]


@functools.cache
def _shape(cls: Any) -> tuple[dict[str, tuple[Sort, PowerUpValue]], dict[str, type[Model]]]:
    found: dict[str, tuple[Sort, PowerUpValue]] = {}
    inner: dict[str, type[Model]] = {}
    for name, annotation in hints(cls, cls).items():
        if name.startswith("_") or typing.get_origin(annotation) is typing.ClassVar:
            continue
        declared = cls.__dict__.get(name, getattr(cls, name, None))
        if name in vars(Model) or name == "step":
            raise ModelError(
                f"{cls.__name__}.{name}: every model has a {name!r} of its own; give the field another name"
            )
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
    """The annotations of a model, its step or a bundle, as objects; `ModelError` for a name that is not defined."""
    try:
        return typing.get_type_hints(thing, localns={**cls._locals, cls.__name__: cls}, include_extras=True)
    except NameError as error:
        raise ModelError(f"{cls.__name__}: {error.name!r} in an annotation is not defined; import it") from None


def is_bundle(annotation: Any) -> bool:
    """Whether an annotation is a named tuple of signals."""
    return isinstance(annotation, type) and issubclass(annotation, tuple) and hasattr(annotation, "_fields")


def _flatten(value: Any, prefix: str) -> Iterator[tuple[str, Term]]:
    """Full names and terms of an output: a term, or (nested) named tuples of terms."""
    if isinstance(value, Term):
        yield prefix, value
    else:
        for name, item in zip(value._fields, value, strict=True):
            yield from _flatten(item, f"{prefix}.{name}" if prefix else name)


def _fitted(cls: type[Model], annotation: Any, value: Any, where: str) -> Any:
    """A value as its annotation wants it: fields of a bundle one by one, a term brought to its sort."""
    if not is_bundle(annotation):
        return fit(value, sort_of(annotation, where), where)
    if not isinstance(value, annotation):
        raise ModelError(f"{where} is a {annotation.__name__}, not {value!r}")
    types = hints(cls, annotation)
    fields = zip(annotation._fields, value, strict=True)
    return annotation(*(_fitted(cls, types[name], item, f"{where}.{name}") for name, item in fields))


def _output(cls: type[Model], annotation: Any, value: Any, where: str) -> Any:
    """Outputs as the step's return type wants them; a kind without a width takes every width."""
    if annotation in (UInt, Int) and isinstance(value, annotation):
        return value
    if is_bundle(annotation) and isinstance(value, annotation):
        types = hints(cls, annotation)
        fields = zip(annotation._fields, value, strict=True)
        return annotation(*(_output(cls, types[name], item, f"{where}.{name}") for name, item in fields))
    return _fitted(cls, annotation, value, where)


def _outputs(cls: type[Model], returned: Any, outputs: Any) -> Any:
    wanted = typing.get_args(returned)
    if typing.get_origin(returned) is not tuple or len(wanted) != 2:
        raise ModelError(f"{cls.__name__}.step has outputs; annotate its result, e.g. -> tuple[{cls.__name__}, Bit]")
    return _output(cls, wanted[1], outputs, f"output of {cls.__name__}")


def _recorded(step: Any, owner: type[Model]) -> Any:
    """`step` as written, with inputs and outputs fitted to their types and its outputs noted under the part's name.

    Within a step of a subclass, `super().step(...)` may return the `owner` of that step.
    """

    @functools.wraps(step)
    def call(self: Model, *args: Any, **kwargs: Any) -> Any:
        cls, scope = type(self), current.get()
        types = hints(cls, step)
        bound = inspect.signature(step).bind(self, *args, **kwargs)
        for name, value in list(bound.arguments.items())[1:]:
            bound.arguments[name] = _fitted(cls, types[name], value, f"{cls.__name__}.step({name}=...)")
        if scope is None:
            return step(*bound.args, **bound.kwargs)
        prefix = self._place("take a step")
        within_own = prefix in scope.stepped and scope.path == prefix
        if prefix in scope.stepped and not within_own:
            raise ModelError(f"{prefix[:-1]!r} is stepped twice in one step; one step of the whole is one of each part")
        scope.stepped.add(prefix)
        with scope.within(prefix):
            result = step(*bound.args, **bound.kwargs)
        following, outputs = result if type(result) is tuple and len(result) == 2 else (result, None)
        if not isinstance(following, owner if within_own else cls):
            raise ModelError(
                f"{cls.__name__}.step returns {following!r}; write the next {cls.__name__}, or that and its outputs"
            )
        object.__setattr__(following, "_path", prefix)
        object.__setattr__(following, "_old", False)
        if outputs is None:
            return following
        outputs = _outputs(cls, types.get("return"), outputs)
        for name, term in _flatten(outputs, ""):
            head = name.partition(".")[0]
            if head in registers(cls) or head in parts(cls):
                raise ModelError(f"{cls.__name__}: output {head!r} has the name of a register or part; give it another")
            scope.signals[prefix + (name or "out")] = term
        return following, outputs

    return call

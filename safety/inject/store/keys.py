"""The key of a campaign: a digest of everything that its answers rest on.

The traced system, the space and the stimulus count by what they are.  Judges, and how scenarios are drawn, count by
their code with the values and functions that it uses; those of this package count as its own text, which is part of
every key.  What a campaign is called or expects does not count, nor which engine runs it: all give the same answers.
"""

from __future__ import annotations

import dataclasses
import functools
import json
import sys
import types
from collections import namedtuple
from collections.abc import Iterator, Mapping, Set
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from safety.canonical import PACKAGE, READINGS, NoKeyError, Text, digest, files, text_of
from safety.inject.monitors import observing
from safety.inject.store.shards import StoreError
from safety.system import System
from safety.tracing import trace

if TYPE_CHECKING:
    from safety.inject.campaign import Campaign

ENGINE = (*READINGS, "inject/*.py", "inject/native/**/*.py")  # what answers, below the package
TOLD = {  # of a campaign: shown, concluded from the answers, or a way to the same answers
    "id", "module", "confidence", "expect", "engine", "collapsing", "audit",
    "target_coverage",
}  # fmt: skip
BUILT = {  # of a campaign: they stand in its systems, space and stimulus
    "model", "settings", "observe", "watch", "hazard", "detectors", "safe", "faults", "order", "onsets", "length",
    "sample", "stimulus",
}  # fmt: skip


@functools.lru_cache(maxsize=16)
def campaign_key(campaign: Campaign) -> str:
    """The key of a campaign.  Raises `StoreError` when something cannot be written down."""
    text = _CampaignText()
    rest = [f.name for f in dataclasses.fields(campaign) if f.name not in TOLD | BUILT]
    try:
        told = [
            [text.of(system, "system") for system in _systems(campaign)],
            text.of(campaign.space, "space"),
            list(campaign.detectors),
            _stimulus(campaign, text),
            [[name, text.of(getattr(campaign, name))] for name in rest],
        ]
    except NoKeyError as error:
        raise StoreError(
            f"{campaign.id}: {error}; results can be kept only of functions whose values are plain data, functions "
            "and classes"
        ) from None
    return digest([engine(), json.dumps(text.nodes), json.dumps(told)])


def _stimulus(campaign: Campaign, text: Text) -> list[Any]:
    """The different rows of inputs, and which of them each frame has."""
    rows: dict[Any, int] = {}
    frames = (tuple(sorted(campaign.inputs(frame).items())) for frame in range(campaign.timing.frames))
    places = [rows.setdefault(row, len(rows)) for row in frames]
    return [[text.of(row) for row in rows], places]


def _systems(campaign: Campaign) -> Iterator[System]:
    """The model with what is looked at, before anything is drawn; where settings are, also that of each scenario."""
    model = campaign.model
    traced = model if isinstance(model, System) else trace(model, campaign.settings)
    yield observing(traced, campaign.looked_at, campaign.steps_per_frame)
    if campaign.vary.keys() & traced.settings.keys():
        yield from (campaign.variant(number).system for number in range(campaign.scenarios))


@functools.cache
def engine() -> str:
    """A digest of this package's own text, as far as answers come from it."""
    return text_of(PACKAGE, files(PACKAGE, ENGINE))


class _CampaignText(Text):
    """Text of values, of functions by their code, and of objects by what they consist of."""

    in_order = frozenset({"inputs"})
    shown: ClassVar[Mapping[str, Set[str]]] = {
        "system": {"settings", "parts", "points"},
        "space": {"groups", "of_group", "statement"},
    }

    def __init__(self) -> None:
        super().__init__()
        self.met: dict[int, int] = {}  # functions, classes and objects, by number: they may refer to each other
        self.held: list[Any] = []

    def of(self, value: Any, name: str = "") -> Any:
        """What stands for a value."""
        if type(value) in (bool, int, str):
            return super().of(value, name)
        match value:
            case float():
                return ["float", value.hex()]
            case bytes():
                return ["bytes", value.hex()]
            case range():
                return ["range", value.start, value.stop, value.step]
            case Enum():
                return ["enum", _home(type(value)), value.name]
            case set() | frozenset():
                return ["set", sorted((self.of(item) for item in value), key=json.dumps)]
            case types.BuiltinFunctionType() | types.WrapperDescriptorType() | types.MethodDescriptorType():
                return ["built-in", value.__qualname__]
            case types.ModuleType():
                return ["module", value.__name__]
            case types.MethodType():
                return ["method", self.of(value.__func__), self.of(value.__self__)]
            case functools.partial():
                return ["partial", self.of(value.func), self.of(value.args), self.of(value.keywords)]
            case types.FunctionType():
                return self._once(value, self._function)
            case type():
                return self._once(value, self._class) if _is_the_projects(value) else ["class", _home(value)]
        if hasattr(value, "dtype") and hasattr(value, "tobytes"):
            return ["array", str(value.dtype), list(value.shape), digest([value.tobytes()])]
        if _is_the_projects(type(value)):
            return self._once(value, lambda one: ["one", self.of(type(one)), self._content(one, name)])
        return self._content(value, name)

    def _content(self, value: Any, name: str) -> Any:
        try:
            return super().of(value, name)
        except NoKeyError:
            if not hasattr(value, "__dict__"):
                raise
            return self._once(vars(value), lambda own: ["object", _home(type(value)), self._given(value, own)])

    def _given(self, value: Any, own: Mapping[str, Any]) -> Any:
        """What an object was given, without what it has worked out and kept."""
        kind = type(value)
        kept = functools.cached_property
        return self.of({name: held for name, held in own.items() if not isinstance(getattr(kind, name, None), kept)})

    def _once(self, value: Any, write: Any) -> Any:
        if id(value) in self.met:
            return ["met", self.met[id(value)]]
        self.met[id(value)] = len(self.met)
        self.held.append(value)  # one that is gone could leave its place to another
        return write(value)

    def _function(self, function: types.FunctionType) -> Any:
        bound = [self.of(function.__defaults__), self.of(function.__kwdefaults__), self._closure(function)]
        if not _is_the_projects(function):
            return ["function", _home(function), bound]
        used = sorted(_names(function.__code__) & function.__globals__.keys())
        values = [[name, self._used(function.__globals__[name], function.__code__)] for name in used]
        return ["code", self._code(function.__code__), bound, values]

    def _closure(self, function: types.FunctionType) -> list[Any]:
        found = []
        for cell in function.__closure__ or ():
            try:
                found.append(self.of(cell.cell_contents))
            except ValueError:  # not filled yet
                found.append(["empty"])
        return found

    def _used(self, value: Any, code: types.CodeType) -> Any:
        """A global that code uses; of a module of the project, what is used of it."""
        if isinstance(value, types.ModuleType) and _is_the_projects(value):
            used = sorted(_names(code) & vars(value).keys())
            return ["module", value.__name__, [[name, self.of(getattr(value, name))] for name in used]]
        return self.of(value)

    def _code(self, code: types.CodeType) -> Any:
        constants = [self._code(c) if isinstance(c, types.CodeType) else self.of(c) for c in code.co_consts]
        shape = [code.co_argcount, code.co_kwonlyargcount, code.co_posonlyargcount, code.co_flags]
        return [code.co_code.hex(), constants, list(code.co_names), shape, code.co_exceptiontable.hex()]

    def _class(self, one: type) -> Any:
        """A class of the project by its bases and all that it defines."""
        own = {name: _bare(value) for name, value in vars(one).items() if not _is_machinery(name, value)}
        return ["class", one.__qualname__, [self.of(base) for base in one.__bases__], self.of(own)]


def _names(code: types.CodeType) -> set[str]:
    """Names that code, and the code within it, uses."""
    inner = (_names(constant) for constant in code.co_consts if isinstance(constant, types.CodeType))
    return set(code.co_names).union(*inner)


def _bare(value: Any) -> Any:
    """The functions behind a static or class method or a property."""
    if isinstance(value, staticmethod | classmethod):
        return value.__func__
    if isinstance(value, property):
        return [value.fget, value.fset]
    return value.func if isinstance(value, functools.cached_property) else value


_NAMED_FIELD = type(vars(namedtuple("_", "field"))["field"])  # of a named tuple, whose `_fields` say the same


def _is_machinery(name: str, value: Any) -> bool:
    return (name.startswith("__") and not isinstance(value, types.FunctionType)) or isinstance(
        value, types.GetSetDescriptorType | types.MemberDescriptorType | _NAMED_FIELD
    )


def _home(thing: Any) -> str:
    return f"{thing.__module__}.{thing.__qualname__}"


def _is_the_projects(thing: Any) -> bool:
    """Whether the project may change it: it is neither this package's, nor Python's, nor installed."""
    name = thing.__name__ if isinstance(thing, types.ModuleType) else thing.__module__ or ""
    top = name.partition(".")[0]
    file = getattr(sys.modules.get(name), "__file__", None)
    if top == "safety" or top in sys.stdlib_module_names - {"__main__"}:
        return False
    return file is None or not {"site-packages", "dist-packages"} & set(Path(file).parts)

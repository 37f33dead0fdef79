"""Immutable values with named fields, known to `dataclasses` and made without it.

`dataclasses` imports `inspect`, which takes as long as reading, solving and writing a small fault tree.  Its functions
(`replace`, `asdict`, `fields`) work on records all the same.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Self, dataclass_transform
else:

    def dataclass_transform(**_):
        """For the type checker alone."""
        return lambda made: made


class _Fields:
    """The fields as `dataclasses` knows them, made when it asks for them."""

    def __get__(self, record: object, owner: Any) -> dict[str, Any]:
        import dataclasses

        rows = [
            (
                name,
                kind,
                dataclasses.field(default=owner.defaults.get(name, dataclasses.MISSING)),
            )
            for name, kind in owner.kinds.items()
        ]
        made: Any = dataclasses.make_dataclass(owner.__name__, rows)
        found: dict[str, Any] = made.__dataclass_fields__
        owner.__dataclass_fields__ = found  # once for each class
        return found


@dataclass_transform(frozen_default=True)
class Record:
    """Base of a class whose annotations are its fields; one with a value has that as its default.

    Equal and hashed by class and fields. `__post_init__` may check them.
    """

    __dataclass_fields__ = _Fields()

    def __init_subclass__(cls) -> None:
        """Fields in the order written."""
        super().__init_subclass__()
        kind: Any = cls
        kind.kinds = dict(vars(cls).get("__annotations__", {}))
        kind.defaults = {name: vars(cls)[name] for name in kind.kinds if name in vars(cls)}
        kind.__match_args__ = tuple(kind.kinds)  # type: ignore[misc]

    def __init__(self, *values: Any, **named: Any) -> None:
        kind: Any = type(self)
        names, own = kind.__match_args__, self.__dict__
        own.update(kind.defaults)
        own.update(zip(names, values, strict=False))
        own.update(named)
        if len(values) > len(names) or len(own) != len(names) or (named and not self._are_new(values, named)):
            own.clear()
            raise TypeError(self._wrong(values, named))
        self.__post_init__()

    def _are_new(self, values: tuple[Any, ...], named: dict[str, Any]) -> bool:
        """Whether the names are fields that have no value yet."""
        kind: Any = type(self)
        return kind.kinds.keys() >= named.keys() and named.keys().isdisjoint(kind.__match_args__[: len(values)])

    def _wrong(self, values: tuple[Any, ...], named: dict[str, Any]) -> str:
        """What is wrong with the values that a record was to be made of."""
        kind: Any = type(self)
        names = kind.__match_args__
        if len(values) > len(names):
            return f"{kind.__name__} has {len(names)} fields, {len(values)} values were given"
        for name in names[: len(values)]:
            if name in named:
                return f"{kind.__name__}: {name} is given twice"
        for name in names[len(values) :]:
            if name not in named and name not in kind.defaults:
                return f"{kind.__name__}: {name} is missing"
        return f"{kind.__name__} has no field {next(name for name in named if name not in names)!r}"

    def __post_init__(self) -> None:
        """Nothing to check."""

    def changed(self, **changes: Any) -> Self:
        """The same with other values of some fields."""
        kind: Any = type(self)
        made: Self = kind(**{name: self.__dict__[name] for name in kind.__match_args__} | changes)
        return made

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__} cannot be changed; make another with dataclasses.replace")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{type(self).__name__} cannot be changed; make another with dataclasses.replace")

    def _values(self) -> tuple[Any, ...]:
        kind: Any = type(self)
        return tuple([self.__dict__[name] for name in kind.__match_args__])

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Record) or type(other) is not type(self):
            return NotImplemented
        return self._values() == other._values()

    def __hash__(self) -> int:
        return hash(self._values())

    def __repr__(self) -> str:
        kind: Any = type(self)
        fields = ", ".join(f"{name}={self.__dict__[name]!r}" for name in kind.__match_args__)
        return f"{kind.__qualname__}({fields})"

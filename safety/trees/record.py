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
        names, defaults, own = kind.__match_args__, kind.defaults, self.__dict__
        if len(values) > len(names):
            raise TypeError(f"{kind.__name__} has {len(names)} fields, {len(values)} values were given")
        for name, value in zip(names, values, strict=False):
            if name in named:
                raise TypeError(f"{kind.__name__}: {name} is given twice")
            own[name] = value
        for name in names[len(values) :]:
            if name in named:
                own[name] = named.pop(name)
            elif name in defaults:
                own[name] = defaults[name]
            else:
                raise TypeError(f"{kind.__name__}: {name} is missing")
        if named:
            raise TypeError(f"{kind.__name__} has no field {next(iter(named))!r}")
        self.__post_init__()

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

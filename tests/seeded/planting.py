"""Planting a bug: the model of a claim with another part at some of its places."""

from __future__ import annotations

from collections.abc import Mapping

from safety.model import Model, parts


def planted(owner: type[Model], places: Mapping[str, type[Model]]) -> type[Model]:
    """`owner` with the part at each place exchanged: `{"a.comparator": LatchesAtTwo}`; the place "" is all of it."""
    if "" in places:
        return places[""]
    inner: dict[str, dict[str, type[Model]]] = {}
    for place, variant in places.items():
        name, _, rest = place.partition(".")
        inner.setdefault(name, {})[rest] = variant
    exchanged = {name: planted(parts(owner)[name], inside) for name, inside in inner.items()}
    return type(f"Planted{owner.__name__}", (owner,), {"__annotations__": exchanged, "__module__": __name__})

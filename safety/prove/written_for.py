"""Claims whose formulas carry numbers that follow from parameters: they are not judged under other parameters.

    written_for("counter_*", but="counter_order.*", limit=8)

A limit or a count in a formula is often computed from a parameter's value.  Set the parameter otherwise, and the
formula says something that nobody claims; a verdict on it would mislead.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

from safety.model import Model
from safety.system import ModelError
from safety.tracing import fitting


class OtherNumbersError(ModelError):
    """A claim was asked for under parameters for which its numbers are not written."""

    exit_code = 3


@dataclass(frozen=True)
class _Numbers:
    claims: str
    but: str
    values: Mapping[str, Any]


_registry: dict[tuple[str, str], _Numbers] = {}


def written_for(claims: str, *, but: str = "", **values: Any) -> None:
    """Declare that claims, hazards and campaigns of such ids have numbers for these values of parameters.

    `claims` and `but`, those left out, are patterns; parameters go by bare name.  Under other values nothing is judged.
    """
    _registry[claims, but] = _Numbers(claims, but, values)


def check(name: str, models: Iterable[type[Model]], own: Mapping[str, Any], settings: Mapping[str, Any]) -> None:
    """Raise `OtherNumbersError` if settings change what the numbers of the claim `name` follow from.

    What the claim itself sets or leaves open, `own`, stays as it says.
    """
    values = {bare: value for each in _registry.values() if _meant(each, name) for bare, value in each.values.items()}
    for model in models if values else ():
        kept = fitting(model, own)
        for path, value in fitting(model, settings).items():
            bare = path.rpartition(".")[2]
            if bare in values and path not in kept and value != values[bare]:
                raise OtherNumbersError(
                    f"its numbers are written for {bare} = {values[bare]}; with {path} = {value} it is not judged"
                )


def _meant(numbers: _Numbers, name: str) -> bool:
    return fnmatchcase(name, numbers.claims) and not (numbers.but and fnmatchcase(name, numbers.but))

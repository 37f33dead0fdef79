"""Samples of the random variables in a fault tree, and of the probabilities of its events and of other quantities.

A random variable is a distribution, named by where it stands: by the parameter or the basic event whose definition it
is, else by the path within it ("pump/1": the first argument in the expression of event "pump"). Only a parameter is
shared between events; what it says is then the same for all of them in each sample.

Numbers are drawn from the raw stream of PCG64, one stream for each name and seed, so that they do not change with
what else is in the tree, nor with the version of numpy. Sources: M. D. McKay, R. J. Beckman, W. J. Conover,
Technometrics 21 (1979), Latin hypercube; R. L. Iman, W. J. Conover, Communications in Statistics B11 (1982), rank
correlation that keeps the strata.
"""

from __future__ import annotations

import functools
import hashlib
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from importlib import import_module
from typing import Any

import numpy as np

from safety.trees.as_written import TreeError
from safety.trees.expressions.arithmetics import COMPARISONS, Doubles
from safety.trees.expressions.distributions import Distribution, standard_normal
from safety.trees.expressions.expression import Expression, Parameter
from safety.trees.expressions.readings import NOTHING, Reading
from safety.trees.tree import BasicEvent, FaultTree
from safety.trees.uncertainty.correlation import Correlation, Vector


class Vectors(Doubles):
    """Double precision, all samples at once; nan where there is no value."""

    def call(self, name: str, x: Any) -> Any:
        """One of FUNCTIONS at x."""
        if isinstance(x, float):
            return super().call(name, x)
        if name == "decay":
            return np.where(x == 0, 1.0, -np.expm1(-x) / np.where(x == 0, 1.0, x))
        return getattr(np, {"asin": "arcsin", "acos": "arccos", "atan": "arctan"}.get(name, name))(x)

    def power(self, x: Any, y: Any) -> Any:
        """x to the y."""
        return super().power(x, y) if isinstance(x, float) and isinstance(y, float) else np.power(x, y)

    def remainder(self, x: Any, y: Any) -> Any:
        """What is left of x after whole multiples of y, with the sign of x."""
        return super().remainder(x, y) if isinstance(x, float) and isinstance(y, float) else np.fmod(x, y)

    def smallest(self, values: list[Any]) -> Any:
        """The least of `values`."""
        if all(isinstance(value, float) for value in values):
            return super().smallest(values)
        return functools.reduce(np.minimum, values)

    def largest(self, values: list[Any]) -> Any:
        """The greatest of `values`."""
        if all(isinstance(value, float) for value in values):
            return super().largest(values)
        return functools.reduce(np.maximum, values)

    def compare(self, name: str, x: Any, y: Any) -> Any:
        """One of COMPARISONS, as 1 or 0."""
        return COMPARISONS[name](x, y) * 1.0

    def choose(self, condition: Any, then: Any, other: Any) -> Any:
        """`then()` where the condition is not 0, else `other()`."""
        if isinstance(condition, float):
            return super().choose(condition, then, other)
        return np.where(condition != 0, then(), other())


@dataclass(frozen=True)
class Plan:
    """How many samples to draw and how.

    `hypercube` draws `blocks` independent Latin hypercubes of equal size instead of independent samples. Raises
    TreeError: numbers out of range, samples that cannot be shared out evenly.
    """

    samples: int = 10_000
    seed: int = 1
    hypercube: bool = False
    blocks: int = 10
    correlation: Correlation | None = None

    def __post_init__(self) -> None:
        if self.samples < 2 or self.seed < 0:
            raise TreeError(
                f"{self.samples} samples with seed {self.seed}, expected 2 or more with a seed of 0 or more; correct it"
            )
        if self.hypercube and (self.blocks < 2 or self.samples % self.blocks or self.samples < 2 * self.blocks):
            raise TreeError(
                f"{self.samples} samples cannot be shared out among {self.blocks} Latin hypercubes (2 or more of them, "
                "of 2 or more samples each); take a multiple"
            )

    def uniforms(self, names: Sequence[str]) -> dict[str, Vector]:
        """For each random variable its samples of the uniform distribution on 0..1, ends excluded."""
        draw = self._hypercube if self.hypercube else self._independent
        columns = {name: draw(name) for name in names}
        if self.correlation is not None:
            for name in self.correlation.names:
                if name not in columns:
                    raise TreeError(
                        f'a correlation names "{name}", which is no random variable of the tree; its variables are '
                        f"{', '.join(names) or 'none'}",
                        name,
                    )
            self._correlate(columns, self.correlation)
        return columns

    def _raw(self, name: str, purpose: str = "") -> np.ndarray[Any, np.dtype[np.uint64]]:
        """64 random bits for each sample, from a stream of its own for each name and purpose."""
        digest = hashlib.sha256(f"{self.seed}\0{purpose}\0{name}".encode()).digest()
        return np.asarray(np.random.PCG64(int.from_bytes(digest, "big")).random_raw(self.samples), dtype=np.uint64)

    def _independent(self, name: str, purpose: str = "") -> Vector:
        return np.asarray(((self._raw(name, purpose) >> np.uint64(12)) + 0.5) * 2.0**-52)

    def _hypercube(self, name: str) -> Vector:
        each = self.samples // self.blocks
        places = np.argsort(self._raw(name, "place").reshape(self.blocks, each), axis=1, kind="stable").ravel()
        within = ((self._raw(name) >> np.uint64(32)) + 0.5) * 2.0**-32
        return np.asarray(np.minimum((places + within) / each, math.nextafter(1.0, 0.0)))

    def _correlate(self, columns: dict[str, Vector], correlation: Correlation) -> None:
        names = correlation.names
        purpose = "score" if self.hypercube else ""  # the hypercube has used the other stream
        independent = np.array([standard_normal(self._independent(name, purpose)) for name in names])
        scores = correlation.root() @ independent
        for name, score in zip(names, scores, strict=True):
            if not self.hypercube:
                columns[name] = np.clip(import_module("scipy.special").ndtr(score), 2.0**-53, 1 - 2.0**-53)
                continue
            blocks = columns[name].reshape(self.blocks, -1)
            ranks = np.argsort(np.argsort(score.reshape(blocks.shape), axis=1), axis=1)
            columns[name] = np.take_along_axis(np.sort(blocks, axis=1), ranks, axis=1).ravel()


class Draws(Reading):
    """Expressions with each random variable at its samples."""

    def __init__(self, mission_time_h: Fraction | None, uniforms: Mapping[str, Vector] = NOTHING) -> None:
        super().__init__(Vectors(), mission_time_h)
        self.uniforms = uniforms

    def random(self, distribution: Any, values: list[Any], path: str) -> Any:
        """The samples of the variable at `path`."""
        return distribution.quantile(self.uniforms[path], *values)

    def check(self, expression: Expression, values: list[Any]) -> None:
        """Raise TreeError if an argument is out of its domain in any sample."""
        expression.check(values)

    def each(self, expression: Expression, values: list[Any]) -> Any:
        """The formula sample by sample."""
        size = max((value.size for value in values if not isinstance(value, float)), default=0)
        if not size:
            return expression.formula(Doubles(), *values)
        rows = zip(*(np.broadcast_to(value, size).tolist() for value in values), strict=True)
        return np.array([expression.formula(Doubles(), *row) for row in rows])


@dataclass(frozen=True)
class Quantity:
    """What an expression gives besides the probabilities of events: a rate, a frequency, a split fraction; 0 or more.

    `what` says so in messages. `greatest` is its largest possible value.
    """

    name: str
    what: str
    expression: Expression
    mission_time_h: Fraction | None = None
    greatest: float = math.inf


@dataclass(frozen=True)
class Quantities:
    """Events and quantities that share parameters; `name` says in messages of what they are."""

    name: str
    events: tuple[BasicEvent | Quantity, ...]


Holder = FaultTree | Quantities


def said(holder: Holder) -> str:
    """What it is called in messages."""
    return f'fault tree "{holder.name}"' if isinstance(holder, FaultTree) else holder.name


def owners(holder: Holder) -> dict[str, str]:
    """For each event with an expression the name that begins the names of its own random variables."""
    shared = parameters(holder)
    return {
        e.name: f"{e.name} (event)" if e.name in shared else e.name for e in holder.events if e.expression is not None
    }


def parameters(holder: Holder) -> dict[str, Parameter]:
    """The parameters on which the events of `holder` depend. Raises TreeError if one name has two definitions."""
    found: dict[str, Parameter] = {}
    for event in holder.events:
        for name, parameter in (event.expression.parameters if event.expression is not None else {}).items():
            if found.setdefault(name, parameter) != parameter:
                raise TreeError(
                    f'parameter "{name}" has two definitions in {said(holder)}, {found[name].definition} and '
                    f"{parameter.definition}; rename one of them",
                    name,
                )
    return found


def variables(holder: Holder) -> dict[str, Distribution]:
    """The random variables of `holder` by name."""
    return {name: law for each in variables_by_event(holder).values() for name, law in each.items()}


def variables_by_event(holder: Holder) -> dict[str, dict[str, Distribution]]:
    """For each event with an expression the random variables that it depends on, by name."""
    names = owners(holder)
    found: dict[str, dict[str, Distribution]] = {}
    for event in holder.events:
        if event.expression is not None:
            found[event.name] = dict(_within(event.expression, names[event.name]))
            for parameter in event.expression.parameters.values():
                found[event.name].update(_within(parameter.definition, parameter.name))
    return found


def _within(expression: Expression, path: str) -> Iterator[tuple[str, Distribution]]:
    """Distributions with their paths, those behind parameters left out."""
    if isinstance(expression, Distribution):
        yield path, expression
    if not isinstance(expression, Parameter):
        for n, argument in enumerate(expression.arguments, 1):
            yield from _within(argument, f"{path}/{n}")


@dataclass(frozen=True)
class Columns:
    """Samples of the probabilities of events and of quantities.

    values      shape (number of events, number of samples), rows as in the holder's `events`
    outside     for each event whose expression gave values out of its range, 0..1 for a probability: how often, each
                then set to the nearer end
    """

    values: Vector
    outside: Mapping[str, int]


def probabilities(holder: Holder, size: int, at: Callable[[Fraction | None], Draws]) -> Columns:
    """The probability of every event of `holder` in `size` samples, each in the reading that `at` gives for its time.

    Raises TreeError: an event has no probability, or its expression no value in some sample.
    """
    values, outside = np.empty((len(holder.events), size)), {}
    readings: dict[Fraction | None, Draws] = {}
    names = owners(holder)
    for i, event in enumerate(holder.events):
        what = f'basic event "{event.name}"' if isinstance(event, BasicEvent) else event.what
        greatest = 1.0 if isinstance(event, BasicEvent) else event.greatest
        if event.expression is None:
            if event.chance is None:
                raise TreeError(f"{what} has no probability; give it one", event.name)
            values[i] = event.chance[0]
            continue
        if event.mission_time_h not in readings:
            readings[event.mission_time_h] = at(event.mission_time_h)
        reading = readings[event.mission_time_h]
        try:
            with np.errstate(all="ignore"):
                values[i] = reading.of(event.expression, names[event.name])
        except TreeError as error:
            raise TreeError(f"{what}: {error.message}", event.name, error.place) from None
        if lost := int(np.isnan(values[i]).sum()):
            raise TreeError(
                f"the expression of {what} has no value in {lost} of {size} samples; correct its distributions",
                event.name,
            )
        count = int(((values[i] < 0) | (values[i] > greatest)).sum())
        if count:
            outside[event.name] = count
            np.clip(values[i], 0.0, greatest, out=values[i])
    return Columns(values, outside)

"""Every model of the position runs the same on the direct and on the Python reading."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import pytest

from models.position import correction, decoder, journey, locator, odometer, passing, placing, ride, sighting, told
from safety.model import Model
from safety.terms.graph import Sort
from safety.trace import Stepper
from safety.tracing import direct_step, trace

MODULES = (odometer, correction, decoder, journey, locator, ride, passing, placing, sighting, told)
MODELS = sorted(
    {
        m
        for module in MODULES
        for m in vars(module).values()
        if isinstance(m, type) and issubclass(m, Model) and "step" in dir(m)
    },
    key=lambda m: m.__name__,
)


def some(chance: random.Random, sort: Sort) -> Any:
    if sort.kind == "bit":
        return chance.random() < 0.5
    if sort.kind == "real":
        return Fraction(chance.randint(-24, 24), chance.randint(1, 8))
    low, high = sort.bounds
    return chance.randint(low, high)


@pytest.mark.parametrize("model", MODELS, ids=lambda m: m.__name__)
def test_direct_and_python_agree_from_any_state(model: type[Model]) -> None:
    made, chance = trace(model), random.Random(1991)
    stepper = Stepper.of(made)
    for _ in range(5):
        state = {s.path: some(chance, s.var.sort) for s in made.states}
        inputs = {name: some(chance, term.sort) for name, term in made.inputs.items()}
        after = stepper.function(*state.values(), *inputs.values())
        following, seen = direct_step(model, state, inputs)
        assert dict(zip(state, after, strict=False)) == following
        watched = dict(zip(stepper.observed, after[len(state) :], strict=False))
        assert {path: seen[path] for path in watched if path in seen} == watched

"""Every TS-7 model runs the same on the direct and on the Python reading, and refuses misuse."""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import pytest

from models.ts7 import channel, parts, power, ring, signals, system, threshold, train, voting
from safety.faults import instrument
from safety.model import Model
from safety.system import ModelError
from safety.terms.graph import Sort
from safety.trace import Stepper, run
from safety.tracing import direct_step, trace

MODULES = (ring, parts, channel, signals, train, power, voting, threshold, system)
MODELS = sorted(
    {
        m
        for module in MODULES
        for m in vars(module).values()
        if isinstance(m, type) and issubclass(m, Model) and hasattr(m, "step")
    },
    key=lambda m: m.__name__,
)


def some(rng: random.Random, sort: Sort) -> Any:
    if sort.kind == "bit":
        return rng.random() < 0.5
    if sort.kind == "real":
        return Fraction(rng.randint(-24, 24), rng.randint(1, 8))
    low, high = sort.bounds
    return rng.choice((low, high, rng.randint(low, high), rng.randint(low, high)))


def direct_and_python_agree(model: type[Model]) -> None:
    """Step a model from states and inputs of all kinds on both readings."""
    made = trace(model)
    stepper = Stepper.of(made)
    rng = random.Random(1972)
    for _ in range(20):
        state = {s.path: some(rng, s.var.sort) for s in made.states}
        inputs = {name: some(rng, term.sort) for name, term in made.inputs.items()}
        after = stepper.function(*state.values(), *inputs.values())
        following, seen = direct_step(model, state, inputs)
        assert dict(zip(state, after, strict=False)) == following
        watched = dict(zip(stepper.observed, after[len(state) :], strict=False))
        assert {path: seen[path] for path in watched if path in seen} == watched


@pytest.mark.parametrize("model", MODELS, ids=lambda m: m.__name__)
def test_direct_and_python_agree_from_any_state(model: type[Model]) -> None:
    direct_and_python_agree(model)


def test_there_are_all_models() -> None:
    assert len(MODELS) == 30
    assert all(m.__doc__ and str(trace(m).clock) in TICKS for m in MODELS)


TICKS = {"every 125 us", "every 3.90625 us", "at each window of constant speed"}


def sources(model: type[Model]) -> Iterator[str]:
    yield from (setting.source for setting in trace(model).settings.values())


def test_every_parameter_has_unit_range_and_source() -> None:
    settings = trace(system.Ts7).settings
    assert len(settings) == 47
    assert all(s.unit and s.low <= s.value <= s.high and len(s.source) > 8 for s in settings.values())


@pytest.mark.parametrize(
    ("misuse", "says"),
    [
        (lambda: trace(system.Ts7, {"wheel": 180}), "nearest admissible value is 172"),
        (lambda: trace(system.Ts7, {"a.offset": 5}), "lies outside -4..4 word"),
        (lambda: trace(system.Ts7, {"a.ofset": 1}), "did you mean a.offset"),
        (lambda: trace(system.Ts7, {"frames": 2000}), "lies outside 2400..8000 frame"),
        (lambda: run(signals.Selection, {"lines.s25": True}, steps=1), "lacks the input lines.s0"),
        (lambda: run(train.Axle, {"speed": 65536 * 164, "backward": False, "wheel": 164}, steps=1), "f_s below 8 kHz"),
        (lambda: run(train.Axle, {"speed": 0, "backward": False, "wheel": 100}, steps=1), "wheel from 152 to 176"),
        (lambda: run(train.Bench, {}, steps=1, start={"a.comparator.u": 0}), "only registers declared ANY can be set"),
        (
            lambda: run(ring.Words, {"d0": 256, "d1": 0, "d2": 0, "d3": 0, "pulse": True}, steps=1),
            "256 is not a value of it",
        ),
    ],
)
def test_misuse_is_told(misuse: Any, says: str) -> None:
    with pytest.raises(ModelError, match=says.replace(".", r"\.")):
        misuse()


def test_every_named_failure_has_a_place_in_the_equipment() -> None:
    from models.ts7.failures import component_faults, component_modes

    made, faults, modes = trace(system.Ts7), component_faults(), component_modes()
    assert len(faults) == len({f.name for f in faults}) == 39
    everything = [f for some_modes in modes.values() for f in some_modes]
    assert (len(modes), len(everything), len({f.name for f in everything})) == (54, 392, 392)
    for fault in faults + everything:
        assert instrument(made, [fault]).system.states

"""Verilator on the exported Verilog, and vectors in C, see in every run what the engines see, to the last bit."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from safety.inject.engine import AUTO, Engine, Task, Timing, engine_for
from safety.model import ANY, Model, point, power_up
from safety.terms import U4, Bit
from safety.tracing import trace
from tests.bench.injection_c import NARROW, VectorC
from tests.bench.injection_python import Python
from tests.bench.injection_task import at_random, bits, one_second, same, short
from tests.bench.injection_verilator import Verilator

RUNS, MOST = 1000, 3
needs_verilator = pytest.mark.skipif(shutil.which("verilator") is None, reason="Verilator is not installed")
COMPILERS = ["clang++", pytest.param("g++", marks=pytest.mark.slow)]


@pytest.fixture(scope="module")
def task() -> Task:
    return short(1600)


@pytest.fixture(scope="module")
def ours(task: Task) -> Engine:
    return engine_for(task, AUTO)[0]


@pytest.mark.slow
@needs_verilator
def test_a_thousand_random_faults_in_verilator(task: Task, ours: Engine, tmp_path: Path) -> None:
    verilator, batch = Verilator(task, tmp_path), at_random(task, RUNS, seed=1, most=MOST)
    seen = ours.run(batch)
    assert same(verilator.golden, ours.golden)
    assert same(verilator.run(batch), seen)
    assert not same(verilator.run(replace(batch, first=batch.first + 1)), seen)  # a frame late is seen


@pytest.mark.parametrize(("wires", "lanes"), [("bytes", 32), pytest.param("slices", 256, marks=pytest.mark.slow)])
@pytest.mark.parametrize("compiler", COMPILERS)
def test_a_thousand_random_faults_in_vectors_of_c(
    task: Task, ours: Engine, tmp_path: Path, compiler: str, wires: str, lanes: int
) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    batch = at_random(task, RUNS, seed=2, most=MOST)
    seen = ours.run(batch)
    vectors = VectorC(task, tmp_path, compiler, NARROW, wires, lanes, rows=MOST)
    assert same(vectors.golden, ours.golden)
    assert same(vectors.run(batch), seen)
    assert not same(vectors.run(replace(batch, end=np.minimum(batch.end, 900))), seen)


def test_a_few_of_them_in_python(task: Task, ours: Engine) -> None:
    batch = at_random(task, 5, seed=3, most=MOST)
    assert same(Python(task).run(batch), ours.run(batch))


class Pair(NamedTuple):
    equal: Bit
    high: Bit


class Exchange(Model, event="tick"):
    """Registers that take over each other's values, and one that is an output itself."""

    x: U4 = power_up(ANY)
    y: U4 = power_up(9)
    was: Bit = power_up(True)

    def step(self, turn: Bit) -> tuple[Exchange, Pair]:
        x = point("x", self.x)
        following = Exchange(x=self.y, y=(x + turn.word()).low(4), was=point("turned", turn))
        return following, Pair(equal=self.was, high=x >= 8)


@pytest.fixture(scope="module")
def exchange() -> Iterator[Task]:
    system = trace(Exchange)
    wires = ("equal", "high")
    yield Task(
        system, tuple(bits(system)), wires, wires, Timing(3, 40, 8, 1), lambda frame: {"turn": frame % 5 < 2}, {"x": 3}
    )


@pytest.mark.slow
@needs_verilator
def test_registers_that_exchange_their_values_in_verilator(exchange: Task, tmp_path: Path) -> None:
    batch = at_random(exchange, 200, seed=4, most=2)
    expected = Python(exchange).run(batch)
    assert same(Verilator(exchange, tmp_path).run(batch), expected)
    assert same(engine_for(exchange)[0].run(batch), expected)


def test_the_second_of_the_benchmark_brakes_at_its_end() -> None:
    task = one_second()
    stops = engine_for(replace(task, timing=Timing(2500, 5500, 500, 1)))[0].golden.counts["observed braked"][:, 0]
    assert stops[0] == 0 and stops[-1] == 500
    assert all(a <= b for a, b in pairwise(stops.tolist()))

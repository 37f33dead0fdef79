"""How the components of the two-counter ATC fail: faults of `Equipment`, by component.

Each fault names the points or parts at which it acts; rates are given elsewhere.
Source: components and modes [P] where the paper names them, else [A]; sizes (one in so many, offsets) [A].
"""

from __future__ import annotations

from collections.abc import Iterator

from models.two_counter.selection import Lines
from models.two_counter.train import KMH
from safety import (
    TRANSIENT,
    Fault,
    common_cause,
    extra,
    flip,
    missing,
    offset,
    open_circuit,
    power_dip,
    reads,
    stuck,
    swapped,
    welded,
)

STAGES = range(11)
LARGEST_PRESET, SMALLEST_PRESET = 1035, 57
BOTH = (0, 1)
SIGNAL = {n: f"circuit.counter2.signal{n}" for n in (1, 2, 3)}


def stage(counter: int, k: int, value: int) -> Fault:
    """A stage of a counter that is stuck, after every count and after every reset."""
    points = [f"circuit.counter{counter}.{when}" for when in ("count", "cleared")]
    return Fault(stuck(value, bit=k), points, name=f"counter {counter}: stage {k} at {value}")


def at(value: int, what: str, name: str) -> Fault:
    """A point that is stuck."""
    return Fault(stuck(value), [what], name=name)


def component_modes() -> dict[str, list[Fault]]:
    """The failure modes by component."""
    return {component: list(faults) for component, faults in _modes()}


def component_faults() -> list[Fault]:
    """All of them."""
    return [fault for faults in component_modes().values() for fault in faults]


def _modes() -> Iterator[tuple[str, list[Fault]]]:
    yield (
        "speed generator",
        [
            at(0, "train.edge", "generator open or short"),
            Fault(missing(2, every=200), ["train.edge"], name="one generator pulse in 100 lost"),
            Fault(extra(every=200), ["train.edge"], name="noise edge every 200 periods"),
            Fault(offset(5 * KMH), ["train.f2"], name="generator 5 km/h high"),
            Fault(offset(-5 * KMH), ["train.f2"], name="generator 5 km/h low"),
        ],
    )
    yield (
        "oscillator",
        [
            at(0, "oscillator.f1", "oscillator stops"),
            Fault(missing(1, every=100), ["oscillator.f1"], name="oscillator 1 % slow"),
            Fault(extra(every=100), ["oscillator.harmonic"], name="oscillator 1 % fast"),
            at(1, "oscillator.harmonic", "oscillator on its second harmonic"),
        ],
    )
    yield (
        "counter 2",
        [
            *(stage(2, k, value) for k in STAGES for value in BOTH),
            Fault(missing(1, every=100), ["circuit.counter2.input"], name="counter 2 misses one count in 100"),
            at(0, "circuit.counter2.clear", "counter 2 is not reset"),
        ],
    )
    yield "gate circuit 2", list(_gate_circuit_2())
    yield (
        "counter 1",
        [
            *(stage(1, k, value) for k in STAGES for value in BOTH),
            at(0, "circuit.counter1.clear", "counter 1 is not reset"),
        ],
    )
    yield "gate circuit 1", [at(v, "circuit.counter1.gate1", f"gate circuit 1 at {v}") for v in BOTH]
    for gate in ("and1", "and2", "and3"):
        yield gate.upper(), [at(v, f"circuit.{gate}", f"{gate.upper()} at {v}") for v in BOTH]
    yield "signals", list(_signals())
    for memory in ("ff6", "ff2"):
        point, name = f"circuit.{memory}.on", memory.upper()
        flips = Fault(flip(), [point], onset=TRANSIENT, ticks=1, name=f"{name} flips")
        yield name, [*(at(v, point, f"{name} at {v}") for v in BOTH), flips]
    yield (
        "Ry-1",
        [
            Fault(open_circuit(), ["circuit.ry1.coil"], name="Ry-1 coil open"),
            Fault(welded(), ["circuit.ry1.contact"], name="Ry-1 contact welded"),
            Fault(open_circuit(), ["circuit.ry1.contact"], name="Ry-1 contact open"),
        ],
    )
    off = {"circuit.supply": stuck(0), "circuit": power_dip()}
    yield (
        "power supply",
        [common_cause("power off", off), common_cause("power dips", off, onset=TRANSIENT, ticks=100)],
    )


def _gate_circuit_2() -> Iterator[Fault]:
    """Its decoder, its output and the selection before it."""
    yield from (at(v, "circuit.counter2.gate", f"counting gate at {v}") for v in BOTH)
    for k in STAGES:
        yield from (Fault(stuck(v, bit=k), ["selection.preset"], name=f"preset bit {k} at {v}") for v in BOTH)
    for name in Lines._fields:
        yield at(0, f"selection.line.{name}", f"line {name} missing")
        yield at(1, f"selection.line.{name}", f"line {name} besides")
    yield Fault(stuck(0), ["selection.line.*"], name="no selection")
    yield Fault(reads(LARGEST_PRESET), ["selection.preset"], name="preset of 250 km/h")
    yield Fault(reads(SMALLEST_PRESET), ["selection.preset"], name="preset of 5 km/h")


def _signals() -> Iterator[Fault]:
    """Missing, always there, exchanged."""
    for n, point in SIGNAL.items():
        yield at(0, point, f"signal {n} missing")
        yield at(1, point, f"signal {n} always")
    for first, second in ((1, 2), (2, 3), (1, 3)):
        yield Fault(swapped(), [SIGNAL[first], SIGNAL[second]], name=f"signals {first} and {second} swapped")

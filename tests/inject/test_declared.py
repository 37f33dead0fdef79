"""Campaigns judged by wires: hazard, detectors and safe side by when they come, monitors with a memory, latencies."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

from safety.faults import ANY_TIME, Fault, flip, stuck
from safety.inject import Campaign, CampaignError, Group, flipped_bits, stuck_bits
from safety.inject.classes import CELLS
from safety.inject.counting import latencies
from safety.inject.judging import NO_LATENCY, UNDETECTED, Judged
from safety.model import Model, point, power_up
from safety.system import ModelError
from safety.terms import U3, U6, Bit, bit, select


class Signals(NamedTuple):
    heat: Bit
    alarm: Bit
    off: Bit


class Boiler(Model, event="tick"):
    """Too hot while the valve is open from tick 20 on; a sensor trips after 4 hot ticks, the level guard at once."""

    tick: U6 = power_up(0)
    hot: U3 = power_up(0)
    tripped: Bit = power_up(False)

    def step(self) -> tuple[Boiler, Signals]:
        valve = point("valve", self.tick >= 60)  # open only at the end, for the fault-free run to be quiet before
        heat = point("heat", valve & ~self.tripped)
        hot = select(point("sensor", heat), select(self.hot < 7, (self.hot + 1).low(3), self.hot), 0)
        alarm = point("alarm", (self.hot >= 4) & point("enabled", bit(True)))
        return (
            Boiler(
                tick=select(self.tick < 63, (self.tick + 1).low(6), self.tick), hot=hot, tripped=self.tripped | alarm
            ),
            Signals(heat=heat, alarm=alarm, off=self.tripped),
        )


def boiler(**changes: Any) -> Campaign:
    declared: dict[str, Any] = {
        "id": "boiler", "model": Boiler, "engine": "lanes", "run_in": 5, "measured": 50,
        "faults": [Group("wires", stuck_bits("*"))], "onsets": range(5, 50, 10),
        "hazard": lambda wires: wires.lasting(wires["heat"], 8),
        "detectors": {"sensor": "alarm"},
        "safe": "off",
    }  # fmt: skip
    return Campaign(**(declared | changes))


def cells(campaign: Campaign) -> dict[str, str]:
    return {injection.id: cell for injection, cell in campaign.inject().injections()}


def test_each_fault_comes_to_what_can_be_told_by_hand() -> None:
    found = cells(boiler(onsets=None))
    assert found == {
        "valve stuck-at-0": "neutral/no",
        "valve stuck-at-1": "safe/yes",  # the sensor trips at the fifth tick
        "heat stuck-at-0": "neutral/no",
        "heat stuck-at-1": "wrong/yes",  # the trip has no hold of it
        "sensor stuck-at-0": "neutral/no",
        "sensor stuck-at-1": "safe/yes",
        "enabled stuck-at-0": "neutral/no",
        "enabled stuck-at-1": "neutral/no",
        "alarm stuck-at-0": "neutral/no",
        "alarm stuck-at-1": "safe/yes",
    }


def test_pairs_defeat_what_singles_do_not() -> None:
    found = cells(boiler(onsets=None, order=2))
    assert [name for name, cell in found.items() if cell == "wrong/no"] == [
        "valve stuck-at-1 & sensor stuck-at-0",
        "valve stuck-at-1 & enabled stuck-at-0",
        "valve stuck-at-1 & alarm stuck-at-0",
        "heat stuck-at-1 & sensor stuck-at-0",
        "heat stuck-at-1 & enabled stuck-at-0",
        "heat stuck-at-1 & alarm stuck-at-0",
    ]


def test_a_detection_later_than_the_hazard_is_none() -> None:
    fast = {"hazard": lambda wires: wires.lasting(wires["heat"], 3)}
    both = {"onsets": None, "faults": [Fault(stuck(1), ["heat"], ANY_TIME, at=10)]}
    assert list(cells(boiler(**both)).values()) == ["wrong/yes"]
    assert list(cells(boiler(**both, **fast)).values()) == ["wrong/no"]


@pytest.mark.parametrize("frames", [4, 5, 6])
def test_detection_in_the_frame_of_the_hazard_is_in_time(frames: int) -> None:
    """The alarm comes in the fifth frame of heat."""
    one = boiler(
        onsets=None,
        faults=[Fault(stuck(1), ["heat"], ANY_TIME, at=10)],
        hazard=lambda wires: wires.lasting(wires["heat"], frames),
    )
    assert list(cells(one).values()) == ["wrong/yes" if frames >= 5 else "wrong/no"]


def test_latency_counts_frames_from_the_onset() -> None:
    declared = boiler(faults=[Fault(stuck(1), ["valve"])])
    found = declared.inject()
    assert found.judged.latency.tolist() == [4] * 5 and found.judged.detector.tolist() == [0] * 5
    entry = found.to_json()["detected_by"]
    assert entry == {
        "sensor": {
            "count": 5,
            "latency": {"min": 4, "max": 4, "mean": 4.0, "unit": "frames", "histogram": [[5, 5]]},
        }
    }
    replayed = declared.replay(2)
    assert (replayed.cell, replayed.detected_by, replayed.latency) == ("safe/yes", "sensor", 4)


def test_the_detector_that_comes_first_is_the_one_that_counts() -> None:
    late = lambda wires: wires.lasting(wires["heat"], 7)  # noqa: E731
    detectors = {"late": late, "sensor": "alarm", "again": "alarm"}
    found = boiler(faults=[Fault(stuck(1), ["heat"])], detectors=detectors).inject()
    assert set(found.judged.detector.tolist()) == {1}
    assert [d["count"] for d in found.detected_by.values()] == [0, 5, 0]
    assert found.detected_by["late"]["latency"] is None


def test_without_detectors_nothing_is_detected() -> None:
    found = boiler(detectors={}).inject()
    assert found.tally.classes["detected"] == 0 and found.detected_by == {}


def test_every_injection_replays_to_its_cell_detector_and_latency() -> None:
    declared = boiler(order=2, onsets=range(3, 50, 13), length=9)
    found = declared.inject()
    for number in range(0, len(declared.space), 3):
        again = declared.replay(number)
        by = None if found.judged.detector[number] == UNDETECTED else "sensor"
        latency = None if found.judged.latency[number] == NO_LATENCY else found.judged.latency[number]
        assert (again.cell, again.detected_by, again.latency) == (found.cell(number), by, latency)


# --- monitors ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("frames", [1, 2, 3, 7, 8])
def test_lasting_is_true_from_the_frame_on_that_completes_the_time(frames: int) -> None:
    declared = boiler(watch={"long": lambda wires: wires.lasting(wires["heat"], frames)})
    trace = declared.replay("heat stuck-at-1 from step 15", keep=["heat"]).trace
    naive = [all(trace["heat"][max(0, k - frames + 1) : k + 1]) and k + 1 >= frames for k in range(len(trace))]
    assert trace["observed long"] == naive and any(naive) and not all(naive)


def test_lasting_over_frames_of_several_steps_is_true_at_all_of_them() -> None:
    declared = boiler(
        measured=10, run_in=0, onsets=range(0, 40, 8), steps_per_frame=4, hazard="heat",
        watch={"long": lambda wires: wires.lasting(wires["heat"], 2)},
    )  # fmt: skip
    trace = declared.replay("heat stuck-at-1 from step 8", keep=["heat"]).trace
    assert trace["observed long"].index(True) == 8 + 2 * 4 - 1


def test_once_stays() -> None:
    declared = boiler(watch={"ever": lambda wires: wires.once(wires["heat"])}, length=2)
    trace = declared.replay("heat stuck-at-1, transient at 15 for 2").trace
    assert trace["observed ever"] == [k >= 15 for k in range(len(trace))]


def test_the_same_monitor_twice_is_one_register() -> None:
    twice = boiler(watch={"a": lambda w: w.lasting(w["heat"], 8), "b": lambda w: w.lasting(w["heat"], 8)})
    assert sum(s.path.startswith("monitor") for s in twice.system.states) == 1


# --- refusals ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"wrong_side": lambda counts: False}, "hazard and wrong_side are two forms of judging; choose one"),
        ({"hazard": None, "detectors": {}, "safe": None}, "say when a run is dangerous"),
        ({"hazard": None}, "say when a run is dangerous"),
        ({"hazard": "heta"}, "no signal 'heta'; did you mean heat"),
        ({"hazard": "tick"}, "'hazard' observes a u6; write a comparison"),
        ({"hazard": lambda wires: True}, "'hazard' observes a True"),
        ({"hazard": lambda wires: wires.lasting(wires["heat"], 0)}, r"lasting\(..., 0\): a number of frames is"),
        ({"hazard": lambda wires: ~wires["heat"]}, "fault-free run is judged wrong/no"),
        ({"safe": lambda wires: ~wires["off"]}, "fault-free run is judged safe/no"),
        ({"detectors": {"d": lambda wires: ~wires["alarm"]}}, "fault-free run is judged wrong/yes|neutral/yes"),
        ({"observe": {"hazard": "alarm"}}, "'hazard' names two wires"),
        ({"onsets": range(0)}, "name steps in ascending order"),
        ({"onsets": range(48, 58)}, r"begins at step 55, outside the run \(0 to 54\)"),
        ({"onsets": range(10), "length": 0}, "length=0"),
        ({"onsets": None, "length": 3}, "length=3 goes with onsets"),
        ({"faults": [Fault(flip(), ["heat"], ANY_TIME, at=3)]}, "has a schedule of its own"),
        ({"engine": "verilator"}, "engine='verilator'; there is auto, lanes, native"),
        ({"scenarios": 3}, "scenarios=3 goes with vary"),
    ],
)
def test_a_declaration_that_cannot_be_meant_is_refused(changes: Any, message: str) -> None:
    with pytest.raises(ModelError, match=message):
        boiler(**changes).inject()


def test_what_is_not_watched_is_named() -> None:
    with pytest.raises(KeyError, match="'fire' is not watched; there is none"):
        boiler(
            hazard=None, detectors={}, safe=None, observe={"heat": "heat"},
            wrong_side=lambda counts: counts.first("fire") < 9, detected=lambda counts: False,
        ).inject()  # fmt: skip


def test_first_is_there_for_judging_functions_too() -> None:
    by_function = boiler(
        hazard=None, detectors={}, safe=None, watch={"heat": "heat", "alarm": "alarm"},
        wrong_side=lambda counts: counts.first("heat") < 10,
        detected=lambda counts: counts.first("alarm") < 50,
    )  # fmt: skip
    found = cells(by_function)
    assert (
        found["heat stuck-at-1 from step 5"] == "wrong/yes" and found["heat stuck-at-1 from step 25"] == "neutral/yes"
    )


# --- histograms -------------------------------------------------------------------------------------------------------


def test_latencies_are_counted_by_size() -> None:
    judged = Judged.alike(9, 0)
    judged.detector[:] = [0, 0, 0, 1, 1, UNDETECTED, 0, 0, 0]
    judged.latency[:] = np.array([0, 1, 2, 7, 4000, 3, 10, 11, 20], dtype=np.uint32)
    first, second, third = latencies(judged, 3)
    assert first["latency"]["histogram"] == [[0, 1], [1, 1], [2, 1], [10, 1], [20, 2]]
    assert (first["latency"]["min"], first["latency"]["max"], first["latency"]["mean"]) == (0, 20, 44 / 6)
    assert second["latency"]["histogram"] == [[10, 1], [5000, 1]]
    assert third == {"count": 0, "latency": None}


def test_upsets_are_flips_at_every_step() -> None:
    declared = boiler(faults=flipped_bits("*"), onsets=range(50), length=1)
    assert declared.inject().campaign.space.statement == "all 250 single faults at 50 onsets"
    assert declared.space.injection(57).id == "heat flip, transient at 7 for 1"
    with pytest.raises(CampaignError, match="no injection 'heat flip, transient at 7 for 2'"):
        declared.space.find("heat flip, transient at 7 for 2")


@pytest.mark.parametrize("order", [1, 2, 3])
def test_collapsing_keeps_schedules_and_latencies_apart(order: int) -> None:
    """Faults that begin at different times, that come to the same, and that cannot show."""
    kinds = [(stuck(1), "heat"), (stuck(1), "enabled"), (stuck(0), "valve"), (stuck(0), "sensor"), (stuck(1), "heat")]
    faults = [
        Fault(kind, [place], ANY_TIME, at=at, name=f"{n}, {place} at {at}")
        for n, (kind, place) in enumerate(kinds)
        for at in (3, 20, 34)
    ]
    declared = boiler(onsets=None, faults=faults, order=order, audit=True)
    assert not declared.collapse().nothing
    found = declared.inject().judged
    for low in range(0, len(declared.space), 11):  # what stands for another may lie in another range
        high = min(low + 11, len(declared.space))
        assert declared.judged(low, high).same(Judged(*(array[low:high] for array in found.arrays))).all()
    for number in range(0, len(declared.space), 17):
        again = declared.replay(number)
        latency = None if found.latency[number] == NO_LATENCY else found.latency[number]
        assert (again.cell, again.latency) == (CELLS[found.cells[number]], latency)

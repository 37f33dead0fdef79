"""The whole TS-7: braking, single and double failures, the required defeats, loss of power."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import pytest

from models.ts7.failures import CHANNELS, channel_faults, component_faults, component_modes, reads
from models.ts7.numbers import SPEEDS
from models.ts7.system import EdgeRule, RuleB, Settling, Ts7, WiredSignals
from models.ts7.train import PER_WORD
from safety.faults import Fault, instrument, schedule, stuck, welded
from safety.system import System
from safety.trace import Trace, run
from safety.tracing import trace

SEEN = [
    "nb", "eb", "synchronising",
    *(f"{group}.{n}" for group in ("brakes", "isolated", "targets") for n in CHANNELS),
]  # fmt: skip
FAULTS = {f.name: f for f in component_faults()}


def drive(
    words: Callable[[int], int],
    frames: int,
    faults: Sequence[Fault] = (),
    model: type[Ts7] = Ts7,
    settings: Mapping[str, Any] | None = None,
    lines: tuple[int, ...] = (65,),
    **other: Any,
) -> Trace:
    """A run on signal 65 (word 138) with speeds in words, from standstill, both sources of power in order."""
    faulted = instrument(trace(model, settings), faults)
    signal = {f"lines.s{v}": v in lines for v in (0, *SPEEDS)}
    free = {"backward": False, "inverter": True, "mg": True, **other}
    choices = schedule(faulted)

    def row(k: int) -> dict[str, Any]:
        now = {name: value(k) if callable(value) else value for name, value in free.items()}
        return {**signal, **now, "speed": PER_WORD * words(k), **choices(k)}

    return run(faulted.system, row, frames, keep=SEEN)


def rising(k: int) -> int:
    """Standstill for 1/8 s, then 120 words, from frame 4000 on 142: 1.9 km/h above the limit."""
    return 0 if k < 1000 else 120 if k < 4000 else 142


def now(seen: Trace, group: str) -> str:
    return "".join(n for n in CHANNELS if seen[f"{group}.{n}"][-1])


def test_healthy_equipment_brakes_and_releases() -> None:
    seen = drive(lambda k: rising(k) if k < 12_000 else 120, 18_000)
    assert not seen["nb"][3999] and 4000 < seen["nb"].index(True, 3999) < 4000 + 19_120 // 4 + 320
    assert seen["nb"][11_999] and not seen["nb"][-1] and not any(seen["eb"][1000:]) and now(seen, "targets") == ""


def test_p13_power_up_at_standstill() -> None:
    assert all(drive(lambda k: 0, 4000, lines=())["nb"])
    assert not drive(lambda k: 0, 4000, lines=(25,))["nb"][-1]


@pytest.mark.parametrize("name", [f.name for f in channel_faults("a")])
def test_one_failed_channel_still_leaves_the_brake(name: str) -> None:
    """Property 7 by example: whatever one channel does, the train brakes; its spurious brake stops nobody."""
    seen = drive(rising, 12_000, [FAULTS[name]])
    assert not any(seen["nb"][1000:4000]) and seen["nb"][-1] and not seen["eb"][-1]
    found_at_once = name in ("a: ring stuck", "a: f_p in every frame", "a: latch at brake")
    assert now(seen, "targets") in ("a", "") and (now(seen, "targets") == "a" or not found_at_once)


@pytest.mark.parametrize("where", ["nbrr_relay.coil", "chr_relay.coil", "supply"])
def test_property_1_in_one_channel(where: str) -> None:
    """An open coil or a lost supply of one channel is a brake vote and an isolation, no brake."""
    seen = drive(rising, 9000, [Fault(stuck(0), [f"common.b.{where}"])])
    assert seen["brakes.b"][3999] and not seen["nb"][3999]
    assert now(drive(lambda k: 100, 6000, [Fault(stuck(0), [f"common.b.{where}"])]), "isolated") == "b"


@pytest.mark.parametrize(
    "point",
    [
        "common.nb_relay.coil",
        "common.nb_relay.contact",
        "common.eb_relay.coil",
        "common.eb_relay.contact",
        "power.supply",
    ],
)
def test_property_1_in_the_common_part(point: str) -> None:
    seen = drive(lambda k: 0, 3000, [Fault(stuck(0), [point])])
    assert all(nb or eb for nb, eb in zip(seen["nb"], seen["eb"], strict=True))


@pytest.mark.parametrize("name", ["speed generator dead", "wrong row in all channels", "signal lines wire-ORed with 25",
                                  "wheel switch on 780 mm", "NB output welded"])  # fmt: skip
def test_property_16_common_causes_defeat_it(name: str) -> None:
    seen = drive(rising, 40_000, [FAULTS[name]])
    assert not any(seen["nb"][4000:]) and not any(seen["eb"][4000:])


def test_property_16_signal_lines_wire_ored() -> None:
    assert drive(rising, 12_000, lines=(25, 65))["nb"][-1]
    assert not any(drive(rising, 12_000, model=WiredSignals, lines=(25, 65))["nb"][4000:])


def test_p17_two_silent_channels_isolate_the_healthy_one() -> None:
    seen = drive(rising, 40_000, [FAULTS["b: no f_v"], FAULTS["c: latch at release"]])
    assert not any(seen["nb"][1000:]) and not any(seen["eb"][1000:]) and now(seen, "targets") == "a"


def test_rule_b_refuted() -> None:
    """Limits of a and b 4 words low and high, c never brakes: a, merely early, is isolated; then b must brake alone."""

    def early(k: int) -> int:
        return 0 if k < 1000 else 137 if k < 14_000 else 148

    late = [FAULTS["c: latch at release"]]
    settings = {"a.offset": -4, "b.offset": 4}
    seen = {m: drive(early, 24_000, late, m, settings) for m in (Ts7, RuleB)}
    assert {now(s, "targets") for s in seen.values()} == {"a"}
    assert (seen[Ts7]["nb"][-1], seen[RuleB]["nb"][-1], seen[RuleB]["eb"][-1]) == (True, False, False)


def test_edge_rule_refuted() -> None:
    """A channel that falls silent while all three brake: noticed by the level rule only."""
    silent = Fault(stuck(0), ["c.comparator.latch"], "any time", at=12_000)
    assert [now(drive(rising, 30_000, [silent], model), "targets") for model in (Ts7, EdgeRule)] == ["c", ""]


def test_property_10_fails_frame_by_frame() -> None:
    """Spread 4 words, inside the accuracy: just above the lowest limit a healthy channel is isolated."""
    seen = drive(lambda k: 0 if k < 1000 else 135, 30_000, settings={"a.offset": -4})
    assert now(seen, "targets") != ""
    together = drive(lambda k: 0 if k < 1000 else 139, 30_000)
    assert now(together, "targets") == ""


def phases(system: type[Ts7]) -> str:
    """Channels isolated after a healthy release, their dividers in different phases."""
    made: System = trace(system)
    signal = {f"lines.s{v}": v == 65 for v in (0, *SPEEDS)}
    free = {"backward": False, "inverter": True, "mg": True}
    words = {**signal, **free, "speed": PER_WORD * 120}
    start = {"a.div0.n": 0, "b.div0.n": 3, "c.div0.n": 8}
    return now(run(made, words, 12_000, start=start, keep=SEEN), "targets")


def test_level_rule_isolates_a_healthy_channel_at_a_release() -> None:
    """Identical limits, no fault: the channel that releases first is isolated; not so when windows may settle."""
    assert phases(Ts7) == "c"
    assert phases(Settling) == phases(EdgeRule) == ""


def test_lowering_switched_off_loses_the_diagnosis() -> None:
    """Limit of a one word low, speed one word above it: lowered, b and c follow; not lowered, a is thought faulty."""
    settings = {"a.offset": -1}

    def slow(k: int) -> int:
        return 0 if k < 1000 else 138

    assert now(drive(slow, 40_000, settings=settings), "targets") == ""
    assert now(drive(slow, 40_000, settings={**settings, "lowering": 0}), "targets") == "a"


def test_p21_power() -> None:
    def lost(k: int) -> bool:
        return k < 5000

    both = drive(lambda k: 100 if k > 1000 else 0, 6000, inverter=lost, mg=lost)
    assert not both["nb"][4999] and not both["eb"][4999] and both["nb"][-1] and both["eb"][-1]
    one = drive(lambda k: 100 if k > 1000 else 0, 9000, inverter=lost)
    assert one["nb"][5300] and one["eb"][5300] and not one["nb"][-1] and not one["eb"][-1] and now(one, "targets") == ""


def test_p21_rollback_and_dual_fault() -> None:
    seen = drive(lambda k: 0 if k < 1000 else 17, 8000, lines=(65,), backward=True)
    assert seen["eb"][-1] and not seen["nb"][-1]
    dual = drive(rising, 9000, [Fault(stuck(0), [f"{n}.ring.overflow.o2"]) for n in "ac"])
    assert dual["eb"][-1] and now(dual, "targets") == "ac"
    assert drive(rising, 9000, [Fault(stuck(1), ["b.rev"])])["eb"][-1]


def test_late_faults_of_the_generator() -> None:
    swapped = component_modes()["speed generator"][2]
    assert drive(rising, 3000, [swapped])["eb"][-1]  # running forward reads as backward
    ghost = drive(lambda k: 0, 3000, [Fault(stuck(1), ["axle.pulse"])])
    assert ghost["nb"][-1]  # a pulse in every frame brakes


def test_wheel_setting() -> None:
    """True 840 mm on the step 820 mm and the limit is 2.4 % up; too great a step brakes early."""
    at = {"wheel": 164}
    for error, words, nb in ((0, 139, True), (4, 139, False), (4, 143, True), (-4, 136, True), (-4, 132, False)):

        def speed(k: int, words: int = words) -> int:
            return 0 if k < 1000 else words

        assert drive(speed, 25_000, settings={**at, "wheel_error": error})["nb"][-1] is nb, (error, words)


def test_a_welded_output_is_the_last_line() -> None:
    assert not drive(rising, 12_000, [Fault(welded(), ["common.nb_relay.contact"])])["nb"][-1]
    assert drive(rising, 12_000, [Fault(reads(0), ["wheel_switch"])])["nb"][-1] is False  # open switch: f_v = 0

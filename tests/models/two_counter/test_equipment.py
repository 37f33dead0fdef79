"""The two-counter ATC by running it: public checks P2, P14-P18, selection, settings."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from models.two_counter.equipment import Equipment
from models.two_counter.selection import Selection
from safety.faults import ANY_TIME, Fault, stuck
from safety.trace import run
from safety.tracing import trace
from tests.models.two_counter.runs import (
    KMH,
    PRESET,
    SPACING,
    STEP_S,
    Fleet,
    brakes_from,
    lines,
    ride,
    steps_with,
    threshold,
)

SAMPLING = {
    250: "0.31415",
    210: "0.31459",
    160: "0.31542",
    110: "0.31697",
    70: "0.31961",
    30: "0.32762",
    5: "0.35549",
}


def test_p2_presets() -> None:
    """Each line, alone, selects its preset; f2E = m / (2*Tc) rounds to the printed frequency."""
    printed = {250: "1660.04", 210: "1403.42", 160: "1085.84", 110: "765.06", 70: "508.44", 30: "251.81", 5: "91.42"}
    for check, hertz in printed.items():
        assert run(Selection, lines(check), 1)["preset"] == [PRESET[check]]
        assert f"{float(Fraction(PRESET[check], 2) / (2000 * STEP_S)):.2f}" == hertz


def test_lowest_selected_check_speed_wins_and_none_is_the_lowest() -> None:
    for some in range(128):
        checks = [v for k, v in enumerate(PRESET) if some >> k & 1]
        assert run(Selection, lines(*checks), 1)["preset"] == [PRESET[min(checks, default=5)]]


@pytest.mark.parametrize(("check", "seconds"), SAMPLING.items())
def test_p14_sampling_period_at_the_check_speed(check: int, seconds: str) -> None:
    """Ts = Tc + 4/f2E, from the distance of read-outs; 0.31415 s at 250, 0.35549 s at 5 km/h."""
    at = steps_with(ride(threshold(check), 14_000, check, keep=["signal1"]), "signal1")
    mean = Fraction(at[-1] - at[1], len(at) - 2)
    assert abs(mean - Fraction(2000 * (PRESET[check] + 8), PRESET[check])) < Fraction(1, len(at) - 2)
    assert abs(mean * STEP_S - Fraction(seconds)) < Fraction(1, len(at) - 2) * STEP_S + Fraction(5, 10**6)


def response(check: int, phase: int, wait: int) -> int:
    """Steps from the instant of overspeed to the brake, where the train stood for `wait` steps after a count start."""
    slow, fast = threshold(check) - KMH, brakes_from(check)
    start = steps_with(ride(slow, 7000, check, phase=phase, keep=["signal3"]), "signal3")[1]
    begins = start + 1 + wait
    seen = ride(lambda k: slow if k <= start else fast * (k >= begins), 12_000, check, phase=phase, keep=["brake"])
    braked = seen["brake"].index(True, begins)
    assert not seen["brake"][begins] and all(seen["brake"][braked:])
    return braked - begins


@pytest.mark.parametrize(("check", "seconds"), [(250, "0.62649"), (5, "0.67817")])
def test_p15_response(check: int, seconds: str) -> None:
    """(2*n2E + 5) / f2E is not exceeded, and reached within a thousandth: the window that began was just enough."""
    bound = Fraction(2000 * (2 * PRESET[check] + 10), PRESET[check])
    assert abs(bound * STEP_S - Fraction(seconds)) < Fraction(1, 10**5)
    worst = max(response(check, phase, wait) for phase in (0, 300_000, 700_000) for wait in (0, 2))
    assert 0.999 * bound < worst <= bound


def counts(check: int, speed: int, phases: np.ndarray, windows: int = 2) -> tuple[set[int], set[bool]]:
    """Counts of whole windows and what they command, over start phases."""
    fleet, found, commands, seen = Fleet(check, phases), set(), set(), np.zeros(len(phases), int)
    while seen.min() <= windows:
        brake, read_out, _ = fleet(speed)
        judged = read_out & (seen >= 1)
        found |= set(fleet.count[judged].tolist())
        commands |= set(brake[judged].tolist())
        seen += read_out
    return found, commands


def test_p17_one_km_h_below_and_a_fifth_above_the_threshold() -> None:
    """Counts 2007-2008 and release; 1998-1999 and brake, over phases evenly spread."""
    phases = np.arange(0, SPACING, SPACING // 400)
    assert counts(250, threshold(250) - KMH, phases) == ({2007, 2008}, {False})
    assert counts(250, threshold(250) + KMH // 5, phases) == ({1998, 1999}, {True})


@pytest.mark.parametrize(("check", "excess"), [(250, "0.12944"), (5, "0.00713")])
def test_p16_excess_at_which_every_phase_brakes(check: int, excess: str) -> None:
    """One unit of speed, 0.0005 km/h, below it some phase reads 2000; the phases are those just before an edge."""
    least = brakes_from(check)
    assert abs(Fraction(least - threshold(check), KMH) - Fraction(excess)) < Fraction(1, KMH)
    spread = np.arange(0, SPACING, SPACING // 300)
    assert counts(check, least, spread)[1] == {True}
    probe = Fleet(check, spread)
    starts = np.zeros(len(spread), bool)
    while not starts.any():
        _, _, starts = probe(least - 1)
    left = probe.state["train.phase"][starts][0]  # turned since the edge at which the count started
    earlier = (spread[starts][0] - left) % SPACING
    assert 2000 in counts(check, least - 1, np.array([earlier]), windows=1)[0]


def test_p18_oscillator_stop_brakes_after_the_window_in_which_it_stood() -> None:
    """Stopped from before a count start on: the next read-out brakes; stopped when FF6 is set: the one after it."""
    speed = threshold(250) - KMH
    healthy = ride(speed, 9000)
    start, read_out = steps_with(healthy, "signal3")[1], steps_with(healthy, "signal1")[2:]
    assert not any(healthy["brake"][read_out[0] :])
    for stops, brakes_at in ((start, read_out[0]), (start + 1000, read_out[0]), (start + 2001, read_out[1])):
        stop = Fault(stuck(0), ["oscillator.f1"], onset=ANY_TIME, at=stops)
        seen = ride(speed, 9000, faults=[stop])["brake"]
        assert seen.index(True, 3000) == brakes_at and all(seen[brakes_at:])


def test_p18_no_edges_hold_the_release_for_ever() -> None:
    """The hazard: a dead speed generator, then any speed; standstill looks the same."""
    dead = Fault(stuck(0), ["train.edge"], onset=ANY_TIME, at=5000)
    for fault, later in (([dead], 700_000), ([], 0)):
        seen = ride(lambda k, v=later: v if k >= 5000 else 500_000, 15_000, faults=fault)  # type: ignore[misc]
        assert not any(seen["brake"][5000:]) and not any(seen["signal1"][5000:])


def test_power_up_brakes_until_the_first_count_was_enough() -> None:
    seen = ride(500_000, 6000)
    first = steps_with(seen, "signal1")
    assert all(seen["brake"][: first[1]]) and not any(seen["brake"][first[1] :])


@pytest.mark.parametrize(("fast", "delay"), [(0, 160), (1, 321)])
def test_ry_1_takes_its_time(fast: int, delay: int) -> None:
    """Coil to contact: operate 160 periods late, release 321 (50 ms) late at overspeed."""
    speeds, begins = (threshold(250) - KMH, threshold(250) + KMH), 5000 * fast
    found = []
    for settings in ({}, {"operate": 160, "release": 321}):
        seen = ride(lambda k: speeds[fast and k > 5000], 12_000, settings=settings, keep=["brake"])["brake"]
        found.append(seen.index(bool(fast), begins))
    assert found[1] - found[0] == delay


def test_preparation_takes_eight_edges_and_counting_the_preset() -> None:
    seen = ride(500_000, 9000, phase=SPACING - 1)  # an edge in each even step
    assert [steps_with(seen, f"signal{n}")[0] for n in (1, 2, 3)] == [2, 6, 14]
    assert [b - a for a, b in pairwise(steps_with(seen, "signal1"))] == [2 * 1043] * 4
    gate = seen["gate"]
    assert [k for k in range(1, 4180) if gate[k] != gate[k - 1]] == [14, 14 + 2070, 14 + 2086, 14 + 2086 + 2070]


def test_counter_1_wraps_and_the_sample_stays_safe() -> None:
    """At 10 km/h of 250 counter 1 runs 25 times through its 2048 states within one window."""
    seen = ride(10 * KMH, 53_000, keep=["circuit.counter1.n", "brake", "signal1"])
    n = seen["circuit.counter1.n"]
    assert sum(1 for a, b in pairwise(n) if (a, b) == (2047, 0)) == 25
    at = steps_with(seen, "signal1")
    assert len(at) == 2 and not seen["brake"][at[1]]


@pytest.mark.parametrize(
    ("settings", "factor"),
    [
        ({}, 1),
        ({"error": 10_000}, Fraction("1.01")),
        ({"error": -102}, 1 - Fraction(102, 10**6)),
        ({"wheel": 919}, Fraction(919, 910)),
        ({"wheel": 880}, Fraction(880, 910)),
        ({"m250": 1037}, Fraction(1037, 1035)),
        ({"n1f": 2040}, 1),
    ],
)
def test_drifts_move_the_permitted_speed_in_proportion(settings: dict[str, int], factor: Fraction) -> None:
    """Up with a fast oscillator, a large wheel, a large preset; n1F alone does not, the oscillator is tuned to it."""
    permitted = threshold(250) * factor
    above, below = (ride(int(permitted) + x, 4500, settings=settings, keep=["brake"])["brake"][-1] for x in (262, -2))
    assert above and not below


@pytest.mark.parametrize(
    ("n1f", "error", "wheel"),
    [(2000, 0, 910), (2000, -102, 910), (1885, 20_000, 929), (2047, 7, 841), (1885, -20_000, 840)],
)
def test_spacing_of_edges_is_rounded_down_by_less_than_two(n1f: int, error: int, wheel: int) -> None:
    made = trace(Equipment, {"n1f": n1f, "error": error, "wheel": wheel})
    (within,) = made.assumptions.values()
    exact = Fraction(500 * n1f * wheel, 910) * (1 + Fraction(error, 10**6))
    assert exact - 2 < within.args[1].attr <= exact
    assert within.args[1].attr > 800_000  # at most one edge a step, up to 400 km/h

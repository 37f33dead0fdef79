"""TS-7: every single stuck fault of one speed-check channel, injected at two levels.  Time unit: a frame, 125 us.

**Ring**, bit by bit, at 65 km/h (word 138) with a wheel of 820 mm (word 164), check word 85, roll-back word 11; a
speed pulse in every sixteenth frame.  512 frames run in, then 4096 are measured; the check word has to overflow 65 to
127 times in each block of 256 frames.

Permitted speed = 65 km/h * (O0 / O0 healthy) / (O1 / O1 healthy); without O0 it is 0, else without O1 it is unlimited.

Result: 77 of 163 faults are detected, all 70 of them in the path that the words share; 46 raise the permitted speed
above 67 km/h, and 11 of these stay undetected (single words and outputs: the check word sees only its own).  The 77 are
35 wrong, 35 safe and 7 neutral: by IEC 61508 the diagnostic coverage is 35/46, while 77/163, and 77/131 over the faults
that change anything, count every direction.

**Channel**, frame by frame, on the test bench at signal 65: backward at 8 km/h, then forward at 63, then at 67 km/h,
4096 frames each (0.512 s, more than the response of 0.3 s); judged over the last 1024 frames of each.  Wrong side: no
roll-back report at 8 km/h, or the drive still runs at 67.  Safe side: the drive fails at 63, or roll-back is reported
there.  Detected: the channel's own check window.

Result: none of the 40 dangerous faults outside the shared path is detected within the channel; what finds them is the
comparison of the three channels.  Failure rates are INVENTED, to show the calculation [A].
"""

from collections.abc import Mapping
from typing import Any

from models.ts7.numbers import KMH_PER_WORD
from models.ts7.ring import BITS_A_FRAME, Ring
from models.ts7.train import PER_WORD, Bench
from proofs.ts7_parts import CHANNEL, INVENTED_ELEMENTS, RING, Elements
from safety.faults import Fault, stuck
from safety.inject import Campaign, Counts, Faults, Group, Runs, stuck_bits


def too_fast(counts: Counts) -> Runs:
    """The permitted speed is above 67 km/h."""
    return 65 * counts.total("o0") * counts.healthy("o1") > 67 * counts.healthy("o0") * counts.total("o1")


def too_slow(counts: Counts) -> Runs:
    """The permitted speed is below 63 km/h; a channel without reference pulses permits none."""
    slow = 65 * counts.total("o0") * counts.healthy("o1") < 63 * counts.healthy("o0") * counts.total("o1")
    return (counts.total("o0") == 0) | (~too_fast(counts) & slow)


def out_of_window(counts: Counts) -> Runs:
    """The check word leaves its window in some block."""
    return ((counts["o2"] <= 64) | (counts["o2"] >= 128)).any(axis=0)


def both(*points: str) -> list[Fault]:
    """All these points stuck at 0 together, and at 1 together."""
    return [Fault(stuck(value), points) for value in (0, 1)]


def missing(*points: str) -> list[Fault]:
    """Each of these points without its signal."""
    return [Fault(stuck(0), [point]) for point in points]


def row(name: str, parts: Mapping[str, Elements], faults: Any, **expect: int) -> Group:
    """A row of the published table; `expect` counts by direction and detection, e.g. `wrong_no=3`."""
    cells = {cell.replace("_", "/"): number for cell, number in expect.items()}
    return Group(name, faults, parts[name].part, name, parts[name].rate_per_h, INVENTED_ELEMENTS, cells or None)


ring_single_stuck = Campaign(
    id="ts7_ring_single_stuck",
    model=Ring,
    constant={"d0": 138, "d1": 164, "d2": 85, "d3": 11},
    stimulus=lambda frame: {"pulse": frame % 16 == 15},
    steps_per_frame=BITS_A_FRAME, run_in=512, measured=4096, block=256,
    observe={"o0": "o0", "o1": "o1", "o2": "o2"},
    wrong_side=too_fast,
    safe_side=too_slow,
    detected=out_of_window,
    faults=[
        row("stage", RING, stuck_bits("ring"), safe_yes=32, wrong_yes=32),
        row("carry", RING, both("carry.in", "carry.out"), safe_yes=1, wrong_yes=1),
        row("sum", RING, stuck_bits("sum"), safe_yes=1, wrong_yes=1),
        row("data", RING, stuck_bits("data"), safe_yes=1, wrong_yes=1),
        row("column", RING, stuck_bits("column"), neutral_no=8, safe_no=3, wrong_no=3, neutral_yes=2),
        row("cell J0", RING, stuck_bits("matrix.j0"), neutral_no=11, safe_no=2, wrong_no=3),
        row("cell J1", RING, stuck_bits("matrix.j1"), neutral_no=11, safe_no=3, wrong_no=2),
        row("cell J2", RING, stuck_bits("matrix.j2"), neutral_no=14, neutral_yes=2),
        row("cell J3", RING, stuck_bits("matrix.j3"), neutral_no=16),
        row("carry clear", RING, missing("carry.clear"), neutral_no=1),
        row("word select", RING, missing("select.j0", "select.j1", "select.j2", "select.j3"),
            safe_no=1, wrong_no=1, neutral_yes=1, neutral_no=1),
        row("overflow", RING, stuck_bits("overflow.o?"), safe_no=2, wrong_no=2, neutral_yes=2, neutral_no=2),
    ],
    expect={"detected": 77, "safe": 11, "dangerous_undetected": 11, "no_effect": 64, "wrong/yes": 35, "wrong/no": 11},
)  # fmt: skip


SLOW, FAST, PHASE, JUDGED = 63, 67, 4096, 1024  # km/h, km/h, frames, frames
BACKWARD, FORWARD, ABOVE = (k * PHASE // JUDGED - 1 for k in (1, 2, 3))  # the block at the end of each phase


def scaled(speed: int) -> int:
    """A speed in km/h as the bench takes it."""
    return round(speed * PER_WORD / KMH_PER_WORD.low)


def ride(frame: int) -> dict[str, int | bool]:
    """Backward at 8 km/h, forward just within the limit, forward just above it."""
    return {"speed": scaled((8, SLOW, FAST)[frame // PHASE]), "backward": frame < PHASE}


def runs_on(counts: Counts) -> Runs:
    """No roll-back report while running back, or no brake above the limit."""
    return (counts["rev"][BACKWARD] < JUDGED) | (counts["drive"][ABOVE] > 0)


def holds_back(counts: Counts) -> Runs:
    """A brake within the limit, or a roll-back report while running forward."""
    return (counts["drive"][FORWARD] < JUDGED) | (counts["rev"][FORWARD] > 0)


def lines(*points: str) -> Faults:
    """Every bit of these points of the channel stuck at 0 and at 1."""
    return stuck_bits(*(f"a.{point}" for point in points))


channel_single_stuck = Campaign(
    id="ts7_channel_single_stuck",
    model=Bench,
    constant={"word": 138, "wheel": 164, "true_wheel": 164, "lowered": False},
    stimulus=ride,
    measured=3 * PHASE, block=JUDGED,
    observe={"drive": "a.drive", "rev": "a.rev", "fault": "a.fault"},
    wrong_side=runs_on,
    safe_side=holds_back,
    detected=lambda counts: counts.ever("fault"),
    faults=[
        row("inputs", CHANNEL, lines("f_s", "backward", "lowered"), neutral_no=2, safe_no=2, wrong_no=2),
        row("limit", CHANNEL, lines("limit"), neutral_no=10, safe_no=2, wrong_no=4),
        row("cells", CHANNEL, lines("ring.matrix.j?"), neutral_no=46, safe_yes=2, safe_no=5, wrong_no=11),
        row("word select", CHANNEL, lines("ring.select.j?"), neutral_no=5, safe_yes=1, safe_no=1, wrong_no=1),
        row("overflow", CHANNEL, lines("ring.overflow.o?"), neutral_no=1, safe_yes=2, safe_no=2, wrong_no=3),
        row("stages", CHANNEL, lines("div?.n", "f_p", "f_rev"), neutral_no=5, safe_no=5, wrong_no=10),
        row("counter, latch", CHANNEL, lines("f_v", "comparator.*"), safe_no=4, wrong_no=4),
        row("counter, latch, gate", CHANNEL, lines("rollback.*", "rev"), neutral_no=3, safe_no=1, wrong_no=4),
        row("latch", CHANNEL, lines("check.faulty"), neutral_no=1, safe_yes=1),
        row("amplifier", CHANNEL, lines("output.*"), safe_no=3, wrong_no=1),
    ],
    expect={"detected": 6, "safe": 25, "dangerous_undetected": 40, "no_effect": 73},
)  # fmt: skip

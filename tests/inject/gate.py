"""The campaigns that a change of TS-7 has to pass: those of proofs/, and small ones for what these do not reach.

Each of the small ones looks at what no campaign of proofs/ can show: another threshold, another pair of faults, the
supply, what is isolated after the brake.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from models.ts7.failures import reads
from models.ts7.ring import BITS_A_FRAME, Ring
from models.ts7.system import Ts7
from models.ts7.train import PER_WORD, Bench
from proofs.ts7_campaign import channel_single_stuck, ring_single_stuck
from proofs.ts7_system_campaign import CHANNELS, OBSERVED, STRIKE, TOO_FAST, overspeed, pairs, roll_back
from safety import ANY_TIME, TRANSIENT, Fault, any_of, at_least, flip, stuck
from safety.inject import Campaign, Counts, Runs

BLOCK = 1024
SLOWLY = {"speed": PER_WORD * 30, "backward": False}
CHECKED = (0, 21, 63, 64, 65, 66, 106, 126, 127, 128, 129, 190, 255)  # check words, 85 is the right one


def each(*patterns: str, value: int = 0, at: int = STRIKE) -> list[Fault]:
    """The point of each channel stuck, one fault each."""
    return [Fault(stuck(value), [p.replace("?", n)], ANY_TIME, at=at) for n in CHANNELS for p in patterns]


def reported_to_the_end(counts: Counts) -> Runs:
    """The fault is reported in every frame of the last block."""
    return counts["fault"][-1] == BLOCK


def inexact(counts: Counts) -> Runs:
    """Word 11 does not overflow 11/256 times a frame, one more or less."""
    return abs(counts.total("o3") - 176) > 1


check_words = Campaign(
    id="gate_check_words",
    model=Bench,
    constant={"word": 138, "wheel": 164, "true_wheel": 164, "lowered": False},
    stimulus=SLOWLY, measured=3 * BLOCK, block=BLOCK,
    observe={"fault": "a.fault", "drive": "a.drive"},
    wrong_side=lambda counts: counts.total("drive") < 0,
    safe_side=lambda counts: counts["drive"][-1] == 0,
    detected=reported_to_the_end,
    faults=[Fault(reads(word), ["a.ring.matrix.j2"]) for word in CHECKED],
    expect={"detected": 8, "no_effect": 5},
)  # fmt: skip

no_signal = Campaign(
    id="gate_no_signal",
    model=Bench,
    constant={"word": 0, "wheel": 164, "true_wheel": 164, "lowered": False},
    settings={"a.offset": 4},
    stimulus={"speed": PER_WORD * 2, "backward": False}, run_in=6 * BLOCK, measured=BLOCK,
    observe={"drive": "a.drive"},
    wrong_side=lambda counts: counts.ever("drive"),
    detected=lambda counts: counts.total("drive") < 0,
    faults=lambda system: [Fault(stuck(value), [p]) for p in ("a.limit", "a.output.toggle") for value in (0, 1)],
    expect={"no_effect": 2, "dangerous_undetected": 2},
)  # fmt: skip

ring_counts = Campaign(
    id="gate_ring_counts",
    model=Ring,
    constant={"d0": 138, "d1": 164, "d2": 85, "d3": 11},
    stimulus=lambda frame: {"pulse": frame % 16 == 15},
    steps_per_frame=BITS_A_FRAME, run_in=512, measured=4096,
    observe={"o3": "o3"},
    wrong_side=inexact,
    detected=lambda counts: counts.total("o3") < 0,
    faults=lambda system: [Fault(flip(), [p]) for p in ("sum", "data", "carry.in", "carry.clear")],
    expect={"dangerous_undetected": 4},
)  # fmt: skip

_whole: dict[str, Any] = {"model": Ts7, "constant": overspeed.constant, "run_in": STRIKE}

two_isolated = Campaign(
    id="gate_two_isolated",
    **_whole, stimulus=SLOWLY, measured=BLOCK,
    observe={"eb": "eb", "two": lambda wires: at_least(2, *(wires[f"isolated.{n}"] for n in CHANNELS))},
    wrong_side=lambda counts: counts.ever("two") & ~counts.ever("eb"),
    safe_side=lambda counts: counts.ever("eb"),
    detected=lambda counts: counts.ever("two"),
    faults=each("?.check.faulty", value=1), order=2,
    expect={"safe/yes": 3},
)  # fmt: skip

first_stays = Campaign(
    id="gate_the_first_is_not_lowered",
    **_whole, stimulus=SLOWLY, measured=5 * BLOCK,
    observe={
        "isolated": OBSERVED["shown"],
        "first lowered": lambda wires: any_of(
            *(wires[f"common.sync.window.first_{n}"] & wires[f"{n}.lowered"] for n in CHANNELS)
        ),
    },
    wrong_side=lambda counts: counts.ever("first lowered"),
    detected=lambda counts: counts.ever("isolated"),
    faults=each("?.comparator.latch", value=1),
    expect={"neutral/yes": 3},
)  # fmt: skip

falls_silent = Campaign(
    id="gate_one_of_three_falls_silent",
    **_whole, stimulus={"speed": TOO_FAST.speed, "backward": False}, measured=5 * BLOCK,
    observe={"isolated": OBSERVED["shown"], "braked": OBSERVED["braked"]},
    wrong_side=lambda counts: counts.total("braked") < 5 * BLOCK,
    detected=lambda counts: counts.ever("isolated"),
    faults=each("?.comparator.latch"),
    expect={"neutral/yes": 3},
)  # fmt: skip

no_source = Campaign(
    id="gate_no_source",
    model=Ts7, constant={**overspeed.constant, "mg": False},
    stimulus=SLOWLY, run_in=STRIKE + 2 * BLOCK, measured=BLOCK,  # after the gap of the change-over
    observe={"braked": OBSERVED["braked"]},
    wrong_side=lambda counts: counts.total("braked") < 0,
    safe_side=lambda counts: counts.ever("braked"),
    detected=lambda counts: counts.total("braked") < 0,
    faults=[Fault(stuck(0), ["power.inverter"], ANY_TIME, at=STRIKE)],
    expect={"safe/no": 1},
)  # fmt: skip

short_dips = Campaign(
    id="gate_short_dips",
    **_whole, stimulus=SLOWLY, measured=BLOCK,
    observe={"braked": OBSERVED["braked"]},
    wrong_side=lambda counts: counts.total("braked") < 0,
    safe_side=lambda counts: counts.ever("braked"),
    detected=lambda counts: counts.total("braked") < 0,
    faults=[Fault(stuck(0), [f"common.{r}_relay.coil"], TRANSIENT, at=STRIKE, ticks=100) for r in ("nb", "eb")],
    expect={"no_effect": 2},
)  # fmt: skip

two_see_no_roll_back = replace(
    roll_back, id="gate_two_see_no_roll_back", faults=each("?.rev"), order=2, expect={"no_effect": 3}
)

GATE = {
    campaign.id: campaign
    for campaign in (
        channel_single_stuck, ring_single_stuck, overspeed, roll_back, pairs, check_words, no_signal, ring_counts,
        two_isolated, first_stays, falls_silent, no_source, short_dips, two_see_no_roll_back,
    )
}  # fmt: skip

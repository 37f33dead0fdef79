"""TS-7, three channels and their vote: overspeed brakes the train whatever one channel does.

Main result: with one channel byzantine (any value at every point of it, at any time), synchronisation and isolation
included, the normal brake comes; time grows as 1/margin.  Two broken channels, or voting rule (b), refute it.
One step is one frame, 125 us.
"""

from __future__ import annotations

from models.ts7.system import RuleB, Ts7
from models.ts7.train import PER_WORD
from proofs.ts7_brake_chain import CHANNELS, Chain, permitted
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    at_most,
    byzantine,
    claim,
    faulty,
    implies,
    persists,
    stuck,
)

OFFSETS = tuple(f"{n}.offset" for n in CHANNELS)  # left open: every healthy channel errs by up to 4 words
BROKEN_CHANNEL = Chain(words=4, blind=faulty, mute=faulty, broken=faulty, offset=lambda s, n: s[f"{n}.offset"])


def too_fast(words_above_65: int, steps: int, after: int = 2700, **script: object) -> Scenario:
    """Signal 65, released first at a low speed for `after` frames, then too fast."""
    fast = PER_WORD * (138 + words_above_65)
    speed = {"speed": lambda k: PER_WORD * 30 if k < after else fast}
    return Scenario(steps=after + steps, inputs={"lines.s65": True, "inverter": True, **speed}, **script)  # type: ignore[arg-type]


@claim(
    Ts7, expect=PROVED, faults=at_most(1, "channel"), symbolic=(*OFFSETS, "wheel"), lemmas=BROKEN_CHANNEL.lemmas(),
    witness=too_fast(8, 5200), requirement="TS7-7", source="[P] 1.6, rule (a) [A]",
)  # fmt: skip
def brakes_with_one_channel_broken(s: Seen) -> Bit:
    """Overspeed of 4 words (1.9 km/h) above every healthy limit for 5104 frames (0.64 s) applies the normal brake, with
    one speed-check part broken in any way, every wheel setting, and every threshold error up to 4 words."""
    return implies(persists(BROKEN_CHANNEL.overspeed(s), BROKEN_CHANNEL.braked), s.nb)


@claim(
    Ts7, expect=REFUTED, faults=at_most(1, "channel"), symbolic=(*OFFSETS, "wheel"), requirement="TS7-7",
    scenario=too_fast(8, 3000, after=2615, start={"wheel": 172, **dict.fromkeys(OFFSETS, 4)}),
    twin_of=brakes_with_one_channel_broken,
)  # fmt: skip
def brakes_in_a_third_of_the_time(s: Seen) -> Bit:
    """Overspeed of 4 words above every healthy limit for 1701 frames applies the normal brake."""
    return implies(persists(BROKEN_CHANNEL.overspeed(s), BROKEN_CHANNEL.braked // 3), s.nb)


def silent(*channels: str) -> dict[str, object]:
    """Values of a broken channel that never asks for the brake: its output keeps toggling."""
    return {f"{n}.output.level": lambda k: k % 2 == 1 for n in channels}


@claim(
    Ts7, expect=REFUTED, faults=at_most(2, "channel"), symbolic=OFFSETS, twin_of=brakes_with_one_channel_broken,
    scenario=too_fast(8, 5200, present=("a", "b"), at=2500, values=silent("a", "b")), requirement="TS7-7",
)  # fmt: skip
def brakes_with_two_channels_broken(s: Seen) -> Bit:
    """Overspeed of 4 words for 5104 frames applies the normal brake, with two channels broken in any way."""
    return implies(persists(BROKEN_CHANNEL.overspeed(s), BROKEN_CHANNEL.braked), s.nb)


def creeping_up(k: int) -> int:
    """Speed: released at first, then between the thresholds of two healthy channels, then far above both."""
    return PER_WORD * (30 if k < 2700 else 136 if k < 10_000 else 146)


@claim(
    RuleB, expect=REFUTED, faults=at_most(1, "channel"), symbolic=OFFSETS, twin_of=brakes_with_one_channel_broken,
    scenario=Scenario(
        steps=15_200, inputs={"lines.s65": True, "inverter": True, "speed": creeping_up}, present=("a",), at=2500,
        values=silent("a"), start={"b.offset": -4, "c.offset": 4},
    ), requirement="TS7-7", source="[A] rule (b)",
)  # fmt: skip
def brakes_by_rule_b(s: Seen) -> Bit:
    """With rule (b) too, overspeed of 4 words for 5104 frames applies the normal brake with one channel broken."""
    return implies(persists(BROKEN_CHANNEL.overspeed(s), BROKEN_CHANNEL.braked), s.nb)


@claim(
    Ts7, expect=PROVED, symbolic=OFFSETS, requirement="TS7-8", source="[D]",
    faults=at_most(1, [Fault(stuck(1), ["a.lowered"], ANY_TIME)]),
)  # fmt: skip
def lowering_only_lowers(s: Seen) -> Bit:
    """The limit in force in a channel is never above its own threshold, also when lowering sticks on."""
    own = {n: (permitted(s) + s[f"{n}.offset"]).sat(8) for n in CHANNELS}
    return (s.a.limit <= own["a"]) & (s.b.limit <= own["b"]) & (s.c.limit <= own["c"])


@claim(
    Ts7, expect=REFUTED, symbolic=OFFSETS, requirement="TS7-8", twin_of=lowering_only_lowers,
    faults=at_most(1, [Fault(byzantine(), ["a.limit"])]),
)  # fmt: skip
def a_broken_matrix_only_lowers(s: Seen) -> Bit:
    """The limit in force in channel a is never above its own threshold, whatever its data matrix delivers."""
    return s.a.limit <= (permitted(s) + s["a.offset"]).sat(8)

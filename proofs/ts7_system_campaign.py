"""TS-7, the whole equipment: the listed failure modes of its components injected, one by one, against two hazards.

All 392 modes of `component_modes()`, relays with their 30 ms and 20 ms.  One step is one frame, 125 us.  Each ride, at
signal 65 with a wheel of 820 mm, starts at 15 km/h; after 0.3 s, the brake being released, the fault strikes; then
0.6 s at 63 km/h, within the limit; then the hazard, for the time by which the proof has the brake applied:

* **overspeed**: 68.8 km/h, 8 words above the limit, for the 5104 frames of `Chain.braked`;
* **roll-back**: backward at 8 km/h for 3362 frames (a report within 3200, then the relay).

Wrong side: after that time neither normal nor emergency brake.  Safe side: a brake within the limit.  Detected: a
target drops, a relay CHR falls or a channel finds its own fault; where no brake comes, this counts only before the
hazard.  The three channels start in equal phases and have no error.

Not injected: another ratio of a divider than by a stuck stage, a single transient flip, lost or weak pulses of the
speed generator, the pulse generator of bits and words, an inverter out of tolerance.  Fast oscillators are those of
`failures`, 11 % for a channel's own and 6.7 % for a shared one [A]; a slow one is not injected.

Results: 7 of the 392 modes defeat the overspeed brake and 4 the roll-back brake, all in what the channels share and all
undetected: the diagnostic coverage of single faults is 0.  The 7 are the single cut sets of `ts7_hazards`.  No fault of
one channel is dangerous; 141 of these 366 show themselves by isolation, 225 have no effect here.

Of pairs of channel faults, both striking at once, a sample is injected: 12 of 1000 are dangerous, each silencing two
channels in one of 16 ways a channel.  If no other pairs are, these are 768 of the 66 795.  None is found in time, for
what the equipment isolates is the healthy channel, when it alone brakes.

Failure rates are INVENTED, to show the calculation [A].
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from fractions import Fraction
from typing import NamedTuple

from models.ts7.failures import component_modes
from models.ts7.numbers import ROLLBACK_WORD
from models.ts7.system import Ts7
from models.ts7.train import PER_WORD
from proofs.ts7_brake_chain import CHANNELS, RELEASE, WORDS, Chain
from proofs.ts7_formulas import at_least_kmh, at_most_kmh, frames_for
from proofs.ts7_hazards import overspeed_without_brake
from proofs.ts7_parts import component_rate
from proofs.ts7_voting import brakes_with_one_channel_broken
from safety import ANY_TIME, Fault, any_of
from safety.inject import Campaign, Counts, Group, Runs

STRIKE, WITHIN, BLOCKS = 2500, 5000, 16  # frame of the fault; least frames within the limit; blocks of the hazard
MARGIN, OFFSET = 4, 4  # words: as in the proof, above the limit of the worst channel allowed

# --- rides and how they are judged ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Ride:
    """Released, within the limit, then a hazard: `speed` for `allowed` frames; blocks divide the time in between."""

    speed: int
    backward: bool
    allowed: int

    @property
    def block(self) -> int:
        """Frames of a block; the hazard lasts `BLOCKS` of them, and one more to look whether the brake is there."""
        return -(-self.allowed // BLOCKS)

    @property
    def measured(self) -> int:
        """Frames from the fault to the end."""
        return self.block * (-(-WITHIN // self.block) + BLOCKS + 1)

    def __call__(self, frame: int) -> dict[str, int | bool]:
        """Stimulus of a frame."""
        danger = frame >= STRIKE + self.measured - self.block * (BLOCKS + 1)
        slow = at_most_kmh(15 if frame < STRIKE else 63)
        return {"speed": self.speed if danger else slow, "backward": danger and self.backward}


TOO_FAST = Ride(PER_WORD * (WORDS["s65"] + OFFSET + MARGIN), False, Chain(MARGIN).braked)
ROLLS_BACK = Ride(at_least_kmh(8), True, frames_for(at_least_kmh(8) - PER_WORD * ROLLBACK_WORD) + RELEASE + 2)


def runs_on(counts: Counts) -> Runs:
    """Neither brake is there after the time that the proof allows."""
    return counts["free"][-1] > 0


def stops(counts: Counts) -> Runs:
    """A brake, though the train is within the limit."""
    return (counts["braked"][: -BLOCKS - 1] > 0).any(axis=0)


def revealed(counts: Counts) -> Runs:
    """A target, a CHR or a channel's own detector shows a fault, before the hazard or with the brake applied."""
    shown = counts["shown"] > 0
    return shown[: -BLOCKS - 1].any(axis=0) | (shown.any(axis=0) & ~runs_on(counts))


OBSERVED = {
    "braked": lambda wires: wires["nb"] | wires["eb"],
    "free": lambda wires: ~wires["nb"] & ~wires["eb"],
    "shown": lambda wires: any_of(
        *(wires[f"{sign}.{n}"] for sign in ("targets", "isolated") for n in CHANNELS),
        *(wires[f"{n}.fault"] for n in CHANNELS),
    ),
}

# --- failure modes ----------------------------------------------------------------------------------------------------

INVENTED = "[A] invented for the example; all components of the kind together"


class Mode(NamedTuple):
    """A row of the table: its faults among `component_modes()` by name (? is a channel), the rate of one component."""

    part: str
    mode: str
    faults: str
    rate_per_h: str


MODES = [
    Mode("oscillator", "stops", "oscillator ? stops", "3e-7"),
    Mode("oscillator", "fast", "oscillator ? fast", "1e-7"),
    Mode("row select", "wrong row", "row ? wrong", component_rate("a: wrong word")),
    Mode("row select", "two rows", "row ? and that of 25", "1e-8"),
    Mode("ring", "no or only overflows", "?.ring.overflow.o[*] *", "1e-6"),
    Mode("word select", "word missing", "?.ring.select.*", "4e-8"),
    Mode("data matrix", "cell of J0, limit", "?.ring.matrix.j0 *", "8e-8"),
    Mode("data matrix", "cell of J1, wheel", "?.ring.matrix.j1 *", "8e-8"),
    Mode("data matrix", "cell of J2, check", "?.ring.matrix.j2 *", "8e-8"),
    Mode("data matrix", "cell of J3, roll-back", "?.ring.matrix.j3 *", "8e-8"),
    Mode("level converter", "stuck", "lines_?.line.*", "1.2e-7"),
    Mode("overflow gate", "stuck", "?.ring.overflow.o[0-3] *", "8e-8"),
    Mode("divider by 16", "stuck", "?.div?.n *", "1e-7"),
    Mode("comparator", "stuck", "?.comparator.*", "4e-7"),
    Mode("roll-back comparator", "stuck", "?.rollback.*", "4e-7"),
    Mode("fault detector", "dead", "?.check.faulty stuck-at-0", component_rate("a: fault detector dead")),
    Mode("fault detector", "false alarm", "?.check.faulty stuck-at-1", "5e-7"),
    Mode("output amplifier", "stands still", "?.output.level *", "2e-7"),
    Mode("output amplifier", "oscillates", "output amplifier ? oscillates", "1e-8"),
    Mode("lowering", "never or always", "?.lowered *", "5e-8"),
    Mode("relay NBRR", "opens", "common.?.nbrr_relay * open", "2e-7"),
    Mode("relay NBRR", "welded", "common.?.nbrr_relay * welded", component_rate("a: NBRR welded")),
    Mode("relay CHR", "opens", "common.?.chr_relay * open", "2e-7"),
    Mode("relay CHR", "welded", "common.?.chr_relay * welded", component_rate("a: CHR welded")),
    Mode("isolation", "never", "common.sync.isolate_? stuck-at-0", "1e-7"),
    Mode("isolation", "without cause", "common.sync.isolate_? stuck-at-1", "1e-7"),
    Mode("channel supply", "lost", "common.?.supply *", "2e-7"),
    Mode("relay NB", "opens", "common.nb_relay * open", "2e-7"),
    Mode("relay NB", "welded", "common.nb_relay * welded", component_rate("NB output welded")),
    Mode("relay EB", "opens", "common.eb_relay * open", "2e-7"),
    Mode("relay EB", "welded", "common.eb_relay * welded", component_rate("EB relay welded")),
    Mode("shared oscillator", "fast", "oscillator of all fast", component_rate("shared oscillator fast")),
    Mode("shared rows", "wrong row", "row of all wrong", component_rate("wrong row in all channels")),
    Mode("shared rows", "two rows", "row of all and that of 25", component_rate("signal lines wire-ORed with 25")),
    Mode("speed generator", "dead", "axle.pulse stuck-at-0", component_rate("speed generator dead")),
    Mode("speed generator", "pulse in every frame", "axle.pulse stuck-at-1", "1e-8"),
    Mode("speed generator", "windings exchanged", "axle.backward *", "1e-8"),
    Mode("wheel switch", "open", "wheel_switch reads 0", component_rate("wheel switch open")),
    Mode("wheel switch", "wrong step", "wheel_switch reads 1*", "4.5e-7"),
    Mode("inverter", "fails", "power.inverter *", "5e-6"),
    Mode("motor-generator", "fails", "power.mg *", "5e-6"),
    Mode("change-over", "fails", "power.change_over *", "1e-6"),
    Mode("relay supply", "lost", "power.supply *", "1e-7"),
]


def rows() -> Iterator[Group]:
    """The failure modes as groups of faults that strike at `STRIKE`, with the rate of all components of a kind."""
    for part, mode, pattern, rate in MODES:
        found = [[f for f in faults if fnmatchcase(f.name, pattern)] for faults in component_modes().values()]
        hit = [faults for faults in found if faults]
        yield Group(f"{part}: {mode}", struck(hit), part, mode, len(hit) * Fraction(rate), INVENTED)


def channels() -> Iterator[Group]:
    """The faults of each channel."""
    for n in CHANNELS:
        yield Group(
            f"channel {n}", struck(faults for part, faults in component_modes().items() if part[-2:] == f" {n}")
        )


def struck(parts: Iterable[list[Fault]]) -> list[Fault]:
    """Faults that strike at `STRIKE`."""
    return [replace(fault, onset=ANY_TIME, at=STRIKE) for faults in parts for fault in faults]


# --- campaigns --------------------------------------------------------------------------------------------------------

overspeed = Campaign(
    id="ts7_overspeed_single_faults",
    model=Ts7,
    constant={**{f"lines.{line}": line == "s65" for line in WORDS}, "inverter": True, "mg": True},
    stimulus=TOO_FAST, run_in=STRIKE, measured=TOO_FAST.measured, block=TOO_FAST.block,
    observe=OBSERVED,
    wrong_side=runs_on,
    safe_side=stops,
    detected=revealed,
    faults=list(rows()),
    proofs=[brakes_with_one_channel_broken, overspeed_without_brake],
    expect={"safe": 7, "detected": 143, "dangerous_undetected": 7, "no_effect": 235, "safe/yes": 2, "wrong/yes": 0},
)  # fmt: skip

roll_back = replace(
    overspeed,
    id="ts7_roll_back_single_faults",
    proofs=(), stimulus=ROLLS_BACK, measured=ROLLS_BACK.measured, block=ROLLS_BACK.block,
    expect={"safe": 6, "detected": 98, "dangerous_undetected": 4, "no_effect": 284, "safe/yes": 2, "wrong/yes": 0},
)  # fmt: skip

pairs = replace(
    overspeed,
    id="ts7_overspeed_channel_pairs",
    proofs=(), faults=list(channels()),
    order=2, sample=1000, seed=1,
    expect={"safe": 0, "detected": 627, "dangerous_undetected": 12, "no_effect": 361, "wrong/yes": 0},
)  # fmt: skip

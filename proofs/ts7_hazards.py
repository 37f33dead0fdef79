"""TS-7: minimal cut sets of "too fast and no brake", over 39 component faults that may strike at any time.

Main result: seven single faults, all common to the channels; 108 pairs, each silencing two channels; 36 triples and 3
quadruples, in which a ring stands still and its own detector is dead.  Complete at every order over the 39 listed
faults, each one replayed; what is not listed is said in `models.ts7.failures`.
The failure rates are a parts list made up for this study [A]: they show the method, not the equipment.
One step is one frame, 125 us.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from models.ts7.failures import component_faults
from models.ts7.system import Ts7
from models.ts7.train import PER_WORD
from proofs.ts7_brake_chain import CHANNELS, Chain
from proofs.ts7_formulas import Formula, named
from proofs.ts7_parts import INVENTED_COMPONENTS, component_rate
from safety import ANY_TIME, Bit, Scenario, Seen, hazard, implies, persists, struck

FAULTS = [replace(fault, onset=ANY_TIME) for fault in component_faults()]
OUTPUT = "NB output welded"
BLINDING = ("no f_v", "f_p in every frame", "wrong word", "comparator at 0", "latch at release")
SHARED = (
    "speed generator dead",
    "wrong row in all channels",
    "signal lines wire-ORed with 25",
    "wheel switch on 780 mm",
    "wheel switch open",
    "shared oscillator fast",
)
SINGLES = (*SHARED, OUTPUT)  # after one of these nothing brakes the train
SILENCING = (*BLINDING, "NBRR welded")  # after one of these a channel does not ask for the brake
UNSEEN = ("ring stuck", "fault detector dead")  # nor after both of these


def silent_ring(s: Seen, n: str) -> Bit:
    """The ring of channel n stands still, and its detector cannot say so."""
    stuck, dead = (struck(s, f"{n}: {fault}") for fault in UNSEEN)
    return stuck & dead


def blind(s: Seen, n: str) -> Bit:
    """Faults after which the comparison of channel n says nothing about the speed."""
    own = (*BLINDING, "ring stuck", "latch at brake")
    return struck(s, *(f"{n}: {fault}" for fault in own), *SHARED)


def mute(s: Seen, n: str) -> Bit:
    """Faults after which relay NBRR of channel n need not fall."""
    return struck(s, *(f"{n}: {fault}" for fault in SILENCING), *SHARED) | silent_ring(s, n)


CHAIN = Chain(words=4, blind=blind, mute=mute, unheard=lambda s: struck(s, *SINGLES))


def standing_ring_is_found(n: str) -> Formula:
    """Lemma: with no overflows, the check window of channel n finds the fault at the end of a whole block."""

    def lemma(s: Seen) -> Bit:
        check, since = s[n].check, CHAIN.since(s)
        blank = implies(since >= check.frame.int(), check["count"] == 0)
        found = implies(since >= 256 + check.frame.int(), check.faulty)
        return ~struck(s, f"{n}: ring stuck") | struck(s, f"{n}: fault detector dead") | (blank & found)

    return named(f"standing ring of {n} is found", lemma)


def scenarios(present: tuple[str, ...]) -> Iterator[Scenario]:
    """Signal 65, released at a low speed; the faults strike; then the train is 8 words too fast."""
    fast = PER_WORD * (138 + 8)
    speed = {"speed": lambda k: PER_WORD * 30 if k < 2500 else fast}
    steps = 2500 + CHAIN.braked + 20
    given = {"lines.s65": True, "inverter": True, "mg": True, **speed}
    yield Scenario(steps=steps, inputs=given, present=present, at=2300, start={"wheel": 172})


@hazard(
    Ts7, faults=FAULTS, scenarios=scenarios, symbolic=("wheel",), requirement="TS7-7", source="[D]", hours="10000",
    lemmas=[*CHAIN.lemmas(), *(standing_ring_is_found(n) for n in CHANNELS)], expect={1: 7, 2: 108, 3: 36, 4: 3},
    rates={f.name: (component_rate(f.name), INVENTED_COMPONENTS) for f in FAULTS},
)  # fmt: skip
def overspeed_without_brake(s: Seen) -> Bit:
    """The last fault has struck, the train then runs 4 words (1.9 km/h) above every healthy limit for 5104 frames
    (0.64 s), and neither normal nor emergency brake is applied."""
    return persists(CHAIN.overspeed(s), CHAIN.braked) & ~s.nb & ~s.eb

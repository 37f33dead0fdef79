"""Two-counter ATC at 250 km/h with a watchdog [A]: minimal cut sets of "too fast and no brake".

The hazard of `two_counter_hazards` over most of its functional failures, four that hold the command because no read-out
comes (`SILENT`), and a dead watchdog.  T_w is 0.62 s here, within what property 4 allows for the brake; a longer T_w
makes that brake as much later.

Results: without the watchdog these four are single cut sets, beside 13 others; with it the 13 are left, and each of the
four takes a second fault: the watchdog dead, or signal 1 always there.  A read-out that is stuck passes for one that
comes, so a watchdog has to see it change.
Not listed: `ELSEWHERE`, harmless with the watchdog by injection, and the other stages of counter 2.
"""

from __future__ import annotations

from models.two_counter.variants import Watched
from proofs.two_counter_formulas import Formula, named
from proofs.two_counter_hazards import COUNTERS, FUNCTIONAL, RIDE, SINGLES, chain
from safety import ANY_TIME, Bit, Fault, Seen, age, hazard, struck, stuck

T_W = 4000  # steps, 0.62 s
ELSEWHERE = (
    "counter 2 is not reset", "counting gate at 1", "signal 3 always", "signal 3 missing", "signals 1 and 3 swapped",
    "FF6 flips", "noise edge every 200 periods", "signal 1 missing",
)  # fmt: skip
SILENT = ("generator open or short", "counter 2: stage 1 at 0", "counter 2: stage 0 at 1", "counter 2: stage 10 at 1")
"""After these no read-out comes."""

DEAD = Fault(stuck(1), ["watchdog.restart"], ANY_TIME, name="watchdog dead")
LISTED = [
    *(fault for fault in FUNCTIONAL if fault.name not in ELSEWHERE),
    *(fault for fault in COUNTERS if fault.name in SILENT),
]
FOOLED = (DEAD.name, "signal 1 always")  # after these the watchdog knows nothing of read-outs
CHAIN = chain(LISTED).lemmas()
LEFT = [fault.name for fault in LISTED if fault.name in SINGLES and fault.name not in SILENT]


def waited(name: str) -> Formula:
    """Lemma: with this fault, which came before the overspeed, the watchdog has waited for as long as that lasts."""

    def formula(s: Seen) -> Bit:
        lasted = age(RIDE.chain.overspeed(s), RIDE.chain.braked).int()
        return struck(s, *FOOLED) | ~struck(s, name) | (s.watchdog.idle.int() >= lasted - 2)

    return named(f"the watchdog has waited since {name}", formula)


@hazard(Watched, faults=[*LISTED, DEAD], scenarios=RIDE.scenarios, settings={"watchdog.patience": T_W},
        lemmas=[*CHAIN, *map(waited, SILENT)], requirement="TC-15", source="[A]",
        expect={1: 13, 2: 8})  # fmt: skip
def with_watchdog_no_brake(s: Seen) -> Bit:
    """At 250 km/h, with a watchdog of 0.62 s: overspeed for 4019 steps (0.626 s) and no brake."""
    return RIDE.too_fast_too_long(s) & ~s.brake

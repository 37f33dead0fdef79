"""Two-counter ATC: the circuit does what the sample equation says, period by period.

Source: eq. (3) and (4) with the floor [D]; the circuit of section 5 [P].
"""

from __future__ import annotations

from typing import Any

from models.two_counter.circuit import READ_OUT
from models.two_counter.equipment import Equipment
from models.two_counter.failures import component_faults
from models.two_counter.numbers import N1F
from models.two_counter.samples import Samples
from models.two_counter.train import KMH
from proofs.two_counter_formulas import (
    PREPARATION,
    counted,
    counting,
    edges,
    preparation_in_order,
    safe,
)
from safety import PROVED, REFUTED, Bit, Scenario, Seen, any_of_faults, refines, select


def between(s: Seen) -> Bit:
    """Counters in their ranges, FF6 set just when counter 1 has come to n1F, the relay as FF2."""
    return preparation_in_order(s) & (safe(s) | (counted(s) < N1F))


def sampler(s: Seen) -> dict[str, Any]:
    """Place, count and decision of the ideal machine, as they stand in the circuit."""
    read = ~counting(s) & (edges(s) >= READ_OUT)
    return {
        "train.phase": s.train.phase,
        "sampler.place": select(counting(s), edges(s).int(), edges(s).int() - PREPARATION).clip(-PREPARATION, 2046),
        "sampler.n1": select(read, 0, select(safe(s), N1F, counted(s).int())).clip(0, 2048),
        "sampler.braking": s.circuit.ff2.on,
    }


@refines(Equipment, Samples, steps=1, outputs=["brake"], at=between, expect=PROVED, requirement="TC-1",
         source="[D] eq. (3), (4) with the floor")  # fmt: skip
def the_circuit_is_the_sample_equation(s: Seen) -> dict[str, Any]:
    """At every step the circuit commands what floor(phase + f1 W) < n1F says of the last whole sample."""
    return sampler(s)


NOT_RESET = [f for f in component_faults() if f.name == "counter 1 is not reset"]

ONE_SAMPLE = Scenario(100, {"lines.s5": True, "speed": 400 * KMH}, present=[f.name for f in NOT_RESET])


@refines(Equipment, Samples, steps=1, outputs=["brake"], at=between, expect=REFUTED, requirement="TC-1",
         faults=any_of_faults(NOT_RESET), twin_of=the_circuit_is_the_sample_equation,
         scenario=ONE_SAMPLE)  # fmt: skip
def a_circuit_without_reset_is_the_sample_equation(s: Seen) -> dict[str, Any]:
    """The same where signal 2 does not reset counter 1."""
    return sampler(s)

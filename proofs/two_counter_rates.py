"""Two-counter ATC: how often it fails to the wrong side, at 250 km/h, before anything is added to it.

Nothing in the circuit is redundant and nothing detects a fault: the diagnostic coverage, computed by the campaigns, is
0, and the wrong-side rate is the sum over the single wrong-side modes, 5.75e-7 /h.  Most of it comes from four of them:
generator dead, generator losing pulses, oscillator fast, FF6 flipping.

Rates per h, exponential, of an INVENTED parts list [A].
"""

from __future__ import annotations

import functools
from collections.abc import Iterable
from fractions import Fraction

from models.two_counter.failures import component_faults
from proofs.two_counter_campaign import SINGLE
from proofs.two_counter_hazards import PAIRS, SIMULATED, SINGLES
from proofs.two_counter_parts import INVENTED, mode_rate
from safety.inject import Campaign
from safety.rates.claims import rate
from safety.rates.enclosure import Enclosure
from safety.rates.exponential import chance
from safety.rates.units import quantity
from safety.trees import BasicEvent, FaultTree, from_cut_sets, solve

RATES = {fault.name: mode_rate(fault) for fault in component_faults()}
PARTS = quantity(
    "1 FIT", "A", "a stage, line or gate, to one value; generator, oscillator, relay, supply by themselves"
)
HOURS = quantity("10 000 h", "A", "time at risk, without repair or test")
SOURCE = "[D] wrong-side modes computed by proof and by injection, parts list [A]"


def wrong_in(campaigns: Iterable[Campaign]) -> frozenset[str]:
    """The modes that one of some campaigns shows as wrong-side."""
    found = (one for campaign in campaigns for one in campaign.inject().injections())
    return frozenset(injection.faults[0].name for injection, cell in found if cell.startswith("wrong"))


@functools.cache
def wrong_in_the_campaigns() -> frozenset[str]:
    """The modes that some moment of injection shows as wrong-side."""
    return wrong_in(SINGLE)


def by_injection() -> Fraction:
    """Sum over the modes that are dangerous when injected, without those that no proof is about."""
    return sum((RATES[name] for name in wrong_in_the_campaigns() if name not in SIMULATED), Fraction(0))


def by_proof() -> Fraction:
    """Sum over the single cut sets."""
    return sum((RATES[name] for name in SINGLES), Fraction(0))


rate(
    id="two-counter.wrong-side", unit="1/h", source=SOURCE, inputs={"parts": PARTS},
    quantity="rate of wrong-side failure of the two-counter device at 250 km/h, single failures",
    routes={"single cut sets of the hazards": by_proof, "wrong-side modes of the campaigns": by_injection},
)  # fmt: skip


def tree() -> FaultTree:
    """The cut sets of the hazards as a fault tree."""
    sets = [*((name,) for name in SINGLES), *PAIRS]
    names = dict.fromkeys(name for one in sets for name in one)
    return from_cut_sets(
        "overspeed without brake", sets,
        [BasicEvent(name, None, RATES[name], HOURS.value, INVENTED, "A") for name in names],
    )  # fmt: skip


def top_event(end: int) -> Fraction:
    """The probability in closed form, from the lower (0) or upper (1) ends of the single ones."""
    (bit_10,) = {pair[0] for pair in PAIRS}
    bit, singles = chance(RATES[bit_10] * HOURS.value), chance(by_proof() * HOURS.value)
    lower = chance(sum((RATES[name] for _, name in PAIRS), Fraction(0)) * HOURS.value)
    return 1 - (1 - singles[end]) * (1 - bit[end] * lower[end])


rate(
    id="two-counter.top-event", unit="1", source=SOURCE, inputs={"parts": PARTS, "hours": HOURS},
    quantity="probability that the train can run too fast without a brake, within 10 000 h, nothing repaired or tested",
    routes={"closed form": lambda: Enclosure(top_event(0), top_event(1)),
            "decision diagram of the fault tree": lambda: Enclosure(*map(Fraction, solve(tree()).bounds or ()))},
)  # fmt: skip

"""ATS-SP and radio control: wrong-side rates, diagnostic coverage, fault trees from the component table.

The rates are INVENTED [A], since the table has none: the figures show the method and which rows decide.  Main results:
single failures count, 1.35e-5 /h as it stands and 1.26e-5 with the map; the slide is most of it, since a row counts
whole if any of its injections is wrong-side; then creep, and the weak brake, low adhesion included.  What the map takes
away are the missing balises and the silent coil.  Nothing on board finds a wrong-side failure before it does
harm: the diagnostic coverage of a run is 0, and what the map finds is the difference of the two rates.
Rates per h, exponential.  Source: cut sets by injection (`ats_campaign`, `radio_campaign`) and proof
(`dual_processor_hazards`), rates [A].
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction

from models.ats.failures import ASSUMED_RATES
from proofs.ats_campaign import MAPPED_ON_THE_STRETCH, ON_PARTS, ON_THE_STRETCH
from proofs.ats_parts import PAIRS, of_radio, per_hour, singles, wrong_side
from proofs.dual_processor_rates import within
from proofs.radio_campaign import parting, running
from safety.rates.claims import rate
from safety.rates.enclosure import Enclosure
from safety.rates.units import quantity
from safety.trees import BasicEvent, FaultTree, from_cut_sets, solve

PARTS = quantity("1 FIT", "A", "to 10 000 FIT a row: invented parts list of the component table")
HOURS = quantity("1000 h", "A", "time at risk, without repair or test")
SOURCE = "[D] wrong-side rows computed by injection, rates [A]"


def injected(mapped: bool = False) -> list[str]:
    """Rows of ATS-SP that are wrong-side when injected, at any onset and size, on any ride."""
    return wrong_side(MAPPED_ON_THE_STRETCH if mapped else ON_THE_STRETCH) + wrong_side(ON_PARTS)


def total(names: Iterable[str]) -> Fraction:
    """Sum of the rates of some rows."""
    return sum((per_hour(name) for name in names), Fraction(0))


rate(
    id="ats.wrong-side", unit="1/h", source=SOURCE, inputs={"parts": PARTS},
    quantity="rate of wrong-side failure of ATS-SP, single failures",
    routes={"rows of the table": lambda: total(singles()), "rows found by injection": lambda: total(injected())},
)  # fmt: skip

rate(
    id="ats.wrong-side.mapped", unit="1/h", source=SOURCE, inputs={"parts": PARTS},
    quantity="the same, where each balise that was expected and not seen is read as stop",
    routes={"rows of the table": lambda: total(singles(True)),
            "rows found by injection": lambda: total(injected(True))},
)  # fmt: skip

rate(
    id="radio.wrong-side", unit="1/h", source=SOURCE, inputs={"parts": PARTS},
    quantity="rate of wrong-side failure of radio control, single failures",
    routes={"rows of the table": lambda: total(of_radio()),
            "rows found by injection": lambda: total(wrong_side((running, parting)))},
)  # fmt: skip


# --- fault trees ------------------------------------------------------------------------------------------------------


def tree(cut_sets: Sequence[tuple[str, ...]], top: str) -> FaultTree:
    """Cut sets as a fault tree."""
    names = dict.fromkeys(name for one in cut_sets for name in one)
    return from_cut_sets(
        top, cut_sets, [BasicEvent(n, None, per_hour(n), HOURS.value, ASSUMED_RATES, "A") for n in names]
    )


def cut_sets() -> list[tuple[str, ...]]:
    """Of ATS-SP: single rows, and the pair of processor and comparator."""
    return [*((name,) for name in singles()), *PAIRS]


def by_hand(sets: Sequence[tuple[str, ...]]) -> Enclosure:
    """No set happens: they have no event in common."""

    def end(k: int) -> Fraction:
        chances = (math.prod(within(per_hour(name), HOURS.value)[k] for name in one) for one in sets)
        return 1 - math.prod(1 - Fraction(chance) for chance in chances)

    return Enclosure(end(0), end(1))


def by_diagram(sets: Sequence[tuple[str, ...]], top: str) -> Enclosure:
    """By the decision diagram of the tree."""
    return Enclosure(*map(Fraction, solve(tree(sets, top)).bounds or ()))


rate(
    id="ats.top-event", unit="1", source=SOURCE, inputs={"parts": PARTS, "hours": HOURS},
    quantity="probability that ATS-SP lets the train past a stop or too fast over the turnout, within 1000 h",
    routes={"closed form": lambda: by_hand(cut_sets()),
            "decision diagram of the fault tree": lambda: by_diagram(cut_sets(), "past the stop or too fast")},
)  # fmt: skip

rate(
    id="radio.top-event", unit="1", source=SOURCE, inputs={"parts": PARTS, "hours": HOURS},
    quantity="probability that radio control lets the follower reach the leader, within 1000 h, nothing repaired",
    routes={"closed form": lambda: by_hand([(name,) for name in of_radio()]),
            "decision diagram of the fault tree": lambda: by_diagram([(n,) for n in of_radio()], "contact")},
)  # fmt: skip

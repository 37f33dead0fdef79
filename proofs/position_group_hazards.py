"""Five reference balises: minimal cut sets of a wrong code or origin, by balises that are lost or too many.

One balise of any group, with any code, is lost; one stands at any place, before, within or behind it; or one cause does
both.  Any jitter, any scale error; the group is no longer than W.  Complete at every order, each set replayed.
Main result: neither is enough by itself, both together are, by one cause or by two: what `position_guard` proves of
AP-6 and refutes of AP-7, as faults.
Rates are INVENTED [A].
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from models.ats.failures import ASSUMED_RATES, FIT, table
from models.position.passing import LaidGroup
from proofs import position_guard
from safety import ANY_TIME, Bit, Fault, Scenario, Seen, common_cause, hazard, implies, struck, stuck

MISSING, EXTRA, BOTH = (f"reference balise: {mode}" for mode in ("missing", "extra", "both"))
FAULTS = (
    Fault(stuck(1), ["missing"], ANY_TIME, name=MISSING),
    Fault(stuck(1), ["extra"], ANY_TIME, name=EXTRA),
    common_cause(BOTH, {"missing": stuck(1), "extra": stuck(1)}, onset=ANY_TIME),
)
RATES = {mode.name: (str(mode.fit * FIT), ASSUMED_RATES) for mode in table() if mode.name in (MISSING, EXTRA, BOTH)}


def by_faults(s: Seen) -> Bit:
    """None is lost but by a fault, none is too many but by a fault, and then one."""
    return implies(s.lost, s.missing) & implies(s.seen.extra, s.extra & ~s.strange)


def together(s: Seen) -> Bit:
    """One is lost, and one is too many."""
    return struck(s, BOTH) | (struck(s, MISSING) & struck(s, EXTRA))


def by_its_fault(s: Seen) -> Bit:
    """Lemma: an extra balise has been seen only if there is one."""
    return implies(s.strange, struck(s, EXTRA, BOTH))


def collected(s: Seen) -> Bit:
    """Lemma: unless both have struck the decoder has just the group, or one that it will reject, or nothing of it."""
    return together(s) | position_guard.collected(s)


def on_slot_17(present: tuple[str, ...]) -> Iterator[Scenario]:
    """{5, 12, 30}, without its middle balise if one is lost, with another one on slot 17 if one is too many."""
    lost, more = (name in present or BOTH in present for name in (MISSING, EXTRA))
    own = {0, 5, 12, 30, 40} - ({12} if lost else set())
    places = sorted(own | ({17} if more else set()))
    run = [b - a for a, b in pairwise([0, *places, 81])]
    inputs = {"seen.run": run.__getitem__, "seen.own": lambda k: k < len(places) and places[k] in own,
              "seen.extra": lambda k: k < len(places) and places[k] not in own}  # fmt: skip
    yield Scenario(len(run), inputs, {"lost": lost}, present=present)


@hazard(LaidGroup, faults=FAULTS, scenarios=on_slot_17, given=by_faults, lemmas=[by_its_fault, collected],
        rates=RATES, hours="1000", requirement="AP-7", source="[P] reference balises; [A] guard",
        expect={1: 1, 2: 1})  # fmt: skip
def a_group_is_misread(s: Seen) -> Bit:
    """A reading is accepted that is not that of the group's five balises, or has another origin."""
    return ~position_guard.true_reading(s)

"""ATS-SP: minimal cut sets of "a stop was passed, and no pattern acts", for every order of balises and for ever.

The chain from the balises to the target of the home signal, without positions: the rows of the component table that are
in it, and a release by phase without cause.  Complete at every order over the listed faults, each set replayed.
Main result: six single faults and no more; they are the rows of this chain that injection finds wrong-side on the
stretch at stop.  Of a coil that reads nothing the set learns by the position that it gives up, after the second balise
that was not seen: too late where the signal balise is one of the last two.
Rates are INVENTED [A].
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from models.ats.failures import ASSUMED_RATES, FIT, table
from models.ats.telling import Telling
from models.position.correction import RELEASE, SIGNAL
from safety import ANY_TIME, Bit, Fault, Scenario, Seen, common_cause, hazard, implies, struck, stuck
from safety.tracing import trace

POINTS = trace(Telling).points
PHASE = "track receiver: phase inverted"


DRIFT = "on-board coil, oscillation unit: drift"


def chain_faults() -> list[Fault]:
    """The rows whose points the chain has, at any time, by the names of the rows."""
    drift = common_cause(DRIFT, {"coil.shows_stop": stuck(0), "coil.shows_proceed": stuck(1)}, onset=ANY_TIME)
    found = [drift, Fault(stuck(1), ["phase_released"], ANY_TIME, name=PHASE)]
    for mode in table():
        for fault in mode.faults:
            points = [point.replace("track.", "").replace("ats.coil", "coil") for point in fault.points]
            if mode.name != DRIFT and all(point in POINTS for point in points):
                found.append(replace(fault, points=points, onset=ANY_TIME, at=0, ticks=None, name=mode.name))
    return found


FAULTS = chain_faults()
SINGLES = (
    "signal balise: missing / detuned", "signal balise: contact welded", "release balise: false proceed",
    "on-board coil, oscillation unit: silent", DRIFT, PHASE,
)  # fmt: skip
RATES = {mode.name: (str(mode.fit * FIT), ASSUMED_RATES) for mode in table() if mode.name in {f.name for f in FAULTS}}


def the_pattern_acts(s: Seen) -> Bit:
    """Lemma: while a stop is due the target is active, unless one of the singles has struck."""
    return struck(s, *SINGLES) | implies(s.due, s.target.active)


def scenarios(present: tuple[str, ...]) -> Iterator[Scenario]:
    """The signal balise, then the release balise, the signal at stop."""
    passes = {"reached": lambda step: step in (2, 5), "kind": lambda step: SIGNAL if step < 4 else RELEASE}
    yield Scenario(8, {"stop": True, **passes}, present=present, at=1)


@hazard(
    Telling, faults=FAULTS, scenarios=scenarios, lemmas=[the_pattern_acts], rates=RATES, hours="1000",
    requirement="AV-2", source="[D]", expect={1: 6},
)  # fmt: skip
def a_stop_is_forgotten(s: Seen) -> Bit:
    """A signal balise was passed at stop, the signal has not been cleared since, and no pattern acts."""
    return s.forgotten

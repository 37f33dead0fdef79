"""ATS-S and ATS-SP, sampled: drivers who brake late, let go, or do not answer, before a signal at stop.

Each driver is drawn with a pinned seed and meets both equipments, warned where ATS-S needs it at 100 km/h; the share of
those who pass the signal is bounded by Clopper and Pearson at 99 %.  This is sampling, not proof: the distributions are
assumed [A], and what is rare is not seen.  All run at 60 to 100 km/h, brake with 0.4 to 0.8 m/s^2, do not draw power:

* **answers late**: operates the brake after 3 to 7 s, to the stop;
* **brakes late**: touches the handle after 1 to 4.9 s, for 0.5 s, and brakes 100 to 500 m before the signal;
* **lets go**: operates the brake after 1 to 4.9 s, for 10 to 60 s;
* **does not answer**.

Results of 200 drivers: with ATS-S 67 pass the signal, none of those who do not answer; with ATS-SP none, so that at
most 2.7 % do, with 99 % confidence.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

from models.ats.ats_s import AtsS
from models.ats.supervision import Supervision
from models.kinematics import CYCLE, mps
from proofs.ats_plots import ASSUMED, CALM, EVENTS, WARNED, where
from proofs.patterns_drawn import BRAKES, EMERGENCY, SAMPLED, SERVICE, Row, drive, lines
from safety import Model
from safety.exhibits import Column, table
from safety.exhibits import Row as Cells
from safety.inject.statistics import clopper_pearson
from safety.system import System
from safety.trace import Live
from safety.tracing import trace

MISSIONS, SEED, CONFIDENCE = 200, 1987, 0.99
NEVER = 1000  # s, longer than any run
NOWHERE = -1000  # m, beyond any run
Handle = tuple[Fraction, Fraction, int]


class Driver(NamedTuple):
    """A train and what its driver does, seconds from the warning on."""

    kind: str
    speed: int  # km/h at the warning balise
    b: Fraction  # m/s^2, of his braking
    answers: Fraction  # s until he operates the brake
    holds: Fraction  # s for which he does
    again: int  # m before the signal from where he brakes to the stop

    def brakes(self, time: Fraction, x: Fraction) -> bool:
        """Whether the handle is in a braking position, `x` metres before the signal."""
        return self.answers <= time < self.answers + self.holds or x <= self.again


def tenths(pick: random.Random, low: int, high: int) -> Fraction:
    """Uniform from low to high tenths."""
    return Fraction(pick.randint(low, high), 10)


KINDS: Mapping[str, Callable[[random.Random], Handle]] = {
    "answers late": lambda pick: (tenths(pick, 30, 70), Fraction(NEVER), NOWHERE),
    "brakes late": lambda pick: (tenths(pick, 10, 49), Fraction(1, 2), pick.randint(100, 500)),
    "lets go": lambda pick: (tenths(pick, 10, 49), tenths(pick, 100, 600), NOWHERE),
    "does not answer": lambda pick: (Fraction(NEVER), Fraction(0), NOWHERE),
}


@cache
def drivers() -> tuple[Driver, ...]:
    """Those drawn, each kind as likely."""
    pick, found = random.Random(SEED), list[Driver]()
    for _ in range(MISSIONS):
        kind = pick.choice(list(KINDS))
        found.append(Driver(kind, pick.randint(60, 100), Fraction(pick.randint(40, 80), 100), *KINDS[kind](pick)))
    return tuple(found)


# --- the two equipments -----------------------------------------------------------------------------------------------

QUIET = {f"events.{name}": False for name in EVENTS}


class Cab:
    """A driver at his handle, on a train with one of the equipments."""

    def __init__(self, driver: Driver, live: Live, brakes: Callable[[Row], Mapping[str, Any]]) -> None:
        self.driver, self.live, self.brakes, self.braking = driver, live, brakes, False

    def passes(self, row: Callable[[Fraction, Fraction, bool, bool], Row]) -> bool:
        """Whether the train passes the signal; `row` by place, speed, at the balise, braking."""

        def seen(time: Fraction, x: Fraction, v: Fraction) -> Row:
            self.braking = self.driver.brakes(time, x)
            return row(x, v, time == 0, self.braking)

        return drive(self.live, WARNED, mps(self.driver.speed), seen, self.brakes, self.power).end[0] < 0

    def power(self, x: Fraction, v: Fraction) -> Fraction:
        """The acceleration that he gives, m/s^2."""
        return -self.driver.b if self.braking else Fraction(0)


def with_ats_s(driver: Driver, equipment: System) -> bool:
    """Whether he passes the signal with ATS-S."""
    live = Live(equipment, keep=["emergency"])
    live.step({**CALM, "standing": True, "reset": True})

    def row(x: Fraction, v: Fraction, balise: bool, braking: bool) -> Row:
        return {**CALM, "elapsed": CYCLE, "stop_read": balise, "braking": braking, "standing": v == 0}

    return Cab(driver, live, lambda shown: lines(shown, BRAKES, emergency=EMERGENCY)).passes(row)


def with_ats_sp(driver: Driver, equipment: System) -> bool:
    """Whether he passes the signal with ATS-SP."""
    live = Live(equipment, keep=["service", "emergency"])
    live.step({**QUIET, "events.reset": True, **where(WARNED, Fraction(0))})

    def row(x: Fraction, v: Fraction, balise: bool, braking: bool) -> Row:
        return {**QUIET, **where(x, v), "events.stop_read": balise}

    order = {"service": SERVICE, "emergency": EMERGENCY}
    return Cab(driver, live, lambda shown: lines(shown, SAMPLED, **order)).passes(row)


# --- how many pass ----------------------------------------------------------------------------------------------------

Equipment = tuple[Callable[[Driver, System], bool], type[Model]]
ATS_S: Equipment = (with_ats_s, AtsS)
ATS_SP: Equipment = (with_ats_sp, Supervision)
PASS = {"answers late": 5, "brakes late": 32, "lets go": 30, "does not answer": 0, "all": 67}  # with ATS-S


def passing(equipment: Equipment, settings: Row | None = None, many: int = MISSIONS) -> dict[str, int]:
    """How many of the first so many drivers pass the signal, by kind; `settings` of the model if not the usual ones."""
    passes, model = equipment
    system = trace(model, settings)
    found = Counter(driver.kind for driver in drivers()[:many] if passes(driver, system))
    return {kind: found[kind] for kind in KINDS} | {"all": found.total()}


COLUMNS = (
    Column("driver"), Column("missions"), Column("pass with ATS-S"), Column("share, least", decimals=4, assumed=True),
    Column("share, greatest", decimals=4, assumed=True), Column("pass with ATS-SP"),
    Column("share at most", decimals=4, assumed=True), Column("as pinned"),
)  # fmt: skip


@table(id="ats.drivers_sampled", title="Drivers who pass a signal at stop, drawn with a pinned seed", columns=COLUMNS,
       source="[A] distributions; runs of the models, bounds of Clopper and Pearson at 99 %", requirement="AS-3",
       assumed=(*ASSUMED[:2], "[A] drivers"), note="Sampled, not proved.")  # fmt: skip
def sampled() -> Iterator[Cells]:
    """A kind of driver a row, and all."""
    plain, supervised = passing(ATS_S), passing(ATS_SP)
    drawn = Counter(driver.kind for driver in drivers()) + Counter(all=MISSIONS)
    for kind, hits in plain.items():
        low, high = map(Fraction, clopper_pearson(hits, drawn[kind], CONFIDENCE))
        most = Fraction(clopper_pearson(supervised[kind], drawn[kind], CONFIDENCE)[1])
        as_pinned = (hits, supervised[kind]) == (PASS[kind], 0)
        yield kind, drawn[kind], hits, low, high, supervised[kind], most, as_pinned

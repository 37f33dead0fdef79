"""Two-counter ATC: what a watchdog on the read-out, or a second speed generator, would buy [A].

**Watchdog** (`Watched`, T_w = 2 s): without a read-out for T_w it brakes, so whatever fails before it, no release is
held for longer.  Of the 62 single wrong-side modes at 250 km/h 33 are left, and of 5.85e-7 /h 2.58e-7 [A].  The price:
a healthy train below (n2E + 4)/T_w is braked too, 40.7 km/h on the frequency scale at the check speed 250 km/h, 2.6 at
that of 5; and a train at a standstill, whose generator it cannot tell from a dead one.

**Second generator** (`SecondGenerator`): a dead or losing generator is found after 18 edges at the most, and no healthy
pair is; 59 modes are left, 2.75e-7 /h [A].  A hold behind the generators is not found.

One step is an oscillator period.  Counts and rates by injection of all 125 modes, at three moments.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from fractions import Fraction

from models.two_counter.circuit import READ_OUT, START
from models.two_counter.equipment import Equipment
from models.two_counter.second_generator import SecondGenerator
from models.two_counter.variants import Watched
from proofs.two_counter_campaign import MOMENTS, singles
from proofs.two_counter_formulas import EDGE
from proofs.two_counter_hazards import CHAIN, LINES, SINGLES
from proofs.two_counter_rates import PARTS, RATES, SOURCE, wrong_in
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    age,
    at_most,
    byzantine,
    claim,
    implies,
    persists,
    select,
    struck,
    stuck,
)
from safety.rates.claims import rate

PATIENCE = 12_831  # T_w in steps, 2 s
M = 1035

# --- watchdog --------------------------------------------------------------------------------------------------------

BEFORE_IT = Fault(byzantine(), ["train.edge", "oscillator.*", "selection.*", "circuit.*"], ANY_TIME, name="anything")
DEAD = Fault(stuck(0), ["train.edge"], ANY_TIME, name="generator dead")


def no_read_out(s: Seen) -> Bit:
    """No signal 1."""
    return ~s.signal1


def waits(s: Seen) -> Bit:
    """Lemma: the watchdog has counted the periods without a read-out."""
    return s.watchdog.idle >= age(no_read_out(s), PATIENCE + 1)


@claim(Watched, expect=PROVED, faults=at_most(1, [BEFORE_IT]), lemmas=[waits], requirement="TC-15", source="[A]",
       witness=Scenario(PATIENCE + 10))  # fmt: skip
def no_release_is_held_for_longer_than_t_w(s: Seen) -> Bit:
    """With generator, oscillator, selection and circuit broken in any way, 2 s without a read-out brake."""
    return implies(persists(no_read_out(s), PATIENCE + 1), s.brake)


@claim(Equipment, expect=REFUTED, faults=at_most(1, [DEAD]), requirement="TC-15", defeat=True, source="property 15 (a)",
       scenario=Scenario(4300 + PATIENCE, {**LINES, "speed": 500_000}, present=("generator dead",), at=4300),
       twin_of=no_release_is_held_for_longer_than_t_w)  # fmt: skip
def without_watchdog_no_release_is_held(s: Seen) -> Bit:
    """Without the watchdog 2 s without a read-out brake too."""
    return implies(persists(no_read_out(s), PATIENCE + 1), s.brake)


def dead_for_so_long(s: Seen) -> Bit:
    """Lemma: the watchdog has counted the periods since the generator is dead."""
    return s.watchdog.idle >= age(struck(s, "generator dead"), PATIENCE + 1)


@claim(Watched, expect=PROVED, faults=at_most(1, [DEAD]), lemmas=[dead_for_so_long], requirement="TC-15", source="[A]",
       witness=Scenario(PATIENCE + 20, {"speed": 500_000}, present=("generator dead",), at=5))  # fmt: skip
def a_dead_generator_brakes(s: Seen) -> Bit:
    """2 s after the generator is dead there is a brake, at any speed."""
    return implies(persists(struck(s, "generator dead"), PATIENCE + 1), s.brake)


SLOWEST = -(-(M + START) * EDGE // PATIENCE)  # at 250 km/h; 81 288 units are 40.7 km/h


def not_slow(s: Seen) -> Bit:
    """The train runs at (n2E + 4)/T_w or faster."""
    return s.speed >= SLOWEST


def period(s: Seen) -> Bit:
    """Lemma: counter 2 is within its period."""
    return select(s.circuit.counter2.counting, s.circuit.counter2.n < M, s.circuit.counter2.n < START)


def in_time(s: Seen) -> Bit:
    """Lemma: the axle has turned as the watchdog has waited."""
    n, counting = s.circuit.counter2.n.int(), s.circuit.counter2.counting
    edges = select(counting, n + START - READ_OUT, select(n < READ_OUT, n + M + START - READ_OUT, n - READ_OUT))
    return SLOWEST * s.watchdog.idle.int() <= EDGE * edges + s.train.phase


@claim(Watched, expect=PROVED, given=not_slow, lemmas=[period, in_time], requirement="TC-15", source="[A]")
def watchdog_leaves_a_fast_train_alone(s: Seen) -> Bit:
    """At (n2E + 4)/T_w of 250 km/h or faster, 40.7 km/h on the frequency scale, the watchdog never brakes a healthy
    train, whatever is selected."""
    return ~s.watchdog.late


def a_bit_slow(s: Seen) -> Bit:
    """The train runs at 99 % of it or faster."""
    return 100 * s.speed >= 99 * SLOWEST


@claim(Watched, expect=REFUTED, given=a_bit_slow, requirement="TC-15", twin_of=watchdog_leaves_a_fast_train_alone,
       scenario=Scenario(30_000, {**LINES, "speed": SLOWEST * 99 // 100 + 1}))  # fmt: skip
def watchdog_leaves_a_slow_train_alone(s: Seen) -> Bit:
    """At 99 % of it neither."""
    return ~s.watchdog.late


# --- second generator ------------------------------------------------------------------------------------------------

TOLERANCE = 8  # edges
FOUND = -(-(2 * TOLERANCE + 2) * EDGE // CHAIN.speed) + 1  # steps


def within(s: Seen) -> Bit:
    """Lemma: out of tolerance is latched."""
    d, out = s.comparison.difference, s.comparison.differs
    return out | ((d <= TOLERANCE) & (d >= -TOLERANCE))


def dead_and_fast(s: Seen) -> Bit:
    """The first generator is dead, and the train too fast."""
    return struck(s, "generator dead") & (s.speed >= CHAIN.speed)


def falls_behind(s: Seen) -> Bit:
    """Lemma: each edge of the second generator counts against a dead one."""
    behind = EDGE * s.comparison.difference - s.second.phase
    return s.comparison.differs | (behind <= TOLERANCE * EDGE - CHAIN.speed * age(dead_and_fast(s), FOUND).int())


@claim(SecondGenerator, expect=PROVED, faults=at_most(1, [DEAD]), lemmas=[within, falls_behind], requirement="TC-15",
       source="[A]", witness=Scenario(60, {"speed": CHAIN.speed}, present=("generator dead",)))  # fmt: skip
def a_dead_generator_is_found(s: Seen) -> Bit:
    """At overspeed of 250 km/h a dead generator brakes within 18 edges (36 steps, 5.6 ms)."""
    return implies(persists(dead_and_fast(s), FOUND), s.brake)


BOTH_DEAD = Fault(stuck(0), ["train.edge", "second.edge"], ANY_TIME, at=4300, name="generator dead")


@claim(SecondGenerator, expect=REFUTED, faults=at_most(1, [BOTH_DEAD]), requirement="TC-15",
       twin_of=a_dead_generator_is_found, scenario=Scenario(4400, {**LINES, "speed": lambda k: 500_000 if k < 4310
       else CHAIN.speed}, present=("generator dead",), at=4300))  # fmt: skip
def two_dead_generators_are_found(s: Seen) -> Bit:
    """Both dead at once are found too."""
    return implies(persists(dead_and_fast(s), FOUND), s.brake)


def in_step(s: Seen) -> Bit:
    """Lemma: edges of equal wheels come in turn."""
    d, ahead = s.comparison.difference, s.train.phase - s.second.phase
    turn = implies(d == 1, ahead <= 0) & implies(d == -1, ahead >= 0)
    return (d <= 1) & (d >= -1) & turn & ~s.comparison.differs


@claim(SecondGenerator, expect=PROVED, lemmas=[in_step], requirement="TC-15", source="[A]")
def healthy_generators_never_differ(s: Seen) -> Bit:
    """With equal wheels the comparison never brakes a healthy train, at any speed, standstill included."""
    return ~s.comparison.differs


@claim(SecondGenerator, expect=REFUTED, requirement="TC-15", twin_of=healthy_generators_never_differ,
       settings={"second.wheel": 900}, scenario=Scenario(6000, {**LINES, "speed": 500_000}))  # fmt: skip
def unequal_wheels_never_differ(s: Seen) -> Bit:
    """With wheels of 910 and 900 mm it never does.  One per cent is more than its tolerance."""
    return ~s.comparison.differs


# --- what they buy ---------------------------------------------------------------------------------------------------

WITH_WATCHDOG = [singles(f"{when}_watchdog", *at, model=Watched, allowed=PATIENCE + CHAIN.braked)
                 for when, at in MOMENTS.items()]  # fmt: skip
WITH_SECOND = [singles(f"{when}_second_generator", *at, model=SecondGenerator) for when, at in MOMENTS.items()]

GENERATOR = ("generator open or short", "one generator pulse in 100 lost", "generator 5 km/h low")
HOLDING = (
    "generator open or short", "FF6 flips", "counter 2 is not reset", "counting gate at 1", "signal 1 missing",
    "signal 3 always", "signal 3 missing", "signals 1 and 3 swapped",
    *(name for name in SINGLES if name.startswith("counter 2: stage") and name != "counter 2: stage 1 at 1"),
)  # fmt: skip
"""What the watchdog makes harmless: these hold the command, or let a sample more pass."""


@functools.cache
def left(which: str) -> frozenset[str]:
    """The modes that are still wrong-side."""
    return wrong_in(WITH_WATCHDOG if which == "watchdog" else WITH_SECOND)


def bought(names: tuple[str, ...]) -> Callable[[], Fraction]:
    """The single cut sets, and the generator reading low, without what is made harmless."""
    return lambda: sum((RATES[n] for n in (*SINGLES, "generator 5 km/h low") if n not in names), Fraction(0))


for which, names in (("watchdog", HOLDING), ("second generator", GENERATOR)):
    rate(
        id=f"two-counter.wrong-side.{which.replace(' ', '-')}", unit="1/h", source=SOURCE, inputs={"parts": PARTS},
        quantity=f"rate of wrong-side failure at 250 km/h, single failures, with a {which}",
        routes={"modes left in the campaigns": lambda which=which: sum((RATES[n] for n in left(which)), Fraction(0)),
                "single cut sets without those it makes harmless": bought(names)},
    )  # fmt: skip

"""TS-7, mean times and rates: the published 30 000 h, and how often the equipment fails to the wrong side.

The MTBF of 30 000 h is printed without a structure.  Each statement solves for the failure rate that one structure
needs to reach it, in two ways: by the root of a formula, and by bisection on a Markov chain that is written from words.

The rate of wrong-side failure takes a channel's failures from the injection campaigns: what the check window detects is
computed there, fault by fault.  Its parts list is INVENTED [A]; `low` and `high` let each of its rates be wrong by a
factor of 2.  Results: the check window finds 55 % of a channel's dangerous failures by rate; with it alone two silent
channels come at 3.4e-8 /h, with a yearly test at 2.1e-11, with the comparison at each braking at 2.4e-15.  The single
failures of what the channels share, 3.7e-7 /h, decide: three channels do not help against them.

Times in h, rates per h, exponential [A].  Source: 30 000 h [P]; structures E8 to E10, inverted [D].
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from fractions import Fraction
from itertools import combinations, product

from proofs.ts7_campaign import channel_single_stuck, ring_single_stuck
from proofs.ts7_hazards import SILENCING, SINGLES, UNSEEN
from proofs.ts7_parts import BIT_BY_BIT_ONLY, CHANNEL, COMPONENTS, INVENTED_COMPONENTS, component_rate
from safety.inject.fmeda import Row
from safety.inject.result import Result
from safety.rates.claims import Target, printed, rate
from safety.rates.enclosure import Enclosure, Estimate
from safety.rates.exponential import chance
from safety.rates.inverse import solve_decreasing
from safety.rates.markov import Chain, mean_time
from safety.rates.two_out_of_three import FAILED, chain, channel_rate_for, common_rate_for, mttf
from safety.rates.units import quantity
from safety.rates.wrong_side import Coverage, Equipment, rate_by_channels, rate_by_formula
from safety.trees import BasicEvent, FaultTree, from_cut_sets, solve

MTBF = quantity("30 000 h", "P", "mean time between failures of the equipment")
TARGET = MTBF.value
BY_ROOT, BY_CHAIN = "root of the formula", "bisection on the Markov chain, exact"


def specified(text: str, digits: int | None = None) -> Target:
    """A figure of the specification, to its digits; it was derived there, and only the 30 000 h are published."""
    return printed(text, digits)._replace(text=f"{text} of the specification")


def needed(build: Callable[[Fraction], Chain]) -> Enclosure:
    """The rate at which a chain fails after 30 000 h in the mean."""
    return solve_decreasing(lambda x: mean_time(build(x), {FAILED}), TARGET)


# --- structures that give the published 30 000 h ---------------------------------------------------------------------

rate(
    id="ts7.mtbf.first-failure", unit="1/h", source="[D] any first failure, in series",
    quantity="rate of all channels and the common part together that makes the first failure come after 30 000 h",
    target=specified("3.3333e-5 /h"), inputs={"MTBF": MTBF},
    routes={"1 / 30 000 h": lambda: 1 / TARGET, BY_CHAIN: lambda: needed(lambda x: Chain("up", {("up", FAILED): x}))},
)  # fmt: skip

rate(
    id="ts7.mtbf.no-repair", unit="1/h", source="[D] E8", inputs={"MTBF": MTBF},
    quantity="failure rate of a channel, two out of three without repair", target=specified("2.77778e-5 /h"),
    routes={"E8 solved": lambda: Fraction(5, 6) / TARGET, BY_ROOT: lambda: channel_rate_for(TARGET),
            BY_CHAIN: lambda: needed(chain)},
)  # fmt: skip

rate(
    id="ts7.mtbf.no-repair.forward", unit="h", source="[D] E8", target=printed("30 000 h", digits=5),
    quantity="mean time to failure of two out of three without repair, channel MTBF 36 000 h",
    inputs={"channel": quantity("36 000 h", "D", "channel MTBF")},
    routes={"E10 without repair": lambda: mttf(Fraction(1, 36_000), 0, 0),
            "Markov chain, exact": lambda: mean_time(chain(Fraction(1, 36_000)), {FAILED})},
)  # fmt: skip

for share, shown in (("0.1", "2.6114e-5 /h"), ("0.25", "2.3932e-5 /h"), ("0.5", "2.0952e-5 /h")):
    rate(
        id=f"ts7.mtbf.common-{share}", unit="1/h", source="[D] E9", target=specified(shown),
        quantity=f"failure rate of a channel, no repair, common part failing {share} times as often as a channel",
        inputs={"MTBF": MTBF, "share": quantity(share, "A", "rate of the common part for each of a channel")},
        routes={BY_ROOT: lambda k=Fraction(share): channel_rate_for(TARGET, common_per_channel=k),
                BY_CHAIN: lambda k=Fraction(share): needed(lambda x: chain(x, k * x))},
    )  # fmt: skip

for hours, shown in ((8, "1180 h"), (24, "2019 h"), (72, "3424 h"), (168, "5095 h")):
    rate(
        id=f"ts7.mtbf.repair-{hours}h", unit="h", source="[D] E10", target=specified(shown, digits=4),
        quantity=f"MTBF of a channel, two out of three, failed channel exchanged in {hours} h",
        inputs={"MTBF": MTBF, "repair": quantity(f"{hours} h", "A", "mean time to exchange a channel")},
        routes={BY_ROOT: lambda m=Fraction(1, hours): channel_rate_for(TARGET, repair=m).reciprocal(),
                BY_CHAIN: lambda m=Fraction(1, hours): needed(lambda x: chain(x, 0, m)).reciprocal()},
    )  # fmt: skip

A_DAY = Fraction(1, 24)
for channel, shown in ((5_000, "36 085 h"), (10_000, "31 337 h"), (20_000, "30 325 h"), (36_000, "30 100 h")):
    rate(
        id=f"ts7.mtbf.common-part-{channel}h", unit="h", source="[D] E10", target=specified(shown, digits=5),
        quantity=f"MTBF of the common part, channel MTBF {channel} h, exchanged in 24 h",
        inputs={"MTBF": MTBF, "channel": quantity(f"{channel} h", "A"), "repair": quantity("24 h", "A")},
        routes={BY_ROOT: lambda x=Fraction(1, channel): common_rate_for(TARGET, x, A_DAY).reciprocal(),
                BY_CHAIN: lambda x=Fraction(1, channel): needed(lambda c: chain(x, c, A_DAY)).reciprocal()},
    )  # fmt: skip

rate(
    id="ts7.mtbf.common-rate", unit="1/h", source="[D] E10", target=specified("3.1911e-5 /h"),
    quantity="failure rate of the common part, channel MTBF 10 000 h, exchanged in 24 h",
    inputs={"MTBF": MTBF, "channel": quantity("10 000 h", "A"), "repair": quantity("24 h", "A")},
    routes={BY_ROOT: lambda: common_rate_for(TARGET, Fraction(1, 10_000), A_DAY),
            BY_CHAIN: lambda: needed(lambda c: chain(Fraction(1, 10_000), c, A_DAY))},
)  # fmt: skip

# --- failure to the wrong side, from the injection campaigns ---------------------------------------------------------

OFF = 2  # every rate of the invented lists may be wrong by this factor [A]
LAMBDAS = ("lambda_s", "lambda_dd", "lambda_du")


@functools.cache
def campaign_results() -> tuple[Result, Result]:
    """Both injection campaigns, carried out once."""
    return ring_single_stuck.inject(), channel_single_stuck.inject()


def channel_rows() -> list[Row]:
    """The failure modes of one whole channel: what only the ring shows bit by bit, and the rest."""
    ring, channel = campaign_results()
    return [*(row for row in ring.rows if row.group.name in BIT_BY_BIT_ONLY), *channel.rows]


def channel_rates() -> dict[str, Fraction]:
    """Failures per hour of one channel: safe, dangerous detected, dangerous undetected; without those of no effect."""
    return {name: sum((row.split()[name] for row in channel_rows()), Fraction(0)) for name in LAMBDAS}


def spread(found: Fraction, missed: Fraction) -> Coverage:
    """Coverage from the rates of what is detected and what is not, each within a factor of 2."""
    low, value, high = (found * k / (found * k + missed / k) for k in (Fraction(1, OFF), 1, OFF))
    return Coverage.of(value, low, high)


def coverage() -> Coverage:
    """Of a channel's dangerous failures, the share that its check window detects."""
    _, found, missed = channel_rates().values()
    return spread(found, missed)


def coverage_fault_by_fault() -> Coverage:
    """The same from the single injections: each stands for an equal part of its group's rate."""
    found = missed = Fraction(0)
    for result, groups in zip(campaign_results(), (BIT_BY_BIT_ONLY, CHANNEL), strict=True):
        each = {row.group.name: row.rate / row.of for row in result.rows if row.group.name in groups}
        for injection, cell in result.injections():
            found += each.get(injection.group, 0) * (cell == "wrong/yes")
            missed += each.get(injection.group, 0) * (cell == "wrong/no")
    return spread(found, missed)


def bounded(share: Coverage) -> Estimate:
    """A coverage with its ends as a figure."""
    return Estimate(*(Enclosure.exactly(part) for part in share))


def channel_rate() -> Fraction:
    """Failures per hour of one channel that have any effect."""
    return sum(channel_rates().values(), Fraction(0))


def equipment(**more: Fraction) -> Equipment:
    """Three channels of the parts list, a failed one exchanged in 24 h."""
    dangerous = 1 - channel_rates()["lambda_s"] / channel_rate()
    return Equipment(channel=channel_rate(), dangerous=dangerous, coverage=coverage(), repair=A_DAY, **more)


def both_ways(**more: Fraction) -> dict[str, Callable[[], Estimate]]:
    """The rate of wrong-side failure, over states of the equipment and over states of each channel."""
    return {
        "by states of the equipment": lambda: rate_by_formula(equipment(**more)),
        "channel by channel": lambda: rate_by_channels(equipment(**more)),
    }


SHARED_PER_HOUR = sum((Fraction(COMPONENTS[name]) for name in SINGLES), Fraction(0))
REPAIR = quantity("24 h", "A", "mean time to exchange a channel")
ELEMENTS = quantity("1 FIT", "A", "or 2 of each element, within a factor of 2: invented parts list of a channel")
COMMON = quantity("372 FIT", "A", "single failures of what the channels share: invented parts list")
YEARLY = quantity("8760 h", "A", "between proof tests of all channels")
DEMAND = quantity("1 h", "A", "between brakings, at which the comparison of the channels shows a silent one")
COMPUTED = "[D] coverage computed by ts7_ring_single_stuck and ts7_channel_single_stuck, parts list [A]"

rate(
    id="ts7.wrong-side.coverage", unit="1", source=COMPUTED, inputs={"elements": ELEMENTS},
    quantity="diagnostic coverage of the check window over one whole channel, by rate",
    routes={"sums of the failure-mode table": lambda: bounded(coverage()),
            "fault by fault": lambda: bounded(coverage_fault_by_fault())},
)  # fmt: skip

rate(
    id="ts7.wrong-side.window", unit="1/h", source=COMPUTED, inputs={"elements": ELEMENTS, "repair": REPAIR},
    quantity="rate of two channels silent at once; only the check window finds failures", routes=both_ways(),
)  # fmt: skip

rate(
    id="ts7.wrong-side.window-and-test", unit="1/h", source=COMPUTED, routes=both_ways(proof_test=YEARLY.value),
    quantity="rate of two channels silent at once; check window, and a proof test every year",
    inputs={"elements": ELEMENTS, "repair": REPAIR, "test": YEARLY},
)  # fmt: skip

rate(
    id="ts7.wrong-side.compared", unit="1/h", source=COMPUTED, routes=both_ways(proof_test=DEMAND.value),
    quantity="rate of two channels silent at once; check window, and the comparison of the channels at every braking",
    inputs={"elements": ELEMENTS, "repair": REPAIR, "demand": DEMAND},
)  # fmt: skip

rate(
    id="ts7.wrong-side.whole", unit="1/h", source=COMPUTED,
    quantity="rate of wrong-side failure of channels and shared parts; check window, and comparison at every braking",
    routes=both_ways(proof_test=DEMAND.value, common=SHARED_PER_HOUR, common_wrong_side=Fraction(1)),
    inputs={"elements": ELEMENTS, "repair": REPAIR, "demand": DEMAND, "common": COMMON},
)  # fmt: skip

rate(
    id="ts7.mttf.parts-list", unit="h", source=COMPUTED,
    quantity="mean time to failure to either side, by the parts list: two channels, or a single shared failure",
    inputs={"elements": ELEMENTS, "repair": REPAIR, "common": COMMON},
    routes={"E10": lambda: mttf(channel_rate(), SHARED_PER_HOUR, A_DAY),
            "Markov chain, exact": lambda: mean_time(chain(channel_rate(), SHARED_PER_HOUR, A_DAY), {FAILED})},
)  # fmt: skip


# --- a second view: the hazard's cut sets ----------------------------------------------------------------------------

HOURS = quantity("10 000 h", "A", "time at risk, without repair or test")


def cut_sets() -> list[tuple[str, ...]]:
    """What leaves the train too fast and without a brake: a shared failure, or two channels silent."""
    silent = {n: [(f"{n}: {one}",) for one in SILENCING] + [tuple(f"{n}: {one}" for one in UNSEEN)] for n in "abc"}
    pairs = (one + other for m, n in combinations("abc", 2) for one, other in product(silent[m], silent[n]))
    return [*((name,) for name in SINGLES), *pairs]


def tree() -> FaultTree:
    """The cut sets as a fault tree."""
    names = dict.fromkeys(name for one in cut_sets() for name in one)
    events = [BasicEvent(n, None, Fraction(component_rate(n)), HOURS.value, INVENTED_COMPONENTS, "A") for n in names]
    return from_cut_sets("overspeed without brake", cut_sets(), events)


def failed(mode: str) -> tuple[Fraction, Fraction]:
    """Probability that a mode has come within the hours, between two ends."""
    return chance(Fraction(COMPONENTS[mode]) * HOURS.value)


def too_fast_and_no_brake(end: int) -> Fraction:
    """The probability in closed form, from the lower (0) or upper (1) ends of the single ones."""
    unseen = math.prod(failed(mode)[end] for mode in UNSEEN)
    silent = 1 - math.prod(1 - failed(mode)[end] for mode in SILENCING) * (1 - unseen)
    two_silent = 3 * silent**2 - 2 * silent**3
    return 1 - math.prod(1 - failed(mode)[end] for mode in SINGLES) * (1 - two_silent)


rate(
    id="ts7.hazard.top-event", unit="1", source="[D] cut sets of ts7_hazards.overspeed_without_brake, rates [A]",
    quantity="probability that the train can run too fast without a brake, within 10 000 h, nothing repaired or tested",
    inputs={"hours": HOURS, "common": COMMON},
    routes={"closed form, two of three": lambda: Enclosure(too_fast_and_no_brake(0), too_fast_and_no_brake(1)),
            "decision diagram of the fault tree": lambda: Enclosure(*map(Fraction, solve(tree()).bounds or ()))},
)  # fmt: skip

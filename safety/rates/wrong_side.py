"""Wrong-side failure of two-out-of-three equipment: how often can it no longer brake the train?

Three channels fail at a constant rate each. A fraction of the failures is dangerous: the channel would never ask for
the brake. The diagnostics show a fraction of these, the diagnostic coverage. Then, in operating hours:

* a shown failure (right-side, or dangerous and detected) isolates the channel, which from then on counts as a vote for
  the brake (TS-7 voting rule (a)) and is exchanged at the repair rate;
* a silent failure leaves a channel that never votes for the brake, until a proof test;
* the brake is released while two of three votes allow it: with two silent channels it always is, a wrong-side failure;
* two isolated channels stop the train; both are exchanged before it runs again, a silent third one stays silent [A];
* the common part fails at its own rate, a fraction of it to the wrong side at once; the rest only stops the train [A];
* a proof test, if any, comes every `proof_test` hours, is perfect, and leaves the equipment as new [A];
* failures are exponential and independent, but for the common part [A]; a silent failure that the next brake demand
  would reveal counts as detected, that is in the coverage [A].

The rate of wrong-side failure is the long-run number of them per operating hour when each is followed by renewal, which
is exactly 1 / (mean time to wrong-side failure from new) [D]. With a proof test every T that mean time is
(integral of S over [0, T]) / (1 - S(T)), where S(t) is the probability of none up to t without a test [D].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import NamedTuple, TypeAlias

from safety.rates.enclosure import INFINITE, Enclosure, Estimate, Extended, reciprocal
from safety.rates.exceptions import RateError
from safety.rates.exponential import transient_by_exponential
from safety.rates.markov import Chain, mean_time
from safety.rates.numeric import Transient, transient
from safety.rates.units import Rational, exact

WRONG_SIDE = "wrong side"
HEALTHY, ISOLATED, SILENT = "his"  # what one channel is; three letters are a state of the equipment


class Coverage(NamedTuple):
    """Diagnostic coverage: the best value and an interval, for instance the confidence interval of a campaign."""

    value: Fraction
    low: Fraction
    high: Fraction

    @classmethod
    def of(cls, value: Rational, low: Rational | None = None, high: Rational | None = None) -> Coverage:
        """Without an interval the value counts as certain. Raises RateError unless 0 <= low <= value <= high <= 1."""
        ends = (value if low is None else low), (value if high is None else high)
        result = cls(exact(value, "coverage"), exact(ends[0], "coverage low"), exact(ends[1], "coverage high"))
        if not result.low <= result.value <= result.high <= 1:
            raise RateError(f"coverage {value} with interval [{ends[0]}, {ends[1]}] is not in order within 0 to 1")
        return result


class Failures(NamedTuple):
    """Rates per hour: shown and silent failures of one channel, wrong-side failures of the common part."""

    shown: Fraction
    silent: Fraction
    common: Fraction


@dataclass(frozen=True, kw_only=True)
class Equipment:
    """What the wrong-side rate depends on: rates per hour, fractions 0 to 1, `proof_test` in hours or None for never.

    Raises NotExact for a float or a negative value, RateError for a fraction above 1 or a test interval of 0.
    """

    channel: Fraction
    dangerous: Fraction
    coverage: Coverage
    repair: Fraction
    common: Fraction = Fraction(0)
    common_wrong_side: Fraction = Fraction(0)
    proof_test: Fraction | None = None

    def __post_init__(self) -> None:
        for name in ("channel", "dangerous", "repair", "common", "common_wrong_side"):
            exact(getattr(self, name), name)
        for name in ("dangerous", "common_wrong_side"):
            if getattr(self, name) > 1:
                raise RateError(f"{name} = {getattr(self, name)} is above 1; it is a fraction of the failures")
        if self.proof_test is not None and exact(self.proof_test, "proof_test") == 0:
            raise RateError("proof_test = 0 h would test all the time; write the interval, or None for never")

    def failures(self, coverage: Fraction) -> Failures:
        """The rates at one value of the coverage."""
        silent = self.channel * self.dangerous * (1 - coverage)
        return Failures(self.channel - silent, silent, self.common * self.common_wrong_side)


def lumped_chain(rates: Failures, repair: Fraction) -> Chain:
    """Chain over what is amiss, one channel as good as another, written by hand; it ends in WRONG_SIDE."""
    shown, silent, common = rates
    return Chain(
        "new",
        {
            ("new", "isolated"): 3 * shown,
            ("new", "silent"): 3 * silent,
            ("new", WRONG_SIDE): common,
            ("isolated", "new"): repair + 2 * shown,  # by exchange, or by the stop after a second isolation
            ("isolated", "both"): 2 * silent,
            ("isolated", WRONG_SIDE): common,
            ("silent", "both"): 2 * shown,
            ("silent", WRONG_SIDE): 2 * silent + common,
            ("both", "silent"): repair + shown,
            ("both", WRONG_SIDE): silent + common,
        },
    )


def channel_chain(rates: Failures, repair: Fraction) -> Chain:
    """Chain over what each single channel is, with the vote taken relay by relay; it ends in WRONG_SIDE."""
    becomes = {HEALTHY: [(ISOLATED, rates.shown), (SILENT, rates.silent)], ISOLATED: [(HEALTHY, repair)], SILENT: []}
    flows: dict[tuple[str, str], Fraction] = {}

    def add(source: str, target: str, rate: Fraction) -> None:
        flows[source, target] = flows.get((source, target), Fraction(0)) + rate

    for channels in map("".join, product(becomes, repeat=3)):
        if _settled(channels) == channels:
            add(channels, WRONG_SIDE, rates.common)
            for i, now in enumerate(channels):
                for later, rate in becomes[now]:
                    add(channels, _settled(channels[:i] + later + channels[i + 1 :]), rate)
    return Chain(3 * HEALTHY, flows)


def _settled(channels: str) -> str:
    """The state in which the train runs on: after the exchange that two isolated channels force, if any."""
    if channels.count(ISOLATED) >= 2:
        return channels.replace(ISOLATED, HEALTHY)
    # Let the train need the brake: healthy channels ask for it and an isolated one counts as asking.
    energised_relays = sum(now == SILENT for now in channels)
    return WRONG_SIDE if energised_relays >= 2 else channels


def closed_form(rates: Failures, repair: Fraction) -> Extended:
    """Mean time to wrong-side failure without proof test, in hours.

    Cramer's rule, first on the two states after a silent failure, then on the two before. Infinite when every failure
    is shown and the common part has no wrong side.
    """
    v, u, k = rates
    if not u and not k:
        return INFINITE
    silent_out, both_out = 2 * v + 2 * u + k, repair + v + u + k
    after = silent_out * both_out - 2 * v * (repair + v)
    from_silent, from_both = (both_out + 2 * v) / after, (silent_out + repair + v) / after
    new_out, isolated_out = 3 * v + 3 * u + k, repair + 2 * v + 2 * u + k
    before = new_out * isolated_out - 3 * v * (repair + 2 * v)
    return ((1 + 3 * u * from_silent) * isolated_out + 3 * v * (1 + 2 * u * from_both)) / before


def mean_time_by_formula(equipment: Equipment) -> Estimate:
    """Mean time to wrong-side failure, hours: the closed form; with a proof test the lumped chain, uniformised."""

    def untested(rates: Failures) -> Extended:
        return closed_form(rates, equipment.repair)

    return _over_coverage(equipment, untested, lumped_chain, transient)


def mean_time_by_channels(equipment: Equipment) -> Estimate:
    """The same in another way: channel by channel, exact; with a proof test a matrix exponential in ball arithmetic."""

    def untested(rates: Failures) -> Extended:
        return mean_time(channel_chain(rates, equipment.repair), {WRONG_SIDE})

    return _over_coverage(equipment, untested, channel_chain, transient_by_exponential)


def rate_by_formula(equipment: Equipment) -> Estimate:
    """Rate of wrong-side failure per operating hour: 1 / mean_time_by_formula."""
    return mean_time_by_formula(equipment).reciprocal()


def rate_by_channels(equipment: Equipment) -> Estimate:
    """Rate of wrong-side failure per operating hour: 1 / mean_time_by_channels."""
    return mean_time_by_channels(equipment).reciprocal()


Solver: TypeAlias = Callable[[Chain, Fraction, dict[str, Fraction]], Transient]


def _over_coverage(
    equipment: Equipment,
    untested: Callable[[Failures], Extended],
    build: Callable[[Failures, Fraction], Chain],
    solve: Solver,
) -> Estimate:
    """The mean time at the coverage and at both ends of its interval.

    It rises with coverage, so the ends are the extremes: a shown failure never leaves less time than a silent one [D].
    """

    def at(coverage: Fraction) -> Enclosure:
        rates = equipment.failures(coverage)
        if equipment.proof_test is None:
            return Enclosure.exactly(untested(rates))
        return _renewed_every(equipment.proof_test, build(rates, equipment.repair), solve)

    found = {coverage: at(coverage) for coverage in set(equipment.coverage)}
    return Estimate(*(found[coverage] for coverage in equipment.coverage))


def _renewed_every(interval: Fraction, chain: Chain, solve: Solver) -> Enclosure:
    """Mean time to wrong-side failure when the equipment is as new after every `interval` hours."""
    if WRONG_SIDE not in chain.reachable(chain.start):
        return Enclosure.exactly(INFINITE)
    running = {state: Fraction(state != WRONG_SIDE) for state in chain.states}
    at_test = solve(chain, interval, running)
    survived, failed = at_test.reward, at_test.probability[WRONG_SIDE]
    return Enclosure(survived.low * reciprocal(failed.high), survived.high * reciprocal(failed.low))

"""Two-out-of-three equipment with a common part in series: mean time to failure, and the rates that meet a target.

Three channels fail at rate `channel` each. The equipment fails when two have failed, or at once with its common part
(rate `common`). A failed channel is exchanged at rate `repair`. All rates per hour and exponential [A], times in hours,
results exact. Source: TS-7 specification, equations E8 to E10; the chain is written from these words, not from them.
"""

from __future__ import annotations

from safety.rates.enclosure import Enclosure, Extended, reciprocal
from safety.rates.inverse import larger_root
from safety.rates.markov import Chain
from safety.rates.units import Rational, exact

FAILED = "failed"


def mttf_first_failure(channel: Rational, common: Rational = 0) -> Extended:
    """1/(3 channel + common): mean time to the first failure of anything, the series reading of a published MTBF."""
    return reciprocal(3 * exact(channel, "channel") + exact(common, "common"))


def mttf_without_repair(channel: Rational) -> Extended:
    """E8: 5/(6 channel)."""
    return 5 * reciprocal(6 * exact(channel, "channel"))


def mttf_with_common_part(channel: Rational, common: Rational) -> Extended:
    """E9: 3/(2 channel + common) - 2/(3 channel + common), no repair."""
    x, c = exact(channel, "channel"), exact(common, "common")
    return 3 / (2 * x + c) - 2 / (3 * x + c) if x or c else reciprocal(c)


def mttf(channel: Rational, common: Rational, repair: Rational) -> Extended:
    """E10: (5 x + m + c) / ((3 x + c)(2 x + c) + m c) with x = channel, c = common, m = repair."""
    x, c, m = exact(channel, "channel"), exact(common, "common"), exact(repair, "repair")
    return (5 * x + m + c) / ((3 * x + c) * (2 * x + c) + m * c) if x or c else reciprocal(c)


def chain(channel: Rational, common: Rational = 0, repair: Rational = 0) -> Chain:
    """The Markov chain of the module's description; it ends in FAILED."""
    x, c, m = exact(channel, "channel"), exact(common, "common"), exact(repair, "repair")
    return Chain(
        "three work",
        {
            ("three work", "two work"): 3 * x,
            ("two work", "three work"): m,
            ("two work", FAILED): 2 * x + c,
            ("three work", FAILED): c,
        },
    )


def channel_rate_for(
    target: Rational, repair: Rational = 0, common: Rational = 0, common_per_channel: Rational = 0
) -> Enclosure:
    """The channel rate whose E10 is `target` h, when the common part fails at common + common_per_channel * channel.

    E10 = target is a quadratic in it; its positive root is enclosed, and exact where rational, as it always is without
    repair and fixed `common`. Raises Unreachable when the common part alone fails too often.
    """
    t, m = exact(target, "target"), exact(repair, "repair")
    c, k = exact(common, "common"), exact(common_per_channel, "common_per_channel")
    square = t * (3 + k) * (2 + k)
    linear = t * ((5 + 2 * k) * c + m * k) - (5 + k)
    return larger_root(square, linear, (c + m) * (t * c - 1), f"a mean time of {target} h")


def common_rate_for(target: Rational, channel: Rational, repair: Rational = 0) -> Enclosure:
    """The common-part rate whose E10 is `target` h: the positive root of a quadratic, enclosed.

    Raises Unreachable when the channels alone fail too often.
    """
    t, x, m = exact(target, "target"), exact(channel, "channel"), exact(repair, "repair")
    return larger_root(t, t * (5 * x + m) - 1, 6 * t * x * x - (5 * x + m), f"a mean time of {target} h")

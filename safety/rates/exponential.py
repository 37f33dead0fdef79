"""Probabilities at a time by the exponential: of one rate by its series, of a chain by its matrix in ball arithmetic.

The matrix (Arb, which certifies every digit) is the second route beside uniformisation; dense, so for chains of up to
a hundred states or so. Rates per hour, times in hours.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from safety.rates.enclosure import Enclosure
from safety.rates.exceptions import NumericsFailed
from safety.rates.markov import Chain
from safety.rates.numeric import Transient
from safety.rates.units import Rational, exact

MOST_STATES = 200
LONGEST = 4096  # bits of the denominator of a result
TERMS = 12  # of the series: at most 1/12! = 2e-9 wide


def chance(x: Fraction) -> tuple[Fraction, Fraction]:
    """1 - exp(-x), the probability of what has x = rate x time, between two partial sums of its alternating series.

    For x of 0..1, where the terms fall; raises NumericsFailed beyond.
    """
    if not 0 <= x <= 1:
        raise NumericsFailed(f"the series is for a rate x time of 0..1, not {float(x):.3g}; take a shorter time")
    total, before, term = Fraction(0), Fraction(0), Fraction(-1)
    for k in range(1, TERMS + 1):
        term *= -x / k
        total, before = total + term, total
    return min(total, before), max(total, before)


def transient_by_exponential(
    chain: Chain, time: Rational, reward: Mapping[str, Rational] | None = None, bits: int = 512
) -> Transient:
    """What numeric.transient gives, by exp([[Q, reward], [0, 0]] time) with `bits` of working precision.

    Raises ChainError, NotExact, and NumericsFailed above MOST_STATES states or when a ball comes out infinite.
    """
    import flint

    reward, size = reward or {}, len(chain.states)
    chain.check(*reward)
    if size > MOST_STATES:
        raise NumericsFailed(
            f"{size} states are too many for a dense exponential (at most {MOST_STATES}); use numeric.transient"
        )
    end, index = exact(time, "time"), {s: i for i, s in enumerate(chain.states)}

    def ball(value: Fraction) -> Any:
        return flint.arb(flint.fmpq(value.numerator, value.denominator))

    with flint.ctx.workprec(bits):
        matrix = flint.arb_mat(size + 1, size + 1)
        for (source, target), rate in chain.rates.items():
            matrix[index[source], index[target]] = ball(rate * end)
        for state, i in index.items():
            matrix[i, i] = ball(-chain.exit_rate(state) * end)
            matrix[i, size] = ball(exact(reward.get(state, 0), f"reward of {state!r}") * end)
        result, start = matrix.exp(), index[chain.start]
        row = [result[start, column] for column in range(size + 1)]
        if not all(x.is_finite() for x in row):
            raise NumericsFailed(f"{bits} bits are too few for this chain over {float(end):.3g} h; give more bits")
        *states, total = [Enclosure(_end(x.lower(), 0), _end(x.upper(), 1)) for x in row]
    return Transient(dict(zip(chain.states, states, strict=True)), total)


def _end(x: Any, up: int) -> Fraction:
    """One end of a ball as a Fraction; not below 0, since neither a probability nor a reward is.

    What is smaller than 2**-LONGEST becomes 0, or 2**-LONGEST for the upper end: exp(-1e9) has a billion digits.
    """
    mantissa, exponent = (int(part) for part in x.man_exp())
    if mantissa <= 0:
        return Fraction(0)
    if mantissa.bit_length() + exponent < -LONGEST:
        return Fraction(up, 2**LONGEST)
    return Fraction(mantissa) * Fraction(2) ** exponent

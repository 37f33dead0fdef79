"""Trees whose events have rates, for the tests of what happens over time, and their sums over every state."""

import itertools
from dataclasses import replace
from fractions import Fraction

from flint import arb, fmpq

from safety.trees import BasicEvent, FaultTree, Gate
from safety.trees.expressions.expression import MissionTime
from tests.trees.random_trees import random_tree

L, M, T = Fraction(1, 10**4), Fraction(1, 10), MissionTime()


def voted(k, laws, time=8760):
    """Top if k of the events with these expressions occur."""
    names = tuple(f"e{i}" for i in range(len(laws)))
    events = tuple(BasicEvent(name, expression=law) for name, law in zip(names, laws, strict=True))
    return FaultTree("voted", "top", (Gate("top", "vote", names, k),), events, mission_time_h=time)


def inside(exact, bounds):
    """Whether a rational or a ball lies within, and the bounds are narrow."""
    low, high = map(Fraction, bounds)
    if not isinstance(exact, Fraction):
        exact, wide = (Fraction(*map(int, fmpq_of(end))) for end in (exact.mid(), exact.rad()))
        low, high = low + wide, high - wide
    return low <= exact <= high and high - low <= Fraction(1, 10**9) * abs(high)


def fmpq_of(x):
    mantissa, exponent = x.man_exp()
    value = Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    return value.as_integer_ratio()


def rated(seed, **more):
    """A random coherent tree some events of which have rates."""
    tree = random_tree(seed, events=6, coherent=True)
    events = tuple(
        event if n % 3 == 2 else BasicEvent(event.name, rate_per_hour=Fraction(3 * n + 1, 10 ** (3 + n)))
        for n, event in enumerate(tree.events)
    )
    return replace(tree, events=events, mission_time_h=Fraction(5000), **more)


def expansion(tree):
    """Q(t) as {rate: coefficient}, over all states."""
    total = {}
    for flags in itertools.product((False, True), repeat=len(tree.events)):
        if not tree.occurs({event.name for event, flag in zip(tree.events, flags, strict=True) if flag}):
            continue
        terms = {Fraction(0): Fraction(1)}
        for event, failed in zip(tree.events, flags, strict=True):
            if event.probability is not None:
                factor = {Fraction(0): event.probability if failed else 1 - event.probability}
            elif failed:
                factor = {Fraction(0): Fraction(1), event.rate_per_hour: Fraction(-1)} if event.rate_per_hour else {}
            else:
                factor = {event.rate_per_hour: Fraction(1)}
            new = {}
            for (a, c), (b, d) in itertools.product(terms.items(), factor.items()):
                new[a + b] = new.get(a + b, 0) + c * d
            terms = new
        for rate, c in terms.items():
            total[rate] = total.get(rate, 0) + c
    return {rate: c for rate, c in total.items() if c}


def ball(x):
    return arb(fmpq(x.numerator, x.denominator))

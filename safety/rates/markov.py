"""Continuous-time Markov chains with exact rates: mean times, long-run probabilities, event frequencies.

All results here are exact rationals, by elimination without a subtraction (Grassmann, Taksar, Heyman 1985).
`numeric` reaches mean times in another way, and probabilities at a time. Rates are per hour and times in hours,
or any other unit and its inverse. Chains of a few thousand sparsely linked states take seconds.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from difflib import get_close_matches
from fractions import Fraction
from typing import Any

from safety.rates.enclosure import INFINITE, Extended
from safety.rates.exceptions import ChainError, NotErgodic
from safety.rates.units import Rational, exact


class Chain:
    """A finite chain: `rates[source, target]` is the transition rate, `start` the state at time 0.

    Rates are Fractions, ints or decimal texts; 0 means no transition. `states` may be given, to fix the order and
    to catch a misspelt name; without it they are those that occur. `out[source][target]` holds the positive rates.
    Raises ChainError (unknown or repeated state, self loop) and NotExact (float, negative rate).

    >>> unit = Chain("up", {("up", "down"): "1e-4", ("down", "up"): "0.1"})
    >>> availability(unit, {"up"})
    Fraction(1000, 1001)
    """

    def __init__(self, start: str, rates: Mapping[tuple[str, str], Rational], states: Iterable[str] = ()) -> None:
        named = dict.fromkeys([start, *(state for pair in rates for state in pair)])
        self.start = start
        self.states: tuple[str, ...] = tuple(states) or tuple(named)
        self.rates: dict[tuple[str, str], Fraction] = {}
        self.out: dict[str, dict[str, Fraction]] = {state: {} for state in self.states}
        if len(self.out) < len(self.states):
            twice = next(s for s in self.states if self.states.count(s) > 1)
            raise ChainError(f"state {twice!r} is given twice; name every state once")
        self.check(*named)
        for (source, target), value in rates.items():
            if source == target:
                raise ChainError(f"{source!r} -> {source!r} is a self loop; it means nothing here, leave it out")
            rate = exact(value, f"rate {source!r} -> {target!r}")
            if rate:
                self.rates[source, target] = self.out[source][target] = rate

    def check(self, *states: str) -> None:
        """Raises ChainError, with the nearest known name, when one of `states` does not exist."""
        for state in states:
            if state not in self.out:
                near = get_close_matches(str(state), self.states, n=1)
                hint = f"did you mean {near[0]!r}?" if near else f"its first states are {', '.join(self.states[:5])}"
                raise ChainError(f"no state {state!r} in this chain; {hint}")

    def exit_rate(self, state: str) -> Fraction:
        """Sum of the rates out of `state`: 1 / its mean holding time."""
        return sum(self.out[state].values(), Fraction(0))

    def reachable(self, source: str, avoiding: Collection[str] = ()) -> set[str]:
        """States that can follow `source`, itself included; none in `avoiding` is entered."""
        return _closure([source], {s: [t for t in out if t not in avoiding] for s, out in self.out.items()})

    def can_reach(self, targets: Collection[str]) -> set[str]:
        """States from which some state of `targets` can be reached, `targets` included."""
        back: dict[str, list[str]] = {state: [] for state in self.states}
        for source, target in self.rates:
            back[target].append(source)
        return _closure(targets, back)

    def transient(self, until: Collection[str]) -> list[str] | None:
        """The states that can be seen before `until` is entered; None when it may never be entered.

        Raises ChainError when `until` is empty or names an unknown state.
        """
        if not until:
            raise ChainError("the set of target states is empty; name at least one state")
        self.check(*until)
        if self.start in until:
            return []
        seen = self.reachable(self.start, avoiding=until)
        return [s for s in self.states if s in seen] if seen <= self.can_reach(until) else None


def mean_time(chain: Chain, until: Collection[str]) -> Extended:
    """Mean time from the start until `until` is entered: infinite when that is not certain, 0 when it starts there."""
    return mean_reward(chain, until, dict.fromkeys(chain.states, Fraction(1)))


def mean_reward(chain: Chain, until: Collection[str], reward: Mapping[str, Rational]) -> Extended:
    """Mean of the integral of `reward[state]` (>= 0; 0 where not named) over time until `until` is entered.

    Infinite when entering is not certain. Raises ChainError for an unknown state, NotExact for a negative reward.
    """
    chain.check(*reward)
    states = chain.transient(until)
    if states is None:
        return INFINITE
    if not states:
        return Fraction(0)
    earned = {s: _fast(exact(reward.get(s, 0), f"reward of {s!r}")) for s in states}
    out = _copy(chain, states)
    for state, arriving, total in _eliminate(out, keep=chain.start):
        for source, rate in arriving.items():
            earned[source] += rate * earned[state] / total
    return _fraction(earned[chain.start] / sum(out[chain.start].values()))


def probability_before(chain: Chain, wanted: Collection[str], other: Collection[str] = ()) -> Fraction:
    """Probability that `wanted` is ever entered, and not after `other`. Raises ChainError for an unknown state."""
    chain.check(*wanted, *other)
    if chain.start in wanted:
        return Fraction(1)
    hopeless = set(chain.states) - chain.can_reach(wanted)
    entering = {s: sum((rate for t, rate in out.items() if t in wanted), Fraction(0)) for s, out in chain.out.items()}
    result = mean_reward(chain, {*wanted, *other, *hopeless}, entering)
    assert isinstance(result, Fraction), "every state left can reach the wanted ones, so the end is certain"
    return result


def steady_state(chain: Chain) -> dict[str, Fraction]:
    """Long-run probability of every state.

    Raises NotErgodic when it depends on chance in which part of the chain the process ends.
    """
    closed = _closed_class(chain)
    anchor = next(s for s in chain.states if s in closed)
    weight = {anchor: _fast(Fraction(1))}
    out = _copy(chain, [s for s in chain.states if s in closed])
    for state, arriving, total in reversed(list(_eliminate(out, keep=anchor))):
        weight[state] = sum(weight[source] * rate for source, rate in arriving.items()) / total
    whole = sum(weight.values())
    return {s: _fraction(weight[s] / whole) if s in weight else Fraction(0) for s in chain.states}


def availability(chain: Chain, up: Collection[str]) -> Fraction:
    """Long-run share of time in the states `up`. Raises as steady_state does, and ChainError for an unknown state."""
    chain.check(*up)
    long_run = steady_state(chain)
    return sum((long_run[s] for s in set(up)), Fraction(0))


def entry_frequency(chain: Chain, into: Collection[str]) -> Fraction:
    """Long-run number of entries into the set `into` per hour: the hazard rate of repaired equipment.

    Raises as steady_state does, and ChainError for an unknown state.
    """
    chain.check(*into)
    long_run = steady_state(chain)
    entries = (long_run[s] * rate for (s, t), rate in chain.rates.items() if t in into and s not in into)
    return sum(entries, Fraction(0))


def _closure(sources: Collection[str], follow: Mapping[str, Iterable[str]]) -> set[str]:
    found, todo = set(sources), list(sources)
    while todo:
        new = {t for t in follow[todo.pop()] if t not in found}
        found |= new
        todo += new
    return found


def _closed_class(chain: Chain) -> set[str]:
    """The one set of states that the process ends in and never leaves."""
    state = chain.start
    while True:
        ahead = chain.reachable(state)
        no_return = ahead - chain.can_reach({state})
        if not no_return:
            break
        state = min(no_return)
    elsewhere = chain.reachable(chain.start) - chain.can_reach({state})
    if elsewhere:
        raise NotErgodic(
            f"from {chain.start!r} the chain may end in {min(ahead)!r} or in {min(elsewhere)!r}, so "
            f"there is no one long-run state; add the missing repair, or ask for a mean time"
        )
    return ahead


Flows = dict[str, dict[str, Any]]


def _copy(chain: Chain, states: list[str]) -> Flows:
    return {s: {t: _fast(rate) for t, rate in chain.out[s].items()} for s in states}


def _eliminate(out: Flows, keep: str) -> Iterator[tuple[str, dict[str, Any], Any]]:
    """Removes the states of `out` one by one, except `keep`, redirecting the flow past each; changes `out` in place.

    Yields (state, rates into it, sum of rates out of it) as they stood on its removal. Least fill-in goes first.
    """
    into: Flows = {s: {} for s in out}
    for source, targets in out.items():
        for target, rate in targets.items():
            if target in into:
                into[target][source] = rate
    left = set(out) - {keep}
    while left:
        state = min(left, key=lambda s: (len(into[s]) * len(out[s]), s))
        left.remove(state)
        arriving, leaving = into.pop(state), out.pop(state)
        total = sum(leaving.values())
        for target in leaving.keys() & into.keys():
            del into[target][state]
        for source, rate in arriving.items():
            flows = out[source]
            del flows[state]
            for target, onward in leaving.items():
                if target != source:
                    flows[target] = flows.get(target, 0) + rate * onward / total
                    if target in into:
                        into[target][source] = flows[target]
        yield state, arriving, total


def _fast(value: Fraction) -> Any:
    """The same rational in FLINT, whose arithmetic on long numbers is far faster than that of fractions.Fraction."""
    from flint import fmpq

    return fmpq(value.numerator, value.denominator)


def _fraction(value: Any) -> Fraction:
    return Fraction(int(value.p), int(value.q))

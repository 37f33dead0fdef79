"""The race behind a response: the potential that every step raises, and the set of states from which it is decided.

Where pulses are carried from register to register, one whole-number combination of the registers is free of all of
them: the *potential* changes by what flows in alone.  While that flow has a least value above 0, the latch that was set
can let go only below some potential; latched and above it, it stays so.  That set is *held*: once in it, always in it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import gcd
from typing import cast

from safety.prove.extremes import Extremes, NotFound
from safety.prove.flows import Reader, Sum, added, as_int, is_whole, whole
from safety.prove.problem import Problem
from safety.system import State, System
from safety.terms import Bit, Int
from safety.terms.graph import BIT, Term, variables

MOST = 60  # registers that a conclusion may depend on


@dataclass(frozen=True)
class Race:
    """`weights` (by uid of the register) make the potential; a step changes it by `flow`, by `least` or more.

    `held` is closed under steps, by what a solver said: it is still to be confirmed.
    """

    weights: Mapping[int, int]
    flow: Sum
    least: int
    held: Bit


def reached(system: System, roots: Iterable[Term]) -> list[State]:
    """The registers that the roots depend on, at this step or through earlier ones."""
    found: dict[int, State] = {}
    edge = variables(roots)
    for v in edge:  # grows while it is walked
        state = system.state.get(str(v.attr))
        if state is not None and state.var is v and v.uid not in found:
            found[v.uid] = state
            edge += variables([state.next])
        if len(found) > MOST:
            raise NotFound(f"the conclusion depends on more than {MOST} registers")
    return list(found.values())


def changes(reader: Reader, states: Sequence[State]) -> dict[int, Sum]:
    """What a step adds to each register, where that is a sum of inputs and bits."""
    found: dict[int, Sum] = {}
    for s in states:
        if is_whole(s.var):
            change = added(reader(s.next), reader(s.var), -1)
            numbers = [n for _, n in change if n is not None]
            if change and all(is_whole(reader.names[n]) and not reader.inner(n) for n in numbers):
                found[s.var.uid] = change
    return found


def conserved(change: Mapping[int, Sum]) -> list[dict[int, int]]:
    """Whole-number combinations of registers that are free of every carry: the null space of the carries' columns."""
    from flint import fmpz_mat

    carries = sorted({p for total in change.values() for p in total if p[0]}, key=lambda p: (sorted(p[0]), p[1] or -1))
    if not carries or not change:
        return []
    basis, rank = fmpz_mat([[total.get(p, 0) for total in change.values()] for p in carries]).nullspace()
    vectors = fmpz_mat([[int(basis[i, j]) for i in range(len(change))] for j in range(rank)]) if rank else None
    return [] if vectors is None else [_primitive(change, row) for row in vectors.lll().tolist()]


def _primitive(change: Mapping[int, Sum], row: Sequence[object]) -> dict[int, int]:
    numbers = [int(cast(int, c)) for c in row]
    divisor = gcd(*numbers)
    return {uid: c // divisor for uid, c in zip(change, numbers, strict=True) if c}


def combined(change: Mapping[int, Sum], weights: Mapping[int, int]) -> Sum:
    """What a step adds to a combination of registers."""
    total: Sum = {}
    for uid, c in weights.items():
        total = added(total, change[uid], c)
    return total


def value(reader: Reader, weights: Mapping[int, int]) -> Int:
    """A combination of registers as a term."""
    total = whole(0)
    for uid, c in weights.items():
        total = total + as_int(reader.names[uid]) * c
    return total


def races(
    problem: Problem,
    reader: Reader,
    change: Mapping[int, Sum],
    base: Sequence[Bit],
    latches: Sequence[Bit],
    timeout: float,
) -> Iterator[Race]:
    """Each potential that rises while `base` holds, with the states of each latch that it then never lets go."""
    while_base = Extremes(problem, [(0, base)], timeout)
    for weights in conserved(change):
        flow = combined(change, weights)
        for sign in (1, -1):
            rising = {uid: sign * c for uid, c in weights.items()}
            flowing = {product: sign * c for product, c in flow.items()}
            least = while_base.least(reader.term(flowing))
            if least > 0:
                for latch in latches:
                    for latched in (latch, ~latch):
                        held = _held(problem, value(reader, rising), base, latched, timeout)
                        yield Race(rising, flowing, least, held)


def _held(problem: Problem, potential: Int, base: Sequence[Bit], latched: Bit, timeout: float) -> Bit:
    """Latched, and the potential above all at which a step lets go."""
    lets_go = Extremes(problem, [(0, [*base, latched]), (1, [~latched])], timeout)
    if not lets_go.possible:
        return latched
    return latched & (potential >= lets_go.greatest(potential, 1) + 1)


def is_latch(s: State) -> bool:
    """Whether a register is a bit that can change."""
    return s.var.sort == BIT and s.next is not s.var

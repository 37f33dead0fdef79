"""Facts of one step that can be summed over many: how registers move, within which ranges, and what flows into them.

They are looked up with one solver, outside what a race holds; every solver has to confirm them afterwards.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from safety.prove.closed_form import Accumulator, ClosedForm
from safety.prove.extremes import Extremes, NotFound
from safety.prove.flows import Reader, Sum, added, as_int, is_whole
from safety.prove.problem import Problem
from safety.prove.race import Race
from safety.system import State
from safety.terms import Bit
from safety.terms.graph import Term, variables


@dataclass
class StepFacts:
    """A closed form, and what it rests on: `always` of every step outside `held`, `moves` where the next is too."""

    form: ClosedForm
    always: list[Bit] = field(default_factory=list)
    moves: list[Bit] = field(default_factory=list)


def same_inputs(problem: Problem, states: Sequence[State], base: Sequence[Bit], timeout: float) -> dict[int, Term]:
    """For each number among the inputs (by uid) the first that has the same value while `base` holds."""
    look = Extremes(problem, [(0, base)], timeout)
    read = {v.uid for v in variables([s.next for s in states])}
    inputs = [v for v in problem.system.inputs.values() if v.uid in read and is_whole(v)]
    first: dict[int, Term] = {}
    for v in inputs:
        others = (w for w in inputs if first.get(w.uid) is w and w.sort == v.sort)
        first[v.uid] = next((w for w in others if look.holds(as_int(v) == as_int(w))), v)
    return first


def step_facts(
    problem: Problem, race: Race, reader: Reader, change: Mapping[int, Sum], base: Sequence[Bit], steps: int,
    timeout: float,
) -> StepFacts:  # fmt: skip
    """The facts of steps with `base` outside what the race holds, for `steps` of them in a row.

    Raises `NotFound` where a register of the race is not bounded by what flows into it.
    """
    look = Extremes(problem, [(0, base)], timeout)
    numbers: dict[int, tuple[int, int]] = {}
    always = [reader.term(race.flow) >= race.least]
    for n in sorted({n for uid in race.weights for _, n in change[uid] if n is not None}):
        x = as_int(reader.names[n])
        low, high = numbers[n] = look.least(x), look.greatest(x)
        always += [x >= low, x <= high]
    steady = {n: kept for n in numbers if (kept := _kept(problem, reader.names[n], look)) is not None}
    found = StepFacts(ClosedForm(steps, (), numbers, (), frozenset()), [*always, *steady.values()])
    outside = [*base, ~race.held]
    here, next_too = (Extremes(problem, [(0, outside), *more], timeout) for more in ((), [(1, [~race.held])]))
    registers = [s for s in problem.system.states if s.var.uid in race.weights]
    each = [_accumulator(reader, s, change[s.var.uid], steady, here, next_too, found) for s in registers]
    found.form = ClosedForm(steps, tuple(_chained(each)), numbers, ((race.flow, race.least),), frozenset(steady))
    return found


def _kept(problem: Problem, number: Term, look: Extremes) -> Bit | None:
    """That an input is what it was at the step before, by a register that remembers it; None where that is not so."""
    inputs = {v.uid for v in problem.system.inputs.values()}
    for s in problem.system.states:
        if s.next.uid in inputs and s.next.sort == number.sort:
            kept = (as_int(s.var) == as_int(number)) & (as_int(s.next) == as_int(number))
            if look.holds(kept):
                return kept
    return None


def _accumulator(
    reader: Reader, s: State, change: Sum, steady: Mapping[int, Bit], here: Extremes, next_too: Extremes,
    found: StepFacts,
) -> Accumulator:  # fmt: skip
    """A register as an accumulator; what has to be shown of it is added to the facts found."""
    x, then = as_int(s.var), as_int(s.next)
    reached = x + reader.term(change)
    relations = {"==": then == reached, ">=": then >= reached, "<=": then <= reached}
    relation = next((sign for sign, holds in relations.items() if next_too.holds(holds)), None)
    if relation is None:
        raise NotFound(f"{s.path} is not bounded by what flows into it")
    low, high = here.least(x), here.greatest(x)
    found.moves.append(relations[relation])
    found.always += [x >= low, x <= high]
    below: list[tuple[int, int]] = []
    for (bits, n), c in change.items():
        if bits and n is not None and n in steady and c < 0:
            limit = x < as_int(reader.names[n]) * -c
            if here.holds(limit):
                below.append((-c, n))
                found.always.append(limit)
    return Accumulator({s.var.uid: 1}, change, relation, low, high, tuple(below))


def _chained(found: list[Accumulator]) -> list[Accumulator]:
    """Accumulators of which one only counts the wraps of another taken together, as digits of one number."""
    for x in found:
        modulus = x.high + 1
        for (bits, number), c in x.change.items():
            users = [y for y in found if any(bits & others for others, _ in y.change)]
            wraps = len(bits) == 1 and number is None and c == -modulus and x.low == 0
            if wraps and len(users) == 2 and all(y.relation == "==" for y in users):
                (y,) = (y for y in users if y is not x)
                if y.change.get((bits, number)) == 1:
                    weights = {**x.weights, **{uid: modulus * w for uid, w in y.weights.items()}}
                    change = added(x.change, y.change, modulus)
                    one = Accumulator(weights, change, "==", modulus * y.low, x.high + modulus * y.high)
                    return _chained([one if z is x else z for z in found if z is not y])
    return found

"""One compiled step on lanes: a frame of model steps, with masks and presence of faults as lane arrays.

What depends on the faults only (a masked constant, say) is computed once per change of the faults, not once per step;
what no observed wire depends on is left out.  A kernel of another kind needs the same attributes and functions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

from safety.faults import Fault, Faulted, instrument
from safety.inject.masks import masked, without_points
from safety.system import ANY, State, System, repeat, substitute
from safety.terms import Bit, UInt, all_of, select
from safety.terms.graph import Term, node, postorder, rewrite, uint, variable, variables
from safety.terms.texts import compile_lanes
from safety.terms.values import const

COUNTER = uint(40)
BROKEN = "broken assumptions"  # name of the counter of steps at which one is

LaneFunction = Callable[..., tuple[Any, ...]]


@dataclass(frozen=True)
class Kernel:
    """A compiled frame.

    `step(*states, *inputs, *prologue(*faults))` gives the next states; `faults` are the terms that hold masks and
    presence, `counters` says which of the states counts which observed wire,
    `constant` which of them are plain numbers after a step.
    """

    states: tuple[State, ...]
    inputs: tuple[Term, ...]
    faults: tuple[Term, ...]
    counters: Mapping[str, int]
    constant: tuple[int, ...]
    prologue: LaneFunction
    step: LaneFunction
    faulted: Faulted


def build_kernel(
    system: System, observe: Sequence[str], points: Iterable[str], faults: Sequence[Fault] = (), steps: int = 1
) -> Kernel:
    """Compile a system with masks at `points`, and `faults` built in one by one, `steps` model steps at a time.

    `observe` names the wires to count, as they are at the last step of each frame.
    """
    faulted = instrument(system, faults, present=None)
    carried = masked(faulted.system, points)
    held = [term for pair in carried.variables.values() for term in pair]
    present = [cast(Term, there) for there in faulted.present]
    whole = folded(carried.system.mapped(without_points), steps)
    whole, counters = _counting(whole, observe)
    states = [s for s in live_states(whole.states, counters) if s.var not in _Terms(present)]
    first, names, rest = hoisted([s.next for s in states], [*held, *present])
    inputs = tuple(whole.inputs.values())
    positions = {s.var.uid: i for i, s in enumerate(states)}
    return Kernel(
        states=tuple(states),
        inputs=inputs,
        faults=(*held, *present),
        counters={name: positions[var.uid] for name, var in counters.items()},
        constant=tuple(i for i, t in enumerate(rest) if t.is_const),
        prologue=compile_lanes([*held, *present], first),
        step=compile_lanes([*(s.var for s in states), *inputs, *names], rest),
        faulted=faulted,
    )


class _Terms:
    """A set of terms by identity: `==` between terms is a term, not an answer."""

    def __init__(self, terms: Iterable[Term]) -> None:
        self.uids = {t.uid for t in terms}

    def __contains__(self, term: object) -> bool:
        return isinstance(term, Term) and term.uid in self.uids


def _counting(system: System, observe: Sequence[str]) -> tuple[System, dict[str, Term]]:
    """A counter for each observed wire, and for broken assumptions, of the frames at whose end it is true."""
    assumed = all_of(*(cast(Bit, a) for a in system.assumptions.values()))
    watched = {name: cast(Bit, system.lookup(name)) for name in observe} | {BROKEN: ~assumed}
    counters: dict[str, Term] = {}
    states = list(system.states)
    for name, wire in watched.items():
        counter = cast(UInt, variable(f"count of {name}", COUNTER))
        counters[name] = counter
        states.append(State(counter, select(wire, (counter + 1).low(COUNTER.width), counter), 0))
    return replace(system, states=tuple(states)), counters


def folded(system: System, steps: int) -> System:
    """`steps` steps as one; registers that then stand at their power-up value again become constants.

    Such a register (a bit-time counter, for instance) is constant at each start, by induction from power-up.
    """
    whole = repeat(system, steps) if steps > 1 else system
    fixed = _returning(whole.states)
    values = {s.var.uid: const(cast(Any, s.power_up), s.var.sort) for s in fixed}
    kept = tuple(s for s in whole.states if s.var.uid not in values)
    return replace(whole, states=kept).mapped(lambda roots: substitute(roots, values))


def _returning(states: Sequence[State]) -> list[State]:
    """The largest set of registers that are back at power-up if all of them stood there before."""
    fixed = [s for s in states if s.power_up is not ANY]
    while True:
        values = {s.var.uid: const(cast(Any, s.power_up), s.var.sort) for s in fixed}
        nexts = substitute([s.next for s in fixed], values)
        back = [s for s, following in zip(fixed, nexts, strict=True) if following is values[s.var.uid]]
        if len(back) == len(fixed):
            return fixed
        fixed = back


def live_states(states: Sequence[State], counters: Mapping[str, Term]) -> list[State]:
    """The registers that some counter depends on, now or later."""
    following = {s.var.uid: s for s in states}
    todo = [c.uid for c in counters.values()]
    found: set[int] = set()
    while todo:
        uid = todo.pop()
        if uid in following and uid not in found:
            found.add(uid)
            todo += [v.uid for v in variables([following[uid].next])]
    return [s for s in states if s.var.uid in found]


def hoisted(roots: Sequence[Term], rigid: Iterable[Term]) -> tuple[list[Term], list[Term], list[Term]]:
    """Terms over rigid variables only, the names that stand for them, and the roots written with these names."""
    constant = {t.uid for t in rigid}
    rests: set[int] = set()  # of rigid variables and constants only, with at least one variable
    taken: dict[int, Term] = {}
    order = postorder(roots)
    for term in order:
        if term.uid in constant or (term.args and all(a.uid in rests or a.is_const for a in term.args)):
            rests.add(term.uid)
        else:
            taken |= {a.uid: a for a in term.args if a.uid in rests}
    taken |= {r.uid: r for r in roots if r.uid in rests}
    names = {uid: variable(f"hoisted {uid}", t.sort) for uid, t in taken.items()}

    def rule(old: Term, args: tuple[Term, ...]) -> Term:
        return names[old.uid] if old.uid in names else node(old.op, args, old.attr, old.sort) if old.args else old

    return list(taken.values()), list(names.values()), rewrite(roots, rule)

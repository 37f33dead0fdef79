"""One compiled step on lanes: a frame of model steps, with masks and presence of faults as lane arrays.

What depends on the faults only (a masked constant, say) is computed once per change of the faults, not once per step;
what no observed wire depends on is left out.  A kernel of another kind needs the same attributes and functions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

from safety.faults import INTERMITTENT, Fault, Faulted, instrument, now_name
from safety.inject.masks import masked, without_points
from safety.system import ANY, State, System, repeat, substitute
from safety.terms import Bit, UInt, all_of, select
from safety.terms.graph import BIT, Term, node, postorder, rewrite, uint, variable, variables
from safety.terms.texts import compile_lanes
from safety.terms.values import const

COUNTER = uint(40)
BROKEN = "broken assumptions"  # name of the counter of steps at which one is

LaneFunction = Callable[..., tuple[Any, ...]]


@dataclass(frozen=True)
class Kernel:
    """A compiled frame.

    `step(*states, *inputs, *prologue(*faults))` gives the next states; `faults` are the terms that hold masks, and for
    each fault built in whether it acts.  `counters` says which of the states counts the true frames of a wire, and
    `waits` which pair counts the frames before its first true one, and says whether that came; `constant`: which of the
    states are plain numbers after a step.
    """

    states: tuple[State, ...]
    inputs: tuple[Term, ...]
    faults: tuple[Term, ...]
    counters: Mapping[str, int]
    waits: Mapping[str, tuple[int, int]]
    constant: tuple[int, ...]
    prologue: LaneFunction
    step: LaneFunction
    faulted: Faulted


def build_kernel(
    system: System,
    count: Sequence[str],
    watch: Sequence[str],
    points: Iterable[str],
    faults: Sequence[Fault] = (),
    steps: int = 1,
) -> Kernel:
    """Compile a system with masks at `points`, and `faults` built in one by one, `steps` model steps at a time.

    `count` and `watch` name wires, looked at at the last step of each frame.
    """
    faulted = instrument(system, [replace(fault, onset=INTERMITTENT, at=0, ticks=None) for fault in faults])
    carried = masked(faulted.system, points)
    acting = {name: carried.system.inputs[name] for name in map(now_name, range(len(faults)))}
    held = [*(term for pair in carried.variables.values() for term in pair), *acting.values()]
    whole = replace(carried.system, inputs={n: t for n, t in carried.system.inputs.items() if n not in acting})
    whole = folded(whole.mapped(without_points), steps)
    whole, counters = _counting(whole, count)
    whole, waits = _watching(whole, watch)
    needed = [*counters.values(), *(var for pair in waits.values() for var in pair)]
    states = live_states(whole.states, needed)
    first, names, rest = hoisted([s.next for s in states], held)
    inputs = tuple(whole.inputs.values())
    positions = {s.var.uid: i for i, s in enumerate(states)}
    return Kernel(
        states=tuple(states),
        inputs=inputs,
        faults=tuple(held),
        counters={name: positions[var.uid] for name, var in counters.items()},
        waits={name: (positions[wait.uid], positions[met.uid]) for name, (wait, met) in waits.items()},
        constant=tuple(i for i, t in enumerate(rest) if t.is_const),
        prologue=compile_lanes(held, first),
        step=compile_lanes([*(s.var for s in states), *inputs, *names], rest),
        faulted=faulted,
    )


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


def _watching(system: System, watch: Sequence[str]) -> tuple[System, dict[str, tuple[Term, Term]]]:
    """For each watched wire a counter of the frames before the first at whose end it is true, and whether that came."""
    waits: dict[str, tuple[Term, Term]] = {}
    states = list(system.states)
    for name in watch:
        wait = cast(UInt, variable(f"frames before {name}", COUNTER))
        met = cast(Bit, variable(f"{name} came", BIT))
        now = met | cast(Bit, system.lookup(name))
        states += [State(wait, select(now, wait, (wait + 1).low(COUNTER.width)), 0), State(met, now, False)]
        waits[name] = wait, met
    return replace(system, states=tuple(states)), waits


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


def live_states(states: Sequence[State], needed: Iterable[Term]) -> list[State]:
    """The registers that some of these depends on, now or later."""
    following = {s.var.uid: s for s in states}
    todo = [var.uid for var in needed]
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

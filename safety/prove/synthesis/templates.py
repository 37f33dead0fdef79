"""Templates: what is worth guessing about registers that are read together.

Clauses: one atom entails another (ends of counters, latches, mutual exclusion).  Bounds: a form under a guard.
Rates: while something persists, a form runs ahead of the time that it has persisted, or of a sum.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import gcd
from typing import TYPE_CHECKING, Any, cast

from safety.prove.flows import as_int, is_whole
from safety.prove.problem import Problem
from safety.prove.synthesis.candidates import Candidate
from safety.prove.synthesis.conserved import Form, jumps
from safety.prove.synthesis.houdini import Pruner
from safety.prove.synthesis.sampling import Rows, Steps, constants_of, evaluate
from safety.system import State
from safety.terms import Bit, Int
from safety.terms.graph import Term, postorder, variables
from safety.terms.values import any_of, bit, select

if TYPE_CHECKING:
    import numpy.typing as npt

    Lanes = npt.NDArray[Any]

FEW = 8  # values of a register all of which are atoms
SMALL = 16  # values of a register each of which is an atom of its own
MOST_NODES = 12  # of a condition of the model that is taken for an atom
SLOW = 8  # steps at least that a fall at a rate takes through the range of a register
WIDEST = 3  # guards of a rate that are tried, those that hold most often first
SELDOM = 0.1  # share of steps in which a form may fall and yet have a lower bound
TRUE = bit(True)


class Neighbourhood:
    """Which registers are read together, and which faults reach them."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.states = {s.var.uid: s for s in problem.system.states}
        self.members = {
            uid: {uid} | {v.uid for v in variables([s.next]) if v.uid in self.states}
            for uid, s in self.states.items()
            if s.next is not s.var
        }
        self.faults = [{v.uid for v in variables([a])} for a in problem.faulted.active]

    def near(self, registers: Iterable[Term]) -> set[int]:
        """Registers that some register's next value reads beside all of these."""
        wanted = {v.uid for v in registers}
        found: set[int] = set()
        for members in self.members.values():
            if wanted <= members:
                found |= members
        return found

    def healthy(self, registers: Iterable[Term]) -> Bit:
        """No fault that reaches the next values of these registers has acted."""
        read: set[int] = set()
        for v in registers:
            if v.uid in self.states:
                read |= {w.uid for w in variables([self.states[v.uid].next])}
        acted = zip(self.problem.faulted.acted, self.faults, strict=True)
        acting = [fault for fault, leaves in acted if leaves & read]
        return ~any_of(*acting) if acting else TRUE


def atoms(problem: Problem) -> list[Bit]:
    """Conditions over registers: bits, ends and small values of counters, comparisons that the model makes."""
    states = {s.var.uid: s for s in problem.system.states}
    found: dict[int, Bit] = {}
    rigid = {uid for uid, s in states.items() if s.next is s.var}
    roots = [problem.holds, problem.given, *(s.next for s in problem.system.states)]
    constants = constants_of(roots)
    for uid, s in states.items():
        v: Any = s.var
        if v.sort.kind == "bit":
            found[v.uid] = v
        elif is_whole(v) and uid not in rigid:
            low, high = v.sort.bounds
            values = {low, high} | {c for c in constants.get(uid, ()) if low <= c <= high}
            for value in range(low, high + 1) if high - low < FEW else sorted(values) if high - low < SMALL else [low]:
                atom = v == value
                found[atom.uid] = atom
    for term in postorder(roots):
        if term.op in ("eq", "lt", "le"):
            leaves = variables([term])
            small = len(leaves) <= 2 and len(postorder([term])) <= MOST_NODES
            if small and leaves and all(v.uid in states for v in leaves) and any(v.uid not in rigid for v in leaves):
                found[term.uid] = cast(Bit, term)
    return list(found.values())


def ceilings(problem: Problem, rows: Rows) -> list[Candidate]:
    """A register does not pass a constant that its next value is made with."""
    found: list[Candidate] = []
    for s in problem.system.states:
        if is_whole(s.var) and s.next is not s.var:
            low, high = s.var.sort.bounds
            constants = {int(t.attr) for t in postorder([s.next]) if t.is_const and is_whole(t)}
            v: Any = s.var
            seen = int(max(rows[v.uid], default=low)) if rows else low
            found += [Candidate(TRUE, cast(Bit, v <= c)) for c in sorted(constants) if max(low, seen) <= c < high]
    return found


def residues(problem: Problem, rows: Rows) -> list[Candidate]:
    """A register keeps its remainder by a divisor that all its sampled values have in common."""
    found: list[Candidate] = []
    for s in problem.system.states:
        v: Any = s.var
        if is_whole(v) and s.next is not s.var and rows and v.sort.kind == "uint":
            values = rows[v.uid]
            divisor = gcd(*(int(x) - int(values[0]) for x in set(values.tolist()))) if len(values) else 0
            if divisor > 1:
                found.append(Candidate(TRUE, cast(Bit, v % divisor == int(values[0]) % divisor)))
    return found


def ceiling_of(candidate: Candidate) -> tuple[int, int] | None:
    """The register (by uid) and the constant of a ceiling."""
    shown = candidate.shown
    if candidate.guard.is_const and shown.op == "le" and shown.args[0].op == "var" and shown.args[1].is_const:
        return shown.args[0].uid, int(shown.args[1].attr)
    return None


def clauses(near: Neighbourhood, atoms: Sequence[Bit], rows: Rows) -> list[Candidate]:
    """Implications between atoms over registers that are read together, and atoms that always hold, as sampled."""
    import numpy as np

    literals = [literal for a in atoms for literal in (a, ~a)]
    table = np.array([column.astype(bool) for column in evaluate(literals, rows)])
    where = [{v.uid for v in variables([a])} for a in literals]
    always: npt.NDArray[Any] = np.asarray(table.all(axis=1))
    found = [_clause(near, TRUE, literals[i]) for i in np.flatnonzero(always)]
    violated: npt.NDArray[Any] = np.asarray(table.astype(np.int32) @ (~table).astype(np.int32).T)
    together = list(near.members.values())
    for i, j in zip(*np.nonzero(violated == 0), strict=True):
        if always[j] or not table[i].any() or i // 2 == j // 2 or i > (j ^ 1):
            continue
        both = where[i] | where[j]
        if len(both) > 1 and any(both <= members for members in together):
            found.append(_clause(near, literals[i], literals[j]))
    return found


def _clause(near: Neighbourhood, premise: Bit, conclusion: Bit) -> Candidate:
    healthy = near.healthy(variables([premise, conclusion]))
    return Candidate(healthy & premise, conclusion)


def bounds(
    near: Neighbourhood, steps: Steps, forms: Sequence[Form], atoms: Sequence[Bit], tops: Mapping[int, int],
    guarded: bool,
) -> list[Candidate]:  # fmt: skip
    """Lower bounds, both ways, on forms that under a guard seldom fall, as sampled; while no register is at its top."""
    found: list[Candidate] = []
    for form in forms:
        healthy = near.healthy(form.registers)
        guards = guards_of(near, form, atoms) if guarded else below(form, tops)
        shown = form.term()
        values = [evaluate([shown, healthy, *guards], rows) for rows in (steps.before, steps.after)]
        change = values[1][0] - values[0][0]
        gradual = ~jumps(steps, [near.states[v.uid] for v in form.registers if v.uid in near.states], True)
        for guard, was, is_ in zip(guards, values[0][2:], values[1][2:], strict=True):
            seen = change[values[0][1] & was & is_ & gradual]
            if not len(seen):
                continue
            for falls, sided, text in (
                ((seen < 0).mean(), shown, show(form)),
                ((seen > 0).mean(), -shown, f"-({show(form)})"),
            ):
                if falls <= SELDOM:
                    found.append(Candidate(healthy & guard, sided, None, text))
    return found


def below(form: Form, tops: Mapping[int, int]) -> list[Bit]:
    """Nothing; or, of a form with registers that stop counting at a top: that one of them is below its top."""
    return [as_int(v) < tops[v.uid] for v in form.registers if v.uid in tops] or [TRUE]


def guards_of(near: Neighbourhood, form: Form, atoms: Sequence[Bit]) -> list[Bit]:
    """Literals over bits and small counters that are read beside a register of the form."""
    around = {uid for uid, s in near.states.items() if s.path.startswith("watch.") and s.var.sort.kind == "bit"}
    for v in form.registers:
        around |= near.near([v])
    bits = [a for a in atoms if all(v.uid in around and _is_small(v) for v in variables([a]))]
    return [literal for a in bits for literal in (a, ~a)]


def _is_small(v: Term) -> bool:
    return v.sort.kind == "bit" or (is_whole(v) and v.sort.bounds[1] - v.sort.bounds[0] < SMALL)


def show(form: Form) -> str:
    """A form as text."""
    parts = []
    for c, factors in form.terms:
        name = "*".join(str(v.attr) for v in factors)
        sign = "-" if c < 0 else "+"
        parts.append(f"{sign} {name}" if abs(c) == 1 else f"{sign} {abs(c)}*{name}")
    return " ".join(parts).removeprefix("+ ")


def times(problem: Problem) -> list[State]:
    """Registers of the claim that count how long something has held, or sum something up."""
    return [s for s in problem.system.states if is_whole(s.var) and s.path.startswith("watch.") and s.power_up == 0]


def rates(
    pruner: Pruner, near: Neighbourhood, steps: Steps, forms: Sequence[Form], atoms: Sequence[Bit],
    settled: Sequence[Bit], tops: Mapping[int, int], flags: bool,
) -> list[Candidate]:  # fmt: skip
    """`form >= rate * time + constant` where a time grows and a guard does not fail (then: up to where it fails).

    With `flags` the guards are wires; else values of small counters, and single registers may fall at a rate.
    """
    found: list[Candidate] = []
    before = steps.before | steps.inputs
    (*admitting,) = evaluate(settled, before)
    read = [{v.uid for v in variables([lemma])} for lemma in settled]
    for time in times(pruner.problem):
        t = as_int(time.var)
        advance = steps.after[time.var.uid] - steps.before[time.var.uid]
        for form in forms:
            if time.var.uid in {v.uid for v in form.registers}:
                continue
            single = len(form.registers) == 1 and not form.change
            if single and flags:
                continue
            guards = [TRUE, *(g for g in guards_of(near, form, atoms) if not single and _is_flag(g) == flags)]
            healthy = near.healthy(form.registers)
            around = near.near(form.registers) | {v.uid for v in form.registers}
            admitted = _all(len(steps), (a for a, own in zip(admitting, read, strict=True) if own <= around))
            for shown, text in ((form.term(), show(form)), (-form.term(), f"-({show(form)})")):
                values = [evaluate([shown, healthy, *guards], rows) for rows in (before, steps.after)]
                change = values[1][0] - values[0][0]
                seen: list[tuple[int, int, Bit]] = []
                for guard, was, is_ in zip(guards, values[0][2:], values[1][2:], strict=True):
                    where = admitted & (advance > 0) & values[0][1] & was & is_
                    rate = min((int(c // a) for c, a in zip(change[where], advance[where], strict=True)), default=0)
                    low, high = shown.sort.bounds
                    falling = rate < 0 and guard.is_const and not flags and -SLOW * rate <= high - low
                    if falling or (rate > 0 and not single):
                        seen.append((-int(where.sum()), rate, guard))
                for _, rate, guard in sorted(seen, key=lambda one: one[0])[: None if flags else WIDEST]:
                    counting = t < tops[time.var.uid] if rate < 0 and time.var.uid in tops else TRUE
                    raced = _race(pruner, (healthy & counting, shown, text), guard, t, time.next, rate, settled)
                    found += raced
                    if raced and guard.is_const and rate > 0:
                        break
    return found


def _all(lanes: int, columns: Iterable[Lanes]) -> Lanes:
    """Where all columns are true: sampled states seldom satisfy lemmas about registers far away."""
    import numpy as np

    return cast("Lanes", np.logical_and.reduce([np.ones(lanes, dtype=np.bool_), *columns]))


def _is_flag(literal: Bit) -> bool:
    inner = literal.args[0] if literal.op == "not" else literal
    return inner.op == "var"


def _race(
    pruner: Pruner, what: tuple[Bit, Int, str], free: Bit, t: Int, after: Term, rate: int, settled: Sequence[Bit]
) -> list[Candidate]:
    healthy, shown, text = what
    one = as_int(after) == t + 1
    least_rate = pruner.least_change(shown, one, (healthy, free, *settled), free)
    wanted, rate = rate, rate if least_rate is None else min(rate, least_rate)
    least = pruner.least_value(shown, healthy, settled)
    if rate == 0 or least is None or rate < 0 < wanted:
        return []
    start = least if rate > 0 else None  # below 0: a fall is bounded, from what is seen at the start
    found = [Candidate(healthy & free, shown - t * rate, start, f"{text} - {rate}*{t_name(t)}")]
    flag = ~free
    if (
        free.is_const
        or rate < 0
        or (entry := pruner.least_at_entry(shown, flag, (healthy, *settled))) is None
        or entry < least
    ):
        return found
    enough = (entry - least) // rate
    capped = select(t < enough, t, enough)
    text = f"{text} - {rate}*min({t_name(t)}, {enough})"
    return [*found, Candidate(healthy & flag, shown - capped * rate, least, text)]


def t_name(t: Term) -> str:
    """The name of a time register."""
    return str(variables([t])[0].attr)


def telling(c: Candidate, kept: Sequence[Candidate]) -> bool:
    """Whether a bound says more than the sort of its expression, and than a lemma without its guard."""
    if c.bound is None or c.bound <= (c.shown.sort.low or 0):
        return c.bound is None
    return not any(k.shown is c.shown and k.bound is not None and k.bound >= c.bound for k in kept)


# --- clocks --------------------------------------------------------------------------------------------------------


def ages(problem: Problem) -> list[State]:
    """Registers of the claim that count for how long a condition has held."""
    return [s for s in times(problem) if s.next.op == "select" and s.next.args[2].is_const]


def counters(near: Neighbourhood, steps: Steps) -> list[State]:
    """Registers of the model that now and then count one up, and else stand still or go to their lowest value."""
    found: list[State] = []
    for uid, s in near.states.items():
        if not is_whole(s.var) or s.path.startswith("watch.") or s.next is s.var:
            continue
        before, after = steps.before[uid], steps.after[uid]
        one, still, reset = after - before == 1, after == before, after == s.var.sort.bounds[0]
        if one.any() and (one | still | reset).all():
            found.append(s)
    return found


def clocks(near: Neighbourhood, steps: Steps, atoms: Sequence[Bit]) -> list[Candidate]:
    """How long something has held is bounded by a counter, a parameter or a constant, under one literal."""
    found: list[Candidate] = []
    for time in ages(near.problem):
        t = as_int(time.var)
        for s in counters(near, steps):
            w = as_int(s.var)
            limits = [p for p in _limits(near, s) if p.uid != time.var.uid]
            shown: list[tuple[Int, str]] = [
                (w - t, f"{s.path} - {time.path}"),
                (-t, f"-{time.path}"),
            ]
            for p in limits:
                shown += [(e + as_int(p), f"{text} + {p.attr}") for e, text in shown[:2]]
            healthy = near.healthy([s.var])
            for guard in guards_of(near, Form(((1, (s.var,)),), ()), atoms):
                found += [Candidate(healthy & guard, e, None, text) for e, text in shown]
    return list({(c.guard.uid, c.shown.uid): c for c in found}.values())


def _limits(near: Neighbourhood, s: State) -> list[Term]:
    """Parameters that the register is compared with."""
    read = [near.states[v.uid] for v in variables([s.next]) if v.uid in near.states]
    return [r.var for r in read if r.next is r.var and is_whole(r.var)]

"""Further templates: codes and tables, common divisors of differences, the course of a register while something lasts.

Each looks at how registers move in sampled steps or reads it off the model; none knows a register by name.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from math import gcd
from typing import TYPE_CHECKING, Any, cast

from safety.prove.flows import as_int, is_whole
from safety.prove.synthesis.candidates import Candidate
from safety.prove.synthesis.sampling import Rows, Steps, constants_of, evaluate
from safety.prove.synthesis.templates import TRUE, Neighbourhood, ages, counters
from safety.system import State
from safety.terms import Bit
from safety.terms.graph import BIT, Term, node, postorder, rewrite, variables

if TYPE_CHECKING:
    import numpy.typing as npt

    Lanes = npt.NDArray[Any]

LONGEST_TABLE = 64  # values of the register that a table is read by
OFTEN = 0.02  # share of the steps in which a register moves at its greatest rate
LITERALS = 48  # conditions of the model, and their opposites, that are combined for guards of a difference
BEST = 6  # guards of a difference that are tried


def shapes(near: Neighbourhood, steps: Steps, rows: Rows, atoms: Sequence[Bit]) -> list[Candidate]:
    """The candidates of all templates of this module, not yet fitted to sampled states."""
    return [
        *tables(near, rows),
        *congruences(near, steps),
        *limits(near, rows),
        *courses(near, steps, atoms),
        *differences(near, steps),
    ]


def moving(near: Neighbourhood, claim: bool = True) -> list[State]:
    """The registers that hold a whole number and change; `claim`: also those that belong to the claim."""
    return [
        s
        for s in near.states.values()
        if is_whole(s.var) and s.next is not s.var and (claim or not s.path.startswith("watch."))
    ]


# --- codes and tables ----------------------------------------------------------------------------------------------


def codes(near: Neighbourhood) -> list[Candidate]:
    """A register whose next value is made from the next values of others alone: the same holds of them now."""
    found: list[Candidate] = []
    after = {s.next.uid: s.var for s in near.states.values() if s.next.op not in ("var", "const")}
    for s in near.states.values():
        now = _with({uid: v for uid, v in after.items() if v is not s.var}, s.next)
        leaves = variables([now])
        if s.next.op != "var" and leaves and all(v.uid in near.states and v is not s.var for v in leaves):
            found.append(Candidate(TRUE, _equal(s.var, now)))
    return found


def _with(known: Mapping[int, Term], term: Term) -> Term:
    """The term with other terms (by uid) replaced by registers."""

    def rule(old: Term, args: tuple[Term, ...]) -> Term:
        return known[old.uid] if old.uid in known else node(old.op, args, old.attr, old.sort) if args else old

    return rewrite([term], rule)[0]


def _equal(x: Term, y: Term) -> Bit:
    return cast(Bit, ~(cast(Bit, x) ^ cast(Bit, y)) if x.sort == BIT else cast(Any, x) == y)


def tables(near: Neighbourhood, rows: Rows) -> list[Candidate]:
    """Where each value of a register that counts few goes with one value of another, which listens to the same."""
    found: list[Candidate] = []
    for key, other in itertools.permutations(moving(near, False), 2):
        if not _listen(key, other) or not rows:
            continue
        pairs = set(zip(rows[key.var.uid].tolist(), rows[other.var.uid].tolist(), strict=True))
        if 2 < len(pairs) <= LONGEST_TABLE and len({k for k, _ in pairs}) == len(pairs):
            k, v = cast(Any, key.var), cast(Any, other.var)
            found += [Candidate(cast(Bit, k == a), cast(Bit, v == b)) for a, b in sorted(pairs)]
    return found


def _listen(x: State, y: State) -> bool:
    """Whether two registers read something in common beside themselves."""
    own = {x.var.uid, y.var.uid}
    read = [{v.uid for v in variables([s.next])} - own for s in (x, y)]
    return bool(read[0] & read[1])


# --- residues and limits -------------------------------------------------------------------------------------------


def congruences(near: Neighbourhood, steps: Steps) -> list[Candidate]:
    """The sum or difference of two registers keeps its remainder by what all its sampled changes have in common."""
    found: list[Candidate] = []
    for x, y in itertools.combinations(moving(near), 2):
        if not near.near([x.var, y.var]) or type(x.power_up) is not int or type(y.power_up) is not int:
            continue
        if x.var.sort.kind != "uint" or y.var.sort.kind != "uint":
            continue
        changes = [steps.after[s.var.uid].astype(object) - steps.before[s.var.uid] for s in (x, y)]
        for sign in (1, -1):
            divisor = gcd(*{int(c) for c in changes[0] + sign * changes[1]})
            if divisor > 1:
                a, b = cast(Any, x.var), cast(Any, y.var)
                rest = (x.power_up + sign * y.power_up) % divisor
                healthy = near.healthy([x.var, y.var])
                found.append(Candidate(healthy, (a + b * (sign % divisor)) % divisor == rest))
    return found


def limits(near: Neighbourhood, rows: Rows) -> list[Candidate]:
    """A register does not pass what the assumptions say of an input that its next value reads."""
    found: list[Candidate] = []
    assumed = constants_of([near.problem.given])
    for s in moving(near, False):
        v: Any = s.var
        low, high = s.var.sort.bounds
        seen = int(max(rows[v.uid], default=low)) if rows else low
        constants = {c for w in variables([s.next]) for c in assumed.get(w.uid, ()) if seen <= c < high}
        found += [Candidate(TRUE, cast(Bit, v <= c)) for c in sorted(constants)]
    return found


# --- the course of a register --------------------------------------------------------------------------------------


def courses(near: Neighbourhood, steps: Steps, atoms: Sequence[Bit]) -> list[Candidate]:
    """`x <= c + rate * age` and `x >= c - rate * age`, always or under a condition: x moves so while the age grows."""
    found: list[Candidate] = []
    for time in ages(near.problem):
        advances = steps.after[time.var.uid] - steps.before[time.var.uid] == 1
        for s in moving(near, False):
            if not _listen(s, time):
                continue
            guards = [TRUE, *_own_guards(near, s, atoms)]
            was, is_ = (evaluate(guards, rows) for rows in (steps.before, steps.after))
            change = steps.after[s.var.uid].astype(object) - steps.before[s.var.uid]
            for sign in (1, -1):
                loose = 0
                for i, guard in enumerate(guards):
                    rate = _rate(sign * change[advances & was[i] & is_[i]])
                    loose = rate if i == 0 else loose
                    if rate and (i == 0 or rate >= loose):
                        found.append(_course(near, guard, s, sign, time, rate))
    return found


def _course(near: Neighbourhood, guard: Bit, s: State, sign: int, time: State, rate: int) -> Candidate:
    x, t = as_int(s.var), as_int(time.var)
    grown = time.path if abs(rate) == 1 else f"{abs(rate)}*{time.path}"
    text = f"{'' if sign > 0 else '-'}{s.path} {'-' if rate > 0 else '+'} {grown}"
    return Candidate(near.healthy([s.var]) & guard, (x if sign > 0 else -x) - t * rate, None, text)


def _rate(changes: Lanes) -> int:
    """The least change, if it is not a rare one; else 0."""
    least = int(min(changes, default=0))
    return least if len(changes) and (changes == least).mean() >= OFTEN else 0


def _own_guards(near: Neighbourhood, s: State, atoms: Sequence[Bit]) -> list[Bit]:
    """Literals: flags beside a register, comparisons of it, and that it is at its lowest."""
    low = cast(Any, s.var) == s.var.sort.bounds[0]
    around = near.near([s.var])
    found: list[Bit] = []
    for a in atoms:
        alone = [v.uid for v in variables([a])] == [s.var.uid]
        flag = a.op == "var" and (a.uid in around or near.states[a.uid].path.startswith("watch."))
        if flag or (alone and (a.op in ("lt", "le") or a is low)):
            found += [a, ~a]
    return found


# --- differences under conditions of the model ---------------------------------------------------------------------


def differences(near: Neighbourhood, steps: Steps) -> list[Candidate]:
    """Under two conditions of the model a difference of two counters never falls, and starts from a value that says
    something: bounded by the least value at which these conditions are entered.
    """
    found: list[Candidate] = []
    made = conditions(near)
    counting = [s for s in counters(near, steps) if len(steps)]
    pairs = [(x, y) for x, y in itertools.permutations(counting, 2) if near.near([x.var, y.var])]
    literals = [literal for c in made for literal in (c, ~c)] if pairs else []
    was, is_ = (evaluate(literals, rows) for rows in (steps.before, steps.after))
    for x, y in pairs:
        around = near.near([x.var, y.var])
        beside = [i for i, c in enumerate(literals) if all(v.uid in around for v in variables([c]))][:LITERALS]
        values = [rows[x.var.uid] - rows[y.var.uid] for rows in (steps.before, steps.after)]
        falls = values[1] < values[0]
        tried: list[tuple[int, int, Bit]] = []
        for i, j in itertools.combinations(beside, 2):
            before, after = was[i] & was[j], is_[i] & is_[j]
            stays, enters = before & after, ~before & after
            if not stays.any() or not enters.any() or (falls & stays).any():
                continue
            bound = int(values[1][enters].min())
            if bound > int(values[0][before].min()):
                tried.append((-bound, -int(before.sum()), literals[i] & literals[j]))
        shown, text = as_int(x.var) - as_int(y.var), f"{x.path} - {y.path}"
        healthy = near.healthy([x.var, y.var])
        for bound, _, guard in sorted(tried, key=lambda one: one[:2])[:BEST]:
            found.append(Candidate(healthy & guard, shown, -bound, text))
    return found


def conditions(near: Neighbourhood) -> list[Bit]:
    """The conditions over registers alone that the model and the claim make; what a condition reads comes before it."""
    roots = [near.problem.holds, *(s.next for s in near.states.values())]
    return [
        cast(Bit, t)
        for t in postorder(roots)
        if t.sort == BIT and t.op not in ("var", "const", "not") and all(v.uid in near.states for v in variables([t]))
    ]

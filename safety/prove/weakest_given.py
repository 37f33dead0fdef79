"""Whether what is given leaves each value of a parameter possible: of one that it leaves out, no proof says anything.

A point at which it all holds is found for one value; with all else held there, what is given says for which other
values the same point will do.  Values that no point serves yet are asked for until there are none.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from safety.prove.engines.engine import in_integers
from safety.prove.induction import Obligation, discharge
from safety.prove.outcome import Limits
from safety.prove.problem import Problem
from safety.prove.solve import UNKNOWN, UNSAT, Disagreement, Solver, Unrolling
from safety.prove.weakest import Value
from safety.system import substitute
from safety.terms import Bit, Int, Real, TermError, UInt
from safety.terms.graph import Term, describe, variables
from safety.terms.values import bit, const

MOST = 100  # points that are tried
Point = Mapping[int, Term]  # what stands for each variable, by uid


class NotShownError(Exception):
    """No answer: neither that each value is possible, nor one that is not."""


def left_out_of_model(problem: Problem, free: str, ends: Sequence[int], limits: Limits) -> Value | None:
    """A value of an open parameter, from one end to the other, with which no run starts; None if there is none.

    The points are checked exactly; that they serve all values is put to all solvers.  Raises `NotShownError`.
    """
    x = problem.system.lookup(free)
    assert isinstance(x, UInt | Int)
    side = (x >= min(ends)) & (x <= max(ends))
    integers = in_integers(problem)

    def possible(formula: Bit) -> Point | None:
        unrolling = Unrolling(problem.system, "z3", integers)
        asked = Solver("z3", unrolling.k, limits.timeout, finite=not integers)
        asked.add(*unrolling.at(0, [formula]))
        asked.add_ranges(unrolling)
        answer = asked.check()
        if answer == UNKNOWN:
            raise NotShownError(asked.why)
        if answer == UNSAT:
            return None
        model, context = asked.model(), unrolling.contexts[0]
        try:
            values = [(v, context.value(model, context.known[v.uid], v.sort)) for v in variables([formula])]
        except TermError as error:
            raise NotShownError(str(error)) from None
        return {v.uid: const(value, v.sort) for v, value in values}

    def unserved(served: Bit) -> Value | None:
        asked = Obligation("each value is possible", True, ((0, (side,)),), 0, served)
        answer = discharge(problem, [asked], integers, limits.timeout, limits.solvers)
        if not answer.proved and free not in answer.candidate:
            raise NotShownError("; ".join(answer.silent.values()))
        return None if answer.proved else int(answer.candidate[free])

    return _left_out(problem.start & problem.given, x, ends, possible, unserved)


def left_out_of_reals(
    situation: Bit, whole: Sequence[Real], x: Real, ends: Sequence[Value], seconds: float
) -> Value | None:
    """A value of a real, from one end to the other, that a situation leaves out; None if there is none.

    Raises `NotShownError`.
    """
    from safety.prove.bounds.routes import Limits as Seconds
    from safety.prove.bounds.routes import Question

    side = (x >= min(ends)) & (x <= max(ends))

    def asked(formula: Bit) -> list[tuple[Term, Value]] | None:
        if formula.is_const and not formula.attr:
            return None
        reply = Question(formula, whole, Seconds(seconds)).ask()
        if reply.witness is None and reply.answer != UNSAT:
            raise NotShownError(reply.why)
        if reply.witness is None:
            return None
        if any(low != high for low, high in reply.witness.values()):
            raise NotShownError("a point was found only near a root that no fraction is")
        return [(v, low) for v, (low, _) in reply.witness.items()]

    def possible(formula: Bit) -> Point | None:
        point = asked(formula)
        return None if point is None else {v.uid: const(value, v.sort) for v, value in point}

    def unserved(served: Bit) -> Value | None:
        point = asked(side & ~served)
        return None if point is None else next(value for v, value in point if v is x)

    return _left_out(situation, x, ends, possible, unserved)


def _left_out(
    first: Bit,
    x: UInt | Int | Real,
    ends: Sequence[Value],
    possible: Callable[[Bit], Point | None],
    unserved: Callable[[Bit], Value | None],
) -> Value | None:
    served, ahead = bit(False), list(dict.fromkeys(ends))
    for _ in range(MOST):
        value = ahead.pop(0)
        point = possible(first & (x == value))
        if point is None:
            return value
        (here,) = substitute([first], {uid: term for uid, term in point.items() if uid != x.uid})
        (held,) = substitute([here], {x.uid: const(value, x.sort)})
        if not (held.is_const and held.attr):
            raise Disagreement(f"{describe(x)} {value}: a solver's point does not hold there: {describe(held)}")
        assert isinstance(here, Bit)
        served |= here
        if not ahead:
            rest = unserved(served)
            if rest is None:
                return None
            ahead.append(rest)
    raise NotShownError(f"{MOST} points do not serve all values")

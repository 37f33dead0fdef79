"""Solver queries: a system unrolled over steps, and one yes-or-no question with a time limit.

`Unrolling` binds a system's registers at each step to solver terms; only what a question needs is encoded.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any, cast

from safety.prove.apart import answered_apart
from safety.system import ANY, State, System
from safety.terms.graph import Term, Value, variables
from safety.terms.smt import Encoder
from safety.terms.values import const

FIRST_MS, SECOND_MS = 2000, 8000  # that z3's two ways with reals have in turn, before nlsat has the rest
FEW_BITS = 6
COVERINGS, JUSTIFIED = {"nl-ext": "none"}, {"decision": "justification"}
WAYS = (COVERINGS, JUSTIFIED, dict[str, str]())  # of cvc5 with reals: what one decides at once another may never
TURNS = (2.0, 8.0, math.inf)  # seconds that each of them has
SAT, UNSAT, UNKNOWN = "sat", "unsat", "unknown"


class Disagreement(RuntimeError):
    """Two solvers, or two readings, gave different answers to one question: nothing they say can be relied on."""

    exit_code = 6


class Unrolling:
    """Steps of a system as solver terms: `at(k, terms)` are the terms at step k.

    From power-up, or (`anywhere=True`) from an arbitrary register content.
    """

    def __init__(self, system: System, solver: str, integers: bool, anywhere: bool = False) -> None:
        self.system, self.anywhere = system, anywhere
        self.encoder = Encoder(solver, integers)
        self.k = self.encoder.k
        self.contexts: list[Encoder] = []
        self.state: dict[int, State] = {s.var.uid: s for s in system.states}

    def at(self, step: int, terms: Sequence[Term]) -> list[Any]:
        """The terms as solver terms of a step."""
        while len(self.contexts) <= step:
            self.contexts.append(self.encoder.step_context())
        context = self.contexts[step]
        for v in variables(terms):
            if v.uid not in context.known:
                context.bind(v, self._leaf(v, step))
        return context(terms)

    def _leaf(self, v: Term, step: int) -> Any:
        state = self.state.get(v.uid)
        if state is None:
            return self.encoder.variable(f"{v.attr}@{step}", v.sort)
        if state.next is state.var and step:  # never changes: one solver constant for all steps
            return self.at(0, [v])[0]
        if step == 0:
            if self.anywhere or state.power_up is ANY:
                return self.encoder.variable(f"{v.attr}@0", v.sort)
            return self.contexts[0]([const(cast(Value, state.power_up), v.sort)])[0]
        return self.at(step - 1, [state.next])[0]

    def ranges(self) -> list[Any]:
        """What the sorts of the variables made so far promise."""
        return list(self.encoder.ranges)


@dataclass
class Solver:
    """One solver instance behind the few calls that are needed; `timeout` in seconds for each question.

    `finite`: the question has bits and bit-vectors only (z3 then runs its incremental SAT engine, cvc5 turns it into
    SAT at once: its ways of doing so while solving took minutes on a serial adder, or on 80 faults).
    `real`: it has reals and bits only.  Each solver then has several ways, and a question that takes one a tenth of
    a second may take another minutes: they have their turns.
    `alone` (z3): in a context of its own, so that its models do not depend on what was asked before it.
    """

    name: str
    k: Any
    timeout: float
    finite: bool = False
    real: bool = False
    alone: bool = False

    def __post_init__(self) -> None:
        logic = "QF_NRA" if self.real else "QF_FD" if self.name == "z3" else "QF_BV"
        own = {"ctx": self.k.Context()} if self.alone and self.name == "z3" else {}
        if self.real and self.name == "z3":
            self.raw = _for_reals(self.k, own.get("ctx"))
        else:
            self.raw = self.k.SolverFor(logic, **own) if self.finite or self.real else self.k.Solver(**own)
        milliseconds = int(self.timeout * 1000)
        if self.name == "z3":
            self.raw.set("timeout", milliseconds)
            self.raw.set("random_seed", 0)
        else:
            self.raw.setOption("tlimit-per", milliseconds)
            if self.finite:
                self.raw.setOption("bitblast", "eager")
        self.asserted = 0
        self.why = ""

    def add(self, *formulas: Any) -> None:
        """Assert."""
        self.raw.add(*(self.translated(formula) for formula in formulas))

    def translated(self, expression: Any) -> Any:
        """An expression as this solver's context and models take it."""
        return expression.translate(self.raw.ctx) if self.alone and self.name == "z3" else expression

    def add_ranges(self, unrolling: Unrolling) -> None:
        """Assert the ranges of variables made since the last call."""
        new = unrolling.encoder.ranges[self.asserted :]
        if new:
            self.raw.add(*new)
        self.asserted = len(unrolling.encoder.ranges)

    def push(self) -> None:
        """Open a scope."""
        self.raw.push()

    def pop(self) -> None:
        """Close the scope."""
        self.raw.pop()

    def check(self) -> str:
        """sat, unsat or unknown (`why` then says more); an interrupt from the keyboard is raised as such."""
        self.why = ""
        try:
            answer = self._asked_apart() if self.apart else str(self.raw.check())
        except Exception as error:
            self.why = f"{type(error).__name__}: {error}"
            return UNKNOWN
        if answer in (SAT, UNSAT):
            return answer
        self.why = str(self.raw.reason_unknown()) if self.name == "z3" else f"no answer in {self.timeout:g} s"
        if "interrupt" in self.why:
            raise KeyboardInterrupt
        return UNKNOWN

    def _asked_apart(self) -> str:
        """cvc5's answer for reals, its ways having their turns."""
        until, ways = time.monotonic() + self.timeout, list(WAYS)
        for most, way in product(TURNS, WAYS):
            left = until - time.monotonic()
            if left <= 0 or way not in ways:
                continue
            answer = answered_apart(partial(self._asked_with, way), min(most, left))
            if answer in (SAT, UNSAT):
                return answer
            if answer:  # it gave up before its time: more of that is no use
                ways.remove(way)
        return UNKNOWN

    def _asked_with(self, options: Mapping[str, str]) -> str:
        """The answer of a new instance to what is asserted."""
        other = self.k.SolverFor("QF_NRA")
        for name, value in options.items():
            other.setOption(name, value)
        other.add(*self.raw.assertions())
        return str(other.check())

    @property
    def apart(self) -> bool:
        """Whether the question is asked in a process of its own; then no model comes back."""
        return self.real and self.name == "cvc5"

    def model(self) -> Any:
        """The model of the last sat answer, of a question that was asked here."""
        return self.raw.model()


def _for_reals(k: Any, context: Any) -> Any:
    """z3 for nonlinear questions over reals and bits."""

    def ways(first: str, second: str) -> Any:
        tries = (
            k.TryFor(k.Tactic(first, context), FIRST_MS, context),
            k.TryFor(k.Tactic(second, context), SECOND_MS, context),
        )
        return k.OrElse(*tries, k.Tactic("qfnra", context), ctx=context)

    many_bits = k.Probe("num-bool-consts", context) > FEW_BITS
    return k.Cond(many_bits, ways("smt", "qfnra"), ways("qfnra", "smt"), context).solver()

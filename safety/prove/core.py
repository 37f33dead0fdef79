"""Inductive validity core: the registers, points, lemmas and assumptions that a proof rests on.

Every register (its power-up value and its next value) and every point can be let loose: then it may hold anything.
What no obligation needs is let loose for good; a lemma that none of the needed obligations uses is not needed either.
The proof is then done once more with just what is left.  In each obligation nothing more can be left out; another
proof of the claim may need other things.
Source: inductive validity cores, E. Ghassabani, A. Gacek, M. W. Whalen (2016).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

from safety.prove.engines.engine import in_integers
from safety.prove.induction import Obligation, by_induction, invariance, property_obligations
from safety.prove.problem import Problem
from safety.prove.solve import UNSAT, Disagreement, Solver, Unrolling
from safety.system import ANY, ModelError, State, substitute
from safety.terms import Bit
from safety.terms.graph import BIT, Term, describe, rewrite, variable, variables
from safety.terms.values import all_of, build, const, implies

KEPT, LOOSE = "kept ", "loose "  # before a name: whether it is as written, and what it holds else


@dataclass(frozen=True)
class ValidityCore:
    """What a proof needs, by name: enough for it, and what is not named here may be anything.

    `inputs` are those that the needed registers and points read; `spared` are the parts without any of them.
    """

    registers: tuple[str, ...]
    points: tuple[str, ...]
    inputs: tuple[str, ...]
    lemmas: tuple[str, ...]
    assumptions: tuple[str, ...]
    spared: tuple[str, ...]
    depth: int

    def __str__(self) -> str:
        rests = ", ".join((*self.registers, *self.points)) or "nothing of the model"
        return f"rests on {rests}" + (f"; does not need {', '.join(self.spared)}" if self.spared else "")


def validity_core(problem: Problem, timeout: float = 20.0) -> ValidityCore:
    """What the proof of a claim by induction over the problem's lemmas rests on; `timeout` in seconds a question.

    Raises `ModelError` where there is no such proof, `Disagreement` when the proof fails with what was found needed.
    """
    proof = by_induction(problem, problem.claim.induction, in_integers(problem), timeout, ("z3",))
    if not proof.proved:
        raise ModelError(f"{problem.claim.id} has no proof to look into ({proof.failed}); prove it by induction first")
    search = _Search(problem, proof.depth, timeout)
    search.walk()
    search.confirm()
    return search.core()


def assumptions_of(problem: Problem) -> dict[str, Bit]:
    """What is assumed at every step, conjunct by conjunct, by the text that it is shown by."""
    labels = {term.uid: text for text, term in problem.system.assumptions.items()}
    found: dict[str, Bit] = {}
    edge: list[Term] = [problem.given]
    for term in edge:  # grows while it is walked
        if term.op == "and" and term.uid not in labels:
            edge += term.args
        elif not term.is_const:
            found[labels.get(term.uid, describe(term, 4))] = cast(Bit, term)
    return found


class _Loose:
    """A problem in which a register or a point is as written only while its KEPT bit is true, and else anything."""

    def __init__(self, problem: Problem) -> None:
        self.flags: dict[str, Bit] = {}
        self.inputs: dict[str, Term] = {}
        system = problem.system.mapped(lambda terms: rewrite(terms, self._rule))
        holds, start = (cast(Bit, t) for t in rewrite([problem.holds, problem.start], self._rule))
        states = []
        for s in system.states:
            moves = s.next is not s.var
            states.append(State(s.var, self._loose(s.path, s.next), ANY) if moves else s)
            if moves and s.power_up is not ANY:
                begins = build("eq", (s.var, const(cast(Any, s.power_up), s.var.sort)), None, BIT)
                start &= implies(self.flags[s.path], cast(Bit, begins))
        rigid = [State(flag, flag, ANY) for flag in self.flags.values()]
        whole = replace(system, states=(*states, *rigid), inputs={**system.inputs, **self.inputs})
        self.assumed = {name: self._one(term) for name, term in assumptions_of(problem).items()}
        self.lemmas = dict(problem.lemmas)
        self.problem = replace(problem, system=whole, holds=holds, start=start, given=all_of())

    def _one(self, term: Bit) -> Bit:
        return cast(Bit, rewrite([term], self._rule)[0])

    def _loose(self, name: str, term: Term) -> Term:
        flag = self.flags.setdefault(name, cast(Bit, variable(KEPT + name, BIT)))
        other = self.inputs.setdefault(LOOSE + name, variable(LOOSE + name, term.sort))
        return build("select", (flag, term, other), None, term.sort)

    def _rule(self, old: Term, args: tuple[Term, ...]) -> Term:
        if old.op == "point":
            return self._loose(f"point {old.attr}", args[0])
        return build(old.op, args, old.attr, old.sort) if old.args else old


class _Search:
    """The obligations of a proof, each with what it needs, by name."""

    def __init__(self, problem: Problem, depth: int, timeout: float) -> None:
        self.problem, self.depth, self.timeout = problem, depth, timeout
        self.loose, self.needed = _Loose(problem), set[str]()

    def walk(self) -> None:
        """From the property to the lemmas that it needs, and on to what these need."""
        lemmas = self.loose.lemmas
        plain = replace(self.loose.problem, lemmas={})
        todo = property_obligations(plain, self.depth)
        asked: set[str] = set()
        for one in todo:  # grows while it is walked
            self.needed |= self._core(one)
            for name in [n for n in lemmas if _lemma(n) in self.needed and n not in asked]:
                asked.add(name)
                todo += invariance(replace(plain, lemmas={name: lemmas[name]}))

    def _core(self, one: Obligation) -> set[str]:
        """What an obligation needs: the solver's core, less what can be left out of it one by one."""
        question = _Question(self, one)
        core = question.core(question.names)
        if core is None:
            raise ModelError(f"{self.problem.claim.id}: {one.label}: no answer; give more time")
        for name in sorted(core - self.needed):
            smaller = question.core(core - {name})
            core = core if smaller is None else smaller
        return core

    def confirm(self) -> None:
        """The same proof with only what is needed; all else is let loose or left out."""
        loose = self.loose
        fixed = {flag.uid: const(name in self.needed, BIT) for name, flag in loose.flags.items()}
        left = replace(
            loose.problem,
            given=all_of(*(term for name, term in loose.assumed.items() if _assumed(name) in self.needed)),
            lemmas={name: term for name, term in loose.lemmas.items() if _lemma(name) in self.needed},
        )
        holds, given, start = cast(list[Bit], substitute([left.holds, left.given, left.start], fixed))
        system = left.system.mapped(lambda terms: substitute(terms, fixed))
        left = replace(left, system=system, holds=holds, given=given, start=start)
        proof = by_induction(left, self.depth, in_integers(left), self.timeout, ("z3",))
        if not proof.proved:
            raise Disagreement(f"{self.problem.claim.id}: the proof fails without what its obligations do not need")

    def core(self) -> ValidityCore:
        """What was found, by kind."""
        system, needed = self.problem.system, self.needed
        registers = tuple(s.path for s in system.states if s.path in needed and not s.path.startswith("watch."))
        points = tuple(name for name in system.points if f"point {name}" in needed)
        assumed = {name: term for name, term in self.loose.assumed.items() if _assumed(name) in needed}
        fixed = {flag.uid: const(name in needed, BIT) for name, flag in self.loose.flags.items()}
        terms = [s.next for s in self.loose.problem.system.states if s.path in needed]
        read = {v.uid for v in variables(substitute([*terms, *assumed.values(), self.loose.problem.holds], fixed))}
        used = (*registers, *points)
        return ValidityCore(
            registers,
            points,
            inputs=tuple(name for name, v in system.inputs.items() if v.uid in read),
            lemmas=tuple(name for name in self.loose.lemmas if _lemma(name) in needed),
            assumptions=tuple(assumed),
            spared=tuple(part for part in system.parts if not any(path.startswith(f"{part}.") for path in used)),
            depth=self.depth,
        )


def _lemma(name: str) -> str:
    return f"lemma {name}"


def _assumed(name: str) -> str:
    return f"assumed {name}"


class _Question:
    """An obligation in a solver, with a literal for each thing that it may need."""

    def __init__(self, search: _Search, one: Obligation) -> None:
        loose = search.loose
        integers = in_integers(search.problem)
        self.unrolling = Unrolling(loose.problem.system, "z3", integers, one.anywhere)
        self.solver = Solver("z3", self.unrolling.k, search.timeout)
        self.literals = {}
        for name, flag in loose.flags.items():
            self.literals[name] = self.unrolling.at(0, [flag])[0]
        last = max(step for step, _ in one.assumed)
        for name, term in loose.assumed.items():
            self._tracked(_assumed(name), [self.unrolling.at(k, [term])[0] for k in range(last + 1)])
        if one.anywhere:
            for name, term in loose.lemmas.items():
                self._tracked(_lemma(name), self.unrolling.at(0, [term]))
        for step, formulas in one.assumed:
            self.solver.add(*self.unrolling.at(step, formulas))
        self.solver.add(self.unrolling.k.Not(self.unrolling.at(one.step, [one.shown])[0]))
        self.solver.add_ranges(self.unrolling)
        self.by_literal = {str(literal): name for name, literal in self.literals.items()}

    @property
    def names(self) -> set[str]:
        return set(self.literals)

    def _tracked(self, name: str, formulas: Sequence[Any]) -> None:
        literal = self.unrolling.k.Bool(name)
        self.literals[name] = literal
        self.solver.add(*(self.unrolling.k.Implies(literal, formula) for formula in formulas))

    def core(self, allowed: Collection[str]) -> set[str] | None:
        """Some of what is allowed that is enough; None when all of it is not, or the solver does not say."""
        if str(self.solver.raw.check(*(self.literals[name] for name in sorted(allowed)))) != UNSAT:
            return None
        return {self.by_literal[str(literal)] for literal in self.solver.raw.unsat_core()}

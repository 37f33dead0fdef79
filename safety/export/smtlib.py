"""A claim as an SMT-LIB 2.6 script: the transition system as functions, and three questions put to any solver.

`base`: is the claim broken within the first k steps?  `step`: after k steps that keep it, can the next one break it,
from whatever registers?  `run`: is there a run of k + 1 steps at all?  Unsatisfiable, unsatisfiable, satisfiable: the
claim holds for ever, and not for want of runs.  A satisfiable `step` says nothing by itself (more lemmas, or a greater
k); a satisfiable `base` is a counterexample.
"""

from __future__ import annotations

from collections.abc import Sequence

from safety.export.smt_text import Texts, Variable, conjunction, symbol, texts
from safety.export.transition import Problem, transition

HEAD = """\
; {name}: a claim of rightside as a transition system, and its proof by induction of depth {depth}
; base unsat, step unsat, run sat: it holds for ever.  base sat: it is refuted within {depth} step(s)
(set-logic {logic})
"""


def smtlib(problem: Problem, lemmas: bool = False, integers: bool = True, depth: int = 1) -> str:
    """The claim as an SMT-LIB script for induction of depth `depth`, 1 or more.

    `integers`: words are integers with a range, and reals are allowed; else they are bit-vectors.  `lemmas` have to
    hold as the claim does.  Raises `TermError` for reals among bit-vectors.
    """
    what = transition(problem, lemmas, words_as_integers=integers)
    said = texts(what, integers)
    now = said.registers + said.inputs
    after = [Variable(v.after, "", v.sort) for v in said.registers]
    lines = [
        HEAD.format(name=what.name, depth=depth, logic="ALL" if integers else "QF_BV").rstrip(),
        _function("start", said.registers, said.start),
        _function("given", now, said.given),
        _function("holds", now, said.holds),
        _function("next", now + after, said.next),
        *(f"(declare-const {_at(v, k)} {v.sort})" for k in range(depth + 1) for v in now),
        *_questions(said, depth),
        "(exit)\n",
    ]
    return "\n".join(lines)


def _function(name: str, over: Sequence[Variable], body: str) -> str:
    return f"(define-fun {name} ({' '.join(f'({v.now} {v.sort})' for v in over)}) Bool\n  {body})"


def _at(v: Variable, step: int) -> str:
    return symbol(f"{v.now.strip('|')}@{step}")


def _questions(said: Texts, depth: int) -> list[str]:
    def call(name: str, step: int) -> str:
        arguments = [_at(v, step) for v in said.registers]
        if name != "start":
            arguments += [_at(v, step) for v in said.inputs]
        if name == "next":
            arguments += [_at(v, step + 1) for v in said.registers]
        return f"({name} {' '.join(arguments)})" if arguments else name

    def run(steps: int) -> list[str]:
        return [call("given", k) for k in range(steps)] + [call("next", k) for k in range(steps - 1)]

    held = [call("holds", k) for k in range(depth + 1)]
    questions = {
        "base": [call("start", 0), *run(depth), f"(not {conjunction(held[:depth])})"],
        "step": [*run(depth + 1), *held[:depth], f"(not {held[depth]})"],
        "run": [call("start", 0), *run(depth + 1)],
    }
    lines = []
    for name, asserted in questions.items():
        lines += [f'(push 1)\n(echo "{name}")', *(f"(assert {a})" for a in asserted), "(check-sat)\n(pop 1)"]
    return lines

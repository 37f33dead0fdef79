"""A claim in the Verification Modulo Theories format (VMT 1.0, A. Cimatti, A. Griggio, S. Tonetta): SMT-LIB, annotated.

Inputs are registers whose next value is free, so that initial condition, transition and property read registers only.
"""

from __future__ import annotations

from dataclasses import replace

from safety.export.smt_text import conjunction, texts
from safety.export.transition import Problem, transition
from safety.terms.values import implies

HEAD = "; {name}: a claim of rightside; the property (index 0) holds in every state that a run reaches"


def vmt(problem: Problem, lemmas: bool = False, integers: bool = True) -> str:
    """The claim in VMT.

    `integers`: words are integers with a range, and reals are allowed; else they are bit-vectors.  `lemmas` have to
    hold as the claim does.  Raises `TermError` for reals among bit-vectors.
    """
    what = transition(problem, lemmas, words_as_integers=integers)
    said = texts(replace(what, holds=implies(what.given, what.holds)), integers)
    lines = [HEAD.format(name=what.name)]
    for n, v in enumerate(said.registers + said.inputs):
        lines += [f"(declare-fun {name} () {v.sort})" for name in (v.now, v.after)]
        lines.append(f"(define-fun .sv{n} () {v.sort} (! {v.now} :next {v.after}))")
    lines += [
        f"(define-fun .init () Bool (! {said.start} :init true))",
        f"(define-fun .trans () Bool (! {conjunction([said.given, said.next])} :trans true))",
        f"(define-fun .holds () Bool (! {said.holds} :invar-property 0))\n",
    ]
    return "\n".join(lines)

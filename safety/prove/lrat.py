"""LRAT proofs of unsatisfiable clauses: cvc5 solves them, and its resolution proof is written out step by step.

A step of LRAT is a clause and the clauses that it follows from by unit propagation, in that order.  A chain of
resolutions read backwards is such an order.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

Clause = Sequence[int]


class NoProof(Exception):
    """There is no proof; the message says why."""

    def __init__(self, why: str, satisfiable: bool = False) -> None:
        super().__init__(why)
        self.satisfiable = satisfiable


def refutation(clauses: Sequence[Clause], timeout: float) -> str:
    """The LRAT proof that the clauses are contradictory; `NoProof` if they are not, or not within `timeout` seconds."""
    import cvc5

    try:
        return _refutation(clauses, timeout)
    except (RuntimeError, LookupError, ValueError) as error:  # another release of cvc5, with other options or steps
        raise NoProof(f"cvc5 {cvc5.__version__} gives no proof of these clauses: {error}") from None


def _refutation(clauses: Sequence[Clause], timeout: float) -> str:
    import cvc5

    manager = cvc5.TermManager()
    solver = cvc5.Solver(manager)
    options = {"produce-proofs": "true", "proof-mode": "sat-proof", "sat-solver": "cadical", "simplification": "none"}
    for name, value in (options | {"tlimit-per": str(int(timeout * 1000))}).items():
        solver.setOption(name, value)
    solver.setLogic("QF_UF")
    literals: dict[int, Any] = {}
    for variable in {abs(literal) for clause in clauses for literal in clause}:
        literals[variable] = manager.mkConst(manager.getBooleanSort(), str(variable))
        literals[-variable] = manager.mkTerm(cvc5.Kind.NOT, literals[variable])
    for clause in reversed(clauses):  # what is asserted comes last in them; read first, proofs are a sixth shorter
        terms = [literals[literal] for literal in clause]
        solver.assertFormula(terms[0] if len(terms) == 1 else manager.mkTerm(cvc5.Kind.OR, *terms))
    answer = solver.checkSat()
    if answer.isSat():
        raise NoProof("the clauses can be satisfied", satisfiable=True)
    if not answer.isUnsat():
        raise NoProof(f"not reached in {timeout:g} s")
    (proof,) = solver.getProof(cvc5.ProofComponent.SAT)
    return _written(proof, clauses, {term: literal for literal, term in literals.items()})


def _written(proof: Any, clauses: Sequence[Clause], literal_of: dict[Any, int]) -> str:
    """The steps of a resolution proof, each after those that it uses."""
    import cvc5

    given = {frozenset(clause): number for number, clause in reversed(list(enumerate(clauses, 1)))}
    steps: dict[Any, int] = {}
    lines: list[str] = []
    stack = [(proof, False)]
    while stack:
        step, ready = stack.pop()
        if step in steps:
            continue
        clause = _literals(step.getResult(), literal_of)
        if step.getRule() == cvc5.ProofRule.ASSUME:
            steps[step] = given[frozenset(clause)]
        elif ready:
            steps[step] = len(clauses) + len(lines) + 1
            hints = [steps[child] for child in reversed(step.getChildren())]
            lines.append(" ".join(map(str, (steps[step], *clause, 0, *hints, 0))))
        else:
            stack.append((step, True))
            stack.extend((child, False) for child in step.getChildren())
    return "\n".join([*lines, ""])


def _literals(term: Any, literal_of: dict[Any, int]) -> list[int]:
    import cvc5

    if term.isBooleanValue():
        return []
    if term in literal_of:
        return [literal_of[term]]
    if term.getKind() != cvc5.Kind.OR:
        raise ValueError(f"{term} is no clause")
    return [literal_of[one] for one in term]

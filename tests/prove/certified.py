"""Small problems to certify, certificates as files, and judges of them that share nothing with the checker."""

from __future__ import annotations

import json
import random
import zipfile
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from safety.faults import Faulted
from safety.prove.claims import INTEGERS
from safety.prove.induction import by_induction
from safety.prove.problem import Problem
from safety.system import ANY, Clock, ModelError, State, System
from safety.terms import Bit, Term, TermError, bit, implies, select
from safety.terms.graph import BIT, REAL, Sort, integer, node, uint, variable, variables
from safety.terms.values import const
from tests.prove.small import asked

Files = dict[str, str]  # the texts in a certificate, by name


def problem_of(
    states: Sequence[State],
    inputs: Sequence[Term],
    holds: Any,
    lemmas: Mapping[str, Any] | None = None,
    given: Any = None,
    start: Any = None,
    arithmetic: str = INTEGERS,
) -> Problem:
    """A problem without a model class."""
    system = System("small", Clock(event="tick"), tuple(states), {v.attr: v for v in inputs}, {}, {}, {}, {})
    true = bit(True)
    claim = asked(lambda s: true, arithmetic=arithmetic)
    faulted, start_ = Faulted(system, (), (), (), ()), true if start is None else start
    return Problem(claim, system, faulted, holds, (true,), true if given is None else given, start_, dict(lemmas or {}))


def unpacked(path: Path) -> Files:
    with zipfile.ZipFile(path) as archive:
        return {i.filename: archive.read(i).decode() for i in archive.infolist()}


def packed(files: Mapping[str, str | bytes], path: Path) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return path


# --- a judge of what is claimed: the toolkit's own induction, on the problem built again from the json ---------------

SORTS = {"bit": BIT, "real": REAL}
NATURAL: dict[str, Callable[..., Any]] = {
    "not": lambda n, x: ~x,
    "and": lambda n, x, y: x & y,
    "or": lambda n, x, y: x | y,
    "xor": lambda n, x, y: x ^ y,
    "implies": lambda n, x, y: implies(x, y),
    "add": lambda n, x, y: x + y,
    "sub": lambda n, x, y: x - y,
    "mul": lambda n, x, y: x * y,
    "eq": lambda n, x, y: x == y,
    "lt": lambda n, x, y: x < y,
    "le": lambda n, x, y: x <= y,
    "select": lambda n, c, x, y: select(c, x, y),
    "bit": lambda n, x: x.bit(n),
    "concat": lambda n, x, y: x.concat(y),
    "div": lambda n, x: x // n,
    "mod": lambda n, x: x % n,
    "band": lambda n, x, y: x & y,
    "bor": lambda n, x, y: x | y,
    "bxor": lambda n, x, y: x ^ y,
}


class Nonsense(Exception):
    """The json describes no problem."""


def sort_of(text: str) -> Sort:
    if text in SORTS:
        return SORTS[text]
    if text.startswith("u"):
        return uint(int(text[1:]))
    low, high = text.removeprefix("int[").removesuffix("]").split(", ")
    return integer(int(low), int(high))


def covers(sort: Sort, natural: Sort) -> bool:
    """Whether a sort has all the values of the one that the toolkit would give."""
    if sort.kind in ("bit", "real") or natural.kind in ("bit", "real"):
        return sort == natural
    return sort.bounds[0] <= natural.bounds[0] and natural.bounds[1] <= sort.bounds[1]


def term_of(op: str, args: Sequence[Term], attr: Any, sort: Sort) -> Term:
    """One node; `Nonsense` where its sort lacks a value that the operation gives."""
    if op == "const":
        return const(Fraction(attr) if sort == REAL else attr, sort)
    if op == "var":
        return variable(attr, sort)
    if op == "slice":
        attr = tuple(attr)
        natural, ok = uint(attr[1]), args[0].sort.kind in ("uint", "int") and attr[0] >= 0
    elif op == "clip":
        natural, ok = sort, args[0].sort.kind in ("uint", "int") and sort.kind in ("uint", "int")
    elif op in ("cast", "point"):
        natural, ok = args[0].sort if sort != REAL else sort, op == "cast" or args[0].sort == sort
    else:
        natural, ok = NATURAL[op](attr, *args).sort, True
    if not ok or not covers(sort, natural):
        raise Nonsense(f"{op} of {args} is no {sort}")
    return node(op, tuple(args), attr, sort)


def rebuilt(text: Any) -> Problem:
    """The problem that a certificate's json describes; `Nonsense` where it describes none."""
    try:
        terms: list[Term] = []
        for op, args, attr, sort in text["nodes"]:
            assert all(0 <= a < len(terms) for a in args)
            terms.append(term_of(op, [terms[a] for a in args], attr, sort_of(sort)))
        states = []
        for name, var, after, power_up in text["registers"]:
            v = terms[var]
            assert v.op == "var" and v.attr == name and terms[after].sort == v.sort
            value = ANY if power_up is None else Fraction(power_up) if v.sort == REAL else power_up
            assert value is ANY or v.sort.admits(value)
            states.append(State(v, terms[after], value))
        inputs = [variable(t.attr, t.sort) for t in terms if t.op == "var" and t.attr in text["inputs"]]
        lemmas = {name: terms[root] for name, root in text["lemmas"]}
        given, start, holds = (terms[text[key]] for key in ("given", "start", "holds"))
        assert all(isinstance(t, Bit) for t in (given, start, holds, *lemmas.values()))
        assert len(lemmas) == len(text["lemmas"]) and type(text["depth"]) is int and text["depth"] >= 0
        problem = problem_of(states, inputs, holds, lemmas, given, start, text["arithmetic"])
        known = {s.var.uid for s in states}
        assert all(v.uid in known for v in variables([start, *lemmas.values()]))
        assert all(v.uid in known | {i.uid for i in inputs} for t in terms for v in [t] if t.op == "var")
    except (
        AssertionError,
        KeyError,
        IndexError,
        ValueError,
        TypeError,
        AttributeError,
        TermError,
        ModelError,
    ) as error:
        raise Nonsense(str(error)) from None
    return problem


def proves(text: Any) -> bool:
    """Whether the lemmas and the depth in a json prove its claim, by z3 and the toolkit's induction."""
    try:
        problem = rebuilt(text)
    except Nonsense:
        return False
    return by_induction(problem, text["depth"], True, 20, ("z3",)).proved


def follows(clauses: Sequence[Sequence[int]], proof: str) -> bool:
    """Whether each line of an LRAT proof, up to an empty clause, follows by propagation over its hints in any order."""
    known = dict(enumerate(clauses, 1))
    for line in proof.splitlines():
        try:
            number, *rest = map(int, line.split())
            cut = rest.index(0)
            named = [known[hint] for hint in rest[cut + 1 : -1]]
        except (ValueError, KeyError):
            return False
        if rest[-1] != 0 or cut == len(rest) - 1 or number in known:
            return False
        false = set(rest[:cut])
        while True:
            left = [[literal for literal in clause if literal not in false] for clause in named]
            if [] in left:
                break
            units = {-clause[0] for clause in left if len(clause) == 1} - false
            if not units:
                return False
            false |= units
        if not cut:
            return True
        known[number] = rest[:cut]
    return False


def changed(files: Files, **changes: Any) -> Files:
    """The files with some keys of the json replaced."""
    return files | {"certificate.json": json.dumps(json.loads(files["certificate.json"]) | changes)}


def edited(proof: str, rng: random.Random) -> str:
    """The proof with a line left out, doubled or moved, or a number changed, left out or added."""
    lines = [line.split() for line in proof.splitlines()]
    i = rng.randrange(len(lines))
    match rng.choice(["drop", "twice", "swap", "number", "number", "number", "less", "more", "end"]):
        case "drop":
            del lines[i]
        case "twice":
            lines.insert(i, lines[i])
        case "swap":
            j = rng.randrange(len(lines))
            lines[i], lines[j] = lines[j], lines[i]
        case "end":
            lines = lines[:i]
        case what:
            at = rng.randrange(len(lines[i]))
            if what == "less":
                del lines[i][at]
            elif what == "more":
                lines[i].insert(at, str(rng.randint(-9, 40)))
            else:
                lines[i][at] = (
                    str(int(lines[i][at]) + rng.choice([-1, 1, 2])) if rng.random() < 0.7 else f"-{lines[i][at]}"
                )
    return "\n".join(" ".join(line) for line in lines)

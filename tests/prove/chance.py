"""Equipment, faults and claims drawn at random."""

from __future__ import annotations

import random

from tests.prove.naive import WORDS, Broken, Equipment, Expr, Question


def wire(rng: random.Random, names: list[str], depth: int) -> Expr:
    """A random expression of one bit."""
    if depth == 0 or rng.random() < 0.2:
        name = rng.choice(names)
        if name not in WORDS:
            return ("name", name)
        return rng.choice([("bit", ("name", name), rng.randrange(2)), ("is", ("name", name), rng.randrange(4))])
    op = rng.choice(["not", "and", "or", "xor", "select", "is", "lt", "bit", "and", "or"])
    if op in ("and", "or", "xor"):
        return (op, wire(rng, names, depth - 1), wire(rng, names, depth - 1))
    if op == "select":
        return (op, *(wire(rng, names, depth - 1) for _ in range(3)))
    if op == "not":
        return (op, wire(rng, names, depth - 1))
    if op == "lt":
        return (op, word(rng, names, depth - 1), word(rng, names, depth - 1))
    return (op, word(rng, names, depth - 1), rng.randrange(4 if op == "is" else 2))


def word(rng: random.Random, names: list[str], depth: int) -> Expr:
    """A random expression of two bits."""
    words = [n for n in names if n in WORDS]
    if depth == 0 or rng.random() < 0.2:
        return ("name", rng.choice(words)) if words and rng.random() < 0.8 else ("const", rng.randrange(4))
    op = rng.choice(["inc", "dec", "select", "pair", "mix", "select", "inc"])
    if op in ("inc", "dec"):
        return (op, word(rng, names, depth - 1))
    if op == "pair":
        return (op, wire(rng, names, depth - 1), wire(rng, names, depth - 1))
    if op == "mix":
        return (op, word(rng, names, depth - 1), word(rng, names, depth - 1))
    return (op, wire(rng, names, depth - 1), word(rng, names, depth - 1), word(rng, names, depth - 1))


def equipment(rng: random.Random) -> Equipment:
    """Random equipment."""
    before = ["x", "y", "p", "q"]
    return Equipment(
        a=wire(rng, before, 2),
        w=word(rng, [*before, "a"], 2),
        o=wire(rng, [*before, "a", "w"], 2),
        x=word(rng, [*before, "a", "w"], 2),
        y=wire(rng, [*before, "a", "w"], 2),
        x0=rng.choice([0, 0, 1, 3, None]),
        y0=rng.choice([False, False, True, None]),
        assumed=wire(rng, ["p", "q"], 1) if rng.random() < 0.2 else None,
    )


KINDS = ("stuck0", "stuck1", "flip", "byzantine", "frozen", "delayed", "missing", "extra", "open", "welded")
ONSETS = ("from start", "any time", "transient", "intermittent")


def broken(rng: random.Random, kind: str | None = None, onset: str | None = None) -> Broken:
    """A random fault."""
    kind = kind or rng.choice(KINDS)
    places = ["a", "o"] if kind in ("missing", "extra", "open", "welded") else ["a", "w", "o"]
    at = tuple(sorted(rng.sample(places, 2 if rng.random() < 0.15 else 1)))
    numbers: list[int | None] = [None]
    if kind in ("stuck0", "stuck1", "flip") and at == ("w",):
        numbers = [None, 0, 1]
    elif kind in ("delayed", "missing"):
        numbers = [1, 2]
    onset = onset or rng.choice(ONSETS)
    return Broken(kind, rng.choice(numbers), at, onset, rng.choice([1, 2, 3]) if onset == "transient" else None)


def monitored(rng: random.Random, names: list[str]) -> Expr:
    """A random statement about the past."""
    of = wire(rng, names, 1)
    most = rng.choice([1, 2, 3])
    match rng.choice(["once", "previous", "age", "age", "total"]):
        case "once":
            return ("once", of)
        case "previous":
            return ("previous", of, rng.choice([False, True]))
        case "age":
            return ("not", ("lt", ("age", of, 3), ("const", most)))
    return ("not", ("lt", ("total", word(rng, names, 1), 3), ("const", most)))


def clause(rng: random.Random, names: list[str]) -> Expr:
    """A random statement, most often an implication."""

    def some() -> Expr:
        return monitored(rng, names) if rng.random() < 0.3 else wire(rng, names, 2)

    conclusion = ("or", some(), ("or", wire(rng, names, 1), some()))
    if rng.random() < 0.3:
        state = ("and", ("is", ("name", "x"), rng.randrange(4)), ("xor", ("name", "y"), ("const", rng.random() < 0.5)))
        return ("not", state) if rng.random() < 0.5 else conclusion
    if rng.random() < 0.2:
        return ("implies", some(), ("implies", some(), conclusion))
    return ("implies", wire(rng, names, 1) if rng.random() < 0.5 else some(), conclusion)


def question(rng: random.Random) -> Question:
    """A random claim."""
    faults = tuple(dict.fromkeys(broken(rng) for _ in range(rng.choice([0, 0, 1, 1, 2]))))
    flags = [f"{what}{i}" for i in range(len(faults)) for what in ("has", "struck")]
    names = ["x", "y", "p", "q", "a", "w", "good", "level", *flags]
    holds = clause(rng, names)
    if rng.random() < 0.25:
        holds = ("and", holds, clause(rng, names))
    registers = ["x", "y", *flags]
    given = wire(rng, ["p", "q", "x", "y", "good"], 2) if rng.random() < 0.15 else None
    if faults and rng.random() < 0.5:  # without this most violations need no fault
        given = ("and", ("name", "has0"), given) if given else ("name", "has0")
    return Question(
        holds=holds,
        given=given,
        start=wire(rng, ["x", "y"], 1) if rng.random() < 0.1 else None,
        lemmas=tuple(wire(rng, registers, 2) for _ in range(rng.choice([0, 0, 0, 1, 2]))),
        faults=faults,
        most=rng.choice([None, 1, 1, 1, 0]),
        anywhere=rng.random() < 0.1,
    )

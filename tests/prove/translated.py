"""The same small equipment and claims in the toolkit's own words."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from safety.faults import (
    Fault,
    Kind,
    any_of_faults,
    at_most,
    byzantine,
    delayed,
    extra,
    flip,
    frozen,
    missing,
    open_circuit,
    stuck,
    welded,
)
from safety.model import Model, assume, point, power_up
from safety.prove.claims import Claim, Seen, age, has, once, previous, struck, total
from safety.system import ANY
from safety.terms import U2, Bit, Term, bit, implies, select, word
from tests.prove.naive import Broken, Equipment, Expr, Question

BUILD: dict[str, Callable[..., Any]] = {
    "not": lambda a: ~a,
    "and": lambda a, b: a & b,
    "or": lambda a, b: a | b,
    "xor": lambda a, b: a ^ b,
    "implies": implies,
    "select": lambda c, a, b: select(c, a, b),
    "bit": lambda w, i: w.bit(i),
    "is": lambda w, n: w == n,
    "lt": lambda a, b: a < b,
    "inc": lambda w: (w + 1).low(2),
    "dec": lambda w: w.sat_sub(1),
    "mix": lambda a, b: a ^ b,
    "pair": lambda h, low: h.word().concat(low.word()),
    "once": once,
    "previous": lambda e, start: previous(e, start),
    "age": lambda e, most: age(e, most),
    "total": lambda e, most: total(e, most),
}


def term(e: Expr, of: Callable[[str], Any]) -> Any:
    """An expression as a term."""
    op, *args = e
    if op == "name":
        return of(args[0])
    if op == "const":
        return bit(args[0]) if isinstance(args[0], bool) else word(args[0], 2)
    return BUILD[op](*(term(a, of) if isinstance(a, tuple) else a for a in args))


class Out(NamedTuple):
    good: Bit
    level: U2


def model(made: Equipment) -> type[Model]:
    """The equipment as a model."""

    class Random(Model, event="tick"):
        """Equipment drawn at random."""

        x: U2 = power_up(ANY if made.x0 is None else made.x0)
        y: Bit = power_up(ANY if made.y0 is None else made.y0)

        def step(self, p: Bit, q: Bit) -> tuple[Random, Out]:
            env: dict[str, Term] = {"x": self.x, "y": self.y, "p": p, "q": q}
            if made.assumed is not None:
                assume("what the surroundings do", term(made.assumed, env.__getitem__))
            env["a"] = point("a", term(made.a, env.__getitem__))
            env["w"] = point("w", term(made.w, env.__getitem__))
            env["o"] = point("o", term(made.o, env.__getitem__))
            following = Random(x=term(made.x, env.__getitem__), y=term(made.y, env.__getitem__))
            return following, Out(good=env["o"], level=env["w"])

    return Random


def kind(fault: Broken) -> Kind:
    """The toolkit's fault kind."""
    number = fault.number
    match fault.kind:
        case "stuck0" | "stuck1":
            return stuck(int(fault.kind[-1]), bit=number)
        case "flip":
            return flip(bit=number)
        case "delayed":
            return delayed(number or 1)
        case "missing":
            return missing(number or 1)
    simple = {"byzantine": byzantine, "frozen": frozen, "extra": extra, "open": open_circuit, "welded": welded}
    return simple[fault.kind]()


def fault(broken: Broken, index: int, **schedule: Any) -> Fault:
    """The toolkit's fault, called by its index."""
    timing = {"ticks": broken.ticks} | schedule
    return Fault(kind(broken), broken.places, broken.onset, name=f"f{index}", **timing)


def claim(asked: Question, of: type[Model], *, expect: str, steps: int, induction: int, arithmetic: str) -> Claim:
    """The question as a claim."""

    def read(s: Seen) -> Callable[[str], Any]:
        def one(name: str) -> Any:
            if name.startswith("has"):
                return has(s, f"f{name[3:]}")
            return struck(s, f"f{name[6:]}") if name.startswith("struck") else s[name]

        return one

    def formula(e: Expr) -> Callable[[Seen], Bit]:
        return lambda s: term(e, read(s))

    broken = [fault(f, i) for i, f in enumerate(asked.faults)]
    budget = any_of_faults(broken) if asked.most is None else at_most(asked.most, broken)
    return Claim(
        "random.claim", of, formula(asked.holds), "random", expect, "", "", budget if broken else None,
        formula(asked.given) if asked.given else None, formula(asked.start) if asked.start else None,
        tuple(formula(e) for e in asked.lemmas), (), {}, steps, induction, arithmetic, None, None, None,
        anywhere=asked.anywhere,
    )  # fmt: skip

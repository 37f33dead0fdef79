"""Check certificates of solved fault trees: `python check_tree.py FILE...`, one file that needs nothing but Python.

A certificate is JSON.  `order` has the events; `tree` is what was solved: name, gates [name, kind, inputs, k] (inputs
first), top, events [name, chance], chances such as "1/3", "1-exp(-1/8)" or null, house events [name, state].  `reduced`
is the same simplified, gates [kind, k, references]; `diagram` again, nodes [variable, high, low]; a variable may be
a module, some node before it.  A reference is 2 n, or 2 n + 1 for the opposite, to number n: true at 0, the events in
order, then the gates or nodes, inputs first.

The argument: in a given order of events a function has just one reduced diagram.  Tree, simplified tree and diagram are
each made into it: they are the same function if and only if they become the same node.  On it the probability is
enclosed in whole numbers, rounded down and up, and minimal cut sets (or p-cuts) are counted.
"""

from __future__ import annotations

import hashlib
import json
import sys
from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import pairwise, zip_longest
from pathlib import Path
from typing import Any

FORMAT, MOST_NODES, MOST_BYTES, BITS = "rightside tree certificate 1", 5_000_000, 1 << 28, 1200
CHECKED, REJECTED, UNREADABLE, UNDECIDED = "checked", "rejected", "not a certificate", "undecided"
EXIT, TRUE, FALSE, ONE = {CHECKED: 0, UNDECIDED: 3, REJECTED: 1, UNREADABLE: 2}, 0, 1, 1 << BITS  # best first


class Refused(Exception):
    """Why the certificate is not accepted: words, and one of EXIT."""


def need(condition: object, why: str, verdict: str = REJECTED) -> None:
    """Go on only if `condition` holds."""
    if not condition:
        raise Refused(verdict, why)


class Diagram:
    """Nodes (level, high, low), each there once: references as above, the high one even; of families just numbers."""

    def __init__(self, constants: int) -> None:
        self.nodes: list[tuple[int, int, int]] = [(sys.maxsize, 0, 0)] * constants  # below all variables
        self.numbers: dict[tuple[int, int, int], int] = {}
        self.known: dict[tuple[int, int], int] = {}

    def number(self, level: int, high: int, low: int) -> int:
        """Where a node stands."""
        found = self.numbers.setdefault((level, high, low), len(self.nodes))
        if found == len(self.nodes):
            need(found < MOST_NODES, f"a diagram of more than {MOST_NODES} nodes", UNDECIDED)
            self.nodes.append((level, high, low))
        return found

    def node(self, level: int, high: int, low: int) -> int:
        """The function `high` if the variable holds, else `low`."""
        return high if high == low else 2 * self.number(level, high & ~1, low ^ high & 1) ^ high & 1

    def _both(self, f: int, g: int) -> int:
        f, g = (f, g) if f < g else (g, f)
        if f <= FALSE or f ^ g <= 1:
            return FALSE if f == FALSE or f ^ g == 1 else g
        if (f, g) not in self.known:
            (level, f1, f0), (other, g1, g0) = self.nodes[f >> 1], self.nodes[g >> 1]
            f1, f0 = (f1 ^ f & 1, f0 ^ f & 1) if level <= other else (f, f)
            g1, g0 = (g1 ^ g & 1, g0 ^ g & 1) if other <= level else (g, g)
            self.known[f, g] = self.node(min(level, other), self._both(f1, g1), self._both(f0, g0))
        return self.known[f, g]

    def _choose(self, condition: int, f: int, g: int) -> int:
        return self._both(self._both(condition, f) ^ 1, self._both(condition ^ 1, g) ^ 1) ^ 1

    def _gate(self, kind: str, k: int, inputs: list[int]) -> int:
        if kind == "if":
            return self._choose(*inputs)
        inputs.sort(key=lambda f: -self.nodes[f >> 1][0])  # the lowest variables first
        if kind == "vote":
            at_least = [TRUE] + [FALSE] * k  # 0, 1, .. k of the inputs so far
            for f in inputs:
                at_least[1:] = [self._both(same ^ 1, self._both(f, less) ^ 1) ^ 1 for less, same in pairwise(at_least)]
            return at_least[k]
        need(kind in ("and", "or", "xor"), f"a gate {kind}", UNREADABLE)
        result = FALSE if kind == "xor" else TRUE
        for f in inputs:
            result = self._choose(result, f ^ 1, f) if kind == "xor" else self._both(result, f ^ (kind == "or"))
        return result ^ (kind == "or")

    def top(self, events: int, gates: Any, root: int) -> int:
        """The function of gates [kind, k, references] over so many events."""
        values = [TRUE, *(self.node(level, TRUE, FALSE) for level in range(events))]
        for kind, k, references in gates:
            values.append(self._gate(kind, k, [values[x >> 1] ^ x & 1 for x in references]))
        return values[root >> 1] ^ root & 1

    def probability(self, root: int, chances: list[tuple[int, int]]) -> tuple[int, int]:
        """Times ONE, rounded down and up."""
        known = [(ONE, ONE), (0, 0)]
        for level, f, g in self.nodes[1:]:
            (low, high), (a, b), (c, d) = chances[level], known[f], known[g]
            low, high = low * a + (ONE - high) * c >> BITS, -(-(high * b + (ONE - low) * d) >> BITS)
            known += [(low, high), (ONE - high, ONE - low)]
        return known[root]


def cut_sets_by_order(functions: Diagram, root: int) -> list[int]:
    """How many smallest sets of 0, 1, 2, ... events fulfil a function, all other events absent."""
    # a node stands for the sets of low, and those of high each with its variable; 0 for none, 1 for the empty set alone
    families, minimal = Diagram(2), {TRUE: 1, FALSE: 0}

    def node(level: int, high: int, low: int) -> int:
        return families.number(level, high, low) if high else low

    def without(sets: int, smaller: int) -> int:  # those that contain none of the others
        if sets == 0 or smaller <= 1 or sets == smaller:
            return 0 if smaller else sets
        (level, high, low), (other, inner, below) = families.nodes[sets], families.nodes[smaller]
        if level > other:
            return without(sets, below)
        if (sets, smaller) not in families.known:
            inner, below = (inner, below) if level == other else (0, smaller)
            families.known[sets, smaller] = node(level, without(without(high, inner), below), without(low, below))
        return families.known[sets, smaller]

    def of(f: int) -> int:
        if f not in minimal:
            level, high, low = functions.nodes[f >> 1]
            absent, present = of(low ^ f & 1), of(high ^ f & 1)
            minimal[f] = node(level, without(present, absent), absent)
        return minimal[f]

    top, counts = of(root), [[], [1]]
    for _, high, low in families.nodes[2:]:
        counts.append([a + b for a, b in zip_longest([0, *counts[high]], counts[low], fillvalue=0)])
    return counts[top]


def numbered(tree: Any, order: list[str]) -> tuple[list[Any], int]:
    """The gates of a tree with references instead of names, and that of its top."""
    of = {name: 2 * n for n, name in enumerate(order, 1)} | {name: (1, 0)[on] for name, on in tree["house_events"]}
    need(len(of) == len(order) + len(tree["house_events"]), "an event is there twice", UNREADABLE)
    gates = []
    for name, kind, inputs, k in tree["gates"]:
        fits = len(inputs) == 1 or (len(inputs) > 1 and kind != "not")
        need(fits and name not in of, f"gate {name} is there twice or has {len(inputs)} inputs", UNREADABLE)
        gates.append(("and" if kind == "not" else kind, k, [of[x] for x in inputs]))
        of[name] = 2 * (len(order) + len(gates)) + (kind == "not")
    return gates, of[tree["top"]]


def chance(text: str) -> tuple[int, int]:
    """A chance times ONE, rounded down and up; exp of the decimal library is correctly rounded."""
    number = text.removeprefix("1-exp(-").removesuffix(")")
    need(abs(int(number.lower().partition("e")[2] or 0)) <= 9999, "a chance beyond all measure", UNREADABLE)
    value, margin = Fraction(number), Fraction(0)
    if text.startswith("1-exp(-"):
        with localcontext(prec=400):
            value, margin = 1 - Fraction((-Decimal(value.numerator) / value.denominator).exp()), (1 + value) / 10**390
    need(0 <= value <= 1, f"a chance of {text}", UNREADABLE)
    return max(0, (value - margin) * ONE // 1), min(ONE, -(-(value + margin) * ONE // 1))


def check(c: Any) -> dict[str, Any]:
    """What is certified; raises Refused."""
    need(c["format"] == FORMAT, f"the format is not {FORMAT!r}", UNREADABLE)
    for key in ("tree", "reduced"):
        digest = hashlib.sha256(json.dumps(c[key], sort_keys=True).encode()).hexdigest()
        need(c["sha256"][key] == digest, f"the sha256 of {key} is not that of its content")
    order, events = c["order"], dict(c["tree"]["events"])
    need(sorted(order) == sorted(name for name, _ in c["tree"]["events"]), "the order is not of all events")
    sys.setrecursionlimit(max(sys.getrecursionlimit(), 3 * len(order) + 1000))
    diagram = Diagram(1)
    tree = diagram.top(len(order), *numbered(c["tree"], order))
    for key, gates in (("reduced", c["reduced"]["gates"]), ("diagram", [["if", 0, x] for x in c["diagram"]["nodes"]])):
        need(diagram.top(len(order), gates, c[key]["root"]) == tree, f"the function of {key} is not that of the tree")
    counts = cut_sets_by_order(diagram, tree)
    need(counts == c["cut_sets_by_order"], f"the minimal cut sets by order are {counts}")
    if c["probability"] is not None:
        low, high = diagram.probability(tree, [chance(events[name]) for name in order])
        said = [Fraction(bound) * ONE for bound in c["probability"] if type(bound) is float]
        need(said[0] <= low and high <= said[1], f"the probability is {low / ONE!r}")
    return {"name": c["tree"]["name"], **{key: c[key] for key in ("sha256", "probability", "cut_sets_by_order")}}


def examine(path: Path) -> dict[str, Any]:
    """The report on a certificate: `verdict`, `why`, and what is certified."""
    report: dict[str, Any] = {"file": str(path), "verdict": CHECKED, "why": ""}
    try:
        need(path.stat().st_size <= MOST_BYTES, f"more than {MOST_BYTES} bytes", UNREADABLE)
        return report | check(json.loads(path.read_text(encoding="utf-8")))
    except Refused as refused:
        return report | dict(zip(("verdict", "why"), refused.args, strict=True))
    except (OSError, ValueError, TypeError, LookupError, ArithmeticError, AttributeError, RecursionError) as error:
        return report | {"verdict": UNREADABLE, "why": f"{type(error).__name__}: {error}"[:300]}


if __name__ == "__main__":
    print(json.dumps(reports := [examine(Path(file)) for file in sys.argv[1:]], indent=1))
    sys.exit(EXIT[max((one["verdict"] for one in reports), key=list(EXIT).index, default=UNREADABLE)])

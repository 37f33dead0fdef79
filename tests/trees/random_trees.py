"""Random fault trees by seed: coherent or not, shared, deep, wide, modules, twins, sums of products, constants."""

import random
from fractions import Fraction

from safety.trees import BasicEvent, FaultTree, Gate, HouseEvent

COHERENT, ANY = ("and", "or", "vote"), ("and", "and", "or", "or", "vote", "not", "xor")
SHAPES = ("shared", "deep", "wide", "modules", "twins", "products")
SPECIAL = (Fraction(0), Fraction(1), Fraction(1, 2), Fraction(1, 1000))


def random_tree(seed, events=8, coherent=None, rare=False):
    """A tree over at most `events` basic events; the same one for the same arguments.

    `coherent` says whether it has no not and no xor (None: either); `rare` gives probabilities as in practice.
    """
    rng = random.Random(f"{seed} {events} {coherent} {rare}")
    if coherent is None:
        coherent = rng.random() < 0.5
    shape = rng.choice(SHAPES)
    basic = [
        BasicEvent(f"e{i}", _probability(rng, rare)) for i in range(max(rng.randint(1, events), rng.randint(1, events)))
    ]
    houses = [HouseEvent(f"h{i}", rng.random() < 0.5) for i in range(rng.choice((0, 0, 0, 0, 1, 2)))]
    leaves = [event.name for event in basic]
    grower = _Grower(rng, COHERENT if coherent else ANY, shape)
    if shape == "modules":
        parts = [part for i in range(rng.randint(2, 4)) if (part := leaves[i::4])]
        leaves = [grower.grow(part, rng.randint(1, 4)) for part in parts]
    leaves += [house.name for house in houses]
    count = rng.randint(1 + len(basic) // 2, 2 * len(basic) + 2)
    top = grower.products(leaves, count) if shape == "products" else grower.grow(leaves, count)
    rng.shuffle(grower.gates)
    return FaultTree(f"random {seed}", top, tuple(grower.gates), tuple(basic), tuple(houses))


def _probability(rng, rare):
    if rare:
        return Fraction(rng.randint(1, 99), 10 ** rng.randint(2, 7))
    if rng.random() < 0.1:
        return rng.choice(SPECIAL)
    return Fraction(rng.randint(1, 63), 64)


class _Grower:
    """Gates made one after the other, each over what is there before it."""

    def __init__(self, rng, kinds, shape):
        self.rng, self.kinds, self.shape, self.gates = rng, kinds, shape, []

    def grow(self, leaves, count):
        """Make `count` gates over `leaves`, then more over those that no other uses; the name of the last."""
        gates, supply = [], []
        for _ in range(count):
            arity = self._arity()
            if len(supply) < arity:  # every leaf comes once before any comes again
                supply += self.rng.sample(leaves, len(leaves))
            drawn, supply = supply[:arity], supply[arity:]
            if gates and self.rng.random() < 0.7:
                drawn[-1] = gates[-1] if self.shape == "deep" else self.rng.choice(gates)
            gates.append(self._add(drawn))
            if self.shape == "twins":
                gates.append(self._twin(self.gates[-1]))
        used = {name for gate in self.gates for name in gate.inputs}
        loose = [name for name in dict.fromkeys(gates) if name not in used]
        while len(loose) > 1:
            loose = [*loose[3:], self._add([*loose[:3], *self.rng.sample(leaves, self.rng.randint(0, 1))])]
        return loose[0]

    def products(self, leaves, count):
        """A gate over many ands of a few leaves, or of their opposites; its name."""
        if "not" in self.kinds:
            self.gates += [Gate(f"no-{name}", "not", (name,)) for name in leaves]
            leaves = [*leaves, *(gate.name for gate in self.gates)]
        sizes = [min(len(leaves), self.rng.choice((2, 2, 3, 3, 4))) for _ in range(count)]
        terms = tuple(dict.fromkeys(tuple(self.rng.sample(leaves, size)) for size in sizes))
        self.gates += [Gate(f"p{i}", "and", term) for i, term in enumerate(terms)]
        kind = self.rng.choice(("or", "or", "xor", "vote")) if "xor" in self.kinds else "or"
        self.gates.append(Gate("sum", kind, tuple(f"p{i}" for i in range(len(terms))), 1 if kind == "vote" else None))
        return "sum"

    def _add(self, inputs):
        """A gate over `inputs`, one of which is enough for a not."""
        below = {gate.kind for gate in self.gates if gate.name in inputs}
        kinds = [kind for kind in self.kinds if kind not in below or self.rng.random() < 0.2]
        kind, names = self.rng.choice(kinds or self.kinds), tuple(dict.fromkeys(inputs))
        if kind == "not":
            names = names[-1:]
        k = self.rng.choice((1, (len(names) + 1) // 2, len(names) // 2 + 1, len(names))) if kind == "vote" else None
        self.gates.append(Gate(f"g{len(self.gates)}", kind, names, k))
        return self.gates[-1].name

    def _twin(self, gate):
        """The same gate once more, its inputs in another order; a vote may want more or fewer of them."""
        names = tuple(self.rng.sample(gate.inputs, len(gate.inputs)))
        k = self.rng.randint(1, len(names)) if gate.kind == "vote" and self.rng.random() < 0.5 else gate.k
        self.gates.append(Gate(f"g{len(self.gates)}", gate.kind, names, k))
        return self.gates[-1].name

    def _arity(self):
        if self.shape in ("wide", "twins"):
            return self.rng.randint(3, 7)
        return self.rng.choice((1, 2, 2, 2, 2, 2, 2, 3, 3, 3, 4))

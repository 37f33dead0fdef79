# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Simplification of a graph of gates.

While it is simplified a graph is signed: ands, votes and exclusive ors over literals, an "or" being the complement of
an "and" of complements, and equal gates the same gate.  `reduce` writes it with ands and ors again, complemented where
that keeps monotone parts free of complements below.

This file runs compiled (Cython) and interpreted, with the same results.

Source: A. Rauzy and Y. Dutuit, "Exact and Truncated Computations of Prime Implicants of Coherent and Non-Coherent
Fault Trees within Aralia", Reliability Engineering and System Safety 58 (1997), for constants and coalescing.
"""

from array import array

import cython

from safety.trees.kernel import load
from safety.trees.kernel.flat import FlatGraph

AND = cython.declare(cython.int, 0)
OR = cython.declare(cython.int, 1)
VOTE = cython.declare(cython.int, 2)
XOR = cython.declare(cython.int, 3)
ROUNDS = 8  # of simplification; the last ones change little
FEW, MANY = 1, 8  # copies of a gate, in different contexts

absorb = load("absorb", interpreted=not cython.compiled).absorb
gather = load("modules", interpreted=not cython.compiled).gather
merge = load("merge", interpreted=not cython.compiled).merge
written = load("written", interpreted=not cython.compiled).written


def reduce(flat):
    """The same function of the same variables by fewer gates and fewer repeated references; the root may be constant.

    Complemented literals of gates are left only where a gate is needed both ways or its complement is not monotone.
    """
    best = signed(signed(flat, False))
    costs = cost(best)
    copies = FEW
    for _ in range(ROUNDS):
        if costs[0] == 0:
            break
        better = simplified(best, copies)
        better_costs = costs if better is best else cost(better)
        if better_costs < costs:
            best, costs, copies = better, better_costs, FEW
        elif copies == FEW and shared_gates(best):
            copies = MANY
        else:
            break
    return gather(written(best, references(best)))


def simplified(flat, copies: cython.int):
    """A signed graph after one round of everything, which may have made it larger; itself if nothing could be done."""
    absorbed = absorb(flat, references(flat), copies)
    if absorbed is not flat:
        absorbed = signed(absorbed)
    merged = merge(absorbed, references(absorbed))
    return merged if merged is absorbed else signed(merged)


def shared_gates(flat):
    """Whether some gate has more than one user, so that copies of it could be absorbed into each apart."""
    return max(references(flat)[flat.variables + 1 :], default=0) > 1


def cost(flat):
    """Repeated references first, then gates: what makes diagrams large, then what makes them slow to build."""
    return repeats(flat), len(flat)


def repeats(flat):
    """The number of references to gates and variables beyond the first of each."""
    refs = references(flat)
    i: cython.int
    total: cython.int = 0
    counted: cython.int[::1] = refs
    for i in range(1, len(refs)):
        if counted[i] > 1:
            total += counted[i] - 1
    return total


def references(flat):
    """By index, how often it is an input of a gate that the root reaches; the root has one more."""
    start: cython.int[::1] = flat.start
    inputs: cython.int[::1] = flat.inputs
    first: cython.int = flat.variables + 1
    result = array("i", bytes(4 * (first + len(flat.kind))))
    refs: cython.int[::1] = result
    g: cython.int
    i: cython.int
    refs[flat.root >> 1] += 1
    for g in range(len(flat.kind) - 1, -1, -1):
        if refs[first + g]:
            for i in range(start[g], start[g + 1]):
                refs[inputs[i] >> 1] += 1
    return result


@cython.cclass
class Gates:
    """Signed gates, made one by one, each once; `work` holds the literals of the gate being made."""

    variables: cython.int
    kind: cython.int[::1]
    k: cython.int[::1]
    start: cython.int[::1]
    inputs: cython.int[::1]
    chain: cython.int[::1]  # the next gate of the same bucket, plus one
    bucket: cython.int[::1]
    work: cython.int[::1]
    mark: cython.int[::1]  # by literal: the number of the gate being made, where it is among its literals
    count: cython.int
    made: cython.int

    def __init__(self, variables: cython.int, gates: cython.int, inputs: cython.int):
        self.variables = variables
        self.kind, self.k = array("i", bytes(4 * gates + 4)), array("i", bytes(4 * gates + 4))
        self.start, self.chain = array("i", bytes(4 * gates + 8)), array("i", bytes(4 * gates + 4))
        self.inputs = array("i", bytes(4 * inputs + 4))
        size: cython.int = 64
        while size < gates:
            size *= 2
        self.bucket = array("i", bytes(4 * size))
        self.work = array("i", bytes(4 * inputs + 4))
        self.mark = array("i", bytes(8 * (variables + gates + 2)))
        self.count = self.made = 0

    @cython.cfunc
    @cython.exceptval(check=False)
    def sort(self, n: cython.int) -> cython.void:
        """The first `n` literals of `work` in increasing order: insertion for short gates, a heap for long ones."""
        i: cython.int
        j: cython.int
        literal: cython.int
        if n > 24:
            for i in range(n // 2 - 1, -1, -1):
                self.sift(i, n)
            for i in range(n - 1, 0, -1):
                self.work[0], self.work[i] = self.work[i], self.work[0]
                self.sift(0, i)
            return
        for i in range(1, n):
            literal = self.work[i]
            j = i
            while j > 0 and self.work[j - 1] > literal:
                self.work[j] = self.work[j - 1]
                j -= 1
            self.work[j] = literal

    @cython.cfunc
    @cython.exceptval(check=False)
    def sift(self, i: cython.int, n: cython.int) -> cython.void:
        """Let the i-th sink in the heap of the first `n`, the largest at the top."""
        child: cython.int
        literal: cython.int = self.work[i]
        while 2 * i + 1 < n:
            child = 2 * i + 1
            if child + 1 < n and self.work[child + 1] > self.work[child]:
                child += 1
            if self.work[child] <= literal:
                break
            self.work[i] = self.work[child]
            i = child
        self.work[i] = literal

    @cython.cfunc
    @cython.exceptval(check=False)
    def gate(self, kind: cython.int, k: cython.int, n: cython.int) -> cython.int:
        """The literal of that gate over the first `n` literals of `work`, which are used up."""
        flip: cython.int = 0
        i: cython.int
        m: cython.int = 0
        if kind == OR:
            kind, flip = AND, 1
            for i in range(n):
                self.work[i] ^= 1
        if kind == VOTE:
            self.sort(n)
            i = 0
            while i < n:
                if self.work[i] == 0:
                    k -= 1
                elif self.work[i] != 1:
                    if m and self.work[m - 1] == (self.work[i] ^ 1):
                        m -= 1  # exactly one of the two
                        k -= 1
                    else:
                        self.work[m] = self.work[i]
                        m += 1
                i += 1
            n = m
            if k <= 0 or k > n:
                return 0 if k <= 0 else 1
            if k == 1 or k == n:
                kind = AND
                if k == 1 and n > 1:
                    return self.gate(OR, 0, n)
            elif self.work[0] & 1:
                flip = 1
                k = n - k + 1
                for i in range(n):
                    self.work[i] ^= 1
                self.sort(n)
        if kind == XOR:
            for i in range(n):
                flip ^= self.work[i] & 1
                self.work[i] &= -2
            self.sort(n)
            for i in range(n):
                if self.work[i] == 0:
                    flip ^= 1
                elif m and self.work[m - 1] == self.work[i]:
                    m -= 1
                else:
                    self.work[m] = self.work[i]
                    m += 1
            n = m
            if n == 0:
                return 1 ^ flip
        if kind == AND:
            n = self.conjunction(n)
            if n < 0:
                return 1 ^ flip
            if n == 0:
                return flip
        if n == 1:
            return self.work[0] ^ flip
        return 2 * self.known(kind, k if kind == VOTE else 0, n) + flip

    @cython.cfunc
    @cython.exceptval(check=False)
    def conjunction(self, n: cython.int) -> cython.int:
        """How many literals of `work` an "and" of them needs, -1 if it is false; they are sorted.

        What an "and" below says already is left out, and so is an "or" below that one of the literals makes true.
        """
        i: cython.int
        j: cython.int
        g: cython.int
        m: cython.int = 0
        dropped: cython.int = 0
        literal: cython.int
        self.sort(n)
        self.made += 1
        for i in range(n):
            literal = self.work[i]
            if literal == 1 or self.mark[literal ^ 1] == self.made:
                return -1
            if literal and self.mark[literal] != self.made:
                self.mark[literal] = self.made
                self.work[m] = literal
                m += 1
        n = m
        for i in range(n):
            literal = self.work[i]
            g = (literal >> 1) - self.variables - 1
            if g < 0 or self.kind[g] != AND:
                continue
            for j in range(self.start[g], self.start[g + 1]):
                if literal & 1:
                    if self.mark[self.inputs[j] ^ 1] == self.made:
                        self.mark[literal] = 0
                        dropped += 1
                        break
                elif self.mark[self.inputs[j]] == self.made:
                    self.mark[self.inputs[j]] = 0
                    dropped += 1
                elif self.mark[self.inputs[j] ^ 1] == self.made:
                    return -1
        if dropped:
            m = 0
            for i in range(n):
                if self.mark[self.work[i]] == self.made:
                    self.work[m] = self.work[i]
                    m += 1
        return m

    @cython.cfunc
    @cython.exceptval(check=False)
    def known(self, kind: cython.int, k: cython.int, n: cython.int) -> cython.int:
        """The index of that gate, entered if it is new."""
        mixed: cython.longlong = kind * 7919 + k * 104729
        i: cython.int
        g: cython.int
        at: cython.int
        for i in range(n):
            mixed = (mixed * 1000003 + self.work[i]) & 0x3FFFFFFF
        slot: cython.longlong = (mixed ^ (mixed >> 13)) & (len(self.bucket) - 1)
        g = self.bucket[slot] - 1
        while g >= 0:
            at = self.start[g]
            if self.kind[g] == kind and self.k[g] == k and self.start[g + 1] - at == n:
                i = 0
                while i < n and self.inputs[at + i] == self.work[i]:
                    i += 1
                if i == n:
                    return self.variables + 1 + g
            g = self.chain[g] - 1
        g = self.count
        self.count += 1
        self.kind[g], self.k[g] = kind, k
        at = self.start[g]
        for i in range(n):
            self.inputs[at + i] = self.work[i]
        self.start[g + 1] = at + n
        self.chain[g] = self.bucket[slot]
        self.bucket[slot] = g + 1
        return self.variables + 1 + g

    def graph(self, root: cython.int):
        """What was made, as a graph whose function is `root`; gates that it does not need are still there."""
        return FlatGraph(
            self.variables,
            array("i", self.kind[: self.count]),
            array("i", self.k[: self.count]),
            array("i", self.start[: self.count + 1]),
            array("i", self.inputs[: self.start[self.count]]),
            root,
        )


def signed(flat, coalesce: cython.bint = True):
    """The graph that the root reaches as signed gates: constants gone, equal gates the same, gates of one input gone.

    With `coalesce`, an input of the kind of its gate that is used nowhere else is replaced by its own inputs.
    """
    kind: cython.int[::1] = flat.kind
    k: cython.int[::1] = flat.k
    start: cython.int[::1] = flat.start
    inputs: cython.int[::1] = flat.inputs
    variables: cython.int = flat.variables
    first: cython.int = variables + 1
    count: cython.int = len(kind)
    refs: cython.int[::1] = references(flat)
    literal_of: cython.int[::1] = array("i", range(0, 2 * (first + count), 2))
    inside: cython.char[::1] = bytearray(count + 1)  # the gates that are coalesced with the one above
    agenda: cython.int[::1] = array("i", bytes(4 * count + 4))
    waiting: cython.int
    g: cython.int
    h: cython.int
    c: cython.int
    i: cython.int
    n: cython.int
    literal: cython.int
    gates: Gates = Gates(variables, count, len(inputs))
    if coalesce:
        for g in range(count):
            if kind[g] != VOTE:
                for i in range(start[g], start[g + 1]):
                    c = (inputs[i] >> 1) - first
                    if c < 0 or kind[c] != kind[g] or refs[inputs[i] >> 1] != 1:
                        continue
                    if kind[g] == XOR or not inputs[i] & 1:
                        inside[c] = refs[first + g] > 0
    for g in range(count):
        if refs[first + g] == 0 or inside[g]:
            continue
        n = 0
        agenda[0] = g
        waiting = 1
        while waiting:
            waiting -= 1
            h = agenda[waiting]
            for i in range(start[h], start[h + 1]):
                literal = inputs[i]
                c = (literal >> 1) - first
                if c >= 0 and inside[c]:
                    agenda[waiting] = c
                    waiting += 1
                    if literal & 1:  # an exclusive or in another
                        gates.work[n] = 0
                        n += 1
                else:
                    gates.work[n] = literal_of[literal >> 1] ^ (literal & 1)
                    n += 1
        literal_of[first + g] = gates.gate(kind[g], k[g], n)
    return gates.graph(literal_of[flat.root >> 1] ^ (flat.root & 1))

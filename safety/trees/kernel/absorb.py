# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Absorption in a signed graph: below an "and", its other inputs are true, so x & f(x) becomes x & f(true).

What is known to be true wherever the value of a gate matters, its context, is carried down through all levels. A gate
with several users has the context common to them, or is copied for those who know more.

All replacements are made at once. That is right because of a false "and" only the lowest false input counts: its
context as far as it occurs below it is true, so it stays false.

This file runs compiled (Cython) and interpreted, with the same results.

Source: the satisfiability and observability don't-cares of multi-level logic (R. K. Brayton et al., "Multilevel Logic
Synthesis", Proc. IEEE 78 (1990)), with direct inputs as the only conditions.
"""

from array import array

import cython

from safety.trees.kernel.flat import FlatGraph

AND = cython.declare(cython.int, 0)
BITS = cython.declare(cython.int, 62)  # of a word that are used, so that it is never negative
MEMORY = cython.declare(cython.int, 1 << 22)  # words


def absorb(flat, refs: cython.int[::1], copies: cython.int):
    """The same function with at most `copies` copies of a gate; constants among the inputs are still there.

    `flat` itself if there is nothing to absorb.

    `refs` is the number of references by index.
    """
    if flat.root >> 1 <= flat.variables:
        return flat
    contexts = Contexts(flat, refs, copies)
    return contexts.graph() if contexts.replaced else flat


@cython.cclass
class Contexts:
    """States: a gate in a context, which is two rows of bits, of the shared indices known true and known false."""

    kind: cython.int[::1]
    k: cython.int[::1]
    start: cython.int[::1]
    inputs: cython.int[::1]
    column: cython.int[::1]  # of an index that is used more than once, -1 for others
    cone: cython.longlong[::1]  # by gate, the columns that occur below it
    known: cython.longlong[::1]  # by state: a row of true columns, a row of false ones
    wanted: cython.longlong[::1]  # the context being made
    head: cython.int[::1]  # by gate, its last state plus one
    before: cython.int[::1]  # by state, the one before it of the same gate, plus one
    owned: cython.int[::1]  # by gate, how many states it has
    base: cython.int[::1]  # by state, where its inputs begin in `below`
    below: cython.int[::1]  # a literal with a state for its gate: 2 * state + complement, -2 for true, -1 for false
    words: cython.int
    states: cython.int
    replaced = cython.declare(cython.int, visibility="public")  # inputs that a context decides
    most: cython.int
    copies: cython.int
    used: cython.int  # of `below`
    first: cython.int
    count: cython.int
    variables: cython.int
    root: cython.int

    def __init__(self, flat, refs: cython.int[::1], copies: cython.int):
        g: cython.int
        i: cython.int
        c: cython.int
        w: cython.int
        columns: cython.int = 0
        self.kind, self.k, self.start, self.inputs = flat.kind, flat.k, flat.start, flat.inputs
        self.variables, self.first, self.count = flat.variables, flat.variables + 1, len(flat.kind)
        self.root, self.copies, self.states = flat.root, copies, 0
        self.most = self.count if copies == 1 else 3 * self.count + 64
        room: cython.int = max(1, MEMORY // (2 * self.most))
        self.column = array("i", bytes(4 * len(refs)))
        for i in range(len(refs)):
            self.column[i] = -1
            if i and refs[i] > 1 and columns < room * BITS:
                self.column[i] = columns
                columns += 1
        self.words = w = columns // BITS + 1
        self.cone = array("q", bytes(8 * self.count * w))
        self.known = array("q", bytes(16 * self.most * w))
        self.wanted = array("q", bytes(16 * w))
        self.head, self.owned = array("i", bytes(4 * self.count)), array("i", bytes(4 * self.count))
        self.before, self.base = array("i", bytes(4 * self.most)), array("i", bytes(4 * self.most))
        self.below = array("i", bytes(4 * (len(flat.inputs) + 64)))
        for g in range(self.count):
            for i in range(self.start[g], self.start[g + 1]):
                c = self.inputs[i] >> 1
                if self.column[c] >= 0:
                    self.cone[g * w + self.column[c] // BITS] |= (
                        cython.cast(cython.longlong, 1) << self.column[c] % BITS
                    )
                if c >= self.first:
                    for columns in range(w):
                        self.cone[g * w + columns] |= self.cone[(c - self.first) * w + columns]
        self.replaced = self.used = 0
        self.go_down()

    @cython.cfunc
    @cython.exceptval(check=False)
    @cython.inline
    def bit(self, row: cython.longlong[::1], at: cython.longlong, literal: cython.int) -> cython.bint:
        """Whether the context whose rows begin at word `at` says that the literal is true."""
        column: cython.int = self.column[literal >> 1]
        if column < 0:
            return False
        at += column // BITS + (self.words if literal & 1 else 0)
        return (row[at] >> column % BITS) & 1

    @cython.cfunc
    @cython.exceptval(check=False)
    @cython.inline
    def flip(self, literal: cython.int) -> cython.void:
        """Say or unsay in `wanted` that the literal is true."""
        column: cython.int = self.column[literal >> 1]
        if column >= 0:
            self.wanted[column // BITS + (self.words if literal & 1 else 0)] ^= (
                cython.cast(cython.longlong, 1) << column % BITS
            )

    @cython.cfunc
    @cython.exceptval(check=False)
    def state(self, g: cython.int) -> cython.int:
        """The state of the gate in the context `wanted`, or in as much of it as there is room for."""
        i: cython.int
        s: cython.int = self.head[g] - 1
        w: cython.int = self.words
        at: cython.longlong
        common: cython.longlong
        cone: cython.longlong = cython.cast(cython.longlong, g) * w
        while s >= 0:
            at = 2 * cython.cast(cython.longlong, s) * w
            i = 0
            while (
                i < w
                and self.known[at + i] == self.wanted[i] & self.cone[cone + i]
                and self.known[at + w + i] == self.wanted[w + i] & self.cone[cone + i]
            ):
                i += 1
            if i == w:
                return s
            s = self.before[s] - 1
        if self.owned[g] and (self.owned[g] == self.copies or self.states >= self.most - self.count):
            s = self.head[g] - 1
            at = 2 * cython.cast(cython.longlong, s) * w
            for i in range(2 * w):
                common = self.known[at + i] & self.wanted[i]
                self.known[at + i] = common
            return s
        s = self.states
        self.states += 1
        at = 2 * cython.cast(cython.longlong, s) * w
        for i in range(w):
            self.known[at + i] = self.wanted[i] & self.cone[cone + i]
            self.known[at + w + i] = self.wanted[w + i] & self.cone[cone + i]
        self.before[s] = self.head[g]
        self.head[g] = s + 1
        self.owned[g] += 1
        return s

    @cython.cfunc
    def go_down(self) -> cython.void:
        """Make all states that are needed, from the root's on."""
        g: cython.int
        h: cython.int
        s: cython.int
        i: cython.int
        arity: cython.int
        literal: cython.int
        at: cython.longlong
        used: cython.int = 0
        self.state((self.root >> 1) - self.first)
        for g in range(self.count - 1, -1, -1):
            s = self.head[g] - 1
            arity = self.start[g + 1] - self.start[g]
            while s >= 0:
                if used + arity > len(self.below):
                    wider = array("i", bytes(8 * len(self.below) + 4 * arity))
                    wider[:used] = array("i", self.below[:used])
                    self.below = wider
                self.base[s] = used
                at = 2 * cython.cast(cython.longlong, s) * self.words
                for i in range(2 * self.words):
                    self.wanted[i] = self.known[at + i]
                for i in range(self.start[g], self.start[g + 1]):
                    literal = self.inputs[i]
                    if self.kind[g] == AND and not self.bit(self.known, at, literal):
                        self.flip(literal)
                for i in range(self.start[g], self.start[g + 1]):
                    literal = self.inputs[i]
                    h = (literal >> 1) - self.first
                    if self.bit(self.known, at, literal):
                        self.below[used] = -2
                        self.replaced += 1
                    elif self.bit(self.known, at, literal ^ 1):
                        self.below[used] = -1
                        self.replaced += 1
                    elif h < 0:
                        self.below[used] = literal
                    else:
                        if self.kind[g] == AND:
                            self.flip(literal)
                        self.below[used] = 2 * self.state(h) + (literal & 1)
                        if self.kind[g] == AND:
                            self.flip(literal)
                    used += 1
                s = self.before[s] - 1
        self.used = used

    def graph(self):
        """The graph of all states."""
        g: cython.int
        s: cython.int
        i: cython.int
        literal: cython.int
        n: cython.int = 0
        used: cython.int = self.used
        new_kind, new_k = array("i", bytes(4 * self.states)), array("i", bytes(4 * self.states))
        new_start, new_inputs = array("i", bytes(4 * self.states + 4)), array("i", bytes(4 * used))
        index_of: cython.int[::1] = array("i", bytes(4 * self.states))
        kinds: cython.int[::1] = new_kind
        ks: cython.int[::1] = new_k
        starts: cython.int[::1] = new_start
        filled: cython.int[::1] = new_inputs
        used = 0
        for g in range(self.count):
            s = self.head[g] - 1
            while s >= 0:
                index_of[s] = self.first + n
                kinds[n], ks[n] = self.kind[g], self.k[g]
                for i in range(self.start[g + 1] - self.start[g]):
                    literal = self.below[self.base[s] + i]
                    if literal < 0:
                        literal += 2
                    elif self.inputs[self.start[g] + i] >> 1 >= self.first:
                        literal = 2 * index_of[literal >> 1] + (literal & 1)
                    filled[used] = literal
                    used += 1
                n += 1
                starts[n] = used
                s = self.before[s] - 1
        root = 2 * index_of[self.head[(self.root >> 1) - self.first] - 1] + (self.root & 1)
        return FlatGraph(self.variables, new_kind, new_k, new_start, new_inputs, root)

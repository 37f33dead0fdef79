# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Prime implicants of a function given as a diagram, as a diagram of families of products.

A node of a family stands for the products of `none`, those of `plain` each with its variable, and those of `negated`
each with the opposite of its variable. Family 0 has no product, family 1 the empty one. The primes of a function are
those of f1 & f0, without its variable, and with it those of f1, and of f0, that are not among the former.

This file runs compiled (Cython) and interpreted, with the same results.

Source: O. Coudert, J. C. Madre, "Implicit and Incremental Computation of Primes and Essential Primes of Boolean
Functions", DAC 1992.
"""

from array import array

import cython

FULL = cython.declare(cython.int, -1)
FUNCTION = cython.declare(cython.int, 0)  # kinds of entries of the table
FAMILY = cython.declare(cython.int, 1)
BOTH = cython.declare(cython.int, 0)  # operations
WITHOUT = cython.declare(cython.int, 1)
PRIMES = cython.declare(cython.int, 2)
PATIENCE = cython.declare(cython.longlong, 1 << 18)  # questions to the cache in vain between two looks at signals


@cython.cclass
class Primes:
    """Functions and families in one table of at most `budget` nodes; `full` tells that it needed more."""

    full = cython.declare(cython.bint, visibility="public")
    node: cython.int[::1]  # six a node: kind, level, high or plain, low or negated, none, next of its bucket
    bucket: cython.int[::1]
    cache: cython.int[::1]  # four a slot: operation, f, g, result
    count: cython.int
    room: cython.int
    budget: cython.int
    levels: cython.int
    missed: cython.longlong  # questions to the cache in vain
    pulse: object  # called from time to time: lets signals in; what it raises ends the work

    def __init__(self, levels: cython.int, budget: cython.int, pulse=None):
        self.missed, self.pulse = 0, pulse
        self.levels, self.budget, self.room, self.full = levels, max(budget, 2), 2, False
        self.node, self.count = array("i", bytes(48)), 2
        self.bucket, self.cache = array("i", [0]), array("i", [0])
        self.node[1] = self.node[7] = levels
        self.grow(1024)

    @cython.cfunc
    def grow(self, room: cython.int) -> cython.int:
        """Room for more nodes, as far as the budget goes."""
        i: cython.longlong
        slot: cython.longlong
        size: cython.longlong = 1024
        room = min(room, self.budget)
        if room <= self.room:
            self.full = True
            return FULL
        old = self.node
        self.node = array("i", bytes(24 * room))
        self.node[: 6 * self.count] = old[: 6 * self.count]
        self.room = room
        while size < room:
            size *= 2
        self.bucket, self.cache = array("i", bytes(4 * size)), array("i", bytes(16 * size))
        for i in range(2, self.count):
            slot = self.slot(self.node[6 * i + 1], self.node[6 * i + 2], self.node[6 * i + 3], self.node[6 * i + 4])
            self.node[6 * i + 5] = self.bucket[slot]
            self.bucket[slot] = i
        return 0

    @cython.cfunc
    def slot(self, a: cython.longlong, b: cython.longlong, c: cython.longlong, d: cython.longlong) -> cython.longlong:
        """The bucket of four numbers."""
        mixed: cython.longlong = a * 741457 + b * 12582917 + c * 4256249 + d * 1000003
        return (mixed ^ (mixed >> 15)) & (len(self.bucket) - 1)

    @cython.cfunc
    def make(
        self, kind: cython.int, level: cython.int, high: cython.int, low: cython.int, none: cython.int
    ) -> cython.int:
        """That node, or FULL."""
        i: cython.longlong
        if high < 0 or low < 0 or none < 0:
            return FULL
        if kind == FUNCTION and high == low:
            return high
        if kind == FAMILY and high == 0 and low == 0:
            return none
        slot: cython.longlong = self.slot(level, high, low, none)
        i = self.bucket[slot]
        while i:
            if (
                self.node[6 * i + 2] == high
                and self.node[6 * i + 3] == low
                and self.node[6 * i + 4] == none
                and self.node[6 * i + 1] == level
                and self.node[6 * i] == kind
            ):
                return i
            i = self.node[6 * i + 5]
        if self.count >= self.room:
            if self.grow(2 * self.room) < 0:
                return FULL
            slot = self.slot(level, high, low, none)
        i = self.count
        self.count += 1
        self.node[6 * i], self.node[6 * i + 1], self.node[6 * i + 2] = kind, level, high
        self.node[6 * i + 3], self.node[6 * i + 4], self.node[6 * i + 5] = low, none, self.bucket[slot]
        self.bucket[slot] = i
        return i

    @cython.cfunc
    def part(self, operation: cython.int, f: cython.longlong, level: cython.int, which: cython.int) -> cython.int:
        """Child number `which` of f at that level: high and low of a function; plain, negated and none of a family."""
        if self.node[6 * f + 1] == level:
            return self.node[6 * f + 2 + which]
        return f if operation == BOTH or which == 2 else 0

    @cython.cfunc
    def apply(self, operation: cython.int, f: cython.int, g: cython.int) -> cython.int:
        """BOTH: the function f and g. WITHOUT: the products of f that are not in g. PRIMES: those of f. Or FULL."""
        none: cython.int
        high: cython.int
        low: cython.int
        if operation == PRIMES:
            if f < 2:
                return f
        elif operation == BOTH:
            if f > g:
                f, g = g, f
            if f == 0 or f == g:
                return f
            if f == 1:
                return g
        elif f == g or f == 0:
            return 0
        elif g == 0:
            return f
        slot: cython.longlong = 4 * self.slot(operation, f, g, 0)
        if self.cache[slot + 1] == f and self.cache[slot + 2] == g and self.cache[slot] == operation:
            return self.cache[slot + 3]
        self.missed += 1
        if self.pulse is not None and self.missed % PATIENCE == 0:
            self.pulse()
        level: cython.int = self.node[6 * cython.cast(cython.longlong, f) + 1]
        if operation == PRIMES:
            high, low = self.part(operation, f, level, 0), self.part(operation, f, level, 1)
            none = self.apply(BOTH, high, low)
            none = none if none < 0 else self.apply(PRIMES, none, 0)
            high, low = self.apply(PRIMES, high, 0), self.apply(PRIMES, low, 0)
            if none < 0 or high < 0 or low < 0:
                return FULL
            high, low = self.apply(WITHOUT, high, none), self.apply(WITHOUT, low, none)
        else:
            level = min(level, self.node[6 * cython.cast(cython.longlong, g) + 1])
            high = self.apply(operation, self.part(operation, f, level, 0), self.part(operation, g, level, 0))
            low = self.apply(operation, self.part(operation, f, level, 1), self.part(operation, g, level, 1))
            none = 0
            if operation == WITHOUT:
                none = self.apply(WITHOUT, self.part(operation, f, level, 2), self.part(operation, g, level, 2))
        result: cython.int = self.make(FUNCTION if operation == BOTH else FAMILY, level, high, low, none)
        if result >= 0:
            slot = 4 * self.slot(operation, f, g, 0)
            self.cache[slot], self.cache[slot + 1], self.cache[slot + 2] = operation, f, g
            self.cache[slot + 3] = result
        return result

    def of(self, level: cython.int[::1], high: cython.int[::1], low: cython.int[::1], root: cython.int):
        """The family of the primes of a diagram with complement edges (`kernel/diagram.py`), or -1 past the budget."""
        i: cython.int
        side: cython.int
        edges: cython.int[::1] = array("i", bytes(8 * len(level)))
        edges[0], edges[1] = 1, 0
        for i in range(1, len(level)):
            for side in range(2):
                edges[2 * i + side] = self.make(FUNCTION, level[i], edges[high[i] ^ side], edges[low[i] ^ side], 0)
        return FULL if edges[root] < 0 else self.apply(PRIMES, edges[root], 0)

    def family(self, root: cython.int):
        """The nodes below a family, children first, as (level, plain, negated, none) from number 2; and its own."""
        i: cython.longlong
        j: cython.int
        number = {0: 0, 1: 1}
        needed = bytearray(max(2, root + 1))
        needed[root] = 1
        for i in range(root, 1, -1):
            if needed[i]:
                for j in range(2, 5):
                    needed[self.node[6 * i + j]] = 1
        nodes = []
        for i in range(2, root + 1):
            if needed[i]:
                number[i] = len(nodes) + 2
                nodes.append((self.node[6 * i + 1], *(number[self.node[6 * i + j]] for j in range(2, 5))))
        return nodes, number[root]

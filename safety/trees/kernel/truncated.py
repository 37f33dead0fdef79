# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Minimal cut sets within limits, gate by gate from below, without a diagram of the function.

A limit is on the number of events of a set, and on the sum of their weights. A set within the limits is put together
from sets within them, so what is beyond them is dropped wherever it turns up. Only for gates without complements.

A node stands for the sets of `low`, and those of `high` each with its variable. Node 0 is the family without a set,
node 1 that of the empty set.

This file runs compiled (Cython) and interpreted, with the same results.

Source: S. Minato, "Zero-Suppressed BDDs for Set Manipulation in Combinatorial Problems", DAC 1993; A. Rauzy, "New
Algorithms for Fault Trees Analysis", Reliability Engineering and System Safety 40 (1993).
"""

from array import array

import cython

NONE = cython.declare(cython.int, 0)
EMPTY = cython.declare(cython.int, 1)
FULL = cython.declare(cython.int, -1)  # no room: what an operation gives then
AND = cython.declare(cython.int, 0)
OR = cython.declare(cython.int, 1)
UNION = cython.declare(cython.int, -1)  # operations, where a product has its limit of order
WITHOUT = cython.declare(cython.int, -2)
WIDTH = cython.declare(cython.int, 8)  # of a node: level, high, low, next of its bucket, and of its sets
LEAST = cython.declare(cython.int, 4)  # the smallest and the largest order,
MOST = cython.declare(cython.int, 5)
LIGHTEST = cython.declare(cython.int, 6)  # the smallest and the largest weight
HEAVIEST = cython.declare(cython.int, 7)
STEPS = cython.declare(cython.longlong, 16)  # of work for a node of the budget


@cython.final
@cython.cclass
class Truncating:
    """Families of sets over levels of these weights, in one table of at most `budget` nodes.

    `full` tells that it needed more, or too much work; `cut` that something was beyond a limit and was dropped.
    """

    full = cython.declare(cython.bint, visibility="public")
    cut = cython.declare(cython.bint, visibility="public")
    node: cython.int[::1]
    bucket: cython.int[::1]
    cache: cython.int[::1]  # five a slot: f, g, order, weight, result
    weight: cython.int[::1]
    chance: cython.double[::1]  # by level
    best: cython.double[::1]  # by node, the largest and the smallest chance of its sets
    worst: cython.double[::1]
    count: cython.int
    room: cython.int
    budget: cython.int
    steps: cython.longlong

    def __init__(self, weight: cython.int[::1], budget: cython.int):
        self.weight, self.budget, self.room, self.count = weight, max(budget, 2), 2, 2
        self.full = self.cut = False
        self.steps = STEPS * self.budget
        self.node = array("i", bytes(64))
        self.bucket, self.cache = array("i", [0]), array("i", [0] * 5)
        self.chance = self.best = self.worst = array("d")
        self.node[0] = self.node[8] = len(weight)
        self.node[LEAST] = self.node[LIGHTEST] = 0x7FFFFFFF
        self.grow(1024)

    @cython.cfunc
    def grow(self, room: cython.longlong) -> cython.int:
        """Room for more nodes, as far as the budget goes."""
        i: cython.longlong
        slot: cython.longlong
        size: cython.longlong = 1024
        room = min(room, self.budget)
        if room <= self.room:
            self.full = True
            return FULL
        old = self.node
        self.node = array("i", bytes(4 * WIDTH * room))
        self.node[: WIDTH * self.count] = old[: WIDTH * self.count]
        self.room = room
        while size < room:
            size *= 2
        self.bucket, self.cache = array("i", bytes(4 * size)), array("i", bytes(20 * size))
        for i in range(2, self.count):
            slot = self.slot(self.node[WIDTH * i], self.node[WIDTH * i + 1], self.node[WIDTH * i + 2], 0)
            self.node[WIDTH * i + 3] = self.bucket[slot]
            self.bucket[slot] = i
        return 0

    @cython.cfunc
    @cython.exceptval(check=False)
    @cython.inline
    def slot(self, a: cython.longlong, b: cython.longlong, c: cython.longlong, d: cython.longlong) -> cython.longlong:
        """The bucket of four numbers."""
        mixed: cython.longlong = a * 741457 + b * 12582917 + c * 4256249 + d * 1000003
        return (mixed ^ (mixed >> 15)) & (len(self.bucket) - 1)

    @cython.cfunc
    @cython.exceptval(check=False)
    @cython.inline
    def of(self, node: cython.longlong, what: cython.int) -> cython.int:
        """One figure of a node."""
        return self.node[WIDTH * node + what]

    @cython.cfunc
    @cython.exceptval(check=False)
    def make(self, level: cython.int, high: cython.int, low: cython.int) -> cython.int:
        """The node of that level with these families, -1 if one of them is, or there is no room."""
        i: cython.int
        at: cython.longlong
        if high < 0 or low < 0:
            return FULL
        if high == NONE:
            return low
        slot: cython.longlong = self.slot(level, high, low, 0)
        i = self.bucket[slot]
        while i:
            if self.of(i, 1) == high and self.of(i, 2) == low and self.of(i, 0) == level:
                return i
            i = self.of(i, 3)
        if self.count >= self.room:
            if self.grow(2 * cython.cast(cython.longlong, self.room)) < 0:
                return FULL
            slot = self.slot(level, high, low, 0)
        i = self.count
        self.count += 1
        at = WIDTH * cython.cast(cython.longlong, i)
        self.node[at], self.node[at + 1], self.node[at + 2], self.node[at + 3] = level, high, low, self.bucket[slot]
        self.node[at + LEAST] = min(1 + self.of(high, LEAST), self.of(low, LEAST))
        self.node[at + MOST] = max(1 + self.of(high, MOST), self.of(low, MOST))
        self.node[at + LIGHTEST] = min(self.weight[level] + self.of(high, LIGHTEST), self.of(low, LIGHTEST))
        self.node[at + HEAVIEST] = max(self.weight[level] + self.of(high, HEAVIEST), self.of(low, HEAVIEST))
        self.bucket[slot] = i
        return i

    @cython.cfunc
    @cython.exceptval(check=False)
    def known(self, f: cython.int, g: cython.int, order: cython.int, weight: cython.int) -> cython.int:
        """What that operation gave, or -1; a step of work that is not counted where it was known."""
        at: cython.longlong = 5 * self.slot(f, g, order, weight)
        if (
            self.cache[at] == f
            and self.cache[at + 1] == g
            and self.cache[at + 2] == order
            and self.cache[at + 3] == weight
        ):
            return self.cache[at + 4]
        self.steps -= 1
        if self.steps < 0:
            self.full = True
        return -1

    @cython.cfunc
    @cython.exceptval(check=False)
    def keep(
        self, f: cython.int, g: cython.int, order: cython.int, weight: cython.int, result: cython.int
    ) -> cython.int:
        """Remember what an operation gave; the same again."""
        if result >= 0:
            at: cython.longlong = 5 * self.slot(f, g, order, weight)
            self.cache[at], self.cache[at + 1], self.cache[at + 2] = f, g, order
            self.cache[at + 3], self.cache[at + 4] = weight, result
        return result

    @cython.cfunc
    @cython.exceptval(check=False)
    def without(self, f: cython.int, g: cython.int) -> cython.int:
        """The sets of `f` that contain no set of `g`."""
        high: cython.int
        low: cython.int
        result: cython.int
        if f < 0 or g < 0 or self.full:
            return FULL
        if g == NONE or f == NONE:
            return f
        if g == EMPTY or f == g:
            return NONE
        if f == EMPTY:
            return f
        if self.of(f, 0) > self.of(g, 0):
            return self.without(f, self.of(g, 2))
        result = self.known(f, g, WITHOUT, 0)
        if result >= 0:
            return result
        high, low = self.of(f, 1), self.of(f, 2)
        if self.of(f, 0) < self.of(g, 0):
            high, low = self.without(high, g), self.without(low, g)
        else:
            high = self.without(self.without(high, self.of(g, 1)), self.of(g, 2))
            low = self.without(low, self.of(g, 2))
        return self.keep(f, g, WITHOUT, 0, self.make(self.of(f, 0), high, low))

    @cython.cfunc
    @cython.exceptval(check=False)
    def union(self, f: cython.int, g: cython.int) -> cython.int:
        """The minimal ones of the sets of both."""
        high: cython.int
        low: cython.int
        result: cython.int
        if f < 0 or g < 0 or self.full:
            return FULL
        if g == EMPTY or f == NONE:
            return g
        if f == g or g == NONE:
            return f
        if f == EMPTY:
            return EMPTY
        if self.of(f, 0) > self.of(g, 0) or (self.of(f, 0) == self.of(g, 0) and f > g):
            f, g = g, f
        result = self.known(f, g, UNION, 0)
        if result >= 0:
            return result
        if self.of(f, 0) < self.of(g, 0):
            low, high = self.union(self.of(f, 2), g), self.of(f, 1)
        else:
            low, high = self.union(self.of(f, 2), self.of(g, 2)), self.union(self.of(f, 1), self.of(g, 1))
        return self.keep(f, g, UNION, 0, self.make(self.of(f, 0), self.without(high, low), low))

    @cython.cfunc
    @cython.exceptval(check=False)
    def within(self, f: cython.int, order: cython.int, weight: cython.int) -> cython.int:
        """The sets of `f` within the limits."""
        result: cython.int
        left: cython.int
        if f <= 0 or self.full:
            return FULL if f < 0 or self.full else NONE
        if self.of(f, MOST) <= order and self.of(f, HEAVIEST) <= weight:
            return f
        self.cut = True
        if self.of(f, LEAST) > order or self.of(f, LIGHTEST) > weight:
            return NONE
        result = self.known(f, NONE, order, weight)
        if result >= 0:
            return result
        left = weight - self.weight[self.of(f, 0)]
        result = self.make(
            self.of(f, 0), self.within(self.of(f, 1), order - 1, left), self.within(self.of(f, 2), order, weight)
        )
        return self.keep(f, NONE, order, weight, result)

    @cython.cfunc
    @cython.exceptval(check=False)
    def product(self, f: cython.int, g: cython.int, order: cython.int, weight: cython.int) -> cython.int:
        """The minimal ones of the unions of a set of `f` and one of `g`, within the limits."""
        high: cython.int
        low: cython.int
        level: cython.int
        left: cython.int
        result: cython.int
        if f <= 0 or g <= 0 or self.full:
            return FULL if f < 0 or g < 0 or self.full else NONE
        if f == EMPTY:
            return self.within(g, order, weight)
        if g == EMPTY or f == g:
            return self.within(f, order, weight)
        if max(self.of(f, LEAST), self.of(g, LEAST)) > order:
            self.cut = True
            return NONE
        if max(self.of(f, LIGHTEST), self.of(g, LIGHTEST)) > weight:
            self.cut = True
            return NONE
        order = min(order, self.of(f, MOST) + self.of(g, MOST))
        weight = min(weight, self.of(f, HEAVIEST) + self.of(g, HEAVIEST))
        if self.of(f, 0) > self.of(g, 0) or (self.of(f, 0) == self.of(g, 0) and f > g):
            f, g = g, f
        result = self.known(f, g, order, weight)
        if result >= 0:
            return result
        level = self.of(f, 0)
        left = weight - self.weight[level]
        if level < self.of(g, 0):
            low = self.product(self.of(f, 2), g, order, weight)
            high = self.product(self.of(f, 1), g, order - 1, left)
        else:
            low = self.product(self.of(f, 2), self.of(g, 2), order, weight)
            high = self.product(self.of(f, 1), self.union(self.of(g, 1), self.of(g, 2)), order - 1, left)
            high = self.union(high, self.product(self.of(f, 2), self.of(g, 1), order - 1, left))
        return self.keep(f, g, order, weight, self.make(level, self.without(high, low), low))

    def build(self, graph, gates: cython.int[::1], family_of: cython.int[::1], order: cython.int, weight: cython.int):
        """The families of these gates, inputs first, entered by index; that of the last, -1 if there is no room."""
        kind: cython.int[::1] = graph.kind
        k: cython.int[::1] = graph.k
        start: cython.int[::1] = graph.start
        inputs: cython.int[::1] = graph.inputs
        first: cython.int = graph.variables + 1
        enough: cython.int[::1] = array("i", bytes(4 * (max(k, default=0) + 1)))
        j: cython.int
        g: cython.int
        n: cython.int
        x: cython.int
        f: cython.int = NONE
        for n in range(len(gates)):
            g = gates[n] - first
            f = EMPTY if kind[g] == AND else NONE
            for j in range(1, k[g] + 1):
                enough[j] = NONE
            enough[0] = EMPTY
            below = [family_of[inputs[i] >> 1] for i in range(start[g], start[g + 1])]
            for x in sorted(below, key=lambda y: -self.of(y, 0)):  # the last levels first: a wide gate is then linear
                if kind[g] == AND:
                    f = self.product(x, f, order, weight)
                elif kind[g] == OR:
                    f = self.union(x, f)
                else:  # at least j of the inputs so far
                    for j in range(k[g], 0, -1):
                        f = self.product(x, enough[j - 1], order, weight)
                        enough[j] = f = self.union(enough[j], f)
            if kind[g] > OR:
                f = enough[k[g]]
            if f < 0 or self.full:
                return FULL
            family_of[gates[n]] = f
        return f

    def event(self, level: cython.int, order: cython.int, weight: cython.int):
        """The family of the set of that level alone, if it is within the limits."""
        return self.within(self.make(level, EMPTY, NONE), order, weight)

    def above(self, f: cython.int, chance: cython.double[::1], limit: cython.double):
        """The sets of `f` the product of whose chances by level is `limit` or more; -1 if there is no room."""
        i: cython.int
        self.chance = chance
        self.best, self.worst = (array("d", bytes(8 * self.count)) for _ in range(2))
        self.best[EMPTY] = self.worst[EMPTY] = 1.0
        self.worst[NONE] = 2.0
        for i in range(2, self.count):
            q: cython.double = chance[self.of(i, 0)]
            self.best[i] = max(self.best[self.of(i, 2)], q * self.best[self.of(i, 1)])
            self.worst[i] = min(self.worst[self.of(i, 2)], q * self.worst[self.of(i, 1)])
        return self.chosen(f, 1.0, limit)

    @cython.cfunc
    @cython.exceptval(check=False)
    def chosen(self, f: cython.int, product: cython.double, limit: cython.double) -> cython.int:
        """The sets of `f` that with a `product` of chances so far are likely enough."""
        level: cython.int = self.of(f, 0)
        high: cython.int
        self.steps -= 1
        if self.steps < 0:
            self.full = True
        if self.full:
            return FULL
        if f == NONE or product * self.worst[f] >= limit:
            return f
        if product * self.best[f] < limit:
            self.cut = True
            return NONE
        high = self.chosen(self.of(f, 1), product * self.chance[level], limit)
        return self.make(level, high, self.chosen(self.of(f, 2), product, limit))

    def finish(self, f: cython.int):
        """Levels, high and low edges and root of a diagram with the same minimal solutions: edge 0 is true, 1 false.

        It reads "high and the variable, or low" where the table reads "the sets of high with it, and those of low".
        """
        i: cython.int
        edge: cython.int[::1] = array("i", bytes(4 * (self.count + 1)))
        met: cython.char[::1] = bytearray(self.count + 1)
        level, high, low = array("i", [self.of(NONE, 0)]), array("i", [0]), array("i", [0])
        edge[NONE], edge[EMPTY] = 1, 0
        met[f] = 1
        for i in range(self.count - 1, 1, -1):
            if met[i]:
                met[self.of(i, 1)] = met[self.of(i, 2)] = 1
        for i in range(2, self.count):
            if met[i]:
                edge[i] = 2 * len(level)
                level.append(self.of(i, 0))
                high.append(edge[self.of(i, 1)])
                low.append(edge[self.of(i, 2)])
        return level, high, low, edge[f]

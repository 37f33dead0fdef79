# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Functions below and above that of a module whose diagram is too large: certified bounds, whatever was left out.

Every gate has two plain decision diagrams, one that implies it and one that it implies. Where one of them grows past
some number of nodes, those that matter least are replaced: in the lower function by their low child (of a monotone
module, else by false), in the upper one by their high child (else by true). What a node matters is the chance of coming
to it times the change, under a `measure` of the variables that need not be their probabilities: bounds hold for any.

This file runs compiled (Cython) and interpreted, with the same results.

Source: K. Ravi and others, "Approximation and Decomposition of Binary Decision Diagrams", DAC 1998.
"""

from array import array

import cython

if cython.compiled:
    from cython.cimports.libc.math import sqrt
else:
    from math import sqrt

AND = cython.declare(cython.int, 0)
OR = cython.declare(cython.int, 1)
VOTE = cython.declare(cython.int, 2)
FALSE = cython.declare(cython.int, 0)
TRUE = cython.declare(cython.int, 1)
FULL = cython.declare(cython.int, -1)


@cython.cclass
class Enclosure:
    """Diagrams over `levels` variables in a table of `room` nodes; 0 and 1 are the constants.

    `lower` implies the function of the module, which implies `upper`; every round brings them nearer.
    """

    lower = cython.declare(cython.int, visibility="public")
    upper = cython.declare(cython.int, visibility="public")
    exact = cython.declare(cython.bint, visibility="public")  # the last round left nothing out
    level: cython.int[::1]
    high: cython.int[::1]
    low: cython.int[::1]
    next: cython.int[::1]  # of the same bucket
    bucket: cython.int[::1]
    cache: cython.int[::1]  # four a slot: f, g, operation, result
    place: cython.int[::1]  # of a node in `found`, plus one
    found: cython.int[::1]  # the nodes below an edge, children first
    image: cython.int[::1]  # by place: what a node becomes; while they are looked for, the path
    value: cython.double[::1]  # by place
    reach: cython.double[::1]
    loss: cython.double[::1]
    measure: cython.double[::1]  # by level
    levels: cython.int
    room: cython.int
    count: cython.int
    keep: cython.int  # nodes of a gate
    side: cython.int  # 0 where lower functions are made, 1 where upper ones
    monotone: cython.bint

    def __init__(self, levels: cython.int, monotone: cython.bint, room: cython.int):
        size: cython.int = 1 << 10
        while size < room:
            size *= 2
        self.levels, self.room, self.monotone, self.exact = levels, room, monotone, False
        self.lower, self.upper, self.count, self.measure = FALSE, TRUE, 2, array("d")
        self.level, self.high = array("i", bytes(4 * room)), array("i", bytes(4 * room))
        self.low, self.next = array("i", bytes(4 * room)), array("i", bytes(4 * room))
        self.bucket, self.cache = array("i", bytes(4 * size)), array("i", bytes(16 * size))
        self.place, self.found = array("i", bytes(4 * room)), array("i", bytes(4 * room))
        self.image, self.value = array("i", bytes(8 * room + 8)), array("d", bytes(8 * room))
        self.reach, self.loss = array("d", bytes(8 * room)), array("d", bytes(8 * room))
        self.level[0] = self.level[1] = levels

    @cython.cfunc
    def slot(self, a: cython.longlong, b: cython.longlong, c: cython.longlong) -> cython.longlong:
        """The bucket of three numbers."""
        mixed: cython.longlong = a * 741457 + b * 12582917 + c * 4256249
        return (mixed ^ (mixed >> 15)) & (len(self.bucket) - 1)

    @cython.cfunc
    def make(self, level: cython.int, high: cython.int, low: cython.int) -> cython.int:
        """The node `if variable then high else low`, or FULL."""
        if high == low:
            return high
        slot: cython.longlong = self.slot(level, high, low)
        i: cython.int = self.bucket[slot]
        while i:
            if self.high[i] == high and self.low[i] == low and self.level[i] == level:
                return i
            i = self.next[i]
        if self.count >= self.room:
            return FULL
        i = self.count
        self.count += 1
        self.level[i], self.high[i], self.low[i], self.next[i] = level, high, low, self.bucket[slot]
        self.bucket[slot] = i
        return i

    @cython.cfunc
    def combine(self, operation: cython.int, f: cython.int, g: cython.int) -> cython.int:
        """f and g, f or g, or FULL."""
        if f > g:
            f, g = g, f
        if f == g or f == 1 - operation:  # true for "and", false for "or"
            return g
        if f == operation:
            return f
        if g < 2:
            return f if g == 1 - operation else g
        slot: cython.longlong = 4 * self.slot(operation, f, g)
        if self.cache[slot] == f and self.cache[slot + 1] == g and self.cache[slot + 2] == operation:
            return self.cache[slot + 3]
        level: cython.int = min(self.level[f], self.level[g])
        f_here: cython.bint = self.level[f] == level
        g_here: cython.bint = self.level[g] == level
        high: cython.int = self.combine(operation, self.high[f] if f_here else f, self.high[g] if g_here else g)
        if high < 0:
            return FULL
        low: cython.int = self.combine(operation, self.low[f] if f_here else f, self.low[g] if g_here else g)
        if low < 0:
            return FULL
        result: cython.int = self.make(level, high, low)
        if result >= 0:
            self.cache[slot], self.cache[slot + 1], self.cache[slot + 2] = f, g, operation
            self.cache[slot + 3] = result
        return result

    @cython.cfunc
    def below(self, f: cython.int) -> cython.int:
        """How many nodes f has; they are in `found`, children first, and have their `place` until `forget`."""
        count: cython.int = 0
        waiting: cython.int = f > 1
        n: cython.int
        self.image[0] = f
        while waiting:
            n = self.image[waiting - 1]
            if self.place[n] == 0:
                self.place[n] = -1
                if self.high[n] > 1 and self.place[self.high[n]] == 0:
                    self.image[waiting] = self.high[n]
                    waiting += 1
                if self.low[n] > 1 and self.place[self.low[n]] == 0:
                    self.image[waiting] = self.low[n]
                    waiting += 1
                continue
            waiting -= 1
            if self.place[n] < 0:
                self.found[count] = n
                count += 1
                self.place[n] = count
        return count

    @cython.cfunc
    def forget(self, count: cython.int) -> cython.void:
        """Take their places from the nodes that `below` found."""
        i: cython.int
        for i in range(count):
            self.place[self.found[i]] = 0

    @cython.cfunc
    def worth(self, f: cython.int) -> cython.double:
        """The `value` of an edge."""
        return f if f < 2 else self.value[self.place[f] - 1]

    @cython.cfunc
    def become(self, f: cython.int) -> cython.int:
        """The `image` of an edge."""
        return f if f < 2 else self.image[self.place[f] - 1]

    @cython.cfunc
    def weigh(self, count: cython.int, chance: cython.double[::1]) -> cython.void:
        """Fill `value`, the chance that a node is true, and `reach`, that of coming to it from the last one."""
        i: cython.int
        n: cython.int
        p: cython.double
        for i in range(count):
            n = self.found[i]
            p = chance[self.level[n]]
            self.value[i] = p * self.worth(self.high[n]) + (1.0 - p) * self.worth(self.low[n])
            self.reach[i] = 0.0
        self.reach[count - 1] = 1.0
        for i in range(count - 1, -1, -1):
            n = self.found[i]
            p = chance[self.level[n]]
            if self.high[n] > 1:
                self.reach[self.place[self.high[n]] - 1] += p * self.reach[i]
            if self.low[n] > 1:
                self.reach[self.place[self.low[n]] - 1] += (1.0 - p) * self.reach[i]

    @cython.cfunc
    def trim(self, f: cython.int) -> cython.int:
        """f, or where it has more than `keep` nodes a function on the right `side` of it with no more; or FULL."""
        i: cython.int = 0
        n: cython.int = 0
        p: cython.double
        bar: cython.double
        count: cython.int = self.below(f)
        if count <= self.keep:
            self.forget(count)
            return f
        self.exact = False
        self.weigh(count, self.measure)
        for i in range(count):
            n = self.found[i]
            p = self.measure[self.level[n]]
            if self.monotone:
                p = (1.0 - p if self.side else p) * (self.worth(self.high[n]) - self.worth(self.low[n]))
            else:
                p = 1.0 - self.value[i] if self.side else self.value[i]
            self.loss[i] = p * self.reach[i]
        bar = self.bar(count)
        for i in range(count):
            n = self.found[i]
            if self.loss[i] > bar:
                n = self.make(self.level[n], self.become(self.high[n]), self.become(self.low[n]))
                if n < 0:
                    break
            elif self.monotone:
                n = self.become(self.high[n]) if self.side else self.become(self.low[n])
            else:
                n = self.side
            self.image[i] = n
        self.forget(count)
        return n

    @cython.cfunc
    def bar(self, count: cython.int) -> cython.double:
        """A number that at most `keep` of the first `count` losses exceed, and hardly fewer: by bisection."""
        low: cython.double = 1e-300
        high: cython.double = 1.0
        middle: cython.double
        above: cython.int
        i: cython.int
        for _ in range(40):
            middle = sqrt(low * high)
            above = 0
            for i in range(count):
                above += self.loss[i] > middle
            if above > self.keep:
                low = middle
            else:
                high = middle
        return high

    @cython.cfunc
    def complement(self, f: cython.int) -> cython.int:
        """not f, or FULL."""
        i: cython.int
        n: cython.int = f ^ 1
        count: cython.int = self.below(f)
        for i in range(count):
            n = self.found[i]
            n = self.make(
                self.level[n],
                self.high[n] ^ 1 if self.high[n] < 2 else self.become(self.high[n]),
                self.low[n] ^ 1 if self.low[n] < 2 else self.become(self.low[n]),
            )
            if n < 0:
                break
            self.image[i] = n
        self.forget(count)
        return n

    @cython.cfunc
    def collect(self, edges: cython.int[::1]) -> cython.void:
        """Throw away the nodes that none of `edges` needs, which are numbered anew."""
        i: cython.int
        for i in range(len(edges)):
            self.place[edges[i]] = 1
        for i in range(self.count - 1, 1, -1):
            if self.place[i]:
                self.place[self.high[i]] = self.place[self.low[i]] = 1
        self.place[0], self.place[1] = 0, 1
        self.bucket = array("i", bytes(4 * len(self.bucket)))
        self.cache = array("i", bytes(4 * len(self.cache)))
        old: cython.int = self.count
        self.count = 2
        for i in range(2, old):
            if self.place[i]:
                self.place[i] = self.make(self.level[i], self.place[self.high[i]], self.place[self.low[i]])
        for i in range(len(edges)):
            edges[i] = self.place[edges[i]]
        for i in range(old):
            self.place[i] = 0

    @cython.cfunc
    def step(self, operation: cython.int, f: cython.int, g: cython.int) -> cython.int:
        """`combine`, trimmed."""
        before: cython.int = self.count
        result: cython.int = FULL if f < 0 or g < 0 else self.combine(operation, f, g)
        if result < 0 or self.count - before < self.keep // 4:
            return result
        return self.trim(result)

    @cython.cfunc
    def gate(self, kind: cython.int, k: cython.int, edges: cython.int[::1], n: cython.int) -> cython.int:
        """The function of the gate over the first `n` of `edges`, or one on the same side of it; or FULL."""
        i: cython.int
        j: cython.int
        edge: cython.int
        for i in range(n):  # the deepest first
            edge = self.trim(edges[i])
            if edge < 0:
                return FULL
            j = i
            while j > 0 and self.level[edges[j - 1]] < self.level[edge]:
                edges[j] = edges[j - 1]
                j -= 1
            edges[j] = edge
        if kind != VOTE:
            edge = TRUE if kind == AND else FALSE
            for i in range(n):
                edge = self.step(kind, edge, edges[i])
            return edge
        edges[n] = TRUE
        for j in range(1, k + 1):
            edges[n + j] = FALSE
        for i in range(n):
            for j in range(min(k, i + 1), 0, -1):
                edge = self.step(AND, edges[i], edges[n + j - 1])
                edges[n + j] = self.step(OR, edges[n + j], edge)
        return edges[n + k]

    @cython.locals(g=cython.int, i=cython.int, j=cython.int, n=cython.int, side=cython.int, edge=cython.int)
    def round(
        self, flat, gates: cython.int[::1], order: cython.int[::1], measure: cython.double[::1], keep: cython.int
    ):
        """Bring `lower` and `upper`, of the last of `gates` (inputs first), nearer by diagrams of `keep` nodes.

        `order` has the index of the variable of each level, and `measure` its weight, 0..1.
        """
        kind: cython.int[::1] = flat.kind
        votes: cython.int[::1] = flat.k
        start: cython.int[::1] = flat.start
        inputs: cython.int[::1] = flat.inputs
        first: cython.int = flat.variables + 1
        size: cython.int = first + len(kind)
        edges: cython.int[::1] = array("i", bytes(8 * size + 8))  # lower and upper by index, at last what is known
        uses: cython.int[::1] = array("i", bytes(4 * size))  # still to come
        work: cython.int[::1] = array("i", bytes(16 * len(inputs) + 64))
        top: cython.int = gates[len(gates) - 1]
        self.measure, self.exact = measure, True
        edges[0] = edges[1] = TRUE
        edges[2 * size], edges[2 * size + 1] = self.lower, self.upper
        self.collect(edges)
        for i in range(len(order)):
            edges[2 * order[i]] = edges[2 * order[i] + 1] = self.make(i, TRUE, FALSE)
        for i in range(len(gates)):
            for j in range(start[gates[i] - first], start[gates[i] - first + 1]):
                uses[inputs[j] >> 1] += 1
        for i in range(len(gates)):
            g = gates[i] - first
            for side in range(2):
                self.side, self.keep, edge = side, keep, FULL
                if self.count > self.room // 2:
                    self.collect(edges)
                while edge < 0:
                    n = 0
                    for j in range(start[g], start[g + 1]):
                        work[n] = edges[2 * (inputs[j] >> 1) + (side ^ (inputs[j] & 1))]
                        if inputs[j] & 1:
                            work[n] = self.complement(work[n])
                        n += 1
                    edge = self.gate(kind[g], votes[g], work, n)
                    if edge < 0:
                        self.keep //= 4
                        self.collect(edges)
                        if self.keep == 0:
                            edge, self.exact = side, False
                edges[2 * gates[i] + side] = edge
            for j in range(start[g], start[g + 1]):
                n = inputs[j] >> 1
                uses[n] -= 1
                if uses[n] == 0 and n >= first:
                    edges[2 * n] = edges[2 * n + 1] = FALSE
        self.collect(edges)
        for side in range(2):
            self.side, self.keep = side, self.room // 16
            edge = self.step(1 - side, edges[2 * size + side], edges[2 * top + side])
            if edge >= 0:
                edges[2 * size + side] = edge
        self.lower, self.upper = edges[2 * size], edges[2 * size + 1]

    def function(self, upper: cython.bint):
        """`lower` or `upper` in the form of the kernel's diagrams: levels, high and low edges, and the root."""
        i: cython.int
        n: cython.int
        f: cython.int = self.upper if upper else self.lower
        count: cython.int = self.below(f)
        levels, highs, lows = array("i", [self.levels]), array("i", [0]), array("i", [0])
        for i in range(count):
            n = self.found[i]
            self.image[i] = 2 * i + 2
            levels.append(self.level[n])
            highs.append(self.become(self.high[n]) if self.high[n] > 1 else 1 - self.high[n])
            lows.append(self.become(self.low[n]) if self.low[n] > 1 else 1 - self.low[n])
        self.forget(count)
        return levels, highs, lows, 2 * count if count else 1 - f

# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Minimal cut sets as a zero-suppressed decision diagram: never enumerated, counted and searched in passes over nodes.

A node stands for the sets of `low`, and those of `high` each with its variable.  Node 0 is the family without a set,
node 1 that of the empty set.

This file runs compiled (Cython) and interpreted, with the same results.

Source: A. Rauzy, "New Algorithms for Fault Trees Analysis", Reliability Engineering and System Safety 40 (1993),
minimal solutions.
"""

from array import array

import cython

NONE = cython.declare(cython.int, 0)
EMPTY = cython.declare(cython.int, 1)
LARGEST_CACHE = cython.declare(cython.longlong, 1 << 26)  # C ints, 256 MB


@cython.cclass
class Family:
    """The minimal solutions of a diagram (level, high and low of its nodes, its root edge).

    `full` tells that more than `budget` nodes were needed; the family is then unusable.
    """

    node = cython.declare(cython.int[::1], visibility="public")  # four a node: level, high, low, next of its bucket
    count = cython.declare(cython.int, visibility="public")
    root = cython.declare(cython.int, visibility="public")
    full = cython.declare(cython.bint, visibility="public")
    shortest: cython.int[::1]  # of each node, the smallest and the largest number of variables of a set
    longest: cython.int[::1]
    missed: cython.longlong  # questions to the cache in vain since it was made
    pulse: object  # called from time to time: lets signals in
    stopped: object  # what it raised
    bucket: cython.int[::1]
    cache: cython.int[::1]
    known: cython.int[::1]
    level: cython.int[::1]
    high: cython.int[::1]
    low: cython.int[::1]
    bucket_mask: cython.longlong
    cache_mask: cython.longlong
    room: cython.int
    budget: cython.int

    def __init__(
        self,
        level: cython.int[::1],
        high: cython.int[::1],
        low: cython.int[::1],
        root: cython.int,
        budget: cython.int,
        pulse=None,
    ):
        i: cython.longlong
        self.level, self.high, self.low = level, high, low
        self.budget = budget
        slots: cython.int = 64
        while slots < 4 * len(level) and slots < 1 << 20:
            slots *= 2
        self.room = slots
        self.full = False
        self.missed = 0
        self.pulse, self.stopped = pulse, None
        self.shortest = array("i", bytes(4 * slots))
        self.longest = array("i", bytes(4 * slots))
        self.shortest[0], self.longest[0] = level[0] + 1, -1
        self.node = array("i", bytes(16 * slots))
        self.bucket = array("i", bytes(4 * slots))
        self.cache = array("i", bytes(16 * slots))
        self.bucket_mask = self.cache_mask = slots - 1
        self.known = array("i", bytes(8 * len(level)))
        for i in range(2, 2 * len(level)):
            self.known[i] = -1
        self.known[0], self.known[1] = EMPTY, NONE
        self.node[0] = self.node[4] = level[0]
        self.node[1] = self.node[2] = NONE
        self.node[5] = self.node[6] = EMPTY
        self.count = 2
        self.root = self.minimal(root)
        self.bucket = self.cache = self.known = self.level = self.high = self.low = array("i")
        self.shortest = self.longest = array("i")
        if not self.full:
            self.keep_reachable()
        if self.stopped is not None:
            raise self.stopped

    @cython.cfunc
    def grow(self) -> cython.int:
        i: cython.int
        slot: cython.longlong
        if self.room >= self.budget:
            self.full = True
            return -1
        old = self.node
        self.room = min(self.budget, 2 * self.room)
        self.node = array("i", bytes(16 * self.room))
        self.node[: 4 * self.count] = old[: 4 * self.count]
        short, long = self.shortest, self.longest
        self.shortest = array("i", bytes(4 * self.room))
        self.longest = array("i", bytes(4 * self.room))
        self.shortest[: self.count] = short[: self.count]
        self.longest[: self.count] = long[: self.count]
        self.bucket = array("i", bytes(8 * len(self.bucket)))
        self.bucket_mask = len(self.bucket) - 1
        for i in range(2, self.count):
            slot = self.slot(self.node[4 * i], self.node[4 * i + 1], self.node[4 * i + 2])
            self.node[4 * i + 3] = self.bucket[slot]
            self.bucket[slot] = i
        return 0

    @cython.cfunc
    def refresh(self) -> cython.int:
        """After as many misses as the cache has slots: a larger one, and a look at signals; -1 to stop."""
        if self.pulse is not None:
            try:
                self.pulse()
            except BaseException as raised:
                self.stopped = raised
                self.full = True
                return -1
        if len(self.cache) < LARGEST_CACHE:
            self.cache = array("i", bytes(8 * len(self.cache)))
            self.cache_mask = len(self.cache) // 4 - 1
        self.missed = 0
        return 0

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    @cython.inline
    def slot(self, level: cython.longlong, high: cython.longlong, low: cython.longlong) -> cython.longlong:
        mixed: cython.longlong = level * 741457 + high * 12582917 + low * 4256249
        return (mixed ^ (mixed >> 15)) & self.bucket_mask

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    @cython.inline
    def entry(self, f: cython.longlong, g: cython.longlong) -> cython.longlong:
        mixed: cython.longlong = f * 12582917 + g * 4256249
        return 4 * ((mixed ^ (mixed >> 15)) & self.cache_mask)

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    def make(self, level: cython.int, high: cython.int, low: cython.int) -> cython.int:
        i: cython.int
        at: cython.longlong
        bad: cython.int = 0
        if high == NONE:
            return low
        slot: cython.longlong = self.slot(level, high, low)
        i = self.bucket[slot]
        while i:
            at = 4 * cython.cast(cython.longlong, i)
            if self.node[at + 1] == high and self.node[at + 2] == low and self.node[at] == level:
                return i
            i = self.node[at + 3]
        if self.count >= self.room:
            with cython.gil:
                bad = self.grow()
            if bad:
                return -1
            slot = self.slot(level, high, low)
        i = self.count
        self.count += 1
        at = 4 * cython.cast(cython.longlong, i)
        self.node[at], self.node[at + 1], self.node[at + 2], self.node[at + 3] = level, high, low, self.bucket[slot]
        self.bucket[slot] = i
        self.shortest[i] = min(self.shortest[low], self.shortest[high] + 1)
        self.longest[i] = max(self.longest[low], self.longest[high] + 1)
        return i

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    def minimal(self, edge: cython.int) -> cython.int:
        """The minimal solutions of the function of `edge`; -1 when the budget is used up."""
        present: cython.int
        absent: cython.int
        result: cython.int = self.known[edge]
        if result >= 0:
            return result
        i: cython.int = edge >> 1
        absent = self.minimal(self.low[i] ^ (edge & 1))
        if absent < 0:
            return -1
        present = self.minimal(self.high[i] ^ (edge & 1))
        if present < 0:
            return -1
        present = self.without(present, absent)
        if present < 0:
            return -1
        result = self.make(self.level[i], present, absent)
        self.known[edge] = result
        return result

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    def without(self, sets: cython.int, smaller: cython.int) -> cython.int:
        """The sets of `sets` that contain no set of `smaller`; -1 when the budget is used up."""
        a: cython.longlong
        b: cython.longlong
        high: cython.int
        low: cython.int
        result: cython.int
        bad: cython.int = 0
        if smaller == NONE or sets == NONE:
            return sets
        if smaller == EMPTY or sets == smaller:
            return NONE
        b = 4 * cython.cast(cython.longlong, smaller)
        if sets == EMPTY:  # `smaller` is always minimal: it has the empty set only if it has nothing else
            return EMPTY
        if self.shortest[smaller] > self.longest[sets]:  # too large to be in any of them
            return sets
        a = 4 * cython.cast(cython.longlong, sets)
        if self.node[a] > self.node[b]:
            return self.without(sets, self.node[b + 2])
        entry: cython.longlong = self.entry(sets, smaller)
        if self.cache[entry] == sets and self.cache[entry + 1] == smaller:
            return self.cache[entry + 2]
        self.missed += 1
        if self.missed > self.cache_mask:
            with cython.gil:
                bad = self.refresh()
            if bad:
                return -1
        if self.node[a] < self.node[b]:
            high = self.without(self.node[a + 1], smaller)
            if high < 0:
                return -1
            low = self.without(self.node[a + 2], smaller)
        else:
            high = self.without(self.node[a + 1], self.node[b + 1])
            if high >= 0:
                high = self.without(high, self.node[b + 2])
            if high < 0:
                return -1
            low = self.without(self.node[a + 2], self.node[b + 2])
        if low < 0:
            return -1
        result = self.make(self.node[a], high, low)
        if result >= 0:
            entry = self.entry(sets, smaller)
            self.cache[entry], self.cache[entry + 1], self.cache[entry + 2] = sets, smaller, result
        return result

    @cython.cfunc
    def keep_reachable(self) -> cython.void:
        """Number the nodes of the root anew, without those left over from the work."""
        i: cython.int
        at: cython.longlong
        to: cython.longlong
        count: cython.int = 2
        number: cython.int[::1] = array("i", bytes(4 * max(2, self.root + 1)))
        number[self.root] = 1
        for i in range(self.root, 1, -1):
            if number[i]:
                at = 4 * cython.cast(cython.longlong, i)
                number[self.node[at + 1]] = number[self.node[at + 2]] = 1
        number[0], number[1] = NONE, EMPTY
        for i in range(2, self.root + 1):
            if number[i]:
                at, to = 4 * cython.cast(cython.longlong, i), 4 * cython.cast(cython.longlong, count)
                self.node[to] = self.node[at]
                self.node[to + 1], self.node[to + 2] = number[self.node[at + 1]], number[self.node[at + 2]]
                self.node[to + 3] = 0
                number[i] = count
                count += 1
        self.root = number[self.root]
        self.count = count
        kept = self.node
        self.node = array("i", kept[: 4 * count])

    def orders(self, longest: cython.int[::1]):
        """The largest order of a set of each node, `longest` being that of each variable; -1 where there is no set."""
        i: cython.longlong
        orders: cython.int[::1] = array("i", bytes(4 * self.count))
        orders[0], orders[1] = -1, 0
        for i in range(2, self.count):
            orders[i] = max(orders[self.node[4 * i + 2]], longest[self.node[4 * i]] + orders[self.node[4 * i + 1]])
        return orders

    def size(self, sizes: cython.double[::1]):
        """About how many sets the root has, in doubles, where the variable of each level stands for so many."""
        i: cython.longlong
        total: cython.double[::1] = array("d", bytes(8 * self.count))
        total[1] = 1.0
        for i in range(2, self.count):
            total[i] = sizes[self.node[4 * i]] * total[self.node[4 * i + 1]] + total[self.node[4 * i + 2]]
        return total[self.root]

    def counts(self, weights, modulus: cython.longlong):
        """The number of sets of the root by order, modulo a number below 2^31.

        `weights` gives, for each level, the number of sets with 0, 1, 2, ... events that its variable stands for.
        """
        i: cython.longlong
        j: cython.longlong
        n: cython.longlong
        p: cython.longlong
        q: cython.longlong
        v: cython.int
        h: cython.int
        l: cython.int
        weight: cython.longlong
        number: cython.longlong
        levels: cython.int = len(weights)
        longest: cython.int[::1] = array("i", [len(row) - 1 for row in weights])
        shortest: cython.int[::1] = array("i", [next((n for n, many in enumerate(row) if many), 0) for row in weights])
        start: cython.int[::1] = array("i", bytes(4 * levels + 4))
        for v in range(levels):
            start[v + 1] = start[v] + longest[v] + 1
        flat: cython.longlong[::1] = array("q", [many % modulus for row in weights for many in row])
        orders: cython.int[::1] = self.orders(longest)
        least: cython.int[::1] = array("i", bytes(4 * self.count))
        for i in range(2, self.count):
            h, l = self.node[4 * i + 1], self.node[4 * i + 2]
            least[i] = shortest[self.node[4 * i]] + least[h]
            if l != NONE:
                least[i] = min(least[i], least[l])
        place: cython.longlong[::1] = array("q", bytes(8 * (self.count + 1)))  # of a node's row, from its least order
        for i in range(self.count):
            place[i + 1] = place[i] + orders[i] - least[i] + 1
        counts: cython.longlong[::1] = array("q", bytes(8 * place[self.count]))
        counts[place[1]] = 1
        for i in range(2, self.count):
            v, h, l = self.node[4 * i], self.node[4 * i + 1], self.node[4 * i + 2]
            p = place[i] - least[i]
            for j in range(least[l], orders[l] + 1):
                counts[p + j] = counts[place[l] - least[l] + j]
            for n in range(shortest[v], longest[v] + 1):
                weight = flat[start[v] + n]
                q = place[h] - least[h]
                if weight == 1:
                    for j in range(least[h], orders[h] + 1):
                        number = counts[p + n + j] + counts[q + j]
                        counts[p + n + j] = number - modulus if number >= modulus else number
                elif weight:
                    for j in range(least[h], orders[h] + 1):
                        counts[p + n + j] = (counts[p + n + j] + weight * counts[q + j]) % modulus
        return [0] * least[self.root] + list(counts[place[self.root] : place[self.root + 1]])

    def reachable_orders(self, masks: cython.ulonglong[::1]):
        """For each node, bit n set where it has a set of order n, below 64; `masks` are those of the variables."""
        i: cython.longlong
        n: cython.int
        high: cython.ulonglong
        mask: cython.ulonglong
        reached: cython.ulonglong[::1] = array("Q", bytes(8 * self.count))
        reached[1] = 1
        for i in range(2, self.count):
            mask = masks[self.node[4 * i]]
            high = reached[self.node[4 * i + 1]]
            reached[i] = reached[self.node[4 * i + 2]]
            n = 0
            while mask:
                if mask & 1:
                    reached[i] |= high << n
                mask >>= 1
                n += 1
        return reached

    def best(self, values: cython.double[::1]):
        """For each node, the largest sum of the `values` of a set's variables by level; -inf where there is no set."""
        i: cython.longlong
        best: cython.double[::1] = array("d", bytes(8 * self.count))
        best[0] = -float("inf")
        for i in range(2, self.count):
            best[i] = max(best[self.node[4 * i + 2]], values[self.node[4 * i]] + best[self.node[4 * i + 1]])
        return best

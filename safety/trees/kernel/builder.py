# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Binary decision diagrams with complement edges, built from a graph of gates.

An edge is 2 * node + complement.  Node 0 is the constant true, so edge 0 is true and edge 1 false.  A node's high edge
is never complemented; children have smaller numbers than their parents, so one pass over the numbers is a pass upwards.

This file runs compiled (Cython) and interpreted, with the same results.

Sources: R. E. Bryant, IEEE Trans. Comp. C-35 (1986); K. S. Brace, R. L. Rudell, R. E. Bryant, "Efficient Implementation
of a BDD Package", DAC 1990, for complement edges.
"""

from array import array

import cython

AND = cython.declare(cython.int, 0)
OR = cython.declare(cython.int, 1)
VOTE = cython.declare(cython.int, 2)


@cython.cclass
class Builder:
    """The nodes over `levels` variables, at most `budget` of them; `full` tells that it needed more."""

    node: cython.int[::1]  # four a node: level, high edge, low edge, next node of the same bucket
    bucket: cython.int[::1]
    cache: cython.int[::1]  # four a slot: f, g, result; f < g for "and", f > g for "xor"
    bucket_mask: cython.longlong
    cache_mask: cython.longlong
    done = cython.declare(cython.int, visibility="public")  # gates that were built, of those asked for
    begun = cython.declare(object, visibility="public")  # where it was full: edges of what was ready
    left = cython.declare(object, visibility="public")  # and of what the last gate had yet to join
    count: cython.int
    budget: cython.int
    room: cython.int
    full = cython.declare(cython.bint, visibility="public")

    def __init__(self, levels: cython.int, budget: cython.int):
        slots: cython.int = 64
        while slots < 8 * levels and slots < 4096:
            slots *= 2
        self.budget = budget
        self.room = min(budget, slots)
        self.node = array("i", bytes(16 * self.room))
        self.bucket = array("i", bytes(4 * slots))
        self.cache = array("i", bytes(16 * slots))
        self.bucket_mask = self.cache_mask = slots - 1
        self.node[0] = levels  # the constant lies below every variable
        self.count = 1
        self.done = 0
        self.full = False
        self.begun, self.left = array("i"), array("i")

    @cython.cfunc
    def grow(self) -> cython.int:
        """More room: twice as much, as far as the budget goes."""
        i: cython.int
        slot: cython.longlong
        if self.room >= self.budget:
            self.full = True
            return -1
        old = self.node
        self.room = min(self.budget, 2 * self.room)
        self.node = array("i", bytes(16 * self.room))
        self.node[: 4 * self.count] = old[: 4 * self.count]
        self.bucket = array("i", bytes(8 * len(self.bucket)))
        self.bucket_mask = len(self.bucket) - 1
        for i in range(1, self.count):
            slot = self.slot(self.node[4 * i], self.node[4 * i + 1], self.node[4 * i + 2])
            self.node[4 * i + 3] = self.bucket[slot]
            self.bucket[slot] = i
        if len(self.cache) < 1 << 24:
            self.cache = array("i", bytes(8 * len(self.cache)))
            self.cache_mask = len(self.cache) // 4 - 1
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
    def make(self, level: cython.int, high: cython.int, low: cython.int) -> cython.int:
        """The edge to `if variable then high else low`; -1 when the budget is used up."""
        i: cython.int
        at: cython.longlong
        bad: cython.int = 0
        if high == low:
            return high
        flip: cython.int = high & 1
        high ^= flip
        low ^= flip
        slot: cython.longlong = self.slot(level, high, low)
        i = self.bucket[slot]
        while i:
            at = 4 * cython.cast(cython.longlong, i)
            if self.node[at + 1] == high and self.node[at + 2] == low and self.node[at] == level:
                return 2 * i + flip
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
        self.node[at] = level
        self.node[at + 1] = high
        self.node[at + 2] = low
        self.node[at + 3] = self.bucket[slot]
        self.bucket[slot] = i
        return 2 * i + flip

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
    def both(self, f: cython.int, g: cython.int) -> cython.int:
        """f and g; -1 when the budget is used up."""
        f1: cython.int
        f0: cython.int
        g1: cython.int
        g0: cython.int
        high: cython.int
        low: cython.int
        result: cython.int
        if f == g or g == 0:
            return f
        if f == 0:
            return g
        if f == 1 or g == 1 or f == (g ^ 1):
            return 1
        if f > g:
            f, g = g, f
        entry: cython.longlong = self.entry(f, g)
        if self.cache[entry] == f and self.cache[entry + 1] == g:
            return self.cache[entry + 2]
        a: cython.longlong = 4 * cython.cast(cython.longlong, f >> 1)
        b: cython.longlong = 4 * cython.cast(cython.longlong, g >> 1)
        level: cython.int = min(self.node[a], self.node[b])
        f1 = f0 = f
        g1 = g0 = g
        if self.node[a] == level:
            f1, f0 = self.node[a + 1] ^ (f & 1), self.node[a + 2] ^ (f & 1)
        if self.node[b] == level:
            g1, g0 = self.node[b + 1] ^ (g & 1), self.node[b + 2] ^ (g & 1)
        high = self.both(f1, g1)
        if high < 0:
            return -1
        low = self.both(f0, g0)
        if low < 0:
            with cython.gil:
                self.begun.append(high)
            return -1
        result = self.make(level, high, low)
        if result >= 0:
            entry = self.entry(f, g)
            self.cache[entry], self.cache[entry + 1], self.cache[entry + 2] = f, g, result
        return result

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    def either(self, f: cython.int, g: cython.int) -> cython.int:
        """f or g; -1 when the budget is used up."""
        result: cython.int = self.both(f ^ 1, g ^ 1)
        return result if result < 0 else result ^ 1

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    def odd(self, f: cython.int, g: cython.int) -> cython.int:
        """Exactly one of f and g; -1 when the budget is used up."""
        f1: cython.int
        f0: cython.int
        g1: cython.int
        g0: cython.int
        high: cython.int
        low: cython.int
        result: cython.int
        flip: cython.int = (f ^ g) & 1
        f, g = f & -2, g & -2
        if f == g:
            return 1 ^ flip
        if f == 0:
            return g ^ 1 ^ flip
        if g == 0:
            return f ^ 1 ^ flip
        if f < g:
            f, g = g, f
        entry: cython.longlong = self.entry(f, g)
        if self.cache[entry] == f and self.cache[entry + 1] == g:
            return self.cache[entry + 2] ^ flip
        a: cython.longlong = 4 * cython.cast(cython.longlong, f >> 1)
        b: cython.longlong = 4 * cython.cast(cython.longlong, g >> 1)
        level: cython.int = min(self.node[a], self.node[b])
        f1 = f0 = f
        g1 = g0 = g
        if self.node[a] == level:
            f1, f0 = self.node[a + 1], self.node[a + 2]
        if self.node[b] == level:
            g1, g0 = self.node[b + 1], self.node[b + 2]
        high = self.odd(f1, g1)
        if high < 0:
            return -1
        low = self.odd(f0, g0)
        if low < 0:
            with cython.gil:
                self.begun.append(high)
            return -1
        result = self.make(level, high, low)
        if result >= 0:
            entry = self.entry(f, g)
            self.cache[entry], self.cache[entry + 1], self.cache[entry + 2] = f, g, result
            return result ^ flip
        return -1

    def variable(self, level: cython.int) -> cython.int:
        """The edge to the variable of `level`."""
        return self.make(level, 0, 1)

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    def gate(
        self, kind: cython.int, k: cython.int, edges: cython.int[::1], count: cython.int, counts: cython.int[::1]
    ) -> cython.int:
        """The function of a gate over `count` `edges`, which it sorts; `counts` has room for k + 1 edges."""
        i: cython.int
        j: cython.int
        edge: cython.int
        level: cython.int
        result: cython.int
        flip: cython.int = 0
        if kind == VOTE and 2 * k > count + 1:  # at least k occur: not so many of the opposites
            flip, k = 1, count - k + 1
            for i in range(count):
                edges[i] ^= 1
        for i in range(1, count):  # the deepest first: the smallest diagrams in between
            edge = edges[i]
            level = self.node[4 * cython.cast(cython.longlong, edge >> 1)]
            j = i
            while j > 0 and self.node[4 * cython.cast(cython.longlong, edges[j - 1] >> 1)] < level:
                edges[j] = edges[j - 1]
                j -= 1
            edges[j] = edge
        if kind == VOTE:
            counts[0] = 0
            for j in range(1, k + 1):
                counts[j] = 1
            for i in range(count):
                for j in range(min(k, i + 1), 0, -1):
                    result = self.both(edges[i], counts[j - 1])
                    if result >= 0:
                        result = self.either(counts[j], result)
                    if result < 0:
                        return -1
                    counts[j] = result
            return counts[k] ^ flip
        joined: cython.int = 0 if kind == AND else 1
        for i in range(count):
            if kind == AND:
                result = self.both(joined, edges[i])
            elif kind == OR:
                result = self.either(joined, edges[i])
            else:
                result = self.odd(joined, edges[i])
            if result < 0:
                with cython.gil:
                    self.left.append(joined)
                    for j in range(i, count):
                        self.left.append(edges[j])
                return -1
            joined = result
        return joined

    def build(self, flat, gates: cython.int[::1], edge_of: cython.int[::1], pulse=None, left=()):
        """The edge of the last of `gates` (indices in `flat`, inputs first), or -1 when the budget is used up.

        `edge_of` holds the edge of every variable, module and constant below, by index; that of each gate is entered.
        `pulse` is called before each gate; what it raises ends the work. `left` are the edges that the first gate is
        to join, if that had been begun.
        """
        kind: cython.int[::1] = flat.kind
        votes: cython.int[::1] = flat.k
        start: cython.int[::1] = flat.start
        inputs: cython.int[::1] = flat.inputs
        first: cython.int = flat.variables + 1
        widest: cython.int = 0
        g: cython.int
        i: cython.int
        j: cython.int
        n: cython.int
        result: cython.int = 0
        for i in range(len(gates)):
            g = gates[i] - first
            widest = max(widest, start[g + 1] - start[g])
        edges: cython.int[::1] = array("i", bytes(4 * (widest + 2)))
        counts: cython.int[::1] = array("i", bytes(4 * (widest + 1)))
        for i in range(len(gates)):
            if pulse is not None:
                pulse()
            self.done = i
            g = gates[i] - first
            for j in range(start[g], start[g + 1]):
                edges[j - start[g]] = edge_of[inputs[j] >> 1] ^ (inputs[j] & 1)
            n = start[g + 1] - start[g]
            if i == 0 and len(left):
                n = len(left)
                for j in range(n):
                    edges[j] = left[j]
            result = self.gate(kind[g], votes[g], edges, n, counts)
            if result < 0:
                return -1
            edge_of[gates[i]] = result
        return result

    def finish(self, root: cython.int):
        """Level, high and low of the nodes of `root` alone, numbered anew (see `diagram.Diagram`), and its edge."""
        level, high, low, roots = self.shared(array("i", [root]))
        return level, high, low, roots[0]

    def shared(self, roots: cython.int[::1]):
        """The same of the nodes of several roots, and the edges of these."""
        i: cython.int
        at: cython.longlong
        top: cython.int = 0
        count: cython.int = 1
        for i in range(len(roots)):
            top = max(top, roots[i] >> 1)
        number: cython.int[::1] = array("i", bytes(4 * (top + 1)))
        for i in range(len(roots)):
            number[roots[i] >> 1] = 1
        for i in range(top, 0, -1):
            if number[i]:
                at = 4 * cython.cast(cython.longlong, i)
                number[self.node[at + 1] >> 1] = 1
                number[self.node[at + 2] >> 1] = 1
                count += 1
        level: cython.int[::1] = array("i", bytes(4 * count))
        high: cython.int[::1] = array("i", bytes(4 * count))
        low: cython.int[::1] = array("i", bytes(4 * count))
        level[0] = self.node[0]
        number[0] = 0
        count = 1
        for i in range(1, top + 1):
            if number[i]:
                at = 4 * cython.cast(cython.longlong, i)
                number[i] = count
                level[count] = self.node[at]
                high[count] = 2 * number[self.node[at + 1] >> 1]
                low[count] = 2 * number[self.node[at + 2] >> 1] + (self.node[at + 2] & 1)
                count += 1
        return level, high, low, array("i", [2 * number[root >> 1] + (root & 1) for root in roots])

    def adopt(self, level: cython.int[::1], high: cython.int[::1], low: cython.int[::1]):
        """Enter the nodes of diagrams as `shared` gives them, under their numbers; before any other."""
        i: cython.int
        for i in range(1, len(level)):
            self.make(level[i], high[i], low[i])

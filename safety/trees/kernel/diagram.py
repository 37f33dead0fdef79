# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Binary decision diagrams with complement edges: built from a graph of gates, then evaluated in passes over its nodes.

An edge is 2 * node + complement.  Node 0 is the constant true, so edge 0 is true and edge 1 false.  A node's high edge
is never complemented; children have smaller numbers than their parents, so one pass over the numbers is a pass upwards.

This file runs compiled (Cython) and interpreted, with the same results.

Sources: R. E. Bryant, IEEE Trans. Comp. C-35 (1986); K. S. Brace, R. L. Rudell, R. E. Bryant, "Efficient Implementation
of a BDD Package", DAC 1990, for complement edges; A. Rauzy, Reliability Engineering and System Safety 40 (1993).
"""

from array import array

import cython

AND = cython.declare(cython.int, 0)
OR = cython.declare(cython.int, 1)
VOTE = cython.declare(cython.int, 2)
XOR = cython.declare(cython.int, 3)
BLOCK = cython.declare(
    cython.int, 32
)  # samples of one pass; their values for some thousand nodes stay in the processor's cache


@cython.cclass
class Builder:
    """The nodes over `levels` variables, at most `budget` of them; `full` tells that it needed more."""

    node: cython.int[::1]  # four a node: level, high edge, low edge, next node of the same bucket
    bucket: cython.int[::1]
    cache: cython.int[::1]  # four a slot: f, g, result; f < g for "and", f > g for "xor"
    bucket_mask: cython.longlong
    cache_mask: cython.longlong
    done = cython.declare(cython.int, visibility="public")  # gates that were built, of those asked for
    count: cython.int
    budget: cython.int
    room: cython.int
    full: cython.bint

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
            return counts[k]
        result = 0 if kind == AND else 1
        for i in range(count):
            if kind == AND:
                result = self.both(result, edges[i])
            elif kind == OR:
                result = self.either(result, edges[i])
            else:
                result = self.odd(result, edges[i])
            if result < 0:
                return -1
        return result

    def build(self, flat, gates: cython.int[::1], edge_of: cython.int[::1]):
        """The edge of the last of `gates` (indices in `flat`, inputs first), or -1 when the budget is used up.

        `edge_of` holds the edge of every variable, module and constant below, by index; that of each gate is entered.
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
        result: cython.int = 0
        for i in range(len(gates)):
            g = gates[i] - first
            widest = max(widest, start[g + 1] - start[g])
        edges: cython.int[::1] = array("i", bytes(4 * (widest + 1)))
        counts: cython.int[::1] = array("i", bytes(4 * (widest + 1)))
        for i in range(len(gates)):
            self.done = i
            g = gates[i] - first
            for j in range(start[g], start[g + 1]):
                edges[j - start[g]] = edge_of[inputs[j] >> 1] ^ (inputs[j] & 1)
            result = self.gate(kind[g], votes[g], edges, start[g + 1] - start[g], counts)
            if result < 0:
                return -1
            edge_of[gates[i]] = result
        return result

    def finish(self, root: cython.int):
        """The diagram of `root` alone, its nodes numbered anew."""
        i: cython.int
        at: cython.longlong
        top: cython.int = root >> 1
        number: cython.int[::1] = array("i", bytes(4 * (top + 1)))
        count: cython.int = 1
        if top:
            number[top] = 1
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
        return Diagram(level, high, low, 2 * number[top] + (root & 1))


@cython.cclass
class Diagram:
    """One function: `level`, `high` and `low` of each node (arrays of C int, node 0 the constant), and the root edge."""

    level = cython.declare(cython.int[::1], visibility="public")
    high = cython.declare(cython.int[::1], visibility="public")
    low = cython.declare(cython.int[::1], visibility="public")
    root = cython.declare(cython.int, visibility="public")
    nodes = cython.declare(cython.longlong, visibility="public")

    def __init__(self, level: cython.int[::1], high: cython.int[::1], low: cython.int[::1], root: cython.int):
        self.level = level
        self.high = high
        self.low = low
        self.root = root
        self.nodes = len(level)  # with the constant

    def chances(self, occurs: cython.double[::1], fails: cython.double[::1], chance: cython.double[::1]):
        """Fill in `chance` the probability of every edge (2 a node), from those of the variables by level.

        `occurs` and `fails` are the chances that a variable is true and false.  Nothing is subtracted: both sides of
        every node are accurate to a few ulp a level.
        """
        i: cython.int
        v: cython.int
        h: cython.int
        l: cython.int
        chance[0] = 1.0
        chance[1] = 0.0
        for i in range(1, self.nodes):
            v, h, l = self.level[i], self.high[i], self.low[i]
            chance[2 * i] = occurs[v] * chance[h] + fails[v] * chance[l]
            chance[2 * i + 1] = occurs[v] * chance[h ^ 1] + fails[v] * chance[l ^ 1]
        return chance[self.root]

    def conditionals(
        self,
        occurs: cython.double[::1],
        fails: cython.double[::1],
        chance: cython.double[::1],
        when_true: cython.double[::1],
        when_false: cython.double[::1],
    ):
        """Fill in, by level, the chance of the root when a variable is true and when it is false, in one pass down.

        `chance` is what `chances` left.  Sums of products only, so that what cannot happen comes out as zero itself.
        """
        i: cython.int
        e: cython.int
        v: cython.int
        side: cython.int
        child: cython.int
        arrives: cython.double
        levels: cython.int = self.level[0]
        reach: cython.double[::1] = array("d", bytes(16 * self.nodes))
        skipping: cython.double[::1] = array(
            "d", bytes(16 * max(levels, 1))
        )  # sums over ranges of levels without a node
        self.skip(skipping, 0, self.level[self.root >> 1], chance[self.root])
        reach[self.root] = 1.0
        for i in range(self.nodes - 1, 0, -1):
            v = self.level[i]
            for side in range(2):
                e = 2 * i + side
                arrives = reach[e]
                if arrives > 0.0:
                    child = self.high[i] ^ side
                    when_true[v] += arrives * chance[child]
                    reach[child] += arrives * occurs[v]
                    self.skip(skipping, v + 1, self.level[child >> 1], arrives * occurs[v] * chance[child])
                    child = self.low[i] ^ side
                    when_false[v] += arrives * chance[child]
                    reach[child] += arrives * fails[v]
                    self.skip(skipping, v + 1, self.level[child >> 1], arrives * fails[v] * chance[child])
        for v in range(levels):
            i = v + levels
            while i:
                when_true[v] += skipping[i]
                when_false[v] += skipping[i]
                i >>= 1

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    def skip(self, sums: cython.double[::1], start: cython.int, stop: cython.int, value: cython.double) -> cython.void:
        """Add `value` to each level of the range, in a segment tree: no subtraction, so no cancellation."""
        levels: cython.int = self.level[0]
        start += levels
        stop += levels
        while start < stop:
            if start & 1:
                sums[start] += value
                start += 1
            if stop & 1:
                stop -= 1
                sums[stop] += value
            start >>= 1
            stop >>= 1

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    def block_up(
        self,
        rows: cython.int[::1],
        chance: cython.double[::1],
        width: cython.longlong,
        first: cython.longlong,
        edges: cython.double[::1],
    ) -> cython.void:
        """The chances of every edge for the samples `first` to `first` + BLOCK."""
        i: cython.longlong
        s: cython.longlong
        h: cython.longlong
        l: cython.longlong
        q: cython.longlong
        p: cython.longlong
        side: cython.longlong
        e: cython.longlong
        for s in range(BLOCK):
            edges[s] = 1.0
            edges[BLOCK + s] = 0.0
        for i in range(1, self.nodes):
            q = 2 * width * rows[self.level[i]] + first
            p = q + width
            for side in range(2):
                h, l, e = BLOCK * (self.high[i] ^ side), BLOCK * (self.low[i] ^ side), BLOCK * (2 * i + side)
                for s in range(BLOCK):
                    edges[e + s] = chance[q + s] * edges[h + s] + chance[p + s] * edges[l + s]

    def many(self, rows: cython.int[::1], chance: cython.double[::1], width: cython.longlong, into: cython.longlong):
        """The chances of the root for `width` samples at once, a multiple of BLOCK.

        Row r of `chance` holds 2 * width values: that variable r is true in each sample, and that it is false.  `rows`
        gives the row of each level; that of the root, `into`, is filled in.
        """
        first: cython.longlong
        s: cython.longlong
        edges: cython.double[::1] = array("d", bytes(16 * BLOCK * self.nodes))
        for first in range(0, width, BLOCK):
            self.block_up(rows, chance, width, first, edges)
            for s in range(BLOCK):
                chance[2 * width * into + first + s] = edges[BLOCK * self.root + s]
                chance[2 * width * into + width + first + s] = edges[BLOCK * (self.root ^ 1) + s]

    def slopes(
        self,
        rows: cython.int[::1],
        chance: cython.double[::1],
        width: cython.longlong,
        into: cython.longlong,
        slope: cython.double[::1],
    ):
        """Add to row r of `slope`, `width` values each, the derivative of the top by the chance of variable r.

        Row `into` holds that by the chance of this root.
        """
        first: cython.longlong
        i: cython.longlong
        s: cython.longlong
        h: cython.longlong
        l: cython.longlong
        q: cython.longlong
        v: cython.longlong
        up_to: cython.longlong
        down_to: cython.longlong
        sign: cython.double
        rise: cython.double
        fall: cython.double
        edges: cython.double[::1] = array("d", bytes(16 * BLOCK * self.nodes))
        reach: cython.double[::1] = array("d", bytes(8 * BLOCK * self.nodes))
        for first in range(0, width, BLOCK):
            self.block_up(rows, chance, width, first, edges)
            for i in range(BLOCK * self.nodes):
                reach[i] = 0.0
            sign = 1 - 2 * (self.root & 1)
            for s in range(BLOCK):
                reach[BLOCK * (self.root >> 1) + s] = sign * slope[width * into + first + s]
            for i in range(self.nodes - 1, 0, -1):
                v = width * rows[self.level[i]] + first
                q = v + width * rows[self.level[i]]
                h, l = BLOCK * self.high[i], BLOCK * self.low[i]
                up_to, down_to = BLOCK * (self.high[i] >> 1), BLOCK * (self.low[i] >> 1)
                sign = 1 - 2 * (self.low[i] & 1)
                for s in range(BLOCK):
                    rise = edges[h + s] - edges[l + s]
                    fall = edges[(l ^ BLOCK) + s] - edges[(h ^ BLOCK) + s]
                    slope[v + s] += reach[BLOCK * i + s] * (rise if edges[h + s] + edges[l + s] < 1.0 else fall)
                    reach[up_to + s] += reach[BLOCK * i + s] * chance[q + s]
                    reach[down_to + s] += reach[BLOCK * i + s] * chance[q + width + s] * sign


def load(
    columns: cython.double[::1],
    total: cython.longlong,
    first: cython.longlong,
    count: cython.longlong,
    width: cython.longlong,
    rows: cython.int[::1],
    chance: cython.double[::1],
):
    """Enter samples `first` to `first` + `count` of each of `columns`, `total` values each, into rows of `chance`.

    The rest of `width` repeats the last sample.  Returns the first value outside 0..1 as (column, sample), or None.
    """
    c: cython.longlong
    s: cython.longlong
    value: cython.double
    for c in range(len(rows)):
        for s in range(width):
            value = columns[c * total + first + min(s, count - 1)]
            if not 0.0 <= value <= 1.0:
                return c, first + s
            chance[2 * width * rows[c] + s] = value
            chance[2 * width * rows[c] + width + s] = 1.0 - value
    return None


def block():
    """How many samples one pass takes; widths are its multiples."""
    return BLOCK

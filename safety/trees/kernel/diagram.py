# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""One decision diagram, asked in passes over its nodes: probability, importance, whole samples of probabilities.

Nodes and edges are those of `builder`.

This file runs compiled (Cython) and interpreted, with the same results.

Source: A. Rauzy, Reliability Engineering and System Safety 40 (1993); Y. Dutuit and A. Rauzy, the same 72 (2001).
"""

from array import array

import cython

BLOCK = cython.declare(cython.int, 32)  # samples of a pass; their values for a thousand nodes stay in the cache


@cython.cclass
class Diagram:
    """One function: `level`, `high` and `low` of each node (arrays of C int, node 0 the constant), and the root."""

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
        root: cython.int,
        when_true: cython.double[::1],
        when_false: cython.double[::1],
        slope: cython.double[::1],
    ):
        """Fill in, by level, the chance of `root` when a variable is true and when it is false, in one pass down; and
        `slope`, the difference of the two, of which every part is taken where it loses no digits.

        `root` is that of the diagram or its opposite, `chance` what `chances` left.  The first two are sums of products
        only, so that what cannot happen comes out as zero itself.
        """
        i: cython.int
        e: cython.int
        v: cython.int
        side: cython.int
        child: cython.int
        h: cython.int
        l: cython.int
        arrives: cython.double
        levels: cython.int = self.level[0]
        reach: cython.double[::1] = array("d", bytes(16 * self.nodes))
        skipping: cython.double[::1] = array(
            "d", bytes(16 * max(levels, 1))
        )  # sums over ranges of levels without a node
        self.skip(skipping, 0, self.level[root >> 1], chance[root])
        reach[root] = 1.0
        for i in range(self.nodes - 1, 0, -1):
            v = self.level[i]
            for side in range(2):
                e = 2 * i + side
                arrives = reach[e]
                if arrives > 0.0:
                    h, l = self.high[i] ^ side, self.low[i] ^ side
                    if chance[h] + chance[l] < 1.0:
                        slope[v] += arrives * (chance[h] - chance[l])
                    else:
                        slope[v] += arrives * (chance[l ^ 1] - chance[h ^ 1])
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
    source: cython.longlong
    occurs: cython.longlong
    wrong: cython.longlong
    value: cython.double
    for c in range(len(rows)):
        source, occurs, wrong = c * total + first, 2 * width * rows[c], 0
        for s in range(count):
            value = columns[source + s]
            wrong += not 0.0 <= value <= 1.0
            chance[occurs + s] = value
            chance[occurs + width + s] = 1.0 - value
        if wrong:
            for s in range(count):
                if not 0.0 <= columns[source + s] <= 1.0:
                    return c, first + s
        for s in range(count, width):
            chance[occurs + s] = chance[occurs + count - 1]
            chance[occurs + width + s] = chance[occurs + width + count - 1]
    return None


def block():
    """How many samples one pass takes; widths are its multiples."""
    return BLOCK

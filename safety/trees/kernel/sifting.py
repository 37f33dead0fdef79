# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Sifting: the order of the variables of diagrams that are there already, improved by swaps of adjacent levels.

Nodes and edges are those of `builder`. One variable after the other, that with most nodes first, is moved through all
levels and left where the diagrams are smallest. A swap changes only nodes of the upper level that have a child in the
lower one, in place: who points to them notices nothing.

This file runs compiled (Cython) and interpreted, with the same results.

Sources: R. Rudell, "Dynamic Variable Ordering for Ordered Binary Decision Diagrams", ICCAD 1993; for the bound that
ends a way early: R. Drechsler, W. Günther, F. Somenzi, "Using Lower Bounds During Dynamic BDD Minimization", IEEE
Trans. CAD 20 (2001).
"""

from array import array

import cython

VARIABLE = cython.declare(cython.int, 0)  # what stands where in the eight numbers of a node
HIGH = cython.declare(cython.int, 1)
LOW = cython.declare(cython.int, 2)
USES = cython.declare(cython.int, 3)  # edges to it, of nodes and roots
NEXT = cython.declare(cython.int, 4)  # of the same bucket; of a free place, the next free one
BEFORE = cython.declare(cython.int, 5)  # of the same variable
AFTER = cython.declare(cython.int, 6)


@cython.cclass
class Sifter:
    """The nodes of several roots by level: at most `room` of them at any time, `nodes` at present (without the
    constant).

    `level`, `high`, `low` and `roots` are those of `Builder.shared`; the levels they begin with name the variables.
    """

    node: cython.int[::1]  # eight a node
    bucket: cython.int[::1]
    first: cython.int[::1]  # node of each variable
    count: cython.int[::1]  # nodes of each variable
    variable_at: cython.int[::1]  # by level
    level_of: cython.int[::1]  # by variable
    roots: cython.int[::1]
    mask: cython.longlong
    room: cython.longlong
    space: cython.int  # nodes that there is room for now, the constant and what is free with them
    made: cython.int
    free: cython.int
    levels: cython.int
    nodes = cython.declare(cython.int, visibility="public")
    steps = cython.declare(cython.longlong, visibility="public")  # swaps, and nodes that they looked at

    def __init__(
        self,
        level: cython.int[::1],
        high: cython.int[::1],
        low: cython.int[::1],
        roots: cython.int[::1],
        room: cython.longlong,
    ):
        i: cython.int
        v: cython.int
        n: cython.int = len(level)
        slots: cython.longlong = 16
        while slots < n:
            slots *= 2
        self.levels = level[0]
        self.room = room
        self.space = n + n // 8 + 2
        self.node = array("i", bytes(32 * self.space))
        self.bucket = array("i", bytes(4 * slots))
        self.mask = slots - 1
        self.first, self.count = array("i", bytes(4 * self.levels)), array("i", bytes(4 * self.levels))
        self.variable_at, self.level_of = array("i", range(self.levels)), array("i", range(self.levels))
        self.roots = array("i", roots)
        self.node[VARIABLE] = self.levels
        self.made, self.free, self.nodes, self.steps = 1, 0, 0, 0
        for i in range(1, n):
            v = level[i]
            self.edge(v, high[i], low[i])
        for i in range(len(roots)):
            self.node[8 * cython.cast(cython.longlong, roots[i] >> 1) + USES] += 1

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    @cython.inline
    def slot(self, variable: cython.longlong, high: cython.longlong, low: cython.longlong) -> cython.longlong:
        mixed: cython.longlong = variable * 741457 + high * 12582917 + low * 4256249
        return (mixed ^ (mixed >> 15)) & self.mask

    @cython.cfunc
    def enlarge(self) -> cython.int:
        """Twice the room for nodes, and as many buckets as nodes."""
        i: cython.int
        v: cython.int
        at: cython.longlong
        slot: cython.longlong
        old = self.node
        self.space *= 2
        self.node = array("i", bytes(8 * len(old)))
        self.node[: len(old)] = old
        if len(self.bucket) < self.space:
            self.bucket = array("i", bytes(8 * len(self.bucket)))
            self.mask = len(self.bucket) - 1
            for v in range(self.levels):
                i = self.first[v]
                while i:
                    at = 8 * cython.cast(cython.longlong, i)
                    slot = self.slot(v, self.node[at + HIGH], self.node[at + LOW])
                    self.node[at + NEXT] = self.bucket[slot]
                    self.bucket[slot] = i
                    i = self.node[at + AFTER]
        return 0

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    def edge(self, variable: cython.int, high: cython.int, low: cython.int) -> cython.int:
        """The edge to `if variable then high else low`; a new node uses its children."""
        i: cython.int
        at: cython.longlong
        if high == low:
            return high
        flip: cython.int = high & 1
        high ^= flip
        low ^= flip
        slot: cython.longlong = self.slot(variable, high, low)
        i = self.bucket[slot]
        while i:
            at = 8 * cython.cast(cython.longlong, i)
            if self.node[at + HIGH] == high and self.node[at + LOW] == low and self.node[at] == variable:
                return 2 * i + flip
            i = self.node[at + NEXT]
        if self.free:
            i = self.free
            self.free = self.node[8 * cython.cast(cython.longlong, i) + NEXT]
        else:
            if self.made >= self.space:
                with cython.gil:
                    self.enlarge()
            i = self.made
            self.made += 1
        at = 8 * cython.cast(cython.longlong, i)
        self.node[at + HIGH] = high
        self.node[at + LOW] = low
        self.node[at + USES] = 0
        self.node[8 * cython.cast(cython.longlong, high >> 1) + USES] += 1
        self.node[8 * cython.cast(cython.longlong, low >> 1) + USES] += 1
        self.nodes += 1
        self.enter(i, variable)
        return 2 * i + flip

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    def enter(self, i: cython.int, variable: cython.int) -> cython.void:
        """Put node i, whose children are set, among those of the variable."""
        at: cython.longlong = 8 * cython.cast(cython.longlong, i)
        slot: cython.longlong = self.slot(variable, self.node[at + HIGH], self.node[at + LOW])
        head: cython.int = self.first[variable]
        self.node[at] = variable
        self.node[at + NEXT] = self.bucket[slot]
        self.bucket[slot] = i
        self.node[at + BEFORE] = 0
        self.node[at + AFTER] = head
        if head:
            self.node[8 * cython.cast(cython.longlong, head) + BEFORE] = i
        self.first[variable] = i
        self.count[variable] += 1

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    def leave(self, i: cython.int) -> cython.void:
        """Take node i out of its bucket and its variable."""
        at: cython.longlong = 8 * cython.cast(cython.longlong, i)
        variable: cython.int = self.node[at]
        slot: cython.longlong = self.slot(variable, self.node[at + HIGH], self.node[at + LOW])
        j: cython.int = self.bucket[slot]
        before: cython.int = self.node[at + BEFORE]
        after: cython.int = self.node[at + AFTER]
        if j == i:
            self.bucket[slot] = self.node[at + NEXT]
        else:
            while self.node[8 * cython.cast(cython.longlong, j) + NEXT] != i:
                j = self.node[8 * cython.cast(cython.longlong, j) + NEXT]
            self.node[8 * cython.cast(cython.longlong, j) + NEXT] = self.node[at + NEXT]
        if before:
            self.node[8 * cython.cast(cython.longlong, before) + AFTER] = after
        else:
            self.first[variable] = after
        if after:
            self.node[8 * cython.cast(cython.longlong, after) + BEFORE] = before
        self.count[variable] -= 1

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    def disuse(self, edge: cython.int) -> cython.void:
        """One use less of a node; without any it is gone, and uses its children no more."""
        i: cython.int = edge >> 1
        at: cython.longlong = 8 * cython.cast(cython.longlong, i)
        self.node[at + USES] -= 1
        if i and self.node[at + USES] == 0:
            self.leave(i)
            self.nodes -= 1
            self.node[at + NEXT] = self.free
            self.free = i
            self.disuse(self.node[at + HIGH])
            self.disuse(self.node[at + LOW])

    @cython.cfunc
    @cython.nogil
    @cython.exceptval(check=False)
    def exchange(self, level: cython.int) -> cython.void:
        """Swap the variables of `level` and the one below."""
        x: cython.int = self.variable_at[level]
        y: cython.int = self.variable_at[level + 1]
        i: cython.int = self.first[x]
        after: cython.int
        f1: cython.int
        f0: cython.int
        f11: cython.int
        f10: cython.int
        f01: cython.int
        f00: cython.int
        at: cython.longlong
        a: cython.longlong
        b: cython.longlong
        self.steps += 1
        while i:
            self.steps += 1
            at = 8 * cython.cast(cython.longlong, i)
            after = self.node[at + AFTER]
            f1, f0 = self.node[at + HIGH], self.node[at + LOW]
            a, b = 8 * cython.cast(cython.longlong, f1 >> 1), 8 * cython.cast(cython.longlong, f0 >> 1)
            if self.node[a] == y or self.node[b] == y:
                f11 = f10 = f1
                f01 = f00 = f0
                if self.node[a] == y:
                    f11, f10 = self.node[a + HIGH], self.node[a + LOW]
                if self.node[b] == y:
                    f01, f00 = self.node[b + HIGH] ^ (f0 & 1), self.node[b + LOW] ^ (f0 & 1)
                self.leave(i)
                f11 = self.edge(x, f11, f01)
                f10 = self.edge(x, f10, f00)
                self.node[at + HIGH], self.node[at + LOW] = f11, f10
                self.node[8 * cython.cast(cython.longlong, f11 >> 1) + USES] += 1
                self.node[8 * cython.cast(cython.longlong, f10 >> 1) + USES] += 1
                self.enter(i, y)
                self.disuse(f1)
                self.disuse(f0)
            i = after
        self.variable_at[level], self.variable_at[level + 1] = y, x
        self.level_of[x], self.level_of[y] = level + 1, level

    def swap(self, level: cython.int):
        """Swap the variables of `level` and the one below; the number of nodes then."""
        self.exchange(level)
        return self.nodes

    def sift(self, steps: cython.longlong, pulse=None):
        """Move each variable that has nodes to where the diagrams are smallest; how many had their turn.

        It ends early where `steps` are spent. `pulse` is called before each swap; what it raises ends the work.
        """
        turns = sorted([v for v in range(self.levels) if self.count[v]], key=lambda v: (-self.count[v], v))
        end: cython.longlong = self.steps + steps
        done: cython.int = 0
        for v in turns:
            if self.steps >= end:
                break
            self.settle(v, end, pulse)
            done += 1
        return done

    @cython.cfunc
    def settle(self, variable: cython.int, end: cython.longlong, pulse: object) -> cython.int:
        """Move the variable to its best level, the nearer end first."""
        best: cython.int = self.nodes
        start: cython.int = self.level_of[variable]
        best_level: cython.int = start
        first_down: cython.bint = 2 * start >= self.levels
        k: cython.int
        for k in range(2):
            best, best_level = self.go(variable, first_down == (k == 0), start, best, best_level, end, pulse)
        while self.level_of[variable] < best_level:
            self.exchange(self.level_of[variable])
        while self.level_of[variable] > best_level:
            self.exchange(self.level_of[variable] - 1)
        return 0

    @cython.cfunc
    def go(
        self,
        variable: cython.int,
        down: cython.bint,
        start: cython.int,
        best: cython.int,
        best_level: cython.int,
        end: cython.longlong,
        pulse: object,
    ) -> tuple[cython.int, cython.int]:
        """Move the variable down or up as far as it may pay; the least number of nodes seen, and at which level.

        Up to level `start` it has been there: nothing new to be seen, and nothing to be limited.
        """
        level: cython.int = self.level_of[variable]
        upper: cython.int
        lower: cython.int
        i: cython.int
        least: cython.int  # nodes that stay whatever the further way: a swap only frees nodes of the lower level
        below: cython.int = 0  # nodes of the levels below
        for i in range(level + 1, self.levels):
            below += self.count[self.variable_at[i]]
        while (level < self.levels - 1) if down else (level > 0):
            upper = self.variable_at[level if down else level - 1]
            lower = self.variable_at[level + 1 if down else level]
            if (level >= start) if down else (level <= start):
                least = self.nodes - below if down else below
                if least >= best or self.nodes - best > best // 5:
                    break
                # what the swap may add, and what the way back may need in between
                if self.steps >= end or self.nodes + 2 * self.count[upper] + self.count[lower] > self.room:
                    break
            if pulse is not None:
                pulse()
            if down:
                below -= self.count[lower]
                self.exchange(level)
            else:
                self.exchange(level - 1)
                below += self.count[upper]
            level = self.level_of[variable]
            if self.nodes < best:
                best, best_level = self.nodes, level
        return best, best_level

    def keep(self, count: cython.int):
        """Give up all roots but the first `count`, and the nodes that only they have."""
        i: cython.int
        for i in range(count, len(self.roots)):
            self.disuse(self.roots[i])
        self.roots = self.roots[:count]

    def order(self):
        """The variable of each level."""
        return array("i", self.variable_at)

    def finish(self):
        """Level, high and low of all nodes, numbered anew with children first, and the edges of the roots."""
        i: cython.int
        v: cython.int
        n: cython.int = 1
        at: cython.longlong
        number: cython.int[::1] = array("i", bytes(4 * self.made))
        level, high, low = (array("i", bytes(4 * (self.nodes + 1))) for _ in range(3))
        levels: cython.int[::1] = level
        highs: cython.int[::1] = high
        lows: cython.int[::1] = low
        levels[0] = self.levels
        for v in range(self.levels - 1, -1, -1):
            i = self.first[self.variable_at[v]]
            while i:
                at = 8 * cython.cast(cython.longlong, i)
                levels[n] = v
                highs[n] = 2 * number[self.node[at + HIGH] >> 1]
                lows[n] = 2 * number[self.node[at + LOW] >> 1] + (self.node[at + LOW] & 1)
                number[i] = n
                n += 1
                i = self.node[at + AFTER]
        roots = array("i", [2 * number[root >> 1] + (root & 1) for root in self.roots])
        return level, high, low, roots

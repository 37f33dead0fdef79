# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Modules: gates that share nothing below them with the rest of the graph, each a variable of what is above it.

This file runs compiled (Cython) and interpreted, with the same results.

Source: Y. Dutuit and A. Rauzy, "A Linear-Time Algorithm to Find Modules of Fault Trees", IEEE Trans. Reliability 45
(1996).
"""

from array import array

import cython

from safety.trees.kernel.flat import FlatGraph

VOTE = cython.declare(cython.int, 2)
XOR = cython.declare(cython.int, 3)
VISITS = cython.declare(cython.longlong, 2_000_000)  # that `gather` spends at most on looking for what is shared


def modules(flat, monotone: cython.bint = False):
    """The indices of the gates that are modules, inner ones first and the root's last, and for each whether it is
    monotone: neither a complement nor an exclusive or below it.

    With `monotone`, only such gates, and the root's. Both are arrays of C int, empty where the root is no gate.
    """
    walk = Walk(flat)
    gates, flags = array("i"), array("i")
    g: cython.int
    c: cython.int
    if walk.top < 0:
        return gates, flags
    for g in range(walk.count):
        c = walk.first + g
        if g == walk.top or (walk.entered[c] and walk.closed(c, c) and (walk.plain[c] or not monotone)):
            gates.append(c)
            flags.append(walk.plain[c])
    return gates, flags


def gather(flat):
    """The same function with inputs of an "and", "or" or exclusive or gathered in modules of their own.

    Such are the inputs that are connected with each other below and with nothing else, and all those that are single
    variables or modules together.
    """
    return Gather(flat).graph()


@cython.cclass
class Walk:
    """When a walk from the root that enters each gate once came by what is below, in dates from 1."""

    kind: cython.int[::1]
    k: cython.int[::1]
    start: cython.int[::1]
    inputs: cython.int[::1]
    entered: cython.int[::1]
    last: cython.int[::1]
    left: cython.int[::1]
    earliest: cython.int[::1]  # date at which anything below was met, by index; of a variable, the variable itself
    latest: cython.int[::1]
    plain: cython.char[::1]  # neither a complement nor an exclusive or below
    first: cython.int
    count: cython.int
    top: cython.int

    def __init__(self, flat):
        self.kind, self.k, self.start, self.inputs = flat.kind, flat.k, flat.start, flat.inputs
        self.first, self.count = flat.variables + 1, len(flat.kind)
        self.top = (flat.root >> 1) - self.first
        size: cython.int = 4 * (self.first + self.count)
        self.entered, self.left = array("i", bytes(size)), array("i", bytes(size))
        self.last = array("i", bytes(size))
        self.earliest, self.latest = array("i", bytes(size)), array("i", bytes(size))
        self.plain = bytearray(b"\1" * (self.first + self.count))
        if self.top >= 0:
            self.go()

    @cython.cfunc
    def go(self) -> cython.void:
        """Walk, and enter the dates."""
        last: cython.int[::1] = self.last
        at: cython.int[::1] = array("i", self.start)  # the next input of each gate on the path
        path: cython.int[::1] = array("i", bytes(4 * self.count))
        depth: cython.int = 0
        date: cython.int = 1
        g: cython.int
        i: cython.int
        c: cython.int
        path[0] = self.top
        self.entered[self.first + self.top] = last[self.first + self.top] = 1
        while depth >= 0:
            g = path[depth]
            date += 1
            if at[g] == self.start[g + 1]:
                self.left[self.first + g] = last[self.first + g] = date
                depth -= 1
                continue
            c = self.inputs[at[g]] >> 1
            at[g] += 1
            last[c] = date
            if self.entered[c] == 0:
                self.entered[c] = date
                if c >= self.first:
                    depth += 1
                    path[depth] = c - self.first
        for c in range(self.first):
            self.earliest[c], self.latest[c] = self.entered[c], last[c]
        for g in range(self.count):
            c = self.first + g
            if self.entered[c] == 0:
                continue
            self.plain[c] = self.kind[g] != XOR
            self.earliest[c] = self.left[c]
            for i in range(self.start[g], self.start[g + 1]):
                self.meet(c, self.inputs[i] >> 1)
                if self.inputs[i] & 1 or not self.plain[self.inputs[i] >> 1]:
                    self.plain[c] = False

    @cython.cfunc
    @cython.exceptval(check=False)
    def meet(self, gate: cython.int, below: cython.int) -> cython.void:
        """Enter that `below` and what is below it are below the gate."""
        self.earliest[gate] = min(self.earliest[gate], min(self.entered[below], self.earliest[below]))
        self.latest[gate] = max(self.latest[gate], max(self.last[below], self.latest[below]))

    @cython.cfunc
    @cython.exceptval(check=False)
    def closed(self, gate: cython.int, below: cython.int) -> cython.bint:
        """Whether everything below `below` was met only while the walk was below the gate."""
        return self.entered[gate] < self.earliest[below] and self.latest[below] < self.left[gate]


@cython.cclass
class Gather:
    """For one gate after the other, which of its inputs are connected."""

    walk: Walk
    module: cython.char[::1]
    parent: cython.int[::1]  # of an input, by its position, in the forest of connected ones
    owner: cython.int[::1]  # by index: the last input that reached it, as its place in `inputs`, plus one
    agenda: cython.int[::1]
    visits: cython.longlong
    flat: object

    def __init__(self, flat):
        self.flat, self.walk, self.visits = flat, Walk(flat), 0
        size: cython.int = self.walk.first + self.walk.count
        self.module = bytearray(size)
        for c in modules(flat)[0]:
            self.module[c] = True
        self.parent = array("i", bytes(4 * (len(flat.inputs) + 1)))
        self.owner, self.agenda = array("i", bytes(4 * size)), array("i", bytes(4 * (len(flat.inputs) + 1)))

    @cython.cfunc
    @cython.exceptval(check=False)
    def leader(self, i: cython.int) -> cython.int:
        """The first of the inputs known to be connected with input i."""
        while self.parent[i] != i:
            self.parent[i] = self.parent[self.parent[i]]
            i = self.parent[i]
        return i

    @cython.cfunc
    @cython.exceptval(check=False)
    def connect(self, g: cython.int) -> cython.void:
        """Join the inputs of the gate that share something; the leader is the first of them."""
        walk: Walk = self.walk
        i: cython.int
        j: cython.int
        c: cython.int
        waiting: cython.int
        for i in range(walk.start[g], walk.start[g + 1]):
            self.parent[i] = i
        for i in range(walk.start[g], walk.start[g + 1]):
            self.agenda[0] = walk.inputs[i] >> 1
            waiting = 1
            while waiting:
                waiting -= 1
                c = self.agenda[waiting]
                self.visits += 1
                j = self.owner[c] - 1
                self.owner[c] = i + 1
                if walk.start[g] <= j < i or j == i:
                    j = self.leader(j)
                    self.parent[max(j, self.leader(i))] = min(j, self.leader(i))
                elif c >= walk.first and not self.module[c]:
                    for j in range(walk.start[c - walk.first], walk.start[c - walk.first + 1]):
                        if self.owner[walk.inputs[j] >> 1] != i + 1:
                            self.agenda[waiting] = walk.inputs[j] >> 1
                            waiting += 1

    def graph(self):
        """The graph with the new gates."""
        walk: Walk = self.walk
        inputs: cython.int[::1] = walk.inputs
        index_of: cython.int[::1] = array("i", range(walk.first + walk.count))
        group: cython.int[::1] = array("i", bytes(4 * (len(inputs) + 1)))  # of an input: first of its group, or -1
        size: cython.int[::1] = array("i", bytes(4 * (len(inputs) + 1)))
        new_kind, new_k, new_start, new_inputs = array("i"), array("i"), array("i", [0]), array("i")
        g: cython.int
        i: cython.int
        j: cython.int
        c: cython.int
        low: cython.int
        high: cython.int
        single: cython.int
        made: cython.int = 0
        for g in range(walk.count):
            if not walk.entered[walk.first + g]:
                continue
            low, high = walk.start[g], walk.start[g + 1]
            for i in range(low, high):
                group[i] = -1
                size[i] = 0
            if walk.kind[g] != VOTE and high - low > 2 and self.visits < VISITS:
                self.connect(g)
                for i in range(low, high):
                    size[self.leader(i)] += 1
                    group[i] = self.leader(i)
                for i in range(low, high):  # no group with an input of which a part is elsewhere
                    c = inputs[i] >> 1
                    if not (
                        walk.closed(walk.first + g, c)
                        and walk.entered[c] > walk.entered[walk.first + g]
                        and walk.last[c] < walk.left[walk.first + g]
                    ):
                        size[group[i]] = 0
                single = -1
                for i in range(low, high):
                    if size[group[i]] == 1:
                        if single < 0:
                            single = i
                        else:
                            size[single] += 1
                            size[i] = 0
                            group[i] = single
                for i in range(low, high):
                    j = group[i]
                    if size[j] < 2 or size[j] == high - low:
                        group[i] = -1
            for i in range(low, high):
                if group[i] == i:
                    for j in range(i, high):
                        if group[j] == i:
                            new_inputs.append(2 * index_of[inputs[j] >> 1] + (inputs[j] & 1))
                    new_kind.append(walk.kind[g])
                    new_k.append(0)
                    new_start.append(len(new_inputs))
                    size[i] = walk.first + made
                    made += 1
            for i in range(low, high):
                if group[i] == i:
                    new_inputs.append(2 * size[i])
                elif group[i] < 0:
                    new_inputs.append(2 * index_of[inputs[i] >> 1] + (inputs[i] & 1))
            new_kind.append(walk.kind[g])
            new_k.append(walk.k[g])
            new_start.append(len(new_inputs))
            index_of[walk.first + g] = walk.first + made
            made += 1
        root = 2 * index_of[self.flat.root >> 1] + (self.flat.root & 1)
        return FlatGraph(self.flat.variables, new_kind, new_k, new_start, new_inputs, root)

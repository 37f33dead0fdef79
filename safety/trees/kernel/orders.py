# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Orders of the variables of a module, to be tried in turn: no single rule is good for every fault tree.

Walks down from the module's gate that take the inputs of a gate by some rule, orders by the weight that the gates hand
down, and some of these improved by FORCE.

This file runs compiled (Cython) and interpreted, with the same results.

Sources: S. Minato, N. Ishiura, S. Yajima, "Shared Binary Decision Diagram with Attributed Edges for Efficient Boolean
Function Manipulation", DAC 1990, for weights; F. Aloul, I. Markov, K. Sakallah, "FORCE: A Fast and Easy-to-Implement
Variable-Ordering Heuristic", GLSVLSI 2003.
"""

from array import array

import cython

GIVEN = cython.declare(cython.int, 0)  # which inputs of a gate are taken first
SMALL = cython.declare(cython.int, 1)
SHARED = cython.declare(cython.int, 2)
BIG = cython.declare(cython.int, 3)
SHALLOW = cython.declare(cython.int, 4)
DEEP = cython.declare(cython.int, 5)
ROUNDS = cython.declare(cython.int, 20)  # of FORCE
SCANS = cython.declare(cython.longlong, 3_000_000)  # steps after which the costlier rules go on more simply


def orders(flat, module_gate: cython.int, is_module: cython.char[::1]):
    """Arrays of the indices of the variables and inner modules (`is_module`, by index) below the gate of that index.

    The first of an array is to be nearest the root. They are made as they are asked for, none twice, the usually good
    ones first.
    """
    module = Module(flat, module_gate, is_module)
    if len(module.gates) == 1:  # symmetric
        yield module.walk(GIVEN)
        return
    seen = set()
    for order in _candidates(module):
        if order.tobytes() not in seen:
            seen.add(order.tobytes())
            yield order


def _candidates(module):
    yield module.familiar()
    weighted = module.weighted()
    yield module.force(weighted)
    for rule in (SHARED, BIG):
        yield module.walk(rule)
    yield module.force(module.walk(GIVEN))
    for rule in (GIVEN, SMALL, SHALLOW, DEEP):
        yield module.walk(rule)
    yield weighted
    for rule in (SMALL, SHARED, BIG, SHALLOW, DEEP):
        yield module.force(module.walk(rule))


@cython.cclass
class Module:
    """The gates of one module, inputs first, and what the rules ask about its indices."""

    start: cython.int[::1]
    inputs: cython.int[::1]
    gates: cython.int[::1]
    size: cython.int[::1]  # of a gate, as a tree; 0 for variables
    depth: cython.int[::1]  # gates on the longest path down
    shares: cython.int[::1]  # gates that have it as an input
    seen: cython.int[::1]  # number of the last walk that met it
    told: cython.int[::1]  # number of the last telling that reached it
    tellings: cython.int
    variables: cython.int
    leaves: cython.int
    walks: cython.int
    top: cython.int

    def __init__(self, flat, module_gate: cython.int, is_module: cython.char[::1]):
        first: cython.int = flat.variables + 1
        count: cython.int = first + len(flat.kind)
        path: cython.int[::1] = array("i", bytes(4 * count))
        at: cython.int[::1] = array("i", bytes(4 * count))
        gates: cython.int[::1] = array("i", bytes(4 * count))
        made: cython.int = 0
        deep: cython.int = 0
        c: cython.int
        g: cython.int
        i: cython.int
        self.start, self.inputs = flat.start, flat.inputs
        self.size, self.depth = array("i", bytes(4 * count)), array("i", bytes(4 * count))
        self.shares, self.seen = array("i", bytes(4 * count)), array("i", bytes(4 * count))
        self.told, self.tellings = array("i", bytes(4 * count)), 0
        self.variables, self.leaves, self.walks, self.top = flat.variables, 0, 1, module_gate
        path[0] = module_gate
        at[module_gate] = self.start[module_gate - first]
        while deep >= 0:
            g = path[deep]
            if at[g] < self.start[g + 1 - first]:
                c = self.inputs[at[g]] >> 1
                at[g] += 1
                self.shares[c] += 1
                if self.seen[c] == 0:
                    self.seen[c] = 1
                    if c < first or is_module[c]:
                        self.leaves += 1
                    else:
                        deep += 1
                        path[deep] = c
                        at[c] = self.start[c - first]
                continue
            deep -= 1
            gates[made] = g
            made += 1
            for i in range(self.start[g - first], self.start[g + 1 - first]):
                c = self.inputs[i] >> 1
                self.size[g] = min(self.size[g] + max(self.size[c], 1), 1 << 28)
                self.depth[g] = max(self.depth[g], self.depth[c] + 1)
        self.gates = array("i", gates[:made])

    @cython.cfunc
    @cython.exceptval(check=False)
    def key(self, rule: cython.int, c: cython.int) -> cython.longlong:
        """Inputs of a gate are taken by increasing key, equal ones as they stand."""
        if rule == SMALL:
            return self.size[c]
        if rule == SHARED:
            return self.size[c] - (cython.cast(cython.longlong, self.shares[c]) << 32)
        if rule == BIG:
            return -self.size[c]
        if rule == SHALLOW:
            return self.depth[c]
        if rule == DEEP:
            return -self.depth[c]
        return 0

    def walk(self, rule: cython.int):
        """The variables as a depth-first walk meets them."""
        first: cython.int = self.variables + 1
        agenda: cython.int[::1] = array("i", bytes(4 * (len(self.inputs) + 1)))
        keys: cython.longlong[::1] = array("q", bytes(8 * (len(self.inputs) + 1)))
        order = array("i", bytes(4 * self.leaves))
        met: cython.int[::1] = order
        waiting: cython.int = 1
        count: cython.int = 0
        base: cython.int
        g: cython.int
        c: cython.int
        i: cython.int
        j: cython.int
        key: cython.longlong
        self.walks += 1
        agenda[0] = self.top
        while waiting:
            waiting -= 1
            g = agenda[waiting]
            if self.seen[g] == self.walks:
                continue
            self.seen[g] = self.walks
            if g != self.top and self.size[g] == 0:
                met[count] = g
                count += 1
                continue
            base = waiting
            for i in range(self.start[g + 1 - first] - 1, self.start[g - first] - 1, -1):
                c = self.inputs[i] >> 1
                if self.seen[c] == self.walks:
                    continue
                key = self.key(rule, c)
                j = waiting
                while j > base and keys[j - 1] < key:
                    agenda[j], keys[j] = agenda[j - 1], keys[j - 1]
                    j -= 1
                agenda[j], keys[j] = c, key
                waiting += 1
        return order

    def familiar(self):
        """The variables as a depth-first walk meets them that goes on where the smallest share of variables is new."""
        first: cython.int = self.variables + 1
        size: cython.int = len(self.size)
        users: cython.int[::1] = array("i", bytes(4 * (size + 1)))  # where the gates over an index begin in `over`
        over: cython.int[::1] = array("i", bytes(4 * (len(self.inputs) + 1)))
        total: cython.int[::1] = array("i", bytes(4 * size))  # variables below, and those of them not yet met
        new: cython.int[::1] = array("i", bytes(4 * size))
        agenda: cython.int[::1] = array("i", bytes(4 * (len(self.inputs) + 1)))
        path: cython.int[::1] = array("i", bytes(4 * (len(self.gates) + 1)))
        order: cython.int[::1] = self.walk(GIVEN)
        result = array("i", bytes(4 * self.leaves))
        met: cython.int[::1] = result
        scans: cython.longlong = 0
        count: cython.int = 0
        deep: cython.int = 0
        g: cython.int
        c: cython.int
        i: cython.int
        j: cython.int
        best: cython.int
        for c in range(1, size):
            users[c] = users[c - 1] + self.shares[c - 1]
        for i in range(len(self.gates)):
            g = self.gates[i]
            for j in range(self.start[g - first], self.start[g + 1 - first]):
                c = self.inputs[j] >> 1
                over[users[c]] = g
                users[c] += 1
        for i in range(self.leaves):
            self.tell(order[i], 1, total, users, over, agenda)
        for c in range(size):
            new[c] = total[c]
        self.walks += 1
        path[0] = self.top
        self.seen[self.top] = self.walks
        while deep >= 0:
            g = path[deep]
            best = -1
            for j in range(self.start[g - first], self.start[g + 1 - first]):
                c = self.inputs[j] >> 1
                if self.seen[c] == self.walks:
                    continue
                scans += 1
                if best < 0:
                    best = c
                    if scans > SCANS:
                        break
                else:
                    ours: cython.longlong = cython.cast(cython.longlong, new[c]) * total[best]
                    theirs: cython.longlong = cython.cast(cython.longlong, new[best]) * total[c]
                    if ours < theirs or (ours == theirs and new[c] < new[best]):
                        best = c
            if best < 0:
                deep -= 1
                continue
            self.seen[best] = self.walks
            if self.size[best]:
                deep += 1
                path[deep] = best
            else:
                met[count] = best
                count += 1
                self.tell(best, -1, new, users, over, agenda)
        return result

    @cython.cfunc
    @cython.exceptval(check=False)
    def tell(
        self,
        leaf: cython.int,
        change: cython.int,
        number: cython.int[::1],
        users: cython.int[::1],
        over: cython.int[::1],
        agenda: cython.int[::1],
    ) -> cython.void:
        """Add `change` to the number of `leaf` and of each gate over it."""
        waiting: cython.int = 1
        c: cython.int
        i: cython.int
        self.tellings += 1
        agenda[0] = leaf
        while waiting:
            waiting -= 1
            c = agenda[waiting]
            number[c] += change
            for i in range(users[c - 1], users[c]):
                if self.told[over[i]] != self.tellings:
                    self.told[over[i]] = self.tellings
                    agenda[waiting] = over[i]
                    waiting += 1

    def weighted(self):
        """The variables by weight: the module's gate has weight 1, a gate shares out its weight evenly to its inputs,
        and the heaviest variable is next and gone from its gates.
        """
        first: cython.int = self.variables + 1
        size: cython.int = len(self.size)
        weight: cython.double[::1] = array("d", bytes(8 * size))
        inside: cython.int[::1] = array("i", bytes(4 * size))  # inputs of a gate that are not gone; 1 for a variable
        order: cython.int[::1] = self.walk(GIVEN)
        result = array("i", bytes(4 * self.leaves))
        met: cython.int[::1] = result
        scans: cython.longlong = 0
        count: cython.int
        g: cython.int
        c: cython.int
        i: cython.int
        j: cython.int
        best: cython.int
        for i in range(self.leaves):
            inside[order[i]] = 1
        for count in range(self.leaves):
            for i in range(self.leaves):
                weight[order[i]] = 0.0
            for i in range(len(self.gates)):
                g = self.gates[i]
                weight[g] = 0.0
                inside[g] = 0
                scans += self.start[g + 1 - first] - self.start[g - first]
                for j in range(self.start[g - first], self.start[g + 1 - first]):
                    inside[g] += inside[self.inputs[j] >> 1] > 0
            if scans > SCANS * 4:
                break
            weight[self.top] = 1.0
            for i in range(len(self.gates) - 1, -1, -1):
                g = self.gates[i]
                if inside[g]:
                    for j in range(self.start[g - first], self.start[g + 1 - first]):
                        c = self.inputs[j] >> 1
                        if inside[c]:
                            weight[c] += weight[g] / inside[g]
            best = -1
            for i in range(self.leaves):
                c = order[i]
                if inside[c] and (best < 0 or weight[c] > weight[best]):
                    best = c
            inside[best] = 0
            met[count] = best
        else:
            return result
        for i in range(self.leaves):  # the rest as they are
            if inside[order[i]]:
                met[count] = order[i]
                count += 1
        return result

    def force(self, start_order):
        """`start_order` improved by moving each variable again and again to the mean position of the gates over it."""
        first: cython.int = self.variables + 1
        size: cython.int = len(self.size)
        leaves: cython.int = self.leaves
        place: cython.double[::1] = array("d", bytes(8 * size))  # of a variable, and the centre of a gate
        pull: cython.double[::1] = array("d", bytes(8 * size))
        count: cython.int[::1] = array("i", bytes(4 * size))
        best = start_order
        order: cython.int[::1] = array("i", start_order)
        best_span: cython.double = -1.0
        span: cython.double
        total: cython.double
        least: cython.double
        most: cython.double
        g: cython.int
        c: cython.int
        i: cython.int
        j: cython.int
        for _ in range(ROUNDS + 1):
            span = 0.0
            for i in range(leaves):
                place[order[i]] = i
                pull[order[i]] = 0.0
                count[order[i]] = 0
            for i in range(len(self.gates)):
                g = self.gates[i]
                total = 0.0
                least, most = leaves, 0.0
                for j in range(self.start[g - first], self.start[g + 1 - first]):
                    c = self.inputs[j] >> 1
                    total += place[c]
                    least, most = min(least, place[c]), max(most, place[c])
                place[g] = total / (self.start[g + 1 - first] - self.start[g - first])
                span += most - least
                for j in range(self.start[g - first], self.start[g + 1 - first]):
                    c = self.inputs[j] >> 1
                    pull[c] += place[g]
                    count[c] += 1
            if best_span >= 0 and span >= best_span:
                break
            best_span = span
            best = array("i", order)
            for i in range(leaves):
                c = order[i]
                pull[c] = pull[c] / count[c] if count[c] else place[c]
            self.sort(order, pull, leaves)
        return best

    @cython.cfunc
    @cython.exceptval(check=False)
    def sort(self, order: cython.int[::1], key: cython.double[::1], n: cython.int) -> cython.void:
        """By increasing key, equal ones as they were: merges of ever longer runs."""
        spare: cython.int[::1] = array("i", bytes(4 * n))
        width: cython.int = 1
        low: cython.int
        i: cython.int
        j: cython.int
        at: cython.int
        while width < n:
            for low in range(0, n, 2 * width):
                i, j = low, low + width
                for at in range(low, min(low + 2 * width, n)):
                    if i < min(low + width, n) and (j >= min(low + 2 * width, n) or key[order[i]] <= key[order[j]]):
                        spare[at] = order[i]
                        i += 1
                    else:
                        spare[at] = order[j]
                        j += 1
            for i in range(n):
                order[i] = spare[i]
            width *= 2

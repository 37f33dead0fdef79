# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Merging of common arguments in a signed graph: inputs that always come together in "ands" become a gate.

Events that occur together in many gates are then a module, one variable instead of many.

This file runs compiled (Cython) and interpreted, with the same results.
"""

from array import array

import cython

from safety.trees.kernel.flat import FlatGraph

AND = cython.declare(cython.int, 0)


def merge(flat, refs: cython.int[::1]):
    """The same function; `refs` is the number of references by index.

    Literals that are inputs of exactly the same "ands", two or more, are gathered below a new one. `flat` itself if
    there are none.
    """
    kind: cython.int[::1] = flat.kind
    k: cython.int[::1] = flat.k
    start: cython.int[::1] = flat.start
    inputs: cython.int[::1] = flat.inputs
    first: cython.int = flat.variables + 1
    count: cython.int = len(kind)
    literals: cython.int = 2 * len(refs)
    users: cython.int[::1] = array("i", bytes(4 * literals))  # "ands" that have the literal as an input
    lowest: cython.int[::1] = array("i", bytes(4 * literals))  # the first of them
    sign: cython.longlong[::1] = array("q", bytes(8 * literals))  # of the set of them
    group: cython.int[::1] = array("i", bytes(4 * literals))  # the literal that leads its group, plus one
    size: cython.int[::1] = array("i", bytes(4 * literals))
    made: cython.int[::1] = array("i", bytes(4 * literals))  # the gate of the group, by its leader
    leader: cython.int[::1] = array("i", bytes(4 * (len(inputs) + 1)))
    index_of: cython.int[::1] = array("i", range(first + count))
    new_kind, new_k, new_start, new_inputs = array("i"), array("i"), array("i", [0]), array("i")
    g: cython.int
    i: cython.int
    j: cython.int
    n: cython.int
    literal: cython.int
    other: cython.int
    gates: cython.int = 0
    groups: cython.int = 0
    for g in range(count):
        if kind[g] == AND and refs[first + g]:
            for i in range(start[g], start[g + 1]):
                literal = inputs[i]
                if users[literal] == 0:
                    lowest[literal] = g
                users[literal] += 1
                sign[literal] = (sign[literal] * 1000003 + g + 1) & 0x3FFFFFFF
    for g in range(count):
        if kind[g] != AND or not refs[first + g]:
            continue
        n = 0
        for i in range(start[g], start[g + 1]):
            literal = inputs[i]
            if lowest[literal] != g or users[literal] < 2:
                continue
            for j in range(n):
                other = leader[j]
                if sign[other] == sign[literal] and users[other] == users[literal]:
                    group[literal] = other + 1
                    size[other] += 1
                    groups += 1
                    break
            else:
                leader[n] = literal
                n += 1
                group[literal] = literal + 1
                size[literal] = 1
    if groups == 0:
        return flat
    _keep_exact(kind, start, inputs, refs, first, users, group, size)
    for g in range(count):
        if not refs[first + g]:
            continue
        if kind[g] == AND:
            for i in range(start[g], start[g + 1]):
                literal = inputs[i]
                if group[literal] == literal + 1 and size[literal] > 1 and lowest[literal] == g:
                    for j in range(start[g], start[g + 1]):
                        other = inputs[j]
                        if group[other] == literal + 1:
                            new_inputs.append(2 * index_of[other >> 1] + (other & 1))
                    new_kind.append(AND)
                    new_k.append(0)
                    new_start.append(len(new_inputs))
                    made[literal] = first + gates
                    gates += 1
        for i in range(start[g], start[g + 1]):
            literal = inputs[i]
            if kind[g] != AND or group[literal] == 0 or size[group[literal] - 1] < 2:
                new_inputs.append(2 * index_of[literal >> 1] + (literal & 1))
            elif group[literal] == literal + 1:
                new_inputs.append(2 * made[literal])
        new_kind.append(kind[g])
        new_k.append(k[g])
        new_start.append(len(new_inputs))
        index_of[first + g] = first + gates
        gates += 1
    root = 2 * index_of[flat.root >> 1] + (flat.root & 1)
    return FlatGraph(flat.variables, new_kind, new_k, new_start, new_inputs, root)


@cython.cfunc
def _keep_exact(
    kind: cython.int[::1],
    start: cython.int[::1],
    inputs: cython.int[::1],
    refs: cython.int[::1],
    first: cython.int,
    users: cython.int[::1],
    group: cython.int[::1],
    size: cython.int[::1],
) -> cython.void:
    """Dissolve every group whose literals only looked alike: each "and" must have all of a group or none."""
    found: cython.int[::1] = array("i", bytes(4 * len(users)))
    g: cython.int
    i: cython.int
    leader: cython.int
    for g in range(len(kind)):
        if kind[g] != AND or not refs[first + g]:
            continue
        for i in range(start[g], start[g + 1]):
            if group[inputs[i]]:
                found[group[inputs[i]] - 1] += 1
        for i in range(start[g], start[g + 1]):
            leader = group[inputs[i]] - 1
            if leader >= 0:
                if found[leader] not in (0, size[leader]):
                    size[leader] = 0
                found[leader] = 0

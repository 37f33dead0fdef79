# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""A signed graph, of ands and complements, written with ands and ors.

This file runs compiled (Cython) and interpreted, with the same results.
"""

from array import array

import cython

from safety.trees.kernel.flat import FlatGraph

AND = cython.declare(cython.int, 0)
OR = cython.declare(cython.int, 1)
XOR = cython.declare(cython.int, 3)


def written(flat, refs: cython.int[::1]):
    """A signed graph with ands and ors, without the gates that the root does not reach; `refs` counts references.

    A gate is written as it is or as its complement: as the one that is monotone, else as the one that is used.
    """
    kind: cython.int[::1] = flat.kind
    k: cython.int[::1] = flat.k
    start: cython.int[::1] = flat.start
    inputs: cython.int[::1] = flat.inputs
    first: cython.int = flat.variables + 1
    count: cython.int = len(kind)
    plain: cython.char[::1] = bytearray(first + count)  # used as it is, by index
    literal_of: cython.int[::1] = array("i", range(0, 2 * (first + count), 2))
    monotone: cython.char[::1] = bytearray(2 * (first + count))  # by literal as written
    g: cython.int
    i: cython.int
    literal: cython.int
    flip: cython.int
    both: cython.int
    made: cython.int = 0
    n: cython.int = 0
    new_kind: cython.int[::1] = array("i", bytes(4 * count + 4))
    new_k: cython.int[::1] = array("i", bytes(4 * count + 4))
    new_start: cython.int[::1] = array("i", bytes(4 * count + 8))
    new_inputs: cython.int[::1] = array("i", bytes(4 * len(inputs) + 4))
    plain[flat.root >> 1] = not flat.root & 1
    for g in range(count - 1, -1, -1):
        if refs[first + g]:
            for i in range(start[g], start[g + 1]):
                plain[inputs[i] >> 1] |= (inputs[i] & 1) ^ plain[first + g]
    for i in range(first):
        monotone[2 * i] = 1
    for g in range(count):
        if refs[first + g] == 0:
            continue
        both = 3  # monotone as it is, as its complement
        for i in range(start[g], start[g + 1]):
            literal = literal_of[inputs[i] >> 1] ^ (inputs[i] & 1)
            both &= monotone[literal] + 2 * monotone[literal ^ 1]
            new_inputs[n + i - start[g]] = literal
        if kind[g] == XOR:
            both = 0
        flip = both == 2 or (both == 0 and kind[g] != XOR and not plain[first + g])
        new_kind[made], new_k[made] = kind[g], k[g]
        if flip:
            for i in range(n, n + start[g + 1] - start[g]):
                new_inputs[i] ^= 1
            if kind[g] == AND:
                new_kind[made] = OR
            else:
                new_k[made] = start[g + 1] - start[g] - k[g] + 1
        literal_of[first + g] = 2 * (first + made) + flip
        monotone[2 * (first + made)] = both != 0
        n += start[g + 1] - start[g]
        made += 1
        new_start[made] = n
    root = literal_of[flat.root >> 1] ^ (flat.root & 1)
    return FlatGraph(
        flat.variables,
        array("i", new_kind[:made]),
        array("i", new_k[:made]),
        array("i", new_start[: made + 1]),
        array("i", new_inputs[:n]),
        root,
    )

# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""What one module holds.

This file runs compiled (Cython) and interpreted, with the same results.
"""

from array import array

import cython


def members(flat, gate: cython.int, is_module: cython.char[::1]):
    """The gates of one module, inputs first and `gate` last, and its variables as a walk from it meets them.

    Both are arrays of C int of indices; an inner module (nonzero in `is_module`) is a variable.
    """
    start: cython.int[::1] = flat.start
    inputs: cython.int[::1] = flat.inputs
    first: cython.int = flat.variables + 1
    met: cython.char[::1] = bytearray(first + len(start))
    agenda: cython.int[::1] = array("i", bytes(4 * (len(inputs) + 1)))
    gates, variables = array("i"), array("i")
    depth: cython.int = 1
    i: cython.int
    j: cython.int
    agenda[0] = gate
    while depth:
        depth -= 1
        i = agenda[depth]
        if i == 0 or met[i]:
            continue
        met[i] = 1
        if i < first or (is_module[i] and i != gate):
            variables.append(i)
            continue
        gates.append(i)
        for j in range(start[i - first + 1] - 1, start[i - first] - 1, -1):
            agenda[depth] = inputs[j] >> 1
            depth += 1
    return array("i", sorted(gates)), variables

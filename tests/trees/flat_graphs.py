"""Random graphs of gates, and their truth tables: bit i of a number is the value under the i-th assignment."""

import itertools

from safety.trees.kernel.flat import AND, OR, VOTE, XOR, FlatGraph


def random_graph(rng, largest=8):
    """Up to `largest` variables and 25 gates; half of them monotone, some with constants and repeated inputs."""
    variables, count, coherent = rng.randint(1, largest), rng.randint(0, 25), rng.random() < 0.5
    constants, near = rng.random() < 0.3, rng.random() < 0.5
    gates = []
    for last in range(variables, variables + count):
        kind = rng.choice([AND, OR, AND, OR, VOTE] + [XOR] * (not coherent))
        inputs = []
        for _ in range(rng.randint(1, rng.choice([2, 3, 5]))):
            lowest = 0 if constants and rng.random() < 0.1 else max(1, last - 4) if near and rng.random() < 0.6 else 1
            inputs.append(2 * rng.randint(lowest, last) + (not coherent and rng.random() < 0.3))
        gates.append((kind, rng.randint(1, len(inputs)) if kind == VOTE else 0, inputs))
    return FlatGraph.of(variables, gates, 2 * (variables + count) + (not coherent and rng.random() < 0.2))


def tables(graph):
    """The truth table of each index, and of the root."""
    rows = 1 << graph.variables
    everywhere = (1 << rows) - 1
    table = [everywhere] + [sum(1 << row for row in range(rows) if row >> v & 1) for v in range(graph.variables)]

    def of(literal):
        return table[literal >> 1] ^ (everywhere if literal & 1 else 0)

    for index in range(graph.variables + 1, graph.variables + 1 + len(graph)):
        kind, k, inputs = graph.gate(index)
        values = [of(literal) for literal in inputs]
        if kind == VOTE:
            table.append(at_least(k, values))
        else:
            value = everywhere if kind == AND else 0
            for other in values:
                value = value & other if kind == AND else value | other if kind == OR else value ^ other
            table.append(value)
    return table, of(graph.root)


def at_least(k, values):
    """Where at least k of the tables are true."""
    result = 0
    for some in itertools.combinations(values, k):
        common = some[0]
        for value in some:
            common &= value
        result |= common
    return result


def contents(graph):
    """All of a graph, to be compared."""
    return graph.variables, list(graph.kind), list(graph.k), list(graph.start), list(graph.inputs), graph.root


def below(graph):
    """By index, the set of indices at and below it."""
    cones = [{i} for i in range(graph.variables + 1)]
    for index in range(graph.variables + 1, graph.variables + 1 + len(graph)):
        cones.append({index}.union(*(cones[literal >> 1] for literal in graph.gate(index)[2])))
    return cones

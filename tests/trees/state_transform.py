"""The Laplace transform of the time to failure, read off the states found: exact, to compare with other routes."""

from fractions import Fraction

from safety.trees.dynamic.states import States


def states_transform(states: States, s: Fraction) -> Fraction:
    """Mean of exp(-s x time to failure), exact, from the transitions found."""
    out: list[list[tuple[int, Fraction]]] = [[] for _ in range(states.count)]
    for source, target, cause in zip(
        states.source.tolist(), states.target.tolist(), states.cause.tolist(), strict=True
    ):
        out[source].append((target, states.causes[cause].rate(states.tree)))
    value = [Fraction(0)] * states.count
    for state in sorted(range(states.count), key=lambda one: -states.settled[one]):
        total = sum((rate for _, rate in out[state]), Fraction(0))
        if state == states.failed:
            value[state] = Fraction(1)
        elif total:
            value[state] = sum((rate * value[target] for target, rate in out[state]), Fraction(0)) / (s + total)
    return sum((chance * value[state] for state, chance in states.start.items()), Fraction(0))

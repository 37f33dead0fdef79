"""Uncertainty of a dynamic tree: the distribution of its probability as rates and probabilities range over theirs.

The states are searched once; every sample is one more column of the same numerical solution (see `samples`).
"""

from __future__ import annotations

from collections import Counter
from fractions import Fraction

import numpy as np

from safety.rates.exceptions import NumericsFailed
from safety.trees.as_written import TreeError
from safety.trees.dynamic.data import Data
from safety.trees.dynamic.samples import probabilities
from safety.trees.dynamic.solve import DynamicSolution, checked_time
from safety.trees.tree import LARGEST
from safety.trees.uncertainty.propagation import CHUNK, Uncertainty, drawn
from safety.trees.uncertainty.sampling import Plan, Quantities, Quantity


def propagate(solution: DynamicSolution, data: Data, time_h: Fraction, plan: Plan | None = None) -> Uncertainty:
    """The distribution of the probability that the top of `solution` has failed by `time_h` (hours).

    `solution` is that of `data.tree`. Raises TreeError: nothing is uncertain, no value in some sample, rates that
    differ too much, too many uncertain probabilities in one chain. Raises TooLarge.
    """
    plan, hours = plan or Plan(), float(checked_time(time_h))
    figures = {**data.rates, **data.chances}
    quantities = tuple(
        Quantity(
            name,
            f'{"rate" if name in data.rates else "probability"} of event "{name}"',
            one,
            greatest=float(LARGEST) if name in data.rates else 1.0,
        )
        for name, one in figures.items()
    )
    names, chunks = drawn(Quantities(f'tree "{data.tree.name}"', quantities), plan, CHUNK)
    values, outside = np.empty(plan.samples), Counter[str]()
    for first, columns in chunks:
        rows = dict(zip(figures, columns.values, strict=True))
        rates, chances = ({name: rows[name] for name in part} for part in (data.rates, data.chances))
        try:
            values[first : first + CHUNK] = probabilities(solution, rates, hours, chances)
        except NumericsFailed as error:
            raise TreeError(f"{error} (some samples may have extreme rates)") from None
        outside.update(columns.outside)
    return Uncertainty(values, plan.blocks * plan.hypercube, 0.0, 1.0, plan, names, dict(outside))

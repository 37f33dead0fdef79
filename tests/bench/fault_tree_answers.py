"""What a solved fault tree costs to ask: importance of all events, thousands of samples, the reading of a file.

    python -m tests.bench.fault_tree_answers [--samples 10000]

For each public tree the best of five: the probability alone (simplification, diagrams, probability), the same with the
importance of all events, and both without the diagrams, which are there already; then samples of all probabilities
through the diagrams, also for each 1000 nodes, and the derivatives by all events for each of them.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable

import numpy as np

from safety.trees import TooLarge, read, solve
from safety.trees.solve import Solution
from safety.trees.tree import FaultTree
from tests.bench.fault_trees import trees
from tests.bench.machine import described

LEAVE = {"nus9601", "das9701", "cea9601"}  # seconds each; their ratios say no more


def best(action: Callable[[], object], times: int = 5) -> float:
    """Seconds of the fastest of some runs."""
    taken = []
    for _ in range(times):
        began = time.perf_counter()
        action()
        taken.append(time.perf_counter() - began)
    return min(taken)


def probability(solution: Solution) -> float | None:
    """Computed anew on the diagrams that are there."""
    return Solution(solution.tree, solution.graph, solution.parts).probability


def importance(solution: Solution) -> object:
    """The probability and the importance of all events, computed anew on the diagrams that are there."""
    fresh = Solution(solution.tree, solution.graph, solution.parts)
    return fresh.probability, fresh.importance()


def row(name: str, tree: FaultTree, read_s: float, samples: int) -> tuple[float, float]:
    """Print the figures of one tree; how much longer the importance takes, with and without the diagrams."""
    solution = solve(tree)
    alone = best(lambda: solve(tree).probability)
    both = best(lambda: importance(solve(tree)))
    pass_alone, pass_both = best(lambda: probability(solution)), best(lambda: importance(solution))
    columns = np.random.default_rng(1).uniform(0, 0.1, (len(solution.events), samples))
    many, slopes = best(lambda: solution.many(columns), 3), best(lambda: solution.many_derivatives(columns), 2)
    print(
        f"{name:<16}{len(solution.events):>7}{solution.nodes:>9}{1e3 * read_s:>9.2f}{1e3 * alone:>10.2f}"
        f"{both / alone:>7.2f}{1e3 * pass_alone:>10.3f}{pass_both / pass_alone:>7.2f}{1e3 * many:>10.1f}"
        f"{1e6 * many / max(1, solution.nodes):>10.1f}{slopes / many:>7.1f}",
        flush=True,
    )
    return both / alone, pass_both / pass_alone


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=10_000)
    options = parser.parse_args()
    print(described())
    print(f"{'tree':<16}{'events':>7}{'nodes':>9}{'read ms':>9}{'P ms':>10}{'x':>7}{'pass ms':>10}{'x':>7}"
          f"{'many ms':>10}{'per 1000':>10}{'x':>7}   ({options.samples} samples)")  # fmt: skip
    ratios = []
    found = trees()
    if not found:
        print("no trees; set RIGHTSIDE_ORACLES")
        return 2
    for name, files in found.items():
        if name in LEAVE or name.startswith("scram"):
            continue
        tree = read(*files)
        try:
            ratios.append(row(name, tree, best(lambda files=files: read(*files)), options.samples))
        except TooLarge as error:
            print(f"{name:<16} {error}")
    whole, passes = zip(*ratios, strict=True)
    print(f"importance by probability alone: median {statistics.median(whole):.2f}, worst {max(whole):.2f}; "
          f"on diagrams that are there: median {statistics.median(passes):.2f}, worst {max(passes):.2f}")  # fmt: skip
    return 0


if __name__ == "__main__":
    sys.exit(main())

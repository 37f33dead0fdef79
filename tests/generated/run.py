"""The table of generated models: `python tests/generated/run.py --seeds 0:20 [--family f] [--timeout 10] [--list]`."""

from __future__ import annotations

import argparse
import statistics
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from safety.prove.claims import BOUNDED, PROVED, REFUTED, VACUOUS
from safety.prove.prove import Limits, Outcome, prove
from tests.generated.case import Case
from tests.generated.generator import FAMILIES, drawn

DECIDED = (PROVED, REFUTED, VACUOUS)
COLUMNS = ("holds", "proved", "fails", "refuted", "vacuous", "bounded", "undecided", "wrong", "median s", "max s")


def is_wrong(case: Case, found: Outcome) -> bool:
    """Whether a verdict contradicts the truth: it is another one, or the search passed over a run that breaks it."""
    if found.verdict == BOUNDED and case.breaks is not None:
        return case.breaks.steps <= (found.steps or 0)
    return found.verdict in DECIDED and found.verdict != case.truth


def row(told: Sequence[tuple[Case, Outcome]]) -> list[str]:
    """A line of the table."""
    truths, verdicts = Counter(c.truth for c, _ in told), Counter(o.verdict for _, o in told)
    seconds = [o.seconds for _, o in told]
    return [
        *map(str, (truths[PROVED], verdicts[PROVED], truths[REFUTED], verdicts[REFUTED], verdicts[VACUOUS])),
        *map(str, (verdicts[BOUNDED], verdicts["undecided"], sum(is_wrong(c, o) for c, o in told))),
        *(f"{x:.2f}" for x in (statistics.median(seconds), max(seconds))),
    ]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 when a verdict is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", default="0:20", help="first:last, the last not included")
    parser.add_argument("--family", action="append", choices=[*FAMILIES])
    parser.add_argument("--timeout", type=float, default=10.0, help="seconds for one solver question")
    parser.add_argument("--synthesis", type=float, default=20.0, help="seconds for finding lemmas")
    parser.add_argument("--list", action="store_true", help="also name each case that is not decided")
    options = parser.parse_args(arguments)
    limits = Limits(timeout=options.timeout, synthesis=options.synthesis, solvers=("z3",))
    first, _, last = options.seeds.partition(":")
    print(("{:<14}" + "{:>10}" * len(COLUMNS)).format("family", *COLUMNS))
    everything: list[tuple[Case, Outcome]] = []
    for family in options.family or FAMILIES:
        told = []
        for case in drawn(range(int(first), int(last)), [family]):
            found = prove(case.claim, limits)
            told.append((case, found))
            if is_wrong(case, found):
                print(f"WRONG {case.name}: {found.verdict}, but it is {case.truth}")
            elif options.list and found.verdict not in DECIDED:
                print(f"  {case.name} ({case.truth}): {found.verdict}, {found.why}")
        print(("{:<14}" + "{:>10}" * len(COLUMNS)).format(family, *row(told)), flush=True)
        everything += told
    print(("{:<14}" + "{:>10}" * len(COLUMNS)).format("all", *row(everything)))
    decided = sum(o.verdict in DECIDED for _, o in everything)
    print(f"{decided} of {len(everything)} decided, {100 * decided / len(everything):.1f} %")
    return int(any(is_wrong(c, o) for c, o in everything))


if __name__ == "__main__":
    sys.exit(main())

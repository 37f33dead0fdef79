"""Fault-tree pictures: seconds to draw, beside `dot -Tsvg` (Graphviz) for the same trees.

Trees are grown at random (gates of two to four inputs, a tenth of the events repeated) or read from files. Ours draws
pages with cards, figures and importance; dot draws one picture of names and one probability. `in process` is the call
alone, `process` a whole process that reads the entry as JSON and writes the file, as dot reads and writes its own.

    python -m tests.bench.tree_pictures [FILE ...] [--nodes 100 500 2000] [--cap 60]
"""

import argparse
import json
import random
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from safety.commands.table import table
from safety.report.tree_svg import tree_svg
from safety.trees import BasicEvent, FaultTree, Gate, read, to_document
from safety.trees.formats.dot import to_dot
from tests.bench.machine import described

ROUNDS = 5
DRAW = "import json, sys; from safety.report.tree_svg import tree_svg; sys.stdout.write(tree_svg(json.load(sys.stdin)))"


def grown(nodes: int) -> FaultTree:
    """A tree of about so many gates and events."""
    chance = random.Random(nodes)
    gates: list[Gate] = []
    events: list[BasicEvent] = []
    opened, agenda = 1, [0]
    while agenda:
        number = agenda.pop(0)
        inputs: dict[str, None] = {}
        for _ in range(chance.randint(2, 4)):
            room = nodes - opened - len(events) - 2 * len(agenda)
            if room > 3 and (chance.random() < 0.4 or not agenda):
                inputs[f"sub-system {opened} fails"] = None
                agenda.append(opened)
                opened += 1
            elif events and chance.random() < 0.1:
                inputs[chance.choice(events).name] = None
            else:
                name = f"component {len(events)} stuck"
                given = BasicEvent(name, None, "1e-7", 1000, "from the parts list", "A")
                events.append(given)
                inputs[name] = None
        name = f"sub-system {number} fails" if number else "top"
        gates.append(Gate(name, chance.choice(("and", "or")), tuple(inputs), description="loss of a function"))
    return FaultTree(f"{nodes} nodes", "top", tuple(gates), tuple(events))


def entry(tree: FaultTree) -> dict[str, Any]:
    """As a results document has it, with figures that are made up."""
    rows = [
        {"event": event.name, "probability": 1e-4, "fussell_vesely": random.Random(event.name).random() ** 4}
        for event in tree.events
    ]
    return {"structure": to_document(tree), "probability": 0.01, "importance": rows}


def median(work: Callable[[], Any]) -> float:
    """Seconds, of ROUNDS."""
    taken = []
    for _ in range(ROUNDS):
        began = time.perf_counter()
        work()
        taken.append(time.perf_counter() - began)
    return statistics.median(taken)


def process(command: list[str], given: str, cap: float) -> str:
    """Seconds of a whole process that reads `given`, or why there are none."""
    with tempfile.TemporaryFile("w+", encoding="utf-8") as file:
        file.write(given)

        def work() -> None:
            file.seek(0)
            subprocess.run(command, stdin=file, stdout=subprocess.DEVNULL, timeout=cap, check=True)

        try:
            return f"{median(work):.3f}"
        except FileNotFoundError:
            return "not installed"
        except subprocess.TimeoutExpired:
            return f">= {cap:g}"


def main() -> None:
    """Draw each tree by both and print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--nodes", nargs="*", type=int, default=[100, 500, 2000])
    parser.add_argument("--cap", type=float, default=60)
    args = parser.parse_args()
    print(described())
    rows = []
    for tree in (*map(grown, args.nodes), *map(read, args.files)):
        ours = entry(tree)
        svg = tree_svg(ours)
        rows.append(
            [
                tree.name,
                f"{len(tree.gates)} + {len(tree.events)}",
                str(max(1, svg.count("<svg") - 2)),
                f"{len(svg) / 1e6:.2f}",
                f"{median(partial(tree_svg, ours)):.3f}",
                process([sys.executable, "-c", DRAW], json.dumps(ours), args.cap),
                process(["dot", "-Tsvg"], to_dot(tree), args.cap),
            ]
        )
    head = ["tree", "gates + events", "pages", "MB", "in process s", "process s", "dot -Tsvg s"]
    print(table(head, rows))


if __name__ == "__main__":
    main()

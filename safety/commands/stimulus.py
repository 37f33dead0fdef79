"""What a run was given, kept so that it can be run again without a solver: power-up values and inputs.

    {"start": {"acc": 0}, "inputs": {"k": [[100, 400]], "v": [[120, 12], [0, 388]]}}

Each input is a list of [value, steps]; exact rationals are texts "p/q".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from itertools import groupby
from typing import Any

from safety.system import System
from safety.terms.graph import Sort
from safety.trace import Trace, run


def stimulus(trace: Trace) -> dict[str, Any]:
    """The stimulus of a run."""
    return {
        "start": {path: _plain(value) for path, value in trace.chosen.items()},
        "inputs": {
            path: [[_plain(value), len(list(same))] for value, same in groupby(trace[path])]
            for path in trace.system.inputs
        },
    }


def rerun(system: System, given: Mapping[str, Any], steps: int) -> Trace:
    """Run a system on a stimulus.  Raises `ModelError` when the model has changed so that it no longer fits."""
    inputs = {path: [value for value, times in runs for _ in range(times)] for path, runs in given["inputs"].items()}
    start = {path: _value(value, system.lookup(path).sort) for path, value in given["start"].items()}
    return run(system, _row(system, inputs), steps, start=start)


def _row(system: System, inputs: Mapping[str, list[Any]]) -> Callable[[int], dict[str, Any]]:
    sorts = {path: term.sort for path, term in system.inputs.items()}

    def row(step: int) -> dict[str, Any]:
        return {
            path: _value(values[step], sorts[path]) if path in sorts else values[step]
            for path, values in inputs.items()
        }

    return row


def _plain(value: Any) -> Any:
    return str(value) if isinstance(value, Fraction) else value


def _value(value: Any, sort: Sort) -> Any:
    return Fraction(value) if sort.kind == "real" else value

"""What a run was given, kept so that it can be run again without a solver: power-up values and inputs.

    {"start": {"acc": 0}, "inputs": {"k": [[100, 400]], "v": [[120, 12], [0, 388]]}}

Each input is a list of [value, steps]; exact rationals are texts "p/q".
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from itertools import groupby
from typing import Any

from safety.system import System
from safety.terms.graph import Sort
from safety.trace import Trace, run


def stimulus(trace: Trace) -> dict[str, Any]:
    """The stimulus of a run."""
    return packed(trace.chosen, {path: trace[path] for path in trace.system.inputs})


def packed(start: Mapping[str, Any], inputs: Mapping[str, Iterable[Any]]) -> dict[str, Any]:
    """The stimulus that gives these power-up values, and to each input its values step by step."""
    return {
        "start": {path: _plain(value) for path, value in start.items()},
        "inputs": {
            path: [[_plain(value), len(list(same))] for value, same in groupby(values)]
            for path, values in inputs.items()
        },
    }


def unpacked(system: System, given: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, list[Any]]]:
    """Power-up values and inputs, step by step.  Raises `ModelError` for a register that the system does not have."""
    sorts = {path: term.sort for path, term in system.inputs.items()}
    start = {path: _value(value, system.lookup(path).sort) for path, value in given["start"].items()}
    return start, {path: _column(runs, sorts.get(path)) for path, runs in given["inputs"].items()}


def rerun(system: System, given: Mapping[str, Any], steps: int) -> Trace:
    """Run a system on a stimulus.  Raises `ModelError` when the model has changed so that it no longer fits."""
    start, inputs = unpacked(system, given)
    return run(system, _row(inputs), steps, start=start)


def _row(inputs: Mapping[str, list[Any]]) -> Callable[[int], dict[str, Any]]:
    return lambda step: {path: values[step] for path, values in inputs.items()}


def _column(runs: Iterable[tuple[Any, int]], sort: Sort | None) -> list[Any]:
    return [given for value, times in runs for given in [_value(value, sort)] * times]


def _plain(value: Any) -> Any:
    return str(value) if isinstance(value, Fraction) else value


def _value(value: Any, sort: Sort | None) -> Any:
    return Fraction(value) if sort is not None and sort.kind == "real" else value
